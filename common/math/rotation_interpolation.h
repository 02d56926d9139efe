#pragma once

#include <cmath>
#include <concepts>
#include <optional>

#include "math/quaternion.h"

/// Ways from one rotation to another. t = 0 gives the first, t = 1 the second. Quaternions of any length are
/// taken, and of the two ways round always the shorter: b and −b are the same goal. (Where both ways are half
/// a turn, a·b = 0, which is decided exactly, b is taken as it is.)
///
/// Source of slerp: Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985. How it is computed
/// here: with 2φ ≤ 90° between unit a and b in four dimensions, the point at the fraction t of the arc lies
/// above the point of the chord a … b at the fraction (1 + T)/2, where T = tan((2t − 1) φ) / tan φ. So slerp
/// is nlerp with another t, and T needs neither φ nor any sine: with k = tan² φ = |b − a|² / |b + a|² it is a
/// continued fraction (`chordParameter`). Nothing is divided by sin φ, so equal and opposite quaternions are
/// not special.
namespace quincunx {

/// tan(s φ) / tan φ for tan² φ = k in [0, 1] and s in [−1, 1], by the continued fraction
///   s / (1 + (1 − s²) k / (3 + (4 − s²) k / (5 + (9 − s²) k / (7 + …))))
/// (Perron, "Die Lehre von den Kettenbrüchen", 1913, § 81, for z = i tan φ) cut off after `levels`. No term
/// is negative, so nothing cancels and the values of successive levels enclose the limit. At k = 1, where it
/// converges slowest, each level divides the error by (1 + √2)² = 5.83: 0.091 without any (T = s, nlerp),
/// 2.6e-3 with two, 1.3e-5 with five, 3.3e-10 with eleven. Held by ChordParameter.*.
template <int levels, std::floating_point Float>
Float chordParameter(Float s, Float k) {
    static_assert(levels >= 0 && levels <= (sizeof(Float) == 4 ? 12 : 40));  // the numbers stay in range
    const Float ss = s * s;
    Float numerator = 2 * levels + 1;
    Float denominator = 1;
    for (int level = levels; level >= 1; --level) {
        const Float next = static_cast<Float>(2 * level - 1) * numerator +
                           (static_cast<Float>(level * level) - ss) * k * denominator;
        denominator = numerator;
        numerator = next;
    }
    return s * denominator / numerator;
}

namespace interpolation {

/// −1 if a·b < 0, exactly; else 1.
double nearerSign(glm::quat a, glm::quat b, double squaredA, double squaredB);

/// b scaled to the length of a and turned to its side; none if one is zero or not finite.
struct Ends {
    glm::dquat a;
    glm::dquat b;
};
inline std::optional<Ends> alignedEnds(glm::quat a, glm::quat b) {
    const double squaredA = squaredNorm(a);
    const double squaredB = squaredNorm(b);
    if (!isUsable(squaredA) || !isUsable(squaredB)) [[unlikely]]
        return std::nullopt;
    const glm::dquat from(a);
    const glm::dquat to(b);
    const double along = (from.w * to.w + from.x * to.x) + (from.y * to.y + from.z * to.z);
    // The sum is off by less than 4 u |a||b|; 2^-50 leaves room for the product of the squares.
    const bool sure = along * along > 0x1p-100 * squaredA * squaredB;
    const double sign = sure ? std::copysign(1.0, along) : nearerSign(a, b, squaredA, squaredB);
    return Ends{from, (sign * std::sqrt(squaredA / squaredB)) * to};
}

/// The direction of a (1 − T)/2 + b (1 + T)/2, rounded.
inline glm::quat onChord(const Ends& ends, double chord) {
    const double weightA = 1 - chord;
    const double weightB = 1 + chord;
    const double w = weightA * ends.a.w + weightB * ends.b.w;
    const double x = weightA * ends.a.x + weightB * ends.b.x;
    const double y = weightA * ends.a.y + weightB * ends.b.y;
    const double z = weightA * ends.a.z + weightB * ends.b.z;
    const double scale = 1 / std::sqrt((w * w + x * x) + (y * y + z * z));
    return {static_cast<float>(w * scale), static_cast<float>(x * scale), static_cast<float>(y * scale),
            static_cast<float>(z * scale)};
}

/// tan² of half the angle between the ends, at most 1 + 2^-49.
inline double squaredTangent(const Ends& ends) {
    const glm::dquat apart = ends.b - ends.a;
    const glm::dquat together = ends.b + ends.a;
    return ((apart.w * apart.w + apart.x * apart.x) + (apart.y * apart.y + apart.z * apart.z)) /
           ((together.w * together.w + together.x * together.x) +
            (together.y * together.y + together.z * together.z));
}

/// For t outside [0, 1], by sine and cosine.
glm::quat extrapolate(const Ends& ends, double s);

}  // namespace interpolation

/// Constant angular velocity along the shorter arc. Within 1.2e-7 rad of the exact rotation and within 5.4e-8
/// of the unit sphere (rounding to float; the continued fraction adds 6e-10 rad), exactly `normalize(a)` or
/// ±`normalize(b)` at the ends. For t outside [0, 1] the motion goes on, within 1.2e-7 + 2^-49 |t| rad. If a
/// and b are the same rotation, that rotation for all t. None if one of them is zero or not finite, or t is
/// not finite. Held by Slerp.*.
inline std::optional<glm::quat> slerp(glm::quat a, glm::quat b, float t) {
    const std::optional<interpolation::Ends> ends = interpolation::alignedEnds(a, b);
    const double s = 2 * static_cast<double>(t) - 1;
    if (!ends || !std::isfinite(s)) [[unlikely]]
        return std::nullopt;
    if (std::abs(s) > 1) [[unlikely]]
        return interpolation::extrapolate(*ends, s);
    return interpolation::onChord(*ends, chordParameter<11>(s, interpolation::squaredTangent(*ends)));
}

/// slerp's continued fraction cut off after fewer levels: 0 is nlerp, 1 and 2 are as cheap, and 16 and 100
/// times nearer to slerp. The same in double and rounded once; t is clamped to [0, 1]. Exceptions as for
/// slerp.
template <int levels>
std::optional<glm::quat> slerpTruncated(glm::quat a, glm::quat b, float t) {
    const std::optional<interpolation::Ends> ends = interpolation::alignedEnds(a, b);
    if (!ends || !std::isfinite(t)) [[unlikely]]
        return std::nullopt;
    const double s = 2 * static_cast<double>(glm::clamp(t, 0.0f, 1.0f)) - 1;
    if constexpr (levels == 0)
        return interpolation::onChord(*ends, s);
    else
        return interpolation::onChord(*ends, chordParameter<levels>(s, interpolation::squaredTangent(*ends)));
}

/// The same path as slerp at another speed: the point of the chord, brought to the unit sphere. Faster in the
/// middle; at most 0.143 rad (8.2°) from slerp, for rotations 180° apart. Within 1.2e-7 rad of the exact
/// nlerp. t is clamped to [0, 1]. Exceptions as for slerp. Held by Nlerp.*.
inline std::optional<glm::quat> nlerp(glm::quat a, glm::quat b, float t) {
    return slerpTruncated<0>(a, b, t);
}

/// (a sin((1 − t) θ) + b sin(t θ)) / sin θ with θ = acos(a·b), in float.
glm::quat slerpNaive(glm::quat unitA, glm::quat unitB, float t);
/// The same by way of b or −b, whichever is nearer.
glm::quat slerpNearerNaive(glm::quat unitA, glm::quat unitB, float t);
/// (1 − t) a + t b made unit length, in float.
glm::quat nlerpNaive(glm::quat unitA, glm::quat unitB, float t);
/// slerp by arc tangent and sines in double, within 1e-15 rad for unit a and b: what the continued fraction
/// saves.
glm::dquat slerpByAngle(glm::dquat unitA, glm::dquat unitB, double t);

/// nlerp in float with the continued fraction's first levels, for unit quaternions: what a shader would do.
template <int levels>
glm::quat slerpFast(glm::quat a, glm::quat b, float t) {
    const float along = (a.w * b.w + a.x * b.x) + (a.y * b.y + a.z * b.z);
    const float sign = along < 0 ? -1.0f : 1.0f;
    // |b − a|² / |b + a|² of unit vectors.
    const float k = (1 - sign * along) / (1 + sign * along);
    const float chord = levels == 0 ? 2 * t - 1 : chordParameter<levels>(2 * t - 1, k);
    const float weightA = 1 - chord;
    const float weightB = sign * (1 + chord);
    const glm::quat q(weightA * a.w + weightB * b.w, weightA * a.x + weightB * b.x,
                      weightA * a.y + weightB * b.y, weightA * a.z + weightB * b.z);
    const float scale = 1 / std::sqrt((q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z));
    return {q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

/// (1 − t) A + t B entry by entry: at t ≠ 0, 1 no rotation any more; between rotations 180° apart it flattens
/// space to a line half-way.
glm::mat3 matrixLerpNaive(const glm::mat3& a, const glm::mat3& b, float t);
/// The same with the columns made orthonormal, the first one kept (Gram–Schmidt, in float).
glm::mat3 matrixLerpGramSchmidtNaive(const glm::mat3& a, const glm::mat3& b, float t);
/// The rotation nearest to (1 − t) A + t B, mixed in double: the path of slerp, at the speed of a point of
/// the chord in the plane of the turn, as nlerp with twice its angle. Between rotations of nearly 180° it
/// stands still and then jumps. Exact to 1.2e-7 + 2^-46 κ rad, κ as for `quaternionFromMatrix`. None half-way
/// between rotations 180° apart, where it has no answer, and as for `nearestRotation`. Held by MatrixLerp.*.
std::optional<glm::quat> matrixLerp(const glm::mat3& a, const glm::mat3& b, float t);

}  // namespace quincunx

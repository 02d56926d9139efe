#pragma once

#include <algorithm>
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
/// is nlerp with another t, and T needs neither φ nor any sine: with k = tan² φ = (1 − a·b) / (1 + a·b) it is
/// a continued fraction (`chordParameter`). Nothing is divided by sin φ, so equal and opposite quaternions
/// are not special.
namespace quincunx {

/// tan(s φ) / tan φ for tan² φ = k in [0, 1] and s in [−1, 1], by the continued fraction
///   s / (1 + (1 − s²) k / (3 + (4 − s²) k / (5 + (9 − s²) k / (7 + …))))
/// (Gauss's, for a quotient of hypergeometric functions; Wall, "Analytic Theory of Continued Fractions",
/// 1948) cut off after `levels`. No term is negative, so nothing cancels and the values of successive levels
/// enclose the limit. At k = 1, where it converges slowest, each level divides the error by (1 + √2)² = 5.83:
/// 0.091 without any (T = s, nlerp), 2.6e-3 with two, 1.3e-5 with five, 3.3e-10 with eleven. Held by
/// ChordParameter.*. The value is s · denominator / numerator.
template <std::floating_point Float>
struct ChordRatio {
    Float numerator = 1;
    Float denominator = 1;
};
template <int levels, std::floating_point Float>
ChordRatio<Float> chordRatio(Float s, Float k) {
    static_assert(levels >= 0 && levels <= (sizeof(Float) == 4 ? 12 : 40));  // the numbers stay in range
    const Float sk = s * s * k;
    Float numerator = 2 * levels + 1;
    Float denominator = 1;
    int level = levels;
    // Two levels at a time: their product is made aside, and the chain of dependent sums is half as long.
    for (; level >= 2; level -= 2) {
        const Float inner = static_cast<Float>(level * level) * k - sk;
        const Float outer = static_cast<Float>((level - 1) * (level - 1)) * k - sk;
        const auto b = static_cast<Float>(2 * level - 1);
        const auto c = static_cast<Float>(2 * level - 3);
        const Float next = (c * b + outer) * numerator + (c * inner) * denominator;
        denominator = b * numerator + inner * denominator;
        numerator = next;
    }
    if constexpr (levels % 2 == 1) {
        const Float next = numerator + (k - sk) * denominator;
        denominator = numerator;
        numerator = next;
    }
    return {numerator, denominator};
}
template <int levels, std::floating_point Float>
Float chordParameter(Float s, Float k) {
    const ChordRatio<Float> ratio = chordRatio<levels>(s, k);
    return s * ratio.denominator / ratio.numerator;
}

namespace interpolation {

/// −1 if a·b < 0, exactly; else 1. The squares are those of the lengths.
double nearerSign(glm::quat a, glm::quat b, double squaredA, double squaredB);

/// Two quaternions, made ready.
struct Ends {
    glm::dquat a;
    glm::dquat b;             ///< on the side of a
    double squaredB = 0;      ///< |b|²
    double lengths = 0;       ///< |a||b|
    double squaredTangent{};  ///< tan² of half the angle between them: (|a||b| − a·b) / (|a||b| + a·b)
};
/// The squares of the lengths are usable.
inline Ends ends(glm::quat a, glm::quat b, double squaredA, double squaredB) {
    const glm::dquat from(a);
    const glm::dquat to(b);
    const double along = (from.w * to.w + from.x * to.x) + (from.y * to.y + from.z * to.z);
    const double lengths = productOfLengths(squaredA, squaredB);
    double sign = std::copysign(1.0, along);
    // The sum is off by less than 4 u |a||b|.
    if (std::abs(along) <= 0x1p-50 * lengths) [[unlikely]]
        sign = nearerSign(a, b, squaredA, squaredB);
    // The difference cancels where the ends are close. It is then off by 2^-50, and so is the parameter of
    // the chord; the chord itself is short.
    const double cosine = sign * along;
    const double apart = lengths - cosine;
    return Ends{from, glm::dquat(sign * to.w, sign * to.x, sign * to.y, sign * to.z), squaredB, lengths,
                (apart > 0 ? apart : 0) / (lengths + cosine)};
}

/// The direction of weightA a/|a| + weightB b/|b|, rounded. Times |a||b|², nothing is divided but once.
inline glm::quat mix(const Ends& ends, double weightA, double weightB) {
    const double scaleA = weightA * ends.squaredB;
    const double scaleB = weightB * ends.lengths;
    const double w = scaleA * ends.a.w + scaleB * ends.b.w;
    const double x = scaleA * ends.a.x + scaleB * ends.b.x;
    const double y = scaleA * ends.a.y + scaleB * ends.b.y;
    const double z = scaleA * ends.a.z + scaleB * ends.b.z;
    const double scale = 1 / std::sqrt((w * w + x * x) + (y * y + z * z));
    return {static_cast<float>(w * scale), static_cast<float>(x * scale), static_cast<float>(y * scale),
            static_cast<float>(z * scale)};
}

/// For t outside [0, 1], by sine and cosine.
glm::quat extrapolate(const Ends& ends, double s);

/// s from −1 to 1, at the end of so many levels of the continued fraction.
template <int levels>
glm::quat atChord(const Ends& ends, double s) {
    const ChordRatio<double> ratio = chordRatio<levels>(s, ends.squaredTangent);
    const double moved = s * ratio.denominator;
    return mix(ends, ratio.numerator - moved, ratio.numerator + moved);
}

}  // namespace interpolation

/// Constant angular velocity along the shorter arc. Within 1.2e-7 rad of the exact rotation and within 5.4e-8
/// of the unit sphere (rounding to float; the continued fraction adds 6e-10 rad); `normalize(a)` and
/// ±`normalize(b)` at the ends, but for ties of rounding. For t outside [0, 1] the motion goes on,
/// within 1.2e-7 + 2^-49 |t| rad. If a and b are the same rotation, that rotation for all t. None if one of
/// them is zero or not finite, or t is not finite. Held by Slerp.*.
inline std::optional<glm::quat> slerp(glm::quat a, glm::quat b, float t) {
    const double squaredA = squaredNorm(a);
    const double squaredB = squaredNorm(b);
    if (!isUsable(squaredA) || !isUsable(squaredB) || !std::isfinite(t)) [[unlikely]]
        return std::nullopt;
    const interpolation::Ends ends = interpolation::ends(a, b, squaredA, squaredB);
    const double s = 2 * static_cast<double>(t) - 1;
    if (std::abs(s) > 1) [[unlikely]]
        return interpolation::extrapolate(ends, s);
    return interpolation::atChord<11>(ends, s);
}

/// slerp's continued fraction cut off after fewer levels: 0 is nlerp, 1 and 2 are as cheap, and 16 and 100
/// times nearer to slerp. The same in double and rounded once; t is clamped to [0, 1]. Exceptions as for
/// slerp.
template <int levels>
std::optional<glm::quat> slerpTruncated(glm::quat a, glm::quat b, float t) {
    const double squaredA = squaredNorm(a);
    const double squaredB = squaredNorm(b);
    if (!isUsable(squaredA) || !isUsable(squaredB) || !std::isfinite(t)) [[unlikely]]
        return std::nullopt;
    const interpolation::Ends ends = interpolation::ends(a, b, squaredA, squaredB);
    return interpolation::atChord<levels>(ends, 2 * static_cast<double>(glm::clamp(t, 0.0f, 1.0f)) - 1);
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
    const ChordRatio<float> ratio = chordRatio<levels>(2 * t - 1, k);
    const float moved = (2 * t - 1) * ratio.denominator;
    const float weightA = ratio.numerator - moved;
    const float weightB = sign * (ratio.numerator + moved);
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
/// between rotations 180° apart, where it has no answer, and as for `nearestQuaternion`. Held by
/// MatrixLerp.*.
std::optional<glm::quat> matrixLerp(const glm::mat3& a, const glm::mat3& b, float t);

}  // namespace quincunx

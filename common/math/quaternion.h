#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "math/vector.h"

/// Rotations as quaternions w + xi + yj + zk, glm::quat(w, x, y, z). The rotation by the angle a about the
/// unit axis n, counter-clockwise for an eye that n points at, is (cos a/2, sin a/2 n). All multiples of a
/// quaternion but zero are the same rotation, q and −q among them, and every routine here takes any of them:
/// nothing needs to be made unit length first. Angles are in radians. `product(a, b)` turns by b, then by a,
/// as matrices do.
///
/// Float data are computed in double and rounded once, so "0.5 ulp" reads as in math/vector.h, and u = 2^-53.
/// Rounding a unit quaternion to float moves its components by half an ulp: it turns by up to 2^-23 =
/// 1.2e-7 rad differently, and is off the unit sphere by up to 5.4e-8 (components above ½ have the largest
/// ulp; at most three of them can be, with room for a fourth below). No routine that returns float can
/// promise less.
///
/// What that costs (bench_rotation, whole arrays): against the textbook's forms in float, less than they
/// take, or 1.3 times as much, for products, rotations, matrices of quaternions, shortest arcs and slerp; 1.5
/// to 2.2 times for nlerp and for what needs sines and arc tangents, which are taken in double; 6 times, 20
/// ns more, for `quaternionFromMatrix`, which takes every matrix. GLM's inlined forms for unit quaternions
/// take a third to two thirds of the time, but for slerp, which costs 1.3 times GLM's.
///
/// Each routine has its textbook form beside it, `...Naive`, for `stress`, sweeps and the tests alone.
namespace quincunx {

inline bool isFinite(glm::quat q) {
    return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}

/// |q|² in double, within 3 u: squares of floats are exact there.
inline double squaredNorm(glm::quat q) {
    const glm::dquat d(q);
    return (d.w * d.w + d.x * d.x) + (d.y * d.y + d.z * d.z);
}

/// True for what |q|² can be of a rotation: neither zero, nor infinite, nor NaN.
inline bool isUsable(double squaredNormOfQuaternion) {
    return squaredNormOfQuaternion > 0 && squaredNormOfQuaternion < std::numeric_limits<double>::infinity();
}

/// √(xy) of two squared lengths, within a relative 2^-35 + u. Where both are near 1, as for all unit vectors
/// and quaternions of a program, no root need be waited for: √z = (1 + z)/2 − (z − 1)²/8 + ….
inline double productOfLengths(double squaredX, double squaredY) {
    const double product = squaredX * squaredY;
    return std::abs(product - 1) < 0x1p-16 ? 0.5 * (1 + product) : std::sqrt(product);
}

/// q / |q|, each component to 0.5 ulp, for every finite q but zero; none for these. Held by Quaternion.*.
inline std::optional<glm::quat> normalize(glm::quat q) {
    const double squared = squaredNorm(q);
    if (!isUsable(squared)) [[unlikely]]
        return std::nullopt;
    const double scale = 1 / std::sqrt(squared);
    return glm::quat(static_cast<float>(q.w * scale), static_cast<float>(q.x * scale),
                     static_cast<float>(q.y * scale), static_cast<float>(q.z * scale));
}
/// The same for double, each component to 4 ulp: 3/2 u of the root of the sum, and three roundings. Powers of
/// two keep the squares in range.
std::optional<glm::dquat> normalize(glm::dquat q);

glm::quat normalizeNaive(glm::quat q);

/// ab, the rotation by b and then by a. Each component is within half an ulp of itself plus 4 u |a||b|:
/// products of floats are exact in double, so a⁻¹b of nearly equal rotations keeps its axis. Infinite beyond
/// the range of float. Held by QuaternionProduct.*.
inline glm::quat product(glm::quat a, glm::quat b) {
    const glm::dquat l(a);
    const glm::dquat r(b);
    return {static_cast<float>((l.w * r.w - l.x * r.x) - (l.y * r.y + l.z * r.z)),
            static_cast<float>((l.w * r.x + l.x * r.w) + (l.y * r.z - l.z * r.y)),
            static_cast<float>((l.w * r.y + l.y * r.w) + (l.z * r.x - l.x * r.z)),
            static_cast<float>((l.w * r.z + l.z * r.w) + (l.x * r.y - l.y * r.x))};
}

glm::quat productNaive(glm::quat a, glm::quat b);

/// ab / |ab|: a product that may be repeated for ever. | |result| − 1 | ≤ 5.4e-8 after any number of steps,
/// while each step turns the rotation by up to 1.2e-7 rad, as rounding must. None if a factor is zero or not
/// finite. Held by QuaternionDrift.*.
inline std::optional<glm::quat> compose(glm::quat a, glm::quat b) {
    const double squared = squaredNorm(a) * squaredNorm(b);
    if (!isUsable(squared)) [[unlikely]]
        return std::nullopt;
    const double scale = 1 / std::sqrt(squared);
    const glm::dquat l(a);
    const glm::dquat r(b);
    return glm::quat(static_cast<float>(((l.w * r.w - l.x * r.x) - (l.y * r.y + l.z * r.z)) * scale),
                     static_cast<float>(((l.w * r.x + l.x * r.w) + (l.y * r.z - l.z * r.y)) * scale),
                     static_cast<float>(((l.w * r.y + l.y * r.w) + (l.z * r.x - l.x * r.z)) * scale),
                     static_cast<float>(((l.w * r.z + l.z * r.w) + (l.x * r.y - l.y * r.x)) * scale));
}

/// q⁻¹ = q* / |q|², each component to 0.5 ulp. None for zero, for what is not finite, and where a component
/// leaves the range of float. Held by Quaternion.*.
inline std::optional<glm::quat> inverse(glm::quat q) {
    const double squared = squaredNorm(q);
    if (!isUsable(squared)) [[unlikely]]
        return std::nullopt;
    const glm::quat result(static_cast<float>(q.w / squared), static_cast<float>(-q.x / squared),
                           static_cast<float>(-q.y / squared), static_cast<float>(-q.z / squared));
    return isFinite(result) ? std::optional(result) : std::nullopt;
}

/// The conjugate, which is the inverse of a unit quaternion only.
glm::quat inverseNaive(glm::quat unitQ);

/// q p q⁻¹: p turned, of the same length, for q of any length: p + (2w (v × p) + 2 v × (v × p)) / |q|². Each
/// component is within half an ulp of itself plus 16 u |p|, so |error| ≤ 6e-8 |p|. None if q is zero, if
/// something is not finite, or if the result leaves the range of float. Held by QuaternionRotation.*.
inline std::optional<glm::vec3> rotate(glm::quat q, glm::vec3 p) {
    const double squared = squaredNorm(q);
    if (!isUsable(squared)) [[unlikely]]
        return std::nullopt;
    const glm::dvec3 v(q.x, q.y, q.z);
    const glm::dvec3 from(p);
    const glm::dvec3 across = glm::cross(v, from);
    const double twice = 2 / squared;
    const glm::vec3 turned(from + twice * (static_cast<double>(q.w) * across + glm::cross(v, across)));
    return isFinite(turned) ? std::optional(turned) : std::nullopt;
}
/// The same for double, within 16 u |p|. Powers of two keep |q|² in range; none if the result is not finite.
std::optional<glm::dvec3> rotate(glm::dquat q, glm::dvec3 p);

/// q p q* by two products of quaternions, as the formula is written, in float.
glm::vec3 rotateNaive(glm::quat unitQ, glm::vec3 p);

/// The matrix that turns as q of any length does: each entry within half an ulp of itself plus 8 u, so that
/// |RRᵀ − I| ≤ 1.1e-7 (rounding alone: 2 √3 2^-25). None if q is zero or not finite. Held by
/// QuaternionMatrix.*.
inline std::optional<glm::mat3> matrixFromQuaternion(glm::quat q) {
    const double squared = squaredNorm(q);
    if (!isUsable(squared)) [[unlikely]]
        return std::nullopt;
    const double twice = 2 / squared;
    const glm::dvec3 v(q.x, q.y, q.z);
    const glm::dvec3 scaled = twice * v;
    const glm::dvec3 squares = v * scaled;
    const glm::dvec3 wv = static_cast<double>(q.w) * scaled;
    const double xy = v.x * scaled.y;
    const double yz = v.y * scaled.z;
    const double zx = v.z * scaled.x;
    const auto f = [](double x) { return static_cast<float>(x); };
    return glm::mat3(f(1 - (squares.y + squares.z)), f(xy + wv.z), f(zx - wv.y),  //
                     f(xy - wv.z), f(1 - (squares.z + squares.x)), f(yz + wv.x),  //
                     f(zx + wv.y), f(yz - wv.x), f(1 - (squares.x + squares.y)));
}
/// The same for double, within 8 u.
std::optional<glm::dmat3> matrixFromQuaternion(glm::dquat q);

/// The textbook's, which takes |q| = 1 for granted.
glm::mat3 matrixFromQuaternionNaive(glm::quat unitQ);

/// The unit quaternion, w ≥ 0, of the rotation nearest to m (in the sum of squared differences of entries).
/// For a rotation that is rounded to float that is the rotation; a scaled, stretched or sheared m gives up
/// its polar factor R, m = R S with S symmetric and positive. The turn is right to 1.2e-7 + 2^-46 κ rad, κ =
/// s₁ / (s₂
/// + s₃) of the singular values: 1.2e-7 rad where m is not flattened by more than a thousand times.
/// None if m mirrors (det < 0: negate it, or a column, first), if it squeezes space to a line or a point (the
/// nearest rotation is then not one but many), or if it is not finite. Both are decided exactly. Held by
/// QuaternionMatrix.*.
///
/// Source: the quaternion is the eigenvector of the largest eigenvalue of a symmetric 4×4 matrix N (Horn,
/// "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4(4), 1987; Bar-Itzhack,
/// "New method for extracting the quaternion from a rotation matrix", J. Guidance 23(6), 2000). For a
/// rotation, N + I = 4 q qᵀ, whose largest column is what Shepperd ("Quaternion from rotation matrix", J.
/// Guidance 1(3), 1978) takes, by four branches on the same diagonal. Here that column is multiplied by N + s
/// I once more, which squares its error; where m is farther than 2^-16 from a multiple of a rotation, the
/// eigenvector is found by Jacobi's method.
std::optional<glm::quat> quaternionFromMatrix(const glm::mat3& m);
/// The same, in double to the end: for what is computed further. The turn is right to 2^-30 + 2^-46 κ rad.
std::optional<glm::dquat> nearestQuaternion(const glm::mat3& m);
/// None also where det m is not above 2^-44 of the largest entry's cube: rounding then hides its sign.
std::optional<glm::dquat> nearestQuaternion(const glm::dmat3& m);

/// w = √(1 + trace)/2, v from the differences over 4w.
glm::quat quaternionFromMatrixNaive(const glm::mat3& rotation);

/// The rotation by any finite angle about an axis of any length, each component to 0.5 ulp: (cos a/2,
/// sin a/2 n). Angle 2π gives very nearly −1, which turns as 1 does. None if the axis is zero or something is
/// not finite. Held by AxisAngle.*.
std::optional<glm::quat> quaternionFromAxisAngle(glm::vec3 axis, float radians);

/// (cos t, sin t u) as it stands, in float.
glm::quat quaternionFromAxisAngleNaive(glm::vec3 unitAxis, float radians);

struct AxisAngle {
    glm::vec3 axis{1, 0, 0};  ///< unit length
    float radians = 0;
};

/// Axis (0.5 ulp a component) and angle in [0, π] (0.5 ulp, so that the smallest turns are kept):
/// 2 atan2(|v|, |w|), the axis reversed for w < 0. A quaternion that turns nothing has the angle 0 and the
/// axis x. None if q is zero or not finite. Held by AxisAngle.*.
std::optional<AxisAngle> axisAngleFromQuaternion(glm::quat q);

/// 2 acos w and v / √(1 − w²).
AxisAngle axisAngleFromQuaternionNaive(glm::quat unitQ);

/// eʳᐟ², the rotation about r by |r| radians, each component within half an ulp of itself plus 2 u |r|; 1 for
/// r = 0. None if r is not finite. Held by RotationVector.*.
std::optional<glm::quat> quaternionFromRotationVector(glm::vec3 r);
/// 2 ln q of the shorter way round, |r| ≤ π: each component to 0.5 ulp. None if q is zero or not finite. Held
/// by RotationVector.*.
std::optional<glm::vec3> rotationVectorFromQuaternion(glm::quat q);

glm::quat quaternionFromRotationVectorNaive(glm::vec3 r);
glm::vec3 rotationVectorFromQuaternionNaive(glm::quat unitQ);

/// Rodrigues' formula, p + sin a (n × p) + (1 − cos a) n × (n × p), for an axis of any length and any finite
/// angle; 1 − cos a = 2 sin² a/2 does not cancel. Within half an ulp of itself plus 16 u |p| a component.
/// None if the axis is zero, if something is not finite, or if the result leaves the range of float. Held by
/// AxisAngle.*.
std::optional<glm::vec3> rotateAboutAxis(glm::vec3 p, glm::vec3 axis, float radians);

glm::vec3 rotateAboutAxisNaive(glm::vec3 p, glm::vec3 unitAxis, float radians);

/// The matrix of Rodrigues' formula, each entry within half an ulp of itself plus 8 u; exceptions as for
/// `quaternionFromAxisAngle`. Held by AxisAngle.*.
std::optional<glm::mat3> matrixFromAxisAngle(glm::vec3 axis, float radians);

/// The smallest turn that takes the direction `from` to the direction `to`, of any lengths: each component to
/// 0.501 ulp. (|from||to| + from·to, from × to), whose first term is |from × to|² / (|from||to| − from·to)
/// where it would cancel. If the two are exactly opposite, a half turn about `basisAround(from)`'s first
/// column. None if one is zero or not finite. Held by ShortestArc.*.
std::optional<glm::quat> shortestArc(glm::vec3 from, glm::vec3 to);

/// (1 + a·b, a × b) made unit length, in float.
glm::quat shortestArcNaive(glm::vec3 unitFrom, glm::vec3 unitTo);

/// The angle in [0, π] by which one rotation must be turned to become the other: 4 atan2(|a − b|, |a + b|)
/// for unit a and b, the nearer of b and −b, to a relative 6e-8 + 2^-51 / angle (Kahan, "How futile are
/// mindless assessments of roundoff", 2006, section 12). None if one is zero or not finite. Held by
/// RotationAngle.*.
std::optional<float> rotationAngleBetween(glm::quat a, glm::quat b);

/// 2 acos |a·b|.
float rotationAngleBetweenNaive(glm::quat unitA, glm::quat unitB);

}  // namespace quincunx

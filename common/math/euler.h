#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "math/quaternion.h"

/// Rotations by head, pitch and roll: turns about the world's fixed axes y, x and z (right-handed, y up, the
/// body looks along −z or +z as the caller likes), made one after the other in one of six orders. Read the
/// other way round, the same product turns about the body's own axes: three nested rings, a gimbal. Angles in
/// radians, float; computed in double and rounded once (u = 2^-53).
namespace quincunx {

/// How the three matrices are multiplied, left to right as written; the rightmost acts first. `zxy` is
/// M = Rz(roll) Rx(pitch) Ry(head). In a gimbal the leftmost is the outer ring, the rightmost the inner one.
enum class EulerOrder { xyz, xzy, yxz, yzx, zxy, zyx };

inline constexpr std::array<EulerOrder, 6> eulerOrders = {EulerOrder::xyz, EulerOrder::xzy, EulerOrder::yxz,
                                                          EulerOrder::yzx, EulerOrder::zxy, EulerOrder::zyx};

/// "xyz" …
std::string_view eulerOrderName(EulerOrder order);

/// The axes of an order, left to right: 0 for x (pitch), 1 for y (head), 2 for z (roll).
std::array<int, 3> eulerAxes(EulerOrder order);

struct EulerAngles {
    float head = 0;   ///< about y
    float pitch = 0;  ///< about x
    float roll = 0;   ///< about z

    /// By axis: 0 pitch, 1 head, 2 roll.
    float about(int axis) const { return axis == 0 ? pitch : axis == 1 ? head : roll; }
    float& about(int axis) { return axis == 0 ? pitch : axis == 1 ? head : roll; }
    /// What the middle ring of this order is turned by: at ±90° it locks the gimbal.
    float middle(EulerOrder order) const { return about(eulerAxes(order)[1]); }
};

/// The product of the three matrices, each entry within half an ulp of itself plus 8 u, for angles of any
/// finite size (sine and cosine are those of the float, however large). None if an angle is not finite. Held
/// by Euler.*.
std::optional<glm::mat3> matrixFromEuler(EulerAngles angles, EulerOrder order);
/// The product of three quaternions about the axes, each component within half an ulp of itself plus 8 u.
std::optional<glm::quat> quaternionFromEuler(EulerAngles angles, EulerOrder order);

/// Head, pitch and roll of the rotation of q (of any length): the middle angle in [−π/2, π/2] up to rounding,
/// the others in [−π, π] (float π, which exceeds π by 8.7e-8). They turn as q does to within 1.8e-7 rad, in
/// lock and near it as elsewhere. The outer angle is rounded to float first; the middle and the inner one are
/// read from what remains when that is undone, and so take up what rounding spoiled (the remainder is Day's:
/// "Extracting Euler angles from a rotation matrix", Insomniac Games, 2012). What is left are turns about
/// three axes at right angles: 2^-23 cos β of the outer, 2^-24 of the middle, 2^-23 of the inner angle's
/// rounding, together 1.5 2^-23. In lock (outer and inner axis parallel) only the sum or difference of the
/// outer and inner angle is known: the outer one is then 0. None if q is zero or not finite. Held by Euler.*.
std::optional<EulerAngles> eulerFromQuaternion(glm::quat q, EulerOrder order);
/// The same of the rotation nearest to m, so also of a scaled or sheared one: exceptions as for
/// `quaternionFromMatrix`. Held by Euler.*.
std::optional<EulerAngles> eulerFromMatrix(const glm::mat3& m, EulerOrder order);

/// The product in float.
glm::mat3 matrixFromEulerNaive(EulerAngles angles, EulerOrder order);
/// asin of one entry, atan2 of two pairs of others, in float.
EulerAngles eulerFromMatrixNaive(const glm::mat3& rotation, EulerOrder order);

/// The axes of the three rings in the world, as columns from the outer to the inner ring: the directions
/// about which the body turns when one of the three angles grows. |determinant| = cos of the middle angle:
/// zero in lock, where the first and the third are parallel and one direction of turning is lost. Within 8 u.
/// The angles must be finite (a bug of the caller). Held by Euler.*.
glm::dmat3 gimbalAxes(EulerAngles angles, EulerOrder order);

/// Angles at the fraction t between a and b, each one by itself on the shorter way round: what "interpolating
/// the Euler angles" means. t, a, b finite.
EulerAngles eulerLerp(EulerAngles a, EulerAngles b, float t);

}  // namespace quincunx

#pragma once

#include <optional>

#include <glm/glm.hpp>

/// Projections from the camera's frame (right-handed, looking along −z) to OpenGL's clip space, z from −w at
/// the near plane to +w at the far plane unless said otherwise. Distances along the view are positive. Every
/// entry is computed in double and rounded once: 0.5 ulp (math/vector.h); an entry that exceeds the range of
/// float is infinite.
namespace quincunx {

/// `fovYRadians` in (0, π): the full vertical angle. `aspect` > 0: width over height. 0 < near < far;
/// `farDistance` may be infinite, and then points at infinity (w = 0) land exactly on the far plane. Other
/// arguments are a bug of the caller. The depth entries are 2n (f/(f − n)) and (f + n)/(f − n), which do not
/// overflow where the result does not. Held by Perspective.*.
glm::mat4 perspective(float fovYRadians, float aspect, float nearDistance, float farDistance);

glm::mat4 perspectiveNaive(float fovYRadians, float aspect, float nearDistance, float farDistance);

/// Infinite far plane and reversed depth in [0, 1]: 1 at the near plane, 0 at infinity, depth =
/// near/distance. Needs a float depth buffer and glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE); under
/// OpenGL 3.3's own mapping of −1…1 it gains nothing (Upchurch, Desbrun, "Tightening the precision of
/// perspective rendering", JGT 16, 2012). Keeps distances apart that differ by 2^-12, at any distance. Held
/// by ReversedDepth.*.
glm::mat4 perspectiveReversed(float fovYRadians, float aspect, float nearDistance);

/// The distance along the view of a depth in (0, 1] under `perspectiveReversed`; infinity for depth 0.
/// Together with the rounding of the depth to float the error is at most 2^-23 relative. Held by
/// ReversedDepth.*.
float distanceFromReversedDepth(float depth, float nearDistance);

/// The distance along the view of a window depth in [0, 1] under `perspective` with the default depth range:
/// n / ((1 − depth) + depth n/f), whose terms do not cancel, to 0.5 ulp + 2^-26 of exact for the given
/// floats. `farDistance` may be infinite; then depth 1 is infinitely far. What the rounding of the depth
/// itself has lost is lost: half a step of it is worth 2^-25 z²/n. Held by DepthDistance.*.
float distanceFromDepth(float depth, float nearDistance, float farDistance);

/// 2nf / (f + n − (2 depth − 1)(f − n)), in float.
float distanceFromDepthNaive(float depth, float nearDistance, float farDistance);

/// left ≠ right, bottom ≠ top, near ≠ far, all finite (a bug otherwise): the box between the six planes. The
/// last two are distances along the view and may be negative. Held by Orthographic.*.
glm::mat4 orthographic(float left, float right, float bottom, float top, float nearDistance,
                       float farDistance);

/// Textbook's 2/(r − l) and (r + l)/(r − l), in float.
glm::mat4 orthographicNaive(float left, float right, float bottom, float top, float nearDistance,
                            float farDistance);

/// The same projection with the plane as near plane (Lengyel, "Oblique view frustum depth projection and
/// clipping", Journal of Game Development 1(2), 2005): what is behind the plane is clipped, as mirrors and
/// portals need it, and the far plane is tilted just enough to leave nothing of the old frustum out. The
/// plane (n, d) is in the eye's frame, n·p + d > 0 for what is kept; its length is free. Only the third row
/// changes; its entries are within half an ulp plus 2^-48 of the largest. None if the plane is not finite or
/// has no normal, if the eye is not behind it (for a perspective that is d ≥ 0), if nothing of the frustum is
/// in front of it, or if the projection is singular. Held by ObliqueNear.*.
std::optional<glm::mat4> withNearPlane(const glm::mat4& clipFromEye, glm::vec4 planeEye);

/// Lengyel's formula for a perspective, in float.
glm::mat4 withNearPlaneNaive(const glm::mat4& clipFromEye, glm::vec4 planeEye);

}  // namespace quincunx

#pragma once

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

/// left ≠ right, bottom ≠ top, near ≠ far, all finite (a bug otherwise): the box between the six planes. The
/// last two are distances along the view and may be negative. Held by Orthographic.*.
glm::mat4 orthographic(float left, float right, float bottom, float top, float nearDistance,
                       float farDistance);

}  // namespace quincunx

#pragma once

#include <array>
#include <string_view>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "math/euler.h"

namespace quincunx {

/// Ways from one pose to another that the lab shows and measures.
enum class Method {
    euler,              ///< the three angles, each by itself
    matrix,             ///< nine entries
    matrixGramSchmidt,  ///< nine entries, columns made orthonormal again
    nlerp,
    slerp1,  ///< nlerp with one level of slerp's continued fraction
    slerp2,
    slerp3,
    slerp5,
    slerpNaive,  ///< acos and sines in float
    slerp,
};
inline constexpr std::array<std::string_view, 10> methodNames = {
    "euler",   "matrix",  "gram-schmidt", "nlerp",       "slerp-1",
    "slerp-2", "slerp-3", "slerp-5",      "slerp-naive", "slerp"};

/// From `from` to `to` in the Euler angles of `order`.
struct Flight {
    EulerAngles from;
    EulerAngles to;
    EulerOrder order = EulerOrder::zxy;
};

/// The pose at t in [0, 1]. By `matrix` it is no rotation but at the ends.
glm::mat3 poseAt(const Flight& flight, Method method, float t);

/// Angular speed at t over the mean speed of slerp, from the rotations nearest to the poses a little before
/// and after; 0 where the ends are the same pose or there is no nearest rotation.
double relativeSpeed(const Flight& flight, Method method, float t);

/// The angle to slerp's pose, radians, of the rotation nearest to the pose; π where there is none.
double angleToSlerp(const Flight& flight, Method method, float t);

}  // namespace quincunx

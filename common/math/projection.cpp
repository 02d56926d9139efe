#include "math/projection.h"

#include <cmath>
#include <numbers>

#include "base/check.h"

namespace quincunx {
namespace {

/// x and y of a perspective, the rest zero.
glm::dmat4 fieldOfView(float fovYRadians, float aspect) {
    QX_CHECK(fovYRadians > 0 && fovYRadians < std::numbers::pi);
    QX_CHECK(aspect > 0 && std::isfinite(aspect));
    const double tangent = std::tan(static_cast<double>(fovYRadians) / 2);
    glm::dmat4 clipFromCamera(0);
    clipFromCamera[0][0] = 1 / (tangent * aspect);
    clipFromCamera[1][1] = 1 / tangent;
    clipFromCamera[2][3] = -1;
    return clipFromCamera;
}

}  // namespace

glm::mat4 perspective(float fovYRadians, float aspect, float nearDistance, float farDistance) {
    QX_CHECK(nearDistance > 0 && nearDistance < farDistance);
    glm::dmat4 clipFromCamera = fieldOfView(fovYRadians, aspect);
    const double near = nearDistance;
    const double far = farDistance;
    clipFromCamera[2][2] = std::isinf(far) ? -1 : -(far + near) / (far - near);
    clipFromCamera[3][2] = std::isinf(far) ? -2 * near : -2 * near * (far / (far - near));
    return glm::mat4(clipFromCamera);
}

glm::mat4 perspectiveNaive(float fovYRadians, float aspect, float nearDistance, float farDistance) {
    const float tangent = std::tan(fovYRadians / 2);
    glm::mat4 clipFromCamera(0);
    clipFromCamera[0][0] = 1 / (aspect * tangent);
    clipFromCamera[1][1] = 1 / tangent;
    clipFromCamera[2][2] = -(farDistance + nearDistance) / (farDistance - nearDistance);
    clipFromCamera[2][3] = -1;
    clipFromCamera[3][2] = -(2 * farDistance * nearDistance) / (farDistance - nearDistance);
    return clipFromCamera;
}

glm::mat4 perspectiveReversed(float fovYRadians, float aspect, float nearDistance) {
    QX_CHECK(nearDistance > 0 && std::isfinite(nearDistance));
    glm::dmat4 clipFromCamera = fieldOfView(fovYRadians, aspect);
    clipFromCamera[3][2] = nearDistance;
    return glm::mat4(clipFromCamera);
}

float distanceFromReversedDepth(float depth, float nearDistance) {
    return nearDistance / depth;
}

glm::mat4 orthographic(float left, float right, float bottom, float top, float nearDistance,
                       float farDistance) {
    QX_CHECK(left != right && bottom != top && nearDistance != farDistance);
    const glm::dvec3 low(left, bottom, -static_cast<double>(nearDistance));
    const glm::dvec3 high(right, top, -static_cast<double>(farDistance));
    const glm::dvec3 extent = high - low;
    QX_CHECK(std::isfinite(extent.x) && std::isfinite(extent.y) && std::isfinite(extent.z));
    glm::mat4 clipFromCamera(1);
    for (int axis = 0; axis < 3; ++axis) {
        clipFromCamera[axis][axis] = static_cast<float>(2 / extent[axis]);
        clipFromCamera[3][axis] = static_cast<float>(-(high[axis] + low[axis]) / extent[axis]);
    }
    return clipFromCamera;
}

}  // namespace quincunx

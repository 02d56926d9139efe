#include "math/projection.h"

#include <algorithm>
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

glm::mat4 orthographicNaive(float left, float right, float bottom, float top, float nearDistance,
                            float farDistance) {
    glm::mat4 clipFromCamera(1);
    clipFromCamera[0][0] = 2 / (right - left);
    clipFromCamera[1][1] = 2 / (top - bottom);
    clipFromCamera[2][2] = -2 / (farDistance - nearDistance);
    clipFromCamera[3][0] = -(right + left) / (right - left);
    clipFromCamera[3][1] = -(top + bottom) / (top - bottom);
    clipFromCamera[3][2] = -(farDistance + nearDistance) / (farDistance - nearDistance);
    return clipFromCamera;
}

float distanceFromDepth(float depth, float nearDistance, float farDistance) {
    const double share = static_cast<double>(nearDistance) / farDistance;
    return static_cast<float>(nearDistance / ((1 - static_cast<double>(depth)) + depth * share));
}

float distanceFromDepthNaive(float depth, float nearDistance, float farDistance) {
    const float ndc = depth * 2 - 1;
    return (2 * nearDistance * farDistance) /
           (farDistance + nearDistance - ndc * (farDistance - nearDistance));
}

std::optional<glm::mat4> withNearPlane(const glm::mat4& clipFromEye, glm::vec4 planeEye) {
    const glm::dmat4 clip(clipFromEye);
    const glm::dmat4 eyeFromClip = glm::inverse(clip);
    glm::dvec4 plane(planeEye);
    const double most = std::max({std::abs(plane.x), std::abs(plane.y), std::abs(plane.z)});
    if (!(most > 0) || !std::isfinite(most) || !std::isfinite(plane.w))
        return std::nullopt;
    plane /= most;
    // The corner of the far plane that is farthest in front of the plane must stay inside.
    const glm::dvec4 planeClip = plane * eyeFromClip;
    const auto side = [](double x) { return x < 0 ? -1.0 : 1.0; };
    const glm::dvec4 corner = eyeFromClip * glm::dvec4(side(planeClip.x), side(planeClip.y), 1, 1);
    const glm::dvec4 lastRow(clip[0][3], clip[1][3], clip[2][3], clip[3][3]);
    const double front = glm::dot(plane, corner);
    const double scale = 2 * glm::dot(lastRow, corner) / front;
    // The eye is where x, y and w of clip space vanish: (0, 0, ±∞, 0) there.
    const bool eyeInFront = clip[3][3] == 0 && plane.w >= 0;
    if (!std::isfinite(front) || !(front > 0) || !(scale > 0) || eyeInFront)
        return std::nullopt;
    glm::mat4 result = clipFromEye;
    for (int column = 0; column < 4; ++column)
        result[column][2] = static_cast<float>(scale * plane[column] - lastRow[column]);
    for (int column = 0; column < 4; ++column)
        if (!std::isfinite(result[column][2]))
            return std::nullopt;
    return result;
}

}  // namespace quincunx

#include "math/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "math/exact.h"

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
    const double det = determinant(clipFromEye);
    glm::dvec4 plane(planeEye);
    const double most = std::max({std::abs(plane.x), std::abs(plane.y), std::abs(plane.z)});
    if (det == 0 || !std::isfinite(det) || !(most > 0) || !std::isfinite(most) || !std::isfinite(plane.w))
        return std::nullopt;
    plane /= most;
    // The corner of the far plane that is farthest in front of the plane, which must stay inside. By Cramer's
    // rule, with determinants that do not cancel: the plane's sides in clip space, then the corner.
    glm::vec4 cornerClip(1);
    for (int axis = 0; axis < 2; ++axis) {
        glm::mat4 replaced = clipFromEye;
        for (int column = 0; column < 4; ++column)
            replaced[column][axis] = planeEye[column];
        cornerClip[axis] = determinant(replaced) / det < 0 ? -1.0f : 1.0f;
    }
    glm::dvec4 corner(0);
    for (int axis = 0; axis < 4; ++axis) {
        glm::mat4 replaced = clipFromEye;
        replaced[axis] = cornerClip;
        corner[axis] = determinant(replaced) / det;
    }
    const glm::dvec4 lastRow(clipFromEye[0][3], clipFromEye[1][3], clipFromEye[2][3], clipFromEye[3][3]);
    const double front = glm::dot(plane, corner);
    const double scale = 2 * glm::dot(lastRow, corner) / front;
    // A perspective's eye has no w: it is behind the plane if d < 0.
    const bool eyeInFront = clipFromEye[3][3] == 0 && plane.w >= 0;
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

glm::mat4 withNearPlaneNaive(const glm::mat4& clipFromEye, glm::vec4 planeEye) {
    const auto sign = [](float x) { return x < 0 ? -1.0f : 1.0f; };
    const glm::vec4 corner((sign(planeEye.x) + clipFromEye[2][0]) / clipFromEye[0][0],
                           (sign(planeEye.y) + clipFromEye[2][1]) / clipFromEye[1][1], -1,
                           (1 + clipFromEye[2][2]) / clipFromEye[3][2]);
    const glm::vec4 row = planeEye * (2 / glm::dot(planeEye, corner));
    glm::mat4 result = clipFromEye;
    result[0][2] = row.x;
    result[1][2] = row.y;
    result[2][2] = row.z + 1;
    result[3][2] = row.w;
    return result;
}

}  // namespace quincunx

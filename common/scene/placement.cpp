#include "scene/placement.h"

#include <cmath>

#include "math/vector.h"

namespace quincunx {

glm::dmat4 composedFrame(const glm::dvec3& translation, const glm::dvec4& q, const glm::dvec3& scale) {
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const double x = q.x / length;
    const double y = q.y / length;
    const double z = q.z / length;
    const double w = q.w / length;
    const glm::dvec3 right(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w));
    const glm::dvec3 up(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w));
    const glm::dvec3 back(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y));
    return glm::dmat4(glm::dvec4(right * scale.x, 0), glm::dvec4(up * scale.y, 0),
                      glm::dvec4(back * scale.z, 0), glm::dvec4(translation, 1));
}

glm::dmat4 restFrame(const Node& node) {
    if (node.matrix)
        return glm::dmat4(*node.matrix);
    const glm::dquat q(node.rotation);
    return composedFrame(glm::dvec3(node.translation), glm::dvec4(q.x, q.y, q.z, q.w),
                         glm::dvec3(node.scale));
}

bool isFiniteAsFloat(const glm::dmat4& frame) {
    const glm::mat4 rounded(frame);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(rounded[column][row]))
                return false;
    return true;
}

std::optional<glm::vec3> unitOrAsItIs(const glm::dvec3& direction) {
    const glm::vec3 rounded(direction);
    if (std::abs(glm::length(glm::dvec3(rounded)) - 1) <= unitTolerance)
        return rounded;
    const std::optional<glm::dvec3> unit = normalize(direction);
    return unit ? std::optional(glm::vec3(*unit)) : std::nullopt;
}

std::optional<glm::vec3> viewDirection(const glm::dmat4& worldFromNode) {
    return unitOrAsItIs(-glm::dvec3(worldFromNode[2]));
}

std::optional<glm::mat4> cameraFrame(const glm::dmat4& worldFromNode) {
    if (!isFiniteAsFloat(worldFromNode))
        return std::nullopt;
    const glm::dmat3 axes(glm::mat4{worldFromNode});
    const glm::dmat3 products = glm::transpose(axes) * axes;
    bool isRigid = glm::determinant(axes) > 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            // The squared length of a vector of length 1 + e is off by 2 e.
            isRigid =
                isRigid && std::abs(products[column][row] - (row == column ? 1 : 0)) <= 2 * unitTolerance;
    if (isRigid)
        return glm::mat4(worldFromNode);
    const auto back = normalize(glm::dvec3(worldFromNode[2]));
    const auto up = normalize(glm::dvec3(worldFromNode[1]));
    const auto right = back && up ? normalize(cross(*up, *back)) : std::nullopt;
    if (!right)
        return std::nullopt;
    return glm::mat4(glm::dmat4(glm::dvec4(*right, 0), glm::dvec4(cross(*back, *right), 0),
                                glm::dvec4(*back, 0), worldFromNode[3]));
}

}  // namespace quincunx

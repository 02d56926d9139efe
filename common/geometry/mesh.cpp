#include "geometry/mesh.h"

#include <algorithm>
#include <cmath>

namespace quincunx {

void Bounds::extend(const glm::vec3& point) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z))
        return;
    min = glm::min(min, point);
    max = glm::max(max, point);
}

void Bounds::extend(const Bounds& other) {
    if (other.empty())
        return;
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
}

glm::vec3 Bounds::centre() const {
    if (empty())
        return glm::vec3(0);
    return glm::vec3((glm::dvec3(min) + glm::dvec3(max)) / 2.0);
}

float Bounds::radius() const {
    if (empty())
        return 0;
    // Half of each side is taken first: the diagonal of the largest finite box is sqrt(3) times what a float
    // holds.
    const glm::dvec3 half = (glm::dvec3(max) - glm::dvec3(min)) / 2.0;
    const double length = std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z);
    return static_cast<float>(std::min(length, static_cast<double>(std::numeric_limits<float>::max())));
}

Bounds Mesh::bounds() const {
    Bounds box;
    for (const glm::vec3& position : positions)
        box.extend(position);
    return box;
}

}  // namespace quincunx

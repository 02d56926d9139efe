#include "passes/triangle_order.h"

#include <algorithm>

#include "passes/frame_visibility.h"

namespace quincunx {

bool isConvex(const Mesh& mesh) {
    constexpr std::size_t mostTests = std::size_t{1} << 24;
    const std::size_t triangles = mesh.triangleCount();
    if (triangles != 0 && mesh.positions.size() > mostTests / triangles)
        return false;
    for (std::size_t t = 0; t < triangles; ++t) {
        const auto corner = [&](std::size_t i) {
            return glm::dvec3(mesh.positions[mesh.indices[3 * t + i]]);
        };
        const glm::dvec3 a = corner(0);
        const glm::dvec3 normal = glm::cross(corner(1) - a, corner(2) - a);
        const bool all = std::all_of(mesh.positions.begin(), mesh.positions.end(), [&](const glm::vec3& p) {
            return glm::dot(normal, glm::dvec3(p) - a) <= 0;
        });
        if (!all)
            return false;
    }
    return true;
}

std::vector<std::uint32_t> trianglesFarthestFirst(const Mesh& mesh, const glm::mat4& worldFromModel,
                                                  const glm::vec3& eyeWorld) {
    const glm::dmat3 turn(glm::mat3{worldFromModel});
    const glm::dvec3 towards = glm::dvec3(worldFromModel[3]) - glm::dvec3(eyeWorld);
    std::vector<double> distances(mesh.triangleCount());
    for (std::size_t t = 0; t < distances.size(); ++t) {
        glm::dvec3 sum(0);
        for (std::size_t i = 0; i < 3; ++i)
            sum += glm::dvec3(mesh.positions[mesh.indices[3 * t + i]]);
        const glm::dvec3 centroid = turn * (sum / 3.0) + towards;
        distances[t] = glm::dot(centroid, centroid);
    }
    return farthestFirst(distances);
}

}  // namespace quincunx

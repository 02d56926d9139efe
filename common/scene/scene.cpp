#include "scene/scene.h"

#include "base/check.h"

namespace quincunx {

namespace {

/// The vertices' own bounds in the world: exact, where the box's corners would only be an outer bound.
Bounds worldBounds(const Mesh& mesh, const glm::mat4& worldFromModel) {
    Bounds box;
    if (worldFromModel == glm::mat4(1)) {
        box = mesh.bounds();
    } else {
        const glm::dmat4 matrix(worldFromModel);
        for (const glm::vec3& position : mesh.positions)
            box.extend(glm::vec3(matrix * glm::dvec4(glm::dvec3(position), 1.0)));
    }
    return box;
}

}  // namespace

Bounds Scene::bounds() const {
    Bounds box;
    for (const Instance& instance : instances) {
        QX_CHECK_LT(instance.mesh, meshes.size());
        box.extend(worldBounds(meshes[instance.mesh], instance.worldFromModel));
    }
    return box;
}

std::size_t Scene::triangleCount() const {
    std::size_t count = 0;
    for (const Instance& instance : instances) {
        QX_CHECK_LT(instance.mesh, meshes.size());
        count += meshes[instance.mesh].triangleCount();
    }
    return count;
}

}  // namespace quincunx

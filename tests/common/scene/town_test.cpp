#include "scene/town.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "scene/fingerprint.h"

namespace quincunx {
namespace {

TEST(Town, IsTheSameForTheSameSeedAndAnotherForAnother) {
    EXPECT_EQ(fingerprint(makeTown().scene), fingerprint(makeTown().scene));
    EXPECT_NE(fingerprint(makeTown({.seed = 2}).scene), fingerprint(makeTown().scene));
    EXPECT_EQ(makeTown({.seed = 2}).tour, makeTown().tour);
}

TEST(Town, IsWellFormedForManySeeds) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Town town = makeTown({.seed = seed});
        const Scene& scene = town.scene;
        EXPECT_LE(scene.triangleCount(), 110'000u);
        EXPECT_GE(scene.instances.size(), 500u);
        EXPECT_TRUE(std::is_sorted(town.ground.begin(), town.ground.end()));
        std::set<std::size_t> used;
        for (const Instance& instance : scene.instances) {
            ASSERT_LT(instance.mesh, scene.meshes.size());
            ASSERT_LT(instance.material, scene.materials.size());
            used.insert(instance.mesh);
        }
        EXPECT_EQ(used.size(), scene.meshes.size()) << "meshes that nothing shows";
        for (const Mesh& mesh : scene.meshes) {
            ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
            EXPECT_GE(mesh.triangleCount(), 1u) << mesh.name;
            for (const std::uint32_t index : mesh.indices)
                ASSERT_LT(index, mesh.positions.size()) << mesh.name;
            for (const glm::vec3 normal : mesh.normals)
                ASSERT_NEAR(glm::length(normal), 1, 1e-5) << mesh.name;
        }
        for (const Material& material : scene.materials)
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_GE(material.diffuse[channel], 0) << material.name;
                EXPECT_LE(material.diffuse[channel], 1) << material.name;
            }
    }
}

TEST(Town, TrianglesFaceTheSideOfTheirNormals) {
    const Scene scene = makeTown().scene;
    std::size_t wrong = 0;
    std::size_t all = 0;
    for (const Mesh& mesh : scene.meshes)
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const std::uint32_t* corner = &mesh.indices[i];
            const glm::vec3 plane = glm::cross(mesh.positions[corner[1]] - mesh.positions[corner[0]],
                                               mesh.positions[corner[2]] - mesh.positions[corner[0]]);
            const glm::vec3 normal =
                mesh.normals[corner[0]] + mesh.normals[corner[1]] + mesh.normals[corner[2]];
            wrong += glm::dot(plane, normal) < 0 ? 1 : 0;
            ++all;
        }
    // Where smooth parts end in a sharp fold, the mean of the normals may lean over: none measured.
    EXPECT_EQ(wrong, 0u) << all;
}

TEST(Town, GroundIsLevelWhereTheStreetsAre) {
    const Town town = makeTown();
    for (const std::size_t index : town.ground) {
        const Instance& instance = town.scene.instances[index];
        EXPECT_EQ(instance.worldFromModel, glm::mat4(1)) << instance.name;
        for (const glm::vec3 p : town.scene.meshes[instance.mesh].positions)
            if (std::hypot(p.x, p.z) < townRadius) {
                EXPECT_LE(std::abs(p.y), 0.35) << instance.name;
            }
    }
}

TEST(Town, StreetsAreFreeOfHousesAndTrees) {
    const Town town = makeTown();
    // No corner of what stands there reaches over the lanes of the tour, up to the height of a car.
    for (std::size_t i = 0; i < town.scene.instances.size(); ++i) {
        if (std::binary_search(town.ground.begin(), town.ground.end(), i))
            continue;
        const Instance& instance = town.scene.instances[i];
        if (instance.name.starts_with("car"))
            continue;
        for (const glm::vec3 p : town.scene.meshes[instance.mesh].positions) {
            const glm::dvec3 world(glm::vec3(instance.worldFromModel * glm::vec4(p, 1)));
            if (world.y > 1.5 || world.y < 0.2)
                continue;
            double nearest = 1e9;
            for (std::size_t k = 0; k < town.tour.size(); ++k) {
                const glm::dvec2 a = town.tour[k];
                const glm::dvec2 b = town.tour[(k + 1) % town.tour.size()];
                const glm::dvec2 here(world.x, world.z);
                const double s = glm::clamp(glm::dot(here - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
                nearest = std::min(nearest, glm::length(here - glm::mix(a, b, s)));
            }
            ASSERT_GE(nearest, 1.9) << instance.name << " at " << world.x << ", " << world.z;
        }
    }
}

}  // namespace
}  // namespace quincunx

#include "geometry/mesh_builder.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "geometry/shapes.h"

namespace quincunx {
namespace {

/// Six times the volume that the triangles enclose: positive if they face outwards.
double sixVolumes(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[i]]);
        const glm::dvec3 b(mesh.positions[mesh.indices[i + 1]]);
        const glm::dvec3 c(mesh.positions[mesh.indices[i + 2]]);
        sum += glm::dot(a, glm::cross(b, c));
    }
    return sum;
}

bool normalsFaceOut(const Mesh& mesh) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto p = [&](std::size_t k) { return mesh.positions[mesh.indices[i + k]]; };
        const auto n = [&](std::size_t k) { return mesh.normals[mesh.indices[i + k]]; };
        if (glm::dot(glm::cross(p(1) - p(0), p(2) - p(0)), n(0) + n(1) + n(2)) < 0)
            return false;
    }
    return true;
}

TEST(MeshBuilder, ABoxEnclosesItsVolume) {
    MeshBuilder builder;
    builder.box({1, 2, 3}, {2, 4, 7});
    const Mesh box = builder.take("box");
    EXPECT_EQ(box.triangleCount(), 12u);
    EXPECT_NEAR(sixVolumes(box), 6 * 8, 1e-4);
    EXPECT_TRUE(normalsFaceOut(box));
    EXPECT_TRUE(builder.empty());
    builder.box({1, 2, 3}, {2, 4, 7}, {.inward = true});
    EXPECT_NEAR(sixVolumes(builder.take("room")), -6 * 8, 1e-4);
    builder.box({0, 0, 0}, {1, 1, 1}, {.bottom = false, .back = false});
    EXPECT_EQ(builder.take("open").triangleCount(), 8u);
}

TEST(MeshBuilder, TubesAndColumnsAreClosedAndFaceOut) {
    MeshBuilder builder;
    const std::array bent = {glm::vec3(0), glm::vec3(0, 2, 0), glm::vec3(2, 3, 0), glm::vec3(2, 3, 4)};
    builder.tube(bent, 0.2f, 9);
    const Mesh tube = builder.take("tube");
    EXPECT_GT(sixVolumes(tube), 0);
    EXPECT_TRUE(normalsFaceOut(tube));
    const std::array ring = {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(-1, 0, 0),
                             glm::vec3(0, 0, -1)};
    builder.tube(ring, 0.1f, 6, true);
    EXPECT_GT(std::abs(sixVolumes(builder.take("ring"))), 0);
    // A frustum of many sides: the closed form of the cone's.
    builder.column({5, 1, 2}, 3, 2, 1, 2000, true);
    const Mesh frustum = builder.take("frustum");
    EXPECT_NEAR(sixVolumes(frustum) / 6, std::acos(-1.0) * 3 / 3 * (4 + 2 + 1), 1e-2);
    EXPECT_TRUE(normalsFaceOut(frustum));
    builder.column({0, 0, 0}, 3, 1, 0, 2000, true);
    EXPECT_NEAR(sixVolumes(builder.take("cone")) / 6, std::acos(-1.0), 1e-2);
}

TEST(MeshBuilder, AppendedMeshesFollowTheirPlacement) {
    const Mesh ball = tessellate(Sphere{1}, 24);
    MeshBuilder builder;
    builder.append(ball, glm::translate(glm::mat4(1), {1, 2, 3}) * glm::scale(glm::mat4(1), {1, 2, 3}));
    const Mesh stretched = builder.take("egg");
    EXPECT_NEAR(sixVolumes(stretched), 6 * sixVolumes(ball), 1e-3);
    EXPECT_TRUE(normalsFaceOut(stretched));
    builder.append(ball, glm::scale(glm::mat4(1), {-1, 1, 1}));
    const Mesh mirrored = builder.take("mirrored");
    EXPECT_NEAR(sixVolumes(mirrored), sixVolumes(ball), 1e-4);
    EXPECT_TRUE(normalsFaceOut(mirrored));
}

TEST(Loft, OverCirclesIsACylinder) {
    std::vector<std::vector<glm::vec3>> rings;
    for (int i = 0; i < 5; ++i) {
        std::vector<glm::vec3> ring;
        for (int k = 0; k < 500; ++k) {
            const glm::vec2 p = superellipse(6.2831853f * static_cast<float>(k) / 500, 2, 1, 2);
            ring.emplace_back(p.x, p.y, static_cast<float>(i));
        }
        rings.push_back(std::move(ring));
    }
    const Mesh mesh = loft(rings, true, true, "cylinder");
    EXPECT_NEAR(sixVolumes(mesh) / 6, std::acos(-1.0) * 2 * 4, 1e-2);
    // Closed: every edge lies between two triangles, once in each direction.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k)
            ++edges[{mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    }
}

TEST(Subset, PartsAddUpToTheWhole) {
    const Mesh ball = tessellate(Sphere{1}, 20);
    std::vector<bool> keep(ball.triangleCount());
    for (std::size_t i = 0; i < keep.size(); ++i)
        keep[i] = i % 3 == 0;
    const Mesh one = subset(ball, keep, "one");
    keep.flip();
    const Mesh other = subset(ball, keep, "other");
    EXPECT_EQ(one.triangleCount() + other.triangleCount(), ball.triangleCount());
    EXPECT_NEAR(sixVolumes(one) + sixVolumes(other), sixVolumes(ball), 1e-5);
}

TEST(Superellipse, LiesOnItsCurve) {
    for (const float exponent : {1.0f, 2.0f, 3.5f, 8.0f})
        for (int i = 0; i < 64; ++i) {
            const glm::vec2 p = superellipse(0.1f * static_cast<float>(i), 3, 2, exponent);
            EXPECT_NEAR(std::pow(std::abs(p.x) / 3, exponent) + std::pow(std::abs(p.y) / 2, exponent), 1,
                        1e-5);
        }
}

}  // namespace
}  // namespace quincunx

#include "geometry/tangents.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/shapes.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

Mesh makeTriangle(vec2 a, vec2 b, vec2 c) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.texcoords = {a, b, c};
    mesh.indices = {0, 1, 2};
    return mesh;
}

void expectTangents(const Mesh& mesh, vec4 expected) {
    for (const vec4& tangent : vertexTangents(mesh, mesh.texcoords))
        for (int k = 0; k < 4; ++k)
            EXPECT_NEAR(tangent[k], expected[k], 1e-6);
}

TEST(Tangents, PointAlongGrowingSWithTheBitangentUpInTheImage) {
    // s along x, t down: the usual way up.
    expectTangents(makeTriangle({0, 1}, {1, 1}, {0, 0}), {1, 0, 0, 1});
    // The image mirrored, upside down, turned by a right angle.
    expectTangents(makeTriangle({1, 1}, {0, 1}, {1, 0}), {-1, 0, 0, -1});
    expectTangents(makeTriangle({0, 0}, {1, 0}, {0, 1}), {1, 0, 0, -1});
    expectTangents(makeTriangle({0, 0}, {0, 1}, {1, 0}), {0, 1, 0, 1});
}

TEST(Tangents, DoNotDependOnScale) {
    for (const float scale : {1e-30f, 1.0f, 1e30f}) {
        Mesh mesh = makeTriangle({0, 1}, {1, 1}, {0, 0});
        for (vec3& position : mesh.positions)
            position *= scale;
        for (vec2& st : mesh.texcoords)
            st *= 1 / scale;
        expectTangents(mesh, {1, 0, 0, 1});
    }
}

TEST(Tangents, OfABallRunAlongItsParallels) {
    const Mesh ball = tessellate(Sphere{2}, 64);
    const std::vector<vec4> tangents = vertexTangents(ball, ball.texcoords);
    double worst = 0;
    for (std::size_t v = 0; v < tangents.size(); ++v) {
        const dvec3 n(ball.normals[v]);
        if (std::abs(n.y) > 0.99)  // near its ends the parallels turn within one step
            continue;
        // The texture runs once around, to the east or the west; the same way everywhere.
        const dvec3 east = glm::normalize(glm::cross(dvec3(0, 1, 0), n));
        worst = std::max(worst, 1 - std::abs(glm::dot(east, dvec3(tangents[v]))));
        EXPECT_EQ(tangents[v].w, tangents[ball.positions.size() / 2].w) << v;
    }
    // Chords 2π/64 long around a parallel are off by half of that where only one meets the vertex, at the
    // seam.
    EXPECT_LE(worst, 1 - std::cos(2 * 3.1416 / 64));
}

// Three quarters of the triangles have texture coordinates without an area; 1/(s1 t2 − s2 t1) makes 69 % of
// such tangents NaN.
TEST(Tangents, AreUnitVectorsAcrossTheNormalForEveryInput) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        Mesh mesh =
            makeTriangle(vec2(random.uniform(0, 1), random.uniform(0, 1)), {0.5f, 0.25f}, {0.75f, 0.5f});
        switch (random.below(4)) {
            case 0:
                mesh.texcoords.assign(3, mesh.texcoords[0]);
                break;
            case 1:
                mesh.texcoords[2] = mesh.texcoords[1];
                break;
            case 2:
                mesh.texcoords[0].x = std::nanf("");
                break;
            default:
                break;
        }
        if (random.below(8) == 0)
            mesh.positions[2] = mesh.positions[1];
        if (random.below(8) == 0)
            mesh.normals[1] = vec3(0);
        const vec3 n = glm::normalize(vec3(random.uniform(-1, 1), random.uniform(-1, 1), 1.5));
        mesh.normals[0] = n;
        for (const vec4& tangent : vertexTangents(mesh, mesh.texcoords)) {
            ASSERT_NEAR(glm::length(dvec3(tangent)), 1, 1e-6);
            ASSERT_TRUE(tangent.w == 1 || tangent.w == -1);
        }
        ASSERT_NEAR(glm::dot(dvec3(vertexTangents(mesh, mesh.texcoords)[0]), dvec3(n)), 0, 1e-6);
    }
}

TEST(Tangents, TheLargerShareDecidesBetweenMirroredTriangles) {
    // Two triangles that meet in the edge from (0,0) to (0,1), with the image mirrored at it. At vertex 0 the
    // one on the left has a right angle, the one on the right a smaller one.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {-1, 0, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.texcoords = {{0, 1}, {0, 0}, {1, 0}, {1, 1}};
    mesh.indices = {0, 2, 1, 0, 1, 3};
    const std::vector<vec4> tangents = vertexTangents(mesh, mesh.texcoords);
    EXPECT_NEAR(tangents[0].x, -1, 1e-6);
    EXPECT_EQ(tangents[0].w, -1);
    EXPECT_NEAR(tangents[2].x, 1, 1e-6);
    EXPECT_EQ(tangents[2].w, 1);
    EXPECT_NEAR(tangents[3].x, -1, 1e-6);
}

}  // namespace
}  // namespace quincunx

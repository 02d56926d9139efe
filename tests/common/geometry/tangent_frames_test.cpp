#include "geometry/tangent_frames.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/normals.h"
#include "geometry/shapes.h"

namespace quincunx {
namespace {

/// A square in z = 0 that looks along +z, with an upright picture on it: t grows downwards.
Mesh square() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

void expectFrames(const Mesh& mesh) {
    ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
        const glm::dvec3 tangent(glm::vec3(mesh.tangents[i]));
        // Three components of half an ulp each, 2^-25 sqrt 3 = 5.2e-8; and the same from the normal's
        // rounding.
        EXPECT_NEAR(glm::length(tangent), 1, 1.1e-7);
        EXPECT_NEAR(glm::dot(tangent, glm::dvec3(mesh.normals[i])), 0, 2e-7);
        EXPECT_EQ(std::abs(mesh.tangents[i].w), 1);
    }
}

TEST(TangentFrames, RunAlongSWithTheBitangentUpThePicture) {
    Mesh mesh = square();
    makeTangents(mesh);
    ASSERT_EQ(mesh.positions.size(), 4u);
    for (const glm::vec4& tangent : mesh.tangents)
        EXPECT_EQ(tangent, glm::vec4(1, 0, 0, 1));
    // The bitangent, cross(n, t) w = +y, is where t decreases.
    Mesh turned = square();
    for (glm::vec2& st : turned.texcoords)
        st = {st.y, 1 - st.x};
    makeTangents(turned);
    for (const glm::vec4& tangent : turned.tangents)
        EXPECT_EQ(tangent, glm::vec4(0, -1, 0, 1));
    Mesh mirrored = square();
    for (glm::vec2& st : mirrored.texcoords)
        st.x = 1 - st.x;
    makeTangents(mirrored);
    for (const glm::vec4& tangent : mirrored.tangents)
        EXPECT_EQ(tangent, glm::vec4(-1, 0, 0, -1));
}

TEST(TangentFrames, FollowTheTextureTransformAndTheSet) {
    Mesh mesh = square();
    std::swap(mesh.texcoords, mesh.texcoords1);
    const glm::mat3 mirrorS(-1, 0, 0, 0, 1, 0, 0.5f, 0, 1);
    makeTangents(mesh, 1, mirrorS);
    for (const glm::vec4& tangent : mesh.tangents)
        EXPECT_EQ(tangent, glm::vec4(-1, 0, 0, -1));
    EXPECT_EQ(mesh.texcoords1, square().texcoords);
    // The other set says nothing: still frames.
    makeTangents(mesh, 0);
    expectFrames(mesh);
}

TEST(TangentFrames, OfASphereFollowItsCirclesOfLatitude) {
    Mesh mesh = tessellate(Shape(Sphere{1}), 48);
    const std::size_t before = mesh.positions.size();
    makeTangents(mesh);
    expectFrames(mesh);
    EXPECT_EQ(mesh.positions.size(), before) << "nothing is mirrored on a sphere";
    double worst = 1;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dvec3 p(mesh.positions[i]);
        const glm::dvec3 around(p.z, 0, -p.x);  // from +z over +x
        if (glm::length(around) > 0.2)
            worst =
                std::min(worst, glm::dot(glm::normalize(around), glm::dvec3(glm::vec3(mesh.tangents[i]))));
    }
    // Chords of 7.5°, each side of the seam with its own half; measured 0.997.
    EXPECT_GT(worst, 0.99);
}

TEST(TangentFrames, VerticesBetweenMirroredHalvesBecomeTwo) {
    // The right half shows the picture of the left one, mirrored.
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(6, glm::vec3(0, 0, 1));
    mesh.texcoords = {{0, 1}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {0, 0}};
    mesh.colors.assign(6, glm::vec4(0.5f));
    mesh.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    const Mesh original = mesh;
    makeTangents(mesh);
    expectFrames(mesh);
    EXPECT_EQ(mesh.positions.size(), 8u);
    EXPECT_EQ(mesh.colors.size(), 8u);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        EXPECT_EQ(mesh.positions[mesh.indices[i]], original.positions[original.indices[i]]);
        EXPECT_EQ(mesh.texcoords[mesh.indices[i]], original.texcoords[original.indices[i]]);
        const glm::vec4 expected = i < 6 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1);
        EXPECT_EQ(mesh.tangents[mesh.indices[i]], expected);
    }
}

/// (Δt2 e1 − Δt1 e2) / (Δs1 Δt2 − Δs2 Δt1), in float.
glm::vec3 textbookTangent(const glm::vec3& e1, const glm::vec3& e2, glm::vec2 st1, glm::vec2 st2) {
    const float f = 1.0f / (st1.x * st2.y - st2.x * st1.y);
    return f * (st2.y * e1 - st1.y * e2);
}

TEST(TangentFrames, AreUnitVectorsWhereThreeQuartersOfTheTrianglesSayNothing) {
    // The textbook's quotient is not a number, or infinite, for most of them.
    Random random(97);
    const auto coordinate = [&] { return static_cast<float>(random.uniform(-1, 1)); };
    Mesh mesh;
    int naiveFailures = 0;
    const int triangles = 20'000;
    for (int t = 0; t < triangles; ++t) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (int c = 0; c < 3; ++c) {
            mesh.positions.emplace_back(coordinate(), coordinate(), coordinate());
            mesh.texcoords.emplace_back(coordinate(), coordinate());
            mesh.indices.push_back(first + static_cast<std::uint32_t>(c));
        }
        glm::vec2* const st = &mesh.texcoords[first];
        if (t % 4 == 1)
            st[1] = st[2] = st[0];
        else if (t % 4 == 2)
            st[2] = st[1];
        else if (t % 4 == 3)
            st[1].y = st[2].y = st[0].y;
        if (t % 40 == 4)
            mesh.positions[first + 2] = mesh.positions[first + 1];
        if (t % 40 == 8)
            st[0].x = std::nanf("");
        if (t % 40 == 12)
            for (std::uint32_t c = 0; c < 3; ++c)
                mesh.positions[first + c] *= t % 80 == 12 ? 1e-38f : 1e38f;
        const glm::vec3 naive =
            textbookTangent(mesh.positions[first + 1] - mesh.positions[first],
                            mesh.positions[first + 2] - mesh.positions[first], st[1] - st[0], st[2] - st[0]);
        const float length = glm::length(naive);
        naiveFailures += !(length > 0 && std::isfinite(length));
    }
    makeFlatNormals(mesh);
    makeTangents(mesh);
    expectFrames(mesh);
    // Measured: 15 769.
    EXPECT_GT(naiveFailures, triangles / 2);
}

}  // namespace
}  // namespace quincunx

#include "geometry/mesh.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/normals.h"
#include "geometry/polygon.h"

namespace quincunx {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float largest = std::numeric_limits<float>::max();

TEST(Bounds, OfNothingIsEmptyAtTheOrigin) {
    const Bounds box;
    EXPECT_TRUE(box.empty());
    EXPECT_EQ(box.centre(), glm::vec3(0));
    EXPECT_EQ(box.radius(), 0);
}

TEST(Bounds, LeaveOutPointsThatAreNotFinite) {
    Bounds box;
    box.extend({nan, 0, 0});
    box.extend({0, inf, 0});
    box.extend({0, 0, -inf});
    EXPECT_TRUE(box.empty());
    box.extend({-3, -2, -1});
    EXPECT_EQ(box.min, box.max);
    box.extend(Bounds{});
    EXPECT_EQ(box.min, glm::vec3(-3, -2, -1));
}

TEST(Bounds, OfAllFloatsDoNotOverflow) {
    Bounds box;
    box.extend(glm::vec3(-largest));
    box.extend(glm::vec3(largest));
    EXPECT_EQ(box.centre(), glm::vec3(0));
    EXPECT_EQ(box.radius(), largest);
    Bounds high;
    high.extend(glm::vec3(largest));
    EXPECT_EQ(high.centre(), glm::vec3(largest));
}

/// A sphere cut into triangles, with positions shared.
Mesh sphere(int rings, int segments, float radius, const glm::vec3& centre) {
    Mesh mesh;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const double theta = M_PI * r / rings;
            const double phi = 2 * M_PI * s / segments;
            mesh.positions.push_back(centre + radius * glm::vec3(std::sin(theta) * std::sin(phi),
                                                                 std::cos(theta),
                                                                 std::sin(theta) * std::cos(phi)));
        }
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const auto a = static_cast<std::uint32_t>(r * segments + s);
            const auto b = static_cast<std::uint32_t>(r * segments + (s + 1) % segments);
            const auto c = a + static_cast<std::uint32_t>(segments);
            const auto d = b + static_cast<std::uint32_t>(segments);
            mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
        }
    return mesh;
}

TEST(SmoothNormals, OfASpherePointOutwardAtEveryScale) {
    for (const float radius : {1e-38f, 1e-20f, 1e-6f, 1.0f, 1e6f, 1e20f, 1e38f}) {
        Mesh mesh = sphere(64, 128, radius, glm::vec3(0));
        makeSmoothNormals(mesh);
        double worst = 1;
        // The poles are rings of coinciding points with a few triangles each; they see only their own part.
        for (std::size_t i = 128; i < mesh.positions.size() - 128; ++i) {
            const glm::dvec3 outward =
                glm::normalize(glm::dvec3(mesh.positions[i]) / static_cast<double>(radius));
            worst = std::min(worst, glm::dot(outward, glm::dvec3(mesh.normals[i])));
        }
        // Measured: 1 - 1.0e-7 at every scale, from the uneven cut of the rings.
        EXPECT_GT(worst, 1 - 1.5e-7) << radius;
    }
}

TEST(SmoothNormals, OfACubeDoNotDependOnHowItsSidesAreCut) {
    // Angle weights: every corner sees three right angles, whichever diagonals are cut.
    for (int cut = 0; cut < 64; ++cut) {
        Mesh mesh;
        for (int i = 0; i < 8; ++i)
            mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
        const std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        for (int s = 0; s < 6; ++s) {
            const std::uint32_t* q = sides[s];
            if (cut >> s & 1)
                mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
            else
                mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[3], q[1], q[2], q[3]});
        }
        makeSmoothNormals(mesh);
        for (std::size_t i = 0; i < 8; ++i)
            for (int axis = 0; axis < 3; ++axis)
                // Exactly 1/sqrt(3) but for the rounding of angles and the final one.
                EXPECT_NEAR(mesh.normals[i][axis] * mesh.positions[i][axis], 1 / std::sqrt(3.0), 1e-7);
    }
}

TEST(SmoothNormals, AreUnitAndFiniteForAnyFinitePositions) {
    Random random(7);
    for (int round = 0; round < 200; ++round) {
        Mesh mesh;
        for (int i = 0; i < 30; ++i) {
            glm::vec3 p;
            for (int axis = 0; axis < 3; ++axis) {
                const double exponent = random.uniform(-149, 127);
                p[axis] = static_cast<float>(std::exp2(exponent) * (random.bits() & 1 ? 1 : -1));
                if (random.below(8) == 0)
                    p[axis] = 0;
                if (random.below(16) == 0)
                    p[axis] = largest;
            }
            mesh.positions.push_back(p);
        }
        for (int i = 0; i < 60; ++i)
            mesh.indices.push_back(static_cast<std::uint32_t>(random.below(30)));
        makeSmoothNormals(mesh);
        Mesh flat = mesh;
        makeFlatNormals(flat);
        for (const auto* normals : {&mesh.normals, &flat.normals})
            for (const glm::vec3& n : *normals)
                // Three components rounded once each, by at most 2^-25: sqrt(3) · 2^-25 = 5.2e-8.
                ASSERT_NEAR(glm::length(glm::dvec3(n)), 1, 5.2e-8);
    }
}

TEST(SmoothNormals, HaveADefinedAnswerWhereThereIsNone) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}};
    // The first three from both sides, a triangle without area, and a lone vertex.
    mesh.indices = {0, 1, 2, 0, 2, 1, 4, 5, 6};
    makeSmoothNormals(mesh);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(mesh.normals[i], glm::vec3(0, 0, 1)) << "the first triangle's, where the sum cancels";
    for (std::size_t i = 3; i < 7; ++i)
        EXPECT_EQ(mesh.normals[i], glm::vec3(0, 0, 1));
    std::swap(mesh.indices[1], mesh.indices[2]);
    std::swap(mesh.indices[4], mesh.indices[5]);
    makeSmoothNormals(mesh);
    EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, -1));
}

TEST(FlatNormals, AreThoseOfTheTrianglesPlanes) {
    Mesh mesh = sphere(8, 8, 1, glm::vec3(3, -2, 1));
    const std::size_t triangles = mesh.triangleCount();
    mesh.texcoords.resize(mesh.positions.size());
    makeFlatNormals(mesh);
    ASSERT_EQ(mesh.triangleCount(), triangles);
    ASSERT_EQ(mesh.positions.size(), 3 * triangles);
    ASSERT_EQ(mesh.texcoords.size(), 3 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const glm::vec3 n = mesh.normals[3 * t];
        EXPECT_EQ(n, mesh.normals[3 * t + 1]);
        EXPECT_EQ(n, mesh.normals[3 * t + 2]);
        if (triangleNormal(mesh.positions[3 * t], mesh.positions[3 * t + 1], mesh.positions[3 * t + 2]) ==
            glm::dvec3(0)) {
            EXPECT_EQ(n, glm::vec3(0, 0, 1)) << "at the poles, where corners coincide";
            continue;
        }
        const glm::dvec3 edge = glm::dvec3(mesh.positions[3 * t + 1]) - glm::dvec3(mesh.positions[3 * t]);
        // The normal is rounded to floats: 2^-24 a component.
        EXPECT_NEAR(glm::dot(glm::dvec3(n), edge), 0, 1.2e-7);
    }
}

double doubledArea(std::span<const glm::vec3> corners, std::span<const std::uint32_t> triangle) {
    const glm::dvec3 a(corners[triangle[0]]);
    const glm::dvec3 b(corners[triangle[1]]);
    const glm::dvec3 c(corners[triangle[2]]);
    return glm::cross(b - a, c - a).z;
}

/// Doubled area of a polygon in the plane z = 0.
double doubledArea(std::span<const glm::vec3> corners) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a(corners[i]);
        const glm::dvec3 b(corners[(i + 1) % corners.size()]);
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

TEST(Polygon, ConcaveOnesAreCoveredOnceByTrianglesOfTheirOwnOrientation) {
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        // Star-shaped about the origin, so it does not cross itself.
        const std::size_t n = 4 + random.below(60);
        std::vector<glm::vec3> corners;
        for (std::size_t i = 0; i < n; ++i) {
            const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(n);
            const double radius = random.uniform(0.1, 1);
            corners.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
        }
        if (round % 2)
            std::reverse(corners.begin(), corners.end());
        std::vector<std::uint32_t> triangles(3 * (n - 2));
        ASSERT_TRUE(triangulatePolygon(corners, triangles));
        const double whole = doubledArea(corners);
        double sum = 0;
        for (std::size_t t = 0; t < triangles.size(); t += 3) {
            const double part = doubledArea(corners, std::span(triangles).subspan(t, 3));
            // Same orientation everywhere and areas that add up: each point is covered once.
            EXPECT_GE(part * whole, 0);
            sum += part;
        }
        // Sums of at most 64 doubles of size at most 2.
        EXPECT_NEAR(sum, whole, 1e-13);
    }
}

TEST(Polygon, QuadrilateralsAreCutInside) {
    const std::vector<glm::vec3> arrow{{0, 0, 0}, {2, 0.1f, 0}, {0.5f, 0.5f, 0}, {0.1f, 2, 0}};
    for (std::size_t turn = 0; turn < 4; ++turn) {
        std::vector<glm::vec3> corners = arrow;
        std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(turn), corners.end());
        std::vector<std::uint32_t> triangles(6);
        ASSERT_TRUE(triangulatePolygon(corners, triangles));
        EXPECT_GT(doubledArea(corners, std::span(triangles).first(3)), 0);
        EXPECT_GT(doubledArea(corners, std::span(triangles).last(3)), 0);
    }
}

TEST(Polygon, WithoutAreaOrCrossingItselfIsStillCutIntoAllItsTriangles) {
    const std::vector<std::vector<glm::vec3>> polygons{
        {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 0, 0}},
        {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},
        {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
        {{0, 0, 0}, {largest, 0, 0}, {largest, largest, 0}, {0, largest, 0}, {-largest, 1, 0}}};
    for (const auto& corners : polygons) {
        std::vector<std::uint32_t> triangles(3 * (corners.size() - 2), 99);
        triangulatePolygon(corners, triangles);
        for (const std::uint32_t corner : triangles)
            EXPECT_LT(corner, corners.size());
    }
}

TEST(Polygon, OfManyTeethIsCutInBoundedWork) {
    // A comb has a reflex corner between any two ears; unbounded ear clipping is cubic on 200 000 corners.
    std::vector<glm::vec3> corners;
    const int teeth = 100'000;
    for (int i = 0; i < teeth; ++i) {
        corners.push_back({static_cast<float>(i), 1, 0});
        corners.push_back(
            {static_cast<float>(i) + 0.5f, i % 7 ? 0.001f * static_cast<float>(i % 5) : -1.0f, 0});
    }
    corners.push_back({static_cast<float>(teeth), -100, 0});
    corners.push_back({0, -100, 0});
    std::vector<std::uint32_t> triangles(3 * (corners.size() - 2), 0xffffffffu);
    triangulatePolygon(corners, triangles);
    for (const std::uint32_t corner : triangles)
        ASSERT_LT(corner, corners.size());
}

}  // namespace
}  // namespace quincunx

#include "geometry/ray_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "geometry/predicates.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/common/geometry/rational.h"

namespace quincunx {
namespace {

using oracle::Rational;

std::string text(glm::vec3 v) {
    return fmt::format("({:a},{:a},{:a})", v.x, v.y, v.z);
}

std::string text(const Ray& ray, const Triangle& triangle) {
    return fmt::format("o={} d={} a={} b={} c={}", text(ray.origin), text(ray.direction), text(triangle.a),
                       text(triangle.b), text(triangle.c));
}

struct Worst {
    double t = 0;       // relative
    double weight = 0;  // absolute
    double point = 0;   // excess over 0.501 ulp, in longest edges
};

/// Expects the very hit of rational arithmetic within the bounds of the header.
void expectExact(const Ray& ray, const Triangle& triangle, Worst& worst, Sides sides = Sides::both,
                 RayInterval interval = {}) {
    const auto exact = oracle::rayHit(ray, triangle, interval);
    const bool expected = exact && (sides == Sides::both || exact->front);
    for (const bool byOracle : {false, true}) {
        const auto hit = byOracle ? intersectTriangleOracle(ray, triangle, sides, interval)
                                  : intersectTriangle(ray, triangle, sides, interval);
        ASSERT_EQ(hit.has_value(), expected) << byOracle << " " << text(ray, triangle);
        if (!hit)
            continue;
        EXPECT_EQ(hit->front, exact->front);
        if (exact->t == 0) {
            EXPECT_EQ(hit->t, 0);
        } else {
            const double error =
                std::abs(static_cast<double>(Rational((Rational(hit->t) - exact->t) / exact->t)));
            EXPECT_LE(error, 0x1p-34) << text(ray, triangle);
            worst.t = std::max(worst.t, error);
        }
        const double length =
            std::sqrt(std::max({glm::dot(glm::dvec3(triangle.b) - glm::dvec3(triangle.a),
                                         glm::dvec3(triangle.b) - glm::dvec3(triangle.a)),
                                glm::dot(glm::dvec3(triangle.c) - glm::dvec3(triangle.a),
                                         glm::dvec3(triangle.c) - glm::dvec3(triangle.a)),
                                glm::dot(glm::dvec3(triangle.c) - glm::dvec3(triangle.b),
                                         glm::dvec3(triangle.c) - glm::dvec3(triangle.b))}));
        const std::array<Rational, 3> point = {exact->point.x, exact->point.y, exact->point.z};
        for (int i = 0; i < 3; ++i) {
            const auto index = static_cast<std::size_t>(i);
            const double error = std::abs(static_cast<double>(
                Rational(Rational(static_cast<double>(hit->weights[i])) - exact->weights[i])));
            EXPECT_LE(error, 3.1e-8) << text(ray, triangle);
            worst.weight = std::max(worst.weight, error);
            EXPECT_GE(hit->weights[i], 0);
            EXPECT_LE(hit->weights[i], 1);
            const double ulp =
                std::scalbn(1.0, std::max(std::ilogb(static_cast<double>(abs(point[index]))), -126) - 23);
            const double off = std::abs(
                static_cast<double>(Rational(Rational(static_cast<double>(hit->point[i])) - point[index])));
            EXPECT_LE(off, 0.501 * ulp + 0x1p-28 * length) << text(ray, triangle);
            worst.point = std::max(worst.point, (off - 0.501 * ulp) / length);
        }
    }
}

TEST(RayTriangle, AgreesWithRationalArithmeticOnAllSmallGrids) {
    // All triangles with corners in {0, 1, 2}² × {0, 1}, up to translation none skipped, against rays from a
    // point off the grid and from points on it: touching, edge-on, degenerate, behind.
    Worst worst;
    std::uint64_t hits = 0;
    const auto corner = [](int i) {
        return glm::vec3(static_cast<float>(i % 3), static_cast<float>(i / 3 % 3), static_cast<float>(i / 9));
    };
    const std::array<Ray, 6> rays = {
        Ray{{1, 1, 3}, {0, 0, -1}},      Ray{{0, 0, -1}, {1, 1, 1}},
        Ray{{1, 1, 1}, {-1, 0, -1}},     Ray{{-1, 1, 0}, {3, 0, 0}},
        Ray{{3, 3, 1.5f}, {-2, -2, -1}}, Ray{{0.5f, 0.25f, 2}, {0.125f, 0.5f, -2}}};
    for (int a = 0; a < 18; ++a)
        for (int b = 0; b < 18; ++b)
            for (int c = 0; c < 18; ++c)
                for (const Ray& ray : rays) {
                    const Triangle triangle{corner(a), corner(b), corner(c)};
                    expectExact(ray, triangle, worst);
                    hits += intersectTriangle(ray, triangle) ? 1 : 0;
                }
    EXPECT_GT(hits, 1000u);
}

TEST(RayTriangle, AgreesWithRationalArithmeticNearEdgesAndCorners) {
    StressInputs draw(41);
    Worst worst;
    for (int i = 0; i < 6000; ++i) {
        // Triangles from needles to fair ones, near and far, at 2^-60 … 2^60, and rays at a corner, an edge,
        // the inside, or beside, with directions of 2^-20 … 2^20.
        const double scale = draw.magnitude(-60, 60);
        const glm::dvec3 centre = draw.magnitude(-8, 12) * draw.direction();
        const glm::dvec3 x = draw.direction();
        const glm::dvec3 y = draw.magnitude(-20, 0) * draw.perpendicular(x);
        const Triangle triangle{glm::vec3(scale * centre), glm::vec3(scale * (centre + x)),
                                glm::vec3(scale * (centre + draw.random().uniform(0, 1) * x + y))};
        const glm::dvec3 a(triangle.a);
        const glm::dvec3 b(triangle.b);
        const glm::dvec3 c(triangle.c);
        const double s = draw.random().uniform(0, 1);
        const double r = draw.random().uniform(-0.2, 1);
        const glm::dvec3 target = i % 4 == 0   ? a
                                  : i % 4 == 1 ? glm::mix(b, c, s)
                                               : glm::mix(a, glm::mix(b, c, s), r);
        const glm::vec3 origin(scale * draw.magnitude(-4, 12) * draw.direction());
        const Ray ray{origin, glm::vec3((target - glm::dvec3(origin)) / scale * draw.magnitude(-20, 20))};
        expectExact(ray, triangle, worst);
        expectExact(ray, triangle, worst, Sides::front);
    }
    std::printf("t %.3g (bound %.3g), weights %.4g (3.1e-8), point %.3g edges (%.3g)\n", worst.t, 0x1p-34,
                worst.weight, worst.point, 0x1p-28);
}

TEST(RayTriangle, IsDecidedTheSameByEveryForm) {
    StressInputs draw(42);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Triangle t{draw.vectorOfMagnitude(-3, 3), draw.vectorOfMagnitude(-3, 3),
                         draw.vectorOfMagnitude(-3, 3)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-4, 4);
        const double s = draw.random().uniform(0, 1);
        const glm::vec3 direction(glm::mix(glm::dvec3(t.b), glm::dvec3(t.c), s) - glm::dvec3(origin));
        const auto hit = intersectTriangle({origin, direction}, t);
        const auto sheared = ShearedRay({origin, direction}).intersect(t);
        ASSERT_EQ(hit.has_value(), sheared.has_value());
        // From any corner, and from the other side.
        const auto turned = intersectTriangle({origin, direction}, {t.b, t.c, t.a});
        const auto flipped = intersectTriangle({origin, direction}, {t.a, t.c, t.b});
        ASSERT_EQ(turned.has_value(), hit.has_value());
        ASSERT_EQ(flipped.has_value(), hit.has_value());
        // Mirrored.
        const auto mirror = [](glm::vec3 v) { return glm::vec3(-v.x, v.y, v.z); };
        const auto mirrored =
            intersectTriangle({mirror(origin), mirror(direction)}, {mirror(t.a), mirror(t.b), mirror(t.c)});
        ASSERT_EQ(mirrored.has_value(), hit.has_value());
        // Everything at another scale, the direction at a third.
        const float scale = 0x1p-40f;
        const auto scaled =
            intersectTriangle({scale * origin, 0x1p30f * direction}, {scale * t.a, scale * t.b, scale * t.c});
        ASSERT_EQ(scaled.has_value(), hit.has_value());
        if (!hit)
            continue;
        ++hits;
        constexpr double bound = 0x1p-33;
        EXPECT_EQ(turned->front, hit->front);
        EXPECT_EQ(flipped->front, !hit->front);
        EXPECT_EQ(mirrored->front, !hit->front);
        EXPECT_LE(std::abs(sheared->t - hit->t), bound * hit->t);
        EXPECT_LE(std::abs(turned->t - hit->t), bound * hit->t);
        EXPECT_LE(std::abs(flipped->t - hit->t), bound * hit->t);
        EXPECT_EQ(mirrored->t, hit->t);
        EXPECT_EQ(mirrored->point, mirror(hit->point));
        EXPECT_EQ(scaled->t * 0x1p70, hit->t);
        EXPECT_EQ(scaled->weights, hit->weights);
        EXPECT_LE(std::abs(turned->weights.x - hit->weights.y), 6.2e-8);
    }
    EXPECT_GT(hits, 5000);
}

// Coordinates of few bits move exactly, and so do the answers.
TEST(RayTriangle, MovesWithEverything) {
    StressInputs draw(43);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto few = [&] {
            const auto one = [&] { return static_cast<float>(draw.random().below(64)); };
            return glm::vec3(one(), one(), one());
        };
        const Triangle t{few(), few(), few()};
        const glm::vec3 origin = few();
        const Ray ray{origin, i % 2 == 0 ? t.b - origin : few() - origin};
        const glm::vec3 shift(0x1p17f, -0x1p18f, 0x1p16f);
        const auto hit = intersectTriangle(ray, t);
        const auto moved =
            intersectTriangle({ray.origin + shift, ray.direction}, {t.a + shift, t.b + shift, t.c + shift});
        ASSERT_EQ(moved.has_value(), hit.has_value());
        if (!hit)
            continue;
        ++hits;
        EXPECT_LE(std::abs(moved->t - hit->t), 0x1p-33 * hit->t);
        EXPECT_EQ(moved->front, hit->front);
    }
    EXPECT_GT(hits, 5000);
}

TEST(RayTriangle, MeetsBothTrianglesOfAnEdgeItMeets) {
    // Integer coordinates: the ray at the middle of the shared edge meets it exactly.
    StressInputs draw(44);
    for (int i = 0; i < 20000; ++i) {
        const auto even = [&] {
            const auto one = [&] { return 2 * static_cast<float>(draw.random().below(1 << 16)); };
            return glm::vec3(one(), one(), one());
        };
        const glm::vec3 a = even();
        const glm::vec3 b = even();
        const Triangle left{a, b, even()};
        const Triangle right{b, a, even()};
        const glm::vec3 middle = 0.5f * (a + b);
        const glm::vec3 origin = even();
        const Ray ray{origin, middle - origin};
        const auto first = intersectTriangle(ray, left);
        const auto second = intersectTriangle(ray, right);
        const bool firstEdgeOn = orientation(left.a, left.b, left.c, origin) == 0;
        const bool secondEdgeOn = orientation(right.a, right.b, right.c, origin) == 0;
        ASSERT_EQ(first.has_value(), !firstEdgeOn);
        ASSERT_EQ(second.has_value(), !secondEdgeOn);
        if (first) {
            EXPECT_EQ(first->weights, glm::vec3(0.5f, 0.5f, 0));
            EXPECT_EQ(first->point, middle);
            EXPECT_LE(std::abs(first->t - 1), 0x1p-34);
        }
    }
}

TEST(RayTriangle, CountsHitsWithinTheIntervalEndsIncluded) {
    const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Ray ray{{0.25f, 0.25f, 3}, {0, 0, -2}};  // t = 3/2
    const float inf = std::numeric_limits<float>::infinity();
    const auto meets = [&](float tMin, float tMax) {
        return intersectTriangle(ray, t, Sides::both, {tMin, tMax}).has_value();
    };
    EXPECT_TRUE(meets(1.5f, 1.5f));
    EXPECT_TRUE(meets(-inf, inf));
    EXPECT_TRUE(meets(1, 2));
    EXPECT_FALSE(meets(std::nextafter(1.5f, 2.0f), inf));
    EXPECT_FALSE(meets(0, std::nextafter(1.5f, 1.0f)));
    EXPECT_FALSE(meets(inf, inf));
    EXPECT_FALSE(meets(-inf, -inf));
    // t = 1/3 lies between floats.
    const Ray third{{0.25f, 0.25f, 1}, {0, 0, -3}};
    EXPECT_TRUE(intersectTriangle(third, t, Sides::both, {0.33333331f, 0.33333334f}));
    EXPECT_FALSE(intersectTriangle(third, t, Sides::both, {0.33333334f, 1}));
    EXPECT_FALSE(intersectTriangle(third, t, Sides::both, {0, 0.33333331f}));
    // Behind, and on the triangle.
    EXPECT_FALSE(intersectTriangle({ray.origin, -ray.direction}, t));
    EXPECT_TRUE(intersectTriangle({ray.origin, -ray.direction}, t, Sides::both, {-2, 0}));
    EXPECT_TRUE(intersectTriangle({{0.25f, 0.25f, 0}, {1, 1, -1}}, t));
    EXPECT_TRUE(intersectTriangle({{0.25f, 0.25f, 0}, {1, 1, -1}}, t, Sides::both, {0, 0}));
    EXPECT_FALSE(intersectTriangle({{0.25f, 0.25f, -0x1p-149f}, {0, 0, -1}}, t));
    EXPECT_TRUE(intersectTriangle({{0.25f, 0.25f, 0x1p-149f}, {0, 0, -1}}, t));
}

TEST(RayTriangle, IntervalsAreExactForAnyHit) {
    StressInputs draw(45);
    Worst worst;
    for (int i = 0; i < 500; ++i) {
        const Triangle t{draw.vectorOfMagnitude(-3, 3), draw.vectorOfMagnitude(-3, 3),
                         draw.vectorOfMagnitude(-3, 3)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-4, 4);
        const glm::dvec3 inside = (glm::dvec3(t.a) + glm::dvec3(t.b) + glm::dvec3(t.c)) / 3.0;
        const Ray ray{origin, glm::vec3(draw.magnitude(-10, 10) * (inside - glm::dvec3(origin)))};
        const auto hit = intersectTriangle(ray, t);
        ASSERT_TRUE(hit);
        const auto nearest = static_cast<float>(hit->t);
        for (const float limit : {nearest, std::nextafter(nearest, 0.0f), std::nextafter(nearest, 1e30f)}) {
            expectExact(ray, t, worst, Sides::both, {limit, 1e30f});
            expectExact(ray, t, worst, Sides::both, {-1, limit});
        }
    }
}

TEST(RayTriangle, KeepsToTheFrontWhenAsked) {
    const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Ray down{{0.25f, 0.25f, 1}, {0, 0, -1}};
    const Ray up{{0.25f, 0.25f, -1}, {0, 0, 1}};
    EXPECT_TRUE(intersectTriangle(down, t, Sides::front));
    EXPECT_FALSE(intersectTriangle(up, t, Sides::front));
    EXPECT_TRUE(intersectTriangle(down, t)->front);
    EXPECT_FALSE(intersectTriangle(up, t)->front);
    // Also through a corner, where the exact way decides.
    EXPECT_TRUE(intersectTriangle({{0, 0, 1}, {0, 0, -1}}, t, Sides::front));
    EXPECT_FALSE(intersectTriangle({{0, 0, -1}, {0, 0, 1}}, t, Sides::front));
}

TEST(RayTriangle, HasNoAnswerForDegenerateInput) {
    const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Ray ray{{0.25f, 0.25f, 1}, {0, 0, -1}};
    const float inf = std::numeric_limits<float>::infinity();
    const auto none = [](const Ray& r, const Triangle& one) {
        return !intersectTriangle(r, one) && !ShearedRay(r).intersect(one) &&
               !intersectTriangleOracle(r, one);
    };
    ASSERT_FALSE(none(ray, t));
    EXPECT_TRUE(none({ray.origin, glm::vec3(0)}, t));
    EXPECT_TRUE(none({ray.origin, glm::vec3(-0.0f)}, t));
    EXPECT_TRUE(none({ray.origin, {0, 0, -inf}}, t));
    EXPECT_TRUE(none({ray.origin, {0, NAN, -1}}, t));
    EXPECT_TRUE(none({{0.25f, inf, 1}, ray.direction}, t));
    EXPECT_TRUE(none(ray, {{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}}));
    EXPECT_TRUE(none(ray, {{0, 0, 0}, {inf, 0, 0}, {0, inf, 0}}));
    EXPECT_TRUE(none({{0, 0, 1}, {0, 0, -1}}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
    EXPECT_TRUE(none({{0.5f, 0, 1}, {0, 0, -1}}, {{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}}));
    EXPECT_TRUE(none({{-1, 0.25f, 0}, {1, 0, 0}}, t));  // in its plane
    EXPECT_TRUE(none({{-1, 0, 0}, {1, 0, 0}}, t));      // along an edge
}

TEST(RayTriangle, ReachesTheEndsOfTheRange) {
    const float most = std::numeric_limits<float>::max();
    const float least = std::numeric_limits<float>::denorm_min();
    Worst worst;
    // The smallest triangle there is, and the largest.
    const Triangle tiny{{0, 0, 0}, {least, 0, 0}, {0, least, 0}};
    const Triangle huge{{-most, -most, 0}, {most, -most, 0}, {0, most, 0}};
    for (const float length : {least, 1.0f, most}) {
        for (const float far : {least, 1.0f, most}) {
            expectExact({{0, 0, far}, {0, 0, -length}}, tiny, worst);
            expectExact({{0, 0, far}, {0, 0, -length}}, huge, worst);
            EXPECT_TRUE(intersectTriangle({{0, 0, far}, {0, 0, -length}}, tiny));
            EXPECT_TRUE(intersectTriangle({{0, 0, far}, {0, 0, -length}}, huge));
        }
    }
    EXPECT_FALSE(intersectTriangle({{least, least, 1}, {0, 0, -1}}, tiny));
    StressInputs draw(46);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        // Any bits at all; every other time through the origin, where there are hits.
        const glm::vec3 a = draw.finiteVector();
        const glm::vec3 direction = draw.finiteVector();
        const Ray ray{i % 2 == 0 ? -direction : draw.finiteVector(), direction};
        const Triangle any{a, draw.finiteVector(), i % 2 == 0 ? -a : draw.finiteVector()};
        expectExact(ray, any, worst);
        hits += intersectTriangle(ray, any) ? 1 : 0;
    }
    EXPECT_GT(hits, 100);
}

TEST(RayQuad, IsTwoTrianglesThatMeet) {
    StressInputs draw(47);
    int first = 0;
    int second = 0;
    for (int i = 0; i < 5000; ++i) {
        // Convex seen from above, not flat.
        const auto about = [&](double x, double y) {
            return glm::vec3(x + draw.random().uniform(-0.3, 0.3), y + draw.random().uniform(-0.3, 0.3),
                             draw.random().uniform(-0.3, 0.3));
        };
        const std::array<glm::vec3, 4> corners = {about(-1, -1), about(1, -1), about(1, 1), about(-1, 1)};
        const double s = draw.random().uniform(0, 1);
        // At the diagonal, or anywhere.
        const glm::dvec3 target =
            i % 2 == 0 ? glm::mix(glm::dvec3(corners[0]), glm::dvec3(corners[2]), s)
                       : glm::dvec3(draw.random().uniform(-0.5, 0.5), draw.random().uniform(-0.5, 0.5), 0);
        const glm::vec3 origin(target + glm::dvec3(draw.random().uniform(-1, 1), 0.5, 5));
        const Ray ray{origin, glm::vec3(target - glm::dvec3(origin))};
        const auto hit = intersectQuadrilateral(ray, corners);
        ASSERT_TRUE(hit) << i;
        (hit->secondTriangle ? second : first) += 1;
        const Triangle triangle = hit->secondTriangle ? Triangle{corners[0], corners[2], corners[3]}
                                                      : Triangle{corners[0], corners[1], corners[2]};
        EXPECT_EQ(ShearedRay(ray).intersect(triangle)->t, hit->hit.t);
        EXPECT_FALSE(intersectQuadrilateral({ray.origin, -ray.direction}, corners));
        EXPECT_EQ(intersectQuadrilateral(ray, corners, Sides::front).has_value(), hit->hit.front);
    }
    EXPECT_GT(first, 1000);
    EXPECT_GT(second, 1000);
}

// Naive forms are right where there is nothing hard.
TEST(RayTriangle, NaiveFormsMeetAFairTriangle) {
    const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Ray inside{{0.25f, 0.5f, 3}, {0, 0, -2}};
    const Ray outside{{0.75f, 0.5f, 3}, {0, 0, -2}};
    const Ray behind{{0.25f, 0.5f, -3}, {0, 0, -2}};
    const auto check = [&](const auto& intersect) {
        const auto hit = intersect(inside, t);
        ASSERT_TRUE(hit);
        EXPECT_FLOAT_EQ(static_cast<float>(hit->t), 1.5f);
        EXPECT_NEAR(hit->weights.y, 0.25f, 1e-6);
        EXPECT_NEAR(hit->weights.z, 0.5f, 1e-6);
        EXPECT_TRUE(hit->front);
        EXPECT_FALSE(intersect(outside, t));
        EXPECT_FALSE(intersect(behind, t));
    };
    check(intersectMollerTrumboreNaive);
    check(intersectPlueckerNaive);
    check(intersectWoopNaive);
    for (const InsideMethod method : insideMethods)
        check(
            [method](const Ray& ray, const Triangle& one) { return intersectPlaneNaive(ray, one, method); });
}

/// t of each pair, decided as `intersectTriangle` does.
void expectPacked(const Ray& ray, const Triangle& triangle, float t) {
    const auto exact = intersectTriangle(ray, triangle);
    ASSERT_EQ(std::isfinite(t), exact.has_value()) << t << " " << text(ray, triangle);
    if (exact) {
        const double limit = std::numeric_limits<float>::max();
        EXPECT_LE(std::abs(t - std::min(exact->t, limit)), 0x1p-14 * exact->t + 0x1p-150)
            << text(ray, triangle);
    } else {
        EXPECT_EQ(t, std::numeric_limits<float>::infinity());
    }
}

TEST(PackedRayTriangle, DecidesAsTheScalarFormDoes) {
    StressInputs draw(48);
    std::size_t left = 0;
    std::size_t pairs = 0;
    for (int round = 0; round < 300; ++round) {
        // Every length of arrays around the widths of vectors; scales, edges, corners, any bits at all.
        const std::size_t size = draw.random().below(40);
        const double scale = round % 3 == 0 ? draw.magnitude(-120, 100) : 1;
        RayArrays rays;
        TriangleArrays triangles;
        const auto point = [&] { return glm::vec3(scale * draw.magnitude(-4, 1) * draw.direction()); };
        const Triangle triangle{point(), point(), point()};
        Ray first{point(), draw.unitVector()};
        for (std::size_t i = 0; i < size; ++i) {
            const glm::dvec3 edge =
                glm::mix(glm::dvec3(triangle.a), glm::dvec3(triangle.b), draw.random().uniform(0, 1));
            const glm::dvec3 target = draw.random().below(3) == 0 ? edge
                                                                  : glm::mix(edge, glm::dvec3(triangle.c),
                                                                             draw.random().uniform(0, 1.2));
            const glm::vec3 origin(scale * draw.magnitude(0, 6) * draw.direction());
            Ray ray{origin, glm::vec3(target - glm::dvec3(origin))};
            if (round % 5 == 4)
                ray = {draw.finiteVector(), draw.finiteVector()};
            rays.add(ray);
            first = ray;
            const glm::vec3 a(triangle.a + point());
            triangles.add(round % 5 == 4
                              ? Triangle{draw.finiteVector(), draw.finiteVector(), draw.finiteVector()}
                              : Triangle{a, triangle.b, draw.random().below(8) == 0 ? a : triangle.c});
        }
        std::vector<float> t(size, -1);
        left += intersectPacked(rays, triangle, t);
        for (std::size_t i = 0; i < size; ++i)
            expectPacked(rays.at(i), triangle, t[i]);
        std::fill(t.begin(), t.end(), -1.0f);
        left += intersectPacked(first, triangles, t);
        for (std::size_t i = 0; i < size; ++i)
            expectPacked(first, triangles.at(i), t[i]);
        pairs += 2 * size;
    }
    EXPECT_GT(left, pairs / 20);
    EXPECT_LT(left, pairs * 3 / 4);
}

TEST(PackedRayTriangle, SettlesNearlyAllOfAnOrdinaryPictureInFloat) {
    const Triangle triangle{{-1, -1, -3}, {1, -1, -3.5f}, {0, 1, -2.5f}};
    StressInputs draw(49);
    RayArrays rays;
    for (int i = 0; i < 10000; ++i)
        rays.add({{0.1f, 0.2f, 0.3f},
                  glm::vec3(draw.random().uniform(-0.35, 0.35), draw.random().uniform(-0.35, 0.35), -1)});
    std::vector<float> t(rays.size());
    const std::size_t left = intersectPacked(rays, triangle, t);
    EXPECT_LE(left, 10u);  // measured: 0
    std::size_t hits = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
        expectPacked(rays.at(i), triangle, t[i]);
        hits += std::isfinite(t[i]) ? 1 : 0;
    }
    EXPECT_GT(hits, 3000u);
    EXPECT_LT(hits, 4500u);
}

TEST(PackedRayTriangle, HasNoHitForWhatIsNotFinite) {
    RayArrays rays;
    rays.add({{0, 0, 1}, {0, 0, 0}});
    rays.add({{0, NAN, 1}, {0, 0, -1}});
    rays.add({{0, 0, 1}, {0, 0, -std::numeric_limits<float>::infinity()}});
    rays.add({{0, 0, 1}, {0, 0, -1}});
    std::vector<float> t(4);
    intersectPacked(rays, {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, t);
    EXPECT_EQ(t[0], std::numeric_limits<float>::infinity());
    EXPECT_EQ(t[1], std::numeric_limits<float>::infinity());
    EXPECT_EQ(t[2], std::numeric_limits<float>::infinity());
    EXPECT_EQ(t[3], 1);
    intersectPacked(rays, {{-1, -1, 0}, {1, NAN, 0}, {0, 1, 0}}, t);
    EXPECT_EQ(t[3], std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace quincunx

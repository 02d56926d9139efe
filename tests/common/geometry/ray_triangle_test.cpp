#include "geometry/ray_triangle.h"

#include <array>
#include <cmath>
#include <cstdint>
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
    RecordProperty("t", fmt::format("{:a}", worst.t));
    std::printf("t %.3g (bound %.3g), weights %.4g (3.1e-8), point %.3g edges (%.3g)\n", worst.t, 0x1p-34,
                worst.weight, worst.point, 0x1p-28);
}

}  // namespace
}  // namespace quincunx

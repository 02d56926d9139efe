#include "geometry/polygon_tests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/predicates.h"
#include "geometry/ray_triangle.h"
#include "math/stress_inputs.h"
#include "tests/common/geometry/rational.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;

using Polygon = std::vector<glm::vec2>;

Rational rational(float x) {
    return Rational(static_cast<double>(x));
}

/// By the definition: on an edge, or an odd number of crossings with a half line that misses all corners.
PointLocation exactLocation(glm::vec2 point, const Polygon& polygon) {
    const Rational px = rational(point.x);
    const Rational py = rational(point.y);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec2 a = polygon[i];
        const glm::vec2 b = polygon[(i + 1) % polygon.size()];
        const bool beside = oracle::orientation2(a, b, point) != 0;
        const bool inBox = std::min(a.x, b.x) <= point.x && point.x <= std::max(a.x, b.x) &&
                           std::min(a.y, b.y) <= point.y && point.y <= std::max(a.y, b.y);
        if (!beside && inBox)
            return PointLocation::boundary;
    }
    // A half line from the point at the slope 1/k, k beyond all slopes between the point and corners.
    Rational k = 1;
    const auto meetsCorner = [&] {
        for (const glm::vec2 corner : polygon)
            if ((rational(corner.y) - py) * k == rational(corner.x) - px)
                return true;
        return false;
    };
    while (meetsCorner())
        k += Rational(1) / Rational(7);
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        // Coordinates along (h) and across (s) the half line, whose direction is (k, 1).
        const auto across = [&](glm::vec2 v) {
            return Rational(k * (rational(v.y) - py) - (rational(v.x) - px));
        };
        const auto along = [&](glm::vec2 v) {
            return Rational(k * (rational(v.x) - px) + (rational(v.y) - py));
        };
        const glm::vec2 a = polygon[i];
        const glm::vec2 b = polygon[(i + 1) % polygon.size()];
        const Rational sa = across(a);
        const Rational sb = across(b);
        if ((sa > 0) == (sb > 0))
            continue;
        inside ^= Rational(along(a) + sa / (sa - sb) * (along(b) - along(a))) > 0;
    }
    return inside ? PointLocation::inside : PointLocation::outside;
}

Polygon gridPolygon(StressInputs& draw, std::uint64_t corners, std::uint64_t side) {
    Polygon polygon;
    for (std::uint64_t i = 0; i < corners; ++i)
        polygon.emplace_back(static_cast<float>(draw.random().below(side)),
                             static_cast<float>(draw.random().below(side)));
    return polygon;
}

TEST(PointInPolygon, IsExactForEveryTriangleAndPointOfASmallGrid) {
    const auto at = [](int i) { return glm::vec2(static_cast<float>(i % 4), static_cast<float>(i / 4)); };
    std::array<int, 3> counts{};
    for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b)
            for (int c = 0; c < 16; ++c)
                for (int p = 0; p < 16; p += 3) {
                    const Polygon triangle = {at(a), at(b), at(c)};
                    const glm::vec2 point = at(p);
                    const PointLocation exact = exactLocation(point, triangle);
                    ++counts[static_cast<std::size_t>(exact)];
                    ASSERT_EQ(locate(point, triangle), exact) << a << " " << b << " " << c << " " << p;
                    ASSERT_EQ(locateByTriangleFan(point, triangle), exact);
                    if (isConvex(triangle)) {
                        ASSERT_EQ(locateInConvex(point, triangle), exact);
                    }
                    ASSERT_EQ(isConvex(triangle), oracle::orientation2(at(a), at(b), at(c)) != 0);
                }
    for (const int count : counts)
        EXPECT_GT(count, 500);
}

// Polygons that cross and touch themselves, repeat corners, lie on lines.
TEST(PointInPolygon, IsExactForRandomPolygonsOnGrids) {
    StressInputs draw(51);
    for (int i = 0; i < 10000; ++i) {
        const Polygon polygon = gridPolygon(draw, draw.random().below(9), 2 + draw.random().below(5));
        const glm::vec2 point(static_cast<float>(draw.random().below(13)) * 0.5f,
                              static_cast<float>(draw.random().below(13)) * 0.5f);
        const PointLocation exact = exactLocation(point, polygon);
        ASSERT_EQ(locate(point, polygon), exact);
        ASSERT_EQ(locateByTriangleFan(point, polygon), exact);
        const auto turns = windingNumber(point, polygon);
        ASSERT_EQ(turns.has_value(), exact != PointLocation::boundary);
        if (turns) {
            ASSERT_EQ(*turns % 2 != 0, exact == PointLocation::inside);
            ASSERT_EQ(containsHalfOpen(point, polygon), exact == PointLocation::inside);
        }
        if (isConvex(polygon)) {
            ASSERT_EQ(locateInConvex(point, polygon), exact);
        }
    }
}

TEST(PointInPolygon, IsExactForPointsBesideLongEdgesAtAnyScale) {
    StressInputs draw(52);
    std::array<int, 3> counts{};
    for (int i = 0; i < 6000; ++i) {
        const double scale = i % 2 == 0 ? draw.magnitude(-140, 120) : 1;
        Polygon polygon;
        for (std::uint64_t n = 3 + draw.random().below(6); n > 0; --n)
            polygon.emplace_back(scale * draw.random().uniform(-1, 1), scale * draw.random().uniform(-1, 1));
        const glm::dvec2 a(polygon[0]);
        const glm::dvec2 b(polygon[1]);
        const glm::vec2 point(i % 3 == 0 ? a : glm::mix(a, b, draw.random().uniform(-0.1, 1.1)));
        const PointLocation exact = exactLocation(point, polygon);
        ++counts[static_cast<std::size_t>(exact)];
        ASSERT_EQ(locate(point, polygon), exact);
        ASSERT_EQ(locateByTriangleFan(point, polygon), exact);
    }
    for (const int count : counts)
        EXPECT_GT(count, 300);
}

TEST(PointInPolygon, GivesEachPointToOneCellOfAPartition) {
    StressInputs draw(53);
    for (int i = 0; i < 20000; ++i) {
        // A square cut into four triangles at any inner point.
        const float size = static_cast<float>(draw.magnitude(-100, 100));
        const std::array<glm::vec2, 4> square = {glm::vec2(0), glm::vec2(size, 0), glm::vec2(size, size),
                                                 glm::vec2(0, size)};
        const glm::vec2 centre(size * static_cast<float>(draw.random().uniform(0.1, 0.9)),
                               size * static_cast<float>(draw.random().uniform(0.1, 0.9)));
        const glm::vec2 corner = square[draw.random().below(4)];
        const glm::vec2 point = i % 5 == 0 ? centre
                                           : glm::vec2(glm::mix(glm::dvec2(centre), glm::dvec2(corner),
                                                                draw.random().uniform(0, 0.999)));
        int owners = 0;
        for (std::size_t k = 0; k < 4; ++k)
            owners += containsHalfOpen(point, std::array{square[k], square[(k + 1) % 4], centre}) ? 1 : 0;
        ASSERT_EQ(owners, 1);
    }
}

TEST(PointInPolygon, DoesNotDependOnWhereTheChainStartsOrWhichWayItRuns) {
    StressInputs draw(54);
    for (int i = 0; i < 2000; ++i) {
        Polygon polygon = gridPolygon(draw, 3 + draw.random().below(6), 5);
        const glm::vec2 point(static_cast<float>(draw.random().below(5)),
                              static_cast<float>(draw.random().below(5)));
        const PointLocation location = locate(point, polygon);
        const auto turns = windingNumber(point, polygon);
        const bool convex = isConvex(polygon);
        const bool owned = containsHalfOpen(point, polygon);
        std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
        EXPECT_EQ(locate(point, polygon), location);
        EXPECT_EQ(windingNumber(point, polygon), turns);
        EXPECT_EQ(isConvex(polygon), convex);
        EXPECT_EQ(containsHalfOpen(point, polygon), owned);
        std::reverse(polygon.begin(), polygon.end());
        EXPECT_EQ(locate(point, polygon), location);
        EXPECT_EQ(isConvex(polygon), convex);
        EXPECT_EQ(containsHalfOpen(point, polygon), owned);
        if (turns) {
            EXPECT_EQ(windingNumber(point, polygon), -*turns);
        }
    }
}

TEST(PointInPolygon, FindsNothingInsideWhatHasNoArea) {
    EXPECT_EQ(locate({0, 0}, {}), PointLocation::outside);
    const Polygon one = {{1, 1}};
    EXPECT_EQ(locate({1, 1}, one), PointLocation::boundary);
    EXPECT_EQ(locate({1, 0}, one), PointLocation::outside);
    const Polygon line = {{0, 0}, {2, 2}, {1, 1}, {3, 3}};
    EXPECT_EQ(locate({1.5f, 1.5f}, line), PointLocation::boundary);
    EXPECT_EQ(locate({4, 4}, line), PointLocation::outside);
    EXPECT_FALSE(isConvex(line));
    EXPECT_FALSE(isConvex(one));
    EXPECT_FALSE(isConvex(Polygon{}));
    EXPECT_FALSE(isConvex(Polygon{{1, 1}, {1, 1}, {1, 1}}));
}

TEST(PointInPolygon, CallsConvexWhatTurnsOneWayOnce) {
    EXPECT_TRUE(isConvex(Polygon{{0, 0}, {1, 0}, {2, 0}, {2, 0}, {2, 2}, {0, 2}}));
    EXPECT_TRUE(isConvex(Polygon{{0, 0}, {0, 2}, {2, 2}, {2, 0}}));
    // A spike, a dent, a pentagram, and a square run around twice.
    EXPECT_FALSE(isConvex(Polygon{{0, 0}, {2, 0}, {4, 0}, {2, 0}, {2, 2}}));
    EXPECT_FALSE(isConvex(Polygon{{0, 0}, {4, 0}, {1, 1}, {0, 4}}));
    EXPECT_FALSE(isConvex(Polygon{{0, 3}, {2, -3}, {-3, 1}, {3, 1}, {-2, -3}}));
    EXPECT_FALSE(isConvex(Polygon{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}}));
}

TEST(PointInPolygon, CountsTurnsOfChainsThatCoverThemselves) {
    const Polygon twice = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 2}, {0, 2}};
    EXPECT_EQ(windingNumber({1, 1}, twice), 2);
    EXPECT_EQ(locate({1, 1}, twice), PointLocation::outside);
    EXPECT_EQ(windingNumber({2, 1}, twice), std::nullopt);
    EXPECT_EQ(windingNumber({1, 1}, Polygon(twice.rbegin(), twice.rend())), -2);
}

TEST(PointInPolygon, NaiveWaysAgreeAwayFromTheBoundary) {
    const Polygon triangle = {{0, 0}, {4, 0}, {0, 4}};
    const Polygon concave = {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
    for (const InsideMethod method : insideMethods) {
        EXPECT_TRUE(insideNaive(method, {1, 1}, triangle));
        EXPECT_FALSE(insideNaive(method, {3, 3}, triangle));
        EXPECT_FALSE(insideNaive(method, {-1, 1}, triangle));
    }
    for (const InsideMethod method :
         {InsideMethod::crossings, InsideMethod::angleSum, InsideMethod::triangleFan}) {
        EXPECT_TRUE(insideNaive(method, {0.5f, 2.5f}, concave));
        EXPECT_FALSE(insideNaive(method, {2.0f, 2.5f}, concave));
    }
}

// A flat polygon on a grid in the plane of two integer vectors, and rays at grid points of that plane.
struct FlatCase {
    std::vector<glm::vec3> polygon;
    Polygon coordinates;
    glm::vec3 target{0};
    glm::vec2 targetCoordinates{0};
    Ray ray;
    bool edgeOn = false;
    double scale = 1;
};

FlatCase drawFlatCase(StressInputs& draw, double scaleExponent) {
    const auto integer = [&](int reach) {
        return static_cast<float>(draw.random().below(static_cast<std::uint64_t>(2 * reach + 1))) -
               static_cast<float>(reach);
    };
    FlatCase made;
    glm::vec3 u(0);
    glm::vec3 v(0);
    while (glm::cross(u, v) == glm::vec3(0)) {
        u = {integer(3), integer(3), integer(3)};
        v = {integer(3), integer(3), integer(3)};
    }
    made.scale = std::exp2(scaleExponent);
    const auto scale = static_cast<float>(made.scale);
    const glm::vec3 corner(integer(50), integer(50), integer(50));
    const auto at = [&](glm::vec2 c) { return scale * (corner + c.x * u + c.y * v); };
    made.coordinates = gridPolygon(draw, 3 + draw.random().below(5), 5);
    for (const glm::vec2 c : made.coordinates)
        made.polygon.push_back(at(c));
    made.targetCoordinates = {integer(3) + 2, integer(3) + 2};
    made.target = at(made.targetCoordinates);
    const glm::vec3 offset(integer(20), integer(20), integer(20));
    made.ray.origin = made.target + scale * offset;
    made.ray.direction = -offset * static_cast<float>(std::exp2(draw.random().below(40)));
    made.edgeOn = glm::dot(offset, glm::cross(u, v)) == 0;
    return made;
}

TEST(RayPolygon, AgreesWithTheExactTestInThePlane) {
    StressInputs draw(55);
    std::array<int, 3> counts{};
    for (int i = 0; i < 20000; ++i) {
        const FlatCase one = drawFlatCase(draw, static_cast<double>(draw.random().below(100)) - 50);
        const auto hit = intersectPolygon(one.ray, one.polygon);
        PointLocation expected = exactLocation(one.targetCoordinates, one.coordinates);
        bool hasArea = false;  // is it not on a line?
        for (std::size_t k = 2; k < one.coordinates.size(); ++k)
            hasArea |=
                oracle::orientation2(one.coordinates[0], one.coordinates[k - 1], one.coordinates[k]) != 0;
        if (one.edgeOn || !hasArea)
            expected = PointLocation::outside;
        ++counts[static_cast<std::size_t>(expected)];
        ASSERT_EQ(hit.has_value(), expected != PointLocation::outside) << i;
        if (!hit)
            continue;
        EXPECT_EQ(hit->boundary, expected == PointLocation::boundary);
        // Targets are floats, so half an ulp is nothing. Sides of at most 26 that span an area of at least 1
        // have parts of up to 2^12 on the way to a point 26 away: 2^-35 2^12.
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(hit->point[axis] - one.target[axis]), 0x1p-23 * one.scale);
        // origin + t direction = target, exactly.
        const glm::dvec3 reached =
            glm::dvec3(one.ray.origin) + hit->t * glm::dvec3(one.ray.direction) - glm::dvec3(one.target);
        EXPECT_LE(glm::length(reached), 0x1p-35 * glm::length(glm::dvec3(one.target - one.ray.origin)));
        EXPECT_GT(hit->t, 0);
        const auto behind = intersectPolygon({one.ray.origin, -one.ray.direction}, one.polygon);
        EXPECT_FALSE(behind);
        // Seen from the other side.
        const Ray opposite{one.target - (one.ray.origin - one.target), -one.ray.direction};
        const auto back = intersectPolygon(opposite, one.polygon);
        ASSERT_TRUE(back);
        EXPECT_EQ(back->front, !hit->front);
    }
    for (const int count : counts)
        EXPECT_GT(count, 300);
}

TEST(RayPolygon, IsTheTriangleOfThreeCorners) {
    StressInputs draw(56);
    int hits = 0;
    for (int i = 0; i < 10000; ++i) {
        const Triangle triangle{draw.vectorOfMagnitude(-2, 2), draw.vectorOfMagnitude(-2, 2),
                                draw.vectorOfMagnitude(-2, 2)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-4, 4);
        const glm::dvec3 target =
            glm::mix(glm::dvec3(triangle.a), glm::dvec3(triangle.b), draw.random().uniform(0, 1));
        const Ray ray{origin, glm::vec3(target - glm::dvec3(origin))};
        const std::array corners = {triangle.a, triangle.b, triangle.c};
        const auto polygonHit = intersectPolygon(ray, corners);
        const auto triangleHit = intersectTriangle(ray, triangle);
        ASSERT_EQ(polygonHit.has_value(), triangleHit.has_value());
        if (!polygonHit)
            continue;
        ++hits;
        EXPECT_EQ(polygonHit->front, triangleHit->front);
        EXPECT_LE(std::abs(polygonHit->t / triangleHit->t - 1), 0x1p-33);
    }
    EXPECT_GT(hits, 1000);
}

TEST(RayPolygon, HasNoAnswerForWhatIsNoPolygonOrNoRay) {
    const std::array<glm::vec3, 4> square = {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0),
                                             glm::vec3(0, 1, 0)};
    const Ray down{{0.5f, 0.5f, 1}, {0, 0, -1}};
    EXPECT_TRUE(intersectPolygon(down, square));
    EXPECT_FALSE(intersectPolygon(down, std::span(square).first(2)));
    EXPECT_FALSE(intersectPolygon(down, {}));
    EXPECT_FALSE(intersectPolygon({down.origin, glm::vec3(0)}, square));
    EXPECT_FALSE(intersectPolygon({{0.5f, 0.5f, 0}, {1, 0, 0}}, square));  // in its plane
    EXPECT_FALSE(intersectPolygon({{0.5f, NAN, 1}, {0, 0, -1}}, square));
    auto broken = square;
    broken[2].x = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(intersectPolygon(down, broken));
    // From the plane itself: t = 0.
    const auto touching = intersectPolygon({{0.5f, 0.5f, 0}, {0, 0, -1}}, square);
    ASSERT_TRUE(touching);
    EXPECT_EQ(touching->t, 0);
}

struct ExactQuadHit {
    Rational t;
    Rational a;
    Rational b;
};

std::optional<ExactQuadHit> exactQuadHit(const Ray& ray, const Parallelogram& quad) {
    const RationalVector u(quad.u);
    const RationalVector v(quad.v);
    const RationalVector d(ray.direction);
    const RationalVector w = RationalVector(ray.origin) - RationalVector(quad.corner);
    const Rational facing = oracle::tripleProduct(u, v, d);
    if (facing == 0)
        return std::nullopt;
    const Rational a = oracle::tripleProduct(w, v, d) / facing;
    const Rational b = oracle::tripleProduct(u, w, d) / facing;
    const Rational t = -oracle::tripleProduct(u, v, w) / facing;
    if (a < 0 || a > 1 || b < 0 || b > 1 || t < 0)
        return std::nullopt;
    return ExactQuadHit{t, a, b};
}

TEST(RayQuad, AgreesWithRationalsBesideEdgesForAnyLengthOfTheDirection) {
    StressInputs draw(57);
    int hits = 0;
    int naiveWrong = 0;
    for (int i = 0; i < 20000; ++i) {
        const Parallelogram quad{draw.vectorOfMagnitude(-2, 2), draw.vectorOfMagnitude(-2, 2),
                                 draw.vectorOfMagnitude(-2, 2)};
        const auto pick = [&] {
            const std::uint64_t kind = draw.random().below(4);
            return kind < 2 ? static_cast<double>(kind) : draw.random().uniform(-0.1, 1.1);
        };
        const glm::dvec3 target =
            glm::dvec3(quad.corner) + pick() * glm::dvec3(quad.u) + pick() * glm::dvec3(quad.v);
        const glm::vec3 origin = i % 2 == 0 ? draw.vectorOfMagnitude(-2, 4)
                                            : glm::vec3(glm::round(glm::dvec3(draw.vectorOfMagnitude(2, 4))));
        const Ray ray{origin, glm::vec3(draw.magnitude(-60, 10) * (target - glm::dvec3(origin)))};
        const auto exact = exactQuadHit(ray, quad);
        const auto hit = intersectParallelogram(ray, quad);
        ASSERT_EQ(hit.has_value(), exact.has_value());
        naiveWrong += intersectParallelogramNaive(ray, quad).has_value() != exact.has_value() ? 1 : 0;
        if (!hit)
            continue;
        ++hits;
        EXPECT_LE(std::abs(static_cast<double>(Rational((Rational(hit->t) - exact->t) / exact->t))), 0x1p-34);
        EXPECT_LE(std::abs(static_cast<double>(Rational(rational(hit->ab.x) - exact->a))), 3.1e-8);
        EXPECT_LE(std::abs(static_cast<double>(Rational(rational(hit->ab.y) - exact->b))), 3.1e-8);
        EXPECT_GE(hit->ab.x, 0);
        EXPECT_LE(hit->ab.x, 1);
        EXPECT_GE(hit->ab.y, 0);
        EXPECT_LE(hit->ab.y, 1);
    }
    EXPECT_GT(hits, 3000);
    EXPECT_GT(naiveWrong, 3000);
}

TEST(RayQuad, LeavesNoGapBetweenParallelogramsThatShareAnEdge) {
    StressInputs draw(58);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        // Corners that are exact: floats of few bits.
        const auto few = [&](double reach) {
            return static_cast<float>(std::floor(draw.random().uniform(-reach, reach))) * 0x1p-10f;
        };
        const Parallelogram left{{few(1e5), few(1e5), few(1e5)},
                                 {1 + few(1e3), few(1e3), few(1e3)},
                                 {few(1e3), 1 + few(1e3), few(1e3)}};
        const Parallelogram right{left.corner + left.u, {1 + few(1e3), few(1e3), few(1e3)}, left.v};
        const glm::dvec3 target =
            glm::dvec3(right.corner) + draw.random().uniform(0.001, 0.999) * glm::dvec3(left.v);
        const glm::vec3 origin(target + glm::dvec3(few(1e3), few(1e3), 10 + few(1e3)));
        const Ray ray{origin, glm::vec3(draw.magnitude(-60, 10) * (target - glm::dvec3(origin)))};
        // The ray must see the two side by side, not folded onto each other.
        const auto facing = [&](const Parallelogram& quad) {
            return oracle::sign(oracle::tripleProduct(RationalVector(quad.u), RationalVector(quad.v),
                                                      RationalVector(ray.direction)));
        };
        if (facing(left) != facing(right))
            continue;
        ++seen;
        ASSERT_TRUE(intersectParallelogram(ray, left) || intersectParallelogram(ray, right)) << i;
    }
    EXPECT_GT(seen, 5000);
}

TEST(RayQuad, DoesNotDependOnTheLengthOfTheDirection) {
    StressInputs draw(59);
    for (int i = 0; i < 5000; ++i) {
        const Parallelogram quad{draw.vectorOfMagnitude(-2, 2), draw.vectorOfMagnitude(-2, 2),
                                 draw.vectorOfMagnitude(-2, 2)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-2, 4);
        const glm::vec3 direction(glm::dvec3(quad.corner) + draw.random().uniform(0, 1) * glm::dvec3(quad.u) -
                                  glm::dvec3(origin));
        const auto unit = intersectParallelogram({origin, direction}, quad);
        const auto scaled = intersectParallelogram({origin, 0x1p-60f * direction}, quad);
        ASSERT_EQ(unit.has_value(), scaled.has_value());
        if (unit) {
            EXPECT_EQ(unit->ab, scaled->ab);
            EXPECT_EQ(unit->t, scaled->t * 0x1p-60);
        }
    }
}

TEST(RayQuad, HasNoAnswerForDegenerateInput) {
    const Parallelogram quad{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_TRUE(intersectParallelogram({{1, 1, 1}, {0, 0, -1}}, quad));
    EXPECT_FALSE(intersectParallelogram({{1.0000001f, 1, 1}, {0, 0, -1}}, quad));
    EXPECT_FALSE(intersectParallelogram({{1, 1, 1}, {0, 0, 0}}, quad));
    EXPECT_FALSE(intersectParallelogram({{1, 1, 1}, {0, 0, 1}}, quad));
    EXPECT_FALSE(intersectParallelogram({{-1, 0.5f, 0}, {1, 0, 0}}, quad));
    EXPECT_FALSE(intersectParallelogram({{0, 0, 1}, {0, 0, -1}}, {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}));
    EXPECT_FALSE(intersectParallelogram({{0, NAN, 1}, {0, 0, -1}}, quad));
}

}  // namespace
}  // namespace quincunx

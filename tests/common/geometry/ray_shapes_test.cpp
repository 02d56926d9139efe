#include "geometry/ray_shapes.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "geometry/intersection_oracle.h"
#include "geometry/polygon_tests.h"
#include "geometry/ray_triangle.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;
using oracle::Real;

/// What the header promises of t: 2^-31, relative.
constexpr double tError = 0x1p-31;

Real realOf(const Rational& q) {
    return Real(numerator(q)) / Real(denominator(q));
}

/// a t² + 2 b t + c ≤ 0 inside.
struct Conic {
    Rational a;
    Rational b;
    Rational c;
    Rational discriminant() const { return b * b - a * c; }
    Real root(int side) const { return (realOf(-b) + side * sqrt(realOf(discriminant()))) / realOf(a); }
    Rational at(const Rational& t) const { return a * t * t + 2 * b * t + c; }
};

Conic sphereOf(const Ray& ray, const Ball& ball) {
    const RationalVector w = RationalVector(ray.origin) - RationalVector(ball.centre);
    const RationalVector d(ray.direction);
    return {dot(d, d), dot(d, w), dot(w, w) - Rational(ball.radius) * Rational(ball.radius)};
}

Conic cylinderOf(const Ray& ray, const Cylinder& cylinder) {
    const RationalVector axis(cylinder.axis);
    const RationalVector e = cross(RationalVector(ray.direction), axis);
    const RationalVector g = cross(RationalVector(ray.origin) - RationalVector(cylinder.base), axis);
    return {dot(e, e), dot(e, g),
            dot(g, g) - Rational(cylinder.radius) * Rational(cylinder.radius) * dot(axis, axis)};
}

/// The first point of the surface with t ≥ 0. MPFR's 300 bits take t from exact coefficients.
std::optional<Real> firstOf(const Conic& conic) {
    if (conic.a == 0 || conic.discriminant() < 0)
        return std::nullopt;
    if (conic.c == 0)
        return Real(0);
    if (conic.c < 0)
        return conic.root(1);
    return conic.b < 0 ? std::optional(conic.root(-1)) : std::nullopt;
}

double relativeError(double got, const Real& exact) {
    return exact == 0 ? std::abs(got) : std::abs(static_cast<double>(Real((Real(got) - exact) / exact)));
}

template <typename Describe>
void expectSame(const std::optional<double>& got, const std::optional<Quad>& quad,
                const std::optional<Real>& exact, const Describe& describe) {
    ASSERT_EQ(got.has_value(), exact.has_value()) << describe();
    ASSERT_EQ(quad.has_value(), exact.has_value()) << "the oracle: " << describe();
    if (!exact)
        return;
    EXPECT_LE(relativeError(*got, *exact), tError) << describe();
    // The oracle of the shipped program, rounded to double.
    EXPECT_LE(relativeError(static_cast<double>(*quad), *exact), 0x1p-52) << describe();
}

std::string text(glm::vec3 v) {
    return fmt::format("({:a},{:a},{:a})", v.x, v.y, v.z);
}

/// Of about size 1, of any size, or whole numbers, so that exact contacts occur.
glm::vec3 someVector(StressInputs& draw, int kind) {
    if (kind == 0)
        return draw.vectorOfMagnitude(-3, 3);
    if (kind == 1)
        return draw.vectorOfMagnitude(-90, 90);
    glm::vec3 v;
    do
        for (int axis = 0; axis < 3; ++axis)
            v[axis] = static_cast<float>(static_cast<int>(draw.random().below(9)) - 4);
    while (v == glm::vec3(0));
    return v;
}

float someSize(StressInputs& draw, int kind) {
    return kind == 0   ? static_cast<float>(draw.magnitude(-3, 2))
           : kind == 1 ? static_cast<float>(draw.magnitude(-90, 90))
                       : static_cast<float>(draw.random().below(5));
}

/// Half of the rays point at the target.
Ray someRay(StressInputs& draw, int kind, glm::vec3 target) {
    Ray ray{someVector(draw, kind), someVector(draw, kind)};
    if (draw.random().below(2) == 0 && target - ray.origin != glm::vec3(0))
        ray.direction = target - ray.origin;
    return ray;
}

TEST(RayShapes, SphereIsMetWhereRationalsSay) {
    StressInputs draw(31);
    int hits = 0;
    for (int i = 0; i < 12000; ++i) {
        const Ball ball{someVector(draw, i % 3), someSize(draw, i % 3)};
        const Ray ray = someRay(draw, i % 3, ball.centre + ball.radius * draw.unitVector());
        const std::optional<Real> exact = firstOf(sphereOf(ray, ball));
        hits += exact.has_value();
        expectSame(raySphereDistance(ray, ball), raySphereExact(ray, ball), exact, [&] {
            return fmt::format("{} {} {} {:a}", text(ray.origin), text(ray.direction), text(ball.centre),
                               ball.radius);
        });
    }
    EXPECT_GT(hits, 3000);
}

TEST(RayShapes, SphereOfDoublesIsMetWhereRationalsSay) {
    StressInputs draw(30);
    int hits = 0;
    for (int i = 0; i < 6000; ++i) {
        const DBall ball{draw.doubleVectorOfMagnitude(-3, i % 2 == 0 ? 3 : 60), draw.magnitude(-3, 3)};
        const glm::dvec3 origin =
            ball.centre + ball.radius * draw.magnitude(-2, i % 3 == 0 ? 50 : 2) * draw.direction();
        const glm::dvec3 target =
            ball.centre + draw.random().uniform(0, 1.3) * ball.radius * draw.direction();
        const DRay ray{origin, draw.magnitude(-9, 9) * (target - origin)};
        if (ray.direction == glm::dvec3(0))
            continue;
        const RationalVector w = RationalVector(ray.origin) - RationalVector(ball.centre);
        const RationalVector d(ray.direction);
        const std::optional<Real> exact =
            firstOf({dot(d, d), dot(d, w), dot(w, w) - Rational(ball.radius) * Rational(ball.radius)});
        const std::optional<double> got = raySphereDistance(ray, ball);
        ASSERT_EQ(got.has_value(), exact.has_value()) << i;
        ASSERT_EQ(raySphereExact(ray, ball).has_value(), exact.has_value()) << i;
        hits += exact.has_value();
        if (exact && *exact != 0) {
            EXPECT_LE(ulpError(*got, *exact), 6) << i;  // measured: 3.1
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST(RayShapes, CylinderIsMetWhereRationalsSay) {
    StressInputs draw(32);
    int hits = 0;
    for (int i = 0; i < 9000; ++i) {
        const int kind = i % 2 == 0 ? 0 : 2;
        const Cylinder cylinder{someVector(draw, kind), someVector(draw, kind), someSize(draw, kind)};
        const Ray ray = someRay(draw, kind, cylinder.base + cylinder.radius * draw.unitVector());
        const std::optional<Real> exact = firstOf(cylinderOf(ray, cylinder));
        hits += exact.has_value();
        expectSame(rayCylinderDistance(ray, cylinder), rayCylinderExact(ray, cylinder), exact, [&] {
            return fmt::format("{} {} {} {} {:a}", text(ray.origin), text(ray.direction), text(cylinder.base),
                               text(cylinder.axis), cylinder.radius);
        });
    }
    EXPECT_GT(hits, 3000);
}

TEST(RayShapes, CylinderOfAnySizeIsDecidedAsRationalsDo) {
    // The whole range: the oracle of the shipped program may leave double's range here, so rationals alone.
    StressInputs draw(33);
    for (int i = 0; i < 3000; ++i) {
        const Cylinder cylinder{draw.finiteVector(), draw.finiteVector(), std::abs(draw.finiteFloat())};
        const Ray ray{draw.finiteVector(), draw.finiteVector()};
        const std::optional<double> got = rayCylinderDistance(ray, cylinder);
        const std::optional<Real> exact = firstOf(cylinderOf(ray, cylinder));
        ASSERT_EQ(got.has_value(), exact.has_value()) << i;
        if (exact) {
            EXPECT_LE(relativeError(*got, *exact), tError) << i;
        }
    }
}

/// The can's first point by brute force: the conic's roots and the caps, with exact signs where they decide.
std::optional<Real> canOf(const Ray& ray, const Cylinder& can) {
    const Conic side = cylinderOf(ray, can);
    const RationalVector axis(can.axis);
    const Rational height = dot(RationalVector(ray.origin) - RationalVector(can.base), axis);
    const Rational climb = dot(RationalVector(ray.direction), axis);
    const Rational length = dot(axis, axis);
    // In the solid where side ≤ 0 and 0 ≤ height + t climb ≤ length: an interval of t. Its rational ends:
    std::optional<Rational> low = Rational(0);
    std::optional<Rational> high;
    if (climb == 0) {
        if (height < 0 || height > length)
            return std::nullopt;
    } else {
        Rational first = -height / climb;
        Rational last = (length - height) / climb;
        if (last < first)
            std::swap(first, last);
        if (first > *low)
            low = first;
        high = last;
        if (*high < *low)
            return std::nullopt;
    }
    const bool startsInside = *low == 0 && side.c <= 0;
    const bool onCap =
        climb == 0 ? (height == 0 || height == length) : (height == 0 || height == length) && height >= 0;
    if (startsInside && (side.c == 0 || onCap))
        return Real(0);
    if (startsInside) {
        if (side.a == 0 || (high && side.at(*high) <= 0))
            return realOf(*high);
        return side.root(1);
    }
    if (side.at(*low) <= 0)
        return realOf(*low);
    if (side.a == 0 || side.discriminant() < 0)
        return std::nullopt;
    const Rational middle = -side.b / side.a;
    if (high && side.at(*high) <= 0)
        return side.root(-1);
    if (middle < *low || (high && middle > *high))
        return std::nullopt;
    return side.root(-1);
}

TEST(RayShapes, CanIsMetWhereRationalsSay) {
    StressInputs draw(34);
    int hits = 0;
    for (int i = 0; i < 9000; ++i) {
        const int kind = i % 2 == 0 ? 0 : 2;
        const Cylinder can{someVector(draw, kind), someVector(draw, kind), someSize(draw, kind)};
        Ray ray = someRay(draw, kind, can.base + 0.5f * can.radius * draw.unitVector());
        if (i % 6 == 1)
            ray.direction = i % 12 == 1 ? can.axis : -can.axis;
        if (i % 10 == 3) {
            const glm::vec3 across = glm::cross(can.axis, someVector(draw, kind));
            if (across != glm::vec3(0))
                ray = {can.base - across, across};
        }
        const std::optional<Real> exact = canOf(ray, can);
        hits += exact.has_value();
        expectSame(rayCappedCylinderDistance(ray, can), rayCappedCylinderExact(ray, can), exact, [&] {
            return fmt::format("{} {} {} {} {:a}", text(ray.origin), text(ray.direction), text(can.base),
                               text(can.axis), can.radius);
        });
    }
    EXPECT_GT(hits, 3000);
}

TEST(RayShapes, PlaneIsMetWhereRationalsSay) {
    StressInputs draw(35);
    for (int i = 0; i < 12000; ++i) {
        const Plane plane{someVector(draw, i % 3), static_cast<float>(draw.sign()) * someSize(draw, i % 3)};
        const Ray ray = someRay(draw, i % 3, glm::vec3(0));
        const Rational height =
            dot(RationalVector(plane.normal), RationalVector(ray.origin)) + Rational(plane.offset);
        const Rational approach = dot(RationalVector(plane.normal), RationalVector(ray.direction));
        std::optional<Real> exact;
        if (height == 0)
            exact = Real(0);
        else if (approach != 0 && (approach < 0) != (height < 0))
            exact = realOf(-height / approach);
        expectSame(rayPlaneDistance(ray, plane), rayPlaneExact(ray, plane), exact, [&] {
            return fmt::format("{} {} {} {:a}", text(ray.origin), text(ray.direction), text(plane.normal),
                               plane.offset);
        });
    }
}

TEST(RayShapes, BoxIsMetWhereRationalsSay) {
    StressInputs draw(36);
    int hits = 0;
    for (int i = 0; i < 12000; ++i) {
        const glm::vec3 a = someVector(draw, i % 3);
        const glm::vec3 b = someVector(draw, i % 3);
        const Bounds box{glm::min(a, b), glm::max(a, b)};
        Ray ray = someRay(draw, i % 3, glm::mix(a, b, 0.5f));
        if (i % 4 == 0)
            ray.direction[i / 4 % 3] = i % 8 == 0 ? 0.0f : -0.0f;
        if (ray.direction == glm::vec3(0))
            continue;
        Rational enter = 0;
        std::optional<Rational> exit;
        bool outside = false;
        for (int axis = 0; axis < 3; ++axis) {
            const Rational o(ray.origin[axis]);
            const Rational d(ray.direction[axis]);
            const Rational low(box.min[axis]);
            const Rational high(box.max[axis]);
            if (d == 0) {
                outside = outside || o < low || o > high;
                continue;
            }
            Rational in = (low - o) / d;
            Rational out = (high - o) / d;
            if (out < in)
                std::swap(in, out);
            enter = in > enter ? in : enter;
            exit = exit && *exit < out ? *exit : out;
        }
        const bool exact = !outside && enter <= *exit;
        hits += exact;
        const std::optional<RaySpan> got = rayBox(ray, box);
        const std::optional<ExactSpan> quad = rayBoxExact(ray, box);
        ASSERT_EQ(got.has_value(), exact) << text(ray.origin) << text(ray.direction) << text(box.min);
        ASSERT_EQ(quad.has_value(), exact);
        if (exact) {
            EXPECT_LE(relativeError(got->enter, realOf(enter)), tError);
            EXPECT_LE(relativeError(got->exit, realOf(*exit)), tError);
            EXPECT_LE(got->enter, got->exit);
            EXPECT_LE(relativeError(static_cast<double>(quad->enter), realOf(enter)), 0x1p-52);
            EXPECT_LE(relativeError(static_cast<double>(quad->exit), realOf(*exit)), 0x1p-52);
        }
    }
    EXPECT_GT(hits, 3000);
}

TEST(RayShapes, LengthOfTheDirectionOnlyCountsInT) {
    StressInputs draw(37);
    for (int i = 0; i < 3000; ++i) {
        const Ball ball{someVector(draw, 0), someSize(draw, 0)};
        const Cylinder can{someVector(draw, 0), someVector(draw, 0), someSize(draw, 0)};
        const Plane plane{someVector(draw, 0), someSize(draw, 0)};
        const Bounds box{ball.centre - 1.0f, ball.centre + 1.0f};
        const Ray ray = someRay(draw, 0, ball.centre);
        const int exponent = static_cast<int>(draw.random().below(180)) - 90;
        const Ray longer{ray.origin, glm::vec3(std::scalbn(1.0, exponent) * glm::dvec3(ray.direction))};
        const auto same = [&](const std::optional<double>& a, const std::optional<double>& b) {
            return a.has_value() == b.has_value() &&
                   (!a || std::abs(*a - std::scalbn(*b, exponent)) <= 2 * tError * *a);
        };
        EXPECT_TRUE(same(raySphereDistance(ray, ball), raySphereDistance(longer, ball))) << i;
        EXPECT_TRUE(same(rayCylinderDistance(ray, can), rayCylinderDistance(longer, can))) << i;
        EXPECT_TRUE(same(rayCappedCylinderDistance(ray, can), rayCappedCylinderDistance(longer, can))) << i;
        EXPECT_TRUE(same(rayPlaneDistance(ray, plane), rayPlaneDistance(longer, plane))) << i;
        EXPECT_EQ(rayBox(ray, box).has_value(), rayBox(longer, box).has_value()) << i;
    }
}

TEST(RayShapes, PointsLieOnTheSurfaceAndNormalsStandOnIt) {
    StressInputs draw(38);
    double worst = 0;
    for (int i = 0; i < 6000; ++i) {
        const Ball ball{draw.vectorOfMagnitude(-3, 3), static_cast<float>(draw.magnitude(-3, 3))};
        // From up to a million radii away, where o + t d itself is off by whole radii in float.
        const glm::dvec3 away = draw.direction();
        const glm::vec3 origin(glm::dvec3(ball.centre) + ball.radius * draw.magnitude(-2, 20) * away);
        const Ray ray{origin, ball.centre + 0.7f * ball.radius * draw.unitVector() - origin};
        const std::optional<RayHit> hit = raySphere(ray, ball);
        if (!hit)
            continue;
        const glm::dvec3 out = glm::dvec3(hit->point) - glm::dvec3(ball.centre);
        const double scale = std::max({1.0f, glm::length(ball.centre) / ball.radius});
        worst = std::max(worst, std::abs(glm::length(out) / ball.radius - 1) / scale);
        EXPECT_NEAR(glm::dot(glm::normalize(out), glm::dvec3(hit->normal)), 1, 1e-6 * scale);
    }
    // Three components, each rounded by half an ulp of at most |centre| + r: √3 2^-24.
    EXPECT_LE(worst, 2 * std::sqrt(3.0) * 0x1p-24);

    const Bounds box{{-1, -2, -3}, {4, 5, 6}};
    const Cylinder can{{1, 1, 1}, {0, 0, 4}, 2};
    for (int i = 0; i < 4000; ++i) {
        const Ray ray = someRay(draw, i % 2 == 0 ? 0 : 2, draw.unitVector());
        if (const auto hit = rayBoxSurface(ray, box)) {
            bool onFace = false;
            for (int axis = 0; axis < 3; ++axis)
                if (hit->normal[axis] != 0)
                    onFace = hit->point[axis] == (hit->normal[axis] > 0 ? box.max : box.min)[axis];
            EXPECT_TRUE(onFace) << i;
        }
        if (const auto hit = rayCappedCylinder(ray, can)) {
            const glm::vec2 radial(hit->point.x - 1, hit->point.y - 1);
            if (std::abs(hit->normal.z) == 1.0f) {
                EXPECT_NEAR(hit->point.z, hit->normal.z > 0 ? 5 : 1, 1e-6);
            } else {
                EXPECT_NEAR(glm::length(radial), 2, 2e-6);
            }
            EXPECT_NEAR(glm::length(hit->normal), 1, 2e-7);
        }
        if (const auto hit = rayCylinder(ray, can)) {
            const glm::dvec2 radial(hit->point.x - 1, hit->point.y - 1);
            EXPECT_NEAR(glm::dot(glm::normalize(radial), glm::dvec2(hit->normal)), 1, 1e-6) << i;
            EXPECT_EQ(hit->normal.z, 0);
        }
    }
}

TEST(RayShapes, DegenerateInputHasADocumentedAnswer) {
    const Ray still{{0, 0, 0}, {0, 0, 0}};
    EXPECT_FALSE(raySphere(still, {{0, 0, 0}, 1}));
    EXPECT_FALSE(rayCylinder(still, {}));
    EXPECT_FALSE(rayCappedCylinder(still, {}));
    EXPECT_FALSE(rayPlane(still, {{0, 1, 0}, 0}));
    EXPECT_FALSE(rayBox(still, {{-1, -1, -1}, {1, 1, 1}}));
    const Ray up{{0, 0, -2}, {0, 0, 1}};
    EXPECT_FALSE(rayPlane(up, {{0, 0, 0}, 0}));
    EXPECT_FALSE(rayPlane(up, {{0, 0, 0}, 1}));
    EXPECT_FALSE(rayBox(up, Bounds{}));
    EXPECT_FALSE(rayCylinder(up, {{0, 0, 0}, {0, 0, 1}, 1}));
    EXPECT_FALSE(rayCappedCylinder(up, {{0, 0, 0}, {0, 0, 0}, 1}));
    EXPECT_EQ(rayCappedCylinderDistance(up, {{0, 0, 0}, {0, 0, 1}, 1}), 2.0);
    EXPECT_EQ(rayCappedCylinder(up, {{0, 0, 0}, {0, 0, 1}, 1})->normal, glm::vec3(0, 0, -1));
    // A ball without extent is met by rays through its centre alone; the normal then faces the ray.
    EXPECT_EQ(raySphereDistance(up, {{0, 0, 5}, 0}), 7.0);
    EXPECT_EQ(raySphere(up, {{0, 0, 5}, 0})->normal, glm::vec3(0, 0, -1));
    EXPECT_FALSE(raySphereDistance(up, {{0x1p-100f, 0, 5}, 0}));
    // From the surface.
    EXPECT_EQ(raySphereDistance(Ray{{0, 0, 1}, {0, 0, 1}}, Ball{{0, 0, 0}, 1}), 0.0);
    EXPECT_EQ(raySphereDistance(Ray{{0, 0, 1}, {1, 0, 0}}, Ball{{0, 0, 0}, 1}), 0.0);
    EXPECT_EQ(rayBox({{1, 0, 0}, {1, 0, 0}}, {{-1, -1, -1}, {1, 1, 1}})->exit, 0.0);
    EXPECT_EQ(rayBoxSurface({{1, 0, 0}, {0, 1, 0}}, {{-1, -1, -1}, {1, 1, 1}})->t, 0.0);
    EXPECT_EQ(rayPlaneDistance({{3, 0, 4}, {1, 0, 0}}, {{0, 1, 0}, 0}), 0.0);
}

TEST(RayShapes, WhatIsNotFiniteIsNotMet) {
    const float endless = std::numeric_limits<float>::infinity();
    const float notANumber = std::numeric_limits<float>::quiet_NaN();
    // A ray and shapes that it meets, of which one number after the other is spoilt.
    struct Everything {
        Ray ray{{0.25f, 0.125f, -4}, {0.0625f, 0.03125f, 1}};
        Ball ball{{0, 0, 0}, 1};
        Cylinder cylinder{{0, 0, -1}, {0.25f, 0.5f, 2}, 1};
        Plane plane{{0.25f, 0.5f, 1}, 0.5f};
        Bounds box{{-1, -1, -1}, {1, 1, 1}};
    };
    const auto met = [](const Everything& e) {
        return std::array<bool, 6>{raySphere(e.ray, e.ball).has_value(),
                                   rayCylinder(e.ray, e.cylinder).has_value(),
                                   rayCappedCylinder(e.ray, e.cylinder).has_value(),
                                   rayPlane(e.ray, e.plane).has_value(),
                                   rayBoxSurface(e.ray, e.box).has_value(),
                                   rayBox(e.ray, e.box).has_value()};
    };
    EXPECT_EQ(met({}), (std::array<bool, 6>{true, true, true, true, true, true}));
    for (const float wrong : {endless, -endless, notANumber})
        for (int axis = 0; axis < 3; ++axis) {
            Everything spoilt;
            spoilt.ray.origin[axis] = wrong;
            EXPECT_EQ(met(spoilt), (std::array<bool, 6>{})) << wrong << " in the origin's " << axis;
            spoilt = {};
            spoilt.ray.direction[axis] = wrong;
            EXPECT_EQ(met(spoilt), (std::array<bool, 6>{})) << wrong << " in the direction's " << axis;
            spoilt = {};
            spoilt.ball.centre[axis] = wrong;
            spoilt.cylinder.base[axis] = wrong;
            spoilt.plane.normal[axis] = wrong;
            spoilt.box.max[axis] = wrong;
            EXPECT_EQ(met(spoilt), (std::array<bool, 6>{})) << wrong << " in the shapes' " << axis;
            spoilt = {};
            spoilt.ball.radius = wrong;
            spoilt.cylinder.axis[axis] = wrong;
            spoilt.plane.offset = wrong;
            spoilt.box.min[axis] = wrong;
            EXPECT_EQ(met(spoilt), (std::array<bool, 6>{})) << wrong << " in the shapes' size " << axis;
        }
    EXPECT_FALSE(raySphereDistance(DRay{{0, notANumber, -4}, {0, 0, 1}}, DBall{}));
    EXPECT_FALSE(rayCylinder({}, {{0, 0, 0}, {1, 0, 0}, endless}));
    EXPECT_FALSE(rayCappedCylinder({}, {{0, 0, 0}, {1, 0, 0}, notANumber}));
}

TEST(RayShapes, ZeroIsPositiveAndNoDistanceIsBelowIt) {
    const auto isPlusZero = [](double t) { return t == 0 && !std::signbit(t); };
    // From faces, backwards and forwards: quotients of zeros by numbers of either sign.
    for (const float sign : {1.0f, -1.0f}) {
        const Ray ray{{0, 0.25f, 0.25f}, {sign, 0.25f, 0.25f}};
        const Bounds box{{0, 0, 0}, {1, 1, 1}};
        const std::optional<RaySpan> span = rayBox(ray, box);
        ASSERT_TRUE(span);
        EXPECT_TRUE(isPlusZero(span->enter));
        EXPECT_TRUE(sign > 0 || isPlusZero(span->exit));
        EXPECT_TRUE(isPlusZero(rayBoxSurface(ray, box)->t));
        EXPECT_TRUE(isPlusZero(*rayPlaneDistance(ray, {{sign, 0, 0}, 0})));
        EXPECT_TRUE(isPlusZero(intersectTriangle(ray, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}})->t));
        EXPECT_TRUE(isPlusZero(intersectParallelogram(ray, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}})->t));
        const std::array<glm::vec3, 4> square = {{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}};
        EXPECT_TRUE(isPlusZero(intersectPolygon(ray, square)->t));
    }
    // Numbers more than 2^100 apart, where the can is no longer exact: still not behind the origin.
    const std::optional<double> t =
        rayCappedCylinderDistance({{0x1.5af1d8p+66f, -2, -0x1p-149f}, {0x1p-75f, 0x1p-149f, 0.5f}},
                                  {{-0x1.fffffep+127f, 2, -0x1p-149f}, {0, 0, 0x1p-149f}, 0x1p+64f});
    EXPECT_TRUE(!t || *t >= 0);
}

TEST(RayShapes, AnyFiniteFloatsGiveFiniteAnswers) {
    StressInputs draw(39);
    for (int i = 0; i < 20000; ++i) {
        const Ray ray{draw.finiteVector(), draw.finiteVector()};
        const auto finite = [](const std::optional<double>& t) {
            return !t || (std::isfinite(*t) && *t >= 0);
        };
        EXPECT_TRUE(finite(raySphereDistance(ray, Ball{draw.finiteVector(), std::abs(draw.finiteFloat())})));
        EXPECT_TRUE(finite(rayCylinderDistance(
            ray, {draw.finiteVector(), draw.finiteVector(), std::abs(draw.finiteFloat())})));
        EXPECT_TRUE(finite(rayCappedCylinderDistance(
            ray, {draw.finiteVector(), draw.finiteVector(), std::abs(draw.finiteFloat())})));
        EXPECT_TRUE(finite(rayPlaneDistance(ray, {draw.finiteVector(), draw.finiteFloat()})));
        const glm::vec3 a = draw.finiteVector();
        const glm::vec3 b = draw.finiteVector();
        if (const auto span = rayBox(ray, {glm::min(a, b), glm::max(a, b)})) {
            EXPECT_TRUE(finite(span->enter) && finite(span->exit) && span->enter <= span->exit);
        }
    }
}

}  // namespace
}  // namespace quincunx

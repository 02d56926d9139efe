#include "geometry/predicates.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

#include "math/exact_sum.h"
#include "math/stress_inputs.h"
#include "tests/common/geometry/rational.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;

int exactSide(glm::vec3 o, glm::vec3 d, glm::vec3 a, glm::vec3 b) {
    const RationalVector origin(o);
    return oracle::sign(
        oracle::tripleProduct(RationalVector(d), RationalVector(a) - origin, RationalVector(b) - origin));
}

template <typename V>
int exactOrientation3(const V& a, const V& b, const V& c, const V& d) {
    const RationalVector origin(a);
    return oracle::sign(oracle::tripleProduct(RationalVector(b) - origin, RationalVector(c) - origin,
                                              RationalVector(d) - origin));
}

TEST(Orientation2D, FollowsTheHandOfTheAxes) {
    EXPECT_EQ(orientation(glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)), 1);
    EXPECT_EQ(orientation(glm::vec2(0, 0), glm::vec2(0, 1), glm::vec2(1, 0)), -1);
    EXPECT_EQ(orientation(glm::vec2(0, 0), glm::vec2(1, 1), glm::vec2(3, 3)), 0);
    EXPECT_EQ(orientation(glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1)), 1);
}

// The grid of Kettner, Mehlhorn, Pion, Schirra, Yap, "Classroom examples of robustness problems in geometric
// computations", Comput. Geom. 40, 2008: every neighbour of (½, ½) beside the line from (12, 12) to (24, 24).
template <typename V>
void expectExactOnTheGrid() {
    using Float = typename V::value_type;
    const Float ulp = std::numeric_limits<Float>::epsilon() / 2;
    int wrongNaive = 0;
    for (int i = 0; i < 256; ++i) {
        for (int j = 0; j < 256; ++j) {
            const V p(Float(0.5) + static_cast<Float>(i) * ulp, Float(0.5) + static_cast<Float>(j) * ulp);
            const V q(12, 12);
            const V r(24, 24);
            const int exact = j > i ? 1 : j < i ? -1 : 0;  // above the diagonal is to the left of q → r
            ASSERT_EQ(orientation(q, r, p), exact) << i << "," << j;
            ASSERT_EQ(orientation(p, q, r), exact);
            ASSERT_EQ(orientation(r, p, q), exact);
            ASSERT_EQ(orientation(r, q, p), -exact);
            const Float naive = orientationNaive(p, q, r);
            wrongNaive += (naive > 0) - (naive < 0) != exact ? 1 : 0;
        }
    }
    EXPECT_GT(wrongNaive, 10000);  // 18 % of 65536
}

TEST(Orientation2D, IsExactOnTheGridOfKettnerForFloat) {
    expectExactOnTheGrid<glm::vec2>();
}

TEST(Orientation2D, IsExactOnTheGridOfKettnerForDouble) {
    expectExactOnTheGrid<glm::dvec2>();
}

TEST(Orientation2D, AgreesWithRationalsForAnyFloats) {
    StressInputs draw(50);
    for (int i = 0; i < 20000; ++i) {
        glm::vec2 a(draw.finiteFloat(), draw.finiteFloat());
        glm::vec2 b(draw.finiteFloat(), draw.finiteFloat());
        // Every other time collinear up to rounding.
        const double s = draw.random().uniform(-2, 2);
        const glm::dvec2 on = glm::dvec2(a) + s * (glm::dvec2(b) - glm::dvec2(a));
        glm::vec2 c = i % 2 == 0 ? glm::vec2(on) : glm::vec2(draw.finiteFloat(), draw.finiteFloat());
        if (!std::isfinite(c.x) || !std::isfinite(c.y))
            continue;
        const int exact = oracle::orientation2(a, b, c);
        ASSERT_EQ(orientation(a, b, c), exact);
        ASSERT_EQ(orientation(b, c, a), exact);
        ASSERT_EQ(orientation(b, a, c), -exact);
    }
}

double anyDouble(StressInputs& draw) {
    for (;;) {
        const auto x = std::bit_cast<double>(draw.random().bits());
        if (std::isfinite(x))
            return x;
    }
}

TEST(Orientation2D, AgreesWithRationalsForDoublesOfTheWholeRange) {
    StressInputs draw(51);
    const double most = std::numeric_limits<double>::max();
    const double least = std::numeric_limits<double>::denorm_min();
    const double special[] = {0, least, -least, most, -most, 1, 0x1p-1022, 0x1p-540, 0x1p512};
    for (int i = 0; i < 20000; ++i) {
        const auto number = [&] {
            return i % 3 == 0 ? special[draw.random().below(std::size(special))] : anyDouble(draw);
        };
        const glm::dvec2 a(number(), number());
        const glm::dvec2 b(number(), number());
        glm::dvec2 c(number(), number());
        if (i % 3 == 1)
            c = a * 0.5 + b * 0.5;
        const int exact = oracle::orientation2(a, b, c);
        ASSERT_EQ(orientation(a, b, c), exact);
        ASSERT_EQ(orientation(c, a, b), exact);
        ASSERT_EQ(orientation(a, c, b), -exact);
    }
}

TEST(Orientation2D, AgreesWithRationalsNearLines) {
    StressInputs draw(52);
    for (int i = 0; i < 20000; ++i) {
        const double scale = draw.magnitude(-500, 500);
        const glm::dvec2 a = scale * glm::dvec2(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1));
        const glm::dvec2 b = scale * glm::dvec2(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1));
        const glm::dvec2 c = a + draw.random().uniform(-2, 2) * (b - a);
        const int exact = oracle::orientation2(a, b, c);
        ASSERT_EQ(orientation(a, b, c), exact);
        ASSERT_EQ(orientation(b, c, a), exact);
        ASSERT_EQ(orientation(c, b, a), -exact);
    }
}

TEST(Orientation3D, FollowsTheHandOfTheAxes) {
    const glm::vec3 a(0, 0, 0);
    const glm::vec3 b(1, 0, 0);
    const glm::vec3 c(0, 1, 0);
    EXPECT_EQ(orientation(a, b, c, glm::vec3(0, 0, 1)), 1);
    EXPECT_EQ(orientation(a, b, c, glm::vec3(0, 0, -1)), -1);
    EXPECT_EQ(orientation(a, b, c, glm::vec3(7, -3, 0)), 0);
    EXPECT_EQ(orientation(a, b, b, glm::vec3(0, 0, 1)), 0);
}

template <typename V, typename Draw>
void expectOrientations(const Draw& draw, int count) {
    for (int i = 0; i < count; ++i) {
        const auto [a, b, c, d] = draw(i);
        if (!isFinite(d))
            continue;
        const int exact = exactOrientation3(a, b, c, d);
        ASSERT_EQ(orientation(a, b, c, d), exact) << i;
        ASSERT_EQ(orientation(b, c, a, d), exact);
        ASSERT_EQ(orientation(b, a, c, d), -exact);
        ASSERT_EQ(orientation(a, b, d, c), -exact);
    }
}

TEST(Orientation3D, AgreesWithRationalsNearPlanes) {
    StressInputs draw(53);
    const auto near = [&]<typename V>(V, double low, double high) {
        const double scale = draw.magnitude(low, high);
        const V a(scale * draw.direction());
        const V b(scale * draw.direction());
        const V c(scale * draw.direction());
        const glm::dvec3 da(a);
        const glm::dvec3 d = da + draw.random().uniform(-1, 2) * (glm::dvec3(b) - da) +
                             draw.random().uniform(-1, 2) * (glm::dvec3(c) - da);
        return std::array<V, 4>{a, b, c, V(d)};
    };
    expectOrientations<glm::vec3>([&](int) { return near(glm::vec3(), -100, 100); }, 10000);
    expectOrientations<glm::dvec3>([&](int) { return near(glm::dvec3(), -1, 1); }, 10000);
    expectOrientations<glm::dvec3>([&](int) { return near(glm::dvec3(), -1060, 1000); }, 10000);
}

TEST(Orientation3D, AgreesWithRationalsForAnyNumbers) {
    StressInputs draw(54);
    expectOrientations<glm::vec3>(
        [&](int) {
            return std::array<glm::vec3, 4>{draw.finiteVector(), draw.finiteVector(), draw.finiteVector(),
                                            draw.finiteVector()};
        },
        10000);
    expectOrientations<glm::dvec3>(
        [&](int) {
            std::array<glm::dvec3, 4> points;
            for (glm::dvec3& p : points)
                p = {anyDouble(draw), anyDouble(draw), anyDouble(draw)};
            return points;
        },
        5000);
}

TEST(SideOfLine, AgreesWithRationalsAndChangesSignWithTheEdge) {
    StressInputs draw(55);
    int zeros = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 a = i % 3 == 0 ? draw.finiteVector() : draw.vectorOfMagnitude(-20, 20);
        const glm::vec3 b = i % 3 == 0 ? draw.finiteVector() : draw.vectorOfMagnitude(-20, 20);
        const glm::vec3 o = draw.vectorOfMagnitude(-10, 10);
        // At a point of the edge.
        const glm::vec3 d(glm::mix(glm::dvec3(a), glm::dvec3(b), draw.random().uniform(0, 1)) -
                          glm::dvec3(o));
        if (!isFinite(d))
            continue;
        const int exact = exactSide(o, d, a, b);
        zeros += exact == 0 ? 1 : 0;
        ASSERT_EQ(sideOfLine(o, d, a, b), exact);
        ASSERT_EQ(sideOfLine(o, d, b, a), -exact);
        ASSERT_EQ(sideOfLine(o, -d, a, b), -exact);
    }
    EXPECT_EQ(sideOfLine({0, 0, 1}, {0, 0, -1}, {-1, -1, 0}, {1, 1, 0}), 0);
}

TEST(SideOfLine, IsNegativeForAllEdgesOfATriangleSeenFromItsFront) {
    const glm::vec3 a(0, 0, 0);
    const glm::vec3 b(1, 0, 0);
    const glm::vec3 c(0, 1, 0);
    const glm::vec3 o(0.25f, 0.25f, 1);
    const glm::vec3 d(0, 0, -1);
    EXPECT_EQ(sideOfLine(o, d, a, b), -1);
    EXPECT_EQ(sideOfLine(o, d, b, c), -1);
    EXPECT_EQ(sideOfLine(o, d, c, a), -1);
}

TEST(Facing, TellsFrontFromBackAndEdgeOn) {
    const glm::vec3 a(0, 0, 0);
    const glm::vec3 b(1, 0, 0);
    const glm::vec3 c(0, 1, 0);
    EXPECT_EQ(facing(a, b, c, {5, 5, 0x1p-149f}), Facing::front);
    EXPECT_EQ(facing(a, b, c, {5, 5, -0x1p-149f}), Facing::back);
    EXPECT_EQ(facing(a, b, c, {5, 5, 0}), Facing::edgeOn);
    EXPECT_EQ(facing(a, b, a, {5, 5, 1}), Facing::edgeOn);
    EXPECT_EQ(facingAlong(a, b, c, {1, 1, -0x1p-149f}), Facing::front);
    EXPECT_EQ(facingAlong(a, b, c, {1, 1, 0x1p-149f}), Facing::back);
    EXPECT_EQ(facingAlong(a, b, c, {1, 1, 0}), Facing::edgeOn);
    EXPECT_EQ(facingOnScreen({0, 0}, {1, 0}, {0, 1}), Facing::front);
}

TEST(Facing, AgreesWithRationalsForGrazingEyes) {
    StressInputs draw(56);
    int wrongNaive = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 a = draw.vectorOfMagnitude(-2, 2);
        const glm::vec3 b = draw.vectorOfMagnitude(-2, 2);
        const glm::vec3 c = draw.vectorOfMagnitude(-2, 2);
        const glm::dvec3 along = draw.random().uniform(-4, 4) * (glm::dvec3(b) - glm::dvec3(a)) +
                                 draw.random().uniform(-4, 4) * (glm::dvec3(c) - glm::dvec3(a));
        const glm::vec3 eye(glm::dvec3(a) + along);
        const glm::vec3 view(along);
        const int exact = exactOrientation3(a, b, c, eye);
        const int exactAlong = exactSide(a, view, b, c);
        ASSERT_EQ(static_cast<int>(facing(a, b, c, eye)), exact);
        ASSERT_EQ(static_cast<int>(facing(a, c, b, eye)), -exact);
        ASSERT_EQ(static_cast<int>(facingAlong(a, b, c, view)), -exactAlong);
        wrongNaive += static_cast<int>(facingNaive(a, b, c, eye)) != exact ? 1 : 0;
        wrongNaive += static_cast<int>(facingAlongNaive(a, b, c, view)) != -exactAlong ? 1 : 0;
    }
    EXPECT_GT(wrongNaive, 1000);
}

}  // namespace
}  // namespace quincunx

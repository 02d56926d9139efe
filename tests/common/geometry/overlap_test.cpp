#include "geometry/overlap.h"

#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "geometry/intersection_oracle.h"
#include "math/stress_inputs.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;

int signOf(const Rational& x) {
    return x < 0 ? -1 : x > 0 ? 1 : 0;
}

Rational valueOf(const Plane& plane, glm::vec3 p) {
    return dot(RationalVector(plane.normal), RationalVector(p)) + Rational(plane.offset);
}

glm::vec3 someVector(StressInputs& draw, int kind) {
    if (kind == 0)
        return draw.vectorOfMagnitude(-3, 3);
    if (kind == 1)
        return draw.finiteVector();
    glm::vec3 v;
    for (int axis = 0; axis < 3; ++axis)
        v[axis] = static_cast<float>(static_cast<int>(draw.random().below(7)) - 3);
    return v;
}

float someSize(StressInputs& draw, int kind) {
    return kind == 0   ? static_cast<float>(draw.magnitude(-2, 2))
           : kind == 1 ? std::abs(draw.finiteFloat())
                       : static_cast<float>(draw.random().below(5));
}

TEST(Overlap, BallsTouchWhereRationalsSay) {
    StressInputs draw(1);
    int touching = 0;
    for (int i = 0; i < 30000; ++i) {
        const Ball a{someVector(draw, i % 3), someSize(draw, i % 3)};
        const Ball b{someVector(draw, i % 3), someSize(draw, i % 3)};
        const RationalVector d = RationalVector(a.centre) - RationalVector(b.centre);
        const Rational reach = Rational(a.radius) + Rational(b.radius);
        const Rational apart = dot(d, d) - reach * reach;
        touching += apart == 0;
        ASSERT_EQ(ballsOverlap(a, b), apart <= 0) << i;
        ASSERT_EQ(ballsOverlap(b, a), apart <= 0) << i;
        ASSERT_EQ(ballsOverlapExact(a, b), apart <= 0) << i;
    }
    EXPECT_GT(touching, 100);
}

TEST(Overlap, PlaneValueHasTheExactSignAndNearlyTheValue) {
    StressInputs draw(2);
    for (int i = 0; i < 30000; ++i) {
        const Plane plane{someVector(draw, i % 3), static_cast<float>(draw.sign()) * someSize(draw, i % 3)};
        const glm::vec3 p = someVector(draw, i % 3);
        const Rational exact = valueOf(plane, p);
        const double got = planeValue(plane, p);
        ASSERT_EQ((got > 0) - (got < 0), signOf(exact)) << i;
        ASSERT_EQ(planeSignExact(plane, p), signOf(exact)) << i;
        if (exact != 0) {
            ASSERT_LE(std::abs(static_cast<double>(Rational((Rational(got) - exact) / exact))), 0x1p-32) << i;
        }
    }
}

TEST(Overlap, BallsBoxesAndHullsAreOnTheSideThatRationalsSay) {
    StressInputs draw(3);
    int crossing = 0;
    for (int i = 0; i < 20000; ++i) {
        const int kind = i % 3;
        Plane plane{someVector(draw, kind), static_cast<float>(draw.sign()) * someSize(draw, kind)};
        const Ball ball{someVector(draw, kind), someSize(draw, kind)};
        const Rational value = valueOf(plane, ball.centre);
        const RationalVector n(plane.normal);
        const bool meets = value * value <= Rational(ball.radius) * Rational(ball.radius) * dot(n, n);
        const Side side = meets ? Side::crossing : value < 0 ? Side::behind : Side::inFront;
        ASSERT_EQ(sideOf(ball, plane), side) << i;
        ASSERT_EQ(ballMeetsPlaneExact(ball, plane), meets) << i;

        const glm::vec3 a = someVector(draw, kind);
        const glm::vec3 b = someVector(draw, kind);
        const Bounds box{glm::min(a, b), glm::max(a, b)};
        int lowest = 1;
        int highest = -1;
        for (const glm::vec3& corner : cornersOf(box)) {
            lowest = std::min(lowest, signOf(valueOf(plane, corner)));
            highest = std::max(highest, signOf(valueOf(plane, corner)));
        }
        const Side boxSide = lowest > 0 ? Side::inFront : highest < 0 ? Side::behind : Side::crossing;
        crossing += boxSide == Side::crossing;
        ASSERT_EQ(sideOf(box, plane), boxSide) << i;
        ASSERT_EQ(sideByEightCorners(box, plane), boxSide) << i;
    }
    EXPECT_GT(crossing, 2000);
}

TEST(Overlap, TurningThePlaneRoundSwapsTheSides) {
    StressInputs draw(4);
    for (int i = 0; i < 5000; ++i) {
        const Plane plane{someVector(draw, i % 3), static_cast<float>(draw.sign()) * someSize(draw, i % 3)};
        const Plane turned{-plane.normal, -plane.offset};
        const std::array<glm::vec3, 4> corners{someVector(draw, i % 3), someVector(draw, i % 3),
                                               someVector(draw, i % 3), someVector(draw, i % 3)};
        EXPECT_EQ(static_cast<int>(sideOf(corners, plane)), -static_cast<int>(sideOf(corners, turned)));
        const Ball ball{corners[0], someSize(draw, i % 3)};
        EXPECT_EQ(static_cast<int>(sideOf(ball, plane)), -static_cast<int>(sideOf(ball, turned)));
    }
    EXPECT_EQ(sideOf(std::span<const glm::vec3>(), Plane{}), Side::crossing);
    EXPECT_EQ(sideOf(Ball{}, Plane{{0, 0, 0}, 0}), Side::crossing);
}

TEST(Overlap, BallTouchesBoxAtTheNearestPoint) {
    const Bounds box{{0, 0, 0}, {2, 2, 2}};
    EXPECT_TRUE(overlaps(Ball{{1, 1, 1}, 0}, box));
    EXPECT_TRUE(overlaps(Ball{{4, 1, 1}, 2}, box));
    EXPECT_FALSE(overlaps(Ball{{4, 1, 1}, std::nextafter(2.0f, 0.0f)}, box));
    EXPECT_TRUE(overlaps(Ball{{3, 4, 4}, 3}, box));  // (1, 2, 2) from the corner
    EXPECT_FALSE(overlaps(Ball{{3, 4, 4}, std::nextafter(3.0f, 0.0f)}, box));
    EXPECT_FALSE(overlaps(Ball{{0, 0, 0}, 1}, Bounds{}));
    EXPECT_TRUE(boxesOverlap(box, {{2, 2, 2}, {3, 3, 3}}));
    EXPECT_FALSE(boxesOverlap(box, {{std::nextafter(2.0f, 3.0f), 0, 0}, {3, 3, 3}}));
    EXPECT_FALSE(boxesOverlap(box, Bounds{}));
}

TEST(Overlap, FrustumKeepsWhatIsSeenAndDropsWhatIsFarOutside) {
    StressInputs draw(5);
    int dropped = 0;
    int seen = 0;
    for (int i = 0; i < 4000; ++i) {
        const glm::dvec3 eye = draw.magnitude(0, 20) * draw.direction();
        const glm::dvec3 forward = draw.direction();
        const glm::dmat4 clipFromWorld = glm::perspective(1.0, 1.6, 0.01, 1e4) *
                                         glm::lookAt(eye, eye + forward, draw.perpendicular(forward));
        const Frustum frustum = frustumOf(clipFromWorld);
        const glm::vec3 centre(eye + draw.magnitude(-4, 10) * draw.turned(forward, -4, 1.5));
        const float half = static_cast<float>(draw.magnitude(-6, 2));
        const Bounds box{centre - half, centre + half};
        bool visible = false;
        for (int k = 0; k < 40; ++k) {
            glm::dvec3 p;
            for (int axis = 0; axis < 3; ++axis)
                p[axis] = draw.random().uniform(box.min[axis], box.max[axis]);
            const glm::dvec4 clip = clipFromWorld * glm::dvec4(p, 1);
            visible = visible || (std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w &&
                                  std::abs(clip.z) <= clip.w);
        }
        seen += visible;
        if (visible) {
            EXPECT_TRUE(mayBeVisible(box, frustum)) << i;
            EXPECT_TRUE(mayBeVisible(Ball{centre, 1.8f * half}, frustum)) << i;
        }
        dropped += !mayBeVisible(box, frustum);
        // Behind the eye, by more than the box reaches.
        const glm::vec3 behind(eye - (4.0 * half + 1) * forward);
        EXPECT_FALSE(mayBeVisible({behind - half, behind + half}, frustum)) << i;
        EXPECT_FALSE(mayBeVisible(Ball{behind, half}, frustum)) << i;
    }
    EXPECT_GT(seen, 300);
    EXPECT_GT(dropped, 300);
    EXPECT_FALSE(mayBeVisible(Bounds{}, frustumOf(glm::dmat4(1))));
    EXPECT_TRUE(mayBeVisible({{1, 1, 1}, {2, 2, 2}}, frustumOf(glm::dmat4(1))));
}

TEST(Overlap, FrustumKeepsPointsThatAreJustInside) {
    using oracle::Rational;
    StressInputs draw(110);
    int inside = 0;
    for (int i = 0; i < 20'000; ++i) {
        // A matrix whose left plane goes through the point, but for rounding; the point is in the middle of
        // the others.
        const glm::vec3 p = draw.vectorOfMagnitude(-4, 20);
        const glm::dvec3 x(draw.magnitude(-2, 2) * draw.direction());
        glm::dvec4 last(draw.direction(), 0);
        last.w = draw.magnitude(-20, 4) * draw.sign() - glm::dot(glm::dvec3(last), glm::dvec3(p));
        if (glm::dot(last, glm::dvec4(glm::dvec3(p), 1)) < 0)
            last = -last;
        glm::dmat4 rows(0);
        rows[3] = last;
        rows[0] = glm::dvec4(x, -glm::dot(last, glm::dvec4(glm::dvec3(p), 1)) - glm::dot(x, glm::dvec3(p)));
        Rational w = Rational(last.w);
        Rational fromLeft = Rational(last.w) + Rational(rows[0].w);
        for (int axis = 0; axis < 3; ++axis) {
            const Rational coordinate(static_cast<double>(p[axis]));
            w += Rational(last[axis]) * coordinate;
            fromLeft += (Rational(last[axis]) + Rational(rows[0][axis])) * coordinate;
        }
        if (w < 0 || fromLeft < 0 || fromLeft > 2 * w)
            continue;
        ++inside;
        const Frustum frustum = frustumOf(glm::transpose(rows));
        EXPECT_TRUE(mayBeVisible(Bounds{p, p}, frustum)) << i;
        EXPECT_TRUE(mayBeVisible(Ball{p, 0}, frustum)) << i;
    }
    EXPECT_GT(inside, 8000);
}

TEST(Overlap, WhatIsNotANumberOverlapsNothingAndIsOnNoSide) {
    const float notANumber = std::numeric_limits<float>::quiet_NaN();
    const Ball ball{{0, notANumber, 0}, 1};
    EXPECT_FALSE(ballsOverlap(ball, Ball{}));
    EXPECT_FALSE(ballsOverlap(Ball{}, Ball{{0, 0, 0}, notANumber}));
    EXPECT_EQ(sideOf(ball, Plane{}), Side::crossing);
    EXPECT_EQ(sideOf(Ball{}, Plane{{0, notANumber, 0}, 1}), Side::crossing);
    EXPECT_EQ(sideOf(Bounds{{-1, -1, -1}, {1, 1, 1}}, Plane{{0, 1, 0}, notANumber}), Side::crossing);
    const float endless = std::numeric_limits<float>::infinity();
    EXPECT_EQ(sideOf(Ball{{endless, 0, 0}, 1}, Plane{}), Side::crossing);
    EXPECT_FALSE(ballsOverlap(Ball{{endless, 0, 0}, 1}, Ball{{endless, 0, 0}, 1}));
}

}  // namespace
}  // namespace quincunx

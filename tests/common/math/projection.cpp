#include "math/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::Real;

constexpr double halfUlp = 0.5 + 0x1p-26;
constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(Perspective, IsRoundedOnceInEveryEntry) {
    StressInputs draw(1);
    for (int i = 0; i < 10000; ++i) {
        const auto fovY = static_cast<float>(draw.random().uniform(1e-6, 3.1415));
        const auto aspect = static_cast<float>(draw.magnitude(-6, 6));
        const auto near = static_cast<float>(draw.magnitude(-60, 60));
        const float far = std::max(static_cast<float>(near * (1 + draw.magnitude(-22, 66))),
                                   std::nextafter(near, infinity));
        const glm::mat4 clipFromCamera = perspective(fovY, aspect, near, far);
        const Real cotangent = 1 / tan(Real(fovY) / 2);
        const Rational n(near);
        const Rational f(far);
        ASSERT_LE(ulpError(clipFromCamera[0][0], Real(cotangent / Real(aspect))), halfUlp);
        ASSERT_LE(ulpError(clipFromCamera[1][1], cotangent), halfUlp);
        ASSERT_LE(ulpError(clipFromCamera[2][2], Rational(-(f + n) / (f - n))), halfUlp);
        ASSERT_LE(ulpError(clipFromCamera[3][2], Rational(-2 * n * f / (f - n))), halfUlp)
            << near << " " << far;
        ASSERT_EQ(clipFromCamera[2][3], -1);
    }
}

TEST(Perspective, TakesTheNearAndFarPlanesToMinusAndPlusOne) {
    const glm::mat4 clipFromCamera = perspective(1.0f, 1.5f, 0.5f, 8.0f);
    const glm::vec4 near = clipFromCamera * glm::vec4(0, 0, -0.5f, 1);
    const glm::vec4 far = clipFromCamera * glm::vec4(0, 0, -8, 1);
    EXPECT_NEAR(near.z / near.w, -1, 2e-7);
    EXPECT_NEAR(far.z / far.w, 1, 2e-7);
    // A point on the upper edge of the view lands on the upper edge of clip space.
    const glm::vec4 edge = clipFromCamera * glm::vec4(0, 2 * std::tan(0.5f), -2, 1);
    EXPECT_NEAR(edge.y / edge.w, 1, 2e-7);
}

TEST(Perspective, WithInfiniteFarKeepsPointsAtInfinityOnTheFarPlane) {
    const glm::mat4 clipFromCamera = perspective(1.0f, 1.0f, 0.1f, infinity);
    StressInputs draw(2);
    for (int i = 0; i < 10000; ++i) {
        glm::vec3 direction = draw.unitVector();
        direction.z = -std::abs(direction.z);
        const glm::vec4 clip = clipFromCamera * glm::vec4(direction, 0);
        ASSERT_EQ(clip.z, clip.w);
    }
    EXPECT_EQ(clipFromCamera[3][2], -0.2f);
    // The limit of ever farther planes.
    EXPECT_EQ(perspective(1.0f, 1.0f, 0.1f, 1e30f), clipFromCamera);
}

TEST(Perspective, RefusesWrongArguments) {
    EXPECT_DEATH(perspective(0.0f, 1.0f, 0.1f, 1.0f), "fovYRadians");
    EXPECT_DEATH(perspective(3.1415927f, 1.0f, 0.1f, 1.0f), "fovYRadians");
    EXPECT_DEATH(perspective(1.0f, 0.0f, 0.1f, 1.0f), "aspect");
    EXPECT_DEATH(perspective(1.0f, 1.0f, 0.0f, 1.0f), "nearDistance");
    EXPECT_DEATH(perspective(1.0f, 1.0f, 1.0f, 1.0f), "nearDistance");
    EXPECT_DEATH(perspective(std::nanf(""), 1.0f, 0.1f, 1.0f), "fovYRadians");
}

TEST(ReversedDepth, KeepsNeighboursApartWhereTheUsualDepthDoesNot) {
    const glm::mat4 reversed = perspectiveReversed(1.0f, 1.0f, 0.1f);
    const glm::mat4 usual = perspective(1.0f, 1.0f, 0.1f, 1e6f);
    const auto depth = [](const glm::mat4& m, float distance) {
        return (m[2][2] * -distance + m[3][2]) / (m[2][3] * -distance);
    };
    StressInputs draw(3);
    int usualTies = 0;
    for (int i = 0; i < 50000; ++i) {
        const auto distance = static_cast<float>(draw.magnitude(-3, 19));
        const float farther = distance * (1 + 0x1p-12f);
        ASSERT_GT(depth(reversed, distance), depth(reversed, farther));
        usualTies += depth(usual, distance) >= depth(usual, farther) ? 1 : 0;
    }
    EXPECT_GT(usualTies, 15000);  // measured: 21 600
}

// Two roundings of half an ulp: 2^-23 at most, reached where near is a power of two. Where the mantissa of
// near is m, at most 2^-24 (1 + 1/m): 9.7e-8 for 0.1, 1.06e-7 for 0.01.
TEST(ReversedDepth, GivesTheDistanceBack) {
    StressInputs draw(4);
    for (const auto& [near, bound] :
         {std::pair(0.1f, 9.7e-8), std::pair(0.01f, 1.07e-7), std::pair(0.5f, 0x1p-23)}) {
        const glm::mat4 m = perspectiveReversed(1.0f, 1.0f, near);
        double worst = 0;
        for (int i = 0; i < 50000; ++i) {
            const auto distance = static_cast<float>(near * draw.magnitude(0, 40));
            const float depth = (m[2][2] * -distance + m[3][2]) / distance;
            const double back = distanceFromReversedDepth(depth, near);
            worst = std::max(worst, std::abs(back / distance - 1));
        }
        EXPECT_LE(worst, bound) << near;
    }
    EXPECT_EQ(distanceFromReversedDepth(0, 0.1f), infinity);
}

TEST(Orthographic, IsRoundedOnceInEveryEntry) {
    StressInputs draw(5);
    for (int i = 0; i < 5000; ++i) {
        const auto draw1 = [&] { return static_cast<float>(draw.sign() * draw.magnitude(-20, 20)); };
        const float left = draw1(), right = draw1(), bottom = draw1(), top = draw1(), near = draw1(),
                    far = draw1();
        const glm::mat4 m = orthographic(left, right, bottom, top, near, far);
        const Rational l(left), r(right), n(near), f(far);
        ASSERT_LE(ulpError(m[0][0], Rational(2 / (r - l))), halfUlp);
        ASSERT_LE(ulpError(m[3][0], Rational(-(r + l) / (r - l))), halfUlp);
        ASSERT_LE(ulpError(m[2][2], Rational(-2 / (f - n))), halfUlp);
        ASSERT_LE(ulpError(m[3][2], Rational(-(f + n) / (f - n))), halfUlp);
    }
    const glm::vec4 corner = orthographic(-2, 6, 1, 3, 0, 10) * glm::vec4(6, 1, -10, 1);
    EXPECT_EQ(corner, glm::vec4(1, -1, 1, 1));
    EXPECT_DEATH(orthographic(1, 1, 0, 1, 0, 1), "left");
}

TEST(DepthDistance, UndoesThePerspective) {
    StressInputs draw(6);
    for (int i = 0; i < 20000; ++i) {
        const auto near = static_cast<float>(draw.magnitude(-10, 10));
        const float far = i % 4 == 0 ? infinity : static_cast<float>(near * draw.magnitude(1, 30));
        const auto depth = static_cast<float>(draw.random().uniform());
        const Rational n(near);
        const Rational d(depth);
        const Rational share = far == infinity ? Rational(0) : Rational(n / Rational(far));
        const Rational exact = n / ((1 - d) + d * share);
        ASSERT_LE(ulpError(distanceFromDepth(depth, near, far), exact), halfUlp);
    }
    EXPECT_EQ(distanceFromDepth(0, 0.1f, 100), 0.1f);
    EXPECT_EQ(distanceFromDepth(1, 0.1f, 100), 100);
    EXPECT_EQ(distanceFromDepth(1, 0.1f, infinity), infinity);
}

TEST(ObliqueNear, PlaneBecomesTheNearPlaneAndNothingElseMoves) {
    StressInputs draw(7);
    for (int i = 0; i < 5000; ++i) {
        const float far = i % 3 == 0 ? infinity : 500.0f;
        const glm::mat4 clipFromEye = perspective(1.0f, 1.5f, 0.25f, far);
        glm::dvec3 normal = draw.direction();
        normal.z = -std::abs(normal.z) - 0.2;
        const double away = draw.magnitude(0, 5);
        const glm::vec4 plane(draw.magnitude(-30, 30) * glm::dvec4(normal, normal.z * away));
        const glm::mat4 oblique = withNearPlane(clipFromEye, plane).value();
        for (int k = 0; k < 8; ++k) {
            // A point on the plane, and one of the frustum.
            const double x = draw.random().uniform(-9, 9);
            const double y = draw.random().uniform(-9, 9);
            const glm::dvec4 on(x, y, -(plane.x * x + plane.y * y + plane.w) / plane.z, 1);
            const glm::dvec4 onClip = glm::dmat4(oblique) * on;
            // Rounding of the third row to float: 2^-24 of each of its three terms.
            const glm::dmat4 rows(oblique);
            const double terms = std::abs(rows[0][2] * on.x) + std::abs(rows[1][2] * on.y) +
                                 std::abs(rows[2][2] * on.z) + std::abs(rows[3][2]);
            ASSERT_NEAR(onClip.z + onClip.w, 0, 0x1p-23 * terms);
            const double distance = draw.magnitude(-1, 8);
            const glm::dvec4 inside(distance * draw.random().uniform(-0.7, 0.7),
                                    distance * draw.random().uniform(-0.5, 0.5), -distance, 1);
            const glm::dvec4 before = glm::dmat4(clipFromEye) * inside;
            const glm::dvec4 after = glm::dmat4(oblique) * inside;
            ASSERT_EQ((glm::dvec3(before.x, before.y, before.w)), (glm::dvec3(after.x, after.y, after.w)));
            const double side = glm::dot(glm::dvec4(plane), inside) / glm::length(glm::dvec3(plane));
            if (std::abs(side) > 1e-4 * distance) {
                ASSERT_EQ(after.z > -after.w, side > 0);
            }
            // What the old frustum held beyond the plane is still before the far plane.
            if (side > 0 && before.z < before.w) {
                ASSERT_LE(after.z, after.w * (1 + 1e-5));
            }
        }
    }
}

TEST(ObliqueNear, RefusesPlanesThatNoFrustumHas) {
    const glm::mat4 clipFromEye = perspective(1.0f, 1.5f, 0.25f, 100.0f);
    EXPECT_TRUE(withNearPlane(clipFromEye, {0, 0, -1, -2}).has_value());
    EXPECT_FALSE(withNearPlane(clipFromEye, {0, 0, -1, 0}).has_value());  // through the eye
    EXPECT_FALSE(withNearPlane(clipFromEye, {0, 0, -1, 2}).has_value());  // behind the eye
    EXPECT_FALSE(withNearPlane(clipFromEye, {0, 0, 1, -2}).has_value());  // nothing of the frustum in front
    EXPECT_FALSE(withNearPlane(clipFromEye, {0, 0, 0, -2}).has_value());
    EXPECT_FALSE(withNearPlane(clipFromEye, {0, infinity, -1, -2}).has_value());
    EXPECT_FALSE(withNearPlane(glm::mat4(0), {0, 0, -1, -2}).has_value());
    const glm::mat4 box = orthographic(-1, 1, -1, 1, 0, 10);
    const glm::mat4 cut = withNearPlane(box, {0, 0, -1, -4}).value();
    EXPECT_NEAR((cut * glm::vec4(0, 0, -4, 1)).z, -1, 4e-7);
    EXPECT_NEAR((cut * glm::vec4(0, 0, -10, 1)).z, 1, 4e-7);
}

}  // namespace
}  // namespace quincunx

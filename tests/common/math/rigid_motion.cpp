#include "math/rigid_motion.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "math/exact.h"
#include "math/projection.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/vector.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Real;
using oracle::RealVector;

constexpr double u = 0x1p-53;
constexpr double pi = std::numbers::pi;
constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// The largest entry of |RᵀR − I|.
double departure(const glm::mat3& r) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            worst = std::max(worst, std::abs(dotInDouble(r[i], r[j]) - (i == j ? 1 : 0)));
    return worst;
}

double largestDifference(const glm::dmat3& a, const glm::dmat3& b) {
    double worst = 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            worst = std::max(worst, std::abs(a[column][row] - b[column][row]));
    return worst;
}

/// How far z has turned to the left from the world's +z, by the direction it faces.
double heading(const glm::dmat3& worldFromBody) {
    return std::atan2(worldFromBody[2].x, worldFromBody[2].z);
}

Orientation anyOrientation(StressInputs& draw) {
    Orientation result;
    result.turnAboutWorld(draw.direction(), draw.random().uniform(-pi, pi));
    return result;
}

TEST(TurnMatrix, IsRodriguesFormulaInManyDigits) {
    StressInputs draw(3);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
        const glm::dvec3 axis = draw.doubleVectorOfMagnitude(-1000, 1000);
        const double radians = draw.sign() * draw.magnitude(-60, 60);
        const glm::dmat3 got = turnMatrix(axis, radians);
        const RealVector n = oracle::normalize(RealVector(axis));
        const Real c = cos(Real(radians));
        const Real s = sin(Real(radians));
        for (int column = 0; column < 3; ++column) {
            glm::dvec3 unit(0);
            unit[column] = 1;
            const RealVector e(unit);
            const RealVector exact = c * e + s * cross(n, e) + (1 - c) * dot(n, e) * n;
            worst = std::max({worst, std::abs(static_cast<double>(Real(got[column].x) - exact.x)),
                              std::abs(static_cast<double>(Real(got[column].y) - exact.y)),
                              std::abs(static_cast<double>(Real(got[column].z) - exact.z))});
        }
    }
    EXPECT_LE(worst, 16 * u) << worst / u;  // measured 8 u
}

TEST(TurnMatrix, TurnsLeftFromZToX) {
    EXPECT_LE(largestDifference(turnMatrix(glm::dvec3(0, 5, 0), pi / 2),
                                glm::dmat3(glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0))),
              4 * u);
}

TEST(TurnMatrix, IsTheIdentityWhereThereIsNoTurn) {
    for (const glm::vec3 axis : {glm::vec3(0), glm::vec3(inf, 0, 0), glm::vec3(0, nan, 0)})
        EXPECT_EQ(turnMatrix(axis, 1.0f), glm::mat3(1));
    for (const float radians : {0.0f, inf, nan})
        EXPECT_EQ(turnMatrix(glm::vec3(0, 1, 0), radians), glm::mat3(1));
}

TEST(GramSchmidt, KeepsTheFacingDirectionAndUnmirrors) {
    StressInputs draw(4);
    for (int i = 0; i < 2000; ++i) {
        const glm::mat3 frame(draw.vectorOfMagnitude(-30, 30), draw.vectorOfMagnitude(-30, 30),
                              draw.vectorOfMagnitude(-30, 30));
        const std::optional<glm::mat3> made = gramSchmidt(frame);
        ASSERT_TRUE(made);
        EXPECT_LE(departure(*made), 1.1e-7);
        EXPECT_GT(determinant(*made), 0);
        EXPECT_LE(*angleBetween((*made)[2], frame[2]), 1e-7f);
        EXPECT_GT(dotInDouble((*made)[1], frame[1]), 0);
    }
}

TEST(GramSchmidt, AgreesWithDuffsBasis) {
    StressInputs draw(5);
    for (int i = 0; i < 4000; ++i) {
        const glm::dvec3 facing = draw.nearAxis();
        const glm::mat3 frame(draw.unitVector(), draw.turned(facing, -20, 0), facing);
        const std::optional<glm::mat3> one = gramSchmidt(frame);
        const std::optional<glm::mat3> other = orthonormalizedByDuff(frame);
        ASSERT_EQ(one.has_value(), other.has_value());
        if (!one)
            continue;
        const double across = glm::length(crossInDouble(frame[1], frame[2]));
        EXPECT_LE(largestDifference(glm::dmat3(*one), glm::dmat3(*other)), 0x1p-24 + 16 * u / across);
        EXPECT_LE(departure(*other), 1.1e-7);
    }
}

TEST(GramSchmidt, HasNoAnswerForParallelAxes) {
    const glm::vec3 z(0.1f, 0.2f, 0.3f);
    for (const glm::vec3 y : {z, -2.0f * z, glm::vec3(0), glm::vec3(nan, 0, 0), glm::vec3(inf, 1, 0)}) {
        EXPECT_FALSE(gramSchmidt(glm::mat3(glm::vec3(1, 0, 0), y, z)));
        EXPECT_FALSE(orthonormalizedByDuff(glm::mat3(glm::vec3(1, 0, 0), y, z)));
    }
    EXPECT_TRUE(gramSchmidt(glm::mat3(glm::vec3(0), {0, 0x1p-149f, 0}, {0, 0, 0x1p-149f})));
}

TEST(NearestRotation, UndoesAStretchAlongAnyAxes) {
    StressInputs draw(6);
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
        // M = R S with S symmetric and positive: the polar decomposition itself.
        const glm::dmat3 rotation = draw.rotation();
        const glm::dmat3 v = draw.rotation();
        const glm::dvec3 sigma(1, draw.magnitude(-3, 3), draw.magnitude(-3, 3));
        const glm::dmat3 stretch =
            glm::dmat3(sigma.x * v[0], sigma.y * v[1], sigma.z * v[2]) * glm::transpose(v);
        const glm::mat3 m(rotation * stretch);
        const std::optional<glm::mat3> nearest = nearestRotation(m);
        ASSERT_TRUE(nearest);
        EXPECT_LE(departure(*nearest), 1.1e-7);
        const double smallest = std::min({sigma.x, sigma.y, sigma.z});
        const double largest = std::max({sigma.x, sigma.y, sigma.z});
        worst = std::max(worst,
                         largestDifference(glm::dmat3(*nearest), rotation) / (0x1p-24 * largest / smallest));
    }
    // The rounding of M to float, 3 entries of 2^-25 σ1 a column, over σ2 + σ3, at least 2 σ3.
    EXPECT_LE(worst, 3);  // measured 0.6
}

TEST(NearestRotation, IsNotBeatenByItsNeighbours) {
    StressInputs draw(7);
    for (int i = 0; i < 300; ++i) {
        const glm::dmat3 m =
            glm::dmat3(glm::mat3(draw.rotation() * glm::dmat3(glm::dvec3(1, 0.3, -0.2), glm::dvec3(0, 2, 0.5),
                                                              glm::dvec3(0.1, 0, 0.7))));
        const glm::dmat3 nearest(*nearestRotation(glm::mat3(m)));
        const auto distance = [&](const glm::dmat3& r) {
            const glm::dmat3 d = m - r;
            return glm::dot(d[0], d[0]) + glm::dot(d[1], d[1]) + glm::dot(d[2], d[2]);
        };
        for (int k = 0; k < 20; ++k)
            EXPECT_LT(distance(nearest), distance(nearest * turnMatrix(draw.direction(), 1e-3)));
    }
}

TEST(NearestRotation, HasNoAnswerForMirroredFlatAndEndlessFrames) {
    EXPECT_FALSE(nearestRotation(glm::mat3(glm::vec3(-1, 0, 0), {0, 1, 0}, {0, 0, 1})));
    EXPECT_FALSE(nearestRotation(glm::mat3(0)));
    EXPECT_FALSE(nearestRotation(glm::mat3(glm::vec3(1, 2, 3), {2, 4, 6}, {0, 0, 1})));
    EXPECT_FALSE(nearestRotation(glm::mat3(inf)));
    EXPECT_FALSE(nearestRotation(glm::mat3(nan)));
    EXPECT_TRUE(nearestRotation(glm::mat3(0x1p-140f)));
    EXPECT_TRUE(nearestRotation(glm::mat3(0x1p127f)));
}

TEST(NearestRotation, OneNewtonSchulzStepMendsASmallDrift) {
    StressInputs draw(8);
    for (int i = 0; i < 1000; ++i) {
        glm::dmat3 drifted = draw.rotation();
        for (int column = 0; column < 3; ++column)
            drifted[column] += 3e-5 * draw.direction();
        EXPECT_LE(departure(newtonSchulzStep(glm::mat3(drifted))), 1.1e-7 + 3e-8);
    }
}

TEST(TurnLeft, TheCardsFrameIsMirroredAndTurnsRight) {
    glm::mat3 card(1);
    glm::mat3 corrected(1);
    Orientation exact;
    for (int i = 0; i < 157; ++i) {
        card = turnLeftMirroredNaive(card, 0.01f);
        corrected = turnLeftNaive(corrected, 0.01f);
        exact.turnAboutBody({0, 1, 0}, std::atan(0.01));
        ASSERT_LT(determinant(card), 0);
        ASSERT_GT(determinant(corrected), 0);
    }
    const double expected = 157 * std::atan(0.01);
    EXPECT_NEAR(heading(glm::dmat3(corrected)), expected, 1e-4);
    EXPECT_NEAR(heading(exact.worldFromBody()), expected, 157 * 16 * u);
    // The first press goes left, the 156 others right.
    EXPECT_NEAR(heading(glm::dmat3(card)), -155 * std::atan(0.01), 1e-3);
}

TEST(Turned, StaysOrthonormalForAMillionTurnsWhereTheProductDoesNot) {
    glm::mat3 naive(1);
    glm::mat3 stable(1);
    const glm::vec3 axis(0.2f, 0.9f, -0.4f);
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        naive = turnedNaive(naive, axis, 0.01f);
        stable = *turned(stable, axis, 0.01f);
        if (i % 64 == 0) {
            worst = std::max(worst, departure(stable));
            ASSERT_GT(determinant(stable), 0);
        }
    }
    EXPECT_LE(worst, 1.1e-7);           // measured 1.0e-7
    EXPECT_GE(departure(naive), 1e-3);  // measured 1.0e-2
}

TEST(Turned, TakesAFrameThatDriftedAndRefusesAMirroredOne) {
    const glm::mat3 drifted = 1.25f * turnMatrix(glm::vec3(1, 2, 3), 0.7f);
    const std::optional<glm::mat3> mended = turned(drifted, {0, 1, 0}, 0);
    ASSERT_TRUE(mended);
    EXPECT_LE(
        largestDifference(glm::dmat3(*mended), turnMatrix(glm::dvec3(1, 2, 3), static_cast<double>(0.7f))),
        1e-7);
    EXPECT_FALSE(turned(glm::mat3(glm::vec3(-1, 0, 0), {0, 1, 0}, {0, 0, 1}), {0, 1, 0}, 0.1f));
    EXPECT_FALSE(turned(glm::mat3(nan), {0, 1, 0}, 0.1f));
    EXPECT_FALSE(turned(glm::mat3(1), {0, inf, 0}, 0.1f));
    EXPECT_FALSE(turned(glm::mat3(1), {0, 1, 0}, nan));
    EXPECT_EQ(turned(glm::mat3(1), glm::vec3(0), 1), glm::mat3(1));
}

TEST(Orientation, TenMillionTurnsAreOneTurn) {
    // A thousandth of a whole turn, ten million times: back at the start ten thousand times.
    constexpr int turns = 10'000'000;
    Orientation body;
    const double step = 2 * pi / 1000;
    for (int i = 0; i < turns; ++i)
        body.turnAboutBody({0, 1, 0}, step);
    // Measured 5e-10, of which 2e-12 are the rounding of the step.
    EXPECT_LE(largestDifference(body.worldFromBody(), glm::dmat3(1)), turns * 16 * u);
    const glm::dmat3 r = body.worldFromBody();
    EXPECT_LE(largestDifference(glm::transpose(r) * r, glm::dmat3(1)), 32 * u);
}

TEST(Orientation, TurnsAboutTheWorldsAxesToo) {
    StressInputs draw(9);
    for (int i = 0; i < 1000; ++i) {
        Orientation body = anyOrientation(draw);
        const glm::dmat3 before = body.worldFromBody();
        const glm::dvec3 axis = draw.direction();
        const double radians = draw.random().uniform(-9, 9);
        body.turnAboutWorld(axis, radians);
        EXPECT_LE(largestDifference(body.worldFromBody(), turnMatrix(axis, radians) * before), 48 * u);
    }
}

TEST(Orientation, IsUnmovedByTurnsThatAreNone) {
    StressInputs draw(10);
    const Orientation before = anyOrientation(draw);
    Orientation after = before;
    for (const glm::dvec3 axis : {glm::dvec3(0), glm::dvec3(0, static_cast<double>(nan), 0)})
        after.turnAboutBody(axis, 1);
    after.turnAboutBody({0, 1, 0}, static_cast<double>(inf));
    EXPECT_LE(largestDifference(after.worldFromBody(), before.worldFromBody()), 16 * u);
}

TEST(AngleSum, RemembersSmallAnglesBesideLargeOnes) {
    AngleSum sum(0x1p39);
    for (int i = 0; i < 1000; ++i)
        sum.add(0x1p-30);
    sum.add(-0x1p39);
    sum.add(static_cast<double>(nan));
    EXPECT_EQ(sum.radians(), 1000 * 0x1p-30);
    EXPECT_LE(glm::length(sum.direction() - glm::dvec2(std::cos(1000 * 0x1p-30), std::sin(1000 * 0x1p-30))),
              4 * u);
}

TEST(ArcOffset, TwoArcsAreOne) {
    StressInputs draw(11);
    double worst = 0;
    for (int i = 0; i < 20'000; ++i) {
        const double curvature = i % 5 == 0 ? 0 : draw.sign() * draw.magnitude(-40, 2);
        const double first = draw.random().uniform(-10, 10);
        const double second = draw.random().uniform(-10, 10);
        const glm::dvec2 a = arcOffset(first, curvature);
        const glm::dvec2 b = arcOffset(second, curvature);
        const double turned = curvature * first;
        const glm::dvec2 chained = a + glm::dvec2(std::cos(turned) * b.x - std::sin(turned) * b.y,
                                                  std::sin(turned) * b.x + std::cos(turned) * b.y);
        worst = std::max(worst, glm::length(chained - arcOffset(first + second, curvature)));
    }
    EXPECT_LE(worst, 10 * 64 * u);  // measured 10 · 13 u
}

TEST(ArcOffset, GoesStraightWithoutACurveAndRoundAFullCircle) {
    EXPECT_EQ(arcOffset(7, 0), glm::dvec2(7, 0));
    EXPECT_EQ(arcOffset(0, 3), glm::dvec2(0, 0));
    EXPECT_LE(glm::length(arcOffset(2 * pi * 5, 0.2)), 16 * u * 10);
    EXPECT_GT(arcOffset(1, 0.1).y, 0);  // to the left
    EXPECT_EQ(arcOffset(static_cast<double>(inf), 0), glm::dvec2(0));
    EXPECT_EQ(arcOffset(1, static_cast<double>(nan)), glm::dvec2(0));
}

TEST(CameraFromModel, PutsTheBodysOriginAtTheEyeExactly) {
    StressInputs draw(12);
    for (int i = 0; i < 500; ++i) {
        const RigidPose car{draw.rotation(), draw.magnitude(0, 60) * draw.direction()};
        const glm::mat4 seen = cameraFromModel(cameraFacing(car, glm::dvec3(0)), car);
        EXPECT_EQ(glm::vec3(seen[3]), glm::vec3(0));
        // What the body faces lies along the camera's −z, its left along −x.
        EXPECT_LE(glm::length(glm::vec3(seen[2]) - glm::vec3(0, 0, -1)), 1e-15f);
        EXPECT_LE(glm::length(glm::vec3(seen[0]) - glm::vec3(-1, 0, 0)), 1e-15f);
        EXPECT_GT(determinant(glm::mat3(seen)), 0);
    }
}

TEST(CameraFromModel, IsTheInverseOfThePoseTimesTheModel) {
    StressInputs draw(13);
    for (int i = 0; i < 500; ++i) {
        const RigidPose camera{draw.rotation(), draw.magnitude(0, 10) * draw.direction()};
        const RigidPose model{draw.rotation(), draw.magnitude(0, 10) * draw.direction()};
        const RigidPose chained = camera.inverse() * model;
        const glm::mat4 seen = cameraFromModel(camera, model);
        EXPECT_LE(largestDifference(glm::dmat3(glm::mat3(seen)), chained.rotation), 0x1p-25 + 8 * u);
        EXPECT_LE(glm::length(glm::dvec3(glm::vec3(seen[3])) - chained.origin), 2e-7 * 2048);
    }
}

TEST(RigidPose, TheInverseUndoesThePose) {
    StressInputs draw(14);
    for (int i = 0; i < 500; ++i) {
        const RigidPose pose{draw.rotation(), draw.magnitude(-3, 3) * draw.direction()};
        const RigidPose back = pose.inverse() * pose;
        EXPECT_LE(largestDifference(back.rotation, glm::dmat3(1)), 16 * u);
        EXPECT_LE(glm::length(back.origin), 8 * 16 * u);
    }
}

}  // namespace
}  // namespace quincunx

#include "math/trs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "math/exact.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "math/vector.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// A placement of any kind: mirrored along any axes, sheared, flat in up to three directions.
glm::mat4 anyPlacement(StressInputs& draw) {
    glm::dmat3 shape(1);
    for (int axis = 0; axis < 3; ++axis)
        shape[axis][axis] = draw.random().below(6) == 0 ? 0 : draw.sign() * draw.magnitude(-3, 3);
    if (draw.random().below(2) == 0)
        shape[1][0] = draw.sign() * draw.magnitude(-3, 3);
    if (draw.random().below(2) == 0)
        shape[2] += glm::dvec3(draw.magnitude(-3, 3), -draw.magnitude(-3, 3), 0);
    if (draw.random().below(8) == 0)
        shape[1] = 2.0 * shape[0];
    glm::mat4 m{glm::mat3(draw.magnitude(-40, 40) * (draw.rotation() * shape))};
    m[3] = glm::vec4(draw.vectorOfMagnitude(-10, 10), 1);
    return m;
}

double largestEntry(const glm::mat3& m) {
    double most = 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            most = std::max(most, std::abs(static_cast<double>(m[column][row])));
    return most;
}

TEST(Trs, IsTranslationTimesRotationTimesScale) {
    StressInputs draw(1);
    for (int i = 0; i < 2000; ++i) {
        Trs placement;
        placement.translation = draw.vectorOfMagnitude(-5, 5);
        placement.rotation = glm::mat3(draw.rotation());
        placement.scale = draw.vectorOfMagnitude(-5, 5);
        placement.shear = i % 2 == 0 ? glm::vec3(0) : draw.vectorOfMagnitude(-5, 5);
        const glm::mat4 m = compose(placement);
        const glm::dmat3 triangular(placement.scale.x, 0, 0, placement.shear.x, placement.scale.y, 0,
                                    placement.shear.y, placement.shear.z, placement.scale.z);
        const glm::dmat3 exact = glm::dmat3(placement.rotation) * triangular;
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row)
                // Half an ulp, and four roundings of terms that are at most 2^6 each.
                ASSERT_NEAR(m[column][row], exact[column][row],
                            0x1p-24 * std::abs(exact[column][row]) + 0x1p-45);
        ASSERT_EQ(m[3], glm::vec4(placement.translation, 1));
        ASSERT_EQ((glm::vec4(m[0].w, m[1].w, m[2].w, m[3].w)), glm::vec4(0, 0, 0, 1));
    }
    EXPECT_EQ(compose({}), glm::mat4(1));
}

TEST(Trs, ComesApartAndTogetherAgain) {
    StressInputs draw(2);
    double worst = 0;
    double worstAngle = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::mat4 m = anyPlacement(draw);
        const std::optional<Trs> parts = decompose(m);
        ASSERT_TRUE(parts.has_value());
        const glm::mat3 difference = glm::mat3(compose(*parts)) - glm::mat3(m);
        if (glm::mat3(m) != glm::mat3(0))
            worst = std::max(worst, largestEntry(difference) / largestEntry(glm::mat3(m)));
        EXPECT_EQ(compose(*parts)[3], m[3]);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                worstAngle = std::max(
                    worstAngle,
                    std::abs(dotInDouble(parts->rotation[a], parts->rotation[b]) - (a == b ? 1 : 0)));
        ASSERT_GT(determinant(parts->rotation), 0.999);
        ASSERT_GE(parts->scale.y, 0);
        ASSERT_GE(parts->scale.z, 0);
        ASSERT_EQ(parts->scale.x < 0, determinant(glm::mat3(m)) < 0);
    }
    // Three roundings of lengths and three of axes: measured 1.5e-7.
    EXPECT_LE(worst, 6 * 0x1p-24);
    EXPECT_LE(worstAngle, 1.1e-7);
}

TEST(Trs, GivesBackTheRotationAndScaleThatWentIn) {
    StressInputs draw(3);
    for (int i = 0; i < 5000; ++i) {
        Trs placement;
        placement.rotation = glm::mat3(draw.rotation());
        placement.scale = glm::abs(draw.vectorOfMagnitude(-3, 3)) + 0x1p-3f;
        if (i % 2 == 0)
            placement.scale.x = -placement.scale.x;
        const Trs parts = decompose(compose(placement)).value();
        for (int axis = 0; axis < 3; ++axis) {
            // The rotation is off its ideal by 2^-25 an entry, each column of the matrix by as much again.
            ASSERT_NEAR(parts.scale[axis], placement.scale[axis], 4e-7 * std::abs(placement.scale[axis]));
            ASSERT_NEAR(parts.shear[axis], 0, 4e-7 * 8.2);
            for (int row = 0; row < 3; ++row)
                ASSERT_NEAR(parts.rotation[axis][row], placement.rotation[axis][row], 1e-6);
        }
    }
}

TEST(Trs, ShearIsTheLeanAlongTheTurnedAxes) {
    StressInputs draw(4);
    for (int i = 0; i < 5000; ++i) {
        Trs placement;
        placement.scale = {2, 3, 0.5f};
        placement.shear = {0.75f, -1.5f, 4};
        placement.rotation = glm::mat3(draw.rotation());
        const Trs parts = decompose(compose(placement)).value();
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_NEAR(parts.shear[axis], placement.shear[axis], 4e-6);
            ASSERT_NEAR(parts.scale[axis], placement.scale[axis], 4e-6);
        }
    }
}

TEST(Trs, OfAFlattenedModelKeepsTheAxesThatAreLeft) {
    const glm::mat3 rotation(glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0));
    for (int flat = 0; flat < 8; ++flat) {
        Trs placement;
        placement.rotation = rotation;
        placement.scale = {(flat & 1) != 0 ? 0.0f : 2.0f, (flat & 2) != 0 ? 0.0f : 3.0f,
                           (flat & 4) != 0 ? 0.0f : 5.0f};
        const glm::mat4 m = compose(placement);
        const Trs parts = decompose(m).value();
        EXPECT_EQ(parts.scale, placement.scale) << flat;
        EXPECT_EQ(parts.shear, glm::vec3(0)) << flat;
        EXPECT_EQ(compose(parts), m) << flat;
        const bool oneFlat = flat == 0 || flat == 1 || flat == 2 || flat == 4;
        if (oneFlat) {
            EXPECT_EQ(parts.rotation, rotation) << flat;
        }
    }
    EXPECT_EQ(decompose(glm::mat4(glm::mat3(0)))->rotation, glm::mat3(1));
}

TEST(Trs, MirrorsAlongXWhicheverAxisWasMirrored) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::mat4 m(1);
        m[axis][axis] = -2;
        const Trs parts = decompose(m).value();
        EXPECT_EQ(std::signbit(parts.scale.x), true);
        EXPECT_EQ(compose(parts), m);
        EXPECT_EQ(determinant(parts.rotation), 1);
    }
}

TEST(Trs, RefusesWhatHasNoParts) {
    glm::mat4 m(1);
    m[1][2] = infinity;
    EXPECT_FALSE(decompose(m).has_value());
    m[1][2] = std::nanf("");
    EXPECT_FALSE(decompose(m).has_value());
    m = glm::mat4(1);
    m[3][1] = infinity;
    EXPECT_FALSE(decompose(m).has_value());
    m = glm::mat4(1);
    m[0] = glm::vec4(3e38f, 3e38f, 0, 0);  // a length that no float holds
    EXPECT_FALSE(decompose(m).has_value());
    m = glm::mat4(1);
    m[0][3] = 1;
    EXPECT_DEATH(decompose(m), "m\\[0\\]");
}

TEST(Trs, NaiveFormLosesMirrorAndShear) {
    glm::mat4 m(1);
    m[0][0] = -1;
    EXPECT_EQ(decomposeNaive(m).scale, glm::vec3(1));
    EXPECT_LT(determinant(decomposeNaive(m).rotation), 0);
    m[0] = glm::vec4(0);
    EXPECT_TRUE(std::isnan(decomposeNaive(m).rotation[0].x));
}

}  // namespace
}  // namespace quincunx

#include "math/spaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "math/projection.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/ulp.h"
#include "math/vector.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float largestFloat = std::numeric_limits<float>::max();

TEST(Homogenize, IsRoundedOnceAndFiniteForAnyFiniteInput) {
    StressInputs draw(1);
    std::array<int, 4> kinds{};
    for (int i = 0; i < 40000; ++i) {
        glm::vec4 p(draw.finiteFloat(), draw.finiteFloat(), draw.finiteFloat(), draw.finiteFloat());
        if (i % 5 == 0)
            p.w = 0;
        if (i % 7 == 0)
            p.w = static_cast<float>(draw.sign() * draw.magnitude(-149, -126));
        if (i % 3 == 0)
            for (int axis = 0; axis < 3; ++axis)
                p[axis] = std::clamp(static_cast<float>(p.w * draw.magnitude(-30, 30)), -largestFloat,
                                     largestFloat);
        const Homogenized got = homogenize(p);
        ++kinds[static_cast<std::size_t>(got.kind)];
        ASSERT_TRUE(isFinite(got.value));
        bool fits = p.w != 0;
        for (int axis = 0; axis < 3 && fits; ++axis)
            fits = abs(Rational(Rational(p[axis]) / Rational(p.w))) < Rational(0x1.ffffffp127);
        ASSERT_EQ(got.isPoint(), fits);
        if (fits) {
            ASSERT_EQ(got.kind, p.w > 0 ? HomogeneousKind::point : HomogeneousKind::behind);
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_LE(ulpError(got.value[axis], Rational(Rational(p[axis]) / Rational(p.w))), 0.5);
        } else if (got.kind == HomogeneousKind::direction) {
            ASSERT_NEAR(glm::length(glm::dvec3(got.value)), 1, 1e-7);
        }
    }
    EXPECT_GT(*std::min_element(kinds.begin(), kinds.begin() + 3), 1000);
}

TEST(Homogenize, NamesWhatIsNoPoint) {
    EXPECT_EQ(homogenize(glm::vec4(2, 4, 6, 2)).value, glm::vec3(1, 2, 3));
    EXPECT_EQ(homogenize(glm::vec4(2, 4, 6, -2)).kind, HomogeneousKind::behind);
    EXPECT_EQ(homogenize(glm::vec4(2, 4, 6, -2)).value, glm::vec3(-1, -2, -3));
    for (const float zero : {0.0f, -0.0f}) {
        EXPECT_EQ(homogenize(glm::vec4(0, -3, 0, zero)).kind, HomogeneousKind::direction);
        EXPECT_EQ(homogenize(glm::vec4(0, -3, 0, zero)).value, glm::vec3(0, -1, 0));
        EXPECT_EQ(homogenize(glm::vec4(0, 0, 0, zero)).kind, HomogeneousKind::nothing);
    }
    // Beyond the range: a direction, turned round if it lies behind.
    EXPECT_EQ(homogenize(glm::vec4(0, 0, 1e30f, 1e-30f)).value, glm::vec3(0, 0, 1));
    EXPECT_EQ(homogenize(glm::vec4(0, 0, 1e30f, -1e-30f)).value, glm::vec3(0, 0, -1));
    EXPECT_EQ(homogenize(glm::vec4(largestFloat, 0, 0, 0x1p-149f)).kind, HomogeneousKind::direction);
    for (const float bad : {infinity, -infinity, std::nanf("")})
        for (int entry = 0; entry < 4; ++entry) {
            glm::vec4 p(1);
            p[entry] = bad;
            EXPECT_EQ(homogenize(p).kind, HomogeneousKind::nothing) << bad << " " << entry;
            EXPECT_EQ(homogenize(p).value, glm::vec3(0));
            EXPECT_EQ(homogenize(glm::dvec4(p)).kind, HomogeneousKind::nothing);
        }
    EXPECT_FALSE(isFinite(homogenizeNaive(glm::vec4(1e-30f, 0, 0, 0x1p-140f))));
}

// Bounds derived in the header; measured 1.42 and, below 2^-125, 2.2.
TEST(ScaleThroughW, ScalesPointsByD) {
    StressInputs draw(2);
    double worst = 0;
    double worstSubnormal = 0;
    for (int i = 0; i < 40000; ++i) {
        const auto d = static_cast<float>(draw.magnitude(-149, 127.99));
        const glm::mat4 m = scaleThroughW(d);
        const auto x = static_cast<float>(std::min(draw.magnitude(-149, 127) / d, 3e38));
        const Rational exact = Rational(x) * Rational(d);
        if (d == 0 || abs(exact) >= Rational(largestFloat))
            continue;
        const Homogenized got = homogenize(m * glm::vec4(x, 0, 0, 1));
        ASSERT_EQ(got.kind, HomogeneousKind::point) << d;
        double& most = abs(exact) < Rational(0x1p-125) ? worstSubnormal : worst;
        most = std::max(most, ulpError(got.value.x, exact));
    }
    EXPECT_LE(worst, 1.5);
    EXPECT_LE(worstSubnormal, 2.5);
    EXPECT_DEATH(scaleThroughW(0), "d > 0");
    EXPECT_DEATH(scaleThroughW(infinity), "isfinite");
}

TEST(ScaleThroughW, KeepsDirectionsDirections) {
    const glm::vec4 direction = scaleThroughW(3) * glm::vec4(1, 2, 3, 0);
    EXPECT_EQ(direction.w, 0);
    EXPECT_EQ(normalize(glm::vec3(direction)), normalize(glm::vec3(1, 2, 3)));
    EXPECT_EQ(homogenize(scaleThroughWNaive(4) * glm::vec4(1, 2, 3, 1)).value, glm::vec3(4, 8, 12));
}

/// A model of up to four units, and an eye eight and more away that looks at it.
SpaceChain someChain(StressInputs& draw) {
    SpaceChain chain;
    chain.worldFromModel = glm::mat4{glm::mat3(draw.magnitude(-3, 0) * draw.rotation())};
    chain.worldFromModel[3] = glm::vec4(draw.vectorOfMagnitude(-3, 3), 1);
    const glm::vec3 centre(chain.worldFromModel[3]);
    chain.eyeFromWorld =
        cameraFromWorld(lookAt(centre + draw.vectorOfMagnitude(3, 5), centre, glm::vec3(0, 1, 0)));
    chain.clipFromEye = perspective(1.0f, 1.5f, 0.1f, 200.0f);
    chain.viewport = {.x = 20, .y = 10, .width = 300, .height = 200, .nearDepth = 0.1, .farDepth = 0.9};
    return chain;
}

TEST(Spaces, AreTheMatricesOneByOne) {
    StressInputs draw(3);
    for (int i = 0; i < 5000; ++i) {
        const SpaceChain chain = someChain(draw);
        const glm::vec3 p = draw.vectorOfMagnitude(-2, 2);
        const VertexInSpaces vertex = throughSpaces(chain, glm::dvec3(p));
        // Exactly, in rationals.
        std::array<Rational, 4> v = {Rational(p.x), Rational(p.y), Rational(p.z), 1};
        for (const glm::mat4* m : {&chain.worldFromModel, &chain.eyeFromWorld, &chain.clipFromEye}) {
            std::array<Rational, 4> next;
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 4; ++column)
                    next[static_cast<std::size_t>(row)] +=
                        Rational((*m)[column][row]) * v[static_cast<std::size_t>(column)];
            v = next;
        }
        for (int row = 0; row < 4; ++row)
            ASSERT_NEAR(vertex.clip[row], static_cast<double>(v[static_cast<std::size_t>(row)]), 1e-12);
        ASSERT_TRUE(vertex.window.has_value());
        const Rational x = 20 + (v[0] / v[3] + 1) / 2 * 300;
        const Rational y = 10 + (v[1] / v[3] + 1) / 2 * 200;
        const Rational z = Rational(0.1) + (v[2] / v[3] + 1) / 2 * (Rational(0.9) - Rational(0.1));
        ASSERT_NEAR(vertex.window->x, static_cast<double>(x), 1e-10);
        ASSERT_NEAR(vertex.window->y, static_cast<double>(y), 1e-10);
        ASSERT_NEAR(vertex.window->z, static_cast<double>(z), 1e-12);
        // The viewport as a matrix says the same.
        const glm::dvec4 byMatrix =
            glm::dmat4(viewportMatrix(chain.viewport)) * glm::dvec4(vertex.ndc.value, 1);
        ASSERT_LE(glm::length(glm::dvec3(byMatrix) - *vertex.window), 1e-5);
        ASSERT_EQ(windowFromModel(chain, p), glm::vec3(*vertex.window));
    }
}

TEST(Spaces, GiveNoPixelToWhatIsNotInFrontOfTheEye) {
    SpaceChain chain;
    chain.clipFromEye = perspective(1.0f, 1.0f, 0.1f, 10.0f);
    chain.viewport = {.width = 100, .height = 100};
    EXPECT_TRUE(windowFromModel(chain, {0, 0, -1}).has_value());
    EXPECT_FALSE(windowFromModel(chain, {1, 0, 0}).has_value());
    EXPECT_EQ(throughSpaces(chain, {1, 0, 0}).ndc.kind, HomogeneousKind::direction);
    EXPECT_FALSE(windowFromModel(chain, {0, 0, 1}).has_value());
    EXPECT_EQ(throughSpaces(chain, {0, 0, 1}).ndc.kind, HomogeneousKind::behind);
    EXPECT_EQ(throughSpaces(chain, {0, 0, 0}).ndc.kind, HomogeneousKind::direction);
    EXPECT_TRUE(throughSpaces(chain, {0, 0, -1}).inView);
    EXPECT_FALSE(throughSpaces(chain, {0, 0, -11}).inView);
    EXPECT_FALSE(throughSpaces(chain, {9, 0, -1}).inView);
    EXPECT_FALSE(throughSpaces(chain, {0, 0, 1}).inView);
    chain.viewport.width = 0;
    EXPECT_DEATH(windowFromModel(chain, {0, 0, -1}), "width");
}

TEST(Unproject, IsTheWayBack) {
    StressInputs draw(4);
    for (int i = 0; i < 5000; ++i) {
        const SpaceChain chain = someChain(draw);
        const glm::vec3 p = draw.vectorOfMagnitude(-2, 2);
        const VertexInSpaces vertex = throughSpaces(chain, glm::dvec3(p));
        const std::optional<glm::vec3> back = modelFromWindow(chain, vertex.window.value());
        ASSERT_TRUE(back.has_value());
        // Doubles all the way: |p| 2^-24, and 2^-53 of the way through z²/n = 40²/0.1, over the scale of 1/8.
        ASSERT_LE(glm::length(glm::dvec3(*back) - glm::dvec3(p)), 1e-7 * glm::length(glm::dvec3(p)) + 1e-9);
    }
}

TEST(Unproject, RefusesWhatHasNoWayBack) {
    SpaceChain chain;
    chain.clipFromEye = perspective(1.0f, 1.0f, 0.1f, infinity);
    chain.viewport = {.width = 100, .height = 100};
    EXPECT_FALSE(modelFromWindow(chain, {50, 50, 1}).has_value());  // infinitely far
    EXPECT_TRUE(modelFromWindow(chain, {50, 50, 0.5}).has_value());
    EXPECT_FALSE(modelFromWindow(chain, {50, std::nan(""), 0.5}).has_value());
    chain.worldFromModel = glm::mat4(0);
    EXPECT_FALSE(modelFromWindow(chain, {50, 50, 0.5}).has_value());
    chain.worldFromModel = glm::mat4(infinity);
    EXPECT_FALSE(modelFromWindow(chain, {50, 50, 0.5}).has_value());
}

TEST(LargeWorld, SeenFromTheEyeIsTheSmallWorld) {
    StressInputs draw(5);
    for (int i = 0; i < 5000; ++i) {
        const glm::dmat3 eyeAxes = draw.rotation();
        const glm::dvec3 apart = 20.0 * draw.direction();
        const glm::dvec3 offset = draw.magnitude(10, 33) * draw.direction();
        glm::dmat4 worldFromModel(draw.rotation());
        glm::dmat4 worldFromEye(eyeAxes);
        worldFromEye[3] = glm::dvec4(0, 0, 0, 1);
        worldFromModel[3] = glm::dvec4(apart, 1);
        const glm::mat4 small = eyeFromModel(worldFromModel, worldFromEye);
        worldFromEye[3] = glm::dvec4(offset, 1);
        worldFromModel[3] = glm::dvec4(offset + apart, 1);
        const glm::mat4 large = eyeFromModel(worldFromModel, worldFromEye);
        ASSERT_EQ(glm::mat3(small), glm::mat3(large));
        // The sum offset + apart is rounded by 2^-53 of up to 2^33: 1e-6.
        ASSERT_LE(glm::length(glm::vec3(small[3]) - glm::vec3(large[3])), 4e-6f);
    }
}

}  // namespace
}  // namespace quincunx

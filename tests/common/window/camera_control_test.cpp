#include "scene/camera_control.h"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "math/transform.h"

namespace quincunx {
namespace {

Bounds box(float radius, glm::vec3 centre = glm::vec3(0)) {
    Bounds bounds;
    bounds.min = centre - glm::vec3(radius) / std::sqrt(3.0f);
    bounds.max = centre + glm::vec3(radius) / std::sqrt(3.0f);
    return bounds;
}

Camera lookingFrom(glm::vec3 eye, glm::vec3 target = glm::vec3(0)) {
    Camera camera;
    camera.worldFromCamera = lookAt(eye, target, {0, 1, 0});
    return camera;
}

bool sameBits(const Camera& a, const Camera& b) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (std::bit_cast<std::uint32_t>(a.worldFromCamera[column][row]) !=
                std::bit_cast<std::uint32_t>(b.worldFromCamera[column][row]))
                return false;
    return a.fovYRadians == b.fovYRadians && a.nearDistance == b.nearDistance &&
           a.farDistance == b.farDistance;
}

float worstDifference(const glm::mat4& a, const glm::mat4& b) {
    float worst = 0;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            worst = std::max(worst, std::abs(a[column][row] - b[column][row]));
    return worst;
}

glm::vec3 eyeOf(const Camera& camera) {
    return glm::vec3(camera.worldFromCamera[3]);
}

void expectSound(const Camera& camera) {
    const glm::dmat3 pose(camera.worldFromCamera);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            ASSERT_TRUE(std::isfinite(camera.worldFromCamera[column][row]));
    const glm::dmat3 product = glm::transpose(pose) * pose;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            // Rounding a rotation to float alone: 2 √3 2^-25.
            ASSERT_NEAR(product[i][j], i == j ? 1 : 0, 1.1e-7);
    ASSERT_GT(camera.nearDistance, 0);
    ASSERT_GT(camera.farDistance, camera.nearDistance);
    ASSERT_TRUE(std::isfinite(camera.farDistance));
}

TEST(CameraControl, ReturnsItsStartBitForBitUntilItMovesAndAfterReset) {
    Camera start = lookingFrom({3, 2, 5}, {0.3f, 0.1f, 0});
    start.farDistance = std::numeric_limits<float>::infinity();
    CameraControl control(start, box(2));
    EXPECT_TRUE(sameBits(control.camera(), start));
    for (const auto mode : {CameraControl::Mode::fly, CameraControl::Mode::orbit}) {
        control.setMode(mode);
        EXPECT_TRUE(sameBits(control.camera(), start));
        control.turn({0.2, 0.1});
        control.pan({0.2, 0.1});
        control.zoom(2);
        EXPECT_FALSE(sameBits(control.camera(), start));
        control.reset();
        EXPECT_TRUE(sameBits(control.camera(), start));
        EXPECT_EQ(control.mode(), mode);
    }
}

TEST(CameraControl, TakesOverAnyPoseWithoutAJump) {
    // A movement of nothing makes the camera from the angles: also for straight views and rolled ones.
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    float worst = 0;
    for (int i = 0; i < 10'000; ++i) {
        glm::vec3 eye(uniform(random), uniform(random), uniform(random));
        if (i % 4 == 0)
            eye = {0, i % 8 == 0 ? 3 : -3, 0};
        else if (i % 4 == 1)
            eye = {std::ldexp(uniform(random), -(i % 60)), 3, std::ldexp(uniform(random), -(i % 60))};
        Camera start;
        start.worldFromCamera = lookAt(eye, {0, 0, 0}, {uniform(random), uniform(random), uniform(random)});
        CameraControl control(start, box(1));
        control.turn({0, 0});
        worst = std::max(worst, worstDifference(control.camera().worldFromCamera, start.worldFromCamera));
    }
    // Measured 1.8e-7: the start is orthonormal to 1.1e-7, and is rounded once more.
    EXPECT_LE(worst, 3e-7f);
}

TEST(CameraControl, OrbitKeepsItsDistanceFromThePivot) {
    CameraControl control(lookingFrom({0, 0, 5}), box(1));
    for (int i = 0; i < 1000; ++i) {
        control.turn({0.013, i % 20 < 10 ? 0.031 : -0.03});
        const Camera camera = control.camera();
        expectSound(camera);
        EXPECT_NEAR(glm::length(eyeOf(camera)), 5, 2e-6);
        const glm::vec3 forward = -glm::vec3(camera.worldFromCamera[2]);
        EXPECT_NEAR(glm::dot(forward, eyeOf(camera)), -5, 4e-6);
    }
}

TEST(CameraControl, ADragToTheRightTurnsTheSceneToTheRightAndOneDownShowsItFromAbove) {
    CameraControl control(lookingFrom({0, 0, 5}), box(1));
    control.turn({0.1, 0});
    EXPECT_LT(eyeOf(control.camera()).x, -0.5f);
    control.reset();
    control.turn({0, 0.1});
    EXPECT_GT(eyeOf(control.camera()).y, 0.5f);
    control.reset();
    control.turn({2, 0});
    EXPECT_LE(worstDifference(control.camera().worldFromCamera, lookingFrom({0, 0, 5}).worldFromCamera),
              3e-7f);
}

TEST(CameraControl, ThePolesAreEndsNotTraps) {
    for (const auto mode : {CameraControl::Mode::orbit, CameraControl::Mode::fly})
        for (const double direction : {1.0, -1.0}) {
            CameraControl control(lookingFrom({1, 1, 5}), box(1));
            control.setMode(mode);
            for (int i = 0; i < 100; ++i) {
                control.turn({0.001, direction});
                expectSound(control.camera());
            }
            EXPECT_NEAR(std::abs(control.camera().worldFromCamera[2].y), 1, 1e-7);
            control.turn({0, -direction * 0.5});
            EXPECT_LT(std::abs(control.camera().worldFromCamera[2].y), 0.75f);
        }
}

TEST(CameraControl, PanCarriesThePivotWithTheDrag) {
    CameraControl control(lookingFrom({0, 0, 5}), box(1));
    const double height = 2 * 5 * std::tan(0.7854 / 2);
    control.pan({0.25, -0.5});
    EXPECT_NEAR(eyeOf(control.camera()).x, -0.25 * height, 1e-4);
    EXPECT_NEAR(eyeOf(control.camera()).y, -0.5 * height, 1e-4);
    EXPECT_NEAR(eyeOf(control.camera()).z, 5, 1e-6);
}

TEST(CameraControl, ZoomNeverReachesThePivotAndNeverLosesTheScene) {
    CameraControl control(lookingFrom({0, 0, 5}), box(1));
    control.zoom(1);
    EXPECT_NEAR(eyeOf(control.camera()).z, 4.5, 1e-6);
    for (int i = 0; i < 1000; ++i)
        control.zoom(5);
    EXPECT_NEAR(eyeOf(control.camera()).z, 1e-3, 1e-9);
    expectSound(control.camera());
    for (int i = 0; i < 1000; ++i)
        control.zoom(-5);
    EXPECT_NEAR(eyeOf(control.camera()).z, 1e3, 1e-3);
    expectSound(control.camera());
}

TEST(CameraControl, FlightEndsAtTheSamePlaceAtAnyFrameRate) {
    const auto endOf = [](int frames) {
        CameraControl control(lookingFrom({3, 2, 5}), box(2));
        control.setMode(CameraControl::Mode::fly);
        control.turn({0.3, -0.2});
        for (int i = 0; i < frames; ++i)
            control.fly(glm::dvec3(0.5, 0.25, 1.5) / static_cast<double>(frames));
        return control.camera();
    };
    const Camera once = endOf(1);
    for (const int frames : {2, 60, 1000, 100'000})
        EXPECT_LE(glm::length(eyeOf(endOf(frames)) - eyeOf(once)), 1e-6f) << frames;
}

TEST(CameraControl, FliesForwardsAndUpwards) {
    CameraControl control(lookingFrom({0, 0, 5}), box(2));
    control.setMode(CameraControl::Mode::fly);
    control.fly({0, 0, 1});
    EXPECT_NEAR(eyeOf(control.camera()).z, 3, 1e-5);
    control.fly({0.5, 1, 0});
    EXPECT_NEAR(eyeOf(control.camera()).x, 1, 1e-5);
    EXPECT_NEAR(eyeOf(control.camera()).y, 2, 1e-5);
}

TEST(CameraControl, DepthPlanesHoldTheScene) {
    const Bounds bounds = box(2, {10, -4, 3});
    for (const float distance : {0.1f, 1.0f, 5.0f, 30.0f, 1000.0f}) {
        const glm::vec3 eye = bounds.centre() + glm::vec3(0, 0, distance);
        CameraControl control(lookingFrom(eye, bounds.centre()), bounds);
        control.turn({0.3, 0.1});
        const Camera camera = control.camera();
        EXPECT_GE(camera.farDistance, distance + 2);
        EXPECT_LE(camera.nearDistance, std::max(distance - 2, camera.farDistance / 1000));
    }
}

TEST(CameraControl, IsSoundForScenesOfAnySize) {
    for (const float radius : {0.0f, 1e-44f, 1e-30f, 1.0f, 1e20f, 3e38f})
        for (const float far : {0.0f, 1e30f}) {
            const Bounds bounds = radius == 0 ? Bounds{} : box(radius, {far, 0, 0});
            Camera start;
            CameraControl control(start, bounds);
            for (int i = 0; i < 50; ++i) {
                control.setMode(i % 2 == 0 ? CameraControl::Mode::orbit : CameraControl::Mode::fly);
                control.turn({0.3, 0.4});
                control.pan({0.5, -3});
                control.zoom(i % 3 - 1);
                control.fly({1, -2, 30});
                expectSound(control.camera());
            }
        }
}

}  // namespace
}  // namespace quincunx

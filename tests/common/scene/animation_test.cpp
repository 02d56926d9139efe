#include "scene/animation.h"

#include <cmath>
#include <functional>
#include <limits>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "scene/fingerprint.h"
#include "scene/still_life.h"

namespace quincunx {
namespace {

using Interpolation = Animation::Interpolation;
using Path = Animation::Path;

/// One instance, one light and one camera on one node that one channel moves.
Scene moved(Path path, Interpolation interpolation, std::vector<float> seconds,
            std::vector<glm::vec4> values) {
    Scene scene;
    scene.instances.emplace_back();
    scene.lights.emplace_back();
    scene.cameras.emplace_back();
    scene.nodes.emplace_back();
    scene.attachments = {{Attachment::Thing::instance, 0, 0},
                         {Attachment::Thing::light, 0, 0},
                         {Attachment::Thing::camera, 0, 0}};
    scene.animations.push_back(
        {"", {{interpolation, std::move(seconds), std::move(values)}}, {{0, 0, path}}});
    return scene;
}

glm::vec3 placeAt(Scene scene, double seconds) {
    pose(scene, seconds);
    return glm::vec3(scene.instances[0].worldFromModel[3]);
}

TEST(Pose, LeavesScenesWithoutAnimationAlone) {
    Scene scene = tessellate(makeStillLife(), 6);
    const std::uint64_t before = fingerprint(scene);
    EXPECT_FALSE(isAnimated(scene));
    EXPECT_EQ(animationSeconds(scene), 0);
    for (const double seconds : {0.0, 1.0, -3.0}) {
        pose(scene, seconds);
        EXPECT_EQ(fingerprint(scene), before);
    }
    // Keys that move only what nothing hangs from.
    scene.nodes.resize(2);
    scene.animations.push_back({"", {{Interpolation::linear, {0}, {glm::vec4(1)}}}, {{0, 1, Path::scale}}});
    scene.attachments = {{Attachment::Thing::instance, 0, 0}};
    EXPECT_FALSE(isAnimated(scene));
    scene.nodes[0].parent = Node::noParent;
    scene.attachments[0].node = 1;
    EXPECT_TRUE(isAnimated(scene));
}

TEST(Pose, InterpolatesTranslationsAsTheKeysSay) {
    const std::vector<float> seconds{1, 2, 4};
    const std::vector<glm::vec4> values{{0, 0, 0, 0}, {10, 0, 0, 0}, {10, 8, 0, 0}};
    const Scene linear = moved(Path::translation, Interpolation::linear, seconds, values);
    EXPECT_TRUE(isAnimated(linear));
    EXPECT_EQ(animationSeconds(linear), 4);
    EXPECT_EQ(placeAt(linear, 0), glm::vec3(0)) << "before the first key";
    EXPECT_EQ(placeAt(linear, 1), glm::vec3(0));
    EXPECT_EQ(placeAt(linear, 1.25), glm::vec3(2.5f, 0, 0));
    EXPECT_EQ(placeAt(linear, 2), glm::vec3(10, 0, 0));
    EXPECT_EQ(placeAt(linear, 3), glm::vec3(10, 4, 0));
    EXPECT_EQ(placeAt(linear, 4), glm::vec3(0)) << "a new round";
    EXPECT_EQ(placeAt(linear, 403), glm::vec3(10, 4, 0));
    EXPECT_EQ(placeAt(linear, -1), glm::vec3(10, 4, 0));
    const Scene step = moved(Path::translation, Interpolation::step, seconds, values);
    EXPECT_EQ(placeAt(step, 1.999), glm::vec3(0));
    EXPECT_EQ(placeAt(step, 2), glm::vec3(10, 0, 0));
    EXPECT_EQ(placeAt(step, 3.999), glm::vec3(10, 0, 0));
}

TEST(Pose, CubicSplinesPassThroughTheirKeysWithTheirTangents) {
    // A parabola x = t² and a cubic y = t³ are their own splines: x' = 2t, y' = 3t².
    const auto value = [](double t) { return glm::vec4(t * t, t * t * t, 1, 0); };
    const auto tangent = [](double t) { return glm::vec4(2 * t, 3 * t * t, 0, 0); };
    std::vector<glm::vec4> values;
    const std::vector<float> seconds{0, 0.5, 2};
    for (const float t : seconds)
        values.insert(values.end(), {tangent(t), value(t), tangent(t)});
    const Scene scene = moved(Path::translation, Interpolation::cubicSpline, seconds, values);
    for (double t = 0; t < 2; t += 0.01) {
        const glm::vec3 found = placeAt(scene, t);
        // Rounded once from double: half an ulp of at most 8.
        EXPECT_NEAR(found.x, t * t, 2.4e-7);
        EXPECT_NEAR(found.y, t * t * t, 2.4e-7);
        EXPECT_EQ(found.z, 1);
    }
}

TEST(Pose, RotationsTurnEvenlyByTheShorterWay) {
    // From 0 to 100° about z, the goal's sign reversed and its length changed.
    const double half = glm::radians(50.0);
    const glm::vec4 goal(0, 0, -3 * std::sin(half), -3 * std::cos(half));
    Scene scene = moved(Path::rotation, Interpolation::linear, {0, 2}, {{0, 0, 0, 1}, goal});
    for (double t = 0; t < 2; t += 0.05) {
        pose(scene, t);
        const glm::mat4& m = scene.instances[0].worldFromModel;
        const double angle = std::atan2(m[0].y, m[0].x);
        // slerp's 1.2e-7 rad, the rounding of its parameter (1.7 · 2^-25), and of the matrix.
        EXPECT_NEAR(angle, glm::radians(50.0) * t, 3e-7);
        EXPECT_NEAR(glm::determinant(glm::dmat4(m)), 1, 3e-7);
    }
}

TEST(Pose, CubicRotationsAreUnitAndAgreeWithTheirKeys) {
    const auto about = [](float degrees) {
        const float half = glm::radians(degrees) / 2;
        return glm::vec4(std::sin(half), 0, 0, std::cos(half));
    };
    const glm::vec4 none(0);
    Scene scene = moved(Path::rotation, Interpolation::cubicSpline, {0, 1, 2},
                        {none, about(0), none, none, about(90), none, none, about(180), none});
    for (double t = 0; t <= 1.99; t += 0.07) {
        pose(scene, t);
        const glm::dmat3 r(glm::mat3(scene.instances[0].worldFromModel));
        const glm::dmat3 product = glm::transpose(r) * r;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(product[i][k], i == k, 3e-7);
    }
    pose(scene, 1);
    EXPECT_NEAR(scene.instances[0].worldFromModel[1].z, 1, 1e-6);
    // Opposite keys meet in no rotation half-way: there the first one stays.
    Scene opposite = moved(Path::rotation, Interpolation::cubicSpline, {0, 1},
                           {none, {0, 0, 0, 1}, none, none, {0, 0, 0, -1}, none});
    pose(opposite, 0.5);
    EXPECT_EQ(opposite.instances[0].worldFromModel, glm::mat4(1));
}

TEST(Pose, FollowsTheHierarchyForInstancesLightsAndCameras) {
    Scene scene = moved(Path::translation, Interpolation::linear, {0, 10}, {{0, 0, 0, 0}, {10, 0, 0, 0}});
    // World ← turned by 90° about y ← moved along x ← what hangs there, one unit up and scaled.
    scene.nodes[0].parent = Node::noParent;
    scene.nodes.insert(scene.nodes.begin(), Node{});
    scene.nodes[0].rotation = glm::quat(std::sqrt(0.5f), 0, std::sqrt(0.5f), 0);
    scene.nodes[1].parent = 0;
    scene.nodes[1].scale = {2, 3, 4};
    scene.animations[0].channels[0].node = 1;
    for (Attachment& attachment : scene.attachments) {
        attachment.node = 1;
        attachment.nodeFromThing[3] = glm::vec4(0, 1, 0, 1);
    }
    pose(scene, 4);
    // Along x by 4 and up by 3 · 1; the turn takes x to −z and −z to −x.
    const glm::vec3 expected(0, 3, -4);
    for (const glm::vec3& place : {glm::vec3(scene.instances[0].worldFromModel[3]), scene.lights[0].position,
                                   glm::vec3(scene.cameras[0].worldFromCamera[3])})
        EXPECT_LT(glm::length(place - expected), 1e-6f);
    EXPECT_LT(glm::length(scene.lights[0].direction - glm::vec3(-1, 0, 0)), 1e-6f);
    EXPECT_LT(glm::length(glm::vec3(scene.cameras[0].worldFromCamera[2]) - glm::vec3(1, 0, 0)), 1e-6f);
    EXPECT_NEAR(glm::determinant(glm::mat3(scene.cameras[0].worldFromCamera)), 1, 1e-6);
    EXPECT_NEAR(glm::determinant(glm::mat3(scene.instances[0].worldFromModel)), 24, 1e-5);
}

TEST(Pose, DoesNotDrift) {
    Scene scene = moved(Path::rotation, Interpolation::linear, {0, 3}, {{0, 0, 0, 1}, {1, 2, 3, 4}});
    scene.nodes[0].translation = {0.1f, 0.2f, 0.3f};
    pose(scene, 1.1);
    const std::uint64_t once = fingerprint(scene);
    Random random(3);
    for (int i = 0; i < 1000; ++i)
        pose(scene, random.uniform(-10, 10));
    pose(scene, 1.1);
    EXPECT_EQ(fingerprint(scene), once);
}

TEST(Pose, OneRoundIsAsLongAsTheLongestAnimationAndTheOthersWait) {
    Scene scene = moved(Path::translation, Interpolation::linear, {0, 1}, {{0, 0, 0, 0}, {1, 0, 0, 0}});
    scene.animations.push_back(
        {"", {{Interpolation::linear, {0, 4}, {{1, 1, 1, 0}, {5, 5, 5, 0}}}}, {{0, 0, Path::scale}}});
    EXPECT_EQ(animationSeconds(scene), 4);
    pose(scene, 3);
    EXPECT_EQ(scene.instances[0].worldFromModel[3].x, 1);
    EXPECT_EQ(scene.instances[0].worldFromModel[1].y, 4);
    // Of two that move the same, the later one wins.
    scene.animations.push_back({"", {{Interpolation::step, {0}, {{7, 7, 7, 0}}}}, {{0, 0, Path::scale}}});
    pose(scene, 3);
    EXPECT_EQ(scene.instances[0].worldFromModel[1].y, 7);
}

TEST(Pose, OddKeysAndTimesHaveResults) {
    const double infinity = std::numeric_limits<double>::infinity();
    const Scene single = moved(Path::translation, Interpolation::linear, {2}, {{1, 2, 3, 0}});
    const Scene atZero = moved(Path::translation, Interpolation::linear, {0}, {{1, 2, 3, 0}});
    const Scene same = moved(Path::translation, Interpolation::linear, {1, 1, 1},
                             {{9, 9, 9, 0}, {8, 8, 8, 0}, {1, 2, 3, 0}});
    for (const double seconds : {0.0, 1.0, 2.0, -1.0, 1e300, infinity, -infinity, std::nan("")}) {
        EXPECT_EQ(placeAt(single, seconds), glm::vec3(1, 2, 3)) << seconds;
        EXPECT_EQ(placeAt(atZero, seconds), glm::vec3(1, 2, 3)) << seconds;
        EXPECT_EQ(placeAt(same, seconds), glm::vec3(9)) << "before the first key";
    }
    // Between equal times the later key counts.
    const Scene jump = moved(Path::translation, Interpolation::linear, {0, 1, 1, 2},
                             {{0, 0, 0, 0}, {1, 0, 0, 0}, {5, 0, 0, 0}, {6, 0, 0, 0}});
    EXPECT_EQ(placeAt(jump, 1), glm::vec3(5, 0, 0));
    EXPECT_NEAR(placeAt(jump, 0.999).x, 0.999, 1e-6);
}

TEST(Pose, WhatHasNoPlaceVanishesAndNothingIsNaN) {
    // Two nodes that each scale by 1e30, and a camera in a frame flattened to nothing.
    Scene scene = moved(Path::scale, Interpolation::step, {0, 1}, {{1e30f, 1e30f, 1e30f, 0}, {0, 0, 0, 0}});
    scene.nodes.push_back(scene.nodes[0]);
    scene.nodes[1].parent = 0;
    scene.nodes[1].scale = glm::vec3(1e30f);
    for (Attachment& attachment : scene.attachments) {
        attachment.node = 1;
        attachment.nodeFromThing[3] = glm::vec4(1, 0, 0, 1);
    }
    for (const double seconds : {0.0, 0.999999, 1.0}) {
        pose(scene, seconds);
        for (const glm::mat4& m : {scene.instances[0].worldFromModel, scene.cameras[0].worldFromCamera})
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 4; ++k)
                    EXPECT_TRUE(std::isfinite(m[i][k]));
        EXPECT_EQ(scene.instances[0].worldFromModel[0], glm::vec4(0));
        EXPECT_NEAR(glm::length(scene.lights[0].direction), 1, 1e-6);
        EXPECT_NEAR(glm::determinant(scene.cameras[0].worldFromCamera), 1, 1e-6);
    }
}

TEST(Fingerprint, CoversWhatMoves) {
    const Scene scene = moved(Path::translation, Interpolation::linear, {1}, {{1, 2, 3, 0}});
    const std::vector<std::function<void(Scene&)>> changes = {
        [](Scene& s) { s.nodes[0].scale.x = 2; },
        [](Scene& s) { s.nodes[0].rotation.y = 0.5f; },
        [](Scene& s) { s.nodes[0].matrix = glm::mat4(1); },
        [](Scene& s) { s.nodes.emplace_back(); },
        [](Scene& s) { s.attachments.pop_back(); },
        [](Scene& s) { s.attachments[0].nodeFromThing[3].x = 1; },
        [](Scene& s) { s.animations[0].samplers[0].seconds[0] = 2; },
        [](Scene& s) { s.animations[0].samplers[0].values[0].z = 2; },
        [](Scene& s) { s.animations[0].samplers[0].interpolation = Interpolation::step; },
        [](Scene& s) { s.animations[0].channels[0].path = Path::scale; },
        [](Scene& s) { s.animations.clear(); },
    };
    for (const auto& change : changes) {
        Scene changed = scene;
        change(changed);
        EXPECT_NE(fingerprint(changed), fingerprint(scene));
    }
}

}  // namespace
}  // namespace quincunx

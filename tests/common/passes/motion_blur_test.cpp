#include "passes/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "gl/calls.h"
#include "image/compare.h"
#include "math/projection.h"
#include "math/transform.h"
#include "scene/still_life.h"
#include "tests/common/passes/film_set.h"
#include "tests/support/broken_shaders.h"
#include "trace/motion_glsl.h"

namespace quincunx {
namespace {

using test::FilmSet;
using test::haveSameBits;
using test::isFinite;

constexpr float infinite = std::numeric_limits<float>::infinity();

/// What moves while the shutter is open, by the time from −½ (opening) to ½ (closing).
struct Action {
    std::function<Camera(double)> camera;
    std::vector<std::size_t> moving = {};
    std::function<glm::mat4(std::size_t, double)> place = {};
};

/// The still life and its buffers.
class Stage {
  public:
    Stage(gl::Backend backend, int width, int height, int segments = 24)
        : scene_(tessellate(makeStillLife(), segments)),
          set_(backend, scene_, width, height),
          buffers_(scene_, SceneBuffers::Layout::shared) {
        std::vector<ObjectBlock> objects;
        for (const Instance& instance : scene_.instances)
            objects.push_back(makeObjectBlock(scene_.materials[instance.material], instance.worldFromModel));
        buffers_.updateObjects(objects);
    }

    const Scene& scene() const { return scene_; }
    FilmSet& set() { return set_; }

    MotionBlurParams params(const Action& action) const {
        MotionBlurParams params{.camera = action.camera(0),
                                .cameraOpen = action.camera(-0.5),
                                .cameraClose = action.camera(0.5),
                                .buffers = [this]() -> const SceneBuffers& { return buffers_; }};
        for (const std::size_t i : action.moving)
            params.instances.push_back({.instance = i,
                                        .worldFromModel = action.place(i, 0),
                                        .worldFromModelOpen = action.place(i, -0.5),
                                        .worldFromModelClose = action.place(i, 0.5)});
        return params;
    }

    ForwardView at(const Action& action, double time) {
        for (const std::size_t i : action.moving)
            set_.scene().instances[i].worldFromModel = action.place(i, time);
        return forwardView(action.camera(time), set_.aspect());
    }

    Image sharp(const Action& action, graph::Format format = graph::Format::rgba32f) {
        return set_.picture(at(action, 0), {}, format);
    }
    Image blurred(const Action& action, const MotionBlurParams& params,
                  graph::Format format = graph::Format::rgba32f) {
        return set_.picture(
            at(action, 0),
            [&](graph::FrameGraph& graph, graph::Resource color, graph::Resource depth) {
                return addMotionBlurPasses(graph, color, depth, params);
            },
            format);
    }
    /// The picture that many moments of the exposure add up to.
    Image exposed(const Action& action, int moments) {
        return set_.exposure(moments, [&](int i) { return at(action, (i + 0.5) / moments - 0.5); });
    }

  private:
    Scene scene_;
    FilmSet set_;
    SceneBuffers buffers_;
};

Camera stillLifeCamera() {
    return makeStillLife().camera;
}

/// The ivory pawn and the red egg run by so many units to the right.
Action runningThings(const Scene& scene, float way) {
    return {.camera = [](double) { return stillLifeCamera(); },
            .moving = {4, 6},
            .place =
                [&scene, way](std::size_t i, double time) {
                    return glm::translate(glm::mat4(1), {way * static_cast<float>(time), 0, 0}) *
                           scene.instances[i].worldFromModel;
                }};
}

/// The camera turns about the vertical.
Action turningCamera(float radians) {
    return {.camera = [radians](double time) {
        Camera camera = stillLifeCamera();
        const glm::mat4 turn =
            glm::rotate(glm::mat4(1), radians * static_cast<float>(time), glm::vec3(0, 1, 0));
        camera.worldFromCamera = camera.worldFromCamera * turn;
        return camera;
    }};
}

/// The camera runs forward.
Action runningCamera(float way) {
    return {.camera = [way](double time) {
        Camera camera = stillLifeCamera();
        camera.worldFromCamera =
            camera.worldFromCamera * glm::translate(glm::mat4(1), {0, 0, -way * static_cast<float>(time)});
        return camera;
    }};
}

TEST(ScreenMotion, IsTheWayBetweenTheTwoPlaces) {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const glm::vec2 size(640, 480);
    for (int i = 0; i < 20000; ++i) {
        const auto clip = [&] {
            const float w = std::exp(uniform(random));
            return glm::vec4(w * uniform(random), w * uniform(random), 0, w);
        };
        const glm::vec4 a = clip();
        const glm::vec4 b = clip();
        const glm::vec2 motion = glsl::screenMotion(a, b, size, 1e6f);
        for (int axis = 0; axis < 2; ++axis) {
            const double half = static_cast<double>(size[axis]) / 2;
            const double exact =
                half * (static_cast<double>(b[axis]) / b.w - static_cast<double>(a[axis]) / a.w);
            // Two quotients, a difference, a product, of places within ±1: five roundings of up to 2 · 2^-24.
            EXPECT_NEAR(static_cast<double>(motion[axis]), exact, 8 * half * 0x1p-24);
        }
    }
}

TEST(ScreenMotion, IsExactlyNothingForWhatStaysAndBoundedForAll) {
    std::mt19937_64 random(10);
    std::uniform_real_distribution<float> exponent(-60, 60);
    std::uniform_real_distribution<float> sign(-1, 1);
    const auto number = [&] { return std::copysign(std::exp2(exponent(random)), sign(random)); };
    const float hard[] = {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-140f, -0x1p-140f, 0x1p100f};
    for (int i = 0; i < 100000; ++i) {
        const auto clip = [&] {
            glm::vec4 result(number(), number(), number(), number());
            if (i % 3 == 0)
                result[static_cast<int>(random() % 4)] = hard[random() % 7];
            return result;
        };
        const glm::vec4 a = clip();
        const glm::vec4 b = clip();
        const glm::vec2 motion = glsl::screenMotion(a, b, {640, 480}, 40);
        EXPECT_LE(glm::length(glm::dvec2(motion)), 40 * (1 + 0x1p-20)) << i;
        EXPECT_EQ(glsl::screenMotion(a, a, {640, 480}, 40), glm::vec2(0)) << i;
    }
}

TEST(ScreenMotion, PassesTheCamerasPlaneInTheRightDirection) {
    // Upper right of the axis, running past the eye: over the picture it runs to the upper right.
    const glm::vec2 motion = glsl::screenMotion({1, 2, 0, 4}, {1, 2, 0, -3}, {100, 100}, 40);
    EXPECT_NEAR(glm::length(glm::dvec2(motion)), 40, 1e-4);
    EXPECT_NEAR(static_cast<double>(motion.y / motion.x), 2, 1e-5);
    EXPECT_EQ(glsl::screenMotion({1, 2, 0, -1}, {1, 2, 0, -3}, {100, 100}, 40), glm::vec2(0));
    EXPECT_EQ(glsl::screenMotion({1, 2, 0, 0}, {1, 3, 0, 0}, {100, 100}, 40), glm::vec2(0));
}

TEST(WayCover, AddsUpToTheLengthOfTheWayTimesItsWidth) {
    for (const glm::vec2 motion : {glm::vec2(12, 0), glm::vec2(0, -7), glm::vec2(9, 13)}) {
        double sum = 0;
        for (int y = -200; y <= 200; ++y)
            for (int x = -200; x <= 200; ++x)
                sum += static_cast<double>(glsl::wayCover(motion, 0.1f * glm::vec2(x, y))) * 0.01;
        // As wide as two pixels: half a pixel whole, and a ramp of one pixel on each side.
        EXPECT_NEAR(sum, 2 * glm::length(glm::dvec2(motion)), 0.02 * sum);
    }
    EXPECT_EQ(glsl::wayCover({1, 0}, {0.2f, 0}), 0);
}

class MotionBlur : public testing::TestWithParam<gl::Backend> {
  protected:
    Stage stage_{GetParam(), 160, 120};
};
INSTANTIATE_TEST_SUITE_P(On, MotionBlur, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         test::nameOfBackend);

TEST_P(MotionBlur, WhatStandsStillIsCopiedBitByBit) {
    // Without instances and camera motion, and with passes that find all motion to be zero.
    for (const graph::Format format :
         {graph::Format::rgba16f, graph::Format::rgba32f, graph::Format::rgba8Srgb}) {
        const Action still = turningCamera(0);
        EXPECT_TRUE(
            haveSameBits(stage_.sharp(still, format), stage_.blurred(still, stage_.params(still), format)));
        const Action standing = runningThings(stage_.scene(), 0);
        EXPECT_TRUE(haveSameBits(stage_.sharp(standing, format),
                                 stage_.blurred(standing, stage_.params(standing), format)));
    }
}

constexpr int moments = 40;

struct Errors {
    double sharp = 0;    ///< of the picture of one moment, RMSE against many
    double blurred = 0;  ///< … of the gather
};

Errors errorsOf(Stage& stage, const Action& action) {
    const Image exposed = stage.exposed(action, moments);
    return {rmse(exposed, stage.sharp(action)), rmse(exposed, stage.blurred(action, stage.params(action)))};
}

struct MotionLimit {
    const char* name;
    Action action;
    double error;
    double gain;  ///< at most this share of the sharp picture's error
};

std::vector<MotionLimit> motionLimits(const Scene& scene) {
    // Measured 0.0062 of 0.0381, 0.0039 of 0.0464, 0.0103 of 0.0246 and 0.0048 of 0.0123. What small ways
    // leave is what many moments do to the stairs of edges, which the picture of one moment has.
    return {{"run", runningThings(scene, 0.8f), 0.0069, 0.2},
            {"turn", turningCamera(0.06f), 0.0044, 0.1},
            {"forward", runningCamera(0.8f), 0.0113, 0.5},
            {"a shorter run", runningThings(scene, 0.1f), 0.0053, 0.5},
            {"no way", turningCamera(0), 0, 1}};
}

TEST_P(MotionBlur, ComesNearToManyMomentsOfTheExposure) {
    for (const MotionLimit& limit : motionLimits(stage_.scene())) {
        const Errors errors = errorsOf(stage_, limit.action);
        EXPECT_LE(errors.blurred, limit.error) << limit.name;
        EXPECT_LE(errors.blurred, limit.gain * errors.sharp) << limit.name;
    }
}

TEST_P(MotionBlur, ThingsAndCamerasThatPassTheCamerasPlaneGiveNumbers) {
    for (const float way : {20.0f, -1e6f})
        for (const float far : {40.0f, infinite}) {
            Action action = runningCamera(way);
            action.moving = {0, 6};
            action.place = [&, way](std::size_t i, double time) {
                return glm::translate(glm::mat4(1), {0, 0, -way * static_cast<float>(time)}) *
                       stage_.scene().instances[i].worldFromModel;
            };
            const auto camera = action.camera;
            action.camera = [camera, far](double time) {
                Camera result = camera(time);
                result.farDistance = far;
                return result;
            };
            for (const float most : {1.0f, 256.0f}) {
                MotionBlurParams params = stage_.params(action);
                params.maxLengthPixels = most;
                params.taps = 8;
                const Image blurred = stage_.blurred(action, params);
                EXPECT_TRUE(isFinite(blurred)) << way << " " << far << " " << most;
                EXPECT_EQ(haveSameBits(blurred, stage_.sharp(action)), most <= 1) << way << " " << most;
            }
        }
}

TEST_P(MotionBlur, DrawsOnlyWhatMovesAndCostsTheFetchesAndCallsItSays) {
    EXPECT_EQ(fetchesAPixel(MotionBlurParams{.camera = {}, .cameraOpen = {}, .cameraClose = {}, .taps = 24}),
              159u);
    const auto callsOf = [&](const Action& action) {
        stage_.blurred(action, stage_.params(action));
        const gl::CallRecorder recorder;
        stage_.blurred(action, stage_.params(action));
        return recorder.calls();
    };
    auto things = callsOf(runningThings(stage_.scene(), 0.5f));
    auto camera = callsOf(turningCamera(0.05f));
    auto nothing = callsOf(turningCamera(0));
    const auto drawn = [](auto& calls) { return calls["glDrawElementsBaseVertex"]; };
    EXPECT_EQ(drawn(nothing), stage_.scene().instances.size());
    EXPECT_EQ(drawn(camera), drawn(nothing));
    EXPECT_EQ(drawn(things), drawn(nothing) + 2);
    // Tiles and gather; a turning camera is one draw more.
    EXPECT_EQ(things["glDrawArrays"], nothing["glDrawArrays"]);
    EXPECT_EQ(camera["glDrawArrays"], nothing["glDrawArrays"] + 1);
    EXPECT_EQ(nothing["glClearBufferfv"], 1u);
    EXPECT_EQ(camera["glClearBufferfv"], 0u);
}

struct Mutation {
    const char* file;
    const char* from;
    const char* to;
    std::size_t limit;  ///< which picture shows it
};

TEST(MotionBlurMutations, EveryBrokenShaderIsNoticed) {
    const Mutation mutations[] = {
        {"lib/motion.glsl", "0.5f * sizePixels", "0.2f * sizePixels", 1},
        {"lib/motion.glsl", "0.5f * length_ - along", "0.1f * length_ - along", 0},
        {"passes/velocity_camera.frag", "1.0 - depth, depth", "depth, 1.0 - depth", 2},
        {"passes/velocity.frag", "> rounding", "< rounding", 0},
        {"passes/velocity.vert", "close = closeFromModel", "close = openFromModel", 0},
        {"passes/motion_blur_tiles.frag", "> dot(found, found)", "< dot(found, found)", 1},
        {"passes/motion_blur.frag", "- 0.5) * motion;", "- 0.0) * motion;", 1},
        {"passes/motion_blur.frag", "* spacing /", "* 0.1 * spacing /", 0},
        {"passes/motion_blur.frag", "(1.0 - before.a) * behind.rgb", "behind.rgb", 0},
    };
    Stage whole(gl::Backend::egl, 160, 120);
    const std::vector<MotionLimit> limits = motionLimits(whole.scene());
    const Image exposed[] = {whole.exposed(limits[0].action, moments),
                             whole.exposed(limits[1].action, moments),
                             whole.exposed(limits[2].action, moments)};
    const auto isNoticed = [&](std::size_t which) {
        Stage stage(gl::Backend::egl, 160, 120);
        const Action& action = limits[which].action;
        return rmse(exposed[which], stage.blurred(action, stage.params(action))) > limits[which].error;
    };
    for (const Mutation& mutation : mutations) {
        const test::BrokenShaders broken(mutation.file, mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.file << " no longer holds: " << mutation.from;
        EXPECT_TRUE(isNoticed(mutation.limit))
            << mutation.file << ": " << mutation.from << " -> " << mutation.to;
    }
}

}  // namespace
}  // namespace quincunx

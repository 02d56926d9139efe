#include "passes/accumulation.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "gl/calls.h"
#include "gl/context.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Camera lensCamera(float focus) {
    Camera camera;
    camera.worldFromCamera = lookAt({3, 2, 7}, {0.5f, 1, -1}, {0, 1, 0});
    camera.apertureRadius = 0.4f;
    camera.focusDistance = focus;
    return camera;
}

glm::dvec2 pixelOf(const glm::mat4& clipFromWorld, glm::dvec4 world, int width, int height) {
    const glm::dvec4 clip = glm::dmat4(clipFromWorld) * world;
    return (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(width, height);
}

TEST(PassSamples, SpreadOnlyWhatIsCalledForByOneSetForAll) {
    const AccumulatedEffects all{true, true, true, true};
    const std::vector<PassSample> whole = passSamples(SamplePattern::sobol, 32, all, 4);
    ASSERT_EQ(whole.size(), 32u);
    EXPECT_EQ(passSamples(SamplePattern::sobol, 32, {}, 4), std::vector<PassSample>(1));
    for (int effect = 0; effect < 4; ++effect) {
        const AccumulatedEffects one{effect == 0, effect == 1, effect == 2, effect == 3};
        const std::vector<PassSample> samples = passSamples(SamplePattern::sobol, 32, one, 4);
        ASSERT_EQ(samples.size(), 32u);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            PassSample expected;
            if (effect == 0)
                expected.pixel = whole[i].pixel;
            if (effect == 1)
                expected.lens = whole[i].lens;
            if (effect == 2)
                expected.light = whole[i].light;
            if (effect == 3)
                expected.time = whole[i].time;
            EXPECT_EQ(samples[i], expected);
        }
    }
}

TEST(LensViews, KeepThePlaneOfFocusInPlaceAndSpreadTheRest) {
    constexpr int width = 640;
    constexpr int height = 480;
    for (const float focus : {0.5f, 5.0f, 200.0f, infinity}) {
        const Camera camera = lensCamera(focus);
        const ForwardView pinhole = passView(camera, width, height, {});
        for (const glm::dvec2 lens : {glm::dvec2(0, 0.5), glm::dvec2(0.9, 0.2), glm::dvec2(0.5, 0.99)}) {
            PassSample sample;
            sample.lens = lens;
            const ForwardView view = passView(camera, width, height, sample);
            const glm::dvec2 onLens = static_cast<double>(camera.apertureRadius) * pointOnDisc(lens);
            for (const double z : {0.3, 0.5, 5.0, 30.0, 200.0}) {
                const glm::dvec4 world =
                    glm::dmat4(camera.worldFromCamera) * glm::dvec4(0.1 * z, -0.2 * z, -z, 1);
                const glm::dvec2 moved = pixelOf(view.clipFromWorld, world, width, height) -
                                         pixelOf(pinhole.clipFromWorld, world, width, height);
                const double pixels = height / (2 * std::tan(static_cast<double>(camera.fovYRadians) / 2));
                const glm::dvec2 expected = pixels * (1 / static_cast<double>(focus) - 1 / z) * onLens;
                // The matrix' entries are rounded by 2^-24 of a world 10 units wide, seen from 0.3 of one.
                EXPECT_NEAR(moved.x, expected.x, 1e-6 * pixels * 10 / z) << focus << " " << z;
                EXPECT_NEAR(moved.y, expected.y, 1e-6 * pixels * 10 / z) << focus << " " << z;
            }
            const glm::dvec4 eye = glm::dmat4(camera.worldFromCamera) * glm::dvec4(onLens, 0, 1);
            EXPECT_LE(glm::distance(glm::dvec3(view.eyeWorld), glm::dvec3(eye)), 1e-6);
        }
    }
}

TEST(LensViews, MoveThePictureAgainstTheSample) {
    const Camera camera = lensCamera(5);
    PassSample sample;
    sample.pixel = {0.75, 0.1};
    const ForwardView view = passView(camera, 320, 200, sample);
    const ForwardView middle = passView(camera, 320, 200, {});
    const glm::dvec4 world(0.5, 1, -1, 1);
    const glm::dvec2 moved =
        pixelOf(view.clipFromWorld, world, 320, 200) - pixelOf(middle.clipFromWorld, world, 320, 200);
    EXPECT_NEAR(moved.x, -0.25, 1e-4);
    EXPECT_NEAR(moved.y, 0.4, 1e-4);
}

TEST(LensViews, OfTheMiddleAndOfPinholesAreThePlainViewBitForBit) {
    Camera camera = lensCamera(5);
    const ForwardView plain = forwardView(camera, 4.0f / 3);
    EXPECT_EQ(passView(camera, 640, 480, {}).clipFromWorld, plain.clipFromWorld);
    camera.apertureRadius = 0;
    PassSample sample;
    sample.lens = {0.1, 0.9};
    EXPECT_EQ(passView(camera, 640, 480, sample).clipFromWorld, plain.clipFromWorld);
    EXPECT_EQ(passView(camera, 640, 480, sample).eyeWorld, plain.eyeWorld);
}

TEST(LensViews, AreFiniteForEveryFocusAndAperture) {
    for (const float focus : {0.0f, 1e-45f, 1e-30f, 1.0f, 1e30f, infinity})
        for (const float aperture : {1e-45f, 1e-3f, 1e3f, 1e30f, 3e38f})
            for (const float near : {1e-30f, 0.1f}) {
                Camera camera = lensCamera(focus);
                camera.apertureRadius = aperture;
                camera.nearDistance = near;
                camera.farDistance = infinity;
                PassSample sample;
                sample.lens = {0.3, 0.8};
                const glm::mat4 m(lensClipFromCamera(
                    camera, 1.5f, static_cast<double>(aperture) * pointOnDisc(sample.lens), {0, 0}));
                for (int column = 0; column < 4; ++column)
                    for (int row = 0; row < 4; ++row)
                        EXPECT_TRUE(std::isfinite(m[column][row])) << focus << " " << aperture;
            }
}

TEST(AreaLights, HaveTheirShapeAcrossTheWayTheyShine) {
    AreaLight area;
    area.light.kind = Light::Kind::spot;
    area.light.position = {1, 5, 2};
    area.light.direction = glm::normalize(glm::vec3(0.3f, -1, 0.2f));
    area.radius = 0.5f;
    for (const AreaLight::Shape shape : {AreaLight::Shape::disc, AreaLight::Shape::square}) {
        area.shape = shape;
        double farthest = 0;
        for (const PassSample& sample : passSamples(SamplePattern::jittered, 400, {.softShadows = true}, 1)) {
            const Light light = passLight(area, sample);
            const glm::vec3 offset = light.position - area.light.position;
            EXPECT_NEAR(glm::dot(offset, area.light.direction), 0, 1e-6);
            farthest = std::max(farthest, static_cast<double>(glm::length(offset)));
            EXPECT_EQ(light.direction, area.light.direction);
        }
        EXPECT_LE(farthest, (shape == AreaLight::Shape::disc ? 0.5 : 0.5 * std::sqrt(2.0)) + 1e-6);
        EXPECT_GT(farthest, shape == AreaLight::Shape::disc ? 0.48 : 0.6);
    }
    area.light.kind = Light::Kind::directional;
    for (const PassSample& sample : passSamples(SamplePattern::sobol, 64, {.softShadows = true}, 1)) {
        const Light light = passLight(area, sample);
        EXPECT_NEAR(glm::length(light.direction), 1, 1e-6);
        EXPECT_LE(std::tan(std::acos(glm::dot(light.direction, area.light.direction))),
                  0.5 * std::sqrt(2.0) + 1e-3);
    }
    // Without extent, without direction, and in its middle it is the light as it is.
    PassSample aside;
    aside.light = {0.9, 0.1};
    area.light.kind = Light::Kind::point;
    EXPECT_EQ(passLight(area, {}).position, area.light.position);
    area.radius = 0;
    EXPECT_EQ(passLight(area, aside).position, area.light.position);
    area.radius = 1;
    area.light.direction = glm::vec3(0);
    EXPECT_EQ(passLight(area, aside).position, area.light.position);
}

TEST(PassMoments, CoverTheShutterEvenLongAfterTheStart) {
    const double day = 86400;
    std::set<double> moments;
    for (const PassSample& sample : passSamples(SamplePattern::regular, 64, {.motionBlur = true}, 1)) {
        const double moment = passSeconds(day, 1e-3, sample);
        EXPECT_NEAR(moment, day, 5.001e-4);
        moments.insert(moment);
    }
    EXPECT_EQ(moments.size(), 64u);
    EXPECT_EQ(passSecondsNaive(86400, 1e-3f, 0.9f), passSecondsNaive(86400, 1e-3f, 0.1f));
    EXPECT_EQ(passSeconds(day, 0, {.time = 0.9}), day);
}

/// A context with an executor, drawing frames of known values.
class Accumulation : public testing::TestWithParam<gl::Backend> {
  protected:
    Accumulation() : context_(gl::createOffscreenContext(GetParam())) {}

    AccumulationParams paramsFor(Accumulator::Params params, const std::function<float(std::size_t)>& value) {
        params.width = 3;
        params.height = 2;
        AccumulationParams frames;
        frames.accumulator = params;
        frames.format = graph::Format::rgba32f;
        frames.samples.resize(params.passes);
        frames.draw = [this, value](graph::PassContext&, const PassSample&) {
            const float grey = value(drawn_++);
            const GLfloat color[4] = {grey, 2 * grey, 0, 1};
            glClearBufferfv(GL_COLOR, 0, color);
        };
        return frames;
    }
    Image run(const AccumulationParams& params, bool resume = false) {
        graph::FrameGraph graph;
        const graph::Resource picture = addAccumulationPasses(graph, accumulator_, params, resume);
        graph.addOutput(picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(picture));
    }
    double mean(const Accumulator::Params& params, const std::function<float(std::size_t)>& value) {
        drawn_ = 0;
        return static_cast<double>(run(paramsFor(params, value)).data[0]);
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    Accumulator accumulator_;
    std::size_t drawn_ = 0;
};
INSTANTIATE_TEST_SUITE_P(On, Accumulation, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const auto& test) {
                             return test.param == gl::Backend::osmesa ? "osmesa" : "egl";
                         });

/// For what takes thousands of frames.
class ManyFrames : public Accumulation {};
INSTANTIATE_TEST_SUITE_P(On, ManyFrames, testing::Values(gl::Backend::egl),
                         [](const auto&) { return "egl"; });

float wavy(std::size_t i) {
    return 0.25f + 0.5f * static_cast<float>(i * 2654435761u % 4096) / 4096;
}

double exactMean(std::size_t count) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += static_cast<double>(wavy(i));
    return sum / static_cast<double>(count);
}

TEST_P(Accumulation, IsTheMeanInEverySummationAndBuffer) {
    const double exact = exactMean(8);
    for (const Summation summation : {Summation::weighted, Summation::runningMean, Summation::compensated})
        for (const auto& [buffer, limit] : {std::pair(AccumulationBuffer::rgba8, 8.5 / 255),
                                            std::pair(AccumulationBuffer::rgba16f, 8 * 0x1p-11),
                                            std::pair(AccumulationBuffer::rgba32f, 8 * 0x1p-24)})
            EXPECT_NEAR(mean({.summation = summation, .buffer = buffer, .passes = 8}, wavy), exact, limit)
                << static_cast<int>(summation) << " " << static_cast<int>(buffer);
}

TEST_P(Accumulation, CompensatedKeepsItsBoundForEveryBlockAndCount) {
    for (const std::size_t block : {1u, 7u, 16u})
        for (const std::size_t count : {2u, 16u, 17u, 500u}) {
            const double exact = exactMean(count);
            const double got = mean({.passes = count, .blockPasses = block}, wavy);
            EXPECT_LE(std::abs(got - exact), (static_cast<double>(block) + 3) * 0x1p-24 * exact)
                << block << " " << count;
        }
}

TEST_P(ManyFrames, StandStillInFewBits) {
    const auto grey = [](std::size_t) { return 0.7f; };
    constexpr std::size_t frames = 2048;
    const auto of = [&](Summation summation, AccumulationBuffer buffer) {
        return mean({.summation = summation, .buffer = buffer, .passes = frames}, grey) /
                   static_cast<double>(0.7f) -
               1;
    };
    EXPECT_EQ(of(Summation::weighted, AccumulationBuffer::rgba8), -1);
    // A share of 0.7/2048 is below half a step of 16-bit floats from ½ on: measured -0.286.
    EXPECT_LT(of(Summation::weighted, AccumulationBuffer::rgba16f), -0.2);
    EXPECT_LE(std::abs(of(Summation::compensated, AccumulationBuffer::rgba32f)), 19 * 0x1p-24);
    // A running mean of frames that grow brighter stands still as well: once 1/n of what is new is less than
    // half a step, nothing moves.
    const auto brighter = [](std::size_t i) { return i < frames / 2 ? 0.5f : 0.53f; };
    const Accumulator::Params eight{
        .summation = Summation::runningMean, .buffer = AccumulationBuffer::rgba8, .passes = frames};
    EXPECT_LE(mean(eight, brighter), 0.5f + 1.1 / 255);
    EXPECT_NEAR(mean({.passes = frames}, brighter), 0.515, 2e-6);
}

TEST_P(ManyFrames, DoNotDriftInCompensatedSums) {
    const auto grey = [](std::size_t) { return 0.7f; };
    // 65 536 of them are the lab's hard cases, by the shader's own text; here the driver has its say. Without
    // the carry it is 4e-5.
    constexpr std::size_t frames = 8192;
    EXPECT_LE(std::abs(mean({.passes = frames, .blockPasses = 1}, grey) / static_cast<double>(0.7f) - 1),
              4 * 0x1p-24);
}

TEST_P(Accumulation, GoesOnFromFrameToFrameAndStartsAnewWhenAsked) {
    AccumulationParams params = paramsFor({.passes = 10, .blockPasses = 4}, wavy);
    params.passesAFrame = 4;
    for (const auto& [resume, total] : {std::pair(false, 4u), std::pair(true, 8u), std::pair(true, 10u),
                                        std::pair(true, 10u), std::pair(false, 4u)}) {
        if (!resume)
            drawn_ = 0;
        const Image picture = run(params, resume);
        EXPECT_EQ(accumulator_.added(), total);
        EXPECT_EQ(drawn_, total);
        EXPECT_NEAR(picture.data[0], exactMean(total), 1e-6);
    }
    params.accumulator.passes = 11;
    params.samples.resize(11);
    drawn_ = 0;
    run(params, true);
    EXPECT_EQ(accumulator_.added(), 4u) << "other parameters start anew";
}

TEST_P(Accumulation, IsTheSameToTheBitHoweverManyPassesAFrameHas) {
    for (const Summation summation : {Summation::weighted, Summation::compensated}) {
        AccumulationParams params = paramsFor({.summation = summation, .passes = 37, .blockPasses = 6}, wavy);
        drawn_ = 0;
        const Image whole = run(params);
        for (const std::size_t passesAFrame : {1u, 3u, 5u}) {
            params.passesAFrame = passesAFrame;
            drawn_ = 0;
            Image live = run(params);
            while (accumulator_.added() < 37)
                live = run(params, true);
            EXPECT_EQ(live.data, whole.data) << static_cast<int>(summation) << " " << passesAFrame;
        }
    }
}

TEST_P(Accumulation, TakesOnlyTheMemoryThatItsSumNeeds) {
    constexpr std::size_t texels = 6;
    mean({.passes = 1}, wavy);
    EXPECT_EQ(accumulator_.bytes(), 0u) << "a single pass is drawn straight into the picture";
    mean({.passes = 16}, wavy);
    EXPECT_EQ(accumulator_.bytes(), texels * (4 * 16 + 4 + 2 * 16)) << "one block needs no total";
    mean({.passes = 17}, wavy);
    EXPECT_EQ(accumulator_.bytes(), texels * (4 * 16 + 4 + 2 * 16 + 4 * 16));
    mean({.summation = Summation::runningMean, .buffer = AccumulationBuffer::rgba8, .passes = 17}, wavy);
    EXPECT_EQ(accumulator_.bytes(), texels * (4 + 4 + 4));
}

TEST_P(Accumulation, AddsTheSameFewCallsForEachPass) {
    const auto calls = [&](std::size_t passes) {
        const AccumulationParams params = paramsFor({.passes = passes}, wavy);
        run(params);
        const std::uint64_t before = gl::callCount();
        run(params);
        return gl::callCount() - before;
    };
    const std::uint64_t sixteen = calls(32) - calls(16);
    EXPECT_LE(calls(48) - calls(32), sixteen);
    // Clear and target of each; program, textures, target and draw for four; and a sixteenth of the total.
    EXPECT_LE(sixteen, 16u * 16);
}

}  // namespace
}  // namespace quincunx

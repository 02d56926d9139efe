#include "passes/depth_of_field.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "geometry/shapes.h"
#include "gl/calls.h"
#include "image/compare.h"
#include "math/projection.h"
#include "math/transform.h"
#include "scene/still_life.h"
#include "tests/common/passes/film_set.h"
#include "tests/support/broken_shaders.h"
#include "trace/lens_glsl.h"

namespace quincunx {
namespace {

using test::FilmSet;
using test::haveSameBits;
using test::isFinite;

constexpr float infinite = std::numeric_limits<float>::infinity();

/// The still life with the ring in the middle in focus; its near things are some 6 units away, its far
/// ones 9.
Scene stillLife() {
    return tessellate(makeStillLife(), 24);
}

/// What is seen through one point of the lens, `sample` within the unit disc: all that lies in the plane of
/// focus stays where it is.
ForwardView viewThrough(const Camera& camera, float aspect, glm::dvec2 sample) {
    const glm::dvec2 p = static_cast<double>(camera.apertureRadius) * sample;
    glm::dmat4 shear(1);
    shear[2] = glm::dvec4(-p / static_cast<double>(camera.focusDistance), 1, 0);
    shear[3] = glm::dvec4(-p, 0, 1);
    const glm::dmat4 clipFromCamera(
        perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance));
    const glm::dmat4 fromWorld(cameraFromWorld(camera.worldFromCamera));
    return {glm::mat4(clipFromCamera * shear * fromWorld),
            glm::vec3(glm::dmat4(camera.worldFromCamera) * glm::dvec4(p, 0, 1))};
}

/// The picture that many points of the lens add up to.
Image throughLens(FilmSet& set, const Camera& camera, int samples) {
    return set.exposure(samples, [&](int i) {
        const double radius = std::sqrt((i + 0.5) / samples);
        const double angle = 2.39996322972865 * i;
        return viewThrough(camera, set.aspect(), radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    });
}

Image withDepthOfField(FilmSet& set, const DepthOfFieldParams& params,
                       graph::Format format = graph::Format::rgba32f) {
    return set.picture(
        forwardView(params.camera, set.aspect()),
        [&](graph::FrameGraph& graph, graph::Resource color, graph::Resource depth) {
            return addDepthOfFieldPasses(graph, color, depth, params);
        },
        format);
}

Camera stillLifeCamera(float apertureRadius, float focusDistance) {
    Camera camera = makeStillLife().camera;
    camera.apertureRadius = apertureRadius;
    camera.focusDistance = focusDistance;
    return camera;
}

TEST(CirclesOfConfusion, AreThoseOfTheLensEquation) {
    std::mt19937_64 random(3);
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(
            std::exp(std::uniform_real_distribution(std::log(low), std::log(high))(random)));
    };
    for (int i = 0; i < 20000; ++i) {
        Camera camera;
        camera.fovYRadians = uniform(0.01, 3);
        camera.nearDistance = uniform(1e-3, 10);
        camera.farDistance = i % 3 == 0 ? infinite : camera.nearDistance * uniform(1.5, 1e7);
        camera.apertureRadius = uniform(1e-4, 1);
        camera.focusDistance = i % 5 == 0 ? infinite : uniform(1e-4, 1e6);
        const auto depth = std::uniform_real_distribution<float>(0, 1)(random);
        const CirclesOfConfusion circles = circlesOfConfusion(camera, 480);
        using Wide = long double;
        const Wide scale =
            camera.apertureRadius * 480 / (2 * std::tan(static_cast<Wide>(camera.fovYRadians) / 2));
        // Where depth d is: n / ((1 − d) + d n/f).
        const Wide inverseDistance = (1 - static_cast<Wide>(depth)) / camera.nearDistance +
                                     depth / static_cast<Wide>(camera.farDistance);
        const Wide exact = scale * (1 / static_cast<Wide>(camera.focusDistance) - inverseDistance);
        const Wide terms = std::abs((1 - static_cast<Wide>(depth)) * circles.atNear) +
                           std::abs(static_cast<Wide>(depth) * circles.atFar);
        const float coc = glsl::circleOfConfusion(depth, circles.atNear, circles.atFar, 1e30f);
        // Four roundings of half an ulp (the two ends, the products or 1 − d, the sum), each at most 2^-24 of
        // the terms.
        EXPECT_LE(std::abs(coc - exact), 0x1p-22L * terms) << i;
    }
}

TEST(CirclesOfConfusion, HaveTheirLimits) {
    Camera camera;
    EXPECT_EQ(circlesOfConfusion(camera, 480), (CirclesOfConfusion{0, 0}));
    for (const float focus : {0.0f, 1e-45f, infinite}) {
        camera.focusDistance = focus;
        camera.apertureRadius = 0;
        EXPECT_EQ(circlesOfConfusion(camera, 480), (CirclesOfConfusion{0, 0}));
        camera.apertureRadius = 0.1f;
        camera.farDistance = infinite;
        const CirclesOfConfusion circles = circlesOfConfusion(camera, 480);
        if (focus > 0 && std::isinf(focus)) {
            EXPECT_LT(circles.atNear, 0);
            EXPECT_EQ(circles.atFar, 0);
        } else {
            EXPECT_GE(circles.atNear, 0x1p99f);
            EXPECT_GE(circles.atFar, 0x1p99f);
            // All is as blurred as it may be, and never NaN.
            for (const float depth : {0.0f, 0.5f, 1.0f})
                EXPECT_EQ(glsl::circleOfConfusion(depth, circles.atNear, circles.atFar, 16), 16);
        }
    }
    camera.focusDistance = camera.nearDistance;
    EXPECT_EQ(circlesOfConfusion(camera, 480).atNear, 0);
}

TEST(Lens, ADiscAddsUpToItsArea) {
    for (const float radius : {0.5f, 1.0f, 3.7f, 16.0f, 128.0f}) {
        double sum = 0;
        constexpr int steps = 20000;
        const double width = (static_cast<double>(radius) + 1) / steps;
        for (int i = 0; i < steps; ++i) {
            const double away = (i + 0.5) * width;
            sum += static_cast<double>(glsl::discCover(radius, static_cast<float>(away))) * 2 *
                   std::numbers::pi * away * width;
        }
        EXPECT_NEAR(static_cast<double>(glsl::discArea(radius)), sum, 1e-4 * sum) << radius;
    }
}

TEST(Lens, TheTapsOfACellAreOneSpiralOfGoldenAngles) {
    constexpr int taps = 48;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int k = 0; k < 9; ++k) {
        glm::vec2 direction = glsl::spiralStart(k);
        for (int i = 0; i < taps; ++i) {
            const double angle = golden * (9 * i + k);
            // 48 products of two roundings each, and eight digits of two constants.
            EXPECT_NEAR(static_cast<double>(direction.x), std::cos(angle), 2e-5);
            EXPECT_NEAR(static_cast<double>(direction.y), std::sin(angle), 2e-5);
            EXPECT_NEAR(static_cast<double>(glsl::spiralShare(i, k, taps)), (9 * i + k + 0.5) / (9 * taps),
                        1e-6);
            direction = glsl::spiralNext(direction);
        }
    }
}

class DepthOfField : public testing::TestWithParam<gl::Backend> {
  protected:
    static constexpr int width = 160;
    static constexpr int height = 120;
    FilmSet set_{GetParam(), stillLife(), width, height};
};
INSTANTIATE_TEST_SUITE_P(On, DepthOfField, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         test::nameOfBackend);

TEST_P(DepthOfField, APinholeCopiesEveryBit) {
    for (const graph::Format format :
         {graph::Format::rgba16f, graph::Format::rgba32f, graph::Format::rgba8Srgb})
        for (const float focus : {0.0f, 9.0f, infinite}) {
            const Camera camera = stillLifeCamera(0, focus);
            EXPECT_TRUE(haveSameBits(set_.picture(forwardView(camera, set_.aspect()), {}, format),
                                     withDepthOfField(set_, {camera}, format)))
                << static_cast<int>(format) << " " << focus;
        }
}

TEST_P(DepthOfField, AFocusAnywhereAndAFarPlaneAtInfinityGiveNumbers) {
    for (const float focus : {0.0f, 0.5f, 1.0f, infinite})
        for (const float far : {40.0f, infinite})
            for (const float most : {0.4f, 5.0f, 128.0f}) {
                Camera camera = stillLifeCamera(0.5f, focus);
                camera.farDistance = far;
                const Image sharp = set_.picture(forwardView(camera, set_.aspect()));
                const Image blurred = withDepthOfField(set_, {camera, most, 8});
                EXPECT_TRUE(isFinite(blurred)) << focus << " " << far << " " << most;
                EXPECT_EQ(haveSameBits(sharp, blurred), most < 0.5f) << focus << " " << far << " " << most;
            }
}

TEST_P(DepthOfField, CostsTheFetchesAndCallsItSays) {
    // 43 besides the taps, of which discs of half a pixel have 48 in each layer, and of 16.5 pixels 96.
    EXPECT_EQ(fetchesAPixel(DepthOfFieldParams{.camera = {}, .maxRadiusPixels = 0, .taps = 48}), 235u);
    EXPECT_EQ(fetchesAPixel(DepthOfFieldParams{.camera = {}, .taps = 48}), 427u);
    const Camera camera = stillLifeCamera(0.2f, 9);
    const ForwardView view = forwardView(camera, set_.aspect());
    const auto callsOf = [&](const FilmSet::Effect& effect) {
        set_.picture(view, effect);
        const gl::CallRecorder recorder;
        set_.picture(view, effect);
        return recorder.calls();
    };
    auto with = callsOf([&](graph::FrameGraph& graph, graph::Resource color, graph::Resource depth) {
        return addDepthOfFieldPasses(graph, color, depth, {camera});
    });
    auto without = callsOf({});
    std::uint64_t all = 0;
    for (const auto& [name, count] : with)
        all += count - without[name];
    // Three draws, each with its target, viewport, program and vertex array, and eight textures on units that
    // are chosen first.
    EXPECT_EQ(with["glDrawArrays"] - without["glDrawArrays"], 3u);
    EXPECT_LE(all, 40u);
}

constexpr int lensPoints = 60;

struct Errors {
    double sharp = 0;    ///< of the pinhole's picture, RMSE against the lens
    double blurred = 0;  ///< … of the gather
};

Errors errorsOf(FilmSet& set, const Camera& camera) {
    const Image lens = throughLens(set, camera, lensPoints);
    return {rmse(lens, set.picture(forwardView(camera, set.aspect()))),
            rmse(lens, withDepthOfField(set, {camera}))};
}

struct LensLimit {
    float apertureRadius;
    float focusDistance;
    double error;
    double gain;  ///< at most this share of the sharp picture's error
};
// Measured 0.0074 of 0.0234, 0.0052 of 0.0357, 0.0092 of 0.0123, 0.0082 of 0.0082 and 0.0033 of 0.0033. What
// small apertures leave is what many points of the lens do to the stairs of edges, which the pinhole's
// picture has.
const LensLimit lensLimits[] = {{0.4f, 10, 0.0082, 0.4},     {0.4f, 13, 0.0058, 0.2},
                                {0.1f, 10, 0.0100, 0.85},    {0.025f, 13, 0.0088, 1.01},
                                {0.0125f, 10, 0.0036, 1.01}, {0, 10, 0, 1}};

TEST_P(DepthOfField, ComesNearToManyPointsOfTheLens) {
    for (const LensLimit& limit : lensLimits) {
        const Errors errors = errorsOf(set_, stillLifeCamera(limit.apertureRadius, limit.focusDistance));
        EXPECT_LE(errors.blurred, limit.error) << limit.apertureRadius << " " << limit.focusDistance;
        EXPECT_LE(errors.blurred, limit.gain * errors.sharp)
            << limit.apertureRadius << " " << limit.focusDistance;
    }
}

/// A white ball of radius 1 that glows before a black background, 6 units away.
Scene glowingBall() {
    Scene scene;
    scene.meshes.push_back(tessellate(Sphere{}, 48));
    scene.materials.emplace_back();
    scene.materials.back().ambient = scene.materials.back().diffuse = scene.materials.back().specular =
        glm::vec3(0);
    scene.materials.back().emission = glm::vec3(1);
    scene.instances.push_back({"ball", 0, 0, glm::mat4(1)});
    return scene;
}

Camera ballCamera(float focusDistance, float apertureRadius) {
    Camera camera;
    camera.worldFromCamera = lookAt({0, 0, 6}, {0, 0, 0}, {0, 1, 0});
    camera.nearDistance = 1;
    camera.apertureRadius = apertureRadius;
    camera.focusDistance = focusDistance;
    return camera;
}

double lightOf(const Image& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.pixelCount(); ++i)
        sum += static_cast<double>(image.data[4 * i]);
    return sum;
}

/// Light that a sharp ball has lost to the blurred background or the background got from it.
double bleeding(gl::Backend backend) {
    FilmSet set(backend, glowingBall(), 160, 120);
    // Discs within half a pixel over the ball's whole depth, and of 1.9 pixels behind it.
    const Camera camera = ballCamera(5.8f, 0.08f);
    const Image sharp = set.picture(forwardView(camera, set.aspect()));
    const Image blurred = withDepthOfField(set, {camera});
    double sum = 0;
    for (std::size_t i = 0; i < sharp.pixelCount(); ++i)
        sum += std::abs(static_cast<double>(sharp.data[4 * i]) - blurred.data[4 * i]);
    return sum;
}

TEST_P(DepthOfField, WhatIsSharpDoesNotBleedIntoABlurredBackground) {
    EXPECT_EQ(bleeding(GetParam()), 0);
}

TEST_P(DepthOfField, ABlurredThingKeepsItsLightAndSpreadsOverASharpBackground) {
    FilmSet set(GetParam(), glowingBall(), 160, 120);
    const Camera camera = ballCamera(infinite, 0.4f);
    const Image sharp = set.picture(forwardView(camera, set.aspect()));
    const Image blurred = withDepthOfField(set, {camera});
    // Discs of 10 to 12 pixels around a ball that is 49 wide.
    EXPECT_NEAR(lightOf(blurred), lightOf(sharp), 0.05 * lightOf(sharp));
    const float* outside = blurred.pixel(80 + 25 + 4, 60);
    const float* inside = blurred.pixel(80 + 25 - 6, 60);
    EXPECT_EQ(sharp.pixel(80 + 25 + 4, 60)[0], 0);
    EXPECT_EQ(sharp.pixel(80 + 25 - 6, 60)[0], 1);
    EXPECT_GT(outside[0], 0.1f);
    EXPECT_LT(inside[0], 0.9f);
    EXPECT_EQ(blurred.pixel(80, 60)[0], 1);
}

TEST_P(DepthOfField, ASmallBrightThingBecomesAnEvenDisc) {
    // A ball of three pixels, before the plane of focus and behind it, as a disc of 40 pixels.
    Scene scene = glowingBall();
    scene.instances[0].worldFromModel = glm::mat4(glm::mat3(0.06f));
    FilmSet set(GetParam(), scene, 160, 120);
    for (const float focus : {infinite, 3.0f}) {
        const Camera camera = ballCamera(focus, 1.5f);
        const Image blurred = withDepthOfField(set, {.camera = camera, .maxRadiusPixels = 48});
        double sum = 0;
        double squares = 0;
        int count = 0;
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x)
                if (std::hypot(x - 79.5, y - 59.5) < 25) {
                    const auto light = static_cast<double>(blurred.pixel(x, y)[0]);
                    sum += light;
                    squares += light * light;
                    ++count;
                }
        const double mean = sum / count;
        const double deviation = std::sqrt(std::max(squares / count - mean * mean, 0.0));
        EXPECT_GT(mean, 0);
        // Measured 0.44 and 0.42; with 48 taps for every disc, 1.43 and 1.33: spots with nothing between
        // them.
        EXPECT_LT(deviation, 0.5 * mean) << focus;
    }
}

TEST_P(DepthOfField, InfiniteLightIsFiniteAndStaysWhereItsDiscsReach) {
    Scene scene = glowingBall();
    scene.materials.back().emission = glm::vec3(infinite);
    FilmSet set(GetParam(), scene, 96, 64);
    const Image blurred = withDepthOfField(set, {ballCamera(infinite, 0.4f)}, graph::Format::rgba16f);
    EXPECT_TRUE(isFinite(blurred));
    EXPECT_EQ(blurred.pixel(2, 2)[0], 0);
}

struct Mutation {
    const char* file;
    const char* from;
    const char* to;
};

TEST(DepthOfFieldMutations, EveryBrokenShaderIsNoticed) {
    const Mutation mutations[] = {
        {"lib/lens.glsl", "(1.0f - depth) * atNear", "depth * atNear"},
        {"lib/lens.glsl", "radius - away + 0.5f", "1.0f"},
        {"lib/lens.glsl", "r * r + 0.0833333333f", "r + 0.0833333333f"},
        {"passes/depth_of_field_tiles.frag", "nearest = min(", "nearest = max("},
        {"passes/depth_of_field_gather.frag", "reach * sqrt(spiralShare", "1.0 * sqrt(spiralShare"},
        {"passes/depth_of_field_gather.frag", "ring / discArea", "0.2 * ring / discArea"},
        {"passes/depth_of_field_gather.frag", "isBefore(cocThere, coc) * cover", "0.0 * cover"},
        {"passes/depth_of_field.frag", "(1.0 - before.a) * light", "light"},
    };
    const LensLimit& limit = lensLimits[0];
    const Camera camera = stillLifeCamera(limit.apertureRadius, limit.focusDistance);
    FilmSet whole(gl::Backend::egl, stillLife(), 160, 120);
    const Image lens = throughLens(whole, camera, lensPoints);
    const auto error = [&] {
        FilmSet set(gl::Backend::egl, stillLife(), 160, 120);
        return rmse(lens, withDepthOfField(set, {camera}));
    };
    for (const Mutation& mutation : mutations) {
        const test::BrokenShaders broken(mutation.file, mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.file << " no longer holds: " << mutation.from;
        EXPECT_GT(error(), limit.error) << mutation.file << ": " << mutation.from << " -> " << mutation.to;
    }
    const test::BrokenShaders broken("passes/depth_of_field_gather.frag",
                                     "(1.0 - isBefore(cocAt(there), coc))", "1.0");
    ASSERT_TRUE(broken.found());
    EXPECT_GT(bleeding(gl::Backend::egl), 1);
}

}  // namespace
}  // namespace quincunx

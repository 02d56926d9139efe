#include "trace/whitted.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "base/random.h"
#include "image/compare.h"
#include "math/transform.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

Camera cameraAt(glm::vec3 eye, glm::vec3 target, float degrees = 40) {
    Camera camera;
    camera.worldFromCamera = lookAt(eye, target, {0, 1, 0});
    camera.fovYRadians = glm::radians(degrees);
    return camera;
}

Mesh quadMesh(const std::array<glm::vec3, 4>& corners) {
    Mesh mesh;
    mesh.positions.assign(corners.begin(), corners.end());
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

/// A floor at `height` under a lamp, nothing else.
WhittedContents floorAndLamp(float height = 0) {
    WhittedContents contents;
    contents.materials = {{.diffuse = glm::vec3(0.5f)}};
    contents.parts.push_back(
        {quadMesh({glm::vec3(-8, height, 8), {8, height, 8}, {8, height, -8}, {-8, height, -8}}), 0});
    contents.lights.push_back({{-0.5f, height + 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, glm::vec3(3, 2, 1)});
    contents.ambient = glm::vec3(0);
    return contents;
}

/// A sky of radiance 1 in every direction.
WhittedContents furnace() {
    WhittedContents contents;
    contents.skyZenith = contents.skyHorizon = contents.skyNadir = glm::vec3(1);
    contents.ambient = glm::vec3(0);
    return contents;
}

WhittedMaterial glassOf(float ior) {
    return {.diffuse = glm::vec3(0), .ior = ior, .glass = true};
}

/// Lambert's formula for the irradiance of a polygon of radiance 1: ½ Σ angle · (normal of edge's plane · n).
double irradianceOf(const AreaLight& lamp, glm::dvec3 point, glm::dvec3 normal) {
    const std::array<glm::vec3, 4> corners{lamp.at({0, 0}), lamp.at({0, 1}), lamp.at({1, 1}),
                                           lamp.at({1, 0})};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 a = glm::normalize(glm::dvec3(corners[i]) - point);
        const glm::dvec3 b = glm::normalize(glm::dvec3(corners[(i + 1) % 4]) - point);
        const glm::dvec3 across = glm::cross(a, b);
        sum += std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
    }
    return std::abs(0.5 * sum);
}

TEST(Whitted, FloorUnderALampHasTheRadianceOfLambertsFormula) {
    const WhittedScene scene(floorAndLamp());
    const Camera camera = cameraAt({0, 1.9f, 6}, {0, 0, 0});
    WhittedSettings settings;
    settings.shadowRays = 256;
    const Image image = renderWhitted(scene, camera, 32, 24, settings);
    CsgScratch scratch;
    double worst = 0;
    int floor = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x) {
            // The ray again, in double, from the camera's definition.
            const double up = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
            const glm::dvec3 inCamera((2 * (x + 0.5) / 32 - 1) * up * 32 / 24, (1 - 2 * (y + 0.5) / 24) * up,
                                      -1);
            const glm::dvec3 d = glm::dmat3(glm::dmat4(camera.worldFromCamera)) * inCamera;
            if (d.y >= -0.05)
                continue;
            const glm::dvec3 o(camera.worldFromCamera[3]);
            const glm::dvec3 p = o - o.y / d.y * d;
            if (std::abs(p.x) > 7.9 || std::abs(p.z) > 7.9)
                continue;
            const double expected =
                irradianceOf(scene.contents().lights[0], p, {0, 1, 0}) * 0.5 * std::numbers::inv_pi;
            worst = std::max(worst, std::abs(image.pixel(x, y)[0] / (3 * expected) - 1));
            worst = std::max(worst, std::abs(image.pixel(x, y)[2] / expected - 1));
            ++floor;
        }
    EXPECT_GT(floor, 300);
    // 256 Sobol points of a smooth integrand; measured 8e-4.
    EXPECT_LE(worst, 3e-3);
}

TEST(Whitted, GlassInAWhiteFurnaceCannotBeSeen) {
    // What is mirrored and what goes through sum to 1, also where all is mirrored, in nested glass and by
    // CSG.
    WhittedContents contents = furnace();
    contents.materials = {glassOf(1.5f), glassOf(1.2f), glassOf(1.33f)};
    contents.solids.push_back({Csg::ball({{-1, 0, 0}, 1}, 0)});
    contents.solids.push_back({Csg::ball({{-1, 0, 0}, 0.5f}, 1)});
    contents.solids.push_back(
        {subtract(Csg::box({{0.3f, -1, -1}, {2, 1, 1}}, 2), Csg::ball({{1, 0, 1}, 0.6f}, 2))});
    const WhittedScene scene(std::move(contents));
    WhittedSettings settings;
    settings.minWeight = 0x1p-12f;
    WhittedCounts counts;
    const Image image = renderWhitted(scene, cameraAt({0.4f, 1, 5}, {0.3f, 0, 0}), 48, 36, settings, &counts);
    double worst = 0;
    double sum = 0;
    for (std::size_t i = 0; i < image.data.size(); i += 4) {
        worst = std::max(worst, std::abs(image.data[i] - 1.0));
        sum += image.data[i];
    }
    // What is lost is what the threshold cuts, and what 48 mirrorings inside the box leave. Measured: a mean
    // of 0.9995.
    EXPECT_LE(worst, 0.2);
    EXPECT_NEAR(sum / static_cast<double>(image.pixelCount()), 1, 3e-3);
    EXPECT_GT(counts.deepest, 10u);
}

TEST(Whitted, RouletteKeepsTheMeanThatAThresholdLoses) {
    WhittedContents contents = furnace();
    contents.materials = {glassOf(1.5f)};
    contents.solids.push_back({Csg::ball({{0, 0, 0}, 1}, 0)});
    const WhittedScene scene(std::move(contents));
    const Camera camera = cameraAt({0, 0, 3.2f}, {0, 0, 0});
    const auto meanOf = [&](RecursionEnd end, std::uint64_t seed) {
        WhittedSettings settings;
        settings.end = end;
        settings.minWeight = 0.25f;
        settings.seed = seed;
        const Image image = renderWhitted(scene, camera, 24, 24, settings);
        double sum = 0;
        for (std::size_t i = 0; i < image.data.size(); i += 4)
            sum += image.data[i];
        return sum / static_cast<double>(image.pixelCount());
    };
    EXPECT_LT(meanOf(RecursionEnd::weight, 1), 0.97);
    constexpr int runs = 20;
    double sum = 0;
    double squares = 0;
    for (int run = 1; run <= runs; ++run) {
        const double mean = meanOf(RecursionEnd::roulette, static_cast<std::uint64_t>(run));
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / runs;
    const double error = std::sqrt((squares / runs - mean * mean) / (runs - 1));
    // Student's t with 19 degrees of freedom exceeds 4 once in 1300 times; the seeds are fixed.
    EXPECT_LE(std::abs(mean - 1) / error, 4);
    EXPECT_LT(error, 0.01);
}

TEST(Whitted, GlassOfTheIndexOfAirChangesNothing) {
    WhittedContents contents = floorAndLamp();
    contents.materials.push_back(glassOf(1));
    const Camera camera = cameraAt({0, 1.5f, 5}, {0, 0.5f, 0});
    const Image without = renderWhitted(WhittedScene(contents), camera, 40, 30, {});
    contents.solids.push_back({Csg::ball({{0, 0.6f, 1}, 0.5f}, 1)});
    WhittedCounts counts;
    const Image with = renderWhitted(WhittedScene(contents), camera, 40, 30, {}, &counts);
    EXPECT_GT(counts.childRays, 50u);
    EXPECT_LE(rmse(without, with), 1e-4);
}

TEST(Whitted, GlassWithinGlassOfTheSameIndexChangesNothing) {
    WhittedContents contents = floorAndLamp();
    contents.materials.push_back(glassOf(1.5f));
    contents.materials.push_back(glassOf(1.5f));
    contents.solids.push_back({Csg::ball({{0, 0.6f, 1}, 0.5f}, 1)});
    const Camera camera = cameraAt({0, 1.5f, 5}, {0, 0.5f, 0});
    const Image one = renderWhitted(WhittedScene(contents), camera, 40, 30, {});
    contents.solids.push_back({Csg::ball({{0, 0.6f, 1}, 0.25f}, 2)});
    const Image two = renderWhitted(WhittedScene(contents), camera, 40, 30, {});
    // Shadows through glass count surfaces, so the floor is compared through the balls alone.
    double worst = 0;
    for (int y = 8; y < 20; ++y)
        for (int x = 16; x < 24; ++x)
            worst = std::max(worst, static_cast<double>(std::abs(one.pixel(x, y)[0] - two.pixel(x, y)[0])));
    EXPECT_LE(worst, 2e-2);
}

TEST(Whitted, FacingMirrorsAreLookedIntoAsDeepAsIsSaid) {
    WhittedContents contents = furnace();
    contents.materials = {{.diffuse = glm::vec3(0), .mirror = glm::vec3(0.5f)}};
    contents.solids.push_back({Csg::box({{-9, -9, -2}, {9, 9, -1}}, 0)});
    contents.solids.push_back({Csg::box({{-9, -9, 1}, {9, 9, 2}}, 0)});
    const WhittedScene scene(std::move(contents));
    const Camera camera = cameraAt({0, 0, 0.5f}, {0, 0, -1}, 0.01f);
    WhittedCounts counts;
    WhittedSettings settings;
    settings.end = RecursionEnd::depth;
    for (const int depth : {0, 1, 5, 16}) {
        settings.maxDepth = depth;
        renderWhitted(scene, camera, 1, 1, settings, &counts);
        EXPECT_EQ(counts.traceCalls, static_cast<std::uint64_t>(depth) + 1);
        EXPECT_EQ(counts.endedRays, 1u);
    }
    // Each mirror halves the weight: 2^-8 is the last that is not below the threshold.
    settings.end = RecursionEnd::weight;
    settings.minWeight = 0x1p-8f;
    renderWhitted(scene, camera, 1, 1, settings, &counts);
    EXPECT_EQ(counts.traceCalls, 9u);
    // Without an end of its own, the picture ends at the deepest.
    settings.minWeight = 1e-30f;
    renderWhitted(scene, camera, 1, 1, settings, &counts);
    EXPECT_EQ(counts.traceCalls, static_cast<std::uint64_t>(whittedDeepest) + 1);
}

/// A floor, a drilled cube, a glass ball.
WhittedContents someScene() {
    WhittedContents contents = floorAndLamp();
    contents.materials.push_back(glassOf(1.5f));
    contents.materials.push_back({.diffuse = {0.7f, 0.3f, 0.1f}, .ior = 1.5f});
    contents.solids.push_back({subtract(Csg::box({{-1.1f, 0, -0.4f}, {-0.3f, 0.8f, 0.4f}}, 2),
                                        Csg::cylinder({{-0.7f, 0.4f, -1}, {0, 0, 2}, 0.25f}, 2))});
    contents.solids.push_back({Csg::ball({{0.5f, 0.4f, 0.3f}, 0.4f}, 1)});
    return contents;
}

TEST(Whitted, IsTheSameOnAnyNumberOfThreadsCountsIncluded) {
    const WhittedScene scene(someScene());
    const Camera camera = cameraAt({0, 1.8f, 4}, {0, 0.4f, 0});
    WhittedSettings settings;
    settings.end = RecursionEnd::roulette;
    WhittedCounts first;
    WhittedCounts second;
    Image one;
    {
        const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
        one = renderWhitted(scene, camera, 64, 48, settings, &first);
    }
    const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 4);
    const Image many = renderWhitted(scene, camera, 64, 48, settings, &second);
    EXPECT_EQ(one, many);
    EXPECT_EQ(first.traceCalls, second.traceCalls);
    EXPECT_EQ(first.cacheHits, second.cacheHits);
    EXPECT_EQ(first.shadowWalks, second.shadowWalks);
    EXPECT_EQ(first.shadowTraversal.triangles, second.shadowTraversal.triangles);
}

TEST(ShadowCache, ChangesNoPictureAndSparesWalks) {
    const WhittedScene scene(someScene());
    const Camera camera = cameraAt({0, 1.8f, 4}, {0, 0.4f, 0});
    WhittedSettings settings;
    WhittedCounts with;
    WhittedCounts without;
    const Image cached = renderWhitted(scene, camera, 64, 48, settings, &with);
    settings.shadowCache = false;
    const Image plain = renderWhitted(scene, camera, 64, 48, settings, &without);
    EXPECT_EQ(cached, plain);
    EXPECT_EQ(with.shadowRays, without.shadowRays);
    EXPECT_EQ(with.blockedRays, without.blockedRays);
    EXPECT_EQ(with.shadowWalks + with.cacheHits, without.shadowWalks);
    EXPECT_EQ(without.cacheTries, 0u);
    EXPECT_GT(with.cacheHits, with.blockedRays / 2);
}

TEST(Whitted, StructuresGiveTheSamePicture) {
    const Camera camera = cameraAt({0, 1.8f, 4}, {0, 0.4f, 0});
    const Image brute = renderWhitted(WhittedScene(someScene(), Structure::bruteForce), camera, 40, 30, {});
    for (const Structure structure : allStructures)
        if (isAvailable(structure)) {
            EXPECT_EQ(brute, renderWhitted(WhittedScene(someScene(), structure), camera, 40, 30, {}))
                << structureName(structure);
        }
}

TEST(LeaveSurface, StartsAboveTheSurfaceFarAndNear) {
    using oracle::Rational;
    using oracle::RationalVector;
    Random random(31);
    CsgScratch scratch;
    int tried = 0;
    int naiveBelow = 0;
    while (tried < 2000) {
        const double size = std::exp2(random.uniform(-20, 4));
        const double place = random.below(2) == 0 ? 1e6 : size;
        const auto corner = [&] {
            return glm::vec3(place + size * random.uniform(-1, 1), place + size * random.uniform(-1, 1),
                             place + size * random.uniform(-1, 1));
        };
        WhittedContents contents;
        contents.materials.emplace_back();
        Mesh mesh;
        mesh.positions = {corner(), corner(), corner()};
        mesh.indices = {0, 1, 2};
        contents.parts.push_back({mesh, 0});
        const WhittedScene scene(std::move(contents), Structure::bruteForce);
        const glm::vec3 middle = (mesh.positions[0] + mesh.positions[1] + mesh.positions[2]) / 3.0f;
        const glm::vec3 d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const auto hit = scene.nearest({middle - static_cast<float>(3 * size) * d, d}, scratch, nullptr);
        if (!hit)
            continue;
        ++tried;
        for (const double side : {1.0, -1.0}) {
            const glm::vec3 start =
                leaveSurface(hit->point, hit->pointError, hit->normal, side * hit->normal);
            const glm::vec3 naive =
                leaveSurfaceNaive(hit->point, glm::vec3(hit->normal), glm::vec3(side * hit->normal), 1e-4f);
            const RationalVector a(mesh.positions[0]);
            const RationalVector n =
                cross(RationalVector(mesh.positions[1]) - a, RationalVector(mesh.positions[2]) - a);
            const Rational sign(side);
            EXPECT_GT(sign * dot(n, RationalVector(start) - a), 0);
            naiveBelow += sign * dot(n, RationalVector(naive) - a) <= 0;
        }
    }
    EXPECT_GT(naiveBelow, 200);
}

TEST(Whitted, WrongScenesAreErrors) {
    WhittedContents contents = floorAndLamp();
    contents.parts[0].material = 1;
    EXPECT_THROW(WhittedScene{contents}, InputError);
    contents.materials.push_back(glassOf(1.5f));
    EXPECT_THROW(WhittedScene{contents}, InputError);
    contents.parts.clear();
    contents.solids.push_back({unite(Csg::ball({}, 0), Csg::ball({}, 1))});
    EXPECT_THROW(WhittedScene{contents}, InputError);
    std::atomic<bool> stop = true;
    const Image nothing =
        renderWhitted(WhittedScene(floorAndLamp()), cameraAt({0, 1, 4}, {0, 0, 0}), 8, 8, {}, nullptr, &stop);
    EXPECT_EQ(nothing.pixel(4, 4)[3], 0);
}

}  // namespace
}  // namespace quincunx

#include "trace/path.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "image/compare.h"
#include "math/transform.h"
#include "tests/support/allocations.h"
#include "tests/support/temporary_folder.h"
#include "trace/path_scenes.h"
#include "trace/render.h"

namespace quincunx {
namespace {

using test::TemporaryFolder;

constexpr PathMethod allMethods[] = {PathMethod::naive, PathMethod::nee, PathMethod::mis};

/// A scene at an address of its own, ready for paths.
struct Ready {
    explicit Ready(PathSet set)
        : camera(set.scene.cameras.at(0)),
          traced(std::move(set.scene), std::move(set.solids)),
          paths(traced, set.model) {}
    Camera camera;
    TraceScene traced;
    PathScene paths;
};

/// Mean and standard error of independent samples along rays that `rayOf` makes.
struct Estimate {
    double mean = 0;
    double error = 0;

    /// Student's t of the difference to an exact value.
    double t(double exact) const { return (mean - exact) / error; }
};

template <typename Sample>
Estimate estimate(int count, const Sample& sample) {
    Estimate result;
    double squares = 0;
    for (int i = 0; i < count; ++i) {
        PathSampler sampler(3, static_cast<std::uint32_t>(i), 2024);
        const double value = sample(sampler);
        const double off = value - result.mean;
        result.mean += off / (i + 1);
        squares += off * (value - result.mean);
    }
    result.error = std::sqrt(squares / (count * (count - 1.0)));
    return result;
}

// A t beyond 4.5 comes by chance once in 150 000 times; with fixed seeds it comes or it does not.
constexpr double farOff = 4.5;

TEST(Path, AllMethodsMeetTheFurnace) {
    for (const float albedo : {0.0f, 0.5f, 0.9f}) {
        const Ready furnace(makeFurnace(albedo));
        for (const PathMethod method : allMethods) {
            const Estimate light = estimate(4000, [&](PathSampler& sampler) {
                const Ray ray = cameraRay(furnace.camera, 1, 1, sampler.next2());
                return tracePath(method, furnace.paths, ray, sampler).g;
            });
            const double exact = furnaceRadiance(albedo);
            if (albedo == 0)
                EXPECT_NEAR(light.mean, exact, 1e-6);
            else
                EXPECT_LT(std::abs(light.t(exact)), farOff)
                    << static_cast<int>(method) << ": " << light.mean << " ± " << light.error;
            EXPECT_LT(light.error, 0.06 * exact);
        }
    }
}

TEST(Path, AllMethodsMeetTwoBodiesThatExchangeLight) {
    for (const auto& [inner, ballAlbedo, shellAlbedo] :
         {std::tuple(0.5f, 0.6f, 0.7f), std::tuple(0.1f, 0.2f, 0.9f)}) {
        const Ready shell(makeShell(inner, ballAlbedo, shellAlbedo));
        const ShellRadiance exact = shellRadiance(inner, ballAlbedo, shellAlbedo);
        for (const PathMethod method : allMethods) {
            const Estimate ball = estimate(3000, [&](PathSampler& sampler) {
                return tracePath(method, shell.paths, {{0, 0, 0.99f}, {0.01f, 0.02f, -1}}, sampler).g;
            });
            const Estimate wall = estimate(6000, [&](PathSampler& sampler) {
                return tracePath(method, shell.paths, {{0, 0, -0.75f}, {0.3f, 0.2f, -1}}, sampler).g;
            });
            EXPECT_LT(std::abs(ball.t(exact.ball)), farOff)
                << static_cast<int>(method) << ": " << ball.mean << " ± " << ball.error << ", " << exact.ball;
            EXPECT_LT(std::abs(wall.t(exact.shell)), farOff) << static_cast<int>(method) << ": " << wall.mean
                                                             << " ± " << wall.error << ", " << exact.shell;
        }
    }
}

TEST(Path, DirectLightOfABallIsItsFormFactor) {
    const double radius = 0.5;
    const double height = 1;
    const Ready floor(makeBallOverFloor(0.8f, static_cast<float>(radius), static_cast<float>(height)));
    for (const double x : {0.6, 2.0, 30.0}) {
        const double exact = ballOverFloorRadiance(static_cast<double>(0.8f), radius, height, x);
        const Ray ray{{static_cast<float>(x), 3, 1e-3f}, {0, -1, 0}};
        for (const PathMethod method : {PathMethod::nee, PathMethod::mis}) {
            const Estimate light = estimate(1500, [&](PathSampler& sampler) {
                return tracePath(method, floor.paths, ray, sampler, {.maxBounces = 1}).g;
            });
            // Drawn by the angle that it fills, the light is nearly the same for all samples.
            EXPECT_LT(std::abs(light.mean - exact), farOff * light.error + 1e-5 * exact) << x;
            EXPECT_LT(light.error, 0.02 * exact) << x;
        }
    }
}

TEST(Path, TheTreeAgreesWithThePaths) {
    const Ready shell(makeShell(0.5f, 0.6f, 0.7f));
    const Ray ray{{0, 0, -0.75f}, {0.3f, 0.2f, -1}};
    const PathLimits limits{.maxBounces = 4, .rouletteThreshold = 0};
    const Estimate paths = estimate(
        6000, [&](PathSampler& sampler) { return tracePathNee(shell.paths, ray, sampler, limits).g; });
    PathCounts counts;
    const Estimate tree = estimate(300, [&](PathSampler& sampler) {
        return traceTree(shell.paths, ray, sampler, 3, limits, &counts).g;
    });
    EXPECT_LT(std::abs(paths.mean - tree.mean), farOff * std::hypot(paths.error, tree.error));
    for (std::size_t level = 0; level <= 4; ++level)
        EXPECT_EQ(counts.raysAtLevel[level], 300 * std::pow(3.0, level)) << level;
}

/// A flat sheet across the view, facing +y, of which a ray goes through with the probability ¾.
void addVeil(Scene& scene, float height, glm::vec3 emission = glm::vec3(0)) {
    Material veil;
    veil.baseColor = {0, 0, 0, 0.25f};
    veil.emission = emission;
    veil.alphaMode = Material::AlphaMode::blend;
    Mesh mesh;
    mesh.positions = {{-50, height, -50}, {-50, height, 50}, {50, height, 50}, {50, height, -50}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.instances.push_back({"veil", scene.meshes.size(), scene.materials.size(), glm::mat4(1)});
    scene.meshes.push_back(mesh);
    scene.materials.push_back(veil);
}

TEST(Path, SurfacesThatBlendLetTheirShareOfLightThrough) {
    // Two veils between the shining ball and the floor, and three between that and an eye above them all.
    PathSet set = makeBallOverFloor(0.5f, 0.4f, 2);
    for (const float height : {0.5f, 1.0f, 3.0f})
        addVeil(set.scene, height);
    const double clear = ballOverFloorRadiance(0.5, static_cast<double>(0.4f), 2, 1);
    const Ready veiled(set);
    const PathLimits direct{.maxBounces = 1, .rouletteThreshold = 0};
    for (const bool above : {false, true})
        for (const PathMethod method : allMethods) {
            const Ray ray{{1, above ? 4.0f : 0.3f, 0}, {0, -1, 0}};
            const double share = std::pow(0.75, above ? 5 : 2);
            const Estimate light = estimate(above ? 60000 : 30000, [&](PathSampler& sampler) {
                return tracePath(method, veiled.paths, ray, sampler, direct).g;
            });
            EXPECT_LT(std::abs(light.t(share * clear)), farOff) << static_cast<int>(method) << above;
            EXPECT_GT(std::abs(light.t(clear)), 2 * farOff) << "as much as without veils";
        }
    // What is behind blends as pictures do: a quarter of the veil, three of the rest.
    PathSet sky;
    sky.scene.environment.emplace().panorama = Image(1, 1, 3, Encoding::linear);
    std::fill_n(sky.scene.environment->panorama.data.begin(), 3, 1.0f);
    sky.scene.cameras.emplace_back();
    addVeil(sky.scene, 0, {8, 8, 8});
    const Ready shining(sky);
    const Estimate both = estimate(20000, [&](PathSampler& sampler) {
        return tracePathMis(shining.paths, {{0, 1, 0}, {0, -1, 0}}, sampler).g;
    });
    EXPECT_LT(std::abs(both.t(0.25 * 8 + 0.75 * 1)), farOff);
}

TEST(Path, LightsThatBlendAreFoundByChanceAndByChoiceAlike) {
    PathSet set = makeBallOverFloor(0.5f, 0.4f, 2);
    set.scene.materials[set.solids[0].material].emission = glm::vec3(0);
    Material lamp;
    lamp.baseColor = {0, 0, 0, 0.5f};
    lamp.emission = glm::vec3(3);
    lamp.doubleSided = true;
    lamp.alphaMode = Material::AlphaMode::blend;
    Mesh mesh;
    mesh.positions = {{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    set.scene.instances.push_back(
        {"lamp", set.scene.meshes.size(), set.scene.materials.size(), glm::mat4(1)});
    set.scene.meshes.push_back(mesh);
    set.scene.materials.push_back(lamp);
    const Ready ready(set);
    const Ray ray{{0.3f, 0.5f, 0}, {0, -1, 0}};
    const auto by = [&](PathMethod method) {
        return estimate(20000, [&](PathSampler& sampler) {
            return tracePath(method, ready.paths, ray, sampler, {.maxBounces = 1}).g;
        });
    };
    const Estimate naive = by(PathMethod::naive);
    for (const PathMethod method : {PathMethod::nee, PathMethod::mis}) {
        const Estimate other = by(method);
        EXPECT_GT(other.mean, 0.1);
        EXPECT_LT(std::abs(other.mean - naive.mean) / std::hypot(other.error, naive.error), farOff);
    }
    // The terms at the point: all of the light comes straight from the lamp.
    const EquationTerms terms = estimateTerms(ready.paths, ray, 20000, 3, {.maxBounces = 0});
    EXPECT_LT(std::abs(terms.direct.g - naive.mean) / std::hypot(terms.directError.g, naive.error), farOff);
    EXPECT_LT(std::abs(terms.indirect.g), farOff * terms.indirectError.g + 1e-6);
}

TEST(Path, EnvironmentsLightByChanceAndByChoiceAlike) {
    PathSet set;
    set.model = OpaqueModel::lambert;
    set.scene.ambientLight = glm::vec3(0);
    Material ball;
    ball.baseColor = glm::vec4(0.7f, 0.7f, 0.7f, 1);
    set.scene.materials = {ball};
    set.solids = {{Sphere{1}, 0, glm::mat4(1)}};
    Environment& sky = set.scene.environment.emplace();
    sky.panorama = Image(16, 8, 3, Encoding::linear);
    for (std::size_t i = 0; i < sky.panorama.data.size(); ++i)
        sky.panorama.data[i] = i / 3 == 20 ? 30.0f : 0.2f + 0.01f * static_cast<float>(i % 7);
    set.scene.cameras = {Camera{}};
    const Ready ready(std::move(set));
    const Ray ray{{0.2f, 0.7f, 5}, {0, 0, -1}};
    std::vector<Estimate> estimates;
    for (const PathMethod method : allMethods)
        estimates.push_back(estimate(method == PathMethod::naive ? 20000 : 5000, [&](PathSampler& sampler) {
            return tracePath(method, ready.paths, ray, sampler).g;
        }));
    EXPECT_LT(std::abs(estimates[0].mean - estimates[2].mean),
              farOff * std::hypot(estimates[0].error, estimates[2].error));
    EXPECT_LT(std::abs(estimates[1].mean - estimates[2].mean),
              farOff * std::hypot(estimates[1].error, estimates[2].error));
    EXPECT_LT(estimates[2].error, estimates[0].error);

    // A white sky is a furnace: whatever mirrors or lets through all light is not seen.
    PathSet white;
    white.scene.ambientLight = glm::vec3(0);
    Material clear;
    clear.transmission = 1;
    clear.roughness = 0;
    white.scene.materials = {clear};
    white.solids = {{Sphere{1}, 0, glm::mat4(1)}, {Torus{2, 0.4}, 0, glm::mat4(1)}};
    white.scene.environment.emplace().panorama = Image(2, 2, 3, Encoding::linear);
    for (float& value : white.scene.environment->panorama.data)
        value = 1;
    white.scene.cameras = {Camera{}};
    const Ready glass(std::move(white));
    for (int i = 0; i < 300; ++i) {
        PathSampler sampler(1, static_cast<std::uint32_t>(i), 5);
        const glm::vec2 at = 3.0f * sampler.next2() - 1.5f;
        const glm::vec3 light = tracePathMis(glass.paths, {{at, 6}, {0, 0, -1}}, sampler);
        EXPECT_NEAR(light.g, 1, 2e-5);
    }
}

TEST(Path, LightsWithoutExtentAreSeenByChoiceAndDarkByChance) {
    PathSet set = makeFurnace(0.5f);
    for (Material& material : set.scene.materials)
        material.emission = glm::vec3(0);
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.intensity = 2;
    lamp.position = {0, 0.5f, 0};
    set.scene.lights = {lamp};
    const Ready room(std::move(set));
    const Ray down{{0.25f, 0, 0.1f}, {0, -1, 0}};
    const double squared = 0.25 * 0.25 + 1.5 * 1.5 + 0.1 * 0.1;
    // intensity is divided by π: f π I cos / d², f = albedo / π.
    const double exact = 0.5 * 2 * (1.5 / std::sqrt(squared)) / squared;
    PathSampler sampler(0, 0, 1);
    const PathLimits once{.maxBounces = 1};
    EXPECT_NEAR(tracePathNee(room.paths, down, sampler, once).g, exact, 1e-5 * exact);
    EXPECT_NEAR(tracePathMis(room.paths, down, sampler, once).g, exact, 1e-5 * exact);
    EXPECT_EQ(tracePathNaive(room.paths, down, sampler), glm::vec3(0));
}

TEST(Path, TheTermsOfTheEquationAddUp) {
    const Ready furnace(makeFurnace(0.5f));
    const EquationTerms terms =
        estimateTerms(furnace.paths, cameraRay(furnace.camera, 8, 8, {2.5f, 5.5f}), 4000, 3);
    EXPECT_EQ(terms.emitted.g, 1);
    // The walls' own light, scattered once: ½. Scattered more often: ½² / (1 − ½).
    EXPECT_NEAR(terms.direct.g, 0.5, farOff * terms.directError.g + 1e-6);
    EXPECT_NEAR(terms.indirect.g, 0.5, farOff * terms.indirectError.g);
    EXPECT_GT(terms.indirectError.g, 0);
    EXPECT_LT(terms.indirectError.g, 0.02f);
}

TEST(Path, TheTermsAreTheSameHoweverTheirDrawsAreSharedOut) {
    const Ready chamber(makeChamber());
    const Ray ray = cameraRay(chamber.camera, 8, 8, {3.5f, 6.5f});
    const EquationTerms whole = estimateTerms(chamber.paths, ray, 300, 3, {.maxBounces = 5});
    TermEstimate parts(chamber.paths, ray, 3, {.maxBounces = 5});
    EXPECT_EQ(parts.terms().direct, glm::vec3(0));
    EXPECT_TRUE(std::isinf(parts.terms().directError.g));
    for (const int samples : {1, 0, 99, 200})
        parts.add(samples);
    EXPECT_EQ(parts.samples(), 300);
    EXPECT_EQ(parts.terms().direct, whole.direct);
    EXPECT_EQ(parts.terms().indirect, whole.indirect);
    EXPECT_EQ(parts.terms().directError, whole.directError);
    EXPECT_EQ(parts.terms().indirectError, whole.indirectError);
    EXPECT_GT(whole.sum().g, 0);
}

TEST(Path, RouletteKeepsTheMeanAndACutoffLosesLight) {
    const Ready furnace(makeFurnace(0.9f));
    const Ray ray = cameraRay(furnace.camera, 8, 8, {2.5f, 5.5f});
    const auto with = [&](PathLimits limits) {
        return estimate(4000, [&](PathSampler& sampler) {
            return tracePathNaive(furnace.paths, ray, sampler, limits).g;
        });
    };
    EXPECT_LT(std::abs(with({.rouletteThreshold = 1}).t(10)), farOff);
    EXPECT_LT(std::abs(with({.rouletteThreshold = 0.1f}).t(10)), farOff);
    // Without chance: 1 + 0.9 + … as long as 0.9^n ≥ 0.05, and up to eight bounces.
    EXPECT_NEAR(with({.rouletteThreshold = 0, .cutoff = 0.05f}).mean, 10 * (1 - std::pow(0.9, 29)), 1e-4);
    EXPECT_NEAR(with({.maxBounces = 8, .rouletteThreshold = 0}).mean, 10 * (1 - std::pow(0.9, 9)), 1e-4);
}

TEST(Path, WhatIsNoNumberInAPictureIsNotInTheLight) {
    PathSet set = makeChamber();
    set.scene.instances.resize(3);  // open above
    Environment& sky = set.scene.environment.emplace();
    sky.panorama = Image(4, 4, 3, Encoding::linear);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < sky.panorama.data.size(); ++i)
        sky.panorama.data[i] = i % 3 == 0 ? nan : i % 5 == 0 ? std::numeric_limits<float>::infinity() : 1.0f;
    set.scene.materials[set.solids[0].material].emission = glm::vec3(nan);
    const Ready ready(std::move(set));
    for (const PathMethod method : allMethods) {
        ProgressiveRender render(ready.paths,
                                 {.width = 12, .height = 9, .camera = ready.camera, .method = method});
        render.addSamples(4);
        for (const float value : render.picture().data) {
            EXPECT_TRUE(std::isfinite(value));
            EXPECT_GE(value, 0);
        }
    }
}

TEST(Path, FarFromTheOriginThePictureIsTheSame) {
    PathSet here = makeChamber();
    const glm::dvec3 far(1048576, -524288, 262144);
    // What stands at places of few digits keeps them; the room's walls have theirs in their meshes.
    const auto snap = [](glm::mat4& m) {
        for (int i = 0; i < 3; ++i)
            m[3][i] = std::round(m[3][i] * 8) / 8;
    };
    for (TracedSolid& solid : here.solids)
        snap(solid.worldFromModel);
    snap(here.scene.cameras[0].worldFromCamera);
    PathSet there = here;
    there.scene = movedBy(there.scene, far);
    for (TracedSolid& solid : there.solids)
        for (int i = 0; i < 3; ++i)
            solid.worldFromModel[3][i] += static_cast<float>(far[i]);
    there.scene = movedBy(there.scene, -far);
    for (TracedSolid& solid : there.solids)
        for (int i = 0; i < 3; ++i)
            solid.worldFromModel[3][i] -= static_cast<float>(far[i]);
    const auto picture = [](PathSet set) {
        const Ready ready(std::move(set));
        ProgressiveRender render(ready.paths, {.width = 16, .height = 12, .camera = ready.camera});
        render.addSamples(2);
        return render.picture();
    };
    EXPECT_EQ(picture(here), picture(there));
}

RenderSettings smallSettings(const Ready& ready) {
    return {.width = 24, .height = 18, .camera = ready.camera};
}

TEST(ProgressiveRender, IsTheSameOnAnyNumberOfThreadsAndInAnyPasses) {
    const Ready chamber(makeChamber());
    ProgressiveRender all(chamber.paths, smallSettings(chamber));
    all.addSamples(6);
    ProgressiveRender parts(chamber.paths, smallSettings(chamber));
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        parts.addSamples(1);
        parts.addSamples(3);
    }
    parts.addSamples(2);
    EXPECT_EQ(all.picture(), parts.picture());
    EXPECT_EQ(all.errorEstimate(), parts.errorEstimate());
    EXPECT_EQ(all.counts().raysAtLevel, parts.counts().raysAtLevel);
}

TEST(ProgressiveRender, SlicesOfAPassAddUpToIt) {
    const Ready chamber(makeChamber());
    const auto past = std::chrono::steady_clock::time_point::min();
    RenderSettings settings = smallSettings(chamber);
    settings.width = 45;
    settings.height = 35;
    ProgressiveRender whole(chamber.paths, settings);
    ProgressiveRender sliced(chamber.paths, settings);
    for (int pass = 1; pass <= 3; ++pass) {
        whole.addSamples(1);
        int slices = 1;
        while (!sliced.addSlice(past))
            ++slices;
        EXPECT_EQ(sliced.samples(), pass);
        // Every slice goes on by 16 pixels for each of the threads, however late it is.
        EXPECT_GT(slices, 5);
        EXPECT_EQ(sliced.picture(), whole.picture());
        EXPECT_EQ(sliced.errorEstimate(), whole.errorEstimate());
        EXPECT_EQ(sliced.counts().rays(), whole.counts().rays());
    }
    sliced.addSlice(past);
    EXPECT_EQ(sliced.samples(), 3);
    whole.addSamples(2);
    sliced.addSamples(2);
    EXPECT_EQ(sliced.picture(), whole.picture());
    while (!sliced.addSlice(std::chrono::steady_clock::time_point::max())) {
    }
    whole.addSamples(1);
    EXPECT_EQ(sliced.picture(), whole.picture());
}

TEST(ProgressiveRender, ShowsAFirstPassFromCoarseToFine) {
    const Ready furnace(makeFurnace(0));
    ProgressiveRender render(furnace.paths, {.width = 70, .height = 37, .camera = furnace.camera});
    int slices = 0;
    bool whole = false;
    while (!whole) {
        whole = render.addSlice(std::chrono::steady_clock::time_point::min());
        ++slices;
        const Image picture = render.picture();
        // Five by three pixels lie on the coarsest lattice: they are there at once.
        for (std::size_t i = 0; i < picture.data.size(); ++i)
            ASSERT_EQ(picture.data[i], 1) << slices;
    }
    EXPECT_GT(slices, 3);
}

TEST(ProgressiveRender, TakesNoMemoryForRays) {
    const Ready chamber(makeChamber());
    const auto allocated = [&](int samples) {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        ProgressiveRender render(chamber.paths, smallSettings(chamber));
        render.addSamples(1);
        const std::uint64_t before = test::allocationCount();
        render.addSamples(samples);
        return test::allocationCount() - before;
    };
    allocated(1);
    const std::uint64_t few = allocated(1);
    const std::uint64_t many = allocated(20);
    // Tiles take a little, samples nothing.
    EXPECT_EQ(few, many);
}

TEST(ProgressiveRender, GoesOnWhereItWasStopped) {
    const TemporaryFolder folder;
    const Ready chamber(makeChamber());
    ProgressiveRender whole(chamber.paths, smallSettings(chamber));
    whole.addSamples(5);
    {
        ProgressiveRender first(chamber.paths, smallSettings(chamber));
        first.addSamples(2);
        first.save(folder / "picture.checkpoint");
        const std::atomic<bool> stop{true};
        EXPECT_FALSE(first.addSamples(3, &stop));
        EXPECT_EQ(first.samples(), 2);
    }
    ProgressiveRender second(chamber.paths, smallSettings(chamber));
    second.load(folder / "picture.checkpoint");
    EXPECT_EQ(second.samples(), 2);
    second.addSamples(3);
    EXPECT_EQ(whole.picture(), second.picture());
    EXPECT_EQ(whole.errorEstimate(), second.errorEstimate());
}

TEST(ProgressiveRender, RefusesCheckpointsThatAreNotItsOwn) {
    const TemporaryFolder folder;
    const Ready chamber(makeChamber());
    ProgressiveRender render(chamber.paths, smallSettings(chamber));
    render.addSamples(1);
    const std::filesystem::path file = folder / "picture.checkpoint";
    render.save(file);
    RenderSettings others = smallSettings(chamber);
    others.seed = 2;
    ProgressiveRender other(chamber.paths, others);
    EXPECT_THROW(other.load(file), InputError);
    const Ready furnace(makeFurnace(0.5f));
    RenderSettings same = smallSettings(chamber);
    ProgressiveRender another(furnace.paths, same);
    EXPECT_THROW(another.load(file), InputError);
    std::string bytes;
    {
        std::FILE* const stream = std::fopen(file.c_str(), "rb");
        ASSERT_TRUE(stream);
        for (int c = std::fgetc(stream); c != EOF; c = std::fgetc(stream))
            bytes.push_back(static_cast<char>(c));
        std::fclose(stream);
    }
    for (const std::size_t length : {std::size_t{0}, std::size_t{7}, bytes.size() / 2, bytes.size() - 1})
        EXPECT_THROW(render.load(folder.file("cut", bytes.substr(0, length))), InputError) << length;
    std::string flipped = bytes;
    flipped[bytes.size() / 2] ^= 1;
    EXPECT_THROW(render.load(folder.file("flipped", flipped)), InputError);
    EXPECT_EQ(render.samples(), 1) << "nothing was taken over";
    render.load(folder.file("whole", bytes));
}

TEST(ProgressiveRender, ErrorsFallWithTheRootOfTheSamples) {
    const Ready chamber(makeChamber());
    RenderSettings settings = smallSettings(chamber);
    settings.numbers = PathSampler::Kind::independent;
    settings.limits.maxBounces = 3;
    RenderSettings other = settings;
    other.seed = 99;
    ProgressiveRender reference(chamber.paths, other);
    reference.addSamples(700);
    const Image exact = reference.picture();
    ProgressiveRender render(chamber.paths, settings);
    std::vector<double> logs;
    std::vector<double> errors;
    for (const int samples : {2, 2, 4, 8, 16}) {
        render.addSamples(samples);
        logs.push_back(std::log(render.samples()));
        // RMSE counts alpha too, which is right: by 4/3 of the square less.
        errors.push_back(std::log(rmse(exact, render.picture()) * std::sqrt(4.0 / 3)));
    }
    const double meanLog = std::accumulate(logs.begin(), logs.end(), 0.0) / 5;
    const double meanError = std::accumulate(errors.begin(), errors.end(), 0.0) / 5;
    double over = 0;
    double under = 0;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        over += (logs[i] - meanLog) * (errors[i] - meanError);
        under += (logs[i] - meanLog) * (logs[i] - meanLog);
    }
    EXPECT_NEAR(over / under, -0.5, 0.08);
    // The estimate knows the error without a reference.
    EXPECT_NEAR(std::log(render.errorEstimate()), errors.back(), std::log(1.35));
}

}  // namespace
}  // namespace quincunx

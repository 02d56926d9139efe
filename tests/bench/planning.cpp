// What planning a frame of ten thousand objects costs, beside the CPU time that the calling thread spends on
// submitting it: building the graph, sending placements, and all GL calls.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/transform.h"
#include "passes/frame_renderer.h"
#include "scene/finish.h"

namespace {

using namespace quincunx;

double threadSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

/// Solids in a hall, all before the camera, every fifth of glass; a sun, a spot and a lamp.
Scene tenThousandObjects() {
    Scene scene;
    scene.meshes = {tessellate(Sphere{}, 6), tessellate(Torus{}, 6), tessellate(Capsule{}, 6)};
    for (int i = 0; i < 5; ++i)
        scene.materials.push_back(
            makeMaterial("m", {.diffuse = {0.1f * static_cast<float>(i), 0.5f, 0.4f}, .roughness = 0.8f}));
    scene.materials.back().alphaMode = Material::AlphaMode::blend;
    scene.materials.back().baseColor.a = 0.5f;
    Random random(1);
    for (int i = 0; i < 10'000; ++i) {
        glm::mat4 placement(0.2f);
        placement[3] = {random.uniform(-20, 20), random.uniform(-12, 12), random.uniform(-60, -30), 1};
        scene.instances.push_back({"object", random.below(3), random.below(5), placement});
    }
    scene.lights.resize(3);
    scene.lights[0].direction = glm::normalize(glm::vec3(-1, -2, -1));
    scene.lights[1].kind = Light::Kind::spot;
    scene.lights[1].position = {0, 10, -20};
    scene.lights[1].direction = glm::normalize(glm::vec3(0, -1, -1));
    scene.lights[2].kind = Light::Kind::point;
    scene.lights[2].position = {0, 0, -40};
    scene.lights[2].range = 15;
    return scene;
}

struct Stage {
    std::unique_ptr<gl::Context> context = gl::createOffscreenContext(gl::Backend::automatic);
    Scene scene = tenThousandObjects();
    gl::Executor executor;
    FrameRenderer renderer;
    int frame = 0;

    /// A camera that moves a little from frame to frame, as a person's does.
    FrameView view() {
        FrameView result{.scene = scene, .camera = {}, .width = 320, .height = 240};
        const float sway = 0.01f * static_cast<float>(frame++ % 100);
        result.camera.worldFromCamera = lookAt({sway, 0, 0}, {0, 0, -40}, {0, 1, 0});
        result.settings.shadowResolution = 256;
        return result;
    }
    void submit() {
        graph::FrameGraph graph;
        graph.addOutput(renderer.build(graph, view()));
        executor.run(graph);
    }
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    Stage stage;
    benchmark::RegisterBenchmark("plan 10000 objects", [&](benchmark::State& state) {
        for (auto _ : state)
            benchmark::DoNotOptimize(stage.renderer.plan(stage.view()));
    })->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("submit 10000 objects", [&](benchmark::State& state) {
        for (auto _ : state)
            stage.submit();
    })->Unit(benchmark::kMillisecond);
    benchmark::RunSpecifiedBenchmarks();

    std::vector<double> plans;
    std::vector<double> submits;
    for (int round = 0; round < 25; ++round) {
        double start = threadSeconds();
        stage.renderer.plan(stage.view());
        plans.push_back(threadSeconds() - start);
        start = threadSeconds();
        stage.submit();
        submits.push_back(threadSeconds() - start);
        glFinish();
    }
    const FramePlan& plan = stage.renderer.plan();
    std::printf(
        "planning / CPU submit time of the frame: %.4f (%.3f ms / %.3f ms, medians of 25 frames; %d of "
        "%d objects in view)\n",
        median(plans) / median(submits), median(plans) * 1e3, median(submits) * 1e3,
        static_cast<int>(plan.drawn), static_cast<int>(plan.instances));
    return 0;
}

#include "labs/26_ray_tracing/lab.h"

#include <algorithm>
#include <chrono>

#include "gl/executor.h"
#include "gl/program.h"
#include "gl/upload.h"
#include "scene/import.h"
#include "trace/grid.h"

namespace quincunx {
namespace {

constexpr int coarsest = 8;

Camera fitted(const Frame& frame) {
    return fittedToAspect(frame.camera, static_cast<float>(frame.width) / static_cast<float>(frame.height));
}

}  // namespace

std::vector<Structure> RayTracingLab::structures() {
    std::vector<Structure> available;
    for (const Structure structure : allStructures)
        if (isAvailable(structure))
            available.push_back(structure);
    return available;
}

std::vector<std::string> RayTracingLab::structureNames() {
    std::vector<std::string> names;
    for (const Structure structure : structures())
        names.emplace_back(structureName(structure));
    return names;
}

int RayTracingLab::defaultStructure() {
    const std::vector<Structure> all = structures();
    return static_cast<int>(std::find(all.begin(), all.end(), Structure::wideBvh) - all.begin());
}

WhittedSettings RayTracingLab::settings() const {
    WhittedSettings settings;
    settings.end = end.as<RecursionEnd>();
    settings.maxDepth = maxDepth;
    settings.minWeight = minWeight;
    settings.shadowRays = shadowRays;
    settings.pattern = samplePatternOfName(pattern.text()).value();
    settings.shadowCache = shadowCache;
    settings.pixelSamples = supersample;
    return settings;
}

std::shared_ptr<const WhittedScene> RayTracingLab::scene() const {
    std::vector<double> state{static_cast<double>(sculpture.index()), lampSize,
                              static_cast<double>(structure.index()), static_cast<double>(mailboxes.index())};
    if (!scene_ || state != sceneState_) {
        const Structure chosen = structures()[static_cast<std::size_t>(structure.index())];
        scene_ = std::make_shared<const WhittedScene>(
            makeTerrace(sculpture.as<Sculpture>(), lampSize),
            [&](TriangleView triangles) -> std::unique_ptr<Accelerator> {
                if (chosen == Structure::grid)
                    return std::make_unique<Grid>(triangles,
                                                  GridParams{.mailboxes = mailboxes.as<Mailboxes>()});
                return makeAccelerator(chosen, triangles);
            });
        sceneState_ = std::move(state);
    }
    return scene_;
}

std::vector<double> RayTracingLab::stateOf(const Frame& frame) const {
    std::vector<double> state{static_cast<double>(frame.width), static_cast<double>(frame.height),
                              frame.camera.fovYRadians, static_cast<double>(frame.seed)};
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            state.push_back(frame.camera.worldFromCamera[column][row]);
    state.insert(state.end(), {static_cast<double>(end.index()), static_cast<double>(maxDepth), minWeight,
                               static_cast<double>(shadowRays), static_cast<double>(pattern.index()),
                               lampSize, static_cast<double>(mailboxes.index()), shadowCache ? 1.0 : 0.0,
                               static_cast<double>(structure.index()), static_cast<double>(sculpture.index()),
                               static_cast<double>(supersample)});
    return state;
}

void RayTracingLab::begin(const Frame& frame, int step) {
    WhittedSettings with = settings();
    with.seed = frame.seed;
    if (step > 1)
        with.pixelSamples = 1;
    const Image under = render_ && step < coarsest ? render_->picture() : Image{};
    rendered_ = scene();
    render_.emplace(*rendered_, fitted(frame), (frame.width + step - 1) / step,
                    (frame.height + step - 1) / step, with, frame.live ? under : Image{});
    step_ = step;
    uploaded_ = false;
}

void RayTracingLab::traceFrame(const Frame& frame) {
    std::vector<double> state = stateOf(frame);
    if (!render_ || state != state_ || (!frame.live && step_ > 0))
        begin(frame, frame.live ? coarsest : 1);
    state_ = std::move(state);
    if (!frame.live && step_ > 0) {
        render_->traceTiles();
        step_ = 0;
    }
    const auto start = std::chrono::steady_clock::now();
    const auto left = [&] {
        return liveSeconds - std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    while (step_ > 0) {
        uploaded_ = false;
        const bool done = render_->traceTiles(left());
        if (done && step_ > 1)
            begin(frame, step_ / 2);
        else if (done)
            step_ = 0;
        if (left() <= 0)
            break;
    }
}

graph::Resource RayTracingLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    graph.addPass({.name = "show what was traced",
                   .reads = {},
                   .writes = {picture},
                   .execute = [this, frame](graph::PassContext& context) { draw(context, frame); }});
    return picture;
}

void RayTracingLab::draw(graph::PassContext& context, const Frame& frame) {
    traceFrame(frame);
    constexpr int unit = 1;
    const Image& picture = render_->picture();
    if (!texture_ || texture_->width() != picture.width || texture_->height() != picture.height) {
        texture_.emplace("traced", GL_RGBA32F, picture.width, picture.height);
        uploaded_ = false;
    }
    if (!uploaded_)
        gl::upload(*texture_, 0, 0, picture);
    uploaded_ = true;
    const gl::Program& program = context.programs().get({.label = "show what was traced",
                                                         .vertex = "passes/fullscreen.vert",
                                                         .fragment = "labs/26_ray_tracing/show.frag"});
    program.use();
    program.set("traced", unit);
    program.set("viewport", glm::vec2(frame.width, frame.height));
    texture_->bind(unit);
    context.drawFullscreen();
}

void RayTracingLab::markIdleKnobs() {
    const bool byDepth = end.as<RecursionEnd>() == RecursionEnd::depth;
    maxDepth.setIdle(byDepth ? "" : "the tree ends by weight");
    mailboxes.setIdle(structures()[static_cast<std::size_t>(structure.index())] == Structure::grid
                          ? ""
                          : "only the grid has a triangle in several places");
    minWeight.setIdle(byDepth ? "the tree ends by depth" : "");
}

std::map<std::string, std::uint64_t> RayTracingLab::counters() const {
    if (!render_)
        return {};
    const WhittedCounts counts = render_->counts();
    return {{"trace calls", counts.traceCalls},
            {"shade calls", counts.shadeCalls},
            {"rays ended early", counts.endedRays},
            {"shadow rays", counts.shadowRays},
            {"shadow cache hits", counts.cacheHits},
            {"structure nodes", counts.viewTraversal.nodes + counts.shadowTraversal.nodes},
            {"triangle tests", counts.viewTraversal.triangles + counts.shadowTraversal.triangles}};
}

Lab::ReferenceJob RayTracingLab::reference(const Frame& frame) const {
    WhittedSettings with = settings();
    with.end = RecursionEnd::weight;
    with.minWeight = 1 / 4096.0f;
    with.shadowRays = 256;
    with.pattern = SamplePattern::sobol;
    with.shadowCache = true;
    return [scene = scene(), camera = fitted(frame), width = frame.width, height = frame.height,
            with](const std::atomic<bool>& stop) {
        Image image = renderWhitted(*scene, camera, width, height, with, nullptr, &stop);
        return stop ? Image{} : image;
    };
}

Exercise RayTracingLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"mirrors and glass", {{"max-depth", "0"}}},
                        {"the sculpture", {{"sculpture", "union"}}},
                        {"the half-shadows", {{"lamp-size", "0.05"}}}};
    exercise.freeKnobs = {"structure", "shadow-cache", "mailboxes"};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::RayTracingLab)

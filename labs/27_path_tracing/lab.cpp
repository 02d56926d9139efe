#include "labs/27_path_tracing/lab.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "gl/upload.h"
#include "scene/import.h"

namespace quincunx {
namespace {

using Clock = std::chrono::steady_clock;

/// How long a window's frame is worked at before what there is is shown: a share of the time that nothing has
/// changed for, so that a hand on a knob sees many frames and a picture at rest is soon whole.
constexpr int restShare = 8;
constexpr std::chrono::milliseconds leastSlice{8};
constexpr std::chrono::milliseconds longestSlice{32};
/// The terms' part of it.
constexpr int termShare = 4;
constexpr int termSamples = 2048;
/// So many are drawn between two looks at the clock.
constexpr int termsALook = 16;

/// Rays that a tree has at its last level, at most: each level has `branches` times those of the one before.
constexpr int mostLeaves = 64;

int treeDepth(int bounces, int branches) {
    int depth = 0;
    for (int leaves = 1; depth < bounces && leaves <= mostLeaves / branches && depth < 8; ++depth)
        leaves *= branches;
    return depth;
}

float luminance(glm::vec3 c) {
    return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

PathSet makeSet(PathTracingLab::Subject subject, float albedo) {
    switch (subject) {
        case PathTracingLab::Subject::chamber:
            return makeChamber();
        case PathTracingLab::Subject::balls:
            return makeBallField(27);
        case PathTracingLab::Subject::furnace:
            return makeFurnace(albedo);
        case PathTracingLab::Subject::shell:
            break;
    }
    return makeShell(0.4f, 0.6f, 0.8f);
}

Camera cameraOf(const PathSet& set) {
    return set.scene.cameras.empty() ? frameBounds(set.scene.bounds(), composedAspect)
                                     : set.scene.cameras.front();
}

}  // namespace

PathStage::PathStage(PathSet set)
    : camera(cameraOf(set)), traced(std::move(set.scene), std::move(set.solids)), paths(traced, set.model) {}

void PathTracingLab::useScene(Scene scene) {
    const bool shines =
        !scene.lights.empty() || scene.environment ||
        std::any_of(scene.materials.begin(), scene.materials.end(),
                    [](const Material& material) { return material.emission != glm::vec3(0); });
    if (!shines)
        scene.lights = studioLights();
    imported_ = std::move(scene);
    live_ = {};
    whole_ = {};
    terms_.reset();
    stage_.reset();
}

const PathStage& PathTracingLab::stage() {
    const std::pair<int, float> wanted{subject.index(), albedo};
    if (stage_ && (imported_ || staged_ == wanted))
        return *stage_;
    live_ = {};
    whole_ = {};
    terms_.reset();
    stage_ = std::make_unique<PathStage>(imported_ ? PathSet{*imported_, {}, OpaqueModel::metallicRoughness}
                                                   : makeSet(subject.as<Subject>(), albedo));
    staged_ = wanted;
    return *stage_;
}

void PathTracingLab::markIdleKnobs() {
    const bool isTree = method.as<Method>() == Method::tree;
    subject.setIdle(imported_ ? "the imported model is shown" : "");
    albedo.setIdle(!imported_ && subject.as<Subject>() == Subject::furnace ? "" : "only the furnace has it");
    branches.setIdle(isTree ? "" : "only trees branch");
    roulette.setIdle(isTree ? "trees end by their depth" : "");
    cutoff.setIdle(isTree ? "trees end by their depth" : "");
    pickX.setIdle(terms ? "" : "no terms are shown");
    pickY.setIdle(terms ? "" : "no terms are shown");
}

Camera PathTracingLab::defaultCamera() const {
    if (imported_)
        return imported_->cameras.empty() ? frameBounds(imported_->bounds(), composedAspect)
                                          : imported_->cameras.front();
    return cameraOf(makeSet(subject.as<Subject>(), albedo));
}

Bounds PathTracingLab::sceneBounds() const {
    if (imported_)
        return imported_->bounds();
    return subject.as<Subject>() == Subject::balls ? Bounds{{-6, 0, -6}, {6, 2, 6}}
                                                   : Bounds{{-2, 0, -2}, {2, 3, 2}};
}

PathLimits PathTracingLab::limits() const {
    return {bounces, roulette, cutoff};
}

RenderSettings PathTracingLab::settings(const Frame& frame) const {
    const Method way = method.as<Method>();
    return {.width = frame.width,
            .height = frame.height,
            .camera = fittedToAspect(frame.camera,
                                     static_cast<float>(frame.width) / static_cast<float>(frame.height)),
            .method = way == Method::tree ? PathMethod::nee : static_cast<PathMethod>(method.index()),
            .limits = way == Method::tree ? PathLimits{treeDepth(bounces, branches), 0, 0} : limits(),
            .numbers = numbers.as<PathSampler::Kind>(),
            .seed = frame.seed,
            .branches = way == Method::tree ? branches : 0,
            .clamp = clamp};
}

ProgressiveRender& PathTracingLab::renderOf(const Frame& frame) {
    const PathStage& scene = stage();
    const RenderSettings asked = settings(frame);
    Rendered& slot = frame.live ? live_ : whole_;
    if (!slot.render || slot.settings != asked.identity() || slot.render->samples() > samples) {
        slot = {std::make_unique<ProgressiveRender>(scene.paths, asked), asked.identity()};
        begun_ = Clock::now();
    }
    return *slot.render;
}

bool PathTracingLab::isConverging() const {
    return (live_.render && live_.render->samples() < samples) ||
           (terms && terms_ && terms_->samples() < termSamples);
}

void PathTracingLab::traceFrame(ProgressiveRender& render, const Frame& frame, Clock::time_point until) {
    if (frame.live) {
        while (render.samples() < samples && render.addSlice(until) && Clock::now() < until) {
        }
    } else if (render.samples() < samples) {
        renderPaths(render, {.samples = frame.unseen ? 1 : samples,
                             .checkpoint = frame.unseen ? std::string() : checkpoint.value(),
                             .stop = &interruptFlag()});
    }
    counters_ = {{"rays", render.counts().rays()}, {"shadow rays", render.counts().shadowRays}};
}

Lab::ReferenceJob PathTracingLab::reference(const Frame& frame) const {
    if (imported_ || subject.as<Subject>() != Subject::furnace || terms)
        return {};
    return [value = static_cast<float>(furnaceRadiance(static_cast<double>(albedo))) * exposure,
            frame](const std::atomic<bool>&) {
        Image image(frame.width, frame.height, 4, Encoding::linear);
        std::fill(image.data.begin(), image.data.end(), value);
        for (std::size_t i = 0; i < image.pixelCount(); ++i)
            image.data[4 * i + 3] = 1;
        return image;
    };
}

graph::Resource PathTracingLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    graph.addPass({.name = "show",
                   .reads = {},
                   .writes = {picture},
                   .execute = [this, frame](graph::PassContext& context) { draw(context, frame); }});
    return picture;
}

void PathTracingLab::draw(graph::PassContext& context, const Frame& frame) {
    const Clock::time_point start = Clock::now();
    ProgressiveRender& render = renderOf(frame);
    const auto slice = std::clamp<Clock::duration>((start - begun_) / restShare, leastSlice, longestSlice);
    labels_.clear();
    if (terms)
        addTerms(frame, start + slice / termShare);
    traceFrame(render, frame, start + slice);
    constexpr int unit = 1;
    if (!texture_ || texture_->width() != frame.width || texture_->height() != frame.height)
        texture_.emplace("light", GL_RGBA32F, frame.width, frame.height);
    gl::upload(*texture_, 0, 0, render.picture());
    const gl::Program& program = context.programs().get({.label = "show light",
                                                         .vertex = "passes/fullscreen.vert",
                                                         .fragment = "labs/27_path_tracing/show.frag"});
    program.use();
    program.set("light", unit);
    program.set("exposure", static_cast<float>(exposure));
    texture_->bind(unit);
    context.drawFullscreen();
    labels_.draw(context, {frame.width, frame.height});
}

void PathTracingLab::addTerms(const Frame& frame, Clock::time_point until) {
    const PathStage& scene = stage();
    const RenderSettings asked = settings(frame);
    const std::pair<float, float> pick{pickX, pickY};
    const glm::vec2 at(pickX * static_cast<float>(frame.width), pickY * static_cast<float>(frame.height));
    if (!terms_ || termsOf_ != asked.identity() || picked_ != pick) {
        terms_.emplace(scene.paths, cameraRay(asked.camera, frame.width, frame.height, at), frame.seed,
                       asked.limits);
        termsOf_ = asked.identity();
        picked_ = pick;
    }
    const int wanted = frame.unseen ? termsALook : termSamples;
    do
        terms_->add(std::clamp(wanted - terms_->samples(), 0, termsALook));
    while (terms_->samples() < wanted && (!frame.live || Clock::now() < until));
    drawTerms(at, static_cast<float>(frame.height), terms_->terms());
}

void PathTracingLab::drawTerms(glm::vec2 at, float height, const EquationTerms& found) {
    const float size = std::clamp(height / 32, 8.0f, 22.0f);
    // A cross at the point.
    const glm::vec4 mark(1, 0.75f, 0.1f, 1);
    const float arm = 0.6f * size;
    const float thin = std::max(1.0f, size / 9);
    labels_.plate(at - glm::vec2(arm, thin / 2), {2 * arm, thin}, mark);
    labels_.plate(at - glm::vec2(thin / 2, arm), {thin, 2 * arm}, mark);

    struct Row {
        const char* words;
        glm::vec3 light;
        glm::vec3 error;
    };
    const std::array rows{
        Row{"Le  emitted", found.emitted, glm::vec3(0)},
        Row{"∫ from lights", found.direct, found.directError},
        Row{"∫ from surfaces", found.indirect, found.indirectError},
        Row{"Lo  their sum", found.sum(),
            glm::sqrt(found.directError * found.directError + found.indirectError * found.indirectError)}};
    const float whole = std::max(luminance(found.sum()), 1e-30f);
    const float left = 0.8f * size;
    float top = 0.8f * size;
    const float barWidth = 8 * size;
    labels_.plate({0.3f * size, 0.3f * size}, {27.5f * size, 6.2f * size}, {0.01f, 0.012f, 0.02f, 0.72f});
    for (const Row& row : rows) {
        const float value = luminance(row.light);
        labels_.text(row.words, {left, top}, {.sizePixels = size, .color = {0.92f, 0.93f, 0.95f, 1}});
        const float bright = std::max({row.light.r, row.light.g, row.light.b, 1e-30f});
        const glm::vec3 hue = value > 0 ? row.light / bright : glm::vec3(0);
        labels_.plate({left + 8 * size, top + 0.15f * size},
                      {std::max(barWidth * value / whole, thin), 0.8f * size},
                      glm::vec4(0.12f + 0.88f * hue, 1));
        labels_.text(fmt::format("{:.4f} ± {:.4f}", value, luminance(row.error)), {left + 16.5f * size, top},
                     {.sizePixels = size, .color = {0.92f, 0.93f, 0.95f, 1}});
        top += 1.35f * size;
    }
}

Exercise PathTracingLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the terms of the equation", {{"terms", "off"}}},
                        {"light that was scattered before", {{"bounces", "1"}}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::PathTracingLab)

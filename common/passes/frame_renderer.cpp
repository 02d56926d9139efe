#include "passes/frame_renderer.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "passes/fullscreen.h"
#include "passes/targets.h"

namespace quincunx {
namespace {

void addCopyPass(graph::FrameGraph& graph, graph::Resource from, graph::Resource to) {
    graph.addPass(
        {.name = "present", .reads = {from}, .writes = {to}, .execute = [from](graph::PassContext& context) {
             drawPicture(context, from);
         }});
}

/// The scene with its shadows and mirrors, into the bound target.
void shade(graph::PassContext& context, const FrameView& view, const Visibility& visibility,
           FrameDevice& device, const std::vector<FrameBuilder::ShadowMapUse>& maps, bool mirrors,
           bool sorts) {
    MaterialParams params;
    params.ordersTriangles = sorts;
    if (!maps.empty()) {
        params.fragment = "passes/frame_material.frag";
        std::vector<FrameShadows::Map> bound;
        for (const FrameBuilder::ShadowMapUse& use : maps) {
            FrameShadows::addTo(params, use.atlas->kind);
            bound.push_back({*use.atlas, context.texture(use.map)});
        }
        device.shadows().bind(context, visibility, bound, view.settings.shadowRadius);
    }
    if (mirrors) {
        params.environmentFragment = "passes/frame_mirror.frag";
        gl::ProgramFiles files;
        EnvironmentMap::addBindings(files);
        params.blocks.insert(params.blocks.end(), files.blocks.begin(), files.blocks.end());
        params.samplers.insert(params.samplers.end(), files.samplers.begin(), files.samplers.end());
        device.environment(context, view, visibility.surroundings).bind();
    }
    std::vector<Light> lights;
    for (const LightReach& reach : visibility.lights) {
        lights.push_back(view.scene.lights[reach.light]);
        lights.back().position -= visibility.anchorWorld;
    }
    std::vector<std::uint32_t> blended = visibility.blended;
    if (!sorts)
        std::sort(blended.begin(), blended.end());
    glClear(GL_DEPTH_BUFFER_BIT);
    device.materials(view.scene)
        .draw(
            context, view.scene,
            {.frame = makeFrameBlock(view.scene, lights, visibility.clipFromAnchored, visibility.eyeAnchored),
             .anchorWorld = visibility.anchorWorld,
             .visible = visibility.solid,
             .blended = blended},
            params);
    if (!maps.empty())
        device.shadows().unbind();
}

}  // namespace

/// What the passes of one frame refer to while they run.
struct FrameRenderer::Planned {
    FrameView view;
    Visibility visibility;
};

const PlannedEffect& FramePlan::find(std::string_view effect) const {
    return effects.at(findEffect(effect));
}

FrameRenderer::FrameRenderer() : device_(std::make_shared<FrameDevice>()) {}
FrameRenderer::~FrameRenderer() = default;
FrameRenderer::FrameRenderer(FrameRenderer&&) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&&) noexcept = default;

void FrameRenderer::reset() {
    bounds_.reset();
    planned_.reset();
    plan_ = {};
    inWords_ = true;
    device_ = std::make_shared<FrameDevice>();
}

const Visibility& FrameRenderer::visibility() const {
    QX_CHECK(planned_ != nullptr);
    return planned_->visibility;
}

void FrameRenderer::decide(const FrameView& view) {
    if (view.width < 1 || view.height < 1)
        throw InputError(fmt::format("{}×{} pixels", view.width, view.height), "picture",
                         "give it at least 1×1");
    if (!bounds_)
        bounds_.emplace(view.scene);
    planned_ = std::make_shared<Planned>(Planned{view, bounds_->look(view)});
    const Visibility& visibility = planned_->visibility;
    const std::span<const Effect> rows = effects();
    plan_.effects.resize(rows.size());
    inWords_ = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        PlannedEffect& effect = plan_.effects[i];
        effect.name = rows[i].name;
        effect.decision.calledFor = rows[i].calledFor(visibility, view, nullptr);
        effect.added = (effect.decision.calledFor || view.settings.forced[i]) && !view.settings.leftOut[i];
        effect.passes.clear();
    }
    plan_.shadowTriangles = 0;
    plan_.instances = visibility.instances;
    plan_.drawn = visibility.visible();
    plan_.lights = visibility.lights.size();
    plan_.lightsOfScene = view.scene.lights.size();
    const auto trianglesOf = [&](const std::vector<std::uint32_t>& instances) {
        std::size_t sum = 0;
        for (const std::uint32_t i : instances)
            sum += view.scene.meshes[view.scene.instances[i].mesh].triangleCount();
        return sum;
    };
    plan_.triangles = trianglesOf(visibility.solid) + trianglesOf(visibility.blended);
}

const FramePlan& FrameRenderer::plan(const FrameView& view) {
    decide(view);
    return plan();
}

const FramePlan& FrameRenderer::plan() const {
    if (!inWords_) {
        const std::span<const Effect> rows = effects();
        for (std::size_t i = 0; i < rows.size(); ++i)
            rows[i].calledFor(planned_->visibility, planned_->view, &plan_.effects[i].decision.reason);
        inWords_ = true;
    }
    return plan_;
}

graph::Resource FrameRenderer::build(graph::FrameGraph& graph, const FrameView& view) {
    decide(view);
    const std::shared_ptr<Planned> planned = planned_;
    const Visibility& visibility = planned->visibility;
    const graph::Resource target =
        graph.addResource({"picture", view.pictureFormat, view.width, view.height});
    FrameBuilder frame{.graph = graph, .view = planned->view, .visibility = visibility, .device = *device_};
    frame.target = target;

    const std::span<const Effect> rows = effects();
    const auto addStage = [&](Effect::Stage stage) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            PlannedEffect& effect = plan_.effects[i];
            if (rows[i].stage != stage || !effect.added)
                continue;
            frame.isLast = std::none_of(plan_.effects.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                        plan_.effects.end(), [](const auto& later) { return later.added; });
            const std::size_t before = graph.passCount();
            rows[i].addTo(frame);
            for (std::size_t p = before; p < graph.passCount(); ++p)
                effect.passes.push_back(graph.pass({p}).name);
        }
    };
    addStage(Effect::Stage::before);
    addStage(Effect::Stage::shading);

    // What blends is blended in float, and rounded once; so is what later passes read.
    const bool direct =
        !frame.sortsBlended && std::none_of(plan_.effects.begin(), plan_.effects.end(), [&](const auto& e) {
            return e.added &&
                   rows[static_cast<std::size_t>(&e - plan_.effects.data())].stage == Effect::Stage::after;
        });
    frame.picture = direct ? target : frame.addPicture("shaded");
    frame.depth = graph.addResource({"depth", graph::Format::depth32f, view.width, view.height});
    std::vector<graph::Resource> reads;
    for (const FrameBuilder::ShadowMapUse& use : frame.shadowMaps) {
        reads.push_back(use.map);
        for (const ShadowAtlas::Tile& tile : use.atlas->tiles)
            for (const std::uint32_t i : tile.casters)
                plan_.shadowTriangles += view.scene.meshes[view.scene.instances[i].mesh].triangleCount();
    }
    if (frame.environment)
        reads.push_back(*frame.environment);
    graph.addPass({.name = "shade",
                   .reads = reads,
                   .writes = {frame.picture, frame.depth},
                   .execute = [planned, device = device_, maps = frame.shadowMaps,
                               mirrors = frame.environment.has_value(),
                               sorts = frame.sortsBlended](graph::PassContext& context) {
                       shade(context, planned->view, planned->visibility, *device, maps, mirrors, sorts);
                   }});
    addStage(Effect::Stage::after);
    if (!(frame.picture == target))
        addCopyPass(graph, frame.picture, target);
    return target;
}

}  // namespace quincunx

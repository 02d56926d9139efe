#include "labs/02_car_camera/town_pass.h"

#include <algorithm>
#include <cmath>

#include "scene/town.h"

namespace quincunx {
namespace {

constexpr float shadowHeight = 0.06f;  // between street and pavement, metres
constexpr float highestGround = 0.4f;
constexpr int shadowUnit = 2;  // not those of materials and of what is averaged

gl::ProgramFiles groundProgram() {
    return {.label = "ground",
            .vertex = "passes/phong.vert",
            .fragment = "labs/02_car_camera/ground.frag",
            .defines = {{"BLINN_PHONG", ""}},
            .blocks = SceneBuffers::bindings()};
}

gl::ProgramFiles shadowProgram() {
    return {.label = "ground shadow",
            .vertex = "labs/02_car_camera/ground_shadow.vert",
            .fragment = "labs/02_car_camera/ground_shadow.frag",
            .blocks = SceneBuffers::bindings()};
}

std::vector<ObjectBlock> blocksOf(const Scene& scene) {
    std::vector<ObjectBlock> blocks;
    blocks.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances)
        blocks.push_back(makeObjectBlock(scene.materials[instance.material], instance.worldFromModel));
    return blocks;
}

ForwardParams forwardParams(const Scene& scene, bool background) {
    ForwardParams params{.background = background};
    for (const Instance& instance : scene.instances) {
        params.doubleSided.push_back(scene.materials[instance.material].doubleSided);
        params.mirrored.push_back(glm::determinant(glm::mat3(instance.worldFromModel)) < 0);
    }
    return params;
}

}  // namespace

TownPass::TownPass(Scene scene, const std::vector<std::size_t>& ground)
    : ground_(scene), objects_(std::move(scene)) {
    const std::vector<Instance> all = objects_.instances;
    ground_.instances.clear();
    ground_.meshes.clear();
    objects_.instances.clear();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!std::binary_search(ground.begin(), ground.end(), i)) {
            objects_.instances.push_back(all[i]);
            // What stands on the hills is not on the plane of the shadows, and clouds are too far above.
            const glm::vec3 place(all[i].worldFromModel[3]);
            castsShadow_.push_back(std::hypot(place.x, place.z) < townRadius + 60 && std::abs(place.y) < 1);
            continue;
        }
        Instance flat = all[i];
        ground_.meshes.push_back(std::move(objects_.meshes[flat.mesh]));
        flat.mesh = ground_.meshes.size() - 1;
        ground_.instances.push_back(flat);
    }
}

void TownPass::update(const ForwardView& view) {
    if (!groundBuffers_) {
        groundBuffers_.emplace(ground_, SceneBuffers::Layout::shared);
        objectBuffers_.emplace(objects_, SceneBuffers::Layout::shared);
    }
    groundBuffers_->update(makeFrameBlock(ground_, ground_.lights, view.clipFromWorld, view.eyeWorld),
                           blocksOf(ground_));
    objectBuffers_->update(makeFrameBlock(objects_, objects_.lights, view.clipFromWorld, view.eyeWorld),
                           blocksOf(objects_));
}

void TownPass::addPasses(graph::FrameGraph& graph, const PictureTargets& targets, const Params& params) {
    const graph::ResourceDescription size = graph.resource(targets.color);
    std::optional<graph::Resource> shadow;
    if (params.shadows) {
        shadow = graph.addResource({"ground shadow", graph::Format::rgba8, size.width, size.height});
        graph.addPass({.name = "ground shadow",
                       .reads = {},
                       .writes = {*shadow},
                       .execute = [this, params](graph::PassContext& context) {
                           update(params.view);
                           glClearColor(0, 0, 0, 0);
                           glClear(GL_COLOR_BUFFER_BIT);
                           objectBuffers_->bindFrame();
                           objectBuffers_->bindVertices();
                           const gl::Program& program = context.programs().get(shadowProgram());
                           program.use();
                           program.set("shadowHeight", shadowHeight);
                           for (std::size_t i = 0; i < castsShadow_.size(); ++i)
                               if (castsShadow_[i])
                                   objectBuffers_->draw(i);
                       }});
    }
    graph.addPass({.name = "town",
                   .reads = shadow ? std::vector{*shadow} : std::vector<graph::Resource>{},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, params, shadow](graph::PassContext& context) {
                       // With shadows the pass before has done so.
                       if (!shadow)
                           update(params.view);
                       glClear(GL_DEPTH_BUFFER_BIT);
                       ForwardParams forward = forwardParams(ground_, params.view.background);
                       if (shadow) {
                           forward.program = groundProgram();
                           const gl::Program& program = context.programs().get(groundProgram());
                           program.use();
                           program.set("groundShadow", shadowUnit);
                           program.set("highestGround", highestGround);
                           context.texture(*shadow).bind(shadowUnit);
                       }
                       drawForward(context, *groundBuffers_, forward);
                       drawForward(context, *objectBuffers_, forwardParams(objects_, false));
                       if (params.over)
                           params.over(context);
                   }});
}

}  // namespace quincunx

#include "passes/frame_scene.h"

#include <algorithm>

#include "base/check.h"
#include "math/exact.h"
#include "passes/forward.h"

namespace quincunx {

FrameScene::FrameScene(const Scene& scene) : buffers_(scene, SceneBuffers::Layout::shared) {
    objects_.resize(scene.instances.size());
    kinds_.resize(scene.instances.size());
}

void FrameScene::update(const FrameView& view, const Visibility& visibility) {
    const Scene& scene = view.scene;
    QX_CHECK_EQ(scene.instances.size(), objects_.size());
    const auto place = [&](const std::vector<std::uint32_t>& instances) {
        for (const std::uint32_t i : instances) {
            const Instance& instance = scene.instances[i];
            const Material& material = scene.materials[instance.material];
            const glm::mat4 anchored = relativeTo(visibility.anchorWorld, instance.worldFromModel);
            objects_[i] = makeObjectBlock(material, anchored);
            kinds_[i] = {material.doubleSided, material.alphaMode == Material::AlphaMode::mask,
                         determinant(glm::mat3(anchored)) < 0};
        }
    };
    place(visibility.solid);
    place(visibility.blended);
    std::vector<Light> lights;
    for (const LightReach& reach : visibility.lights) {
        place(reach.casters);
        lights.push_back(scene.lights[reach.light]);
        lights.back().position -= visibility.anchorWorld;
    }
    buffers_.update(makeFrameBlock(scene, lights, visibility.clipFromAnchored, visibility.eyeAnchored),
                    objects_);
}

void FrameScene::drawBackground(graph::PassContext& context) {
    buffers_.bindFrame();
    context.programs()
        .get({.label = "background",
              .vertex = "passes/fullscreen.vert",
              .fragment = "passes/background.frag",
              .blocks = SceneBuffers::bindings()})
        .use();
    context.drawFullscreen();
}

void FrameScene::setFrontFace(bool mirrored) {
    if (mirrored != clockwise_)
        glFrontFace(mirrored ? GL_CW : GL_CCW);
    clockwise_ = mirrored;
}

void FrameScene::setCulling(bool culls) {
    if (culls != culls_)
        culls ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
    culls_ = culls;
}

void FrameScene::drawSolid(graph::PassContext& context, std::span<const std::uint32_t> instances,
                           const gl::ProgramFiles& program) {
    buffers_.bindVertices();
    glEnable(GL_DEPTH_TEST);
    for (const bool doubleSided : {false, true}) {
        const auto belongs = [&](std::uint32_t i) { return kinds_[i].doubleSided == doubleSided; };
        if (std::none_of(instances.begin(), instances.end(), belongs))
            continue;
        context.programs().get(doubleSided ? doubleSidedVariant(program) : program).use();
        setCulling(!doubleSided);
        for (const std::uint32_t i : instances) {
            if (!belongs(i))
                continue;
            setFrontFace(kinds_[i].mirrored);
            buffers_.draw(i);
        }
    }
    setCulling(false);
    setFrontFace(false);
    glDisable(GL_DEPTH_TEST);
}

void FrameScene::drawBlended(graph::PassContext& context, std::span<const std::uint32_t> instances,
                             const gl::ProgramFiles& program) {
    if (instances.empty())
        return;
    gl::ProgramFiles blended = program;
    blended.defines.emplace_back("BLENDED", "");
    const gl::ProgramFiles doubleSided = doubleSidedVariant(blended);
    buffers_.bindVertices();
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    setCulling(true);
    for (const std::uint32_t i : instances) {
        setFrontFace(kinds_[i].mirrored);
        context.programs().get(kinds_[i].doubleSided ? doubleSided : blended).use();
        if (kinds_[i].doubleSided) {
            glCullFace(GL_FRONT);
            buffers_.draw(i);
            glCullFace(GL_BACK);
        }
        buffers_.draw(i);
    }
    setCulling(false);
    setFrontFace(false);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
}

void FrameScene::drawDepth(graph::PassContext& context, std::span<const std::uint32_t> instances,
                           const glm::mat4& clipFromAnchored) {
    gl::ProgramFiles files{.label = "shadow map",
                           .vertex = "passes/shadow_map.vert",
                           .fragment = "passes/shadow_map.frag",
                           .blocks = SceneBuffers::bindings()};
    buffers_.bindVertices();
    glEnable(GL_DEPTH_TEST);
    for (const bool cutOut : {false, true}) {
        const auto belongs = [&](std::uint32_t i) { return kinds_[i].cutOut == cutOut; };
        if (std::none_of(instances.begin(), instances.end(), belongs))
            continue;
        if (cutOut)
            files.defines.emplace_back("CUT_OUT", "");
        const gl::Program& program = context.programs().get(files);
        program.set("shadowClipFromWorld", clipFromAnchored);
        program.use();
        for (const std::uint32_t i : instances) {
            if (!belongs(i))
                continue;
            setCulling(!cutOut && !kinds_[i].doubleSided);
            setFrontFace(kinds_[i].mirrored);
            buffers_.draw(i);
        }
    }
    setCulling(false);
    setFrontFace(false);
    glDisable(GL_DEPTH_TEST);
}

FrameScene& FrameDevice::scene(const FrameView& view, const Visibility& visibility) {
    if (!scene_)
        scene_.emplace(view.scene);
    if (updatedFor_ != &visibility) {
        scene_->update(view, visibility);
        updatedFor_ = &visibility;
    }
    return *scene_;
}

}  // namespace quincunx

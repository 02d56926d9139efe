#include "passes/forward.h"

#include <algorithm>

#include "base/check.h"
#include "math/exact.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {
namespace {

gl::ProgramFiles variantOf(gl::ProgramFiles files, bool doubleSided) {
    if (files.blocks.empty())
        files.blocks = SceneBuffers::bindings();
    if (doubleSided)
        files.defines.emplace_back("DOUBLE_SIDED", "");
    return files;
}

void drawBackground(graph::PassContext& context) {
    context.programs()
        .get({.label = "background",
              .vertex = "passes/fullscreen.vert",
              .fragment = "passes/background.frag",
              .blocks = SceneBuffers::bindings()})
        .use();
    context.drawFullscreen();
}

}  // namespace

gl::ProgramFiles phongProgram(bool blinnPhong) {
    gl::ProgramFiles files{.label = "phong", .vertex = "passes/phong.vert", .fragment = "passes/phong.frag"};
    if (blinnPhong)
        files.defines.emplace_back("BLINN_PHONG", "");
    return files;
}

void drawForward(graph::PassContext& context, const SceneBuffers& buffers, const ForwardParams& params) {
    QX_CHECK_EQ(params.doubleSided.size(), buffers.instanceCount());
    QX_CHECK_EQ(params.mirrored.size(), buffers.instanceCount());
    buffers.bindFrame();
    if (params.background)
        drawBackground(context);

    buffers.bindVertices();
    glEnable(GL_DEPTH_TEST);
    bool clockwise = false;
    for (const bool doubleSided : {false, true}) {
        if (std::find(params.doubleSided.begin(), params.doubleSided.end(), doubleSided) ==
            params.doubleSided.end())
            continue;
        context.programs().get(variantOf(params.program, doubleSided)).use();
        if (!doubleSided)
            glEnable(GL_CULL_FACE);
        for (std::size_t i = 0; i < buffers.instanceCount(); ++i) {
            if (params.doubleSided[i] != doubleSided)
                continue;
            if (params.mirrored[i] != clockwise) {
                clockwise = params.mirrored[i];
                glFrontFace(clockwise ? GL_CW : GL_CCW);
            }
            buffers.draw(i);
        }
        if (!doubleSided)
            glDisable(GL_CULL_FACE);
    }
    if (clockwise)
        glFrontFace(GL_CCW);
    glDisable(GL_DEPTH_TEST);
}

ForwardView forwardView(const Camera& camera, float aspect) {
    return {perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance) *
                cameraFromWorld(camera.worldFromCamera),
            glm::vec3(camera.worldFromCamera[3])};
}

ForwardParams ForwardScene::update(const glm::mat4& clipFromWorld, glm::vec3 eyeWorld) {
    if (!buffers_)
        buffers_.emplace(scene_, SceneBuffers::Layout::shared);
    ForwardParams params;
    std::vector<ObjectBlock> objects;
    for (const Instance& instance : scene_.instances) {
        const Material& material = scene_.materials[instance.material];
        objects.push_back(makeObjectBlock(material, instance.worldFromModel));
        params.doubleSided.push_back(material.doubleSided);
        params.mirrored.push_back(determinant(glm::mat3(instance.worldFromModel)) < 0);
    }
    buffers_->update(makeFrameBlock(scene_, scene_.lights, clipFromWorld, eyeWorld), objects);
    return params;
}

void ForwardScene::draw(graph::PassContext& context, const ForwardView& view,
                        const gl::ProgramFiles& program) {
    ForwardParams params = update(view.clipFromWorld, view.eyeWorld);
    params.program = program;
    params.background = view.background;
    drawForward(context, *buffers_, params);
}

void ForwardScene::bindFrame(const ForwardView& view) {
    update(view.clipFromWorld, view.eyeWorld);
    buffers_->bindFrame();
}

void ForwardScene::drawDepth(graph::PassContext& context, const glm::mat4& clipFromWorld, bool backFaces) {
    const ForwardParams params = update(clipFromWorld, glm::vec3(0));
    buffers_->bindVertices();
    glEnable(GL_DEPTH_TEST);
    for (const bool cutOut : {false, true}) {
        const gl::Program* program = nullptr;
        for (std::size_t i = 0; i < buffers_->instanceCount(); ++i) {
            const Material& material = scene_.materials[scene_.instances[i].material];
            if ((material.alphaMode == Material::AlphaMode::mask) != cutOut)
                continue;
            if (program == nullptr) {
                gl::ProgramFiles files{.label = "shadow map",
                                       .vertex = "passes/shadow_map.vert",
                                       .fragment = "passes/shadow_map.frag",
                                       .blocks = SceneBuffers::bindings()};
                if (cutOut)
                    files.defines.emplace_back("CUT_OUT", "");
                program = &context.programs().get(files);
                program->use();
                program->set("shadowClipFromWorld", clipFromWorld);
            }
            if (!cutOut && !params.doubleSided[i]) {
                glEnable(GL_CULL_FACE);
                glCullFace(backFaces ? GL_FRONT : GL_BACK);
                glFrontFace(params.mirrored[i] ? GL_CW : GL_CCW);
            } else {
                glDisable(GL_CULL_FACE);
            }
            buffers_->draw(i);
        }
    }
    glDisable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glDisable(GL_DEPTH_TEST);
}

}  // namespace quincunx

#include "passes/forward.h"

#include <algorithm>

#include "base/check.h"
#include "math/exact.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/fullscreen.h"

namespace quincunx {

void drawBackground(graph::PassContext& context) {
    gl::ProgramFiles files = fullscreenProgram("background");
    files.blocks = SceneBuffers::bindings();
    context.programs().get(files).use();
    context.drawFullscreen();
}

gl::ProgramFiles phongProgram(bool blinnPhong) {
    gl::ProgramFiles files{.label = "phong", .vertex = "passes/phong.vert", .fragment = "passes/phong.frag"};
    if (blinnPhong)
        files.defines.emplace_back("BLINN_PHONG", "");
    return files;
}

gl::ProgramFiles doubleSidedVariant(gl::ProgramFiles program) {
    program.defines.emplace_back("DOUBLE_SIDED", "");
    return program;
}

void drawForward(graph::PassContext& context, const SceneBuffers& buffers, const ForwardParams& params) {
    QX_CHECK_EQ(params.doubleSided.size(), buffers.instanceCount());
    QX_CHECK_EQ(params.mirrored.size(), buffers.instanceCount());
    buffers.bindFrame();
    if (params.background)
        drawBackground(context);

    buffers.bindVertices();
    glEnable(GL_DEPTH_TEST);
    gl::ProgramFiles program = params.program;
    if (program.blocks.empty())
        program.blocks = SceneBuffers::bindings();
    bool clockwise = false;
    for (const bool doubleSided : {false, true}) {
        if (std::find(params.doubleSided.begin(), params.doubleSided.end(), doubleSided) ==
            params.doubleSided.end())
            continue;
        context.programs().get(doubleSided ? doubleSidedVariant(program) : program).use();
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

ForwardScene::Placed ForwardScene::place() {
    if (!buffers_)
        buffers_.emplace(scene_, SceneBuffers::Layout::shared);
    Placed placed;
    for (const Instance& instance : scene_.instances) {
        const Material& material = scene_.materials[instance.material];
        placed.objects.push_back(makeObjectBlock(material, instance.worldFromModel));
        placed.params.doubleSided.push_back(material.doubleSided);
        placed.params.mirrored.push_back(determinant(glm::mat3(instance.worldFromModel)) < 0);
    }
    return placed;
}

void ForwardScene::draw(graph::PassContext& context, const ForwardView& view,
                        const gl::ProgramFiles& program) {
    Placed placed = place();
    buffers_->update(makeFrameBlock(scene_, scene_.lights, view.clipFromWorld, view.eyeWorld),
                     placed.objects);
    placed.params.program = program;
    placed.params.background = view.background;
    drawForward(context, *buffers_, placed.params);
}

void ForwardScene::bindFrame(const ForwardView& view) {
    const Placed placed = place();
    buffers_->update(makeFrameBlock(scene_, scene_.lights, view.clipFromWorld, view.eyeWorld),
                     placed.objects);
    buffers_->bindFrame();
}

void ForwardScene::drawDepth(graph::PassContext& context, const glm::mat4& clipFromWorld, bool backFaces) {
    const Placed placed = place();
    buffers_->updateObjects(placed.objects);
    const auto isCutOut = [this](std::size_t i) {
        return scene_.materials[scene_.instances[i].material].alphaMode == Material::AlphaMode::mask;
    };
    bool anyCutOut = false;
    for (std::size_t i = 0; i < buffers_->instanceCount(); ++i)
        anyCutOut = anyCutOut || isCutOut(i);
    gl::ProgramFiles files{.label = "shadow map",
                           .vertex = "passes/shadow_map.vert",
                           .fragment = "passes/shadow_map.frag",
                           .blocks = SceneBuffers::bindings()};
    const gl::Program* const whole = &context.programs().get(files);
    files.defines.emplace_back("CUT_OUT", "");
    const gl::Program* const cutOut = anyCutOut ? &context.programs().get(files) : nullptr;

    buffers_->bindVertices();
    glEnable(GL_DEPTH_TEST);
    if (backFaces)
        glCullFace(GL_FRONT);
    bool culls = false;
    bool clockwise = false;
    for (const gl::Program* program : {whole, cutOut}) {
        if (program == nullptr)
            continue;
        program->set("shadowClipFromWorld", clipFromWorld);
        program->use();
        for (std::size_t i = 0; i < buffers_->instanceCount(); ++i) {
            if (isCutOut(i) != (program == cutOut))
                continue;
            const bool cull = !isCutOut(i) && !placed.params.doubleSided[i];
            if (cull != culls) {
                culls = cull;
                cull ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
            }
            if (placed.params.mirrored[i] != clockwise) {
                clockwise = placed.params.mirrored[i];
                glFrontFace(clockwise ? GL_CW : GL_CCW);
            }
            buffers_->draw(i);
        }
    }
    if (culls)
        glDisable(GL_CULL_FACE);
    if (clockwise)
        glFrontFace(GL_CCW);
    if (backFaces)
        glCullFace(GL_BACK);
    glDisable(GL_DEPTH_TEST);
}

}  // namespace quincunx

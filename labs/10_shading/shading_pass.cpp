#include "labs/10_shading/shading_pass.h"

#include <algorithm>
#include <array>

#include "base/check.h"

namespace quincunx {
namespace {

gl::ProgramFiles shadingProgram(ShadingModel shading, bool blinnPhong, bool doubleSided) {
    static constexpr std::array names = {"flat", "gouraud", "phong"};
    const std::string name = names[static_cast<std::size_t>(shading)];
    gl::ProgramFiles files{.label = name,
                           .vertex = "labs/10_shading/" + name + ".vert",
                           .fragment = "labs/10_shading/" + name + ".frag",
                           .blocks = SceneBuffers::bindings()};
    if (blinnPhong)
        files.defines.emplace_back("BLINN_PHONG", "");
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

SceneBuffers::Layout layoutFor(ShadingModel shading) {
    return shading == ShadingModel::flat ? SceneBuffers::Layout::faceted : SceneBuffers::Layout::shared;
}

void drawShaded(graph::PassContext& context, const SceneBuffers& buffers, const ShadingPassParams& params) {
    QX_CHECK_EQ(params.doubleSided.size(), buffers.instanceCount());
    QX_CHECK_EQ(params.mirrored.size(), buffers.instanceCount());
    buffers.bindFrame();
    drawBackground(context);

    buffers.bindVertices();
    glEnable(GL_DEPTH_TEST);
    bool clockwise = false;
    for (const bool doubleSided : {false, true}) {
        if (std::find(params.doubleSided.begin(), params.doubleSided.end(), doubleSided) ==
            params.doubleSided.end())
            continue;
        context.programs().get(shadingProgram(params.shading, params.blinnPhong, doubleSided)).use();
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

}  // namespace quincunx

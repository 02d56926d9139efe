#include "passes/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "gl/executor.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/forward.h"
#include "passes/fresh_name.h"
#include "passes/fullscreen.h"

namespace quincunx {
namespace {

constexpr int pictureUnit = 1;
constexpr int depthUnit = 2;
constexpr int motionUnit = 3;
constexpr int tilesUnit = 4;
constexpr float greatestLength = 256;
constexpr int mostTaps = 1024;

struct Passes {
    graph::Resource color;
    graph::Resource depth;
    graph::Resource motion = {};
    graph::Resource tiles = {};
    glm::vec2 sizePixels{1};
    float most = 0;
    int tile = 1;
    int taps = 1;
};

glm::dmat4 wideClipFromWorldOf(const Camera& camera, float aspect) {
    return glm::dmat4(perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance)) *
           glm::inverse(glm::dmat4(camera.worldFromCamera));
}

/// The columns that a clip-space matrix has for (x, y, 1 − depth, depth): as z/w = depth − (1 − depth) and
/// 1 = (1 − depth) + depth, points near the far plane are told apart as well as depths are.
glm::mat4 fromViewOf(const glm::dmat4& m) {
    return glm::mat4(glm::dmat4(m[0], m[1], m[3] - m[2], m[3] + m[2]));
}

void drawVelocity(graph::PassContext& context, const Passes& passes, const MotionBlurParams& params) {
    const float aspect = passes.sizePixels.x / passes.sizePixels.y;
    const glm::dmat4 openFromWorld = wideClipFromWorldOf(params.cameraOpen, aspect);
    const glm::dmat4 closeFromWorld = wideClipFromWorldOf(params.cameraClose, aspect);
    context.texture(passes.depth).bind(depthUnit);
    if (openFromWorld == closeFromWorld) {
        const GLfloat still[4] = {0, 0, 0, 0};
        glClearBufferfv(GL_COLOR, 0, still);
    } else {
        const glm::dmat4 worldFromClip = glm::inverse(wideClipFromWorldOf(params.camera, aspect));
        const gl::Program& program = context.programs().get(fullscreenProgram("velocity_camera"));
        program.use();
        program.set("depthMap", depthUnit);
        program.set("sizePixels", passes.sizePixels);
        program.set("most", passes.most);
        program.set("openFromView", fromViewOf(openFromWorld * worldFromClip));
        program.set("closeFromView", fromViewOf(closeFromWorld * worldFromClip));
        context.drawFullscreen();
    }
    if (params.instances.empty())
        return;
    const gl::Program& program = context.programs().get(
        {.label = "velocity", .vertex = "passes/velocity.vert", .fragment = "passes/velocity.frag"});
    program.use();
    program.set("depthMap", depthUnit);
    program.set("sizePixels", passes.sizePixels);
    program.set("most", passes.most);
    program.set("clipFromWorld", forwardView(params.camera, aspect).clipFromWorld);
    const SceneBuffers& buffers = params.buffers();
    buffers.bindVertices();
    for (const MovingInstance& moving : params.instances) {
        program.set("worldFromModel", moving.worldFromModel);
        program.set("openFromModel", glm::mat4(openFromWorld * glm::dmat4(moving.worldFromModelOpen)));
        program.set("closeFromModel", glm::mat4(closeFromWorld * glm::dmat4(moving.worldFromModelClose)));
        buffers.draw(moving.instance);
    }
}

void drawTiles(graph::PassContext& context, const Passes& passes) {
    const gl::Program& program = context.programs().get(fullscreenProgram("motion_blur_tiles"));
    program.use();
    program.set("motionMap", motionUnit);
    program.set("tile", passes.tile);
    context.texture(passes.motion).bind(motionUnit);
    context.drawFullscreen();
}

void drawPicture(graph::PassContext& context, const Passes& passes) {
    const gl::Program& program = context.programs().get(fullscreenProgram("motion_blur"));
    program.use();
    program.set("picture", pictureUnit);
    program.set("depthMap", depthUnit);
    program.set("motionMap", motionUnit);
    program.set("tiles", tilesUnit);
    program.set("tile", passes.tile);
    program.set("taps", passes.taps);
    context.texture(passes.color).bind(pictureUnit);
    context.texture(passes.depth).bind(depthUnit);
    context.texture(passes.motion).bind(motionUnit);
    context.texture(passes.tiles).bind(tilesUnit);
    context.drawFullscreen();
}

}  // namespace

graph::Resource addMotionBlurPasses(graph::FrameGraph& graph, graph::Resource color, graph::Resource depth,
                                    const MotionBlurParams& params) {
    QX_CHECK(params.maxLengthPixels >= 0 && params.maxLengthPixels <= greatestLength);
    QX_CHECK(params.taps >= 1 && params.taps <= mostTaps);
    QX_CHECK(params.instances.empty() || params.buffers);
    const graph::ResourceDescription like = graph.resource(color);
    const std::string name = freshName(graph, "motion blur");
    Passes passes{.color = color,
                  .depth = depth,
                  .sizePixels = glm::vec2(like.width, like.height),
                  .most = params.maxLengthPixels,
                  .taps = params.taps};
    // A way reaches half of its length and half a pixel; small tiles would be many.
    passes.tile = std::max(8, static_cast<int>(std::ceil(0.5f * params.maxLengthPixels + 0.5f)));
    passes.motion = graph.addResource({name + ", velocity", graph::Format::rg16f, like.width, like.height});
    passes.tiles = graph.addResource({name + ", tiles", graph::Format::rg16f,
                                      (like.width + passes.tile - 1) / passes.tile,
                                      (like.height + passes.tile - 1) / passes.tile});
    const graph::Resource shown = graph.addResource({name, like.format, like.width, like.height});

    graph.addPass({.name = name + ", velocity",
                   .reads = {depth},
                   .writes = {passes.motion},
                   .execute = [passes, params](graph::PassContext& context) {
                       drawVelocity(context, passes, params);
                   }});
    graph.addPass({.name = name + ", tiles",
                   .reads = {passes.motion},
                   .writes = {passes.tiles},
                   .execute = [passes](graph::PassContext& context) { drawTiles(context, passes); }});
    graph.addPass({.name = name,
                   .reads = {color, depth, passes.motion, passes.tiles},
                   .writes = {shown},
                   .execute = [passes](graph::PassContext& context) { drawPicture(context, passes); }});
    return shown;
}

std::size_t fetchesAPixel(const MotionBlurParams& params) {
    constexpr std::size_t ofVelocity = 1;
    constexpr std::size_t ofTiles = 1;
    constexpr std::size_t ofPicture = 9 + 4;  // tiles around; the pixel itself
    return ofVelocity + ofTiles + ofPicture + 2 * 3 * static_cast<std::size_t>(params.taps);
}

}  // namespace quincunx

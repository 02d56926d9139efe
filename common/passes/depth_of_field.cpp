#include "passes/depth_of_field.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "gl/executor.h"
#include "passes/fresh_name.h"
#include "passes/fullscreen.h"
#include "trace/lens_glsl.h"

namespace quincunx {
namespace {

constexpr int pictureUnit = 1;
constexpr int depthUnit = 2;
constexpr int tilesUnit = 3;
constexpr int behindUnit = 3;
constexpr int beforeUnit = 4;
constexpr float greatestRadius = 128;
constexpr int mostTaps = 1024;

struct Passes {
    graph::Resource color;
    graph::Resource depth;
    graph::Resource tiles = {};
    graph::Resource behind = {};
    graph::Resource before = {};
    CirclesOfConfusion circles;
    float most = 0;
    int tile = 1;
    int taps = 1;
};

void setLens(const gl::Program& program, const Passes& passes) {
    program.set("depthMap", depthUnit);
    program.set("atNear", passes.circles.atNear);
    program.set("atFar", passes.circles.atFar);
    program.set("most", passes.most);
}

void drawTiles(graph::PassContext& context, const Passes& passes) {
    const gl::Program& program = context.programs().get(fullscreenProgram("depth_of_field_tiles"));
    program.use();
    setLens(program, passes);
    program.set("tile", passes.tile);
    context.texture(passes.depth).bind(depthUnit);
    context.drawFullscreen();
}

void drawLayers(graph::PassContext& context, const Passes& passes) {
    const gl::Program& program = context.programs().get(fullscreenProgram("depth_of_field_gather"));
    program.use();
    setLens(program, passes);
    program.set("picture", pictureUnit);
    program.set("tiles", tilesUnit);
    program.set("tile", passes.tile);
    program.set("taps", passes.taps);
    context.texture(passes.color).bind(pictureUnit);
    context.texture(passes.depth).bind(depthUnit);
    context.texture(passes.tiles).bind(tilesUnit);
    context.drawFullscreen();
}

void drawPicture(graph::PassContext& context, const Passes& passes) {
    const gl::Program& program = context.programs().get(fullscreenProgram("depth_of_field"));
    program.use();
    setLens(program, passes);
    program.set("picture", pictureUnit);
    program.set("behindMap", behindUnit);
    program.set("beforeMap", beforeUnit);
    context.texture(passes.color).bind(pictureUnit);
    context.texture(passes.depth).bind(depthUnit);
    context.texture(passes.behind).bind(behindUnit);
    context.texture(passes.before).bind(beforeUnit);
    context.drawFullscreen();
}

}  // namespace

CirclesOfConfusion circlesOfConfusion(const Camera& camera, int heightPixels) {
    QX_CHECK_GE(camera.apertureRadius, 0.0f);
    QX_CHECK_GE(camera.focusDistance, 0.0f);
    QX_CHECK_GT(camera.nearDistance, 0.0f);
    QX_CHECK_GT(camera.farDistance, camera.nearDistance);
    if (camera.apertureRadius == 0)
        return {};
    const double scale = static_cast<double>(camera.apertureRadius) * heightPixels /
                         (2 * std::tan(static_cast<double>(camera.fovYRadians) / 2));
    const auto radiusAt = [&](double distance) {
        const double radius = scale * (1 / static_cast<double>(camera.focusDistance) - 1 / distance);
        return static_cast<float>(std::clamp(radius, -0x1p100, 0x1p100));
    };
    return {radiusAt(camera.nearDistance), radiusAt(camera.farDistance)};
}

graph::Resource addDepthOfFieldPasses(graph::FrameGraph& graph, graph::Resource color, graph::Resource depth,
                                      const DepthOfFieldParams& params) {
    QX_CHECK(params.maxRadiusPixels >= 0 && params.maxRadiusPixels <= greatestRadius);
    QX_CHECK(params.taps >= 1 && params.taps <= mostTaps);
    const graph::ResourceDescription like = graph.resource(color);
    const std::string name = freshName(graph, "depth of field");
    Passes passes{.color = color,
                  .depth = depth,
                  .circles = circlesOfConfusion(params.camera, like.height),
                  .most = params.maxRadiusPixels,
                  .taps = params.taps};
    // A disc reaches half a pixel beyond its radius; small tiles would be many.
    passes.tile = std::max(8, static_cast<int>(std::ceil(params.maxRadiusPixels + 0.5f)));
    passes.tiles = graph.addResource({name + ", tiles", graph::Format::r32f,
                                      (like.width + passes.tile - 1) / passes.tile,
                                      (like.height + passes.tile - 1) / passes.tile});
    const graph::Format light =
        like.format == graph::Format::rgba32f ? graph::Format::rgba32f : graph::Format::rgba16f;
    passes.behind = graph.addResource({name + ", behind", light, like.width, like.height});
    passes.before = graph.addResource({name + ", before", light, like.width, like.height});
    const graph::Resource shown = graph.addResource({name, like.format, like.width, like.height});

    graph.addPass({.name = name + ", tiles",
                   .reads = {depth},
                   .writes = {passes.tiles},
                   .execute = [passes](graph::PassContext& context) { drawTiles(context, passes); }});
    graph.addPass({.name = name + ", layers",
                   .reads = {color, depth, passes.tiles},
                   .writes = {passes.behind, passes.before},
                   .execute = [passes](graph::PassContext& context) { drawLayers(context, passes); }});
    graph.addPass({.name = name,
                   .reads = {color, depth, passes.behind, passes.before},
                   .writes = {shown},
                   .execute = [passes](graph::PassContext& context) { drawPicture(context, passes); }});
    return shown;
}

std::size_t fetchesAPixel(const DepthOfFieldParams& params) {
    const int taps = glsl::tapsOfDisc(params.maxRadiusPixels + 0.5f, params.taps);
    constexpr std::size_t ofTiles = 1;
    constexpr std::size_t ofLayers = 9 + 2;       // tiles around; the pixel itself
    constexpr std::size_t ofPicture = 4 + 3 * 9;  // the pixel itself; depth and layers around
    return ofTiles + ofLayers + 4 * static_cast<std::size_t>(taps) + ofPicture;
}

}  // namespace quincunx

#include "labs/18_environment_mapping/lab.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "gl/upload.h"
#include "image/filter.h"
#include "image/io.h"
#include "passes/fullscreen.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;
constexpr float overThePlane = 0.6f;  // where the plane's map is taken
constexpr int roughLevels = 6;

gl::ProgramFiles mirrorProgram(bool showVectors) {
    gl::ProgramFiles files{.label = "mirror",
                           .vertex = "passes/phong.vert",
                           .fragment = "labs/18_environment_mapping/mirror.frag"};
    EnvironmentMap::addBindings(files);
    if (showVectors)
        files.defines.emplace_back("SHOW_VECTORS", "");
    return files;
}

float aspectOf(const Frame& frame) {
    return static_cast<float>(frame.width) / static_cast<float>(frame.height);
}

}  // namespace

EnvironmentMappingLab::EnvironmentMappingLab() : hall_(makeMirrorHall()) {}

void EnvironmentMappingLab::markIdleKnobs() {
    const bool rough = roughness > 0;
    samples.setIdle(rough ? "" : "a mirror needs no samples");
    filtered.setIdle(rough ? "" : "a mirror needs no samples");
    panorama.setIdle(source.as<Source>() == Source::panorama ? "" : "for --map=panorama");
    turn.setIdle(solids ? "" : "there are no solids");
    supersample.setIdle(view.as<View>() == View::faces ? "the map is shown texel by texel" : "");
}

Bounds EnvironmentMappingLab::sceneBounds() const {
    // What the window's camera turns about: the mirrors and what is near them, not the whole hall.
    return {{-3.5f, 0, -3.2f}, {4.5f, 3, 3.5f}};
}

MirrorsSeen EnvironmentMappingLab::mirrors() const {
    return {reflector.as<Reflector>() != Reflector::plane, reflector.as<Reflector>() != Reflector::ball};
}

glm::vec3 EnvironmentMappingLab::mapPosition() const {
    return reflector.as<Reflector>() == Reflector::plane ? hall_.panelCentre() + glm::vec3(0, overThePlane, 0)
                                                         : hall_.ball.centre;
}

MirrorHall EnvironmentMappingLab::currentHall() const {
    const MirrorHall turned = turnedSolids(hall_, hall_.ball.centre, turn * degree);
    return movedAway(solids ? turned : emptied(turned), mapPosition(), distance);
}

EnvironmentParams EnvironmentMappingLab::environmentParams() const {
    EnvironmentParams params;
    params.size = resolution;
    params.levels = roughness > 0 ? roughLevels : 1;
    params.samples = samples;
    params.filteredSamples = filtered;
    params.irradiance = false;
    return params;
}

std::string EnvironmentMappingLab::key(const std::string& what) const {
    std::string text;
    for (const auto& [name, value] : knobs().values())
        if (what.find(" " + name + " ") != std::string::npos)
            text += name + "=" + value + ";";
    return text;
}

void EnvironmentMappingLab::prepareScene() {
    const std::string wanted = key(" reflector distance turn solids tessellation ");
    if (scene_ && builtScene_ == wanted)
        return;
    const MirrorHall hall = currentHall();
    scene_ = std::make_unique<ForwardScene>(quincunx::tessellate(hall, tessellation));
    mirrorScene_ = std::make_unique<ForwardScene>(
        tessellateMirrors(hall, mirrors().ball, mirrors().panel, std::min(4 * tessellation, 512)));
    builtScene_ = wanted;
}

void EnvironmentMappingLab::makeMap(graph::PassContext& context) {
    const EnvironmentParams params = environmentParams();
    const Source from = source.as<Source>();
    // A still map is taken anew when it is asked for in another form, never because something has moved.
    std::string wanted =
        fmt::format("{} {} {} {} {}", from == Source::panorama ? "panorama" : "still", params.size,
                    params.levels, params.levels > 1 ? params.samples : 0, params.filteredSamples);
    if (from == Source::panorama)
        wanted += panorama.value().empty() ? key(" reflector distance turn solids ") : panorama.value();
    else
        wanted += key(" reflector ");
    if (from != Source::rendered && map_.isMade() && wanted == builtMap_)
        return;
    builtMap_.clear();
    if (from == Source::panorama) {
        const std::string image =
            panorama.value().empty()
                ? fmt::format("{} {}", key(" reflector distance turn solids "), params.size)
                : panorama.value();
        if (panoramaImage_.data.empty() || loadedPanorama_ != image) {
            // A panorama with the map's texels along its middle row.
            const int width = std::clamp(4 * params.size, 64, 2048);
            panoramaImage_ = panorama.value().empty() ? tracePanorama(currentHall(), mapPosition(), width,
                                                                      width / 2, 2, &interruptFlag())
                                                      : readImage(panorama.value());
            loadedPanorama_ = image;
        }
        map_.fromPanorama(context, panoramaImage_, mapPosition(), params);
    } else {
        EnvironmentView around;
        around.position = mapPosition();
        around.farDistance = hall_.contents.camera.farDistance;
        map_.render(
            context, around,
            [this](graph::PassContext& passContext, const ForwardView& face) {
                scene_->draw(passContext, face);
            },
            params);
    }
    if (from != Source::rendered)
        builtMap_ = wanted;
}

void EnvironmentMappingLab::drawPicture(graph::PassContext& context, const Frame& frame) {
    EnvironmentMap::Lookup lookup;
    if (boxProjection)
        lookup.box = currentHall().walls;
    lookup.seamless = seamless;
    map_.bind(lookup);
    if (view.as<View>() == View::faces) {
        gl::ProgramFiles files = fullscreenProgram("faces", "labs/18_environment_mapping/faces.frag");
        EnvironmentMap::addBindings(files);
        const gl::Program& program = context.programs().get(files);
        program.set("targetPixels", glm::vec2(frame.width, frame.height));
        program.set("roughness", static_cast<float>(roughness));
        program.use();
        context.drawFullscreen();
        return;
    }
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    ForwardView eye = forwardView(frame.camera, aspectOf(frame));
    eye.background = false;
    scene_->draw(context, eye);
    const gl::ProgramFiles files = mirrorProgram(view.as<View>() == View::vectors);
    context.programs().get(files).set("roughness", static_cast<float>(roughness));
    mirrorScene_->draw(context, eye, files);
}

void EnvironmentMappingLab::showTraced(graph::PassContext& context, const Frame& frame,
                                       const gl::Texture2D* drawn) {
    const std::string wanted = key(" reflector distance turn solids supersample ");
    const bool same = tracedTexture_.get() != 0 && tracedFrame_.width == frame.width &&
                      tracedFrame_.height == frame.height && tracedKnobs_ == wanted &&
                      tracedFrame_.camera.worldFromCamera == frame.camera.worldFromCamera &&
                      tracedFrame_.camera.fovYRadians == frame.camera.fovYRadians;
    if (!same) {
        const Image traced =
            boxDownsample(traceMirrors(currentHall(), frame.camera, frame.width * supersample,
                                       frame.height * supersample, mirrors(), &interruptFlag()),
                          supersample);
        tracedTexture_ = gl::Texture2D("traced", GL_RGBA32F, frame.width, frame.height);
        gl::upload(tracedTexture_, 0, 0, traced);
        tracedFrame_ = frame;
        tracedKnobs_ = wanted;
    }
    constexpr int tracedUnit = 1;
    constexpr int drawnUnit = 2;
    tracedTexture_.bind(tracedUnit);
    (drawn != nullptr ? *drawn : tracedTexture_).bind(drawnUnit);
    gl::ProgramFiles files = fullscreenProgram("traced", "labs/18_environment_mapping/traced.frag");
    files.samplers = {{"traced", tracedUnit}, {"drawn", drawnUnit}};
    const gl::Program& program = context.programs().get(files);
    program.set("showError", drawn != nullptr ? 1 : 0);
    program.use();
    context.drawFullscreen();
}

graph::Resource EnvironmentMappingLab::build(graph::FrameGraph& graph, const Frame& frame) {
    prepareScene();
    const View shown = view.as<View>();
    counters_ = {{"triangles", scene_->triangleCount() + mirrorScene_->triangleCount()}};
    if (shown == View::traced) {
        const graph::Resource picture =
            graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
        graph.addPass(
            {.name = "show the traced picture",
             .reads = {},
             .writes = {picture},
             .execute = [this, frame](graph::PassContext& context) { showTraced(context, frame, nullptr); }});
        return picture;
    }
    const graph::Resource made =
        addEnvironmentPass(graph, [this](graph::PassContext& context) { makeMap(context); });
    const auto size = static_cast<std::uint64_t>(resolution);
    const bool draws = source.as<Source>() == Source::rendered;
    counters_["map texels"] = 6 * size * size;
    counters_["map triangles"] = draws ? 6 * static_cast<std::uint64_t>(scene_->triangleCount()) : 0;

    const bool error = shown == View::error;
    const PictureTargets targets =
        addPictureTargets(graph, {.format = error ? graph::Format::rgba32f : frame.pictureFormat,
                                  .width = frame.width,
                                  .height = frame.height,
                                  .factor = shown == View::faces ? 1 : static_cast<int>(supersample),
                                  .name = error ? "drawn" : "picture"});
    graph.addPass({.name = "shade",
                   .reads = {made},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, frame](graph::PassContext& context) { drawPicture(context, frame); }});
    addResolvePass(graph, targets);
    if (!error)
        return targets.picture;
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    graph.addPass({.name = "hold against the traced picture",
                   .reads = {targets.picture},
                   .writes = {picture},
                   .execute = [this, frame, drawn = targets.picture](graph::PassContext& context) {
                       showTraced(context, frame, &context.texture(drawn));
                   }});
    return picture;
}

Lab::ReferenceJob EnvironmentMappingLab::reference(const Frame& frame) const {
    if (view.as<View>() != View::picture || roughness > 0)
        return {};
    return [hall = currentHall(), seen = mirrors(), frame,
            factor = static_cast<int>(supersample)](const std::atomic<bool>& stop) {
        return boxDownsample(
            traceMirrors(hall, frame.camera, frame.width * factor, frame.height * factor, seen, &stop),
            factor);
    };
}

Exercise EnvironmentMappingLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"what is reflected", {}},
                        {"the plane mirror", {{"reflector", "ball"}}},
                        {"the solids", {{"solids", "off"}}}};
    exercise.freeKnobs = {"supersample"};
    exercise.shader = "labs/18_environment_mapping/mirror.frag";
    exercise.scenes = {{{"turn", "90"}}, {{"box-projection", "on"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::EnvironmentMappingLab)

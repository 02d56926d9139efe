#include "labs/16_shadow_maps/lab.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "image/filter.h"
#include "passes/fullscreen.h"
#include "scene/colonnade.h"
#include "scene/import.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;
/// Where the sun stands, about the upright axis, when its knob is at zero.
constexpr float sunAzimuthRadians = 52 * degree;
constexpr int mostAtlasTexels = 16384;  // along a side, as today's drivers hold them

void showMap(graph::PassContext& context, const gl::Texture2D& map, const Frame& frame, bool evenDepths) {
    constexpr int unit = 1;
    const gl::Program& program = context.programs().get(fullscreenProgram("depth_view"));
    program.use();
    program.set("depthMap", unit);
    program.set("targetPixels", glm::vec2(frame.width, frame.height));
    program.set("contrast", evenDepths ? 1.0f : 0.35f);
    map.bind(unit);
    context.drawFullscreen();
}

}  // namespace

ShadowMapLab::ShadowMapLab() : colonnade_(makeColonnade()) {}

void ShadowMapLab::useScene(Scene scene) {
    builtIn_ = false;
    tessellation.setIdle("imported models keep their own triangles");
    scene.backgroundTop = colonnade_.backgroundTop;
    scene.backgroundBottom = colonnade_.backgroundBottom;
    scene.ambientLight = colonnade_.ambientLight;
    bounds_ = scene.bounds();
    imported_ = std::make_shared<const Scene>(scene);
    scene_ = std::make_unique<ForwardScene>(std::move(scene));
}

void ShadowMapLab::markIdleKnobs() {
    pcfRadius.setIdle(filter.as<Filter>() == Filter::pcf ? "" : "for --filter=pcf");
    cascades.setIdle(source.as<Source>() == Source::sun ? "" : "only the sun has cascades");
    biasScale.setIdle(bias.as<ShadowBias>() == ShadowBias::none ? "there is no bias" : "");
    supersample.setIdle(view.as<View>() == View::picture ? "" : "for --view=picture");
}

Camera ShadowMapLab::defaultCamera() const {
    if (builtIn_)
        return colonnade_.camera;
    const Scene& scene = scene_->scene();
    return scene.cameras.empty() ? frameBounds(scene.bounds(), composedAspect) : scene.cameras.front();
}

Bounds ShadowMapLab::sceneBounds() const {
    return builtIn_ ? quincunx::tessellate(colonnade_, 8).bounds() : bounds_;
}

Light ShadowMapLab::currentLight() const {
    const float azimuth = sunAzimuthRadians + sunTurn * degree;
    const float height = sunHeight * degree;
    const glm::vec3 towards(std::cos(height) * std::sin(azimuth), std::sin(height),
                            std::cos(height) * std::cos(azimuth));
    Light light = colonnade_.lights.front();
    light.direction = -towards;
    if (source.as<Source>() == Source::sun)
        return light;
    // A built-in scene is lit from just outside the colonnade, an imported one from as far in its own
    // measure.
    const glm::vec3 centre = builtIn_ ? glm::vec3(0, 1.2f, 0) : bounds_.centre();
    const float distance = builtIn_ ? 11.0f : 2.2f * bounds_.radius();
    if (source.as<Source>() == Source::lamp) {
        light.kind = Light::Kind::point;
        // Inside: shadows in every direction.
        light.position = centre + 0.16f * distance * towards;
        light.intensity = 0.055f * distance * distance;
        return light;
    }
    light.kind = Light::Kind::spot;
    light.position = centre + distance * towards;
    light.outerConeRadians = 34 * degree;
    light.innerConeRadians = 24 * degree;
    light.intensity = 1.6f * distance * distance;
    return light;
}

ShadowMapParams ShadowMapLab::shadowParams() const {
    ShadowMapParams params;
    params.resolution = resolution;
    params.cascades = source.as<Source>() == Source::sun ? static_cast<int>(cascades) : 1;
    params.bias = bias.as<ShadowBias>();
    params.biasScale = biasScale;
    params.bilinear = filter.as<Filter>() != Filter::nearest;
    params.radius = filter.as<Filter>() == Filter::pcf ? static_cast<int>(pcfRadius) : 0;
    params.backFaces = backFaces;
    return params;
}

void ShadowMapLab::prepareScene() {
    if (!builtIn_ || builtTessellation_ == tessellation)
        return;
    Scene scene = quincunx::tessellate(colonnade_, tessellation);
    bounds_ = scene.bounds();
    scene_ = std::make_unique<ForwardScene>(std::move(scene));
    builtTessellation_ = tessellation;
}

graph::Resource ShadowMapLab::build(graph::FrameGraph& graph, const Frame& frame) {
    prepareScene();
    const Light light = currentLight();
    scene_->scene().lights = {light};
    const ShadowMapParams params = shadowParams();
    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    const ShadowViews views = fitShadowViews(light, scene_->scene(), frame.camera, aspect, params);
    const glm::ivec2 size = ShadowMap::size(views.views.size(), params.resolution);
    if (std::max(size.x, size.y) > mostAtlasTexels)
        throw InputError(fmt::format("{} views of {} texels do not fit into a map of {}", views.views.size(),
                                     params.resolution, mostAtlasTexels),
                         "--resolution", "lower it, or use fewer cascades");

    const graph::Resource map = graph.addResource({"shadow map", graph::Format::depth32f, size.x, size.y});
    graph.addPass({.name = "shadow map",
                   .reads = {},
                   .writes = {map},
                   .execute = [this, views, params](graph::PassContext& context) {
                       shadowMap_.draw(context, *scene_, views, params);
                   }});
    const bool showsMap = view.as<View>() == View::map;
    const PictureTargets targets =
        addPictureTargets(graph, {frame.pictureFormat, frame.width, frame.height,
                                  view.as<View>() == View::picture ? static_cast<int>(supersample) : 1});
    const std::uint64_t triangles = scene_->triangleCount();
    counters_ = {{"triangles", triangles},
                 {"map triangles", triangles * views.views.size()},
                 {"map texels", static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y)}};
    graph.addPass(
        {.name = showsMap ? "show the map" : "shade",
         .reads = {map},
         .writes = {targets.color, targets.depth},
         .execute = [this, frame, views, params, light, map, showsMap, aspect](graph::PassContext& context) {
             if (showsMap)
                 return showMap(context, context.texture(map), frame,
                                views.kind == ShadowViews::Kind::cascades);
             glClear(GL_DEPTH_BUFFER_BIT);
             shadowMap_.drawShadowed(context, *scene_, forwardView(frame.camera, aspect),
                                     {.map = context.texture(map),
                                      .views = views,
                                      .params = params,
                                      .camera = frame.camera,
                                      .lightIndex = 0,
                                      .lightPosition = light.position},
                                     view.as<View>() == View::mask);
         }});
    addResolvePass(graph, targets);
    return targets.picture;
}

Lab::ReferenceJob ShadowMapLab::reference(const Frame& frame) const {
    if (view.as<View>() != View::picture)
        return {};
    return
        [exact = exactScene(), frame, factor = static_cast<int>(supersample)](const std::atomic<bool>& stop) {
            return boxDownsample(
                traceReference(exact(), frame.camera, frame.width * factor, frame.height * factor,
                               {.reflection = PhongModel::Reflection::blinnPhong, .shadows = true}, &stop),
                factor);
        };
}

std::function<TraceScene()> ShadowMapLab::exactScene() const {
    if (!builtIn_)
        return [scene = imported_, light = currentLight()] {
            Scene exact = *scene;
            exact.lights = {light};
            return TraceScene(std::move(exact));
        };
    StillLife exact = colonnade_;
    exact.lights = {currentLight()};
    return [exact] { return TraceScene(exact); };
}

Exercise ShadowMapLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the shadows", {}}, {"where the shadows fall", {{"light-turn", "60"}}}};
    exercise.freeKnobs = {"supersample"};
    exercise.shader = "passes/phong_shadowed.frag";
    exercise.scenes = {{{"light-turn", "80"}}, {{"light", "spot"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::ShadowMapLab)

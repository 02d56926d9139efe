#include "labs/21_accumulation/lab.h"

#include <algorithm>

#include <fmt/format.h>

#include "labs/21_accumulation/toy_table.h"
#include "passes/depth_of_field.h"
#include "passes/motion_blur.h"
#include "passes/post.h"
#include "scene/animation.h"
#include "scene/import.h"

namespace quincunx {
namespace {

constexpr const char* antialiasingName = "antialiasing";
constexpr const char* depthOfFieldName = "depth of field";
constexpr const char* softShadowsName = "soft shadows";
constexpr const char* motionBlurName = "motion blur";

/// Models of other programs are taken as so many units large.
constexpr float modelRadius = 6;
/// A directional light has the extent of a lamp so far away.
constexpr float lampDistance = 10;

}  // namespace

AccumulationLab::AccumulationLab() = default;

void AccumulationLab::useScene(Scene scene) {
    builtIn_ = false;
    subject.setIdle("for what is built in");
    tessellation.setIdle("imported models keep their own triangles");
    if (scene.lights.empty())
        scene.lights = studioLights();
    lights_ = scene.lights;
    bounds_ = scene.bounds();
    unit_ = bounds_.radius() > 0 ? bounds_.radius() / modelRadius : 1;
    scene_ = std::make_unique<ForwardScene>(std::move(scene));
    movingMeshes_.reset();
    liveSettings_.clear();
}

void AccumulationLab::prepareScene() {
    if (!builtIn_ || (builtTessellation_ == tessellation && builtSubject_ == subject.index()))
        return;
    const auto wanted = subject.as<Subject>();
    scene_ = std::make_unique<ForwardScene>(wanted == Subject::toys ? makeToyTable(tessellation)
                                                                    : makeSubject(wanted));
    builtSubject_ = subject.index();
    lights_ = scene_->scene().lights;
    bounds_ = scene_->scene().bounds();
    builtTessellation_ = tessellation;
    movingMeshes_.reset();
}

const Scene& AccumulationLab::scene() {
    prepareScene();
    return scene_->scene();
}

Camera AccumulationLab::defaultCamera() const {
    if (const std::optional<Camera> own = ownCamera())
        return *own;
    if (builtIn_)
        return makeToyTable(3).cameras.front();
    const Scene& scene = scene_->scene();
    return scene.cameras.empty() ? frameBounds(scene.bounds(), composedAspect) : scene.cameras.front();
}

std::optional<Camera> AccumulationLab::ownCamera() const {
    if (!builtIn_ || subject.as<Subject>() == Subject::toys)
        return {};
    return makeSubject(subject.as<Subject>()).cameras.front();
}

Lab::ReferenceJob AccumulationLab::reference(const Frame& frame) const {
    if (!builtIn_ || subject.as<Subject>() == Subject::toys || method.as<Method>() != Method::accumulated)
        return {};
    EdgeSettings settings;
    settings.subject = subject.as<Subject>();
    settings.camera = cameraOf(frame);
    settings.lamp.radius = lightSize;
    settings.lamp.shape = lightShape.as<AreaLight::Shape>();
    settings.seconds = time;
    settings.shutterSeconds = shutter;
    return [settings, width = frame.width, height = frame.height](const std::atomic<bool>&) {
        const Image share = exactEdge(settings, width, height);
        Image picture(width, height, 4, Encoding::linear);
        for (std::size_t i = 0; i < picture.data.size(); ++i)
            picture.data[i] = i % 4 == 3 ? 1 : share.data[i / 4];
        return picture;
    };
}

Bounds AccumulationLab::sceneBounds() const {
    // The toys without the cloth.
    return builtIn_ ? Bounds{{-4, 0, -4}, {4, 3, 4}} : scene_->scene().bounds();
}

std::vector<glm::mat4> AccumulationLab::placementsAt(double seconds) {
    pose(scene_->scene(), seconds);
    std::vector<glm::mat4> placements;
    for (const Instance& instance : scene_->scene().instances)
        placements.push_back(instance.worldFromModel);
    return placements;
}

bool AccumulationLab::moves() {
    if (!isAnimated(scene_->scene()) || shutter == 0)
        return false;
    // What comes back to where it was has moved in between: the middle is looked at as well.
    const double half = 0.5 * static_cast<double>(shutter);
    const double middle = time;
    const std::vector<glm::mat4> atOpen = placementsAt(middle - half);
    return atOpen != placementsAt(middle) || atOpen != placementsAt(middle + half);
}

bool AccumulationLab::casts() const {
    return !lights_.empty() && !scene_->scene().instances.empty();
}

AreaLight AccumulationLab::lamp() const {
    AreaLight area;
    area.light = lights_.front();
    area.shape = lightShape.as<AreaLight::Shape>();
    area.radius = area.light.kind == Light::Kind::directional ? lightSize / lampDistance : lightSize * unit_;
    return area;
}

AccumulatedEffects AccumulationLab::calledFor() {
    prepareScene();
    const bool drawn = !scene_->scene().instances.empty();
    const bool moving = moves();
    reports_.clear();
    const AccumulatedEffects shown = builtIn_ ? effectsOf(subject.as<Subject>()) : effectsOf(Subject::toys);
    const auto decide = [&](const char* name, bool isShown, bool yes, std::string reason) {
        reports_.push_back(
            {name, isShown && yes, isShown ? std::move(reason) : "the edge is for another effect", {}});
        return isShown && yes && leftOut_.find(name) == leftOut_.end();
    };
    AccumulatedEffects effects;
    effects.antialiasing = decide(antialiasingName, shown.antialiasing, antialias && drawn,
                                  !antialias ? "not asked for"
                                  : drawn    ? "outlines cross pixels"
                                             : "nothing is drawn");
    effects.depthOfField = decide(
        depthOfFieldName, shown.depthOfField, aperture > 0 && drawn,
        aperture > 0 ? fmt::format("the lens is {:g} wide", 2 * aperture) : "a pinhole shows all sharp");
    const bool soft = casts() && lightSize > 0;
    effects.softShadows = decide(
        softShadowsName, shown.softShadows, soft,
        !casts() ? "no light casts a shadow"
        : soft   ? fmt::format("{} is {:g} wide",
                             lights_.front().name.empty() ? "the light" : lights_.front().name, 2 * lightSize)
                 : "the light is a point");
    effects.motionBlur =
        decide(motionBlurName, shown.motionBlur, moving,
               shutter == 0 ? "the shutter is open for a moment only"
               : moving     ? fmt::format("something moves in the {:g} s of the exposure", shutter)
                            : "nothing moves during the exposure");
    return effects;
}

std::vector<EffectReport> AccumulationLab::effects() const {
    return reports_;
}

void AccumulationLab::leaveOut(const std::vector<std::string>& effects) {
    leftOut_ = {effects.begin(), effects.end()};
}

void AccumulationLab::markIdleKnobs() {
    const bool accumulated = method.as<Method>() == Method::accumulated;
    const bool compensates = summation.as<Summation>() == Summation::compensated;
    const char* const forAccumulated = accumulated ? "" : "for --method=accumulated";
    for (Knob* knob :
         std::initializer_list<Knob*>{&passes, &samples, &antialias, &lightSize, &summation, &perFrame})
        knob->setIdle(forAccumulated);
    focus.setIdle(aperture > 0 ? "" : "a pinhole shows all sharp");
    lightShape.setIdle(!accumulated ? forAccumulated : lightSize > 0 ? "" : "the light is a point");
    buffer.setIdle(!accumulated ? forAccumulated : compensates ? "compensated sums are in 32-bit float" : "");
    block.setIdle(!accumulated ? forAccumulated : compensates ? "" : "for --sum=compensated");
    if (builtIn_)
        tessellation.setIdle(subject.as<Subject>() == Subject::toys ? "" : "the edge is of two triangles");
    taps.setIdle(accumulated ? "for --method=post-processed" : "");
    if (!builtIn_ && !isAnimated(scene_->scene()))
        for (Knob* knob : std::initializer_list<Knob*>{&shutter, &time})
            knob->setIdle("nothing in the scene moves");
}

Camera AccumulationLab::cameraOf(const Frame& frame) const {
    Camera camera = frame.camera;
    camera.apertureRadius = aperture * unit_;
    camera.focusDistance = focus * unit_;
    return camera;
}

std::string AccumulationLab::settings(const Frame& frame) const {
    std::string text = fmt::format("{}x{} {} {} {:a}", frame.width, frame.height,
                                   static_cast<int>(frame.pictureFormat), frame.seed, frame.timeSeconds);
    for (const auto& [name, value] : knobs().values())
        if (name != perFrame.name())
            text += fmt::format("\n{}={}", name, value);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            text += fmt::format(" {:a}", frame.camera.worldFromCamera[column][row]);
    return text + fmt::format(" {:a} {:a} {:a}", frame.camera.fovYRadians, frame.camera.nearDistance,
                              frame.camera.farDistance);
}

AccumulationLab::Shot AccumulationLab::shotOf(const Frame& frame) {
    Shot shot;
    shot.camera = cameraOf(frame);
    shot.effects = calledFor();
    shot.shadowed = casts();
    if (shot.shadowed)
        shot.lamp = lamp();
    shot.shadows.resolution = shadowResolution;
    shot.shadows.bilinear = true;
    shot.seconds = time;
    shot.shutterSeconds = shot.effects.motionBlur ? static_cast<double>(shutter) : 0;
    shot.aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    shot.width = frame.width;
    shot.height = frame.height;
    pose(scene_->scene(), shot.seconds);
    return shot;
}

graph::Resource AccumulationLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const Shot shot = shotOf(frame);
    converging_ = false;
    counters_ = {{"passes", 0}, {"shadow maps", 0}, {"triangles", 0}};
    if (map_)
        map_->drawn = false;
    if (method.as<Method>() == Method::postProcessed)
        return buildPostProcessed(graph, frame, shot);

    AccumulationParams params;
    params.samples = passSamples(samples.as<SamplePattern>(), passes, shot.effects, frame.seed);
    params.accumulator = {.width = frame.width,
                          .height = frame.height,
                          .summation = summation.as<Summation>(),
                          .buffer = buffer.as<AccumulationBuffer>(),
                          .passes = params.samples.size(),
                          .blockPasses = static_cast<std::size_t>(static_cast<int>(block))};
    params.format = frame.pictureFormat;
    params.prepare = [this, shot](graph::PassContext& context, const PassSample& sample) {
        prepare(context, shot, sample);
    };
    params.draw = [this, shot](graph::PassContext& context, const PassSample& sample) {
        draw(context, shot, sample);
    };
    const std::vector<std::string> names = params.samples.size() > 1
                                               ? std::vector<std::string>{"accumulate", "show the mean"}
                                               : std::vector<std::string>{};
    for (EffectReport& report : reports_)
        if (report.calledFor && leftOut_.find(report.name) == leftOut_.end())
            report.passes = names;
    if (!frame.live)
        return addAccumulationPasses(graph, whole_, params);
    const std::string now = settings(frame);
    const bool resume = now == std::exchange(liveSettings_, now);
    params.passesAFrame = static_cast<std::size_t>(static_cast<int>(perFrame));
    const std::size_t before = resume ? live_.added() : 0;
    converging_ = params.samples.size() > 1 && before + params.passesAFrame < params.samples.size();
    return addAccumulationPasses(graph, live_, params, resume);
}

void AccumulationLab::prepare(graph::PassContext& context, const Shot& shot, const PassSample& sample) {
    if (shot.effects.motionBlur)
        pose(scene_->scene(), passSeconds(shot.seconds, shot.shutterSeconds, sample));
    if (!shot.shadowed)
        return;
    const Light light = passLight(shot.lamp, sample);
    scene_->scene().lights.front() = light;
    if (map_ && map_->drawn && !shot.effects.motionBlur && !shot.effects.softShadows)
        return;
    const ShadowViews views = fitShadowViews(light, scene_->scene(), shot.camera, shot.aspect, shot.shadows);
    const glm::ivec2 size = ShadowMap::size(views.views.size(), shot.shadows.resolution);
    if (!map_ || map_->depth.width() != size.x || map_->depth.height() != size.y) {
        map_.emplace();
        map_->depth = gl::Texture2D("lamp's shadow map", GL_DEPTH_COMPONENT32F, size.x, size.y);
        map_->framebuffer = gl::Framebuffer("lamp's shadow map", {}, &map_->depth);
    }
    map_->views = views;
    map_->framebuffer.bind();
    shadowMap_.draw(context, *scene_, views, shot.shadows);
    map_->drawn = true;
    counters_["shadow maps"] += 1;
    counters_["triangles"] += scene_->triangleCount() * views.views.size();
}

void AccumulationLab::draw(graph::PassContext& context, const Shot& shot, const PassSample& sample) {
    const ForwardView view = passView(shot.camera, shot.width, shot.height, sample);
    glClear(GL_DEPTH_BUFFER_BIT);
    counters_["passes"] += 1;
    counters_["triangles"] += scene_->triangleCount();
    if (!shot.shadowed)
        return scene_->draw(context, view);
    shadowMap_.drawShadowed(context, *scene_, view,
                            {.map = map_->depth,
                             .views = map_->views,
                             .params = shot.shadows,
                             .camera = shot.camera,
                             .lightIndex = 0,
                             .lightPosition = scene_->scene().lights.front().position},
                            builtIn_ && subject.as<Subject>() == Subject::penumbra);
}

graph::Resource AccumulationLab::buildPostProcessed(graph::FrameGraph& graph, const Frame& frame,
                                                    const Shot& shot) {
    const graph::Format light =
        frame.pictureFormat == graph::Format::rgba32f ? graph::Format::rgba32f : graph::Format::rgba16f;
    const graph::Resource ready = graph.addResource({"shadow map ready", graph::Format::rgba8, 1, 1});
    const graph::Resource shaded = graph.addResource({"shaded", light, frame.width, frame.height});
    const graph::Resource depth =
        graph.addResource({"depth", graph::Format::depth32f, frame.width, frame.height});
    Shot still = shot;
    still.effects = {};
    graph.addPass({.name = "shadow map",
                   .reads = {},
                   .writes = {ready},
                   .execute = [this, still](graph::PassContext& context) {
                       glClear(GL_COLOR_BUFFER_BIT);
                       prepare(context, still, PassSample{});
                   }});
    graph.addPass(
        {.name = "draw",
         .reads = {ready},
         .writes = {shaded, depth},
         .execute = [this, still](graph::PassContext& context) { draw(context, still, PassSample{}); }});
    graph::Resource shown = shaded;
    const auto pixels = static_cast<float>(frame.height);
    if (shot.effects.motionBlur) {
        MotionBlurParams params{.camera = shot.camera, .cameraOpen = shot.camera, .cameraClose = shot.camera};
        const double half = 0.5 * shot.shutterSeconds;
        const std::vector<glm::mat4> atOpen = placementsAt(shot.seconds - half);
        const std::vector<glm::mat4> atClose = placementsAt(shot.seconds + half);
        const std::vector<glm::mat4> now = placementsAt(shot.seconds);
        for (std::size_t i = 0; i < now.size(); ++i)
            if (atOpen[i] != atClose[i])
                params.instances.push_back({i, now[i], atOpen[i], atClose[i]});
        params.buffers = [this]() -> const SceneBuffers& {
            if (!movingMeshes_)
                movingMeshes_.emplace(scene_->scene(), SceneBuffers::Layout::shared);
            std::vector<ObjectBlock> objects;
            for (const Instance& instance : scene_->scene().instances)
                objects.push_back(
                    makeObjectBlock(scene_->scene().materials[instance.material], instance.worldFromModel));
            movingMeshes_->updateObjects(objects);
            return *movingMeshes_;
        };
        params.maxLengthPixels = std::min(0.25f * pixels, 256.0f);
        params.taps = taps;
        shown = addMotionBlurPasses(graph, shown, depth, params);
    }
    if (shot.effects.depthOfField)
        shown = addDepthOfFieldPasses(
            graph, shown, depth,
            {.camera = shot.camera, .maxRadiusPixels = std::min(0.06f * pixels, 128.0f), .taps = taps});
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    addToneMapPass(graph, shown, picture, {.curve = ToneCurve::none, .cutOff = false});
    return picture;
}

Exercise AccumulationLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the depth of field", {{"aperture", "0"}}},
                        {"the soft shadows", {{"light-size", "0"}}},
                        {"the motion blur", {{"shutter", "0"}}}};
    exercise.freeKnobs = {"sum"};
    exercise.shader = "passes/accumulate_add.frag";
    exercise.scenes = {{{"time", "1"}}, {{"aperture", "0.3"}}};
    exercise.shaderKnobs = {{"passes", "12"}, {"sum", "weighted"}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::AccumulationLab)

#include "labs/30_full_frame/lab.h"

#include <algorithm>

#include <fmt/format.h>

#include "image/compare.h"
#include "lab/studio.h"
#include "labs/30_full_frame/evening.h"
#include "passes/fullscreen.h"
#include "scene/animation.h"
#include "scene/import.h"

namespace quincunx {
namespace {

/// "directional shadows" as a word of the command line.
std::string wordFor(std::string_view effect) {
    std::string word(effect);
    std::replace(word.begin(), word.end(), ' ', '-');
    return word;
}

std::vector<std::string> nothingOrOneEffect() {
    std::vector<std::string> options = {"nothing"};
    for (const Effect& effect : quincunx::effects())
        options.push_back(wordFor(effect.name));
    return options;
}

/// The light of the built-in scene, for files that have none.
std::vector<Light> lightsFor(const Scene& scene) {
    return scene.lights.empty() ? studioLights() : scene.lights;
}

}  // namespace

FullFrameLab::FullFrameLab()
    : without{knobs(), "without", nothingOrOneEffect(), 0, "Leave out one effect that is called for"} {}

void FullFrameLab::useScene(Scene scene) {
    builtIn_ = false;
    playing_ = false;
    tessellation.setIdle("imported models keep their own triangles");
    scene.lights = lightsFor(scene);
    // Files of other programs have no background; one of no colour lets what mirrors it be seen.
    if (scene.backgroundTop == glm::vec3(0) && scene.backgroundBottom == glm::vec3(0)) {
        scene.backgroundTop = {0.30f, 0.34f, 0.40f};
        scene.backgroundBottom = {0.05f, 0.05f, 0.055f};
    }
    scene_ = std::move(scene);
    renderer_.reset();
}

bool FullFrameLab::moves() const {
    return builtIn_ || isAnimated(scene_);
}

void FullFrameLab::markIdleKnobs() {
    const char* const still = moves() ? "" : "nothing in the scene moves";
    time.setIdle(still);
    shutter.setIdle(still);
    focus.setIdle(aperture > 0 || defaultCamera().apertureRadius > 0 ? "" : "a pinhole shows all sharp");
}

Camera FullFrameLab::defaultCamera() const {
    if (builtIn_)
        return makeEvening(3).cameras.front();
    return scene_.cameras.empty() ? frameBounds(scene_.bounds(), composedAspect) : scene_.cameras.front();
}

Bounds FullFrameLab::sceneBounds() const {
    return builtIn_ ? Bounds{{-5, 0, -5}, {5, 4, 7}} : scene_.bounds();
}

bool FullFrameLab::advance(double seconds, const HeldSeconds& /*held*/) {
    const float next = time + static_cast<float>(seconds);
    time.set(next <= time.range().max ? next : time.range().min);
    return true;
}

std::vector<LabKey> FullFrameLab::keys() {
    return {{'T', "let the time run, or stop it", [this] {
                 playing_ = moves() && !playing_;
                 return std::string(moves() ? "" : "nothing in the scene moves");
             }}};
}

std::vector<EffectReport> FullFrameLab::effects() const {
    std::vector<EffectReport> reports;
    for (const PlannedEffect& effect : renderer_.plan().effects)
        reports.push_back(
            {std::string(effect.name), effect.decision.calledFor, effect.decision.reason, effect.passes});
    return reports;
}

void FullFrameLab::leaveOut(const std::vector<std::string>& effects) {
    leftOut_.reset();
    for (const std::string& effect : effects)
        leftOut_.set(findEffect(effect));
}

void FullFrameLab::prepareScene() {
    if (!builtIn_ || builtTessellation_ == tessellation)
        return;
    scene_ = makeEvening(tessellation);
    renderer_.reset();
    builtTessellation_ = tessellation;
}

void FullFrameLab::placeAt(double seconds) {
    builtIn_ ? poseEvening(scene_, seconds) : pose(scene_, seconds);
}

std::vector<glm::mat4> FullFrameLab::placementsAt(double seconds) {
    placeAt(seconds);
    std::vector<glm::mat4> placements;
    placements.reserve(scene_.instances.size());
    for (const Instance& instance : scene_.instances)
        placements.push_back(instance.worldFromModel);
    return placements;
}

graph::Resource FullFrameLab::build(graph::FrameGraph& graph, const Frame& frame) {
    prepareScene();
    const double seconds = static_cast<double>(time);
    const double halfOpen = 0.5 * static_cast<double>(shutter);
    atOpen_ = shutter > 0 ? placementsAt(seconds - halfOpen) : std::vector<glm::mat4>{};
    atClose_ = shutter > 0 ? placementsAt(seconds + halfOpen) : std::vector<glm::mat4>{};
    placeAt(seconds);

    FrameView view{.scene = scene_,
                   .camera = frame.camera,
                   .width = frame.width,
                   .height = frame.height,
                   .worldFromModelAtOpen = atOpen_,
                   .worldFromModelAtClose = atClose_,
                   .pictureFormat = frame.pictureFormat};
    if (aperture > 0)
        view.camera.apertureRadius = aperture;
    if (focus > 0)
        view.camera.focusDistance = focus;
    view.cameraAtOpen = view.camera;
    view.cameraAtClose = view.camera;
    FrameSettings& settings = view.settings;
    settings.exposureStops = exposure;
    settings.toneCurve = toneCurve.as<ToneCurve>();
    settings.bloomStrength = bloom;
    settings.bloomSigmaPixels = 0.0125f * static_cast<float>(frame.height);
    settings.largestDiscPixels = 0.04f * static_cast<float>(frame.height);
    settings.longestWayPixels = 0.08f * static_cast<float>(frame.height);
    settings.blurSigmaPixels = blur;
    settings.greyscale = greyscale;
    settings.fxaa = fxaa;
    settings.shutterSeconds = shutter;
    settings.shadowResolution = shadowResolution;
    settings.leftOut = leftOut_;
    if (without.index() > 0)
        settings.leftOut.set(static_cast<std::size_t>(without.index() - 1));
    if (force)
        settings.forced.set();
    const graph::Resource picture = renderer_.build(graph, view);

    const FramePlan& plan = renderer_.plan();
    const auto called = static_cast<std::uint64_t>(std::count_if(
        plan.effects.begin(), plan.effects.end(), [](const auto& e) { return e.decision.calledFor; }));
    counters_ = {{"triangles", plan.triangles},
                 {"shadow triangles", plan.shadowTriangles},
                 {"objects", plan.drawn},
                 {"effects", called}};
    return showPlan ? addPlanPass(graph, frame, picture) : picture;
}

std::string FullFrameLab::fitted(std::string words, float sizePixels, float widthPixels) {
    if (labels_.extent(words, sizePixels).x <= widthPixels)
        return words;
    constexpr const char* dots = "…";
    while (!words.empty() && labels_.extent(words + dots, sizePixels).x > widthPixels) {
        // A character of UTF-8 ends at its first byte.
        while (words.size() > 1 && (static_cast<unsigned char>(words.back()) & 0xc0) == 0x80)
            words.pop_back();
        words.pop_back();
    }
    return words + dots;
}

graph::Resource FullFrameLab::addPlanPass(graph::FrameGraph& graph, const Frame& frame,
                                          graph::Resource picture) {
    const graph::Resource written =
        graph.addResource({"picture with its plan", frame.pictureFormat, frame.width, frame.height});
    graph.addPass(
        {.name = "write the plan",
         .reads = {picture},
         .writes = {written},
         .execute = [this, picture, plan = renderer_.plan(),
                     size = glm::vec2(frame.width, frame.height)](graph::PassContext& context) {
             drawPicture(context, picture);
             labels_.clear();
             const float line = std::clamp(size.y / 40, 8.0f, 20.0f);
             const auto rows = static_cast<float>(plan.effects.size() + 1);
             labels_.plate({0, 0}, {size.x, line * (rows + 1)}, {0, 0, 0, 0.55f});
             const auto write = [&](const std::string& words, float x, std::size_t row,
                                    const glm::vec4& color) {
                 labels_.text(fitted(words, line, size.x - x - 0.5f * line),
                              {x, line * (0.5f + static_cast<float>(row))},
                              {.sizePixels = line, .color = color});
             };
             for (std::size_t i = 0; i < plan.effects.size(); ++i) {
                 const PlannedEffect& effect = plan.effects[i];
                 const bool in = effect.decision.calledFor;
                 const glm::vec4 color =
                     in ? glm::vec4(1, 0.75f, 0.3f, 1) : glm::vec4(0.35f, 0.35f, 0.35f, 1);
                 write(in ? "●" : "○", 0.5f * line, i, color);
                 write(std::string(effect.name), 1.5f * line, i, color);
                 write(effect.decision.reason, 11 * line, i, color);
             }
             write(fmt::format("{} of {} objects, {} of {} lights, {} triangles and {} in shadow maps",
                               plan.drawn, plan.instances, plan.lights, plan.lightsOfScene, plan.triangles,
                               plan.shadowTriangles),
                   0.5f * line, plan.effects.size(), glm::vec4(1));
             labels_.draw(context, size);
         }});
    return written;
}

std::vector<Sweep> FullFrameLab::sweeps() {
    const auto measureAgainst = [this](const KnobValues& reference) {
        return [this, reference](Studio& studio, const Frame& frame) {
            const Image picture = studio.linearPicture(*this, frame);
            SweepSample sample;
            const auto timing = studio.time(*this, frame, 9);
            sample.seconds = timing.medianSeconds;
            sample.secondsSpread = timing.spreadSeconds;
            sample.counters = counters();
            const KnobScope scope(knobs());
            knobs().set(reference);
            sample.error = rmse(studio.linearPicture(*this, frame), picture);
            return sample;
        };
    };
    Sweep effects;
    effects.name = "effects";
    effects.title = "what leaving out one effect saves, and what it spoils";
    effects.reference = "the frame with all that it calls for";
    effects.metric = "RMSE";
    for (const std::string& option : without.options())
        effects.points.push_back({{"without", option}, {"aperture", "0.06"}, {"shutter", "0.03"}});
    effects.measure = measureAgainst({{"without", "nothing"}});
    Sweep shadows;
    shadows.name = "shadow-resolution";
    shadows.title = "how fine shadow maps must be";
    shadows.reference = "maps of 8192 texels a side, four times the finest point's texels";
    shadows.metric = "RMSE";
    for (const char* texels : {"64", "128", "256", "512", "1024", "2048", "4096"})
        shadows.points.push_back({{"shadow-resolution", texels}});
    shadows.measure = measureAgainst({{"shadow-resolution", "8192"}});
    return {effects, shadows};
}

Exercise FullFrameLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the light on the materials", {}},
                        {"the glow", {{"bloom", "0"}}},
                        {"the exposure", {{"exposure", "-1"}}}};
    exercise.freeKnobs = {"force"};
    exercise.shader = "passes/frame_material.frag";
    exercise.scenes = {{{"exposure", "1"}}, {{"time", "1"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::FullFrameLab)

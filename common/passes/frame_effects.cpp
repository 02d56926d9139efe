#include "passes/frame_effects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "passes/depth_of_field.h"
#include "passes/motion_blur.h"

namespace quincunx {
namespace {

std::string nameOf(const Light& light) {
    const char* const kind = light.kind == Light::Kind::directional ? "sun"
                             : light.kind == Light::Kind::spot      ? "spot"
                                                                    : "lamp";
    return light.name.empty() || light.name == kind
               ? fmt::format("the {}", kind)
               : fmt::format("the {} '{}'", kind, printable(light.name, 40));
}

std::string counted(std::size_t count, const char* thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// Says yes or no, and why, where somebody asks: sentences cost more than the decisions they are about.
template <typename Sentence>
bool answer(bool yes, std::string* why, Sentence&& sentence) {
    if (why != nullptr)
        *why = sentence();
    return yes;
}

/// Why a frame calls for the shadows of that kind of light, or does not.
template <Light::Kind kind>
std::string shadowReason(const Visibility& visibility, const FrameView& view) {
    const std::vector<Light>& lights = view.scene.lights;
    constexpr const char* kindName = kind == Light::Kind::directional ? "directional"
                                     : kind == Light::Kind::spot      ? "spot"
                                                                      : "point";
    const auto ofKind = static_cast<std::size_t>(
        std::count_if(lights.begin(), lights.end(), [](const Light& light) { return light.kind == kind; }));
    if (ofKind == 0)
        return fmt::format("there is no {} light", kindName);
    std::vector<std::string> casting;
    std::vector<std::string> idle;
    for (const LightReach& reach : visibility.lights) {
        const Light& light = lights[reach.light];
        if (light.kind != kind)
            continue;
        if (reach.shadowed > 0)
            casting.push_back(fmt::format("{} casts onto {} of {} from {}", nameOf(light), reach.shadowed,
                                          counted(visibility.visible(), "visible object"),
                                          counted(reach.casters.size(), "caster")));
        else
            idle.push_back(fmt::format("nothing stands between {} and what it lights", nameOf(light)));
    }
    if (!casting.empty() || !idle.empty())
        return fmt::format("{}", fmt::join(casting.empty() ? idle : casting, "; "));
    if (visibility.visible() == 0)
        return fmt::format("nothing is in view for {} to light", counted(ofKind, "such light"));
    return fmt::format("{} {} nothing in view", counted(ofKind, "such light"),
                       ofKind == 1 ? "reaches" : "reach");
}

template <Light::Kind kind>
bool castsShadows(const Visibility& visibility, const FrameView& view, std::string* why) {
    const std::vector<Light>& lights = view.scene.lights;
    const bool casts = std::any_of(
        visibility.lights.begin(), visibility.lights.end(),
        [&](const LightReach& reach) { return reach.shadowed > 0 && lights[reach.light].kind == kind; });
    return answer(casts, why, [&] { return shadowReason<kind>(visibility, view); });
}

template <Light::Kind kind>
void addShadows(FrameBuilder& frame) {
    constexpr const char* name = kind == Light::Kind::directional ? "directional shadow map"
                                 : kind == Light::Kind::spot      ? "spot shadow map"
                                                                  : "point shadow map";
    const auto atlas = std::make_shared<const ShadowAtlas>(
        makeShadowAtlas(frame.visibility, frame.view.scene, kind, frame.view.settings));
    const graph::Resource map =
        frame.graph.addResource({name, graph::Format::depth32f, atlas->width(), atlas->height()});
    frame.graph.addPass({.name = name,
                         .writes = {map},
                         .execute = [&device = frame.device, &view = frame.view,
                                     &visibility = frame.visibility, atlas](graph::PassContext& context) {
                             drawShadowAtlas(context, device.materials(view.scene), view.scene, visibility,
                                             *atlas);
                         }});
    frame.shadowMaps.push_back({atlas, map});
}

bool mirrors(const Visibility& visibility, const FrameView& view, std::string* why) {
    const Surroundings& surroundings = visibility.surroundings;
    return answer(surroundings.mirrorsInView > 0, why, [&]() -> std::string {
        if (surroundings.mirrorsInView > 0)
            return fmt::format("{} of {} mirror{} the surroundings", surroundings.mirrorsInView,
                               counted(visibility.visible(), "visible object"),
                               surroundings.mirrorsInView == 1 ? "s" : "");
        if (surroundings.mirrors > 0)
            return fmt::format("no reflecting surface in view ({} {} out of view)", surroundings.mirrors,
                               surroundings.mirrors == 1 ? "is" : "are");
        return view.scene.instances.empty() ? "the scene is empty"
                                            : "nothing in the scene is metallic or smooth enough to mirror "
                                              "its surroundings";
    });
}

void addEnvironment(FrameBuilder& frame) {
    frame.environment =
        addEnvironmentPass(frame.graph, [&device = frame.device, &view = frame.view,
                                         &visibility = frame.visibility](graph::PassContext& context) {
            device.environment(context, view, visibility.surroundings);
        });
}

bool blends(const Visibility& visibility, const FrameView& view, std::string* why) {
    return answer(!visibility.blended.empty(), why, [&]() -> std::string {
        if (!visibility.blended.empty())
            return fmt::format(
                "{} of {} blend{} with what is behind: sorted, and so are the triangles of what "
                "is not convex",
                visibility.blended.size(), counted(visibility.visible(), "visible object"),
                visibility.blended.size() == 1 ? "s" : "");
        const auto blending = std::count_if(
            view.scene.instances.begin(), view.scene.instances.end(), [&](const Instance& instance) {
                return view.scene.materials[instance.material].alphaMode == Material::AlphaMode::blend;
            });
        return blending == 0 ? "nothing in the scene blends"
                             : fmt::format("nothing in view blends ({} out of view)", blending);
    });
}

void sortBlended(FrameBuilder& frame) {
    frame.sortsBlended = true;
}

bool defocuses(const Visibility&, const FrameView& view, std::string* why) {
    const Camera& camera = view.camera;
    return answer(camera.apertureRadius > 0, why, [&]() -> std::string {
        if (!(camera.apertureRadius > 0))
            return "the camera is a pinhole: everything is sharp";
        const CirclesOfConfusion discs = circlesOfConfusion(camera, view.height);
        return fmt::format(
            "a lens of radius {:.3g} focused at {:.3g}: discs of {:.3g} pixels at the near "
            "plane, {:.3g} at the far one",
            camera.apertureRadius, camera.focusDistance, std::abs(discs.atNear), std::abs(discs.atFar));
    });
}

void addDefocus(FrameBuilder& frame) {
    frame.picture = addDepthOfFieldPasses(
        frame.graph, frame.picture, frame.depth,
        {.camera = frame.view.camera, .maxRadiusPixels = frame.view.settings.largestDiscPixels});
}

bool movesWhileExposed(const Visibility& visibility, const FrameView& view, std::string* why) {
    const bool exposes = view.settings.shutterSeconds > 0;
    const bool moves = !visibility.moving.empty() || visibility.cameraMoves;
    return answer(exposes && moves, why, [&]() -> std::string {
        if (!exposes)
            return "the shutter is open for no time";
        const std::string open =
            fmt::format("the shutter is open for {:.3g} s", view.settings.shutterSeconds);
        if (!visibility.moving.empty())
            return fmt::format("{}, while {} of {} move{}{}", open, visibility.moving.size(),
                               counted(visibility.visible(), "visible object"),
                               visibility.moving.size() == 1 ? "s" : "",
                               visibility.cameraMoves ? ", and so does the camera" : "");
        return open + (moves ? ", while the camera moves" : ", but nothing in view moves");
    });
}

void addMotionBlur(FrameBuilder& frame) {
    const FrameView& view = frame.view;
    const glm::vec3& anchor = frame.visibility.anchorWorld;
    const auto anchored = [&](Camera camera) {
        camera.worldFromCamera = relativeTo(anchor, camera.worldFromCamera);
        return camera;
    };
    const bool moves = movesWhileExposed(frame.visibility, view, nullptr);
    MotionBlurParams params{.camera = anchored(view.camera),
                            .cameraOpen = anchored(moves ? view.cameraAtOpen : view.camera),
                            .cameraClose = anchored(moves ? view.cameraAtClose : view.camera)};
    for (const std::uint32_t i : frame.visibility.moving)
        params.instances.push_back({i, relativeTo(anchor, view.scene.instances[i].worldFromModel),
                                    relativeTo(anchor, view.worldFromModelAtOpen[i]),
                                    relativeTo(anchor, view.worldFromModelAtClose[i])});
    params.buffers = [&device = frame.device, &scene = view.scene]() -> const SceneBuffers& {
        return device.movingMeshes(scene);
    };
    params.maxLengthPixels = view.settings.longestWayPixels;
    frame.picture = addMotionBlurPasses(frame.graph, frame.picture, frame.depth, params);
}

bool blooms(const Visibility&, const FrameView& view, std::string* why) {
    const FrameSettings& settings = view.settings;
    return answer(settings.bloomStrength != 0, why, [&]() -> std::string {
        return settings.bloomStrength == 0
                   ? "no bloom is asked for"
                   : fmt::format("asked for: what is brighter than {:g} glows with a strength of {:g}",
                                 settings.bloomThreshold, settings.bloomStrength);
    });
}

void addBloom(FrameBuilder& frame) {
    const FrameSettings& settings = frame.view.settings;
    frame.picture = addBloomPasses(frame.graph, frame.picture,
                                   {.threshold = settings.bloomThreshold,
                                    .strength = settings.bloomStrength,
                                    .sigmaPixels = settings.bloomSigmaPixels});
}

bool mapsTones(const Visibility&, const FrameView& view, std::string* why) {
    const FrameSettings& settings = view.settings;
    const bool curved = settings.toneCurve != ToneCurve::none;
    const bool exposed = settings.exposureStops != 0;
    return answer(curved || exposed || settings.fxaa, why, [&]() -> std::string {
        constexpr std::array<const char*, 3> curves = {"none", "Reinhard", "filmic"};
        if (curved)
            return fmt::format("asked for: the {} curve at an exposure of {:g} stops",
                               curves[static_cast<std::size_t>(settings.toneCurve)], settings.exposureStops);
        if (exposed)
            return fmt::format("asked for: an exposure of {:g} stops", settings.exposureStops);
        return settings.fxaa ? "FXAA works on a picture within [0, 1]"
                             : "neither curve nor exposure is asked for: the picture's format cuts off at 1";
    });
}

void addToneMap(FrameBuilder& frame) {
    const FrameSettings& settings = frame.view.settings;
    const graph::Resource mapped = frame.destination("tone mapped");
    addToneMapPass(frame.graph, frame.picture, mapped,
                   {.curve = settings.toneCurve,
                    .exposureStops = settings.exposureStops,
                    .cutOff = mapsTones(frame.visibility, frame.view, nullptr)});
    frame.picture = mapped;
}

bool blurs(const Visibility&, const FrameView& view, std::string* why) {
    const float sigma = view.settings.blurSigmaPixels;
    return answer(sigma > 0, why, [&]() -> std::string {
        return sigma > 0 ? fmt::format("asked for: a Gaussian of {:g} pixels", sigma)
                         : "no blur is asked for";
    });
}

void addBlur(FrameBuilder& frame) {
    frame.picture =
        addBlurPasses(frame.graph, frame.picture, {.sigmaPixels = frame.view.settings.blurSigmaPixels});
}

bool greys(const Visibility&, const FrameView& view, std::string* why) {
    const float grey = view.settings.greyscale;
    return answer(grey != 0, why, [&]() -> std::string {
        return grey == 0 ? "no greyscale is asked for" : fmt::format("asked for: {:.0f} % grey", 100 * grey);
    });
}

void addGrey(FrameBuilder& frame) {
    frame.picture = addFilmPass(frame.graph, frame.picture, {.greyscale = frame.view.settings.greyscale});
}

bool smoothsEdges(const Visibility&, const FrameView& view, std::string* why) {
    const bool asked = view.settings.fxaa;
    return answer(asked, why,
                  [&] { return asked ? "asked for: edges are smoothed" : "no antialiasing is asked for"; });
}

void addFxaa(FrameBuilder& frame) {
    const graph::Resource smoothed = frame.destination("smoothed");
    addFxaaPass(frame.graph, frame.picture, smoothed, {.strength = frame.view.settings.fxaa ? 1.0f : 0.0f});
    frame.picture = smoothed;
}

using Stage = Effect::Stage;
using Kind = Light::Kind;

/// The one place where an effect is made known.
constexpr Effect table[] = {
    {"directional shadows", Stage::before, castsShadows<Kind::directional>, addShadows<Kind::directional>},
    {"spot shadows", Stage::before, castsShadows<Kind::spot>, addShadows<Kind::spot>},
    {"point shadows", Stage::before, castsShadows<Kind::point>, addShadows<Kind::point>},
    {"environment map", Stage::before, mirrors, addEnvironment},
    {"transparency order", Stage::shading, blends, sortBlended},
    {"depth of field", Stage::after, defocuses, addDefocus},
    {"motion blur", Stage::after, movesWhileExposed, addMotionBlur},
    {"bloom", Stage::after, blooms, addBloom},
    {"tone map", Stage::after, mapsTones, addToneMap},
    {"blur", Stage::after, blurs, addBlur},
    {"greyscale", Stage::after, greys, addGrey},
    {"fxaa", Stage::after, smoothsEdges, addFxaa},
};
static_assert(std::size(table) <= maxEffects);
static_assert(std::is_sorted(std::begin(table), std::end(table),
                             [](const Effect& a, const Effect& b) { return a.stage < b.stage; }));

}  // namespace

graph::Resource FrameBuilder::addPicture(const std::string& name) {
    return graph.addResource({name, graph::Format::rgba32f, view.width, view.height});
}

graph::Resource FrameBuilder::destination(const std::string& name) {
    return isLast ? target : addPicture(name);
}

std::span<const Effect> effects() {
    return table;
}

std::size_t findEffect(std::string_view name) {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < std::size(table); ++i) {
        if (table[i].name == name)
            return i;
        names.push_back(table[i].name);
    }
    throw InputError(fmt::format("there is no effect \"{}\"", printable(name, 40)), {},
                     fmt::format("choose from {}", fmt::join(names, ", ")));
}

}  // namespace quincunx

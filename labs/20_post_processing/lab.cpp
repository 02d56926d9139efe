#include "labs/20_post_processing/lab.h"

#include <algorithm>

#include "passes/fullscreen.h"
#include "passes/targets.h"
#include "scene/import.h"
#include "scene/spaceship.h"

namespace quincunx {

PostProcessingLab::PostProcessingLab() = default;

void PostProcessingLab::useScene(Scene scene) {
    builtIn_ = false;
    tessellation.setIdle("imported models keep their own triangles");
    if (scene.lights.empty())
        scene.lights = makeSpaceship(3).lights;
    scene_ = std::make_unique<ForwardScene>(std::move(scene));
}

void PostProcessingLab::markIdleKnobs() {
    place.setIdle(greyscale > 0 || grain > 0 ? "" : "there is neither grey nor grain");
    const char* const withoutBlur = blurSize > 0 ? "" : "there is no blur";
    blurMethod.setIdle(withoutBlur);
    blurReach.setIdle(withoutBlur);
    bloomSize.setIdle(bloom > 0 ? "" : "there is no bloom");
}

Camera PostProcessingLab::defaultCamera() const {
    if (builtIn_)
        return makeSpaceship(3).cameras.front();
    const Scene& scene = scene_->scene();
    return scene.cameras.empty() ? frameBounds(scene.bounds(), composedAspect) : scene.cameras.front();
}

Bounds PostProcessingLab::sceneBounds() const {
    // The ship without its planet and stars.
    return builtIn_ ? Bounds{{-3, -2, -2}, {3, 2, 2}} : scene_->scene().bounds();
}

void PostProcessingLab::prepareScene() {
    if (!builtIn_ || builtTessellation_ == tessellation)
        return;
    scene_ = std::make_unique<ForwardScene>(makeSpaceship(tessellation));
    builtTessellation_ = tessellation;
}

void PostProcessingLab::drawScene(graph::PassContext& context, const Frame& frame, int factor) {
    const bool inside = place.as<Place>() == Place::shader && (greyscale > 0 || grain > 0);
    gl::ProgramFiles files{.label = "fancy",
                           .vertex = "passes/phong.vert",
                           .fragment = "labs/20_post_processing/fancy.frag",
                           .defines = {{"BLINN_PHONG", ""}},
                           .blocks = SceneBuffers::bindings()};
    gl::ProgramFiles space = fullscreenProgram("space", "labs/20_post_processing/space.frag");
    space.blocks = SceneBuffers::bindings();
    const auto setFilm = [&](const gl::ProgramFiles& program) {
        const gl::Program& built = context.programs().get(program);
        built.set("greyscale", greyscale);
        built.set("octaves", static_cast<int>(grain));
        built.set("samplesPerPixel", static_cast<float>(factor));
    };
    if (inside) {
        for (gl::ProgramFiles* program : {&files, &space}) {
            program->defines.emplace_back("FILM_INSIDE", "");
            setFilm(*program);
        }
        const std::vector<Material>& materials = scene_->scene().materials;
        if (std::any_of(materials.begin(), materials.end(), [](const Material& m) { return m.doubleSided; }))
            setFilm(doubleSidedVariant(files));
    }
    ForwardView view =
        forwardView(frame.camera, static_cast<float>(frame.width) / static_cast<float>(frame.height));
    view.background = false;
    glClear(GL_DEPTH_BUFFER_BIT);
    scene_->bindFrame(view);
    context.programs().get(space).use();
    context.drawFullscreen();
    glDepthFunc(GL_LEQUAL);  // the same triangles again are drawn again
    for (int i = 0; i < layers; ++i)
        scene_->draw(context, view, files);
    glDepthFunc(GL_LESS);
}

graph::Resource PostProcessingLab::build(graph::FrameGraph& graph, const Frame& frame) {
    prepareScene();
    const graph::Format light =
        frame.pictureFormat == graph::Format::rgba32f ? graph::Format::rgba32f : graph::Format::rgba16f;
    const PictureTargets targets =
        addPictureTargets(graph, {light, frame.width, frame.height, supersample, "scene"});
    graph.addPass({.name = "draw the scene",
                   .reads = {},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, frame, targets](graph::PassContext& context) {
                       drawScene(context, frame, targets.factor);
                   }});
    addResolvePass(graph, targets);

    graph::Resource shown = targets.picture;
    if (place.as<Place>() == Place::pass && (greyscale > 0 || grain > 0))
        shown = addFilmPass(graph, shown, {greyscale, grain});
    std::uint64_t fetches = 0;
    if (blurSize > 0) {
        const BlurParams blur{blurMethod.as<BlurMethod>(), blurSize, blurReach};
        shown = addBlurPasses(graph, shown, blur);
        fetches = fetchesAPixel(blur);
    }
    if (bloom > 0)
        shown = addBloomPasses(graph, shown, {.strength = bloom, .sigmaPixels = bloomSize});
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    const ToneMapParams tone{curve.as<ToneCurve>(), exposure};
    if (fxaa) {
        const graph::Resource mapped = graph.addResource({"tone mapped", light, frame.width, frame.height});
        addToneMapPass(graph, shown, mapped, tone);
        addFxaaPass(graph, mapped, picture);
    } else {
        addToneMapPass(graph, shown, picture, tone);
    }
    counters_ = {{"triangles", scene_->triangleCount() * static_cast<std::uint64_t>(layers)}};
    if (fetches > 0)
        counters_["blur fetches a pixel"] = fetches;
    return picture;
}

Exercise PostProcessingLab::exercise() const {
    Exercise exercise;
    exercise.effects = {
        {"the glow", {{"bloom", "0"}}}, {"the tone curve", {}}, {"the exposure", {{"exposure", "-1.5"}}}};
    exercise.freeKnobs = {"supersample"};
    exercise.shader = "passes/tone_map.frag";
    exercise.scenes = {{{"exposure", "2.5"}}, {{"tone-map", "reinhard"}}};
    exercise.shaderKnobs = {{"tone-map", "filmic"}, {"exposure", "1.5"}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::PostProcessingLab)

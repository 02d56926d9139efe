#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "image/compare.h"
#include "image/filter.h"
#include "lab/studio.h"
#include "labs/20_post_processing/lab.h"

namespace quincunx {
namespace {

/// Nothing after the scene but what is switched on next.
void bare(PostProcessingLab& lab) {
    for (Knob* knob : lab.knobs().all())
        knob->reset();
    lab.supersample.set(1);
    lab.bloom.set(0);
    lab.curve.set(static_cast<int>(ToneCurve::none));
}

/// A square that covers the middle pixel of a picture with odd sides, and no other.
Scene onePixel() {
    Scene scene;
    constexpr float half = 0.004f;
    scene.meshes.push_back(
        {.name = "square",
         .positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}},
         .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
         .texcoords = {},
         .indices = {0, 1, 2, 0, 2, 3}});
    Material material;
    material.diffuse = glm::vec3(0);
    material.ambient = glm::vec3(0);
    material.specular = glm::vec3(0);
    material.emission = {0.2f, 0.9f, 0.4f};
    scene.materials.push_back(material);
    scene.instances.push_back({.name = "square"});
    Camera camera;
    camera.worldFromCamera[3].z = 1;
    scene.cameras.push_back(camera);
    return scene;
}

double litPixels(PostProcessingLab& lab, Studio& studio) {
    Frame frame = studio.frame(lab, 65, 65);
    const Image picture = studio.linearPicture(lab, frame);
    double count = 0;
    for (std::size_t i = 0; i < picture.pixelCount(); ++i)
        count += picture.data[4 * i + 1] > 0;
    return count;
}

std::vector<Measurement> measureSteps(Studio& studio) {
    std::vector<Measurement> figures;
    const StepOrders orders = runAllOrders(studio.context());
    figures.push_back(
        {"orders of the eight steps, each run on OpenGL", double(orders.tried), "", equals(40320)});
    figures.push_back({"of these the window shows the grey spaceship", double(orders.right), "", equals(42)});
    figures.push_back({"orders that the card's partial order allows", double(orders.cards), "", equals(18)});
    figures.push_back({"of these, right", double(orders.rightOfCards), "", equals(18)});
    figures.push_back({"right, and the texture bound before the spaceship is drawn",
                       double(orders.rightWithEarlyBind), "", equals(24)});

    PostProcessingLab lab;
    bare(lab);
    lab.greyscale.set(1);
    lab.grain.set(12);
    const Frame frame = studio.frame(lab, 240, 160);
    const double pixels = 240 * 160;
    const auto place = [&](PostProcessingLab::Place where) { lab.place.set(static_cast<int>(where)); };
    place(PostProcessingLab::Place::shader);
    const Image inside = studio.linearPicture(lab, frame);
    place(PostProcessingLab::Place::pass);
    const Image after = studio.linearPicture(lab, frame);
    double worst = 0;
    for (std::size_t i = 0; i < inside.data.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(inside.data[i]) - after.data[i]));
    // One addition and one product are rounded otherwise by another compiler of shaders.
    figures.push_back(
        {"the effect in FancyShader or in a pass: largest difference", worst, "", atMost(1e-6)});
    for (const int layers : {1, 4, 16}) {
        lab.layers.set(layers);
        place(PostProcessingLab::Place::shader);
        // The tone map, one pixel each, does not run the effect.
        const double fragments = static_cast<double>(studio.samplesPassed(lab, frame)) - pixels;
        const double insideSeconds = studio.time(lab, frame, 5, 1).medianSeconds;
        place(PostProcessingLab::Place::pass);
        const double passSeconds = studio.time(lab, frame, 5, 1).medianSeconds;
        figures.push_back(
            {fmt::format("drawn {} times over: runs of the effect in FancyShader over those in a pass",
                         layers),
             fragments / pixels, "times", layers == 16 ? atLeast(2) : atLeast(1)});
        figures.push_back(
            {fmt::format("drawn {} times over: time", layers), insideSeconds / passSeconds, "times", {}});
    }

    PostProcessingLab dot;
    dot.useScene(onePixel());
    bare(dot);
    dot.greyscale.set(1);
    figures.push_back(
        {"one bright pixel: pixels that the greyscale of it reaches", litPixels(dot, studio), "", equals(1)});
    dot.greyscale.set(0);
    dot.blurSize.set(4);
    figures.push_back(
        {"one bright pixel: pixels that its blur reaches", litPixels(dot, studio), "", equals(625)});
    return figures;
}

}  // namespace

std::vector<Question> PostProcessingLab::questions() {
    return {
        {53,
         "A spaceship is drawn into a texture and shown in grey: which orders of the eight steps work, why "
         "can a pass over the picture be cheaper than the same effect in the spaceship's shader, and why can "
         "many effects not be written there at all?",
         "Bind the off-screen target, then clear it; bind FancyShader any time before the spaceship is "
         "drawn. Then bind the window as target and GrayScaleShader, in any order, and draw the quad last. "
         "The texture may be bound to its unit at any moment before the quad: it is only read then. A pass "
         "runs once for every pixel; the spaceship's shader runs for every fragment, also those that "
         "something nearer covers later. And a fragment cannot read its neighbours, which are not finished "
         "yet, while a pass reads a picture that is: a blur needs them.",
         "binding the texture earlier is right as well, so 42 orders work and not 18",
         [](Studio& studio) { return measureSteps(studio); }},
    };
}

std::vector<Sweep> PostProcessingLab::sweeps() {
    Sweep sweep;
    sweep.name = "blur";
    sweep.title = "a Gaussian blur of 6 pixels, five ways";
    sweep.reference = "the Gaussian out to six deviations, in double, on the same picture";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of linear light";
    sweep.width = 320;
    sweep.height = 240;
    for (const char* method : {"separable", "pairs", "half", "quarter"})
        for (const char* reach : {"1.5", "2", "3", "4"})
            sweep.points.push_back({{"blur-method", method}, {"blur-reach", reach}});
    for (const char* reach : {"2", "3"})
        sweep.points.push_back({{"blur-method", "direct"}, {"blur-reach", reach}});
    const auto scene = std::make_shared<Image>();
    const auto blurred = std::make_shared<Image>();
    sweep.measure = [this, scene, blurred](Studio& studio, const Frame& frame) {
        constexpr float sigma = 6;
        blurSize.set(sigma);
        supersample.set(1);
        bloom.set(0);
        Frame exact = frame;
        exact.pictureFormat = graph::Format::rgba32f;
        const Image seen = studio.resource(*this, exact, "scene");
        if (*scene != seen) {
            *scene = seen;
            *blurred = gaussianBlur(seen, sigma);
        }
        SweepSample sample;
        sample.error = rmse(*blurred, studio.resource(*this, exact, "blurred"));
        const Studio::Timing timing = studio.time(*this, frame);
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters = counters();
        return sample;
    };
    return {sweep};
}

}  // namespace quincunx

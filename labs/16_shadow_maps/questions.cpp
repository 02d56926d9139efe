#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "lab/studio.h"
#include "labs/16_shadow_maps/lab.h"
#include "labs/16_shadow_maps/mask_figures.h"

namespace quincunx {
namespace {

constexpr int width = 320;
constexpr int height = 240;

/// The built-in scene with fine triangles, one sample a pixel and one texel a lookup, and its traced mask.
struct Bench {
    ShadowMapLab lab;
    Studio& studio;
    Frame frame;
    Image traced;

    explicit Bench(Studio& drawing) : studio(drawing), frame(drawing.frame(lab, width, height)) {
        lab.supersample.set(1);
        lab.tessellation.set(96);
        lab.filter.set(static_cast<int>(ShadowMapLab::Filter::nearest));
        lab.view.set(static_cast<int>(ShadowMapLab::View::mask));
        retrace();
    }
    void retrace() {
        traced = traceLitMask(lab.exactScene()(), frame.camera, width, height, 0, &interruptFlag());
    }
    MaskFigures measure() { return compareMasks(studio.linearPicture(lab, frame), traced); }
    MaskFigures measure(ShadowBias bias, float scale) {
        lab.bias.set(static_cast<int>(bias));
        lab.biasScale.set(scale);
        return measure();
    }
};

double percent(double share) {
    return 100 * share;
}

std::vector<Measurement> measureAlgorithm(Studio& studio) {
    Bench bench(studio);
    std::vector<Measurement> figures;
    static constexpr std::array resolutions = {128, 256, 512, 1024, 2048};
    std::vector<double> wrong;
    for (const int resolution : resolutions) {
        bench.lab.resolution.set(resolution);
        wrong.push_back(bench.measure().wrongShare());
        figures.push_back(
            {fmt::format("{0}×{0} texels: pixels that the traced shadow has otherwise", resolution),
             percent(wrong.back()),
             "%",
             {}});
        const Studio::Timing timing = studio.time(bench.lab, bench.frame, 5, 1);
        figures.push_back({fmt::format("{0}×{0} texels: time of a frame", resolution),
                           timing.medianSeconds * 1e3,
                           "ms",
                           {}});
    }
    // Wrong pixels line the shadows' edges in a band as wide as a texel, so they go with the texel's width:
    // measured slope -0.8, less steep than -1 since the finest maps meet the error of the triangles.
    const double slope = std::log2(wrong.back() / wrong.front()) /
                         std::log2(static_cast<double>(resolutions.back()) / resolutions.front());
    figures.push_back({"slope of wrong pixels over texels a side, log-log", slope, "", atMost(-0.5)});
    figures.push_back({"2048×2048 texels: wrong pixels", percent(wrong.back()), "%", atMost(1)});
    return figures;
}

std::vector<Measurement> measureBias(Studio& studio) {
    Bench bench(studio);
    std::vector<Measurement> figures;
    const auto tell = [&](const std::string& name, const MaskFigures& found) {
        figures.push_back({name + ": lit pixels that went dark (acne)", percent(found.acneShare()), "%", {}});
        figures.push_back(
            {name + ": dark pixels that went lit (leaks)", percent(found.leakShare()), "%", {}});
        return found;
    };
    const MaskFigures none = tell("no bias", bench.measure(ShadowBias::none, 0));
    MaskFigures widest = none;
    for (const float scale : {0.5f, 1.0f, 2.0f, 4.0f, 16.0f, 64.0f})
        widest =
            tell(fmt::format("constant, {:g} texels", scale), bench.measure(ShadowBias::constant, scale));
    const MaskFigures slope = tell("by slope, in the map", bench.measure(ShadowBias::slope, 1));
    const MaskFigures plane = tell("by the receiver's plane", bench.measure(ShadowBias::receiverPlane, 1));
    figures.push_back({"no bias: acne", percent(none.acneShare()), "%", atLeast(25)});
    figures.push_back(
        {"64 texels: leaks over those without bias",
         static_cast<double>(widest.leaks) / std::max<double>(1, static_cast<double>(none.leaks)), "times",
         atLeast(2)});
    figures.push_back({"by slope: acne", percent(slope.acneShare()), "%", atMost(1)});
    figures.push_back({"by the receiver's plane: acne", percent(plane.acneShare()), "%", atMost(1)});
    // Measured 3.2: within half a texel of an edge a point takes its neighbour's depth, whatever the bias.
    figures.push_back({"by the receiver's plane: leaks", percent(plane.leakShare()), "%", atMost(5)});
    return figures;
}

std::vector<Measurement> measureProsAndCons(Studio& studio) {
    Bench bench(studio);
    ShadowMapLab& lab = bench.lab;
    std::vector<Measurement> figures;
    const auto seconds = [&] { return studio.time(lab, bench.frame, 5, 1).medianSeconds; };

    lab.tessellation.set(24);
    const double coarse = seconds();
    const auto coarseTriangles = static_cast<double>(lab.counters().at("map triangles"));
    lab.tessellation.set(96);
    const double fine = seconds();
    const auto fineTriangles = static_cast<double>(lab.counters().at("map triangles"));
    // 4 times the segments are 16 times the triangles but for pieces that have few steps already.
    figures.push_back({"any triangles: drawn once more, in the map; more of them",
                       fineTriangles / coarseTriangles, "times", atLeast(8)});
    figures.push_back({"any triangles: time of the frame with so many more", fine / coarse, "times", {}});
    lab.tessellation.set(48);

    lab.source.set(static_cast<int>(ShadowMapLab::Source::sun));
    const double sun = seconds();
    const auto sunTexels = static_cast<double>(lab.counters().at("map texels"));
    lab.source.set(static_cast<int>(ShadowMapLab::Source::lamp));
    const double lamp = seconds();
    figures.push_back({"a light in every direction: texels over those of the sun",
                       static_cast<double>(lab.counters().at("map texels")) / sunTexels, "times", equals(6)});
    figures.push_back({"a light in every direction: time over the sun's", lamp / sun, "times", {}});
    lab.source.set(static_cast<int>(ShadowMapLab::Source::sun));

    const double picture = seconds();
    lab.view.set(static_cast<int>(ShadowMapLab::View::map));
    const double mapAlone = seconds();
    lab.view.set(static_cast<int>(ShadowMapLab::View::mask));
    figures.push_back(
        {"a map that can be kept saves, of the frame's time", percent(mapAlone / picture), "%", {}});

    lab.tessellation.set(96);
    lab.resolution.set(64);
    const double jagged = bench.measure().wrongShare();
    lab.resolution.set(2048);
    const double smooth = bench.measure().wrongShare();
    figures.push_back({"jagged at 64 texels: wrong pixels", percent(jagged), "%", atLeast(4)});
    figures.push_back({"2048 texels: wrong pixels", percent(smooth), "%", atMost(1)});

    lab.resolution.set(1024);
    const double tuned = bench.measure(ShadowBias::receiverPlane, 1).wrongShare();
    const double untuned = bench.measure(ShadowBias::none, 0).wrongShare();
    figures.push_back({"bias: wrong pixels without over with", untuned / tuned, "times", atLeast(10)});

    // A constant that nearly suffices under a high sun, and the same under a low one.
    constexpr float enough = 1;
    for (const auto& [degrees, bound] : {std::pair{60.0f, atMost(4)}, std::pair{3.0f, atLeast(6)}}) {
        lab.sunHeight.set(degrees);
        bench.retrace();
        figures.push_back({fmt::format("a constant bias of {:g} texel, sun at {:g}°: acne", enough, degrees),
                           percent(bench.measure(ShadowBias::constant, enough).acneShare()), "%", bound});
    }
    return figures;
}

}  // namespace

std::vector<Question> ShadowMapLab::questions() {
    return {
        {26, "What speaks for shadow maps, and what against them, where shadow volumes are the alternative?",
         "For maps: whatever can be drawn can cast, since the map is one more drawing of the scene; a "
         "lookup costs the same however rich the scene is; the map of a scene that stands still can be "
         "kept. Against them: a map covers one frustum, so that a light in every direction needs six views; "
         "a shadow's edge is as jagged as the map's texels are large; and the comparison needs a bias, "
         "which a scene and a light must be tuned for where it is a constant. Volumes have sharp edges and "
         "no direction that they cannot serve, but draw many large polygons, in more passes.",
         "", [](Studio& studio) { return measureProsAndCons(studio); }},
        {27, "Why does a shadow map need a bias?",
         "A surface is sampled twice: by the eye at its pixels, and by the light at the texels of the map. "
         "A pixel looks up the depth that was taken up to half a texel away; where the surface slopes away "
         "from the light, that depth can be the smaller one, and the surface shades itself in stripes. The "
         "bias lets the pixel lie that much deeper; it also covers that both depths are rounded. Too little "
         "leaves acne, too much lets light leak in under what touches the surface. Half a texel times the "
         "slope of the receiver's own plane is just enough.",
         "the two samplings are the eye's and the light's, not the eye's and the camera's; too little bias "
         "gives acne, leaks come from too much",
         [](Studio& studio) { return measureBias(studio); }},
        {69, "How does the shadow map algorithm work?",
         "First draw the scene from the light and keep the depth of what it sees first: the map. Then draw "
         "it from the eye; carry each fragment's position into the light's view, divide by w, and compare "
         "its depth with the one stored there. If it is deeper, something nearer to the light takes its "
         "light away. Stored are rounded depths at the texels' centres, so that \"deeper\" must mean by "
         "more than a bias.",
         "", [](Studio& studio) { return measureAlgorithm(studio); }},
    };
}

std::vector<Sweep> ShadowMapLab::sweeps() {
    Sweep sweep;
    sweep.name = "resolution";
    sweep.title = "texels, taps or cascades: where to spend the map";
    sweep.reference = "shadow rays traced to the exact surfaces, one a pixel";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of the lit share";
    for (const char* filterName : {"nearest", "bilinear", "pcf"})
        for (const int texels : {128, 256, 512, 1024, 2048, 4096})
            sweep.points.push_back({{"filter", filterName}, {"resolution", std::to_string(texels)}});
    for (const int texels : {256, 512, 1024})
        sweep.points.push_back(
            {{"filter", "nearest"}, {"resolution", std::to_string(texels)}, {"cascades", "4"}});
    const auto traced = std::make_shared<Image>();
    sweep.measure = [this, traced](Studio& studio, const Frame& frame) {
        supersample.set(1);
        tessellation.set(96);
        if (traced->width != frame.width || traced->height != frame.height) {
            *traced =
                traceLitMask(exactScene()(), frame.camera, frame.width, frame.height, 0, &interruptFlag());
        }
        SweepSample sample;
        view.set(static_cast<int>(View::mask));
        const MaskFigures found = compareMasks(studio.linearPicture(*this, frame), *traced);
        sample.error = found.rmse;
        view.set(static_cast<int>(View::picture));
        const Studio::Timing timing = studio.time(*this, frame);
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters = counters();
        sample.counters["acne pixels"] = found.acne;
        sample.counters["leak pixels"] = found.leaks;
        return sample;
    };
    return {sweep};
}

}  // namespace quincunx

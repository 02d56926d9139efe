#include <memory>

#include "base/timing.h"
#include "image/compare.h"
#include "labs/26_ray_tracing/lab.h"
#include "labs/26_ray_tracing/measure.h"
#include "labs/26_ray_tracing/penumbra.h"

namespace quincunx {
namespace {

Sweep recursionSweep(RayTracingLab& lab) {
    Sweep sweep;
    sweep.name = "recursion";
    sweep.title = "where the tree of rays ends: a depth, a weight, roulette";
    sweep.reference = "all rays that weigh 2^-16 of their pixel or more";
    sweep.metric = "RMSE";
    sweep.errorUnit = "linear";
    sweep.width = 160;
    sweep.height = 120;
    for (const char* depth : {"0", "1", "2", "3", "4", "6", "8", "12"})
        sweep.points.push_back({{"end", "depth"}, {"max-depth", depth}});
    for (const char* end : {"weight", "roulette"})
        for (const char* weight : {"0.25", "0.0625", "0.015625", "0.00390625", "0.0009765625"})
            sweep.points.push_back({{"end", end}, {"min-weight", weight}});
    const auto reference = std::make_shared<Image>();
    sweep.measure = [&lab, reference](Studio&, const Frame& frame) {
        const auto scene = lab.scene();
        if (reference->width != frame.width || reference->height != frame.height)
            *reference = recursionReference(*scene, frame.camera, frame.width, frame.height);
        const WhittedSettings settings =
            recursionSettings(lab.end.as<RecursionEnd>(), lab.maxDepth, lab.minWeight, frame.seed);
        WhittedCounts counts;
        Image image;
        const Timing timing = timeRuns(5, [&] {
            image = renderWhitted(*scene, frame.camera, frame.width, frame.height, settings, &counts);
        });
        return SweepSample{rmse(*reference, image),
                           timing.medianSeconds,
                           timing.spreadSeconds,
                           {{"rays", counts.traceCalls}, {"rays ended early", counts.endedRays}}};
    };
    return sweep;
}

Sweep penumbraSweep(RayTracingLab& lab) {
    Sweep sweep;
    sweep.name = "penumbra";
    sweep.title = "shadow rays, and where on the lamp they end";
    sweep.reference = "the exact area of the lamp that is seen, by clipping";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of the seen share";
    for (const std::string& pattern : lab.pattern.options())
        for (const char* count : {"1", "4", "16", "64", "256"})
            sweep.points.push_back({{"pattern", pattern}, {"shadow-rays", count}});
    const auto bench = std::make_shared<PenumbraBench>();
    sweep.measure = [&lab, bench](Studio&, const Frame& frame) {
        const WhittedSettings settings = lab.settings();
        const auto sets = lightSets(settings.pattern, settings.shadowRays, frame.seed);
        SweepSample sample;
        sample.error = penumbraError(*bench, sets);
        const Timing timing = timeRuns(5, [&] { penumbraError(*bench, sets); });
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters["shadow rays"] =
            bench->points.size() * static_cast<std::uint64_t>(settings.shadowRays);
        return sample;
    };
    return sweep;
}

Sweep structureSweep(RayTracingLab& lab) {
    Sweep sweep;
    sweep.name = "structures";
    sweep.title = "structures for the same rays: tests and time; the picture is the same";
    sweep.reference = "the picture by testing every triangle";
    sweep.metric = "RMSE";
    sweep.errorUnit = "linear";
    sweep.width = 48;
    sweep.height = 36;
    for (const std::string& structure : lab.structure.options())
        sweep.points.push_back({{"structure", structure}});
    const auto reference = std::make_shared<Image>();
    sweep.measure = [&lab, reference](Studio&, const Frame& frame) {
        const WhittedSettings settings = recursionSettings(RecursionEnd::weight, 0, 1 / 32.0f);
        if (reference->width != frame.width || reference->height != frame.height)
            *reference = renderWhitted(WhittedScene(lab.scene()->contents(), Structure::bruteForce),
                                       frame.camera, frame.width, frame.height, settings);
        const auto scene = lab.scene();
        WhittedCounts counts;
        Image image;
        const bool slow = lab.structure.index() == 0;
        const Timing timing = timeRuns(slow ? 1 : 5, [&] {
            image = renderWhitted(*scene, frame.camera, frame.width, frame.height, settings, &counts);
        });
        TraversalCounts all = counts.viewTraversal;
        all += counts.shadowTraversal;
        return SweepSample{rmse(*reference, image),
                           timing.medianSeconds,
                           timing.spreadSeconds,
                           {{"rays", all.rays}, {"nodes", all.nodes}, {"triangle tests", all.triangles}}};
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> RayTracingLab::sweeps() {
    return {recursionSweep(*this), penumbraSweep(*this), structureSweep(*this)};
}

}  // namespace quincunx

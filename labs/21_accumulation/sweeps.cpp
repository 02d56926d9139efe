#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "gl/objects.h"
#include "image/compare.h"
#include "labs/21_accumulation/measure.h"

namespace quincunx {
namespace {

void addTime(SweepSample& sample, AccumulationLab& lab, Studio& studio, const Frame& frame) {
    const Studio::Timing timing = studio.time(lab, frame, 3, 1);
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
    sample.counters = lab.counters();
}

/// Against what many passes converge to; those do not depend on the knobs of the points.
Sweep againstConverged(AccumulationLab& lab, std::string name, std::string title, const KnobValues& always) {
    constexpr int convergedPasses = 1024;
    Sweep sweep;
    sweep.name = std::move(name);
    sweep.title = std::move(title);
    sweep.reference =
        fmt::format("{} other passes, summed with compensation in 32-bit float", convergedPasses);
    sweep.metric = "RMSE";
    sweep.errorUnit = "of linear light";
    sweep.width = 160;
    sweep.height = 120;
    const auto reference = std::make_shared<Image>();
    sweep.measure = [&lab, reference, always](Studio& studio, const Frame& frame) {
        lab.knobs().set(always);
        if (reference->width != frame.width || reference->height != frame.height)
            *reference = convergedPicture(lab, studio, frame, convergedPasses);
        SweepSample sample;
        sample.error = rmse(*reference, studio.linearPicture(lab, frame));
        addTime(sample, lab, studio, frame);
        return sample;
    };
    return sweep;
}

Sweep ofEdge(AccumulationLab& lab, const std::string& subject, std::string title) {
    Sweep sweep;
    sweep.name = subject;
    sweep.title = std::move(title);
    sweep.reference = lab.referenceName();
    sweep.metric = "RMSE";
    sweep.errorUnit = "of the share";
    sweep.width = 96;
    sweep.height = 72;
    for (const char* pattern : std::span(samplePatternNames).first(patternsOfAnyDimension))
        for (const char* passes : {"4", "16", "64", "256", "1024"})
            sweep.points.push_back({{"samples", pattern}, {"passes", passes}, {"subject", subject}});
    sweep.measure = [&lab](Studio& studio, const Frame& given) {
        Frame frame = given;
        frame.camera = lab.defaultCamera();
        SweepSample sample;
        sample.error = rmse(lab.reference(frame)(interruptFlag()), studio.linearPicture(lab, frame));
        addTime(sample, lab, studio, frame);
        return sample;
    };
    return sweep;
}

/// Equal frames of one pixel, up to those of three quarters of an hour of film: what is left of their mean.
Sweep ofFrames(AccumulationLab& lab) {
    Sweep sweep;
    sweep.name = "frames";
    sweep.title = "up to 65 536 equal frames: sums that stand still, drift, and stay";
    sweep.reference = "what each frame shows";
    sweep.metric = "relative error";
    sweep.errorUnit = "of the mean";
    sweep.width = 1;
    sweep.height = 1;
    for (const auto& [sum, kept] :
         {std::pair("weighted", "rgba8"), std::pair("weighted", "rgba16f"), std::pair("weighted", "rgba32f"),
          std::pair("running-mean", "rgba32f"), std::pair("compensated", "rgba32f")})
        for (const char* count : {"64", "512", "4096", "32768", "65536"})
            sweep.points.push_back({{"sum", sum}, {"buffer", kept}, {"passes", count}});
    sweep.measure = [&lab](Studio& studio, const Frame&) {
        constexpr float grey = 0.7f;
        const Accumulator::Params params{.summation = lab.summation.as<Summation>(),
                                         .buffer = lab.buffer.as<AccumulationBuffer>(),
                                         .passes = static_cast<std::size_t>(static_cast<int>(lab.passes))};
        throwIfInterrupted();
        Accumulator::Params few = params;
        few.passes = std::min<std::size_t>(params.passes, 64);
        meanOfSameFrames(studio, few, grey);  // programs are finished at their first use
        SweepSample sample;
        double mean = 0;
        sample.seconds = gl::secondsOf([&] { mean = meanOfSameFrames(studio, params, grey); });
        sample.error = std::abs(mean / static_cast<double>(grey) - 1);
        sample.counters["frames"] = params.passes;
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> AccumulationLab::sweeps() {
    std::vector<Sweep> sweeps;
    Sweep all =
        againstConverged(*this, "passes", "all four effects at once: how many passes, and how spread", {});
    for (const char* pattern : std::span(samplePatternNames).first(patternsOfAnyDimension))
        for (const char* count : {"4", "16", "64", "256"})
            all.points.push_back({{"samples", pattern}, {"passes", count}});
    sweeps.push_back(std::move(all));
    sweeps.push_back(ofEdge(*this, "moving-edge", "exposure of a moving edge"));
    sweeps.push_back(ofEdge(*this, "turning-edge", "exposure of a turning edge"));
    sweeps.push_back(ofEdge(*this, "defocused-edge", "an edge out of focus"));
    sweeps.push_back(ofEdge(*this, "penumbra", "the penumbra of an edge"));
    sweeps.push_back(ofEdge(*this, "edge", "how much of a pixel an edge covers"));

    Sweep buffers = ofEdge(*this, "moving-edge", "what the sum is kept in");
    buffers.name = "buffers";
    buffers.points.clear();
    for (const auto& [sum, kept] : {std::pair("weighted", "rgba8"), std::pair("running-mean", "rgba8"),
                                    std::pair("weighted", "rgba16f"), std::pair("running-mean", "rgba16f"),
                                    std::pair("weighted", "rgba32f"), std::pair("compensated", "rgba32f")})
        for (const char* count : {"4", "16", "64", "256", "1024"})
            buffers.points.push_back(
                {{"buffer", kept}, {"sum", sum}, {"passes", count}, {"subject", "moving-edge"}});
    sweeps.push_back(std::move(buffers));

    sweeps.push_back(ofFrames(*this));

    const auto compare = [&](const char* name, const char* title, const KnobValues& off) {
        Sweep sweep = againstConverged(*this, name, title, off);
        for (const char* count : {"4", "8", "16", "32", "64", "128"})
            sweep.points.push_back({{"method", "accumulated"}, {"passes", count}});
        for (const char* count : {"8", "16", "32", "64", "128"})
            sweep.points.push_back({{"method", "post-processed"}, {"taps", count}});
        return sweep;
    };
    sweeps.push_back(compare("lens-methods", "depth of field: many pictures, or one and its depths",
                             {{"antialias", "off"}, {"light-size", "0"}, {"shutter", "0"}}));
    sweeps.push_back(compare("shutter-methods", "motion blur: many pictures, or one and its velocities",
                             {{"antialias", "off"}, {"light-size", "0"}, {"aperture", "0"}}));
    return sweeps;
}

}  // namespace quincunx

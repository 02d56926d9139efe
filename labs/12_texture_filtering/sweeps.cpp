#include <cmath>
#include <memory>

#include "base/interrupt.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/12_texture_filtering/lab.h"

namespace quincunx {
namespace {

void takeTime(TextureFilteringLab& lab, Studio& studio, const Frame& frame, SweepSample& sample) {
    const Studio::Timing timing = studio.time(lab, frame);
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
}

/// Filters and probes on the receding floor.
Sweep floorSweep(TextureFilteringLab& lab, const std::string& pattern) {
    Sweep sweep;
    sweep.name = "floor-" + pattern;
    sweep.title = "a receding floor of " + pattern + ": blur, aliasing, or probes";
    sweep.reference = "the mean over each pixel, 1024 samples";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of linear light";
    sweep.width = 240;
    sweep.height = 180;
    const auto add = [&](const std::string& filter, const std::string& most) {
        sweep.points.push_back({{"minification", filter},
                                {"max-anisotropy", most},
                                {"view", "floor"},
                                {"compare", "off"},
                                {"unit", "opengl"},
                                {"pattern", pattern},
                                {"lod-bias", "0"}});
    };
    for (const char* filter : {"nearest", "bilinear", "mipmapped", "trilinear"})
        add(filter, "1");
    for (const char* most : {"2", "4", "8", "16"})
        add("anisotropic", most);
    add("driver", "16");
    const auto truth = std::make_shared<Image>();
    sweep.measure = [&lab, truth](Studio& studio, const Frame& frame) {
        const FloorView view = lab.floorView(frame.camera, frame.width, frame.height);
        if (truth->width != frame.width || truth->height != frame.height)
            *truth = floorReference(lab.texture(), lab.wrap.as<TextureWrap>(), view, 32, interruptFlag());
        throwIfInterrupted();
        SweepSample sample;
        sample.error = rmse(*truth, studio.linearPicture(lab, frame));
        takeTime(lab, studio, frame, sample);
        if (lab.minification.as<TextureFilteringLab::Filter>() != TextureFilteringLab::Filter::driver) {
            const FloorCounts counts = countFloor(lab.texture(), lab.sampler(), view);
            sample.counters["texels read"] = counts.texels;
            sample.counters["probes"] = counts.probes;
        }
        return sample;
    };
    return sweep;
}

/// Filters on a picture whose value is known at every point.
Sweep wavesSweep(TextureFilteringLab& lab) {
    Sweep sweep;
    sweep.name = "magnification";
    sweep.title = "enlarging a band-limited picture: how many texels a sample is worth";
    sweep.reference = "the picture's formula";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of linear light";
    sweep.width = 480;
    sweep.height = 360;
    const auto add = [&](const std::string& filter, const std::string& lobes) {
        sweep.points.push_back({{"magnification", filter},
                                {"lobes", lobes},
                                {"view", "photo"},
                                {"photo", "waves"},
                                {"compare", "off"},
                                {"unit", "opengl"},
                                {"wrap", "repeat"}});
    };
    for (const char* filter : {"nearest", "tent", "mitchell"})
        add(filter, "1");
    for (const char* lobes : {"2", "3", "4", "6", "9", "13"})
        add("lanczos", lobes);
    add("sinc", "1");
    const auto truth = std::make_shared<Image>();
    sweep.measure = [&lab, truth](Studio& studio, const Frame& frame) {
        if (truth->width != frame.width || truth->height != frame.height)
            *truth = lab.reference(frame)(interruptFlag());
        throwIfInterrupted();
        SweepSample sample;
        sample.error = rmse(*truth, studio.linearPicture(lab, frame));
        takeTime(lab, studio, frame, sample);
        const TexturePoint magnified{.st = {0.3f, 0.7f}, .alongX = {1e-6f, 0}, .alongY = {0, 1e-6f}};
        sample.counters["texels of a sample"] =
            static_cast<std::uint64_t>(sampleTexture(lab.texture(), lab.sampler(), magnified).texels);
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> TextureFilteringLab::sweeps() {
    std::vector<Sweep> sweeps;
    sweeps.push_back(floorSweep(*this, "bricks"));
    sweeps.push_back(floorSweep(*this, "checker"));
    sweeps.push_back(wavesSweep(*this));
    return sweeps;
}

}  // namespace quincunx

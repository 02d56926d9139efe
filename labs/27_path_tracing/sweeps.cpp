#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "image/compare.h"
#include "labs/27_path_tracing/lab.h"

namespace quincunx {
namespace {

SweepSample timedRender(const PathStage& stage, const RenderSettings& settings, int samples, Image& picture) {
    SweepSample sample;
    const Timing timing = timeRuns(3, [&] {
        ProgressiveRender render(stage.paths, settings);
        render.addSamples(samples, &interruptFlag());
        throwIfInterrupted();
        picture = render.picture();
        sample.counters = {{"rays", render.counts().rays()},
                           {"shadow rays", render.counts().shadowRays},
                           {"samples", static_cast<std::uint64_t>(samples)}};
    });
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
    return sample;
}

/// The ways to find light, at growing numbers of samples.
Sweep methodSweep(PathTracingLab& lab) {
    Sweep sweep;
    sweep.name = "methods";
    sweep.title = "ways to find the light, and how many paths: error against time";
    sweep.reference = "two ways of 1024 paths with other numbers, averaged";
    sweep.metric = "RMSE";
    sweep.width = 48;
    sweep.height = 36;
    for (const std::string& method : lab.method.options())
        for (const int samples : {1, 2, 4, 8, 16, 32, 64})
            if (method != "tree" || samples <= 4)
                sweep.points.push_back({{"method", method},
                                        {"samples", std::to_string(samples)},
                                        {"subject", "chamber"},
                                        {"bounces", "6"},
                                        {"branches", "3"}});
    const auto exact = std::make_shared<Image>();
    sweep.measure = [&lab, exact](Studio&, Frame frame) {
        const PathStage& stage = lab.stage();
        frame.camera = stage.camera;
        if (exact->width != frame.width || exact->height != frame.height) {
            // The mean of two ways: neither is held against itself.
            RenderSettings settings = lab.settings(frame);
            settings.branches = 0;
            settings.limits = {.maxBounces = 6};
            settings.numbers = PathSampler::Kind::sobol;
            std::vector<Image> pictures;
            for (const PathMethod method : {PathMethod::nee, PathMethod::mis}) {
                settings.method = method;
                settings.seed = frame.seed + 1000 + pictures.size();
                ProgressiveRender render(stage.paths, settings);
                render.addSamples(1024, &interruptFlag());
                throwIfInterrupted();
                pictures.push_back(render.picture());
            }
            *exact = pictures[0];
            for (std::size_t i = 0; i < exact->data.size(); ++i)
                exact->data[i] = 0.5f * (exact->data[i] + pictures[1].data[i]);
        }
        Image picture;
        SweepSample sample = timedRender(stage, lab.settings(frame), lab.samples, picture);
        sample.error = rmse(*exact, picture);
        return sample;
    };
    return sweep;
}

/// How paths end, where the light is known: every pixel of the furnace is 1 / (1 − albedo).
Sweep endingSweep(PathTracingLab& lab) {
    Sweep sweep;
    sweep.name = "endings";
    sweep.title = "how paths end: by roulette, by their weight, by their length";
    sweep.reference = "the furnace's light in closed form";
    sweep.metric = "RMSE";
    sweep.width = 32;
    sweep.height = 24;
    const auto add = [&](const char* roulette, const char* cutoff, const char* bounces) {
        for (const char* samples : {"4", "64"})
            sweep.points.push_back({{"roulette", roulette},
                                    {"cutoff", cutoff},
                                    {"bounces", bounces},
                                    {"samples", samples},
                                    {"method", "naive"},
                                    {"subject", "furnace"},
                                    {"albedo", "0.8"}});
    };
    for (const char* roulette : {"1", "0.5", "0.2", "0.05", "0.01"})
        add(roulette, "0", "1000");
    for (const char* cutoff : {"0.5", "0.1", "0.01"})
        add("0", cutoff, "1000");
    for (const char* bounces : {"2", "8", "32"})
        add("0", "0", bounces);
    sweep.measure = [&lab](Studio&, const Frame& frame) {
        Frame within = frame;
        within.camera = lab.stage().camera;
        Image picture;
        SweepSample sample = timedRender(lab.stage(), lab.settings(within), lab.samples, picture);
        Image exact = picture;
        const auto light = static_cast<float>(furnaceRadiance(static_cast<double>(lab.albedo)));
        for (std::size_t i = 0; i < exact.data.size(); ++i)
            exact.data[i] = i % 4 == 3 ? 1.0f : light;
        sample.error = rmse(exact, picture);
        return sample;
    };
    return sweep;
}

/// Two bodies that exchange light, in closed form: every pixel is one of two numbers.
Sweep exchangeSweep(PathTracingLab& lab) {
    Sweep sweep;
    sweep.name = "exchange";
    sweep.title = "a shining ball in a shell: ways to find the light, against the closed form";
    sweep.reference = "two bodies that exchange light, in closed form";
    sweep.metric = "RMSE";
    sweep.width = 32;
    sweep.height = 24;
    for (const char* method : {"naive", "nee", "mis"})
        for (const char* numbers : {"independent", "sobol"})
            for (const char* samples : {"4", "16", "64"})
                sweep.points.push_back({{"method", method},
                                        {"numbers", numbers},
                                        {"samples", samples},
                                        {"subject", "shell"},
                                        {"bounces", "1000"}});
    sweep.measure = [&lab](Studio&, const Frame& frame) {
        Frame looking = frame;
        looking.camera = lab.stage().camera;
        // Away from the ball: the shell alone.
        looking.camera.worldFromCamera[0] = -looking.camera.worldFromCamera[0];
        looking.camera.worldFromCamera[2] = -looking.camera.worldFromCamera[2];
        Image picture;
        SweepSample sample = timedRender(lab.stage(), lab.settings(looking), lab.samples, picture);
        Image exact = picture;
        const auto light = static_cast<float>(
            shellRadiance(static_cast<double>(0.4f), static_cast<double>(0.6f), static_cast<double>(0.8f))
                .shell);
        for (std::size_t i = 0; i < exact.data.size(); ++i)
            exact.data[i] = i % 4 == 3 ? 1.0f : light;
        sample.error = rmse(exact, picture);
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> PathTracingLab::sweeps() {
    return {methodSweep(*this), endingSweep(*this), exchangeSweep(*this)};
}

}  // namespace quincunx

// What the engine adds to a frame of lab 10: CPU time of the process and GL calls, beside BareShading, which
// draws the same picture by hand without any check of its calls.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "bare_shading.h"
#include "base/check.h"
#include "tests/bench/contender.h"

namespace {

using namespace quincunx;

struct Pair {
    Pair(int width, int height) : engine(width, height, true), bare(width, height, false) {}
    Contender<EngineShading> engine;
    Contender<BareShading> bare;
};

/// Rounds of one batch each, in changing order; medians over the rounds.
void compare(Pair& pair, int width, int height, int rounds, int frames) {
    std::vector<double> engine;
    std::vector<double> bare;
    std::vector<double> ratios;
    std::vector<double> threadRatios;
    for (int round = 0; round < rounds; ++round) {
        const bool bareFirst = round % 2 == 0;
        const auto first = bareFirst ? pair.bare.batch(frames) : pair.engine.batch(frames);
        const auto second = bareFirst ? pair.engine.batch(frames) : pair.bare.batch(frames);
        const auto& [engineTime, engineThread] = bareFirst ? second : first;
        const auto& [bareTime, bareThread] = bareFirst ? first : second;
        engine.push_back(engineTime);
        bare.push_back(bareTime);
        ratios.push_back(engineTime / bareTime);
        threadRatios.push_back(engineThread / bareThread);
    }
    std::printf(
        "ratio engine / bare, CPU time of a frame at %dx%d: %.3f (%.3f ms / %.3f ms, medians of %d rounds of "
        "%d frames; round by round: process %.3f, calling thread %.3f)\n",
        width, height, median(engine) / median(bare), median(engine) * 1e3, median(bare) * 1e3, rounds,
        frames, median(ratios), median(threadRatios));
}

void printCalls(Pair& pair) {
    const auto engine = pair.engine.calls();
    const auto bare = pair.bare.calls();
    for (const auto& [name, count] : engine)
        std::printf("  %-26s %3d engine\n", name.c_str(), static_cast<int>(count));
    for (const auto& [name, count] : bare)
        std::printf("  %-26s %3d bare\n", name.c_str(), static_cast<int>(count));
    std::printf("ratio engine / bare, GL calls of a frame: %.3f (%d / %d)\n",
                static_cast<double>(sumOf(engine)) / static_cast<double>(sumOf(bare)),
                static_cast<int>(sumOf(engine)), static_cast<int>(sumOf(bare)));
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    struct Setup {
        int width, height, rounds, frames;
        std::unique_ptr<Pair> pair;
    };
    std::vector<Setup> setups;
    setups.push_back({640, 480, 21, 2, std::make_unique<Pair>(640, 480)});
    setups.push_back({64, 48, 41, 15, std::make_unique<Pair>(64, 48)});
    for (Setup& setup : setups) {
        const auto add = [&](const char* name, auto& contender) {
            benchmark::RegisterBenchmark(fmt::format("{}, {}x{}", name, setup.width, setup.height).c_str(),
                                         [&contender](benchmark::State& state) {
                                             contender.enter();
                                             for (auto _ : state)
                                                 contender.frame();
                                         })
                ->Unit(benchmark::kMillisecond)
                ->MeasureProcessCPUTime();
        };
        add("bare", setup.pair->bare);
        add("engine", setup.pair->engine);
    }
    benchmark::RunSpecifiedBenchmarks();
    printCalls(*setups.front().pair);
    for (Setup& setup : setups)
        compare(*setup.pair, setup.width, setup.height, setup.rounds, setup.frames);
}

// How long importScene takes on an OBJ of a million triangles, beside tinyobjloader's parsing alone.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "base/check.h"
#include "scene/import.h"
#include "wavy_surface.h"

using quincunx::bench::parseByTinyobj;
using quincunx::bench::WavySurface;

namespace {

namespace fs = std::filesystem;

void byUs(const fs::path& path) {
    const quincunx::ImportedScene imported = quincunx::importScene(path);
    const quincunx::Bounds bounds = imported.scene.bounds();
    benchmark::DoNotOptimize(bounds.radius());
    QX_CHECK_EQ(imported.scene.triangleCount(), WavySurface::triangleCount);
}

template <typename Load>
double medianSeconds(const Load& load, const fs::path& path) {
    std::vector<double> seconds;
    for (int run = 0; run < 5; ++run) {
        const auto start = std::chrono::steady_clock::now();
        load(path);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[2];
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    const WavySurface plain(false);
    const WavySurface full(true);
    for (const auto& [name, model] : {std::pair{"positions only, normals made", &plain},
                                      std::pair{"with normals and texture coordinates", &full}}) {
        const fs::path path = model->path();
        benchmark::RegisterBenchmark(fmt::format("tinyobjloader alone, {}", name).c_str(),
                                     [path](benchmark::State& state) {
                                         for (auto _ : state)
                                             parseByTinyobj(path);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
        benchmark::RegisterBenchmark(fmt::format("importScene, {}", name).c_str(),
                                     [path](benchmark::State& state) {
                                         for (auto _ : state)
                                             byUs(path);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    }
    benchmark::RunSpecifiedBenchmarks();
    for (const auto& [name, model] : {std::pair{"positions only, normals made", &plain},
                                      std::pair{"with normals and texture coordinates", &full}}) {
        const double tinyobj = medianSeconds(parseByTinyobj, model->path());
        const double ours = medianSeconds(byUs, model->path());
        std::printf("ratio importScene / tinyobjloader alone, %s: %.3f (%.0f ms / %.0f ms, medians of 5)\n",
                    name, ours / tinyobj, ours * 1e3, tinyobj * 1e3);
    }
}

// Constructed solids: all crossings of a ray by the textbook's arithmetic in float, with a tolerance, and by
// the form that decides exactly and allocates nothing.

#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "math/stress_inputs.h"
#include "ratio_reporter.h"
#include "trace/csg.h"

namespace {

using namespace quincunx;

struct Named {
    const char* name;
    Csg csg;
};

std::vector<Named> solids() {
    const Csg cube = Csg::box({{-1, -1, -1}, {1, 1, 1}});
    const Csg hole = Csg::cylinder({{0, 0, -1}, {0, 0, 2}, 0.5f});  // ends in the cube's faces
    return {{"lens", intersect(Csg::ball({{0, 0, -0.5f}, 1}), Csg::ball({{0, 0, 0.5f}, 1}))},
            {"rounded_cube", intersect(cube, Csg::ball({{0, 0, 0}, 1.3f}))},
            {"drilled_cube", subtract(cube, hole)},
            {"plugged_cube", unite(subtract(cube, hole), hole)}};
}

std::vector<Ray> rays() {
    StressInputs input(1);
    std::vector<Ray> all;
    for (int i = 0; i < 4096; ++i) {
        const glm::dvec3 d = input.direction();
        all.push_back({glm::vec3(-4.0 * d + 0.9 * input.random().uniformDouble() * input.perpendicular(d)),
                       glm::vec3(d)});
    }
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<Ray> all = rays();
    for (const Named& named : solids()) {
        benchmark::RegisterBenchmark(
            (std::string(named.name) + "/naive").c_str(), [&all, csg = named.csg](benchmark::State& state) {
                for (auto _ : state)
                    for (const Ray& ray : all)
                        benchmark::DoNotOptimize(csgCrossingsNaive(csg, ray, 1e-6f));
                state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.size()));
            });
        benchmark::RegisterBenchmark(
            (std::string(named.name) + "/stable").c_str(), [&all, csg = named.csg](benchmark::State& state) {
                const CsgSolid solid(csg);
                CsgScratch scratch;
                for (auto _ : state)
                    for (const Ray& ray : all)
                        benchmark::DoNotOptimize(solid.crossings(ray, scratch).data());
                state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.size()));
            });
    }
    benchmark::Initialize(&argc, argv);
    quincunx::RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
}

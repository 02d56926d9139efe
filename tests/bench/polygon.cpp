// What exactness costs: orientations, points in polygons, and rays against polygons, each beside its textbook
// form, with the ratio of their times.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/polygon_tests.h"
#include "geometry/predicates.h"
#include "math/stress_inputs.h"
#include "ratio_reporter.h"

namespace {

using namespace quincunx;

constexpr std::size_t count = 4096;
constexpr std::size_t corners = 8;

struct Inputs {
    std::vector<glm::vec2> points;
    std::vector<glm::vec3> places;
    std::vector<Ray> rays;  ///< at the polygon's plane, half of them hit
    std::vector<glm::vec2> convex;
    std::vector<glm::vec2> star;
    std::vector<glm::vec3> flat;
    Parallelogram quad{{-1, -1, 0}, {2, 0, 0.25f}, {0.25f, 2, 0}};
};

const Inputs& inputs() {
    static const Inputs filled = [] {
        Inputs in;
        StressInputs draw(1);
        for (std::size_t i = 0; i < count + 3; ++i) {
            in.points.emplace_back(draw.random().uniform(-1.2, 1.2), draw.random().uniform(-1.2, 1.2));
            in.places.emplace_back(2.0 * draw.direction());
            const glm::vec3 origin(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1), 4);
            in.rays.push_back({origin, glm::vec3(in.points.back(), 0) - origin});
        }
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = 2 * 3.141592653589793 * static_cast<double>(i) / corners;
            const double radius = i % 2 == 0 ? 1 : 0.4;
            in.convex.emplace_back(std::cos(angle), std::sin(angle));
            in.star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
            in.flat.emplace_back(in.star.back(), 0);
        }
        return in;
    }();
    return filled;
}

/// Registers "routine/naive" and "routine/stable": `compute(i)` for the whole of the arrays.
template <typename Naive, typename Stable>
void pairOf(const std::string& routine, const Naive& naive, const Stable& stable) {
    const auto over = [](const auto& compute) {
        return [compute](benchmark::State& state) {
            std::vector<float> out(count);
            for (auto _ : state) {
                for (std::size_t i = 0; i < count; ++i)
                    out[i] = static_cast<float>(compute(i));
                benchmark::DoNotOptimize(out.data());
                benchmark::ClobberMemory();
            }
            state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
        };
    };
    benchmark::RegisterBenchmark((routine + "/naive").c_str(), over(naive));
    benchmark::RegisterBenchmark((routine + "/stable").c_str(), over(stable));
}

template <typename Hit>
double tOf(const Hit& hit) {
    return hit ? hit->t : -1;
}

}  // namespace

int main(int argc, char** argv) {
    const Inputs& in = inputs();
    const auto& p = in.points;
    const auto& q = in.places;
    pairOf(
        "orientation 2D",
        [&](std::size_t i) { return detail::signOf(orientationNaive(p[i], p[i + 1], p[i + 2])); },
        [&](std::size_t i) { return orientation(p[i], p[i + 1], p[i + 2]); });
    pairOf(
        "orientation 3D",
        [&](std::size_t i) { return detail::signOf(orientationNaive(q[i], q[i + 1], q[i + 2], q[i + 3])); },
        [&](std::size_t i) { return orientation(q[i], q[i + 1], q[i + 2], q[i + 3]); });
    pairOf(
        "sideOfLine",
        [&](std::size_t i) { return detail::signOf(sideOfLineNaive(q[i], q[i + 1], q[i + 2], q[i + 3])); },
        [&](std::size_t i) { return sideOfLine(q[i], q[i + 1], q[i + 2], q[i + 3]); });
    pairOf(
        "facingAlong",
        [&](std::size_t i) { return static_cast<int>(facingAlongNaive(q[i], q[i + 1], q[i + 2], q[i + 3])); },
        [&](std::size_t i) { return static_cast<int>(facingAlong(q[i], q[i + 1], q[i + 2], q[i + 3])); });
    pairOf(
        "locate (crossings)", [&](std::size_t i) { return insideByCrossingsNaive(p[i], in.star); },
        [&](std::size_t i) { return static_cast<int>(locate(p[i], in.star)); });
    pairOf(
        "containsHalfOpen", [&](std::size_t i) { return insideByCrossingsNaive(p[i], in.star); },
        [&](std::size_t i) { return containsHalfOpen(p[i], in.star); });
    pairOf(
        "windingNumber (angles)", [&](std::size_t i) { return insideByAngleSumNaive(p[i], in.star); },
        [&](std::size_t i) { return windingNumber(p[i], in.star).value_or(0); });
    pairOf(
        "locateByTriangleFan", [&](std::size_t i) { return insideByTriangleFanNaive(p[i], in.star); },
        [&](std::size_t i) { return static_cast<int>(locateByTriangleFan(p[i], in.star)); });
    pairOf(
        "locateInConvex (areas)", [&](std::size_t i) { return insideByAreasNaive(p[i], in.convex); },
        [&](std::size_t i) { return static_cast<int>(locateInConvex(p[i], in.convex)); });
    pairOf(
        "locateInConvex (lines)", [&](std::size_t i) { return insideByPlueckerNaive(p[i], in.convex); },
        [&](std::size_t i) { return static_cast<int>(locateInConvex(p[i], in.convex)); });
    pairOf(
        "locateInConvex (cross)", [&](std::size_t i) { return insideByCrossProductsNaive(p[i], in.convex); },
        [&](std::size_t i) { return static_cast<int>(locateInConvex(p[i], in.convex)); });
    pairOf(
        "intersectPolygon", [&](std::size_t i) { return tOf(intersectPolygonNaive(in.rays[i], in.flat)); },
        [&](std::size_t i) { return tOf(intersectPolygon(in.rays[i], in.flat)); });
    pairOf(
        "intersectParallelogram",
        [&](std::size_t i) { return tOf(intersectParallelogramNaive(in.rays[i], in.quad)); },
        [&](std::size_t i) { return tOf(intersectParallelogram(in.rays[i], in.quad)); });

    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}

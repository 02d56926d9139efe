// What exactness costs: the intersections but for triangles (ray_triangle.cpp), each beside its textbook
// form, with the ratio of their times; and the packed ones beside what the machine's vector units allow for
// their operations.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "base/vector_units.h"
#include "geometry/overlap.h"
#include "geometry/ray_shapes.h"
#include "geometry/ray_shapes_packed.h"
#include "math/quadratic.h"
#include "math/stress_inputs.h"
#include "ratio_reporter.h"

namespace {

using namespace quincunx;

constexpr std::size_t count = 4096;

struct Inputs {
    std::vector<Ray> rays;  ///< towards the origin, half of them hit something of size 1
    std::vector<Ball> balls;
    std::vector<Bounds> boxes;
    std::vector<Plane> planes;
    std::vector<glm::vec3> coefficients;
    RayArrays packedRays;
    BallArrays packedBalls;
    BoxArrays packedBoxes;
};

const Inputs& inputs() {
    static const Inputs filled = [] {
        Inputs in;
        StressInputs draw(1);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 origin(8.0 * draw.direction());
            const glm::vec3 aim(1.4 * draw.direction());
            const Ray ray{origin, aim - origin};
            const glm::vec3 place(0.3 * draw.direction());
            in.rays.push_back(ray);
            in.balls.push_back({place, static_cast<float>(draw.random().uniform(0.5, 1.2))});
            in.boxes.push_back({place - 0.8f, place + 0.8f});
            in.planes.push_back(
                {draw.vectorOfMagnitude(-2, 2), static_cast<float>(draw.random().uniform(-1, 1))});
            in.coefficients.emplace_back(draw.random().uniform(-1, 1), draw.random().uniform(-3, 3),
                                         draw.random().uniform(-1, 1));
            in.packedRays.add(ray);
            in.packedBalls.add(in.balls.back());
            in.packedBoxes.add(in.boxes.back());
        }
        return in;
    }();
    return filled;
}

/// Registers "routine/naive" and "routine/stable": `compute(i)` for the whole of the arrays.
template <typename Result, typename Naive, typename Stable>
void pairOf(const std::string& routine, const Naive& naive, const Stable& stable) {
    const auto over = [](const auto& compute) {
        return [compute](benchmark::State& state) {
            std::vector<Result> out(count);
            for (auto _ : state) {
                for (std::size_t i = 0; i < count; ++i)
                    out[i] = static_cast<Result>(compute(i));
                benchmark::DoNotOptimize(out.data());
                benchmark::ClobberMemory();
            }
            state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
        };
    };
    benchmark::RegisterBenchmark((routine + "/naive").c_str(), over(naive));
    benchmark::RegisterBenchmark((routine + "/stable").c_str(), over(stable));
}

void registerScalar() {
    const Inputs& in = inputs();
    const Cylinder cylinder{{0, 0, 0}, {0, 0, 1}, 1};
    pairOf<float>(
        "raySphere", [&](std::size_t i) { return raySphereNaive(in.rays[i], in.balls[i]).value_or(-1); },
        [&](std::size_t i) { return raySphereDistance(in.rays[i], in.balls[i]).value_or(-1); });
    pairOf<float>(
        "rayCylinder", [&](std::size_t i) { return rayCylinderNaive(in.rays[i], 1).value_or(-1); },
        [&, cylinder](std::size_t i) { return rayCylinderDistance(in.rays[i], cylinder).value_or(-1); });
    pairOf<float>(
        "rayCappedCylinder",
        [&](std::size_t i) { return rayCappedCylinderNaive(in.rays[i], 1, 1).value_or(-1); },
        [&, cylinder](std::size_t i) {
            return rayCappedCylinderDistance(in.rays[i], cylinder).value_or(-1);
        });
    pairOf<float>(
        "rayPlane", [&](std::size_t i) { return rayPlaneNaive(in.rays[i], in.planes[i]).value_or(-1); },
        [&](std::size_t i) { return rayPlaneDistance(in.rays[i], in.planes[i]).value_or(-1); });
    pairOf<float>(
        "rayBox",
        [&](std::size_t i) {
            return rayBoxNaive(in.rays[i], in.boxes[i]).value_or(RaySpan{-1, 0}).enter;
        },
        [&](std::size_t i) {
            return rayBox(in.rays[i], in.boxes[i]).value_or(RaySpan{-1, 0}).enter;
        });
    pairOf<char>(
        "sphereSphere",
        [&](std::size_t i) { return ballsOverlapNaive(in.balls[i], in.balls[count - 1 - i]); },
        [&](std::size_t i) { return ballsOverlap(in.balls[i], in.balls[count - 1 - i]); });
    pairOf<char>(
        "spherePlane", [&](std::size_t i) { return ballMeetsPlaneNaive(in.balls[i], in.planes[i]); },
        [&](std::size_t i) { return sideOf(in.balls[i], in.planes[i]) == Side::crossing; });
    pairOf<char>(
        "boxPlane", [&](std::size_t i) { return boxMeetsPlaneNaive(in.boxes[i], in.planes[i]); },
        [&](std::size_t i) { return sideOf(in.boxes[i], in.planes[i]) == Side::crossing; });
    pairOf<float>(
        "quadratic",
        [&](std::size_t i) {
            const glm::vec3& k = in.coefficients[i];
            const QuadraticRootsNaive roots = solveQuadraticNaive(k.x, k.y, k.z);
            return roots.first + roots.second;
        },
        [&](std::size_t i) {
            const glm::vec3& k = in.coefficients[i];
            const QuadraticRoots roots = solveQuadratic(k.x, k.y, k.z);
            return roots.first + roots.second;
        });
}

/// Nanoseconds an item: the fastest of many runs, since other programs only ever add time.
double nanoseconds(std::size_t items, const std::function<void()>& run) {
    double best = 1e30;
    for (int repeat = 0; repeat < 400; ++repeat) {
        const auto start = std::chrono::steady_clock::now();
        run();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / static_cast<double>(items));
    }
    return best;
}

// What the vector units allow: operations of a kind without memory, on values that do not wait for each
// other.

QUINCUNX_FOR_EACH_VECTOR_UNIT
void sumsAndProducts(float* __restrict x) {
    for (std::size_t i = 0; i < 1024; ++i) {
        float a = x[i];
        float b = a + 1;
        float c = a + 2;
        float d = a + 3;
        for (int k = 0; k < 8; ++k) {
            a = a * 0.999f + 0.25f;
            b = b * 0.998f + 0.5f;
            c = c * 0.997f + 0.125f;
            d = d * 0.996f + 0.75f;
        }
        x[i] = (a + b) + (c + d);
    }
}
constexpr double sumsPerLane = 8 * 8 + 6;

QUINCUNX_FOR_EACH_VECTOR_UNIT
void comparisons(float* __restrict x) {
    for (std::size_t i = 0; i < 1024; ++i) {
        const float a = x[i];
        const float b = a + 1;
        const float c = a + 2;
        float least = b;
        for (int k = 0; k < 16; ++k) {
            const float chosen = a < static_cast<float>(k) * 0.0625f ? b : c;
            least = chosen < least ? chosen : least;
        }
        x[i] = least;
    }
}
constexpr double comparisonsPerLane = 16 * 3;

QUINCUNX_FOR_EACH_VECTOR_UNIT
void divisions(float* __restrict x) {
    for (std::size_t i = 0; i < 1024; ++i) {
        const float a = x[i] + 2;
        x[i] = 1 / a + 1 / (a + 1) + 1 / (a + 2) + 1 / (a + 3);
    }
}
constexpr double divisionsPerLane = 4;

/// Nanoseconds an operation.
double nanosecondsOf(void (*kernel)(float*), double perLane) {
    std::vector<float> x(1024, 0.5f);
    return nanoseconds(1024,
                       [&] {
                           kernel(x.data());
                           benchmark::DoNotOptimize(x.data());
                       }) /
           perLane;
}

/// Operations of one pair in the stable form, counted in its source; what one ray or shape gives for all
/// pairs is not counted.
struct Packed {
    const char* name;
    double sums;         ///< and differences, products, magnitudes
    double comparisons;  ///< selections, minima, maxima, and what joins comparisons
    double divisions;    ///< and square roots
    std::function<void(std::span<float>)> naive;
    std::function<void(std::span<float>)> stable;
};

void printPacked() {
    const Inputs& in = inputs();
    std::vector<float> t(count);
    const double sum = nanosecondsOf(&sumsAndProducts, sumsPerLane);
    const double comparison = nanosecondsOf(&comparisons, comparisonsPerLane);
    const double division = nanosecondsOf(&divisions, divisionsPerLane);
    std::printf(
        "\nthis machine's vector units, a ns: %.1f sums or products, %.1f comparisons or selections, "
        "%.2f divisions or roots\n",
        1 / sum, 1 / comparison, 1 / division);
    const Ray ray = in.rays[0];
    const std::vector<Packed> table{
        {"rays, one sphere", 69, 23, 2,
         [&](auto out) { intersectPackedNaive(in.packedRays, in.balls[0], out); },
         [&](auto out) { intersectPacked(in.packedRays, in.balls[0], out); }},
        {"ray, many spheres", 61, 22, 1, [&](auto out) { intersectPackedNaive(ray, in.packedBalls, out); },
         [&](auto out) { intersectPacked(ray, in.packedBalls, out); }},
        {"rays, one box", 24, 38, 3, [&](auto out) { intersectPackedNaive(in.packedRays, in.boxes[0], out); },
         [&](auto out) { intersectPacked(in.packedRays, in.boxes[0], out); }},
        {"ray, many boxes", 17, 30, 0, [&](auto out) { intersectPackedNaive(ray, in.packedBoxes, out); },
         [&](auto out) { intersectPacked(ray, in.packedBoxes, out); }},
    };
    std::printf("%-20s %6s %8s %9s %10s %9s %9s %11s %13s\n", "packed", "sums", "compares", "divisions",
                "allowed ns", "naive ns", "stable ns", "of allowed", "stable/naive");
    for (const Packed& row : table) {
        // Divisions have a unit of their own, beside which the others work on.
        const double allowed =
            std::max(row.sums * sum + row.comparisons * comparison, row.divisions * division);
        const double naive = nanoseconds(count, [&] { row.naive(t); });
        const double stable = nanoseconds(count, [&] { row.stable(t); });
        std::printf("%-20s %6.0f %8.0f %9.0f %10.3f %9.3f %9.3f %10.2fx %12.2fx\n", row.name, row.sums,
                    row.comparisons, row.divisions, allowed, naive, stable, stable / allowed, stable / naive);
    }
}

}  // namespace

int main(int argc, char** argv) {
    registerScalar();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    quincunx::RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    printPacked();
    return 0;
}

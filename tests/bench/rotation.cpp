// What exactness costs: the stable rotations on whole arrays, each beside GLM's, with the ratio of their
// times.

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/euler_angles.hpp>
#include <glm/gtx/quaternion.hpp>

#include "math/euler.h"
#include "math/quaternion.h"
#include "math/rotation_hard_cases.h"
#include "math/rotation_interpolation.h"

namespace {

using namespace quincunx;
using glm::quat;
using glm::vec3;

struct Item {
    quat a;
    quat b;
    vec3 p;
    vec3 axis;
    float t;
    glm::mat3 m;
};

const std::vector<Item>& items() {
    static const std::vector<Item> filled = [] {
        std::vector<Item> made;
        StressInputs draw(1);
        for (int i = 0; i < 2048; ++i) {
            const glm::dquat a = randomRotation(draw);
            made.push_back({quat(a), quat(randomRotation(draw)), draw.unitVector(), draw.unitVector(),
                            draw.random().uniform(), glm::mat3(glm::mat3_cast(a))});
        }
        return made;
    }();
    return filled;
}

/// Writes `compute(item)` for the whole array.
template <typename Result, typename Compute>
void overItems(benchmark::State& state, const Compute& compute) {
    const std::vector<Item>& in = items();
    std::vector<Result> out(in.size());
    for (auto _ : state) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = compute(in[i]);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * out.size()));
}

/// Registers "routine/glm", "routine/naive" and "routine/ours".
template <typename Result, typename Peer, typename Naive, typename Ours>
void compare(const std::string& routine, const Peer& peer, const Naive& naive, const Ours& ours) {
    benchmark::RegisterBenchmark((routine + "/naive").c_str(),
                                 [naive](benchmark::State& state) { overItems<Result>(state, naive); });
    benchmark::RegisterBenchmark((routine + "/glm").c_str(),
                                 [peer](benchmark::State& state) { overItems<Result>(state, peer); });
    benchmark::RegisterBenchmark((routine + "/ours").c_str(),
                                 [ours](benchmark::State& state) { overItems<Result>(state, ours); });
}

/// The usual table, then one line a routine with the ratio.
class RatioReporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
            if (run.error_occurred || (run.run_type == Run::RT_Aggregate && !median))
                continue;
            const std::string name = run.run_name.function_name;
            const auto perItem = 1e9 / run.counters.at("items_per_second");
            const std::string routine = name.substr(0, name.find('/'));
            Times& times = times_[routine];
            (name.ends_with("/glm")     ? times.glm
             : name.ends_with("/naive") ? times.naive
                                        : times.ours) = perItem;
        }
    }

    void printRatios() const {
        std::printf("\n%-26s %8s %9s %8s %9s %11s\n", "routine", "glm ns", "naive ns", "ours ns", "ours/glm",
                    "ours/naive");
        for (const auto& [routine, time] : times_)
            std::printf("%-26s %8.2f %9.2f %8.2f %8.2fx %10.2fx\n", routine.c_str(), time.glm, time.naive,
                        time.ours, time.ours / time.glm, time.ours / time.naive);
    }

  private:
    struct Times {
        double glm = 0;
        double naive = 0;
        double ours = 0;
    };
    std::map<std::string, Times> times_;
};

}  // namespace

int main(int argc, char** argv) {
    const quat none(1, 0, 0, 0);
    compare<quat>(
        "normalize", [](const Item& i) { return glm::normalize(i.a); },
        [](const Item& i) { return normalizeNaive(i.a); },
        [none](const Item& i) { return normalize(i.a).value_or(none); });
    compare<quat>(
        "product", [](const Item& i) { return i.a * i.b; },
        [](const Item& i) { return productNaive(i.a, i.b); },
        [](const Item& i) { return product(i.a, i.b); });
    compare<quat>(
        "compose", [](const Item& i) { return glm::normalize(i.a * i.b); },
        [](const Item& i) { return normalizeNaive(productNaive(i.a, i.b)); },
        [none](const Item& i) { return compose(i.a, i.b).value_or(none); });
    compare<quat>(
        "inverse", [](const Item& i) { return glm::inverse(i.a); },
        [](const Item& i) { return inverseNaive(i.a); },
        [none](const Item& i) { return inverse(i.a).value_or(none); });
    compare<vec3>(
        "rotate", [](const Item& i) { return i.a * i.p; },
        [](const Item& i) { return rotateNaive(i.a, i.p); },
        [](const Item& i) { return rotate(i.a, i.p).value_or(vec3(0)); });
    compare<glm::mat3>(
        "matrixFromQuaternion", [](const Item& i) { return glm::mat3_cast(i.a); },
        [](const Item& i) { return matrixFromQuaternionNaive(i.a); },
        [](const Item& i) { return matrixFromQuaternion(i.a).value_or(glm::mat3(1)); });
    compare<quat>(
        "quaternionFromMatrix", [](const Item& i) { return glm::quat_cast(i.m); },
        [](const Item& i) { return quaternionFromMatrixNaive(i.m); },
        [none](const Item& i) { return quaternionFromMatrix(i.m).value_or(none); });
    compare<quat>(
        "quaternionFromAxisAngle",
        [](const Item& i) { return glm::angleAxis(6 * i.t, glm::normalize(i.axis)); },
        [](const Item& i) { return quaternionFromAxisAngleNaive(i.axis, 6 * i.t); },
        [none](const Item& i) { return quaternionFromAxisAngle(i.axis, 6 * i.t).value_or(none); });
    compare<glm::vec4>(
        "axisAngleFromQuaternion", [](const Item& i) { return glm::vec4(glm::axis(i.a), glm::angle(i.a)); },
        [](const Item& i) {
            const AxisAngle turn = axisAngleFromQuaternionNaive(i.a);
            return glm::vec4(turn.axis, turn.radians);
        },
        [](const Item& i) {
            const AxisAngle turn = axisAngleFromQuaternion(i.a).value_or(AxisAngle{});
            return glm::vec4(turn.axis, turn.radians);
        });
    compare<vec3>(
        "rotateAboutAxis",
        [](const Item& i) { return vec3(glm::rotate(glm::mat4(1), 6 * i.t, i.axis) * glm::vec4(i.p, 0)); },
        [](const Item& i) { return rotateAboutAxisNaive(i.p, i.axis, 6 * i.t); },
        [](const Item& i) { return rotateAboutAxis(i.p, i.axis, 6 * i.t).value_or(vec3(0)); });
    compare<quat>(
        "shortestArc", [](const Item& i) { return glm::rotation(i.p, i.axis); },
        [](const Item& i) { return shortestArcNaive(i.p, i.axis); },
        [none](const Item& i) { return shortestArc(i.p, i.axis).value_or(none); });
    compare<quat>(
        "slerp", [](const Item& i) { return glm::slerp(i.a, i.b, i.t); },
        [](const Item& i) { return slerpNearerNaive(i.a, i.b, i.t); },
        [none](const Item& i) { return slerp(i.a, i.b, i.t).value_or(none); });
    compare<quat>(
        "nlerp", [](const Item& i) { return glm::normalize(glm::lerp(i.a, i.b, i.t)); },
        [](const Item& i) { return nlerpNaive(i.a, i.b, i.t); },
        [none](const Item& i) { return nlerp(i.a, i.b, i.t).value_or(none); });
    compare<glm::mat3>(
        "matrixFromEuler",
        [](const Item& i) { return glm::mat3(glm::eulerAngleZXY(6 * i.t, 2 * i.p.x, 3 * i.p.y)); },
        [](const Item& i) {
            return matrixFromEulerNaive({3 * i.p.y, 2 * i.p.x, 6 * i.t}, EulerOrder::zxy);
        },
        [](const Item& i) {
            return matrixFromEuler({3 * i.p.y, 2 * i.p.x, 6 * i.t}, EulerOrder::zxy).value_or(glm::mat3(1));
        });
    compare<vec3>(
        "eulerFromQuaternion",
        [](const Item& i) {
            vec3 angles;
            glm::extractEulerAngleZXY(glm::mat4_cast(i.a), angles.x, angles.y, angles.z);
            return angles;
        },
        [](const Item& i) {
            const EulerAngles angles = eulerFromMatrixNaive(matrixFromQuaternionNaive(i.a), EulerOrder::zxy);
            return vec3(angles.head, angles.pitch, angles.roll);
        },
        [](const Item& i) {
            const EulerAngles angles = eulerFromQuaternion(i.a, EulerOrder::zxy).value_or(EulerAngles{});
            return vec3(angles.head, angles.pitch, angles.roll);
        });

    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}

// What exactness costs: the stable routines on whole arrays, each beside the textbook's formula in float as
// GLM has it, with the ratio of their times. `normalize` stands beside the division by the length as well,
// since GLM multiplies by a reciprocal that adds an error of its own.

#include "math/vector.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "math/projection.h"
#include "math/spaces.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/trs.h"

namespace {

using namespace quincunx;

struct Arrays {
    std::vector<glm::vec3> a;
    std::vector<glm::vec3> b;
    std::vector<glm::mat4> models;
};

const Arrays& arrays() {
    static const Arrays filled = [] {
        Arrays made;
        StressInputs draw(1);
        for (int i = 0; i < 4096; ++i) {
            made.a.push_back(draw.unitVector());
            made.b.push_back(draw.unitVector());
        }
        for (int i = 0; i < 256; ++i) {
            glm::mat4 model{glm::mat3(draw.magnitude(-2, 2) * draw.rotation())};
            model[3] = glm::vec4(draw.vectorOfMagnitude(-3, 3), 1);
            made.models.push_back(model);
        }
        return made;
    }();
    return filled;
}

/// Writes `compute(a, b)` for the whole of two arrays.
template <typename Result, typename Compute>
void overPairs(benchmark::State& state, const Compute& compute) {
    const Arrays& in = arrays();
    std::vector<Result> out(in.a.size());
    for (auto _ : state) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = compute(in.a[i], in.b[i]);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * out.size()));
}

template <typename Result, typename Compute>
void overModels(benchmark::State& state, const Compute& compute) {
    const Arrays& in = arrays();
    std::vector<Result> out(in.models.size());
    for (auto _ : state) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = compute(in.models[i]);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * out.size()));
}

/// Registers "routine/naive" and "routine/stable".
template <typename Result, typename Naive, typename Stable>
void pairsOf(const std::string& routine, const Naive& naive, const Stable& stable) {
    benchmark::RegisterBenchmark((routine + "/naive").c_str(),
                                 [naive](benchmark::State& state) { overPairs<Result>(state, naive); });
    benchmark::RegisterBenchmark((routine + "/stable").c_str(),
                                 [stable](benchmark::State& state) { overPairs<Result>(state, stable); });
}

template <typename Result, typename Naive, typename Stable>
void modelsOf(const std::string& routine, const Naive& naive, const Stable& stable) {
    benchmark::RegisterBenchmark((routine + "/naive").c_str(),
                                 [naive](benchmark::State& state) { overModels<Result>(state, naive); });
    benchmark::RegisterBenchmark((routine + "/stable").c_str(),
                                 [stable](benchmark::State& state) { overModels<Result>(state, stable); });
}

/// A perspective of what a placed eye sees.
glm::mat4 projectionOf(const glm::mat4& worldFromEye) {
    static const glm::mat4 clipFromEye = perspective(1.0f, 1.5f, 0.1f, 100.0f);
    return clipFromEye * worldFromEye;
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
            (name.ends_with("/naive") ? times_[name.substr(0, name.find('/'))].first
                                      : times_[name.substr(0, name.find('/'))].second) = perItem;
        }
    }

    void printRatios() const {
        std::printf("\n%-24s %10s %10s %8s\n", "routine", "naive ns", "stable ns", "ratio");
        for (const auto& [routine, time] : times_)
            std::printf("%-24s %10.2f %10.2f %7.2fx\n", routine.c_str(), time.first, time.second,
                        time.second / time.first);
    }

  private:
    std::map<std::string, std::pair<double, double>> times_;
};

}  // namespace

int main(int argc, char** argv) {
    using glm::vec3;
    pairsOf<vec3>(
        "normalize", [](vec3 a, vec3) { return glm::normalize(a); },
        [](vec3 a, vec3) { return normalizeOr(a, vec3(0)); });
    pairsOf<vec3>(
        "normalize (division)", [](vec3 a, vec3) { return a / std::sqrt(glm::dot(a, a)); },
        [](vec3 a, vec3) { return normalizeOr(a, vec3(0)); });
    pairsOf<vec3>(
        "normalizePrescaled", [](vec3 a, vec3) { return glm::normalize(a); },
        [](vec3 a, vec3) { return normalizePrescaled(a).value_or(vec3(0)); });
    pairsOf<float>(
        "length", [](vec3 a, vec3) { return glm::length(a); }, [](vec3 a, vec3) { return length(a); });
    pairsOf<float>(
        "dot", [](vec3 a, vec3 b) { return glm::dot(a, b); }, [](vec3 a, vec3 b) { return dot(a, b); });
    pairsOf<vec3>(
        "cross", [](vec3 a, vec3 b) { return glm::cross(a, b); }, [](vec3 a, vec3 b) { return cross(a, b); });
    pairsOf<float>(
        "angleBetween", [](vec3 a, vec3 b) { return std::acos(glm::dot(a, b)); },
        [](vec3 a, vec3 b) { return angleBetween(a, b).value_or(0); });
    pairsOf<vec3>(
        "reflect", [](vec3 a, vec3 b) { return glm::reflect(a, glm::normalize(b)); },
        [](vec3 a, vec3 b) { return reflect(a, b).value_or(vec3(0)); });
    pairsOf<vec3>(
        "halfVector", [](vec3 a, vec3 b) { return glm::normalize(a + b); },
        [](vec3 a, vec3 b) { return halfVector(a, b).value_or(vec3(0)); });
    pairsOf<float>(
        "cosinePower", [](vec3 a, vec3 b) { return std::pow(std::max(glm::dot(a, b), 0.0f), 32.0f); },
        [](vec3 a, vec3 b) { return cosinePower(a, b, 32.0f); });
    pairsOf<glm::mat4>(
        "lookAt", [](vec3 a, vec3 b) { return glm::lookAt(a, b, vec3(0, 1, 0)); },
        [](vec3 a, vec3 b) { return cameraFromWorld(lookAt(a, b, vec3(0, 1, 0))); });
    pairsOf<glm::mat4>(
        "perspective", [](vec3 a, vec3) { return glm::perspective(2 + a.x, 1.5f, 0.1f, 100.0f); },
        [](vec3 a, vec3) { return perspective(2 + a.x, 1.5f, 0.1f, 100.0f); });
    modelsOf<glm::mat3>(
        "normalMatrix", [](const glm::mat4& m) { return glm::inverseTranspose(glm::mat3(m)); },
        [](const glm::mat4& m) { return normalMatrix(m); });
    modelsOf<glm::mat4>(
        "inverse", [](const glm::mat4& m) { return glm::inverse(m); },
        [](const glm::mat4& m) { return inverse(m).value_or(glm::mat4(0)); });

    modelsOf<glm::mat4>(
        "inverseAffine", [](const glm::mat4& m) { return glm::affineInverse(m); },
        [](const glm::mat4& m) { return inverseAffine(m).value_or(glm::mat4(0)); });
    modelsOf<glm::mat4>(
        "inverseRigid",
        [](const glm::mat4& m) {
            const glm::mat3 transposed = glm::transpose(glm::mat3(m));
            glm::mat4 result{transposed};
            result[3] = glm::vec4(-(transposed * glm::vec3(m[3])), 1);
            return result;
        },
        [](const glm::mat4& m) { return inverseRigid(m); });
    modelsOf<glm::mat4>(
        "inverse (projection)", [](const glm::mat4& m) { return glm::inverse(projectionOf(m)); },
        [](const glm::mat4& m) { return inverse(projectionOf(m)).value_or(glm::mat4(0)); });
    modelsOf<Trs>(
        "decompose", [](const glm::mat4& m) { return decomposeNaive(m); },
        [](const glm::mat4& m) { return decompose(m).value_or(Trs{}); });
    pairsOf<vec3>(
        "homogenize",
        [](vec3 a, vec3 b) {
            const float reciprocal = 1 / b.x;
            return a * reciprocal;
        },
        [](vec3 a, vec3 b) { return homogenize(glm::vec4(a, b.x)).value; });
    modelsOf<glm::mat4>(
        "eyeFromModel", [](const glm::mat4& m) { return inverseRigidNaive(m) * m; },
        [](const glm::mat4& m) { return eyeFromModel(glm::dmat4(m), glm::dmat4(m)); });

    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}

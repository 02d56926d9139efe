// What stability costs in scattering and sampling: each routine on whole arrays beside the textbook's form in
// float, with the ratio of their times; then what one evaluation and one sample of each scattering model
// cost.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "math/stress_inputs.h"
#include "ratio_reporter.h"
#include "trace/bsdf.h"
#include "trace/fresnel.h"
#include "trace/light_sampling.h"
#include "trace/microfacet.h"
#include "trace/sample_patterns.h"
#include "trace/sampling.h"

namespace {

using namespace quincunx;
using glm::vec2;
using glm::vec3;

/// What a call may need: numbers, cosines, directions.
struct Input {
    vec3 a;
    vec3 b;
    vec3 above;
    vec2 uv;
    float cosine;
    float other;
    float eta;
};

const std::vector<Input>& inputs() {
    static const std::vector<Input> filled = [] {
        std::vector<Input> made(4096);
        StressInputs draw(1);
        for (Input& in : made) {
            in.a = draw.unitVector();
            in.b = draw.unitVector();
            in.above = draw.unitVector();
            in.above.z = std::abs(in.above.z);
            in.uv = vec2(draw.random().uniform(), draw.random().uniform());
            in.cosine = static_cast<float>(draw.random().uniform(0.01, 1));
            in.other = static_cast<float>(draw.random().uniform(0.01, 1));
            in.eta = static_cast<float>(draw.random().uniform(1.1, 2));
        }
        return made;
    }();
    return filled;
}

template <typename Compute>
void overInputs(benchmark::State& state, const Compute& compute) {
    using Result = decltype(compute(inputs().front()));
    std::vector<Result> out(inputs().size());
    for (auto _ : state) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = compute(inputs()[i]);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * out.size()));
}

/// Registers "routine/naive" and "routine/stable".
template <typename Naive, typename Stable>
void pairsOf(const std::string& routine, const Naive& naive, const Stable& stable) {
    benchmark::RegisterBenchmark((routine + "/naive").c_str(),
                                 [naive](benchmark::State& state) { overInputs(state, naive); });
    benchmark::RegisterBenchmark((routine + "/stable").c_str(),
                                 [stable](benchmark::State& state) { overInputs(state, stable); });
}

}  // namespace

int main(int argc, char** argv) {
    pairsOf(
        "fresnelDielectric", [](const Input& in) { return fresnelDielectricNaive(in.cosine, in.eta); },
        [](const Input& in) { return fresnelDielectric(in.cosine, in.eta); });
    pairsOf(
        "fresnelConductor",
        [](const Input& in) { return fresnelConductorNaive(in.cosine, in.eta, in.other); },
        [](const Input& in) { return fresnelConductor(in.cosine, in.eta, in.other); });
    pairsOf(
        "refract", [](const Input& in) { return refractNaive(in.a, in.b, in.eta).value_or(vec3(0)); },
        [](const Input& in) { return refract(in.a, in.b, in.eta).value_or(vec3(0)); });
    pairsOf(
        "ggxDistribution", [](const Input& in) { return ggxDistributionNaive(in.a, in.b, in.other); },
        [](const Input& in) { return ggxDistribution(in.a, in.b, in.other); });
    pairsOf(
        "smithVisibility", [](const Input& in) { return smithVisibilityNaive(in.cosine, in.other, in.uv.x); },
        [](const Input& in) { return smithVisibility(in.cosine, in.other, in.uv.x); });
    pairsOf(
        "sampleCosineHemisphere", [](const Input& in) { return sampleCosineHemisphereNaive(in.uv); },
        [](const Input& in) { return sampleCosineHemisphere(in.uv); });
    pairsOf(
        "sampleCone", [](const Input& in) { return sampleConeNaive(in.other, in.uv); },
        [](const Input& in) { return sampleCone(in.other, in.uv); });
    pairsOf(
        "coneOfSphere", [](const Input& in) { return coneOfSphereNaive(in.eta, in.other); },
        [](const Input& in) { return coneOfSphere(in.eta, in.other).value_or(0); });
    pairsOf(
        "solidAngle", [](const Input& in) { return solidAngleNaive(vec3(0), in.a, in.b, in.above); },
        [](const Input& in) { return static_cast<float>(solidAngle(vec3(0), in.a, in.b, in.above)); });
    pairsOf(
        "sampleSphericalTriangle",
        [](const Input& in) { return sampleSphericalTriangleNaive(vec3(0), in.a, in.b, in.above, in.uv); },
        [](const Input& in) { return sampleSphericalTriangle(vec3(0), in.a, in.b, in.above, in.uv); });
    pairsOf(
        "powerHeuristic", [](const Input& in) { return powerHeuristicNaive(in.cosine, in.other); },
        [](const Input& in) { return powerHeuristic(in.cosine, in.other); });
    pairsOf(
        "jitterCell",
        [](const Input& in) {
            return jitterCellNaive(static_cast<std::uint32_t>(99 * in.uv.x), 100, in.uv.y);
        },
        [](const Input& in) { return jitterCell(static_cast<std::uint32_t>(99 * in.uv.x), 100, in.uv.y); });
    pairsOf(
        "uniformBetween", [](const Input& in) { return uniformBetweenNaive(in.cosine, in.eta, in.other); },
        [](const Input& in) { return uniformBetween(in.cosine, in.eta, in.other); });
    pairsOf(
        "playRoulette",
        [](const Input& in) { return playRouletteNaive(vec3(in.cosine), in.uv.x).value_or(vec3(0)); },
        [](const Input& in) { return playRoulette(vec3(in.cosine), in.uv.x).value_or(vec3(0)); });
    pairsOf(
        "arriveFromPoint", [](const Input& in) { return arriveFromPointNaive(in.a, in.b); },
        [](const Input& in) { return arriveFromPoint(in.a, in.b); });
    pairsOf(
        "spotShare", [](const Input& in) { return spotShareNaive(in.a, in.b, 0.5f, 1.0f); },
        [](const Input& in) { return spotShare(in.a, in.b, 0.5f, 1.0f); });

    // Against a diffuse surface.
    const std::pair<const char*, Bsdf> models[] = {
        {"Phong", PhongBsdf{}},        {"Blinn-Phong", BlinnPhongBsdf{}},
        {"conductor", GgxConductor{}}, {"plastic", MetallicRoughness{}},
        {"glass", Dielectric{}},       {"rough glass", Dielectric{1.5f, 0.2f}}};
    for (const auto& [name, bsdf] : models) {
        const auto evaluateAndWeigh = [](const Bsdf& model) {
            return [model](const Input& in) {
                const vec3 wo(in.above);
                const vec3 wi(in.a.x, in.a.y, std::abs(in.a.z));
                return evaluateWithDensity(model, wo, wi);
            };
        };
        const auto sampleOnce = [](const Bsdf& model) {
            return [model](const Input& in) {
                return sample(model, in.above, in.other, in.uv).value_or(BsdfSample{});
            };
        };
        pairsOf(std::string("evaluate ") + name + " : Lambert", evaluateAndWeigh(Lambert{}),
                evaluateAndWeigh(bsdf));
        pairsOf(std::string("sample ") + name + " : Lambert", sampleOnce(Lambert{}), sampleOnce(bsdf));
    }

    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "labs/20_post_processing/lab.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "trace/tone_glsl.h"

namespace quincunx {
namespace {

/// |got − exact| / |exact|, infinite where `got` is not finite.
double relativeError(float got, Quad exact) {
    if (!std::isfinite(got))
        return std::numeric_limits<double>::infinity();
    return std::abs(static_cast<double>((Quad(got) - exact) / exact));
}

/// Light of 2^-120 … 2^127.
HardCaseFigures runFilmic(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto x = static_cast<float>(draw.magnitude(-120, 127));
        const Quad q = x;
        const auto constant = [](float f) { return Quad(f); };
        const Quad exact = (q * (constant(2.51f) * q + constant(0.03f))) /
                           (q * (constant(2.43f) * q + constant(0.59f)) + constant(0.14f));
        const float naive = (x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f);
        tally.add(relativeError(naive, exact), relativeError(glsl::filmicCurve(x), exact),
                  [&] { return fmt::format("x={:a}", x); });
    }
    return tally.figures();
}

/// Luminances of 2^-140 … 2^127 and whites of 2^-40 … 2^60.
HardCaseFigures runReinhard(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto l = static_cast<float>(draw.magnitude(-140, 127));
        const auto white = static_cast<float>(draw.magnitude(-40, 60));
        const Quad q = l;
        const Quad exact = (1 + q / (Quad(white) * Quad(white))) / (1 + q);
        const float naive = (1.0f + l / (white * white)) / (1.0f + l);
        tally.add(relativeError(naive, exact), relativeError(glsl::reinhardFactor(l, white), exact),
                  [&] { return fmt::format("l={:a} white={:a}", l, white); });
    }
    return tally.figures();
}

/// Blurs of 2^-7 … 2^5 pixels cut off at 1 … 6 deviations: how far the weights' sum is from 1. The textbook's
/// weights are the density 1/(σ√2π) exp(−x²/2σ²) at the texels.
HardCaseFigures runBlurWeights(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto sigma = static_cast<float>(draw.magnitude(-7, 5));
        const auto reach = static_cast<float>(draw.random().uniform(1, 6));
        const std::vector<float> weights = blurWeights(sigma, reach);
        double naive = 0;
        for (std::size_t x = 0; x < weights.size(); ++x) {
            const float place = static_cast<float>(x);
            const float density = std::exp(-place * place / (2 * sigma * sigma)) / (sigma * 2.5066283f);
            naive += (x == 0 ? 1 : 2) * static_cast<double>(density);
        }
        const double stable =
            2 * std::accumulate(weights.begin(), weights.end(), 0.0) - static_cast<double>(weights.front());
        tally.add(std::abs(naive - 1), std::abs(stable - 1),
                  [&] { return fmt::format("sigma={:a} reach={:a}", sigma, reach); });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> PostProcessingLab::hardCases() {
    // Eight roundings.
    return {
        {"filmicCurve", "light of 2^-120 … 2^127", "relative error", 8 * 0x1p-24,
         "divided by x² above 1, so that no square overflows", &runFilmic},
        // Six roundings: two reciprocals, a square, two sums, a quotient.
        {"reinhardFactor", "luminance 2^-140 … 2^127, white 2^-40 … 2^60", "relative error", 6 * 0x1p-24,
         "divided by l above 1", &runReinhard},
        // 2 · 129 weights, each rounded by 2^-25 of itself: of their sum, 1, at most.
        {"blurWeights", "deviations of 2^-7 … 2^5 pixels", "|sum − 1|", 0x1p-24,
         "divided by their sum in double, rounded once", &runBlurWeights},
    };
}

}  // namespace quincunx

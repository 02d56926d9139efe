#include "trace/microfacet.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "math/stress_inputs.h"
#include "tests/support/chi_square.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;

constexpr double pi = std::numbers::pi;

/// ∫ f over the upper hemisphere, with the slopes' length r = alpha tan s as variable, in which GGX's lobe is
/// the same for every alpha: cos⁻³ times a solid angle is an area of slopes.
double overHemisphere(double alpha, const std::function<double(const dvec3&)>& f) {
    constexpr int rings = 400;
    constexpr int turns = 64;
    double total = 0;
    for (int i = 0; i < rings; ++i) {
        const double s = (i + 0.5) / rings * 0.5 * pi;
        const double slope = alpha * std::tan(s);
        const double ring = alpha / (std::cos(s) * std::cos(s)) * (0.5 * pi / rings) * slope;
        const double cosine = 1 / std::sqrt(1 + slope * slope);
        for (int j = 0; j < turns; ++j) {
            const double angle = (j + 0.5) / turns * 2 * pi;
            total += ring * (2 * pi / turns) * cosine * cosine * cosine *
                     f(cosine * dvec3(slope * std::cos(angle), slope * std::sin(angle), 1));
        }
    }
    return total;
}

constexpr float alphas[] = {1e-4f, 1e-3f, 0.03f, 0.3f, 1};

// A microsurface covers the plane below it once.
TEST(GgxDistribution, HasAProjectedAreaOfOne) {
    for (const float alpha : alphas)
        EXPECT_NEAR(overHemisphere(alpha, [&](const dvec3& h) { return h.z * ggx::distribution(h, alpha); }),
                    1, 5e-6)
            << alpha;
}

TEST(GgxDistribution, HasAPeakOfOneOverPiAlphaSquared) {
    for (const float alpha : alphas) {
        const double peak = 1 / (pi * alpha * static_cast<double>(alpha));
        EXPECT_NEAR(ggxDistribution(vec3(0, 0, 1), vec3(0, 0, 1), alpha) / peak, 1, 1e-7);
        // A quarter of it at slopes of alpha, but for cos⁻⁴.
        const dvec3 h = glm::normalize(dvec3(alpha, 0, 1));
        EXPECT_NEAR(ggx::distribution(h, alpha) * std::pow(h.z, 4) / peak, 0.25, 1e-9);
    }
    EXPECT_EQ(ggxDistribution(vec3(0, 0, 1), vec3(0, 0.1f, -1), 0.5f), 0);
    EXPECT_EQ(ggxDistribution(vec3(0, 0, 1), vec3(0), 0.5f), 0);
    EXPECT_EQ(ggxDistribution(vec3(0, 0, 1), vec3(1, 0, 0), 0.5f), 0);
    EXPECT_EQ(ggxDistribution(vec3(0, 0, 1), vec3(0, 0, 1), 0),
              ggxDistribution(vec3(0, 0, 1), vec3(0, 0, 1), 1e-4f));
    // Lengths do not matter.
    EXPECT_FLOAT_EQ(ggxDistribution(vec3(0, 0, 8), vec3(0.25f, 0, 0.5f), 0.3f),
                    ggxDistribution(vec3(0, 0, 1), vec3(0.5f, 0, 1), 0.3f));
}

vec3 eyeOf(double cosine) {
    return vec3(std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine);
}

// What is seen of the microsurface covers the view of the plane: ∫ G1 D max(0, wo·h) dh = cos.
TEST(Smith, SeesTheProjectedAreaOfThePlane) {
    for (const float alpha : alphas)
        for (const double cosine : {1.0, 0.6, 0.2, 0.05}) {
            const vec3 wo = eyeOf(cosine);
            const double seen = overHemisphere(alpha, [&](const dvec3& h) {
                return smithG1(wo.z, alpha) * ggx::distribution(h, alpha) *
                       std::max(0.0, glm::dot(dvec3(wo), h));
            });
            EXPECT_NEAR(seen / wo.z, 1, 2e-3) << alpha << " " << cosine;
        }
}

TEST(Smith, IsBoundedSymmetricAndOneStraightAbove) {
    StressInputs draw(1);
    for (int i = 0; i < 5000; ++i) {
        const auto a = static_cast<float>(draw.magnitude(-40, 0));
        const auto b = static_cast<float>(draw.magnitude(-40, 0));
        const float alpha = alphas[i % 5];
        const float both = smithG2(a, b, alpha);
        EXPECT_EQ(both, smithG2(b, a, alpha));
        EXPECT_LE(both, std::min(smithG1(a, alpha), smithG1(b, alpha)));
        // Correlated heights hide less than independent ones.
        EXPECT_GE(both, smithG1(a, alpha) * smithG1(b, alpha) * (1 - 3e-7f));
        EXPECT_NEAR(smithVisibility(a, b, alpha) / (static_cast<double>(both) / (4.0 * a * b)), 1, 3e-7);
    }
    for (const float alpha : alphas) {
        EXPECT_EQ(smithG1(1, alpha), 1);
        EXPECT_EQ(smithG2(1, 1, alpha), 1);
        EXPECT_EQ(smithG1(0, alpha), 0);
        EXPECT_EQ(smithG1(-0.5f, alpha), 0);
        EXPECT_EQ(smithVisibility(0, 0.5f, alpha), 0);
        // Finite where both cosines are the smallest that there are.
        EXPECT_TRUE(std::isfinite(smithVisibility(0x1p-149f, 0x1p-149f, alpha)));
    }
}

/// Normals by their slopes: rings of the angle whose tangent is slope / alpha, and sectors.
struct SlopeCells {
    static constexpr int rings = 12;
    static constexpr int sectors = 12;

    static std::size_t cellOf(const dvec3& h, double alpha) {
        const double ring = std::atan2(std::sqrt(h.x * h.x + h.y * h.y), alpha * h.z) / (0.5 * pi) * rings;
        const double sector = (std::atan2(h.y, h.x) / (2 * pi) + 0.5) * sectors;
        return static_cast<std::size_t>(std::min(static_cast<int>(ring), rings - 1) * sectors +
                                        std::min(static_cast<int>(sector), sectors - 1));
    }
};

statistics::ChiSquareOutcome compareNormals(vec3 wo, float alpha, float claimedAlpha, std::uint64_t seed) {
    constexpr int drawn = 20000;
    constexpr int steps = 16;
    std::vector<double> observed(SlopeCells::rings * SlopeCells::sectors);
    std::vector<double> expected(observed.size());
    Random random(seed);
    for (int i = 0; i < drawn; ++i) {
        const float u = random.uniform();
        ++observed[SlopeCells::cellOf(dvec3(sampleVisibleNormal(wo, alpha, vec2(u, random.uniform()))),
                                      alpha)];
    }
    for (int i = 0; i < SlopeCells::rings * steps; ++i) {
        const double step = 0.5 * pi / (SlopeCells::rings * steps);
        const double angleOfSlope = (i + 0.5) * step;
        const double slope = alpha * std::tan(angleOfSlope);
        const double area = slope * alpha / (std::cos(angleOfSlope) * std::cos(angleOfSlope)) * step *
                            (2 * pi / (SlopeCells::sectors * steps));
        for (int j = 0; j < SlopeCells::sectors * steps; ++j) {
            const double angle = ((j + 0.5) / (SlopeCells::sectors * steps) - 0.5) * 2 * pi;
            const dvec3 h =
                dvec3(slope * std::cos(angle), slope * std::sin(angle), 1) / std::sqrt(1 + slope * slope);
            expected[static_cast<std::size_t>(i / steps * SlopeCells::sectors + j / steps)] +=
                drawn * area * h.z * h.z * h.z * visibleNormalDensity(wo, vec3(h), claimedAlpha);
        }
    }
    return statistics::chiSquareTest(observed, expected);
}

TEST(VisibleNormals, AreDrawnByTheirDensity) {
    const double level = statistics::levelOfEach(25);
    std::uint64_t seed = 1;
    for (const float alpha : alphas)
        for (const double cosine : {1.0, 0.7, 0.3, 0.05, 0.0}) {
            const auto outcome = compareNormals(eyeOf(cosine), alpha, alpha, seed++);
            EXPECT_GT(outcome.pValue, level)
                << alpha << " " << cosine << ": " << outcome.statistic << " of " << outcome.degreesOfFreedom;
            EXPECT_GT(outcome.degreesOfFreedom, 60);
        }
    EXPECT_LT(compareNormals(eyeOf(0.7), 0.3f, 0.33f, 1).pValue, 1e-10);
}

TEST(VisibleNormals, FaceTheEyeAndHaveUnitLength) {
    StressInputs draw(2);
    const float ends[] = {0, 0x1p-24f, 0.5f, 1 - 0x1p-24f, 1};
    for (int i = 0; i < 20000; ++i) {
        const vec3 wo = eyeOf(i % 8 == 0 ? 0 : std::min(1.0, draw.magnitude(-60, 0)));
        const float alpha = alphas[i % 5];
        const vec2 uv = i % 2 == 0 ? vec2(ends[draw.random().below(5)], ends[draw.random().below(5)])
                                   : vec2(draw.random().uniform(), draw.random().uniform());
        const dvec3 h(sampleVisibleNormal(wo, alpha, uv));
        EXPECT_NEAR(glm::length(h), 1, 6e-8);
        EXPECT_GE(h.z, 0);
        EXPECT_GE(glm::dot(h, dvec3(wo)), -1.2e-7);
    }
}

}  // namespace
}  // namespace quincunx

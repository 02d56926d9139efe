#include "trace/brdf_glsl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "base/random.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double epsilon = 0x1p-24;
constexpr double pi = std::numbers::pi;

dvec3 unit(const dvec3& v) {
    return v / std::sqrt(glm::dot(v, v));
}

dvec3 randomDirection(Random& random) {
    for (;;) {
        const dvec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const double squared = glm::dot(v, v);
        if (squared > 0.01 && squared < 1)
            return v / std::sqrt(squared);
    }
}

/// A direction `angle` away from the unit vector `v`, anywhere around it.
dvec3 away(Random& random, const dvec3& v, double angle) {
    return std::cos(angle) * v + std::sin(angle) * unit(glm::cross(v, randomDirection(random)));
}

// The same formulas as in the sources, in double, for the exact directions of float vectors.
namespace exact {

double alpha(double roughness) {
    return std::max(std::clamp(roughness, 0.0, 1.0) * std::clamp(roughness, 0.0, 1.0),
                    static_cast<double>(glsl::leastAlpha));
}

/// π D.
double distribution(const dvec3& n, const dvec3& h, double alpha) {
    const dvec3 sine = glm::cross(unit(n), unit(h));
    const double cosine = glm::dot(unit(n), unit(h));
    const double below = glm::dot(sine, sine) + alpha * alpha * cosine * cosine;
    return cosine > 0 ? alpha * alpha / (below * below) : 0;
}

/// n·wi V, by Heitz's equation 99: G = 1 / (1 + Λ(wi) + Λ(wo)) over 4 n·wi n·wo.
double visibility(double cosLight, double cosEye, double alpha) {
    const auto lambda = [&](double cosine) {
        const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
        return 0.5 * (std::sqrt(1 + alpha * alpha * tangent2) - 1);
    };
    return 1 / (1 + lambda(cosLight) + lambda(cosEye)) / (4 * cosEye);
}

double fresnel(double f0, double cosine) {
    return f0 + (1 - f0) * std::pow(1 - cosine, 5);
}

/// π f n·wi of one channel.
double share(double base, double metallic, double roughness, const dvec3& n, const dvec3& wi,
             const dvec3& wo) {
    const double cosLight = glm::dot(unit(n), unit(wi));
    const double cosEye = glm::dot(unit(n), unit(wo));
    const dvec3 h = unit(unit(wi) + unit(wo));
    const double a = alpha(roughness);
    const double f = fresnel(0.04 * (1 - metallic) + base * metallic, glm::dot(h, unit(wo)));
    return (1 - f) * base * (1 - metallic) * cosLight +
           f * distribution(n, h, a) * visibility(cosLight, cosEye, a);
}

}  // namespace exact

TEST(Fresnel, IsSchlicksWithinItsBoundAndInItsLimits) {
    double worst = 0;
    for (int i = 0; i <= 100000; ++i) {
        const float cosine = static_cast<float>(i) / 100000.0f;
        const double off =
            static_cast<double>(glsl::fresnelWeight(cosine)) - std::pow(1 - static_cast<double>(cosine), 5);
        worst = std::max(worst, std::abs(off));
    }
    EXPECT_LE(worst, 8 * epsilon);  // measured: 2.3 ε
    EXPECT_EQ(glsl::fresnelSchlick(vec3(0.04f), 1), vec3(0.04f));
    EXPECT_EQ(glsl::fresnelSchlick(vec3(0.5f), 0), vec3(1));
    for (const float outside : {-0.1f, -1e30f, 1.0000001f, 7.0f}) {
        EXPECT_GE(glsl::fresnelWeight(outside), 0) << outside;
        EXPECT_LE(glsl::fresnelWeight(outside), 1) << outside;
    }
}

TEST(Ggx, KeepsItsBoundAtTheHighlightWhereTheTextbookFormCancels) {
    Random random(1);
    double worst = 0;
    double worstNaive = 0;
    for (int i = 0; i < 100000; ++i) {
        const double roughness = random.uniform(0.01, 1);
        const double alpha = exact::alpha(roughness);
        const dvec3 normal = randomDirection(random);
        const double angle = std::min(alpha * std::exp2(random.uniform(-3, 3)), 1.5);
        const vec3 n(normal);
        const vec3 h(away(random, normal, angle));
        const float a = static_cast<float>(alpha);
        const double reference = exact::distribution(n, h, static_cast<double>(a));
        worst =
            std::max(worst, std::abs(static_cast<double>(glsl::ggxDistribution(n, h, a)) / reference - 1));
        const float cosine = glm::dot(n, h);
        const float below = cosine * cosine * (a * a - 1) + 1;
        worstNaive =
            std::max(worstNaive, std::abs(static_cast<double>(a * a / (below * below)) / reference - 1));
    }
    EXPECT_LE(worst, 24 * epsilon);
    EXPECT_GT(worstNaive, 0.5);
    RecordProperty("worst_eps", std::to_string(worst / epsilon));
}

// ∫ D(h) n·h dω = 1 over the hemisphere (Walter et al. 2007, equation 4). With tan θ = α e^x the integrand is
// smooth and falls off on both sides as e^(−2|x|): the trapezoidal rule on −14 … 14 leaves e^−28.
TEST(Ggx, IntegratesToOneOverTheHemisphere) {
    for (const double roughness : {0.0, 0.01, 0.05, 0.1, 0.3, 0.5, 0.8, 1.0}) {
        const float a = glsl::alphaOfRoughness(static_cast<float>(roughness));
        const double alpha = static_cast<double>(a);
        double sum = 0;
        constexpr double step = 1.0 / 64;
        for (double x = -14; x <= 14; x += step) {
            const double tangent = alpha * std::exp(x);
            const double cosine = 1 / std::sqrt(1 + tangent * tangent);
            const double sine = tangent * cosine;
            const vec3 h(dvec3(sine, 0, cosine));
            const double d = static_cast<double>(glsl::ggxDistribution({0, 0, 1}, h, a)) / pi;
            // dω = 2π sin θ dθ, dθ = tan θ / (1 + tan² θ) dx.
            sum += d * cosine * 2 * pi * sine * tangent * cosine * cosine * step;
        }
        EXPECT_NEAR(sum, 1, 24 * epsilon) << roughness;
    }
}

TEST(Ggx, HasItsLimitsRight) {
    const vec3 n(0, 0, 1);
    // A roughness of 1 has no preferred direction.
    for (const double angle : {0.0, 0.5, 1.0, 1.5})
        EXPECT_NEAR(glsl::ggxDistribution(n, vec3(std::sin(angle), 0, std::cos(angle)), 1), 1, 8 * epsilon);
    const float a = glsl::alphaOfRoughness(0);
    EXPECT_EQ(a, glsl::leastAlpha);
    EXPECT_NEAR(static_cast<double>(glsl::ggxDistribution(n, n, a)), 1e8, 1e8 * 8 * epsilon);
    EXPECT_EQ(glsl::ggxDistribution(n, vec3(0), a), 0);
    EXPECT_EQ(glsl::ggxDistribution(n, -n, a), 0);
    EXPECT_EQ(glsl::alphaOfRoughness(2), 1);
}

TEST(Smith, AgreesWithHeitzInDoubleToGrazingAngles) {
    Random random(2);
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const float l = static_cast<float>(std::exp2(random.uniform(-20, 0)));
        const float v = static_cast<float>(std::exp2(random.uniform(-20, 0)));
        const float a = glsl::alphaOfRoughness(static_cast<float>(random.uniform(0, 1)));
        const double reference = exact::visibility(l, v, a);
        worst =
            std::max(worst, std::abs(static_cast<double>(glsl::smithVisibility(l, v, a)) / reference - 1));
    }
    EXPECT_LE(worst, 8 * epsilon);
    RecordProperty("worst_eps", std::to_string(worst / epsilon));
}

TEST(Smith, IsFiniteWhereCosinesVanish) {
    for (const float a : {glsl::leastAlpha, 0.1f, 1.0f}) {
        EXPECT_EQ(glsl::smithVisibility(0, 0, a), 0);
        EXPECT_EQ(glsl::smithVisibility(-0.5f, 0.5f, a), 0);
        for (const float l : {std::numeric_limits<float>::denorm_min(), 1e-38f, 1e-6f, 1.0f})
            for (const float v : {-1.0f, 0.0f, std::numeric_limits<float>::denorm_min(), 1.0f}) {
                const float share = glsl::smithVisibility(l, v, a);
                EXPECT_TRUE(share >= 0 && share <= 0.5f / a * 1.0001f) << l << " " << v << " " << a;
            }
    }
}

/// What of white surroundings a surface sends towards an eye at that cosine, its specular part and all of it.
/// Half vectors are taken from GGX's own distribution, evenly over its two quantiles.
double albedo(const glsl::MicrofacetSurface& surface, double cosEye, bool diffuse) {
    const vec3 n(0, 0, 1);
    const dvec3 wo(std::sqrt(1 - cosEye * cosEye), 0, cosEye);
    glsl::MicrofacetSurface shiny = surface;
    shiny.diffuse = vec3(0);
    const double alpha = static_cast<double>(surface.alpha);
    constexpr int rings = 200;
    constexpr int spokes = 100;
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        const double u = (i + 0.5) / rings;
        const double tangent2 = alpha * alpha * u / (1 - u);
        const double cosine = 1 / std::sqrt(1 + tangent2);
        const double sine = std::sqrt(tangent2) * cosine;
        for (int j = 0; j < spokes; ++j) {
            const double phi = 2 * pi * (j + 0.5) / spokes;
            const dvec3 h(sine * std::cos(phi), sine * std::sin(phi), cosine);
            const double across = glm::dot(wo, h);
            const dvec3 wi = 2 * across * h - wo;
            if (across <= 0 || wi.z <= 0)
                continue;
            const double pdf = exact::distribution(n, h, alpha) / pi * cosine / (4 * across);
            sum += static_cast<double>(glsl::microfacetShare(shiny, n, vec3(wi), vec3(wo)).x) / pi / pdf;
        }
    }
    sum /= rings * spokes;
    if (!diffuse)
        return sum;
    glsl::MicrofacetSurface matt = surface;
    double lambert = 0;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            const double sine2 = (i + 0.5) / rings;
            const double phi = 2 * pi * (j + 0.5) / spokes;
            const vec3 wi(std::sqrt(sine2) * std::cos(phi), std::sqrt(sine2) * std::sin(phi),
                          std::sqrt(1 - sine2));
            const vec3 all = glsl::microfacetShare(matt, n, wi, vec3(wo));
            const vec3 highlight = glsl::microfacetShare(shiny, n, wi, vec3(wo));
            lambert += static_cast<double>(all.x - highlight.x) / static_cast<double>(wi.z);
        }
    return sum + lambert / (rings * spokes);
}

// One bounce of height-correlated GGX loses light at rough surfaces and never makes any.
TEST(WhiteFurnace, AWhiteMetalSendsBackNoMoreThanArrives) {
    for (const float roughness : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f})
        for (const double cosEye : {1.0, 0.7, 0.4, 0.2, 0.1}) {
            const double share = albedo(glsl::metallicRoughness(vec3(1), 1, roughness), cosEye, false);
            EXPECT_LE(share, 1.001) << roughness << " " << cosEye;
            EXPECT_GE(share, 0.306) << roughness << " " << cosEye;
        }
    EXPECT_NEAR(albedo(glsl::metallicRoughness(vec3(1), 1, 0.05f), 0.7, false), 1, 1e-3);
    // For α = 1 seen from above π f n·wi is l / (2 (1 + l)) with l = n·wi, whose mean over the hemisphere is
    // 1 − ln 2.
    EXPECT_NEAR(albedo(glsl::metallicRoughness(vec3(1), 1, 1), 1, false), 1 - std::numbers::ln2, 1e-5);
}

TEST(WhiteFurnace, AWhiteDielectricSeenFromAboveSendsBackAlmostAll) {
    for (const float roughness : {0.1f, 0.5f, 1.0f}) {
        const double share = albedo(glsl::metallicRoughness(vec3(1), 0, roughness), 0.9, true);
        EXPECT_LE(share, 1.001) << roughness;
        EXPECT_GE(share, 0.9) << roughness;
    }
}

// What appendix B's mix makes of it at grazing angles is part of the format: known, and no more than this.
TEST(WhiteFurnace, AppendixBLetsSmoothDielectricsGainAtGrazingAngles) {
    const auto share = [](float roughness, double cosEye) {
        return albedo(glsl::metallicRoughness(vec3(1), 0, roughness), cosEye, true);
    };
    EXPECT_NEAR(share(0.1f, 0.5), 1.025, 0.002);
    EXPECT_NEAR(share(0.05f, 0.05), 1.716, 0.005);
    EXPECT_NEAR(share(0.5f, 0.05), 1.132, 0.005);
    EXPECT_NEAR(share(1, 0.05), 1.001, 0.002);
}

TEST(MicrofacetShare, AgreesWithDoubleOverRandomSurfacesAndDirections) {
    Random random(3);
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const dvec3 normal = randomDirection(random);
        const vec3 n(normal);
        const vec3 wi(away(random, normal, random.uniform(0, 1.5)));
        const vec3 wo(away(random, normal, random.uniform(0, 1.5)));
        const float base = static_cast<float>(random.uniform(0, 1));
        const float metallic = static_cast<float>(random.uniform(0, 1));
        const float roughness = static_cast<float>(random.uniform(0.05, 1));
        const double reference = exact::share(base, metallic, roughness, n, wi, wo);
        const double got = static_cast<double>(
            glsl::microfacetShare(glsl::metallicRoughness(vec3(base), metallic, roughness), n, wi, wo).x);
        // Directions that are off by ε turn n·wi by 2 ε (which is 0.07 at least) and h by ε √2, which moves D
        // by 2 / α of that where it is steepest.
        const double alpha = exact::alpha(roughness);
        const double bound = (100 + 6 / alpha) * epsilon * reference;
        worst = std::max(worst, std::abs(got - reference) / bound);
    }
    EXPECT_LE(worst, 1);
    RecordProperty("worst_of_bound", std::to_string(worst));
}

TEST(MicrofacetShare, IsReciprocal) {
    Random random(4);
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const dvec3 normal = randomDirection(random);
        const vec3 n(normal);
        const vec3 wi(away(random, normal, random.uniform(0, 1.56)));
        const vec3 wo(away(random, normal, random.uniform(0, 1.56)));
        const glsl::MicrofacetSurface surface = glsl::metallicRoughness(
            vec3(0.7f), static_cast<float>(random.uniform(0, 1)), static_cast<float>(random.uniform(0, 1)));
        const double there = static_cast<double>(glsl::microfacetShare(surface, n, wi, wo).x) /
                             static_cast<double>(glm::dot(n, wi));
        const double back = static_cast<double>(glsl::microfacetShare(surface, n, wo, wi).x) /
                            static_cast<double>(glm::dot(n, wo));
        worst = std::max(worst, std::abs(there - back) / std::max(there, back));
    }
    EXPECT_LE(worst, 32 * epsilon);
    RecordProperty("worst_eps", std::to_string(worst / epsilon));
}

TEST(MicrofacetShare, IsFiniteAndNotNegativeForEveryDirection) {
    Random random(5);
    const auto tilted = [&](const dvec3& v) {
        return vec3(away(random, v, pi / 2 - std::exp2(random.uniform(-30, 0.6))));
    };
    for (int i = 0; i < 100000; ++i) {
        const dvec3 normal = randomDirection(random);
        const vec3 n(random.below(50) == 0 ? dvec3(0) : normal);
        const vec3 wi = tilted(normal);
        const vec3 wo = random.below(3) == 0 ? -wi
                        : random.below(2) == 0
                            ? tilted(normal)
                            : vec3(away(random, -dvec3(wi), std::exp2(random.uniform(-30, 0))));
        const float roughness = random.below(3) == 0 ? 0 : static_cast<float>(random.uniform(-0.5, 1.5));
        const vec3 share = glsl::microfacetShare(
            glsl::metallicRoughness(vec3(1, 0.5f, 0), static_cast<float>(random.uniform(-0.5, 1.5)),
                                    roughness),
            n, wi, wo);
        for (int channel = 0; channel < 3; ++channel) {
            ASSERT_TRUE(std::isfinite(share[channel]));
            ASSERT_GE(share[channel], 0);
        }
    }
}

TEST(MetallicRoughness, MixesAsTheAppendixSays) {
    const vec3 base(0.5f, 0.25f, 1);
    const glsl::MicrofacetSurface dielectric = glsl::metallicRoughness(base, 0, 0.5f);
    EXPECT_EQ(dielectric.diffuse, base);
    EXPECT_EQ(dielectric.f0, vec3(0.04f));
    EXPECT_EQ(dielectric.alpha, 0.25f);
    const glsl::MicrofacetSurface metal = glsl::metallicRoughness(base, 1, 0.5f);
    EXPECT_EQ(metal.diffuse, vec3(0));
    EXPECT_EQ(metal.f0, base);
}

TEST(RangeShare, EndsSmoothlyAtTheRange) {
    EXPECT_EQ(glsl::rangeShare(1e30f, 0), 1);
    EXPECT_EQ(glsl::rangeShare(0, 4), 1);
    EXPECT_EQ(glsl::rangeShare(4, 4), 0);
    EXPECT_EQ(glsl::rangeShare(5, 4), 0);
    for (int i = 0; i <= 100; ++i) {
        const double distance = 0.05 * i;
        const double exactShare = std::max(1 - std::pow(distance / 4, 4), 0.0);
        EXPECT_NEAR(glsl::rangeShare(static_cast<float>(distance), 4), exactShare, 8 * epsilon) << distance;
    }
}

}  // namespace
}  // namespace quincunx

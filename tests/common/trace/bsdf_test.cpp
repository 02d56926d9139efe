#include "trace/bsdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "math/vector.h"
#include "tests/support/chi_square.h"
#include "trace/brdf_glsl.h"
#include "trace/fresnel.h"
#include "trace/sampling.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;

constexpr double pi = std::numbers::pi;

struct Model {
    std::string name;
    Bsdf bsdf;
};

/// White ones, so that energies are albedos.
const std::vector<Model>& models() {
    static const std::vector<Model> all = [] {
        std::vector<Model> made{{"lambert", Lambert{vec3(1)}}};
        for (const float exponent : {0.0f, 32.0f, 1e5f}) {
            made.push_back({fmt::format("phong {}", exponent), PhongBsdf{vec3(0.4f), vec3(0.6f), exponent}});
            made.push_back(
                {fmt::format("blinn {}", exponent), BlinnPhongBsdf{vec3(0.4f), vec3(0.6f), exponent}});
        }
        for (const float alpha : {1.0f, 0.2f, 1e-3f, 1e-4f}) {
            made.push_back({fmt::format("conductor {}", alpha), GgxConductor{vec3(1), alpha}});
            // What goes through is bent by (ior − 1) alpha only: at 1e-4 the grain of directions in float
            // shows.
            const float frosting = std::max(alpha, 5e-4f);
            made.push_back({fmt::format("glass {}", frosting), Dielectric{1.5f, frosting, vec3(1)}});
        }
        for (const float alpha : {0.5f, 1e-3f})
            made.push_back(
                {fmt::format("plastic {}", alpha), MetallicRoughness{vec3(0.8f), vec3(0.04f), alpha}});
        made.push_back({"air in glass 0.3", Dielectric{1 / 1.5f, 0.3f, vec3(1)}});
        made.push_back({"diamond 0.1", Dielectric{2.4f, 0.1f, vec3(1)}});
        return made;
    }();
    return all;
}

bool isGlass(const Bsdf& bsdf) {
    return std::holds_alternative<Dielectric>(bsdf);
}

vec3 directionOfCosine(double cosine, double turn = 0.7) {
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    return vec3(sine * std::cos(turn), sine * std::sin(turn), cosine);
}

/// Where eyes are: from straight above to grazing, and for glass below as well.
std::vector<vec3> eyesOf(const Bsdf& bsdf) {
    std::vector<vec3> eyes;
    for (const double cosine : {1.0, 0.7, 0.3, 0.1}) {
        eyes.push_back(directionOfCosine(cosine));
        if (isGlass(bsdf))
            eyes.push_back(directionOfCosine(-cosine));
    }
    return eyes;
}

/// The radiance that arrives through glass is (index of the light's side / index of the eye's side)² times
/// that of the same flux in the eye's medium: by this factor energies are those of flux.
double fluxFactor(const Bsdf& bsdf, vec3 wo, vec3 wi) {
    const auto* glass = std::get_if<Dielectric>(&bsdf);
    if (glass == nullptr || (wo.z > 0) == (wi.z > 0))
        return 1;
    const double ior = glass->ior;
    return wo.z > 0 ? ior * ior : 1 / (ior * ior);
}

/// Cells of one hemisphere: rings about an axis, whose widths grow with their distance from it so that lobes
/// of any width have several, cut into sectors. Directions of the other hemisphere belong to none.
class LobeCells {
  public:
    static constexpr int rings = 16;
    static constexpr int sectors = 6;
    static constexpr int count = rings * sectors;

    /// `width`: radians, of the narrowest lobe.
    LobeCells(vec3 axis, bool above, double width, double flatness)
        : frame_(frameOf(dvec3(axis))),
          above_(above),
          least_(std::min(0.1, width * width / 32)),
          flatness_(std::max(flatness, 0.1)) {}

    int cellOf(vec3 wi) const {
        if ((wi.z > 0) != above_ || wi.z == 0)
            return -1;
        const dvec3 unit = dvec3(wi) / std::sqrt(glm::dot(dvec3(wi), dvec3(wi)));
        const dvec3 chord = unit - frame_[2];
        const double versine = 0.5 * glm::dot(chord, chord);
        const double ring = versine <= least_ ? 0 : 1 + std::log(versine / least_) / ringLog();
        const double angle = std::atan2(glm::dot(unit, frame_[1]), flatness_ * glm::dot(unit, frame_[0]));
        const int sector = std::clamp(static_cast<int>((angle / (2 * pi) + 0.5) * sectors), 0, sectors - 1);
        return std::clamp(static_cast<int>(ring), 0, rings - 1) * sectors + sector;
    }

    /// ∫ f over each cell by the midpoint rule, `steps` rings a cell.
    std::vector<double> integrate(const std::function<double(vec3)>& f, int steps) const {
        std::vector<double> sums(count);
        const int turns = flatness_ < 1 ? 3 * steps : steps;
        for (int ring = 0; ring < rings; ++ring)
            for (int i = 0; i < steps; ++i) {
                const double from = edge(ring, static_cast<double>(i) / steps);
                const double to = edge(ring, static_cast<double>(i + 1) / steps);
                const double versine = 0.5 * (from + to);
                const double sine = std::sqrt(versine * (2 - versine));
                const double area = (to - from) * 2 * pi / (sectors * turns);
                for (int j = 0; j < sectors * turns; ++j) {
                    const double stretched = ((j + 0.5) / (sectors * turns) - 0.5) * 2 * pi;
                    const double x = std::cos(stretched);
                    const double y = flatness_ * std::sin(stretched);
                    const double squared = x * x + y * y;
                    const double radius = sine / std::sqrt(squared);
                    const vec3 wi(frame_ * dvec3(radius * x, radius * y, 1 - versine));
                    if ((wi.z > 0) == above_ && wi.z != 0)
                        sums[static_cast<std::size_t>(ring * sectors + j / turns)] +=
                            area * (flatness_ / squared) * f(wi);
                }
            }
        return sums;
    }

  private:
    /// x in the plane of the normal and the axis.
    static glm::dmat3 frameOf(dvec3 axis) {
        const dvec3 across(-axis.y, axis.x, 0);
        const double length = std::sqrt(glm::dot(across, across));
        const dvec3 y = length > 1e-6 ? across / length : dvec3(0, 1, 0);
        const dvec3 z = axis / std::sqrt(glm::dot(axis, axis));
        return {glm::cross(y, z), y, z};
    }
    double ringLog() const { return std::log(2 / least_) / (rings - 1); }
    /// The versine at a share of a ring's width, uniform in its logarithm but for the innermost.
    double edge(int ring, double share) const {
        return ring == 0 ? least_ * share : least_ * std::exp((ring - 1 + share) * ringLog());
    }

    glm::dmat3 frame_;
    bool above_;
    double least_;
    double flatness_;
};

/// The narrowest lobe's half width, radians.
double widthOf(const Bsdf& bsdf) {
    if (const auto* phong = std::get_if<PhongBsdf>(&bsdf))
        return 1 / std::sqrt(phong->exponent + 1);
    if (const auto* blinn = std::get_if<BlinnPhongBsdf>(&bsdf))
        return 2 / std::sqrt(blinn->exponent + 1);
    if (const auto* metal = std::get_if<GgxConductor>(&bsdf))
        return metal->alpha;
    if (const auto* plastic = std::get_if<MetallicRoughness>(&bsdf))
        return plastic->alpha;
    if (const auto* glass = std::get_if<Dielectric>(&bsdf))
        return 0.5 * glass->alpha;
    return 1;
}

/// Cells of the hemisphere of wo, about its mirror image, and of the other, about where light goes through.
std::array<LobeCells, 2> cellsOf(const Bsdf& bsdf, vec3 wo) {
    const double width = widthOf(bsdf);
    vec3 through = -wo;
    if (const auto* glass = std::get_if<Dielectric>(&bsdf))
        through = refract(-wo, vec3(0, 0, 1), wo.z > 0 ? glass->ior : 1 / glass->ior).value_or(-wo);
    const bool byHalfVector = width < 0.1 && !std::holds_alternative<PhongBsdf>(bsdf);
    return {
        LobeCells(vec3(-wo.x, -wo.y, wo.z), wo.z > 0, width,
                  byHalfVector ? std::abs(static_cast<double>(wo.z)) : 1),
        LobeCells(through, wo.z <= 0, width, byHalfVector ? std::abs(static_cast<double>(through.z)) : 1)};
}

/// Wide lobes end at the horizon somewhere inside cells.
int stepsFor(const Bsdf& bsdf) {
    return widthOf(bsdf) > 0.1 ? 24 : 12;
}

constexpr int drawn = 20000;

vec3 threeNumbers(Random& random) {
    const float x = random.uniform();
    const float y = random.uniform();
    return {x, y, random.uniform()};
}

/// What `draw` gives against `densityAt`, in cells about the lobes and one for what is lost.
statistics::ChiSquareOutcome compareDensity(const Bsdf& bsdf, vec3 wo,
                                            const std::function<double(vec3)>& densityAt, int seed) {
    const std::array<LobeCells, 2> cells = cellsOf(bsdf, wo);
    std::vector<double> observed(2 * LobeCells::count + 1);
    std::vector<double> expected(observed.size());
    Random random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < drawn; ++i) {
        const vec3 numbers = threeNumbers(random);
        const auto s = sample(bsdf, wo, numbers.x, vec2(numbers.y, numbers.z));
        int cell = 2 * LobeCells::count;
        if (s)
            cell = cells[0].cellOf(s->wi) >= 0 ? cells[0].cellOf(s->wi)
                                               : LobeCells::count + cells[1].cellOf(s->wi);
        ++observed[static_cast<std::size_t>(cell)];
    }
    double inside = 0;
    for (int side = 0; side < (isGlass(bsdf) ? 2 : 1); ++side) {
        const std::vector<double> sums =
            cells[static_cast<std::size_t>(side)].integrate(densityAt, stepsFor(bsdf));
        for (std::size_t i = 0; i < sums.size(); ++i) {
            expected[static_cast<std::size_t>(side) * LobeCells::count + i] = drawn * sums[i];
            inside += sums[i];
        }
    }
    // What is left over is as uncertain as the quadrature, 1e-3: five of what is drawn stand in for it.
    expected.back() = std::max(drawn * (1 - inside), observed.back() > 0 ? 5.0 : 0.0);
    return statistics::chiSquareTest(observed, expected);
}

int casesOfAll() {
    int cases = 0;
    for (const Model& model : models())
        cases += static_cast<int>(eyesOf(model.bsdf).size());
    return cases;
}

TEST(Bsdf, IsSampledByItsDensity) {
    const double level = statistics::levelOfEach(casesOfAll());
    int seed = 1;
    for (const auto& [name, bsdf] : models())
        for (const vec3 wo : eyesOf(bsdf)) {
            const auto outcome = compareDensity(
                bsdf, wo, [&, &b = bsdf](vec3 wi) { return density(b, wo, wi); }, seed++);
            EXPECT_GT(outcome.pValue, level) << name << " from " << wo.z << ": chi² " << outcome.statistic
                                             << " of " << outcome.degreesOfFreedom;
        }
}

TEST(Bsdf, WouldBeCaughtWithAWrongDensity) {
    const vec3 wo = directionOfCosine(0.7);
    // Half as wide again, and a lobe that leaves masking out.
    const Bsdf metal = GgxConductor{vec3(1), 0.3f};
    EXPECT_LT(compareDensity(
                  metal, wo,
                  [&](vec3 wi) {
                      return density(GgxConductor{vec3(1), 0.33f}, wo, wi);
                  },
                  1)
                  .pValue,
              1e-10);
    const Bsdf phong = PhongBsdf{vec3(0.4f), vec3(0.6f), 32};
    EXPECT_LT(compareDensity(
                  phong, wo,
                  [&](vec3 wi) {
                      return density(PhongBsdf{vec3(0.4f), vec3(0.6f), 45}, wo, wi);
                  },
                  1)
                  .pValue,
              1e-10);
    const Bsdf glass = Dielectric{1.5f, 0.3f};
    EXPECT_LT(compareDensity(
                  glass, wo,
                  [&](vec3 wi) {
                      return density(Dielectric{1.55f, 0.3f}, wo, wi);
                  },
                  1)
                  .pValue,
              1e-10);
}

/// ∫ f |cos| of flux over the directions that cells cover.
double albedo(const Bsdf& bsdf, vec3 wo, int steps) {
    const std::array<LobeCells, 2> cells = cellsOf(bsdf, wo);
    double total = 0;
    for (int side = 0; side < (isGlass(bsdf) ? 2 : 1); ++side)
        for (const double sum : cells[static_cast<std::size_t>(side)].integrate(
                 [&](vec3 wi) {
                     return evaluate(bsdf, wo, wi).x * std::abs(static_cast<double>(wi.z)) *
                            fluxFactor(bsdf, wo, wi);
                 },
                 steps))
            total += sum;
    return total;
}

// The quadrature knows nothing of `sample` and `density`. Its own error is 1e-3 (measured: against twice as
// many steps 4e-4 at most); D of directions rounded to float is off by some 1e-3 at a width of 1e-4.
TEST(Bsdf, WeighsItsSamplesToItsAlbedo) {
    const double level = statistics::levelOfEach(casesOfAll());
    int seed = 1000;
    for (const auto& [name, bsdf] : models())
        for (const vec3 wo : eyesOf(bsdf)) {
            Random random(static_cast<std::uint64_t>(seed++));
            statistics::Moments moments;
            for (int i = 0; i < drawn; ++i) {
                const vec3 numbers = threeNumbers(random);
                const auto s = sample(bsdf, wo, numbers.x, vec2(numbers.y, numbers.z));
                moments.add(s ? s->weight.x * fluxFactor(bsdf, wo, s->wi) : 0);
            }
            const double expected = albedo(bsdf, wo, stepsFor(bsdf));
            EXPECT_GT(statistics::studentTTest(moments, expected, 2e-3 * std::max(expected, 0.5)), level)
                << name << " from " << wo.z << ": " << moments.mean() << " ± " << moments.standardError()
                << " against " << expected;
        }
}

TEST(Bsdf, SendsBackNoMoreThanArrives) {
    for (const auto& [name, bsdf] : models())
        for (const vec3 wo : eyesOf(bsdf)) {
            if (std::holds_alternative<MetallicRoughness>(bsdf))
                continue;
            EXPECT_LE(albedo(bsdf, wo, stepsFor(bsdf)), 1 + 2e-3) << name << " from " << wo.z;
        }
    // In closed form from straight above: the lobes' normalizations.
    for (const float exponent : {0.0f, 0.5f, 1.0f, 3.0f, 20.0f, 1e3f}) {
        const vec3 above(0, 0, 1);
        EXPECT_NEAR(albedo(PhongBsdf{vec3(0), vec3(1), exponent}, above, 24), 1, 1e-3) << exponent;
        EXPECT_NEAR(albedo(BlinnPhongBsdf{vec3(0), vec3(1), exponent}, above, 24), 1, 1e-3) << exponent;
        // And less, or with exponent 0 as much, from anywhere else.
        for (const double cosine : {0.99, 0.9, 0.5, 0.1}) {
            EXPECT_LE(albedo(PhongBsdf{vec3(0), vec3(1), exponent}, directionOfCosine(cosine), 16), 1 + 1e-3);
            EXPECT_LE(albedo(BlinnPhongBsdf{vec3(0), vec3(1), exponent}, directionOfCosine(cosine), 16),
                      1 + 1e-3);
        }
    }
}

// A white plastic, as glTF mixes it, gives back more than arrives from 46° on where it is rough, at once
// where it is smooth: the diffuse part lacks (1 − F) of one half vector, which is less than what is mirrored
// at grazing angles. Measured by the quadrature: alpha 1e-3: 1.0000 at cos 1, 1.025 at 0.5, 1.30 at 0.2, 1.72
// at 0.05.
TEST(Bsdf, ExceedsUnityInGltfsMixAtGrazingAnglesOnly) {
    const auto plastic = [](float alpha, double cosine) {
        return albedo(MetallicRoughness{vec3(1), vec3(0.04f), alpha}, directionOfCosine(cosine), 16);
    };
    EXPECT_NEAR(plastic(1e-3f, 1), 1.0, 3e-3);
    EXPECT_NEAR(plastic(1e-3f, 0.5), 1.025, 4e-3);
    EXPECT_NEAR(plastic(1e-3f, 0.05), 1.72, 1e-2);
    EXPECT_LT(plastic(0.5f, 0.5), 1.0);
    EXPECT_NEAR(plastic(0.5f, 0.05), 1.046, 4e-3);
    // Metals never do.
    for (const double cosine : {1.0, 0.5, 0.05})
        EXPECT_LE(albedo(MetallicRoughness{vec3(0), vec3(1), 1e-3f}, directionOfCosine(cosine), 16),
                  1 + 2e-3);
}

vec3 randomDirection(Random& random) {
    return sampleSphere(vec2(random.uniform(), random.uniform())).direction;
}

// f of glass is reciprocal after division by the square of the eye's side's index: what arrives in denser
// glass is squeezed into a narrower cone.
TEST(Bsdf, IsReciprocal) {
    Random random(5);
    for (const auto& [name, bsdf] : models())
        for (int i = 0; i < 2000; ++i) {
            const vec3 a = randomDirection(random);
            const vec3 b = randomDirection(random);
            double there = evaluate(bsdf, a, b).x;
            double back = evaluate(bsdf, b, a).x;
            there *= fluxFactor(bsdf, a, b);
            // Rounding of directions that are far from a lobe's peak has no effect; both take the same ones.
            EXPECT_NEAR(there, back, 2e-6 * std::max(there, back)) << name;
        }
}

// Sizes over the whole range of cosines, and the half spaces' border itself.
TEST(Bsdf, IsFiniteAndNotNegativeForAllDirections) {
    Random random(6);
    const auto cosineOf = [&] {
        switch (random.below(4)) {
            case 0:
                return random.uniform(-1, 1);
            case 1:
                return (random.below(2) == 0 ? 1 : -1) * std::exp2(random.uniform(-140, 0));
            case 2:
                return 1 - std::exp2(random.uniform(-24, -1));
            default:
                return 0.0;
        }
    };
    const float ends[] = {0, 0x1p-24f, 0.5f, 1 - 0x1p-24f};
    for (const auto& [name, bsdf] : models())
        for (int i = 0; i < 4000; ++i) {
            const double turn = random.uniform(0, 2 * pi);
            const vec3 wo = directionOfCosine(cosineOf(), turn);
            // As often opposite, the same, or the mirror image.
            const vec3 wi = i % 8 == 0   ? -wo
                            : i % 8 == 1 ? wo
                            : i % 8 == 2 ? vec3(-wo.x, -wo.y, wo.z)
                                         : directionOfCosine(cosineOf(), random.uniform(0, 2 * pi));
            const float value = evaluate(bsdf, wo, wi).x;
            const float likely = density(bsdf, wo, wi);
            EXPECT_TRUE(value >= 0 && std::isfinite(value)) << name << " " << value;
            EXPECT_TRUE(likely >= 0 && std::isfinite(likely)) << name << " " << likely;
            const vec2 uv = i % 2 == 0 ? vec2(ends[random.below(4)], ends[random.below(4)])
                                       : vec2(random.uniform(), random.uniform());
            const auto s = sample(bsdf, wo, random.uniform(), uv);
            if (!s)
                continue;
            EXPECT_TRUE(s->weight.x >= 0 && std::isfinite(s->weight.x)) << name;
            EXPECT_TRUE(s->density > 0 && std::isfinite(s->density)) << name;
            EXPECT_NEAR(glm::length(dvec3(s->wi)), 1, 4e-7) << name;
            EXPECT_NE(s->wi.z, 0) << name;
            EXPECT_EQ(s->transmitted, (s->wi.z > 0) != (wo.z > 0)) << name;
        }
}

TEST(Bsdf, GivesSamplesTheirDensityAndValue) {
    Random random(7);
    for (const auto& [name, bsdf] : models())
        for (int i = 0; i < 500; ++i) {
            const vec3 wo = directionOfCosine(random.uniform(isGlass(bsdf) ? -1 : 0.01, 1));
            const vec3 numbers = threeNumbers(random);
            const auto s = sample(bsdf, wo, numbers.x, vec2(numbers.y, numbers.z));
            if (!s)
                continue;
            ASSERT_FALSE(s->delta);
            const double likely = density(bsdf, wo, s->wi);
            EXPECT_EQ(evaluateWithDensity(bsdf, wo, s->wi).value, evaluate(bsdf, wo, s->wi)) << name;
            EXPECT_EQ(evaluateWithDensity(bsdf, wo, s->wi).density, density(bsdf, wo, s->wi)) << name;
            EXPECT_NEAR(s->density, likely, 3e-7 * likely) << name;
            const double share =
                evaluate(bsdf, wo, s->wi).x * std::abs(static_cast<double>(s->wi.z)) / likely;
            EXPECT_NEAR(s->weight.x, share, 1e-6 * share) << name;
        }
}

// shaders/lib/brdf.glsl in float, whose bounds are some 40 eps together.
TEST(MetallicRoughness, IsWhatTheShaderComputes) {
    Random random(8);
    for (int i = 0; i < 20000; ++i) {
        MaterialValues material;
        material.baseColor = vec3(random.uniform(), random.uniform(), random.uniform());
        material.metallic = i % 4 == 0 ? 1 : random.uniform();
        material.roughness = random.uniform();
        const vec3 wo = directionOfCosine(random.uniform(0.01, 1), random.uniform(0, 6));
        const vec3 wi = directionOfCosine(random.uniform(0.01, 1), random.uniform(0, 6));
        const glsl::MicrofacetSurface surface =
            glsl::metallicRoughness(material.baseColor, material.metallic, material.roughness);
        const vec3 shader =
            glsl::microfacetShare(surface, vec3(0, 0, 1), wi, wo) / (std::numbers::pi_v<float> * wi.z);
        const vec3 ours = evaluate(bsdfOf(material), wo, wi);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(ours[channel], shader[channel], 4e-6 * shader[channel]);
    }
}

TEST(BsdfOf, PicksTheModelByTheMaterial) {
    MaterialValues material;
    EXPECT_TRUE(std::holds_alternative<MetallicRoughness>(bsdfOf(material)));
    material.metallic = 1;
    EXPECT_TRUE(std::holds_alternative<GgxConductor>(bsdfOf(material)));
    material.transmission = 1;
    material.roughness = 0;
    material.ior = 1.33f;
    const Bsdf glass = bsdfOf(material);
    ASSERT_TRUE(std::holds_alternative<Dielectric>(glass));
    EXPECT_TRUE(isDelta(glass));
    EXPECT_EQ(std::get<Dielectric>(glass).ior, 1.33f);
    material.roughness = 0.5f;
    EXPECT_FALSE(isDelta(bsdfOf(material)));
    EXPECT_TRUE(isDelta(GgxConductor{vec3(1), 0}));
    EXPECT_FALSE(isDelta(Lambert{}));
}

TEST(SmoothGlass, SharesLightAsFresnelSays) {
    const Bsdf glass = Dielectric{1.5f, 0, vec3(0.5f, 1, 1)};
    for (const double cosine : {1.0, 0.5, 0.1, -1.0, -0.9, -0.76}) {
        const vec3 wo = directionOfCosine(cosine);
        const float eta = cosine > 0 ? 1.5f : 1 / 1.5f;
        const float mirrored = fresnelDielectric(wo.z, eta);
        const auto reflected = sample(glass, wo, 0, vec2(0));
        ASSERT_TRUE(reflected && reflected->delta && !reflected->transmitted);
        EXPECT_NEAR(reflected->density, mirrored, 1e-6);
        EXPECT_EQ(reflected->weight, vec3(1));
        EXPECT_EQ(reflected->wi, vec3(-wo.x, -wo.y, wo.z));
        const auto through = sample(glass, wo, 0.9999f, vec2(0));
        ASSERT_TRUE(through && through->delta && through->transmitted);
        EXPECT_NEAR(through->density, 1 - mirrored, 1e-6);
        // Snell: the tangential part shrinks by the index.
        EXPECT_NEAR(through->wi.x, -wo.x / eta, 2e-7);
        EXPECT_LT(through->wi.z * wo.z, 0);
        EXPECT_NEAR(through->weight.y, 1 / (eta * eta), 1e-6);
        EXPECT_NEAR(through->weight.x, 0.5 / (eta * eta), 1e-6);
        EXPECT_EQ(evaluate(glass, wo, through->wi), vec3(0));
        EXPECT_EQ(density(glass, wo, through->wi), 0);
    }
    // From inside, beyond the critical cosine of 0.745: all is mirrored.
    EXPECT_FALSE(sample(glass, directionOfCosine(-0.74), 0.9999f, vec2(0))->transmitted);
    EXPECT_EQ(sample(glass, directionOfCosine(-0.74), 0.9999f, vec2(0))->density, 1);
    // Glass in glass is not there.
    const auto matched = sample(Dielectric{1, 0, vec3(1)}, directionOfCosine(0.3), 0, vec2(0));
    EXPECT_TRUE(matched->transmitted);
    EXPECT_EQ(matched->wi, -directionOfCosine(0.3));
}

TEST(Bsdf, TakesWhatAMirrorSendsAsTheLimitOfNarrowLobes) {
    const vec3 wo = directionOfCosine(0.4);
    const auto mirror = sample(GgxConductor{vec3(0.9f, 0.5f, 0.2f), 0}, wo, 0, vec2(0.3f, 0.6f));
    const auto narrow = sample(GgxConductor{vec3(0.9f, 0.5f, 0.2f), 1e-4f}, wo, 0, vec2(0.3f, 0.6f));
    ASSERT_TRUE(mirror && narrow);
    EXPECT_TRUE(mirror->delta);
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(mirror->wi[channel], narrow->wi[channel], 1e-3);
        EXPECT_NEAR(mirror->weight[channel], narrow->weight[channel], 1e-3);
    }
}

TEST(Bsdf, SendsNothingBelowAnOpaqueSurface) {
    for (const auto& [name, bsdf] : models()) {
        if (isGlass(bsdf))
            continue;
        EXPECT_EQ(evaluate(bsdf, directionOfCosine(-0.5), directionOfCosine(0.5)), vec3(0)) << name;
        EXPECT_EQ(evaluate(bsdf, directionOfCosine(0.5), directionOfCosine(-0.5)), vec3(0)) << name;
        EXPECT_FALSE(sample(bsdf, directionOfCosine(-0.5), 0.5f, vec2(0.5f))) << name;
    }
    EXPECT_FALSE(sample(Lambert{vec3(0)}, vec3(0, 0, 1), 0.5f, vec2(0.5f)));
    EXPECT_FALSE(sample(PhongBsdf{vec3(0), vec3(0), 5}, vec3(0, 0, 1), 0.5f, vec2(0.5f)));
}

}  // namespace
}  // namespace quincunx

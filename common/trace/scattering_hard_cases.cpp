#include "trace/scattering_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "math/vector.h"
#include "trace/bsdf.h"
#include "trace/fresnel.h"
#include "trace/light_sampling.h"
#include "trace/microfacet.h"
#include "trace/sample_patterns.h"
#include "trace/sampling.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;

constexpr double infinity = std::numeric_limits<double>::infinity();
/// What a rounding of a result that is right to a few 2^-50 leaves.
constexpr double halfUlp = 0.5 + 0x1p-20;

std::string hex(double x) {
    return fmt::format("{:a}", x);
}
std::string hexPair(vec2 v) {
    return fmt::format("({:a},{:a})", v.x, v.y);
}

Quad quadPi() {
    return arcTangent(0, -1);
}

double distance(vec3 got, const QuadVector& exact) {
    const QuadVector d = QuadVector(got) - exact;
    const auto squared = static_cast<double>(dotQuad(d, d));
    return squared >= 0 ? std::sqrt(squared) : infinity;
}

double absolute(double got, const Quad& exact) {
    const auto difference = static_cast<double>(Quad(got) - exact);
    return std::isfinite(difference) ? std::abs(difference) : infinity;
}

double relative(double got, const Quad& exact) {
    return std::isfinite(got) ? std::abs(static_cast<double>((Quad(got) - exact) / exact)) : infinity;
}

// Boundaries

Quad fresnelExact(Quad cosine, Quad eta) {
    const Quad g2 = eta * eta - 1 + cosine * cosine;
    if (eta == 1)
        return 0;
    if (g2 <= 0)
        return 1;
    const Quad g = squareRoot(g2);
    const Quad across = (cosine - g) / (cosine + g);
    const Quad along = (eta * eta * cosine - g) / (eta * eta * cosine + g);
    return (across * across + along * along) / 2;
}

/// Draws cosine and eta; the exact share is that of the cosine's magnitude, at most 1.
template <typename Draw>
HardCaseFigures runFresnel(std::uint64_t inputs, std::uint64_t seed, const Draw& draw) {
    StressInputs random(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto [cosine, eta] = draw(random);
        const Quad exact = fresnelExact(std::min(std::abs(cosine), 1.0f), eta);
        tally.add(ulpError(fresnelDielectricNaive(cosine, eta), exact),
                  ulpError(fresnelDielectric(cosine, eta), exact),
                  [&, c = cosine, e = eta] { return "cosine=" + hex(c) + " eta=" + hex(e); });
    }
    return tally.figures();
}

struct CosineAndEta {
    float cosine;
    float eta;
};

float unitCosine(StressInputs& draw) {
    return static_cast<float>(draw.random().uniform(0x1p-10, 1));
}

HardCaseFigures runFresnelNearOne(std::uint64_t inputs, std::uint64_t seed) {
    return runFresnel(inputs, seed, [](StressInputs& draw) {
        return CosineAndEta{unitCosine(draw), static_cast<float>(1 + draw.sign() * draw.magnitude(-24, -2))};
    });
}

HardCaseFigures runFresnelCritical(std::uint64_t inputs, std::uint64_t seed) {
    return runFresnel(inputs, seed, [](StressInputs& draw) {
        const auto eta = static_cast<float>(draw.random().uniform(0.25, 0.99));
        const double critical = std::sqrt((1.0 - eta) * (1.0 + eta));
        return CosineAndEta{static_cast<float>(critical + draw.sign() * draw.magnitude(-26, -6)), eta};
    });
}

HardCaseFigures runFresnelGrazing(std::uint64_t inputs, std::uint64_t seed) {
    return runFresnel(inputs, seed, [](StressInputs& draw) {
        const auto cosine = draw.random().below(8) == 0 ? 0.0f : static_cast<float>(draw.magnitude(-140, -1));
        return CosineAndEta{cosine, static_cast<float>(1 + draw.magnitude(-22, 2))};
    });
}

HardCaseFigures runFresnelOutside(std::uint64_t inputs, std::uint64_t seed) {
    return runFresnel(inputs, seed, [](StressInputs& draw) {
        const double magnitude =
            draw.random().below(2) == 0 ? 1 + draw.magnitude(-23, -12) : draw.random().uniform(0x1p-10, 1);
        return CosineAndEta{static_cast<float>(draw.sign() * magnitude),
                            static_cast<float>(draw.magnitude(-2, 2))};
    });
}

HardCaseFigures runFresnelAnyEta(std::uint64_t inputs, std::uint64_t seed) {
    return runFresnel(inputs, seed, [](StressInputs& draw) {
        return CosineAndEta{static_cast<float>(draw.magnitude(-30, 0)),
                            static_cast<float>(draw.magnitude(-30, 30))};
    });
}

Quad conductorExact(Quad c, Quad eta, Quad k) {
    const Quad s2 = 1 - c * c;
    const Quad t = eta * eta - k * k - s2;
    const Quad sum = squareRoot(t * t + 4 * eta * eta * k * k);
    const Quad a2 = (sum + t) / 2;
    const Quad a = a2 > 0 ? squareRoot(a2) : Quad(0);
    const Quad across = (sum + c * c - 2 * a * c) / (sum + c * c + 2 * a * c);
    const Quad low = c * c * sum + s2 * s2 - 2 * a * c * s2;
    const Quad high = c * c * sum + s2 * s2 + 2 * a * c * s2;
    return across * (1 + low / high) / 2;
}

template <typename Draw>
HardCaseFigures runConductor(std::uint64_t inputs, std::uint64_t seed, const Draw& drawIndex) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto cosine = static_cast<float>(draw.magnitude(-20, 0));
        const vec2 index = drawIndex(draw);
        const Quad exact = conductorExact(cosine, index.x, index.y);
        tally.add(ulpError(fresnelConductorNaive(cosine, index.x, index.y), exact),
                  ulpError(fresnelConductor(cosine, index.x, index.y), exact),
                  [&] { return "cosine=" + hex(cosine) + " index=" + hexPair(index); });
    }
    return tally.figures();
}

HardCaseFigures runConductorNearOne(std::uint64_t inputs, std::uint64_t seed) {
    return runConductor(inputs, seed, [](StressInputs& draw) {
        return vec2(1 + draw.sign() * draw.magnitude(-20, -2), draw.magnitude(-20, -2));
    });
}

HardCaseFigures runConductorAnyIndex(std::uint64_t inputs, std::uint64_t seed) {
    return runConductor(inputs, seed, [](StressInputs& draw) {
        return vec2(draw.magnitude(-12, 12), draw.magnitude(-12, 12));
    });
}

/// |error| of the refracted direction; a wrong decision on total reflection is a failure.
template <typename Draw>
HardCaseFigures runRefract(std::uint64_t inputs, std::uint64_t seed, const Draw& drawCase) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto [d, n, eta] = drawCase(draw);
        const QuadVector exactD(d);
        const QuadVector exactN(n);
        const QuadVector across = crossQuad(exactN, exactD);
        const Quad rest =
            Quad(eta) * eta * dotQuad(exactN, exactN) * dotQuad(exactD, exactD) - dotQuad(across, across);
        double naiveError = 0;
        double stableError = 0;
        const std::optional<vec3> naive = refractNaive(d, n, eta);
        const std::optional<vec3> stable = refract(d, n, eta);
        if (rest < 0) {
            naiveError = naive ? infinity : 0;
            stableError = stable ? infinity : 0;
        } else {
            const Quad root = squareRoot(rest);
            const QuadVector exact = normalizeQuad(crossQuad(across, exactN) +
                                                   (dotQuad(exactN, exactD) < 0 ? -root : root) * exactN);
            const auto errorOf = [&](const std::optional<vec3>& got) {
                if (!got)
                    return infinity;
                const QuadVector difference = QuadVector(*got) - exact;
                return worse(worse(std::abs(static_cast<double>(difference.x)),
                                   std::abs(static_cast<double>(difference.y))),
                             std::abs(static_cast<double>(difference.z)));
            };
            naiveError = errorOf(naive);
            stableError = errorOf(stable);
        }
        tally.add(naiveError, stableError, [&, ray = d, normal = n, e = eta] {
            return "d=" + hexVector(ray) + " n=" + hexVector(normal) + " eta=" + hex(e);
        });
    }
    return tally.figures();
}

struct RayAtBoundary {
    vec3 d;
    vec3 n;
    float eta;
};

/// A ray that meets the normal at an angle.
RayAtBoundary rayAt(StressInputs& draw, double angle, double eta) {
    const dvec3 n = draw.direction();
    const dvec3 d = -std::cos(angle) * n + std::sin(angle) * draw.perpendicular(n);
    return {vec3(d), vec3(n), static_cast<float>(eta)};
}

HardCaseFigures runRefractCritical(std::uint64_t inputs, std::uint64_t seed) {
    return runRefract(inputs, seed, [](StressInputs& draw) {
        const auto eta = static_cast<float>(draw.random().uniform(0.25, 0.99));
        return rayAt(draw, std::asin(static_cast<double>(eta)) + draw.sign() * draw.magnitude(-30, -4), eta);
    });
}

HardCaseFigures runRefractGrazing(std::uint64_t inputs, std::uint64_t seed) {
    return runRefract(inputs, seed, [](StressInputs& draw) {
        return rayAt(draw, 1.5707963267948966 - draw.magnitude(-24, -2), draw.random().uniform(1.01, 3));
    });
}

HardCaseFigures runRefractLengths(std::uint64_t inputs, std::uint64_t seed) {
    return runRefract(inputs, seed, [](StressInputs& draw) {
        const vec3 n = draw.vectorOfMagnitude(-20, 20);
        return RayAtBoundary{draw.vectorOfMagnitude(-20, 20), n, static_cast<float>(draw.magnitude(-2, 2))};
    });
}

/// No bend: the ray goes straight on, its tangential part as it was.
HardCaseFigures runRefractMatched(std::uint64_t inputs, std::uint64_t seed) {
    return runRefract(inputs, seed, [](StressInputs& draw) {
        return rayAt(draw, 1.5707963267948966 - draw.magnitude(-24, -2),
                     1 + draw.sign() * draw.magnitude(-24, -8));
    });
}

// Microfacets

Quad distributionExact(const QuadVector& n, const QuadVector& h, Quad alpha) {
    const Quad nh = dotQuad(n, h);
    const Quad cos2 = nh * nh / (dotQuad(n, n) * dotQuad(h, h));
    const Quad below = cos2 * (alpha * alpha - 1) + 1;
    return alpha * alpha / (quadPi() * below * below);
}

HardCaseFigures runGgxAtLobe(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto alpha = static_cast<float>(draw.magnitude(-13.28, 0));
        const dvec3 n = draw.direction();
        const double angle = std::min(1.5, alpha * draw.magnitude(-3, 3));
        const vec3 normal(n);
        const vec3 half =
            i % 8 == 0 ? normal : vec3(std::cos(angle) * n + std::sin(angle) * draw.perpendicular(n));
        const Quad exact = distributionExact(QuadVector(normal), QuadVector(half), std::max(alpha, 1e-4f));
        tally.add(ulpError(ggxDistributionNaive(normal, half, alpha), exact),
                  ulpError(ggxDistribution(normal, half, alpha), exact), [&] {
                      return "n=" + hexVector(normal) + " h=" + hexVector(half) + " alpha=" + hex(alpha);
                  });
    }
    return tally.figures();
}

/// Widths of 0 and below the least one, which stand for it.
HardCaseFigures runGgxSmooth(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto alpha = i % 2 == 0 ? 0.0f : static_cast<float>(draw.magnitude(-140, -14));
        const dvec3 n = draw.direction();
        const vec3 normal(n);
        const vec3 half = i % 4 < 2 ? normal : vec3(draw.turned(n, -24, -8));
        const Quad exact = distributionExact(QuadVector(normal), QuadVector(half), 1e-4f);
        tally.add(ulpError(ggxDistributionNaive(normal, half, alpha), exact),
                  ulpError(ggxDistribution(normal, half, alpha), exact), [&] {
                      return "n=" + hexVector(normal) + " h=" + hexVector(half) + " alpha=" + hex(alpha);
                  });
    }
    return tally.figures();
}

Quad lambdaExact(Quad cosine, Quad alpha) {
    const Quad tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (squareRoot(1 + alpha * alpha * tangent2) - 1) / 2;
}

struct SmithInput {
    float cosLight;
    float cosEye;
    float alpha;
};

SmithInput drawSmith(StressInputs& draw, double lowestExponent) {
    return {static_cast<float>(draw.magnitude(lowestExponent, 0)),
            static_cast<float>(draw.magnitude(lowestExponent, 0)),
            std::max(1e-4f, static_cast<float>(draw.magnitude(-13.28, 0)))};
}

std::string describe(const SmithInput& in) {
    return "cosLight=" + hex(in.cosLight) + " cosEye=" + hex(in.cosEye) + " alpha=" + hex(in.alpha);
}

HardCaseFigures runSmithG1(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const SmithInput in = drawSmith(draw, -100);
        const Quad exact = 1 / (1 + lambdaExact(in.cosEye, in.alpha));
        tally.add(ulpError(smithG1Naive(in.cosEye, in.alpha), exact),
                  ulpError(smithG1(in.cosEye, in.alpha), exact), [&] { return describe(in); });
    }
    return tally.figures();
}

/// The naive form has no correlation of heights, so that its error is the model's where the cosines are not
/// small.
HardCaseFigures runSmithVisibility(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const SmithInput in = drawSmith(draw, -60);
        const Quad exact = 1 / (1 + lambdaExact(in.cosEye, in.alpha) + lambdaExact(in.cosLight, in.alpha)) /
                           (4 * Quad(in.cosEye) * in.cosLight);
        tally.add(ulpError(smithVisibilityNaive(in.cosLight, in.cosEye, in.alpha), exact),
                  ulpError(smithVisibility(in.cosLight, in.cosEye, in.alpha), exact),
                  [&] { return describe(in); });
    }
    return tally.figures();
}

/// What a sample weighs: G2 / G1 against f cos over the density, in float.
HardCaseFigures runGgxWeight(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const SmithInput in = drawSmith(draw, -60);
        const Quad eye = lambdaExact(in.cosEye, in.alpha);
        const Quad exact = (1 + eye) / (1 + eye + lambdaExact(in.cosLight, in.alpha));
        const float d = ggxDistributionNaive(vec3(0, 0, 1), vec3(0, 0, 1), in.alpha);
        const float value =
            d * (1 / (1 / smithG1Naive(in.cosLight, in.alpha) + 1 / smithG1Naive(in.cosEye, in.alpha) - 1)) /
            (4 * in.cosLight * in.cosEye);
        const float density = d * smithG1Naive(in.cosEye, in.alpha) / (4 * in.cosEye);
        tally.add(
            ulpError(value * in.cosLight / density, exact),
            ulpError(static_cast<float>(ggx::shadowingOfUnmasked(in.cosLight, in.cosEye, in.alpha)), exact),
            [&] { return describe(in); });
    }
    return tally.figures();
}

// Numbers, points, directions

HardCaseFigures runUnitFloat(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // The largest 2^12 outputs of a generator, where rounding reaches 1.
        const auto bits = static_cast<std::uint32_t>(0xffffffffu - draw.random().below(1u << 12));
        const auto errorOf = [&](float got) { return got < 1 ? std::abs(got - bits * 0x1p-32) : infinity; };
        tally.add(errorOf(unitFloatNaive(bits)), errorOf(unitFloat(bits)),
                  [&] { return fmt::format("bits={:#x}", bits); });
    }
    return tally.figures();
}

HardCaseFigures runUniformBetween(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        float low = draw.finiteFloat();
        float high =
            draw.random().below(2) == 0
                ? draw.finiteFloat()
                : static_cast<float>(low + draw.magnitude(-24, 0) * std::abs(static_cast<double>(low)));
        if (low > high)
            std::swap(low, high);
        if (!(low < high) || !std::isfinite(high)) {
            low = 1;
            high = 2;
        }
        const float u = i % 2 == 0 ? 1 - 0x1p-24f : draw.random().uniform();
        const Quad exact = Quad(low) + Quad(u) * (Quad(high) - Quad(low));
        // One more ulp where rounding to nearest would leave the range.
        const auto errorOf = [&](float got) {
            return got >= low && got < high
                       ? absolute(got, exact) /
                             std::max(static_cast<double>(std::max(std::abs(low), std::abs(high))), 0x1p-126)
                       : infinity;
        };
        tally.add(errorOf(uniformBetweenNaive(low, high, u)), errorOf(uniformBetween(low, high, u)),
                  [&] { return "low=" + hex(low) + " high=" + hex(high) + " u=" + hex(u); });
    }
    return tally.figures();
}

/// How far a point lies outside its cell, in cells' widths; a point of 1 is off the square: a failure.
HardCaseFigures runJitter(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto cells = static_cast<std::uint32_t>(
            std::min(0x1p24, std::max(1.0, draw.magnitude(0, i % 2 == 0 ? 11 : 24))));
        const auto cell = static_cast<std::uint32_t>(draw.random().below(cells));
        const float u = i % 4 < 2 ? 1 - 0x1p-24f : i % 4 == 2 ? 0.0f : draw.random().uniform();
        const auto errorOf = [&](float x) {
            const double place = static_cast<double>(x) * cells;  // exact: 48 bits
            if (!(x >= 0 && x < 1))
                return infinity;
            // The cell's end is not in it.
            return place < cell ? cell - place : place >= cell + 1.0 ? place - cell - 1 + 0x1p-40 : 0;
        };
        tally.add(errorOf(jitterCellNaive(cell, cells, u)), errorOf(jitterCell(cell, cells, u)),
                  [&] { return fmt::format("cell={} cells={} u={:a}", cell, cells, u); });
    }
    return tally.figures();
}

/// | |v| − 1 |; below the horizon is a failure.
template <typename Naive, typename Stable>
HardCaseFigures runDirections(std::uint64_t inputs, std::uint64_t seed, const Naive& naive,
                              const Stable& stable) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const float ends[] = {0, 0x1p-149f, 0x1p-24f, 0.5f, 1 - 0x1p-24f, 1};
        const auto number = [&] {
            return draw.random().below(2) == 0 ? ends[draw.random().below(6)] : draw.random().uniform();
        };
        const float x = number();
        const vec2 uv(x, number());
        const auto errorOf = [](vec3 v) {
            const QuadVector exact(v);
            return v.z >= 0 ? absolute(1, lengthQuad(exact)) : infinity;
        };
        tally.add(errorOf(naive(uv)), errorOf(stable(uv)), [&] { return "uv=" + hexPair(uv); });
    }
    return tally.figures();
}

HardCaseFigures runCosineHemisphere(std::uint64_t inputs, std::uint64_t seed) {
    return runDirections(
        inputs, seed, [](vec2 uv) { return sampleCosineHemisphereNaive(uv).direction; },
        [](vec2 uv) { return sampleCosineHemisphere(uv).direction; });
}

/// The sine of the direction against that of the angle asked for, relative, and the density.
HardCaseFigures runTinyCone(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto versine = static_cast<float>(draw.magnitude(-60, 1));
        const vec2 uv(static_cast<float>(draw.random().uniform(0x1p-10, 1)), draw.random().uniform());
        const Quad asked = Quad(versine) * uv.x;
        const Quad sine = squareRoot(asked * (2 - asked));
        const Quad density = 1 / (2 * quadPi() * versine);
        const auto errorOf = [&](const DirectionSample& got) {
            const Quad x = got.direction.x;
            const Quad y = got.direction.y;
            const Quad squared = x * x + y * y;
            if (!(squared > 0))
                return infinity;
            return worse(relative(static_cast<double>(squareRoot(squared)), sine),
                         relative(got.density, density));
        };
        // A sine near 0 opposite to the axis is that of a difference too, for both.
        if (asked > 1.9) {
            tally.add(0, 0, [&] { return "versine=" + hex(versine) + " uv=" + hexPair(uv); });
            continue;
        }
        tally.add(errorOf(sampleConeNaive(versine, uv)), errorOf(sampleCone(versine, uv)),
                  [&] { return "versine=" + hex(versine) + " uv=" + hexPair(uv); });
    }
    return tally.figures();
}

HardCaseFigures runConeOfSphere(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto radius = static_cast<float>(draw.magnitude(-20, 20));
        // Far away, or just outside.
        const auto away = static_cast<float>(i % 2 == 0 ? radius * draw.magnitude(0, 30)
                                                        : radius * (1 + draw.magnitude(-26, 0)));
        double naiveError = 0;
        double stableError = 0;
        const std::optional<float> stable = coneOfSphere(away, radius);
        if (away <= radius) {
            stableError = stable ? infinity : 0;
        } else {
            const Quad sine = Quad(radius) / away;
            const Quad exact = 1 - squareRoot(1 - sine * sine);
            naiveError = ulpError(coneOfSphereNaive(away, radius), exact);
            stableError = stable ? ulpError(*stable, exact) : infinity;
        }
        tally.add(naiveError, stableError,
                  [&] { return "distance=" + hex(away) + " radius=" + hex(radius); });
    }
    return tally.figures();
}

struct TriangleSeen {
    vec3 from;
    vec3 a;
    vec3 b;
    vec3 c;
};

/// A well-shaped triangle of 2^e of its distance, turned up to 70° away.
TriangleSeen drawTriangle(StressInputs& draw, double lowExponent, double highExponent) {
    const dvec3 towards = draw.direction();
    const dvec3 normal = draw.turned(towards, -4, 0.2);
    const dvec3 side = draw.perpendicular(normal);
    const dvec3 up = glm::cross(normal, side);
    const double size = draw.magnitude(lowExponent, highExponent);
    const dvec3 middle = draw.random().uniform(0.5, 2) * towards;
    const double lean = draw.random().uniform(-1, 1);
    return {vec3(0), vec3(middle - size * side), vec3(middle + size * side),
            vec3(middle + size * (lean * side + draw.random().uniform(0.3, 2) * up))};
}

std::string describe(const TriangleSeen& t) {
    return "a=" + hexVector(t.a) + " b=" + hexVector(t.b) + " c=" + hexVector(t.c);
}

struct SphericalQuad {
    QuadVector a;
    QuadVector b;
    QuadVector c;
    Quad area;
};

SphericalQuad exactTriangle(const TriangleSeen& t) {
    SphericalQuad s;
    s.a = normalizeQuad(QuadVector(t.a) - QuadVector(t.from));
    s.b = normalizeQuad(QuadVector(t.b) - QuadVector(t.from));
    s.c = normalizeQuad(QuadVector(t.c) - QuadVector(t.from));
    const Quad volume = dotQuad(s.a, crossQuad(s.b, s.c));
    s.area = 2 * arcTangent(volume < 0 ? -volume : volume,
                            1 + dotQuad(s.a, s.b) + dotQuad(s.b, s.c) + dotQuad(s.c, s.a));
    return s;
}

QuadVector tangentQuad(const QuadVector& at, const QuadVector& other) {
    return normalizeQuad(other - dotQuad(at, other) * at);
}

/// Arvo's formulas, with the angle at a by its tangents.
QuadVector exactSample(const SphericalQuad& s, vec2 uv) {
    const QuadVector towardsB = tangentQuad(s.a, s.b);
    const QuadVector towardsC = tangentQuad(s.a, s.c);
    const QuadVector across = crossQuad(towardsB, towardsC);
    const Quad alpha = arcTangent(lengthQuad(across), dotQuad(towardsB, towardsC));
    const QuadSineCosine atA = sineCosine(alpha);
    const QuadSineCosine rest = sineCosine(Quad(uv.x) * s.area - alpha);
    const Quad u = rest.cosine - atA.cosine;
    const Quad v = rest.sine + atA.sine * dotQuad(s.a, s.b);
    const Quad above = (v * rest.cosine - u * rest.sine) * atA.cosine - v;
    const Quad below = (v * rest.sine + u * rest.cosine) * atA.sine;
    Quad q = above / below;
    q = q > 1 ? Quad(1) : q < -1 ? Quad(-1) : q;
    const QuadVector d = q * s.a + squareRoot(1 - q * q) * towardsC;
    const Quad z = 1 - Quad(uv.y) * (1 - dotQuad(d, s.b));
    return z * s.b + squareRoot(1 - z * z) * tangentQuad(s.b, d);
}

template <int Low, int High>
HardCaseFigures runSolidAngle(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const TriangleSeen t = drawTriangle(draw, Low, High);
        const Quad exact = exactTriangle(t).area;
        tally.add(relative(solidAngleNaive(t.from, t.a, t.b, t.c), exact),
                  relative(solidAngle(t.from, t.a, t.b, t.c), exact), [&] { return describe(t); });
    }
    return tally.figures();
}

template <int Low, int High>
HardCaseFigures runSphericalTriangle(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const TriangleSeen t = drawTriangle(draw, Low, High);
        const vec2 uv(static_cast<float>(draw.random().uniform(0x1p-10, 1)),
                      static_cast<float>(draw.random().uniform(0x1p-10, 1)));
        const QuadVector exact = exactSample(exactTriangle(t), uv);
        tally.add(distance(sampleSphericalTriangleNaive(t.from, t.a, t.b, t.c, uv).direction, exact),
                  distance(sampleSphericalTriangle(t.from, t.a, t.b, t.c, uv).direction, exact),
                  [&] { return describe(t) + " uv=" + hexPair(uv); });
    }
    return tally.figures();
}

HardCaseFigures runPowerHeuristic(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto own = static_cast<float>(draw.magnitude(-126, 127));
        const auto other = static_cast<float>(own * draw.magnitude(-20, 20));
        if (!std::isfinite(other)) {
            tally.add(0, powerHeuristic(own, 0) == 1 ? 0 : infinity, [&] { return "own=" + hex(own); });
            continue;
        }
        const Quad a = Quad(own) * own;
        const Quad exact = a / (a + Quad(other) * other);
        tally.add(ulpError(powerHeuristicNaive(own, other), exact),
                  ulpError(powerHeuristic(own, other), exact),
                  [&] { return "own=" + hex(own) + " other=" + hex(other); });
    }
    return tally.figures();
}

/// What is carried on the average over all 2^24 numbers, relative to what was carried before.
HardCaseFigures runRoulette(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto carried = static_cast<float>(draw.magnitude(-30, 0));
        const vec3 throughput(carried, 0.5f * carried, 0);
        const auto errorOf = [&](const auto& play) {
            // Numbers below some limit go on.
            std::uint32_t lives = 0;
            for (std::uint32_t step = 1u << 24; step != 0; step >>= 1)
                if (lives + step <= 1u << 24 &&
                    play(throughput, static_cast<float>(lives + step - 1) * 0x1p-24f))
                    lives += step;
            if (lives == 0)
                return 1.0;
            return relative(lives * 0x1p-24 * static_cast<double>(play(throughput, 0.0f)->x), carried);
        };
        tally.add(errorOf(playRouletteNaive), errorOf(playRoulette),
                  [&] { return "throughput=" + hex(carried); });
    }
    return tally.figures();
}

// Values of BSDFs

/// How far a value is from what it is with both directions exchanged; infinite where it is no value at all.
template <typename Value>
double asymmetry(const Value& valueOf, vec3 wo, vec3 wi) {
    const double there = valueOf(wo, wi);
    const double back = valueOf(wi, wo);
    if (!(there >= 0 && back >= 0 && std::isfinite(there) && std::isfinite(back)))
        return infinity;
    return there == back ? 0 : std::abs(there - back) / std::max(there, back);
}

/// Directions at the horizon, just below it, opposite to one another, and the same.
HardCaseFigures runGrazingLobes(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const auto direction = [&](bool grazing) {
        dvec3 d = draw.direction();
        if (grazing)
            d.z = draw.magnitude(-40, -3) * (draw.random().below(4) == 0 ? -1 : 1);
        else
            d.z = std::abs(d.z);
        return vec3(glm::normalize(d));
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const vec3 wo = direction(i % 2 == 0);
        const vec3 wi = i % 8 == 1 ? -wo : i % 8 == 3 ? wo : direction(i % 4 != 1);
        const auto exponent = static_cast<float>(draw.magnitude(0, 17));
        const vec3 color(0.5f);
        const std::array<Bsdf, 4> lobes = {PhongBsdf{color, color, exponent},
                                           BlinnPhongBsdf{color, color, exponent},
                                           GgxConductor{color, std::sqrt(2 / (exponent + 2))},
                                           MetallicRoughness{color, color, std::sqrt(2 / (exponent + 2))}};
        double worst = 0;
        for (const Bsdf& lobe : lobes)
            worst = worse(worst, asymmetry([&](vec3 o, vec3 in) { return evaluate(lobe, o, in).g; }, wo, wi));
        tally.add(
            asymmetry([&](vec3 o, vec3 in) { return microfacetLobeNaive(o, in, exponent); }, wo, wi), worst,
            [&] { return "wo=" + hexVector(wo) + " wi=" + hexVector(wi) + " exponent=" + hex(exponent); });
    }
    return tally.figures();
}

// Small lights

HardCaseFigures runPointLight(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const vec3 light = i % 16 == 0 ? vec3(0) : vec3(draw.magnitude(-148, 100) * draw.direction());
        const float radius = 0x1p-30f;
        const QuadVector exact(light);
        const Quad squared = std::max(dotQuad(exact, exact), Quad(radius) * radius);
        const auto errorOf = [&](const LightArrival& got) {
            return isFinite(got.wi) ? ulpError(got.strength, Quad(1) / squared) : infinity;
        };
        tally.add(errorOf(arriveFromPointNaive(light, vec3(0))),
                  errorOf(arriveFromPoint(light, vec3(0), radius)),
                  [&] { return "light=" + hexVector(light); });
    }
    return tally.figures();
}

Quad cosineQuad(Quad angle) {
    return sineCosine(angle).cosine;
}

HardCaseFigures runSpot(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto outer = static_cast<float>(draw.magnitude(-18, 0.5));
        // Also the same cones, and an inner one that is wider.
        const auto inner = static_cast<float>(i % 4 == 0 ? outer : outer * (1.1 - draw.magnitude(-20, 0)));
        const dvec3 axis = draw.direction();
        const double angle = outer * draw.random().uniform(0, 1.2);
        const vec3 direction(axis);
        const vec3 wi(-(std::cos(angle) * axis + std::sin(angle) * draw.perpendicular(axis)));
        const QuadVector a(wi);
        const QuadVector b(direction);
        const Quad cosine = -dotQuad(a, b) / squareRoot(dotQuad(a, a) * dotQuad(b, b));
        const Quad cosOuter = cosineQuad(outer);
        const Quad cosInner = cosineQuad(std::min(inner, outer));
        Quad exact = cosine >= cosInner ? 1 : 0;
        if (cosine > cosOuter && cosine < cosInner) {
            const Quad share = (cosine - cosOuter) / (cosInner - cosOuter);
            exact = share * share * (3 - 2 * share);
        }
        tally.add(absolute(spotShareNaive(wi, direction, inner, outer), exact),
                  absolute(spotShare(wi, direction, inner, outer), exact), [&] {
                      return "wi=" + hexVector(wi) + " axis=" + hexVector(direction) +
                             " inner=" + hex(inner) + " outer=" + hex(outer);
                  });
    }
    return tally.figures();
}

}  // namespace

std::span<const HardCase> boundaryHardCases() {
    static constexpr const char* productForm = "differences multiplied out; Cook, Torrance 1982";
    static constexpr HardCase cases[] = {
        {"fresnelDielectric", "eta 1 ± 2^-24 … 2^-2", "ulp", halfUlp, productForm, &runFresnelNearOne},
        {"fresnelDielectric", "2^-26 … 2^-6 from the critical cosine", "ulp", halfUlp,
         "exact sign of eta² − 1 + cos²", &runFresnelCritical},
        {"fresnelDielectric", "cosines 0 and 2^-140 … 2^-1", "ulp", halfUlp, productForm, &runFresnelGrazing},
        {"fresnelDielectric", "cosines outside [0, 1]", "ulp", halfUlp, "magnitude, at most 1",
         &runFresnelOutside},
        {"fresnelDielectric", "eta 2^-30 … 2^30, grazing", "ulp", halfUlp, productForm, &runFresnelAnyEta},
        {"fresnelConductor", "index within 2^-20 … 2^-2 of 1", "ulp", halfUlp,
         "root of a quadratic that does not cancel", &runConductorNearOne},
        {"fresnelConductor", "eta and k 2^-12 … 2^12, grazing", "ulp", halfUlp,
         "root of a quadratic that does not cancel", &runConductorAnyIndex},
        {"refract", "2^-30 … 2^-4 rad from the critical angle", "component", 3.1e-8,
         "|n × d|², exact where it cancels", &runRefractCritical},
        {"refract", "2^-24 … 2^-2 rad from grazing", "component", 3.1e-8, "|n × d|², exact where it cancels",
         &runRefractGrazing},
        {"refract", "lengths 2^-20 … 2^20, any angle", "component", 3.1e-8, "lengths taken along",
         &runRefractLengths},
        {"refract", "eta 1 ± 2^-24 … 2^-8, grazing", "component", 3.1e-8, "|n × d|², exact where it cancels",
         &runRefractMatched},
    };
    return cases;
}

std::span<const HardCase> microfacetHardCases() {
    static constexpr HardCase cases[] = {
        {"ggxDistribution", "alpha 1e-4 … 1, h within and around the lobe, and on n", "ulp", halfUlp,
         "|n × h|² + alpha² (n·h)²", &runGgxAtLobe},
        {"ggxDistribution", "alpha 0 and 2^-140 … 2^-14", "ulp", halfUlp, "a least alpha", &runGgxSmooth},
        {"evaluate", "grazing, opposite and same directions, exponents 1 … 10^5", "asymmetry, relative", 1e-5,
         "black below the horizon, directions told apart by their cross product", &runGrazingLobes},
        {"smithG1", "cosines 2^-100 … 1", "ulp", halfUlp, "no tangent; Heitz 2014", &runSmithG1},
        {"smithVisibility", "cosines 2^-60 … 1", "ulp", halfUlp, "G2 / (4 cos cos) as one; Heitz 2014",
         &runSmithVisibility},
        {"weight of a GGX sample", "cosines 2^-60 … 1, alpha 1e-4 … 1", "ulp", halfUlp,
         "D cancelled by hand; Heitz 2018", &runGgxWeight},
    };
    return cases;
}

std::span<const HardCase> samplingHardCases() {
    static constexpr HardCase cases[] = {
        {"unitFloat", "the largest 2^12 outputs", "difference", 0x1p-24, "24 bits; Goualard 2020",
         &runUnitFloat},
        {"uniformBetween", "any two floats; neighbours", "relative error", 1.3e-7,
         "in double, kept below the end", &runUniformBetween},
        {"jitterCell", "1 … 2^24 cells, u = 0 and 1 − 2^-24", "cells", 0, "exact products decide",
         &runJitter},
        {"sampleCosineHemisphere", "u, v = 0, 2^-149, 1 − 2^-24, 1", "| |v| − 1 |", 6e-8,
         "√((1 − r)(1 + r)); Shirley, Chiu 1997", &runCosineHemisphere},
        {"sampleCone", "1 − cos 2^-60 … 2", "relative error", 2.5e-7, "1 − cos carried", &runTinyCone},
        {"coneOfSphere", "far away; just outside", "ulp", halfUlp, "s² / (1 + √(1 − s²))", &runConeOfSphere},
        {"solidAngle", "triangles 2^-20 … 2^-4 of their distance", "relative error", 1e-12,
         "Van Oosterom, Strackee 1983", &runSolidAngle<-20, -4>},
        {"solidAngle", "triangles up to 2^14 times their distance", "relative error", 1e-9,
         "Van Oosterom, Strackee 1983", &runSolidAngle<-4, 14>},
        {"sampleSphericalTriangle", "triangles 2^-12 … 2^-4 of their distance", "|error|", 6e-8,
         "tangent of half an angle; after Arvo 1995", &runSphericalTriangle<-12, -4>},
        {"sampleSphericalTriangle", "triangles up to 2^10 times their distance", "|error|", 6e-8,
         "tangent of half an angle; after Arvo 1995", &runSphericalTriangle<-4, 10>},
        {"powerHeuristic", "densities 2^-126 … 2^127", "ulp", halfUlp, "squares in double",
         &runPowerHeuristic},
        {"playRoulette", "throughput 2^-30 … 1", "bias, relative", 6e-8,
         "divided by q, a multiple of 2^-24; Arvo, Kirk 1990", &runRoulette},
        {"arriveFromPoint", "distances 0 and 2^-148 … 2^100", "ulp", halfUlp, "1 / max(d², r²) in double",
         &runPointLight},
        {"spotShare", "cones of 2^-18 … 1.4 rad, alike or crossed", "difference", 5e-8, "1 − cos carried",
         &runSpot},
    };
    return cases;
}

}  // namespace quincunx

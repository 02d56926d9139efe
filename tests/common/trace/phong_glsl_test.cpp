#include "trace/phong_glsl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <boost/multiprecision/mpfr.hpp>
#include <gtest/gtest.h>

#include "base/random.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec3;
using Exact = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60>>;

constexpr double epsilon = 0x1p-24;

struct ExactVector {
    Exact x, y, z;

    explicit ExactVector(const vec3& v) : x(v.x), y(v.y), z(v.z) {}
    ExactVector(Exact a, Exact b, Exact c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
    Exact dot(const ExactVector& o) const { return x * o.x + y * o.y + z * o.z; }
    ExactVector operator*(const Exact& s) const { return {x * s, y * s, z * s}; }
    ExactVector operator+(const ExactVector& o) const { return {x + o.x, y + o.y, z + o.z}; }
    ExactVector operator-(const ExactVector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    ExactVector unit() const { return *this * (1 / sqrt(dot(*this))); }
};

/// Units in the last place of `exact`, as a float, that `computed` is off.
double ulps(float computed, const Exact& exact) {
    const float rounded = exact.convert_to<float>();
    const float magnitude = std::abs(rounded);
    const double ulp = std::max<double>(static_cast<double>(std::nextafter(magnitude, INFINITY)) - magnitude,
                                        std::numeric_limits<float>::denorm_min());
    return abs(Exact(computed) - exact).convert_to<double>() / ulp;
}

float randomBits(Random& random) {
    for (;;) {
        const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
        if (std::isfinite(value))
            return value;
    }
}

float logUniform(Random& random, double low, double high) {
    const double sign = random.below(2) == 0 ? 1 : -1;
    return static_cast<float>(sign * std::exp2(random.uniform(low, high)));
}

/// A unit vector with each component off by half an ulp at most, as shaders get them.
vec3 unitVector(const dvec3& v) {
    return vec3(v / std::sqrt(glm::dot(v, v)));
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
    const dvec3 across = glm::normalize(glm::cross(v, randomDirection(random)));
    return std::cos(angle) * v + std::sin(angle) * across;
}

void expectUnit(const vec3& v, double& worst) {
    const vec3 n = glsl::safeNormalize(v);
    const ExactVector exact = ExactVector(v).unit();
    worst = std::max({worst, ulps(n.x, exact.x), ulps(n.y, exact.y), ulps(n.z, exact.z)});
}

// Measured: 2.3 ulp. The bound: half an ulp each for square root and quotient, 1.5 for the root of
// three squares and two sums.
TEST(SafeNormalize, IsGoodTo2AndAHalfUlpOverTheWholeRange) {
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 60000; ++i)
        expectUnit(
            {logUniform(random, -148, 127), logUniform(random, -148, 127), logUniform(random, -148, 127)},
            worst);
    for (int i = 0; i < 60000; ++i) {
        const double exponent = random.uniform(-148, 126);
        const dvec3 v = randomDirection(random) * std::exp2(exponent);
        if (vec3(v) != vec3(0))
            expectUnit(vec3(v), worst);
    }
    for (int i = 0; i < 60000; ++i)
        expectUnit({randomBits(random), randomBits(random), randomBits(random)}, worst);
    EXPECT_LE(worst, 2.5);
    constexpr float tiny = std::numeric_limits<float>::denorm_min();
    constexpr float huge = std::numeric_limits<float>::max();
    EXPECT_EQ(glsl::safeNormalize({0, tiny, 0}), vec3(0, 1, 0));
    EXPECT_EQ(glsl::safeNormalize({0, 0, -huge}), vec3(0, 0, -1));
    EXPECT_NEAR(glsl::safeNormalize({huge, huge, huge}).x, 1 / std::sqrt(3.0), epsilon);
}

TEST(SafeNormalize, GivesTheZeroVectorWhereThereIsNoDirection) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(glsl::safeNormalize({0, 0, 0}), vec3(0));
    EXPECT_EQ(glsl::safeNormalize({-0.0f, 0, -0.0f}), vec3(0));
    EXPECT_EQ(glsl::safeNormalize({1, infinity, 0}), vec3(0));
    EXPECT_EQ(glsl::safeNormalize({-infinity, infinity, 2}), vec3(0));
    EXPECT_EQ(glsl::safeNormalize({1, 2, nan}), vec3(0));
    EXPECT_EQ(glsl::safeNormalize({nan, nan, -nan}), vec3(0));
}

TEST(ReflectDirection, MirrorsAtThePlane) {
    Random random(2);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const vec3 n = unitVector(randomDirection(random));
        const vec3 d = unitVector(randomDirection(random));
        const vec3 r = glsl::reflectDirection(d, n);
        const ExactVector nn(n);
        const ExactVector exact = ExactVector(d) - nn * (2 * nn.dot(ExactVector(d)));
        const ExactVector off = ExactVector(r) - exact;
        worst = std::max(worst, sqrt(off.dot(off)).convert_to<double>() / epsilon);
    }
    // The dot product of unit vectors is off by 3 ε at most, doubled and times n 6 ε; products and
    // differences round once more a component: below 8 ε. Measured: 4.1 ε.
    EXPECT_LE(worst, 8);
    EXPECT_EQ(glsl::reflectDirection({1, -1, 0}, {0, 1, 0}), vec3(1, 1, 0));
}

TEST(HalfVector, IsFiniteAndUnitUnlessThereIsNone) {
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const dvec3 direction = randomDirection(random);
        const vec3 wi = unitVector(direction);
        EXPECT_EQ(glsl::halfVector(wi, -wi), vec3(0));
        const vec3 wo = unitVector(away(random, -direction, std::exp2(random.uniform(-26, 0))));
        const vec3 h = glsl::halfVector(wi, wo);
        if (wi == -wo)
            EXPECT_EQ(h, vec3(0));
        else
            EXPECT_NEAR(glm::length(dvec3(h)), 1, 4 * epsilon);
    }
}

/// max(0, cos)^exponent for the exact directions of two vectors.
double exactPower(const ExactVector& a, const ExactVector& b, double exponent) {
    const Exact cosine = a.unit().dot(b.unit());
    return cosine > 0 ? pow(cosine, Exact(exponent)).convert_to<double>() : 0;
}

/// The largest errors of cosinePower, and of pow(dot(a, b), exponent), over directions across the highlight.
struct PowerErrors {
    double stable = 0;
    double naive = 0;
};

PowerErrors powerErrors(double exponent) {
    Random random(5);
    PowerErrors worst;
    const double lobe = std::min(1.0, std::sqrt(2 / exponent));
    for (int i = 0; i < 4000; ++i) {
        const dvec3 direction = randomDirection(random);
        const vec3 a = unitVector(direction);
        const vec3 b = unitVector(away(random, direction, random.uniform(0, 3) * lobe));
        const double exact = exactPower(ExactVector(a), ExactVector(b), exponent);
        const float power = static_cast<float>(exponent);
        const double stable = static_cast<double>(glsl::cosinePower(a, b, power));
        const double naive = static_cast<double>(std::pow(std::max(0.0f, glm::dot(a, b)), power));
        worst.stable = std::max(worst.stable, std::abs(stable - exact));
        worst.naive = std::max(worst.naive, std::abs(naive - exact));
    }
    return worst;
}

// The bound of shaders/lib/phong.glsl where the logarithm is good to an ulp.
constexpr double powerBound = 16 * epsilon / std::numbers::e + 2e-8;

TEST(CosinePower, StaysWithinItsBoundWherePowDoesNot) {
    for (const double exponent : {1.0, 2.0, 10.0, 32.0, 100.0, 1e3, 1e4, 1e5}) {
        const PowerErrors worst = powerErrors(exponent);
        EXPECT_LE(worst.stable, powerBound) << exponent;
        if (exponent >= 1e4) {
            EXPECT_GT(worst.naive, 10 * worst.stable) << exponent;
        }
    }
    // Near a right angle a root makes more of the vectors' roundings: (2 ε)^½.
    EXPECT_LE(powerErrors(0.5).stable, std::sqrt(2 * epsilon));
    // Measured at 1e5: 7e-8 against 1.3e-2 for pow(dot(a, b), 1e5).
    EXPECT_GT(powerErrors(1e5).naive, 1e-3);
}

TEST(CosinePower, HasItsLimitsRight) {
    const vec3 x(1, 0, 0);
    for (const float exponent : {0.0f, 1.0f, 1e5f})
        EXPECT_EQ(glsl::cosinePower(x, x, exponent), 1) << exponent;
    EXPECT_EQ(glsl::cosinePower(x, -x, 0), 1);
    EXPECT_EQ(glsl::cosinePower(x, {0, 1, 0}, 0), 1);
    EXPECT_EQ(glsl::cosinePower(x, {0, 1, 0}, 1), 0);
    EXPECT_EQ(glsl::cosinePower(x, -x, 1e5f), 0);
    EXPECT_EQ(glsl::cosinePower(x, {0, 1, 0}, 1e-20f), 0);
}

TEST(Specular, IsZeroUnlessTheLightIsAboveTheHorizon) {
    const vec3 n(0, 0, 1);
    for (const float shininess : {0.0f, 1.0f, 1e5f}) {
        for (const vec3& wi : {vec3(1, 0, 0), vec3(0, 0, -1), vec3(0.6f, 0, -0.8f)}) {
            EXPECT_EQ(glsl::phongSpecular(n, wi, n, shininess), 0);
            EXPECT_EQ(glsl::blinnPhongSpecular(n, wi, n, shininess), 0);
        }
        EXPECT_EQ(glsl::phongSpecular(n, n, n, shininess), 1);
        EXPECT_EQ(glsl::blinnPhongSpecular(n, n, n, shininess), 1);
    }
    EXPECT_EQ(glsl::phongSpecular(n, {0.6f, 0, 0.8f}, {1, 0, 0}, 0), 1);
    EXPECT_EQ(glsl::lambert(n, {0, 0, -1}), 0);
}

TEST(Specular, IsZeroWithoutAHalfVector) {
    const vec3 wi(0.6f, 0, 0.8f);
    for (const float shininess : {0.0f, 1.0f, 1e5f})
        EXPECT_EQ(glsl::blinnPhongSpecular({0, 0, 1}, wi, -wi, shininess), 0);
}

TEST(Specular, IsNeverNegativeAboveOneOrNotANumber) {
    Random random(7);
    for (int i = 0; i < 50000; ++i) {
        const dvec3 normal = randomDirection(random);
        const dvec3 light = away(random, normal, std::numbers::pi / 2 - std::exp2(random.uniform(-30, 1)));
        const vec3 n = unitVector(normal);
        const vec3 wi = unitVector(light);
        const vec3 wo = random.below(2) == 0
                            ? unitVector(randomDirection(random))
                            : unitVector(away(random, -light, std::exp2(random.uniform(-30, 0))));
        const float shininess = random.below(4) == 0 ? 0 : std::abs(logUniform(random, -10, 17));
        for (const float s :
             {glsl::phongSpecular(n, wi, wo, shininess), glsl::blinnPhongSpecular(n, wi, wo, shininess)}) {
            EXPECT_GE(s, 0);
            EXPECT_LE(s, 1);
        }
    }
}

TEST(Specular, FollowsTheClosedFormAcrossTheHighlight) {
    // In a plane through n: light at angle a, eye at angle b on the other side. Phong's angle is |a - b|,
    // Blinn's half of it. Reflecting costs 8 ε, rounding the vectors 2 ε: k = 10 in the bound of cosinePower.
    for (const double shininess : {1.0, 30.0, 1e3, 1e5}) {
        Random random(11);
        for (int i = 0; i < 5000; ++i) {
            const double a = random.uniform(0, 1.5);
            const double b = a + random.uniform(-3, 3) * std::min(0.5, std::sqrt(1 / shininess));
            if (b < -1.5 || a + b > 2.4)  // below the horizon, or the half vector of nearly opposite ones
                continue;
            const vec3 wi(std::sin(a), 0, std::cos(a));
            const vec3 wo(-std::sin(b), 0, std::cos(b));
            const double phong = std::pow(std::max(0.0, std::cos(a - b)), shininess);
            const double blinn = std::pow(std::cos(0.5 * (a - b)), shininess);
            const double bound = 10 * epsilon * std::sqrt(shininess / std::numbers::e) + 1e-6;
            const float power = static_cast<float>(shininess);
            EXPECT_NEAR(glsl::phongSpecular({0, 0, 1}, wi, wo, power), phong, bound);
            EXPECT_NEAR(glsl::blinnPhongSpecular({0, 0, 1}, wi, wo, power), blinn, bound);
        }
    }
}

TEST(LightSample, FallsOffWithTheSquareAndIsFiniteAtTheLight) {
    glsl::PhongLight light{};
    light.kind = 1;
    light.position = vec3(0, 3, 4);
    const glsl::LightSample far = glsl::sampleLight(light, vec3(0));
    EXPECT_NEAR(far.strength, 1 / 25.0, 4 * epsilon / 25);
    EXPECT_NEAR(far.wi.y, 0.6, epsilon);
    Random random(13);
    glsl::PhongMaterial material{vec3(0), vec3(0.8f), vec3(0.5f), vec3(0), 20};
    light.radiance = vec3(1000);
    light.position = vec3(0);
    for (int i = 0; i < 10000; ++i) {
        const vec3 near(logUniform(random, -149, -20), logUniform(random, -149, -20),
                        logUniform(random, -149, -20));
        const vec3 reflected = glsl::reflectLight(material, light, near, {0, 0, 1}, {0, 0, 1}, i % 2 == 0);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_TRUE(std::isfinite(reflected[channel]));
    }
    EXPECT_EQ(glsl::reflectLight(material, light, vec3(0), {0, 0, 1}, {0, 0, 1}, false), vec3(0));
}

TEST(LightSample, SpotsWithoutASoftEdgeAreSharp) {
    const vec3 down(0, -1, 0);
    for (int i = 0; i <= 1000; ++i) {
        const double angle = i * 1e-3;
        const vec3 wi(std::sin(angle), std::cos(angle), 0);
        const float share = glsl::spotShare(wi, down, 0.5f, 0.5f);
        EXPECT_TRUE(share == 0 || share == 1);
        if (i < 499 || i > 501) {
            EXPECT_EQ(share, angle < 0.5 ? 1 : 0) << angle;
        }
    }
    EXPECT_EQ(glsl::spotShare({0, 1, 0}, down, 0, 0), 1);
    // Halfway between the cosines the cubic is one half.
    const double middle = std::acos(0.5 * (std::cos(0.2) + std::cos(0.6)));
    EXPECT_NEAR(glsl::spotShare({std::sin(middle), std::cos(middle), 0}, down, 0.2f, 0.6f), 0.5, 1e-5);
}

}  // namespace
}  // namespace quincunx

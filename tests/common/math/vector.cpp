#include "math/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;
using oracle::Real;
using oracle::RealVector;

/// What math/vector.h calls 0.5 ulp.
constexpr double halfUlp = 0.5 + 0x1p-26;
constexpr float infinity = std::numeric_limits<float>::infinity();
const float notANumber = std::nanf("");
constexpr float largest = std::numeric_limits<float>::max();
constexpr float smallest = std::numeric_limits<float>::denorm_min();

/// Vectors that have no direction.
const std::vector<glm::vec3> directionless = {
    {0, 0, 0},          {-0.0f, 0, -0.0f},  {infinity, 0, 0},         {1, -infinity, 2},
    {notANumber, 1, 1}, {0, 0, notANumber}, {infinity, notANumber, 1}};

template <typename V, typename Exact>
double worstUlps(const V& got, const Exact& exact) {
    return std::max({ulpError(got.x, exact.x), ulpError(got.y, exact.y), ulpError(got.z, exact.z)});
}

double distance(glm::vec3 got, const RealVector& exact) {
    return static_cast<double>(length(RealVector(got) - exact));
}

// Measured: 0.49999 over both kinds of input; `normalizePrescaled` 2.13.
TEST(Normalize, IsRoundedOnceForEverySize) {
    StressInputs draw(1);
    double worst = 0;
    double worstPrescaled = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 v = i % 2 == 0 ? draw.vectorOfMagnitude(-148, 127) : draw.finiteVector();
        const RealVector exact = oracle::normalize(RealVector(v));
        worst = std::max(worst, worstUlps(normalize(v).value(), exact));
        worstPrescaled = std::max(worstPrescaled, worstUlps(normalizePrescaled(v).value(), exact));
    }
    EXPECT_LE(worst, halfUlp);
    EXPECT_LE(worstPrescaled, 2.5);
}

// Measured: 1.90 over 3 · 10⁶.
TEST(Normalize, KeepsItsBoundForDoublesOfEverySize) {
    StressInputs draw(2);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 v = draw.doubleVectorOfMagnitude(-1070, 1020);
        worst = std::max(worst, worstUlps(normalize(v).value(), oracle::normalize(RealVector(v))));
    }
    EXPECT_LE(worst, 2.5);
}

TEST(Normalize, SaysNoWhereThereIsNoDirection) {
    for (const glm::vec3 v : directionless) {
        EXPECT_FALSE(normalize(v).has_value());
        EXPECT_FALSE(normalize(glm::dvec3(v)).has_value());
        EXPECT_FALSE(normalizePrescaled(v).has_value());
        EXPECT_EQ(normalizeOr(v, glm::vec3(0, 1, 0)), glm::vec3(0, 1, 0));
    }
    EXPECT_EQ(normalizeOr(glm::vec3(0, 0, -5), glm::vec3(0, 1, 0)), glm::vec3(0, 0, -1));
}

TEST(Normalize, TakesTheExtremesOfTheRange) {
    EXPECT_EQ(normalize(glm::vec3(0, -smallest, 0)), glm::vec3(0, -1, 0));
    EXPECT_EQ(normalize(glm::vec3(largest, 0, smallest)), glm::vec3(1, 0, 0));
    EXPECT_EQ(normalize(glm::vec3(largest)), normalize(glm::vec3(1)));
    EXPECT_EQ(normalize(glm::vec3(smallest)), normalize(glm::vec3(1)));
    EXPECT_EQ(normalize(glm::dvec3(0x1p-1074, 0, 0)), glm::dvec3(1, 0, 0));
    EXPECT_FALSE(isFinite(normalizeNaive(glm::vec3(smallest))));
}

TEST(Normalize, DoesNotDependOnPowersOfTwoOrOrderOrSign) {
    StressInputs draw(3);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 v = draw.unitVector();
        const auto scale = static_cast<float>(std::exp2(std::floor(draw.random().uniform(-90, 120))));
        const glm::vec3 unit = normalize(v).value();
        ASSERT_EQ(normalize(v * scale), unit);
        ASSERT_EQ(normalize(-v), -unit);
        // Twice normalized is once normalized, within the rounding of the length to 5.2e-8.
        const glm::vec3 again = normalize(unit).value();
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_LE(ulpDistance(again[axis], unit[axis]), 1u);
    }
}

TEST(Length, IsRoundedOnceForEverySize) {
    StressInputs draw(4);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 v = i % 2 == 0 ? draw.vectorOfMagnitude(-148, 126) : draw.finiteVector();
        ASSERT_LE(ulpError(length(v), oracle::length(RealVector(v))), halfUlp);
        const glm::dvec3 d = draw.doubleVectorOfMagnitude(-1070, 1020);
        ASSERT_LE(ulpError(length(d), oracle::length(RealVector(d))), 1.5);
    }
}

TEST(Length, IsInfiniteWhereFloatEndsAndForWhatIsNotANumber) {
    EXPECT_EQ(length(glm::vec3(0)), 0);
    EXPECT_EQ(length(glm::vec3(smallest, 0, 0)), smallest);
    EXPECT_EQ(length(glm::vec3(3e38f, 3e38f, 0)), infinity);
    EXPECT_EQ(length(glm::dvec3(3e38, 4e38, 0)), 5e38);
    for (const glm::vec3 v : directionless) {
        if (v == glm::vec3(0))
            continue;
        EXPECT_EQ(length(v), infinity);
        EXPECT_EQ(length(glm::dvec3(v)), infinity);
    }
}

TEST(Dot, HasTheSignAndTheFirstBitsOfTheExactValue) {
    StressInputs draw(5);
    for (int i = 0; i < 30000; ++i) {
        glm::vec3 a = draw.finiteVector();
        glm::vec3 b = draw.finiteVector();
        if (i % 3 == 1) {
            const glm::dvec3 direction = draw.direction();
            a = glm::vec3(direction);
            b = glm::vec3(draw.perpendicular(direction));
        } else if (i % 3 == 2) {
            // Two products that cancel, beside one that is smaller by up to 2^-200.
            a.y = -a.x;
            b.y = b.x;
            a.z = static_cast<float>(draw.magnitude(-100, 0));
            b.z = static_cast<float>(draw.magnitude(-100, 0));
        }
        const Rational exact = dot(RationalVector(a), RationalVector(b));
        const double got = dotInDouble(a, b);
        ASSERT_EQ(got > 0, exact > 0);
        ASSERT_EQ(got < 0, exact < 0);
        if (exact != 0) {
            ASSERT_LE(abs(Rational((Rational(got) - exact) / exact)), Rational(0x1p-53 * (1 + 0x1p-50)));
        }
        ASSERT_LE(ulpError(dot(a, b), exact), halfUlp);
        ASSERT_EQ(dot(a, b), dot(b, a));
    }
}

TEST(Cross, IsRoundedOnceForNearlyParallelAndForAllVectors) {
    StressInputs draw(6);
    int wronglyZero = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 a = i % 2 == 0 ? glm::vec3(direction) : draw.finiteVector();
        const glm::vec3 b = i % 2 == 0 ? glm::vec3(draw.turned(direction, -23, -1)) : draw.finiteVector();
        const RationalVector exact = cross(RationalVector(a), RationalVector(b));
        const glm::vec3 got = cross(a, b);
        ASSERT_LE(worstUlps(got, exact), halfUlp);
        wronglyZero += i % 2 == 0 && got.x == 0 && exact.x != 0 ? 1 : 0;
        ASSERT_EQ(cross(b, a), -got);
        ASSERT_EQ(cross(a, a), glm::vec3(0));
    }
    EXPECT_EQ(wronglyZero, 0);
}

// Measured: 1.48.
TEST(Cross, KeepsItsBoundForNearlyParallelDoubles) {
    StressInputs draw(7);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 a = draw.direction();
        const glm::dvec3 b = draw.turned(a, -52, -1);
        worst = std::max(worst, worstUlps(cross(a, b), cross(RationalVector(a), RationalVector(b))));
    }
    EXPECT_LE(worst, 1.5);
}

TEST(Angle, IsRoundedOnceFromZeroToPi) {
    StressInputs draw(8);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 a(direction * draw.magnitude(-60, 60));
        const glm::vec3 b(draw.turned(draw.sign() * direction, -22, 0) * draw.magnitude(-60, 60));
        const RealVector exactA(a);
        const RealVector exactB(b);
        const Real exact = atan2(oracle::length(cross(exactA, exactB)), dot(exactA, exactB));
        const float got = angleBetween(a, b).value();
        ASSERT_GT(got, 0);
        worst = std::max(worst, std::abs(static_cast<double>(Real((Real(got) - exact) / exact))));
        ASSERT_EQ(angleBetween(b, a), got);
    }
    EXPECT_LE(worst, 6.0e-8);
}

TEST(Angle, OfParallelOppositeAndDegenerateVectors) {
    const glm::vec3 v(0.1f, -0.7f, 0.3f);
    EXPECT_EQ(angleBetween(v, 4.0f * v), 0.0f);
    EXPECT_EQ(angleBetween(v, -v), 3.14159265f);
    EXPECT_EQ(angleBetween({0, largest, 0}, {smallest, 0, 0}), 1.57079633f);
    for (const glm::vec3 none : directionless) {
        EXPECT_FALSE(angleBetween(v, none).has_value());
        EXPECT_FALSE(angleBetween(none, v).has_value());
    }
}

// Measured: 9.8e-8.
TEST(Basis, IsOrthonormalAndRightHandedAroundEveryDirection) {
    StressInputs draw(9);
    for (int i = 0; i < 50000; ++i) {
        const glm::vec3 n(draw.magnitude(-60, 60) * (i % 2 == 0 ? draw.nearAxis() : draw.direction()));
        const glm::mat3 basis = basisAround(n).value();
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                ASSERT_LE(std::abs(dotInDouble(basis[row], basis[column]) - (row == column ? 1 : 0)), 1.1e-7);
        ASSERT_NEAR(glm::dot(glm::dvec3(basis[0]), crossInDouble(basis[1], basis[2])), 1, 2e-7);
        ASSERT_EQ(basis[2], normalize(n).value());
    }
    for (const glm::vec3 none : directionless)
        EXPECT_FALSE(basisAround(none).has_value());
}

TEST(Reflect, SolvesTheExamsNumbers) {
    // l = (1, 2, 3) points away from the surface of normal (2, 3, 4): r = (51, 62, 73)/29, as long as l.
    const glm::vec3 l(1, 2, 3);
    const glm::vec3 n(2, 3, 4);
    const glm::vec3 r = mirrorDirection(l, n).value();
    const RationalVector exact(Rational(51) / 29, Rational(62) / 29, Rational(73) / 29);
    EXPECT_LE(worstUlps(r, exact), 0.5);  // measured: 0.414
    EXPECT_NEAR(length(glm::dvec3(r)), std::sqrt(14), 3e-7);
    // The other convention, l towards the surface, is the same vector seen from the other end.
    EXPECT_EQ(reflect(-l, n), r);
    EXPECT_EQ(reflect(l, n), -r);
}

TEST(Reflect, IsRoundedOnceForNormalsOfEveryLength) {
    StressInputs draw(10);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 l = draw.vectorOfMagnitude(-10, 10);
        const glm::vec3 n = draw.vectorOfMagnitude(-145, 126);
        const RationalVector exactN(n);
        const RationalVector exact =
            RationalVector(l) - Rational(2 * dot(exactN, RationalVector(l)) / dot(exactN, exactN)) * exactN;
        const glm::vec3 got = reflect(l, n).value();
        const double size = glm::length(glm::dvec3(l));
        for (const double error :
             {static_cast<double>(Rational(got.x - exact.x)), static_cast<double>(Rational(got.y - exact.y)),
              static_cast<double>(Rational(got.z - exact.z))})
            worst = std::max(worst, std::abs(error) / (0x1p-23 * size));
        ASSERT_EQ(reflect(l, -n), got);
    }
    EXPECT_LE(worst, halfUlp);  // measured: 0.49
}

// A float vector that is normalized is off unit length by √3 2^-25 = 5.2e-8 at most. Measured: 5.1e-8; the
// textbook formula alone drifts by 1e-4.
TEST(Reflect, KeepsUnitLengthOverAMillionBounces) {
    StressInputs draw(11);
    glm::vec3 ray = draw.unitVector();
    glm::vec3 naive = ray;
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const glm::vec3 n = draw.unitVector();
        ray = normalize(reflect(ray, n).value()).value();
        naive = reflectNaive(naive, n);
        worst = std::max(worst, std::abs(length(glm::dvec3(ray)) - 1));
    }
    EXPECT_LE(worst, 6e-8);
    EXPECT_GT(std::abs(length(glm::dvec3(naive)) - 1), 1e-6);
}

TEST(Reflect, SaysNoWithoutANormalAndBeyondTheRange) {
    const glm::vec3 l(1, 2, 3);
    for (const glm::vec3 none : directionless) {
        EXPECT_FALSE(reflect(l, none).has_value());
        EXPECT_FALSE(mirrorDirection(l, none).has_value());
    }
    EXPECT_FALSE(reflect({notANumber, 0, 0}, l).has_value());
    EXPECT_FALSE(reflect({infinity, 0, 0}, l).has_value());
    EXPECT_FALSE(reflect({largest, largest, 0}, {-1, -1, 0.5f}).has_value() &&
                 !isFinite(*reflect({largest, largest, 0}, {-1, -1, 0.5f})));
    EXPECT_EQ(reflect(glm::vec3(0), l), glm::vec3(0));
    EXPECT_EQ(reflect({0, -smallest, 0}, {0, smallest, 0}), glm::vec3(0, smallest, 0));
}

// Measured: 5.0e-8.
TEST(HalfVector, IsRoundedOnceHoweverCloseToOpposite) {
    StressInputs draw(12);
    double worst = 0;
    int none = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 wi(direction * draw.magnitude(-40, 40));
        const glm::vec3 wo(draw.turned(draw.sign() * direction, -26, 0.5) * draw.magnitude(-40, 40));
        const RealVector across = cross(RealVector(wi), RealVector(wo));
        const std::optional<glm::vec3> half = halfVector(wi, wo);
        if (dot(across, across) == 0 && dot(RealVector(wi), RealVector(wo)) < 0) {
            ASSERT_FALSE(half.has_value());
            ++none;
            continue;
        }
        ASSERT_TRUE(half.has_value());
        const RealVector exact =
            oracle::normalize(oracle::normalize(RealVector(wi)) + oracle::normalize(RealVector(wo)));
        worst = std::max(worst, distance(*half, exact));
        // Symmetric up to the last rounding.
        ASSERT_LE(glm::length(glm::dvec3(*halfVector(wo, wi)) - glm::dvec3(*half)), 0x1p-23);
    }
    EXPECT_LE(worst, 6e-8);
}

TEST(HalfVector, SaysNoForExactlyOppositeDirections) {
    StressInputs draw(13);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 wi = draw.unitVector();
        ASSERT_FALSE(halfVector(wi, -wi).has_value());
        ASSERT_FALSE(halfVector(wi, -0.25f * wi).has_value());
        ASSERT_LE(glm::distance(*halfVector(wi, 2.0f * wi), wi), 1.3e-7f);
    }
    for (const glm::vec3 none : directionless) {
        EXPECT_FALSE(halfVector(none, {1, 0, 0}).has_value());
        EXPECT_FALSE(halfVector({1, 0, 0}, none).has_value());
    }
    EXPECT_FALSE(isFinite(halfVectorNaive({1, 0, 0}, {-1, 0, 0})));
}

// Measured: 0.49999.
TEST(CosinePower, IsRoundedOnceForExponentsUpToAHundredThousand) {
    StressInputs draw(14);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const auto exponent = static_cast<float>(i % 10 == 0 ? 0 : draw.magnitude(-3, 20));
        const double widest = std::min(1.57, std::sqrt(200.0 / std::max(exponent, 1.0f)));
        const glm::dvec3 direction = draw.direction();
        const double angle = i % 2 == 0 ? draw.random().uniform(0, widest) : widest * draw.magnitude(-30, 0);
        const glm::vec3 a(direction * draw.magnitude(-60, 60));
        const glm::vec3 b((std::cos(angle) * direction + std::sin(angle) * draw.perpendicular(direction)) *
                          draw.magnitude(-60, 60));
        const RealVector exactA(a);
        const RealVector exactB(b);
        const Real cosine = dot(exactA, exactB) / (oracle::length(exactA) * oracle::length(exactB));
        const double error = ulpError(cosinePower(a, b, exponent), Real(pow(cosine, Real(exponent))));
        worst = std::max(worst, error);
    }
    EXPECT_LE(worst, 0.5 + 4e-6);
}

TEST(CosinePower, IsZeroFromNinetyDegreesOnAndOneForExponentZero) {
    EXPECT_EQ(cosinePower({1, 0, 0}, {1, 1, 0}, 0), 1);
    EXPECT_EQ(cosinePower({1, 0, 0}, {1, 0, 0}, 1e5f), 1);
    EXPECT_EQ(cosinePower({3, 0, 0}, {0.5f, 0, 0}, 1e30f), 1);
    EXPECT_EQ(cosinePower({1, 0, 0}, {1, 1, 0}, 2), 0.5f);
    for (const float exponent : {0.0f, 0.5f, 1.0f, 1e5f}) {
        EXPECT_EQ(cosinePower({1, 0, 0}, {0, 1, 0}, exponent), 0);
        EXPECT_EQ(cosinePower({1, 0, 0}, {-1, 1, 0}, exponent), 0);
        for (const glm::vec3 none : directionless)
            EXPECT_EQ(cosinePower(none, {1, 1, 1}, exponent), 0);
    }
    EXPECT_DEATH(cosinePower({1, 0, 0}, {1, 0, 0}, -1), "exponent");
    EXPECT_DEATH(cosinePower({1, 0, 0}, {1, 0, 0}, notANumber), "exponent");
}

TEST(CosinePower, FallsWithTheAngleAndTheExponent) {
    StressInputs draw(15);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 axis(0, 0, 1);
        const double angle = draw.random().uniform(0, 1.5);
        const auto at = [](double a) { return glm::vec3(std::sin(a), 0, std::cos(a)); };
        const auto exponent = static_cast<float>(draw.magnitude(0, 17));
        ASSERT_GE(cosinePower(axis, at(angle), exponent), cosinePower(axis, at(angle + 1e-3), exponent));
        ASSERT_GE(cosinePower(axis, at(angle), exponent), cosinePower(axis, at(angle), exponent * 1.01f));
    }
}

}  // namespace
}  // namespace quincunx

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "math/euler.h"
#include "math/quad_rotation.h"
#include "math/quaternion.h"
#include "math/rotation_hard_cases.h"
#include "math/rotation_interpolation.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Real;
using oracle::RealVector;

constexpr double pi = std::numbers::pi;
constexpr float maxFloat = std::numeric_limits<float>::max();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr double halfUlp = 0.5 + 0x1p-26;

/// Rotations in 300 bits, written as in a book.
struct RealQuaternion {
    Real w;
    RealVector v;

    RealQuaternion(const Real& w_, const RealVector& v_) : w(w_), v(v_) {}
    explicit RealQuaternion(glm::quat q) : w(q.w), v(q.x, q.y, q.z) {}
    explicit RealQuaternion(glm::dquat q) : w(q.w), v(q.x, q.y, q.z) {}
};

Real normOf(const RealQuaternion& q) {
    return sqrt(Real(q.w * q.w + dot(q.v, q.v)));
}

RealQuaternion scaled(const Real& s, const RealQuaternion& q) {
    return {s * q.w, s * q.v};
}

RealQuaternion sum(const RealQuaternion& a, const RealQuaternion& b) {
    return {a.w + b.w, a.v + b.v};
}

RealQuaternion times(const RealQuaternion& a, const RealQuaternion& b) {
    return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}

RealVector turnedBy(const RealQuaternion& q, const RealVector& p) {
    const RealQuaternion inverse = {q.w, Real(-1) * q.v};
    const Real squared = normOf(q) * normOf(q);
    return Real(1 / squared) * times(times(q, {Real(0), p}), inverse).v;
}

RealQuaternion unitOf(const RealQuaternion& q) {
    return scaled(Real(1 / normOf(q)), q);
}

/// cos and sin of θ = acos(a·b), as Shoemake has it, towards the nearer of b and −b.
RealQuaternion slerpOf(const RealQuaternion& from, const RealQuaternion& to, const Real& t) {
    const RealQuaternion a = unitOf(from);
    RealQuaternion b = unitOf(to);
    Real cosine = a.w * b.w + dot(a.v, b.v);
    if (cosine < 0) {
        b = scaled(Real(-1), b);
        cosine = -cosine;
    }
    if (cosine >= 1)
        return a;
    const Real theta = acos(cosine);
    return sum(scaled(Real(sin(Real((1 - t) * theta)) / sin(theta)), a),
               scaled(Real(sin(Real(t * theta)) / sin(theta)), b));
}

double asDouble(const Real& x) {
    return static_cast<double>(x);
}

double ulps(glm::quat got, const RealQuaternion& exact) {
    return std::max(std::max(ulpError(got.w, exact.w), ulpError(got.x, exact.v.x)),
                    std::max(ulpError(got.y, exact.v.y), ulpError(got.z, exact.v.z)));
}

/// The angle between rotations; small ones to full accuracy.
double turnBetween(const RealQuaternion& a, const RealQuaternion& b) {
    const RealQuaternion p = unitOf(a);
    const RealQuaternion q = unitOf(b);
    const double apart = asDouble(normOf(sum(p, scaled(Real(-1), q))));
    const double together = asDouble(normOf(sum(p, q)));
    return 4 * std::asin(std::min(1.0, std::min(apart, together) / 2));
}
double turnBetween(glm::quat a, const RealQuaternion& b) {
    return turnBetween(RealQuaternion(a), b);
}

double distanceOf(glm::vec3 got, const RealVector& exact) {
    return asDouble(oracle::length(RealVector(got) - exact));
}

double awayFromSphere(glm::quat q) {
    return std::abs(asDouble(Real(normOf(RealQuaternion(q)) - 1)));
}

glm::quat randomUnit(StressInputs& draw) {
    return glm::quat(randomRotation(draw));
}

glm::quat ofAnyLength(StressInputs& draw) {
    return glm::quat(randomRotation(draw) * draw.magnitude(-120, 120));
}

glm::quat value(const std::optional<glm::quat>& q) {
    EXPECT_TRUE(q.has_value());
    return q.value_or(glm::quat(0, 0, 0, 0));
}

const glm::quat zero(0, 0, 0, 0);
const glm::quat identity(1, 0, 0, 0);
const std::array<glm::quat, 4> unusable = {zero, glm::quat(infinity, 0, 0, 0),
                                           glm::quat(0, std::nanf(""), 0, 0),
                                           glm::quat(1, 0, -infinity, infinity)};

// The shipped oracle against MPFR.

TEST(QuadRotation, SinesAgreeWithMpfrFarOut) {
    StressInputs draw(1);
    double worst = 0;
    for (int i = 0; i < 4000; ++i) {
        const auto x = static_cast<float>(draw.sign() * draw.magnitude(-40, 40));
        const QuadSineCosine got = sineCosine(x);
        const auto high = static_cast<double>(got.sine);
        const auto low = static_cast<double>(got.sine - high);
        worst = std::max(worst, std::abs(asDouble(Real(Real(high) + Real(low) - sin(Real(x))))));
        const auto highCosine = static_cast<double>(got.cosine);
        const auto lowCosine = static_cast<double>(got.cosine - highCosine);
        worst = std::max(worst, std::abs(asDouble(Real(Real(highCosine) + Real(lowCosine) - cos(Real(x))))));
    }
    EXPECT_LE(worst, 0x1p-100);
}

TEST(QuadRotation, AgreesWithMpfr) {
    StressInputs draw(2);
    double slerps = 0;
    double rotations = 0;
    for (int i = 0; i < 1500; ++i) {
        const glm::quat a = ofAnyLength(draw);
        const glm::quat b = i % 3 == 0 ? glm::quat(turnedInFour(draw, glm::normalize(glm::dquat(a)), -24, -1))
                                       : ofAnyLength(draw);
        const double t = draw.random().uniformDouble();
        const QuadQuaternion got = slerpQuad(QuadQuaternion(a), QuadQuaternion(b), t);
        const RealQuaternion exact = slerpOf(RealQuaternion(a), RealQuaternion(b), t);
        slerps = std::max(slerps, std::abs(asDouble(Real(Real(static_cast<double>(got.w)) - exact.w))));
        slerps = std::max(slerps, std::abs(asDouble(Real(Real(static_cast<double>(got.v.x)) - exact.v.x))));
        const glm::vec3 p = draw.unitVector();
        const QuadVector turned = rotateQuad(QuadQuaternion(a), QuadVector(p));
        const RealVector exactTurned = turnedBy(RealQuaternion(a), RealVector(p));
        rotations = std::max(rotations,
                             std::abs(asDouble(Real(Real(static_cast<double>(turned.y)) - exactTurned.y))));
    }
    // What is seen is the rounding to double, 2^-54.
    EXPECT_LE(slerps, 0x1p-53);
    EXPECT_LE(rotations, 0x1p-53);
}

TEST(QuadRotation, NearestRotationIsThePolarFactor) {
    // R S with a known R.
    StressInputs draw(3);
    for (int i = 0; i < 300; ++i) {
        const glm::quat q = randomUnit(draw);
        const QuadMatrix rotation = matrixQuad(QuadQuaternion(q));
        const QuadVector stretch(draw.magnitude(-3, 3), draw.magnitude(-3, 3), draw.magnitude(-3, 3));
        const QuadMatrix m = {stretch.x * rotation[0], stretch.y * rotation[1], stretch.z * rotation[2]};
        EXPECT_LE(distanceQuad(nearestRotationQuad(m), rotation), 0x1p-90);
    }
}

// Quaternions.

TEST(Quaternion, NormalizesToHalfAnUlpOverTheWholeRange) {
    StressInputs draw(4);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::quat q = i % 2 == 0 ? glm::quat(randomRotation(draw) * draw.magnitude(-148, 127))
                                       : glm::quat(draw.finiteFloat(), draw.finiteFloat(), draw.finiteFloat(),
                                                   draw.finiteFloat());
        if (q == zero)
            continue;
        worst = std::max(worst, ulps(value(normalize(q)), unitOf(RealQuaternion(q))));
    }
    EXPECT_LE(worst, halfUlp);
}

TEST(Quaternion, DoublesNormalizeOverTheWholeRange) {
    StressInputs draw(5);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::dquat q = randomRotation(draw) * draw.magnitude(-1060, 1022);
        const std::optional<glm::dquat> got = normalize(q);
        ASSERT_TRUE(got.has_value());
        const RealQuaternion exact = unitOf(RealQuaternion(q));
        worst = std::max(worst, std::max(ulpError(got->w, exact.w), ulpError(got->z, exact.v.z)));
    }
    EXPECT_LE(worst, 4);  // measured: 2.1
    EXPECT_FALSE(normalize(glm::dquat(0, 0, 0, 0)));
    EXPECT_FALSE(normalize(glm::dquat(std::nan(""), 1, 0, 0)));
    EXPECT_FALSE(normalize(glm::dquat(1, 0, HUGE_VAL, 0)));
}

TEST(Quaternion, HasNoAnswerForZeroAndWhatIsNotFinite) {
    for (const glm::quat q : unusable) {
        EXPECT_FALSE(normalize(q));
        EXPECT_FALSE(inverse(q));
        EXPECT_FALSE(rotate(q, {1, 2, 3}));
        EXPECT_FALSE(matrixFromQuaternion(q));
        EXPECT_FALSE(axisAngleFromQuaternion(q));
        EXPECT_FALSE(rotationVectorFromQuaternion(q));
        EXPECT_FALSE(rotationAngleBetween(q, identity));
        EXPECT_FALSE(rotationAngleBetween(identity, q));
        EXPECT_FALSE(compose(q, identity));
        EXPECT_FALSE(compose(identity, q));
        EXPECT_FALSE(slerp(q, identity, 0.5f));
        EXPECT_FALSE(slerp(identity, q, 0.5f));
        EXPECT_FALSE(nlerp(q, identity, 0.5f));
        EXPECT_FALSE(eulerFromQuaternion(q, EulerOrder::zxy));
    }
    EXPECT_FALSE(rotate(identity, {infinity, 0, 0}));
    EXPECT_FALSE(inverse(glm::quat(0x1p-140f, 0, 0, 0)));  // its inverse is 2^140
}

TEST(Quaternion, InverseTimesItselfIsOne) {
    StressInputs draw(6);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::quat q = glm::quat(randomRotation(draw) * draw.magnitude(-60, 60));
        const glm::quat one = product(value(inverse(q)), q);
        worst = std::max({worst, std::abs(one.w - 1.0), std::abs(double(one.x)), std::abs(double(one.y)),
                          std::abs(double(one.z))});
    }
    // The inverse is rounded: 2^-24 of its length, and the result once more.
    EXPECT_LE(worst, 2 * 0x1p-24);
}

TEST(QuaternionProduct, IsWithinHalfAnUlpAndFourUnitsOfTheLengths) {
    StressInputs draw(7);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::quat a(randomRotation(draw) * draw.magnitude(-50, 50));
        const glm::quat b =
            i % 2 == 0
                ? glm::quat(randomRotation(draw))
                : glm::quat(turnedInFour(draw, glm::conjugate(glm::normalize(glm::dquat(a))), -24, -1));
        const RealQuaternion exact = times(RealQuaternion(a), RealQuaternion(b));
        const glm::quat got = product(a, b);
        const double allowed = 4 * 0x1p-53 * asDouble(normOf(RealQuaternion(a)) * normOf(RealQuaternion(b)));
        const auto excess = [&](float component, const Real& right) {
            const double error = std::abs(asDouble(Real(Real(component) - right)));
            const double ulp = std::scalbn(1.0, std::max(std::ilogb(asDouble(right)), -126) - 23);
            return (error - allowed) / ulp;
        };
        worst = std::max({worst, excess(got.w, exact.w), excess(got.x, exact.v.x), excess(got.y, exact.v.y),
                          excess(got.z, exact.v.z)});
    }
    EXPECT_LE(worst, 0.5);
}

TEST(QuaternionProduct, TurnsAsTheTwoAfterEachOther) {
    StressInputs draw(8);
    double worst = 0;
    double associativity = 0;
    for (int i = 0; i < 5000; ++i) {
        const glm::quat a = randomUnit(draw);
        const glm::quat b = randomUnit(draw);
        const glm::quat c = randomUnit(draw);
        const glm::vec3 p = draw.unitVector();
        const glm::vec3 once = *rotate(product(a, b), p);
        const glm::vec3 twice = *rotate(a, *rotate(b, p));
        worst = std::max(worst, glm::length(glm::dvec3(once) - glm::dvec3(twice)));
        associativity = std::max(associativity, static_cast<double>(*rotationAngleBetween(
                                                    product(product(a, b), c), product(a, product(b, c)))));
    }
    // ab is rounded (a turn of 2^-23), one vector once and the other twice (3 · 2^-24 |p|, all at worst).
    EXPECT_LE(worst, 0x1p-23 + 3 * 0x1p-24);
    EXPECT_LE(associativity, 4 * 0x1p-23);
}

TEST(QuaternionRotation, IsWithin6em8OfTheExactOneForAnyLength) {
    StressInputs draw(9);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::quat q = ofAnyLength(draw);
        const glm::vec3 p = draw.vectorOfMagnitude(-60, 60);
        const std::optional<glm::vec3> got = rotate(q, p);
        ASSERT_TRUE(got.has_value());
        worst = std::max(worst, distanceOf(*got, turnedBy(RealQuaternion(q), RealVector(p))) /
                                    asDouble(oracle::length(RealVector(p))));
    }
    EXPECT_LE(worst, 6e-8);
}

TEST(QuaternionRotation, OfDoublesIsWithinSixteenUnits) {
    StressInputs draw(10);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::dquat q = randomRotation(draw) * draw.magnitude(-1060, 1022);
        const glm::dvec3 p = draw.doubleVectorOfMagnitude(-900, 1000);
        const std::optional<glm::dvec3> got = rotate(q, p);
        ASSERT_TRUE(got.has_value());
        const RealVector off = RealVector(*got) - turnedBy(RealQuaternion(q), RealVector(p));
        worst = std::max(worst, asDouble(Real(oracle::length(off) / oracle::length(RealVector(p)))));
    }
    EXPECT_LE(worst, 16 * 0x1p-53);
}

TEST(QuaternionRotation, IsTheSameForAllMultiples) {
    StressInputs draw(11);
    for (int i = 0; i < 2000; ++i) {
        const glm::quat q = randomUnit(draw);
        const glm::vec3 p = draw.unitVector();
        for (const float factor : {-1.0f, 0x1p-100f, -0x1p100f}) {
            EXPECT_EQ(*rotate(q * factor, p), *rotate(q, p));
            EXPECT_EQ(*matrixFromQuaternion(q * factor), *matrixFromQuaternion(q));
        }
    }
}

TEST(QuaternionRotation, KeepsTheVectorWhereTheResultHasNoRoom) {
    EXPECT_EQ(rotate(identity, glm::vec3(maxFloat, 0, 0)), glm::vec3(maxFloat, 0, 0));
    // Turned by 45°, (max, max, 0) becomes √2 max.
    EXPECT_FALSE(rotate(*quaternionFromAxisAngle({0, 0, 1}, -0.785398f), {maxFloat, maxFloat, 0}));
    EXPECT_EQ(rotate(glm::quat(0, 1, 0, 0), glm::vec3(0, 0x1p-149f, 0)), glm::vec3(0, -0x1p-149f, 0));
}

TEST(QuaternionMatrix, TurnsVectorsAsTheQuaternionDoes) {
    StressInputs draw(12);
    double worst = 0;
    double orthonormality = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::quat q = ofAnyLength(draw);
        const glm::mat3 m = *matrixFromQuaternion(q);
        const glm::vec3 p = draw.unitVector();
        worst = std::max(worst, glm::length(glm::dmat3(m) * glm::dvec3(p) - glm::dvec3(*rotate(q, p))));
        for (int k = 0; k < 3; ++k)
            for (int l = k; l < 3; ++l)
                orthonormality =
                    std::max(orthonormality, std::abs(dotInDouble(m[k], m[l]) - (k == l ? 1 : 0)));
        const std::optional<glm::dmat3> wide = matrixFromQuaternion(glm::dquat(q));
        ASSERT_TRUE(wide.has_value());
        for (int k = 0; k < 3; ++k)
            EXPECT_LE(glm::length((*wide)[k] - glm::dvec3(m[k])), 2 * 0x1p-25);
    }
    EXPECT_LE(worst, 1.3e-7);  // nine entries rounded by up to 2^-25 for |p| = 1, and the vector
    EXPECT_LE(orthonormality, 1.1e-7);
}

TEST(QuaternionMatrix, RoundTripsEveryQuaternionInAllFourBranches) {
    StressInputs draw(13);
    double worst = 0;
    std::array<int, 4> branches{};
    for (int i = 0; i < 20000; ++i) {
        // Every fourth half a turn about an axis or near one.
        glm::quat q = randomUnit(draw);
        if (i % 4 == 0) {
            const glm::dvec3 axis = draw.nearAxis();
            q = glm::quat(i % 8 == 0 ? 0.0f : static_cast<float>(draw.magnitude(-30, -2)), glm::vec3(axis));
        }
        const glm::quat back = value(quaternionFromMatrix(*matrixFromQuaternion(q)));
        worst = std::max(worst, turnBetween(back, RealQuaternion(q)));
        EXPECT_LE(awayFromSphere(back), 5.4e-8);
        EXPECT_GE(back.w, 0);
        const std::array<float, 4> sizes = {std::abs(back.w), std::abs(back.x), std::abs(back.y),
                                            std::abs(back.z)};
        ++branches[static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin())];
    }
    // Rounding the matrix turns it by up to 2^-25 √(3/2) or so, rounding the quaternion by up to 2^-23.
    EXPECT_LE(worst, 1.3e-7);
    for (const int count : branches)
        EXPECT_GT(count, 1000);
}

TEST(QuaternionMatrix, ScaleOfTheMatrixDoesNotMatter) {
    StressInputs draw(14);
    for (int i = 0; i < 2000; ++i) {
        const glm::mat3 m(draw.rotation());
        const glm::quat plain = value(quaternionFromMatrix(m));
        for (const float scale : {0x1p-100f, 0x1p100f, 0x1p-20f})
            EXPECT_EQ(value(quaternionFromMatrix(m * scale)), plain);
        EXPECT_LE(*rotationAngleBetween(value(quaternionFromMatrix(m * 3.7f)), plain), 3e-7);
    }
}

TEST(QuaternionMatrix, TakesThePolarFactorOfWhatIsStretchedOrFlattened) {
    StressInputs draw(15);
    for (const double flattest : {1.0, 0x1p-10, 0x1p-20}) {
        double worst = 0;
        for (int i = 0; i < 1500; ++i) {
            const glm::dmat3 axes = draw.rotation();
            glm::dmat3 stretch(1);
            stretch[1][1] = draw.random().uniform(flattest, 1);
            stretch[2][2] = flattest * draw.random().uniform(0.5, 1);
            const glm::mat3 m(draw.rotation() * axes * stretch * glm::transpose(axes));
            if (determinant(m) <= 0)
                continue;
            const QuadMatrix exact = nearestRotationQuad(toQuad(m));
            worst = std::max(worst,
                             distanceQuad(matrixQuad(QuadQuaternion(value(quaternionFromMatrix(m)))), exact));
        }
        EXPECT_LE(worst, 1.2e-7 + 0x1p-46 / flattest) << flattest;
    }
    // Flattened altogether: the plane that is left still turns.
    const glm::mat3 flat = glm::mat3(0, 1, 0, -1, 0, 0, 0, 0, 0);
    EXPECT_LE(*rotationAngleBetween(value(quaternionFromMatrix(flat)),
                                    *quaternionFromAxisAngle({0, 0, 1}, static_cast<float>(pi / 2))),
              2e-7);
}

TEST(QuaternionMatrix, HasNoAnswerForMirrorsLinesAndPoints) {
    StressInputs draw(16);
    for (int i = 0; i < 500; ++i) {
        const glm::mat3 m(draw.rotation() * draw.magnitude(-20, 20));
        EXPECT_FALSE(quaternionFromMatrix(m * -1.0f));
        EXPECT_FALSE(quaternionFromMatrix(glm::mat3(m[1], m[0], m[2])));
        const glm::vec3 a = draw.unitVector();
        EXPECT_FALSE(quaternionFromMatrix(glm::mat3(a, 2.0f * a, -0.5f * a)));
    }
    EXPECT_FALSE(quaternionFromMatrix(glm::mat3(0)));
    EXPECT_FALSE(quaternionFromMatrix(glm::mat3(std::nanf(""))));
    EXPECT_FALSE(quaternionFromMatrix(glm::mat3(infinity)));
    EXPECT_FALSE(nearestQuaternion(glm::dmat3(0)));
    EXPECT_FALSE(nearestQuaternion(glm::dmat3(-1)));
    EXPECT_FALSE(nearestQuaternion(glm::dmat3(std::nan(""))));
}

TEST(QuaternionDrift, MillionProductsStayOnTheSphere) {
    // The same turn again and again: its rounding adds up where nobody makes it unit length.
    const glm::quat turn = *quaternionFromAxisAngle({1, 2, 3}, 0.01f);
    glm::quat naive = identity;
    glm::quat stable = identity;
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        naive = productNaive(turn, naive);
        stable = *compose(turn, stable);
        worst = std::max(worst, std::abs(std::sqrt(squaredNorm(stable)) - 1));
    }
    EXPECT_LE(worst, 5.4e-8);
    EXPECT_GT(std::abs(std::sqrt(squaredNorm(naive)) - 1), 1e-3);
    // Where it ends: each step may turn by 2^-23 more.
    const AxisAngle exactTurn = *axisAngleFromQuaternion(turn);
    const double expected = 1e6 * 2 * std::atan2(std::sqrt(squaredNorm({0, turn.x, turn.y, turn.z})), turn.w);
    const glm::dvec3 v = std::sin(expected / 2) * glm::dvec3(exactTurn.axis);
    EXPECT_LE(*rotationAngleBetween(stable, glm::quat(glm::dquat(std::cos(expected / 2), v.x, v.y, v.z))),
              1e6 * 0x1p-23);
}

// Axis and angle.

TEST(AxisAngle, IsRightForEveryAngleAndAxis) {
    StressInputs draw(17);
    double worst = 0;
    double matrices = 0;
    for (int i = 0; i < 8000; ++i) {
        const glm::vec3 axis = i % 2 == 0 ? draw.vectorOfMagnitude(-148, 127) : draw.finiteVector();
        const float radians =
            i % 3 == 0 ? draw.finiteFloat() : static_cast<float>(draw.sign() * draw.magnitude(-140, 20));
        const Real half = Real(radians) / 2;
        const RealQuaternion exact(cos(half), Real(sin(half)) * oracle::normalize(RealVector(axis)));
        worst = std::max(worst, ulps(value(quaternionFromAxisAngle(axis, radians)), exact));
        const glm::mat3 m = *matrixFromAxisAngle(axis, radians);
        for (int k = 0; k < 3; ++k) {
            RealVector unit(Real(0), Real(0), Real(0));
            (k == 0 ? unit.x : k == 1 ? unit.y : unit.z) = 1;
            matrices = std::max(matrices, distanceOf(m[k], turnedBy(exact, unit)));
        }
    }
    EXPECT_LE(worst, halfUlp);
    EXPECT_LE(matrices, 1.8 * 0x1p-25);  // three entries
}

TEST(AxisAngle, SpecialAnglesAreWhatTheyShouldBe) {
    EXPECT_EQ(value(quaternionFromAxisAngle({0, 0, 5}, 0)), identity);
    const float floatPi = static_cast<float>(pi);
    // cos of float π/2 is 4.4e-8 off zero, as it must be.
    EXPECT_LE(std::abs(value(quaternionFromAxisAngle({0, 3, 0}, floatPi)).w), 5e-8f);
    EXPECT_EQ(value(quaternionFromAxisAngle({0, 3, 0}, floatPi)).y, 1);
    EXPECT_EQ(value(quaternionFromAxisAngle({0, 3, 0}, 2 * floatPi)).w, -1);
    EXPECT_FALSE(quaternionFromAxisAngle({0, 0, 0}, 1));
    EXPECT_FALSE(quaternionFromAxisAngle({0, 0, 1}, infinity));
    EXPECT_FALSE(quaternionFromAxisAngle({0, std::nanf(""), 1}, 1));
    EXPECT_FALSE(rotateAboutAxis({1, 2, 3}, {0, 0, 0}, 1));
    EXPECT_FALSE(rotateAboutAxis({1, infinity, 3}, {0, 0, 1}, 1));
    EXPECT_FALSE(matrixFromAxisAngle({0, 0, 0}, 1));
}

TEST(AxisAngle, RodriguesAgreesWithTheSandwich) {
    StressInputs draw(18);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 axis = draw.vectorOfMagnitude(-100, 100);
        const glm::vec3 p = draw.vectorOfMagnitude(-60, 60);
        const auto radians = static_cast<float>(draw.sign() * draw.magnitude(-40, 20));
        const Real half = Real(radians) / 2;
        const RealVector exact =
            turnedBy({cos(half), Real(sin(half)) * oracle::normalize(RealVector(axis))}, RealVector(p));
        worst = std::max(worst, distanceOf(*rotateAboutAxis(p, axis, radians), exact) /
                                    asDouble(oracle::length(RealVector(p))));
    }
    EXPECT_LE(worst, 6e-8);
}

TEST(AxisAngle, ExtractionKeepsTheSmallestTurns) {
    StressInputs draw(19);
    double angles = 0;
    double axes = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::quat q(static_cast<float>(draw.sign() * draw.magnitude(-60, 1)),
                          draw.vectorOfMagnitude(-90, 30));
        const AxisAngle got = *axisAngleFromQuaternion(q);
        const RealQuaternion exact(q);
        const Real sine = oracle::length(exact.v);
        const Real angle = 2 * atan2(sine, Real(abs(exact.w)));
        angles = std::max(angles, ulpError(got.radians, angle));
        const RealVector axis = Real((q.w < 0 ? -1 : 1) / sine) * exact.v;
        axes = std::max(
            {axes, ulpError(got.axis.x, axis.x), ulpError(got.axis.y, axis.y), ulpError(got.axis.z, axis.z)});
        EXPECT_GE(got.radians, 0);
        EXPECT_LE(got.radians, static_cast<float>(pi));
    }
    EXPECT_LE(angles, halfUlp);
    EXPECT_LE(axes, halfUlp);
    EXPECT_EQ(axisAngleFromQuaternion(identity)->radians, 0);
    EXPECT_EQ(axisAngleFromQuaternion(glm::quat(-3, 0, 0, 0))->axis, glm::vec3(1, 0, 0));
}

TEST(RotationVector, IsTheExponentialAndTheLogarithm) {
    StressInputs draw(20);
    double exponentials = 0;
    double logarithms = 0;
    for (int i = 0; i < 8000; ++i) {
        const glm::vec3 r = draw.vectorOfMagnitude(-148, 3);
        const Real angle = oracle::length(RealVector(r));
        const RealQuaternion exact(cos(Real(angle / 2)), Real(sin(Real(angle / 2)) / angle) * RealVector(r));
        exponentials = std::max(exponentials, ulps(value(quaternionFromRotationVector(r)), exact));
        const glm::quat q = i % 2 == 0 ? value(quaternionFromRotationVector(r)) : ofAnyLength(draw);
        const RealQuaternion unit(q);
        const Real sine = oracle::length(unit.v);
        if (sine == 0)
            continue;
        const Real turn = (q.w < 0 ? -2 : 2) * atan2(sine, Real(abs(unit.w)));
        const RealVector exactR = Real(turn / sine) * unit.v;
        const glm::vec3 got = *rotationVectorFromQuaternion(q);
        logarithms = std::max(
            {logarithms, ulpError(got.x, exactR.x), ulpError(got.y, exactR.y), ulpError(got.z, exactR.z)});
    }
    EXPECT_LE(exponentials, halfUlp);
    EXPECT_LE(logarithms, halfUlp);
    EXPECT_EQ(value(quaternionFromRotationVector(glm::vec3(0))), identity);
    EXPECT_EQ(*rotationVectorFromQuaternion(glm::quat(-2, 0, 0, 0)), glm::vec3(0));
    EXPECT_FALSE(quaternionFromRotationVector({0, infinity, 0}));
    EXPECT_TRUE(isFinite(value(quaternionFromRotationVector(glm::vec3(maxFloat)))));
}

// Shortest arc and angle.

TEST(ShortestArc, IsRightToHalfAnUlpForAnyTwoDirections) {
    StressInputs draw(21);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::dvec3 direction = draw.direction();
        const double far = i % 2 == 0 ? 0 : 100;  // every other pair of unit length
        const glm::vec3 from(draw.magnitude(-far, far) * direction);
        const glm::vec3 to(draw.magnitude(-far, far) *
                           (i % 3 == 0 ? draw.direction() : draw.turned(draw.sign() * direction, -40, 0)));
        const RealVector a = oracle::normalize(RealVector(from));
        const RealVector b = oracle::normalize(RealVector(to));
        const RealVector across = cross(a, b);
        if (oracle::length(across) == 0)
            continue;
        const RealQuaternion exact = unitOf({Real(1 + dot(a, b)), across});
        worst = std::max(worst, ulps(value(shortestArc(from, to)), exact));
    }
    EXPECT_LE(worst, 0.501);
}

TEST(ShortestArc, TakesADefinedHalfTurnBetweenOpposites) {
    StressInputs draw(22);
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 from = i % 2 == 0 ? draw.vectorOfMagnitude(-100, 100) : glm::vec3(draw.nearAxis());
        const glm::quat q = value(shortestArc(from, -4.0f * from));
        EXPECT_EQ(q.w, 0);
        const glm::vec3 unit = *normalize(from);
        // The axis is rounded (a half turn doubles that), the turned vector and the unit one too.
        EXPECT_LE(glm::length(glm::dvec3(*rotate(q, unit)) + glm::dvec3(unit)), 2 * 6e-8 + 6e-8);
        EXPECT_EQ(value(shortestArc(from, from)), identity);
    }
    EXPECT_FALSE(shortestArc({0, 0, 0}, {0, 0, 1}));
    EXPECT_FALSE(shortestArc({0, 1, 0}, {0, 0, infinity}));
}

TEST(RotationAngle, KeepsSmallAnglesAndForgetsSigns) {
    StressInputs draw(23);
    for (int i = 0; i < 5000; ++i) {
        const glm::quat a = ofAnyLength(draw);
        const glm::quat b(turnedInFour(draw, glm::normalize(glm::dquat(a)), -22, 0));
        const double exact = turnBetween(a, RealQuaternion(b));
        const double got = *rotationAngleBetween(a, b);
        EXPECT_LE(std::abs(got - exact), 6e-8 * exact + 0x1p-51);
        EXPECT_EQ(*rotationAngleBetween(a, -b), *rotationAngleBetween(a, b));
        EXPECT_EQ(*rotationAngleBetween(b, a), *rotationAngleBetween(a, b));
        EXPECT_EQ(*rotationAngleBetween(a, a), 0);
    }
    EXPECT_NEAR(*rotationAngleBetween(identity, {0, 0, 1, 0}), pi, 1e-7);
}

// Interpolation.

TEST(ChordParameter, LevelsEncloseTheLimitAndDivideTheErrorBySix) {
    std::vector<double> worst(15);
    for (int i = 0; i <= 100; ++i)
        for (int j = 0; j <= 50; ++j) {
            const double s = i / 50.0 - 1;
            const double k = j / 50.0;
            const double root = std::sqrt(k);
            const double limit = k > 0 ? std::tan(s * std::atan(root)) / root : s;
            const std::array<double, 6> levels = {chordParameter<0>(s, k), chordParameter<1>(s, k),
                                                  chordParameter<2>(s, k), chordParameter<3>(s, k),
                                                  chordParameter<5>(s, k), chordParameter<11>(s, k)};
            for (std::size_t level = 0; level < levels.size(); ++level)
                worst[level] = std::max(worst[level], std::abs(levels[level] - limit));
            // Even and odd levels lie on either side.
            if (std::abs(s) > 0.01 && std::abs(s) < 0.99 && k > 0.05) {
                EXPECT_GT(std::abs(levels[0]), std::abs(limit));
                EXPECT_LT(std::abs(levels[1]), std::abs(limit));
                EXPECT_GT(std::abs(levels[2]), std::abs(limit));
            }
            EXPECT_NEAR(chordParameter<5>(static_cast<float>(s), static_cast<float>(k)), levels[4], 4e-7);
        }
    EXPECT_LE(worst[0], 0.091);
    EXPECT_LE(worst[1], 0.0151);
    EXPECT_LE(worst[2], 2.6e-3);
    EXPECT_LE(worst[3], 4.4e-4);
    EXPECT_LE(worst[4], 1.3e-5);
    EXPECT_LE(worst[5], 3.4e-10);
    EXPECT_EQ(chordParameter<11>(1.0, 0.7), 1);
    EXPECT_EQ(chordParameter<11>(-1.0, 1.0), -1);
    EXPECT_EQ(chordParameter<11>(0.0, 1.0), 0);
}

TEST(Slerp, IsWithinTheRoundingOfTheExactRotation) {
    StressInputs draw(24);
    double worst = 0;
    double sphere = 0;
    for (int i = 0; i < 6000; ++i) {
        const glm::quat a = ofAnyLength(draw);
        const glm::quat b =
            i % 3 == 0 ? ofAnyLength(draw)
                       : glm::quat(turnedInFour(draw, glm::normalize(glm::dquat(a)), -24, 1) * draw.sign());
        const auto t = static_cast<float>(draw.random().uniform(0, 1));
        const glm::quat got = value(slerp(a, b, t));
        worst = std::max(worst, turnBetween(got, slerpOf(RealQuaternion(a), RealQuaternion(b), Real(t))));
        sphere = std::max(sphere, awayFromSphere(got));
    }
    EXPECT_LE(worst, 1.2e-7);  // measured: 9e-8
    EXPECT_LE(sphere, 5.4e-8);
}

TEST(Slerp, EndsAreTheEndsAndOppositesTheSame) {
    StressInputs draw(25);
    for (int i = 0; i < 3000; ++i) {
        const glm::quat a = ofAnyLength(draw);
        const glm::quat b = ofAnyLength(draw);
        EXPECT_EQ(*slerp(a, b, 0), *normalize(a));
        const glm::quat end = *slerp(a, b, 1);
        EXPECT_LE(*rotationAngleBetween(end, b), 0x1p-22);
        const auto t = static_cast<float>(draw.random().uniform(-3, 4));
        EXPECT_EQ(*slerp(a, -b, t), *slerp(a, b, t));
        EXPECT_EQ(*slerp(-a, b, t), -*slerp(a, b, t));
        EXPECT_EQ(*slerp(a, a, t), *normalize(a));
        EXPECT_EQ(*slerp(a, -a, t), *normalize(a));
    }
}

TEST(Slerp, MovesAtConstantSpeedAndNeverBack) {
    StressInputs draw(26);
    for (int i = 0; i < 200; ++i) {
        const glm::quat a = randomUnit(draw);
        const glm::quat b = randomUnit(draw);
        const double whole = *rotationAngleBetween(a, b);
        double last = 0;
        for (int step = 0; step <= 64; ++step) {
            const auto t = static_cast<float>(step) / 64;
            const double angle = *rotationAngleBetween(a, *slerp(a, b, t));
            EXPECT_GE(angle, last - 0x1p-22);
            EXPECT_NEAR(angle, t * whole, 3e-7);
            last = angle;
        }
    }
}

TEST(Slerp, GoesOnBeyondTheEnds) {
    StressInputs draw(27);
    for (int i = 0; i < 2000; ++i) {
        const glm::quat a = randomUnit(draw);
        const glm::quat b = randomUnit(draw);
        const auto t = static_cast<float>(draw.sign() * draw.magnitude(0, 20));
        const double error =
            turnBetween(value(slerp(a, b, t)), slerpOf(RealQuaternion(a), RealQuaternion(b), Real(t)));
        EXPECT_LE(error, 1.2e-7 + 0x1p-49 * std::abs(t));
        EXPECT_TRUE(isFinite(value(slerp(a, b, maxFloat))));
        EXPECT_FALSE(slerp(a, b, infinity));
        EXPECT_FALSE(slerp(a, b, std::nanf("")));
    }
}

TEST(Slerp, ChoosesTheSideExactlyAtHalfATurn) {
    // a·b = ±2^-60 by way of components that cancel: both ways round are half a turn, but one is shorter.
    const glm::quat a(1, 1, 0x1p-30f, 0);
    for (const float tiny : {0x1p-30f, -0x1p-30f}) {
        const glm::quat b(1, -1, tiny, 1);
        const glm::quat between = value(slerp(a, b, 0.5f));
        const glm::quat other = tiny > 0 ? b : -b;
        const RealQuaternion exact = sum(unitOf(RealQuaternion(a)), unitOf(RealQuaternion(other)));
        EXPECT_LE(turnBetween(between, exact), 1.2e-7);
    }
}

TEST(Slerp, ByAngleAgreesInDouble) {
    StressInputs draw(28);
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
        const glm::dquat a = *normalize(randomRotation(draw));
        const glm::dquat b = *normalize(i % 2 == 0 ? randomRotation(draw) : turnedInFour(draw, a, -40, 0));
        const double t = draw.random().uniformDouble();
        worst = std::max(worst, turnBetween(RealQuaternion(slerpByAngle(a, b, t)),
                                            slerpOf(RealQuaternion(a), RealQuaternion(b), Real(t))));
    }
    EXPECT_LE(worst, 1e-15);
}

TEST(Slerp, FewerLevelsAreFartherOff) {
    StressInputs draw(29);
    std::array<double, 4> worst{};
    std::array<double, 4> fast{};
    for (int i = 0; i < 20000; ++i) {
        const glm::quat a = randomUnit(draw);
        const glm::quat b = randomUnit(draw);
        const auto t = static_cast<float>(draw.random().uniform(0, 1));
        const glm::quat right = *slerp(a, b, t);
        const std::array<glm::quat, 4> got = {*slerpTruncated<0>(a, b, t), *slerpTruncated<1>(a, b, t),
                                              *slerpTruncated<2>(a, b, t), *slerpTruncated<3>(a, b, t)};
        const std::array<glm::quat, 4> got32 = {slerpFast<0>(a, b, t), slerpFast<1>(a, b, t),
                                                slerpFast<2>(a, b, t), slerpFast<3>(a, b, t)};
        for (std::size_t level = 0; level < got.size(); ++level) {
            worst[level] = std::max<double>(worst[level], *rotationAngleBetween(got[level], right));
            fast[level] = std::max<double>(fast[level], *rotationAngleBetween(got32[level], right));
        }
    }
    // The largest errors over all s at k = 1, rotations 180° apart.
    static constexpr std::array<double, 4> limits = {0.1423, 0.0246, 0.0042, 7.2e-4};
    for (std::size_t level = 0; level < worst.size(); ++level) {
        EXPECT_LE(worst[level], limits[level] + 3e-7);
        EXPECT_GE(worst[level], 0.7 * limits[level]);
        EXPECT_LE(fast[level], limits[level] + 1e-6);
    }
}

TEST(Nlerp, IsTheNormalizedChord) {
    StressInputs draw(30);
    for (int i = 0; i < 4000; ++i) {
        const glm::quat a = ofAnyLength(draw);
        const glm::quat b = ofAnyLength(draw);
        const auto t = static_cast<float>(draw.random().uniform(0, 1));
        const RealQuaternion p = unitOf(RealQuaternion(a));
        RealQuaternion q = unitOf(RealQuaternion(b));
        if (p.w * q.w + dot(p.v, q.v) < 0)
            q = scaled(Real(-1), q);
        const glm::quat got = value(nlerp(a, b, t));
        EXPECT_LE(turnBetween(got, sum(scaled(Real(1 - t), p), scaled(Real(t), q))), 1.2e-7);
        EXPECT_LE(awayFromSphere(got), 5.4e-8);
        EXPECT_EQ(*nlerp(a, b, -1), *nlerp(a, b, 0));
        EXPECT_EQ(*nlerp(a, b, 7), *nlerp(a, b, 1));
    }
    EXPECT_FALSE(nlerp(identity, identity, std::nanf("")));
}

TEST(Nlerp, LiesOnTheArcOfSlerp) {
    StressInputs draw(31);
    for (int i = 0; i < 2000; ++i) {
        const glm::quat a = randomUnit(draw);
        const glm::quat b = randomUnit(draw);
        const double whole = *rotationAngleBetween(a, b);
        const glm::quat between = *nlerp(a, b, static_cast<float>(draw.random().uniform(0, 1)));
        EXPECT_NEAR(*rotationAngleBetween(a, between) + *rotationAngleBetween(between, b), whole, 1e-6);
    }
}

TEST(MatrixLerp, LiesOnTheArcOfSlerpAtItsOwnSpeed) {
    StressInputs draw(32);
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 axis = draw.direction();
        const auto whole = static_cast<float>(draw.random().uniform(0, 2.5));
        const auto t = static_cast<float>(draw.random().uniform(0, 1));
        const glm::mat3 a(draw.rotation());
        const glm::mat3 b(glm::dmat3(*matrixFromAxisAngle(glm::vec3(axis), whole)) * glm::dmat3(a));
        const glm::quat between = value(matrixLerp(a, b, t));
        // The argument of (1 − t) + t e^{iθ}.
        const double angle = std::atan2(t * std::sin(whole), (1 - t) + t * std::cos(whole));
        EXPECT_NEAR(*rotationAngleBetween(value(quaternionFromMatrix(a)), between), angle, 1e-6);
    }
    const glm::mat3 half = *matrixFromQuaternion(glm::quat(0, 0, 0, 1));
    EXPECT_FALSE(matrixLerp(glm::mat3(1), half, 0.5f));
    EXPECT_TRUE(matrixLerp(glm::mat3(1), half, 0.499f));
}

// Euler angles.

EulerAngles randomAngles(StressInputs& draw) {
    const auto angle = [&] { return static_cast<float>(draw.random().uniform(-pi, pi)); };
    return {angle(), angle(), angle()};
}

RealQuaternion realFromEuler(EulerAngles angles, EulerOrder order) {
    RealQuaternion product(Real(1), RealVector(Real(0), Real(0), Real(0)));
    for (const int axis : eulerAxes(order)) {
        const Real half = Real(angles.about(axis)) / 2;
        RealQuaternion turn(cos(half), RealVector(Real(0), Real(0), Real(0)));
        (axis == 0 ? turn.v.x : axis == 1 ? turn.v.y : turn.v.z) = sin(half);
        product = times(product, turn);
    }
    return product;
}

TEST(Euler, MatrixAndQuaternionAreTheProductOfThreeTurns) {
    StressInputs draw(33);
    double quaternions = 0;
    double matrices = 0;
    for (int i = 0; i < 3000; ++i)
        for (const EulerOrder order : eulerOrders) {
            EulerAngles angles = randomAngles(draw);
            if (i % 5 == 0)
                angles.head = draw.finiteFloat();  // turns without number are turns too
            const RealQuaternion exact = realFromEuler(angles, order);
            const glm::quat q = *quaternionFromEuler(angles, order);
            quaternions = std::max(quaternions, turnBetween(q, exact));
            const glm::mat3 m = *matrixFromEuler(angles, order);
            matrices = std::max(
                matrices,
                distanceOf(m[i % 3],
                           turnedBy(exact, RealVector(glm::vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2)))));
        }
    EXPECT_LE(quaternions, 1.2e-7);
    EXPECT_LE(matrices, 1.8 * 0x1p-25);
    EXPECT_FALSE(matrixFromEuler({infinity, 0, 0}, EulerOrder::xyz));
    EXPECT_FALSE(quaternionFromEuler({0, std::nanf(""), 0}, EulerOrder::xyz));
}

TEST(Euler, OrdersReadLeftToRightAsMatrixProducts) {
    const EulerAngles angles{0.3f, 0.5f, 0.7f};
    const glm::dmat3 head(*matrixFromAxisAngle({0, 1, 0}, angles.head));
    const glm::dmat3 pitch(*matrixFromAxisAngle({1, 0, 0}, angles.pitch));
    const glm::dmat3 roll(*matrixFromAxisAngle({0, 0, 1}, angles.roll));
    const std::array<glm::dmat3, 6> products = {pitch * head * roll, pitch * roll * head,
                                                head * pitch * roll, head * roll * pitch,
                                                roll * pitch * head, roll * head * pitch};
    for (std::size_t i = 0; i < eulerOrders.size(); ++i)
        for (int column = 0; column < 3; ++column)
            EXPECT_LE(glm::length(glm::dvec3((*matrixFromEuler(angles, eulerOrders[i]))[column]) -
                                  products[i][column]),
                      3e-7)
                << eulerOrderName(eulerOrders[i]);
}

TEST(Euler, RoundTripsEveryRotationInEveryOrder) {
    StressInputs draw(34);
    double worst = 0;
    for (int i = 0; i < 3000; ++i)
        for (const EulerOrder order : eulerOrders) {
            const glm::quat q = ofAnyLength(draw);
            const std::optional<EulerAngles> angles = eulerFromQuaternion(q, order);
            ASSERT_TRUE(angles.has_value());
            worst = std::max(worst, turnBetween(realFromEuler(*angles, order), RealQuaternion(q)));
            EXPECT_LE(std::abs(angles->middle(order)), static_cast<float>(pi / 2));
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_LE(std::abs(angles->about(axis)), static_cast<float>(pi));
        }
    EXPECT_LE(worst, 1.8e-7);  // measured: 1.6e-7
}

TEST(Euler, LockedExtractionKeepsTheRotationAndTheOuterAngleAtZero) {
    StressInputs draw(35);
    const float rootHalf = 0x1.6a09e6p-1f;
    for (int i = 0; i < 2000; ++i)
        for (const EulerOrder order : eulerOrders) {
            const std::array<int, 3> axes = eulerAxes(order);
            // A quarter turn about the middle axis, exactly; then any turn about the inner one, in halves.
            glm::dquat quarter(rootHalf, 0, 0, 0);
            (axes[1] == 0 ? quarter.x : axes[1] == 1 ? quarter.y : quarter.z) = draw.sign() * rootHalf;
            const std::array<double, 4> exactTurns = {0, 1, -1, 0.5};
            const double tangent = exactTurns[draw.random().below(4)];
            glm::dquat inner(1, 0, 0, 0);
            (axes[2] == 0 ? inner.x : axes[2] == 1 ? inner.y : inner.z) = tangent;
            const glm::quat q(quarter * inner);
            const EulerAngles angles = *eulerFromQuaternion(q, order);
            EXPECT_LE(turnBetween(realFromEuler(angles, order), RealQuaternion(q)), 1.8e-7);
            EXPECT_EQ(angles.about(axes[0]), 0) << eulerOrderName(order);
        }
}

TEST(Euler, MatrixExtractionTakesScaledAndShearedMatrices) {
    StressInputs draw(36);
    for (int i = 0; i < 500; ++i)
        for (const EulerOrder order : eulerOrders) {
            const glm::dmat3 rotation = draw.rotation();
            glm::dmat3 stretch(1);
            stretch[0][0] = 3;
            stretch[2][2] = 0.2;
            const glm::mat3 m(rotation * stretch);
            const EulerAngles angles = *eulerFromMatrix(m, order);
            const glm::dmat3 back(*matrixFromEuler(angles, order));
            for (int column = 0; column < 3; ++column)
                EXPECT_LE(glm::length(back[column] - rotation[column]), 6e-7);
            EXPECT_FALSE(eulerFromMatrix(m * -1.0f, order));
        }
    EXPECT_FALSE(eulerFromMatrix(glm::mat3(0), EulerOrder::xyz));
}

TEST(Euler, GimbalAxesLoseOneDimensionByTheCosineOfTheMiddleAngle) {
    StressInputs draw(37);
    for (int i = 0; i < 1000; ++i)
        for (const EulerOrder order : eulerOrders) {
            EulerAngles angles = randomAngles(draw);
            if (i % 3 == 0)
                angles.about(eulerAxes(order)[1]) = static_cast<float>(draw.sign() * pi / 2);
            const glm::dmat3 axes = gimbalAxes(angles, order);
            const double volume = glm::dot(axes[0], glm::cross(axes[1], axes[2]));
            EXPECT_NEAR(std::abs(volume), std::abs(std::cos(double(angles.middle(order)))), 1e-14);
            // Each column is the direction about which the body turns when that angle grows.
            for (int ring = 0; ring < 3; ++ring) {
                const int axis = eulerAxes(order)[static_cast<std::size_t>(ring)];
                EulerAngles more = angles;
                more.about(axis) += 0x1p-8f;
                const glm::dquat step = glm::dquat(*quaternionFromEuler(more, order)) *
                                        glm::conjugate(glm::dquat(*quaternionFromEuler(angles, order)));
                const glm::dvec3 turn = glm::dvec3(step.x, step.y, step.z) * (step.w < 0 ? -512.0 : 512.0);
                EXPECT_LE(glm::length(turn - axes[ring]), 2e-4);
            }
        }
}

TEST(Euler, AnglesAreMixedOneByOneOnTheShorterWay) {
    const EulerAngles between = eulerLerp({3.0f, -0.5f, 0}, {-3.0f, 0.5f, 1}, 0.5f);
    EXPECT_NEAR(std::abs(between.head), pi, 1e-6);
    EXPECT_NEAR(between.pitch, 0, 1e-7);
    EXPECT_NEAR(between.roll, 0.5, 1e-7);
}

}  // namespace
}  // namespace quincunx

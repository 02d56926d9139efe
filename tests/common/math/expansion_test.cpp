#include "math/expansion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "math/quadratic.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::Real;

Rational valueOf(const Expansion& expansion) {
    Rational sum = 0;
    for (const double part : expansion.parts())
        sum += Rational(part);
    return sum;
}

/// A float, sometimes of a size near others', sometimes of any.
float anyFloat(StressInputs& draw) {
    return draw.random().below(2) == 0 ? draw.finiteFloat()
                                       : static_cast<float>(draw.sign() * draw.magnitude(-3, 3));
}

TEST(Expansion, HoldsPolynomialsOfDegreeSixInFloatsExactly) {
    StressInputs draw(1);
    for (int i = 0; i < 20000; ++i) {
        const float a = anyFloat(draw);
        const float b = anyFloat(draw);
        const float c = anyFloat(draw);
        const float d = anyFloat(draw);
        const Expansion e = Expansion::difference(a, b) * Expansion::product(c, d) + Expansion(a);
        const Rational exact = (Rational(a) - Rational(b)) * Rational(c) * Rational(d) + Rational(a);
        ASSERT_EQ(valueOf(e), exact) << a << " " << b << " " << c << " " << d;
        ASSERT_EQ(valueOf(e.squared() - Expansion(b)), exact * exact - Rational(b));
        ASSERT_EQ(e.sign(), exact < 0 ? -1 : exact > 0 ? 1 : 0);
    }
}

TEST(Expansion, CancelsToZero) {
    StressInputs draw(2);
    for (int i = 0; i < 1000; ++i) {
        const Expansion a = Expansion::product(draw.finiteFloat(), draw.finiteFloat());
        const Expansion b = Expansion::difference(draw.finiteFloat(), draw.finiteFloat());
        const Expansion zero = (a + b).squared() - a.squared() - 2.0 * (a * b) - b.squared();
        ASSERT_EQ(zero.sign(), 0);
        ASSERT_TRUE(zero.parts().empty());
    }
}

TEST(Expansion, RoundsToTheNearestDoubleOrItsNeighbour) {
    StressInputs draw(3);
    for (int i = 0; i < 5000; ++i) {
        const Expansion e = Expansion::difference(anyFloat(draw), anyFloat(draw)) *
                            Expansion::difference(anyFloat(draw), anyFloat(draw));
        const Rational exact = valueOf(e);
        if (exact == 0)
            continue;
        const auto relative = [&](const Rational& got) {
            return std::abs(static_cast<double>(Rational((got - exact) / exact)));
        };
        EXPECT_LE(relative(Rational(e.approximate())), 0x1p-52);
        const auto high = static_cast<double>(e.toQuad());
        const auto low = static_cast<double>(e.toQuad() - static_cast<Quad>(high));
        EXPECT_LE(relative(Rational(high) + Rational(low)), 0x1p-104);
    }
}

TEST(Quadratic, CountsAndRootsAreThoseOfExactArithmetic) {
    StressInputs draw(4);
    double worst = 0;
    int doubleRoots = 0;
    for (int i = 0; i < 30000; ++i) {
        float a = anyFloat(draw);
        float b = anyFloat(draw);
        float c = i % 3 == 0 ? static_cast<float>(static_cast<double>(b) * b / (4.0 * a)) : anyFloat(draw);
        if (i % 5 == 0) {
            const float p = static_cast<float>(1 + draw.random().below(4000));
            const float q = static_cast<float>(draw.random().below(4000));
            a = p * p;
            b = -2 * p * q;
            c = q * q;
        }
        if (!std::isfinite(c) || a == 0)
            continue;
        const Rational discriminant = Rational(b) * Rational(b) - 4 * Rational(a) * Rational(c);
        const QuadraticRoots roots = solveQuadratic(a, b, c);
        ASSERT_EQ(roots.count, discriminant < 0 ? 0 : discriminant == 0 ? 1 : 2) << a << " " << b << " " << c;
        doubleRoots += roots.count == 1;
        if (roots.count == 0)
            continue;
        const Real spread = sqrt(Real(discriminant));
        Real x = (-Real(b) - spread) / (2 * Real(a));
        Real y = (-Real(b) + spread) / (2 * Real(a));
        if (b < 0 && c != 0)
            x = Real(c) / Real(a) / y;
        else if (c != 0)
            y = Real(c) / Real(a) / x;
        if (c == 0)
            (b < 0 ? x : y) = 0;
        const Real low = x < y ? x : y;
        const Real high = x < y ? y : x;
        worst = std::max({worst, ulpError(roots.first, low), ulpError(roots.second, high)});
        EXPECT_LE(roots.first, roots.second);
    }
    // 4 · 2^-53, relative, is up to 8 times half an ulp of double where the mantissa is near 1.
    // Measured: 2.4.
    EXPECT_LE(worst, 4);
    EXPECT_GT(doubleRoots, 4000);
}

TEST(Quadratic, OfLowerDegreeIsSolvedToo) {
    EXPECT_EQ(solveQuadratic(0, 0, 0).count, QuadraticRoots::everywhere);
    EXPECT_EQ(solveQuadratic(0, 0, 3).count, 0);
    EXPECT_EQ(solveQuadratic(0, 2, -3).count, 1);
    EXPECT_EQ(solveQuadratic(0, 2, -3).first, 1.5);
    EXPECT_EQ(solveQuadratic(5, 0, 0).count, 1);
    EXPECT_EQ(solveQuadratic(5, 0, 0).second, 0);
    EXPECT_EQ(solveQuadratic(2, 3, 0).first, -1.5);
    EXPECT_EQ(solveQuadratic(2, 3, 0).second, 0);
    EXPECT_EQ(solveQuadratic(-1, 0, 4).first, -2);
    EXPECT_EQ(solveQuadratic(-1, 0, 4).second, 2);
}

}  // namespace
}  // namespace quincunx

#include "math/exact_sum.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;

double anyDouble(Random& random) {
    for (;;) {
        const auto x = std::bit_cast<double>(random.bits());
        if (std::isfinite(x))
            return x;
    }
}

int sign(const Rational& x) {
    return x < 0 ? -1 : x > 0 ? 1 : 0;
}

TEST(ExactSum, HasTheSignAndTheSizeOfRationalSums) {
    Random random(1);
    for (int i = 0; i < 3000; ++i) {
        ExactSum sum;
        Rational exact = 0;
        for (std::uint64_t n = random.below(8); n > 0; --n) {
            const double a = anyDouble(random);
            const double b = anyDouble(random);
            const double c = anyDouble(random);
            if (random.below(2) == 0) {
                sum.add({a, b, c});
                exact += Rational(a) * Rational(b) * Rational(c);
            } else {
                sum.subtract({a, b});
                exact -= Rational(a) * Rational(b);
            }
        }
        ASSERT_EQ(sum.sign(), sign(exact));
        const ExactSum::Scaled scaled = sum.scaled();
        if (sign(exact) == 0) {
            EXPECT_EQ(scaled.mantissa, 0);
            continue;
        }
        EXPECT_GE(std::abs(scaled.mantissa), 0.5);
        EXPECT_LT(std::abs(scaled.mantissa), 1);
        Rational power = 1;
        for (int e = 0; e < std::abs(scaled.exponent); ++e)
            power *= 2;
        const Rational got = scaled.exponent < 0 ? Rational(Rational(scaled.mantissa) / power)
                                                 : Rational(Rational(scaled.mantissa) * power);
        EXPECT_LE(std::abs(static_cast<double>(Rational((got - exact) / exact))), 0x1.01p-53);
    }
}

TEST(ExactSum, ComesBackToZeroFromTheEndsOfTheRange) {
    const double most = std::numeric_limits<double>::max();
    const double least = std::numeric_limits<double>::denorm_min();
    ExactSum sum;
    for (int i = 0; i < 100; ++i) {
        sum.add({most, most, most});
        sum.subtract({least, least, least});
    }
    EXPECT_EQ(sum.sign(), 1);
    for (int i = 0; i < 100; ++i)
        sum.subtract({most, most, most});
    EXPECT_EQ(sum.sign(), -1);
    EXPECT_EQ(sum.scaled().mantissa, -100.0 / 128);
    EXPECT_EQ(sum.scaled().exponent, -3222 + 7);
    for (int i = 0; i < 100; ++i)
        sum.add({least, least, least});
    EXPECT_EQ(sum.sign(), 0);
    EXPECT_EQ(sum.scaled().mantissa, 0);
}

TEST(ExactSum, HoldsProductsOfSixFloats) {
    const double most = std::numeric_limits<float>::max();
    const double least = std::numeric_limits<float>::denorm_min();
    ExactSum sum;
    sum.add({most, most, most, most, most, most});
    sum.subtract({most * most, most * most, most * most});
    EXPECT_EQ(sum.sign(), 0);
    sum.subtract({least, least, least, least, least, least});
    EXPECT_EQ(sum.sign(), -1);
    EXPECT_EQ(sum.scaled().exponent, -894 + 1);
    sum.add({0, most});
    EXPECT_EQ(sum.sign(), -1);
}

}  // namespace
}  // namespace quincunx

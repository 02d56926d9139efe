#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "math/exact.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::Real;

constexpr float maxFloat = std::numeric_limits<float>::max();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Exactly the quad, as the sum of three doubles; scaled, so that the last is not lost at the end of the
/// range.
Real exactly(Quad x) {
    const Quad magnitude = x < 0 ? -x : x;
    const double scale = magnitude < 1 ? 0x1p900 : 1;
    const Quad scaled = x * scale;
    const auto high = static_cast<double>(scaled);
    const auto middle = static_cast<double>(scaled - high);
    const auto low = static_cast<double>(scaled - high - middle);
    return (Real(high) + Real(middle) + Real(low)) / Real(scale);
}

double relativeError(Quad got, const Real& exact) {
    return std::abs(static_cast<double>(Real((exactly(got) - exact) / exact)));
}

TEST(Ulp, CountsHalfForTheWorstCorrectRounding) {
    EXPECT_EQ(ulpError(1.0f, Rational(1)), 0);
    EXPECT_EQ(ulpError(1.0f, Rational(1) + Rational(0x1p-24)), 0.5);
    EXPECT_EQ(ulpError(2.0, Rational(2) + Rational(0x1p-51)), 1);
    // Below a power of two the ulp is half as large.
    EXPECT_EQ(ulpError(1.0f, Rational(1) - Rational(0x1p-24)), 1);
    EXPECT_EQ(ulpError(-3.0f, Rational(-3) - Rational(0x1p-22)), 1);
}

TEST(Ulp, StaysAtTheSmallestSpacingNearZero) {
    EXPECT_EQ(ulpError(0.0f, Rational(0)), 0);
    EXPECT_EQ(ulpError(0x1p-149f, Rational(0)), 1);
    EXPECT_EQ(ulpError(0.0f, Rational(0x1p-200)), 0x1p-51);
    EXPECT_EQ(ulpError(0x1p-1074, Rational(0)), 1);
    EXPECT_EQ(ulpError(0x1p-1022, Rational(0x1p-1022) - Rational(0x1p-1074)), 1);
}

TEST(Ulp, IsInfiniteForWhatIsNotFiniteUnlessRoundingGivesIt) {
    const double none = std::numeric_limits<double>::infinity();
    EXPECT_EQ(ulpError(infinity, Rational(1)), none);
    EXPECT_EQ(ulpError(std::nanf(""), Rational(1)), none);
    EXPECT_EQ(ulpError(infinity, Rational(maxFloat)), none);
    EXPECT_EQ(ulpError(infinity, Rational(maxFloat) + Rational(0x1p103)), 0);
    EXPECT_EQ(ulpError(-infinity, Rational(maxFloat) + Rational(0x1p103)), none);
}

TEST(Ulp, AgreesForQuadAndRational) {
    StressInputs draw(11);
    for (int i = 0; i < 5000; ++i) {
        const float got = draw.finiteFloat();
        const double exact = got * (1 + draw.random().uniform(-0x1p-20, 0x1p-20));
        ASSERT_EQ(ulpError(got, Quad(exact)), ulpError(got, Rational(exact)));
    }
}

TEST(Ulp, DistanceCountsStepsOfNextafter) {
    EXPECT_EQ(ulpDistance(0.0f, -0.0f), 0u);
    EXPECT_EQ(ulpDistance(-0x1p-149f, 0x1p-149f), 2u);
    EXPECT_EQ(ulpDistance(1.0f, std::nextafter(1.0f, 2.0f)), 1u);
    EXPECT_EQ(ulpDistance(2.0, 1.0), std::uint64_t{1} << 52);
    EXPECT_EQ(ulpDistance(-maxFloat, maxFloat), 2 * std::uint64_t{0x7f7fffff});
    EXPECT_EQ(ulpDistance(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()),
              2 * std::uint64_t{0x7fefffffffffffff});
}

// Measured: 0.97 units of 2^-113.
TEST(QuadOracle, RootsAgreeWithMpfrToThreeUnits) {
    StressInputs draw(1);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const double x = draw.magnitude(-1020, 1020);
        worst = std::max(worst, relativeError(squareRoot(Quad(x)), sqrt(Real(x))));
        const Quad square = Quad(x) * x;
        worst = std::max(worst, relativeError(squareRoot(square), Real(x)));
    }
    EXPECT_LE(worst, 3 * 0x1p-113);
    RecordProperty("units", std::to_string(worst * 0x1p113));
    EXPECT_EQ(squareRoot(0), Quad(0));
}

TEST(QuadOracle, NormalizedVectorsAgreeWithMpfr) {
    StressInputs draw(2);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 v = draw.finiteVector();
        const QuadVector got = normalizeQuad(QuadVector(v));
        const oracle::RealVector exact = oracle::normalize(oracle::RealVector(v));
        if (v.x != 0)
            worst = std::max(worst, relativeError(got.x, exact.x));
    }
    // A sum of three squares, a root, a reciprocal and a product: 4.5 units at most.
    EXPECT_LE(worst, 4.5 * 0x1p-113);
}

TEST(QuadOracle, ElementaryFunctionsAgreeWithMpfr) {
    StressInputs draw(3);
    double exponentials = 0;
    double logarithms = 0;
    double tangents = 0;
    double angles = 0;
    for (int i = 0; i < 5000; ++i) {
        const double x = draw.random().uniform(-700, 700);
        exponentials = std::max(exponentials, relativeError(exponential(Quad(x)), exp(Real(x))));
        const double y = i % 2 == 0 ? draw.magnitude(-1020, 1020) : 1 - draw.magnitude(-52, -1);
        const Real exactLogarithm = log(Real(y));
        const double difference =
            std::abs(static_cast<double>(Real(exactly(logarithm(Quad(y))) - exactLogarithm)));
        logarithms =
            std::max(logarithms, difference / std::max(1.0, std::abs(static_cast<double>(exactLogarithm))));
        const double angle = draw.random().uniform(0, 1.57);
        tangents = std::max(tangents, relativeError(tangent(Quad(angle)), tan(Real(angle))));
        const double rise = draw.magnitude(-300, 10);
        const double run = draw.sign() * draw.magnitude(-10, 10);
        angles = std::max(angles, relativeError(arcTangent(rise, run), atan2(Real(rise), Real(run))));
    }
    EXPECT_LE(exponentials, 0x1p-100);
    EXPECT_LE(logarithms, 0x1p-100);
    EXPECT_LE(tangents, 0x1p-100);
    EXPECT_LE(angles, 0x1p-100);
    const double widest = 1.5707962989807129;  // the largest below π/2 − 2^-25
    EXPECT_LE(relativeError(tangent(Quad(widest)), tan(Real(widest))), 0x1p-80);
}

/// By Leibniz's formula.
template <int Size, typename Matrix>
Rational exactDeterminant(const Matrix& m) {
    std::array<int, Size> order{};
    for (int i = 0; i < Size; ++i)
        order[static_cast<std::size_t>(i)] = i;
    Rational sum = 0;
    do {
        Rational product = 1;
        for (int i = 0; i < Size; ++i) {
            product *= Rational(m[i][order[static_cast<std::size_t>(i)]]);
            for (int j = 0; j < i; ++j)
                if (order[static_cast<std::size_t>(j)] > order[static_cast<std::size_t>(i)])
                    product = -product;
        }
        sum += product;
    } while (std::next_permutation(order.begin(), order.end()));
    return sum;
}

template <int Size, typename Matrix>
void expectExactDeterminant(const Matrix& m) {
    const Rational exact = exactDeterminant<Size>(m);
    const double got = determinant(m);
    if (exact == 0)
        ASSERT_EQ(got, 0);
    else
        ASSERT_LE(abs(Rational((Rational(got) - exact) / exact)), Rational(0x1p-52));
}

TEST(Determinant, IsRightForEveryConditionAndSize) {
    StressInputs draw(4);
    for (int i = 0; i < 4000; ++i) {
        glm::mat3 m3;
        glm::mat4 m4;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                m4[column][row] =
                    i % 2 == 0 ? draw.finiteFloat() : static_cast<float>(draw.random().uniform(-1, 1));
        // Columns that nearly, every third time exactly, depend on one another.
        if (i % 4 >= 2) {
            m4[3] = 2.0f * m4[0] - m4[1] * 0.5f;
            if (i % 3 != 0)
                m4[3][2] = std::nextafter(m4[3][2], 0.0f);
        }
        for (int column = 0; column < 3; ++column)
            m3[column] = glm::vec3(m4[column + (column == 2 ? 1 : 0)]);
        bool finite = true;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                finite = finite && std::isfinite(m4[column][row]);
        if (!finite)
            continue;
        expectExactDeterminant<3>(m3);
        expectExactDeterminant<4>(m4);
    }
}

TEST(Determinant, IsZeroOnlyForSingularMatrices) {
    // Whole numbers below 2^24: a singular matrix, and its neighbour with determinant −1 · 8388607 · 2^0.
    const glm::mat3 singular(glm::vec3(8388607, 1, 2), glm::vec3(4, 8388605, 6),
                             glm::vec3(8388611, 8388606, 8));
    EXPECT_EQ(determinant(singular), 0);
    glm::mat3 neighbour = singular;
    neighbour[2][2] = 9;
    EXPECT_EQ(determinant(neighbour), 8388607.0 * 8388605.0 - 4.0);
    // Far beyond what a product of doubles resolves: (1 + 2^-23)(1 − 2^-23) − 1 = −2^-46, times 2^-100.
    const glm::mat3 near(glm::vec3(1 + 0x1p-23f, 1, 0), glm::vec3(1, 1 - 0x1p-23f, 0),
                         glm::vec3(0, 0, 0x1p-100f));
    EXPECT_EQ(determinant(near), -0x1p-146);
    EXPECT_EQ(determinantNaive(near), 0);
}

}  // namespace
}  // namespace quincunx

#include "math/exact.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace quincunx {
namespace {

struct Sum {
    double value;
    double error;
};

/// a + b = value + error, exactly (Knuth).
Sum twoSum(double a, double b) {
    const double sum = a + b;
    const double rounded = sum - a;
    return {sum, (a - (sum - rounded)) + (b - rounded)};
}

struct Product {
    double a;
    double b;
};

/// Σ ab with a relative error of at most 2^-52; the rounding errors of the products must not underflow.
template <std::size_t Count>
double sumOfProducts(const std::array<Product, Count>& products) {
    double sum = 0;
    double errors = 0;
    double magnitude = 0;
    for (const auto [a, b] : products) {
        const double product = a * b;
        const Sum next = twoSum(sum, product);
        sum = next.value;
        errors += next.error + std::fma(a, b, -product);
        magnitude += std::abs(product);
    }
    // The error so far is u |result| + (2 Count u)² magnitude: far below 2^-52 |result| unless 40 bits
    // cancel.
    static_assert(Count <= 24);
    const double compensated = sum + errors;
    if (std::abs(compensated) >= 0x1p-40 * magnitude || !std::isfinite(magnitude))
        return compensated;

    std::array<double, 2 * Count> parts{};  // an expansion: parts that do not overlap, smallest first
    std::size_t size = 0;
    const auto add = [&](double term) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size; ++i) {
            const Sum next = twoSum(term, parts[i]);
            if (next.error != 0)
                parts[kept++] = next.error;
            term = next.value;
        }
        if (term != 0)
            parts[kept++] = term;
        size = kept;
    };
    for (const auto [a, b] : products) {
        const double product = a * b;
        add(std::fma(a, b, -product));
        add(product);
    }
    double exact = 0;
    for (std::size_t i = 0; i < size; ++i)
        exact += parts[i];
    return exact;
}

}  // namespace

double determinant(const glm::mat3& m) {
    // A product of two floats is exact in double, one of three is a multiple of 2^-447.
    std::array<Product, 6> products{};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        const double factor = m[0][i];
        products[static_cast<std::size_t>(2 * i)] = {factor, static_cast<double>(m[1][j]) * m[2][k]};
        products[static_cast<std::size_t>(2 * i + 1)] = {-factor, static_cast<double>(m[1][k]) * m[2][j]};
    }
    return sumOfProducts(products);
}

double determinant(const glm::mat4& m) {
    // Laplace's expansion by the 2×2 minors of two columns; products of four floats are multiples of 2^-596.
    std::array<Product, 24> products{};
    std::size_t next = 0;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            if (j == i)
                continue;
            int k = 0;
            while (k == i || k == j)
                ++k;
            const int l = 6 - i - j - k;
            // The sign of the permutation (i, j, k, l), k < l.
            const double sign = ((i + j) % 2 == 1) == (i < j) ? 1 : -1;
            const double first = sign * static_cast<double>(m[0][i]) * m[1][j];
            products[next++] = {first, static_cast<double>(m[2][k]) * m[3][l]};
            products[next++] = {-first, static_cast<double>(m[2][l]) * m[3][k]};
        }
    }
    return sumOfProducts(products);
}

float determinantNaive(const glm::mat3& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1]) +
           m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1]);
}

}  // namespace quincunx

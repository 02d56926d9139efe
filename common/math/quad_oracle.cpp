#include "math/quad_oracle.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace quincunx {
namespace {

/// ln 2 as the sum of three doubles, 159 bits.
constexpr double logTwo[3] = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111};

/// 1/k at index k.
const std::array<Quad, 32>& reciprocals() {
    static const std::array<Quad, 32> table = [] {
        std::array<Quad, 32> filled{};
        for (std::size_t k = 1; k < filled.size(); ++k)
            filled[k] = Quad(1) / static_cast<double>(k);
        return filled;
    }();
    return table;
}

struct SineCosine {
    Quad sine;
    Quad cosine;
};

/// |x| ≤ π. The Taylor series at x/16, then the angle doubled four times, each doubling at the cost of two
/// bits.
SineCosine sineCosine(Quad x) {
    const Quad reduced = x / 16;
    const std::array<Quad, 32>& reciprocal = reciprocals();
    Quad sine = 0;
    Quad versine = 0;  // 1 − cos
    Quad term = reduced;
    // |reduced| < 0.2: the 25th term is below 2^-140.
    for (std::size_t k = 1; k < 24; k += 2) {
        sine += term;
        term *= reduced * reciprocal[k + 1];
        versine += term;
        term *= -reduced * reciprocal[k + 2];
    }
    for (int doubling = 0; doubling < 4; ++doubling) {
        const Quad nextVersine = 2 * sine * sine;
        sine = 2 * sine * (1 - versine);
        versine = nextVersine;
    }
    return {sine, 1 - versine};
}

}  // namespace

Quad squareRoot(Quad x) {
    if (!(x > 0))
        return 0;
    // Scaled by a power of four to where the residuals below, 2^-106 of it, are normal doubles.
    Quad scale = 1;
    Quad scaled = x;
    while (scaled > 0x1p500) {
        scaled *= 0x1p-500;
        scale *= 0x1p250;
    }
    while (scaled < 0x1p-500) {
        scaled *= 0x1p500;
        scale *= 0x1p-250;
    }
    // Two Newton steps, 53 bits each: a correction need not be known better than to double.
    const double start = std::sqrt(static_cast<double>(scaled));
    Quad root = start;
    root += static_cast<double>(scaled - root * root) / (2 * start);
    root += static_cast<double>(scaled - root * root) / (2 * start);
    return root * scale;
}

Quad exponential(Quad x) {
    const double count = std::nearbyint(static_cast<double>(x) / logTwo[0]);
    // The first product is exact: count has 11 bits at most, but logTwo[0] has 53, together below 113.
    const Quad reduced =
        (((x - static_cast<Quad>(count) * logTwo[0]) - static_cast<Quad>(count) * logTwo[1]) -
         static_cast<Quad>(count) * logTwo[2]) *
        0x1p-5;
    Quad sum = 0;
    Quad term = 1;
    const std::array<Quad, 32>& reciprocal = reciprocals();
    // |reduced| < 0.011: the 15th term is below 2^-135.
    for (std::size_t k = 1; k < 15; ++k) {
        term *= reduced * reciprocal[k];
        sum += term;
    }
    // eʸ − 1 doubles its argument without losing bits: (1 + s)² − 1 = s (2 + s).
    for (int doubling = 0; doubling < 5; ++doubling)
        sum = sum * (2 + sum);
    const int exponent = static_cast<int>(count);
    const int half = exponent / 2;
    return (1 + sum) * std::scalbn(1.0, half) * std::scalbn(1.0, exponent - half);
}

Quad logarithm(Quad x) {
    const Quad start = std::log(static_cast<double>(x));
    const Quad power = exponential(start);
    // Halley's step: the error of double, 2^-53, is cubed.
    return start + 2 * (x - power) / (x + power);
}

Quad tangent(Quad x) {
    const SineCosine at = sineCosine(x);
    return at.sine / at.cosine;
}

Quad arcTangent(Quad y, Quad x) {
    const Quad start = std::atan2(static_cast<double>(y), static_cast<double>(x));
    const SineCosine at = sineCosine(start);
    // The angle left over, below 2^-50: its tangent differs by a third of its cube.
    const Quad rest = (y * at.cosine - x * at.sine) / (x * at.cosine + y * at.sine);
    return start + rest;
}

QuadAdjugate adjugateQuad(const glm::mat4& m) {
    QuadAdjugate result;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            std::array<glm::vec3, 3> minor{};
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r)
                    minor[static_cast<std::size_t>(c)][r] = m[c < column ? c : c + 1][r < row ? r : r + 1];
            const Quad determinant =
                dotQuad(QuadVector(minor[0]), crossQuad(QuadVector(minor[1]), QuadVector(minor[2])));
            result.entries[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
                (column + row) % 2 == 0 ? determinant : -determinant;
        }
    }
    for (int row = 0; row < 4; ++row)
        result.determinant += Quad(m[0][row]) * result.entries[static_cast<std::size_t>(row)][0];
    return result;
}

}  // namespace quincunx

#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "math/quad_oracle.h"

namespace quincunx {

/// A real number as the unrounded sum of doubles that do not overlap: sums, differences and products are
/// exact (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
/// Discrete Comput. Geom. 18, 1997), as long as nothing exceeds 2^1023 and no bit lies below 2^-1074.
/// Polynomials of degree up to 7 in float data never do: their bits lie between 2^-1043 and 2^903 times the
/// number of terms. Slow beside doubles (some 10 ns for a sum, 50 ns for a product): for the rare decisions
/// that a bound on rounding errors leaves open. Held by Expansion.*.
class Expansion {
  public:
    Expansion() = default;
    Expansion(double value) {  // NOLINT: a double is an expansion
        if (value != 0)
            parts_[size_++] = value;
    }
    /// a − b and a · b without rounding.
    static Expansion difference(double a, double b);
    static Expansion product(double a, double b);

    Expansion operator-() const;
    friend Expansion operator+(const Expansion& a, const Expansion& b);
    friend Expansion operator-(const Expansion& a, const Expansion& b) { return a + -b; }
    friend Expansion operator*(const Expansion& a, const Expansion& b);
    /// This number squared.
    Expansion squared() const { return *this * *this; }

    /// −1, 0 or 1.
    int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] < 0 ? -1 : 1; }
    /// The nearest double, or its neighbour: relative error at most 2^-52.
    double approximate() const;
    /// Relative error at most 2^-110.
    Quad toQuad() const;
    /// The parts, by growing magnitude; none is zero.
    std::span<const double> parts() const { return {parts_.data(), size_}; }

  private:
    /// Two parts side by side span more than 53 bits, and a double's bits lie in 2^-1074 … 2^1023.
    static constexpr std::size_t capacity = 96;
    void assignCompressed(std::span<double> parts);

    std::array<double, capacity> parts_;
    std::size_t size_ = 0;
};

}  // namespace quincunx

#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>

namespace quincunx {

/// An exact sum of products of doubles: a fixed-point number that is long enough for every product of three
/// doubles, and of six floats, whatever their exponents (Kulisch, "Computer Arithmetic and Validity", 2nd
/// ed., 2013, chapter 8). Slow beside math/exact.h; for what leaves the range of double there, and for
/// oracles. Up to 2^40 products may be added. Held by ExactSum.*.
class ExactSum {
  public:
    /// Adds a product of one to six finite factors. One of more than three factors must be a product of
    /// floats.
    void add(std::initializer_list<double> factors);
    void subtract(std::initializer_list<double> factors);

    /// −1, 0 or 1, exactly.
    int sign() const;

    /// The sum = mantissa · 2^exponent, ½ ≤ |mantissa| < 1, the mantissa cut off after 64 bits and rounded
    /// (so within 0.501 ulp); 0 and 0 for zero.
    struct Scaled {
        double mantissa = 0;
        int exponent = 0;
    };
    Scaled scaled() const;

  private:
    void accumulate(std::initializer_list<double> factors, bool negative);

    // Two's complement, least significant word first; bit 0 weighs 2^lowestExponent. The smallest product of
    // three doubles is 2^-3222, the largest below 2^3072.
    static constexpr int lowestExponent = -3264;
    static constexpr std::size_t wordCount = 100;
    std::array<std::uint64_t, wordCount> words_{};
};

}  // namespace quincunx

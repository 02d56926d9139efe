#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

/// Errors counted in units in the last place (Muller et al., "Handbook of Floating-Point Arithmetic", 2nd
/// ed., section 2.3): a result that is correctly rounded has an error of at most 0.5.
namespace quincunx {

/// |got − exact| / 2^(max(⌊log2 |exact|⌋, emin) − p + 1), with emin = −126, p = 24 for float and −1022, 53
/// for double. `Real` is any type that holds both numbers and their difference (Quad, a rational, MPFR); it
/// converts explicitly from and to double.
/// An infinite `got` has error 0 where rounding `exact` gives the same infinity; any other `got` that is not
/// finite has an infinite error. Held by Ulp.*.
template <std::floating_point Float, typename Real>
double ulpError(Float got, const Real& exact) {
    using Limits = std::numeric_limits<Float>;
    const Real zero(0.0);
    const Real magnitude = exact < zero ? Real(zero - exact) : exact;
    if (!std::isfinite(got)) {
        // Half an ulp above the largest finite number, from where rounding goes to infinity.
        const Real overflow = Real(static_cast<double>(Limits::max())) +
                              Real(std::scalbn(1.0, Limits::max_exponent - Limits::digits - 1));
        const bool sameSign = (got < 0) == (exact < zero);
        return std::isinf(got) && sameSign && magnitude >= overflow ? 0
                                                                    : std::numeric_limits<double>::infinity();
    }
    int exponent = Limits::min_exponent - 1;
    const double nearby = static_cast<double>(magnitude);
    if (nearby > 0) {
        int found = std::isfinite(nearby) ? std::ilogb(nearby) : 1023;
        // Rounding to double may have reached the next power of two.
        if (Real(std::scalbn(1.0, found)) > magnitude)
            --found;
        exponent = found > exponent ? found : exponent;
    }
    const Real difference = Real(static_cast<double>(got)) - exact;
    const int shift = Limits::digits - 1 - exponent;
    if constexpr (sizeof(Float) == 4) {
        return std::abs(std::scalbn(static_cast<double>(difference), shift));
    } else {
        // In two factors: the reciprocal of the smallest ulp of double exceeds its range.
        const Real scaled = difference * Real(std::scalbn(1.0, shift / 2));
        return std::abs(static_cast<double>(Real(scaled * Real(std::scalbn(1.0, shift - shift / 2)))));
    }
}

/// How many steps of `nextafter` lie between two finite numbers; −0 and +0 are the same. Held by Ulp.*.
template <std::floating_point Float>
std::uint64_t ulpDistance(Float a, Float b) {
    using Bits = std::conditional_t<sizeof(Float) == 4, std::int32_t, std::int64_t>;
    const auto ordered = [](Float x) {
        const Bits bits = std::bit_cast<Bits>(x);
        return static_cast<std::int64_t>(bits < 0 ? std::numeric_limits<Bits>::min() - bits : bits);
    };
    const std::int64_t from = ordered(a);
    const std::int64_t to = ordered(b);
    return from < to ? static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from)
                     : static_cast<std::uint64_t>(from) - static_cast<std::uint64_t>(to);
}

}  // namespace quincunx

#include "math/exact_sum.h"

#include <bit>
#include <cmath>

#include "base/check.h"

namespace quincunx {
namespace {

__extension__ using Wide = unsigned __int128;

}  // namespace

void ExactSum::add(std::initializer_list<double> factors) {
    accumulate(factors, false);
}

void ExactSum::subtract(std::initializer_list<double> factors) {
    accumulate(factors, true);
}

void ExactSum::accumulate(std::initializer_list<double> factors, bool negative) {
    // The product as an odd integer of up to three words times a power of two.
    std::array<std::uint64_t, 4> product{1, 0, 0, 0};
    int exponent = 0;
    for (const double factor : factors) {
        QX_CHECK(std::isfinite(factor));
        if (factor == 0)
            return;
        negative ^= factor < 0;
        int factorExponent = 0;
        auto integer =
            static_cast<std::uint64_t>(std::scalbn(std::frexp(std::abs(factor), &factorExponent), 53));
        const int zeros = std::countr_zero(integer);
        integer >>= zeros;
        exponent += factorExponent - 53 + zeros;
        std::uint64_t carry = 0;
        for (std::uint64_t& word : product) {
            const Wide next = static_cast<Wide>(word) * integer + carry;
            word = static_cast<std::uint64_t>(next);
            carry = static_cast<std::uint64_t>(next >> 64);
        }
        QX_CHECK(product[3] == 0 && carry == 0);
    }

    const int position = exponent - lowestExponent;
    QX_CHECK(position >= 0 && static_cast<std::size_t>(position) / 64 + product.size() <= wordCount);
    const auto first = static_cast<std::size_t>(position) / 64;
    const int shift = position % 64;
    std::uint64_t above = 0;
    std::uint64_t carry = 0;  // or borrow
    for (std::size_t i = 0; first + i < wordCount; ++i) {
        if (i >= product.size() && carry == 0)
            break;
        const std::uint64_t word = i < product.size() ? product[i] : 0;
        const std::uint64_t shifted = word << shift | above;
        above = shift == 0 ? 0 : word >> (64 - shift);
        std::uint64_t& sum = words_[first + i];
        const Wide next =
            negative ? static_cast<Wide>(sum) - shifted - carry : static_cast<Wide>(sum) + shifted + carry;
        sum = static_cast<std::uint64_t>(next);
        carry = static_cast<std::uint64_t>(next >> 64) & 1;
    }
}

int ExactSum::sign() const {
    if (words_.back() >> 63 != 0)
        return -1;
    for (const std::uint64_t word : words_)
        if (word != 0)
            return 1;
    return 0;
}

ExactSum::Scaled ExactSum::scaled() const {
    std::array<std::uint64_t, wordCount> magnitude = words_;
    const bool negative = words_.back() >> 63 != 0;
    if (negative) {
        std::uint64_t carry = 1;
        for (std::uint64_t& word : magnitude) {
            word = ~word + carry;
            carry = carry != 0 && word == 0 ? 1 : 0;
        }
    }
    std::size_t top = wordCount;
    while (top > 0 && magnitude[top - 1] == 0)
        --top;
    if (top == 0)
        return {};
    const int zeros = std::countl_zero(magnitude[top - 1]);
    std::uint64_t leading = magnitude[top - 1] << zeros;
    if (zeros > 0 && top > 1)
        leading |= magnitude[top - 2] >> (64 - zeros);
    int exponent = 0;
    const double mantissa = std::frexp(static_cast<double>(leading), &exponent);
    return {negative ? -mantissa : mantissa,
            lowestExponent + static_cast<int>(top) * 64 - zeros - 64 + exponent};
}

}  // namespace quincunx

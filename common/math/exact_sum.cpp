#include "math/exact_sum.h"

#include <bit>
#include <cmath>
#include <cstddef>

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
    std::size_t size = 1;
    int exponent = 0;
    for (const double factor : factors) {
        if (factor == 0)
            return;
        const auto bits = std::bit_cast<std::uint64_t>(factor);
        const int biased = static_cast<int>(bits >> 52 & 0x7ff);
        QX_CHECK(biased != 0x7ff);
        negative ^= bits >> 63 != 0;
        std::uint64_t integer = bits & 0xfffffffffffffu;
        integer |= static_cast<std::uint64_t>(biased != 0 ? 1 : 0) << 52;
        const int zeros = std::countr_zero(integer);
        integer >>= zeros;
        exponent += (biased != 0 ? biased : 1) - 1075 + zeros;
        std::uint64_t carry = 0;
        for (std::size_t i = 0; i < size; ++i) {
            const Wide next = static_cast<Wide>(product[i]) * integer + carry;
            product[i] = static_cast<std::uint64_t>(next);
            carry = static_cast<std::uint64_t>(next >> 64);
        }
        if (carry != 0) {
            QX_CHECK(size < 3);
            product[size++] = carry;
        }
    }

    const int position = exponent - lowestExponent;
    QX_CHECK(position >= 0 && static_cast<std::size_t>(position) / 64 + product.size() <= wordCount);
    const int shift = position % 64;
    std::size_t index = static_cast<std::size_t>(position) / 64;
    std::uint64_t above = 0;
    std::uint64_t carry = 0;  // or borrow
    const auto addWord = [&](std::uint64_t word) {
        std::uint64_t& sum = words_[index++];
        const Wide next =
            negative ? static_cast<Wide>(sum) - word - carry : static_cast<Wide>(sum) + word + carry;
        sum = static_cast<std::uint64_t>(next);
        carry = static_cast<std::uint64_t>(next >> 64) & 1;
    };
    for (std::size_t i = 0; i <= size; ++i) {
        addWord(product[i] << shift | above);
        above = shift == 0 ? 0 : product[i] >> (64 - shift);
    }
    while (carry != 0 && index < wordCount)
        addWord(0);
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

#include "trace/sample_patterns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/check.h"

namespace quincunx {
namespace {

std::uint32_t reversedBits(std::uint32_t x) {
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    return __builtin_bswap32(x);
}

/// Each bit is flipped or not by a hash of the bits below it: products with even numbers, added to what was
/// there, carry upwards only (Burley 2020, section 3, after Laine and Karras 2011).
std::uint32_t permutedFromBelow(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}
std::uint32_t hashScrambled(std::uint32_t x, std::uint32_t seed) {
    return reversedBits(permutedFromBelow(reversedBits(x), seed));
}

/// Owen's scrambling as defined: each bit flipped by an independent random bit of its node in the tree.
std::uint32_t treeScrambled(std::uint32_t x, std::uint64_t seed) {
    std::uint32_t flips = 0;
    for (unsigned bit = 0; bit < 32; ++bit) {
        const std::uint64_t above = bit == 0 ? 0 : x >> (32 - bit);
        const std::uint64_t node = (std::uint64_t{1} << bit) | above;
        flips |= static_cast<std::uint32_t>(Random(seed + 0x9e3779b97f4a7c15u * node).bits() >> 63)
                 << (31 - bit);
    }
    return x ^ flips;
}

/// The radical inverse of `index` in base 3, times 2^32.
std::uint32_t ternaryInverse(std::uint32_t index) {
    return static_cast<std::uint32_t>(radicalInverse(3, index) * 0x1p32);
}

/// Calls `place(row, column, columns, from, to)` for each of `count` cells of equal area; the row lies
/// between from/count and to/count.
template <typename Place>
void forEachCell(std::uint32_t count, const Place& place) {
    const auto rows =
        static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(static_cast<double>(count)))));
    for (std::uint32_t row = 0; row < rows; ++row) {
        const auto from = static_cast<std::uint32_t>(std::uint64_t{row} * count / rows);
        const auto to = static_cast<std::uint32_t>((std::uint64_t{row} + 1) * count / rows);
        for (std::uint32_t column = 0; column < to - from; ++column)
            place(column, to - from, from, to);
    }
}

float belowOne(double x) {
    return std::min(static_cast<float>(x), 1 - 0x1p-24f);
}

/// Of each cell the point at (x, y) of its width and height.
void appendLattice(std::vector<glm::vec2>& points, std::uint32_t count, double x, double y) {
    forEachCell(
        count, [&](std::uint32_t column, std::uint32_t columns, std::uint32_t from, std::uint32_t to) {
            points.emplace_back(belowOne((column + x) / columns), belowOne((from + y * (to - from)) / count));
        });
}

}  // namespace

std::vector<glm::vec2> samplePattern(SamplePattern pattern, std::size_t count, std::uint64_t seed) {
    QX_CHECK(count <= std::size_t{1} << 24);
    const auto size = static_cast<std::uint32_t>(count);
    Random random(seed);
    std::vector<glm::vec2> points;
    points.reserve(count);
    switch (pattern) {
        case SamplePattern::regular:
            appendLattice(points, size, 0.5, 0.5);
            break;
        case SamplePattern::random:
            for (std::uint32_t i = 0; i < size; ++i) {
                const float x = random.uniform();
                points.emplace_back(x, random.uniform());
            }
            break;
        case SamplePattern::jittered:
            forEachCell(
                size, [&](std::uint32_t column, std::uint32_t columns, std::uint32_t from, std::uint32_t to) {
                    const float x = jitterCell(column, columns, random.uniform());
                    // A row is as high as `to - from` of the `size` equal strips.
                    const auto strip = from + static_cast<std::uint32_t>(random.below(to - from));
                    points.emplace_back(x, jitterCell(strip, size, random.uniform()));
                });
            break;
        case SamplePattern::nRooks: {
            std::vector<std::uint32_t> rows(count);
            std::iota(rows.begin(), rows.end(), 0u);
            for (std::uint32_t i = size; i > 1; --i)
                std::swap(rows[i - 1], rows[random.below(i)]);
            for (std::uint32_t i = 0; i < size; ++i) {
                const float x = jitterCell(i, size, random.uniform());
                points.emplace_back(x, jitterCell(rows[i], size, random.uniform()));
            }
            break;
        }
        case SamplePattern::halton: {
            const auto shiftX = static_cast<std::uint32_t>(random.bits() >> 32);
            const auto shiftY = static_cast<std::uint32_t>(random.bits() >> 32);
            for (std::uint32_t i = 0; i < size; ++i)
                points.emplace_back(unitFloat(reversedBits(i) + shiftX),
                                    unitFloat(ternaryInverse(i) + shiftY));
            break;
        }
        case SamplePattern::sobol: {
            const std::uint64_t seedX = random.bits();
            const std::uint64_t seedY = random.bits();
            for (std::uint32_t i = 0; i < size; ++i)
                points.emplace_back(unitFloat(treeScrambled(sobol(i, 0), seedX)),
                                    unitFloat(treeScrambled(sobol(i, 1), seedY)));
            break;
        }
        case SamplePattern::quincunx:
            appendLattice(points, size - size / 2, 0, 0);
            appendLattice(points, size / 2, 0.5, 0.5);
            break;
    }
    return points;
}

float unitFloatNaive(std::uint32_t bits) {
    return static_cast<float>(bits) * 0x1p-32f;
}

float uniformBetween(float low, float high, float u) {
    // In double neither the difference overflows nor the sum rounds before the last step.
    const double value = low + static_cast<double>(u) * (static_cast<double>(high) - low);
    const auto rounded = static_cast<float>(value);
    return rounded < high ? std::max(rounded, low)
                          : std::nextafter(high, -std::numeric_limits<float>::infinity());
}

float uniformBetweenNaive(float low, float high, float u) {
    return low + u * (high - low);
}

std::int64_t integerBetween(std::int64_t low, std::int64_t high, Random& random) {
    // Differences wrap as unsigned numbers do, and so does the sum back.
    const std::uint64_t count = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
    const std::uint64_t drawn = count == 0 ? random.bits() : random.below(count);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + drawn);
}

std::int64_t integerBetweenNaive(std::int64_t low, std::int64_t high, Random& random) {
    return static_cast<std::int64_t>(static_cast<double>(low) +
                                     random.uniformDouble() *
                                         (static_cast<double>(high) - static_cast<double>(low) + 1));
}

float jitterCell(std::uint32_t cell, std::uint32_t cells, float u) {
    // The quotient is within the cell but for a rounding, and a cell is no narrower than floats are spaced:
    // the nearest float or its neighbour lies in it. The products that decide are exact.
    const auto x = static_cast<float>((cell + static_cast<double>(u)) / cells);
    const double place = static_cast<double>(x) * cells;
    if (place < cell) [[unlikely]]
        return std::nextafter(x, 2.0f);
    if (place >= cell + 1.0) [[unlikely]]
        return std::nextafter(x, -1.0f);
    return x;
}

float jitterCellNaive(std::uint32_t cell, std::uint32_t cells, float u) {
    return (static_cast<float>(cell) + u) / static_cast<float>(cells);
}

namespace {

/// The first dimension's number of a shuffled index: its bits reversed.
std::uint32_t shuffledFirst(std::uint32_t index, std::uint32_t seed) {
    return permutedFromBelow(reversedBits(index), seed ^ 0x5bd1e995u);
}

}  // namespace

float PathSampler::sobolNumber(std::uint32_t index, std::uint64_t hash) {
    const auto high = static_cast<std::uint32_t>(hash >> 32);
    return unitFloat(hashScrambled(shuffledFirst(index, high), high));
}

glm::vec2 PathSampler::sobolPoint(std::uint32_t index, std::uint64_t hash) {
    const auto high = static_cast<std::uint32_t>(hash >> 32);
    const auto low = static_cast<std::uint32_t>(hash);
    const std::uint32_t first = shuffledFirst(index, high);
    return {unitFloat(hashScrambled(first, high)), unitFloat(hashScrambled(secondSobolOfFirst(first), low))};
}

}  // namespace quincunx

#include "math/sample_patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/check.h"
#include "base/random.h"

namespace quincunx {
namespace {

constexpr std::array<std::uint32_t, mostSampleDimensions> primes = {2, 3, 5, 7, 11, 13, 17, 19};

/// Of a primitive polynomial over two elements: its degree, its inner coefficients, and the first direction
/// numbers. Dimension 0 has none: its numbers are mirrored bits.
struct SobolStart {
    int degree;
    std::uint32_t coefficients;
    std::array<std::uint32_t, 5> directions;
};
constexpr std::array<SobolStart, mostSampleDimensions - 1> sobolStarts = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
}};

using SobolColumns = std::array<std::uint32_t, 32>;

constexpr SobolColumns sobolColumns(std::size_t dimension) {
    SobolColumns columns{};
    if (dimension == 0) {
        for (std::size_t i = 0; i < 32; ++i)
            columns[i] = 1u << (31 - i);
        return columns;
    }
    const SobolStart& start = sobolStarts[dimension - 1];
    const auto degree = static_cast<std::size_t>(start.degree);
    for (std::size_t i = 0; i < 32; ++i) {
        if (i < degree) {
            columns[i] = start.directions[i] << (31 - i);
            continue;
        }
        columns[i] = columns[i - degree] ^ (columns[i - degree] >> degree);
        for (std::size_t k = 1; k < degree; ++k)
            if (((start.coefficients >> (degree - 1 - k)) & 1u) != 0)
                columns[i] ^= columns[i - k];
    }
    return columns;
}

constexpr std::array<SobolColumns, mostSampleDimensions> allSobolColumns = [] {
    std::array<SobolColumns, mostSampleDimensions> all{};
    for (std::size_t d = 0; d < all.size(); ++d)
        all[d] = sobolColumns(d);
    return all;
}();

/// A stream of its own for each of many purposes.
Random streamOf(std::uint64_t seed, std::uint64_t purpose) {
    return Random(Random(seed).bits() ^ purpose);
}

/// How many digits fit into 53 bits.
int digitCount(std::uint32_t base) {
    int digits = 0;
    for (std::uint64_t power = 1; power <= (std::uint64_t{1} << 53) / base; power *= base)
        ++digits;
    return digits;
}

/// Radical inverses whose digits are permuted, each place by a permutation of its own.
class ScrambledRadicalInverse {
  public:
    ScrambledRadicalInverse(std::uint32_t base, std::uint64_t seed) : base_(base), digits_(digitCount(base)) {
        Random random(seed);
        permutations_.resize(static_cast<std::size_t>(digits_) * base);
        for (int place = 0; place < digits_; ++place) {
            const auto begin = permutations_.begin() + place * static_cast<std::ptrdiff_t>(base);
            std::iota(begin, begin + static_cast<std::ptrdiff_t>(base), 0u);
            for (std::uint32_t i = base; i > 1; --i)
                std::swap(begin[i - 1], begin[static_cast<std::ptrdiff_t>(random.below(i))]);
        }
    }

    double operator()(std::uint32_t index) const {
        std::uint64_t numerator = 0;
        std::uint64_t denominator = 1;
        for (std::size_t place = 0; place < static_cast<std::size_t>(digits_); ++place) {
            numerator = numerator * base_ + permutations_[place * base_ + index % base_];
            denominator *= base_;
            index /= base_;
        }
        return static_cast<double>(numerator) / static_cast<double>(denominator);
    }

  private:
    std::uint32_t base_;
    int digits_;
    std::vector<std::uint32_t> permutations_;
};

std::vector<std::size_t> shuffled(std::size_t count, Random& random) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(i))]);
    return order;
}

/// (cell + within) / cells, below 1: `within` near 1 may round the sum up.
double inCell(std::size_t cell, double within, std::size_t cells) {
    constexpr double last = 1 - 0x1p-53;
    return std::min((static_cast<double>(cell) + within) / static_cast<double>(cells), last);
}

/// Fills one group of a grid pattern.
void fillGrid(std::span<double> points, std::size_t dimensions, std::size_t first, int size,
              std::size_t count, bool jittered, Random& random) {
    const SampleGrid grid = size == 2 ? sampleGrid(count) : SampleGrid{count, 1};
    const std::vector<std::size_t> cells = shuffled(count, random);
    const auto within = [&] { return jittered ? random.uniformDouble() : 0.5; };
    for (std::size_t i = 0; i < count; ++i) {
        double* const point = points.data() + i * dimensions + first;
        point[0] = inCell(cells[i] % grid.columns, within(), grid.columns);
        if (size == 2)
            point[1] = inCell(cells[i] / grid.columns, within(), grid.rows);
    }
}

}  // namespace

std::string_view samplePatternName(SamplePattern pattern) {
    return samplePatternNames[static_cast<std::size_t>(pattern)];
}

std::optional<SamplePattern> samplePatternOfName(std::string_view name) {
    const auto found = std::find(samplePatternNames.begin(), samplePatternNames.end(), name);
    if (found == samplePatternNames.end())
        return std::nullopt;
    return allSamplePatterns[static_cast<std::size_t>(found - samplePatternNames.begin())];
}

SampleGrid sampleGrid(std::size_t count) {
    QX_CHECK_GE(count, 1u);
    auto rows = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    while (count % rows != 0)
        --rows;
    return {count / rows, rows};
}

double radicalInverse(std::uint32_t base, std::uint32_t index) {
    QX_CHECK(base >= 2 && base <= 65536);
    // The denominator is less than base · 2^32 ≤ 2^48, so both are doubles, and 1 − 2^-48 is below 1 in
    // double.
    std::uint64_t numerator = 0;
    std::uint64_t denominator = 1;
    for (; index > 0; index /= base) {
        numerator = numerator * base + index % base;
        denominator *= base;
    }
    return static_cast<double>(numerator) / static_cast<double>(denominator);
}

float radicalInverseNaive(std::uint32_t base, std::uint32_t index) {
    const float step = 1.0f / static_cast<float>(base);
    float place = step;
    float result = 0;
    for (; index > 0; index /= base) {
        result += static_cast<float>(index % base) * place;
        place *= step;
    }
    return result;
}

std::uint32_t sobol(std::uint32_t index, int dimension) {
    QX_CHECK(dimension >= 0 && dimension < mostSampleDimensions);
    const SobolColumns& columns = allSobolColumns[static_cast<std::size_t>(dimension)];
    std::uint32_t bits = 0;
    for (std::size_t i = 0; index > 0; ++i, index >>= 1)
        if ((index & 1u) != 0)
            bits ^= columns[i];
    return bits;
}

std::uint32_t owenScrambled(std::uint32_t bits, std::uint64_t seed) {
    std::uint32_t result = 0;
    for (unsigned place = 0; place < 32; ++place) {
        const unsigned shift = 31 - place;
        // A leading 1 tells prefixes of different lengths apart.
        const std::uint64_t prefix =
            (std::uint64_t{1} << place) | (static_cast<std::uint64_t>(bits) >> (shift + 1));
        const auto flip =
            static_cast<std::uint32_t>(Random(seed ^ (prefix * 0xd1342543de82ef95u)).bits() >> 63);
        result |= (((bits >> shift) & 1u) ^ flip) << shift;
    }
    return result;
}

glm::dvec2 pointOnDisc(glm::dvec2 square) {
    const glm::dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0 && p.y == 0)
        return {0, 0};
    constexpr double eighth = std::numbers::pi / 4;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const double radius = wide ? p.x : p.y;
    const double angle = wide ? eighth * (p.y / p.x) : 2 * eighth - eighth * (p.x / p.y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

std::vector<double> samplePoints(SamplePattern pattern, std::size_t count, std::span<const int> groups,
                                 std::uint64_t seed) {
    QX_CHECK_LT(static_cast<std::size_t>(pattern), patternsOfAnyDimension);
    QX_CHECK_LE(count, std::size_t{1} << 32);
    std::size_t dimensions = 0;
    for (const int size : groups) {
        QX_CHECK(size == 1 || size == 2);
        dimensions += static_cast<std::size_t>(size);
    }
    QX_CHECK_LE(dimensions, static_cast<std::size_t>(mostSampleDimensions));
    std::vector<double> points(count * dimensions);
    switch (pattern) {
        case SamplePattern::regular:
        case SamplePattern::jittered: {
            std::size_t first = 0;
            for (std::size_t g = 0; g < groups.size() && count > 0; ++g) {
                Random random = streamOf(seed, g);
                fillGrid(points, dimensions, first, groups[g], count, pattern == SamplePattern::jittered,
                         random);
                first += static_cast<std::size_t>(groups[g]);
            }
            break;
        }
        case SamplePattern::random: {
            Random random = streamOf(seed, 0);
            std::generate(points.begin(), points.end(), [&] { return random.uniformDouble(); });
            break;
        }
        case SamplePattern::halton:
            for (std::size_t d = 0; d < dimensions; ++d) {
                const ScrambledRadicalInverse inverse(primes[d], streamOf(seed, d).bits());
                for (std::size_t i = 0; i < count; ++i)
                    points[i * dimensions + d] = inverse(static_cast<std::uint32_t>(i));
            }
            break;
        case SamplePattern::sobol:
            for (std::size_t d = 0; d < dimensions; ++d) {
                const std::uint64_t scramble = streamOf(seed, d).bits();
                for (std::size_t i = 0; i < count; ++i) {
                    const std::uint32_t bits =
                        owenScrambled(sobol(static_cast<std::uint32_t>(i), static_cast<int>(d)), scramble);
                    points[i * dimensions + d] = (static_cast<double>(bits) + 0.5) * 0x1p-32;
                }
            }
            break;
        case SamplePattern::nRooks:
        case SamplePattern::quincunx:
            break;
    }
    return points;
}

}  // namespace quincunx

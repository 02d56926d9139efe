#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

/// Points of the unit cube for sums that stand for integrals: what is summed up over a pixel, a lens, a light
/// and the time that a shutter is open. All numbers are in [0, 1), never 1, computed from a seed, and the
/// same on every machine.
namespace quincunx {

enum class SamplePattern {
    regular,   ///< the centres of a grid
    random,    ///< each number for itself
    jittered,  ///< one at random in each cell of a grid (Cook, Porter, Carpenter, SIGGRAPH 1984)
    halton,    ///< radical inverses in the first primes, digits permuted (Matoušek, J. Complexity 14, 1998)
    sobol,    ///< Sobol' points, scrambled (Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995)
    nRooks,   ///< in the square alone: one in each of `count` columns and rows (Shirley 1991)
    quincunx  ///< in the square alone: the corners of cells and their centres
};
inline constexpr std::array allSamplePatterns = {
    SamplePattern::regular, SamplePattern::random, SamplePattern::jittered, SamplePattern::halton,
    SamplePattern::sobol,   SamplePattern::nRooks, SamplePattern::quincunx};
inline constexpr std::array samplePatternNames = {"regular", "random",  "jittered", "halton",
                                                  "sobol",   "n-rooks", "quincunx"};
/// So many of the first ones are known for any number of dimensions.
inline constexpr std::size_t patternsOfAnyDimension = 5;

std::string_view samplePatternName(SamplePattern pattern);
std::optional<SamplePattern> samplePatternOfName(std::string_view name);

inline constexpr int mostSampleDimensions = 8;

/// `count` points of as many dimensions as the groups have together, point after point. A group is one number
/// or a pair of them, such as the two coordinates on a lens; at most `mostSampleDimensions` in all. `pattern`
/// is one of the `patternsOfAnyDimension`.
///
/// Grids are made for each group on its own: `count` cells in a row, or columns × rows for a pair, the most
/// square that divides `count` without rest (a prime has one row only). Which cell of one group meets which
/// of another is left to chance, for otherwise the left of the lens would see nothing but the left of the
/// light. Held by SamplePatterns.*.
std::vector<double> samplePoints(SamplePattern pattern, std::size_t count, std::span<const int> groups,
                                 std::uint64_t seed);

/// The most square grid of just so many cells: columns ≥ rows. count ≥ 1.
struct SampleGrid {
    std::size_t columns = 1;
    std::size_t rows = 1;
};
SampleGrid sampleGrid(std::size_t count);

/// The digits of `index` in `base` (2 … 2^16) mirrored at the point: to 0.5 ulp, and below 1 for every index.
/// Held by RadicalInverse.*.
double radicalInverse(std::uint32_t base, std::uint32_t index);

/// Digit by digit in float, as the textbook has it.
float radicalInverseNaive(std::uint32_t base, std::uint32_t index);

/// The number of a Sobol' point, times 2^32, with the direction numbers of Joe and Kuo ("Constructing Sobol
/// sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30, 2008). `dimension` from 0,
/// less than `mostSampleDimensions`. The first 2^k points have one number in each of the 2^k intervals.
std::uint32_t sobol(std::uint32_t index, int dimension);

/// The second dimension's number from the first one's: sobol(i, 1) of sobol(i, 0), in five steps. The
/// generator matrix is Pascal's triangle modulo 2, whose entry (j, i) is 1 where the digits of i hold those
/// of j (Lucas), so that it is a product of one step for each digit.
inline std::uint32_t secondSobolOfFirst(std::uint32_t first) {
    first ^= first << 1 & 0xaaaaaaaau;
    first ^= first << 2 & 0xccccccccu;
    first ^= first << 4 & 0xf0f0f0f0u;
    first ^= first << 8 & 0xff00ff00u;
    return first ^ (first << 16 & 0xffff0000u);
}

/// Each bit turned over or not, by what the bits above it are: points that are evenly spread stay so (Owen
/// 1995). A bijection for every seed.
std::uint32_t owenScrambled(std::uint32_t bits, std::uint64_t seed);

/// A point of the unit square carried to the unit disc, equal areas to equal areas and neighbours to
/// neighbours; the centre to the centre (Shirley, Chiu, "A low distortion map between disk and square", JGT
/// 2(3), 1997). Its length is at most 1. Held by DiscPoints.*.
glm::dvec2 pointOnDisc(glm::dvec2 square);

}  // namespace quincunx

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "base/random.h"
#include "math/sample_patterns.h"

/// Sets of points in the unit square, and the numbers that a path is made of. All are the same for the same
/// arguments on every machine and for any number of threads; every number is a multiple of 2^-24 in [0, 1),
/// cells' edges apart.
namespace quincunx {

/// `count` points of equal weight, any count (at most 2^24).
///
/// `regular` and `jittered` share cells: about √count rows, whose heights go with the cells in them, so that
/// every cell has the area 1/count whatever the count; one point each, in the centre or anywhere.
/// `nRooks`: one point in each of count columns and of count rows (Shirley 1991). `halton`: bases 2 and 3,
/// shifted on the torus. `sobol`: the first two dimensions, an elementary net for counts that are powers of
/// two, Owen-scrambled (Owen 1995; each bit flipped by a hash of all those above it). `quincunx`: of half as
/// many cells the lower corners and the centres; a corner serves four cells, so that one cell weighs its
/// corners by 1/8 each and its centre by 1/2, at a cost of two points.
///
/// `regular` and `quincunx` do not depend on the seed.
std::vector<glm::vec2> samplePattern(SamplePattern pattern, std::size_t count, std::uint64_t seed = 0);

/// A number from 32 random bits: of the 2^24 multiples of 2^-24 in [0, 1) each as often, and never 1, which
/// bits / 2^32 in float is 128 times. Held by UnitFloat.*.
inline float unitFloat(std::uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}
float unitFloatNaive(std::uint32_t bits);

/// low + u (high − low), rounded, in [low, high) for every u in [0, 1); low < high, finite. What rounding
/// would take to `high` becomes the number before it. Held by UniformBetween.*.
float uniformBetween(float low, float high, float u);
float uniformBetweenNaive(float low, float high, float u);

/// Each of low … high alike, without bias; low ≤ high.
std::int64_t integerBetween(std::int64_t low, std::int64_t high, Random& random);
/// (int)(low + u (high − low + 1)): the conversion cuts towards zero, not down.
std::int64_t integerBetweenNaive(std::int64_t low, std::int64_t high, Random& random);

/// A point of cell `cell` of `cells` (1 … 2^24) equal ones of [0, 1): cell/cells ≤ result < (cell + 1)/cells,
/// exactly, for every u in [0, 1). Held by JitterCell.*.
float jitterCell(std::uint32_t cell, std::uint32_t cells, float u);
float jitterCellNaive(std::uint32_t cell, std::uint32_t cells, float u);

/// The numbers of one path. Two words of state: cheap to make for every sample of every pixel.
class PathSampler {
  public:
    /// `independent` numbers know nothing of one another: the error goes with samples^-½. `sobol` gives each
    /// pair of `next2` of a pixel's samples 0, 1, 2 … the points of an Owen-scrambled Sobol set in shuffled
    /// order (Burley, "Practical hash-based Owen scrambling", JCGT 2020), other ones for each pair: less
    /// error for as many samples, most when their number is a power of two.
    enum class Kind { independent, sobol };

    PathSampler(std::uint32_t pixel, std::uint32_t sample, std::uint64_t seed, Kind kind = Kind::independent)
        : state_(mixed(mixed(seed ^ 0x632be59bd9b4e019u) + pixel)), sample_(sample), kind_(kind) {
        if (kind == Kind::independent)
            state_ = mixed(state_ + (static_cast<std::uint64_t>(sample) << 32));
    }

    /// Uniform in [0, 1).
    float next() {
        const std::uint64_t bits = advance();
        return kind_ == Kind::independent ? unitFloat(static_cast<std::uint32_t>(bits >> 32))
                                          : sobolNumber(sample_, bits);
    }
    glm::vec2 next2() {
        const std::uint64_t bits = advance();
        if (kind_ == Kind::independent)
            return {unitFloat(static_cast<std::uint32_t>(bits >> 32)),
                    unitFloat(static_cast<std::uint32_t>(bits))};
        return sobolPoint(sample_, bits);
    }

  private:
    static std::uint64_t mixed(std::uint64_t seed) { return Random(seed).bits(); }
    std::uint64_t advance() {
        Random random(state_);
        state_ += 0x9e3779b97f4a7c15u;
        return random.bits();
    }
    static float sobolNumber(std::uint32_t index, std::uint64_t hash);  ///< the first of sobolPoint
    static glm::vec2 sobolPoint(std::uint32_t index, std::uint64_t hash);

    std::uint64_t state_;
    std::uint32_t sample_;
    Kind kind_;
};

}  // namespace quincunx

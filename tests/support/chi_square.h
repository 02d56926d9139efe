#pragma once

#include <cmath>
#include <cstddef>
#include <span>

/// Tests of what is drawn at random against what should come out, for seeds that are fixed: the outcome is
/// the same in every run, so that a test that passes goes on passing until the code changes.
///
/// A family of `tests` tests, each at the level that `levelOfEach` gives, rejects a right sampler somewhere
/// with the family's probability, 1 % as a rule: that is how often a new seed, or a change that alters the
/// order of numbers and nothing else, meets a failure by chance. A wrong sampler meets p values of 1e-10 and
/// less with the counts used here; every family is shown to find a planted error.
namespace quincunx::statistics {

struct ChiSquareOutcome {
    double statistic = 0;
    int degreesOfFreedom = 0;
    double pValue = 1;  ///< how often a right sampler deviates this much or more
};

/// Pearson's test of counts against expected counts, both for the same cells, the last of which may be
/// "nothing drawn". Cells are pooled, in order of what is expected, until at least five are expected in each.
ChiSquareOutcome chiSquareTest(std::span<const double> observed, std::span<const double> expected);

/// Mean and variance of a stream of numbers (Welford, Technometrics 4(3), 1962).
class Moments {
  public:
    void add(double x) {
        ++count_;
        const double step = x - mean_;
        mean_ += step / static_cast<double>(count_);
        squares_ += step * (x - mean_);
    }
    std::size_t count() const { return count_; }
    double mean() const { return mean_; }
    double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
    double standardError() const { return std::sqrt(variance() / static_cast<double>(count_)); }

  private:
    std::size_t count_ = 0;
    double mean_ = 0;
    double squares_ = 0;
};

/// Student's test of a mean: how often numbers of the expected mean have one this far or farther away.
/// `slack` is what the expected value itself may be off by. Numbers that are all the same have p = 1 within
/// the slack, else 0.
double studentTTest(const Moments& moments, double expected, double slack = 0);

/// Šidák's level of each of `tests` independent tests.
inline double levelOfEach(int tests, double family = 0.01) {
    return -std::expm1(std::log1p(-family) / tests);
}

}  // namespace quincunx::statistics

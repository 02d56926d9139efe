#include "tests/support/chi_square.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>

namespace quincunx::statistics {

ChiSquareOutcome chiSquareTest(std::span<const double> observed, std::span<const double> expected) {
    constexpr double leastExpected = 5;
    std::vector<std::size_t> order(expected.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    ChiSquareOutcome outcome;
    struct Cell {
        double observed = 0;
        double expected = 0;
    };
    std::vector<Cell> cells;
    Cell pool;
    for (const std::size_t i : order) {
        pool.observed += observed[i];
        pool.expected += expected[i];
        if (pool.expected >= leastExpected) {
            cells.push_back(pool);
            pool = {};
        }
    }
    if (cells.empty())
        return outcome;
    cells.back().observed += pool.observed;
    cells.back().expected += pool.expected;
    for (const Cell& cell : cells)
        outcome.statistic +=
            (cell.observed - cell.expected) * (cell.observed - cell.expected) / cell.expected;
    outcome.degreesOfFreedom = static_cast<int>(cells.size()) - 1;
    if (outcome.degreesOfFreedom > 0)
        outcome.pValue = boost::math::gamma_q(0.5 * outcome.degreesOfFreedom, 0.5 * outcome.statistic);
    return outcome;
}

double studentTTest(const Moments& moments, double expected, double slack) {
    const double difference = std::max(0.0, std::abs(moments.mean() - expected) - slack);
    const double error = moments.standardError();
    if (!(error > 0))
        return difference == 0 ? 1 : 0;
    const double t = difference / error;
    const auto freedom = static_cast<double>(moments.count() - 1);
    return boost::math::ibeta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
}

}  // namespace quincunx::statistics

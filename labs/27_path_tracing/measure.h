#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "trace/path.h"

namespace quincunx {

/// A mean and its standard error, by Welford's sums.
struct MeanAndError {
    double mean = 0;
    double squares = 0;
    double count = 0;

    void add(double value) {
        ++count;
        const double off = value - mean;
        mean += off / count;
        squares += off * (value - mean);
    }
    double variance() const { return squares / (count - 1); }
    double error() const { return std::sqrt(variance() / count); }
    /// How many standard errors the mean is off.
    double off(double exact) const { return std::abs(mean - exact) / error(); }
};

/// Independent samples of `sample(PathSampler&)`.
template <typename Sample>
MeanAndError meanOf(int count, std::uint64_t seed, const Sample& sample) {
    MeanAndError result;
    for (int i = 0; i < count; ++i) {
        PathSampler sampler(0, static_cast<std::uint32_t>(i), seed);
        result.add(static_cast<double>(sample(sampler)));
    }
    return result;
}

/// The slope of y over x in logarithms, by least squares.
inline double logSlope(const std::vector<double>& x, const std::vector<double>& y) {
    double meanX = 0;
    double meanY = 0;
    const auto n = static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        meanX += std::log(x[i]) / n;
        meanY += std::log(y[i]) / n;
    }
    double over = 0;
    double under = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        over += (std::log(x[i]) - meanX) * (std::log(y[i]) - meanY);
        under += (std::log(x[i]) - meanX) * (std::log(x[i]) - meanX);
    }
    return over / under;
}

}  // namespace quincunx

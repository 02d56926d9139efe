#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace quincunx {

/// The median and the interquartile range of the seconds that `work` takes.
struct Seconds {
    double median = 0;
    double spread = 0;
};

template <typename Work>
Seconds secondsOfRuns(int runs, const Work& work) {
    std::vector<double> seconds;
    for (int i = 0; i < runs; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    const auto at = [&](double share) {
        return seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
    };
    return {at(0.5), at(0.75) - at(0.25)};
}

/// Keeps a computed value from being left out as unused.
template <typename T>
void keep(const T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

}  // namespace quincunx

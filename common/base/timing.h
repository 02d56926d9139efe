#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "base/interrupt.h"

namespace quincunx {

/// What repeated runs of the same work took.
struct Timing {
    double medianSeconds = 0;
    double spreadSeconds = 0;  ///< interquartile range
};

/// Of at least one run, in any order.
Timing timingOf(std::vector<double> seconds);

/// Runs `work` by the steady clock, `warmUps` times unmeasured first. Throws Interrupted between runs.
template <typename Work>
Timing timeRuns(int repeats, const Work& work, int warmUps = 0) {
    std::vector<double> seconds;
    for (int i = -warmUps; i < repeats; ++i) {
        throwIfInterrupted();
        const auto start = std::chrono::steady_clock::now();
        work();
        if (i >= 0)
            seconds.push_back(
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return timingOf(std::move(seconds));
}

}  // namespace quincunx

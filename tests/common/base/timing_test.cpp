#include "base/timing.h"

#include <gtest/gtest.h>

namespace quincunx {
namespace {

TEST(Timing, IsTheMedianAndTheInterquartileRangeInAnyOrder) {
    const Timing timing = timingOf({9, 1, 5, 3, 7});
    EXPECT_EQ(timing.medianSeconds, 5);
    EXPECT_EQ(timing.spreadSeconds, 7 - 3);
    const Timing one = timingOf({2});
    EXPECT_EQ(one.medianSeconds, 2);
    EXPECT_EQ(one.spreadSeconds, 0);
}

TEST(Timing, WarmUpsRunWithoutBeingMeasured) {
    int runs = 0;
    const Timing timing = timeRuns(
        3, [&] { ++runs; }, 2);
    EXPECT_EQ(runs, 5);
    EXPECT_GE(timing.medianSeconds, 0);
}

}  // namespace
}  // namespace quincunx

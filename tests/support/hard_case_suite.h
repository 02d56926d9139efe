#pragma once

#include <cctype>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "math/hard_case.h"

/// The tests that every array of hard cases must pass. A test program includes this once and instantiates
/// `HardCases` with its arrays, `nameOfHardCase` naming them.
namespace quincunx {

class HardCases : public testing::TestWithParam<HardCase> {};

// Two seeds, since a bound must not hang on one set of inputs.
TEST_P(HardCases, KeepTheStableBoundWhereTheNaiveFormFails) {
    for (const std::uint64_t seed : {1u, 20260u}) {
        const HardCaseFigures figures = GetParam().run(8000, seed);
        EXPECT_EQ(figures.inputs, 8000u);
        EXPECT_EQ(figures.stableFailures, 0u) << figures.worstInput;
        EXPECT_LE(figures.stableError, GetParam().bound) << figures.worstInput;
        // The inputs are hard: the textbook form fails or is off by at least twice what is promised.
        EXPECT_TRUE(figures.naiveFailures > 0 || figures.naiveError > 2 * GetParam().bound)
            << figures.naiveError;
        EXPECT_FALSE(figures.worstInput.empty());
    }
}

TEST_P(HardCases, RepeatForTheSameSeed) {
    const HardCaseFigures first = GetParam().run(500, 7);
    const HardCaseFigures second = GetParam().run(500, 7);
    EXPECT_EQ(first.stableError, second.stableError);
    EXPECT_EQ(first.naiveError, second.naiveError);
    EXPECT_EQ(first.worstInput, second.worstInput);
    EXPECT_EQ(GetParam().run(0, 7).inputs, 0u);
}

inline std::string nameOfHardCase(const testing::TestParamInfo<HardCase>& info) {
    std::string name;
    for (const char c : std::string(info.param.routine))
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            name += c;
    return name + std::to_string(info.index);
}

}  // namespace quincunx

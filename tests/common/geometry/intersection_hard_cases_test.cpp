#include "geometry/intersection_hard_cases.h"

#include <cctype>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "geometry/triangle_hard_cases.h"

namespace quincunx {
namespace {

class IntersectionHardCases : public testing::TestWithParam<HardCase> {};

// Two seeds, since a bound must not hang on one set of inputs.
TEST_P(IntersectionHardCases, KeepTheStableBoundWhereTheNaiveFormFails) {
    for (const std::uint64_t seed : {1u, 20260u}) {
        const HardCaseFigures figures = GetParam().run(8000, seed);
        EXPECT_EQ(figures.inputs, 8000u);
        EXPECT_EQ(figures.stableFailures, 0u) << figures.worstInput;
        EXPECT_LE(figures.stableError, GetParam().bound) << figures.worstInput;
        EXPECT_TRUE(figures.naiveFailures > 0 || figures.naiveError > 2 * GetParam().bound)
            << figures.naiveError;
        EXPECT_FALSE(figures.worstInput.empty());
    }
}

TEST_P(IntersectionHardCases, RepeatForTheSameSeed) {
    const HardCaseFigures first = GetParam().run(300, 7);
    const HardCaseFigures second = GetParam().run(300, 7);
    EXPECT_EQ(first.stableError, second.stableError);
    EXPECT_EQ(first.naiveError, second.naiveError);
    EXPECT_EQ(first.worstInput, second.worstInput);
    EXPECT_EQ(GetParam().run(0, 7).inputs, 0u);
}

std::string nameOf(const testing::TestParamInfo<HardCase>& info) {
    std::string name;
    for (const char c : std::string(info.param.routine))
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            name += c;
    return name + std::to_string(info.index);
}

const auto cases = intersectionHardCases();
const auto triangleCases = triangleHardCases();
INSTANTIATE_TEST_SUITE_P(Triangles, IntersectionHardCases,
                         testing::ValuesIn(triangleCases.begin(), triangleCases.end()), nameOf);
INSTANTIATE_TEST_SUITE_P(Of, IntersectionHardCases, testing::ValuesIn(cases.begin(), cases.end()), nameOf);

}  // namespace
}  // namespace quincunx

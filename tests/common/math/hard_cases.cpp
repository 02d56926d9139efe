#include "math/hard_cases.h"

#include <cctype>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "math/rigid_motion_hard_cases.h"
#include "math/rotation_hard_cases.h"
#include "math/transform_hard_cases.h"

namespace quincunx {
namespace {

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

std::string nameOf(const testing::TestParamInfo<HardCase>& info) {
    std::string name;
    for (const char c : std::string(info.param.routine))
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            name += c;
    return name + std::to_string(info.index);
}

const auto shading = shadingHardCases();
const auto frames = frameHardCases();
const auto transforms = transformHardCases();
const auto rigidMotions = rigidMotionHardCases();
INSTANTIATE_TEST_SUITE_P(Shading, HardCases, testing::ValuesIn(shading.begin(), shading.end()), nameOf);
INSTANTIATE_TEST_SUITE_P(Transforms, HardCases, testing::ValuesIn(transforms.begin(), transforms.end()),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Frames, HardCases, testing::ValuesIn(frames.begin(), frames.end()), nameOf);
INSTANTIATE_TEST_SUITE_P(RigidMotions, HardCases, testing::ValuesIn(rigidMotions.begin(), rigidMotions.end()),
                         nameOf);

const auto quaternions = quaternionHardCases();
const auto orientations = orientationHardCases();
INSTANTIATE_TEST_SUITE_P(Quaternions, HardCases, testing::ValuesIn(quaternions.begin(), quaternions.end()),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Orientations, HardCases, testing::ValuesIn(orientations.begin(), orientations.end()),
                         nameOf);

}  // namespace
}  // namespace quincunx

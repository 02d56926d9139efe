#include "math/hard_cases.h"

#include <gtest/gtest.h>

#include "math/rigid_motion_hard_cases.h"
#include "math/rotation_hard_cases.h"
#include "math/transform_hard_cases.h"
#include "tests/support/hard_case_suite.h"

namespace quincunx {
namespace {

const auto shading = shadingHardCases();
const auto frames = frameHardCases();
const auto transforms = transformHardCases();
const auto rigidMotions = rigidMotionHardCases();
INSTANTIATE_TEST_SUITE_P(Shading, HardCases, testing::ValuesIn(shading.begin(), shading.end()),
                         nameOfHardCase);
INSTANTIATE_TEST_SUITE_P(Transforms, HardCases, testing::ValuesIn(transforms.begin(), transforms.end()),
                         nameOfHardCase);
INSTANTIATE_TEST_SUITE_P(Frames, HardCases, testing::ValuesIn(frames.begin(), frames.end()), nameOfHardCase);
INSTANTIATE_TEST_SUITE_P(RigidMotions, HardCases, testing::ValuesIn(rigidMotions.begin(), rigidMotions.end()),
                         nameOfHardCase);

const auto quaternions = quaternionHardCases();
const auto orientations = orientationHardCases();
INSTANTIATE_TEST_SUITE_P(Quaternions, HardCases, testing::ValuesIn(quaternions.begin(), quaternions.end()),
                         nameOfHardCase);
INSTANTIATE_TEST_SUITE_P(Orientations, HardCases, testing::ValuesIn(orientations.begin(), orientations.end()),
                         nameOfHardCase);

}  // namespace
}  // namespace quincunx

#include "geometry/intersection_hard_cases.h"

#include <gtest/gtest.h>

#include "geometry/triangle_hard_cases.h"
#include "tests/support/hard_case_suite.h"

namespace quincunx {
namespace {

const auto cases = intersectionHardCases();
const auto triangleCases = triangleHardCases();
INSTANTIATE_TEST_SUITE_P(Triangles, HardCases, testing::ValuesIn(triangleCases.begin(), triangleCases.end()),
                         nameOfHardCase);
INSTANTIATE_TEST_SUITE_P(Of, HardCases, testing::ValuesIn(cases.begin(), cases.end()), nameOfHardCase);

}  // namespace
}  // namespace quincunx

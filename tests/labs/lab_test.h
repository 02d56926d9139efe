#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gl/context.h"
#include "image/image.h"
#include "lab/lab.h"
#include "lab/studio.h"
#include "tests/support/broken_shaders.h"

/// What the tests of all labs share.
namespace quincunx::test {

/// A picture's size in pixels.
struct Size {
    int width;
    int height;
};

/// The largest difference of two values of two images of the same size.
double largestDifference(const Image& a, const Image& b);
bool isFinite(const Image& image);

/// For INSTANTIATE_TEST_SUITE_P over back ends.
std::string nameOfBackend(const testing::TestParamInfo<gl::Backend>& info);

/// The lab answers just these questions, in words and in figures, at least two of them with a bound, and all
/// bounds hold.
void expectAnswersHold(Lab& lab, Studio& studio, const std::vector<int>& numbers);

/// Every hard case keeps its bound where its naive form does not.
void expectStressHolds(Lab& lab, std::uint64_t inputs = 5000);

/// The picture is that of data/golden/LAB/NAME.png, but for what another vector width of the processor moves
/// at edges (mean ꟻLIP below 0.001). Written afresh when QUINCUNX_WRITE_GOLDENS is set.
void expectGolden(const Image8& picture, const std::string& labFolder, const std::string& name,
                  double limit = 0.003);

/// OSMesa and EGL draw each lab, as it is, with the same bits in each size.
using MakeLab = std::function<std::unique_ptr<Lab>()>;
void expectSameBitsOnBothBackends(const std::vector<MakeLab>& makers, const std::vector<Size>& sizes);
inline void expectSameBitsOnBothBackends(const MakeLab& make, const std::vector<Size>& sizes) {
    expectSameBitsOnBothBackends(std::vector{make}, sizes);
}

}  // namespace quincunx::test

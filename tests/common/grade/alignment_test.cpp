// What happened to a picture on its way is found out, and a wrong picture is not explained away.

#include "grade/alignment.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "image/compare.h"
#include "tests/common/grade/drawing.h"

namespace quincunx::grade {
namespace {

using test::drawing;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<Handling> found(const Alignment& alignment) {
    std::vector<Handling> handlings;
    for (const Finding& finding : alignment.findings)
        handlings.push_back(finding.handling);
    return handlings;
}

Image8 throughPower(Image8 image, double exponent) {
    for (std::uint8_t& code : image.data)
        code = static_cast<std::uint8_t>(std::lround(255 * std::pow(code / 255.0, exponent)));
    return image;
}

Image8 noisy(Image8 image, int codes) {
    Random random(7);
    for (std::uint8_t& code : image.data)
        code = static_cast<std::uint8_t>(std::clamp<int>(
            code + static_cast<int>(random.below(static_cast<std::uint64_t>(2 * codes + 1))) - codes, 0,
            255));
    return image;
}

TEST(Alignment, LeavesTheSamePictureAlone) {
    const Alignment alignment = align(drawing(96, 64), drawing(96, 64));
    EXPECT_THAT(alignment.findings, IsEmpty());
    EXPECT_EQ(alignment.reference, alignment.submitted);
}

TEST(Alignment, LeavesTheRoundingsOfAnotherDriverAlone) {
    EXPECT_THAT(align(drawing(96, 64), noisy(drawing(96, 64), 3)).findings, IsEmpty());
}

TEST(Alignment, NamesABlankPicture) {
    Image8 grey(96, 64, 3, Encoding::srgb);
    std::fill(grey.data.begin(), grey.data.end(), std::uint8_t{90});
    EXPECT_THAT(found(align(drawing(96, 64), grey)), ElementsAre(Handling::blank));
    EXPECT_THAT(found(align(drawing(96, 64), noisy(grey, 1))), ElementsAre(Handling::blank));
}

TEST(Alignment, FindsThePictureInAWindow) {
    Image8 window(96 + 6, 64 + 20, 3, Encoding::srgb);
    for (std::size_t i = 0; i < window.data.size(); ++i)
        window.data[i] = static_cast<std::uint8_t>(200 + i % 7);
    const Image8 inside = drawing(96, 64);
    for (int y = 0; y < 64; ++y)
        std::copy_n(inside.pixel(0, y), 3 * 96, window.pixel(3, y + 17));
    const Alignment alignment = align(inside, window);
    EXPECT_THAT(found(alignment), ElementsAre(Handling::bordered));
    EXPECT_EQ(alignment.submitted, inside);
}

TEST(Alignment, FindsWhereRowsAndColumnsWereCutOff) {
    const Image8 whole = drawing(96, 64);
    for (const auto& [left, top] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 2)}) {
        const Alignment alignment = align(whole, cropped(whole, left, top, 96 - left, 64 - top));
        EXPECT_THAT(found(alignment), ElementsAre(Handling::cropped));
        EXPECT_EQ(alignment.reference, alignment.submitted) << left << ' ' << top;
        EXPECT_EQ(alignment.left, left);
        EXPECT_EQ(alignment.top, top);
    }
}

TEST(Alignment, FindsAShift) {
    const Image8 whole = drawing(100, 70);
    const Alignment alignment = align(cropped(whole, 0, 0, 96, 64), cropped(whole, 3, 1, 96, 64));
    EXPECT_THAT(found(alignment), ElementsAre(Handling::shifted));
    EXPECT_EQ(alignment.reference, alignment.submitted);
}

TEST(Alignment, BringsAScaledPictureToSize) {
    const Alignment alignment = align(drawing(96, 64), drawing(192, 128));
    EXPECT_THAT(found(alignment), ElementsAre(Handling::scaled));
    // Measured: 0.017. Edges are between pixels; a picture of something else has 0.2 and more.
    EXPECT_LE(rmse(alignment.reference, alignment.submitted), 0.03);
}

TEST(Alignment, FindsPowerCurvesAndUndoesThem) {
    for (const double exponent : {1 / 2.2, 0.8, 1.25, 2.2}) {
        const Alignment alignment = align(drawing(96, 64), throughPower(drawing(96, 64), exponent));
        EXPECT_THAT(found(alignment), ElementsAre(Handling::gamma)) << exponent;
        // Measured: 0.009 at 2.2, which takes dark codes together.
        EXPECT_LE(rmse(alignment.reference, alignment.submitted), 0.015) << exponent;
    }
}

TEST(Alignment, FindsExchangedChannels) {
    Image8 swapped = drawing(96, 64);
    for (std::size_t i = 0; i < swapped.data.size(); i += 3)
        std::swap(swapped.data[i], swapped.data[i + 2]);
    const Alignment alignment = align(drawing(96, 64), swapped);
    EXPECT_THAT(found(alignment), ElementsAre(Handling::swappedChannels));
    EXPECT_EQ(alignment.submitted, drawing(96, 64));
}

TEST(Alignment, FindsMirrors) {
    Image8 upsideDown = drawing(96, 64);
    for (int y = 0; y < 32; ++y)
        std::swap_ranges(upsideDown.pixel(0, y), upsideDown.pixel(0, y) + 3 * 96,
                         upsideDown.pixel(0, 63 - y));
    EXPECT_THAT(found(align(drawing(96, 64), upsideDown)), ElementsAre(Handling::mirrored));
}

TEST(Alignment, DoesNotExplainAPictureThatIsWrong) {
    Image8 wrong = drawing(96, 64);
    for (int y = 20; y < 64; ++y)
        for (int x = 50; x < 90; ++x)
            std::fill_n(wrong.pixel(x, y), 3, std::uint8_t{90});
    EXPECT_THAT(align(drawing(96, 64), wrong).findings, IsEmpty());
}

TEST(Alignment, AcceptsAnySizeAndNumberOfChannels) {
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(1, 300), std::pair(97, 64), std::pair(500, 2)})
        for (int channels = 1; channels <= 4; ++channels) {
            const Alignment alignment =
                align(drawing(96, 64), Image8(width, height, channels, Encoding::srgb));
            EXPECT_EQ(alignment.reference.data.size(), alignment.submitted.data.size());
        }
}

TEST(Resizing, KeepsAConstantAndTheMean) {
    Image8 constant(33, 21, 3, Encoding::srgb);
    std::fill(constant.data.begin(), constant.data.end(), std::uint8_t{77});
    for (const std::uint8_t code : resized(constant, 10, 50).data)
        EXPECT_EQ(code, 77);
}

}  // namespace
}  // namespace quincunx::grade

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "image/color.h"
#include "image/compare.h"
#include "tests/common/image/pictures.h"

namespace quincunx {
namespace {

using testing::HasSubstr;

// Means in float32 against double: measured up to 3e-7.
constexpr double meanTolerance = 1e-6;

// One pixel: lightness up to 100 comes from a cube root rounded to some 2^-23, so a distance is off by up to
// 4 · 116 · 2^-23 = 6e-5, and the power 0.7 (steep at 0) and the remapping make that 0.95 / 16.4 · 6e-5^0.7 =
// 6e-5 where the pictures all but agree. Measured 5.6e-5.
constexpr double pixelTolerance = 7e-5;

Image8 constant(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    Image8 image(width, height, 3, Encoding::srgb);
    for (std::size_t i = 0; i < image.data.size(); i += 3) {
        image.data[i] = r;
        image.data[i + 1] = g;
        image.data[i + 2] = b;
    }
    return image;
}

FlipSettings at(double pixelsPerDegree) {
    FlipSettings settings;
    settings.pixelsPerDegree = pixelsPerDegree;
    return settings;
}

/// The steps that `ppd` does not touch, for pictures of one colour: CIELAB with Hunt's adjustment, HyAB,
/// remapping. Written from the paper in double with CIE's own constants, not from the code under test.
double flipOfConstants(const double (&reference)[3], const double (&test)[3]) {
    // XYZ of the sRGB primaries under D65 (0.31271, 0.32902), to six digits.
    constexpr double m[3][3] = {
        {0.412387, 0.357591, 0.180450}, {0.212637, 0.715183, 0.072180}, {0.019331, 0.119197, 0.950373}};
    const auto lab = [&](const double(&rgb)[3]) {
        double f[3];
        for (int row = 0; row < 3; ++row) {
            const double white = m[row][0] + m[row][1] + m[row][2];
            const double t = (m[row][0] * rgb[0] + m[row][1] * rgb[1] + m[row][2] * rgb[2]) / white;
            f[row] = t > std::pow(6.0 / 29, 3) ? std::cbrt(t) : t / (3 * 36.0 / 841) + 4.0 / 29;
        }
        const double l = 116 * f[1] - 16;
        return std::array<double, 3>{l, l / 100 * 500 * (f[0] - f[1]), l / 100 * 200 * (f[1] - f[2])};
    };
    const auto distance = [&](const double(&p)[3], const double(&q)[3]) {
        const auto a = lab(p);
        const auto b = lab(q);
        return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
    };
    const double largest = distance({0, 1, 0}, {0, 0, 1});
    const double d = distance(reference, test);
    const double knee = 0.4 * largest;
    return d < knee ? 0.95 * d / knee : 0.95 + 0.05 * (d - knee) / (largest - knee);
}

TEST(Flip, IsZeroForEqualPictures) {
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {300, 20}, {257, 261}}) {
        const Image8 image = noise8(width, height, 3, 4);
        EXPECT_EQ(flip(image, image), 0) << width << " × " << height;
    }
}

TEST(Flip, OfConstantPicturesIsTheRemappedColourDistance) {
    const auto check = [](std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t r2, std::uint8_t g2,
                          std::uint8_t b2) {
        const auto linear = [](std::uint8_t code) { return static_cast<double>(linearOfCode()[code]); };
        const double reference[3] = {linear(r), linear(g), linear(b)};
        const double test[3] = {linear(r2), linear(g2), linear(b2)};
        // 2e-6: the matrix of the expected value has six digits.
        EXPECT_NEAR(flip(constant(40, 30, r, g, b), constant(40, 30, r2, g2, b2)),
                    flipOfConstants(reference, test), 2e-6);
    };
    check(0, 0, 0, 255, 255, 255);
    check(0, 255, 0, 0, 0, 255);
    check(255, 0, 0, 0, 255, 255);
    check(10, 10, 10, 12, 10, 10);
    check(0, 0, 0, 1, 0, 0);
    check(128, 64, 200, 120, 80, 190);
}

TEST(Flip, OfGreenAgainstBlueIsOne) {
    EXPECT_NEAR(flip(constant(9, 9, 0, 255, 0), constant(9, 9, 0, 0, 255)), 1, 1e-6);
}

TEST(Flip, OfBlackAgainstWhiteDoesNotDependOnPixelsPerDegree) {
    // 100^0.7 between knee and largest: 0.9673797621528, from the direct evaluation below.
    for (const double ppd : {1.0, 20.0, 67.0, 300.0})
        EXPECT_NEAR(flip(constant(50, 40, 0, 0, 0), constant(50, 40, 255, 255, 255), at(ppd)),
                    0.9673797621528, meanTolerance)
            << ppd;
}

/// Means and pixels from a program of a different kind: numpy 1.24 and scipy 1.9 in double, each filter one
/// unseparated two-dimensional kernel over the whole picture (scipy.ndimage.correlate, mode "nearest"), CIE's
/// matrix and its numerical inverse.
TEST(Flip, AgreesWithDirectConvolutionInDouble) {
    struct Expected {
        int width, height;
        double ppd, mean;
    };
    const double usual = FlipSettings{}.pixelsPerDegree;
    for (const Expected& expected :
         {Expected{97, 61, usual, 0.2072102359564792}, Expected{97, 61, 30, 0.1823413358773958},
          Expected{97, 61, 120, 0.22413840900521614}, Expected{300, 200, usual, 0.19168842601925665},
          Expected{300, 200, 30, 0.1726442738097613}, Expected{300, 200, 120, 0.20463392629704097}}) {
        const double value = flip(pattern(expected.width, expected.height),
                                  distortedPattern(expected.width, expected.height), at(expected.ppd));
        EXPECT_NEAR(value, expected.mean, meanTolerance) << expected.width << " at " << expected.ppd;
    }
    const Image map = flipMap(pattern(300, 200), distortedPattern(300, 200));
    EXPECT_NEAR(*map.pixel(0, 0), 0.9627640399509347, pixelTolerance);
    EXPECT_NEAR(*map.pixel(150, 100), 0.6618571200929427, pixelTolerance);
    EXPECT_NEAR(*map.pixel(299, 199), 0.1903536850009225, pixelTolerance);
    EXPECT_NEAR(*map.pixel(30, 20), 0.03862017403184054, pixelTolerance);
}

TEST(Flip, IsSymmetric) {
    const Image8 a = pattern(120, 80);
    const Image8 b = distortedPattern(120, 80);
    EXPECT_EQ(flip(a, b), flip(b, a));
    EXPECT_EQ(flipMap(a, b), flipMap(b, a));
}

TEST(Flip, TurnsWithThePictures) {
    const Image8 a = pattern(70, 40);
    const Image8 b = distortedPattern(70, 40);
    const auto transposed = [](const Image8& image) {
        Image8 result(image.height, image.width, 3, Encoding::srgb);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                std::copy_n(image.pixel(x, y), 3, result.pixel(y, x));
        return result;
    };
    const Image map = flipMap(a, b);
    const Image turned = flipMap(transposed(a), transposed(b));
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            ASSERT_NEAR(*map.pixel(x, y), *turned.pixel(y, x), pixelTolerance) << x << ", " << y;
}

TEST(Flip, IsTheMeanOfItsMap) {
    const Image8 a = noise8(301, 277, 3, 1);
    const Image8 b = noise8(301, 277, 3, 2);
    const Image map = flipMap(a, b);
    double sum = 0;
    for (const float value : map.data) {
        ASSERT_GE(value, 0);
        ASSERT_LE(value, 1);
        sum += static_cast<double>(value);
    }
    EXPECT_NEAR(flip(a, b), sum / static_cast<double>(map.pixelCount()), 1e-12);
}

TEST(Flip, GivesTheSameBitsOnAnyNumberOfThreads) {
    const Image8 a = noise8(700, 530, 3, 1);
    const Image8 b = noise8(700, 530, 3, 2);
    const auto onThreads = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return std::pair{std::bit_cast<std::uint64_t>(flip(a, b)), flipMap(a, b)};
    };
    const auto one = onThreads(1);
    EXPECT_EQ(onThreads(2), one);
    EXPECT_EQ(onThreads(4), one);
}

TEST(Flip, SeesNoSeamBetweenTiles) {
    // A picture and its part: where the filters see the same pixels, the errors are the same to the last bit.
    const Image8 a = pattern(600, 560);
    const Image8 b = distortedPattern(600, 560);
    const auto part = [](const Image8& image, int x0, int y0) {
        Image8 result(200, 200, 3, Encoding::srgb);
        for (int y = 0; y < 200; ++y)
            std::copy_n(image.pixel(x0, y0 + y), 600, result.pixel(0, y));
        return result;
    };
    const Image whole = flipMap(a, b);
    const Image cut = flipMap(part(a, 170, 170), part(b, 170, 170));
    for (int y = 10; y < 190; ++y)
        for (int x = 10; x < 190; ++x)
            ASSERT_EQ(*cut.pixel(x, y), *whole.pixel(170 + x, 170 + y)) << x << ", " << y;
}

TEST(Flip, OfFloatsIsThatOfTheirCodes) {
    const Image8 a = pattern(90, 50);
    const Image8 b = distortedPattern(90, 50);
    EXPECT_EQ(flip(toLinear(a), toLinear(b)), flip(a, b));
    EXPECT_EQ(flipMap(toLinear(a), toLinear(b)), flipMap(a, b));
}

TEST(Flip, OfGreyIsThatOfEqualChannels) {
    const Image8 grey = noise8(50, 40, 1, 3);
    Image8 rgb(50, 40, 3, Encoding::srgb);
    for (std::size_t i = 0; i < rgb.data.size(); ++i)
        rgb.data[i] = grey.data[i / 3];
    EXPECT_EQ(flip(grey, rgb), 0);
}

TEST(Flip, CountsAPixelThatIsNotANumberAsTheWorstError) {
    Image a(40, 30, 3, Encoding::linear);
    Image b = a;
    b.pixel(12, 7)[1] = std::numeric_limits<float>::quiet_NaN();
    b.pixel(20, 20)[0] = -std::numeric_limits<float>::infinity();
    const Image map = flipMap(a, b);
    EXPECT_EQ(*map.pixel(12, 7), 1);
    EXPECT_EQ(*map.pixel(13, 7), 0);
    EXPECT_EQ(*map.pixel(20, 20), 0);
    EXPECT_EQ(flip(b, b), 1.0 / 1200);
    b.pixel(20, 20)[0] = std::numeric_limits<float>::infinity();
    EXPECT_GT(*flipMap(a, b).pixel(20, 20), 0.1F);
}

TEST(Flip, RefusesOtherSizesNamingBoth) {
    try {
        flip(noise8(4, 5, 3, 1), noise8(6, 7, 3, 1));
        FAIL() << "nothing thrown";
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("4 × 5"));
        EXPECT_THAT(e.what(), HasSubstr("6 × 7"));
    }
    EXPECT_THROW(flip(Image8(), Image8()), InputError);
}

TEST(Flip, RefusesSenselessResolutions) {
    const Image8 image = noise8(4, 4, 3, 1);
    for (const double ppd : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(flip(image, image, at(ppd)), InputError) << ppd;
    EXPECT_EQ(flip(image, image, at(1)), 0);
    EXPECT_EQ(flip(image, image, at(10000)), 0);
}

}  // namespace
}  // namespace quincunx

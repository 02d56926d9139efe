#include "image/compare.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "image/color.h"
#include "tests/common/image/pictures.h"

namespace quincunx {
namespace {

using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Metric allMetrics[] = {Metric::rmse, Metric::psnr, Metric::ssim, Metric::flip};

// The expected values of this file come from numpy 1.24 and scikit-image 0.19.3 on the same pictures: sqrt of
// the mean of squares; peak_signal_noise_ratio(data_range=255); structural_similarity(gaussian_weights=True,
// sigma=1.5, use_sample_covariance=False, data_range=255) on 0.299 R + 0.587 G + 0.114 B. Both sides are
// double: they differ by the rounding of sums, measured below 1e-13.
constexpr double tolerance = 1e-11;

TEST(Rmse, AgreesWithNumpy) {
    EXPECT_NEAR(rmse(pattern(97, 61), distortedPattern(97, 61)), 0.10874191551971722, tolerance);
    EXPECT_NEAR(rmse(pattern(300, 200), distortedPattern(300, 200)), 0.0962030701936398, tolerance);
}

TEST(Psnr, AgreesWithScikitImage) {
    EXPECT_NEAR(psnr(pattern(97, 61), distortedPattern(97, 61)), 19.27206042092636, tolerance);
    EXPECT_NEAR(psnr(pattern(300, 200), distortedPattern(300, 200)), 20.336221356150276, tolerance);
}

TEST(Ssim, AgreesWithScikitImage) {
    EXPECT_NEAR(ssim(pattern(97, 61), distortedPattern(97, 61)), 0.8529067922727755, tolerance);
    EXPECT_NEAR(ssim(pattern(300, 200), distortedPattern(300, 200)), 0.8599994453190428, tolerance);
}

TEST(Rmse, OfOneChannelOffByOneCode) {
    Image8 a(4, 4, 3, Encoding::srgb);
    Image8 b = a;
    b.data[5] = 1;
    EXPECT_DOUBLE_EQ(rmse(a, b), std::sqrt(1.0 / 48) / 255);
}

TEST(Psnr, OfBlackAgainstWhiteIsZero) {
    const Image8 black(5, 5, 3, Encoding::srgb);
    Image8 white = black;
    std::fill(white.data.begin(), white.data.end(), std::uint8_t{255});
    EXPECT_EQ(psnr(black, white), 0);
    EXPECT_EQ(rmse(black, white), 1);
}

TEST(Ssim, OfConstantsIsTheLuminanceTerm) {
    Image8 a(20, 20, 1, Encoding::srgb);
    Image8 b = a;
    std::fill(a.data.begin(), a.data.end(), std::uint8_t{100});
    std::fill(b.data.begin(), b.data.end(), std::uint8_t{150});
    const double c1 = 6.5025;  // (0.01 · 255)²
    EXPECT_NEAR(ssim(a, b), (2 * 100 * 150 + c1) / (100 * 100 + 150 * 150 + c1), 1e-9);
}

TEST(Ssim, RefusesPicturesSmallerThanItsWindow) {
    EXPECT_THROW(ssim(noise8(10, 11, 3, 1), noise8(10, 11, 3, 1)), InputError);
    EXPECT_EQ(ssim(noise8(11, 11, 3, 1), noise8(11, 11, 3, 1)), 1);
}

TEST(Metrics, OfEqualPicturesAreTheBest) {
    const Image8 image = noise8(40, 30, 3, 8);
    for (const Metric metric : allMetrics) {
        const Comparison comparison = compareImages(image, image, metric);
        const double best = metric == Metric::psnr ? infinity : (metric == Metric::ssim ? 1 : 0);
        EXPECT_EQ(comparison.value, best) << metricName(metric);
        for (const float error : comparison.perPixel.data)
            ASSERT_EQ(error, 0) << metricName(metric);
    }
}

TEST(Metrics, AreSymmetric) {
    const Image8 a = pattern(50, 40);
    const Image8 b = distortedPattern(50, 40);
    for (const Metric metric : allMetrics)
        EXPECT_EQ(compareImages(a, b, metric).value, compareImages(b, a, metric).value) << metricName(metric);
}

TEST(Metrics, GetWorseAsNoiseGrows) {
    const Image8 clean = pattern(80, 60);
    for (const Metric metric : allMetrics) {
        double before = higherIsBetter(metric) ? infinity : -1;
        for (const int strength : {2, 8, 32, 128}) {
            Image8 noisy = clean;
            NoiseSource source(1);
            for (std::uint8_t& code : noisy.data) {
                const int shift = static_cast<int>(source.next() >> 16) % (2 * strength + 1) - strength;
                code = static_cast<std::uint8_t>(std::clamp(code + shift, 0, 255));
            }
            const double value = compareImages(clean, noisy, metric).value;
            EXPECT_TRUE(higherIsBetter(metric) ? value < before : value > before)
                << metricName(metric) << " at " << strength;
            before = value;
        }
    }
}

TEST(Metrics, HaveNamesThatParseBack) {
    for (const Metric metric : allMetrics)
        EXPECT_EQ(parseMetric(metricName(metric)), metric);
    EXPECT_FALSE(parseMetric("mse"));
    EXPECT_FALSE(parseMetric(""));
}

TEST(Metrics, RefuseOtherSizesAndEncodings) {
    const Image8 a = noise8(20, 12, 3, 1);
    Image8 linear = a;
    linear.encoding = Encoding::linear;
    for (const Metric metric : allMetrics) {
        try {
            compareImages(a, noise8(20, 13, 3, 1), metric);
            FAIL() << "nothing thrown";
        } catch (const InputError& e) {
            EXPECT_THAT(e.what(), HasSubstr("20 × 12"));
            EXPECT_THAT(e.what(), HasSubstr("20 × 13"));
        }
        EXPECT_THROW(compareImages(a, linear, metric), InputError);
        EXPECT_THROW(compareImages(Image8(), Image8(), metric), InputError);
    }
}

TEST(Metrics, TakeGreyForEqualChannelsAndMissingAlphaForOpaque) {
    const Image8 grey = noise8(20, 20, 1, 3);
    Image8 rgba(20, 20, 4, Encoding::srgb);
    for (std::size_t i = 0; i < rgba.data.size(); ++i)
        rgba.data[i] = i % 4 == 3 ? 255 : grey.data[i / 4];
    EXPECT_EQ(rmse(grey, rgba), 0);
    EXPECT_EQ(ssim(grey, grey), 1);
    rgba.data[3] = 0;
    EXPECT_DOUBLE_EQ(rmse(grey, rgba), std::sqrt(1.0 / 1600));
}

TEST(Rmse, OfFloatsThatAreNotFiniteIsInfinite) {
    Image a(3, 3, 1, Encoding::linear);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Image b = a;
        b.data[4] = bad;
        EXPECT_EQ(rmse(a, b), infinity);
        EXPECT_EQ(rmse(b, a), infinity);
        EXPECT_EQ(rmse(b, b), infinity);
    }
}

TEST(Rmse, OfFloatsIsNotClamped) {
    Image a(2, 1, 1, Encoding::linear);
    Image b = a;
    b.data = {3, -4};
    EXPECT_DOUBLE_EQ(rmse(a, b), std::sqrt(12.5));
}

TEST(ErrorMap, GrowsLighterWithTheErrorAndStartsBlack) {
    Image errors(256, 1, 1, Encoding::linear);
    for (int i = 0; i < 256; ++i)
        *errors.pixel(i, 0) = static_cast<float>(i) / 255;
    const Image8 map = errorMap(errors);
    const Image linear = toLinear(map);
    double before = -1;
    for (int i = 0; i < 256; ++i) {
        double luminance = 0;
        for (int c = 0; c < 3; ++c)
            luminance +=
                luminanceWeights[static_cast<std::size_t>(c)] * static_cast<double>(linear.pixel(i, 0)[c]);
        EXPECT_GE(luminance, before) << i;
        before = luminance;
    }
    EXPECT_EQ(map.pixel(0, 0)[0] + map.pixel(0, 0)[1] + map.pixel(0, 0)[2], 0);
    EXPECT_GT(before, 0.85);
}

TEST(ErrorMap, ClampsAndMarksWhatIsNotANumber) {
    Image errors(4, 1, 1, Encoding::linear);
    errors.data = {-1, 2, 1, std::numeric_limits<float>::quiet_NaN()};
    const Image8 map = errorMap(errors, 2);
    EXPECT_EQ(map.pixel(0, 0)[0], 0);
    const Image8 half = errorMap(errors, 1);
    EXPECT_TRUE(std::equal(half.pixel(1, 0), half.pixel(1, 0) + 3, map.pixel(1, 0)));
    EXPECT_EQ(map.pixel(3, 0)[0], 0);
    EXPECT_EQ(map.pixel(3, 0)[2], 255);
}

}  // namespace
}  // namespace quincunx

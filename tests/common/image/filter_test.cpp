#include "image/filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace quincunx {
namespace {

TEST(GaussianBlur, SpreadsAPointByTheGaussianItself) {
    for (const double sigma : {0.8, 2.0, 3.5}) {
        Image point(63, 63, 1, Encoding::linear);
        *point.pixel(31, 31) = 1;
        const Image blurred = gaussianBlur(point, sigma);
        double sum = 0;
        for (int y = 0; y < 63; ++y)
            for (int x = 0; x < 63; ++x) {
                const double r2 = (x - 31) * (x - 31) + (y - 31) * (y - 31);
                const double density =
                    std::exp(-r2 / (2 * sigma * sigma)) / (2 * std::numbers::pi * sigma * sigma);
                // Sampled weights sum to the density's integral but for 2 exp(−2π²σ²) along each axis: 1.3e-5
                // of 0.25 at 0.8 pixels.
                EXPECT_NEAR(*blurred.pixel(x, y), density, 4e-6);
                sum += static_cast<double>(*blurred.pixel(x, y));
            }
        EXPECT_NEAR(sum, 1, 1e-6);
    }
}

TEST(GaussianBlur, TwiceIsOnceWithTheSumOfTheVariances) {
    Image picture(96, 90, 3, Encoding::linear);
    for (std::size_t i = 0; i < picture.data.size(); ++i)
        picture.data[i] = static_cast<float>((i * 7919) % 101) / 101;
    const Image twice = gaussianBlur(gaussianBlur(picture, 3), 4);
    const Image once = gaussianBlur(picture, 5);
    // Eight deviations from the edges, which the two go on beyond in different ways.
    for (int y = 40; y < 50; ++y)
        for (int x = 40; x < 56; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(twice.pixel(x, y)[c], once.pixel(x, y)[c], 1e-6) << x << ", " << y;
}

TEST(GaussianBlur, LeavesAnEvenPictureAlone) {
    Image even(9, 5, 4, Encoding::linear);
    std::fill(even.data.begin(), even.data.end(), 0.625f);
    for (const double sigma : {0.01, 1.0, 30.0})
        EXPECT_EQ(gaussianBlur(even, sigma), even) << sigma;
}

}  // namespace
}  // namespace quincunx

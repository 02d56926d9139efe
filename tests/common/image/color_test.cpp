#include "image/color.h"

#include <bit>
#include <cmath>
#include <limits>

#include <boost/multiprecision/mpfr.hpp>
#include <gtest/gtest.h>

#include "tests/common/image/pictures.h"

namespace quincunx {
namespace {

using Exact = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50>>;

Exact exactEncode(float linear) {
    const Exact v = linear;
    return v <= Exact("0.0031308") ? Exact("12.92") * v
                                   : Exact("1.055") * pow(v, Exact(5) / 12) - Exact("0.055");
}

Exact exactDecode(const Exact& v) {
    return v <= Exact("0.04045") ? v / Exact("12.92")
                                 : pow((v + Exact("0.055")) / Exact("1.055"), Exact("2.4"));
}

double ulps(float value, const Exact& exact) {
    const float rounded = exact.convert_to<float>();
    const double ulp =
        static_cast<double>(std::nextafter(rounded, std::numeric_limits<float>::infinity()) - rounded);
    return std::abs((Exact(value) - exact).convert_to<double>()) / ulp;
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(Srgb, EncodesWithinHalfAnUlp) {
    double worst = 0;
    const auto check = [&](std::uint32_t from, std::uint32_t to, std::uint32_t step) {
        for (std::uint32_t bits = from; bits <= to; bits += step) {
            const float linear = std::bit_cast<float>(bits);
            worst = std::max(worst, ulps(srgbFromLinear(linear), exactEncode(linear)));
        }
    };
    const auto bitsOf = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    check(bitsOf(1e-6F), bitsOf(1), 20011);
    check(bitsOf(0.00313F), bitsOf(0.00314F), 7);  // about the junction
    // ½ from the rounding to float; the double below it adds 2^-28 of an ulp. Measured 0.500000.
    EXPECT_LE(worst, 0.500001);
}

TEST(Srgb, DecodesWithinHalfAnUlp) {
    double worst = 0;
    for (std::uint32_t bits = 0x3A000000; bits <= 0x3F800000; bits += 20011) {
        const float encoded = std::bit_cast<float>(bits);
        worst = std::max(worst, ulps(linearFromSrgb(encoded), exactDecode(encoded)));
    }
    EXPECT_LE(worst, 0.500001);  // as above
}

TEST(Srgb, RisesExceptForTheStandardsOwnStep) {
    int falls = 0;
    float before = 0;
    for (std::uint32_t bits = std::bit_cast<std::uint32_t>(0.0030F);
         bits < std::bit_cast<std::uint32_t>(0.0033F); ++bits) {
        const float encoded = srgbFromLinear(std::bit_cast<float>(bits));
        falls += encoded < before ? 1 : 0;
        before = encoded;
    }
    EXPECT_LE(falls, 1);
}

TEST(Srgb, StaysInTheUnitIntervalWhateverComes) {
    for (const float value : {-1e-30F, -1e-9F, -0.5F, -infinity, nan, -0.0F}) {
        EXPECT_EQ(srgbFromLinear(value), 0) << value;
        EXPECT_EQ(linearFromSrgb(value), 0) << value;
        EXPECT_EQ(srgbCode(value), 0) << value;
    }
    for (const float value : {1.0F, 1.0000001F, 65504.0F, infinity}) {
        EXPECT_EQ(srgbFromLinear(value), 1) << value;
        EXPECT_EQ(linearFromSrgb(value), 1) << value;
        EXPECT_EQ(srgbCode(value), 255) << value;
    }
    EXPECT_EQ(srgbCode(std::numeric_limits<float>::denorm_min()), 0);
}

TEST(Srgb, AllCodesSurviveTheRoundTrip) {
    for (int code = 0; code < 256; ++code) {
        const float linear = linearOfCode()[static_cast<std::size_t>(code)];
        EXPECT_LE(ulps(linear, exactDecode(Exact(code) / 255)), 0.500001) << code;
        EXPECT_EQ(srgbCode(linear), code);
    }
}

TEST(Srgb, CodesChangeAtTheFirstFloatThatRoundsUp) {
    for (int code = 1; code < 256; ++code) {
        const Exact threshold = exactDecode((Exact(code) - Exact("0.5")) / 255);
        float first = threshold.convert_to<float>();
        if (Exact(first) < threshold)
            first = std::nextafter(first, 2.0F);
        EXPECT_EQ(srgbCode(first), code);
        EXPECT_EQ(srgbCode(std::nextafter(first, 0.0F)), code - 1) << code;
    }
}

TEST(Srgb, CodesAreTheNearestEverywhere) {
    for (std::uint32_t bits = 1; bits <= 0x3F900000; bits += 997) {
        const float linear = std::bit_cast<float>(bits);
        if (bits % 50 == 0) {  // the exact value is slow
            const double encoded = exactEncode(std::min(linear, 1.0F)).convert_to<double>();
            ASSERT_EQ(srgbCode(linear), static_cast<int>(std::floor(255 * encoded + 0.5))) << linear;
        }
        ASSERT_NEAR(srgbCode(linear), 255 * static_cast<double>(srgbFromLinear(linear)), 0.50001) << linear;
    }
}

TEST(Luminance, OfWhiteIsOne) {
    EXPECT_EQ(luminanceWeights[0] + luminanceWeights[1] + luminanceWeights[2], 1.0);
    // The decimals of BT.601 are not binary fractions: one rounding.
    EXPECT_NEAR(lumaWeights[0] + lumaWeights[1] + lumaWeights[2], 1.0, 0x1p-52);
}

TEST(ImageEncoding, RoundTripKeepsEveryCodeAndAlpha) {
    for (int channels = 1; channels <= 4; ++channels) {
        const Image8 image = noise8(64, 64, channels, 5);
        EXPECT_EQ(toSrgb8(toLinear(image)), image) << channels;
    }
}

TEST(ImageEncoding, LeavesAlphaLinear) {
    Image8 image(1, 1, 4, Encoding::srgb);
    image.data = {128, 128, 128, 128};
    const Image linear = toLinear(image);
    EXPECT_EQ(linear.data[0], linearOfCode()[128]);
    EXPECT_EQ(linear.data[3], 128.0F / 255);
    Image8 grey(1, 1, 2, Encoding::srgb);
    grey.data = {128, 128};
    EXPECT_EQ(toLinear(grey).data[0], linearOfCode()[128]);
    EXPECT_EQ(toLinear(grey).data[1], 128.0F / 255);
}

TEST(ImageEncoding, LinearCodesAreFractions) {
    Image8 image(1, 1, 3, Encoding::linear);
    image.data = {0, 51, 255};
    EXPECT_EQ(toLinear(image).data, (std::vector<float>{0, 0.2F, 1}));
}

TEST(ImageEncoding, LinearFloatsPassUntouched) {
    Image image(2, 1, 1, Encoding::linear);
    image.data = {-3, 1e9F};
    EXPECT_EQ(toLinear(image), image);
}

TEST(ImageEncoding, NotANumberAndBeyondBecomeTheEnds) {
    Image image(5, 1, 1, Encoding::linear);
    image.data = {nan, -1, 2, infinity, -infinity};
    EXPECT_EQ(toSrgb8(image).data, (std::vector<std::uint8_t>{0, 0, 255, 255, 0}));
    image.encoding = Encoding::srgb;
    EXPECT_EQ(toSrgb8(image).data, (std::vector<std::uint8_t>{0, 0, 255, 255, 0}));
}

}  // namespace
}  // namespace quincunx

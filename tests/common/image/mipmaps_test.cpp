#include "image/mipmaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "base/random.h"
#include "image/block_compression.h"
#include "image/color.h"
#include "image/patterns.h"

namespace quincunx {
namespace {

Image8 noise(int width, int height, int channels, Encoding encoding, std::uint64_t seed) {
    Image8 image(width, height, channels, encoding);
    Random random(seed);
    for (std::uint8_t& code : image.data)
        code = static_cast<std::uint8_t>(random.below(256));
    return image;
}

/// The mean of what texel (x, y) of the next level covers, by areas in double.
double exactMean(const Image& image, int x, int y, int channel) {
    const int halfWidth = mipSide(image.width, 1);
    const int halfHeight = mipSide(image.height, 1);
    const auto covered = [](int texel, int i, int side, int half) {
        const double low = static_cast<double>(i) * side / half;
        const double high = static_cast<double>(i + 1) * side / half;
        return std::max(0.0, std::min(high, texel + 1.0) - std::max(low, static_cast<double>(texel))) /
               (high - low);
    };
    double mean = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            mean += covered(row, y, image.height, halfHeight) * covered(column, x, image.width, halfWidth) *
                    image.pixel(column, row)[channel];
    return mean;
}

double encoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double meanOf(const Image& image, int channel) {
    double sum = 0;
    for (std::size_t i = static_cast<std::size_t>(channel); i < image.data.size();
         i += static_cast<std::size_t>(image.channels))
        sum += image.data[i];
    return sum / static_cast<double>(image.pixelCount());
}

TEST(MipChain, HasTheSidesOfOpenGL) {
    EXPECT_EQ(mipLevelCount(1, 1), 1);
    EXPECT_EQ(mipLevelCount(2, 1), 2);
    EXPECT_EQ(mipLevelCount(255, 3), 8);
    EXPECT_EQ(mipLevelCount(256, 3), 9);
    const std::vector<Image8> levels = makeMipmaps(Image8(13, 5, 3, Encoding::srgb));
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_EQ(levels[0].width, 6);
    EXPECT_EQ(levels[0].height, 2);
    EXPECT_EQ(levels[2].width, 1);
    EXPECT_EQ(levels[2].height, 1);
    EXPECT_TRUE(makeMipmaps(Image8(1, 1, 4, Encoding::srgb)).empty());
}

TEST(MipChain, BoxIsTheMeanOfTheCoveredAreaForAllSides) {
    double worst = 0;
    for (int width = 1; width <= 9; ++width)
        for (int height = 1; height <= 9; ++height)
            for (const Encoding encoding : {Encoding::linear, Encoding::srgb}) {
                if (width == 1 && height == 1)
                    continue;
                const Image8 base =
                    noise(width, height, 4, encoding, static_cast<std::uint64_t>(width * height));
                const Image linear = toLinear(base);
                const Image8 level = makeMipmaps(base)[0];
                for (int y = 0; y < level.height; ++y)
                    for (int x = 0; x < level.width; ++x)
                        for (int c = 0; c < 4; ++c) {
                            const double mean = exactMean(linear, x, y, c);
                            const bool curved = encoding == Encoding::srgb && c < 3;
                            worst = std::max(worst, std::abs(level.pixel(x, y)[c] -
                                                             255 * (curved ? encoded(mean) : mean)));
                        }
            }
    // Half a code, and the rounding of floats. Measured: 0.50000.
    EXPECT_LE(worst, 0.5001);
}

TEST(MipChain, KeepsTheMeanOnEveryLevel) {
    for (const auto& [width, height] : {std::pair(64, 64), std::pair(255, 131), std::pair(301, 1)}) {
        Image base(width, height, 3, Encoding::linear);
        Random random(5);
        for (float& value : base.data)
            value = random.uniform();
        for (const Image& level : makeMipmaps(base))
            for (int c = 0; c < 3; ++c)
                // Measured: 2e-7 (a float's rounding, once a level).
                EXPECT_NEAR(meanOf(level, c), meanOf(base, c), 1e-6) << level.width << "x" << level.height;
    }
}

TEST(MipChain, TextbookDarkensAndForgetsTheOddColumn) {
    const Image8 base = noise(127, 127, 1, Encoding::linear, 9);
    double mean = 0;
    for (const std::uint8_t code : base.data)
        mean += code / static_cast<double>(base.pixelCount());
    EXPECT_LE(std::abs(makeMipmaps(base).back().data[0] - mean), 0.5001);
    EXPECT_GT(std::abs(makeMipmapsNaive(base).back().data[0] - mean), 1);
}

TEST(MipChain, WideFiltersLeaveConstantsAndMirrorWithTheImage) {
    for (const MipFilter filter : {MipFilter::box, MipFilter::kaiser, MipFilter::lanczos})
        for (const bool repeats : {false, true}) {
            MipmapParams params;
            params.filter = filter;
            params.repeats = repeats;
            Image8 flat(37, 20, 4, Encoding::srgb);
            std::fill(flat.data.begin(), flat.data.end(), std::uint8_t{201});
            for (const Image8& level : makeMipmaps(flat, params))
                EXPECT_TRUE(std::all_of(level.data.begin(), level.data.end(),
                                        [](std::uint8_t code) { return code == 201; }));
            const Image8 base = noise(37, 20, 1, Encoding::linear, 4);
            Image8 mirrored = base;
            for (int y = 0; y < base.height; ++y)
                for (int x = 0; x < base.width; ++x)
                    *mirrored.pixel(x, y) = *base.pixel(base.width - 1 - x, y);
            const Image8 level = makeMipmaps(base, params)[0];
            const Image8 other = makeMipmaps(mirrored, params)[0];
            for (int y = 0; y < level.height; ++y)
                for (int x = 0; x < level.width; ++x)
                    EXPECT_NEAR(*level.pixel(x, y), *other.pixel(level.width - 1 - x, y), 1);
        }
}

TEST(MipChain, WideFiltersKeepWhatFitsAndDropWhatDoesNot) {
    constexpr int side = 128;
    const auto amplitude = [](int periods, MipFilter filter) {
        Image line(side, 1, 1, Encoding::linear);
        for (int x = 0; x < side; ++x)
            *line.pixel(x, 0) =
                static_cast<float>(std::cos(2 * std::numbers::pi * periods * (x + 0.5) / side));
        MipmapParams params;
        params.filter = filter;
        params.repeats = true;
        const Image level = makeMipmaps(line, params)[0];
        double squares = 0;
        for (const float value : level.data)
            squares += static_cast<double>(value) * value / level.width;
        return std::sqrt(2 * squares);  // of a wave of whole periods
    };
    // The next level holds 32 periods at most. The box is |cos(π f / 128)|: 0.92 for 16, 0.56 for 40.
    EXPECT_NEAR(amplitude(16, MipFilter::box), 0.924, 0.01);
    EXPECT_NEAR(amplitude(40, MipFilter::box), 0.556, 0.02);
    for (const MipFilter filter : {MipFilter::kaiser, MipFilter::lanczos}) {
        EXPECT_GT(amplitude(16, filter), 0.97);  // measured 0.99 and 1.00
        EXPECT_LT(amplitude(44, filter), 0.10);  // measured 0.03 and 0.04
    }
}

TEST(MipChain, RepeatedTextureMovedByTwoTexelsMovesItsLevelByOne) {
    const Image8 base = noise(32, 32, 3, Encoding::srgb, 8);
    Image8 moved = base;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
            std::copy_n(base.pixel(x, y), 3, moved.pixel((x + 2) % 32, (y + 4) % 32));
    for (const MipFilter filter : {MipFilter::box, MipFilter::kaiser, MipFilter::lanczos}) {
        MipmapParams params;
        params.filter = filter;
        params.repeats = true;
        const Image8 level = makeMipmaps(base, params)[0];
        const Image8 other = makeMipmaps(moved, params)[0];
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                for (int c = 0; c < 3; ++c)
                    EXPECT_EQ(level.pixel(x, y)[c], other.pixel((x + 1) % 16, (y + 2) % 16)[c]);
    }
}

TEST(MipChain, BytesAndFloatsAgree) {
    for (int channels = 1; channels <= 4; ++channels) {
        const Image8 base = noise(45, 22, channels, Encoding::srgb, 3);
        MipmapParams params;
        params.filter = MipFilter::lanczos;
        const std::vector<Image8> bytes = makeMipmaps(base, params);
        const std::vector<Image> floats = makeMipmaps(toLinear(base), params);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            EXPECT_EQ(bytes[i], toSrgb8(floats[i])) << channels << " channels, level " << i + 1;
    }
}

TEST(MipChain, AlphaKeepsItsCoverage) {
    Image8 leaves(64, 64, 4, Encoding::srgb);
    Random random(6);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const bool leaf = std::hypot(x % 16 - 7.5, y % 16 - 7.5) < 4.3;
            leaves.pixel(x, y)[3] =
                static_cast<std::uint8_t>(leaf ? 230 + random.below(26) : random.below(40));
        }
    const auto coverage = [](const Image8& image) {
        int count = 0;
        for (std::size_t i = 3; i < image.data.size(); i += 4)
            count += image.data[i] >= 128 ? 1 : 0;
        return static_cast<double>(count) / static_cast<double>(image.pixelCount());
    };
    MipmapParams params;
    params.coverageCutoff = 0.5f;
    const std::vector<Image8> kept = makeMipmaps(leaves, params);
    const std::vector<Image8> plain = makeMipmaps(leaves);
    const double wanted = coverage(leaves);
    double worstPlain = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        // Half a texel of a level, and ties of its symmetric leaves: up to 8 texels have the same alpha in
        // level 3 (8×8), so that all or none of them pass.
        const double texel = 1.0 / static_cast<double>(kept[i].pixelCount());
        if (i < 2) {
            EXPECT_NEAR(coverage(kept[i]), wanted, 2 * texel) << "level " << i + 1;
        }
        worstPlain = std::max(worstPlain, std::abs(coverage(plain[i]) - wanted));
    }
    EXPECT_GT(worstPlain, 0.1) << "the leaves are no test";
}

TEST(MipChain, ReducesToTheFirstLevelThatFits) {
    const Image8 base = noise(100, 10, 3, Encoding::srgb, 2);
    EXPECT_EQ(reducedToSide(base, 100), base);
    const Image8 reduced = reducedToSide(base, 60);
    EXPECT_EQ(reduced.width, 50);
    EXPECT_EQ(reduced, makeMipmaps(base)[0]);
    EXPECT_EQ(reducedToSide(base, 1).width, 1);
}

double psnrOf(const Image8& a, const Image8& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        sum += std::pow(static_cast<double>(a.data[i]) - b.data[i], 2);
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.data.size()) / sum);
}

TEST(BlockCompression, TakesAnEighthAndStaysNear) {
    const Image8 bricks = brickTexture(64, 8, 7);
    const BlockImage coded = compressBlocks(bricks, BlockFormat::bc1);
    EXPECT_EQ(coded.blocks.size() * 8, bricks.pixelCount() * 4);
    // Measured: 35.9 dB; the extremes of each channel as endpoints, the simplest encoder, give 33.
    EXPECT_GE(psnrOf(bricks, decompressBlocks(coded)), 35);
}

TEST(BlockCompression, GivesBackWhatTheFormatHolds) {
    // Two colours of 5:6:5 bits, and one of them alone.
    Image8 image(8, 4, 3, Encoding::srgb);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) {
            const bool first = x >= 4 || (x + y) % 2 == 0;
            image.pixel(x, y)[0] = first ? 255 : 0;
            image.pixel(x, y)[1] = first ? 130 : 65;  // 32 and 16 of 63
            image.pixel(x, y)[2] = first ? 0 : 255;
        }
    EXPECT_EQ(decompressBlocks(compressBlocks(image, BlockFormat::bc1)), image);
    Image8 grey(5, 3, 1, Encoding::linear);  // not whole blocks
    for (std::size_t i = 0; i < grey.data.size(); ++i)
        grey.data[i] = static_cast<std::uint8_t>(17 * (i % 2) + 100);
    EXPECT_EQ(decompressBlocks(compressBlocks(grey, BlockFormat::bc4)), grey);
}

TEST(BlockCompression, StepsAreNeverFartherThanHalfAStep) {
    const Image8 image = noise(32, 32, 1, Encoding::linear, 12);
    const Image8 back = decompressBlocks(compressBlocks(image, BlockFormat::bc4));
    // Eight steps over a block's range of at most 255: half a step of 255/7, and as much again where the
    // endpoints were moved inwards by up to 6.
    for (std::size_t i = 0; i < image.data.size(); ++i)
        EXPECT_NEAR(image.data[i], back.data[i], 255.0 / 14 + 6 + 0.5);
}

TEST(Patterns, RepeatWithoutASeam) {
    for (const Image8& image : {brickTexture(64, 8, 7), woodTexture(64, 7), noiseTexture(64, 7)}) {
        // The step over the edge is no larger than the largest step inside, rows and columns apart.
        const auto step = [&](bool rows, int i) {
            double sum = 0;
            for (int k = 0; k < 64; ++k)
                for (int c = 0; c < 3; ++c)
                    sum += std::abs((rows ? image.pixel(k, i) : image.pixel(i, k))[c] -
                                    (rows ? image.pixel(k, (i + 1) % 64) : image.pixel((i + 1) % 64, k))[c]);
            return sum;
        };
        for (const bool rows : {false, true}) {
            double inside = 0;
            for (int i = 0; i < 63; ++i)
                inside = std::max(inside, step(rows, i));
            EXPECT_LE(step(rows, 63), inside);
        }
    }
}

TEST(Patterns, CheckerHasItsSquaresAndWavesTheirTexels) {
    const Image8 checker = checkerTexture(8, 4, 4, 2);
    EXPECT_NE(checker.pixel(0, 0)[0], checker.pixel(2, 0)[0]);
    EXPECT_EQ(checker.pixel(0, 0)[0], checker.pixel(1, 1)[0]);
    EXPECT_EQ(checker.pixel(0, 0)[0], checker.pixel(2, 2)[0]);
    const WavePicture waves(16, 0.8, 1);
    const Image texels = waves.texels();
    for (int i = 0; i < 16; ++i) {
        EXPECT_NEAR(*texels.pixel(i, 3), waves.at((i + 0.5) / 16, 3.5 / 16), 1e-7);
        EXPECT_NEAR(waves.at(i / 16.0 + 1, -2.25), waves.at(i / 16.0, 0.75), 1e-12);
        EXPECT_TRUE(*texels.pixel(i, 5) >= 0 && *texels.pixel(i, 5) <= 1);
    }
}

}  // namespace
}  // namespace quincunx

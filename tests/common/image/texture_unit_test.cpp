#include "image/texture_unit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "image/patterns.h"
#include "image/texture_hard_cases.h"
#include "tests/support/hard_case_suite.h"

namespace quincunx {
namespace {

const auto textureCases = textureHardCases();
INSTANTIATE_TEST_SUITE_P(TextureUnit, HardCases, testing::ValuesIn(textureCases.begin(), textureCases.end()),
                         nameOfHardCase);

constexpr std::array wraps = {TextureWrap::repeat, TextureWrap::mirroredRepeat, TextureWrap::clampToEdge,
                              TextureWrap::clampToBorder};
constexpr std::array kernels = {Magnification::nearest, Magnification::bilinear, Magnification::mitchell,
                                Magnification::lanczos, Magnification::sinc};
constexpr std::array minifications = {Minification::nearest,        Minification::bilinear,
                                      Minification::nearestMipmap,  Minification::bilinearMipmap,
                                      Minification::nearestBlended, Minification::trilinear,
                                      Minification::anisotropic};

MipTexture noiseTextureOf(int width, int height, std::uint64_t seed) {
    Image base(width, height, 4, Encoding::linear);
    Random random(seed);
    for (float& value : base.data)
        value = random.uniform();
    std::vector<Image> levels = makeMipmaps(base);
    levels.insert(levels.begin(), base);
    return MipTexture(std::move(levels));
}

TexturePoint randomPoint(Random& random, double texelsPerPixel) {
    TexturePoint point;
    point.st = {random.uniform(-3, 3), random.uniform(-3, 3)};
    const double turn = random.uniform(0, 6.28);
    const double scale = texelsPerPixel / 32;
    point.alongX = {scale * std::cos(turn), scale * std::sin(turn)};
    point.alongY = {-0.3 * scale * std::sin(turn), 0.3 * scale * std::cos(turn)};
    return point;
}

/// The table of wrap modes, read literally.
int wrapByTheTable(int texel, int side, TextureWrap wrap) {
    const auto modulo = [](int a, int b) { return ((a % b) + b) % b; };
    const auto mirror = [](int a) { return a >= 0 ? a : -(1 + a); };
    switch (wrap) {
        case TextureWrap::repeat:
            return modulo(texel, side);
        case TextureWrap::mirroredRepeat:
            return (side - 1) - mirror(modulo(texel, 2 * side) - side);
        case TextureWrap::clampToEdge:
            return std::clamp(texel, 0, side - 1);
        default: {
            const int clamped = std::clamp(texel, -1, side);
            return clamped == side ? -1 : clamped;
        }
    }
}

TEST(TextureUnit, WrapsAsTheTableOfOpenGL) {
    for (const TextureWrap wrap : wraps)
        for (const int side : {1, 2, 5, 8})
            for (int texel = -40; texel <= 40; ++texel)
                EXPECT_EQ(wrapTexel(texel, side, wrap), wrapByTheTable(texel, side, wrap))
                    << texel << " of " << side;
}

TEST(TextureUnit, ReadsTheTexelsThatEachFilterNeedsAndNoMore) {
    const MipTexture texture = noiseTextureOf(32, 32, 1);
    Random random(2);
    for (int i = 0; i < 500; ++i) {
        const TexturePoint point = randomPoint(random, random.uniform(1.5, 15.9));
        SamplerSettings settings;
        const auto texels = [&](Minification filter) {
            settings.minification = filter;
            return sampleTexture(texture, settings, point).texels;
        };
        EXPECT_EQ(texels(Minification::nearest), 1);
        EXPECT_EQ(texels(Minification::bilinear), 4);
        EXPECT_EQ(texels(Minification::nearestMipmap), 1);
        EXPECT_EQ(texels(Minification::bilinearMipmap), 4);
        EXPECT_EQ(texels(Minification::nearestBlended), 2);
        EXPECT_EQ(texels(Minification::trilinear), 8);
        const int probes = footprintOf(point, 32, 32, 16).probes;
        EXPECT_LE(texels(Minification::anisotropic), 8 * probes);
        EXPECT_GE(texels(Minification::anisotropic), 4 * probes);
    }
    const TexturePoint magnified{.st = {0.3f, 0.4f}, .alongX = {1e-4f, 0}, .alongY = {0, 1e-4f}};
    SamplerSettings settings;
    settings.lobes = 4;
    const std::array wanted = {1, 4, 16, 64, 1024};
    for (std::size_t i = 0; i < kernels.size(); ++i) {
        settings.magnification = kernels[i];
        EXPECT_EQ(sampleTexture(texture, settings, magnified).texels, wanted[i]);
    }
}

TEST(TextureUnit, WeightsSumToOneAndMakeTheSample) {
    const MipTexture texture = noiseTextureOf(11, 6, 3);
    Random random(4);
    double worstSum = 0;
    double worstValue = 0;
    for (const TextureWrap wrap : wraps)
        for (const Minification filter : minifications)
            for (const Magnification kernel : kernels)
                for (int i = 0; i < 8; ++i) {
                    SamplerSettings settings;
                    settings.wrapS = settings.wrapT = wrap;
                    settings.minification = filter;
                    settings.magnification = kernel;
                    settings.border = {0.25f, 0.5f, 0.75f, 1};
                    const TexturePoint point = randomPoint(random, i % 2 == 0 ? 0.1 : random.uniform(1, 40));
                    double sum = 0;
                    glm::dvec4 color(0);
                    for (const TexelTap& tap : texelTaps(texture, settings, point)) {
                        sum += tap.weight;
                        const float* const texel =
                            tap.x < 0 ? &settings.border.x : texture.level(tap.level).pixel(tap.x, tap.y);
                        for (int c = 0; c < 4; ++c)
                            color[c] += tap.weight * texel[c];
                    }
                    worstSum = std::max(worstSum, std::abs(sum - 1));
                    const glm::dvec4 sample(sampleTexture(texture, settings, point).color);
                    worstValue = std::max(worstValue, glm::length(sample - color));
                }
    EXPECT_LE(worstSum, 1e-13);
    EXPECT_LE(worstValue, 2e-7);  // four channels rounded to float
}

TEST(TextureUnit, ConstantTextureIsConstantUnderEveryFilter) {
    Image base(13, 7, 4, Encoding::linear);
    std::fill(base.data.begin(), base.data.end(), 0.7f);
    std::vector<Image> levels = makeMipmaps(base);
    levels.insert(levels.begin(), base);
    const MipTexture texture(std::move(levels));
    Random random(5);
    SamplerSettings settings;
    for (const Minification filter : minifications)
        for (const Magnification kernel : kernels)
            for (int i = 0; i < 20; ++i) {
                settings.minification = filter;
                settings.magnification = kernel;
                const glm::vec4 color =
                    sampleTexture(texture, settings, randomPoint(random, random.uniform(0.01, 30))).color;
                for (int c = 0; c < 4; ++c)
                    EXPECT_NEAR(color[c], 0.7f, 6e-8f);
            }
}

TEST(TextureUnit, TexelCentresGiveTexels) {
    const MipTexture texture = noiseTextureOf(16, 8, 6);
    SamplerSettings settings;
    for (const Magnification kernel : kernels) {
        if (kernel == Magnification::mitchell)
            continue;  // it blurs: its weight at a centre is 8/9
        settings.magnification = kernel;
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x)
                for (int c = 0; c < 4; ++c)
                    EXPECT_NEAR(sampleTextureLod(texture, settings,
                                                 glm::vec2(glm::dvec2((x + 0.5) / 16, (y + 0.5) / 8)), -1)
                                    .color[c],
                                texture.level(0).pixel(x, y)[c], 1e-7);
    }
}

TEST(TextureUnit, WholeSincGivesBackABandLimitedPictureEverywhere) {
    for (const int side : {15, 16}) {
        const WavePicture waves(side, 0.9, 3);
        const MipTexture texture(std::vector<Image>{waves.texels()});
        SamplerSettings settings;
        settings.magnification = Magnification::sinc;
        Random random(7);
        double worst = 0;
        double tent = 0;
        for (int i = 0; i < 300; ++i) {
            const glm::vec2 st(random.uniform(-1, 2), random.uniform(-1, 2));
            settings.magnification = Magnification::sinc;
            worst = std::max(worst, std::abs(sampleTextureLod(texture, settings, st, -1).color.r -
                                             waves.at(static_cast<double>(st.x), static_cast<double>(st.y))));
            settings.magnification = Magnification::bilinear;
            tent = std::max(tent, std::abs(sampleTextureLod(texture, settings, st, -1).color.r -
                                           waves.at(static_cast<double>(st.x), static_cast<double>(st.y))));
        }
        // Texels are floats of up to 1, off by 2^-25; the sum of the weights' magnitudes stays below 8.
        EXPECT_LE(worst, 8 * 0x1p-25) << side;
        EXPECT_GT(tent, 0.01) << side;
    }
}

TEST(TextureUnit, MitchellSumsToOneByItself) {
    for (int i = 0; i <= 64; ++i) {
        double sum = 0;
        for (int k = -2; k <= 2; ++k)
            sum += filterWeight(Magnification::mitchell, i / 64.0 - k, 0);
        // Terms of up to 80 / 6 in each of five weights, rounded three times.
        EXPECT_NEAR(sum, 1, 5 * 3 * 80 / 6 * 0x1p-53);
    }
}

TEST(TextureUnit, EnlargingByRowsAndColumnsIsSamplingEachPixel) {
    const MipTexture texture = noiseTextureOf(12, 9, 8);
    const TextureWindow window{{-0.3, 0.2}, {0.6, 1.3}};
    for (const TextureWrap wrap : wraps)
        for (const Magnification kernel : kernels) {
            SamplerSettings settings;
            settings.wrapS = settings.wrapT = wrap;
            settings.magnification = kernel;
            settings.border = {0.1f, 0.2f, 0.3f, 0.4f};
            const Image enlarged = enlarge(texture, settings, window, 24, 17);
            for (int y = 0; y < 17; ++y)
                for (int x = 0; x < 24; ++x) {
                    const glm::dvec2 st =
                        glm::mix(window.low, window.high, glm::dvec2((x + 0.5) / 24, (y + 0.5) / 17));
                    const glm::vec4 color = sampleTextureLod(texture, settings, glm::vec2(st), -1).color;
                    for (int c = 0; c < 4; ++c)
                        // The coordinates of the single sample are rounded to float: 2^-24 · 12 texels.
                        EXPECT_NEAR(enlarged.pixel(x, y)[c], color[c], 5e-6);
                }
        }
}

TEST(TextureUnit, LevelsAreChosenAsTheSpecificationHasIt) {
    const MipTexture texture = noiseTextureOf(32, 32, 9);
    SamplerSettings settings;
    const auto levelsRead = [&](Minification filter, double lambda) {
        settings.minification = filter;
        TexturePoint point{.st = {0.4f, 0.6f}};
        point.alongX = {std::exp2(lambda) / 32, 0};
        std::vector<int> levels;
        for (const TexelTap& tap : texelTaps(texture, settings, point))
            if (std::find(levels.begin(), levels.end(), tap.level) == levels.end())
                levels.push_back(tap.level);
        return levels;
    };
    using Levels = std::vector<int>;
    EXPECT_EQ(levelsRead(Minification::nearestMipmap, 0.45), Levels({0}));
    EXPECT_EQ(levelsRead(Minification::nearestMipmap, 0.55), Levels({1}));
    EXPECT_EQ(levelsRead(Minification::bilinearMipmap, 3.45), Levels({3}));
    EXPECT_EQ(levelsRead(Minification::bilinearMipmap, 3.55), Levels({4}));
    EXPECT_EQ(levelsRead(Minification::trilinear, 2.25), Levels({2, 3}));
    EXPECT_EQ(levelsRead(Minification::trilinear, -2), Levels({0}));
    EXPECT_EQ(levelsRead(Minification::trilinear, 30), Levels({5}));
    settings.lodBias = 1;
    EXPECT_EQ(levelsRead(Minification::trilinear, 2.25), Levels({3, 4}));
    settings.maxLod = 1.5;
    EXPECT_EQ(levelsRead(Minification::trilinear, 2.25), Levels({1, 2}));
    settings.minLod = settings.maxLod = 4;
    EXPECT_EQ(levelsRead(Minification::trilinear, -9), Levels({4, 5}));
}

TEST(TextureUnit, IncompleteTexturesAreOpaqueBlackAndShortChainsEnd) {
    Image base(8, 8, 4, Encoding::linear);
    std::fill(base.data.begin(), base.data.end(), 0.5f);
    const TexturePoint point{.st = {0.5f, 0.5f}, .alongX = {0.4f, 0}, .alongY = {0, 0.4f}};
    for (const std::vector<Image>& levels :
         {std::vector<Image>{}, std::vector<Image>{base, Image(3, 4, 4, Encoding::linear)},
          std::vector<Image>{base, Image()}}) {
        const MipTexture texture(levels);
        EXPECT_FALSE(texture.complete());
        const TextureSample sample = sampleTexture(texture, {}, point);
        EXPECT_EQ(sample.color, glm::vec4(0, 0, 0, 1));
        EXPECT_EQ(sample.texels, 0);
        EXPECT_TRUE(texelTaps(texture, {}, point).empty());
    }
    const MipTexture alone(std::vector<Image>{base});
    EXPECT_TRUE(alone.complete());
    EXPECT_EQ(sampleTexture(alone, {}, point).color, glm::vec4(0.5f));
    EXPECT_EQ(sampleTexture(alone, {}, point).texels, 4);
}

TEST(TextureUnit, FootprintIsTheEllipseOfThePixel) {
    const auto footprint = [](glm::dvec2 x, glm::dvec2 y, int most) {
        return footprintOf({.st = {}, .alongX = glm::vec2(x / 64.0), .alongY = glm::vec2(y / 64.0)}, 64, 64,
                           most);
    };
    const Footprint slanted = footprint({2, 0}, {0, 12}, 16);
    EXPECT_NEAR(slanted.longTexels, 12, 1e-5);
    EXPECT_NEAR(slanted.shortTexels, 2, 1e-6);
    EXPECT_EQ(slanted.probes, 6);
    EXPECT_NEAR(slanted.lambda, 1, 1e-6);
    EXPECT_NEAR(std::abs(slanted.longAxis.y), 12.0 / 64, 1e-7);
    EXPECT_NEAR(footprint({2, 0}, {0, 12}, 4).lambda, std::log2(3), 1e-6);
    EXPECT_EQ(footprint({5, 0}, {0, 5}, 16).probes, 1);
    EXPECT_EQ(footprint({0.1, 0}, {0, 0.9}, 16).probes, 1);
    // Turning pixels about does not change the ellipse.
    for (int i = 0; i < 12; ++i) {
        const double a = 0.5 * i;
        const Footprint turned =
            footprint({2 * std::cos(a), 12 * std::sin(a)}, {-2 * std::sin(a), 12 * std::cos(a)}, 16);
        EXPECT_NEAR(turned.longTexels, 12, 1e-4);
        EXPECT_NEAR(turned.shortTexels, 2, 1e-4);
        EXPECT_NEAR(std::abs(turned.longAxis.y), 12.0 / 64, 1e-6);
    }
    // Probes fill the long axis evenly.
    glm::dvec2 mean(0);
    for (int i = 0; i < slanted.probes; ++i)
        mean += slanted.probe(i, {0.3, 0.4}) / 6.0;
    EXPECT_NEAR(glm::length(mean - glm::dvec2(0.3, 0.4)), 0, 1e-12);
    EXPECT_NEAR(glm::length(slanted.probe(1, {}) - slanted.probe(0, {})), 2.0 / 64, 1e-7);
}

TEST(TextureUnit, GreyAndMissingAlphaAreFilledIn) {
    Image8 grey(1, 1, 1, Encoding::linear);
    grey.data = {51};
    EXPECT_EQ(sampleTexture(MipTexture(std::span<const Image8>(&grey, 1)), {}, {}).color,
              glm::vec4(0.2f, 0.2f, 0.2f, 1));
}

}  // namespace
}  // namespace quincunx

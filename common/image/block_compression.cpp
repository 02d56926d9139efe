#include "image/block_compression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>
#include <tbb/parallel_for.h>

#include "base/check.h"

namespace quincunx {
namespace {

constexpr int side = 4;
constexpr int texelCount = side * side;
constexpr std::size_t bytesPerBlock = 8;  // of both formats

using Block = std::array<glm::vec3, texelCount>;  ///< codes

/// Texels beyond the image's edges are those of the edge.
Block blockOf(const Image8& image, int left, int top) {
    Block block;
    for (int i = 0; i < texelCount; ++i) {
        const std::uint8_t* const texel = image.pixel(std::min(left + i % side, image.width - 1),
                                                      std::min(top + i / side, image.height - 1));
        for (int c = 0; c < 3; ++c)
            block[static_cast<std::size_t>(i)][c] = texel[std::min(c, image.channels - 1)];
    }
    return block;
}

/// A colour of 5:6:5 bits and back; the low bits repeat the high ones.
std::uint16_t packed565(glm::vec3 color) {
    const auto bits = [](float value, float most) {
        return static_cast<unsigned>(std::lround(std::clamp(value, 0.0f, 255.0f) / 255 * most));
    };
    return static_cast<std::uint16_t>(bits(color.r, 31) << 11 | bits(color.g, 63) << 5 | bits(color.b, 31));
}
glm::vec3 unpacked565(std::uint16_t packed) {
    const unsigned r = packed >> 11;
    const unsigned g = packed >> 5 & 63;
    const unsigned b = packed & 31;
    return {r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2};
}

/// The four colours of a block whose first packed colour is the larger one.
std::array<glm::vec3, 4> colorsOf(std::uint16_t first, std::uint16_t second) {
    const glm::vec3 a = unpacked565(first);
    const glm::vec3 b = unpacked565(second);
    return {a, b, glm::round((2.0f * a + b) / 3.0f), glm::round((a + 2.0f * b) / 3.0f)};
}

struct Bc1 {
    std::uint16_t first = 0;
    std::uint16_t second = 0;
    std::uint32_t indices = 0;
    float error = std::numeric_limits<float>::infinity();
};

/// The best indices for two endpoints.
Bc1 withEndpoints(const Block& block, glm::vec3 a, glm::vec3 b) {
    Bc1 coded{packed565(a), packed565(b)};
    if (coded.first < coded.second)
        std::swap(coded.first, coded.second);  // the other order would mean three colours
    const std::array<glm::vec3, 4> colors = colorsOf(coded.first, coded.second);
    coded.error = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
        std::uint32_t best = 0;
        float bestError = std::numeric_limits<float>::infinity();
        // Equal endpoints leave one colour, index 0.
        for (std::uint32_t k = 0; k < (coded.first == coded.second ? 1u : 4u); ++k) {
            const glm::vec3 difference = block[i] - colors[k];
            const float error = glm::dot(difference, difference);
            if (error < bestError) {
                bestError = error;
                best = k;
            }
        }
        coded.indices |= best << 2 * i;
        coded.error += bestError;
    }
    return coded;
}

/// The direction in which a block's colours spread most, by power iteration.
glm::vec3 mainAxis(const Block& block, glm::vec3 mean) {
    glm::mat3 covariance(0);
    for (const glm::vec3& texel : block)
        covariance += glm::outerProduct(texel - mean, texel - mean);
    glm::vec3 axis(covariance[0][0], covariance[1][1], covariance[2][2]);
    axis = covariance * axis;
    for (int i = 0; i < 8; ++i) {
        const float length = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
        if (length <= 0)
            return {1, 1, 1};
        axis = covariance * (axis / length);
    }
    const float length = glm::length(axis);
    return length > 0 ? axis / length : glm::vec3(1, 1, 1);
}

Bc1 encodeBc1(const Block& block) {
    glm::vec3 mean(0);
    for (const glm::vec3& texel : block)
        mean += texel / static_cast<float>(texelCount);
    const glm::vec3 axis = mainAxis(block, mean);
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const glm::vec3& texel : block) {
        low = std::min(low, glm::dot(texel - mean, axis));
        high = std::max(high, glm::dot(texel - mean, axis));
    }
    // The extremes, and a little within, where few texels are extreme.
    Bc1 best = withEndpoints(block, mean + high * axis, mean + low * axis);
    const float inset = (high - low) / 16;
    const Bc1 within = withEndpoints(block, mean + (high - inset) * axis, mean + (low + inset) * axis);
    best = within.error < best.error ? within : best;
    for (int round = 0; round < 3; ++round) {
        // Least squares for the endpoints, with the steps as they are.
        static constexpr std::array shares = {1.0f, 0.0f, 2.0f / 3, 1.0f / 3};
        float aa = 0;
        float bb = 0;
        float ab = 0;
        glm::vec3 ax(0);
        glm::vec3 bx(0);
        for (std::size_t i = 0; i < block.size(); ++i) {
            const float a = shares[best.indices >> 2 * i & 3];
            aa += a * a;
            bb += (1 - a) * (1 - a);
            ab += a * (1 - a);
            ax += a * block[i];
            bx += (1 - a) * block[i];
        }
        const float determinant = aa * bb - ab * ab;
        if (determinant < 1e-3f)  // all texels at one step: sums of ninths cannot be smaller and not 0
            break;
        const Bc1 refined =
            withEndpoints(block, (ax * bb - bx * ab) / determinant, (bx * aa - ax * ab) / determinant);
        if (!(refined.error < best.error))
            break;
        best = refined;
    }
    return best;
}

/// The eight values of a BC4 block whose first value is the larger one, or equal.
std::array<int, 8> valuesOf(int first, int second) {
    std::array<int, 8> values{first, second};
    for (int k = 2; k < 8; ++k)
        values[static_cast<std::size_t>(k)] = ((8 - k) * first + (k - 1) * second + 3) / 7;
    return values;
}

std::array<std::uint8_t, bytesPerBlock> encodeBc4(const Block& block) {
    int low = 255;
    int high = 0;
    for (const glm::vec3& texel : block) {
        low = std::min(low, static_cast<int>(texel.r));
        high = std::max(high, static_cast<int>(texel.r));
    }
    std::uint64_t bestIndices = 0;
    int bestHigh = high;
    int bestLow = low;
    long bestError = std::numeric_limits<long>::max();
    // A little within the extremes may be better than the extremes themselves.
    const int most = std::min((high - low) / 8, 6);
    for (int up = 0; up <= most; ++up)
        for (int down = 0; down <= most; ++down) {
            const std::array<int, 8> values = valuesOf(high - down, low + up);
            std::uint64_t indices = 0;
            long error = 0;
            for (std::size_t i = 0; i < block.size(); ++i) {
                std::uint64_t best = 0;
                for (std::uint64_t k = 1; k < (high == low ? 1u : 8u); ++k)
                    if (std::abs(values[k] - static_cast<int>(block[i].r)) <
                        std::abs(values[best] - static_cast<int>(block[i].r)))
                        best = k;
                const long difference = values[best] - static_cast<int>(block[i].r);
                error += difference * difference;
                indices |= best << 3 * i;
            }
            if (error < bestError) {
                bestError = error;
                bestIndices = indices;
                bestHigh = high - down;
                bestLow = low + up;
            }
        }
    std::array<std::uint8_t, bytesPerBlock> bytes{static_cast<std::uint8_t>(bestHigh),
                                                  static_cast<std::uint8_t>(bestLow)};
    for (std::size_t i = 0; i < 6; ++i)
        bytes[2 + i] = static_cast<std::uint8_t>(bestIndices >> 8 * i);
    return bytes;
}

int blocksAlong(int texels) {
    return (texels + side - 1) / side;
}

}  // namespace

std::size_t blockBytes(BlockFormat, int width, int height) {
    return bytesPerBlock * static_cast<std::size_t>(blocksAlong(width)) *
           static_cast<std::size_t>(blocksAlong(height));
}

BlockImage compressBlocks(const Image8& image, BlockFormat format) {
    QX_CHECK_GE(std::min(image.width, image.height), 1);
    QX_CHECK_GE(image.channels, format == BlockFormat::bc1 ? 3 : 1);
    BlockImage coded{image.width, image.height, format, image.encoding, {}};
    coded.blocks.resize(blockBytes(format, image.width, image.height));
    const int across = blocksAlong(image.width);
    tbb::parallel_for(0, blocksAlong(image.height), [&](int row) {
        for (int column = 0; column < across; ++column) {
            const Block block = blockOf(image, side * column, side * row);
            std::array<std::uint8_t, bytesPerBlock> bytes{};
            if (format == BlockFormat::bc4) {
                bytes = encodeBc4(block);
            } else {
                const Bc1 best = encodeBc1(block);
                const std::uint64_t bits = static_cast<std::uint64_t>(best.indices) << 32 |
                                           static_cast<std::uint64_t>(best.second) << 16 | best.first;
                for (std::size_t i = 0; i < bytes.size(); ++i)
                    bytes[i] = static_cast<std::uint8_t>(bits >> 8 * i);
            }
            std::copy(
                bytes.begin(), bytes.end(),
                coded.blocks.begin() + static_cast<std::ptrdiff_t>(bytesPerBlock) * (row * across + column));
        }
    });
    return coded;
}

Image8 decompressBlocks(const BlockImage& coded) {
    QX_CHECK_EQ(coded.blocks.size(), blockBytes(coded.format, coded.width, coded.height));
    const bool color = coded.format == BlockFormat::bc1;
    Image8 image(coded.width, coded.height, color ? 3 : 1, coded.encoding);
    const int across = blocksAlong(coded.width);
    for (int y = 0; y < coded.height; ++y)
        for (int x = 0; x < coded.width; ++x) {
            const std::uint8_t* const bytes =
                &coded.blocks[bytesPerBlock * static_cast<std::size_t>(y / side * across + x / side)];
            const int texel = y % side * side + x % side;
            std::uint64_t bits = 0;
            for (std::size_t i = 0; i < bytesPerBlock; ++i)
                bits |= static_cast<std::uint64_t>(bytes[i]) << 8 * i;
            if (!color) {
                *image.pixel(x, y) =
                    static_cast<std::uint8_t>(valuesOf(bytes[0], bytes[1])[bits >> (16 + 3 * texel) & 7]);
                continue;
            }
            const glm::vec3 value =
                colorsOf(static_cast<std::uint16_t>(bits),
                         static_cast<std::uint16_t>(bits >> 16))[bits >> (32 + 2 * texel) & 3];
            for (int c = 0; c < 3; ++c)
                image.pixel(x, y)[c] = static_cast<std::uint8_t>(value[c]);
        }
    return image;
}

}  // namespace quincunx

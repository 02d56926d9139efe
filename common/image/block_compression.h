#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/image.h"

/// Textures in blocks of 4×4 texels (Khronos Data Format Specification, sections 13 and 14): a fixed number
/// of bytes a block, read by the texture unit as they are.
namespace quincunx {

enum class BlockFormat {
    bc1,  ///< S3TC's DXT1, opaque: RGB in 8 bytes; two colours of 5:6:5 bits and four steps between them
    bc4   ///< RGTC1: one channel in 8 bytes; two values of 8 bits and eight steps between them
};

struct BlockImage {
    int width = 0;   ///< texels
    int height = 0;  ///< texels
    BlockFormat format = BlockFormat::bc1;
    Encoding encoding = Encoding::linear;
    std::vector<std::uint8_t> blocks;  ///< by rows from the top
};

/// Bytes of an image: blocks at the right and lower edges may reach beyond it.
std::size_t blockBytes(BlockFormat format, int width, int height);

/// Codes that come near to the image's, measured in codes: the endpoints are fitted along each block's main
/// axis, refined by least squares, and each texel takes its nearest step. `bc1` takes 3 or 4 channels (alpha
/// is left out), `bc4` the first channel.
BlockImage compressBlocks(const Image8& image, BlockFormat format);

/// What a texture unit reads: 3 channels (`bc1`) or 1 (`bc4`). Steps are rounded to whole codes.
Image8 decompressBlocks(const BlockImage& image);

}  // namespace quincunx

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "image/io/module.h"

namespace quincunx::imageio {

/// What the first bytes of a picture file claim.
struct Header {
    Format format = Format::png;
    std::int64_t width = 0;   ///< pixels
    std::int64_t height = 0;  ///< pixels
};

/// Reads the header without decoding or allocating. PNG (ISO/IEC 15948), JPEG (ITU-T T.81), WebP (RFC 9649),
/// OpenEXR (its file layout document), Radiance HDR. Also follows the chunks of a PNG and the segments of a
/// JPEG to their end mark, which decoders don't insist on. Throws InputError naming `name`: not a picture,
/// damaged, ends early.
Header readHeader(std::span<const std::byte> bytes, const std::string& name);

}  // namespace quincunx::imageio

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

/// What image/io.cpp asks of the module that holds OpenImageIO: bytes to pixels and back. Faults are returned
/// as text, so that no exception crosses.
namespace quincunx::imageio {

enum class Format { png, jpeg, webp, exr, hdr };

struct Decoded {
    Image8 codes;      ///< filled if `asked` was 8 bits
    Image values;      ///< filled if it was float
    std::string note;  ///< the text that `encode` was given
};

enum class Depth { none, bits8, float32 };  ///< none: the note alone

/// Version of this table: the library and the module must have been built from the same one.
inline constexpr int tableVersion = 3;

struct Table {
    int version = 0;
    /// Decodes the first picture in `bytes`. False, with one line in `error`, if that fails or its size and
    /// channels are not `width` × `height` and 1 to 4.
    bool (*decode)(Format format, std::span<const std::byte> bytes, int width, int height, Depth depth,
                   Decoded& result, std::string& error) = nullptr;
    /// Encodes as PNG (8 bits) or EXR (float); `note` is printable ASCII.
    bool (*encodePng)(const Image8& image, const std::string& note, std::vector<unsigned char>& bytes,
                      std::string& error) = nullptr;
    bool (*encodeExr)(const Image& image, const std::string& note, std::vector<unsigned char>& bytes,
                      std::string& error) = nullptr;
    /// Of 1 or 3 channels; `quality` is 1 … 100.
    bool (*encodeJpeg)(const Image8& image, int quality, std::vector<unsigned char>& bytes,
                       std::string& error) = nullptr;
};

/// The one symbol that the module exports.
inline constexpr const char* entryName = "quincunxImageIo";
using Entry = const Table* (*)();

}  // namespace quincunx::imageio

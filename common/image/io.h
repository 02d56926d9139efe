#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/image.h"

/// Picture files. PNG, JPEG, WebP, EXR and Radiance HDR are read, PNG and EXR written, by OpenImageIO. That
/// library is loaded at the first call that needs it and never otherwise.
///
/// Files are not believed: the kind is told from the first bytes, never from the name; size and channels are
/// taken from the header and held against the limits before anything is decoded; a file that ends early is an
/// error. All faults of a file are an InputError of one line that names it.
namespace quincunx {

inline constexpr int maxImageSide = 32768;                   ///< pixels
inline constexpr std::uint64_t maxImagePixels = 1ULL << 28;  ///< width × height
inline constexpr std::uintmax_t maxImageFileBytes = 1ULL << 32;

/// Text kept in a picture: keys and values of any bytes, in order, keys may repeat.
using ImageMetadata = std::vector<std::pair<std::string, std::string>>;

/// 8 bits a channel, 1 to 4 channels, alpha not premultiplied. PNG and JPEG: sRGB, unless a PNG says it is
/// linear (gamma 1); of 16 bits the nearest 8 are taken. EXR and HDR: encoded to sRGB by `toSrgb8`.
Image8 readImage8(const std::filesystem::path& file);

/// Floats, 1 to 4 channels. EXR and HDR: linear, bits as in the file (NaN and infinities too). PNG and JPEG:
/// codes divided by 255 or 65535, still sRGB-encoded as `encoding` then says; `toLinear` decodes them.
Image readImage(const std::filesystem::path& file);

/// The same from bytes in memory; `name` stands for the file in errors.
Image8 readImage8FromMemory(std::span<const std::byte> bytes, const std::string& name);
Image readImageFromMemory(std::span<const std::byte> bytes, const std::string& name);

/// Writes a PNG (.png, 8 bits) or an EXR (.exr, 32-bit float, linear, lossless). A PNG keeps
/// `image.encoding`; what an EXR is given is decoded to linear, what a float image in a PNG is given goes
/// through `toSrgb8`. The file appears whole or not at all. A folder that cannot be written, a full disk or
/// another extension is an InputError.
void writeImage(const std::filesystem::path& file, const Image8& image, const ImageMetadata& metadata = {});
void writeImage(const std::filesystem::path& file, const Image& image, const ImageMetadata& metadata = {});

/// The bytes of a PNG as `writeImage` would write it; `name` stands for the file in errors.
std::vector<unsigned char> encodedPng(const Image8& image, const std::string& name);

/// The bytes of a JPEG of `quality` 1 … 100; alpha is left out. For pictures to look at: nothing is measured
/// on them.
std::vector<unsigned char> encodedJpeg(const Image8& image, int quality, const std::string& name);

/// The kind of picture that a name asks for.
enum class ImageKind { png, exr };
/// By the extension, in any case: .png or .exr; nothing else can be written (InputError).
ImageKind imageKindOf(const std::filesystem::path& file);

/// What `writeImage` was given; empty for pictures from elsewhere.
ImageMetadata readMetadata(const std::filesystem::path& file);

ImageMetadata readMetadataFromMemory(std::span<const std::byte> bytes, const std::string& name);

/// Starts to load OpenImageIO (about a quarter of a second) on a thread of its own, so that a later read or
/// write does not wait for it. Need not be called; more calls do nothing; a failure is reported by the later
/// call. The calling thread, when it ends, waits for the loading to end.
void preloadImageIo();

/// True once OpenImageIO is in this process.
bool imageIoLoaded();

}  // namespace quincunx

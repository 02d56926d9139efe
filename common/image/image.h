#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/check.h"

namespace quincunx {

/// What the numbers of an image stand for.
enum class Encoding {
    linear,  ///< proportional to light (or not colour at all: normals, depths, masks)
    srgb     ///< colour through the sRGB transfer curve (IEC 61966-2-1), alpha linear
};

/// Pixels of interleaved channels; row 0 is the top one. `Channel` is std::uint8_t (0…255 stands for 0…1) or
/// float. Pixel (x, y) covers [x, x+1) × [y, y+1); its centre is at (x + ½, y + ½).
template <typename Channel>
struct BasicImage {
    int width = 0;     ///< pixels
    int height = 0;    ///< pixels
    int channels = 0;  ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA
    Encoding encoding = Encoding::linear;
    std::vector<Channel> data;  ///< height × width × channels

    BasicImage() = default;
    BasicImage(int widthPixels, int heightPixels, int channelCount, Encoding meaning)
        : width(widthPixels),
          height(heightPixels),
          channels(channelCount),
          encoding(meaning),
          data(static_cast<std::size_t>(widthPixels) * static_cast<std::size_t>(heightPixels) *
               static_cast<std::size_t>(channelCount)) {}

    std::size_t pixelCount() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }

    /// The channels of pixel (x, y).
    Channel* pixel(int x, int y) { return data.data() + offset(x, y); }
    const Channel* pixel(int x, int y) const { return data.data() + offset(x, y); }

    bool operator==(const BasicImage&) const = default;

  private:
    std::size_t offset(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels);
    }
};

using Image8 = BasicImage<std::uint8_t>;  ///< screenshots, colour textures: usually Encoding::srgb
using Image = BasicImage<float>;          ///< measurements, references: usually Encoding::linear

}  // namespace quincunx

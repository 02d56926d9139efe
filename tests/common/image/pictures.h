#pragma once

#include <cmath>
#include <cstdint>

#include "image/image.h"

namespace quincunx {

/// The same numbers on every machine (Marsaglia's xorshift32, 2003).
class NoiseSource {
  public:
    explicit NoiseSource(std::uint32_t seed) : state_(seed * 2654435769U + 1) {}

    std::uint32_t next() {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return state_;
    }

  private:
    std::uint32_t state_;
};

inline Image8 noise8(int width, int height, int channels, std::uint32_t seed) {
    Image8 image(width, height, channels, Encoding::srgb);
    NoiseSource source(seed);
    for (std::uint8_t& value : image.data)
        value = static_cast<std::uint8_t>(source.next() >> 24);
    return image;
}

/// A picture that integer arithmetic alone makes, with gradients, edges and lines: RGB at (x, y).
inline Image8 pattern(int width, int height) {
    Image8 image(width, height, 3, Encoding::srgb);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::uint8_t* const pixel = image.pixel(x, y);
            const bool checker = ((x / 12 + y / 9) & 1) != 0;
            pixel[0] = static_cast<std::uint8_t>((x * 5 + y * 3) & 255);
            pixel[1] = static_cast<std::uint8_t>(checker ? 210 - (y & 127) : 40 + (x & 63));
            pixel[2] = static_cast<std::uint8_t>((x * x + 2 * y * y) / 40 & 255);
        }
    }
    return image;
}

/// `pattern` as a faulty renderer would draw it: brighter blocks, a moved line, fireflies.
inline Image8 distortedPattern(int width, int height) {
    Image8 image = pattern(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::uint8_t* const pixel = image.pixel(x, y);
            if ((x / 24 + y / 18) % 3 == 1)
                for (int c = 0; c < 3; ++c)
                    pixel[c] = static_cast<std::uint8_t>(pixel[c] + (255 - pixel[c]) / 4);
            if (y == height / 2 + 1)
                pixel[0] = pixel[1] = pixel[2] = 250;
            if ((x * 7 + y * 13) % 211 == 0)
                pixel[0] = 255;
        }
    }
    return image;
}

}  // namespace quincunx

#pragma once

#include <cmath>

#include "image/image.h"

namespace quincunx::grade::test {

/// A picture with edges, colours and a gradient, unlike itself when mirrored, shifted or with channels
/// exchanged.
inline Image8 drawing(int width, int height) {
    Image8 image(width, height, 3, Encoding::srgb);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width;
            const double v = (y + 0.5) / height;
            std::uint8_t* const p = image.pixel(x, y);
            p[0] = static_cast<std::uint8_t>(40 + 60 * v);
            p[1] = static_cast<std::uint8_t>(60 + 50 * v);
            p[2] = static_cast<std::uint8_t>(90 + 40 * u);
            if (std::hypot(u - 0.3, v - 0.4) < 0.2) {
                const double light = 1 - 3 * std::hypot(u - 0.25, v - 0.33);
                p[0] = static_cast<std::uint8_t>(70 + 170 * std::fmax(light, 0));
                p[1] = static_cast<std::uint8_t>(30 + 60 * std::fmax(light, 0));
                p[2] = 25;
            }
            if (u > 0.6 && u < 0.85 && v > 0.5 && v < 0.9) {
                p[0] = 20;
                p[1] = static_cast<std::uint8_t>(120 + 100 * u);
                p[2] = static_cast<std::uint8_t>(80 * v);
            }
        }
    return image;
}

}  // namespace quincunx::grade::test

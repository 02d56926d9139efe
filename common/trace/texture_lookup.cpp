#include "trace/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "image/color.h"

namespace quincunx {
namespace {

/// The texel that a texel's number, any whole one, is repeated as.
int wrapped(double texel, int size, Texture::Wrap wrap) {
    const double count = size;
    if (wrap == Texture::Wrap::clampToEdge)
        return static_cast<int>(std::clamp(texel, 0.0, count - 1));
    if (wrap == Texture::Wrap::repeat)
        return std::min(static_cast<int>(texel - count * std::floor(texel / count)), size - 1);
    const double along = texel - 2 * count * std::floor(texel / (2 * count));
    return std::clamp(static_cast<int>(along < count ? along : 2 * count - 1 - along), 0, size - 1);
}

glm::vec4 texelOf(const Image8& image, int x, int y) {
    const std::uint8_t* const codes = image.pixel(x, y);
    const auto colour = [&](std::uint8_t code) {
        return image.encoding == Encoding::srgb ? linearOfCode()[code] : static_cast<float>(code) / 255;
    };
    const auto plain = [](std::uint8_t code) { return static_cast<float>(code) / 255; };
    switch (image.channels) {
        case 1:
            return glm::vec4(glm::vec3(colour(codes[0])), 1);
        case 2:
            return glm::vec4(glm::vec3(colour(codes[0])), plain(codes[1]));
        case 3:
            return {colour(codes[0]), colour(codes[1]), colour(codes[2]), 1};
        default:
            return {colour(codes[0]), colour(codes[1]), colour(codes[2]), plain(codes[3])};
    }
}

}  // namespace

glm::vec4 lookUp(const Texture& texture, glm::vec2 st) {
    const Image8& image = texture.image;
    if (image.pixelCount() == 0)
        return glm::vec4(1);
    const double s = std::isfinite(st.x) ? static_cast<double>(st.x) * image.width : 0;
    const double t = std::isfinite(st.y) ? static_cast<double>(st.y) * image.height : 0;
    const auto texel = [&](double x, double y) {
        return texelOf(image, wrapped(x, image.width, texture.wrapS),
                       wrapped(y, image.height, texture.wrapT));
    };
    if (texture.magnification == Texture::Filter::nearest)
        return texel(std::floor(s), std::floor(t));
    const double left = std::floor(s - 0.5);
    const double top = std::floor(t - 0.5);
    const auto x = static_cast<float>(s - 0.5 - left);
    const auto y = static_cast<float>(t - 0.5 - top);
    return glm::mix(glm::mix(texel(left, top), texel(left + 1, top), x),
                    glm::mix(texel(left, top + 1), texel(left + 1, top + 1), x), y);
}

}  // namespace quincunx

#include "trace/texture_lookup.h"

#include "image/color.h"
#include "image/texture_unit.h"

namespace quincunx {
namespace {

TextureWrap wrapOf(Texture::Wrap wrap) {
    switch (wrap) {
        case Texture::Wrap::repeat:
            return TextureWrap::repeat;
        case Texture::Wrap::mirroredRepeat:
            return TextureWrap::mirroredRepeat;
        case Texture::Wrap::clampToEdge:
            break;
    }
    return TextureWrap::clampToEdge;
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
    const TextureWrap wrapS = wrapOf(texture.wrapS);
    const TextureWrap wrapT = wrapOf(texture.wrapT);
    if (texture.magnification == Texture::Filter::nearest)
        return texelOf(image, nearestTexel(st.x, image.width, wrapS),
                       nearestTexel(st.y, image.height, wrapT));
    const LinearTexels x = linearTexels(st.x, image.width, wrapS);
    const LinearTexels y = linearTexels(st.y, image.height, wrapT);
    const auto row = [&](int texel) {
        return glm::mix(texelOf(image, x.first, texel), texelOf(image, x.second, texel),
                        static_cast<float>(x.share));
    };
    return glm::mix(row(y.first), row(y.second), static_cast<float>(y.share));
}

}  // namespace quincunx

#pragma once

#include "gl/objects.h"
#include "image/image.h"

namespace quincunx::gl {

/// Replaces a rectangle of a texture, whose corner of least texel numbers is (x, y), by an image of four
/// channels. The image's top row goes to y. What does not lie in the texture is a bug of the caller.
void upload(const Texture2D& texture, int x, int y, const Image& image);

}  // namespace quincunx::gl

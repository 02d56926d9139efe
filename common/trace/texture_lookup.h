#pragma once

#include <glm/glm.hpp>

#include "scene/scene.h"

namespace quincunx {

/// The texture's finest level at a place, (0, 0) its top left corner: RGBA, decoded to linear numbers,
/// filtered as `Texture::magnification` says, repeated as its wraps say. Grey counts as R = G = B, a missing
/// alpha as 1. Coordinates that are not finite are read as 0; a texture without pixels is white.
glm::vec4 lookUp(const Texture& texture, glm::vec2 st);

}  // namespace quincunx

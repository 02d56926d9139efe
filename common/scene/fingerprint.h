#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace quincunx {

/// A number that follows from all that is drawn of a scene: meshes, materials, textures, placements, lights,
/// cameras and what moves them, wherever they were read from; names do not count. Two scenes that differ have
/// the same one by accident once in 2^64; it is no protection from intent. Never 0. The same on every 64-bit
/// machine of the same byte order. Held by Fingerprint.*.
std::uint64_t fingerprint(const Scene& scene);

}  // namespace quincunx

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace quincunx {

/// A scene from a file, and what of the file is not drawn (each kind of thing once, one line each).
struct ImportedScene {
    Scene scene;
    std::vector<std::string> warnings;
};

/// Reads .obj (with .mtl), .gltf or .glb, by the extension in any case. Missing normals are made, and
/// missing tangents where a normal map needs them. The scene has its own lights and cameras only if the file
/// has. Throws InputError with one line (file, what, remedy) for files that are missing, cut off, malformed,
/// too large, or that require an unsupported glTF extension; nothing in a file makes it hang or use memory
/// out of proportion to its size.
ImportedScene importScene(const std::filesystem::path& file);

/// A camera that sees all of `bounds` from a little above, for a picture of the given shape.
Camera frameBounds(const Bounds& bounds, float aspect);

/// Width over height of the pictures that cameras are composed for.
inline constexpr float composedAspect = 4.0f / 3.0f;

/// `camera` with its angle widened, where the picture is narrower than `composed`, so that it still
/// sees all of the width that it was composed for. Wider pictures show more at the sides.
Camera fittedToAspect(Camera camera, float aspect, float composed = composedAspect);

/// Key, fill and rim light for scenes without lights of their own, scaled to nothing but direction.
std::vector<Light> studioLights();

}  // namespace quincunx

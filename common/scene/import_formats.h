#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/import.h"

/// The readers behind `importScene`, on contents already in memory (tests, fuzzing). `file` names the
/// contents in messages and says beside what other files lie: those are read only from its folder and the
/// folders in it. All throw InputError like `importScene`.
namespace quincunx {

/// The largest file of any kind that is read.
constexpr std::uintmax_t largestModelFile = std::uintmax_t{2} << 30;

/// Wavefront OBJ. Faces are cut into triangles and gathered into one mesh a material. Numbers are rounded
/// correctly. Normals that are missing, zero or not numbers are made: by smoothing group where the file
/// speaks of them (`s`), smooth over the whole surface where it does not. Surfaces are two-sided, as nothing
/// in the format says otherwise. A position that is not a finite number and an index that names nothing are
/// errors. `contents` may be changed.
ImportedScene importObj(std::string contents, const std::filesystem::path& file);

/// glTF 2.0, as JSON (.gltf) or binary (.glb), by its first four bytes. Supports the extensions
/// KHR_lights_punctual, KHR_materials_emissive_strength, KHR_mesh_quantization and KHR_texture_transform.
///
/// - As the specification asks (section 3.7.2.1), normals that are missing are made flat, and tangents with
///   them; where a normal map is without tangents, `makeTangents` makes them for its texture coordinates.
/// - Textures used for colour (base, emission) are sRGB, the others linear, whatever their file says; one
/// used
///   both ways becomes two. Of the sets of texture coordinates a mesh gets the first two, or those two that
///   the material asks for.
/// - Nodes are kept that an animation moves and from which something hangs, and those above them; all else is
///   placed for good. Everything comes placed as the nodes are at rest: `pose` (scene/animation.h) moves it.
///   Keys must be in the order of time (equal ones are let pass), finite and not before 0; a rotation must
///   have a length. A node that is animated though placed by a matrix keeps of that translation, rotation and
///   scale.
/// - Meshes, textures, instances, lights and cameras come in the order of the file.
/// - Morph targets, skins, points, lines, orthographic cameras, and textures by a third set of coordinates
///   are left out with a warning.
ImportedScene importGltf(std::string_view contents, const std::filesystem::path& file);

}  // namespace quincunx

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
/// KHR_lights_punctual, KHR_materials_emissive_strength and KHR_mesh_quantization. As the specification
/// asks (section 3.7.2.1), normals that are missing are made flat.
ImportedScene importGltf(std::string_view contents, const std::filesystem::path& file);

}  // namespace quincunx

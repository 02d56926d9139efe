#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace quincunx {

/// Writes a scene as glTF 2.0: .glb, or .gltf as one file that holds its bytes and pictures (PNG) as base64.
/// The file appears whole or not at all. `importScene` reads back the same scene, floats bit for bit, with
/// the same `fingerprint`:
///
/// - Materials, textures with their ways of being looked up, texture transforms, vertices, placements,
/// lights,
///   cameras, nodes and animations are written as glTF has them (extensions KHR_lights_punctual,
///   KHR_materials_emissive_strength, KHR_materials_ior, KHR_materials_transmission, KHR_texture_transform).
///   What it has no place for stands in "extras", which other programs pass over: Phong numbers that do not
///   follow from metalness and roughness, the lens of a camera, ambient light, background, the environment
///   (three channels of its panorama, as floats), and texture transforms that are no scale, turn and offset.
/// - Left out is what nothing shows: meshes of no instance, textures of no material, instances without
///   triangles, vertices of no triangle (where a mesh has fewer corners than vertices), nodes that neither
///   move nor carry such that do, cones of lights that are no spots. Where something is left out, the numbers
///   of what follows it change.
/// - What hangs from a node is written as the nodes are at rest.
/// - A texture's numbers are sRGB where a material takes them for colour and linear elsewhere, whatever
///   `encoding` says. Factors are clamped to what glTF allows, 0 … 1, emission to 1e6. Directions, normals,
///   tangents and rotations further from unit length than 2^-21 are made so; missing normals come back flat.
/// - Names come back without control characters, cut at 200 bytes, bytes that are no UTF-8 replaced.
///
/// InputError with one line for a scene without triangles, for a number that is not finite (the far plane
/// and the focus may be infinite), a placement whose last row is not 0 0 0 1, a picture that PNG cannot hold,
/// a file of more than 2 GiB, an extension other than those two, a folder that cannot be written.
/// Held by ExportGltf.*.
void exportScene(const Scene& scene, const std::filesystem::path& file);

}  // namespace quincunx

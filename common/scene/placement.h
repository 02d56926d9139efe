#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "scene/motion.h"

/// Where nodes are, and what hangs from them. Frames are affine matrices in double.
namespace quincunx {

/// T R S; the rotation of any length but zero.
glm::dmat4 composedFrame(const glm::dvec3& translation, const glm::dvec4& rotationXyzw,
                         const glm::dvec3& scale);

/// `parent_from_node` at rest.
glm::dmat4 restFrame(const Node& node);

/// `texture_from_texcoord` of KHR_texture_transform: the scale first, then a turn that is counter-clockwise
/// where t points down, then the offset. (The matrix in the extension's text turns the other way; its prose,
/// its test model and the programs that read it agree on this one.)
glm::mat3 textureTransformMatrix(const glm::dvec2& offset, double rotationRadians, const glm::dvec2& scale);

/// The factor of a material's emission is taken up to here, W/(m² sr).
inline constexpr double mostEmission = 1e6;

/// Indices of refraction are taken up to here: such glass mirrors all but a millionth.
inline constexpr double mostIor = 1e6;

/// True if all is finite as float.
bool isFiniteAsFloat(const glm::dmat4& frame);

/// A vector whose length differs from 1 by no more than this is one that was made unit length in float (three
/// components of half an ulp, 2^-25 each, and a few operations more): it is taken as it is, so that what is
/// written is read back bit for bit.
inline constexpr double unitTolerance = 0x1p-21;

/// The direction, made unit length where it is not within `unitTolerance`; none for a vector of no length or
/// one that is not finite.
std::optional<glm::vec3> unitOrAsItIs(const glm::dvec3& direction);

/// Where the frame looks, its −z axis; none if that has no length.
std::optional<glm::vec3> viewDirection(const glm::dmat4& worldFromNode);

/// The rigid frame of a camera in a node's frame: origin and view direction of the node, its up as far as
/// possible, no scale. A frame that is rigid up to `unitTolerance` is taken as it is. None if the frame has
/// no volume or is not finite as float.
std::optional<glm::mat4> cameraFrame(const glm::dmat4& worldFromNode);

}  // namespace quincunx

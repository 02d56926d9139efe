#pragma once

#include <glm/glm.hpp>

#include "geometry/mesh.h"

namespace quincunx {

/// Fills `mesh.tangents` by `vertexTangents` for a normal map that is looked up at `textureFromTexcoord`
/// (affine) times the texture coordinates of the given set (0 or 1). A vertex at which triangles with upright
/// and with mirrored coordinates meet becomes two first, each with the triangles of one kind, so that the
/// mesh may grow, to twice its vertices at most; its triangles stay what they are. Every vertex gets a
/// tangent of unit length to 1.1e-7 that is perpendicular to the normal to 2e-7, also without texture
/// coordinates. Positions must be finite and normals there, of unit length. Held by TangentFrames.*.
void makeTangents(Mesh& mesh, int texcoordSet = 0, const glm::mat3& textureFromTexcoord = glm::mat3(1));

}  // namespace quincunx

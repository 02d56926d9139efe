#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"

namespace quincunx {

/// Tangents for normal maps, one a vertex, as Mesh::tangents has them: along growing s, perpendicular to the
/// normal, unit length; w is the sign that makes w cross(normal, tangent) run against t, up in the image.
/// Each is the mean of the triangles that meet in the vertex, projected into the vertex' tangent plane and
/// weighted with their angles there, as Mikkelsen, "Simulation of wrinkled surfaces revisited", 2008, asks;
/// mirrored triangles that share a vertex with others give way to the larger sum of angles. Triangles whose
/// texture coordinates span no area, or are not finite, do not count; vertices without any other get some
/// tangent, so that all are unit vectors. In double, nothing is divided by the span, so that no scale of
/// positions or texture coordinates matters. `texcoords` and the mesh's normals have one entry a vertex. Held
/// by Tangents.*.
std::vector<glm::vec4> vertexTangents(const Mesh& mesh, std::span<const glm::vec2> texcoords);

}  // namespace quincunx

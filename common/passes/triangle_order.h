#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"

namespace quincunx {

/// Whether no vertex lies before any of the mesh's triangles: then a line of sight meets at most one triangle
/// that faces the eye and one that faces away, and blending those that face away first is right everywhere.
/// Flat meshes are convex. Tests triangles times vertices, in double without slack, so that rounding can call
/// a convex mesh not convex; beyond 2^24 tests the answer is no. Held by TriangleOrder.*.
bool isConvex(const Mesh& mesh);

/// The mesh's triangles by the distance of their centroids from the eye, the farthest first, in the mesh's
/// order where equal, those of no place last. What painting them in this order leaves wrong are triangles
/// that are large for their distance from one another, and those that intersect. n log n.
std::vector<std::uint32_t> trianglesFarthestFirst(const Mesh& mesh, const glm::mat4& worldFromModel,
                                                  const glm::vec3& eyeWorld);

}  // namespace quincunx

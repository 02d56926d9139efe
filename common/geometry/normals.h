#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"

/// Normals for meshes that came without. All sums are in double, where products of four floats neither
/// overflow nor vanish, so that the results do not depend on the model's scale. Results are the same on any
/// number of threads. Positions must be finite.
namespace quincunx {

/// The unit normal of the triangle's plane, by the right-hand rule; (0,0,0) if its area is zero.
glm::dvec3 triangleNormal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

/// One unit normal a group: the sum of the normals of the triangles that touch it, each weighted with the
/// triangle's angle there, which makes the result independent of how flat parts are cut into triangles
/// (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", Journal of Graphics Tools 3(1),
/// 1998). `positionIndices` and `groups` have three entries a triangle; `groups` says which of the
/// `groupCount` sums the corner belongs to, or `noGroup`. Triangles without area do not count. Where the sum
/// cancels out, the group gets the normal of its first triangle with area; a group without such a triangle
/// gets (0,0,1).
constexpr std::uint32_t noGroup = 0xffffffffu;
std::vector<glm::vec3> smoothNormals(std::span<const glm::vec3> positions,
                                     std::span<const std::uint32_t> positionIndices,
                                     std::span<const std::uint32_t> groups, std::size_t groupCount);

/// Gives `mesh` one normal a vertex by `smoothNormals`.
void makeSmoothNormals(Mesh& mesh);

/// Gives every triangle of `mesh` three vertices of its own, with the normal of the triangle's plane;
/// (0,0,1) where it has no area. Tangents, which belonged to other normals, go.
void makeFlatNormals(Mesh& mesh);

}  // namespace quincunx

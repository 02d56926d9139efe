#pragma once

#include <glm/glm.hpp>

#include "geometry/mesh.h"

namespace quincunx {

/// Fills `mesh.tangents` for a normal map that is looked up at `textureFromTexcoord` (affine) times the
/// texture coordinates of the given set (0 or 1). Normals must be there, of unit length; positions finite.
///
/// A triangle's tangent is its edges' combination along which s grows and t does not, by the cofactors
/// e1 Δt2 − e2 Δt1 with the sign of the determinant: nothing is divided by that. A vertex gets the sum over
/// its triangles of that direction, brought into the plane of the vertex's normal and made unit length,
/// weighted with the triangle's angle there (as MikkTSpace does: Mikkelsen, "Simulation of wrinkled surfaces
/// revisited", 2008, section 2.4 and appendix A). The fourth component is +1 where texture coordinates run
/// as they do on an upright picture seen from outside, −1 where they are mirrored. A vertex at which both
/// kinds of triangles meet becomes two, so the mesh may grow, to twice its vertices at most.
///
/// Triangles with no area in space or in the texture (or with coordinates that are not finite) say nothing.
/// A vertex for which nothing is said, or where the sum cancels out, gets some tangent perpendicular to its
/// normal. Sums are in double: every tangent is of unit length to 1.1e-7 and perpendicular to the float
/// normal to 2e-7. Without texture coordinates nothing is said anywhere. Held by Tangents.*.
void makeTangents(Mesh& mesh, int texcoordSet = 0, const glm::mat3& textureFromTexcoord = glm::mat3(1));

/// The textbook's tangent of one triangle, (Δt2 e1 − Δt1 e2) / (Δs1 Δt2 − Δs2 Δt1), in float and not of unit
/// length; not a number where the coordinates have no area.
glm::vec3 triangleTangentNaive(const glm::vec3& e1, const glm::vec3& e2, glm::vec2 st1, glm::vec2 st2);

}  // namespace quincunx

#pragma once

#include <optional>

#include <glm/glm.hpp>

/// Matrices between frames, column vectors, `a_from_b * b`. The camera's frame is right-handed: x right, y
/// up, looking along −z. Computed in double and rounded once; see math/vector.h for what "0.5 ulp" means.
/// What that costs against the textbook's form in float (bench_vector, whole arrays): inverse 1.3 times (3.3
/// for projections, whose determinants cancel), rigid inverses 2, normal matrices 2.5, lookAt 3.4, affine
/// inverses 5 times, since GLM's are vectorised.
namespace quincunx {

/// The matrix that takes normals from the model to the world: sign(det M) cof M of the upper 3×3 M, which is
/// |det M| times the inverse transpose but divides by nothing, so it serves singular models too (the limit of
/// a flattened one has normals). The sign is exact: normals that pointed outward still do when the model is
/// mirrored; for det = 0 it is +. Normalize what comes out.
/// Each entry is right to 0.5 ulp, up to a common power of two that centres the magnitudes of the columns on
/// 1: a rigid or uniformly scaled model gets entries up to 1, the largest of each column in [½, 2), and none
/// leaves the range of float unless columns are 2^250 apart (the largest entry stays below 2^125, small ones
/// vanish). A model squeezed to a line or a point has no normals, and one that is not finite none that are
/// known: these get the identity. Held by NormalMatrix.*.
glm::mat3 normalMatrix(const glm::mat4& worldFromModel);

/// transpose(inverse(mat3(worldFromModel))) in float.
glm::mat3 normalMatrixNaive(const glm::mat4& worldFromModel);

/// The unit world normal of a model's normal (of any length): as `normalMatrix`, but in double to the end.
/// Each component is within 3e-8 + 32 u κ of exact, κ = ‖cof M‖ ‖n‖ / ‖cof M n‖ (Frobenius), the condition of
/// the product; so 3e-8 for rigid, mirrored and uniformly scaled models of any size. None if the result has
/// no direction, or something is not finite. Held by NormalMatrix.*.
std::optional<glm::vec3> transformNormal(const glm::mat4& worldFromModel, glm::vec3 normal);

/// The inverse, every entry to 0.53 ulp however badly conditioned: the adjugate over the determinant in
/// double, whose 2×2 minors of floats do not cancel. Where the sums of larger ones cancel by more than 2^20
/// they are taken from `determinant` of math/exact.h; else they and the determinant are within 5 · 2^-33 of
/// themselves, 0.02 ulp together. None if the matrix is singular (decided exactly), not finite, or if an
/// entry of its inverse exceeds the range of float. Held by Inverse.*.
std::optional<glm::mat4> inverse(const glm::mat4& m);

/// Adjugate over determinant, in float.
glm::mat4 inverseNaive(const glm::mat4& m);

/// The same result, bound and exceptions as `inverse` for an affine matrix, whose last row is 0 0 0 1 (a bug
/// of the caller otherwise): A⁻¹ and −A⁻¹t. Held by Inverse.*.
std::optional<glm::mat4> inverseAffine(const glm::mat4& m);

/// A⁻¹ and −A⁻¹t, in float.
glm::mat4 inverseAffineNaive(const glm::mat4& m);

/// The inverse of a rigid matrix, Rᵀ and −Rᵀt: 0.5 ulp an entry of what these are for the given floats.
/// Whatever R lacks of being orthonormal stays in the result. The last row is 0 0 0 1. Held by Inverse.*.
glm::mat4 inverseRigid(const glm::mat4& m);

/// Rᵀ and −Rᵀt, in float.
glm::mat4 inverseRigidNaive(const glm::mat4& m);

/// The pose of a camera at `eye` that looks at `target` with `up` upwards in its picture: a rigid matrix,
/// |RRᵀ − I| ≤ 1.1e-7 in every entry (rounding alone: 2 √3 2^-25), det = +1, its origin exactly `eye`.
/// If `up` is zero or exactly along the view, the picture's right is `basisAround(view)`'s first column; if
/// eye and target coincide, the camera is turned as the world is. The three must be finite. Held by LookAt.*.
glm::mat4 lookAt(glm::vec3 eye, glm::vec3 target, glm::vec3 up);

glm::mat4 lookAtNaive(glm::vec3 eye, glm::vec3 target, glm::vec3 up);

/// `inverseRigid` of a camera's pose. Held by LookAt.*.
glm::mat4 cameraFromWorld(const glm::mat4& worldFromCamera);

}  // namespace quincunx

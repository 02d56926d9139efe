#pragma once

#include <glm/glm.hpp>

/// Sums of products that are right however much of them cancels.
namespace quincunx {

/// det m with a relative error of at most 2^-52 for every finite m, so with the exact sign, and zero only if
/// m is singular. The products are split without error and summed in twice the precision (Ogita, Rump, Oishi,
/// "Accurate sum and dot product", SIAM J. Sci. Comput. 26, 2005); where that cancels too far, by expansions
/// (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete
/// Comput. Geom. 18, 1997). A matrix that is not finite has no determinant: the result is not finite.
/// Held by Determinant.*.
double determinant(const glm::mat3& m);
double determinant(const glm::mat4& m);

float determinantNaive(const glm::mat3& m);

}  // namespace quincunx

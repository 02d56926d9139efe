#pragma once

#include <cmath>

#include "base/vector_units.h"

/// Möller and Trumbore's numbers with a bound of their error, for the scalar and the packed forms of
/// geometry/ray_triangle.h; no part of the interface.
///
/// Let ε be half an ulp of 1 of `Real`; s = origin − a, e1 = b − a, e2 = c − a with a relative error ε in
/// each component; S = Σ|s|, D = Σ|d|, e the largest component of e1 and e2.
/// - u = s · (d × e2) sums six products of three, each with eight such errors at most (two of components, two
/// of
///   products, one of the difference, two of the sum, one spare). Σ|s_i|(|d_j e_k| + |d_k e_j|) ≤ S D e, so u
///   is off by 8 S D e ε; v = d · (s × e1) too; det = e1 · (d × e2) by 24 D e² ε, as Σ|e1| ≤ 3 e.
/// - w = det − u − v is off by the sum of these and a few roundings of |u| + |v| + |det| ≤ D e (2 S + 3 e):
/// in all
///   below (24 S + 48 e) D e ε. With far = S + 4 e, B = 32 ε D e far bounds the error of u, v, and w, the
///   roundings of B included.
/// - The quotient t = e2 · (s × e1) / det: Σ|s_i|(|e1_j e2_k| + |e1_k e2_j|) ≤ 2 S e², so the numerator is
/// off by
///   16 S e² ε, and det by 16 D e² ε likewise, where |t| D ≤ S + 3 e for a hit, the sizes of its components:
///   together at most 32 ε e² far / |det|.
/// All this as long as nothing overflows or underflows.
namespace quincunx::detail {

template <typename Real>
struct Components {
    Real x;
    Real y;
    Real z;
};

template <typename Real>
QUINCUNX_ALWAYS_INLINE Components<Real> minus(Components<Real> a, Components<Real> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
QUINCUNX_ALWAYS_INLINE Components<Real> crossed(Components<Real> a, Components<Real> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real dotted(Components<Real> a, Components<Real> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real larger(Real a, Real b) {
    return a > b ? a : b;
}
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real smaller(Real a, Real b) {
    return a < b ? a : b;
}
/// |x| + |y| + |z|
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real sumOfSizes(Components<Real> a) {
    return std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
}
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real largestSize(Components<Real> a) {
    return larger(larger(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

/// The weights of b and c and t, all times `det`.
template <typename Real>
struct Products {
    Real det;
    Real u;
    Real v;
    Real t;
};

template <typename Real>
QUINCUNX_ALWAYS_INLINE Products<Real> productsOf(Components<Real> s, Components<Real> d, Components<Real> e1,
                                                 Components<Real> e2) {
    const Components<Real> p = crossed(d, e2);
    const Components<Real> q = crossed(s, e1);
    return {dotted(e1, p), dotted(s, p), dotted(d, q), dotted(e2, q)};
}

}  // namespace quincunx::detail

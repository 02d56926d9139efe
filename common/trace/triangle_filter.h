#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "base/vector_units.h"
#include "geometry/ray_triangle.h"
#include "geometry/ray_triangle_filter.h"
#include "trace/accelerator.h"
#include "trace/slabs.h"

/// How the structures test triangles: float arithmetic with a bound of its error throws out nearly all that
/// a ray misses, and ShearedRay has the last word on the rest. No part of the interface.
namespace quincunx::detail {

/// What a ray needs for the filter. `Real` is float, or a vector of floats for several rays.
///
/// The bounds are those of geometry/ray_triangle_filter.h with far = S + 4 e, S = Σ|origin − a|, each twice
/// what it has to be, which pays for the roundings of the bounds themselves:
/// - u, v, w: 2 B = 64 ε D e far;
/// - the numerator of t: 32 ε S e²; det: 32 ε D e².
/// Sizes below 2^40 keep products of three below 2^123. What underflows is off by less than 2^-149 · 2^40
/// times the number of products, below 2^-100, for which 2^-90 is added.
template <typename Real>
struct FilterRay {
    Components<Real> origin;
    Components<Real> direction;
    Real weightScale;  ///< 64 ε D
    Real detScale;     ///< 32 ε D
};

/// The ray for the filter, `all` being the box of all triangles; nothing where float does not suffice.
inline std::optional<FilterRay<float>> filterRay(const Ray& ray, RayInterval interval, const Bounds& all) {
    const glm::vec3 farthest = glm::max(glm::abs(all.min - ray.origin), glm::abs(all.max - ray.origin));
    const Components<float> direction{ray.direction.x, ray.direction.y, ray.direction.z};
    const float d = sumOfSizes(direction);
    if (!(interval.tMin >= 0 && farthest.x + farthest.y + farthest.z < 0x1p38f && d < 0x1p38f &&
          floatIsEnough(ray)))
        return std::nullopt;
    return FilterRay<float>{
        {ray.origin.x, ray.origin.y, ray.origin.z}, direction, 0x1p-18f * d, 0x1p-19f * d};
}

/// The largest size that a triangle's edges from `a` have along an axis, as `filterTriangle` wants it:
/// infinite where float's range does not suffice, so that nothing is thrown out.
inline float filterSize(const Triangle& triangle) {
    const glm::vec3 e1 = triangle.b - triangle.a;
    const glm::vec3 e2 = triangle.c - triangle.a;
    const float e = larger(largestSize(Components<float>{e1.x, e1.y, e1.z}),
                           largestSize(Components<float>{e2.x, e2.y, e2.z}));
    return e < 0x1p38f ? e : std::numeric_limits<float>::infinity();
}

/// The interval with room for the roundings of `filterTriangle`.
inline float filterMin(float tMin) {
    return tMin * (1 - 0x1p-20f);
}
inline float filterMax(float tMax) {
    return tMax * (1 + 0x1p-20f);
}

/// `a`, its sign turned where `sign` is negative.
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real turned(Real a, Real sign) {
    if constexpr (std::is_same_v<Real, float>) {
        const auto signBit = std::bit_cast<std::uint32_t>(sign) & 0x80000000u;
        return std::bit_cast<float>(std::bit_cast<std::uint32_t>(a) ^ signBit);
    } else {
        using Bits = decltype(a < a);
        const Bits signBit = (Bits)sign & (Bits{} + std::numeric_limits<std::int32_t>::min());
        return (Real)((Bits)a ^ signBit);
    }
}

template <typename Real>
QUINCUNX_ALWAYS_INLINE Real sizeOf(Real a) {
    return turned(a, a);
}

/// Below 0: surely no hit in the interval. Anything else, what is no number included, says nothing.
/// `size` is filterSize, and the interval filterMin … filterMax.
///
/// If the least of u, v, w, signed as det, is below −2 B, the others add up to more than 2 B, so that one of
/// them has surely the other sign, whatever the sign of det: a miss. t = T / det > tMax where
/// T − error > tMax (det + error), up to a few roundings of tMax · det, far below its 2^-20.
template <typename Real>
QUINCUNX_ALWAYS_INLINE Real filterTriangle(const FilterRay<Real>& ray, Components<Real> a, Components<Real> b,
                                           Components<Real> c, Real size, Real tMin, Real tMax) {
    const Components<Real> s = minus(ray.origin, a);
    const Products<Real> f = productsOf(s, ray.direction, minus(b, a), minus(c, a));
    const Real far = sizeOf(s.x) + sizeOf(s.y) + sizeOf(s.z) + 4 * size;
    const Real square = size * size;
    const Real weightError = size * ray.weightScale * far + 0x1p-90f;
    const Real depthError = square * (far * 0x1p-19f) + 0x1p-90f;
    const Real detError = square * ray.detScale + 0x1p-90f;
    const Real det = sizeOf(f.det);
    const Real u = turned(f.u, f.det);
    const Real v = turned(f.v, f.det);
    const Real depth = turned(f.t, f.det);
    const Real inside = smaller(smaller(u, v), det - u - v) + weightError;
    const Real notBefore = (depth + depthError) - tMin * (det - detError);
    const Real notBeyond = tMax * (det + detError) - (depth - depthError);
    return smaller(smaller(notBeyond, notBefore), inside);
}

/// Whether the ray may hit the triangle, its interval being filterMin … filterMax.
QUINCUNX_ALWAYS_INLINE bool mayHit(const FilterRay<float>& ray, const Triangle& triangle, float tMin,
                                   float tMax) {
    const auto components = [](const glm::vec3& v) { return Components<float>{v.x, v.y, v.z}; };
    return !(filterTriangle(ray, components(triangle.a), components(triangle.b), components(triangle.c),
                            filterSize(triangle), tMin, tMax) < 0);
}

/// The exact side: the nearest hit among the triangles it is shown, by the rules of Accelerator.
class NearestHit {
  public:
    NearestHit(const Ray& ray, RayInterval interval) : ray_(ray), interval_(interval), tMax_(interval.tMax) {}

    void test(const Triangle& triangle, std::uint32_t index) {
        if (!sheared_)
            sheared_.emplace(ray_);
        const std::optional<TriangleHit> found = sheared_->intersect(triangle, Sides::both, interval_);
        if (!found || (hit_ && (found->t > hit_->t || (found->t == hit_->t && index > hit_->triangle))))
            return;
        hit_ = AcceleratorHit{found->t, found->weights, index, found->front};
        tMax_ = std::min(tMax_, roundedUp(found->t));
    }

    /// What is beyond cannot be nearer.
    float tMax() const { return tMax_; }
    const std::optional<AcceleratorHit>& hit() const { return hit_; }

  private:
    const Ray& ray_;
    RayInterval interval_;
    float tMax_;
    std::optional<ShearedRay> sheared_;
    std::optional<AcceleratorHit> hit_;
};

/// Whether any of the triangles it is shown is hit.
class AnyHit {
  public:
    AnyHit(const Ray& ray, RayInterval interval) : ray_(ray), interval_(interval) {}

    bool test(const Triangle& triangle) {
        if (!sheared_)
            sheared_.emplace(ray_);
        return sheared_->intersect(triangle, Sides::both, interval_).has_value();
    }

  private:
    const Ray& ray_;
    RayInterval interval_;
    std::optional<ShearedRay> sheared_;
};

}  // namespace quincunx::detail

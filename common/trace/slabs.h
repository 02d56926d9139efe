#pragma once

#include <cmath>
#include <limits>

#include <glm/glm.hpp>

#include "base/vector_units.h"
#include "geometry/ray.h"

namespace quincunx {

/// A ray made ready for many boxes: the slab test (Kay, Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986)
/// that never loses a box that the ray meets (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013).
///
/// A quotient (plane − origin) / direction is a difference, a reciprocal and a product, each off by ε of
/// itself, so 3 ε in all and a little more. So the enter e and the exit x that are computed stand in the
/// right order where |x − e| > 8 ε min(|e|, |x|): for equal signs the error is at most
/// 3 ε (2 min(|e|, |x|) + |x − e|), and for different ones |x − e| is |e| + |x|. What lies closer counts as
/// met. That also covers a tMax that is off by ε.
/// Along a slab the reciprocal is infinite, and so are the quotients, of the right sign inside and outside;
/// in one of its planes 0 · ∞ is no number, and the comparisons below let it say nothing.
/// In double nothing of this can overflow or underflow, as quotients of floats stay within 2^±278. In float
/// see `floatIsEnough`; what underflows there is off by less than 2^-148, for which 2^-100 is added.
/// Held by Slabs.*.
template <typename Real>
class SlabRay {
  public:
    explicit SlabRay(const Ray& ray) : origin_(ray.origin), inverse_(Real(1) / Vector(ray.direction)) {
        for (int axis = 0; axis < 3; ++axis)
            backwards_[axis] = std::signbit(ray.direction[axis]);
    }

    /// Whether the ray may meet the box with tMin ≤ t ≤ tMax. `enter` is where it comes in, tMin at least,
    /// off by 3 ε of itself.
    QUINCUNX_ALWAYS_INLINE bool meets(const glm::vec3& min, const glm::vec3& max, Real tMin, Real tMax,
                                      Real& enter) const {
        enter = tMin;
        Real exit = tMax;
        for (int axis = 0; axis < 3; ++axis) {
            const Real nearPlane = backwards_[axis] ? max[axis] : min[axis];
            const Real farPlane = backwards_[axis] ? min[axis] : max[axis];
            const Real in = (nearPlane - origin_[axis]) * inverse_[axis];
            const Real out = (farPlane - origin_[axis]) * inverse_[axis];
            enter = in > enter ? in : enter;
            exit = out < exit ? out : exit;
        }
        const Real sizeIn = std::abs(enter);
        const Real sizeOut = std::abs(exit);
        return enter <= exit + (8 * epsilon * (sizeIn < sizeOut ? sizeIn : sizeOut) + tiny);
    }

    bool backwards(int axis) const { return backwards_[axis]; }

  private:
    using Vector = glm::vec<3, Real, glm::defaultp>;
    static constexpr Real epsilon = std::numeric_limits<Real>::epsilon() / 2;
    static constexpr Real tiny = std::numeric_limits<Real>::digits == 24 ? Real(0x1p-100) : Real(0);

    Vector origin_;
    Vector inverse_;
    bool backwards_[3] = {};
};

/// Whether SlabRay<float> keeps its word: each component of the direction is 0 or its size between 2^-60 and
/// 2^60, and no component of the origin is beyond 2^100, so that a difference to any finite plane is finite.
inline bool floatIsEnough(const Ray& ray) {
    for (int axis = 0; axis < 3; ++axis) {
        const float size = std::abs(ray.direction[axis]);
        if (!((size == 0 || (size >= 0x1p-60f && size <= 0x1p60f)) && std::abs(ray.origin[axis]) <= 0x1p100f))
            return false;
    }
    return true;
}

/// Finite, and with a direction: others meet nothing.
inline bool isUsable(const Ray& ray) {
    const glm::vec3 o = ray.origin - ray.origin;
    const glm::vec3 d = ray.direction - ray.direction;
    return o == glm::vec3(0) && d == glm::vec3(0) && ray.direction != glm::vec3(0);
}

/// The least float that is not below `t`.
inline float roundedUp(double t) {
    const auto rounded = static_cast<float>(t);
    return static_cast<double>(rounded) < t ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                            : rounded;
}

}  // namespace quincunx

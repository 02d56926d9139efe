#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "base/vector_units.h"
#include "geometry/ray_triangle.h"
#include "geometry/ray_triangle_filter.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

using detail::larger;
using detail::largestSize;
using detail::minus;
using detail::productsOf;
using detail::smaller;
using detail::sumOfSizes;
using Components = detail::Components<float>;
using Products = detail::Products<float>;

QUINCUNX_ALWAYS_INLINE float naiveLane(Components s, Components d, Components e1, Components e2) {
    const Products f = productsOf(s, d, e1, e2);
    const float inverse = 1 / f.det;
    const float u = f.u * inverse;
    const float v = f.v * inverse;
    const float t = f.t * inverse;
    const bool hit = (f.det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0);
    return hit ? t : infinity;
}

/// What a lane needs to know of the size of its triangle; `e` bounds the components of e1 and e2.
struct Sizes {
    float e4;      ///< 4 e
    float scale;   ///< 64 ε e
    float tScale;  ///< 2^14 · 32 ε e², a little more; nothing passes where that underflows
};

QUINCUNX_ALWAYS_INLINE Sizes sizesOf(float e) {
    return {4 * e, e * 0x1p-18f, e > 0x1p-55f ? e * e * 0x1.01p-5f : infinity};
}

constexpr float doubtful = std::numeric_limits<float>::quiet_NaN();

/// t, or infinity where the ray misses, or `doubtful` where float does not settle it, by the bounds of
/// ray_triangle_filter.h divided by det, so that the three weights add up to 1. If the least is below
/// −2 B/|det|, the others add up to more than 2 B/|det|, so one has surely the other sign: a miss. If it is
/// above, all are surely of one sign. A det whose sign is open makes B/|det| at least 1/2 and a hit
/// impossible, as the least cannot exceed ⅓. The error of t must be below 2^-14 |t|.
/// The limits of range see to it that nothing overflows or underflows: sizes below 2^40 keep products of
/// three below 2^123; what underflows is at most 2^-149 · 2^40 times a few, far below 2^-79, the least B
/// there is for D e far above 2^-60.
QUINCUNX_ALWAYS_INLINE float certainLane(Components s, Components d, Components e1, Components e2,
                                         Sizes sizes) {
    const Products f = productsOf(s, d, e1, e2);
    const float inverse = 1 / f.det;
    const float u = f.u * inverse;
    const float v = f.v * inverse;
    const float t = f.t * inverse;
    const float least = smaller(smaller(u, v), 1 - u - v);
    const float sizeS = sumOfSizes(s);
    const float sizeD = sumOfSizes(d);
    const float far = sizeS + sizes.e4;
    const float bound = far * (sizeD * sizes.scale);  // 2 B
    const float size = std::abs(inverse);
    const bool inRange = (far + sizeD < 0x1p40f) & (bound > 0x1p-78f);
    const bool certain = std::abs(least) > bound * size;
    const bool miss = least < 0;
    const bool exactEnough = std::abs(t) > far * size * sizes.tScale;
    const bool settled = inRange & certain & (miss | exactEnough);
    return settled ? (miss | (t < 0) ? infinity : t) : doubtful;
}

struct RayPointers {
    const float* __restrict origin[3];
    const float* __restrict direction[3];
};

RayPointers pointersOf(const RayArrays& rays) {
    RayPointers p{};
    for (std::size_t i = 0; i < 3; ++i) {
        p.origin[i] = rays.origin[i].data();
        p.direction[i] = rays.direction[i].data();
    }
    return p;
}

struct TrianglePointers {
    const float* __restrict a[3];
    const float* __restrict b[3];
    const float* __restrict c[3];
};

TrianglePointers pointersOf(const TriangleArrays& triangles) {
    TrianglePointers p{};
    for (std::size_t i = 0; i < 3; ++i) {
        p.a[i] = triangles.a[i].data();
        p.b[i] = triangles.b[i].data();
        p.c[i] = triangles.c[i].data();
    }
    return p;
}

Components componentsOf(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

#define QX_LOAD(pointers, i) \
    { (pointers)[0][i], (pointers)[1][i], (pointers)[2][i] }

QUINCUNX_FOR_EACH_VECTOR_UNIT
void naiveRays(RayPointers rays, Components a, Components e1, Components e2, std::size_t size,
               float* __restrict t) {
    const float* const ox = rays.origin[0];
    const float* const oy = rays.origin[1];
    const float* const oz = rays.origin[2];
    const float* const dx = rays.direction[0];
    const float* const dy = rays.direction[1];
    const float* const dz = rays.direction[2];
    for (std::size_t i = 0; i < size; ++i)
        t[i] = naiveLane(minus({ox[i], oy[i], oz[i]}, a), {dx[i], dy[i], dz[i]}, e1, e2);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void certainRays(RayPointers rays, Components a, Components e1, Components e2, std::size_t size,
                 float* __restrict t) {
    const float* const ox = rays.origin[0];
    const float* const oy = rays.origin[1];
    const float* const oz = rays.origin[2];
    const float* const dx = rays.direction[0];
    const float* const dy = rays.direction[1];
    const float* const dz = rays.direction[2];
    const Sizes sizes = sizesOf(larger(largestSize(e1), largestSize(e2)));
    for (std::size_t i = 0; i < size; ++i)
        t[i] = certainLane(minus({ox[i], oy[i], oz[i]}, a), {dx[i], dy[i], dz[i]}, e1, e2, sizes);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void naiveTriangles(Components o, Components d, TrianglePointers triangles, std::size_t size,
                    float* __restrict t) {
    for (std::size_t i = 0; i < size; ++i) {
        const Components a QX_LOAD(triangles.a, i);
        const Components b QX_LOAD(triangles.b, i);
        const Components c QX_LOAD(triangles.c, i);
        t[i] = naiveLane(minus(o, a), d, minus(b, a), minus(c, a));
    }
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void certainTriangles(Components o, Components d, TrianglePointers triangles, std::size_t size,
                      float* __restrict t) {
    for (std::size_t i = 0; i < size; ++i) {
        const Components a QX_LOAD(triangles.a, i);
        const Components b QX_LOAD(triangles.b, i);
        const Components c QX_LOAD(triangles.c, i);
        const Components e1 = minus(b, a);
        const Components e2 = minus(c, a);
        t[i] = certainLane(minus(o, a), d, e1, e2, sizesOf(larger(largestSize(e1), largestSize(e2))));
    }
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
int countDoubtful(const float* t, std::size_t size) {
    int count = 0;
    for (std::size_t i = 0; i < size; ++i)
        count += t[i] != t[i] ? 1 : 0;
    return count;
}

/// Calls `settle(index)` for what is doubtful, and says how many there were.
template <typename Settle>
std::size_t settleDoubtful(std::span<const float> t, const Settle& settle) {
    constexpr std::size_t blockSize = 1024;
    std::size_t total = 0;
    for (std::size_t begin = 0; begin < t.size(); begin += blockSize) {
        const std::size_t size = std::min(blockSize, t.size() - begin);
        const int count = countDoubtful(&t[begin], size);
        if (count == 0)
            continue;
        total += static_cast<std::size_t>(count);
        for (std::size_t i = begin; i < begin + size; ++i)
            if (std::isnan(t[i]))
                settle(i);
    }
    return total;
}

/// t rounded to float and kept finite.
float storedT(const std::optional<TriangleHit>& hit) {
    if (!hit)
        return infinity;
    return static_cast<float>(std::min(hit->t, static_cast<double>(std::numeric_limits<float>::max())));
}

}  // namespace

std::size_t intersectPacked(const RayArrays& rays, const Triangle& triangle, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, rays.size());
    certainRays(pointersOf(rays), componentsOf(triangle.a), componentsOf(triangle.b - triangle.a),
                componentsOf(triangle.c - triangle.a), rays.size(), t.data());
    return settleDoubtful(t, [&](std::size_t i) { t[i] = storedT(intersectTriangle(rays.at(i), triangle)); });
}

std::size_t intersectPacked(const Ray& ray, const TriangleArrays& triangles, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, triangles.size());
    certainTriangles(componentsOf(ray.origin), componentsOf(ray.direction), pointersOf(triangles),
                     triangles.size(), t.data());
    const ShearedRay sheared(ray);
    return settleDoubtful(t, [&](std::size_t i) { t[i] = storedT(sheared.intersect(triangles.at(i))); });
}

void intersectMollerTrumborePackedNaive(const RayArrays& rays, const Triangle& triangle, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, rays.size());
    naiveRays(pointersOf(rays), componentsOf(triangle.a), componentsOf(triangle.b - triangle.a),
              componentsOf(triangle.c - triangle.a), rays.size(), t.data());
}

void intersectMollerTrumborePackedNaive(const Ray& ray, const TriangleArrays& triangles, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, triangles.size());
    naiveTriangles(componentsOf(ray.origin), componentsOf(ray.direction), pointersOf(triangles),
                   triangles.size(), t.data());
}

}  // namespace quincunx

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/check.h"
#include "base/vector_units.h"
#include "geometry/ray_triangle.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Components {
    float x;
    float y;
    float z;
};

QUINCUNX_ALWAYS_INLINE Components minus(Components a, Components b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
QUINCUNX_ALWAYS_INLINE Components crossed(Components a, Components b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
QUINCUNX_ALWAYS_INLINE float dotted(Components a, Components b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
QUINCUNX_ALWAYS_INLINE float larger(float a, float b) {
    return a > b ? a : b;
}
QUINCUNX_ALWAYS_INLINE float smaller(float a, float b) {
    return a < b ? a : b;
}
/// |x| + |y| + |z|
QUINCUNX_ALWAYS_INLINE float sumOfSizes(Components a) {
    return std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
}
QUINCUNX_ALWAYS_INLINE float largestSize(Components a) {
    return larger(larger(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

/// Möller and Trumbore's numbers: the weights of b and c and t, all times `det`.
struct Products {
    float det;
    float u;
    float v;
    float t;
};

QUINCUNX_ALWAYS_INLINE Products productsOf(Components s, Components d, Components e1, Components e2) {
    const Components p = crossed(d, e2);
    const Components q = crossed(s, e1);
    return {dotted(e1, p), dotted(s, p), dotted(d, q), dotted(e2, q)};
}

QUINCUNX_ALWAYS_INLINE float naiveLane(Components s, Components d, Components e1, Components e2) {
    const Products f = productsOf(s, d, e1, e2);
    const float inverse = 1 / f.det;
    const float u = f.u * inverse;
    const float v = f.v * inverse;
    const float t = f.t * inverse;
    const bool hit = (f.det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0);
    return hit ? t : infinity;
}

/// t, or infinity; `doubt` is 1 where float does not settle it. `e` bounds the components of e1 and e2.
///
/// With ε = 2^-24, S = Σ|s|, D = Σ|d|: components of s, e1, e2 have a relative error ε. u = s · (d × e2) sums
/// six products of three, each with eight such errors at most (two of components, two of products, one of the
/// difference, two of the sum, one spare), and Σ|s_i|(|d_j e_k| + |d_k e_j|) ≤ S D e: 8 S D e ε. The same for
/// v; 24 D e² ε for det, since Σ|e1| ≤ 3e; and for w = det − u − v these three and 3 roundings of the
/// largest: below 18 S D e ε + 32 D e² ε, which serves all. The product with t in it is off by 8 · 2 S e² ε,
/// as each Σ|s_i|(|e1_j e2_k| + |e1_k e2_j|) ≤ 2 S e²; det also by 8 · 2 D e² ε. All this as long as nothing
/// overflows or underflows, which the two limits of range see to: sizes below 2^40 keep products of three
/// below 2^123, and what underflows is at most 2^-149 · 2^40 times a few, far below a bound of 2^-90.
QUINCUNX_ALWAYS_INLINE float certainLane(Components s, Components d, Components e1, Components e2, float e,
                                         std::int32_t& doubt) {
    const Products f = productsOf(s, d, e1, e2);
    const float w = f.det - f.u - f.v;
    const float sizeS = sumOfSizes(s);
    const float sizeD = sumOfSizes(d);
    const float bound = sizeD * e * (sizeS * 0x1.2p-20f + e * 0x1p-19f);
    const float least = smaller(smaller(f.u, f.v), w);
    const float most = larger(larger(f.u, f.v), w);
    const bool inRange = (bound > 0x1p-90f) & (sizeS + sizeD + e < 0x1p40f);
    const bool miss = (least < -bound) & (most > bound);
    const bool oneSided = (least > bound) | (most < -bound);
    // 16 ε of the sizes is at most 2^-15 of the value: t is within 2^-14.
    const float area = e * e;
    const bool exactEnough =
        (std::abs(f.t) > 0x1p-5f * (sizeS * area)) & (std::abs(f.det) > 0x1p-5f * (sizeD * area));
    const float t = f.t / f.det;
    const bool settled = inRange & (miss | (oneSided & exactEnough));
    doubt = settled ? 0 : 1;
    return miss | !(t >= 0) ? infinity : t;
}

constexpr std::size_t blockSize = 256;
using Doubts = std::array<std::int32_t, blockSize>;

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
void naiveRays(RayPointers rays, Components a, Components e1, Components e2, std::size_t begin,
               std::size_t end, float* __restrict t) {
    const float* const ox = rays.origin[0];
    const float* const oy = rays.origin[1];
    const float* const oz = rays.origin[2];
    const float* const dx = rays.direction[0];
    const float* const dy = rays.direction[1];
    const float* const dz = rays.direction[2];
    for (std::size_t i = begin; i < end; ++i)
        t[i] = naiveLane(minus({ox[i], oy[i], oz[i]}, a), {dx[i], dy[i], dz[i]}, e1, e2);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void certainRays(RayPointers rays, Components a, Components e1, Components e2, float e, std::size_t begin,
                 std::size_t count, float* __restrict t, std::int32_t* __restrict doubts) {
    const float* const ox = rays.origin[0] + begin;
    const float* const oy = rays.origin[1] + begin;
    const float* const oz = rays.origin[2] + begin;
    const float* const dx = rays.direction[0] + begin;
    const float* const dy = rays.direction[1] + begin;
    const float* const dz = rays.direction[2] + begin;
    for (std::size_t i = 0; i < count; ++i)
        t[i] = certainLane(minus({ox[i], oy[i], oz[i]}, a), {dx[i], dy[i], dz[i]}, e1, e2, e, doubts[i]);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void naiveTriangles(Components o, Components d, TrianglePointers triangles, std::size_t begin,
                    std::size_t end, float* __restrict t) {
    for (std::size_t i = begin; i < end; ++i) {
        const Components a QX_LOAD(triangles.a, i);
        const Components b QX_LOAD(triangles.b, i);
        const Components c QX_LOAD(triangles.c, i);
        t[i] = naiveLane(minus(o, a), d, minus(b, a), minus(c, a));
    }
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void certainTriangles(Components o, Components d, TrianglePointers triangles, std::size_t begin,
                      std::size_t count, float* __restrict t, std::int32_t* __restrict doubts) {
    for (std::size_t i = 0; i < count; ++i) {
        const Components a QX_LOAD(triangles.a, begin + i);
        const Components b QX_LOAD(triangles.b, begin + i);
        const Components c QX_LOAD(triangles.c, begin + i);
        const Components e1 = minus(b, a);
        const Components e2 = minus(c, a);
        t[i] = certainLane(minus(o, a), d, e1, e2, larger(largestSize(e1), largestSize(e2)), doubts[i]);
    }
}

/// Calls `fill(begin, count, doubts)` for block after block, and `settle(index)` for what is doubtful, whose
/// number is returned.
template <typename Fill, typename Settle>
std::size_t inBlocks(std::size_t size, const Fill& fill, const Settle& settle) {
    Doubts doubts;
    std::size_t doubtful = 0;
    for (std::size_t begin = 0; begin < size; begin += blockSize) {
        const std::size_t count = std::min(blockSize, size - begin);
        fill(begin, count, doubts.data());
        std::int32_t inBlock = 0;
        for (std::size_t i = 0; i < count; ++i)
            inBlock += doubts[i];
        if (inBlock == 0)
            continue;
        doubtful += static_cast<std::size_t>(inBlock);
        for (std::size_t i = 0; i < count; ++i)
            if (doubts[i] != 0)
                settle(begin + i);
    }
    return doubtful;
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
    const RayPointers pointers = pointersOf(rays);
    const Components e1 = componentsOf(triangle.b - triangle.a);
    const Components e2 = componentsOf(triangle.c - triangle.a);
    const float e = larger(largestSize(e1), largestSize(e2));
    return inBlocks(
        rays.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            certainRays(pointers, componentsOf(triangle.a), e1, e2, e, begin, count, t.data() + begin,
                        doubts);
        },
        [&](std::size_t i) { t[i] = storedT(intersectTriangle(rays.at(i), triangle)); });
}

std::size_t intersectPacked(const Ray& ray, const TriangleArrays& triangles, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, triangles.size());
    const TrianglePointers pointers = pointersOf(triangles);
    const ShearedRay sheared(ray);
    return inBlocks(
        triangles.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            certainTriangles(componentsOf(ray.origin), componentsOf(ray.direction), pointers, begin, count,
                             t.data() + begin, doubts);
        },
        [&](std::size_t i) { t[i] = storedT(sheared.intersect(triangles.at(i))); });
}

void intersectMollerTrumborePackedNaive(const RayArrays& rays, const Triangle& triangle, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, rays.size());
    naiveRays(pointersOf(rays), componentsOf(triangle.a), componentsOf(triangle.b - triangle.a),
              componentsOf(triangle.c - triangle.a), 0, rays.size(), t.data());
}

void intersectMollerTrumborePackedNaive(const Ray& ray, const TriangleArrays& triangles, std::span<float> t) {
    QX_CHECK_OP(t.size(), ==, triangles.size());
    naiveTriangles(componentsOf(ray.origin), componentsOf(ray.direction), pointersOf(triangles), 0,
                   triangles.size(), t.data());
}

}  // namespace quincunx

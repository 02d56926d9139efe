// No include guard: a source file includes this once, with QX_KERNEL_TARGET naming the vector units that it
// is for (an attribute, or nothing), and gets `kernels` in an unnamed namespace. Attributes and not the
// compiler's options choose the instructions, so that nothing inline that other files share is compiled for a
// machine that may not be there.

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#if defined(QX_KERNEL_AVX2)
#include <immintrin.h>
#endif

#include "trace/bvh_build.h"
#include "trace/triangle_filter.h"
#include "trace/wide_bvh.h"

// No function with vectors among its parameters is ever called: all are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace quincunx::detail {
namespace {

#define QX_INLINE QX_KERNEL_TARGET inline __attribute__((always_inline))

using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));

// The second one where the first is no number.
#if defined(QX_KERNEL_AVX2)
QX_INLINE Float8 larger8(Float8 a, Float8 b) {
    return _mm256_max_ps(a, b);
}
QX_INLINE Float8 smaller8(Float8 a, Float8 b) {
    return _mm256_min_ps(a, b);
}
/// A bit for each lane.
QX_INLINE unsigned lessOrEqual(Float8 a, Float8 b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}
QX_INLINE unsigned notNegative(Float4 a) {
    return static_cast<unsigned>(_mm_movemask_ps(_mm_cmp_ps(a, _mm_setzero_ps(), _CMP_NLT_UQ)));
}
#else
QX_INLINE Float8 larger8(Float8 a, Float8 b) {
    return a > b ? a : b;
}
QX_INLINE Float8 smaller8(Float8 a, Float8 b) {
    return a < b ? a : b;
}
QX_INLINE unsigned lessOrEqual(Float8 a, Float8 b) {
    unsigned mask = 0;
    for (int i = 0; i < 8; ++i)
        mask |= a[i] <= b[i] ? 1u << i : 0u;
    return mask;
}
QX_INLINE unsigned notNegative(Float4 a) {
    unsigned mask = 0;
    for (int i = 0; i < 4; ++i)
        mask |= a[i] < 0 ? 0u : 1u << i;
    return mask;
}
#endif

template <typename Vector>
QX_INLINE Vector load(const float* from) {
    Vector v;
    __builtin_memcpy(&v, from, sizeof(v));
    return v;
}

/// A ray made ready for nodes: SlabRay's test for eight boxes. Here 0 ≤ tMin, so e ≤ x (1 + 8 ε) is enough.
class NodeRay {
  public:
    QX_INLINE NodeRay(const Ray& ray, float tMin) : tMin_(Float8{} + tMin) {
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = Float8{} + ray.origin[axis];
            inverse_[axis] = Float8{} + 1 / ray.direction[axis];
            const std::size_t toMin =
                offsetof(WideNode, min) + static_cast<std::size_t>(axis) * sizeof(Float8);
            const std::size_t toMax =
                offsetof(WideNode, max) + static_cast<std::size_t>(axis) * sizeof(Float8);
            near_[axis] = std::signbit(ray.direction[axis]) ? toMax : toMin;
            far_[axis] = std::signbit(ray.direction[axis]) ? toMin : toMax;
        }
    }

    /// A bit for each child that the ray may meet up to tMax.
    QX_INLINE unsigned meets(const WideNode& node, Float8 tMax, Float8& enter) const {
        const auto* bytes = reinterpret_cast<const char*>(&node);
        const auto plane = [bytes](std::size_t offset) QX_KERNEL_TARGET __attribute__((always_inline)) {
            return load<Float8>(reinterpret_cast<const float*>(bytes + offset));
        };
        const Float8 inX = (plane(near_[0]) - origin_[0]) * inverse_[0];
        const Float8 inY = (plane(near_[1]) - origin_[1]) * inverse_[1];
        const Float8 inZ = (plane(near_[2]) - origin_[2]) * inverse_[2];
        const Float8 outX = (plane(far_[0]) - origin_[0]) * inverse_[0];
        const Float8 outY = (plane(far_[1]) - origin_[1]) * inverse_[1];
        const Float8 outZ = (plane(far_[2]) - origin_[2]) * inverse_[2];
        enter = larger8(inX, larger8(inY, larger8(inZ, tMin_)));
        const Float8 exit = smaller8(outX, smaller8(outY, smaller8(outZ, tMax)));
        return lessOrEqual(enter, exit * (1 + 0x1p-21f) + 0x1p-100f);
    }

  private:
    Float8 origin_[3];
    Float8 inverse_[3];
    Float8 tMin_;
    std::size_t near_[3];  ///< where the planes that are met first are in a node
    std::size_t far_[3];
};

/// A node or block and where the ray enters it, ordered by that: floats that are not negative are ordered as
/// their bits are.
using StackEntry = std::uint64_t;

QX_INLINE StackEntry stackEntry(float enter, std::uint32_t ref) {
    return static_cast<StackEntry>(std::bit_cast<std::uint32_t>(enter)) << 32 | ref;
}
QX_INLINE float enterOf(StackEntry entry) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32));
}

/// Each level leaves seven siblings at most.
constexpr std::size_t stackSize = 7 * maxBvhDepth + 8;

/// A bit for each triangle of the block that the ray may hit.
QX_INLINE unsigned mayHit(const FilterRay<Float4>& ray, const TriangleBlock& block, unsigned triangles,
                          Float4 tMin, Float4 tMax) {
    const auto corner = [&](std::size_t c) QX_KERNEL_TARGET __attribute__((always_inline)) {
        return Components<Float4>{load<Float4>(block.corners[c][0].data()),
                                  load<Float4>(block.corners[c][1].data()),
                                  load<Float4>(block.corners[c][2].data())};
    };
    const Float4 result = filterTriangle<Float4>(ray, corner(0), corner(1), corner(2),
                                                 load<Float4>(block.size.data()), tMin, tMax);
    return notNegative(result) & ((1u << triangles) - 1);
}

QX_INLINE FilterRay<Float4> inAllLanes(const FilterRay<float>& ray) {
    const auto lanes = [](float a) QX_KERNEL_TARGET __attribute__((always_inline)) {
        return Float4{} + a;
    };
    return {{lanes(ray.origin.x), lanes(ray.origin.y), lanes(ray.origin.z)},
            {lanes(ray.direction.x), lanes(ray.direction.y), lanes(ray.direction.z)},
            lanes(ray.weightScale),
            lanes(ray.detScale)};
}

/// Puts the children in `mask` on the stack, the nearest on top, and takes it off again.
QX_INLINE std::uint32_t nearestChild(const WideNode& node, Float8 enter, unsigned mask, StackEntry*& top) {
    alignas(32) std::array<float, 8> distance;
    __builtin_memcpy(distance.data(), &enter, sizeof(enter));
    const auto take = [&]() QX_KERNEL_TARGET __attribute__((always_inline)) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
        mask &= mask - 1;
        return stackEntry(distance[lane], node.child[lane]);
    };
    const StackEntry first = take();
    const StackEntry second = take();
    StackEntry nearest = first < second ? first : second;
    StackEntry next = first < second ? second : first;
    if (mask == 0) {
        *top++ = next;
        return static_cast<std::uint32_t>(nearest);
    }
    StackEntry* const bottom = top;
    *top++ = next;
    do {
        StackEntry entry = take();
        if (entry < nearest)
            std::swap(entry, nearest);
        StackEntry* place = top++;
        while (place > bottom && place[-1] < entry) {
            *place = place[-1];
            --place;
        }
        *place = entry;
    } while (mask != 0);
    return static_cast<std::uint32_t>(nearest);
}

void count(TraversalCounts* counts, std::uint64_t nodes, std::uint64_t triangles) {
    if (counts)
        *counts += {1, nodes, triangles};
}

/// What float does not suffice for: boxes in double, every triangle exactly. `test(block, i)` says whether to
/// stop, `tMax()` how far to look.
template <typename Test, typename Limit>
void traverseExactly(const WideTree& tree, const Ray& ray, RayInterval interval, const Test& test,
                     const Limit& tMax, TraversalCounts* counts) {
    const SlabRay<double> slabs(ray);
    std::array<std::uint32_t, stackSize> stack;
    std::size_t size = 0;
    stack[size++] = tree.root;
    std::uint64_t nodes = 0;
    std::uint64_t triangles = 0;
    while (size > 0) {
        const std::uint32_t ref = stack[--size];
        if (WideRef::isBlock(ref)) {
            for (std::size_t i = 0; i < WideRef::triangles(ref); ++i) {
                ++triangles;
                if (test(tree.blocks[WideRef::index(ref)], i)) {
                    size = 0;
                    break;
                }
            }
            continue;
        }
        ++nodes;
        const WideNode& node = tree.nodes[WideRef::index(ref)];
        for (std::size_t i = 0; i < WideNode::width; ++i) {
            double enter = 0;
            if (node.min[0][i] <= node.max[0][i] &&
                slabs.meets({node.min[0][i], node.min[1][i], node.min[2][i]},
                            {node.max[0][i], node.max[1][i], node.max[2][i]}, interval.tMin, tMax(), enter))
                stack[size++] = node.child[i];
        }
    }
    count(counts, nodes, triangles);
}

QX_KERNEL_TARGET std::optional<AcceleratorHit> nearest(const WideTree& tree, const Ray& ray,
                                                       RayInterval interval, TraversalCounts* counts) {
    NearestHit nearest(ray, interval);
    const auto usable = filterRay(ray, interval, tree.box);
    if (!usable) {
        traverseExactly(
            tree, ray, interval,
            [&](const TriangleBlock& block, std::size_t i) {
                nearest.test(block.at(i), block.index[i]);
                return false;
            },
            [&] { return nearest.tMax(); }, counts);
        return nearest.hit();
    }
    const NodeRay nodeRay(ray, interval.tMin);
    const FilterRay<Float4> filter = inAllLanes(*usable);
    const Float4 filterMin4 = Float4{} + filterMin(interval.tMin);
    float tMax = interval.tMax;
    std::array<StackEntry, stackSize> stack;
    StackEntry* top = stack.data();
    std::uint64_t nodes = 0;
    std::uint64_t triangles = 0;
    std::uint32_t ref = tree.root;
    for (;;) {
        if (!WideRef::isBlock(ref)) {
            ++nodes;
            const WideNode& node = tree.nodes[ref];
            Float8 enter;
            const unsigned mask = nodeRay.meets(node, Float8{} + tMax, enter);
            if (mask != 0) {
                ref = (mask & (mask - 1)) == 0 ? node.child[static_cast<std::size_t>(std::countr_zero(mask))]
                                               : nearestChild(node, enter, mask, top);
                continue;
            }
        } else {
            const TriangleBlock& block = tree.blocks[WideRef::index(ref)];
            triangles += WideRef::triangles(ref);
            unsigned mask =
                mayHit(filter, block, WideRef::triangles(ref), filterMin4, Float4{} + filterMax(tMax));
            while (mask != 0) {
                const auto i = static_cast<std::size_t>(std::countr_zero(mask));
                mask &= mask - 1;
                nearest.test(block.at(i), block.index[i]);
                tMax = nearest.tMax();
            }
        }
        const float limit = tMax * (1 + 0x1p-20f);  // `enter` is off by 3 ε of itself
        do {
            if (top == stack.data()) {
                count(counts, nodes, triangles);
                return nearest.hit();
            }
            ref = static_cast<std::uint32_t>(*--top);
        } while (enterOf(*top) > limit);
    }
}

QX_KERNEL_TARGET bool occluded(const WideTree& tree, const Ray& ray, RayInterval interval,
                               TraversalCounts* counts) {
    AnyHit any(ray, interval);
    const auto usable = filterRay(ray, interval, tree.box);
    if (!usable) {
        bool found = false;
        traverseExactly(
            tree, ray, interval,
            [&](const TriangleBlock& block, std::size_t i) { return found = any.test(block.at(i)); },
            [&] { return interval.tMax; }, counts);
        return found;
    }
    const NodeRay nodeRay(ray, interval.tMin);
    const FilterRay<Float4> filter = inAllLanes(*usable);
    const Float4 filterMin4 = Float4{} + filterMin(interval.tMin);
    const Float4 filterMax4 = Float4{} + filterMax(interval.tMax);
    const Float8 tMax = Float8{} + interval.tMax;
    std::array<std::uint32_t, stackSize> stack;
    std::uint32_t* top = stack.data();
    std::uint64_t nodes = 0;
    std::uint64_t triangles = 0;
    std::uint32_t ref = tree.root;
    for (;;) {
        if (!WideRef::isBlock(ref)) {
            ++nodes;
            const WideNode& node = tree.nodes[ref];
            Float8 enter;
            unsigned mask = nodeRay.meets(node, tMax, enter);
            if (mask != 0) {
                ref = node.child[static_cast<std::size_t>(std::countr_zero(mask))];
                while ((mask &= mask - 1) != 0)
                    *top++ = node.child[static_cast<std::size_t>(std::countr_zero(mask))];
                continue;
            }
        } else {
            const TriangleBlock& block = tree.blocks[WideRef::index(ref)];
            triangles += WideRef::triangles(ref);
            unsigned mask = mayHit(filter, block, WideRef::triangles(ref), filterMin4, filterMax4);
            for (; mask != 0; mask &= mask - 1)
                if (any.test(block.at(static_cast<std::size_t>(std::countr_zero(mask))))) {
                    count(counts, nodes, triangles);
                    return true;
                }
        }
        if (top == stack.data()) {
            count(counts, nodes, triangles);
            return false;
        }
        ref = *--top;
    }
}

constexpr WideKernels kernels{nearest, occluded};

}  // namespace
}  // namespace quincunx::detail

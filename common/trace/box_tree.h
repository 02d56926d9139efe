#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "geometry/mesh.h"
#include "geometry/ray.h"
#include "geometry/ray_triangle.h"
#include "trace/accelerator.h"
#include "trace/bvh_build.h"
#include "trace/slabs.h"

namespace quincunx {

/// A tree over boxes of anything: instances, solids, lights. It finds the boxes that a ray may meet; what is
/// in them is for the caller to test:
///
///     tree.visit(ray, interval, [&](std::uint32_t item, float tMax) {
///         if (const auto hit = test(item, ray, {interval.tMin, tMax}); hit && closer(hit))
///             tMax = roundedUp(hit->t);  // trace/slabs.h
///         return tMax;
///     });
class BoxTree {
  public:
    BoxTree() = default;
    /// Boxes that are empty or not finite are never visited.
    explicit BoxTree(std::span<const Bounds> boxes)
        : tree_(buildBvh(boxes, {.maxLeafItems = 1, .nodeCost = 0})) {}

    /// Calls `visit(item, tMax)` for every item whose box the ray meets with tMin ≤ t ≤ tMax, and for some
    /// others; nearer boxes come first, more or less. `visit` returns the tMax to go on with: what it was
    /// given or less, and −∞ to stop. It must be above or equal to the t of what was found, so that others at
    /// the same t are still visited. Rays that are not finite visit nothing. Takes no memory.
    /// Of `counts`, only the boxes looked at are counted; the rest is the caller's.
    template <typename Visit>
    void visit(const Ray& ray, RayInterval interval, Visit&& visit, TraversalCounts* counts = nullptr) const {
        if (tree_.nodes.empty() || !isUsable(ray) || !(interval.tMin <= interval.tMax))
            return;
        if (floatIsEnough(ray))
            visitWith<float>(ray, interval, visit, counts);
        else
            visitWith<double>(ray, interval, visit, counts);
    }

    /// Of all items; empty without any.
    Bounds bounds() const {
        return tree_.nodes.empty() ? Bounds{} : Bounds{tree_.nodes[0].min, tree_.nodes[0].max};
    }
    std::size_t memoryBytes() const { return tree_.memoryBytes(); }

  private:
    template <typename Real, typename Visit>
    void visitWith(const Ray& ray, RayInterval interval, Visit& visit, TraversalCounts* counts) const {
        struct Entry {
            std::uint32_t node;
            Real enter;
        };
        const SlabRay<Real> slabs(ray);
        const BvhNode* nodes = tree_.nodes.data();
        const auto tMin = static_cast<Real>(interval.tMin);
        float tMax = interval.tMax;
        std::array<Entry, maxBvhDepth + 1> stack;
        std::size_t size = 0;
        std::uint64_t boxes = 1;
        Real enter;
        if (slabs.meets(nodes[0].min, nodes[0].max, tMin, tMax, enter))
            stack[size++] = {0, enter};
        while (size > 0) {
            const Entry entry = stack[--size];
            // `enter` is off by 3 ε, and the rest covers a tMax that is off as well.
            if (entry.enter - Real(0x1p-20) * std::abs(entry.enter) > tMax)
                continue;
            const BvhNode& node = nodes[entry.node];
            if (node.isLeaf()) {
                for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
                    tMax = visit(tree_.order[i], tMax);
                if (!(tMax >= interval.tMin))
                    break;
                continue;
            }
            boxes += 2;
            Entry left{node.first, 0};
            Entry right{node.first + 1, 0};
            const bool meetsLeft =
                slabs.meets(nodes[left.node].min, nodes[left.node].max, tMin, tMax, left.enter);
            const bool meetsRight =
                slabs.meets(nodes[right.node].min, nodes[right.node].max, tMin, tMax, right.enter);
            if (meetsLeft && meetsRight) {
                const bool leftFirst = left.enter <= right.enter;
                stack[size++] = leftFirst ? right : left;
                stack[size++] = leftFirst ? left : right;
            } else if (meetsLeft || meetsRight) {
                stack[size++] = meetsLeft ? left : right;
            }
        }
        if (counts)
            *counts += {0, boxes, 0};
    }

    BvhTree tree_;
};

}  // namespace quincunx

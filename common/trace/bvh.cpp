#include "trace/bvh.h"

#include <array>

#include "trace/triangle_filter.h"
#include "trace/triangle_items.h"

namespace quincunx {
namespace {

/// Boxes in float where that is enough, or in double.
template <typename Real>
class Traversal {
  public:
    Traversal(const std::vector<BvhNode>& nodes, const Ray& ray, float tMin)
        : nodes_(nodes.data()), slabs_(ray), tMin_(tMin) {}

    /// Calls `visitLeaf(node, tMax)` for each leaf that the ray meets, nearer ones first, more or less; it
    /// returns the tMax to go on with. Returns the number of boxes looked at.
    template <typename VisitLeaf>
    std::uint64_t run(float tMax, const VisitLeaf& visitLeaf) const {
        struct Entry {
            std::uint32_t node;
            Real enter;
        };
        std::array<Entry, maxBvhDepth + 1> stack;
        std::size_t size = 0;
        std::uint64_t boxes = 1;
        Entry entry{0, 0};
        if (!meets(entry.node, tMax, entry.enter))
            return boxes;
        for (;;) {
            const BvhNode& node = nodes_[entry.node];
            if (node.isLeaf()) {
                tMax = visitLeaf(node, tMax);
            } else {
                boxes += 2;
                Entry left{node.first, 0};
                Entry right{node.first + 1, 0};
                const bool meetsLeft = meets(left.node, tMax, left.enter);
                const bool meetsRight = meets(right.node, tMax, right.enter);
                if (meetsLeft && meetsRight) {
                    const bool leftFirst = left.enter <= right.enter;
                    entry = leftFirst ? left : right;
                    stack[size++] = leftFirst ? right : left;
                    continue;
                }
                if (meetsLeft || meetsRight) {
                    entry = meetsLeft ? left : right;
                    continue;
                }
            }
            do {
                if (size == 0)
                    return boxes;
                entry = stack[--size];
            } while (isBeyond(entry.enter, tMax));
        }
    }

  private:
    bool meets(std::uint32_t node, float tMax, Real& enter) const {
        return slabs_.meets(nodes_[node].min, nodes_[node].max, tMin_, static_cast<Real>(tMax), enter);
    }
    /// `enter` is off by 3 ε of itself.
    static bool isBeyond(Real enter, float tMax) {
        return enter - Real(0x1p-20) * std::abs(enter) > static_cast<Real>(tMax);
    }

    const BvhNode* nodes_;
    SlabRay<Real> slabs_;
    Real tMin_;
};

void count(TraversalCounts* counts, std::uint64_t boxes, std::uint64_t triangles) {
    if (counts)
        *counts += {1, boxes, triangles};
}

}  // namespace

BinaryBvh::BinaryBvh(TriangleView triangles) {
    std::vector<detail::BvhItem> items = detail::itemsOf(triangles);
    BvhTree tree = detail::buildBvh(items, {.maxLeafItems = 4, .itemsATest = 1, .nodeCost = 1});
    nodes_ = std::move(tree.nodes);
    triangles_.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i)
        triangles_[i] = {triangles[items[i].index], items[i].index};
}

std::optional<AcceleratorHit> BinaryBvh::nearest(const Ray& ray, RayInterval interval,
                                                 TraversalCounts* counts) const {
    if (nodes_.empty() || !isUsable(ray) || !(interval.tMin <= interval.tMax)) {
        count(counts, 0, 0);
        return std::nullopt;
    }
    detail::NearestHit nearest(ray, interval);
    std::uint64_t tests = 0;
    std::uint64_t boxes = 0;
    const auto filter = detail::filterRay(ray, interval, {nodes_[0].min, nodes_[0].max});
    if (filter) {
        const float tMin = detail::filterMin(interval.tMin);
        boxes =
            Traversal<float>(nodes_, ray, interval.tMin).run(interval.tMax, [&](const BvhNode& leaf, float) {
                tests += leaf.count;
                for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
                    if (detail::mayHit(*filter, triangles_[i].triangle, tMin,
                                       detail::filterMax(nearest.tMax())))
                        nearest.test(triangles_[i].triangle, triangles_[i].index);
                return nearest.tMax();
            });
    } else {
        boxes =
            Traversal<double>(nodes_, ray, interval.tMin).run(interval.tMax, [&](const BvhNode& leaf, float) {
                tests += leaf.count;
                for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
                    nearest.test(triangles_[i].triangle, triangles_[i].index);
                return nearest.tMax();
            });
    }
    count(counts, boxes, tests);
    return nearest.hit();
}

bool BinaryBvh::occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    if (nodes_.empty() || !isUsable(ray) || !(interval.tMin <= interval.tMax)) {
        count(counts, 0, 0);
        return false;
    }
    detail::AnyHit any(ray, interval);
    bool found = false;
    std::uint64_t tests = 0;
    std::uint64_t boxes = 0;
    const auto filter = detail::filterRay(ray, interval, {nodes_[0].min, nodes_[0].max});
    const float tMin = detail::filterMin(interval.tMin);
    const float tMax = detail::filterMax(interval.tMax);
    const auto visitLeaf = [&](const BvhNode& leaf, float limit) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            ++tests;
            if ((!filter || detail::mayHit(*filter, triangles_[i].triangle, tMin, tMax)) &&
                any.test(triangles_[i].triangle)) {
                found = true;
                return -std::numeric_limits<float>::infinity();  // ends it: nothing is nearer
            }
        }
        return limit;
    };
    boxes = filter ? Traversal<float>(nodes_, ray, interval.tMin).run(interval.tMax, visitLeaf)
                   : Traversal<double>(nodes_, ray, interval.tMin).run(interval.tMax, visitLeaf);
    count(counts, boxes, tests);
    return found;
}

std::size_t BinaryBvh::memoryBytes() const {
    return nodes_.capacity() * sizeof(BvhNode) + triangles_.capacity() * sizeof(LeafTriangle);
}

}  // namespace quincunx

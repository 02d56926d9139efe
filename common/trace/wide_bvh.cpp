#include "trace/wide_bvh.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "trace/bvh_build.h"
#include "trace/slabs.h"
#include "trace/triangle_filter.h"
#include "trace/triangle_items.h"
#include "trace/wide_bvh_units.h"

namespace quincunx {
namespace detail {

const WideKernels& wideKernels() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi"))
        return wideKernelsAvx2;
#endif
    return wideKernelsAny;
}

namespace {

float halfArea(const BvhNode& node) {
    // In quarters, so that the sizes of finite boxes are finite; their products may be infinite.
    const glm::vec3 size = 0.25f * node.max - 0.25f * node.min;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Turns a binary tree into a wide one.
class Collapse {
  public:
    Collapse(const BvhTree& from, TriangleView triangles, WideTree& to)
        : from_(from), triangles_(triangles), to_(to) {
        std::size_t leaves = 0;
        for (const BvhNode& node : from.nodes)
            leaves += node.isLeaf() ? 1 : 0;
        QX_CHECK_LT(leaves, std::size_t{WideRef::largest});
        to.blocks.reserve(leaves);
        to.root = ref(from.nodes[0]);
        to.nodes.shrink_to_fit();
    }

  private:
    std::uint32_t ref(const BvhNode& node) {
        if (node.isLeaf())
            return block(node);
        std::array<const BvhNode*, WideNode::width> children = {&from_.nodes[node.first],
                                                                &from_.nodes[node.first + 1]};
        std::size_t count = 2;
        while (count < WideNode::width) {
            std::size_t largest = WideNode::width;
            float area = -1;
            for (std::size_t i = 0; i < count; ++i)
                if (!children[i]->isLeaf() && halfArea(*children[i]) > area) {
                    largest = i;
                    area = halfArea(*children[i]);
                }
            if (largest == WideNode::width)
                break;
            const std::uint32_t first = children[largest]->first;
            children[largest] = &from_.nodes[first];
            children[count++] = &from_.nodes[first + 1];
        }
        const std::size_t index = to_.nodes.size();
        to_.nodes.emplace_back();
        for (std::size_t i = 0; i < WideNode::width; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<std::size_t>(axis);
                const bool there = i < count;
                to_.nodes[index].min[a][i] =
                    there ? children[i]->min[axis] : std::numeric_limits<float>::infinity();
                to_.nodes[index].max[a][i] =
                    there ? children[i]->max[axis] : -std::numeric_limits<float>::infinity();
            }
        for (std::size_t i = 0; i < WideNode::width; ++i) {
            const std::uint32_t child = i < count ? ref(*children[i]) : 0;
            to_.nodes[index].child[i] = child;
        }
        return WideRef::node(index);
    }

    std::uint32_t block(const BvhNode& leaf) {
        TriangleBlock block{};
        for (std::size_t i = 0; i < leaf.count; ++i) {
            const std::uint32_t index = from_.order[leaf.first + i];
            const Triangle triangle = triangles_[index];
            const std::array<glm::vec3, 3> corners = {triangle.a, triangle.b, triangle.c};
            for (std::size_t c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis)
                    block.corners[c][static_cast<std::size_t>(axis)][i] = corners[c][axis];
            block.size[i] = filterSize(triangle);
            block.index[i] = index;
        }
        to_.blocks.push_back(block);
        return WideRef::block(to_.blocks.size() - 1, leaf.count);
    }

    const BvhTree& from_;
    TriangleView triangles_;
    WideTree& to_;
};

}  // namespace
}  // namespace detail

WideBvh::WideBvh(TriangleView triangles) : kernels_(&detail::wideKernels()) {
    std::vector<detail::BvhItem> items = detail::itemsOf(triangles);
    if (items.empty())
        return;
    const BvhTree tree = detail::buildBvh(items, {.maxLeafItems = detail::TriangleBlock::width,
                                                  .itemsATest = detail::TriangleBlock::width,
                                                  .nodeCost = 0.5f});
    tree_.box = {tree.nodes[0].min, tree.nodes[0].max};
    detail::Collapse(tree, triangles, tree_);
}

std::optional<AcceleratorHit> WideBvh::nearest(const Ray& ray, RayInterval interval,
                                               TraversalCounts* counts) const {
    if (tree_.blocks.empty() || !isUsable(ray) || !(interval.tMin <= interval.tMax)) {
        if (counts)
            ++counts->rays;
        return std::nullopt;
    }
    return kernels_->nearest(tree_, ray, interval, counts);
}

bool WideBvh::occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    if (tree_.blocks.empty() || !isUsable(ray) || !(interval.tMin <= interval.tMax)) {
        if (counts)
            ++counts->rays;
        return false;
    }
    return kernels_->occluded(tree_, ray, interval, counts);
}

std::size_t WideBvh::memoryBytes() const {
    return tree_.nodes.capacity() * sizeof(detail::WideNode) +
           tree_.blocks.capacity() * sizeof(detail::TriangleBlock);
}

}  // namespace quincunx

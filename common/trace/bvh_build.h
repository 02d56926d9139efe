#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"

/// The binary tree of boxes that all bounding volume hierarchies here start from.
namespace quincunx {

/// A box, and either two children that follow one another or a row of items.
struct BvhNode {
    glm::vec3 min{0};
    std::uint32_t first = 0;  ///< a leaf's first entry in BvhTree::order; the first child
    glm::vec3 max{0};
    std::uint32_t count = 0;  ///< of a leaf's items; 0 says that this is no leaf

    bool isLeaf() const { return count != 0; }
};

struct BvhTree {
    std::vector<BvhNode> nodes;        ///< the root first, children after their parents; empty without items
    std::vector<std::uint32_t> order;  ///< items, those of a leaf side by side

    std::size_t memoryBytes() const {
        return nodes.capacity() * sizeof(BvhNode) + order.capacity() * sizeof(std::uint32_t);
    }
};

struct BvhBuildParams {
    std::uint32_t maxLeafItems = 4;  ///< ≥ 1
    std::uint32_t itemsATest = 1;    ///< so many items of a leaf are tested at once
    float nodeCost = 1;              ///< of the step to two children, in tests of items
};

/// No leaf lies deeper below the root: 40 levels are cut where the surface area heuristic says, and at most
/// 32 more at the median, which halve any number of items down to one.
inline constexpr int maxBvhDepth = 72;

/// Cuts where the surface area heuristic expects the least work (Goldsmith, Salmon 1987; MacDonald, Booth
/// 1990), tried at the borders of up to 16 bins an axis (Wald, "On fast construction of SAH-based bounding
/// volume hierarchies", 2007). Items whose centres coincide are halved by their number.
/// Items whose box is empty or not finite are left out. Boxes may have any finite size. On all cores; the
/// tree is the same for any number of them. Throws nothing but for memory; at most 2^32 − 1 items.
BvhTree buildBvh(std::span<const Bounds> boxes, const BvhBuildParams& params = {});

}  // namespace quincunx

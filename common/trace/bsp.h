#pragma once

#include <cstdint>
#include <vector>

#include "trace/accelerator.h"

namespace quincunx {

/// An axis-aligned BSP tree, or kd-tree: cells are cut in two by planes, a triangle is in every leaf that it
/// reaches into, and the leaves are visited in the order of the ray (Jansen 1986; Havran 2000, chapter 4).
///
/// Cut is the middle of what the cell's triangles take of it, across the longest side on which that leaves
/// one of the halves with fewer of them. The textbook's recursion, middle of the cell until there are few
/// triangles or the tree is deep, never ends by itself where triangles coincide, lie in the plane or span the
/// cell; this one ends there at once. Triangles have at most 8 entries each, taken together.
///
/// With u = 2^-53, where the ray meets a plane is off by 3 u of itself; both halves are visited within 2^-48
/// of it, and what touches a plane is in both.
/// Held by Accelerators.* and Bsp.*.
class Bsp : public Accelerator {
  public:
    explicit Bsp(TriangleView triangles);

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval = {},
                                          TraversalCounts* counts = nullptr) const override;
    bool occluded(const Ray& ray, RayInterval interval = {},
                  TraversalCounts* counts = nullptr) const override;
    std::size_t memoryBytes() const override;

    /// Of the deepest leaf; 0 where the root is one.
    int depth() const { return depth_; }
    /// No deeper than that.
    static constexpr int maxDepth = 64;

  private:
    struct Node {
        std::uint32_t first = 0;  ///< of a leaf's entries; the first of two children
        std::uint32_t count = 0;  ///< of a leaf's entries
        float plane = 0;
        int axis = -1;  ///< −1 of a leaf
    };
    struct Clipped;
    void build(std::vector<Clipped> triangles, std::size_t node, std::size_t budget, int depth);
    template <typename Test>
    void search(const Ray& ray, RayInterval interval, TraversalCounts* counts, const Test& test) const;

    TriangleView triangles_;
    Bounds box_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> entries_;
    int depth_ = 0;
};

}  // namespace quincunx

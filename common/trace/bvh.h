#pragma once

#include <cstdint>
#include <vector>

#include "trace/accelerator.h"
#include "trace/bvh_build.h"

namespace quincunx {

/// A binary bounding volume hierarchy over triangles, the one to read first: buildBvh makes the tree, and a
/// ray goes down it, the nearer child first, the other one kept on a stack for later.
/// wide_bvh.h is the same with eight children a node, for vector units.
///
/// Held by Accelerators.*; takes about 70 bytes a triangle.
class BinaryBvh : public Accelerator {
  public:
    explicit BinaryBvh(TriangleView triangles);

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval = {},
                                          TraversalCounts* counts = nullptr) const override;
    bool occluded(const Ray& ray, RayInterval interval = {},
                  TraversalCounts* counts = nullptr) const override;
    std::size_t memoryBytes() const override;

    const std::vector<BvhNode>& nodes() const { return nodes_; }

  private:
    struct LeafTriangle {
        Triangle triangle;
        std::uint32_t index = 0;  ///< in the TriangleView
    };

    std::vector<BvhNode> nodes_;  ///< leaves count `triangles_`
    std::vector<LeafTriangle> triangles_;
};

}  // namespace quincunx

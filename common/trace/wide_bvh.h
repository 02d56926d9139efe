#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trace/accelerator.h"

namespace quincunx {

namespace detail {

/// Eight boxes and what is in them. Boxes that are not there have min = ∞, max = −∞.
struct alignas(32) WideNode {
    static constexpr std::size_t width = 8;
    std::array<std::array<float, width>, 3> min;
    std::array<std::array<float, width>, 3> max;
    std::array<std::uint32_t, width> child;  ///< WideRef
};

/// Up to four triangles; what is not there is 0.
struct alignas(16) TriangleBlock {
    static constexpr std::size_t width = 4;
    std::array<std::array<std::array<float, width>, 3>, 3> corners;  ///< [corner][axis][triangle]
    std::array<float, width> size;                                   ///< filterSize
    std::array<std::uint32_t, width> index;                          ///< in the TriangleView

    Triangle at(std::size_t i) const {
        const auto corner = [&](std::size_t c) {
            return glm::vec3(corners[c][0][i], corners[c][1][i], corners[c][2][i]);
        };
        return {corner(0), corner(1), corner(2)};
    }
};

/// A node, or a block with the number of its triangles, in 32 bits.
class WideRef {
  public:
    static std::uint32_t node(std::size_t index) { return static_cast<std::uint32_t>(index); }
    static std::uint32_t block(std::size_t index, std::size_t triangles) {
        return leafBit | static_cast<std::uint32_t>(triangles - 1) << 29 | static_cast<std::uint32_t>(index);
    }
    static bool isBlock(std::uint32_t ref) { return (ref & leafBit) != 0; }
    static std::uint32_t index(std::uint32_t ref) { return ref & (largest - 1); }
    static std::uint32_t triangles(std::uint32_t ref) { return (ref >> 29 & 3) + 1; }

    static constexpr std::uint32_t leafBit = 0x80000000u;
    static constexpr std::uint32_t largest = 1u << 29;  ///< more than any index
};

struct WideTree {
    std::vector<WideNode> nodes;
    std::vector<TriangleBlock> blocks;
    std::uint32_t root = 0;  ///< WideRef
    Bounds box;              ///< of all triangles; empty without any
};

/// The traversals, compiled for a kind of vector units.
struct WideKernels {
    std::optional<AcceleratorHit> (*nearest)(const WideTree&, const Ray&, RayInterval, TraversalCounts*);
    bool (*occluded)(const WideTree&, const Ray&, RayInterval, TraversalCounts*);
};

}  // namespace detail

/// A bounding volume hierarchy with eight children a node and up to four triangles a leaf, so that a vector
/// unit does eight boxes or four triangles at a time (Dammertz, Hanika, Keller, "Shallow bounding volume
/// hierarchies for fast SIMD ray tracing of incoherent rays", EGSR 2008; Wald, Benthin, Boulos, "Getting rid
/// of packets", 2008). Made by lifting the descendants of largest area out of buildBvh's tree into their
/// grandparents.
///
/// Held by Accelerators.*; the figures are bench_accelerators'.
class WideBvh : public Accelerator {
  public:
    explicit WideBvh(TriangleView triangles);

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval = {},
                                          TraversalCounts* counts = nullptr) const override;
    bool occluded(const Ray& ray, RayInterval interval = {},
                  TraversalCounts* counts = nullptr) const override;
    std::size_t memoryBytes() const override;

  private:
    detail::WideTree tree_;
    const detail::WideKernels* kernels_;
};

}  // namespace quincunx

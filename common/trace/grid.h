#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "trace/accelerator.h"

namespace quincunx {

/// How a ray is kept from testing a triangle again that lies in several of the cells it passes. A mailbox a
/// triangle that holds the last ray's number, as the textbook has it (Amanatides, Woo, "A fast voxel
/// traversal algorithm for ray tracing", 1987), is written by every ray, and so wrong as soon as two threads
/// share it.
enum class Mailboxes {
    none,
    ofRay,  ///< the last 64 triangles or so, kept on the ray's own stack (Shevtsov, Soupikov, Kapustin 2007)
    ofThread  ///< a mailbox a triangle for every thread: no triangle twice, four bytes a triangle and thread
};

struct GridParams {
    double cellsPerTriangle = 4;
    Mailboxes mailboxes = Mailboxes::ofRay;
};

/// Cells of one size, each with the triangles whose boxes reach into it, walked in the order of the ray.
///
/// Where the ray leaves a cell is computed in double from the cell's number, not summed up step by step, so
/// errors do not grow. With u = 2^-53, no coordinate on the way is off by more than 8 u of the distance from
/// the origin to the far end of the grid. Rays that start up to 2^30 sizes of the grid away are walked, and
/// there are up to 2^10 cells an axis, so that is less than 2^-10 cells. Triangles are entered 2^-8 cells
/// around themselves, so they are found even where the walk takes the wrong one of two neighbours. Rays from
/// farther away test every triangle.
/// Held by Accelerators.* and Grid.*.
class Grid : public Accelerator {
  public:
    explicit Grid(TriangleView triangles, const GridParams& params = {});

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval = {},
                                          TraversalCounts* counts = nullptr) const override;
    bool occluded(const Ray& ray, RayInterval interval = {},
                  TraversalCounts* counts = nullptr) const override;
    std::size_t memoryBytes() const override;

    /// Cells along each axis.
    glm::ivec3 resolution() const { return resolution_; }
    /// The corner of cell (0, 0, 0), and the size of each.
    glm::dvec3 origin() const { return origin_; }
    glm::dvec3 cellSize() const { return cellSize_; }
    /// The cells that the ray passes, in order, for pictures and tests.
    std::vector<glm::ivec3> cellsAlong(const Ray& ray) const;

  private:
    struct CellRange {
        glm::ivec3 low{0};
        glm::ivec3 high{0};
    };
    void chooseResolution(std::size_t triangles, double cellsPerTriangle);
    CellRange cellsOf(const Bounds& box) const;
    std::size_t cellIndex(glm::ivec3 cell) const;
    template <typename VisitCell>
    bool walk(const Ray& ray, RayInterval interval, const VisitCell& visit) const;
    template <typename Test>
    void search(const Ray& ray, RayInterval interval, TraversalCounts* counts, const Test& test) const;

    TriangleView triangles_;
    Mailboxes mailboxes_;
    Bounds box_;  ///< of all triangles
    glm::dvec3 origin_{0};
    glm::dvec3 cellSize_{1};
    glm::ivec3 resolution_{0};
    std::vector<std::uint32_t> firstOfCell_;  ///< into `entries_`, one more than there are cells
    std::vector<std::uint32_t> entries_;      ///< triangles
};

}  // namespace quincunx

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "trace/accelerator.h"

namespace quincunx {

/// A ray's number, written on every triangle that was tested against it: one array a thread.
struct Mailboxes {
    std::vector<std::uint32_t> lastRay;  ///< by triangle; 0: none yet
    std::uint32_t ray = 0;               ///< the number given out last
};

/// Triangles in the cells of a regular grid, in every cell that they overlap: so a ray may find the same one
/// several times, and a mailbox spares it all tests but the first (Arnaldi, Priol, Bouatouch 1987; Amanatides
/// and Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987). Nearest hits are those of
/// every Accelerator, bit for bit. Read by any number of threads, each with its own mailboxes.
class MailboxGrid {
  public:
    /// About `density` cells a triangle, up to 128 a side. The triangles must outlive the grid.
    explicit MailboxGrid(TriangleView triangles, float density = 4);

    Mailboxes mailboxes() const { return {std::vector<std::uint32_t>(triangles_.size(), 0), 0}; }

    /// A ray on its way, a cell at a time, so that two of them can be interleaved as threads would.
    class Walk {
      public:
        /// Without mailboxes every triangle of every cell is tested. Shared ones are numbered through.
        Walk(const MailboxGrid& grid, const Ray& ray, Mailboxes* mailboxes);
        /// Looks through one cell; false where there is no more to see.
        bool step();
        const std::optional<AcceleratorHit>& hit() const { return hit_; }
        const TraversalCounts& counts() const { return counts_; }

      private:
        const MailboxGrid& grid_;
        const Ray ray_;
        ShearedRay sheared_;
        Mailboxes* mailboxes_;
        std::uint32_t number_ = 0;
        bool inside_ = false;
        glm::ivec3 cell_{0};
        glm::dvec3 next_{0};  ///< t at which the ray leaves the cell, by axis
        glm::dvec3 step_{0};  ///< t that it takes to cross a cell
        glm::ivec3 way_{0};
        std::optional<AcceleratorHit> hit_;
        TraversalCounts counts_;
    };

    std::optional<AcceleratorHit> nearest(const Ray& ray, Mailboxes* mailboxes,
                                          TraversalCounts& counts) const;
    /// Triangles in cells, each as often as it is in one, over triangles.
    double copies() const;

  private:
    std::size_t indexOf(glm::ivec3 cell) const {
        return static_cast<std::size_t>(cell.x) +
               static_cast<std::size_t>(size_.x) *
                   (static_cast<std::size_t>(cell.y) +
                    static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(cell.z));
    }

    TriangleView triangles_;
    glm::dvec3 min_{0};
    glm::dvec3 max_{0};
    glm::dvec3 cellSize_{1};
    glm::ivec3 size_{1};
    std::vector<std::uint32_t> first_;  ///< by cell, and one more: into contents_
    std::vector<std::uint32_t> contents_;
};

}  // namespace quincunx

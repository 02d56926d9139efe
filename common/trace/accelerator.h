#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"
#include "geometry/ray_triangle.h"

/// Structures that find where rays meet triangles.
///
/// All of them give the same answers, bit for bit: hit or miss is decided exactly (intersectTriangle), so
/// triangles that share an edge or a corner leave no gap; the hit is the one of the smallest t, and of equal
/// t the triangle of the lowest index. A structure is built once and then only read, by any number of
/// threads.
namespace quincunx {

/// Triangles in one frame, three indices each. What it views must outlive whatever is built of it.
struct TriangleView {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;

    std::size_t size() const { return indices.size() / 3; }
    Triangle operator[](std::size_t index) const {
        return {positions[indices[3 * index]], positions[indices[3 * index + 1]],
                positions[indices[3 * index + 2]]};
    }
};

/// Where a ray meets a triangle of a TriangleView.
struct AcceleratorHit {
    double t = 0;                ///< as TriangleHit::t of intersectTriangle
    glm::vec3 weights{1, 0, 0};  ///< barycentric, as TriangleHit::weights
    std::uint32_t triangle = 0;
    bool front = true;
};

/// What finding hits took; the same on every machine for the same rays and structure.
struct TraversalCounts {
    std::uint64_t rays = 0;
    std::uint64_t nodes = 0;      ///< boxes, cells or split planes looked at
    std::uint64_t triangles = 0;  ///< rays tested against triangles

    TraversalCounts& operator+=(const TraversalCounts& other) {
        rays += other.rays;
        nodes += other.nodes;
        triangles += other.triangles;
        return *this;
    }
};

class Accelerator {
  public:
    virtual ~Accelerator() = default;

    /// The nearest hit in the interval, from either side.
    virtual std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval = {},
                                                  TraversalCounts* counts = nullptr) const = 0;
    /// Whether there is any hit in the interval.
    virtual bool occluded(const Ray& ray, RayInterval interval = {},
                          TraversalCounts* counts = nullptr) const = 0;
    /// `nearest` of each ray, all with the same interval; spans of one length. Faster where rays that follow
    /// one another are alike.
    virtual void nearestOfEach(std::span<const Ray> rays, RayInterval interval,
                               std::span<std::optional<AcceleratorHit>> hits,
                               TraversalCounts* counts = nullptr) const;

    /// What it takes beside the triangles that it views.
    virtual std::size_t memoryBytes() const = 0;
};

enum class Structure { bruteForce, grid, bsp, binaryBvh, wideBvh, embree };
inline constexpr Structure allStructures[] = {Structure::bruteForce, Structure::grid,    Structure::bsp,
                                              Structure::binaryBvh,  Structure::wideBvh, Structure::embree};

/// "brute-force", "grid", "bsp", "binary-bvh", "wide-bvh", "embree".
std::string_view structureName(Structure structure);
/// All but Embree always are; that one where its library is installed.
bool isAvailable(Structure structure);
/// The same for any number of cores; the hierarchies are built on all of them. Throws where `structure` is
/// not available.
std::unique_ptr<Accelerator> makeAccelerator(Structure structure, TriangleView triangles);

}  // namespace quincunx

#include "trace/accelerator.h"

#include "base/check.h"
#include "base/error.h"
#include "trace/bvh.h"
#include "trace/wide_bvh.h"

namespace quincunx {
namespace {

/// Every ray against every triangle: what the others are held against.
class BruteForce : public Accelerator {
  public:
    explicit BruteForce(TriangleView triangles) : triangles_(triangles) {}

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval,
                                          TraversalCounts* counts) const override {
        const ShearedRay sheared(ray);
        std::optional<AcceleratorHit> best;
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            if (const auto hit = sheared.intersect(triangles_[i], Sides::both, interval);
                hit && (!best || hit->t < best->t))
                best = AcceleratorHit{hit->t, hit->weights, static_cast<std::uint32_t>(i), hit->front};
        count(counts, triangles_.size());
        return best;
    }

    bool occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const override {
        const ShearedRay sheared(ray);
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            if (sheared.intersect(triangles_[i], Sides::both, interval)) {
                count(counts, i + 1);
                return true;
            }
        count(counts, triangles_.size());
        return false;
    }

    std::size_t memoryBytes() const override { return 0; }

  private:
    static void count(TraversalCounts* counts, std::size_t triangles) {
        if (counts)
            *counts += {1, 0, triangles};
    }

    TriangleView triangles_;
};

}  // namespace

void Accelerator::nearestOfEach(std::span<const Ray> rays, RayInterval interval,
                                std::span<std::optional<AcceleratorHit>> hits,
                                TraversalCounts* counts) const {
    QX_CHECK_EQ(rays.size(), hits.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
        hits[i] = nearest(rays[i], interval, counts);
}

std::string_view structureName(Structure structure) {
    switch (structure) {
        case Structure::bruteForce:
            return "brute-force";
        case Structure::grid:
            return "grid";
        case Structure::bsp:
            return "bsp";
        case Structure::binaryBvh:
            return "binary-bvh";
        case Structure::wideBvh:
            return "wide-bvh";
        case Structure::embree:
            return "embree";
    }
    return "";
}

bool isAvailable(Structure structure) {
    return structure == Structure::bruteForce || structure == Structure::binaryBvh ||
           structure == Structure::wideBvh;
}

std::unique_ptr<Accelerator> makeAccelerator(Structure structure, TriangleView triangles) {
    if (!isAvailable(structure))
        throw EnvironmentError("the structure " + std::string(structureName(structure)) + " is not installed",
                               {}, "choose another one");
    switch (structure) {
        case Structure::binaryBvh:
            return std::make_unique<BinaryBvh>(triangles);
        case Structure::wideBvh:
            return std::make_unique<WideBvh>(triangles);
        default:
            return std::make_unique<BruteForce>(triangles);
    }
}

}  // namespace quincunx

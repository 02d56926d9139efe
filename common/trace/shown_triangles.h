#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "trace/triangle_filter.h"

/// Hits of structures that show a ray triangle after triangle. No part of the interface.
namespace quincunx::detail {

/// The nearest hit. `search(test)` shows `test(triangle index)` what the ray may meet; that returns the t up
/// to which to look on. `box` is that of all triangles.
template <typename Search>
std::optional<AcceleratorHit> nearestShown(const TriangleView& triangles, const Bounds& box, const Ray& ray,
                                           RayInterval interval, const Search& search) {
    NearestHit nearest(ray, interval);
    const auto filter = filterRay(ray, interval, box);
    const float tMin = filterMin(interval.tMin);
    double limit = std::numeric_limits<double>::infinity();
    search([&](std::uint32_t i) {
        const Triangle triangle = triangles[i];
        if (filter && !mayHit(*filter, triangle, tMin, filterMax(nearest.tMax())))
            return limit;
        nearest.test(triangle, i);
        if (nearest.hit())  // t is off by 2^-34 of itself
            limit = nearest.hit()->t + 0x1p-33 * std::abs(nearest.hit()->t);
        return limit;
    });
    return nearest.hit();
}

/// Whether there is any hit; `test` returns minus infinity once there is nothing more to find out.
template <typename Search>
bool anyShown(const TriangleView& triangles, const Bounds& box, const Ray& ray, RayInterval interval,
              const Search& search) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    AnyHit any(ray, interval);
    const auto filter = filterRay(ray, interval, box);
    const float tMin = filterMin(interval.tMin);
    const float tMax = filterMax(interval.tMax);
    bool found = false;
    search([&](std::uint32_t i) {
        const Triangle triangle = triangles[i];
        found = (!filter || mayHit(*filter, triangle, tMin, tMax)) && any.test(triangle);
        return found ? -infinity : infinity;
    });
    return found;
}

}  // namespace quincunx::detail

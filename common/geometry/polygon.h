#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace quincunx {

/// Cuts a simple polygon of n ≥ 3 corners into n - 2 triangles, written to `triangles` (3(n - 2) entries,
/// indices into `corners`) with the polygon's own orientation. Quadrilaterals are cut along the shorter
/// diagonal that lies inside; convex polygons as a fan; others by clipping ears in the plane of Newell's
/// normal (Meisters, "Polygons have ears", 1975). Work is bounded by a multiple of n: what is left of a
/// polygon that crosses itself, has no area, or needs more, is cut as a fan. Returns false in that case.
bool triangulatePolygon(std::span<const glm::vec3> corners, std::span<std::uint32_t> triangles);

}  // namespace quincunx

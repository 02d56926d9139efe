#pragma once

#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What hits and insides rest on: orientations, points in polygons, rays against triangles, polygons and
/// quadrilaterals. The oracle is ExactSum.
std::span<const HardCase> triangleHardCases();

}  // namespace quincunx

#pragma once

#include <vector>

#include "trace/accelerator.h"
#include "trace/bvh_items.h"

namespace quincunx::detail {

/// Boxes of the triangles whose corners are finite, by index. Indices must be of positions.
std::vector<BvhItem> itemsOf(TriangleView triangles);

}  // namespace quincunx::detail

#pragma once

#include "trace/accelerator.h"
#include "trace/bvh_items.h"
#include "trace/huge_pages.h"

namespace quincunx::detail {

/// Boxes of the triangles whose corners are finite, by index. Indices must be of positions.
HugeVector<BvhItem> itemsOf(TriangleView triangles);

}  // namespace quincunx::detail

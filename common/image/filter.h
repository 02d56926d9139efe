#pragma once

#include "image/image.h"

namespace quincunx {

/// The mean of each factor × factor square of pixels (a box filter), of linear light. Sides must be multiples
/// of `factor` ≥ 1. Sums run in double, row by row, so the result does not depend on threads.
Image boxDownsample(const Image& fine, int factor);

}  // namespace quincunx

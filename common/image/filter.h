#pragma once

#include "image/image.h"

namespace quincunx {

/// The mean of each factor × factor square of pixels (a box filter), of linear light. Sides must be multiples
/// of `factor` ≥ 1. Sums run in double, row by row, so the result does not depend on threads.
Image boxDownsample(const Image& fine, int factor);

/// The image under a Gaussian of standard deviation `sigmaPixels` > 0, in double, out to six deviations (what
/// is left out is 2e-9 of the weight); beyond its edges the image goes on as at them. Held by GaussianBlur.*.
Image gaussianBlur(const Image& image, double sigmaPixels);

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// Rays against spheres, cylinders, planes and boxes; which of two shapes overlap; quadratic equations; what
/// a frustum shows. Errors are ulps of t as a float, and a wrong hit or miss is a failure.
std::span<const HardCase> intersectionHardCases();

}  // namespace quincunx

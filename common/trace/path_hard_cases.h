#pragma once

#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// Rays that leave surfaces, means of many samples, lights that are not numbers.
std::span<const HardCase> pathHardCases();

}  // namespace quincunx

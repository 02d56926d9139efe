#pragma once

#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What finds the triangles that rays meet: boxes, cells, planes, and all structures on scenes that are hard
/// for them. The oracle is every triangle, one by one, decided exactly.
std::span<const HardCase> acceleratorHardCases();

}  // namespace quincunx

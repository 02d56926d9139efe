#pragma once

#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What a texture unit must survive: coordinates, derivatives, levels, weights, chains.
std::span<const HardCase> textureHardCases();

}  // namespace quincunx

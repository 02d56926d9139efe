#pragma once

#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// Fresnel's shares and refraction.
std::span<const HardCase> boundaryHardCases();
/// GGX and Smith's shadowing.
std::span<const HardCase> microfacetHardCases();
/// Numbers, points and directions drawn; what arrives from small lights; the end of paths.
std::span<const HardCase> samplingHardCases();

}  // namespace quincunx

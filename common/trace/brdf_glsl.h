#pragma once

#include <glm/glm.hpp>

#include "trace/phong_glsl.h"

/// shaders/lib/brdf.glsl as C++: what the shaders compute, on the CPU, in float.
#define QUINCUNX_INLINE inline
namespace quincunx::glsl {

#include "shaders/lib/brdf.glsl"

}  // namespace quincunx::glsl
#undef QUINCUNX_INLINE

#pragma once

#include <glm/glm.hpp>

/// shaders/lib/motion.glsl as C++: what the shaders compute, on the CPU, in float.
#define QUINCUNX_INLINE inline
namespace quincunx::glsl {

using namespace glm;

#include "shaders/lib/motion.glsl"

}  // namespace quincunx::glsl
#undef QUINCUNX_INLINE

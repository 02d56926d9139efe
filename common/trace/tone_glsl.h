#pragma once

#include <glm/glm.hpp>

/// shaders/lib/tone.glsl as C++: what the shaders compute, on the CPU, in float.
#define QUINCUNX_INLINE inline
namespace quincunx::glsl {

using namespace glm;

#include "shaders/lib/tone.glsl"

}  // namespace quincunx::glsl
#undef QUINCUNX_INLINE

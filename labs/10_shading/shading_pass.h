#pragma once

#include "passes/forward.h"

namespace quincunx {

/// Where the light is evaluated: once a triangle, once a vertex, once a fragment.
enum class ShadingModel { flat, gouraud, phong };

/// The vertex layout that a shading model reads.
SceneBuffers::Layout layoutFor(ShadingModel shading);

/// Its shaders, with Blinn's or Phong's highlight.
gl::ProgramFiles shadingProgram(ShadingModel shading, bool blinnPhong);

}  // namespace quincunx

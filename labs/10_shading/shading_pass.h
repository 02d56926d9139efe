#pragma once

#include <vector>

#include "gl/executor.h"
#include "passes/scene_buffers.h"

namespace quincunx {

/// Where the light is evaluated: once a triangle, once a vertex, once a fragment.
enum class ShadingModel { flat, gouraud, phong };

struct ShadingPassParams {
    ShadingModel shading = ShadingModel::phong;
    bool blinnPhong = true;         ///< else Phong's mirrored light
    std::vector<bool> doubleSided;  ///< by instance: the back is lit as well, with the opposite normal
    std::vector<bool> mirrored;     ///< by instance: its placement turns counter-clockwise into clockwise
};

/// The vertex layout that a shading model reads.
SceneBuffers::Layout layoutFor(ShadingModel shading);

/// Draws the background and every instance of `buffers`, whose blocks are up to date, into the bound target,
/// whose depth is clear. Culls the backs of what is not double-sided. Leaves depth test and culling off.
void drawShaded(graph::PassContext& context, const SceneBuffers& buffers, const ShadingPassParams& params);

}  // namespace quincunx

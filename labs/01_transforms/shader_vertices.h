#pragma once

#include <vector>

#include "lab/studio.h"
#include "labs/01_transforms/lab.h"

namespace quincunx {

/// What the vertex shader of the forward pass made of the boat's vertices, three a triangle, caught by
/// transform feedback, with the knobs `precision` and `world-offset` at work; and P · V · M · vertex in
/// double, in a world without offset, which must be the same.
struct ShaderVertices {
    std::vector<glm::vec4> clip;
    std::vector<glm::dvec4> exactClip;
};
ShaderVertices shaderVertices(Studio& studio, const TransformsLab& lab, const Frame& frame);

}  // namespace quincunx

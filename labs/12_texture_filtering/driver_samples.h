#pragma once

#include <span>
#include <vector>

#include "gl/executor.h"
#include "image/texture_unit.h"

namespace quincunx {

/// The driver's samples of a texture at points, by GLSL's textureGrad.
std::vector<glm::vec4> driverSamples(gl::Executor& executor, const gl::Texture2D& texture,
                                     const gl::Sampler::Params& sampler,
                                     std::span<const TexturePoint> points);
/// … by textureLod, whose level is `levels[i]`.
std::vector<glm::vec4> driverSamplesLod(gl::Executor& executor, const gl::Texture2D& texture,
                                        const gl::Sampler::Params& sampler,
                                        std::span<const TexturePoint> points, std::span<const float> levels);

}  // namespace quincunx

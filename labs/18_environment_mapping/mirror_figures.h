#pragma once

#include <cstddef>
#include <vector>

#include "image/image.h"

namespace quincunx {

/// A drawn picture held against the traced one, over the pixels of one mirror.
struct MirrorFigures {
    std::size_t pixels = 0;
    double meanError = 0;  ///< of the absolute differences of R, G and B, in linear light
};

/// `vectors`: of traceReflectionVectors, of the same size; `mirror`: 1 the ball, 2 the panel. Pixels beside
/// another surface are left out: there triangles and surfaces differ.
MirrorFigures compareMirrors(const Image& drawn, const Image& traced, const Image& vectors, int mirror);

/// How far a mirror's reflection vectors spread: the root of the mean squared angle between them and their
/// mean direction, in radians.
double vectorSpread(const Image& vectors, int mirror);

/// The mean of the first channel over the pixels of one mirror, for traceLookupAngles.
double meanAngle(const Image& angles, int mirror);

/// The share of a cube map's directions that a mirror looks up: of the texels of faces of `size`², those that
/// at least one vector falls on.
double shareOfMap(const Image& vectors, int mirror, int size);

/// A rough level of a map against the integral that it samples: GGX's density times the cosine summed up over
/// all texels of the source in double. The root of the mean squared difference over the mean, of every
/// `stride`-th texel. `source` and `level`: six faces each, of gl::readPixels.
double prefilterError(const std::vector<Image>& source, const std::vector<Image>& level, double alpha,
                      int stride);

}  // namespace quincunx

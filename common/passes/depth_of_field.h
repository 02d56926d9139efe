#pragma once

#include <cstddef>

#include "graph/graph.h"
#include "scene/scene.h"

/// Depth of field: what a thin lens makes of a picture that a pinhole took.
namespace quincunx {

/// Signed radii, in pixels, of the discs that a thin lens makes of points: negative before the plane of
/// focus, positive behind it.
struct CirclesOfConfusion {
    float atNear = 0;  ///< of points in the near plane
    float atFar = 0;   ///< of points in the far plane, which may be infinitely far
    bool operator==(const CirclesOfConfusion&) const = default;
};

/// Of a picture `heightPixels` high. A point at distance z along the view gets the radius
/// K (1/focus − 1/z), K = aperture · height / (2 tan(fov/2)), which is affine in the window depth. Computed
/// in double and rounded once; beyond 2^100 it is 2^100. An aperture of 0 gives zeros. A focus of 0, at the
/// eye, is the limit: everything lies behind it, and is as blurred as can be; a focus of infinity puts
/// everything before it. Negative or NaN numbers are a bug of the caller. Held by CirclesOfConfusion.*.
CirclesOfConfusion circlesOfConfusion(const Camera& camera, int heightPixels);

struct DepthOfFieldParams {
    Camera camera;               ///< that the picture was taken with
    float maxRadiusPixels = 16;  ///< 0 … 128: larger discs are taken as this large
    /// Of each of two layers at least, 1 … 1024; nine pixels share theirs. Discs that hold more texels than
    /// these get one tap for each.
    int taps = 48;
};

/// Adds three passes and returns the picture as the lens shows it, of the format and size of `color`; alpha
/// stays. `depth` is the depth buffer of the same view, drawn with `perspective` and the default depth range.
/// Pixels where nothing was drawn (depth 1) count as lying in the far plane.
///
/// A pixel's light is gathered in two layers: what lies at its own distance and farther, over its own disc,
/// and nearer light whose discs reach it. Sharp pixels that no blurred thing reaches are copied bit by bit:
/// all of them for an aperture of 0. Finite wherever the picture is; light above 65504 counts as that much
/// where it is blurred. What is hidden in the picture stays hidden: through the rim of a blurred near thing
/// its surroundings are seen, instead of what lies behind it. Held by DepthOfField.*.
graph::Resource addDepthOfFieldPasses(graph::FrameGraph& graph, graph::Resource color, graph::Resource depth,
                                      const DepthOfFieldParams& params);

/// Texels fetched for a pixel, at most: where nothing is blurred, only those that are not taps.
std::size_t fetchesAPixel(const DepthOfFieldParams& params);

}  // namespace quincunx

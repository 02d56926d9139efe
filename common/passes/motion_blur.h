#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "graph/graph.h"
#include "passes/scene_buffers.h"
#include "scene/scene.h"

/// Motion blur: what an open shutter makes of a picture taken at one moment.
namespace quincunx {

/// An instance that moves while the shutter is open.
struct MovingInstance {
    std::size_t instance = 0;     ///< of the buffers
    glm::mat4 worldFromModel{1};  ///< as the picture shows it: halfway through the exposure
    glm::mat4 worldFromModelOpen{1};
    glm::mat4 worldFromModelClose{1};
};

struct MotionBlurParams {
    Camera camera;  ///< that the picture was taken with: halfway through the exposure
    Camera cameraOpen;
    Camera cameraClose;
    std::vector<MovingInstance> instances = {};  ///< only these are drawn; all else is at rest in the world
    /// The scene's, up to date for this frame. Asked for when the pass runs, and not at all without
    /// instances.
    std::function<const SceneBuffers&()> buffers = {};
    float maxLengthPixels = 40;  ///< 0 … 256: longer ways are cut to this length
    int taps = 24;               ///< of each of two layers, 1 … 1024
};

/// Adds three passes and returns the picture as seen through the shutter, of the format and size of `color`;
/// alpha stays. `depth` is the depth buffer of the same view, drawn with `perspective` and the default depth
/// range, of vertices clipFromWorld · (worldFromModel · position).
///
/// "velocity" finds how far each pixel moves between opening and closing: what is at rest by its depth,
/// without any drawing, and the instances by being drawn again, each where the picture shows it. Pixels where
/// nothing was drawn (depth 1) count as points of the far plane, which may be infinitely far. Ways are taken
/// as straight, at constant speed, and centred on where a thing is seen. What passes the camera's plane has
/// the right direction and a bounded length. Pixels that move by a pixel at most and that nothing nearer
/// sweeps over are copied bit by bit: all of them if nothing moves. Finite wherever the picture is; light
/// above 65504 counts as that much where it moves. What is hidden in the picture stays hidden. Held by
/// MotionBlur.*.
graph::Resource addMotionBlurPasses(graph::FrameGraph& graph, graph::Resource color, graph::Resource depth,
                                    const MotionBlurParams& params);

/// Texels fetched for a pixel, at most; where nothing moves nearby 12.
std::size_t fetchesAPixel(const MotionBlurParams& params);

}  // namespace quincunx

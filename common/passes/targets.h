#pragma once

#include "graph/graph.h"

namespace quincunx {

/// A picture, and the finer targets that it is averaged from.
struct PictureTargets {
    graph::Resource picture;  ///< what the lab returns
    graph::Resource color;    ///< linear light; what passes draw into: `picture` itself for factor 1
    graph::Resource depth;    ///< 32-bit float, of the size of `color`
    int factor = 1;           ///< texels of `color` along a side of a pixel
};

struct PictureParams {
    graph::Format format = graph::Format::rgba8Srgb;  ///< of the picture
    int width = 0;                                    ///< pixels
    int height = 0;                                   ///< pixels
    int factor = 1;
    const char* name = "picture";
};

/// Adds "picture" or what else it is named, "shaded" (for factors above 1) and "depth". A target that no
/// driver can hold is an InputError about the flag `--supersample`.
PictureTargets addPictureTargets(graph::FrameGraph& graph, const PictureParams& params);

/// Adds the pass that averages `color` into `picture`; for factor 1 there is nothing to add.
void addResolvePass(graph::FrameGraph& graph, const PictureTargets& targets);

}  // namespace quincunx

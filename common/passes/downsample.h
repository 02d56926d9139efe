#pragma once

#include "graph/graph.h"

namespace quincunx {

/// How a large picture becomes a small one.
struct DownsampleParams {
    int factor = 2;  ///< texels of the large picture along a side of one pixel, ≥ 1
};

/// Adds a pass that writes into `picture` the box-filtered `fine`, which is `factor` times as wide and high.
graph::Pass addDownsamplePass(graph::FrameGraph& graph, graph::Resource fine, graph::Resource picture,
                              const DownsampleParams& params);

}  // namespace quincunx

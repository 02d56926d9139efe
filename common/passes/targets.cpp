#include "passes/targets.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "passes/downsample.h"

namespace quincunx {

PictureTargets addPictureTargets(graph::FrameGraph& graph, const PictureParams& params) {
    QX_CHECK_GE(params.factor, 1);
    constexpr int maxSide = 16384;  // texels along a side, as today's drivers hold them
    const int factor = params.factor;
    if (factor > 1 && std::max(params.width, params.height) > maxSide / factor)
        throw InputError(fmt::format("{}x{} with {} samples along a side is too large", params.width,
                                     params.height, factor),
                         "--supersample",
                         fmt::format("give --supersample=1, or a size of at most {}", maxSide / factor));
    PictureTargets targets;
    targets.factor = factor;
    targets.picture = graph.addResource({params.name, params.format, params.width, params.height});
    // Measured pictures keep all bits on the way; for people, half floats hold more than 8 bits can show.
    const graph::Format fine =
        params.format == graph::Format::rgba32f ? graph::Format::rgba32f : graph::Format::rgba16f;
    targets.color = factor == 1
                        ? targets.picture
                        : graph.addResource({"shaded", fine, params.width * factor, params.height * factor});
    targets.depth =
        graph.addResource({"depth", graph::Format::depth32f, params.width * factor, params.height * factor});
    return targets;
}

void addResolvePass(graph::FrameGraph& graph, const PictureTargets& targets) {
    if (targets.factor > 1)
        addDownsamplePass(graph, targets.color, targets.picture, {.factor = targets.factor});
}

}  // namespace quincunx

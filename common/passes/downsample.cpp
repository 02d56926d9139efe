#include "passes/downsample.h"

#include "base/check.h"
#include "gl/executor.h"
#include "passes/fullscreen.h"

namespace quincunx {

graph::Pass addDownsamplePass(graph::FrameGraph& graph, graph::Resource fine, graph::Resource picture,
                              const DownsampleParams& params) {
    QX_CHECK_GE(params.factor, 1);
    QX_CHECK_EQ(graph.resource(fine).width, graph.resource(picture).width * params.factor);
    QX_CHECK_EQ(graph.resource(fine).height, graph.resource(picture).height * params.factor);
    return graph.addPass({.name = "downsample",
                          .reads = {fine},
                          .writes = {picture},
                          .execute = [fine, params](graph::PassContext& context) {
                              const gl::Program& program =
                                  context.programs().get(fullscreenProgram("downsample"));
                              program.use();
                              // Not the unit of the materials, so that both stay bound from frame to frame.
                              constexpr int unit = 1;
                              program.set("fine", unit);
                              program.set("factor", params.factor);
                              context.texture(fine).bind(unit);
                              context.drawFullscreen();
                          }});
}

}  // namespace quincunx

#include "lab.h"

#include <glad/gl.h>

using namespace quincunx;

graph::Resource Probe::build(graph::FrameGraph& graph, const Frame& frame) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    const float grey = grey_;
    graph.addPass({"fill", {}, {picture}, [grey](graph::PassContext&) {
                       glClearColor(grey, grey, grey, 1);
                       glClear(GL_COLOR_BUFFER_BIT);
                   }});
    return picture;
}

QUINCUNX_DEFINE_LAB(Probe)

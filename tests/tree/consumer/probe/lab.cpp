#include "lab/lab.h"

#include <glad/gl.h>

namespace {

using namespace quincunx;

/// A lab that draws one colour.
class Probe final : public Lab {
  public:
    std::string topic() const override { return "A picture of one grey"; }
    Camera defaultCamera() const override { return {}; }
    Bounds sceneBounds() const override { return {}; }

    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override {
        const graph::Resource picture =
            graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
        graph.addPass({"fill", {}, {picture}, [grey = float(grey_)](graph::PassContext&) {
                           glClearColor(grey, grey, grey, 1);
                           glClear(GL_COLOR_BUFFER_BIT);
                       }});
        return picture;
    }

  private:
    FloatKnob grey_{knobs(), "grey", 0, {0, 1}, "", "linear light of every pixel"};
};

}  // namespace

QUINCUNX_DEFINE_LAB(Probe)

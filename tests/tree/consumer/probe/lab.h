#pragma once

#include "lab/lab.h"

/// A lab that draws one colour.
class Probe final : public quincunx::Lab {
  public:
    std::string topic() const override { return "A picture of one grey"; }
    quincunx::graph::Resource build(quincunx::graph::FrameGraph& graph,
                                    const quincunx::Frame& frame) override;
    quincunx::Camera defaultCamera() const override { return {}; }
    quincunx::Bounds sceneBounds() const override { return {}; }

  private:
    quincunx::FloatKnob grey_{knobs(), "grey", 0, {0, 1}, "", "linear light of every pixel"};
};

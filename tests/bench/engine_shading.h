#pragma once

#include <cstdint>

#include <glm/gtc/matrix_transform.hpp>

#include "gl/calls.h"
#include "gl/executor.h"
#include "labs/10_shading/lab.h"

namespace quincunx {

/// Lab 10 at its defaults, driven as the studio and the window drive it: a new graph each frame.
class EngineShading {
  public:
    EngineShading(int width, int height) {
        frame_.width = width;
        frame_.height = height;
    }
    void draw(const Camera& camera) {
        frame_.camera = camera;
        graph::FrameGraph graph;
        picture_ = lab_.build(graph, frame_);
        graph.addOutput(picture_);
        executor_.run(graph);
    }
    Image8 picture() const { return gl::readPixels8(executor_.output(picture_)); }

  private:
    ShadingLab lab_;
    Frame frame_;
    gl::Executor executor_;
    graph::Resource picture_;
};

/// The camera of frame `number` of a slow walk around the still life, so that each frame has news for the
/// device.
inline Camera walking(Camera camera, int number) {
    const float angleRadians = 0.002f * static_cast<float>(number);
    camera.worldFromCamera = glm::rotate(glm::mat4(1), angleRadians, {0, 1, 0}) * camera.worldFromCamera;
    return camera;
}

/// GL calls that `work` makes, by name, while calls are watched.
template <typename Work>
std::map<std::string, std::uint64_t> callsOf(Work&& work) {
    const gl::CallRecorder recorder;
    work();
    return recorder.calls();
}

inline std::uint64_t sumOf(const std::map<std::string, std::uint64_t>& calls) {
    std::uint64_t sum = 0;
    for (const auto& [name, count] : calls)
        sum += count;
    return sum;
}

}  // namespace quincunx

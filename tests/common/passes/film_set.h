#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "gl/context.h"
#include "gl/executor.h"
#include "image/image.h"
#include "passes/forward.h"
#include "passes/targets.h"

namespace quincunx::test {

/// A scene and a context that pictures of it are taken in.
class FilmSet {
  public:
    using Effect =
        std::function<graph::Resource(graph::FrameGraph&, graph::Resource color, graph::Resource depth)>;

    FilmSet(gl::Backend backend, Scene scene, int width, int height)
        : width_(width),
          height_(height),
          context_(gl::createOffscreenContext(backend)),
          scene_(std::make_unique<ForwardScene>(std::move(scene))) {}

    Scene& scene() { return scene_->scene(); }
    float aspect() const { return static_cast<float>(width_) / static_cast<float>(height_); }
    int width() const { return width_; }
    int height() const { return height_; }

    /// The scene in linear light, after the effect if there is one.
    Image picture(const ForwardView& view, const Effect& effect = {},
                  graph::Format format = graph::Format::rgba32f) {
        graph::FrameGraph graph;
        const PictureTargets targets = addPictureTargets(graph, {format, width_, height_, 1});
        graph.addPass({"draw", {}, {targets.color, targets.depth}, [&](graph::PassContext& context) {
                           glClear(GL_DEPTH_BUFFER_BIT);
                           scene_->draw(context, view);
                       }});
        const graph::Resource shown = effect ? effect(graph, targets.color, targets.depth) : targets.color;
        graph.addOutput(shown);
        executor_.run(graph);
        return gl::readPixels(executor_.output(shown));
    }

    /// The mean of pictures: `view` says how each is taken, and may place instances.
    Image exposure(int pictures, const std::function<ForwardView(int)>& view) {
        std::vector<double> sum;
        Image image;
        for (int i = 0; i < pictures; ++i) {
            image = picture(view(i));
            sum.resize(image.data.size());
            for (std::size_t j = 0; j < sum.size(); ++j)
                sum[j] += static_cast<double>(image.data[j]);
        }
        for (std::size_t j = 0; j < sum.size(); ++j)
            image.data[j] = static_cast<float>(sum[j] / pictures);
        return image;
    }

  private:
    int width_;
    int height_;
    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    std::unique_ptr<ForwardScene> scene_;
};

inline bool haveSameBits(const Image& a, const Image& b) {
    return a.data.size() == b.data.size() &&
           std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0;
}

inline bool isFinite(const Image& image) {
    return std::all_of(image.data.begin(), image.data.end(),
                       [](float value) { return std::isfinite(value); });
}

inline std::string nameOfBackend(const testing::TestParamInfo<gl::Backend>& backend) {
    return std::string(gl::backendName(backend.param));
}

}  // namespace quincunx::test

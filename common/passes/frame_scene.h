#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gl/executor.h"
#include "passes/frame_view.h"
#include "passes/frame_visibility.h"
#include "passes/scene_buffers.h"

namespace quincunx {

/// A scene on the device, of which a frame draws what it needs.
class FrameScene {
  public:
    /// Makes buffers and textures in the current context.
    explicit FrameScene(const Scene& scene);

    /// Takes over camera, lights and placements of a frame; of the instances only those that it draws.
    void update(const FrameView& view, const Visibility& visibility);

    /// The scene's gradient, into the bound target.
    void drawBackground(graph::PassContext& context);
    /// Instances that do not blend, with depth test, into the bound target.
    void drawSolid(graph::PassContext& context, std::span<const std::uint32_t> instances,
                   const gl::ProgramFiles& program);
    /// Instances that blend, in the given order, over what is there, without writing depth; of what is
    /// double-sided the far sides first.
    void drawBlended(graph::PassContext& context, std::span<const std::uint32_t> instances,
                     const gl::ProgramFiles& program);
    /// Depth alone, as a light sees them, of those that its view may hold.
    void drawDepth(graph::PassContext& context, std::span<const std::uint32_t> instances,
                   const glm::mat4& clipFromAnchored);

  private:
    struct Kind {
        bool doubleSided = false;
        bool cutOut = false;
        bool mirrored = false;
    };
    void setFrontFace(bool mirrored);
    void setCulling(bool culls);

    SceneBuffers buffers_;
    std::vector<ObjectBlock> objects_;  ///< by instance; of those that were never drawn as made
    std::vector<Kind> kinds_;           ///< by instance
    bool clockwise_ = false;
    bool culls_ = false;
};

/// What a frame's passes share of it on the device.
class FrameDevice {
  public:
    /// The scene as the frame has it: made at the first call ever, brought up to date at the first of each
    /// frame, in the context that is current then.
    FrameScene& scene(const FrameView& view, const Visibility& visibility);

  private:
    std::optional<FrameScene> scene_;
    const Visibility* updatedFor_ = nullptr;

    friend class FrameRenderer;
};

}  // namespace quincunx

#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "passes/forward.h"
#include "passes/scene_buffers.h"
#include "passes/targets.h"
#include "scene/scene.h"

namespace quincunx {

/// Draws a scene on level ground: the ground's instances, with the shadows that the first light (directional)
/// makes of the others on it, and the others.
class TownPass {
  public:
    /// `ground`: the instances that lie flat, in ascending order.
    TownPass(Scene scene, const std::vector<std::size_t>& ground);

    /// All instances but the ground's, in their order: placements and materials may change at any time.
    Scene& objects() { return objects_; }
    Scene& ground() { return ground_; }

    struct Params {
        ForwardView view;
        bool shadows = true;
        std::function<void(graph::PassContext&)> over;  ///< draws into the same targets, at the end; or empty
    };
    /// Adds the passes that write `targets.color` and `targets.depth`; with shadows also the resource
    /// "ground shadow", white where they lie.
    void addPasses(graph::FrameGraph& graph, const PictureTargets& targets, const Params& params);

    std::size_t triangleCount() const { return objects_.triangleCount() + ground_.triangleCount(); }

  private:
    void update(const ForwardView& view);

    Scene ground_;
    Scene objects_;
    std::vector<bool> castsShadow_;  ///< by instance of `objects_`
    std::optional<SceneBuffers> groundBuffers_;
    std::optional<SceneBuffers> objectBuffers_;
};

}  // namespace quincunx

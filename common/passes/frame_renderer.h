#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/graph.h"
#include "passes/frame_effects.h"

namespace quincunx {

/// Whether an effect is called for, and why.
struct Decision {
    bool calledFor = false;
    std::string reason;
};

/// A row of the table as a frame has it.
struct PlannedEffect {
    std::string_view name;
    Decision decision;
    bool added = false;               ///< called for or forced, and not left out
    std::vector<std::string> passes;  ///< its own; some effects only change how the scene is shaded
};

/// What a frame does, and why.
struct FramePlan {
    std::vector<PlannedEffect> effects;  ///< by row of effects()
    std::size_t instances = 0;           ///< of the scene
    std::size_t drawn = 0;               ///< that lie in view
    std::size_t triangles = 0;           ///< of those
    std::size_t shadowTriangles = 0;     ///< drawn into shadow maps
    std::size_t lights = 0;              ///< that the scene is shaded with
    std::size_t lightsOfScene = 0;

    const PlannedEffect& find(std::string_view effect) const;
};

/// Draws a scene with the effects that each view of it calls for.
class FrameRenderer {
  public:
    FrameRenderer();
    ~FrameRenderer();
    FrameRenderer(FrameRenderer&&) noexcept;
    FrameRenderer& operator=(FrameRenderer&&) noexcept;

    /// Adds the frame's passes; returns the picture, of `view.pictureFormat` and size, named "picture". The
    /// scene's placements, lights and colours may change from call to call; its meshes, textures and
    /// instances are those of the first call, until `reset`. The buffers are made when the first pass of the
    /// first frame runs, in the context that is current then. What `view` refers to outlives the graph's run.
    /// A picture without pixels is an InputError.
    graph::Resource build(graph::FrameGraph& graph, const FrameView& view);
    /// Plans a frame without adding anything.
    const FramePlan& plan(const FrameView& view);
    /// Of the last `build` or `plan`, whose view is still there: the reasons are put into words when they are
    /// first asked for.
    const FramePlan& plan() const;
    const Visibility& visibility() const;
    const FrameDevice& device() const { return *device_; }

    /// Forgets the scene, for another one.
    void reset();

  private:
    struct Planned;
    void decide(const FrameView& view);

    std::optional<SceneBounds> bounds_;
    std::shared_ptr<FrameDevice> device_;
    std::shared_ptr<Planned> planned_;  ///< the frame that was built last
    mutable FramePlan plan_;
    mutable bool inWords_ = true;  ///< the plan's reasons are written
};

}  // namespace quincunx

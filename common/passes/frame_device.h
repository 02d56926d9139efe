#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "passes/environment_map.h"
#include "passes/frame_shadows.h"
#include "passes/frame_view.h"
#include "passes/frame_visibility.h"
#include "passes/material.h"
#include "passes/scene_buffers.h"

namespace quincunx {

/// What is kept of a scene on the device from frame to frame, each part made when a frame first needs it.
class FrameDevice {
  public:
    /// Meshes, textures and programs of the scene's materials.
    MaterialPass& materials(const Scene& scene);
    FrameShadows& shadows();
    /// The meshes for drawing what moves once more.
    const SceneBuffers& movingMeshes(const Scene& scene);
    /// The map of what surrounds the scene's mirrors, without shadows and without mirrors in mirrors: taken
    /// when it is first asked for, and again when anything that it shows, or its resolution, has changed.
    EnvironmentMap& environment(graph::PassContext& context, const FrameView& view,
                                const Surroundings& surroundings);
    /// How often the map has been taken.
    std::size_t environmentsTaken() const { return environmentsTaken_; }

  private:
    std::optional<MaterialPass> materials_;
    std::optional<FrameShadows> shadows_;
    std::optional<SceneBuffers> movingMeshes_;
    std::optional<EnvironmentMap> environment_;
    std::vector<std::byte> environmentShows_;  ///< all that the map depends on
    std::size_t environmentsTaken_ = 0;
};

}  // namespace quincunx

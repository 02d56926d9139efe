#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "gl/executor.h"
#include "passes/frame_visibility.h"
#include "passes/material.h"

namespace quincunx {

/// The shadow map of all lights of one kind: a tile for each of their views.
struct ShadowAtlas {
    struct Tile {
        std::size_t light = 0;  ///< index into Visibility::lights
        glm::mat4 clipFromAnchored{1};
        float viewDistance = 0;  ///< directional lights: serves what is up to so far along the view
        std::vector<std::uint32_t> casters;  ///< those of the light that may be seen in it
    };
    Light::Kind kind = Light::Kind::directional;
    int resolution = 1;  ///< texels along a side of a tile
    int columns = 1;
    int rows = 1;
    std::vector<Tile> tiles;

    int width() const { return columns * resolution; }
    int height() const { return rows * resolution; }
};

/// Tiles for the lights of that kind that cast onto something in view; without any, one tile that stays
/// empty. A directional light's view is cut into slices where it is deep, with a tile of half the side for
/// each. The resolution is halved until the map's sides are within 8192 texels.
ShadowAtlas makeShadowAtlas(const Visibility& visibility, const Scene& scene, Light::Kind kind,
                            const FrameSettings& settings);

/// Draws each tile's casters into the bound depth target, whose size is the atlas'.
void drawShadowAtlas(graph::PassContext& context, MaterialPass& materials, const Scene& scene,
                     const Visibility& visibility, const ShadowAtlas& atlas);

/// What the shading shaders read of a frame's shadow maps (shaders/lib/frame_shadows.glsl).
class FrameShadows {
  public:
    struct Map {
        const ShadowAtlas& atlas;
        const gl::Texture2D& texture;
    };
    /// Adds to `params` what programs need to look up maps of that kind.
    static void addTo(MaterialParams& params, Light::Kind kind);
    /// Sends what the maps hold, and binds them and their block.
    void bind(graph::PassContext& context, const Visibility& visibility, const std::vector<Map>& maps,
              int radius);
    /// Gives back the units' samplers.
    void unbind();

  private:
    std::optional<gl::Buffer> block_;
    std::vector<std::byte> sent_;
    std::vector<std::unique_ptr<gl::Sampler::Use>> samplers_;
};

}  // namespace quincunx

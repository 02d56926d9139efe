#pragma once

#include <bitset>
#include <span>

#include <glm/glm.hpp>

#include "graph/graph.h"
#include "passes/post.h"
#include "passes/shadow_map.h"
#include "scene/scene.h"

namespace quincunx {

/// Rows of the table of effects that a set can hold.
inline constexpr std::size_t maxEffects = 32;
using EffectSet = std::bitset<maxEffects>;  ///< by row of effects()

/// What a person asks of a frame. With these values nothing is asked for: what the scene itself calls for is
/// all that is done.
struct FrameSettings {
    float exposureStops = 0;
    ToneCurve toneCurve = ToneCurve::none;  ///< none: cut off at 1
    float bloomStrength = 0;                ///< 0: no bloom
    float bloomThreshold = 1;
    float bloomSigmaPixels = 8;
    float blurSigmaPixels = 0;  ///< 0: no blur
    float greyscale = 0;        ///< 0 colour … 1 grey
    bool fxaa = false;
    float largestDiscPixels = 16;  ///< of a point that a lens shows out of focus, 0 … 128
    float shutterSeconds = 0;      ///< how long the shutter is open; 0: nothing is blurred by its motion
    float longestWayPixels = 40;   ///< that motion blurs, 0 … 256
    /// Of every light that casts; a directional light's one map is as large as wanted, a spot's and each of a
    /// point's six views half as wide.
    int shadowResolution = 2048;
    int environmentResolution = 128;  ///< texels along an edge of a face of the environment map, ≥ 1
    /// Slices of the view that a directional light has a map of, whose sides are half as long then; 0: as
    /// many as its depth is worth (cascadesFor), else 1 … 4.
    int shadowCascades = 0;
    int shadowRadius = 1;  ///< of the (2 radius + 1)² bilinear taps

    bool drawsUnseen =
        false;               ///< draw what is out of view as well, for measuring; the picture stays the same
    EffectSet forced = {};   ///< run although nothing calls for them; the picture stays the same
    EffectSet leftOut = {};  ///< not run although they are called for, for measuring; this wins
};

/// All that a frame depends on. What it refers to outlives the frame's run.
struct FrameView {
    const Scene& scene;  ///< as the picture shows it: halfway through the exposure
    /// The same. Depth is a float that nears 1 with the distance: at distance z, surfaces that are farther
    /// apart than 2^-21 z² / nearDistance are drawn in their order, whatever the far distance. Held by
    /// FrameHardCases.*.
    Camera camera;
    int width = 0;   ///< pixels, ≥ 1
    int height = 0;  ///< pixels, ≥ 1
    FrameSettings settings = {};
    /// Placements of the instances when the shutter opens and closes; both empty: as in the scene.
    std::span<const glm::mat4> worldFromModelAtOpen = {};
    std::span<const glm::mat4> worldFromModelAtClose = {};
    Camera cameraAtOpen = camera;
    Camera cameraAtClose = camera;
    graph::Format pictureFormat = graph::Format::rgba8Srgb;
};

}  // namespace quincunx

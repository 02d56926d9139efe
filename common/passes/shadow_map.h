#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "gl/executor.h"
#include "passes/forward.h"

/// Shadow maps (Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978): what a light sees
/// first is drawn into a depth map; a point that lies deeper than the map says is in shadow.
namespace quincunx {

inline constexpr std::size_t maxShadowViews = 6;

/// One view from the light, drawn into a square tile of the map.
struct ShadowView {
    glm::mat4 clipFromWorld{1};
    float viewDistance = 0;  ///< cascades: serves points up to this distance along the eye's view
};

/// All views that a light needs.
struct ShadowViews {
    enum class Kind { cascades, single, cube };
    Kind kind = Kind::single;
    std::vector<ShadowView> views;  ///< cascades: by distance; cube: +x −x +y −y +z −z
};

/// What the receiving side leaves between a surface and its own image in the map.
enum class ShadowBias {
    none,
    constant,       ///< the same depth everywhere
    slope,          ///< glPolygonOffset in the map: a constant, and a share of each triangle's slope
    receiverPlane,  ///< half a texel along the receiver's own plane (Isidoro 2006)
};

struct ShadowMapParams {
    int resolution = 1024;  ///< texels along a side of one view's tile, ≥ 1
    int cascades = 1;       ///< of a directional light: 1 … 4
    ShadowBias bias = ShadowBias::receiverPlane;
    /// constant: texels' widths in depth; slope, receiverPlane: multiples of what theory asks for.
    float biasScale = 1;
    bool bilinear = false;   ///< each tap compares four texels and blends
    int radius = 0;          ///< of the (2 radius + 1)² taps of percentage-closer filtering (Reeves 1987)
    bool backFaces = false;  ///< draw the casters' backs into the map instead of their fronts
    bool operator==(const ShadowMapParams&) const = default;
};

/// The views of a light that hold all of the scene that can shade what the camera sees. A directional light
/// gets boxes around the vertices, or, for several cascades, around the slices of the camera's view between
/// distances halfway between logarithmic and even steps (Zhang et al., "Parallel-split shadow maps", VRCIA
/// 2006). A spot up to 80° from its axis gets one perspective view, wider ones and points six. Scenes that
/// are empty or not finite: no views, so no shadow. Looks at every vertex. Held by ShadowViews.*.
ShadowViews fitShadowViews(const Light& light, const Scene& casters, const Camera& camera, float aspect,
                           const ShadowMapParams& params);

/// Where a light's casters and receivers lie, for fitting its views without looking at vertices.
struct ShadowExtent {
    Bounds casters;  ///< world space
    /// Directional lights: boxes in the frame of `shadowBasis`, empty where min exceeds max.
    glm::dvec3 castersMin{0}, castersMax{0};
    glm::dvec3 receiversMin{0}, receiversMax{0};
};

/// What the eye sees, for cutting it into slices: how far along its view the nearest and the farthest thing
/// is.
struct ViewDepths {
    Camera camera = {};  ///< in the world of the extent
    float aspect = 1;
    double nearest = 1;   ///< > 0
    double farthest = 1;  ///< ≥ nearest, finite
};

/// How many slices such a view is worth: one more for each factor of 4 between the nearest and the farthest,
/// 4 at most. A pixel covers 4 times as much there, so that the same texels would be 4 times as fine as
/// needed.
int cascadesFor(const ViewDepths& depths);

/// A directional light's frame as the columns of a rotation: it looks along −z, with the world's up for its
/// own, so that what is long and level lies along the map.
glm::mat3 shadowBasis(const Light& light);

/// The views of a light over the part of the world where casters and receivers may meet: one box for a
/// directional light, as small as both allow, or with several cascades one for each slice of the view. No
/// views where there is nothing to see, or nothing finite.
ShadowViews fitShadowViews(const Light& light, const ShadowExtent& extent, const ShadowMapParams& params,
                           const ViewDepths& depths = {});

/// What shaders/lib/shadow_taps.glsl needs of a view.
glm::mat4 shadowFromClip();

/// A light's map: its views, what shaders read of it, and how it is drawn.
class ShadowMap {
  public:
    /// Width and height of the map for so many views: tiles side by side.
    static glm::ivec2 size(std::size_t views, int resolution);

    /// Draws the casters into the bound depth target of that size.
    void draw(graph::PassContext& context, ForwardScene& casters, const ShadowViews& views,
              const ShadowMapParams& params);

    /// What the lookup needs to know.
    struct Lookup {
        const gl::Texture2D& map;
        const ShadowViews& views;  ///< none: everything is lit
        const ShadowMapParams& params;
        const Camera& camera;        ///< whose view the cascades were cut from
        int lightIndex = 0;          ///< which of the scene's lights the map is of
        glm::vec3 lightPosition{0};  ///< of points and wide spots
    };
    /// Draws the scene into the bound target's viewport, whose depth is clear, with the map's shadows.
    /// `mask`: instead of light the share of taps that the light reaches, as grey; 0 where surfaces face
    /// away.
    void drawShadowed(graph::PassContext& context, ForwardScene& scene, const ForwardView& view,
                      const Lookup& lookup, bool mask = false);

  private:
    std::optional<gl::Buffer> block_;
    std::vector<std::byte> sent_;  ///< what the block holds
};

}  // namespace quincunx

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "passes/frame_view.h"

/// What a frame shows: which instances lie in the view, which of them a light reaches, and which instances,
/// in the view or not, can throw a shadow onto those. Everything is decided from bounds, on the safe side:
/// what can change a pixel is never left out, what cannot is sometimes kept.
namespace quincunx {

/// A box in the anchored world, with axes along its own.
struct AnchoredBox {
    glm::dvec3 centre{0};
    glm::dvec3 half{0};
};

/// The planes of a view, each with the magnitudes of the terms that the device sums for it.
class ViewPlanes {
  public:
    /// `sides`: without the near and the far plane, for views that clamp to them.
    enum class Kind { all, sides };
    explicit ViewPlanes(const glm::mat4& clipFromAnchored, Kind kind = Kind::all);

    /// False only where the device is certain to draw nothing of what is in the box: see SceneBounds::look.
    bool mayMeet(const AnchoredBox& box) const;

  private:
    struct Plane {
        glm::dvec3 normal{0};
        double offset = 0;
        glm::dvec3 magnitude{0};
        double offsetMagnitude = 0;
    };
    std::array<Plane, 6> planes_;
    std::size_t count_ = 6;
};

/// A light that reaches something in view, and what it meets. Indices are those of the scene's instances.
struct LightReach {
    std::size_t light = 0;               ///< index into Scene::lights
    std::size_t receivers = 0;           ///< visible instances that it reaches
    std::size_t shadowed = 0;            ///< those of them that may lie in a shadow
    std::vector<std::uint32_t> casters;  ///< what may throw it
    ShadowExtent extent;                 ///< of casters and receivers, for the map's views
};

/// What the mirrors of a scene have around them. It does not depend on the camera, but for being filled in
/// only where a mirror is in view.
struct Surroundings {
    std::size_t mirrors = 0;  ///< instances that mirror their surroundings, in view or not
    std::size_t mirrorsInView = 0;
    glm::vec3 positionWorld{0};  ///< the middle of all mirrors
    float nearDistance = 1e-3f;  ///< of a view from there that holds all instances
    float farDistance = 1;
    std::vector<std::uint32_t> solid;    ///< what is seen from there: all but what holds the position inside
    std::vector<std::uint32_t> blended;  ///< the same, the farthest first
    std::vector<std::size_t> lights;     ///< the strongest, at most maxShaderLights
};

struct Visibility {
    /// Everything is drawn relative to this point of the world, so that a scene far from the origin loses
    /// nothing to rounding: the origin itself for what is near it.
    glm::vec3 anchorWorld{0};
    glm::mat4 clipFromAnchored{1};  ///< of the camera, rounded once
    glm::vec3 eyeAnchored{0};

    /// Visible instances that do not blend, in the scene's order; with FrameSettings::drawsUnseen all of
    /// them.
    std::vector<std::uint32_t> solid;
    std::vector<std::uint32_t> blended;   ///< the same of those that blend, the farthest first
    std::vector<AnchoredBox> boxes;       ///< of all instances; of one with nothing to draw, a point
    ViewDepths depths;                    ///< of what is visible, in the anchored world
    std::vector<LightReach> lights;       ///< at most maxShaderLights, in the scene's order
    std::size_t lightsLeftOut = 0;        ///< that reach something in view, but are weaker than those
    std::size_t lightsWithoutEffect = 0;  ///< dark, or of no reach into the view

    Surroundings surroundings;
    std::size_t instances = 0;          ///< of the scene
    std::vector<std::uint32_t> moving;  ///< visible, solid instances that move while the shutter is open
    bool cameraMoves = false;           ///< … or the camera

    std::size_t visible() const { return solid.size() + blended.size(); }
};

/// What of a scene does not change from frame to frame: the bounds of its meshes.
class SceneBounds {
  public:
    explicit SceneBounds(const Scene& scene);

    /// Linear in instances times (1 + lights); looks at no vertex. The scene has the meshes that it had.
    ///
    /// Culling is conservative against the device's float arithmetic: the planes are those of the matrix that
    /// the device gets, the boxes grow by 2^-21 of the magnitudes that the device sums (its four products and
    /// sums are off by 4 · 2^-24 of them, twice for two products), and the tests grant the same. A NaN counts
    /// as visible. Held by FrameVisibility.*.
    Visibility look(const FrameView& view) const;

  private:
    void look(const Scene& scene, Surroundings& surroundings) const;

    struct MeshBounds {
        glm::dvec3 centre{0};
        glm::dvec3 half{0};
        bool empty = true;  ///< nothing to draw
        bool flat = false;  ///< in a plane of its own axes, so that it casts nothing onto itself
    };
    std::vector<MeshBounds> meshes_;
};

/// The point that a frame is drawn relative to: the multiple of 2^k nearest to the eye, 2^k being the least
/// above 512 near distances. The eye's coordinates are then 512 near distances at most, and their rounding is
/// 2^-15 of the near distance: a fraction of a pixel at the near plane.
glm::vec3 anchorOf(const Camera& camera);

/// A placement relative to the anchor. Exact where both are within a factor of two of each other (Sterbenz).
glm::mat4 relativeTo(const glm::vec3& anchorWorld, const glm::mat4& worldFromModel);

/// Indices of `distances`, the largest first, NaN last, in order of index where equal.
std::vector<std::uint32_t> farthestFirst(std::span<const double> distances);

}  // namespace quincunx

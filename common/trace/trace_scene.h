#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/ray.h"
#include "geometry/ray_triangle.h"
#include "geometry/shapes.h"
#include "scene/scene.h"
#include "scene/still_life.h"
#include "trace/accelerator.h"

namespace quincunx {

/// A solid in closed form among the triangles of a scene.
struct TracedSolid {
    Shape shape;
    std::size_t material = 0;  ///< index into Scene::materials
    glm::mat4 worldFromModel{1};
};

/// What a ray meets. World space. The sides are those of the surface, not of the ray.
struct SurfacePoint {
    double t = 0;                ///< in lengths of the ray's direction
    glm::vec3 position{0};       ///< on the surface
    glm::vec3 positionError{0};  ///< a box of this half size about the position holds a surface point
    glm::vec3 geometricNormal{0, 1,
                              0};  ///< of the triangle's plane or the solid, unit length, out of its front
    glm::vec3 shadingNormal{0, 1, 0};  ///< interpolated and normal-mapped, unit length, same side
    glm::vec3 tangent{1, 0, 0};        ///< unit length, orthogonal to the shading normal
    glm::vec2 texcoord{0};
    glm::vec4 color{1};          ///< Mesh::colors, interpolated
    std::size_t material = 0;    ///< index into Scene::materials
    std::uint32_t instance = 0;  ///< index into Scene::instances, solids counted after them
    std::uint32_t triangle = 0;  ///< of the instance's mesh; 0 of a solid
    glm::vec3 weights{1, 0, 0};  ///< barycentric; (1,0,0) of a solid
    bool front = true;           ///< the ray comes from the front
};

/// A material where a surface point lies, textures and vertex colours multiplied in. Linear; every number is
/// finite and none is below 0, whatever the scene holds.
struct SurfaceValues {
    glm::vec4 baseColor{1};  ///< alpha within [0, 1]
    float metallic = 0;
    float roughness = 0.5f;
    float transmission = 0;
    float ior = 1.5f;
    float occlusion = 1;    ///< share of ambient light that arrives
    glm::vec3 emission{0};  ///< of the side that emits, W/(m² sr)
    glm::vec3 diffuse{0};   ///< Material::diffuse times the base colour's texture and the vertex colour
    glm::vec3 specular{0};  ///< Material::specular
    float shininess = 0;
};

/// A scene made ready for rays: meshes that are used once, or that are small, are flattened into one set of
/// triangles; of those that are used several times there is one structure, and instances of it; solids stay
/// what they are. Cut-outs (Material::AlphaMode::mask) let rays through where they have no surface; where
/// two of them lie within an ulp of t on one another, the second may be passed too. Surfaces that blend
/// (Material::AlphaMode::blend) count as whole but where `coverAt` is asked. What is not finite is left out:
/// triangles as intersectTriangle says, instances whose placement is not. Read by any number of threads.
class TraceScene {
  public:
    explicit TraceScene(Scene scene, std::vector<TracedSolid> solids = {},
                        Structure structure = Structure::wideBvh);
    /// The surfaces themselves, not triangles of them.
    explicit TraceScene(const StillLife& stillLife);
    ~TraceScene();
    TraceScene(TraceScene&&) noexcept;
    TraceScene& operator=(TraceScene&&) noexcept;

    const Scene& scene() const;
    const std::vector<TracedSolid>& solids() const;
    Bounds bounds() const;  ///< of all surfaces, world space

    SurfaceValues valuesAt(const SurfacePoint& point) const;

    /// Whether any surface blends.
    bool blends() const;
    /// The share of light that a surface with these values keeps from going straight through: the base
    /// colour's alpha where its material blends, else 1.
    float coverAt(const SurfacePoint& point, const SurfaceValues& values) const;

    std::optional<SurfacePoint> nearest(const Ray& ray, RayInterval interval = {},
                                        TraversalCounts* counts = nullptr) const;
    /// Whether anything solid lies in the interval.
    bool occluded(const Ray& ray, RayInterval interval = {}, TraversalCounts* counts = nullptr) const;

    /// A ray that leaves the surface on the side of `direction`, and cannot meet it where it starts: the
    /// origin is moved along the geometric normal by the bound on the position's error, no more.
    static Ray leave(const SurfacePoint& point, glm::vec3 direction);
    /// Whether nothing lies between two points; both ends leave their surfaces as above.
    bool visible(const SurfacePoint& from, const SurfacePoint& to, TraversalCounts* counts = nullptr) const;
    bool visible(const SurfacePoint& from, glm::vec3 to, TraversalCounts* counts = nullptr) const;

    /// The share of light that comes through between the same, and from infinitely far: what is left when
    /// each surface has kept its cover. 1 where nothing stands between, 0 behind what does not blend.
    float clearShare(const SurfacePoint& from, const SurfacePoint& to,
                     TraversalCounts* counts = nullptr) const;
    float clearShare(const SurfacePoint& from, glm::vec3 to, TraversalCounts* counts = nullptr) const;
    float clearShareAlong(const SurfacePoint& from, glm::vec3 direction,
                          TraversalCounts* counts = nullptr) const;

  private:
    struct Parts;
    template <typename GoOn>
    float clearShareOf(Ray ray, RayInterval interval, TraversalCounts* counts, const GoOn& goOn) const;

    std::unique_ptr<Parts> parts_;
};

/// The nearest surface that OpenGL would draw: triangles whose material is not double-sided are passed where
/// the ray comes from behind them. Solids count from both sides.
std::optional<SurfacePoint> nearestDrawn(const TraceScene& scene, const Ray& ray, RayInterval interval = {});

/// The scene with everything moved by a vector, computed in double: what is far from the world's origin is
/// moved there, so that rays, which are floats, keep their digits.
Scene movedBy(Scene scene, glm::dvec3 by);
Camera movedBy(Camera camera, glm::dvec3 by);

/// The ray through a point of the picture, (0, 0) its top left corner and (width, height) the bottom right
/// one, and through a point of the lens, in the unit disk; origin at the eye, direction of unit length.
Ray cameraRay(const Camera& camera, int width, int height, glm::vec2 pixel, glm::vec2 lens = glm::vec2(0));

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"
#include "trace/accelerator.h"
#include "trace/csg.h"
#include "trace/shadow_cache.h"

namespace quincunx {

/// What a surface does with light, to the Whitted tracer. Colours are linear RGB in [0, 1].
struct WhittedMaterial {
    glm::vec3 diffuse{0.7f};  ///< Lambertian albedo
    std::optional<glm::vec3> otherTile =
        {};  ///< the albedo of every second tile of a checkered floor, in x and z
    float tileSize = 1;
    glm::vec3 mirror{0};      ///< of a metal, mirrored at normal incidence; towards grazing as Schlick has it
    float ior = 1;            ///< above 1: glass, or a clear coat that mirrors as Fresnel has it
    bool glass = false;       ///< what is not mirrored goes through; a closed solid
    glm::vec3 absorption{0};  ///< of glass: transmittance is exp(−absorption · length)
};

/// A parallelogram that shines to the side of cross(edgeU, edgeV), the same radiance everywhere.
struct AreaLight {
    glm::vec3 corner{0};
    glm::vec3 edgeU{1, 0, 0};
    glm::vec3 edgeV{0, 0, 1};
    glm::vec3 radiance{1};

    glm::vec3 at(glm::vec2 uv) const { return corner + uv.x * edgeU + uv.y * edgeV; }
    float area() const { return glm::length(glm::cross(edgeU, edgeV)); }
};

/// Where a ray meets a surface.
struct WhittedHit {
    double t = 0;
    glm::vec3 point{0};
    glm::vec3 pointError{0};      ///< how far each component may be off the surface
    glm::dvec3 normal{0, 1, 0};   ///< of the surface itself, unit length, out of its front
    glm::dvec3 shading{0, 1, 0};  ///< interpolated, unit length, on the same side
    bool front = true;            ///< the ray comes from the front
    std::uint32_t material = 0;
    std::int32_t light = -1;  ///< index of the light that was met; −1: a surface
};

/// What a Whitted picture is made of: triangles, solids and area lights. World space.
struct WhittedContents {
    struct Part {
        Mesh mesh;  ///< normals, if any, are interpolated
        std::uint32_t material = 0;
    };
    struct Solid {
        Csg shape;  ///< its parts' materials are indices into `materials`
    };
    std::vector<Part> parts;    ///< none of glass
    std::vector<Solid> solids;  ///< all of glass, or none of its parts
    std::vector<WhittedMaterial> materials;
    std::vector<AreaLight> lights;
    glm::vec3 skyZenith{0.2f, 0.3f, 0.5f};
    glm::vec3 skyHorizon{0.8f, 0.85f, 0.9f};
    glm::vec3 skyNadir{0.3f, 0.3f, 0.32f};
    glm::vec3 ambient{0.1f};  ///< radiance that stands for all light that is not traced
};

/// The same made ready for rays. Read by any number of threads.
class WhittedScene {
  public:
    /// InputError where a material's index is out of range, or where triangles are of glass.
    explicit WhittedScene(WhittedContents contents, Structure structure = Structure::wideBvh);
    using MakeAccelerator = std::function<std::unique_ptr<Accelerator>(TriangleView)>;
    WhittedScene(WhittedContents contents, const MakeAccelerator& make);

    const WhittedContents& contents() const { return contents_; }
    const Accelerator& triangles() const { return *accelerator_; }
    std::size_t triangleCount() const { return indices_.size() / 3; }
    TriangleView triangleView() const { return {positions_, indices_}; }
    const WhittedMaterial& material(std::uint32_t index) const { return contents_.materials[index]; }

    std::optional<WhittedHit> nearest(const Ray& ray, CsgScratch& scratch, TraversalCounts* counts) const;

    /// Something that is not glass in the interval, found by walking the structure.
    Blocker findBlocker(const Ray& ray, RayInterval interval, CsgScratch& scratch,
                        TraversalCounts* counts) const;
    /// Whether this one is: a single test, with the outcome that the structure would have.
    bool blocks(Blocker blocker, const Ray& ray, RayInterval interval, CsgScratch& scratch) const;
    /// What glass leaves of light along the ray, t from 0 to 1: Whitted's straight shadows, not refracted.
    glm::vec3 throughGlass(const Ray& ray, CsgScratch& scratch) const;

    glm::vec3 sky(glm::vec3 direction) const;

  private:
    /// A ray that passes a solid's box by far need not walk it.
    struct SolidBox {
        glm::dvec3 min{0};
        glm::dvec3 max{0};
        bool mayBeMet(const Ray& ray, double tMax) const;
    };
    Triangle triangle(std::uint32_t index) const { return triangleView()[index]; }

    WhittedContents contents_;
    std::vector<glm::vec3> positions_;
    std::vector<glm::vec3> normals_;  ///< by vertex; zero where the triangle's own is meant
    std::vector<std::uint32_t> indices_;
    std::vector<std::uint32_t> materialOfTriangle_;
    std::unique_ptr<Accelerator> accelerator_;
    std::vector<CsgSolid> solids_;
    std::vector<SolidBox> boxes_;  ///< by solid
    std::vector<bool> isGlass_;    ///< by solid
};

/// Where a ray starts that leaves a surface to the side of `direction`: the point moved along the normal by
/// the bound on its error, and outwards by the rounding of that. It lies on that side of the surface's
/// tangent plane. The surface's error and curvature must be small against its size. Held by LeaveSurface.*.
glm::vec3 leaveSurface(glm::vec3 point, glm::vec3 pointError, glm::dvec3 normal, glm::dvec3 direction);
/// The point moved along the normal by a constant, in float.
glm::vec3 leaveSurfaceNaive(glm::vec3 point, glm::vec3 normal, glm::vec3 direction, float epsilon);

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "trace/sampling.h"
#include "trace/trace_scene.h"

namespace quincunx {

/// Light on its way to a point, drawn at random.
struct LightDraw {
    glm::vec3 wi{0, 1, 0};  ///< world, unit length, towards the light
    /// Radiance over `density`; of lights without extent (then `delta`), irradiance on a surface that faces
    /// wi over the probability of the light. Whether anything stands in between is not looked at.
    glm::vec3 weight{0};
    float density = 0;  ///< per solid angle, of this direction from all lights; 0 of those without extent
    bool delta = false;
    bool endless = false;  ///< comes from infinitely far
    SurfacePoint end;      ///< where it starts, of what has a surface: position, error and normal
    glm::vec3 from{0};     ///< where it starts, of points and spots
};

/// All that shines in a scene: emissive triangles and balls, the lights of Scene::lights, the environment.
/// Solids other than balls shine too, but are not drawn here. Read by any number of threads.
class LightSet {
  public:
    explicit LightSet(const TraceScene& scene);

    bool empty() const { return lights_.empty(); }
    std::size_t size() const { return lights_.size(); }

    /// A light by the power that it sends out, and a place on it: triangles by area, the part of a ball that
    /// is seen by solid angle, the environment by radiance. Nothing where the light has its back turned or
    /// lies on the point.
    std::optional<LightDraw> draw(const TraceScene& scene, const SurfacePoint& to, float choice,
                                  glm::vec2 uv) const;
    /// The density of `draw`, per solid angle, in the direction of a point `seen` from `to`; 0 of what does
    /// not shine or is not drawn.
    float density(const SurfacePoint& to, const SurfacePoint& seen) const;
    /// The same of the environment.
    float density(glm::vec3 direction) const;

    /// What the environment sends from a unit direction; 0 without one.
    glm::vec3 environment(glm::vec3 direction) const;

  private:
    struct Shining {
        enum class Kind { triangle, ball, punctual, environment } kind = Kind::triangle;
        float power = 0;
        float area = 0;              ///< of triangles
        bool bothSides = false;      ///< of triangles
        std::uint32_t instance = 0;  ///< as SurfacePoint::instance
        std::uint32_t triangle = 0;
        std::uint32_t index = 0;  ///< of Scene::lights
        glm::vec3 a{0}, b{0}, c{0}, normal{0, 1, 0};
        glm::dvec3 centre{0};  ///< of balls
        double radius = 0;
    };
    std::optional<LightDraw> drawTriangle(const TraceScene& scene, const Shining& light,
                                          const SurfacePoint& to, glm::vec2 uv) const;
    std::optional<LightDraw> drawBall(const TraceScene& scene, const Shining& light, const SurfacePoint& to,
                                      glm::vec2 uv) const;
    std::optional<LightDraw> drawPunctual(const TraceScene& scene, const Shining& light,
                                          const SurfacePoint& to) const;
    std::optional<LightDraw> drawEnvironment(glm::vec2 uv) const;
    void addEnvironment(const Environment& environment, float sceneRadius);

    std::vector<Shining> lights_;
    std::optional<DiscreteDistribution> byPower_;
    std::vector<std::uint32_t> firstOfInstance_;  ///< into lightOfTriangle_; `none`: it does not shine
    std::vector<std::uint32_t> lightOfTriangle_;
    std::optional<std::size_t> environmentLight_;
    Image panorama_;  ///< RGB, tinted, finite
    std::optional<GridDistribution> panoramaDistribution_;
};

}  // namespace quincunx

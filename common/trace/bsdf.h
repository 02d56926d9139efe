#pragma once

#include <optional>
#include <variant>

#include <glm/glm.hpp>

#include "scene/scene.h"

/// How surfaces scatter light, for path tracing: value, density and sampling, each whole.
///
/// Everything is in the local frame: z is the unit shading normal on the surface's front, wo points to where
/// the light goes (the eye), wi to where it comes from; unit length; below the horizon is inside. Values are
/// the BSDF in 1/sr without the cosine; densities are per solid angle. `sample` draws wi of a given wo; its
/// weight is f |cos| / density, finite and no less than 0. Directions that are mirrored or refracted
/// perfectly are marked `delta`: their value and density are 0 in `evaluate` and `density`.
namespace quincunx {

struct BsdfSample {
    glm::vec3 wi{0, 0, 1};
    glm::vec3 weight{0};  ///< f |cos| / density; of delta directions, the share sent there / its probability
    float density = 0;    ///< 1/sr; of delta directions, the probability of having chosen this one
    bool delta = false;
    bool transmitted = false;
};

/// Albedo in [0, 1] a channel.
struct Lambert {
    glm::vec3 albedo{0.5f};
};

/// Lafortune and Willems' modified Phong model, normalized so that no more is sent back than comes.
struct PhongBsdf {
    glm::vec3 diffuse{0.5f};
    glm::vec3 specular{0.2f};
    float exponent = 32;  ///< ≥ 0
};

/// The same about the half vector.
struct BlinnPhongBsdf {
    glm::vec3 diffuse{0.5f};
    glm::vec3 specular{0.2f};
    float exponent = 32;  ///< ≥ 0
};

/// Metal: GGX, Smith shadowing and masking correlated by height, Schlick's Fresnel from f0 as in
/// shaders/lib/brdf.glsl, visible normals sampled. alpha 0 is a perfect mirror.
struct GgxConductor {
    glm::vec3 f0{0.9f};
    float alpha = 0.1f;
};

/// glTF's metallic–roughness mix: a diffuse part below a GGX one (shaders/lib/brdf.glsl).
struct MetallicRoughness {
    glm::vec3 diffuse{0.5f};
    glm::vec3 f0{0.04f};
    float alpha = 0.1f;
};

/// Glass: mirrors and refracts, exact Fresnel for dielectrics. The front is outside. `alpha` 0 is smooth.
struct Dielectric {
    float ior = 1.5f;   ///< of the inside over the outside, > 0
    float alpha = 0;    ///< GGX width
    glm::vec3 tint{1};  ///< of what goes through
};

using Bsdf = std::variant<Lambert, PhongBsdf, BlinnPhongBsdf, GgxConductor, MetallicRoughness, Dielectric>;

/// f(wo, wi) in 1/sr; finite, ≥ 0; 0 for delta directions.
glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 wo, glm::vec3 wi);
/// The density of `sample` at wi, in 1/sr; 0 for delta directions.
float density(const Bsdf& bsdf, glm::vec3 wo, glm::vec3 wi);
/// Draws wi by three uniform numbers in [0, 1): `choice` for the lobe. Nothing where all light is absorbed.
std::optional<BsdfSample> sample(const Bsdf& bsdf, glm::vec3 wo, float choice, glm::vec2 uv);
/// Whether every direction it sends light to is a delta one.
bool isDelta(const Bsdf& bsdf);

/// What a material is at a point, its textures multiplied in already: glass by `transmission`, metal and
/// plastic by the metallic–roughness numbers.
struct MaterialValues {
    glm::vec3 baseColor{1};
    float metallic = 0;
    float roughness = 0.5f;
    float transmission = 0;
    float ior = 1.5f;
};
Bsdf bsdfOf(const MaterialValues& material);

}  // namespace quincunx

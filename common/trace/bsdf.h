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
///
/// Values are reciprocal, and of a white surface no more is sent back than comes (the mix of
/// MetallicRoughness excepted). Opaque surfaces are black from below. Radiance is carried: through glass it
/// grows by the square of the index of the eye's side over the light's side, as light is squeezed into
/// narrower cones in denser matter, so that f(wo, wi) of glass over the square of the index of wo's side is
/// reciprocal, and its weights exceed 1 where the eye is in the glass; what goes in and out again has both
/// factors, whose product is 1.
///
/// Computed in double from directions in float. A direction's last digit turns it by 6e-8, and a lobe of
/// width alpha varies by 4 times 6e-8 / alpha over that: 0.3 % at the least alpha, 1e-4. Weights of GGX
/// samples do without the distribution and have no such noise. Held by Bsdf.*.
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

/// Lafortune and Willems' modified Phong model ("Using the modified Phong reflectance model for physically
/// based rendering", 1994), normalized so that no more is sent back than comes: (exponent + 2) / 2π, all of
/// it from straight above.
struct PhongBsdf {
    glm::vec3 diffuse{0.5f};
    glm::vec3 specular{0.2f};
    float exponent = 32;  ///< ≥ 0
};

/// The same about the half vector: normalized by (n + 2)(n + 4) / (8π (n + 2^(-n/2))), n the exponent, by
/// which all is sent back from straight above and less from elsewhere.
struct BlinnPhongBsdf {
    glm::vec3 diffuse{0.5f};
    glm::vec3 specular{0.2f};
    float exponent = 32;  ///< ≥ 0
};

/// Metal: GGX, Smith shadowing and masking correlated by height, Schlick's Fresnel from f0 as in
/// shaders/lib/brdf.glsl, visible normals sampled. alpha 0 is a perfect mirror; else it is
/// 1e-4 at least.
struct GgxConductor {
    glm::vec3 f0{0.9f};
    float alpha = 0.1f;
};

/// glTF's metallic–roughness mix: a diffuse part below a GGX one (shaders/lib/brdf.glsl), the same value
/// divided by π and the cosine. White plastic sends back more than comes at grazing angles: smooth, 1.025
/// times at 60° from the normal and 1.7 at 87°; of roughness 0.7, 1.05 at 87°.
struct MetallicRoughness {
    glm::vec3 diffuse{0.5f};
    glm::vec3 f0{0.04f};
    float alpha = 0.1f;
};

/// Glass: mirrors and refracts, exact Fresnel for dielectrics. The front is outside. `alpha` 0 is smooth;
/// rough glass is that of Walter et al. (EGSR 2007), with heights correlated for what is mirrored and
/// independent for what goes through. A lobe that is bent by less than 2^-20 (alpha |ior − 1|) no direction
/// in float can tell: it counts as smooth.
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
/// Both at the cost of one.
struct BsdfValue {
    glm::vec3 value{0};
    float density = 0;
};
BsdfValue evaluateWithDensity(const Bsdf& bsdf, glm::vec3 wo, glm::vec3 wi);
/// Draws wi by three uniform numbers in [0, 1): `choice` for the lobe. Nothing where all light is absorbed.
std::optional<BsdfSample> sample(const Bsdf& bsdf, glm::vec3 wo, float choice, glm::vec2 uv);
/// Whether every direction it sends light to is a delta one.
bool isDelta(const Bsdf& bsdf);

/// The textbook's lobe of microfacets without Fresnel's share, in float: D G / (4 n·wo n·wi), D by the cosine
/// of the half vector to `exponent`, G = min(1, 2 n·h n·wo / wo·h, 2 n·h n·wi / wo·h) (Cook, Torrance 1982).
/// For `stress` alone.
float microfacetLobeNaive(glm::vec3 wo, glm::vec3 wi, float exponent);

/// What a material is at a point, its textures multiplied in already: glass by `transmission` (from ½ up),
/// metal and plastic by the metallic–roughness numbers.
struct MaterialValues {
    glm::vec3 baseColor{1};
    float metallic = 0;
    float roughness = 0.5f;
    float transmission = 0;
    float ior = 1.5f;
};
Bsdf bsdfOf(const MaterialValues& material);

}  // namespace quincunx

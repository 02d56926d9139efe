#include "trace/bsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "math/vector.h"
#include "trace/brdf_glsl.h"
#include "trace/fresnel.h"
#include "trace/microfacet.h"
#include "trace/sampling.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;

constexpr double invPi = std::numbers::inv_pi;

/// A value and the density of `sample` there.
struct Scattering {
    dvec3 value{0};
    double density = 0;
};

float finite(double x) {
    return static_cast<float>(std::min(x, static_cast<double>(std::numeric_limits<float>::max())));
}
vec3 finite(const dvec3& v) {
    return {finite(v.x), finite(v.y), finite(v.z)};
}

double largest(vec3 v) {
    return std::max({v.x, v.y, v.z});
}

bool bothAbove(vec3 wo, vec3 wi) {
    return wo.z > 0 && wi.z > 0;
}

double widthOf(float alpha) {
    return std::max(alpha, glsl::leastAlpha);
}

dvec3 schlick(vec3 f0, double cosine) {
    const double x = 1 - std::min(cosine, 1.0);
    const double xx = x * x;
    return dvec3(f0) + (1.0 - dvec3(f0)) * (xx * xx * x);
}

/// The sample in direction wi, weighed by its value and density.
std::optional<BsdfSample> weighed(vec3 wi, const Scattering& s) {
    if (!(s.density > 0))
        return std::nullopt;
    return BsdfSample{.wi = wi,
                      .weight = finite(s.value * (std::abs(static_cast<double>(wi.z)) / s.density)),
                      .density = finite(s.density)};
}

vec3 mirrored(vec3 wo) {
    return {-wo.x, -wo.y, wo.z};
}

/// wo mirrored by a unit vector.
vec3 mirroredBy(const dvec3& h, vec3 wo) {
    const dvec3 o(wo);
    return vec3(2 * glm::dot(o, h) * h - o);
}

/// cosine^exponent of an angle up to 90° (0 there, for exponent 0 too) by the square of its sine, which is
/// right where the cosine is near 1.
double cosinePower(double sine2, double exponent) {
    return sine2 < 1 ? std::exp(0.5 * exponent * std::log1p(-sine2)) : 0;
}

/// 1 − cosine of a direction that is drawn with a density of cosine^exponent.
float versineOfPower(float exponent, float u) {
    return static_cast<float>(-std::expm1(std::log1p(-static_cast<double>(u)) / (exponent + 1.0)));
}

// Lambert

Scattering scattering(const Lambert& bsdf, vec3 wo, vec3 wi) {
    if (!bothAbove(wo, wi))
        return {};
    return {dvec3(bsdf.albedo) * invPi, wi.z * invPi};
}

std::optional<BsdfSample> draw(const Lambert& bsdf, vec3 wo, float /*choice*/, vec2 uv) {
    const DirectionSample drawn = sampleCosineHemisphere(uv);
    if (!bothAbove(wo, drawn.direction) || !(largest(bsdf.albedo) > 0))
        return std::nullopt;
    return BsdfSample{.wi = drawn.direction, .weight = bsdf.albedo, .density = drawn.density};
}

// Phong's and Blinn's lobes over a diffuse part

/// How likely the first of two lobes is drawn, by what they weigh.
double shareOf(double first, double second) {
    return first > 0 ? first / (first + second) : 0;
}

Scattering scattering(const PhongBsdf& bsdf, vec3 wo, vec3 wi) {
    if (!bothAbove(wo, wi))
        return {};
    const dvec3 mirror(mirrored(wo));
    const dvec3 light(wi);
    double lobe = 0;
    if (glm::dot(mirror, light) > 0) {
        const dvec3 across = glm::cross(mirror, light);
        const double lengths2 = glm::dot(mirror, mirror) * glm::dot(light, light);
        lobe = cosinePower(glm::dot(across, across) / lengths2, bsdf.exponent) * (0.5 * invPi);
    }
    const double p = shareOf(largest(bsdf.specular), largest(bsdf.diffuse));
    return {dvec3(bsdf.diffuse) * invPi + dvec3(bsdf.specular) * (lobe * (bsdf.exponent + 2.0)),
            p * lobe * (bsdf.exponent + 1.0) + (1 - p) * wi.z * invPi};
}

/// Of the light that arrives from straight above, the lobe without this factor sends back its inverse.
double blinnFactor(double exponent) {
    return (exponent + 2) * (exponent + 4) / (exponent + std::exp2(-0.5 * exponent)) * (0.125 * invPi);
}

Scattering scattering(const BlinnPhongBsdf& bsdf, vec3 wo, vec3 wi) {
    if (!bothAbove(wo, wi))
        return {};
    const dvec3 sum = dvec3(wo) + dvec3(wi);
    const double squared = glm::dot(sum, sum);
    const double facing = 0.5 * std::sqrt(squared);
    const double lobe = cosinePower((sum.x * sum.x + sum.y * sum.y) / squared, bsdf.exponent);
    const double p = shareOf(largest(bsdf.specular), largest(bsdf.diffuse));
    return {dvec3(bsdf.diffuse) * invPi + dvec3(bsdf.specular) * (lobe * blinnFactor(bsdf.exponent)),
            p * lobe * (bsdf.exponent + 1.0) * (0.125 * invPi) / facing + (1 - p) * wi.z * invPi};
}

/// About the mirror image of wo.
vec3 drawLobe(const PhongBsdf& bsdf, vec3 wo, vec2 uv) {
    const DirectionSample local = sampleCone(versineOfPower(bsdf.exponent, uv.x), vec2(1, uv.y));
    return vec3(*basisAround(dvec3(mirrored(wo))) * dvec3(local.direction));
}
/// By a half vector about the normal.
vec3 drawLobe(const BlinnPhongBsdf& bsdf, vec3 wo, vec2 uv) {
    const DirectionSample half = sampleCone(versineOfPower(bsdf.exponent, uv.x), vec2(1, uv.y));
    if (!(glm::dot(dvec3(half.direction), dvec3(wo)) > 0))
        return vec3(0);
    return mirroredBy(dvec3(half.direction), wo);
}

template <typename PhongLike>
std::optional<BsdfSample> drawPhong(const PhongLike& bsdf, vec3 wo, float choice, vec2 uv) {
    const double specular = largest(bsdf.specular);
    const double diffuse = largest(bsdf.diffuse);
    if (!(wo.z > 0 && specular + diffuse > 0))
        return std::nullopt;
    const vec3 wi =
        choice < shareOf(specular, diffuse) ? drawLobe(bsdf, wo, uv) : sampleCosineHemisphere(uv).direction;
    return weighed(wi, scattering(bsdf, wo, wi));
}

std::optional<BsdfSample> draw(const PhongBsdf& bsdf, vec3 wo, float choice, vec2 uv) {
    return drawPhong(bsdf, wo, choice, uv);
}
std::optional<BsdfSample> draw(const BlinnPhongBsdf& bsdf, vec3 wo, float choice, vec2 uv) {
    return drawPhong(bsdf, wo, choice, uv);
}

// GGX

/// D G2 / (4 cos cos), the density of mirroring at visible normals, and the cosine at the half vector.
struct GgxLobe {
    double value = 0;
    double density = 0;
    double facing = 1;
};

GgxLobe ggxLobe(vec3 wo, vec3 wi, double alpha) {
    const dvec3 sum = dvec3(wo) + dvec3(wi);
    const double d = ggx::distribution(sum, alpha);
    return {d * ggx::visibility(wi.z, wo.z, alpha), 0.25 * d * ggx::maskingOverCosine(wo.z, alpha),
            0.5 * std::sqrt(glm::dot(sum, sum))};
}

bool isSmooth(const GgxConductor& bsdf) {
    return !(bsdf.alpha > 0);
}

Scattering scattering(const GgxConductor& bsdf, vec3 wo, vec3 wi) {
    if (isSmooth(bsdf) || !bothAbove(wo, wi))
        return {};
    const GgxLobe lobe = ggxLobe(wo, wi, widthOf(bsdf.alpha));
    return {schlick(bsdf.f0, lobe.facing) * lobe.value, lobe.density};
}

std::optional<BsdfSample> draw(const GgxConductor& bsdf, vec3 wo, float /*choice*/, vec2 uv) {
    if (!(wo.z > 0))
        return std::nullopt;
    if (isSmooth(bsdf))
        return BsdfSample{
            .wi = mirrored(wo), .weight = vec3(schlick(bsdf.f0, wo.z)), .density = 1, .delta = true};
    const double alpha = widthOf(bsdf.alpha);
    const vec3 wi = mirroredBy(ggx::visibleNormal(dvec3(wo), alpha, uv), wo);
    if (!(wi.z > 0))
        return std::nullopt;
    const GgxLobe lobe = ggxLobe(wo, wi, alpha);
    // D cancels from value over density, and with it the noise that rounding wi makes in a narrow lobe.
    return BsdfSample{
        .wi = wi,
        .weight = vec3(schlick(bsdf.f0, lobe.facing) * ggx::shadowingOfUnmasked(wi.z, wo.z, alpha)),
        .density = finite(lobe.density)};
}

/// How likely the mirroring lobe is drawn. A little at least, since f0 says nothing of half vectors that are
/// more grazing than the normal.
double mirrorShare(const MetallicRoughness& bsdf, double cosine) {
    const double mirror = largest(vec3(schlick(bsdf.f0, cosine)));
    const double diffuse = largest(bsdf.diffuse) * (1 - mirror);
    return diffuse > 0 ? std::clamp(mirror / (mirror + diffuse), 0.125, 0.875) : 1;
}

Scattering scattering(const MetallicRoughness& bsdf, vec3 wo, vec3 wi) {
    if (!bothAbove(wo, wi))
        return {};
    const GgxLobe lobe = ggxLobe(wo, wi, widthOf(bsdf.alpha));
    const dvec3 fresnel = schlick(bsdf.f0, lobe.facing);
    const double p = mirrorShare(bsdf, wo.z);
    return {(1.0 - fresnel) * dvec3(bsdf.diffuse) * invPi + fresnel * lobe.value,
            p * lobe.density + (1 - p) * wi.z * invPi};
}

std::optional<BsdfSample> draw(const MetallicRoughness& bsdf, vec3 wo, float choice, vec2 uv) {
    if (!(wo.z > 0))
        return std::nullopt;
    const vec3 wi = choice < mirrorShare(bsdf, wo.z)
                        ? mirroredBy(ggx::visibleNormal(dvec3(wo), widthOf(bsdf.alpha), uv), wo)
                        : sampleCosineHemisphere(uv).direction;
    return weighed(wi, scattering(bsdf, wo, wi));
}

// Glass

bool isSmooth(const Dielectric& bsdf) {
    return !(bsdf.alpha > 0) || widthOf(bsdf.alpha) * std::abs(bsdf.ior - 1.0) < 0x1p-20;
}

/// The far side's index over that of wo's side.
double etaSeenFrom(const Dielectric& bsdf, vec3 wo) {
    return wo.z > 0 ? bsdf.ior : 1 / static_cast<double>(bsdf.ior);
}

/// With wo's side as above.
dvec3 seenFrom(vec3 wo, const dvec3& v) {
    return wo.z > 0 ? v : dvec3(v.x, v.y, -v.z);
}

Scattering scattering(const Dielectric& bsdf, vec3 wo, vec3 wi) {
    if (isSmooth(bsdf) || wo.z == 0 || wi.z == 0)
        return {};
    const double alpha = widthOf(bsdf.alpha);
    const double eta = etaSeenFrom(bsdf, wo);
    const dvec3 o = seenFrom(wo, dvec3(wo));
    const dvec3 i = seenFrom(wo, dvec3(wi));
    if (i.z > 0) {
        const GgxLobe lobe = ggxLobe(vec3(o), vec3(i), alpha);
        const double share = shareAtBoundary(std::min(lobe.facing, 1.0), eta).mirrored;
        return {dvec3(share * lobe.value), share * lobe.density};
    }
    // Snell: o + eta i is along the microfacet's normal; of exact unit length, so that both cosines with it
    // obey the law and Fresnel's share is the same either way, at grazing angles too.
    const dvec3 eye = o / std::sqrt(glm::dot(o, o));
    const dvec3 light = i / std::sqrt(glm::dot(i, i));
    const dvec3 along = eye + eta * light;
    const double squared = glm::dot(along, along);
    const double length = std::copysign(std::sqrt(squared), along.z);
    const double cosEye = glm::dot(eye, along) / length;
    const double cosLight = -glm::dot(light, along) / length;
    if (!(squared > 0 && cosEye > 0 && cosLight > 0))
        return {};
    const double through = 1 - shareAtBoundary(std::min(cosEye, 1.0), eta).mirrored;
    const double visible =
        ggx::distribution(along, alpha) * ggx::maskingOverCosine(o.z, alpha) * cosEye * cosLight / squared;
    return {dvec3(bsdf.tint) * (through * visible * ggx::maskingOverCosine(-i.z, alpha)),
            through * visible * (eta * eta)};
}

std::optional<BsdfSample> draw(const Dielectric& bsdf, vec3 wo, float choice, vec2 uv) {
    if (wo.z == 0)
        return std::nullopt;
    const bool smooth = isSmooth(bsdf);
    const double alpha = widthOf(bsdf.alpha);
    const double eta = etaSeenFrom(bsdf, wo);
    const dvec3 o = seenFrom(wo, dvec3(wo));
    const dvec3 h = smooth ? dvec3(0, 0, 1) : ggx::visibleNormal(o, alpha, uv);
    const double cosine = std::min(glm::dot(o, h), 1.0);
    const BoundaryShare boundary = shareAtBoundary(std::max(cosine, 0.0), eta);
    const bool mirrors = choice < boundary.mirrored;
    dvec3 i = 2 * cosine * h - o;
    if (!mirrors) {
        i = (cosine / eta - boundary.cosTransmitted) * h - o / eta;
        i /= std::sqrt(glm::dot(i, i));
    }
    const vec3 wi(seenFrom(wo, i));
    if (wi.z == 0 || (i.z > 0) != mirrors)
        return std::nullopt;
    BsdfSample sample{.wi = wi, .delta = smooth, .transmitted = !mirrors};
    double shadowing = 1;
    if (smooth) {
        sample.density = static_cast<float>(mirrors ? boundary.mirrored : 1 - boundary.mirrored);
    } else {
        sample.density = finite(scattering(bsdf, wo, wi).density);
        shadowing =
            mirrors ? ggx::shadowingOfUnmasked(i.z, o.z, alpha) : -i.z * ggx::maskingOverCosine(-i.z, alpha);
    }
    if (!(sample.density > 0) || (!mirrors && !(largest(bsdf.tint) > 0)))
        return std::nullopt;
    sample.weight = mirrors ? vec3(static_cast<float>(shadowing))
                            : bsdf.tint * static_cast<float>(shadowing / (eta * eta));
    return sample;
}

}  // namespace

vec3 evaluate(const Bsdf& bsdf, vec3 wo, vec3 wi) {
    return std::visit([&](const auto& model) { return finite(scattering(model, wo, wi).value); }, bsdf);
}

BsdfValue evaluateWithDensity(const Bsdf& bsdf, vec3 wo, vec3 wi) {
    return std::visit(
        [&](const auto& model) {
            const Scattering s = scattering(model, wo, wi);
            return BsdfValue{finite(s.value), finite(s.density)};
        },
        bsdf);
}

float density(const Bsdf& bsdf, vec3 wo, vec3 wi) {
    return std::visit([&](const auto& model) { return finite(scattering(model, wo, wi).density); }, bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, vec3 wo, float choice, vec2 uv) {
    return std::visit([&](const auto& model) { return draw(model, wo, choice, uv); }, bsdf);
}

bool isDelta(const Bsdf& bsdf) {
    return std::visit(
        [](const auto& model) {
            if constexpr (requires { isSmooth(model); })
                return isSmooth(model);
            else
                return false;
        },
        bsdf);
}

float microfacetLobeNaive(glm::vec3 wo, glm::vec3 wi, float exponent) {
    const glm::vec3 h = glm::normalize(wo + wi);
    const float d = (exponent + 2) * (0.5f * std::numbers::inv_pi_v<float>)*std::pow(h.z, exponent);
    const float along = glm::dot(wo, h);
    const float g = std::min(1.0f, std::min(2 * h.z * wo.z / along, 2 * h.z * wi.z / along));
    return d * g / (4 * wo.z * wi.z);
}

Bsdf bsdfOf(const MaterialValues& material) {
    const float roughness = std::clamp(material.roughness, 0.0f, 1.0f);
    if (material.transmission >= 0.5f) {
        const float alpha = roughness * roughness;
        return Dielectric{material.ior, alpha < glsl::leastAlpha ? 0 : alpha, material.baseColor};
    }
    const glsl::MicrofacetSurface surface =
        glsl::metallicRoughness(material.baseColor, material.metallic, roughness);
    if (material.metallic >= 1)
        return GgxConductor{surface.f0, surface.alpha};
    return MetallicRoughness{surface.diffuse, surface.f0, surface.alpha};
}

}  // namespace quincunx

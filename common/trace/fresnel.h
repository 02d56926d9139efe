#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/glm.hpp>

/// How much of unpolarized light a smooth boundary mirrors, and where the rest goes.
///
/// Cosines are those of the angle between the ray and the normal on the ray's side; their magnitude is taken,
/// at most 1. `eta` is the index of refraction of the far side over that of the ray's side, > 0, so below 1
/// where the ray leaves glass. All is computed in double and rounded once. The forms `...Naive` are for
/// `stress` alone.
namespace quincunx {

/// What a boundary does with a ray.
struct BoundaryShare {
    double mirrored = 1;        ///< in [0, 1]
    double cosTransmitted = 0;  ///< > 0, of the refracted ray and the normal; 0 where all is mirrored
};

/// In double, for scattering models that go on with the figures; cosine in [0, 1].
///
/// With g = eta cosTransmitted, g² = eta² − 1 + cosine², Fresnel's two amplitudes are
///   −(eta² − 1) / (cosine + g)²  and  (eta² − 1)(cosine² (eta² + 1) − 1) / (eta² cosine + g)²:
/// differences of near numbers, which the textbook's forms have in their numerators, are multiplied out, so
/// that nothing is lost for eta near 1 or at grazing angles (Born, Wolf, "Principles of optics", 1.5.2; g as
/// Cook, Torrance, ACM TOG 1(1), 1982).
inline BoundaryShare shareAtBoundary(double cosine, double eta) {
    const double e = (eta - 1) * (eta + 1);
    const double g2 = e + cosine * cosine;
    if (!(g2 > 0))
        return e == 0 ? BoundaryShare{0, cosine} : BoundaryShare{};
    const double g = std::sqrt(g2);
    const double sum = cosine + g;
    const double product = eta * eta * cosine + g;
    const double across = e / (sum * sum);
    const double along = e * (cosine * cosine * (eta * eta + 1) - 1) / (product * product);
    return {std::min(0.5 * (across * across + along * along), 1.0), g / eta};
}

/// The share mirrored by a boundary of two dielectrics, to 0.5 ulp + 2^-20, in [0, 1] always. 1 exactly where
/// all light is mirrored, which is decided by the exact sign of eta² − 1 + cosine². 0 for eta = 1. eta in
/// 2^-60 … 2^60. Held by FresnelDielectric.*.
float fresnelDielectric(float cosine, float eta);
/// Snell's law and the two quotients of the cosines, in float.
float fresnelDielectricNaive(float cosine, float eta);

/// The share mirrored by a metal of complex index eta + i k, k ≥ 0 (over that of the ray's side, eta + k >
/// 0), to 0.5 ulp + 2^-20. As Born and Wolf, 14.2, whose a and b, a + i b = √((eta + i k)² − sin²), come from
/// the root of a quadratic that does not cancel. For k = 0 it is `fresnelDielectric`. eta, k ≤ 2^60. Held by
/// FresnelConductor.*.
float fresnelConductor(float cosine, float eta, float k);
float fresnelConductorNaive(float cosine, float eta, float k);

/// Schlick's polynomial f0 + (1 − f0)(1 − cosine)^5 ("An inexpensive BRDF model for physically-based
/// rendering", 1994). It knows no total reflection: from inside it must be given the cosine of the outer
/// angle. Against the exact share it is off by 0.037 at most for eta = 1.5, at 85°; for other indices see
/// Schlick.*.
float fresnelSchlick(float f0, float cosine);
/// What a boundary mirrors at normal incidence: ((eta − 1) / (eta + 1))².
float normalReflectance(float eta);

/// The unit direction in which a ray goes on behind a boundary, or nothing where all light is mirrored.
/// `towardsSurface` and `normal` may have any lengths in 2^-20 … 2^20, the normal either side. Whether all is
/// mirrored is decided exactly for the given numbers: |n × d|² against eta² |n|² |d|². Components are
/// within 3.1e-8 (half an ulp of 1, and 2^-33), however near that the ray is to it. In double; where eta²
/// |n|² |d|² − |n × d|² loses more than 34 bits it is summed without rounding. None for vectors of length 0.
/// eta in 2^-20 … 2^20. Held by Refract.*.
std::optional<glm::vec3> refract(glm::vec3 towardsSurface, glm::vec3 normal, float eta);
/// k = 1 − (1 − (n·d)²) / eta², in float; both of unit length.
std::optional<glm::vec3> refractNaive(glm::vec3 towardsSurface, glm::vec3 normal, float eta);

}  // namespace quincunx

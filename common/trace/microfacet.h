#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/glm.hpp>

/// GGX, the microfacet distribution of Trowbridge and Reitz (1975), as Walter et al., "Microfacet models for
/// refraction through rough surfaces", EGSR 2007, name it; Smith's shadowing and masking.
///
/// The local frame: z is the unit normal; unit vectors point away from the surface. `alpha` is the width of
/// the distribution, the tangent of the angle at which the slopes are half as dense in √; it is taken as 1e-4
/// at least
/// (`leastAlpha` of shaders/lib/brdf.glsl), as a narrower lobe is finer than directions in float can tell.
/// The forms `...Naive` are for `stress` alone.
namespace quincunx {

/// In double, for scattering models that go on with the figures; alpha ≥ 1e-4.
namespace ggx {

/// D of a direction h of any length but 0, z ≥ 0, per steradian: α² |h|⁴ / (π (x² + y² + α² z²)²). A sum of
/// squares: nothing cancels. Within 2^-50, relative.
inline double distribution(const glm::dvec3& h, double alpha) {
    const double a2 = alpha * alpha;
    const double sine2 = h.x * h.x + h.y * h.y;
    const double quotient = (sine2 + h.z * h.z) / (sine2 + a2 * (h.z * h.z));
    return a2 * std::numbers::inv_pi * quotient * quotient;
}
/// √(α² + (1 − α²) cos²): cos √(1 + α² tan²), which grazing angles leave finite.
inline double spread(double cosine, double alpha) {
    return std::sqrt(alpha * alpha + (1 - alpha) * (1 + alpha) * (cosine * cosine));
}
/// G2 / (4 cos cos), heights correlated (Heitz, "Understanding the masking-shadowing function in
/// microfacet-based BRDFs", JCGT 3(2), 2014, equation 99). Not both cosines 0.
inline double visibility(double cosLight, double cosEye, double alpha) {
    return 0.5 / (cosLight * spread(cosEye, alpha) + cosEye * spread(cosLight, alpha));
}
/// G1 / cos.
inline double maskingOverCosine(double cosine, double alpha) {
    return 2 / (cosine + spread(cosine, alpha));
}
/// G2 / G1(cosEye): what is left of light by shadowing alone, in [0, 1]. Not both cosines 0.
inline double shadowingOfUnmasked(double cosLight, double cosEye, double alpha) {
    const double masking = spread(cosEye, alpha);
    return cosLight * (cosEye + masking) / (cosLight * masking + cosEye * spread(cosLight, alpha));
}
/// A microfacet normal as seen from wo, z ≥ 0; of unit length.
glm::dvec3 visibleNormal(const glm::dvec3& wo, double alpha, glm::vec2 uv);

}  // namespace ggx

/// D(h), the area of microfacets a solid angle of their normals, in 1/sr, of a normal and a half vector of
/// any lengths (squares within the range of double): |n × h|² + α² (n·h)² in double, where the textbook's
/// n·h² (α² − 1) + 1 has nothing left at the peak. To 0.5 ulp + 2^-20. 0 for h below the horizon and for
/// vectors of length 0. Held by GgxDistribution.*.
float ggxDistribution(glm::vec3 n, glm::vec3 h, float alpha);
/// ((n·h)² (α² − 1) + 1), in float, of unit vectors; no least alpha.
float ggxDistributionNaive(glm::vec3 n, glm::vec3 h, float alpha);

/// The share of microfacets of any normal that a direction sees: 2 cos / (cos + √(α² + (1 − α²) cos²)), to
/// 0.5 ulp
/// + 2^-20; 0 for cosines ≤ 0. Held by Smith.*.
float smithG1(float cosine, float alpha);
/// 2 / (1 + √(1 + α² (1 − cos²) / cos²)), in float.
float smithG1Naive(float cosine, float alpha);
/// Those that both directions see, heights correlated; 0 unless both cosines are above 0. Error as smithG1.
float smithG2(float cosLight, float cosEye, float alpha);
/// G2 / (4 cosLight cosEye), at most the largest float; 0 unless both cosines are above 0. Error as smithG1.
float smithVisibility(float cosLight, float cosEye, float alpha);
/// G1 G1 / (4 cosLight cosEye), in float.
float smithVisibilityNaive(float cosLight, float cosEye, float alpha);

/// A microfacet normal, of those that wo (z ≥ 0) sees (Heitz, "Sampling the GGX distribution of visible
/// normals", JCGT 7(4), 2018; by spherical caps as Dupuy and Benyoub, "Sampling visible GGX normals with
/// spherical caps", HPG 2023). In double, with 1 − z of the cap carried instead of z, so that nothing cancels
/// for small alpha or at grazing angles. Unit length to 6e-8, z ≥ 0.
glm::vec3 sampleVisibleNormal(glm::vec3 wo, float alpha, glm::vec2 uv);
/// Its density, per steradian of normals: G1(wo) max(0, wo·h) D(h) / wo.z.
float visibleNormalDensity(glm::vec3 wo, glm::vec3 h, float alpha);

}  // namespace quincunx

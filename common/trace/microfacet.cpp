#include "trace/microfacet.h"

#include <limits>

#include "trace/brdf_glsl.h"

namespace quincunx {
namespace {

constexpr double largestFloat = std::numeric_limits<float>::max();

double widthOf(float alpha) {
    return std::max(alpha, glsl::leastAlpha);
}

}  // namespace

namespace ggx {

glm::dvec3 visibleNormal(const glm::dvec3& wo, double alpha, glm::vec2 uv) {
    // Stretched so that the surface is a hemisphere, whose normals seen from wo mirror it to a spherical cap.
    glm::dvec3 o(alpha * wo.x, alpha * wo.y, wo.z);
    o /= std::sqrt(glm::dot(o, o));
    const double v = uv.y;
    const double versine = v * (1 + o.z);
    const double sine = std::sqrt(std::max(0.0, versine * (2 - versine)));
    const double angle = 2 * std::numbers::pi * uv.x;
    // The cap's height 1 − versine plus o.z is (1 − v)(1 + o.z).
    const double x = sine * std::cos(angle) + o.x;
    const double y = sine * std::sin(angle) + o.y;
    const glm::dvec3 h(alpha * x, alpha * y, (1 - v) * (1 + o.z));
    const double squared = glm::dot(h, h);
    return squared > 0 ? h / std::sqrt(squared) : glm::dvec3(0, 0, 1);
}

}  // namespace ggx

float ggxDistribution(glm::vec3 n, glm::vec3 h, float alpha) {
    const glm::dvec3 normal(n);
    const glm::dvec3 half(h);
    const double cosine = glm::dot(normal, half);
    if (!(cosine > 0))
        return 0;
    const glm::dvec3 sine = glm::cross(normal, half);
    const double a2 = widthOf(alpha) * widthOf(alpha);
    const double quotient =
        glm::dot(normal, normal) * glm::dot(half, half) / (glm::dot(sine, sine) + a2 * (cosine * cosine));
    return static_cast<float>(a2 * std::numbers::inv_pi * (quotient * quotient));
}

float ggxDistributionNaive(glm::vec3 n, glm::vec3 h, float alpha) {
    const float cosine = std::max(glm::dot(n, h), 0.0f);
    const float a2 = alpha * alpha;
    const float below = cosine * cosine * (a2 - 1) + 1;
    return a2 / (std::numbers::pi_v<float> * below * below);
}

float smithG1(float cosine, float alpha) {
    if (!(cosine > 0))
        return 0;
    const double c = std::min(cosine, 1.0f);
    return static_cast<float>(c * ggx::maskingOverCosine(c, widthOf(alpha)));
}

float smithG1Naive(float cosine, float alpha) {
    const float tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return 2 / (1 + std::sqrt(1 + alpha * alpha * tangent2));
}

float smithG2(float cosLight, float cosEye, float alpha) {
    if (!(cosLight > 0 && cosEye > 0))
        return 0;
    const double l = std::min(cosLight, 1.0f);
    const double v = std::min(cosEye, 1.0f);
    return static_cast<float>(4 * l * v * ggx::visibility(l, v, widthOf(alpha)));
}

float smithVisibility(float cosLight, float cosEye, float alpha) {
    if (!(cosLight > 0 && cosEye > 0))
        return 0;
    const double l = std::min(cosLight, 1.0f);
    const double v = std::min(cosEye, 1.0f);
    return static_cast<float>(std::min(ggx::visibility(l, v, widthOf(alpha)), largestFloat));
}

float smithVisibilityNaive(float cosLight, float cosEye, float alpha) {
    return smithG1Naive(cosLight, alpha) * smithG1Naive(cosEye, alpha) / (4 * cosLight * cosEye);
}

glm::vec3 sampleVisibleNormal(glm::vec3 wo, float alpha, glm::vec2 uv) {
    return glm::vec3(ggx::visibleNormal(glm::dvec3(wo), widthOf(alpha), uv));
}

float visibleNormalDensity(glm::vec3 wo, glm::vec3 h, float alpha) {
    const double facing = glm::dot(glm::dvec3(wo), glm::dvec3(h));
    if (!(facing > 0 && h.z >= 0 && wo.z >= 0))
        return 0;
    const double width = widthOf(alpha);
    return static_cast<float>(ggx::maskingOverCosine(wo.z, width) * facing *
                              ggx::distribution(glm::dvec3(h), width));
}

}  // namespace quincunx

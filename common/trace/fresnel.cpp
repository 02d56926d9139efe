#include "trace/fresnel.h"

#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

Expansion dotExact(glm::vec3 a, glm::vec3 b) {
    return Expansion::product(a.x, b.x) + Expansion::product(a.y, b.y) + Expansion::product(a.z, b.z);
}

/// eta² |n|² |d|² − |n × d|², with |n × d|² = |n|² |d|² − (n·d)².
double coTangentialExact(glm::vec3 d, glm::vec3 n, float eta) {
    const Expansion lengths = dotExact(n, n) * dotExact(d, d);
    return ((Expansion::product(eta, eta) - Expansion(1.0)) * lengths + dotExact(n, d).squared())
        .approximate();
}

}  // namespace

float fresnelDielectric(float cosine, float eta) {
    const float c = std::min(std::abs(cosine), 1.0f);
    // The products are exact and their sum is as `dotInDouble`'s: g² has the exact sign.
    const double g2 = dotInDouble({eta, c, 1}, {eta, c, -1});
    const double e = (static_cast<double>(eta) - 1) * (static_cast<double>(eta) + 1);
    if (e == 0)
        return 0;
    if (!(g2 > 0))
        return 1;
    const double g = std::sqrt(g2);
    const double eta2 = static_cast<double>(eta) * eta;
    const double c2 = static_cast<double>(c) * c;
    const double sum = c + g;
    const double product = eta2 * c + g;
    const double across = e / (sum * sum);
    const double along = e * (c2 * (eta2 + 1) - 1) / (product * product);
    return std::min(static_cast<float>(0.5 * (across * across + along * along)), 1.0f);
}

float fresnelDielectricNaive(float cosine, float eta) {
    const float sineTransmitted = std::sqrt(1 - cosine * cosine) / eta;
    if (sineTransmitted > 1)
        return 1;
    const float cosTransmitted = std::sqrt(1 - sineTransmitted * sineTransmitted);
    const float across = (cosine - eta * cosTransmitted) / (cosine + eta * cosTransmitted);
    const float along = (eta * cosine - cosTransmitted) / (eta * cosine + cosTransmitted);
    return 0.5f * (across * across + along * along);
}

float fresnelConductor(float cosine, float eta, float k) {
    const double c = std::min(std::abs(cosine), 1.0f);
    const double s2 = (1 - c) * (1 + c);
    const double eta2 = static_cast<double>(eta) * eta;
    const double k2 = static_cast<double>(k) * k;
    // b² = k² + x and a² = eta² + x − s² with x² + m x = s² k², x ≥ 0.
    const double m = (eta2 - s2) + k2;
    const double root = std::sqrt(m * m + 4 * s2 * k2);
    const double x = m >= 0 ? (m + root > 0 ? 2 * s2 * k2 / (m + root) : 0) : 0.5 * (root - m);
    const double b2 = k2 + x;
    // a b = eta k; where b is 0 there is no loss, and a² is eta² − s².
    const double a = b2 > 0 ? std::sqrt(eta2 * k2 / b2) : std::sqrt(std::max(0.0, eta2 - s2));
    const double sum = a + c;
    // a² − c² = eta² − 1 + x.
    const double difference =
        sum > 0 ? ((static_cast<double>(eta) - 1) * (static_cast<double>(eta) + 1) + x) / sum : 0;
    const double below = sum * sum + b2;
    if (!(below > 0))
        return eta == 1 ? 0.0f : 1.0f;
    const double across = (difference * difference + b2) / below;
    const double low = a * c - s2;
    const double high = a * c + s2;
    const double bc2 = b2 * c * c;
    const double ratio = high * high + bc2 > 0 ? (low * low + bc2) / (high * high + bc2) : 1;
    return std::min(static_cast<float>(0.5 * across * (1 + ratio)), 1.0f);
}

float fresnelConductorNaive(float cosine, float eta, float k) {
    const float cos2 = cosine * cosine;
    const float sin2 = 1 - cos2;
    const float t0 = eta * eta - k * k - sin2;
    const float sumOfSquares = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);
    const float a = std::sqrt(0.5f * (sumOfSquares + t0));
    const float across = (sumOfSquares + cos2 - 2 * a * cosine) / (sumOfSquares + cos2 + 2 * a * cosine);
    const float t3 = cos2 * sumOfSquares + sin2 * sin2;
    const float t4 = 2 * a * cosine * sin2;
    return 0.5f * (across + across * (t3 - t4) / (t3 + t4));
}

float fresnelSchlick(float f0, float cosine) {
    const double x = 1 - std::min(static_cast<double>(std::abs(cosine)), 1.0);
    const double xx = x * x;
    return static_cast<float>(f0 + (1 - static_cast<double>(f0)) * (xx * xx * x));
}

float normalReflectance(float eta) {
    const double root = (static_cast<double>(eta) - 1) / (static_cast<double>(eta) + 1);
    return static_cast<float>(root * root);
}

std::optional<glm::vec3> refract(glm::vec3 towardsSurface, glm::vec3 normal, float eta) {
    const glm::dvec3 d(towardsSurface);
    const glm::dvec3 n(normal);
    const double n2 = glm::dot(n, n);
    const double lengths = n2 * glm::dot(d, d);
    if (!(lengths > 0))
        return std::nullopt;
    const double eta2 = static_cast<double>(eta) * eta;
    const glm::dvec3 across = glm::cross(n, d);
    const double sine2 = glm::dot(across, across);
    double rest = eta2 * lengths - sine2;
    // Off by 8 2^-53 (eta² |n|² |d|² + |n × d|²) at most: above 2^-34 of that 16 bits are left, below there
    // are none to lose.
    if (std::abs(rest) < 0x1p-34 * sine2) [[unlikely]]
        rest = coTangentialExact(towardsSurface, normal, eta);
    if (rest < 0)
        return std::nullopt;
    // eta |n|² |d| t = (n × d) × n ± √(eta² |n|² |d|² − |n × d|²) n.
    const double side = dotInDouble(normal, towardsSurface);
    const glm::dvec3 t = glm::cross(across, n) + std::copysign(std::sqrt(rest), side) * n;
    return glm::vec3(t / std::sqrt(glm::dot(t, t)));
}

std::optional<glm::vec3> refractNaive(glm::vec3 towardsSurface, glm::vec3 normal, float eta) {
    const float ratio = 1 / eta;
    const float cosine = glm::dot(normal, towardsSurface);
    const float k = 1 - ratio * ratio * (1 - cosine * cosine);
    if (k < 0)
        return std::nullopt;
    return ratio * towardsSurface - (ratio * cosine + std::sqrt(k)) * normal;
}

}  // namespace quincunx

#include "math/rotation_interpolation.h"

#include <array>
#include <cstddef>

namespace quincunx {
namespace interpolation {

double nearerSign(glm::quat a, glm::quat b, double squaredA, double squaredB) {
    // The products are exact; their sum becomes an expansion, one number at a time, whose last component that
    // is not zero has the sign of the whole (Shewchuk, "Adaptive precision floating-point arithmetic and fast
    // robust geometric predicates", 1997, section 2.4). Scaled by powers of two so that squares stay in
    // range.
    const double scaleA = std::exp2(-std::ilogb(squaredA) / 2);
    const double scaleB = std::exp2(-std::ilogb(squaredB) / 2);
    const std::array<double, 4> products = {(a.w * scaleA) * (b.w * scaleB), (a.x * scaleA) * (b.x * scaleB),
                                            (a.y * scaleA) * (b.y * scaleB), (a.z * scaleA) * (b.z * scaleB)};
    std::array<double, 4> expansion{};
    for (std::size_t count = 0; count < products.size(); ++count) {
        double carried = products[count];
        for (std::size_t i = 0; i < count; ++i) {
            const double sum = carried + expansion[i];
            const double part = sum - carried;
            expansion[i] = (carried - (sum - part)) + (expansion[i] - part);
            carried = sum;
        }
        expansion[count] = carried;
    }
    for (std::size_t i = expansion.size(); i-- > 0;)
        if (expansion[i] != 0)
            return expansion[i] < 0 ? -1 : 1;
    return 1;
}

glm::quat extrapolate(const Ends& ends, double s) {
    const glm::dquat a = ends.a * std::sqrt(ends.squaredB);
    const glm::dquat b = ends.b * (ends.lengths / std::sqrt(ends.squaredB));
    // Both are |a||b| long.
    const glm::dquat apart = b - a;
    const glm::dquat together = b + a;
    const double sine = std::sqrt(glm::dot(apart, apart));
    const double cosine = std::sqrt(glm::dot(together, together));
    const double half = std::atan2(sine, cosine);
    const double weightApart = sine > 0 ? std::sin(s * half) / sine : 0;
    const double weightTogether = std::cos(s * half) / cosine;
    const glm::dquat q = together * weightTogether + apart * weightApart;
    const glm::dquat unit = q * (1 / std::sqrt(glm::dot(q, q)));
    return {static_cast<float>(unit.w), static_cast<float>(unit.x), static_cast<float>(unit.y),
            static_cast<float>(unit.z)};
}

}  // namespace interpolation

glm::quat slerpNaive(glm::quat a, glm::quat b, float t) {
    const float theta = std::acos(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
    const float weightA = std::sin((1 - t) * theta) / std::sin(theta);
    const float weightB = std::sin(t * theta) / std::sin(theta);
    return {weightA * a.w + weightB * b.w, weightA * a.x + weightB * b.x, weightA * a.y + weightB * b.y,
            weightA * a.z + weightB * b.z};
}

glm::quat slerpNearerNaive(glm::quat a, glm::quat b, float t) {
    const float along = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
    return slerpNaive(a, along < 0 ? -b : b, t);
}

glm::quat nlerpNaive(glm::quat a, glm::quat b, float t) {
    return normalizeNaive(
        {(1 - t) * a.w + t * b.w, (1 - t) * a.x + t * b.x, (1 - t) * a.y + t * b.y, (1 - t) * a.z + t * b.z});
}

glm::dquat slerpByAngle(glm::dquat a, glm::dquat b, double t) {
    if (glm::dot(a, b) < 0)
        b = -b;
    const glm::dquat apart = b - a;
    const glm::dquat together = b + a;
    const double sine = std::sqrt(glm::dot(apart, apart));
    const double cosine = std::sqrt(glm::dot(together, together));
    const double half = std::atan2(sine, cosine);
    const double s = 2 * t - 1;
    const double weightApart = sine > 0 ? std::sin(s * half) / sine : 0;
    return together * (std::cos(s * half) / cosine) + apart * weightApart;
}

glm::mat3 matrixLerpNaive(const glm::mat3& a, const glm::mat3& b, float t) {
    return (1 - t) * a + t * b;
}

glm::mat3 matrixLerpGramSchmidtNaive(const glm::mat3& a, const glm::mat3& b, float t) {
    const glm::mat3 m = matrixLerpNaive(a, b, t);
    const glm::vec3 x = normalizeNaive(m[0]);
    const glm::vec3 y = normalizeNaive(m[1] - dotNaive(x, m[1]) * x);
    return {x, y, crossNaive(x, y)};
}

std::optional<glm::quat> matrixLerp(const glm::mat3& a, const glm::mat3& b, float t) {
    const double share = t;
    const std::optional<glm::dquat> q =
        nearestQuaternion((1 - share) * glm::dmat3(a) + share * glm::dmat3(b));
    return q ? std::optional(glm::quat(*q)) : std::nullopt;
}

}  // namespace quincunx

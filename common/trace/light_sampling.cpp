#include "trace/light_sampling.h"

#include <cmath>
#include <limits>

#include "math/vector.h"

namespace quincunx {

LightArrival arriveFromPoint(glm::vec3 light, glm::vec3 position, float radius) {
    const glm::dvec3 towards = glm::dvec3(light) - glm::dvec3(position);
    const double squared = glm::dot(towards, towards);
    const double least = static_cast<double>(radius) * radius;
    const double strength = 1 / std::max(squared, least);
    return {squared > 0 ? glm::vec3(towards / std::sqrt(squared)) : glm::vec3(0),
            static_cast<float>(std::min(strength, static_cast<double>(std::numeric_limits<float>::max())))};
}

LightArrival arriveFromPointNaive(glm::vec3 light, glm::vec3 position) {
    const glm::vec3 towards = light - position;
    const float distance = std::sqrt(towards.x * towards.x + towards.y * towards.y + towards.z * towards.z);
    return {towards / distance, 1 / (distance * distance)};
}

float spotShare(glm::vec3 wi, glm::vec3 lightDirection, float innerConeRadians, float outerConeRadians) {
    const glm::dvec3 a(wi);
    const glm::dvec3 b(lightDirection);
    const double lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    if (!(lengths > 0))
        return 0;
    const double cosine = -glm::dot(a, b) / lengths;
    double versine = 1 - cosine;
    if (cosine > 0) {
        const glm::dvec3 across = glm::cross(a, b) / lengths;
        versine = glm::dot(across, across) / (1 + cosine);
    }
    const double outer = outerConeRadians;
    const double inner = std::min(static_cast<double>(innerConeRadians), outer);
    const auto versineOf = [](double angle) {
        const double sine = std::sin(0.5 * angle);
        return 2 * sine * sine;
    };
    if (versine <= versineOf(inner))
        return 1;
    const double beyond = versineOf(outer) - versine;
    if (beyond <= 0)
        return 0;
    // cos inner − cos outer as a product.
    const double width = 2 * std::sin(0.5 * (outer + inner)) * std::sin(0.5 * (outer - inner));
    const double share = std::min(beyond / width, 1.0);
    return static_cast<float>(share * share * (3 - 2 * share));
}

float spotShareNaive(glm::vec3 wi, glm::vec3 lightDirection, float innerConeRadians, float outerConeRadians) {
    const float cosine = -(wi.x * lightDirection.x + wi.y * lightDirection.y + wi.z * lightDirection.z);
    const float cosOuter = std::cos(outerConeRadians);
    const float share = std::clamp((cosine - cosOuter) / (std::cos(innerConeRadians) - cosOuter), 0.0f, 1.0f);
    return share * share * (3 - 2 * share);
}

}  // namespace quincunx

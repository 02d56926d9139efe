#include "trace/light_sampling.h"

#include <cmath>
#include <limits>

#include "math/vector.h"
#include "trace/phong_glsl.h"

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
    // (1 − cosine) / 2 of the direction and of the cones; of those it is the square of the sine of half the
    // angle.
    const double along = -glm::dot(a, b);
    double off = 0.5 * (1 - along / lengths);
    if (along > 0) {
        const glm::dvec3 across = glm::cross(a, b);
        off = 0.5 * glm::dot(across, across) / (lengths * (lengths + along));
    }
    const double outer = std::sin(0.5 * outerConeRadians);
    if (off > outer * outer)
        return 0;
    const double inner = std::min(std::sin(0.5 * innerConeRadians), outer);
    if (off <= inner * inner)
        return 1;
    const double share = (outer * outer - off) / ((outer - inner) * (outer + inner));
    return static_cast<float>(share * share * (3 - 2 * share));
}

float spotShareNaive(glm::vec3 wi, glm::vec3 lightDirection, float innerConeRadians, float outerConeRadians) {
    const float cosine = -(wi.x * lightDirection.x + wi.y * lightDirection.y + wi.z * lightDirection.z);
    const float cosOuter = std::cos(outerConeRadians);
    const float share = std::clamp((cosine - cosOuter) / (std::cos(innerConeRadians) - cosOuter), 0.0f, 1.0f);
    return share * share * (3 - 2 * share);
}

LightArrival arriveFrom(const Light& light, glm::vec3 position) {
    const glsl::PhongLight source{
        static_cast<int>(light.kind),  light.position,         light.direction,
        light.color * light.intensity, light.innerConeRadians, light.outerConeRadians};
    const glsl::LightSample incoming = glsl::sampleLight(source, position);
    float strength = incoming.strength;
    if (light.range > 0 && light.kind != Light::Kind::directional)
        strength *= glsl::rangeShare(glm::distance(light.position, position), light.range);
    return {incoming.wi, strength};
}

}  // namespace quincunx

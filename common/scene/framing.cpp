#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "scene/import.h"

namespace quincunx {

namespace {

constexpr double degrees = 3.14159265358979323846 / 180;

/// Unit vector by its compass angle from +z towards +x and its height over the horizon.
glm::dvec3 towards(double azimuth, double elevation) {
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
            std::cos(azimuth) * std::cos(elevation)};
}

Light directional(const char* name, double azimuth, double elevation, const glm::vec3& color,
                  float intensity) {
    Light light;
    light.kind = Light::Kind::directional;
    light.name = name;
    light.direction = glm::vec3(-towards(azimuth, elevation));
    light.color = color;
    light.intensity = intensity;
    return light;
}

}  // namespace

Camera frameBounds(const Bounds& bounds, float aspect) {
    QX_CHECK(aspect > 0 && std::isfinite(aspect));
    const glm::dvec3 centre(bounds.centre());
    glm::dvec3 half(0);
    if (!bounds.empty())
        half = (glm::dvec3(bounds.max) - glm::dvec3(bounds.min)) / 2.0;
    // The eye is stored in floats. What is smaller than 8 units in the last place of its own position is
    // framed as if it were that large, or the eye could fall onto it; a point at the origin as if it were 1.
    double smallest = std::max(glm::length(centre) * 0x1p-20, 0x1p-100);
    if (half == glm::dvec3(0) && centre == glm::dvec3(0))
        smallest = 1;
    if (glm::length(half) < smallest)
        half = glm::dvec3(smallest);
    const double radius = glm::length(half);

    Camera camera;
    const double tanY = std::tan(static_cast<double>(camera.fovYRadians) / 2);
    const double tanX = tanY * static_cast<double>(aspect);
    const glm::dvec3 back = towards(30 * degrees, 20 * degrees);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    const glm::dvec3 up = glm::cross(back, right);

    // As near as the picture's edges, a twentieth of it away from each corner, allow, and never among them.
    constexpr double margin = 1.1;
    double nearest = 0;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 away(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                              corner & 4 ? half.z : -half.z);
        const double z = glm::dot(away, back);
        nearest = std::max(nearest, z);
        distance = std::max({distance, z + margin * std::abs(glm::dot(away, right)) / tanX,
                             z + margin * std::abs(glm::dot(away, up)) / tanY});
    }
    distance = std::max(distance, nearest + radius / 4);

    const double largest = std::numeric_limits<float>::max();
    const glm::dvec3 eye = glm::clamp(centre + distance * back, -largest, largest);
    camera.worldFromCamera = glm::mat4(
        glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1)));
    // Room to move towards the model and away from it before either plane cuts it.
    camera.nearDistance = static_cast<float>((distance - nearest) / 8);
    camera.farDistance = static_cast<float>(std::min(4 * (distance + radius), largest));
    return camera;
}

Camera fittedToAspect(Camera camera, float aspect, float composed) {
    if (aspect < composed) {
        const double halfHeight = std::tan(camera.fovYRadians / 2.0) * composed / aspect;
        camera.fovYRadians = static_cast<float>(2 * std::atan(halfHeight));
    }
    return camera;
}

std::vector<Light> studioLights() {
    return {directional("key", -20 * degrees, 45 * degrees, {1.0f, 0.96f, 0.9f}, 0.85f),
            directional("fill", 85 * degrees, 15 * degrees, {0.85f, 0.92f, 1.0f}, 0.25f),
            directional("rim", 195 * degrees, 40 * degrees, {1.0f, 1.0f, 1.0f}, 0.5f)};
}

}  // namespace quincunx

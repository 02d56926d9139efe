#include "labs/22_intersections/triangle_cases.h"

#include <array>

#include "math/stress_inputs.h"

namespace quincunx {

const char* nameOf(Aim aim) {
    static constexpr std::array names{"random", "edge", "corner", "sliver"};
    return names[static_cast<std::size_t>(aim)];
}

std::string nameOfWay(int way) {
    static constexpr std::array names{"crossings",     "angle sum",      "areas",   "triangle fan",
                                      "Plücker in 2D", "cross products", "Plücker", "Möller–Trumbore",
                                      "Woop, float",   "watertight"};
    return names[static_cast<std::size_t>(way)];
}

std::optional<double> meetTriangle(int way, const AimedRay& aimed) {
    if (way + 1 < triangleWays)
        return meetTriangleNaive(aimed.triangle, aimed.ray, static_cast<TriangleWay>(way));
    const std::optional<TriangleHit> hit = intersectTriangle(aimed.ray, aimed.triangle);
    return hit ? std::optional(hit->t) : std::nullopt;
}

std::vector<AimedRay> aimedRays(Aim aim, std::size_t count, std::uint64_t seed) {
    StressInputs draw(seed);
    std::vector<AimedRay> rays;
    rays.reserve(count);
    while (rays.size() < count) {
        Triangle triangle{draw.unitVector(), draw.unitVector(), draw.unitVector()};
        if (aim == Aim::sliver) {
            const glm::dvec3 along = glm::dvec3(triangle.b) - glm::dvec3(triangle.a);
            triangle.c = glm::vec3(glm::dvec3(triangle.a) + draw.random().uniform(0.2, 0.8) * along +
                                   draw.magnitude(-20, -10) * draw.direction());
        }
        double b = draw.random().uniform(-0.2, 1.2);
        double c = draw.random().uniform(-0.2, 1.2);
        if (aim == Aim::edge || aim == Aim::corner) {
            b = draw.random().uniform(0, 1);
            c = aim == Aim::edge ? 1 - b : 0;
            if (aim == Aim::corner)
                b = 1;
        } else if (aim == Aim::sliver) {
            b = draw.random().uniform(0, 0.5);
            c = draw.random().uniform(0, 0.5);
        }
        const glm::dvec3 target =
            (1 - b - c) * glm::dvec3(triangle.a) + b * glm::dvec3(triangle.b) + c * glm::dvec3(triangle.c);
        const glm::vec3 origin(target + draw.magnitude(0, 5) * draw.direction());
        const Ray ray{origin, glm::vec3(target) - origin};
        const std::optional<TriangleHit> hit = intersectTriangleOracle(ray, triangle);
        rays.push_back({ray, triangle, hit.has_value(), hit ? hit->t : 0});
    }
    return rays;
}

}  // namespace quincunx

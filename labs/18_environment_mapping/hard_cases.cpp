#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "labs/18_environment_mapping/lab.h"
#include "math/stress_inputs.h"
#include "trace/environment_glsl.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon = 0x1p-24;
constexpr double pi = 3.141592653589793;

/// Directions of lengths from 2^-140 to 2^125, as often along edges and corners of the cube, on axes, and
/// beside them.
glm::vec3 hardDirection(StressInputs& draw, std::uint64_t i) {
    const double size = draw.magnitude(-140, 125);
    glm::dvec3 d = size * (i % 3 == 0 ? draw.nearAxis() : draw.direction());
    if (i % 5 == 1)
        d.y = draw.sign() * d.x;
    if (i % 5 == 2)
        d = std::abs(d.x) * glm::dvec3(draw.sign(), draw.sign(), draw.sign());
    if (i % 7 == 3)
        d[static_cast<int>(draw.random().below(3))] = draw.sign() * 0.0;
    glm::vec3 rounded(d);
    if (rounded == glm::vec3(0))
        rounded.z = static_cast<float>(draw.sign() * size);
    return rounded == glm::vec3(0) ? glm::vec3(0, 0, 0x1p-149f) : rounded;
}

/// Normalizes, and takes the axis by strict comparisons.
glm::vec3 cubePlaceNaive(glm::vec3 direction) {
    const glm::vec3 d = glm::normalize(direction);
    const glm::vec3 a = glm::abs(d);
    int face = -1;
    for (int axis = 0; axis < 3; ++axis)
        if (a[axis] > a[(axis + 1) % 3] && a[axis] > a[(axis + 2) % 3])
            face = 2 * axis + (d[axis] > 0 ? 0 : 1);
    if (face < 0)
        return glm::vec3(-1);
    const glm::mat3 axes = glsl::cubeFaceAxes(face);
    const float depth = glm::dot(axes[2], d);
    return {0.5f * (glm::dot(axes[0], d) / depth + 1), 0.5f * (glm::dot(axes[1], d) / depth + 1), face};
}

HardCaseFigures runCubePlace(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const auto error = [](glm::vec3 d, glm::vec3 place) {
        const auto face = static_cast<int>(place.z);
        if (!(face >= 0 && face < 6))
            return infinity;
        const glm::dmat3 axes(glsl::cubeFaceAxes(face));
        const glm::dvec3 exact(d);
        const double depth = glm::dot(axes[2], exact);
        const glm::dvec3 a = glm::abs(exact);
        if (!(depth > 0) || depth < std::max({a.x, a.y, a.z}) || !(place.x >= 0 && place.x <= 1) ||
            !(place.y >= 0 && place.y <= 1))
            return infinity;
        return std::max(std::abs(place.x - (0.5 + 0.5 * glm::dot(axes[0], exact) / depth)),
                        std::abs(place.y - (0.5 + 0.5 * glm::dot(axes[1], exact) / depth))) /
               epsilon;
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 d = hardDirection(draw, i);
        tally.add(error(d, cubePlaceNaive(d)), error(d, glsl::cubePlace(d)), [&] { return hexVector(d); });
    }
    return tally.figures();
}

glm::vec2 panoramaPlaceNaive(glm::vec3 direction) {
    const glm::vec3 d = glm::normalize(direction);
    return {0.5f + std::atan2(d.z, d.x) / (2 * static_cast<float>(pi)),
            std::acos(d.y) / static_cast<float>(pi)};
}

/// Directions towards the poles and all around.
HardCaseFigures runPanoramaPlace(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::vec3 d = hardDirection(draw, i);
        if (i % 2 == 0)
            d = glm::vec3(draw.magnitude(-60, 60) * draw.turned({0, draw.sign(), 0}, -40, 0));
        if (d == glm::vec3(0))
            d.y = 1;
        const glm::dvec3 exact(d);
        const double level = std::hypot(exact.x, exact.z);
        const double u = level > 0 ? 0.5 + std::atan2(exact.z, exact.x) / (2 * pi) : 0.5;
        const double v = std::atan2(level, exact.y) / pi;
        const auto error = [&](glm::vec2 place) {
            if (!std::isfinite(place.x) || !std::isfinite(place.y))
                return infinity;
            const double around = std::abs(place.x - u);
            return std::max(std::min(around, 1 - around), std::abs(place.y - v)) / epsilon;
        };
        tally.add(error(panoramaPlaceNaive(d)), error(glsl::panoramaPlace(d)), [&] { return hexVector(d); });
    }
    return tally.figures();
}

/// As printed in most tutorials after Lagarde and Zanuttini.
glm::vec3 boxProjectedNaive(glm::vec3 position, glm::vec3 direction, glm::vec3 boxMin, glm::vec3 boxMax,
                            glm::vec3 map) {
    const glm::vec3 furthest = glm::max((boxMax - position) / direction, (boxMin - position) / direction);
    const float t = std::min({furthest.x, furthest.y, furthest.z});
    return position + t * direction - map;
}

/// Rooms near and far; positions inside, on walls, in corners, and outside; rays along axes, with ±0, of any
/// length.
HardCaseFigures runBoxProjection(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 centre = i % 2 == 0 ? glm::dvec3(0) : draw.magnitude(-2, 10) * draw.direction();
        const glm::vec3 low(centre -
                            glm::dvec3(draw.magnitude(0, 4), draw.magnitude(0, 4), draw.magnitude(0, 4)));
        const glm::vec3 high(centre +
                             glm::dvec3(draw.magnitude(0, 4), draw.magnitude(0, 4), draw.magnitude(0, 4)));
        glm::vec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = low[axis] + static_cast<float>(draw.random().uniform(0, 1)) * (high[axis] - low[axis]);
        p = glm::clamp(p, low, high);
        const glm::vec3 map = p;
        const auto axis = static_cast<int>(draw.random().below(3));
        if (i % 3 == 1)
            p[axis] = draw.sign() > 0 ? high[axis] : low[axis];
        if (i % 6 == 2)
            p[axis] += static_cast<float>(draw.sign() * draw.magnitude(-3, 6));
        const glm::vec3 d = hardDirection(draw, i);

        // The same in double, whose roundings are 2^-29 of float's.
        const glm::dvec3 from = glm::clamp(glm::dvec3(p), glm::dvec3(low), glm::dvec3(high));
        const glm::dvec3 along(d);
        double t = infinity;
        for (int k = 0; k < 3; ++k)
            if (along[k] != 0)
                t = std::min(t, ((along[k] > 0 ? high[k] : low[k]) - from[k]) / along[k]);
        const glm::dvec3 exact = from + t * along - glm::dvec3(map);
        const double size = glm::length(glm::dvec3(high) - glm::dvec3(low)) +
                            std::max(glm::length(glm::dvec3(high)), glm::length(glm::dvec3(low)));
        const auto error = [&](glm::vec3 got) {
            const double off = glm::length(glm::dvec3(got) - exact) / (epsilon * size);
            return std::isfinite(off) ? off : infinity;
        };
        tally.add(error(boxProjectedNaive(p, d, low, high, map)),
                  error(glsl::boxProjected(p, d, low, high, map)), [&] {
                      return fmt::format("p={} d={} box={} {}", hexVector(p), hexVector(d), hexVector(low),
                                         hexVector(high));
                  });
    }
    return tally.figures();
}

float ggxDensityNaive(float cosine, float alpha) {
    const float a2 = alpha * alpha;
    const float root = cosine * cosine * (a2 - 1) + 1;
    return a2 / (static_cast<float>(pi) * root * root);
}

/// Smooth surfaces, and normals close to the surface's own.
HardCaseFigures runGgxDensity(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto alpha = static_cast<float>(draw.magnitude(-12, 0));
        const auto cosine = i % 4 == 0 ? static_cast<float>(draw.random().uniform(0, 1))
                                       : static_cast<float>(1 - draw.magnitude(-24, 0));
        const double a2 = static_cast<double>(alpha) * alpha;
        const double c2 = static_cast<double>(cosine) * cosine;
        const double root = (1 - c2) + a2 * c2;
        const double exact = a2 / (pi * root * root);
        const auto error = [&](float got) {
            return std::isfinite(got) ? std::abs(got / exact - 1) / epsilon : infinity;
        };
        tally.add(error(ggxDensityNaive(cosine, alpha)), error(glsl::ggxDensity(cosine, alpha)),
                  [&] { return fmt::format("cosine={:a} alpha={:a}", cosine, alpha); });
    }
    return tally.figures();
}

/// Normals drawn close to the surface's own, and close to the horizon.
HardCaseFigures runGgxNormal(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto alpha = static_cast<float>(draw.magnitude(-10, 0));
        const auto u = static_cast<float>(i % 2 == 0 ? draw.magnitude(-24, 0) : 1 - draw.magnitude(-24, -1));
        if (u >= 1) {
            tally.add(0, 0, [] { return std::string(); });
            continue;
        }
        const double opposite = static_cast<double>(alpha) * alpha * u;
        const double adjacent = 1 - static_cast<double>(u);
        const double sine = std::sqrt(opposite / (adjacent + opposite));
        const double cosine = std::sqrt(adjacent / (adjacent + opposite));
        const auto error = [&](double gotSine, double gotCosine) {
            return std::max(std::abs(gotSine / sine - 1), std::abs(gotCosine / cosine - 1)) / epsilon;
        };
        const float cosineNaive = std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u));
        const float sineNaive = std::sqrt(1 - cosineNaive * cosineNaive);
        const glm::vec3 normal = glsl::ggxNormal({u, 0}, alpha);
        tally.add(error(sineNaive, cosineNaive), error(normal.x, normal.z),
                  [&] { return fmt::format("u={:a} alpha={:a}", u, alpha); });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> EnvironmentMappingLab::hardCases() {
    return {
        {"cubePlace", "edges and corners of the cube, ±0, lengths 2^-140 … 2^125", "2^-24 of a face", 0.75,
         "scaled by a power of two; the earlier of axes that are as long", &runCubePlace},
        {"panoramaPlace", "directions towards the poles, lengths 2^-140 … 2^125", "2^-24 of the image", 3,
         "atan of the level part and the height, instead of acos", &runPanoramaPlace},
        {"boxProjected", "positions on and outside the walls, rays along them, ±0, any length",
         "2^-24 of the room's size", 8, "only walls that the ray goes towards; put on the wall",
         &runBoxProjection},
        {"ggxDensity", "alpha from 2^-12 on, normals close to the surface's own", "2^-24 of the density", 16,
         "(1 − c)(1 + c) for 1 − c²", &runGgxDensity},
        {"ggxNormal", "normals drawn close to the surface's own, and to its horizon",
         "2^-24 of sine or cosine", 4, "sine and cosine each from the two legs", &runGgxNormal},
    };
}

}  // namespace quincunx

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "labs/16_shadow_maps/lab.h"
#include "math/projection.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "trace/shadow_glsl.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

glm::mat4 shadowFromClip() {
    return {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0.5f, 0.5f, 0.5f, 1};
}

/// A lit plane at 0 … 89° to a light's view of 20 by 20 units and 40 deep, sampled by a map of 64 … 4096
/// texels. The map's depth at the nearest texel's centre is the plane's own, so the plane must be lit.
/// Failures: samples that shade themselves. Error: the gap left, over half a texel along the plane.
HardCaseFigures runSelfShadowing(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const glm::mat4 shadowFromWorld = shadowFromClip() * orthographic(-10, 10, -10, 10, 0, 40);
    const glm::mat4 worldFromShadow = inverse(shadowFromWorld).value_or(glm::mat4(1));
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double slopeRadians = draw.random().uniform(0, 89.0 / 180 * 3.141592653589793);
        const double around = draw.random().uniform(0, 6.283185307179586);
        const glm::dvec3 normal(std::sin(slopeRadians) * std::cos(around),
                                std::sin(slopeRadians) * std::sin(around), std::cos(slopeRadians));
        const int resolution = 64 << draw.random().below(7);
        const double texelWorld = 20.0 / resolution;
        // Near the middle of the view, so that the steepest plane stays within the view's depth.
        const glm::dvec2 xy(draw.random().uniform(-0.1, 0.1), draw.random().uniform(-0.1, 0.1));
        const auto heightAt = [&](glm::dvec2 p) {
            return -20 - (normal.x * p.x + normal.y * p.y) / normal.z;
        };
        const glm::vec3 position(static_cast<float>(xy.x), static_cast<float>(xy.y),
                                 static_cast<float>(heightAt(xy)));
        const glm::dvec2 texel = glm::floor((glm::dvec2(position) + 10.0) / texelWorld);
        const glm::dvec2 centre = (texel + 0.5) * texelWorld - 10.0;
        const auto stored = static_cast<float>(-heightAt(centre) / 40);

        const glm::vec4 place = glsl::shadowPlace(shadowFromWorld, position);
        const glm::vec2 slopes = glsl::receiverSlopes(worldFromShadow, position, glm::vec3(normal));
        const float bias = glsl::receiverPlaneBias(slopes, 0.5f / static_cast<float>(resolution)) + 0x1p-23f;
        const float constant = 0.005f;
        const double exactBias =
            0.5 / resolution * 20 / 40 * (std::abs(normal.x / normal.z) + std::abs(normal.y / normal.z));
        const double rounding = 0x1p-22;
        const auto error = [&](float used) {
            return place.z - used > stored ? infinity
                                           : std::max(0.0, static_cast<double>(used) - rounding) / exactBias;
        };
        tally.add(error(constant), error(bias), [&] {
            return fmt::format("normal=({:a},{:a},{:a}) resolution={} x={:a} y={:a}", normal.x, normal.y,
                               normal.z, resolution, xy.x, xy.y);
        });
    }
    return tally.figures();
}

/// Points all around a spot. Failures: points behind it that are given a place in its map. Error: that of
/// places in front, in the map's width.
HardCaseFigures runBehindSpot(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 position(draw.magnitude(-4, 4) * draw.direction());
        const glm::vec3 target = position + glm::vec3(draw.direction());
        const glm::mat4 worldFromLight = lookAt(position, target, {0, 1, 0});
        const glm::mat4 shadowFromWorld =
            shadowFromClip() * perspective(1.2f, 1, 0.01f, 100) * cameraFromWorld(worldFromLight);
        const glm::vec3 p = position + glm::vec3(draw.magnitude(-6, 6) * draw.direction());
        glm::dvec4 exact(0);
        for (int column = 0; column < 4; ++column)
            exact +=
                glm::dvec4(shadowFromWorld[column]) * (column < 3 ? static_cast<double>(p[column]) : 1.0);
        // The rounding of w itself: within it a point is neither before nor behind.
        double terms = 0;
        for (int column = 0; column < 4; ++column)
            terms += std::abs(static_cast<double>(shadowFromWorld[column][3]) *
                              (column < 3 ? static_cast<double>(p[column]) : 1.0));
        if (std::abs(exact.w) <= 0x1p-21 * terms) {
            tally.add(0, 0, [] { return std::string(); });
            continue;
        }
        const bool behind = exact.w < 0;
        const auto inMap = [](glm::vec2 st) { return st.x >= 0 && st.x <= 1 && st.y >= 0 && st.y <= 1; };
        const glm::vec4 naive = shadowFromWorld * glm::vec4(p, 1);
        const glm::vec4 place = glsl::shadowPlace(shadowFromWorld, p);
        tally.add(behind && inMap(glm::vec2(naive) / naive.w) ? infinity : 0,
                  behind ? (place.w == 0 ? 0 : infinity) : (place.w == 1 ? 0 : infinity),
                  [&] { return fmt::format("p=({:a},{:a},{:a})", p.x, p.y, p.z); });
    }
    return tally.figures();
}

/// Directions from a lamp, also along edges and corners of its cube. Failures: those without a place in the
/// face that is chosen. The naive choice takes the axis by strict comparisons alone. Error: how far the place
/// lies beyond the face's edge.
HardCaseFigures runCubeFace(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const auto beyond = [](glm::vec3 d, int face) {
        if (face < 0)
            return infinity;
        const int axis = face / 2;
        const double depth = face % 2 == 0 ? d[axis] : -static_cast<double>(d[axis]);
        if (!(depth > 0))
            return infinity;
        const double s = std::abs(static_cast<double>(d[(axis + 1) % 3])) / depth;
        const double t = std::abs(static_cast<double>(d[(axis + 2) % 3])) / depth;
        return std::max(0.0, std::max(s, t) - 1);
    };
    const auto naiveFace = [](glm::vec3 d) {
        for (int axis = 0; axis < 3; ++axis)
            if (std::abs(d[axis]) > std::abs(d[(axis + 1) % 3]) &&
                std::abs(d[axis]) > std::abs(d[(axis + 2) % 3]))
                return 2 * axis + (d[axis] > 0 ? 0 : 1);
        return -1;
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::vec3 d(draw.magnitude(-120, 100) * draw.direction());
        if (i % 4 == 1)
            d.y = static_cast<float>(draw.sign()) * d.x;
        if (i % 4 == 2)
            d = glm::vec3(draw.sign(), draw.sign(), draw.sign()) * std::abs(d.x);
        if (d == glm::vec3(0))
            d.x = 1;
        tally.add(beyond(d, naiveFace(d)), beyond(d, glsl::cubeFace(d)),
                  [&] { return fmt::format("d=({:a},{:a},{:a})", d.x, d.y, d.z); });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> ShadowMapLab::hardCases() {
    return {
        {"receiverPlaneBias", "lit planes at 0 … 89° to the light, 64 … 4096 texels", "times the gap needed",
         1.35, "half a texel along the receiver's plane; Isidoro 2006", &runSelfShadowing},
        {"shadowPlace", "points behind a spot and beside it", "of the map's width", 0,
         "w > 0 before the division", &runBehindSpot},
        {"cubeFace", "directions along a cube's edges and corners, lengths 2^-120 … 2^100",
         "of a face's width", 0, "the earlier of two axes that are as long", &runCubeFace},
    };
}

}  // namespace quincunx

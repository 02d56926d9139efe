#pragma once

#include <algorithm>

#include <glm/glm.hpp>

#include "scene/scene.h"

/// How much of a small light's strength arrives. The forms `...Naive` are for `stress` alone; against them
/// (bench_scattering, whole arrays) arriveFromPoint costs 1.1 times and spotShare 2.2 times.
namespace quincunx {

/// The unit vector towards a light and 1 / max(distance², radius²). Where the light is exactly here it has no
/// direction, (0,0,0), and the strength is that at its radius.
struct LightArrival {
    glm::vec3 wi{0};
    float strength = 0;
};
/// Inverse squares of any finite distance, with the light taken as a ball of some radius (≥ 0), inside which
/// nothing grows: to 0.5 ulp + 2^-26, at most the largest float. Held by ArriveFromPoint.*.
LightArrival arriveFromPoint(glm::vec3 light, glm::vec3 position, float radius = 0);
/// 1 / (d·d), in float.
LightArrival arriveFromPointNaive(glm::vec3 light, glm::vec3 position);

/// The share of a spot's strength: 1 inside the inner cone, 0 outside the outer one, smoothstep of the cosine
/// between, within 5e-8 of that. The inner cone is taken as no wider than the outer one; where they are the
/// same the edge is sharp, and what lies on it is lit. Vectors of any length but 0; `lightDirection` is the
/// way the light travels; half angles in [0, π]. 1 − cosine is carried instead of cosines (of two directions
/// |a × b|² / (1 + cos), of cones 2 sin² of half the angle), so that cones of 2^-20 radians have an inside
/// and an edge. Held by SpotShare.*.
float spotShare(glm::vec3 wi, glm::vec3 lightDirection, float innerConeRadians, float outerConeRadians);
/// smoothstep(cos outer, cos inner, cosine), in float, of unit vectors.
float spotShareNaive(glm::vec3 wi, glm::vec3 lightDirection, float innerConeRadians, float outerConeRadians);

/// What of a light of a scene arrives at a point with nothing between, as the shaders have it (sampleLight
/// and rangeShare of shaders/lib/phong.glsl).
LightArrival arriveFrom(const Light& light, glm::vec3 position);

}  // namespace quincunx

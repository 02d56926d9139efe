#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

/// Uniform numbers turned into directions and points, with their densities. Numbers come in [0, 1], multiples
/// of 2^-24 or finer; what is drawn is finite, and where it is a direction its length is 1 to 6e-8 (three
/// components rounded to float: √3 2^-25 = 5.2e-8; what comes before is in double, good to 2e-9). Densities
/// are rounded once from double, and at most the largest float. The forms `...Naive` are for `stress` alone.
namespace quincunx {

/// A direction and its density per solid angle.
struct DirectionSample {
    glm::vec3 direction{0, 0, 1};
    float density = 0;
};
/// A point on a triangle by its barycentric weights, and its density per area.
struct TriangleSample {
    glm::vec3 weights{1, 0, 0};
    float density = 0;
};

/// Uniform on the unit disk; neighbours stay neighbours (Shirley, Chiu, "A low distortion map between disk
/// and square", JGT 2(3), 1997). Held by SampleDisk.*.
glm::vec2 sampleDisk(glm::vec2 uv);
/// About +z, density cos / π; z ≥ 0. The point above the one of the disk, whose height is √((1 − r)(1 + r))
/// of the radius that the square gives, so that nothing cancels at the rim. Held by SampleCosineHemisphere.*.
DirectionSample sampleCosineHemisphere(glm::vec2 uv);
/// r = √u, z = √(1 − x² − y²), in float.
DirectionSample sampleCosineHemisphereNaive(glm::vec2 uv);
/// Uniform on the whole sphere, density 1 / 4π.
DirectionSample sampleSphere(glm::vec2 uv);
/// Uniform in the cone about +z whose half angle has 1 − cos = `oneMinusCosine` (in [0, 2]): exact for tiny
/// cones too. Density 0 for a cone of no width. Held by SampleCone.*.
DirectionSample sampleCone(float oneMinusCosine, glm::vec2 uv);
/// From the cosine, in float: cones below 2^-12 radians have a cosine of 1.
DirectionSample sampleConeNaive(float oneMinusCosine, glm::vec2 uv);
/// Uniform by area (> 0).
TriangleSample sampleTriangle(float area, glm::vec2 uv);

/// 1 − cos of the half angle of the cone that holds a sphere seen from a distance: s² / (1 + √(1 − s²)),
/// s = radius / distance, to 0.5 ulp + 2^-24. None where the distance is no longer than the radius: from
/// there the sphere is all around. Held by ConeOfSphere.*.
std::optional<float> coneOfSphere(float distance, float radius);
float coneOfSphereNaive(float distance, float radius);
/// Uniform in the solid angle of a sphere; from inside it, over the whole sphere of directions. Density 0
/// where the radius is 0 or nothing.
DirectionSample sampleSphereLight(glm::vec3 from, glm::vec3 center, float radius, glm::vec2 uv);

/// The solid angle of a triangle, in [0, 2π): Van Oosterom and Strackee (IEEE Trans. Biomed. Eng. 30, 1983)
/// with differences of the corners, so that nothing cancels for small ones: within 2^-48 / the cosine
/// between the triangle's normal and the way to it, relative, where `from` is not far nearer than the
/// corners. 0 where `from` lies in its plane. Held by SphericalTriangle.*.
double solidAngle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c);
/// The sum of the angles less π, in float (Girard).
float solidAngleNaive(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c);
/// Uniform in the solid angle of a triangle seen from `from`, as Arvo ("Stratified sampling of spherical
/// triangles", SIGGRAPH 1995), the corner on the edge found by the tangent of half its angle: nothing
/// cancels, however small or large the triangle is. Density 1 / solid angle; 0 where it has none. Held by
/// SphericalTriangle.*.
DirectionSample sampleSphericalTriangle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec2 uv);
/// Arvo's formulas, in float.
DirectionSample sampleSphericalTriangleNaive(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c,
                                             glm::vec2 uv);

/// Indices with probabilities in proportion to weights (≥ 0, finite, not all 0, at most 2^24 of them).
///
/// Probabilities are multiples of 2^-24, so that those given out are exactly those drawn by numbers that are
/// multiples of 2^-24: estimates by them have no bias. Every weight above 0 has one such part at least, and
/// the rest is shared in proportion to 2^-24; weights of 0 are never drawn. Held by DiscreteDistribution.*.
class DiscreteDistribution {
  public:
    explicit DiscreteDistribution(std::span<const float> weights);
    struct Drawn {
        std::size_t index = 0;
        float probability = 0;
        float rest = 0;  ///< what is left of u: uniform in [0, 1) again, in steps of 2^-24 / probability
    };
    Drawn sample(float u) const;
    float probability(std::size_t index) const;
    std::size_t size() const { return cumulative_.size(); }

  private:
    std::vector<float> cumulative_;
    std::vector<float> probability_;
};

/// Points of the unit square with a density in proportion to the weights of width × height cells, row by row.
class GridDistribution {
  public:
    GridDistribution(std::span<const float> weights, int width, int height);
    struct Drawn {
        glm::vec2 point{0};  ///< (0, 0) the first cell's corner
        float density = 0;   ///< per area of the unit square
    };
    Drawn sample(glm::vec2 uv) const;
    float density(glm::vec2 point) const;

  private:
    int width_ = 0;
    int height_ = 0;
    std::vector<DiscreteDistribution> rows_;
    std::vector<DiscreteDistribution> row_;  ///< one: which row
};

/// Veach's weight for a sample of density `own` where another technique would have had `other` (balance
/// heuristic squared); 0 where own is 0.
/// Nothing overflows: own² / (own² + other²) in double, to 0.5 ulp + 2^-20, for all finite densities. Held by
/// PowerHeuristic.*.
float powerHeuristic(float own, float other);
float powerHeuristicNaive(float own, float other);

/// Russian roulette (Arvo, Kirk, "Particle transport and image synthesis", SIGGRAPH 1990): a path that
/// carries `throughput` goes on with probability q = min(1, its largest channel), and then carries throughput
/// / q; nothing where it ends. q is rounded up to a multiple of 2^-24, which is what numbers u that are such
/// multiples are below with exactly that probability: no bias, however little is carried. Held by Roulette.*.
std::optional<glm::vec3> playRoulette(glm::vec3 throughput, float u);
/// Ends with the same probability and changes no weight.
std::optional<glm::vec3> playRouletteNaive(glm::vec3 throughput, float u);

}  // namespace quincunx

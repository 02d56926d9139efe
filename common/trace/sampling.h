#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/glm.hpp>

/// Uniform numbers turned into directions and points, with their densities. Numbers come in [0, 1); what is
/// drawn is finite, and of unit length where it is a direction.
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

/// Uniform on the unit disk; neighbours stay neighbours (Shirley, Chiu 1997).
glm::vec2 sampleDisk(glm::vec2 uv);
/// About +z, density cos / π.
DirectionSample sampleCosineHemisphere(glm::vec2 uv);
/// Uniform on the whole sphere, density 1 / 4π.
DirectionSample sampleSphere(glm::vec2 uv);
/// Uniform in the cone about +z whose half angle has 1 − cos = `oneMinusCosine`: exact for tiny cones too.
DirectionSample sampleCone(float oneMinusCosine, glm::vec2 uv);
/// Uniform by area (> 0).
TriangleSample sampleTriangle(float area, glm::vec2 uv);
/// Uniform in the solid angle of a triangle seen from `from` (Arvo 1995); density 0 where it has none.
DirectionSample sampleSphericalTriangle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec2 uv);

/// Indices with probabilities in proportion to weights (≥ 0, finite, not all 0).
class DiscreteDistribution {
  public:
    explicit DiscreteDistribution(std::span<const float> weights);
    struct Drawn {
        std::size_t index = 0;
        float probability = 0;
        float rest = 0;  ///< what is left of u, uniform in [0, 1) again
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
float powerHeuristic(float own, float other);

}  // namespace quincunx

#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

#include "base/random.h"
#include "math/vector.h"

namespace quincunx {

/// Inputs on which textbook formulas fail, the same for the same seed on every machine. Sizes are spread
/// evenly over exponents, since failures live at the ends of the range; counts of failures on such inputs
/// speak of the range, not of typical scenes.
class StressInputs {
  public:
    explicit StressInputs(std::uint64_t seed) : random_(seed) {}

    Random& random() { return random_; }

    double sign() { return random_.bits() >> 63 != 0 ? -1 : 1; }

    /// 2^e, e uniform in [lowExponent, highExponent).
    double magnitude(double lowExponent, double highExponent) {
        return std::exp2(random_.uniform(lowExponent, highExponent));
    }

    /// Any finite float, each bit pattern alike.
    float finiteFloat() {
        for (;;) {
            const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(random_.bits() >> 32));
            if (std::isfinite(x))
                return x;
        }
    }

    /// Three of them, not all zero.
    glm::vec3 finiteVector() {
        for (;;) {
            const glm::vec3 v(finiteFloat(), finiteFloat(), finiteFloat());
            if (v != glm::vec3(0))
                return v;
        }
    }

    /// Evenly over the sphere, of length 1 to a few 2^-53 (Archimedes: equal heights have equal areas).
    glm::dvec3 direction() {
        const double z = random_.uniform(-1, 1);
        const double angle = random_.uniform(0, 6.283185307179586);
        const double radius = std::sqrt(1 - z * z);
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

    /// The same rounded to float: off the sphere by up to 5.2e-8, as every unit vector of a program is.
    glm::vec3 unitVector() { return glm::vec3(direction()); }

    /// Any direction, length from 2^lowExponent to 2^highExponent, not zero.
    glm::vec3 vectorOfMagnitude(double lowExponent, double highExponent) {
        for (;;) {
            const glm::vec3 v(magnitude(lowExponent, highExponent) * direction());
            if (v != glm::vec3(0))
                return v;
        }
    }
    glm::dvec3 doubleVectorOfMagnitude(double lowExponent, double highExponent) {
        for (;;) {
            const glm::dvec3 v = magnitude(lowExponent, highExponent) * direction();
            if (v != glm::dvec3(0))
                return v;
        }
    }

    /// A unit vector at right angles to a unit vector.
    glm::dvec3 perpendicular(glm::dvec3 unit) {
        for (;;) {
            const glm::dvec3 across = glm::cross(unit, direction());
            if (glm::dot(across, across) > 0.01)
                return glm::normalize(across);
        }
    }

    /// `unit` turned by an angle of 2^e radians, e uniform in [lowExponent, highExponent).
    glm::dvec3 turned(glm::dvec3 unit, double lowExponent, double highExponent) {
        const double angle = magnitude(lowExponent, highExponent);
        return std::cos(angle) * unit + std::sin(angle) * perpendicular(unit);
    }

    /// An axis or, as often, a direction within 2^-24 … 1 radian of one.
    glm::dvec3 nearAxis() {
        glm::dvec3 axis(0);
        axis[static_cast<int>(random_.below(3))] = sign();
        return random_.below(2) == 0 ? axis : turned(axis, -24, 0);
    }

    /// A rotation, evenly over all of them up to rounding (columns right-handed).
    glm::dmat3 rotation() {
        const glm::dvec3 x = direction();
        const glm::dvec3 y = perpendicular(x);
        return {x, y, glm::cross(x, y)};
    }

  private:
    Random random_;
};

}  // namespace quincunx

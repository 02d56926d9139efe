#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace quincunx {

/// Small turns of the lab, one after another.
inline constexpr std::uint64_t driftProducts = 1u << 20;

/// A turn by 0.01 rad about `axis` (not zero).
glm::quat smallTurn(glm::vec3 axis);

/// What becomes of a unit quaternion when it is multiplied, in float, by the same turn again and again.
struct Drift {
    glm::quat last{1, 0, 0, 0};
    double largest = 0;             ///< of | |q| − 1 |
    std::vector<double> byDoubles;  ///< at index i: the largest in the first 2ⁱ products
};

/// Made unit length after every `every` products; 0: never.
Drift measureDrift(glm::quat turn, int every);

}  // namespace quincunx

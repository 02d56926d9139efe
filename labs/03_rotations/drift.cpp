#include "labs/03_rotations/drift.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/quaternion.h"

namespace quincunx {

glm::quat smallTurn(glm::vec3 axis) {
    return quaternionFromAxisAngle(axis, 0.01f).value_or(glm::quat(1, 0, 0, 0));
}

Drift measureDrift(glm::quat turn, int every) {
    Drift drift;
    const auto stretch = static_cast<std::uint64_t>(every);
    for (std::uint64_t i = 1; i <= driftProducts; ++i) {
        drift.last = productNaive(turn, drift.last);
        if (stretch > 0 && i % stretch == 0)
            drift.last = normalizeNaive(drift.last);
        drift.largest = std::max(drift.largest, std::abs(std::sqrt(squaredNorm(drift.last)) - 1));
        if (std::has_single_bit(i))
            drift.byDoubles.push_back(drift.largest);
    }
    return drift;
}

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "trace/bvh_build.h"

/// What buildBvh works on; no part of the interface.
namespace quincunx::detail {

/// A finite box that is not empty, and whose it is.
struct BvhItem {
    glm::vec3 min{0};
    std::uint32_t index = 0;
    glm::vec3 max{0};
    std::uint32_t unused = 0;
};

/// As quincunx::buildBvh; puts the items into the order of the leaves.
BvhTree buildBvh(std::span<BvhItem> items, const BvhBuildParams& params);

}  // namespace quincunx::detail

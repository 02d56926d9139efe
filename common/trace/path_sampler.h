#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "base/random.h"

namespace quincunx {

class PathSampler {
  public:
    PathSampler(std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample)
        : random_(seed * 0x9e3779b97f4a7c15u + (std::uint64_t{pixel} << 32 | sample) * 0xd1342543de82ef95u) {}
    float next() { return random_.uniform(); }
    glm::vec2 nextPair() {
        const float x = random_.uniform();
        return {x, random_.uniform()};
    }

  private:
    Random random_;
};

}  // namespace quincunx

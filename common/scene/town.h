#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "scene/car.h"
#include "scene/scene.h"

namespace quincunx {

struct TownParams {
    std::uint64_t seed = 1;  ///< of colours, sizes, trees; the streets are the same in every town
    bool parkedCars = true;
};

/// A small town on a summer morning: two streets that cross at a roundabout with a fountain, a street around
/// them, houses, a church, a park with a pond, trees, lamps, hills. Metres; y up, streets at y = 0, traffic
/// on the right. Everything within `townRadius` is flat.
struct Town {
    Scene scene;                      ///< a sun, no other lights; ambient light of the sky
    std::vector<std::size_t> ground;  ///< instances that lie flat: they receive shadows and cast none
    std::vector<glm::dvec2> tour;     ///< (x, z): corners of a closed drive along the lanes
    CarState start;                   ///< on the tour's first leg, facing along it
};

inline constexpr double townRadius = 110;

/// About 95 000 triangles in 1070 instances of 130 meshes. The same seed gives the same town, bit for bit.
Town makeTown(const TownParams& params = {});

}  // namespace quincunx

#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "scene/scene.h"

namespace quincunx {

/// A little sailing boat that looks different from every side, so that turns and mirrors are seen: a red lamp
/// to port, a green one to starboard, a ring on one side, bow and stern. Model space: bow along +x, masthead
/// along +y, starboard along +z, the water line at y = 0; some two and a half units long and high. Placements
/// of the instances are those of its parts in the boat.
Scene makeBoat();

/// Round water about the origin, its surface at y = 0.
Scene makeSea();

/// A vertex of the boat that has a name.
struct BoatVertex {
    const char* name;
    std::size_t instance = 0;
    std::size_t vertex = 0;     ///< of the instance's mesh
    glm::vec3 positionBoat{0};  ///< in the boat's model space
};

/// Masthead, bow, stern (its upper starboard corner), clew (the sail's corner at the boom's end).
std::array<BoatVertex, 4> namedVertices(const Scene& boat);

}  // namespace quincunx

#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/ray.h"
#include "scene/still_life.h"

namespace quincunx {

/// A rectangle of tiles, seen from the side that edgeU × edgeV points to.
struct Tiling {
    std::string name;
    glm::vec3 corner{0};
    glm::vec3 edgeU{1, 0, 0};  ///< at right angles to edgeV
    glm::vec3 edgeV{0, 1, 0};
    int countU = 1;  ///< tiles along edgeU, ≥ 1
    int countV = 1;
    Material even;  ///< of tiles the sum of whose numbers, from the corner on, is even …
    Material odd;   ///< … and odd
};

/// A hall with walls of tiles, solids in it, and two mirrors. All but the mirrors is matt, so that every
/// point sends the same light in all directions, and every surface is known in closed form. World space:
/// right-handed, y up.
struct MirrorHall {
    StillLife contents;           ///< solids, lights, camera
    std::vector<Tiling> tilings;  ///< walls and what is flat
    Bounds walls;                 ///< the box whose inside the walls are
    Ball ball;                    ///< a mirror
    glm::vec3 ballTint{1};        ///< share of the light that it reflects
    Tiling panel;                 ///< a flat mirror; its materials and tiles count for nothing
    glm::vec3 panelTint{1};

    glm::vec3 panelCentre() const { return panel.corner + 0.5f * (panel.edgeU + panel.edgeV); }
};

/// The built-in hall: a silver ball on a plinth and a mirror let into the floor beside it.
MirrorHall makeMirrorHall();

/// The hall without its solids: walls, windows and mirrors.
MirrorHall emptied(MirrorHall hall);

/// All but the mirrors and the camera, so many times as far from `centre` and as large; lights shine so much
/// stronger that every point looks as before. factor > 0.
MirrorHall movedAway(MirrorHall hall, glm::vec3 centre, float factor);

/// The solids turned about the upright axis through a point.
MirrorHall turnedSolids(MirrorHall hall, glm::vec3 about, float radians);

/// All but the mirrors as triangles; tiles are two each. `segments` as in tessellate(StillLife).
Scene tessellate(const MirrorHall& hall, int segments);

/// The mirrors alone as triangles; their tints are the materials' `specular`.
Scene tessellateMirrors(const MirrorHall& hall, bool ball, bool panel, int segments);

}  // namespace quincunx

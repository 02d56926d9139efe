#pragma once

#include "scene/scene.h"
#include "trace/csg.h"
#include "trace/whitted_scene.h"

namespace quincunx {

/// What stands in the middle of the terrace: a rounded cube and three rods, put together by an operator.
enum class Sculpture { drilled, united, common };

/// A checkered terrace in the evening: balls of glass, silver and gold, a lens cut from two spheres in a
/// brass ring, a sculpture of constructed solids on a plinth, a balustrade of turned posts behind, and one
/// square lamp. One unit is a foot or so; the floor is y = 0. `lampSize`: the length of the lamp's sides
/// against the usual; the light that it gives stays the same.
WhittedContents makeTerrace(Sculpture sculpture = Sculpture::drilled, float lampSize = 1);
Camera terraceCamera();

/// The sculpture's cube, rods and lens, for measuring.
Csg roundedCube();
Csg rods();
Csg lens();

}  // namespace quincunx

#pragma once

#include "scene/scene.h"

namespace quincunx {

/// A spaceship with a habitat ring and burning engines before a planet and stars. Engines and stars emit far
/// more than a screen can show, as post-processing wants it. World space: right-handed, y up; the ship flies
/// towards +x. `segments` as in quincunx::tessellate for shapes.
Scene makeSpaceship(int segments);

}  // namespace quincunx

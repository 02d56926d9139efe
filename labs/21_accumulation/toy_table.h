#pragma once

#include "scene/scene.h"

namespace quincunx {

/// After which everything on the table begins anew; so do edges that move.
inline constexpr double roundSeconds = 4;

/// Toys on a table: peg dolls in a row away from the eye, a train that goes by and a pinwheel that turns,
/// under a lamp. World space: right-handed, y up, the table at y = 0. The train goes to the right by 2.4
/// units a second, the pinwheel turns counter-clockwise by ¾ a second; all begins anew after roundSeconds.
/// The first light casts shadows. `segments` as in quincunx::tessellate for shapes.
Scene makeToyTable(int segments);

}  // namespace quincunx

#pragma once

#include "scene/scene.h"

namespace quincunx {

/// The house's colonnade at dusk, with something for every effect: a low sun, a spot on the golden egg,
/// lamps, a chrome ball and a brass hoop that mirror, glass that blends, flames that glow, and balls that
/// circle the stone ring. World space: right-handed, y up, metres. `segments` as in quincunx::tessellate.
Scene makeEvening(int segments);

/// Places what moves as it is at that time. `scene` is one of `makeEvening`.
void poseEvening(Scene& scene, double seconds);

}  // namespace quincunx

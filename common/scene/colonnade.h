#pragma once

#include "scene/still_life.h"

namespace quincunx {

/// A round temple of the house on a sunny terrace: steps, a ring of columns that carry a stone ring, and a
/// golden egg on a pedestal in the middle; outside, balls and an obelisk. Thin and thick casters, shadows
/// that fall on flat, bent and upright receivers, and casters that touch what they shade. World space:
/// right-handed, y up, metres; the terrace's floor is y = 0. Light 0 is the sun.
StillLife makeColonnade();

}  // namespace quincunx

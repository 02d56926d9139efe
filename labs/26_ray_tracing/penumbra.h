#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "trace/whitted.h"

namespace quincunx {

/// A square lamp over a board that is turned against it, over a floor: what share of the lamp a point of the
/// floor sees is known.
struct PenumbraBench {
    PenumbraBench();

    AreaLight lamp;
    std::array<glm::vec3, 4> board;
    WhittedScene scene;
    std::vector<glm::vec3> points;  ///< of the floor, from full light through the penumbra into the shadow
};

/// The share of the lamp that a point sees past a flat convex board that lies between: the board is projected
/// onto the lamp and clipped by it (Sutherland and Hodgman 1974), in double, to some 1e-13.
double exactVisibleShare(const AreaLight& lamp, const std::array<glm::vec3, 4>& board, glm::vec3 point);

/// RMSE of `visibleShare` over the points, which take the sets in turn.
double penumbraError(const PenumbraBench& bench, const std::vector<std::vector<glm::vec2>>& sets);

/// The slope of log error against log count, by least squares.
double slopeOf(const std::vector<double>& counts, const std::vector<double>& errors);

}  // namespace quincunx

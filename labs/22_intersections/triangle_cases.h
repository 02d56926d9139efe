#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "labs/22_intersections/exhibit.h"

namespace quincunx {

/// How rays are aimed at triangles: somewhere near, at an edge, at a corner, at triangles a thousand to a
/// million times longer than wide.
enum class Aim { random, edge, corner, sliver };
inline constexpr Aim aims[] = {Aim::random, Aim::edge, Aim::corner, Aim::sliver};
const char* nameOf(Aim aim);

struct AimedRay {
    Ray ray;
    Triangle triangle;
    bool hits = false;  ///< by exact arithmetic
    double t = 0;       ///< if it hits
};

/// The same for the same seed.
std::vector<AimedRay> aimedRays(Aim aim, std::size_t count, std::uint64_t seed);

/// Nine textbook ways, then the watertight one.
inline constexpr int triangleWays = 10;
std::string nameOfWay(int way);
std::optional<double> meetTriangle(int way, const AimedRay& aimed);

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "trace/path.h"
#include "trace/trace_scene.h"

/// Scenes for path tracing: one to look at, and those whose light is known.
namespace quincunx {

struct PathSet {
    Scene scene;
    std::vector<TracedSolid> solids;
    OpaqueModel model = OpaqueModel::metallicRoughness;
};

/// A closed room of plaster, one wall petrol and one of fired clay, lit by a panel below the ceiling: an egg
/// of glass, a golden ring on edge, a ball of brushed metal and a stone drum.
PathSet makeChamber();

/// A closed box whose walls all shine with radiance 1 and scatter `albedo` of the light evenly: the light is
/// 1 / (1 − albedo) everywhere and in all directions.
PathSet makeFurnace(float albedo);
double furnaceRadiance(double albedo);

/// Two bodies that exchange light in closed form: a ball of radius `inner` that shines with radiance 1, in
/// the middle of a hollow ball of radius 1. Both scatter evenly. All that leaves the ball reaches the shell,
/// and of what leaves the shell, inner² reaches the ball; so that the light that leaves each is the same
/// everywhere.
PathSet makeShell(float inner, float innerAlbedo, float outerAlbedo);
struct ShellRadiance {
    double ball = 0;   ///< leaving the inner ball
    double shell = 0;  ///< leaving the outer one
};
ShellRadiance shellRadiance(double inner, double innerAlbedo, double outerAlbedo);

/// A shining ball (radiance 1) above the middle of a wide floor that scatters `albedo`, and nothing else. A
/// point of the floor at the distance d from the ball's centre, seen at the cosine c, sends back
/// albedo c (radius / d)², as long as all of the ball is above its horizon.
PathSet makeBallOverFloor(float albedo, float radius, float height);
double ballOverFloorRadiance(double albedo, double radius, double height, double distanceOnFloor);

/// Hundreds of small balls, matt, of metal and of glass, about three big ones, on a ball as large as a planet
/// and under a pale sky.
PathSet makeBallField(std::uint64_t seed);

}  // namespace quincunx

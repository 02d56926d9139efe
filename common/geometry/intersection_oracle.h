#pragma once

#include <optional>

#include "geometry/ray_shapes.h"
#include "math/quad_oracle.h"

/// The answers of exact arithmetic on the given floats, for `stress`, the map of lab 22 and benchmarks: every
/// decision by expansions, t by quadruple precision from them (relative error below 2^-100). The formulas are
/// not those of the routines that are measured. The tests hold them against rationals
/// (RayShapes.*, Overlap.*). Slow, microseconds each.
namespace quincunx {

std::optional<Quad> raySphereExact(const Ray& ray, const Ball& ball);
/// Numbers that are not zero must be between 2^-200 and 2^200.
std::optional<Quad> raySphereExact(const DRay& ray, const DBall& ball);

/// The numbers that are not zero must be less than 2^100 apart.
std::optional<Quad> rayCylinderExact(const Ray& ray, const Cylinder& cylinder);
std::optional<Quad> rayCappedCylinderExact(const Ray& ray, const Cylinder& cylinder);

std::optional<Quad> rayPlaneExact(const Ray& ray, const Plane& plane);

struct ExactSpan {
    Quad enter = 0;
    Quad exit = 0;
};
std::optional<ExactSpan> rayBoxExact(const Ray& ray, const Bounds& box);

/// The sign of n·p + offset.
int planeSignExact(const Plane& plane, glm::vec3 point);
bool ballsOverlapExact(const Ball& a, const Ball& b);
bool ballMeetsPlaneExact(const Ball& ball, const Plane& plane);

}  // namespace quincunx

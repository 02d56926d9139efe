#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"

/// Where rays meet spheres, cylinders, planes and boxes. Everything is in one frame and unit.
///
/// What a routine decides (hit or miss, inside or outside, in front or behind) is decided as exact arithmetic
/// on the given floats would: double arithmetic with a bound on its rounding errors answers nearly always,
/// and where the bound leaves it open, expansions do (math/expansion.h). Shapes are closed: touching counts,
/// and an origin on the surface hits it at t = 0. t has a relative error of at most 2^-31, so rounded to
/// float it is within 0.51 ulp. Finite input never gives NaN or infinity, except that a point or a t rounded
/// to float may leave float's range. A direction of zero gives no hit, nor does input that is not finite; a t
/// of zero is +0. Held by RayShapes.* against rationals.
///
/// What exactness costs against the textbook's form in float (bench_intersect, whole arrays): nothing for
/// planes, 1.5 to 1.7 times for balls, boxes and cylinders, 2.2 times for capped ones. `...Distance` gives t
/// alone and costs less.
namespace quincunx {

/// A cylinder around the segment from `base` to `base + axis`; infinite, it goes on along the axis both ways.
/// The axis has any finite length but zero; radius ≥ 0. Exactness of the capped one needs that the largest
/// and the smallest of its numbers that are not zero are less than 2^100 apart, and likewise the ray's.
struct Cylinder {
    glm::vec3 base{0};
    glm::vec3 axis{0, 0, 1};
    float radius = 1;
};

/// A ball of double data.
struct DBall {
    glm::dvec3 centre{0};
    double radius = 1;
};

/// The part of a ray, 0 ≤ enter ≤ exit, that lies in a shape; in lengths of the ray's direction.
struct RaySpan {
    double enter = 0;
    double exit = 0;
};

/// The nearest point of the sphere with t ≥ 0, from outside or from inside. The centre is projected onto the
/// ray, so that what decides is the distance r² − |l|², which does not cancel (Haines, Günther,
/// Akenine-Möller, "Precision improvements for ray/sphere intersection", Ray Tracing Gems, ch. 7, 2019). The
/// normal points out of the ball; the point lies on the sphere to the rounding of its float components.
std::optional<RayHit> raySphere(const Ray& ray, const Ball& ball);
std::optional<double> raySphereDistance(const Ray& ray, const Ball& ball);

/// The same for double data whose numbers are 0 or between 2^-200 and 2^200 in magnitude: decided exactly, t
/// to 6 ulp of double (6 u: c and the denominator of c / (b + √D) by 2 u and 3 u, the quotient). What the
/// bound on rounding does not let go as a miss is computed with expansions: a microsecond.
std::optional<double> raySphereDistance(const DRay& ray, const DBall& ball);

/// (−b ± √(b² − 4ac)) / 2a of |o + t d − c|² = r² in float (or double); the first that is not negative.
std::optional<float> raySphereNaive(const Ray& ray, const Ball& ball);
std::optional<double> raySphereNaive(const DRay& ray, const DBall& ball);

/// The nearest point of the infinite cylinder's side with t ≥ 0, from outside or from inside: the distance
/// between two lines, as for the sphere. A ray exactly parallel to the axis has none. The normal points
/// outwards.
std::optional<RayHit> rayCylinder(const Ray& ray, const Cylinder& cylinder);
std::optional<double> rayCylinderDistance(const Ray& ray, const Cylinder& cylinder);

/// (ox + t dx)² + (oy + t dy)² = r² about the z axis, solved by the quadratic formula in float.
std::optional<float> rayCylinderNaive(const Ray& ray, float radius);

/// The nearest point of the surface of the solid between the caps with t ≥ 0, from outside or from inside.
/// Parallel rays meet the caps. The normal points outwards; on the rim it is the side's or the cap's,
/// whichever is entered last (left first, from inside).
std::optional<RayHit> rayCappedCylinder(const Ray& ray, const Cylinder& cylinder);
std::optional<double> rayCappedCylinderDistance(const Ray& ray, const Cylinder& cylinder);

/// The same about the z axis, from z = 0 to `height`: the nearest of the quadratic's roots between the caps
/// and the cap planes' points within the radius, in float.
std::optional<float> rayCappedCylinderNaive(const Ray& ray, float radius, float height);

/// The point of the plane with t ≥ 0. A ray parallel to the plane has none unless its origin lies in it, then
/// t = 0; a plane with a normal of zero has none. The normal is the plane's, at unit length.
std::optional<RayHit> rayPlane(const Ray& ray, const Plane& plane);
std::optional<double> rayPlaneDistance(const Ray& ray, const Plane& plane);

/// −(n·o + offset) / (n·d) in float, with |n·d| < 1e-8 taken as parallel.
std::optional<float> rayPlaneNaive(const Ray& ray, const Plane& plane);

/// The part of the ray in the box, by slabs (Kay and Kajiya, "Ray tracing complex scenes", 1986). A component
/// of the direction that is ±0 makes its slab a test of the origin; flat boxes and rays in faces, along edges
/// and through corners count as hits. An empty box has none. `enter` is 0 where the origin is in the box.
std::optional<RaySpan> rayBox(const Ray& ray, const Bounds& box);
/// The nearest point of the box's surface with t ≥ 0. The normal is that of the face, outwards; on edges and
/// corners that of the lowest axis.
std::optional<RayHit> rayBoxSurface(const Ray& ray, const Bounds& box);

/// The slabs as on the flashcard, in float: tmin < tmax, no case for parallel rays, no t ≥ 0.
std::optional<RaySpan> rayBoxNaive(const Ray& ray, const Bounds& box);

}  // namespace quincunx

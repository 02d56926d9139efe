#pragma once

#include <array>
#include <cmath>
#include <span>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"

/// Which shapes overlap, and on which side of a plane they lie; for collision and culling. Everything is in
/// one frame and unit. Shapes are closed: touching counts as overlapping.
///
/// Every answer is that of exact arithmetic on the given floats: double arithmetic with a bound on its
/// rounding errors answers nearly always, and expansions (math/expansion.h) do where the bound leaves it
/// open. No finite input gives another result. What is not a number overlaps nothing and is on no one side of
/// a plane (`crossing`). Held by Overlap.* against rationals. That costs 1.2 times the textbook's form in
/// float for box and plane, 1.6 for two balls, 2.7 for a ball and a plane (bench_intersect).
namespace quincunx {

/// n·p + offset with a relative error of at most 2^-32, so of the exact sign: positive in front of the plane.
/// Times 1/|n| it is the distance. The products are exact in double; only a sum that cancels needs more.
inline double planeValue(const Plane& plane, glm::vec3 point);

enum class Side { behind = -1, crossing = 0, inFront = 1 };

/// Whether two balls have a point in common: |a − b|² ≤ (ra + rb)².
bool ballsOverlap(const Ball& a, const Ball& b);
/// |a − b| ≤ ra + rb in float.
bool ballsOverlapNaive(const Ball& a, const Ball& b);

/// The side of the plane that a ball is on: `crossing` where (n·c + offset)² ≤ r² n·n, so that the normal may
/// have any length. A plane with a normal of zero is crossed by everything.
Side sideOf(const Ball& ball, const Plane& plane);
/// The flashcard's n·c + offset ≤ r, true for an intersection: without the magnitude, every ball behind the
/// plane counts.
bool ballMeetsPlaneNaive(const Ball& ball, const Plane& plane);

/// The side of the plane that a box is on, by two of its eight corners: the one farthest along the normal and
/// the one farthest against it. An empty box is a bug of the caller.
Side sideOf(const Bounds& box, const Plane& plane);
/// The flashcard's two corners in float: different signs mean an intersection.
bool boxMeetsPlaneNaive(const Bounds& box, const Plane& plane);
/// The same with all eight corners, what two are measured against.
Side sideByEightCorners(const Bounds& box, const Plane& plane);

/// The side of the plane that the convex hull of points is on: triangles, tetrahedra, polygons, frusta.
/// `crossing` where a point lies in the plane or two are on different sides, and for no points at all.
Side sideOf(std::span<const glm::vec3> points, const Plane& plane);
/// Signs in float: true unless all are positive or all negative.
bool pointsMeetPlaneNaive(std::span<const glm::vec3> points, const Plane& plane);

/// The corners of a box: bit i of the index picks `max` on axis i.
std::array<glm::vec3, 8> cornersOf(const Bounds& box);

/// Whether two boxes have a point in common; empty ones have none.
bool boxesOverlap(const Bounds& a, const Bounds& b);
/// Whether a ball and a box have a point in common: the squared distance to the nearest point of the box
/// (Arvo, "A simple method for box-sphere intersection testing", Graphics Gems, 1990).
bool overlaps(const Ball& ball, const Bounds& box);

/// Six half spaces; what is in front of all is inside. Order: left, right, bottom, top, near, far. Doubles,
/// since a plane rounded to float cuts off what it should not.
struct Frustum {
    std::array<glm::dvec4, 6> planes;  ///< xyz: normal towards the inside, of no stated length; w: offset
};

/// The part of the world that a projection shows (Gribb and Hartmann, "Fast extraction of viewing frustum
/// planes from the world-view-projection matrix", 2001), for OpenGL's clip space −w ≤ x, y, z ≤ w. Compute
/// the matrix in double where the camera is far from the world's origin: a product in float moves the planes.
Frustum frustumOf(const glm::dmat4& clipFromWorld);

/// False only if all of the box lies outside one plane of the frustum: by its corner farthest along the
/// plane's normal, with 8 · 2^-53 of the terms' magnitudes granted: the planes' entries, the products and
/// three sums are rounded, five times 2^-53. So nothing that can be seen is left out; a few boxes near the
/// frustum's edges are kept although they are outside.
bool mayBeVisible(const Bounds& box, const Frustum& frustum);
bool mayBeVisible(const Ball& ball, const Frustum& frustum);

namespace detail {
/// The sum of doubles that a rounded sum leaves open, to 2^-52 relative.
double sumExactly(const std::array<double, 4>& terms);
}  // namespace detail

inline double planeValue(const Plane& plane, glm::vec3 point) {
    const double x = static_cast<double>(plane.normal.x) * point.x;
    const double y = static_cast<double>(plane.normal.y) * point.y;
    const double z = static_cast<double>(plane.normal.z) * point.z;
    const double w = plane.offset;
    const double sum = (x + y) + (z + w);
    // Two roundings on any path: off by 2 · 2^-53 of the magnitudes.
    const double magnitude = (std::abs(x) + std::abs(y)) + (std::abs(z) + std::abs(w));
    if (std::abs(sum) >= 0x1p-19 * magnitude) [[likely]]
        return sum;
    return detail::sumExactly({x, y, z, w});
}

}  // namespace quincunx

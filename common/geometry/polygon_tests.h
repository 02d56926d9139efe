#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <glm/glm.hpp>

#include "geometry/ray.h"

/// Is a point in a polygon? A polygon is the chain of its corners, closed from the last to the first, either
/// way round. It may be concave, touch or cross itself, repeat corners, lie on a line, have any number of
/// corners; with none it is empty. A point is inside if a half line from it crosses the chain an odd number
/// of times (even–odd rule). All tests are exact for finite coordinates: they hang on signs of
/// geometry/predicates.h alone.
///
/// Beside them stand the ways of the textbooks in float arithmetic, `...Naive`, for `stress`, sweeps, and the
/// tests. Exactness costs 0.8 to 1.5 times those, 3 times for the fan of triangles and for rays; winding
/// numbers take a sixth of the sum of angles (bench_polygon).
namespace quincunx {

enum class PointLocation { outside, boundary, inside };

/// By counting crossings with a half line to the right (Shimrat, "Algorithm 112", CACM 5(8), 1962), an edge
/// holding its lower end but not its upper one. `boundary` on an edge or a corner. Held by PointInPolygon.*.
PointLocation locate(glm::vec2 point, std::span<const glm::vec2> polygon);

/// The same, but points on edges are given to one side: of several polygons that share edges and tile a
/// region, each point of the region's interior is in exactly one. A point on an edge belongs to the polygon
/// on its right, on a level edge to the one above. Held by PointInPolygon.*.
bool containsHalfOpen(glm::vec2 point, std::span<const glm::vec2> polygon);

/// How often the chain turns around the point, counter-clockwise positive: the angle sum over 2π. None on the
/// boundary. (The nonzero rule of path filling; it differs from even–odd where the polygon covers itself.)
/// Held by PointInPolygon.*.
std::optional<int> windingNumber(glm::vec2 point, std::span<const glm::vec2> polygon);

/// By the triangles of corner 0 with each edge: the point is inside if it is in an odd number of them (each
/// owning its points as `containsHalfOpen` says). Equal to `locate`. Held by PointInPolygon.*.
PointLocation locateByTriangleFan(glm::vec2 point, std::span<const glm::vec2> polygon);

/// For convex polygons (`isConvex`), by the sides of their edges: the exact form of the sum of areas, of
/// Plücker's lines and of the cross products, which ask the same question (Σ|areas| = |Σ areas| if and only
/// if no two have opposite signs). Equal to `locate` for those. Held by PointInPolygon.*.
PointLocation locateInConvex(glm::vec2 point, std::span<const glm::vec2> polygon);

/// Whether the corners turn one way only, once around. Repeated corners and corners within edges are allowed;
/// a polygon on a line is not convex. Held by PointInPolygon.*.
bool isConvex(std::span<const glm::vec2> polygon);

/// The card's and the textbook's ways. Which polygons each is for, points on the boundary left to chance.
/// @{
/// Crossings with a horizontal line, both ends of an edge counting; any polygon.
bool insideByCrossingsNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// The sum of the signed angles under which the edges are seen is ±360°, to 1e-3 radians; simple polygons.
bool insideByAngleSumNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// The triangles of the point with the edges have together the polygon's area, to 2^-20 of it; convex.
bool insideByAreasNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// Inside an odd number of the triangles of corner 0 with the edges; any polygon.
bool insideByTriangleFanNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// On one side of all edges, taken as lines with homogeneous coordinates a × b (Plücker's, of the plane);
/// convex.
bool insideByPlueckerNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// On one side of all edges by (b − a) × (point − a); convex.
bool insideByCrossProductsNaive(glm::vec2 point, std::span<const glm::vec2> polygon);
/// @}

/// The naive ways by name, for tables and knobs.
enum class InsideMethod { crossings, angleSum, areas, triangleFan, pluecker, crossProducts };
constexpr InsideMethod insideMethods[] = {InsideMethod::crossings, InsideMethod::angleSum,
                                          InsideMethod::areas,     InsideMethod::triangleFan,
                                          InsideMethod::pluecker,  InsideMethod::crossProducts};
bool insideNaive(InsideMethod method, glm::vec2 point, std::span<const glm::vec2> polygon);

/// Where a ray meets a polygon in space.
struct PolygonHit {
    double t = 0;           ///< in lengths of the ray's direction
    glm::vec3 point{0};     ///< on the polygon's plane
    bool boundary = false;  ///< on an edge or a corner
    bool front = true;      ///< the ray comes from the side that sees the corners counter-clockwise
};

/// Where a ray meets a flat polygon, any of those above, with 0 ≤ t. Decided exactly: the corners are looked
/// at along the ray, where the ray is a point and all signs are those of `sideOfLine`; for a flat polygon
/// that is the same as projecting hit and corners along a coordinate axis. So polygons that share edges leave
/// no gap between them, flat or not. t and point lie on the plane of corner 0 with that edge whose triangle
/// looks largest from the ray (for a flat polygon, its plane), and `front` is of that triangle. t has a
/// relative error of at most 2^-35; the point's components are within 0.501 ulp plus 2^-35 (|x| + |y|), x and
/// y being the parts of point − corner 0 along that triangle's two sides. None for fewer than three corners,
/// for polygons that the ray sees edge-on (which lie in a plane with it), for the direction zero, and if
/// something is not finite. Held by RayPolygon.*.
std::optional<PolygonHit> intersectPolygon(const Ray& ray, std::span<const glm::vec3> polygon);

/// The card's way in float: the point on the plane of the first three corners, the coordinate in which the
/// normal is largest dropped, crossings counted.
std::optional<PolygonHit> intersectPolygonNaive(const Ray& ray, std::span<const glm::vec3> polygon);

/// A parallelogram: corner + a · u + b · v, 0 ≤ a, b ≤ 1.
struct Parallelogram {
    glm::vec3 corner{0};
    glm::vec3 u{1, 0, 0};
    glm::vec3 v{0, 1, 0};
};

struct ParallelogramHit {
    double t = 0;       ///< in lengths of the ray's direction
    glm::vec2 ab{0};    ///< coordinates on the parallelogram, in [0, 1]
    bool front = true;  ///< the ray comes from the side of u × v
};

/// Where a ray meets a parallelogram with 0 ≤ t, whose far corners are the exact sums: so two that share an
/// edge exactly leave no gap, and the answer does not depend on the length of the direction. Decided exactly;
/// t with a relative error of at most 2^-34, a and b to 3.1e-8. None if u and v are parallel, if the ray
/// runs in the plane, for the direction zero, and if something is not finite. Held by RayQuad.*.
std::optional<ParallelogramHit> intersectParallelogram(const Ray& ray, const Parallelogram& quad);

/// Float, rejecting |n·d| < 1e-8 for the unit normal n, as "Ray Tracing: The Next Week" has it.
std::optional<ParallelogramHit> intersectParallelogramNaive(const Ray& ray, const Parallelogram& quad);

}  // namespace quincunx

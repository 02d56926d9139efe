#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/polygon_tests.h"
#include "geometry/ray.h"

/// Rays against triangles, as textbooks do it and as it is right.
///
/// A ray meets a triangle where a point origin + t · direction with tMin ≤ t ≤ tMax lies in it, edges and
/// corners included. Whether it does is decided exactly by `intersectTriangle`, for any finite triangle, near
/// or far, tiny, huge or grazing, and for any length of the direction. So triangles that share an edge or a
/// corner leave no gap (a ray that meets the shared edge hits both), and a mirrored or turned triangle is met
/// by the mirrored or turned ray.
/// No hit, by definition: rays in the triangle's plane, triangles without area (also those of a mesh: their
/// neighbours close the gap), the direction zero, and anything that is not finite.
///
/// What exactness costs against Möller–Trumbore in float (bench_ray_triangle): 1.75 times for a ray at a
/// time, 1.4 for one ray and many triangles, 1.5 to 1.75 for packed arrays.
///
/// Triangles are counter-clockwise seen from their front. One frame and unit.
namespace quincunx {

struct Triangle {
    glm::vec3 a{0};
    glm::vec3 b{1, 0, 0};
    glm::vec3 c{0, 1, 0};
};

struct TriangleHit {
    double t = 0;                ///< in lengths of the ray's direction
    glm::vec3 weights{1, 0, 0};  ///< barycentric: the point is weights.x a + weights.y b + weights.z c
    glm::vec3 point{0};          ///< on the triangle
    bool front = true;           ///< the ray comes from the front
};

enum class Sides { both, front };

/// Which hits count. tMin ≤ tMax may be any numbers; both ends are included.
struct RayInterval {
    float tMin = 0;
    float tMax = std::numeric_limits<float>::infinity();
};

/// A ray made ready for many triangles: the shear that takes its direction to the z axis (Woop, Benthin,
/// Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013), in double.
class ShearedRay {
  public:
    explicit ShearedRay(const Ray& ray);

    /// The hit, decided exactly; also `interval`.
    /// - t: a relative error of at most 2^-34, so rounded to float 0.501 ulp;
    /// - weights: each in [0, 1] and within 3.1e-8 of its value (2^-25 of the rounding, 2^-30);
    /// - point: each component within 0.501 ulp plus 2^-28 of the triangle's longest edge.
    /// The signs of the three edge functions, and the quotients, are taken from double with a bound of their
    /// error, and from exact sums (math/exact.h) where the bound leaves them open: through corners and edges
    /// to the last bit, on extreme needles, under grazing rays. That takes 0.1 to 0.7 µs, but rarely: rays
    /// aimed at an edge in float arithmetic miss it by far more than double cannot tell. Held by
    /// RayTriangle.*.
    std::optional<TriangleHit> intersect(const Triangle& triangle, Sides sides = Sides::both,
                                         RayInterval interval = {}) const;

    const Ray& ray() const { return ray_; }

  private:
    /// An edge function that is off by `error`, with the exact sign.
    double withExactSign(double side, double error, glm::vec3 a, glm::vec3 b) const;
    std::optional<TriangleHit> intersectExactly(const Triangle& triangle, Sides sides,
                                                RayInterval interval) const;

    Ray ray_;
    int kx_ = 0;
    int ky_ = 1;
    int kz_ = 2;  ///< the axis along which the direction is longest
    bool valid_ = false;
    double shearX_ = 0;
    double shearY_ = 0;
    double shearZ_ = 0;
};

/// For one triangle: as ShearedRay(ray).intersect(...), with the same decisions and bounds. Möller and
/// Trumbore's numbers in double come first, which need no preparation; a ShearedRay gets what they leave
/// open.
std::optional<TriangleHit> intersectTriangle(const Ray& ray, const Triangle& triangle,
                                             Sides sides = Sides::both, RayInterval interval = {});

/// The same decisions and values (t to 2^-50, weights and point to 0.501 ulp) by a wholly different way,
/// every number an ExactSum: the oracle that the shipped program has for pictures, sweeps and `stress`.
/// Microseconds.
std::optional<TriangleHit> intersectTriangleOracle(const Ray& ray, const Triangle& triangle,
                                                   Sides sides = Sides::both, RayInterval interval = {});

/// Textbook forms in float, with 0 ≤ t and two-sided. None has a bound: where they lose digits, they lose
/// all.
/// @{
/// Möller, Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 2(1), 1997; only det = 0
/// rejected.
std::optional<TriangleHit> intersectMollerTrumboreNaive(const Ray& ray, const Triangle& triangle);
/// The point on the plane, projected along the longest component of the normal, inside by one of the ways.
std::optional<TriangleHit> intersectPlaneNaive(const Ray& ray, const Triangle& triangle, InsideMethod inside);
/// Plücker coordinates of the ray and of the three edges: all on one side.
std::optional<TriangleHit> intersectPlueckerNaive(const Ray& ray, const Triangle& triangle);
/// Woop, Benthin, Wald 2013 as published: float, with double where an edge function is zero. It leaves no
/// gaps, but scales badly and is as inexact as float.
std::optional<TriangleHit> intersectWoopNaive(const Ray& ray, const Triangle& triangle);
/// @}

/// Two triangles of a quadrilateral with the corners a, b, c, d in order, convex, flat or not, cut along ac.
/// The hit of the smaller t; `weights` are those of the triangle that was hit, a, b, c or a, c, d as
/// `secondTriangle` says. No gaps to anything that shares its edges. Concave ones: `intersectPolygon`.
/// Held by RayQuad.*.
struct QuadrilateralHit {
    TriangleHit hit;
    bool secondTriangle = false;
};
std::optional<QuadrilateralHit> intersectQuadrilateral(const Ray& ray,
                                                       const std::array<glm::vec3, 4>& corners,
                                                       Sides sides = Sides::both, RayInterval interval = {});

/// Rays as arrays of their coordinates, for vector units.
struct RayArrays {
    std::array<std::vector<float>, 3> origin;
    std::array<std::vector<float>, 3> direction;

    std::size_t size() const { return origin[0].size(); }
    void add(const Ray& ray);
    Ray at(std::size_t index) const;
};

/// Triangles as arrays of the coordinates of their corners.
struct TriangleArrays {
    std::array<std::vector<float>, 3> a;
    std::array<std::vector<float>, 3> b;
    std::array<std::vector<float>, 3> c;

    std::size_t size() const { return a[0].size(); }
    void add(const Triangle& triangle);
    Triangle at(std::size_t index) const;
};

/// Many rays against a triangle, and a ray against many triangles, two-sided, t ≥ 0. `t` has an entry for
/// each pair: infinity where there is no hit. The packed forms decide exactly as `intersectTriangle` does:
/// float arithmetic with a bound of its error settles nearly all pairs, a vector of them at a time, and
/// `intersectTriangle` the rest. t is within 2^-14 of its value, relative; the number of pairs left to
/// `intersectTriangle` is returned. Held by PackedRayTriangle.*.
/// @{
std::size_t intersectPacked(const RayArrays& rays, const Triangle& triangle, std::span<float> t);
std::size_t intersectPacked(const Ray& ray, const TriangleArrays& triangles, std::span<float> t);
void intersectMollerTrumborePackedNaive(const RayArrays& rays, const Triangle& triangle, std::span<float> t);
void intersectMollerTrumborePackedNaive(const Ray& ray, const TriangleArrays& triangles, std::span<float> t);
/// @}

}  // namespace quincunx

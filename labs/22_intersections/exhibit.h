#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/ray_shapes.h"
#include "geometry/ray_triangle.h"
#include "math/quad_oracle.h"

namespace quincunx {

/// A cylinder about a line parallel to y that ends nowhere.
struct Column {
    Cylinder cylinder;
};

/// Four triangles, seen from outside.
struct Tetrahedron {
    std::array<glm::vec3, 4> corners;
    std::array<Triangle, 4> faces() const;
};

/// A flat polygon, seen from both sides.
struct Card {
    std::vector<glm::vec3> corners;
};

using ExhibitShape = std::variant<Ball, Column, Cylinder, Bounds, Tetrahedron, Card, Plane>;

struct Exhibit {
    const char* name;
    ExhibitShape shape;
    glm::vec3 color{1};  ///< linear
    float gloss = 0;     ///< weight of the highlight
    Ball around;         ///< holds the shape; radius infinite where nothing does
};

/// How a ray is met: by the textbook's formulas in float; in float, arranged so that less cancels, where
/// there is such an arrangement; by the textbook's formulas in double; by the routines with a bound; or by
/// exact arithmetic.
enum class Method { naive, careful, real, stable, exact };

/// How the textbook meets a triangle: the point on its plane, inside by one of six tests; by lines in Plücker
/// coordinates; by Möller and Trumbore; by Woop, Benthin and Wald in float.
enum class TriangleWay {
    crossings,
    angleSum,
    areas,
    fan,
    pluecker2d,
    crossProducts,
    pluecker,
    mollerTrumbore,
    woop
};

struct Approach {
    Method method = Method::stable;
    TriangleWay triangle = TriangleWay::mollerTrumbore;  ///< for the naive method
};

/// The shapes of the lab: whole multiples of 1/64, so that moving them by whole numbers up to 2^17 changes
/// nothing but their place. The names are those of the knob `shape`, in its order.
std::vector<Exhibit> makeExhibits(glm::vec3 place);

/// The nearest point with t ≥ 0. Normals face the ray's origin.
std::optional<RayHit> meet(const Exhibit& exhibit, const Ray& ray, const Approach& approach);
/// Its t alone, which is what the methods are timed by.
std::optional<double> meetDistance(const Exhibit& exhibit, const Ray& ray, const Approach& approach);
/// The textbook's ways for one triangle.
std::optional<double> meetTriangleNaive(const Triangle& triangle, const Ray& ray, TriangleWay way);
/// The nearest t of exact arithmetic.
std::optional<Quad> meetExactly(const Exhibit& exhibit, const Ray& ray);

}  // namespace quincunx

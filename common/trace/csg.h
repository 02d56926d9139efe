#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"
#include "geometry/ray_shapes.h"
#include "geometry/ray_triangle.h"

/// Constructive solid geometry on rays (Roth, "Ray casting for modeling solids", CGIP 18, 1982): a ray cuts
/// each solid in intervals, and union, intersection and difference are merges of sorted lists of them.
///
/// The operations are the regularized ones (Requicha, "Representations for rigid solids", Computing Surveys
/// 12, 1980), on the line: what is left has no intervals of length zero, and intervals that touch are one. So
/// A − A is empty, A ∪ A and A ∩ A are A, and A ∪ (B − A) has no seam, for every ray and to the last bit:
/// where crossings are nearer to one another than double arithmetic can tell, their order, or that they are
/// equal, is decided by exact arithmetic on the given floats.
///
/// A ray in a face, along an edge, through a corner or along a cylinder's side is taken as if its origin were
/// moved by (ε⁴, ε⁶, ε⁷), ε above zero and smaller than any number (Edelsbrunner and Mücke, "Simulation of
/// simplicity", ACM TOG 9, 1990). So such rays are inside of exactly one of two solids that share the face.
///
/// Where all numbers of a solid are 0 or less than 2^20 apart in magnitude, and likewise the ray's, all this
/// is exact; beyond, ties of curved surfaces may be decided wrongly, never more. Held by Csg.*.
namespace quincunx {

/// What a solid is made of: an expression. Copies share their parts.
class Csg {
  public:
    enum class Operator { unite, intersect, subtract };

    /// InputError unless all numbers are finite. Solids without volume are empty.
    /// @{
    static Csg ball(const Ball& ball, std::uint32_t material = 0);
    static Csg box(const Bounds& box, std::uint32_t material = 0);
    /// The capped one.
    static Csg cylinder(const Cylinder& cylinder, std::uint32_t material = 0);
    /// Inside is where a ray has crossed it an odd number of times. InputError unless every edge, vertices at
    /// equal positions taken as one, belongs to an even number of triangles: then that is well defined.
    static Csg mesh(const Mesh& mesh, std::uint32_t material = 0);
    /// @}
    /// InputError where operators are nested more than `deepest` deep.
    static Csg combine(Operator op, const Csg& left, const Csg& right);

    static constexpr int deepest = 64;

    struct Node;
    const std::shared_ptr<const Node>& node() const { return node_; }

  private:
    explicit Csg(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
    std::shared_ptr<const Node> node_;
};

inline Csg unite(const Csg& left, const Csg& right) {
    return Csg::combine(Csg::Operator::unite, left, right);
}
inline Csg intersect(const Csg& left, const Csg& right) {
    return Csg::combine(Csg::Operator::intersect, left, right);
}
/// What of `left` is not in `right`.
inline Csg subtract(const Csg& left, const Csg& right) {
    return Csg::combine(Csg::Operator::subtract, left, right);
}

/// Where the line of a ray crosses the surface of a solid. Even ones of a list enter, odd ones leave.
struct CsgCrossing {
    double t = 0;               ///< in lengths of the ray's direction, of either sign
    double error = 0;           ///< t is off by this much at most
    std::uint32_t leaf = 0;     ///< the part whose surface this is, counted from the left of the expression
    std::uint32_t feature = 0;  ///< which of its surfaces; of a mesh, the triangle
    bool front = true;          ///< of a mesh, whether the ray comes from the triangle's front
    bool inverted = false;      ///< the surface is seen from within: it bounds what was subtracted
};

/// A point of a solid's surface.
struct CsgHit {
    double t = 0;                ///< in lengths of the ray's direction
    glm::vec3 point{0};          ///< on the surface
    glm::vec3 pointError{0};     ///< how far each component of it may be off the surface
    glm::dvec3 normal{0, 1, 0};  ///< unit length, out of the solid
    std::uint32_t leaf = 0;
    std::uint32_t material = 0;  ///< of that part
    bool front = true;           ///< the ray comes from outside
};

/// What is written while a ray is met, kept from ray to ray so that nothing is allocated: one a thread.
struct CsgScratch {
    std::vector<CsgCrossing> crossings;
    std::uint64_t leaves = 0;  ///< parts whose surfaces were solved for, in all
    std::uint64_t exact = 0;   ///< decisions that exact arithmetic had to take, in all
};

/// An expression made ready for rays. Read by any number of threads.
class CsgSolid {
  public:
    explicit CsgSolid(const Csg& expression);
    ~CsgSolid();
    CsgSolid(CsgSolid&&) noexcept;
    CsgSolid& operator=(CsgSolid&&) noexcept;

    /// All crossings of the ray's line, t growing strictly; an even number. They live in `scratch` until its
    /// next use. None for a direction of zero or a ray that is not finite.
    std::span<const CsgCrossing> crossings(const Ray& ray, CsgScratch& scratch) const;
    /// The first crossing in the interval, both ends included, decided exactly.
    std::optional<CsgHit> nearest(const Ray& ray, RayInterval interval, CsgScratch& scratch) const;
    bool occluded(const Ray& ray, RayInterval interval, CsgScratch& scratch) const;

    /// Holds the solid; empty where the solid must be.
    Bounds bounds() const;
    std::size_t leafCount() const;
    /// Of a part.
    std::uint32_t material(std::uint32_t leaf) const;
    /// Of all parts, each once.
    std::vector<std::uint32_t> materials() const;

  private:
    struct Parts;
    class Walk;
    std::unique_ptr<const Parts> parts_;
};

/// The same with textbook arithmetic: crossings in float, ends closer than `epsilon` taken as equal.
/// For balls, boxes and cylinders along z. {enter, leave, enter, leave, …}.
std::vector<float> csgCrossingsNaive(const Csg& expression, const Ray& ray, float epsilon);

}  // namespace quincunx

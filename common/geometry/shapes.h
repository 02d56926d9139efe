#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "geometry/ray.h"

/// Solids of revolution with smooth surfaces known in closed form. Each can be cut into triangles at any
/// fineness, with exact normals, and each can be met with a ray in double precision, so that a picture of the
/// triangles can be held against a picture of the surface itself.
///
/// Frame: model space, right-handed, the axis of revolution is y. A solid is made by turning a profile, a
/// curve in the half plane (ρ ≥ 0, y), about the axis. All profiles are chains of circular arcs and of lines
/// along ρ or y, tangent where they meet, so that every surface point has one normal.
namespace quincunx {

/// Where a ray meets a surface.
struct Hit {
    double t = 0;                ///< in lengths of the ray's direction
    glm::dvec3 position{0};      ///< on the surface, model space
    glm::dvec3 normal{0, 1, 0};  ///< unit length, out of the solid
};

/// A ball about the origin. radius > 0.
struct Sphere {
    double radius = 1;
};

/// A ring about the y axis: a circle of `minorRadius` carried along one of `majorRadius` > `minorRadius` > 0.
struct Torus {
    double majorRadius = 1;
    double minorRadius = 0.25;
};

/// All points within `radius` of the segment from (0, -halfLength, 0) to (0, halfLength, 0). halfLength ≥ 0.
struct Capsule {
    double radius = 0.5;
    double halfLength = 0.5;
};

/// A cylinder about the y axis whose rims are rounded: 0 < rimRadius ≤ halfHeight, rimRadius < radius.
struct Drum {
    double radius = 1;
    double halfHeight = 0.5;
    double rimRadius = 0.1;
};

/// The egg of four circles: below, half a ball of `radius`; above it arcs of twice the radius about the far
/// ends of the equator, and a cap of (2 - √2) times the radius about (0, radius, 0). The origin is the ball's
/// centre; the egg reaches from y = -radius to (3 - √2) · radius.
struct Egg {
    double radius = 1;
};

/// One piece of a profile, walked with the solid on the left, so that the normal points to the right.
struct ProfilePiece {
    enum class Kind { line, arc };
    Kind kind = Kind::line;
    glm::dvec2 from{0};  ///< line: (ρ, y) of its ends; one of the two coordinates stays the same
    glm::dvec2 to{0};
    glm::dvec2 centre{0};     ///< arc: (ρ, y), ρ of either sign; 0 makes a zone of a ball
    double radius = 0;        ///< arc: > 0
    double startRadians = 0;  ///< arc: from +ρ towards +y; growing to `endRadians` where the solid is convex,
    double endRadians = 0;    ///< falling where it is hollow; half a turn at most, or a whole one
};

/// A solid turned from any profile, from the axis at the bottom to the axis again. Made with Lathe.
struct Turned {
    std::vector<ProfilePiece> profile;
};

using Shape = std::variant<Sphere, Torus, Capsule, Drum, Egg, Turned>;

/// Draws the profile of a Turned: starts on the axis at height `bottom`, heading outwards.
class Lathe {
  public:
    explicit Lathe(double bottom) : position_(0, bottom) {}
    /// Straight on; only while heading along ρ or y. length > 0.
    Lathe& line(double length);
    /// Along a circle of `radius`, to the left (convex) for positive angles, to the right (hollow) for
    /// negative ones; at most half a turn.
    Lathe& arc(double radius, double degrees);
    /// The finished solid. The last piece must end on the axis, heading inwards.
    Turned finish() const;
    /// Where the next piece starts.
    glm::dvec2 position() const { return position_; }

  private:
    glm::dvec2 position_;
    double headingDegrees_ = 0;
    std::vector<ProfilePiece> pieces_;
};

/// A shape made ready: its profile and a ball around it. Making one costs more than a ray.
class Solid {
  public:
    explicit Solid(const Shape& shape);

    /// The nearest point of the surface with t ≥ 0, seen from outside or from inside.
    ///
    /// The ray is first carried to the point nearest the origin by exact-product cross products (Kahan), so
    /// that the distance it comes from costs no accuracy; spheres and cylinders are then solved by distance
    /// from the ray (Haines, Günther, Akenine-Möller: Ray Tracing Gems, ch. 7), tori by isolating the roots
    /// of their quartic between its critical points and refining each on the factored distance.
    ///
    /// With ε = 2^-53 and D = size(): the position lies within 8 ε D of the surface and within 64 ε D of the
    /// ray's line; t · |direction| is off by 64 ε D / cos + 8 ε |origin| at most, cos being the cosine
    /// between ray and normal. (|origin| enters through t alone: three roundings of the dot product, four of
    /// the division by |direction|², one of the sum.) A ray that passes the surface at less than 64 ε D may
    /// count as meeting it; every exact tangent does.
    std::optional<Hit> intersect(const DRay& ray) const;

    /// A piece of the profile, made ready.
    struct Part {
        ProfilePiece piece;
        glm::dvec2 first{0};  ///< direction of the arc's end with the smaller angle
        glm::dvec2 last{0};   ///< and of the other
        bool fullTurn = false;
        glm::dvec2 min{0};  ///< the box (ρ, y) that holds the piece
        glm::dvec2 max{0};
    };
    const std::vector<Part>& parts() const { return parts_; }
    /// A ball about (0, y, 0) that holds the solid.
    double boundingCentreY() const { return boundingCentreY_; }
    double boundingRadius() const { return boundingRadius_; }
    /// Largest distance of a point of the solid from the origin, from above.
    double size() const { return boundingRadius_ + std::abs(boundingCentreY_); }

  private:
    std::vector<Part> parts_;
    double boundingCentreY_ = 0;
    double boundingRadius_ = 0;
};

/// Solid(shape).intersect(ray).
std::optional<Hit> intersect(const Shape& shape, const DRay& ray);

/// Triangles of the shape. `segments` (3 … 4096) is the number of steps around the axis; along the profile,
/// steps are as long as the steps around are where the solid is widest, but each arc has at least one step
/// per third of a turn, and the profile has at least three steps if it is a loop and two if not. Positions
/// are the surface's own points and normals its own normals, both rounded once to float. Triangles are
/// counter-clockwise seen from outside, and every edge has exactly two when vertices at equal positions are
/// taken as one: vertices are doubled only along the seam u = 0 = 1 and at the ends of the axis.
/// texcoords: u around from +z over +x, v down from 0 where the profile ends to 1 where it starts.
Mesh tessellate(const Shape& shape, int segments, std::string name = {});

/// The number of triangles `tessellate` gives: 2 · segments · steps along the profile, less 2 · segments
/// unless the profile is a loop (a torus).
std::size_t triangleCount(const Shape& shape, int segments);

}  // namespace quincunx

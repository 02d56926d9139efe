#pragma once

#include <cmath>

#include <glm/glm.hpp>

/// On which side? Signs that are exact for every finite input, so that no two answers contradict each other:
/// the orientation of points in the plane and in space, of a line beside another, of a triangle towards the
/// eye. First comes the determinant in double with a bound of its rounding error; only what that leaves open
/// is summed without error (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates", Discrete Comput. Geom. 18, 1997).
///
/// That costs 1.2 times the textbook's form in float for points in the plane, 1.4 to 1.6 times for the others
/// (bench_polygon).
///
/// Each predicate has its textbook form beside it, `...Naive`, for `stress` and the tests alone.
/// Coordinates that are not finite are a bug of the caller: floats get a sign that means nothing, doubles
/// stop the program.
namespace quincunx {

namespace detail {
int exactOrientation(glm::vec2 a, glm::vec2 b, glm::vec2 c);
int exactOrientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);
int exactOrientation(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d);
/// ((b − a) × (c − a)) · (d − a), and direction · ((a − origin) × (b − origin)), each with a relative error
/// of at most 2^-52: 0.1 to 0.5 µs.
double orientationValue(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);
double sideOfLineValue(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b);

/// A value in double with a bound of its error.
struct Estimate {
    double value = 0;
    double error = 0;

    /// False too if something overflowed.
    bool decided() const { return std::abs(value) > error; }
};
Estimate orientationEstimate(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);
Estimate sideOfLineEstimate(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b);

inline int signOf(double x) {
    return (x > 0) - (x < 0);
}
}  // namespace detail

/// +1 if a, b, c turn counter-clockwise (x right, y up), −1 if clockwise, 0 if they lie on a line.
/// Held by Orientation2D.*.
inline int orientation(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
    // Floats: no product leaves the range of double. Bound: Shewchuk 1997, (3 + 16 u) u, u = 2^-53.
    const double left = (static_cast<double>(a.x) - c.x) * (static_cast<double>(b.y) - c.y);
    const double right = (static_cast<double>(a.y) - c.y) * (static_cast<double>(b.x) - c.x);
    const double difference = left - right;
    if (std::abs(difference) > 0x1.8000000000008p-52 * (std::abs(left) + std::abs(right))) [[likely]]
        return detail::signOf(difference);
    return detail::exactOrientation(a, b, c);
}

/// The same for doubles of the whole range.
int orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

/// (b − a) × (c − a).
float orientationNaive(glm::vec2 a, glm::vec2 b, glm::vec2 c);
double orientationNaive(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

/// +1 if d lies in front of the plane of a, b, c (on the side from which they are seen counter-clockwise), −1
/// if behind it, 0 on it, and where a, b, c have no plane. Held by Orientation3D.*.
int orientation(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);
int orientation(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d);

/// ((b − a) × (c − a)) · (d − a).
float orientationNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);
double orientationNaive(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d);

/// How the line origin + t · direction passes the one from a to b: the sign of direction · ((a − origin) ×
/// (b − origin)), the permuted inner product of their Plücker coordinates. 0 if they meet or are parallel.
/// Of a triangle whose normal points against the direction, the line passes all three edges at −1.
/// Held by SideOfLine.*.
int sideOfLine(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b);

/// By Plücker coordinates in float, not translated (Shoemake, "Plücker coordinate tutorial", Ray Tracing News
/// 11(1), 1998).
float sideOfLineNaive(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b);

enum class Facing { back = -1, edgeOn = 0, front = 1 };

/// Which side of a triangle, counter-clockwise from its front, an eye sees; `edgeOn` in the triangle's plane
/// and for triangles without area. Held by Facing.*.
inline Facing facing(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 eye) {
    return static_cast<Facing>(orientation(a, b, c, eye));
}

/// The same for an eye at infinity that looks along `viewDirection`, of any length.
Facing facingAlong(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 viewDirection);

/// The same on the screen (x right, y up).
inline Facing facingOnScreen(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
    return static_cast<Facing>(orientation(a, b, c));
}

/// The sign of ((b − a) × (c − a)) · (eye − a) in float.
Facing facingNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 eye);
/// The sign of −((b − a) × (c − a)) · viewDirection in float.
Facing facingAlongNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 viewDirection);

}  // namespace quincunx

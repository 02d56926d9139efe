#include "geometry/ray_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/overlap.h"
#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double u = 0x1p-53;  // the unit roundoff of double
constexpr double infinity = std::numeric_limits<double>::infinity();
/// The relative error that t may have.
constexpr double accepted = 0x1p-31;

struct ExactVector {
    Expansion x;
    Expansion y;
    Expansion z;
};

ExactVector exactDifference(glm::dvec3 a, glm::dvec3 b) {
    return {Expansion::difference(a.x, b.x), Expansion::difference(a.y, b.y),
            Expansion::difference(a.z, b.z)};
}

ExactVector exact(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}

Expansion dot(const ExactVector& a, const ExactVector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

ExactVector cross(const ExactVector& a, const ExactVector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double sumOfMagnitudes(glm::dvec3 v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

glm::dvec3 unit(glm::dvec3 v, glm::dvec3 fallback) {
    if (const std::optional<glm::dvec3> n = normalize(v))
        return *n;
    return normalize(fallback).value_or(glm::dvec3(0, 0, 1));
}

/// Where a line meets a round shape: a t² − 2 b t + c = 0.
struct Roots {
    double b;
    double c;       ///< of the sign of the origin's side: positive outside
    double a;       ///< > 0
    double spread;  ///< √(b² − a c) ≥ 0
};

/// The nearest root that is not negative; each term is used where it does not cancel.
std::optional<double> nearestRoot(const Roots& roots) {
    if (roots.c == 0)
        return 0.0;
    if (roots.c > 0) {
        if (roots.b <= 0)
            return std::nullopt;
        return roots.c / (roots.b + roots.spread);
    }
    return roots.b >= 0 ? (roots.b + roots.spread) / roots.a : roots.c / (roots.b - roots.spread);
}

struct Meeting {
    double t;
    glm::dvec3 fromCentre;  ///< out of the shape, of no stated length
};

enum class Verdict { hit, miss, open };

struct Filtered {
    Verdict verdict;
    double t = 0;
    double half = 0;  ///< from the middle of the chord to t
};

/// The nearest t ≥ 0 of middle ± half, whose errors are at most scaledError / gap; `open` where that does not
/// decide. (A product with the gap spares a division.)
inline Filtered nearestWithin(double middle, double half, double gap, double scaledError) {
    const double nearer = middle - half;
    const double farther = middle + half;
    // What is accepted is above 2^31 times its error, so its sign is right; the other's must be as well.
    if (nearer * gap * accepted >= scaledError)
        return {Verdict::hit, nearer, -half};
    if (farther * gap < -scaledError)
        return {Verdict::miss};
    if (nearer * gap < -scaledError && farther * gap * accepted >= scaledError)
        return {Verdict::hit, farther, half};
    return {Verdict::open};
}

// What is not finite is left open by every bound, and so ends in one of the exact forms.

std::optional<Meeting> meetSphereExactly(const DRay& ray, const DBall& ball) {
    if (!isFinite(ray.origin) || !isFinite(ray.direction) || !isFinite(ball.centre) ||
        !std::isfinite(ball.radius))
        return std::nullopt;
    const ExactVector toCentre = exactDifference(ball.centre, ray.origin);
    const ExactVector direction = exact(ray.direction);
    const Expansion a = dot(direction, direction);
    const Expansion b = dot(direction, toCentre);
    const Expansion c = dot(toCentre, toCentre) - Expansion::product(ball.radius, ball.radius);
    const Expansion discriminant = b.squared() - a * c;
    if (discriminant.sign() < 0)
        return std::nullopt;
    const std::optional<double> t = nearestRoot(
        {b.approximate(), c.approximate(), a.approximate(), std::sqrt(discriminant.approximate())});
    if (!t)
        return std::nullopt;
    return Meeting{*t, *t * ray.direction - (ball.centre - ray.origin)};
}

/// Bounds, to first order in u, with |f|, |l| below their sums of magnitudes: a is off by 2u a; b by
/// 4u |d||f|; the middle b/a by 7u |f|/|d|; l by 10u |f|, of which 3u |f| are not along d and count in |l|²
/// as 6u |l||f|, the rest as its square; so r² − |l|² is off by 6u |l||f| + 3u |l|² + 2u r² + (10u |f|)².
inline std::optional<Meeting> meetSphere(const Ray& ray, const Ball& ball) {
    const glm::dvec3 f = glm::dvec3(ball.centre) - glm::dvec3(ray.origin);
    const glm::dvec3 d(ray.direction);
    const double r = ball.radius;
    const double a = d.x * d.x + d.y * d.y + d.z * d.z;
    if (!(a > 0)) [[unlikely]]
        return std::nullopt;
    const double inverse = 1 / a;
    const double middle = (d.x * f.x + d.y * f.y + d.z * f.z) * inverse;
    const glm::dvec3 l = f - middle * d;
    const double missed = l.x * l.x + l.y * l.y + l.z * l.z;
    const double gap = r * r - missed;
    const double far = sumOfMagnitudes(f);
    const double gapError = u * ((12 * sumOfMagnitudes(l) + 0x1p-44 * far) * far + 4 * r * r);
    if (gap < -gapError)
        return std::nullopt;
    if (gap > gapError) {
        // half is off by half · gapError / gap; middle by 8u |f| / |d|, and |d| / a = 1 / |d|.
        const double half = std::sqrt(gap * inverse);
        const double reach = far * sumOfMagnitudes(d) * inverse;
        const double error = half * gapError + gap * (u * (8 * half + 10 * (reach + std::abs(middle))));
        const Filtered result = nearestWithin(middle, half, gap, error);
        if (result.verdict == Verdict::hit)
            return Meeting{result.t, result.half * d - l};
        if (result.verdict == Verdict::miss)
            return std::nullopt;
    }
    return meetSphereExactly({glm::dvec3(ray.origin), d}, {glm::dvec3(ball.centre), r});
}

struct ExactCylinder {
    Expansion a;
    Expansion b;
    Expansion c;
    double spread = 0;  ///< √(b² − a c)
    int discriminantSign = 0;
};

/// With f the way from the origin to the base: a = |d × axis|², b = (f × axis)·(d × axis),
/// c = |f × axis|² − r²|axis|², b² − a c = |axis|² (r²|d × axis|² − (f·(d × axis))²).
ExactCylinder exactCylinder(const ExactVector& f, const ExactVector& d, const ExactVector& axis, double r) {
    const ExactVector across = cross(d, axis);
    const ExactVector away = cross(f, axis);
    const Expansion squaredRadius = Expansion::product(r, r);
    const Expansion squaredAxis = dot(axis, axis);
    ExactCylinder result;
    result.a = dot(across, across);
    result.b = dot(away, across);
    result.c = dot(away, away) - squaredRadius * squaredAxis;
    const Expansion discriminant = squaredRadius * result.a - dot(f, across).squared();
    result.discriminantSign = discriminant.sign();
    if (result.discriminantSign > 0)
        result.spread = std::sqrt(squaredAxis.approximate()) * std::sqrt(discriminant.approximate());
    return result;
}

/// From the axis to the point of the ray at t.
glm::dvec3 fromAxis(const Ray& ray, const Cylinder& cylinder, double t) {
    const glm::dvec3 p = t * glm::dvec3(ray.direction) - (glm::dvec3(cylinder.base) - glm::dvec3(ray.origin));
    const glm::dvec3 axis(cylinder.axis);
    // By the cross product, whose terms cancel less than p − (p·axis) axis does.
    return glm::cross(axis, glm::cross(p, axis));
}

bool isFinite(const Ray& ray, const Cylinder& cylinder) {
    return quincunx::isFinite(ray.origin) && quincunx::isFinite(ray.direction) &&
           quincunx::isFinite(cylinder.base) && quincunx::isFinite(cylinder.axis) &&
           std::isfinite(cylinder.radius);
}

std::optional<Meeting> meetCylinderExactly(const Ray& ray, const Cylinder& cylinder) {
    if (!isFinite(ray, cylinder))
        return std::nullopt;
    const ExactCylinder sides = exactCylinder(exactDifference(cylinder.base, ray.origin),
                                              exact(ray.direction), exact(cylinder.axis), cylinder.radius);
    if (sides.discriminantSign < 0)
        return std::nullopt;
    const std::optional<double> t =
        nearestRoot({sides.b.approximate(), sides.c.approximate(), sides.a.approximate(), sides.spread});
    if (!t)
        return std::nullopt;
    return Meeting{*t, fromAxis(ray, cylinder, *t)};
}

/// The chord of a line in an infinite cylinder, with bounds on its errors.
struct Chord {
    enum class Kind { none, parallel, open, some };
    Kind kind = Kind::none;
    double middle = 0;
    double half = 0;
    double error = 0;
    double offAxis = 0;  ///< f·e / |e|²: how far the ray passes, in lengths of e
    glm::dvec3 e{0};     ///< d × axis
};

/// Bounds, to first order in u: e = d × axis by u |e|, its products being exact; e·e by 4u; m = f·e by
/// 5u |f||e|; r² e·e − m² by 6u r² e·e + 2u m² + 10u |m||f||e|; (f × axis)·e by 12u |f||axis||e|.
inline Chord chordOf(const Ray& ray, const Cylinder& cylinder) {
    const glm::dvec3 f = glm::dvec3(cylinder.base) - glm::dvec3(ray.origin);
    const glm::dvec3 axis(cylinder.axis);
    const double r = cylinder.radius;
    Chord chord;
    chord.e = crossInDouble(ray.direction, cylinder.axis);
    const glm::dvec3& e = chord.e;
    const double ee = e.x * e.x + e.y * e.y + e.z * e.z;
    if (ee == 0) {
        chord.kind = Chord::Kind::parallel;
        return chord;
    }
    const double m = f.x * e.x + f.y * e.y + f.z * e.z;
    const double aa = axis.x * axis.x + axis.y * axis.y + axis.z * axis.z;
    const double gap = r * r * ee - m * m;
    const double far = sumOfMagnitudes(f);
    const double sumE = sumOfMagnitudes(e);
    const double gapError = u * (8 * r * r * ee + (4 * std::abs(m) + 12 * far * sumE) * std::abs(m));
    if (gap < -gapError)
        return chord;
    const double inverse = 1 / ee;
    const double scaled = gap * aa;
    // Six lengths multiplied may leave the range of double; what has come close is left to the exact form.
    constexpr double least = 0x1p-900;
    if (!(gap > gapError && ee > least && scaled > least && scaled < infinity && gapError < infinity))
        [[unlikely]] {
        chord.kind = Chord::Kind::open;
        return chord;
    }
    const glm::dvec3 g(f.y * axis.z - f.z * axis.y, f.z * axis.x - f.x * axis.z, f.x * axis.y - f.y * axis.x);
    chord.kind = Chord::Kind::some;
    chord.middle = (g.x * e.x + g.y * e.y + g.z * e.z) * inverse;
    chord.half = std::sqrt(scaled) * inverse;
    chord.offAxis = m * inverse;
    chord.error = chord.half * (gapError / gap + 12 * u) +
                  20 * u * (far * sumOfMagnitudes(axis) * sumE * inverse + std::abs(chord.middle));
    return chord;
}

inline std::optional<Meeting> meetCylinder(const Ray& ray, const Cylinder& cylinder) {
    const Chord chord = chordOf(ray, cylinder);
    if (chord.kind == Chord::Kind::none || chord.kind == Chord::Kind::parallel)
        return std::nullopt;
    if (chord.kind == Chord::Kind::some) {
        const Filtered result = nearestWithin(chord.middle, chord.half, 1, chord.error);
        if (result.verdict == Verdict::miss)
            return std::nullopt;
        if (result.verdict == Verdict::hit) {
            // d less its part along the axis is axis × e / |axis|².
            const glm::dvec3 axis(cylinder.axis);
            const glm::dvec3 across = glm::cross(axis, chord.e) / glm::dot(axis, axis);
            return Meeting{result.t, result.half * across - chord.offAxis * chord.e};
        }
    }
    return meetCylinderExactly(ray, cylinder);
}

glm::vec3 pointAt(const Ray& ray, double t) {
    return glm::vec3(glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction));
}

/// A power of two that brings the largest of the numbers near 1.
double scaleOf(std::initializer_list<float> values) {
    float largest = 0;
    for (const float value : values)
        largest = std::max(largest, std::abs(value));
    return largest > 0 ? std::scalbn(1.0, -std::ilogb(largest)) : 1.0;
}

/// A quotient with a denominator above zero, or an end of the line.
struct Fraction {
    Expansion numerator;
    Expansion denominator = 1.0;
    bool infinite = false;

    double approximate() const {
        return infinite ? infinity : numerator.approximate() / denominator.approximate();
    }
};

struct CappedMeeting {
    double t = 0;
    int cap = 0;  ///< −1: at the base, 1: at the other end, 0: on the side
};

std::optional<CappedMeeting> meetCappedExactly(const Ray& ray, const Cylinder& cylinder) {
    if (!isFinite(ray, cylinder))
        return std::nullopt;
    // Powers of two keep the polynomials of degree 8 in range: t does not change with the unit of length if
    // the direction scales along with it, and is scaled back otherwise.
    const glm::vec3 o = ray.origin;
    const glm::vec3 d = ray.direction;
    const glm::vec3 p = cylinder.base;
    const glm::vec3 ax = cylinder.axis;
    const double lengths = scaleOf({o.x, o.y, o.z, p.x, p.y, p.z, ax.x, ax.y, ax.z, cylinder.radius});
    const double directions = scaleOf({d.x, d.y, d.z});
    const auto scaledDifference = [&](float a, float b) {
        return Expansion::difference(lengths * a, lengths * b);
    };
    const ExactVector f{scaledDifference(p.x, o.x), scaledDifference(p.y, o.y), scaledDifference(p.z, o.z)};
    const ExactVector axis = exact(lengths * glm::dvec3(ax));
    const ExactVector direction = exact(directions * glm::dvec3(d));
    const ExactCylinder sides = exactCylinder(f, direction, axis, lengths * cylinder.radius);
    const double tScale = directions / lengths;

    Expansion alongAxis = dot(direction, axis);
    const Expansion below = dot(f, axis);             // less than zero: the origin is above the base
    const Expansion above = below + dot(axis, axis);  // less than zero: above the other end
    const int heading = alongAxis.sign();
    const bool betweenCaps = below.sign() <= 0 && above.sign() >= 0;
    Fraction first;
    Fraction last;
    last.infinite = true;
    int firstCap = -1;
    if (heading == 0) {
        if (!betweenCaps)
            return std::nullopt;
    } else {
        first = {heading > 0 ? below : -above, heading > 0 ? alongAxis : -alongAxis};
        last = {heading > 0 ? above : -below, heading > 0 ? alongAxis : -alongAxis};
        firstCap = -heading;
        if (last.numerator.sign() < 0)
            return std::nullopt;
    }
    bool startsAtOrigin = false;
    if (first.numerator.sign() <= 0) {
        startsAtOrigin = true;
        first = {Expansion(), Expansion(1.0)};
    }
    /// The side's polynomial at a fraction: at most zero where the point is within the radius.
    const auto sideAt = [&](const Fraction& at) {
        return (sides.a * at.numerator.squared() - 2.0 * (sides.b * at.numerator * at.denominator) +
                sides.c * at.denominator.squared())
            .sign();
    };
    const bool parallel = sides.a.sign() == 0;
    const int atFirst = parallel ? sides.c.sign() : sideAt(first);
    const int atLast = last.infinite ? 1 : parallel ? sides.c.sign() : sideAt(last);
    const Roots roots{sides.b.approximate(), sides.c.approximate(), sides.a.approximate(), sides.spread};
    // Below zero only by rounding, where the numbers are too far apart for exactness.
    const auto result = [&](double t, int cap) { return CappedMeeting{std::max(0.0, t * tScale), cap}; };
    if (atFirst > 0 && atLast > 0) {
        // Outside at both ends: a hit only if the chord lies between them.
        if (parallel || sides.discriminantSign < 0)
            return std::nullopt;
        const bool afterFirst = (sides.b * first.denominator - sides.a * first.numerator).sign() >= 0;
        const bool beforeLast =
            last.infinite || (sides.a * last.numerator - sides.b * last.denominator).sign() >= 0;
        if (!afterFirst || !beforeLast)
            return std::nullopt;
    }
    if (atFirst > 0)
        return result(roots.b > 0 ? roots.c / (roots.b + roots.spread) : (roots.b - roots.spread) / roots.a,
                      0);
    if (!startsAtOrigin)
        return result(first.approximate(), firstCap);
    if (sides.c.sign() == 0)
        return result(0, 0);
    if (below.sign() == 0 || above.sign() == 0)
        return result(0, below.sign() == 0 ? -1 : 1);
    if (atLast <= 0)
        return result(last.approximate(), heading);
    return result(roots.b >= 0 ? (roots.b + roots.spread) / roots.a : roots.c / (roots.b - roots.spread), 0);
}

/// As chords: the side's and the slab's, each with its error; left to the exact form where they decide by
/// less than that.
inline std::optional<CappedMeeting> meetCapped(const Ray& ray, const Cylinder& cylinder) {
    if (ray.direction == glm::vec3(0) || cylinder.axis == glm::vec3(0)) [[unlikely]]
        return std::nullopt;
    const Chord chord = chordOf(ray, cylinder);
    if (chord.kind == Chord::Kind::none)
        return std::nullopt;
    const double alongAxis = dotInDouble(ray.direction, cylinder.axis);
    if (chord.kind != Chord::Kind::some || alongAxis == 0)
        return meetCappedExactly(ray, cylinder);
    const glm::dvec3 f = glm::dvec3(cylinder.base) - glm::dvec3(ray.origin);
    const glm::dvec3 axis(cylinder.axis);
    const double below = f.x * axis.x + f.y * axis.y + f.z * axis.z;
    const double aa = axis.x * axis.x + axis.y * axis.y + axis.z * axis.z;
    const double inverse = 1 / alongAxis;
    const double base = below * inverse;
    const double top = (below + aa) * inverse;
    // `below` is off by 4u |f||axis|, the sum by 3u aa more, the quotients by 3u of themselves.
    const double slabError = u * (8 * (sumOfMagnitudes(f) * sumOfMagnitudes(axis) + aa) * std::abs(inverse));
    const double error = chord.error + slabError;
    const double sideEnter = chord.middle - chord.half;
    const double sideExit = chord.middle + chord.half;
    const double slabEnter = std::min(base, top);
    const double slabExit = std::max(base, top);
    const double enter = std::max(sideEnter, slabEnter);
    const double exit = std::min(sideExit, slabExit);
    if (!(error < infinity))
        return meetCappedExactly(ray, cylinder);
    if (exit < -error || enter > exit + 2 * error)
        return std::nullopt;
    const int entryCap = sideEnter >= slabEnter ? 0 : alongAxis > 0 ? -1 : 1;
    const int exitCap = sideExit <= slabExit ? 0 : alongAxis > 0 ? 1 : -1;
    if (enter < exit - 2 * error) {
        if (enter * accepted >= error)
            return CappedMeeting{enter, entryCap};
        if (enter < -error && exit * accepted >= error)
            return CappedMeeting{exit, exitCap};
    }
    return meetCappedExactly(ray, cylinder);
}

/// n·d and n·o + offset decide: their signs are exact.
inline std::optional<double> meetPlane(const Ray& ray, const Plane& plane) {
    const double height = planeValue(plane, ray.origin);
    const double approach = dotInDouble(plane.normal, ray.direction);
    if (height == 0 && plane.normal != glm::vec3(0) && ray.direction != glm::vec3(0))
        return 0.0;
    if (approach == 0)
        return std::nullopt;
    const double t = -height / approach;
    return t > 0 && t < infinity && std::abs(approach) < infinity ? std::optional(t) : std::nullopt;
}

/// Whether n₁/d₁ ≤ n₂/d₂ for n = to − from; d₁, d₂ not zero.
bool quotientsOrdered(float to1, float from1, float d1, float to2, float from2, float d2) {
    const Expansion left = Expansion::difference(to1, from1) * Expansion(d2);
    const Expansion right = Expansion::difference(to2, from2) * Expansion(d1);
    const int order = (left - right).sign();
    return (d1 < 0) == (d2 < 0) ? order <= 0 : order >= 0;
}

struct Slabs {
    double enter = -infinity;
    double exit = infinity;
    int enterAxis = 0;
    int exitAxis = 0;
};

/// The line in the box; quotients are off by 3u of themselves (difference, reciprocal, product).
inline std::optional<Slabs> slabsOf(const Ray& ray, const Bounds& box) {
    if (box.empty() || ray.direction == glm::vec3(0)) [[unlikely]]
        return std::nullopt;
    // Comparisons below would pass over what is not a number.
    if (!quincunx::isFinite(ray.origin) || !quincunx::isFinite(ray.direction) ||
        !quincunx::isFinite(box.min) || !quincunx::isFinite(box.max)) [[unlikely]]
        return std::nullopt;
    Slabs slabs;
    const auto through = [&](float o, float d, float low, float high, int axis) {
        if (d == 0)
            return o >= low && o <= high;
        const double inverse = 1.0 / d;
        const double first = (static_cast<double>(low) - o) * inverse;
        const double second = (static_cast<double>(high) - o) * inverse;
        const double in = first < second ? first : second;
        const double out = first < second ? second : first;
        slabs.enterAxis = in > slabs.enter ? axis : slabs.enterAxis;
        slabs.enter = in > slabs.enter ? in : slabs.enter;
        slabs.exitAxis = out < slabs.exit ? axis : slabs.exitAxis;
        slabs.exit = out < slabs.exit ? out : slabs.exit;
        return true;
    };
    if (!through(ray.origin.x, ray.direction.x, box.min.x, box.max.x, 0) ||
        !through(ray.origin.y, ray.direction.y, box.min.y, box.max.y, 1) ||
        !through(ray.origin.z, ray.direction.z, box.min.z, box.max.z, 2))
        return std::nullopt;
    // Differences of floats have the right sign, also rounded, so exit ≥ 0 is decided exactly.
    if (slabs.exit < 0)
        return std::nullopt;
    if (std::abs(slabs.enter - slabs.exit) > 8 * u * std::max(std::abs(slabs.enter), slabs.exit)) {
        if (slabs.enter > slabs.exit)
            return std::nullopt;
        return slabs;
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const float di = ray.direction[i];
            const float dj = ray.direction[j];
            if (i == j || di == 0 || dj == 0)
                continue;
            if (!quotientsOrdered(di > 0 ? box.min[i] : box.max[i], ray.origin[i], di,
                                  dj > 0 ? box.max[j] : box.min[j], ray.origin[j], dj))
                return std::nullopt;
        }
    slabs.enter = std::min(slabs.enter, slabs.exit);
    return slabs;
}

}  // namespace

std::optional<double> raySphereDistance(const Ray& ray, const Ball& ball) {
    const std::optional<Meeting> meeting = meetSphere(ray, ball);
    return meeting ? std::optional(meeting->t) : std::nullopt;
}

std::optional<RayHit> raySphere(const Ray& ray, const Ball& ball) {
    const std::optional<Meeting> meeting = meetSphere(ray, ball);
    if (!meeting)
        return std::nullopt;
    const glm::dvec3 normal = unit(meeting->fromCentre, -glm::dvec3(ray.direction));
    return RayHit{meeting->t, glm::vec3(glm::dvec3(ball.centre) + static_cast<double>(ball.radius) * normal),
                  glm::vec3(normal)};
}

std::optional<double> raySphereDistance(const DRay& ray, const DBall& ball) {
    const glm::dvec3& d = ray.direction;
    const glm::dvec3 f = ball.centre - ray.origin;
    const double a = glm::dot(d, d);
    if (!(a > 0)) [[unlikely]]
        return std::nullopt;
    // As for floats, with a rounding more in each product.
    const glm::dvec3 l = f - glm::dot(d, f) / a * d;
    const double far = sumOfMagnitudes(f);
    const double squaredRadius = ball.radius * ball.radius;
    const double gapError = u * ((16 * sumOfMagnitudes(l) + 0x1p-43 * far) * far + 6 * squaredRadius);
    if (squaredRadius - glm::dot(l, l) < -gapError)
        return std::nullopt;
    const std::optional<Meeting> meeting = meetSphereExactly(ray, ball);
    return meeting ? std::optional(meeting->t) : std::nullopt;
}

namespace {

template <typename T>
std::optional<T> sphereByFormula(const glm::vec<3, T>& oc, const glm::vec<3, T>& d, T radius) {
    const T a = glm::dot(d, d);
    const T b = 2 * glm::dot(oc, d);
    const T c = glm::dot(oc, oc) - radius * radius;
    const T discriminant = b * b - 4 * a * c;
    if (discriminant < 0)
        return std::nullopt;
    const T root = std::sqrt(discriminant);
    const T nearer = (-b - root) / (2 * a);
    if (nearer >= 0)
        return nearer;
    const T farther = (-b + root) / (2 * a);
    return farther >= 0 ? std::optional(farther) : std::nullopt;
}

}  // namespace

std::optional<float> raySphereNaive(const Ray& ray, const Ball& ball) {
    return sphereByFormula<float>(ray.origin - ball.centre, ray.direction, ball.radius);
}

std::optional<double> raySphereNaive(const DRay& ray, const DBall& ball) {
    return sphereByFormula<double>(ray.origin - ball.centre, ray.direction, ball.radius);
}

std::optional<double> rayCylinderDistance(const Ray& ray, const Cylinder& cylinder) {
    const std::optional<Meeting> meeting = meetCylinder(ray, cylinder);
    return meeting ? std::optional(meeting->t) : std::nullopt;
}

std::optional<RayHit> rayCylinder(const Ray& ray, const Cylinder& cylinder) {
    const std::optional<Meeting> meeting = meetCylinder(ray, cylinder);
    if (!meeting)
        return std::nullopt;
    return RayHit{meeting->t, pointAt(ray, meeting->t),
                  glm::vec3(unit(meeting->fromCentre, -glm::dvec3(ray.direction)))};
}

std::optional<float> rayCylinderNaive(const Ray& ray, float radius) {
    const float a = ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y;
    const float b = 2 * (ray.origin.x * ray.direction.x + ray.origin.y * ray.direction.y);
    const float c = ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y - radius * radius;
    const float discriminant = b * b - 4 * a * c;
    if (discriminant < 0)
        return std::nullopt;
    const float root = std::sqrt(discriminant);
    const float nearer = (-b - root) / (2 * a);
    const float farther = (-b + root) / (2 * a);
    if (nearer >= 0)
        return nearer;
    if (farther < 0)
        return std::nullopt;
    return farther;
}

std::optional<double> rayCappedCylinderDistance(const Ray& ray, const Cylinder& cylinder) {
    const std::optional<CappedMeeting> meeting = meetCapped(ray, cylinder);
    return meeting ? std::optional(meeting->t) : std::nullopt;
}

std::optional<RayHit> rayCappedCylinder(const Ray& ray, const Cylinder& cylinder) {
    const std::optional<CappedMeeting> meeting = meetCapped(ray, cylinder);
    if (!meeting)
        return std::nullopt;
    const glm::dvec3 axis(cylinder.axis);
    const glm::dvec3 normal = meeting->cap == 0
                                  ? unit(fromAxis(ray, cylinder, meeting->t), -glm::dvec3(ray.direction))
                                  : static_cast<double>(meeting->cap) * unit(axis, axis);
    return RayHit{meeting->t, pointAt(ray, meeting->t), glm::vec3(normal)};
}

std::optional<float> rayCappedCylinderNaive(const Ray& ray, float radius, float height) {
    const glm::vec3& o = ray.origin;
    const glm::vec3& d = ray.direction;
    std::optional<float> nearest;
    const auto offer = [&](float t) {
        if (t >= 0 && !(nearest && *nearest <= t))
            nearest = t;
    };
    const float a = d.x * d.x + d.y * d.y;
    const float b = 2 * (o.x * d.x + o.y * d.y);
    const float c = o.x * o.x + o.y * o.y - radius * radius;
    const float discriminant = b * b - 4 * a * c;
    if (discriminant >= 0)
        for (const float root : {-std::sqrt(discriminant), std::sqrt(discriminant)}) {
            const float t = (-b + root) / (2 * a);
            const float z = o.z + t * d.z;
            if (z >= 0 && z <= height)
                offer(t);
        }
    for (const float z : {0.0f, height}) {
        const float t = (z - o.z) / d.z;
        const float x = o.x + t * d.x;
        const float y = o.y + t * d.y;
        if (x * x + y * y <= radius * radius)
            offer(t);
    }
    return nearest;
}

std::optional<double> rayPlaneDistance(const Ray& ray, const Plane& plane) {
    return meetPlane(ray, plane);
}

std::optional<RayHit> rayPlane(const Ray& ray, const Plane& plane) {
    const std::optional<double> t = meetPlane(ray, plane);
    if (!t)
        return std::nullopt;
    return RayHit{*t, pointAt(ray, *t), normalizeOr(plane.normal, glm::vec3(0, 0, 1))};
}

std::optional<float> rayPlaneNaive(const Ray& ray, const Plane& plane) {
    const float approach = glm::dot(plane.normal, ray.direction);
    if (std::abs(approach) < 1e-8f)
        return std::nullopt;
    const float t = -(glm::dot(plane.normal, ray.origin) + plane.offset) / approach;
    return t >= 0 ? std::optional(t) : std::nullopt;
}

std::optional<RaySpan> rayBox(const Ray& ray, const Bounds& box) {
    const std::optional<Slabs> slabs = slabsOf(ray, box);
    if (!slabs)
        return std::nullopt;
    return RaySpan{std::max(0.0, slabs->enter), std::max(0.0, slabs->exit)};
}

std::optional<RayHit> rayBoxSurface(const Ray& ray, const Bounds& box) {
    const std::optional<Slabs> slabs = slabsOf(ray, box);
    if (!slabs)
        return std::nullopt;
    const bool outside = slabs->enter >= 0;
    double t = std::max(0.0, outside ? slabs->enter : slabs->exit);
    int axis = outside ? slabs->enterAxis : slabs->exitAxis;
    bool onMax = (ray.direction[axis] > 0) != outside;
    if (!outside) {
        // An origin on a face that the ray runs along is on the surface, too.
        for (int i = 0; i < 3; ++i)
            if (ray.direction[i] == 0 && (ray.origin[i] == box.min[i] || ray.origin[i] == box.max[i])) {
                t = 0;
                axis = i;
                onMax = ray.origin[i] == box.max[i];
                break;
            }
    }
    glm::vec3 point = pointAt(ray, t);
    point[axis] = onMax ? box.max[axis] : box.min[axis];
    glm::vec3 normal(0);
    normal[axis] = onMax ? 1.0f : -1.0f;
    return RayHit{t, glm::clamp(point, box.min, box.max), normal};
}

std::optional<RaySpan> rayBoxNaive(const Ray& ray, const Bounds& box) {
    float tMin = -std::numeric_limits<float>::infinity();
    float tMax = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const float t0 = (box.min[axis] - ray.origin[axis]) / ray.direction[axis];
        const float t1 = (box.max[axis] - ray.origin[axis]) / ray.direction[axis];
        tMin = std::max(tMin, std::min(t0, t1));
        tMax = std::min(tMax, std::max(t0, t1));
    }
    return tMin < tMax ? std::optional(RaySpan{tMin, tMax}) : std::nullopt;
}

}  // namespace quincunx

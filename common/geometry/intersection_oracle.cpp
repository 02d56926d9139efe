#include "geometry/intersection_oracle.h"

#include <algorithm>
#include <array>
#include <vector>

#include "math/expansion.h"

namespace quincunx {
namespace {

using Exact3 = std::array<Expansion, 3>;

Exact3 exactly(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}

Exact3 minus(glm::dvec3 a, glm::dvec3 b) {
    return {Expansion::difference(a.x, b.x), Expansion::difference(a.y, b.y),
            Expansion::difference(a.z, b.z)};
}

Expansion dot(const Exact3& a, const Exact3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// a t² + 2 b t + c = 0, a > 0, with the sign and value of b² − a c.
struct Polynomial {
    Expansion a;
    Expansion b;
    Expansion c;
    Expansion discriminant;

    Quad root(int side) const {
        const Quad spread = discriminant.sign() > 0 ? squareRoot(discriminant.toQuad()) : Quad(0);
        const Quad half = b.toQuad();
        // The root that cancels is taken from the product of the two, c/a.
        const bool cancels = side < 0 ? half < 0 : half > 0;
        if (!cancels)
            return (-half + side * spread) / a.toQuad();
        return c.toQuad() / (-half - side * spread);
    }

    int signAt(const Expansion& numerator, const Expansion& denominator) const {
        return (a * numerator * numerator + 2.0 * (b * numerator * denominator) +
                c * denominator * denominator)
            .sign();
    }
};

/// The first root that is not negative. Where the origin is not on the surface, both roots have one sign
/// outside (that of −b) and different signs inside.
std::optional<Quad> firstRoot(const Polynomial& p) {
    if (p.discriminant.sign() < 0)
        return std::nullopt;
    if (p.c.sign() == 0)
        return Quad(0);
    if (p.c.sign() < 0)
        return p.root(1);
    return p.b.sign() < 0 ? std::optional(p.root(-1)) : std::nullopt;
}

/// With w = origin − base: |(w + t d) × axis|² = r² |axis|², the products expanded by Lagrange's identity.
Polynomial sideOf(const Exact3& w, const Exact3& d, const Exact3& axis, const Expansion& radius) {
    const Expansion axisAxis = dot(axis, axis);
    const Expansion alongD = dot(d, axis);
    const Expansion alongW = dot(w, axis);
    Polynomial p;
    p.a = axisAxis * dot(d, d) - alongD * alongD;
    p.b = axisAxis * dot(d, w) - alongD * alongW;
    p.c = axisAxis * dot(w, w) - alongW * alongW - radius * radius * axisAxis;
    p.discriminant = p.b * p.b - p.a * p.c;
    return p;
}

}  // namespace

std::optional<Quad> raySphereExact(const Ray& ray, const Ball& ball) {
    return raySphereExact(DRay{glm::dvec3(ray.origin), glm::dvec3(ray.direction)},
                          DBall{glm::dvec3(ball.centre), ball.radius});
}

std::optional<Quad> raySphereExact(const DRay& ray, const DBall& ball) {
    const Exact3 d = exactly(ray.direction);
    const Exact3 w = minus(ray.origin, ball.centre);
    Polynomial p;
    p.a = dot(d, d);
    if (p.a.sign() == 0)
        return std::nullopt;
    p.b = dot(d, w);
    const Expansion squaredRadius = Expansion::product(ball.radius, ball.radius);
    p.c = dot(w, w) - squaredRadius;
    // Lagrange: (d·w)² − d·d w·w = −|d × w|².
    const Exact3 across{d[1] * w[2] - d[2] * w[1], d[2] * w[0] - d[0] * w[2], d[0] * w[1] - d[1] * w[0]};
    p.discriminant = p.a * squaredRadius - dot(across, across);
    return firstRoot(p);
}

std::optional<Quad> rayCylinderExact(const Ray& ray, const Cylinder& cylinder) {
    const Polynomial p = sideOf(minus(ray.origin, cylinder.base), exactly(ray.direction),
                                exactly(cylinder.axis), cylinder.radius);
    return p.a.sign() == 0 ? std::nullopt : firstRoot(p);
}

std::optional<Quad> rayCappedCylinderExact(const Ray& ray, const Cylinder& cylinder) {
    const Exact3 w = minus(ray.origin, cylinder.base);
    const Exact3 d = exactly(ray.direction);
    const Exact3 axis = exactly(cylinder.axis);
    const Polynomial side = sideOf(w, d, axis, cylinder.radius);
    const Expansion height = dot(w, axis);
    const Expansion climb = dot(d, axis);
    const Expansion length = dot(axis, axis);
    if (dot(d, d).sign() == 0 || length.sign() == 0)
        return std::nullopt;

    // Every point of the surface that can be the first one: of those, the nearest counts.
    std::vector<Quad> found;
    const auto onCap = [&](const Expansion& rise) {
        // height + t climb = the cap's, t = rise / climb.
        if (climb.sign() == 0 || (rise.sign() != 0 && rise.sign() != climb.sign()))
            return;
        const Expansion numerator = climb.sign() > 0 ? rise : -rise;
        const Expansion denominator = climb.sign() > 0 ? climb : -climb;
        const int outside = side.a.sign() == 0 ? side.c.sign() : side.signAt(numerator, denominator);
        if (outside <= 0)
            found.push_back(rise.toQuad() / climb.toQuad());
    };
    onCap(-height);
    onCap(length - height);
    if (side.a.sign() > 0 && side.discriminant.sign() >= 0)
        for (const int which : {-1, 1}) {
            const bool onSurface =
                side.c.sign() == 0 && (which < 0 ? side.b.sign() >= 0 : side.b.sign() <= 0);
            const Quad t = onSurface ? Quad(0) : side.root(which);
            const Quad z = height.toQuad() + t * climb.toQuad();
            // Roots on a rim are seen by the caps as well, exactly; so here nothing is granted.
            if (t >= 0 && z >= 0 && z <= length.toQuad())
                found.push_back(t);
        }
    // Along the caps and along the side, the surface begins where the ray does.
    const bool between = height.sign() >= 0 && (length - height).sign() >= 0;
    if (between && side.c.sign() <= 0 &&
        (side.c.sign() == 0 || height.sign() == 0 || (length - height).sign() == 0))
        found.push_back(Quad(0));
    // Rays in a cap's plane that start outside meet the rim.
    if (found.empty())
        return std::nullopt;
    return *std::min_element(found.begin(), found.end());
}

std::optional<Quad> rayPlaneExact(const Ray& ray, const Plane& plane) {
    const Exact3 n = exactly(plane.normal);
    const Exact3 d = exactly(ray.direction);
    if (dot(n, n).sign() == 0 || dot(d, d).sign() == 0)
        return std::nullopt;
    const Expansion height = dot(n, exactly(ray.origin)) + Expansion(plane.offset);
    const Expansion approach = dot(n, d);
    if (height.sign() == 0)
        return Quad(0);
    if (approach.sign() == 0 || approach.sign() == height.sign())
        return std::nullopt;
    return -height.toQuad() / approach.toQuad();
}

std::optional<ExactSpan> rayBoxExact(const Ray& ray, const Bounds& box) {
    if (box.empty() || ray.direction == glm::vec3(0))
        return std::nullopt;
    struct End {
        Expansion numerator;
        Expansion denominator;  // > 0
        bool before(const End& other) const {
            return (numerator * other.denominator - other.numerator * denominator).sign() < 0;
        }
    };
    End enter{0.0, 1.0};
    std::optional<End> exit;
    for (int axis = 0; axis < 3; ++axis) {
        const float o = ray.origin[axis];
        const float d = ray.direction[axis];
        if (d == 0) {
            if (o < box.min[axis] || box.max[axis] < o)
                return std::nullopt;
            continue;
        }
        const End low{Expansion::difference(box.min[axis], o) * (d < 0 ? -1.0 : 1.0),
                      std::abs(static_cast<double>(d))};
        const End high{Expansion::difference(box.max[axis], o) * (d < 0 ? -1.0 : 1.0),
                       std::abs(static_cast<double>(d))};
        const End& in = d < 0 ? high : low;
        const End& out = d < 0 ? low : high;
        if (enter.before(in))
            enter = in;
        if (!exit || out.before(*exit))
            exit = out;
    }
    if (exit->before(enter))
        return std::nullopt;
    return ExactSpan{enter.numerator.toQuad() / enter.denominator.toQuad(),
                     exit->numerator.toQuad() / exit->denominator.toQuad()};
}

int planeSignExact(const Plane& plane, glm::vec3 point) {
    return (dot(exactly(plane.normal), exactly(point)) + Expansion(plane.offset)).sign();
}

bool ballsOverlapExact(const Ball& a, const Ball& b) {
    const Exact3 d = minus(a.centre, b.centre);
    const Expansion reach = Expansion(a.radius) + Expansion(b.radius);
    return (reach * reach - dot(d, d)).sign() >= 0;
}

bool ballMeetsPlaneExact(const Ball& ball, const Plane& plane) {
    const Exact3 n = exactly(plane.normal);
    const Expansion value = dot(n, exactly(ball.centre)) + Expansion(plane.offset);
    return (Expansion::product(ball.radius, ball.radius) * dot(n, n) - value * value).sign() >= 0;
}

}  // namespace quincunx

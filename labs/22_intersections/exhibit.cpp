#include "labs/22_intersections/exhibit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/intersection_oracle.h"
#include "geometry/polygon_tests.h"
#include "labs/22_intersections/forms.h"
#include "math/vector.h"

namespace quincunx {
namespace {

template <typename... Cases>
struct Overload : Cases... {
    using Cases::operator()...;
};
template <typename... Cases>
Overload(Cases...) -> Overload<Cases...>;

glm::vec3 facing(glm::vec3 normal, const Ray& ray) {
    return glm::dot(normal, ray.direction) > 0 ? -normal : normal;
}

/// The textbook's cylinder stands on the z axis: the axes change places, and the base goes to the origin.
glm::vec3 turned(glm::vec3 v) {
    return {v.z, v.x, v.y};
}

Ray onZAxis(const Ray& ray, const Cylinder& cylinder) {
    return {turned(ray.origin - cylinder.base), turned(ray.direction)};
}

DRay onZAxisInDouble(const Ray& ray, const Cylinder& cylinder) {
    return {glm::dvec3(turned(ray.origin)) - glm::dvec3(turned(cylinder.base)),
            glm::dvec3(turned(ray.direction))};
}

/// The first of the faces that `meetFace` meets.
template <typename MeetFace>
std::optional<double> nearestFace(const Tetrahedron& tetrahedron, const MeetFace& meetFace) {
    std::optional<double> nearest;
    for (const Triangle& face : tetrahedron.faces())
        if (const std::optional<double> t = meetFace(face); t && !(nearest && *nearest <= *t))
            nearest = t;
    return nearest;
}

template <typename T>
std::optional<double> widened(const std::optional<T>& t) {
    return t && std::isfinite(*t) ? std::optional<double>(*t) : std::nullopt;
}

std::optional<double> distanceNaive(const ExhibitShape& shape, const Ray& ray, TriangleWay way) {
    return std::visit(
        Overload{[&](const Ball& ball) { return widened(raySphereNaive(ray, ball)); },
                 [&](const Column& column) {
                     return widened(rayCylinderNaive(onZAxis(ray, column.cylinder), column.cylinder.radius));
                 },
                 [&](const Cylinder& can) {
                     return widened(rayCappedCylinderNaive(onZAxis(ray, can), can.radius, can.axis.y));
                 },
                 [&](const Bounds& box) -> std::optional<double> {
                     const std::optional<RaySpan> span = rayBoxNaive(ray, box);
                     if (!span || !(span->exit >= 0))
                         return std::nullopt;
                     return span->enter >= 0 ? span->enter : span->exit;
                 },
                 [&](const Tetrahedron& tetrahedron) {
                     return nearestFace(tetrahedron, [&](const Triangle& face) {
                         return meetTriangleNaive(face, ray, way);
                     });
                 },
                 [&](const Card& card) -> std::optional<double> {
                     const std::optional<PolygonHit> hit = intersectPolygonNaive(ray, card.corners);
                     return hit && std::isfinite(hit->t) ? std::optional(hit->t) : std::nullopt;
                 },
                 [&](const Plane& plane) { return widened(rayPlaneNaive(ray, plane)); }},
        shape);
}

std::optional<double> distanceCarefully(const ExhibitShape& shape, const Ray& ray) {
    return std::visit(
        Overload{[&](const Ball& ball) {
                     return widened(forms::firstOf(forms::sphereByDistance<float>(
                         ray.origin - ball.centre, ray.direction, ball.radius)));
                 },
                 [&](const Column& column) {
                     const Ray local = onZAxis(ray, column.cylinder);
                     return widened(forms::firstOf(forms::cylinderByDistance<float>(
                         local.origin, local.direction, column.cylinder.radius)));
                 },
                 [&](const Cylinder& can) {
                     const Ray local = onZAxis(ray, can);
                     return widened(forms::can<float>(
                         local.origin, local.direction, can.radius, can.axis.y,
                         forms::cylinderByDistance<float>(local.origin, local.direction, can.radius)));
                 },
                 [&](const Bounds& box) {
                     return widened(forms::box<float>(ray.origin, ray.direction, box.min, box.max));
                 },
                 [&](const Tetrahedron& tetrahedron) {
                     return nearestFace(tetrahedron, [&](const Triangle& face) {
                         return meetTriangleNaive(face, ray, TriangleWay::woop);
                     });
                 },
                 [&](const auto&) { return distanceNaive(shape, ray, TriangleWay::woop); }},
        shape);
}

std::optional<double> distanceInDouble(const ExhibitShape& shape, const Ray& ray) {
    const glm::dvec3 o(ray.origin);
    const glm::dvec3 d(ray.direction);
    return std::visit(
        Overload{
            [&](const Ball& ball) {
                return forms::firstOf(forms::sphere<double>(o - glm::dvec3(ball.centre), d, ball.radius));
            },
            [&](const Column& column) {
                const DRay local = onZAxisInDouble(ray, column.cylinder);
                return forms::firstOf(
                    forms::cylinder<double>(local.origin, local.direction, column.cylinder.radius));
            },
            [&](const Cylinder& can) {
                const DRay local = onZAxisInDouble(ray, can);
                return forms::can<double>(local.origin, local.direction, can.radius, can.axis.y,
                                          forms::cylinder<double>(local.origin, local.direction, can.radius));
            },
            [&](const Bounds& box) {
                return forms::box<double>(o, d, glm::dvec3(box.min), glm::dvec3(box.max));
            },
            [&](const Tetrahedron& tetrahedron) {
                return nearestFace(tetrahedron, [&](const Triangle& face) {
                    return forms::triangle<double>(o, d, glm::dvec3(face.a), glm::dvec3(face.b),
                                                   glm::dvec3(face.c));
                });
            },
            [&](const Card& card) {
                std::optional<double> t;
                for (std::size_t i = 1; i + 1 < card.corners.size() && !t; ++i)
                    t = forms::triangle<double>(o, d, glm::dvec3(card.corners[0]),
                                                glm::dvec3(card.corners[i]), glm::dvec3(card.corners[i + 1]));
                return t;
            },
            [&](const Plane& plane) {
                return forms::plane<double>(o, d, glm::dvec3(plane.normal), plane.offset);
            }},
        shape);
}

std::optional<double> distanceStably(const ExhibitShape& shape, const Ray& ray) {
    return std::visit(
        Overload{[&](const Ball& ball) { return raySphereDistance(ray, ball); },
                 [&](const Column& column) { return rayCylinderDistance(ray, column.cylinder); },
                 [&](const Cylinder& can) { return rayCappedCylinderDistance(ray, can); },
                 [&](const Bounds& box) -> std::optional<double> {
                     const std::optional<RaySpan> span = rayBox(ray, box);
                     if (!span)
                         return std::nullopt;
                     return span->enter > 0 ? span->enter : rayBoxSurface(ray, box)->t;
                 },
                 [&](const Tetrahedron& tetrahedron) {
                     return nearestFace(
                         tetrahedron,
                         [sheared = ShearedRay(ray)](const Triangle& face) -> std::optional<double> {
                             const std::optional<TriangleHit> hit = sheared.intersect(face);
                             return hit ? std::optional(hit->t) : std::nullopt;
                         });
                 },
                 [&](const Card& card) -> std::optional<double> {
                     const std::optional<PolygonHit> hit = intersectPolygon(ray, card.corners);
                     return hit ? std::optional(hit->t) : std::nullopt;
                 },
                 [&](const Plane& plane) { return rayPlaneDistance(ray, plane); }},
        shape);
}

/// The normal at a point that float arithmetic has found, wherever that is.
glm::vec3 normalNear(const ExhibitShape& shape, glm::vec3 point) {
    const auto side = [&](const Cylinder& c) {
        return normalizeOr(glm::vec3(point.x - c.base.x, 0, point.z - c.base.z), glm::vec3(0, 0, 1));
    };
    return std::visit(
        Overload{[&](const Ball& ball) { return normalizeOr(point - ball.centre, glm::vec3(0, 1, 0)); },
                 [&](const Column& column) { return side(column.cylinder); },
                 [&](const Cylinder& can) {
                     const float height = point.y - can.base.y;
                     const float toCap = std::min(std::abs(height), std::abs(can.axis.y - height));
                     const glm::vec2 out(point.x - can.base.x, point.z - can.base.z);
                     return toCap < std::abs(glm::length(out) - can.radius) ? glm::vec3(0, 1, 0) : side(can);
                 },
                 [&](const Bounds& box) {
                     const glm::vec3 out =
                         glm::abs((point - 0.5f * (box.min + box.max)) / (0.5f * (box.max - box.min)));
                     const int axis = out.x >= out.y ? (out.x >= out.z ? 0 : 2) : (out.y >= out.z ? 1 : 2);
                     glm::vec3 normal(0);
                     normal[axis] = point[axis] > 0.5f * (box.min + box.max)[axis] ? 1.0f : -1.0f;
                     return normal;
                 },
                 [&](const Tetrahedron& tetrahedron) {
                     glm::vec3 nearest(0, 1, 0);
                     float least = std::numeric_limits<float>::infinity();
                     for (const Triangle& face : tetrahedron.faces()) {
                         const glm::vec3 n =
                             normalizeOr(cross(face.b - face.a, face.c - face.a), glm::vec3(0, 1, 0));
                         const float away = std::abs(dot(n, point - face.a));
                         if (away < least) {
                             least = away;
                             nearest = n;
                         }
                     }
                     return nearest;
                 },
                 [&](const Card& card) {
                     const auto& c = card.corners;
                     return normalizeOr(cross(c[1] - c[0], c[2] - c[0]), glm::vec3(0, 1, 0));
                 },
                 [&](const Plane& plane) { return normalizeOr(plane.normal, glm::vec3(0, 1, 0)); }},
        shape);
}

/// The routines that give point and normal as well.
std::optional<RayHit> hitStably(const ExhibitShape& shape, const Ray& ray) {
    if (const auto* ball = std::get_if<Ball>(&shape))
        return raySphere(ray, *ball);
    if (const auto* column = std::get_if<Column>(&shape))
        return rayCylinder(ray, column->cylinder);
    if (const auto* can = std::get_if<Cylinder>(&shape))
        return rayCappedCylinder(ray, *can);
    if (const auto* box = std::get_if<Bounds>(&shape))
        return rayBoxSurface(ray, *box);
    if (const auto* plane = std::get_if<Plane>(&shape))
        return rayPlane(ray, *plane);
    const std::optional<double> t = distanceStably(shape, ray);
    if (!t)
        return std::nullopt;
    const glm::vec3 point(glm::dvec3(ray.origin) + *t * glm::dvec3(ray.direction));
    return RayHit{*t, point, normalNear(shape, point)};
}

/// The polygon by the triangles of its first corner: flat, convex, and exact corners, so the union of the
/// closed triangles is the closed polygon.
std::optional<Quad> cardExactly(const Card& card, const Ray& ray) {
    for (std::size_t i = 1; i + 1 < card.corners.size(); ++i)
        if (const auto hit =
                intersectTriangleOracle(ray, {card.corners[0], card.corners[i], card.corners[i + 1]}))
            return Quad(hit->t);
    return std::nullopt;
}

Ball around(glm::vec3 centre, float radius) {
    return {centre, radius};
}

}  // namespace

std::array<Triangle, 4> Tetrahedron::faces() const {
    const auto& c = corners;
    return {Triangle{c[0], c[1], c[2]}, Triangle{c[0], c[2], c[3]}, Triangle{c[0], c[3], c[1]},
            Triangle{c[1], c[3], c[2]}};
}

std::vector<Exhibit> makeExhibits(glm::vec3 place) {
    constexpr float everywhere = std::numeric_limits<float>::infinity();
    const auto at = [&](float x, float y, float z) { return place + glm::vec3(x, y, z); };
    // Corners on corner + a u + b v, flat because all of it is exact.
    Card card;
    for (const glm::vec2 ab : {glm::vec2(-0.625f, 0), glm::vec2(0.625f, 0), glm::vec2(1, 1.1875f),
                               glm::vec2(0, 1.9375f), glm::vec2(-1, 1.1875f)})
        card.corners.push_back(at(3.75f, 0, 1) + ab.x * glm::vec3(0.75f, 0, 0.5f) +
                               ab.y * glm::vec3(0.125f, 0.875f, -0.25f));
    return {
        {"sphere",
         Ball{at(-1.625f, 1, 0.25f), 1},
         {0.80f, 0.16f, 0.10f},
         0.5f,
         around(at(-1.625f, 1, 0.25f), 1)},
        {"cylinder",
         Column{{at(-3.5f, 0, -2), {0, 1, 0}, 0.375f}},
         {0.55f, 0.56f, 0.60f},
         0.2f,
         around(place, everywhere)},
        {"can",
         Cylinder{at(2.375f, 0, -1.25f), {0, 2, 0}, 0.8125f},
         {0.05f, 0.42f, 0.45f},
         0.4f,
         around(at(2.375f, 1, -1.25f), 1.5f)},
        {"box",
         Bounds{at(-0.25f, 0, -2.25f), at(1.125f, 1.375f, -0.875f)},
         {0.80f, 0.50f, 0.08f},
         0.15f,
         around(at(0.4375f, 0.6875f, -1.5625f), 1.5f)},
        {"triangle",
         Tetrahedron{
             {at(0.75f, 1.25f, 1.125f), at(0.625f, 0, 2), at(1.75f, 0, 0.875f), at(-0.25f, 0, 0.75f)}},
         {0.16f, 0.36f, 0.10f},
         0.2f,
         around(at(0.75f, 0.5f, 1.125f), 1.6f)},
        {"polygon", std::move(card), {0.30f, 0.14f, 0.48f}, 0.25f, around(at(3.8f, 0.9f, 0.9f), 2)},
        {"plane", Plane{{0, 1, 0}, -place.y}, {0.40f, 0.40f, 0.39f}, 0, around(place, everywhere)},
    };
}

std::optional<double> meetTriangleNaive(const Triangle& triangle, const Ray& ray, TriangleWay way) {
    const std::optional<TriangleHit> hit =
        way == TriangleWay::mollerTrumbore ? intersectMollerTrumboreNaive(ray, triangle)
        : way == TriangleWay::pluecker     ? intersectPlueckerNaive(ray, triangle)
        : way == TriangleWay::woop         ? intersectWoopNaive(ray, triangle)
                                   : intersectPlaneNaive(ray, triangle, insideMethods[static_cast<int>(way)]);
    return hit && std::isfinite(hit->t) ? std::optional(hit->t) : std::nullopt;
}

std::optional<double> meetDistance(const Exhibit& exhibit, const Ray& ray, const Approach& approach) {
    switch (approach.method) {
        case Method::naive:
            return distanceNaive(exhibit.shape, ray, approach.triangle);
        case Method::careful:
            return distanceCarefully(exhibit.shape, ray);
        case Method::real:
            return distanceInDouble(exhibit.shape, ray);
        case Method::stable:
            return distanceStably(exhibit.shape, ray);
        case Method::exact:
            break;
    }
    const std::optional<Quad> t = meetExactly(exhibit, ray);
    return t ? std::optional(static_cast<double>(*t)) : std::nullopt;
}

std::optional<RayHit> meet(const Exhibit& exhibit, const Ray& ray, const Approach& approach) {
    std::optional<RayHit> hit;
    if (approach.method == Method::stable) {
        hit = hitStably(exhibit.shape, ray);
    } else if (const std::optional<double> t = meetDistance(exhibit, ray, approach)) {
        // As a program in the same precision goes on.
        const bool inFloat = approach.method == Method::naive || approach.method == Method::careful;
        const glm::vec3 point = inFloat ? ray.origin + static_cast<float>(*t) * ray.direction
                                        : glm::vec3(glm::dvec3(ray.origin) + *t * glm::dvec3(ray.direction));
        hit = RayHit{*t, point, normalNear(exhibit.shape, point)};
    }
    if (hit)
        hit->normal = facing(hit->normal, ray);
    return hit;
}

std::optional<Quad> meetExactly(const Exhibit& exhibit, const Ray& ray) {
    return std::visit(Overload{[&](const Ball& ball) { return raySphereExact(ray, ball); },
                               [&](const Column& column) { return rayCylinderExact(ray, column.cylinder); },
                               [&](const Cylinder& can) { return rayCappedCylinderExact(ray, can); },
                               [&](const Bounds& box) -> std::optional<Quad> {
                                   const std::optional<ExactSpan> span = rayBoxExact(ray, box);
                                   if (!span)
                                       return std::nullopt;
                                   return span->enter > 0 ? span->enter : span->exit;
                               },
                               [&](const Tetrahedron& tetrahedron) {
                                   std::optional<Quad> nearest;
                                   for (const Triangle& face : tetrahedron.faces())
                                       if (const auto hit = intersectTriangleOracle(ray, face);
                                           hit && !(nearest && *nearest <= hit->t))
                                           nearest = hit->t;
                                   return nearest;
                               },
                               [&](const Card& card) { return cardExactly(card, ray); },
                               [&](const Plane& plane) { return rayPlaneExact(ray, plane); }},
                      exhibit.shape);
}

}  // namespace quincunx

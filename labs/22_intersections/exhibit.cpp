#include "labs/22_intersections/exhibit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/intersection_oracle.h"
#include "geometry/polygon_tests.h"
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

/// What a program makes of t in float: the point, and the normal of the shape there.
template <typename NormalAt>
std::optional<RayHit> fromFloat(const Ray& ray, std::optional<float> t, const NormalAt& normalAt) {
    if (!t || !std::isfinite(*t))
        return std::nullopt;
    const glm::vec3 point = ray.origin + *t * ray.direction;
    return RayHit{*t, point, facing(normalAt(point), ray)};
}

/// The textbook's cylinder stands on the z axis: the axes change places, and the base goes to the origin.
glm::vec3 turned(glm::vec3 v) {
    return {v.z, v.x, v.y};
}

Ray onZAxis(const Ray& ray, glm::vec3 base) {
    return {turned(ray.origin - base), turned(ray.direction)};
}

glm::vec3 awayFromAxis(const Cylinder& cylinder, glm::vec3 point) {
    const glm::vec3 out = point - cylinder.base;
    return normalizeNaive(glm::vec3(out.x, 0, out.z));
}

std::optional<RayHit> meetNaive(const ExhibitShape& shape, const Ray& ray) {
    return std::visit(
        Overload{[&](const Ball& ball) {
                     return fromFloat(ray, raySphereNaive(ray, ball),
                                      [&](glm::vec3 point) { return normalizeNaive(point - ball.centre); });
                 },
                 [&](const Column& column) {
                     const Cylinder& c = column.cylinder;
                     return fromFloat(ray, rayCylinderNaive(onZAxis(ray, c.base), c.radius),
                                      [&](glm::vec3 point) { return awayFromAxis(c, point); });
                 },
                 [&](const Cylinder& can) {
                     return fromFloat(
                         ray, rayCappedCylinderNaive(onZAxis(ray, can.base), can.radius, can.axis.y),
                         [&](glm::vec3 point) {
                             const float height = point.y - can.base.y;
                             const float nearCap = std::min(std::abs(height), std::abs(can.axis.y - height));
                             const glm::vec2 out(point.x - can.base.x, point.z - can.base.z);
                             return nearCap < std::abs(glm::length(out) - can.radius)
                                        ? glm::vec3(0, 1, 0)
                                        : awayFromAxis(can, point);
                         });
                 },
                 [&](const Bounds& box) {
                     const std::optional<RaySpan> span = rayBoxNaive(ray, box);
                     std::optional<float> t;
                     if (span && span->exit >= 0)
                         t = static_cast<float>(span->enter >= 0 ? span->enter : span->exit);
                     return fromFloat(ray, t, [&](glm::vec3 point) {
                         const glm::vec3 out =
                             (point - 0.5f * (box.min + box.max)) / (0.5f * (box.max - box.min));
                         const glm::vec3 size = glm::abs(out);
                         glm::vec3 normal(0);
                         const int axis =
                             size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
                         normal[axis] = 1;
                         return normal;
                     });
                 },
                 [&](const Tetrahedron& tetrahedron) {
                     std::optional<RayHit> nearest;
                     for (const Triangle& face : tetrahedron.faces())
                         if (const auto hit = intersectMollerTrumboreNaive(ray, face);
                             hit && !(nearest && nearest->t <= hit->t))
                             nearest = fromFloat(ray, static_cast<float>(hit->t), [&](glm::vec3) {
                                 return normalizeNaive(crossNaive(face.b - face.a, face.c - face.a));
                             });
                     return nearest;
                 },
                 [&](const Card& card) {
                     const std::optional<PolygonHit> hit = intersectPolygonNaive(ray, card.corners);
                     return fromFloat(ray, hit ? std::optional(static_cast<float>(hit->t)) : std::nullopt,
                                      [&](glm::vec3) {
                                          const auto& c = card.corners;
                                          return normalizeNaive(crossNaive(c[1] - c[0], c[2] - c[0]));
                                      });
                 },
                 [&](const Plane& plane) {
                     return fromFloat(ray, rayPlaneNaive(ray, plane),
                                      [&](glm::vec3) { return normalizeNaive(plane.normal); });
                 }},
        shape);
}

std::optional<RayHit> meetStably(const ExhibitShape& shape, const Ray& ray) {
    std::optional<RayHit> hit = std::visit(
        Overload{[&](const Ball& ball) { return raySphere(ray, ball); },
                 [&](const Column& column) { return rayCylinder(ray, column.cylinder); },
                 [&](const Cylinder& can) { return rayCappedCylinder(ray, can); },
                 [&](const Bounds& box) { return rayBoxSurface(ray, box); },
                 [&](const Tetrahedron& tetrahedron) {
                     std::optional<RayHit> nearest;
                     const ShearedRay sheared(ray);
                     for (const Triangle& face : tetrahedron.faces())
                         if (const auto met = sheared.intersect(face);
                             met && !(nearest && nearest->t <= met->t))
                             nearest = RayHit{
                                 met->t, met->point,
                                 normalizeOr(cross(face.b - face.a, face.c - face.a), glm::vec3(0, 1, 0))};
                     return nearest;
                 },
                 [&](const Card& card) {
                     const std::optional<PolygonHit> met = intersectPolygon(ray, card.corners);
                     const auto& c = card.corners;
                     return met ? std::optional(RayHit{
                                      met->t, met->point,
                                      normalizeOr(cross(c[1] - c[0], c[2] - c[0]), glm::vec3(0, 1, 0))})
                                : std::nullopt;
                 },
                 [&](const Plane& plane) { return rayPlane(ray, plane); }},
        shape);
    if (hit)
        hit->normal = facing(hit->normal, ray);
    return hit;
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
         Tetrahedron{{at(0.75f, 1.25f, 1.125f), at(0, 0, 1.75f), at(1.75f, 0, 1.5f), at(0.625f, 0, 0.25f)}},
         {0.16f, 0.36f, 0.10f},
         0.2f,
         around(at(0.75f, 0.5f, 1.125f), 1.6f)},
        {"polygon", std::move(card), {0.30f, 0.14f, 0.48f}, 0.25f, around(at(3.8f, 0.9f, 0.9f), 2)},
        {"plane", Plane{{0, 1, 0}, -place.y}, {0.62f, 0.60f, 0.56f}, 0, around(place, everywhere)},
    };
}

std::optional<RayHit> meet(const Exhibit& exhibit, const Ray& ray, Method method) {
    return method == Method::naive ? meetNaive(exhibit.shape, ray) : meetStably(exhibit.shape, ray);
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

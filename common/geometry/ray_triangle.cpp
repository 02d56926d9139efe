#include "geometry/ray_triangle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "geometry/predicates.h"
#include "geometry/ray_triangle_filter.h"
#include "math/exact_sum.h"
#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

bool isFinite(const Triangle& triangle) {
    return quincunx::isFinite(triangle.a) && quincunx::isFinite(triangle.b) && quincunx::isFinite(triangle.c);
}

int longestAxis(glm::vec3 v) {
    const glm::vec3 size = glm::abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// The sign of t − limit, t being where the ray meets the plane.
int compareExactly(const Ray& ray, const Triangle& triangle, float limit) {
    std::array<Expansion, 3> first;
    std::array<Expansion, 3> second;
    for (int i = 0; i < 3; ++i) {
        first[static_cast<std::size_t>(i)] = Expansion::difference(triangle.b[i], triangle.a[i]);
        second[static_cast<std::size_t>(i)] = Expansion::difference(triangle.c[i], triangle.a[i]);
    }
    Expansion slope;
    Expansion excess;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        const auto axis = static_cast<int>(i);
        const Expansion normal = first[j] * second[k] - first[k] * second[j];
        slope = slope + Expansion(ray.direction[axis]) * normal;
        excess = excess + (Expansion::difference(triangle.a[axis], ray.origin[axis]) -
                           Expansion::product(limit, ray.direction[axis])) *
                              normal;
    }
    return excess.sign() * slope.sign();
}

/// Whether tMin ≤ t ≤ tMax for a t that is known to a relative 2^-33.
bool isWithin(double t, const Ray& ray, const Triangle& triangle, RayInterval interval) {
    const double doubt = 0x1p-33 * std::abs(t);
    if (!(t - interval.tMin > doubt) &&
        (interval.tMin - t > doubt || compareExactly(ray, triangle, interval.tMin) < 0))
        return false;
    return interval.tMax - t > doubt ||
           (!(t - interval.tMax > doubt) && compareExactly(ray, triangle, interval.tMax) <= 0);
}

/// The point a + weight of b (b − a) + weight of c (c − a).
glm::vec3 pointOf(const Triangle& triangle, double b, double c) {
    const glm::dvec3 origin(triangle.a);
    return glm::vec3(origin + b * (glm::dvec3(triangle.b) - origin) + c * (glm::dvec3(triangle.c) - origin));
}

}  // namespace

ShearedRay::ShearedRay(const Ray& ray) : ray_(ray) {
    valid_ = isFinite(ray.origin) && isFinite(ray.direction) && ray.direction != glm::vec3(0);
    if (!valid_)
        return;
    kz_ = longestAxis(ray.direction);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kz_ + 2) % 3;
    const double along = ray.direction[kz_];
    if (along < 0)
        std::swap(kx_, ky_);  // keeps the turn of triangles
    shearX_ = ray.direction[kx_] / along;
    shearY_ = ray.direction[ky_] / along;
    shearZ_ = 1 / along;
}

std::optional<TriangleHit> ShearedRay::intersect(const Triangle& triangle, Sides sides,
                                                 RayInterval interval) const {
    if (!valid_)
        return std::nullopt;
    const double ox = ray_.origin[kx_];
    const double oy = ray_.origin[ky_];
    const double oz = ray_.origin[kz_];
    const double az = triangle.a[kz_] - oz;
    const double bz = triangle.b[kz_] - oz;
    const double cz = triangle.c[kz_] - oz;
    const double ax = triangle.a[kx_] - ox - shearX_ * az;
    const double ay = triangle.a[ky_] - oy - shearY_ * az;
    const double bx = triangle.b[kx_] - ox - shearX_ * bz;
    const double by = triangle.b[ky_] - oy - shearY_ * bz;
    const double cx = triangle.c[kx_] - ox - shearX_ * cz;
    const double cy = triangle.c[ky_] - oy - shearY_ * cz;
    double u = cx * by - cy * bx;
    double v = ax * cy - ay * cx;
    double w = bx * ay - by * ax;

    // With ε = 2^-53, h the largest sheared coordinate and z the largest depth: a difference has a relative
    // error ε, the shear factor ε, their product ε more, so a sheared coordinate is off by 4 z ε + 2 h ε. The
    // products of two are off by 2 h times that and h² ε, their difference by twice that and 2 h² ε:
    // h (16 z + 12 h) ε; the rest is for what is of second order.
    const double h =
        std::max(std::max(std::max(std::abs(ax), std::abs(ay)), std::max(std::abs(bx), std::abs(by))),
                 std::max(std::abs(cx), std::abs(cy)));
    const double z = std::max(std::max(std::abs(az), std::abs(bz)), std::abs(cz));
    const double error = h * (17 * z + 13 * h) * 0x1p-53;
    const double least = std::min(std::min(u, v), w);
    const double most = std::max(std::max(u, v), w);
    if (least < -error && most > error)
        return std::nullopt;
    if (!(least > error || most < -error)) [[unlikely]] {
        if (!isFinite(triangle))
            return std::nullopt;
        u = withExactSign(u, error, triangle.b, triangle.c);
        v = withExactSign(v, error, triangle.c, triangle.a);
        w = withExactSign(w, error, triangle.a, triangle.b);
        if (std::min(std::min(u, v), w) < 0 && std::max(std::max(u, v), w) > 0)
            return std::nullopt;
    }

    // The three have one sign, each off by 2 `error` at most. Their sum is off by 7 `error`, the weights by
    // 9 error/|sum|, and the depth by 18 error/|sum| times the extent in depth, and by 8 roundings of z.
    const double sum = u + v + w;
    const double toB = v / sum;
    const double toC = w / sum;
    const double alongB = bz - az;
    const double alongC = cz - az;
    const double depth = az + toB * alongB + toC * alongC;
    const double relative = error / std::abs(sum);
    const double depthError = 12 * relative * std::max(std::abs(alongB), std::abs(alongC)) + 8 * 0x1p-53 * z;
    if (!(relative < 0x1p-33 && depthError < 0x1.fp-35 * std::abs(depth))) [[unlikely]]
        return intersectExactly(triangle, sides, interval);
    const bool front = sum > 0;
    if (sides == Sides::front && !front)
        return std::nullopt;
    const double t = depth * shearZ_;
    if (!isWithin(t, ray_, triangle, interval))
        return std::nullopt;
    return TriangleHit{.t = t,
                       .weights = glm::vec3(u / sum, toB, toC),
                       .point = pointOf(triangle, toB, toC),
                       .front = front};
}

double ShearedRay::withExactSign(double side, double error, glm::vec3 a, glm::vec3 b) const {
    if (std::abs(side) > error)
        return side;
    // The shear takes the direction to +z or −z, and looks along it from behind: the sign is the opposite.
    const double exact = detail::sideOfLineValue(ray_.origin, ray_.direction, a, b);
    return exact == 0 ? 0
                      : std::copysign(std::max(std::abs(side), std::numeric_limits<double>::min()), -exact);
}

std::optional<TriangleHit> ShearedRay::intersectExactly(const Triangle& triangle, Sides sides,
                                                        RayInterval interval) const {
    if (!isFinite(triangle))
        return std::nullopt;
    const auto [a, b, c] = triangle;
    const glm::vec3 o = ray_.origin;
    const glm::vec3 d = ray_.direction;
    const double u = detail::sideOfLineValue(o, d, b, c);
    const double v = detail::sideOfLineValue(o, d, c, a);
    const double w = detail::sideOfLineValue(o, d, a, b);
    if (std::min(std::min(u, v), w) < 0 && std::max(std::max(u, v), w) > 0)
        return std::nullopt;
    const double slope = detail::sideOfLineValue(a, d, b, c);  // d · ((b − a) × (c − a))
    if (slope == 0)
        return std::nullopt;
    const bool front = slope < 0;
    if (sides == Sides::front && !front)
        return std::nullopt;
    const double t = -detail::orientationValue(a, b, c, o) / slope;
    if (!isWithin(t, ray_, triangle, interval))
        return std::nullopt;
    const double toB = v / slope;
    const double toC = w / slope;
    return TriangleHit{.t = t,
                       .weights = glm::vec3(u / slope, toB, toC),
                       .point = pointOf(triangle, toB, toC),
                       .front = front};
}

std::optional<TriangleHit> intersectTriangle(const Ray& ray, const Triangle& triangle, Sides sides,
                                             RayInterval interval) {
    // Möller and Trumbore's numbers in double, where no product of floats leaves the range, by the bounds of
    // ray_triangle_filter.h.
    using Components = detail::Components<double>;
    const auto difference = [](glm::vec3 to, glm::vec3 from) {
        return Components{static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y,
                          static_cast<double>(to.z) - from.z};
    };
    const Components s = difference(ray.origin, triangle.a);
    const Components e1 = difference(triangle.b, triangle.a);
    const Components e2 = difference(triangle.c, triangle.a);
    const Components d{ray.direction.x, ray.direction.y, ray.direction.z};
    const detail::Products<double> f = detail::productsOf(s, d, e1, e2);
    const double w = f.det - f.u - f.v;
    const double e = detail::larger(detail::largestSize(e1), detail::largestSize(e2));
    const double far = detail::sumOfSizes(s) + 4 * e;
    const double bound = 0x1p-48 * far * (detail::sumOfSizes(d) * e);
    const double least = detail::smaller(detail::smaller(f.u, f.v), w);
    const double most = detail::larger(detail::larger(f.u, f.v), w);
    if (least < -bound && most > bound)
        return std::nullopt;
    // A hit whose weights are off by less than 2 B/|det| < 2^-33, and t, its last roundings included, by
    // 2^-34.
    const double size = std::abs(f.det);
    if (!((least > bound || most < -bound) && bound < 0x1p-33 * size &&
          0x1.01p-48 * far * (e * e) < 0x1.fp-35 * std::abs(f.t))) [[unlikely]]
        return ShearedRay(ray).intersect(triangle, sides, interval);
    const bool front = f.det > 0;
    if (sides == Sides::front && !front)
        return std::nullopt;
    const double inverse = 1 / f.det;
    const double t = f.t * inverse;
    if (!isWithin(t, ray, triangle, interval))
        return std::nullopt;
    const double toB = f.u * inverse;
    const double toC = f.v * inverse;
    return TriangleHit{.t = t,
                       .weights = glm::vec3(w * inverse, toB, toC),
                       .point = pointOf(triangle, toB, toC),
                       .front = front};
}

namespace {

/// Adds scale · a · (b × c).
void addTripleProduct(ExactSum& sum, double scale, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        sum.add({scale, a[i], b[j], c[k]});
        sum.subtract({scale, a[i], b[k], c[j]});
    }
}

/// Adds scale · d · ((a − o) × (b − o)).
void addSide(ExactSum& sum, double scale, glm::vec3 o, glm::vec3 d, glm::vec3 a, glm::vec3 b) {
    addTripleProduct(sum, scale, d, a, b);
    addTripleProduct(sum, scale, d, o, a);
    addTripleProduct(sum, scale, d, b, o);
}

double quotient(const ExactSum& numerator, const ExactSum& denominator) {
    const ExactSum::Scaled n = numerator.scaled();
    const ExactSum::Scaled d = denominator.scaled();
    return n.mantissa == 0 ? 0 : std::scalbn(n.mantissa / d.mantissa, n.exponent - d.exponent);
}

}  // namespace

std::optional<TriangleHit> intersectTriangleOracle(const Ray& ray, const Triangle& triangle, Sides sides,
                                                   RayInterval interval) {
    const auto [o, d] = ray;
    if (!isFinite(o) || !isFinite(d) || !isFinite(triangle))
        return std::nullopt;
    const auto [a, b, c] = triangle;
    ExactSum u;
    ExactSum v;
    ExactSum w;
    ExactSum slope;
    addSide(u, 1, o, d, b, c);
    addSide(v, 1, o, d, c, a);
    addSide(w, 1, o, d, a, b);
    addSide(slope, 1, a, d, b, c);
    const int side = slope.sign();
    if (side == 0 || u.sign() * side < 0 || v.sign() * side < 0 || w.sign() * side < 0)
        return std::nullopt;
    const bool front = side < 0;
    if (sides == Sides::front && !front)
        return std::nullopt;
    ExactSum height;  // (a − o) · ((b − o) × (c − o))
    addTripleProduct(height, 1, a, b, c);
    addTripleProduct(height, -1, o, a, b);
    addTripleProduct(height, -1, o, b, c);
    addTripleProduct(height, -1, o, c, a);
    const auto compare = [&, &a = a, &b = b, &c = c, &d = d](float limit) {
        if (std::isinf(limit))
            return limit < 0 ? 1 : -1;
        ExactSum excess = height;
        addSide(excess, -limit, a, d, b, c);
        return excess.sign() * side;
    };
    if (!(compare(interval.tMin) >= 0 && compare(interval.tMax) <= 0))
        return std::nullopt;
    TriangleHit hit{.t = quotient(height, slope),
                    .weights = glm::vec3(quotient(u, slope), quotient(v, slope), quotient(w, slope)),
                    .point = glm::vec3(0),
                    .front = front};
    for (int i = 0; i < 3; ++i) {
        ExactSum component;
        addSide(component, a[i], o, d, b, c);
        addSide(component, b[i], o, d, c, a);
        addSide(component, c[i], o, d, a, b);
        hit.point[i] = static_cast<float>(quotient(component, slope));
    }
    return hit;
}

std::optional<TriangleHit> intersectMollerTrumboreNaive(const Ray& ray, const Triangle& triangle) {
    const glm::vec3 e1 = triangle.b - triangle.a;
    const glm::vec3 e2 = triangle.c - triangle.a;
    const glm::vec3 p = glm::cross(ray.direction, e2);
    const float det = glm::dot(e1, p);
    if (det == 0)
        return std::nullopt;
    const float inverse = 1 / det;
    const glm::vec3 s = ray.origin - triangle.a;
    const float u = glm::dot(s, p) * inverse;
    if (u < 0 || u > 1)
        return std::nullopt;
    const glm::vec3 q = glm::cross(s, e1);
    const float v = glm::dot(ray.direction, q) * inverse;
    if (v < 0 || u + v > 1)
        return std::nullopt;
    const float t = glm::dot(e2, q) * inverse;
    if (!(t >= 0))
        return std::nullopt;
    return TriangleHit{.t = t,
                       .weights = glm::vec3(1 - u - v, u, v),
                       .point = ray.origin + t * ray.direction,
                       .front = det > 0};
}

std::optional<TriangleHit> intersectPlaneNaive(const Ray& ray, const Triangle& triangle,
                                               InsideMethod inside) {
    const glm::vec3 normal = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
    const float slope = glm::dot(normal, ray.direction);
    if (slope == 0)
        return std::nullopt;
    const float t = glm::dot(normal, triangle.a - ray.origin) / slope;
    if (!(t >= 0))
        return std::nullopt;
    const glm::vec3 point = ray.origin + t * ray.direction;
    const int dropped = longestAxis(normal);
    const int x = (dropped + 1) % 3;
    const int y = (dropped + 2) % 3;
    const auto flat = [x, y](glm::vec3 v) { return glm::vec2(v[x], v[y]); };
    const std::array<glm::vec2, 3> corners = {flat(triangle.a), flat(triangle.b), flat(triangle.c)};
    if (!insideNaive(inside, flat(point), corners))
        return std::nullopt;
    const float area = orientationNaive(corners[0], corners[1], corners[2]);
    const float v = orientationNaive(corners[0], flat(point), corners[2]) / area;
    const float w = orientationNaive(corners[0], corners[1], flat(point)) / area;
    return TriangleHit{.t = t, .weights = glm::vec3(1 - v - w, v, w), .point = point, .front = slope < 0};
}

std::optional<TriangleHit> intersectPlueckerNaive(const Ray& ray, const Triangle& triangle) {
    const float u = sideOfLineNaive(ray.origin, ray.direction, triangle.b, triangle.c);
    const float v = sideOfLineNaive(ray.origin, ray.direction, triangle.c, triangle.a);
    const float w = sideOfLineNaive(ray.origin, ray.direction, triangle.a, triangle.b);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
        return std::nullopt;
    const float sum = u + v + w;
    if (sum == 0)
        return std::nullopt;
    const glm::vec3 weights(u / sum, v / sum, w / sum);
    const glm::vec3 point = weights.x * triangle.a + weights.y * triangle.b + weights.z * triangle.c;
    const int axis = longestAxis(ray.direction);
    const float t = (point[axis] - ray.origin[axis]) / ray.direction[axis];
    if (!(t >= 0))
        return std::nullopt;
    return TriangleHit{.t = t, .weights = weights, .point = point, .front = sum < 0};
}

std::optional<TriangleHit> intersectWoopNaive(const Ray& ray, const Triangle& triangle) {
    const int kz = longestAxis(ray.direction);
    int kx = (kz + 1) % 3;
    int ky = (kz + 2) % 3;
    if (ray.direction[kz] < 0)
        std::swap(kx, ky);
    const float shearX = ray.direction[kx] / ray.direction[kz];
    const float shearY = ray.direction[ky] / ray.direction[kz];
    const float shearZ = 1 / ray.direction[kz];
    const glm::vec3 a = triangle.a - ray.origin;
    const glm::vec3 b = triangle.b - ray.origin;
    const glm::vec3 c = triangle.c - ray.origin;
    const float ax = a[kx] - shearX * a[kz];
    const float ay = a[ky] - shearY * a[kz];
    const float bx = b[kx] - shearX * b[kz];
    const float by = b[ky] - shearY * b[kz];
    const float cx = c[kx] - shearX * c[kz];
    const float cy = c[ky] - shearY * c[kz];
    float u = cx * by - cy * bx;
    float v = ax * cy - ay * cx;
    float w = bx * ay - by * ax;
    if (u == 0 || v == 0 || w == 0) {
        u = differenceOfProducts(cx, by, cy, bx);
        v = differenceOfProducts(ax, cy, ay, cx);
        w = differenceOfProducts(bx, ay, by, ax);
    }
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
        return std::nullopt;
    const float det = u + v + w;
    if (det == 0)
        return std::nullopt;
    const float scaled = u * (shearZ * a[kz]) + v * (shearZ * b[kz]) + w * (shearZ * c[kz]);
    if (std::signbit(det) != std::signbit(scaled) && scaled != 0)
        return std::nullopt;
    const float t = scaled / det;
    return TriangleHit{.t = t,
                       .weights = glm::vec3(u / det, v / det, w / det),
                       .point = ray.origin + t * ray.direction,
                       .front = det > 0};
}

std::optional<QuadrilateralHit> intersectQuadrilateral(const Ray& ray,
                                                       const std::array<glm::vec3, 4>& corners, Sides sides,
                                                       RayInterval interval) {
    const ShearedRay sheared(ray);
    const auto first = sheared.intersect({corners[0], corners[1], corners[2]}, sides, interval);
    const auto second = sheared.intersect({corners[0], corners[2], corners[3]}, sides, interval);
    if (!first && !second)
        return std::nullopt;
    if (first && (!second || first->t <= second->t))
        return QuadrilateralHit{*first, false};
    return QuadrilateralHit{*second, true};
}

void RayArrays::add(const Ray& ray) {
    for (int i = 0; i < 3; ++i) {
        origin[static_cast<std::size_t>(i)].push_back(ray.origin[i]);
        direction[static_cast<std::size_t>(i)].push_back(ray.direction[i]);
    }
}

Ray RayArrays::at(std::size_t index) const {
    return {{origin[0][index], origin[1][index], origin[2][index]},
            {direction[0][index], direction[1][index], direction[2][index]}};
}

void TriangleArrays::add(const Triangle& triangle) {
    for (int i = 0; i < 3; ++i) {
        a[static_cast<std::size_t>(i)].push_back(triangle.a[i]);
        b[static_cast<std::size_t>(i)].push_back(triangle.b[i]);
        c[static_cast<std::size_t>(i)].push_back(triangle.c[i]);
    }
}

Triangle TriangleArrays::at(std::size_t index) const {
    return {{a[0][index], a[1][index], a[2][index]},
            {b[0][index], b[1][index], b[2][index]},
            {c[0][index], c[1][index], c[2][index]}};
}

}  // namespace quincunx

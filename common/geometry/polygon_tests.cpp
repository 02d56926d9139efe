#include "geometry/polygon_tests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/check.h"
#include "geometry/predicates.h"
#include "geometry/ray_triangle_filter.h"
#include "math/exact.h"
#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

/// Calls `edge(from, to)` for each edge of the closed chain until one returns false.
template <typename Corner, typename Edge>
bool forEachEdge(std::span<const Corner> polygon, const Edge& edge) {
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++)
        if (!edge(polygon[last], polygon[i]))
            return false;
    return true;
}

/// Whether x is one of a and b or between them.
bool between(float x, float a, float b) {
    return a < b ? a <= x && x <= b : b <= x && x <= a;
}

bool onSegment(glm::vec2 point, glm::vec2 a, glm::vec2 b) {
    return between(point.x, a.x, b.x) && between(point.y, a.y, b.y) && orientation(a, b, point) == 0;
}

bool onBoundary(glm::vec2 point, std::span<const glm::vec2> polygon) {
    return !forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) { return !onSegment(point, a, b); });
}

/// Whether the half line to the right from the point crosses the edge: +1 upwards, −1 downwards, 0 not, also
/// if the point lies on the edge.
int crossing(glm::vec2 point, glm::vec2 a, glm::vec2 b) {
    const bool aAbove = a.y > point.y;
    const bool bAbove = b.y > point.y;
    if (aAbove == bAbove)
        return 0;
    const int upwards = bAbove ? 1 : -1;
    return orientation(a, b, point) == upwards ? upwards : 0;
}

float cross2(glm::vec2 a, glm::vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// All of one sign, zeros allowed.
class OneSided {
  public:
    bool add(float side) {
        left_ |= side > 0;
        right_ |= side < 0;
        return !(left_ && right_);
    }

  private:
    bool left_ = false;
    bool right_ = false;
};

/// det [a, b, to − from] to 2^-52.
double tripleProduct(glm::vec3 a, glm::vec3 b, glm::vec3 to, glm::vec3 from) {
    return determinant(glm::mat4(glm::vec4(a, 0), glm::vec4(b, 0), glm::vec4(to, 1), glm::vec4(from, 1)));
}

/// To a relative 2^-37, so that quotients of two are within 2^-36.
bool isPrecise(const detail::Estimate& estimate) {
    return estimate.error < 0x1p-37 * std::abs(estimate.value);
}

/// `sideOfLineValue` to a relative 2^-37.
double preciseSide(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    const detail::Estimate estimate = detail::sideOfLineEstimate(origin, direction, a, b);
    return isPrecise(estimate) ? estimate.value : detail::sideOfLineValue(origin, direction, a, b);
}

/// The ray as a point, looked at along itself, with two axes across it.
class RayView {
  public:
    explicit RayView(const Ray& ray) : ray_(ray) {
        const glm::vec3 size = glm::abs(ray.direction);
        if (size.x >= size.y && size.x >= size.z)
            z_ = 0;
        else
            z_ = size.y >= size.z ? 1 : 2;
    }

    /// On which side of the point a corner lies, to the right and above.
    int right(glm::vec3 corner) const { return side(corner, (z_ + 1) % 3); }
    int above(glm::vec3 corner) const { return side(corner, (z_ + 2) % 3); }

  private:
    /// The sign of d_z (v_x − o_x) − d_x (v_z − o_z).
    int side(glm::vec3 v, int x) const {
        const glm::dvec3 d(ray_.direction);
        const double left = d[z_] * (static_cast<double>(v[x]) - ray_.origin[x]);
        const double down = d[x] * (static_cast<double>(v[z_]) - ray_.origin[z_]);
        // Each product is rounded twice, the difference once: as in `orientation`.
        if (std::abs(left - down) > 0x1.8000000000008p-52 * (std::abs(left) + std::abs(down))) [[likely]]
            return detail::signOf(left - down);
        return (Expansion(d[z_]) * Expansion::difference(v[x], ray_.origin[x]) -
                Expansion(d[x]) * Expansion::difference(v[z_], ray_.origin[z_]))
            .sign();
    }

    Ray ray_;
    int z_ = 0;
};

/// Where the corners' chain lies around the ray, seen along it.
PointLocation locateRay(const Ray& ray, std::span<const glm::vec3> polygon) {
    const RayView view(ray);
    bool inside = false;
    glm::vec3 a = polygon.back();
    int aHeight = view.above(a);
    for (const glm::vec3 b : polygon) {
        const int bHeight = view.above(b);
        if ((aHeight > 0) != (bHeight > 0)) {
            const int side = sideOfLine(ray.origin, ray.direction, a, b);
            if (side == 0)
                return PointLocation::boundary;
            inside ^= (side > 0) == (bHeight > 0);
        } else if (bHeight == 0) {
            const int bRight = view.right(b);
            if (bRight == 0 || (aHeight == 0 && view.right(a) == -bRight))
                return PointLocation::boundary;
        }
        a = b;
        aHeight = bHeight;
    }
    return inside ? PointLocation::inside : PointLocation::outside;
}

}  // namespace

PointLocation locate(glm::vec2 point, std::span<const glm::vec2> polygon) {
    bool inside = false;
    const bool beside = forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        const bool aAbove = a.y > point.y;
        const bool bAbove = b.y > point.y;
        if (aAbove == bAbove)  // then the edge can touch the point only from below
            return aAbove || std::max(a.y, b.y) < point.y || !onSegment(point, a, b);
        const int side = orientation(a, b, point);
        inside ^= (side > 0) == bAbove;
        return side != 0;
    });
    if (!beside)
        return PointLocation::boundary;
    return inside ? PointLocation::inside : PointLocation::outside;
}

bool containsHalfOpen(glm::vec2 point, std::span<const glm::vec2> polygon) {
    bool inside = false;
    forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        inside ^= crossing(point, a, b) != 0;
        return true;
    });
    return inside;
}

std::optional<int> windingNumber(glm::vec2 point, std::span<const glm::vec2> polygon) {
    int turns = 0;
    const bool beside = forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        turns += crossing(point, a, b);
        return !onSegment(point, a, b);
    });
    return beside ? std::optional(turns) : std::nullopt;
}

PointLocation locateByTriangleFan(glm::vec2 point, std::span<const glm::vec2> polygon) {
    if (onBoundary(point, polygon))
        return PointLocation::boundary;
    bool inside = false;
    for (std::size_t i = 2; i < polygon.size(); ++i)
        inside ^= containsHalfOpen(point, std::array{polygon[0], polygon[i - 1], polygon[i]});
    return inside ? PointLocation::inside : PointLocation::outside;
}

PointLocation locateInConvex(glm::vec2 point, std::span<const glm::vec2> polygon) {
    if (polygon.empty())
        return PointLocation::outside;
    bool left = false;
    bool right = false;
    bool on = false;
    const glm::dvec2 origin(point);
    glm::dvec2 a = glm::dvec2(polygon.back()) - origin;
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
        const glm::dvec2 b = glm::dvec2(polygon[i]) - origin;
        // As `orientation` does.
        const double there = a.x * b.y;
        const double back = a.y * b.x;
        a = b;
        if (std::abs(there - back) > 0x1.8000000000008p-52 * (std::abs(there) + std::abs(back))) [[likely]] {
            (there > back ? left : right) = true;
        } else if (polygon[last] != polygon[i]) {
            const int side = detail::exactOrientation(polygon[last], polygon[i], point);
            left |= side > 0;
            right |= side < 0;
            on |= side == 0;
        }
        if (left && right)
            return PointLocation::outside;
    }
    if (left == right)
        return PointLocation::outside;
    return on ? PointLocation::boundary : PointLocation::inside;
}

bool isConvex(std::span<const glm::vec2> polygon) {
    // The chain without repeated corners: each edge with the one before.
    const auto isBefore = [](glm::vec2 a, glm::vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    std::size_t start = 0;
    while (start < polygon.size() && polygon[start] == polygon[(start + 1) % polygon.size()])
        ++start;
    if (start == polygon.size())
        return false;
    glm::vec2 a = polygon[start];
    glm::vec2 b = polygon[(start + 1) % polygon.size()];
    int turn = 0;
    int reversals = 0;  // of the direction along x: two in one turn around
    for (std::size_t i = 2; i < polygon.size() + 2; ++i) {
        const glm::vec2 c = polygon[(start + i) % polygon.size()];
        if (c == b)
            continue;
        const int side = orientation(a, b, c);
        const bool reverses = isBefore(a, b) != isBefore(b, c);
        if ((side == 0 && reverses) || side * turn < 0)
            return false;
        turn = side != 0 ? side : turn;
        reversals += reverses ? 1 : 0;
        a = b;
        b = c;
    }
    return turn != 0 && reversals == 2;
}

bool insideByCrossingsNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    bool inside = false;
    forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        if (a.y != b.y && between(point.y, a.y, b.y))
            inside ^= a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) > point.x;
        return true;
    });
    return inside;
}

bool insideByAngleSumNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    float sum = 0;
    forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        sum += std::atan2(cross2(a - point, b - point), glm::dot(a - point, b - point));
        return true;
    });
    return std::abs(std::abs(sum) - 2 * std::numbers::pi_v<float>) < 1e-3f;
}

bool insideByAreasNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    float whole = 0;
    float parts = 0;
    forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        whole += cross2(a - polygon[0], b - polygon[0]);
        parts += std::abs(cross2(a - point, b - point));
        return true;
    });
    return parts <= std::abs(whole) * (1 + 0x1p-20f);
}

bool insideByTriangleFanNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    bool inside = false;
    for (std::size_t i = 2; i < polygon.size(); ++i)
        inside ^= insideByCrossProductsNaive(point, std::array{polygon[0], polygon[i - 1], polygon[i]});
    return inside;
}

bool insideByPlueckerNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    OneSided sides;
    return forEachEdge(polygon, [&](glm::vec2 a, glm::vec2 b) {
        return sides.add((a.y - b.y) * point.x + (b.x - a.x) * point.y + cross2(a, b));
    });
}

bool insideByCrossProductsNaive(glm::vec2 point, std::span<const glm::vec2> polygon) {
    OneSided sides;
    return forEachEdge(polygon,
                       [&](glm::vec2 a, glm::vec2 b) { return sides.add(cross2(b - a, point - a)); });
}

bool insideNaive(InsideMethod method, glm::vec2 point, std::span<const glm::vec2> polygon) {
    switch (method) {
        case InsideMethod::crossings:
            return insideByCrossingsNaive(point, polygon);
        case InsideMethod::angleSum:
            return insideByAngleSumNaive(point, polygon);
        case InsideMethod::areas:
            return insideByAreasNaive(point, polygon);
        case InsideMethod::triangleFan:
            return insideByTriangleFanNaive(point, polygon);
        case InsideMethod::pluecker:
            return insideByPlueckerNaive(point, polygon);
        case InsideMethod::crossProducts:
            return insideByCrossProductsNaive(point, polygon);
    }
    QX_CHECK(false);
}

std::optional<PolygonHit> intersectPolygon(const Ray& ray, std::span<const glm::vec3> polygon) {
    const auto isFiniteCorner = [](glm::vec3 corner) { return isFinite(corner); };
    if (polygon.size() < 3 || !isFinite(ray.origin) || !isFinite(ray.direction) ||
        ray.direction == glm::vec3(0) || !std::all_of(polygon.begin(), polygon.end(), isFiniteCorner))
        return std::nullopt;
    const PointLocation location = locateRay(ray, polygon);
    if (location == PointLocation::outside)
        return std::nullopt;

    // The largest by double arithmetic; should it be none, any that is one.
    const glm::vec3 a = polygon[0];
    std::size_t largest = 2;
    double size = -1;
    const glm::dvec3 along(ray.direction);
    const glm::dvec3 first(a);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const double next = std::abs(
            glm::dot(along, glm::cross(glm::dvec3(polygon[i - 1]) - first, glm::dvec3(polygon[i]) - first)));
        if (next > size) {
            size = next;
            largest = i;
        }
    }
    double facing = preciseSide(a, ray.direction, polygon[largest - 1], polygon[largest]);
    for (std::size_t i = 2; facing == 0 && i < polygon.size(); ++i) {
        facing = preciseSide(a, ray.direction, polygon[i - 1], polygon[i]);
        largest = i;
    }
    if (facing == 0)
        return std::nullopt;
    const glm::vec3 b = polygon[largest - 1];
    const glm::vec3 c = polygon[largest];
    const glm::vec3 o = ray.origin;
    const glm::vec3 d = ray.direction;
    PolygonHit hit;
    const detail::Estimate height = detail::orientationEstimate(a, b, c, o);
    hit.t = -(isPrecise(height) ? height.value : detail::orientationValue(a, b, c, o)) / facing;
    if (hit.t < 0)
        return std::nullopt;
    const double alongB = preciseSide(o, d, c, a) / facing;
    const double alongC = preciseSide(o, d, a, b) / facing;
    hit.point = glm::vec3(first + alongB * (glm::dvec3(b) - first) + alongC * (glm::dvec3(c) - first));
    hit.boundary = location == PointLocation::boundary;
    hit.front = facing < 0;
    return hit;
}

std::optional<PolygonHit> intersectPolygonNaive(const Ray& ray, std::span<const glm::vec3> polygon) {
    if (polygon.size() < 3)
        return std::nullopt;
    const glm::vec3 normal = glm::cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
    const float facing = glm::dot(normal, ray.direction);
    if (facing == 0)
        return std::nullopt;
    const float t = glm::dot(normal, polygon[0] - ray.origin) / facing;
    if (!(t >= 0))
        return std::nullopt;
    const glm::vec3 point = ray.origin + t * ray.direction;
    const glm::vec3 size = glm::abs(normal);
    const int dropped = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int x = (dropped + 1) % 3;
    const int y = (dropped + 2) % 3;
    bool inside = false;
    forEachEdge(polygon, [&](glm::vec3 a, glm::vec3 b) {
        if (a[y] != b[y] && between(point[y], a[y], b[y]))
            inside ^= a[x] + (point[y] - a[y]) / (b[y] - a[y]) * (b[x] - a[x]) > point[x];
        return true;
    });
    if (!inside)
        return std::nullopt;
    return PolygonHit{.t = t, .point = point, .boundary = false, .front = facing < 0};
}

namespace {

std::optional<ParallelogramHit> intersectParallelogramExactly(const Ray& ray, const Parallelogram& quad) {
    const glm::vec3 o = ray.origin;
    const glm::vec3 d = ray.direction;
    const auto [corner, u, v] = quad;
    if (!isFinite(o) || !isFinite(d) || !isFinite(corner) || !isFinite(u) || !isFinite(v))
        return std::nullopt;
    // Cramer's rule for corner + a u + b v = o + t d, every determinant to 2^-52.
    const double facing = determinant(glm::mat3(u, v, d));
    if (facing == 0)
        return std::nullopt;
    const auto within = [facing](double coordinate) {
        return facing > 0 ? coordinate >= 0 && coordinate <= facing * (1 + 0x1p-50)
                          : coordinate <= 0 && coordinate >= facing * (1 + 0x1p-50);
    };
    const double alongU = tripleProduct(v, d, o, corner);
    if (!within(alongU))
        return std::nullopt;
    const double alongV = tripleProduct(d, u, o, corner);
    if (!within(alongV))
        return std::nullopt;
    const double along = -tripleProduct(u, v, o, corner);
    if (along != 0 && (along > 0) != (facing > 0))
        return std::nullopt;

    // Beside the far edges: the sign of (w − edge) · (first × second), w = o − corner.
    const auto beyond = [&, &corner = corner](double coordinate, glm::vec3 edge, glm::vec3 first,
                                              glm::vec3 second) {
        if (std::abs(coordinate - facing) > 0x1p-50 * std::abs(facing))
            return false;
        Expansion excess;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const int k = (i + 2) % 3;
            excess = excess +
                     (Expansion::difference(o[i], corner[i]) - Expansion(edge[i])) *
                         (Expansion::product(first[j], second[k]) - Expansion::product(first[k], second[j]));
        }
        return excess.sign() == detail::signOf(facing);
    };
    if (beyond(alongU, u, v, d) || beyond(alongV, v, d, u))
        return std::nullopt;
    return ParallelogramHit{.t = along / facing,
                            .ab = glm::min(glm::vec2(glm::dvec2(alongU, alongV) / facing), glm::vec2(1)),
                            .front = facing < 0};
}

}  // namespace

std::optional<ParallelogramHit> intersectParallelogram(const Ray& ray, const Parallelogram& quad) {
    // The numbers of a triangle with the sides u and v, in double, with the bound of ray_triangle_filter.h,
    // which also covers det − a and det − b.
    using Components = detail::Components<double>;
    const Components s{static_cast<double>(ray.origin.x) - quad.corner.x,
                       static_cast<double>(ray.origin.y) - quad.corner.y,
                       static_cast<double>(ray.origin.z) - quad.corner.z};
    const Components d{ray.direction.x, ray.direction.y, ray.direction.z};
    const Components u{quad.u.x, quad.u.y, quad.u.z};
    const Components v{quad.v.x, quad.v.y, quad.v.z};
    const detail::Products<double> f = detail::productsOf(s, d, u, v);
    const double e = detail::larger(detail::largestSize(u), detail::largestSize(v));
    const double far = detail::sumOfSizes(s) + 4 * e;
    const double bound = 0x1p-48 * far * (detail::sumOfSizes(d) * e);
    const auto [least, most] = std::minmax({f.u, f.v, f.det - f.u, f.det - f.v});
    if (least < -bound && most > bound)
        return std::nullopt;
    const bool settled = (least > bound || most < -bound) && bound < 0x1p-33 * std::abs(f.det) &&
                         0x1.01p-47 * far * (e * e) < 0x1.fp-35 * std::abs(f.t);
    if (!settled) [[unlikely]]
        return intersectParallelogramExactly(ray, quad);
    const double inverse = 1 / f.det;
    const double t = f.t * inverse;
    if (t < 0)
        return std::nullopt;
    return ParallelogramHit{.t = t, .ab = glm::vec2(f.u * inverse, f.v * inverse), .front = f.det > 0};
}

std::optional<ParallelogramHit> intersectParallelogramNaive(const Ray& ray, const Parallelogram& quad) {
    const glm::vec3 across = glm::cross(quad.u, quad.v);
    const glm::vec3 normal = glm::normalize(across);
    const float facing = glm::dot(normal, ray.direction);
    if (std::abs(facing) < 1e-8f)
        return std::nullopt;
    const float t = (glm::dot(normal, quad.corner) - glm::dot(normal, ray.origin)) / facing;
    if (!(t >= 0))
        return std::nullopt;
    const glm::vec3 w = across / glm::dot(across, across);
    const glm::vec3 planar = ray.origin + t * ray.direction - quad.corner;
    const glm::vec2 ab(glm::dot(w, glm::cross(planar, quad.v)), glm::dot(w, glm::cross(quad.u, planar)));
    if (!(ab.x >= 0 && ab.x <= 1 && ab.y >= 0 && ab.y <= 1))
        return std::nullopt;
    return ParallelogramHit{.t = t, .ab = ab, .front = facing < 0};
}

}  // namespace quincunx

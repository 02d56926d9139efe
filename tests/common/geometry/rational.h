#pragma once

#include <optional>
#include <vector>

#include "geometry/ray_triangle.h"
#include "tests/support/oracle.h"

/// Answers in rational arithmetic, written as in a book.
namespace quincunx::oracle {

inline int sign(const Rational& x) {
    return x < 0 ? -1 : x > 0 ? 1 : 0;
}

template <typename V>
int orientation2(const V& a, const V& b, const V& c) {
    const Rational ax(static_cast<double>(a.x)), ay(static_cast<double>(a.y));
    const Rational bx(static_cast<double>(b.x)), by(static_cast<double>(b.y));
    const Rational cx(static_cast<double>(c.x)), cy(static_cast<double>(c.y));
    return sign(Rational((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)));
}

inline Rational tripleProduct(const RationalVector& a, const RationalVector& b, const RationalVector& c) {
    return dot(a, cross(b, c));
}

struct ExactHit {
    Rational t;
    Rational weights[3];
    RationalVector point;
    bool front;
};

/// Where the line of the ray meets the triangle, at any t.
inline std::optional<ExactHit> lineHit(const Ray& ray, const Triangle& triangle) {
    const RationalVector o(ray.origin);
    const RationalVector d(ray.direction);
    const RationalVector a(triangle.a);
    const RationalVector b(triangle.b);
    const RationalVector c(triangle.c);
    const RationalVector normal = cross(b - a, c - a);
    const Rational slope = dot(normal, d);
    if (slope == 0)
        return std::nullopt;
    const Rational t = dot(normal, a - o) / slope;
    const RationalVector point = o + t * d;
    // Barycentric coordinates by areas: each part's normal along the whole's.
    const Rational area = dot(normal, normal);
    const Rational u = dot(normal, cross(c - b, point - b)) / area;
    const Rational v = dot(normal, cross(a - c, point - c)) / area;
    const Rational w = dot(normal, cross(b - a, point - a)) / area;
    if (u < 0 || v < 0 || w < 0)
        return std::nullopt;
    return ExactHit{t, {u, v, w}, point, slope < 0};
}

inline std::optional<ExactHit> rayHit(const Ray& ray, const Triangle& triangle, RayInterval interval = {}) {
    auto hit = lineHit(ray, triangle);
    if (!hit)
        return std::nullopt;
    const auto below = [](const Rational& t, float limit) {
        return std::isinf(limit) ? limit > 0 : t < Rational(static_cast<double>(limit));
    };
    const auto above = [](const Rational& t, float limit) {
        return std::isinf(limit) ? limit < 0 : t > Rational(static_cast<double>(limit));
    };
    if (below(hit->t, interval.tMin) || above(hit->t, interval.tMax))
        return std::nullopt;
    return hit;
}

}  // namespace quincunx::oracle

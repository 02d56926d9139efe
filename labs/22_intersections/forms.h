#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/glm.hpp>

/// The textbook's formulas in any precision, and the same arranged so that less cancels: what stands between
/// the naive forms and those with a bound, for the picture and the sweeps of this lab. The first t ≥ 0, in
/// lengths of the direction; cylinders stand on the z axis.
namespace quincunx::forms {

template <typename T>
using Vector = glm::vec<3, T>;

/// The roots of a t² + b t + c by the quadratic formula, in order.
template <typename T>
std::optional<glm::vec<2, T>> rootsOf(T a, T b, T c) {
    const T discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0) || a == 0)
        return std::nullopt;
    const T root = std::sqrt(discriminant);
    return glm::vec<2, T>((-b - root) / (2 * a), (-b + root) / (2 * a));
}

template <typename T>
std::optional<T> firstOf(const std::optional<glm::vec<2, T>>& roots) {
    if (!roots || !(roots->y >= 0))
        return std::nullopt;
    return roots->x >= 0 ? roots->x : roots->y;
}

/// |f + t d|² = r² for f from the centre to the origin.
template <typename T>
std::optional<glm::vec<2, T>> sphere(const Vector<T>& f, const Vector<T>& d, T r) {
    return rootsOf<T>(glm::dot(d, d), 2 * glm::dot(f, d), glm::dot(f, f) - r * r);
}

/// The same by the distance of the centre from the ray (Ray Tracing Gems, 2019, ch. 7).
template <typename T>
std::optional<glm::vec<2, T>> sphereByDistance(const Vector<T>& f, const Vector<T>& d, T r) {
    const T a = glm::dot(d, d);
    const T middle = -glm::dot(f, d) / a;
    const Vector<T> l = f + middle * d;
    const T gap = r * r - glm::dot(l, l);
    if (!(gap >= 0))
        return std::nullopt;
    const T half = std::sqrt(gap / a);
    return glm::vec<2, T>(middle - half, middle + half);
}

template <typename T>
std::optional<glm::vec<2, T>> cylinder(const Vector<T>& o, const Vector<T>& d, T r) {
    return rootsOf<T>(d.x * d.x + d.y * d.y, 2 * (o.x * d.x + o.y * d.y), o.x * o.x + o.y * o.y - r * r);
}

template <typename T>
std::optional<glm::vec<2, T>> cylinderByDistance(const Vector<T>& o, const Vector<T>& d, T r) {
    const T a = d.x * d.x + d.y * d.y;
    if (a == 0)
        return std::nullopt;
    const T across = o.x * d.y - o.y * d.x;
    const T gap = r * r - across * across / a;
    if (!(gap >= 0))
        return std::nullopt;
    const T middle = -(o.x * d.x + o.y * d.y) / a;
    const T half = std::sqrt(gap / a);
    return glm::vec<2, T>(middle - half, middle + half);
}

/// The sides' roots between the caps, and the caps' points within the radius.
template <typename T>
std::optional<T> can(const Vector<T>& o, const Vector<T>& d, T r, T height,
                     const std::optional<glm::vec<2, T>>& sides) {
    std::optional<T> nearest;
    const auto offer = [&](T t) {
        if (t >= 0 && !(nearest && *nearest <= t))
            nearest = t;
    };
    if (sides)
        for (const T t : {sides->x, sides->y}) {
            const T z = o.z + t * d.z;
            if (z >= 0 && z <= height)
                offer(t);
        }
    if (d.z != 0)
        for (const T z : {T(0), height}) {
            const T t = (z - o.z) / d.z;
            const T x = o.x + t * d.x;
            const T y = o.y + t * d.y;
            if (x * x + y * y <= r * r)
                offer(t);
        }
    return nearest;
}

/// Slabs with what the flashcard leaves out: parallel rays, flat boxes, t ≥ 0.
template <typename T>
std::optional<T> box(const Vector<T>& o, const Vector<T>& d, const Vector<T>& low, const Vector<T>& high) {
    T enter = -std::numeric_limits<T>::infinity();
    T exit = std::numeric_limits<T>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
            if (o[axis] < low[axis] || o[axis] > high[axis])
                return std::nullopt;
            continue;
        }
        const T first = (low[axis] - o[axis]) / d[axis];
        const T second = (high[axis] - o[axis]) / d[axis];
        enter = std::max(enter, std::min(first, second));
        exit = std::min(exit, std::max(first, second));
    }
    if (!(enter <= exit && exit >= 0))
        return std::nullopt;
    return enter >= 0 ? enter : exit;
}

template <typename T>
std::optional<T> plane(const Vector<T>& o, const Vector<T>& d, const Vector<T>& n, T offset) {
    const T approach = glm::dot(n, d);
    if (approach == 0)
        return std::nullopt;
    const T t = -(glm::dot(n, o) + offset) / approach;
    return t >= 0 ? std::optional(t) : std::nullopt;
}

/// Möller, Trumbore, JGT 2(1), 1997.
template <typename T>
std::optional<T> triangle(const Vector<T>& o, const Vector<T>& d, const Vector<T>& a, const Vector<T>& b,
                          const Vector<T>& c) {
    const Vector<T> e1 = b - a;
    const Vector<T> e2 = c - a;
    const Vector<T> p = glm::cross(d, e2);
    const T det = glm::dot(e1, p);
    if (det == 0)
        return std::nullopt;
    const Vector<T> s = o - a;
    const Vector<T> q = glm::cross(s, e1);
    const T u = glm::dot(s, p) / det;
    const T v = glm::dot(d, q) / det;
    const T t = glm::dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 ? std::optional(t) : std::nullopt;
}

}  // namespace quincunx::forms

#include "geometry/polygon.h"

#include <cmath>
#include <cstddef>

#include "base/check.h"

namespace quincunx {

namespace {

/// Twice the signed area of a triangle in the plane.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners in the coordinate plane that shows the polygon largest, counter-clockwise; empty if it has no
/// area.
std::vector<glm::dvec2> flattened(std::span<const glm::vec3> corners) {
    const std::size_t n = corners.size();
    const glm::dvec3 origin(corners[0]);
    glm::dvec3 normal(0);
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec3 a = glm::dvec3(corners[i]) - origin;
        const glm::dvec3 b = glm::dvec3(corners[(i + 1) % n]) - origin;
        normal += glm::cross(a, b);
    }
    const glm::dvec3 size = glm::abs(normal);
    std::vector<glm::dvec2> points;
    if (!(size.x > 0) && !(size.y > 0) && !(size.z > 0))
        return points;
    int u = 0;
    int v = 1;
    int w = 2;
    if (size.x >= size.y && size.x >= size.z)
        u = 1, v = 2, w = 0;
    else if (size.y >= size.z)
        u = 2, v = 0, w = 1;
    points.reserve(n);
    for (const glm::vec3& corner : corners) {
        const glm::dvec3 p = glm::dvec3(corner) - origin;
        points.emplace_back(p[u], normal[w] > 0 ? p[v] : -p[v]);
    }
    return points;
}

bool insideOrOn(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
}

class Triangles {
  public:
    explicit Triangles(std::span<std::uint32_t> out) : out_(out) {}
    void add(std::size_t a, std::size_t b, std::size_t c) {
        out_[used_++] = static_cast<std::uint32_t>(a);
        out_[used_++] = static_cast<std::uint32_t>(b);
        out_[used_++] = static_cast<std::uint32_t>(c);
    }

  private:
    std::span<std::uint32_t> out_;
    std::size_t used_ = 0;
};

bool clipEars(const std::vector<glm::dvec2>& points, Triangles& triangles) {
    const std::size_t n = points.size();
    std::vector<std::size_t> next(n);
    std::vector<std::size_t> previous(n);
    for (std::size_t i = 0; i < n; ++i) {
        next[i] = (i + 1) % n;
        previous[next[i]] = i;
    }
    std::size_t left = n;
    std::size_t stalled = 0;
    std::size_t budget = 64 * n;
    std::size_t i = 0;
    const auto isEar = [&](std::size_t tip) {
        const glm::dvec2& a = points[previous[tip]];
        const glm::dvec2& b = points[tip];
        const glm::dvec2& c = points[next[tip]];
        if (!(area(a, b, c) > 0))
            return false;
        for (std::size_t k = next[next[tip]]; k != previous[tip]; k = next[k]) {
            if (budget-- == 0) {
                budget = 0;
                return false;
            }
            const glm::dvec2& p = points[k];
            if (p != a && p != b && p != c && insideOrOn(p, a, b, c))
                return false;
        }
        return true;
    };
    while (left > 3 && stalled < left && budget > 0) {
        if (isEar(i)) {
            triangles.add(previous[i], i, next[i]);
            next[previous[i]] = next[i];
            previous[next[i]] = previous[i];
            --left;
            stalled = 0;
            i = next[next[i]];
        } else {
            i = next[i];
            ++stalled;
        }
    }
    const bool clean = left == 3;
    for (std::size_t k = next[i]; left >= 3; --left) {
        triangles.add(i, k, next[k]);
        k = next[k];
    }
    return clean;
}

}  // namespace

bool triangulatePolygon(std::span<const glm::vec3> corners, std::span<std::uint32_t> out) {
    const std::size_t n = corners.size();
    QX_CHECK_GE(n, 3u);
    QX_CHECK_EQ(out.size(), 3 * (n - 2));
    Triangles triangles(out);
    if (n == 3) {
        triangles.add(0, 1, 2);
        return true;
    }
    const std::vector<glm::dvec2> points = flattened(corners);
    bool convex = true;
    for (std::size_t i = 0; i < points.size() && convex; ++i)
        convex = area(points[i], points[(i + 1) % n], points[(i + 2) % n]) >= 0;
    if (n == 4 && convex && !points.empty()) {
        const glm::dvec3 across02 = glm::dvec3(corners[2]) - glm::dvec3(corners[0]);
        const glm::dvec3 across13 = glm::dvec3(corners[3]) - glm::dvec3(corners[1]);
        if (glm::dot(across02, across02) <= glm::dot(across13, across13)) {
            triangles.add(0, 1, 2);
            triangles.add(0, 2, 3);
        } else {
            triangles.add(0, 1, 3);
            triangles.add(1, 2, 3);
        }
        return true;
    }
    if (!points.empty() && !convex)
        return clipEars(points, triangles);
    for (std::size_t i = 1; i + 1 < n; ++i)
        triangles.add(0, i, i + 1);
    return !points.empty();
}

}  // namespace quincunx

#include "geometry/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double u = 0x1p-53;  // the unit roundoff of double

Side sideOfRange(double lowest, double highest) {
    return lowest > 0 ? Side::inFront : highest < 0 ? Side::behind : Side::crossing;
}

struct TwoCorners {
    glm::vec3 along;
    glm::vec3 against;
};

TwoCorners cornersAlong(const Bounds& box, glm::vec3 normal) {
    TwoCorners corners;
    for (int axis = 0; axis < 3; ++axis) {
        const bool forward = normal[axis] > 0;
        corners.along[axis] = forward ? box.max[axis] : box.min[axis];
        corners.against[axis] = forward ? box.min[axis] : box.max[axis];
    }
    return corners;
}

float valueNaive(const Plane& plane, glm::vec3 point) {
    return glm::dot(plane.normal, point) + plane.offset;
}

bool isFinite(const Ball& ball) {
    return quincunx::isFinite(ball.centre) && std::isfinite(ball.radius);
}

bool ballsOverlapExactly(const Ball& a, const Ball& b) {
    if (!isFinite(a) || !isFinite(b))
        return false;
    Expansion squared;
    for (int axis = 0; axis < 3; ++axis)
        squared = squared + Expansion::difference(a.centre[axis], b.centre[axis]).squared();
    return (squared - (Expansion(a.radius) + Expansion(b.radius)).squared()).sign() <= 0;
}

bool ballMeetsPlaneExactly(const Ball& ball, const Plane& plane) {
    if (!isFinite(ball) || !quincunx::isFinite(plane.normal) || !std::isfinite(plane.offset))
        return true;
    Expansion value = plane.offset;
    Expansion squaredNormal;
    for (int axis = 0; axis < 3; ++axis) {
        value = value + Expansion::product(plane.normal[axis], ball.centre[axis]);
        squaredNormal = squaredNormal + Expansion::product(plane.normal[axis], plane.normal[axis]);
    }
    return (value.squared() - Expansion::product(ball.radius, ball.radius) * squaredNormal).sign() <= 0;
}

}  // namespace

double detail::sumExactly(const std::array<double, 4>& terms) {
    Expansion sum;
    for (const double term : terms) {
        if (!std::isfinite(term))
            return std::numeric_limits<double>::quiet_NaN();
        sum = sum + Expansion(term);
    }
    return sum.approximate();
}

bool ballsOverlap(const Ball& a, const Ball& b) {
    const glm::dvec3 d = glm::dvec3(a.centre) - glm::dvec3(b.centre);
    const double reach = static_cast<double>(a.radius) + b.radius;
    const double apart = d.x * d.x + d.y * d.y + d.z * d.z;
    const double touching = reach * reach;
    // The left is off by 5u of itself (difference twice, square, two sums), the right by 3u.
    if (std::abs(apart - touching) > 8 * u * (apart + touching)) [[likely]]
        return apart < touching;
    return ballsOverlapExactly(a, b);
}

bool ballsOverlapNaive(const Ball& a, const Ball& b) {
    return glm::length(a.centre - b.centre) <= a.radius + b.radius;
}

Side sideOf(const Ball& ball, const Plane& plane) {
    const double value = planeValue(plane, ball.centre);
    const glm::dvec3 n(plane.normal);
    const double left = value * value;
    const double right = static_cast<double>(ball.radius) * ball.radius * (n.x * n.x + n.y * n.y + n.z * n.z);
    // The value is off by 2^-32 of itself at most, its square by twice that; the right by 4u.
    if (std::abs(left - right) > 0x1p-30 * left && left + right > 0) [[likely]]
        return left < right ? Side::crossing : value < 0 ? Side::behind : Side::inFront;
    if (ballMeetsPlaneExactly(ball, plane))
        return Side::crossing;
    return value < 0 ? Side::behind : Side::inFront;
}

bool ballMeetsPlaneNaive(const Ball& ball, const Plane& plane) {
    return valueNaive(plane, ball.centre) <= ball.radius;
}

Side sideOf(const Bounds& box, const Plane& plane) {
    QX_CHECK(!box.empty());
    const auto [along, against] = cornersAlong(box, plane.normal);
    return sideOfRange(planeValue(plane, against), planeValue(plane, along));
}

bool boxMeetsPlaneNaive(const Bounds& box, const Plane& plane) {
    const glm::vec3& n = plane.normal;
    const glm::vec3 v0(n.x > 0 ? box.max.x : box.min.x, n.y > 0 ? box.max.y : box.min.y,
                       n.z > 0 ? box.max.z : box.min.z);
    const glm::vec3 v1(n.x < 0 ? box.max.x : box.min.x, n.y < 0 ? box.max.y : box.min.y,
                       n.z < 0 ? box.max.z : box.min.z);
    return glm::sign(valueNaive(plane, v0)) != glm::sign(valueNaive(plane, v1));
}

Side sideByEightCorners(const Bounds& box, const Plane& plane) {
    return sideOf(cornersOf(box), plane);
}

Side sideOf(std::span<const glm::vec3> points, const Plane& plane) {
    bool front = false;
    bool back = false;
    for (const glm::vec3& point : points) {
        const double value = planeValue(plane, point);
        front = front || value >= 0;
        back = back || value <= 0;
    }
    return front == back ? Side::crossing : front ? Side::inFront : Side::behind;
}

bool pointsMeetPlaneNaive(std::span<const glm::vec3> points, const Plane& plane) {
    bool front = false;
    bool back = false;
    for (const glm::vec3& point : points) {
        const float value = valueNaive(plane, point);
        front = front || value >= 0;
        back = back || value <= 0;
    }
    return front && back;
}

std::array<glm::vec3, 8> cornersOf(const Bounds& box) {
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        corners[i] = {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                      (i & 4) != 0 ? box.max.z : box.min.z};
    return corners;
}

bool boxesOverlap(const Bounds& a, const Bounds& b) {
    if (a.empty() || b.empty())
        return false;
    for (int axis = 0; axis < 3; ++axis)
        if (a.min[axis] > b.max[axis] || b.min[axis] > a.max[axis])
            return false;
    return true;
}

bool overlaps(const Ball& ball, const Bounds& box) {
    if (box.empty())
        return false;
    // The nearest point of the box is exact, so this is two balls, the second of radius 0.
    return ballsOverlap(ball, {glm::clamp(ball.centre, box.min, box.max), 0});
}

Frustum frustumOf(const glm::dmat4& clipFromWorld) {
    const glm::dmat4 rows = glm::transpose(clipFromWorld);
    return {{rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1], rows[3] + rows[2],
             rows[3] - rows[2]}};
}

bool mayBeVisible(const Bounds& box, const Frustum& frustum) {
    if (box.empty())
        return false;
    for (const glm::dvec4& plane : frustum.planes) {
        double value = plane.w;
        double magnitude = std::abs(plane.w);
        for (int axis = 0; axis < 3; ++axis) {
            const double term = plane[axis] * (plane[axis] > 0 ? box.max[axis] : box.min[axis]);
            value += term;
            magnitude += std::abs(term);
        }
        if (value < -8 * u * magnitude)
            return false;
    }
    return true;
}

bool mayBeVisible(const Ball& ball, const Frustum& frustum) {
    for (const glm::dvec4& plane : frustum.planes) {
        double value = plane.w;
        double magnitude = std::abs(plane.w);
        for (int axis = 0; axis < 3; ++axis) {
            const double term = plane[axis] * ball.centre[axis];
            value += term;
            magnitude += std::abs(term);
        }
        const double reach =
            ball.radius * std::sqrt(plane.x * plane.x + plane.y * plane.y + plane.z * plane.z);
        if (value < -reach - 12 * u * (magnitude + reach))
            return false;
    }
    return true;
}

}  // namespace quincunx

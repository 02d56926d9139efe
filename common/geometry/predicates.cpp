#include "geometry/predicates.h"

#include <array>
#include <cstddef>

#include "math/exact.h"
#include "math/exact_sum.h"

namespace quincunx {
namespace {

/// det [a − w d, b − d, c − d] for w = 0 or 1, from the four in homogeneous coordinates, whose determinant is
/// that of floats. Where the differences are floats, too, as on grids, three rows do at a quarter of the
/// time.
double determinantFrom(glm::vec3 d, glm::vec3 a, float w, glm::vec3 b, glm::vec3 c) {
    const std::array<glm::vec3, 3> columns = {a, b, c};
    const std::array<float, 3> weights = {w, 1, 1};
    glm::mat3 translated;
    bool exact = true;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            const auto index = static_cast<std::size_t>(column);
            const double from = static_cast<double>(weights[index]) * d[row];
            const double to = columns[index][row];
            const double difference = to - from;
            const double back = difference - to;
            const double lost = (to - (difference - back)) - (from + back);  // Knuth
            translated[column][row] = static_cast<float>(difference);
            exact &= lost == 0 && static_cast<double>(translated[column][row]) == difference;
        }
    }
    if (exact)
        return determinant(translated);
    return determinant(glm::mat4(glm::vec4(a, w), glm::vec4(b, 1), glm::vec4(c, 1), glm::vec4(d, 1)));
}

using detail::Estimate;

/// a · (b × c) for vectors whose components are off by at most u = 2^-53, relative, in two of the three:
/// eight roundings a summand (Shewchuk 1997, section 4.3: 7 u + 56 u² for three).
Estimate tripleProduct(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const double yz = b.y * c.z;
    const double zy = b.z * c.y;
    const double zx = b.z * c.x;
    const double xz = b.x * c.z;
    const double xy = b.x * c.y;
    const double yx = b.y * c.x;
    const double permanent = std::abs(a.x) * (std::abs(yz) + std::abs(zy)) +
                             std::abs(a.y) * (std::abs(zx) + std::abs(xz)) +
                             std::abs(a.z) * (std::abs(xy) + std::abs(yx));
    return {a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx), 0x1.001p-50 * permanent};
}

Estimate estimateOrientation(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const glm::dvec3 origin(d);
    return tripleProduct(glm::dvec3(c) - origin, glm::dvec3(b) - origin, glm::dvec3(a) - origin);
}

Estimate estimateSide(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    const glm::dvec3 o(origin);
    return tripleProduct(glm::dvec3(direction), glm::dvec3(a) - o, glm::dvec3(b) - o);
}

/// Adds det [a b c], or subtracts it.
void addDeterminant(ExactSum& sum, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, bool negative) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        if (negative) {
            sum.subtract({a[i], b[j], c[k]});
            sum.add({a[i], b[k], c[j]});
        } else {
            sum.add({a[i], b[j], c[k]});
            sum.subtract({a[i], b[k], c[j]});
        }
    }
}

}  // namespace

namespace detail {

int exactOrientation(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
    return signOf(determinant(glm::mat3(glm::vec3(a, 1), glm::vec3(b, 1), glm::vec3(c, 1))));
}

int exactOrientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    ExactSum sum;
    sum.add({a.x, b.y});
    sum.subtract({a.y, b.x});
    sum.add({b.x, c.y});
    sum.subtract({b.y, c.x});
    sum.add({c.x, a.y});
    sum.subtract({c.y, a.x});
    return sum.sign();
}

Estimate orientationEstimate(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    return estimateOrientation(a, b, c, d);
}

Estimate sideOfLineEstimate(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    return estimateSide(origin, direction, a, b);
}

double orientationValue(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    return determinantFrom(a, d, 1, b, c);
}

int exactOrientation(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    ExactSum sum;
    addDeterminant(sum, b, c, d, false);
    addDeterminant(sum, a, c, d, true);
    addDeterminant(sum, a, b, d, false);
    addDeterminant(sum, a, b, c, true);
    return sum.sign();
}

double sideOfLineValue(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    return determinantFrom(origin, direction, 0, a, b);
}

}  // namespace detail

int orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const double ax = a.x - c.x;
    const double ay = a.y - c.y;
    const double bx = b.x - c.x;
    const double by = b.y - c.y;
    const double left = ax * by;
    const double right = ay * bx;
    const double magnitude = std::abs(left) + std::abs(right);
    // Shewchuk's bound holds unless a product underflows; then, and on overflow, the sum is long.
    if (std::abs(left - right) > 0x1.8000000000008p-52 * magnitude && magnitude > 0x1p-960 &&
        magnitude < 0x1p1000) [[likely]]
        return detail::signOf(left - right);
    return detail::exactOrientation(a, b, c);
}

float orientationNaive(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double orientationNaive(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

int orientation(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const Estimate estimate = estimateOrientation(a, b, c, d);
    return detail::signOf(estimate.decided() ? estimate.value : detail::orientationValue(a, b, c, d));
}

int orientation(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    const glm::dvec3 outer = c - d;
    const Estimate estimate = tripleProduct(outer, b - d, a - d);
    // Products that underflow add up to 6 · 2^-1074 times a component of `outer`.
    const bool inRange = estimate.error > 0x1p-700 && std::abs(outer.x) < 0x1p300 &&
                         std::abs(outer.y) < 0x1p300 && std::abs(outer.z) < 0x1p300;
    return inRange && estimate.decided() ? detail::signOf(estimate.value)
                                         : detail::exactOrientation(a, b, c, d);
}

float orientationNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    return glm::dot(glm::cross(b - a, c - a), d - a);
}

double orientationNaive(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
    return glm::dot(glm::cross(b - a, c - a), d - a);
}

int sideOfLine(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    const Estimate estimate = estimateSide(origin, direction, a, b);
    return detail::signOf(estimate.decided() ? estimate.value
                                             : detail::sideOfLineValue(origin, direction, a, b));
}

float sideOfLineNaive(glm::vec3 origin, glm::vec3 direction, glm::vec3 a, glm::vec3 b) {
    const glm::vec3 moment = glm::cross(origin, direction);
    const glm::vec3 edgeMoment = glm::cross(a, b);
    return glm::dot(direction, edgeMoment) + glm::dot(moment, b - a);
}

Facing facingAlong(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 viewDirection) {
    const Estimate estimate = estimateSide(a, viewDirection, b, c);
    return static_cast<Facing>(-detail::signOf(
        estimate.decided() ? estimate.value : detail::sideOfLineValue(a, viewDirection, b, c)));
}

Facing facingNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 eye) {
    return static_cast<Facing>(detail::signOf(glm::dot(glm::cross(b - a, c - a), eye - a)));
}

Facing facingAlongNaive(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 viewDirection) {
    return static_cast<Facing>(-detail::signOf(glm::dot(glm::cross(b - a, c - a), viewDirection)));
}

}  // namespace quincunx

#include "trace/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"
#include "math/vector.h"

namespace quincunx {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double pi = std::numbers::pi;

/// Sine and cosine of |x| ≤ π/4 by their series, which are cut where the next term is 1.8e-9 of the sine and
/// 1.2e-10.
dvec2 cosineSineOfEighth(double x) {
    const double xx = x * x;
    const double cosine =
        1 + xx * (-1.0 / 2 + xx * (1.0 / 24 + xx * (-1.0 / 720 + xx * (1.0 / 40320 - xx * (1.0 / 3628800)))));
    const double sine =
        x * (1 + xx * (-1.0 / 6 + xx * (1.0 / 120 + xx * (-1.0 / 5040 + xx * (1.0 / 362880)))));
    return {cosine, sine};
}

/// The point of the unit circle at `turns` of it, 0 … 1.
dvec2 onCircle(double turns) {
    const auto quarter = static_cast<int>(4 * turns + 0.5);
    const dvec2 p = cosineSineOfEighth(2 * pi * (turns - 0.25 * quarter));
    switch (quarter & 3) {
        case 0:
            return p;
        case 1:
            return {-p.y, p.x};
        case 2:
            return -p;
        default:
            return {p.y, -p.x};
    }
}

/// A point of the disk and its distance from the centre.
struct DiskPoint {
    dvec2 point;
    double radius;
};

DiskPoint concentric(glm::vec2 uv) {
    const dvec2 square = 2.0 * dvec2(uv) - 1.0;
    if (std::abs(square.x) >= std::abs(square.y)) {
        if (square.x == 0)
            return {dvec2(0), 0};
        return {square.x * cosineSineOfEighth(pi / 4 * (square.y / square.x)), std::abs(square.x)};
    }
    const dvec2 p = cosineSineOfEighth(pi / 4 * (square.x / square.y));
    return {square.y * dvec2(p.y, p.x), std::abs(square.y)};
}

float roundedDensity(double density) {
    return static_cast<float>(std::min(density, static_cast<double>(std::numeric_limits<float>::max())));
}

/// A direction about +z whose cosine is 1 − `versine`.
dvec3 aboutZ(double versine, double turns) {
    const double sine = std::sqrt(std::max(0.0, versine * (2 - versine)));
    return {sine * onCircle(turns), 1 - versine};
}

/// Of a cone that holds a sphere.
double versineOfSphere(double distance, double radius) {
    const double sine = radius / distance;
    return sine * sine / (1 + std::sqrt((1 - sine) * (1 + sine)));
}

/// The corners of a triangle as unit vectors, and what its solid angle's half has as opposite and adjacent
/// side.
struct SphericalTriangle {
    dvec3 a{0};
    dvec3 b{0};
    dvec3 c{0};
    double opposite = 0;
    double adjacent = 1;

    double solidAngle() const { return opposite > 0 ? 2 * std::atan2(opposite, adjacent) : 0; }
};

SphericalTriangle sphericalTriangle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const dvec3 toA = dvec3(a) - dvec3(from);
    const dvec3 toB = dvec3(b) - dvec3(from);
    const dvec3 toC = dvec3(c) - dvec3(from);
    const double lengthA = std::sqrt(glm::dot(toA, toA));
    const double lengthB = std::sqrt(glm::dot(toB, toB));
    const double lengthC = std::sqrt(glm::dot(toC, toC));
    SphericalTriangle t;
    const double volume = lengthA * lengthB * lengthC;
    if (!(volume > 0 && volume < std::numeric_limits<double>::infinity()))
        return t;
    t.a = toA / lengthA;
    t.b = toB / lengthB;
    t.c = toC / lengthC;
    // Edges are differences of what is given, so that far, small triangles keep their shape.
    const dvec3 normal = glm::cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a));
    t.opposite = std::abs(glm::dot(toA, normal)) / volume;
    t.adjacent = 1 + glm::dot(t.a, t.b) + glm::dot(t.b, t.c) + glm::dot(t.c, t.a);
    return t;
}

/// The unit tangent at `at` towards another point of the sphere, (0,0,0) if there is none.
dvec3 tangentTowards(const dvec3& at, const dvec3& other) {
    const dvec3 difference = other - at;
    const dvec3 along = difference - glm::dot(difference, at) * at;
    const double squared = glm::dot(along, along);
    return squared > 0 ? along / std::sqrt(squared) : dvec3(0);
}

}  // namespace

glm::vec2 sampleDisk(glm::vec2 uv) {
    return glm::vec2(concentric(uv).point);
}

DirectionSample sampleCosineHemisphere(glm::vec2 uv) {
    const DiskPoint disk = concentric(uv);
    const double z = std::sqrt(std::max(0.0, (1 - disk.radius) * (1 + disk.radius)));
    return {glm::vec3(glm::dvec3(disk.point, z)), static_cast<float>(z / pi)};
}

DirectionSample sampleCosineHemisphereNaive(glm::vec2 uv) {
    const float radius = std::sqrt(uv.x);
    const float angle = 2 * std::numbers::pi_v<float> * uv.y;
    const float x = radius * std::cos(angle);
    const float y = radius * std::sin(angle);
    const float z = std::sqrt(1 - x * x - y * y);
    return {glm::vec3(x, y, z), z / std::numbers::pi_v<float>};
}

DirectionSample sampleSphere(glm::vec2 uv) {
    return {glm::vec3(aboutZ(2 * static_cast<double>(uv.x), uv.y)), static_cast<float>(1 / (4 * pi))};
}

DirectionSample sampleCone(float oneMinusCosine, glm::vec2 uv) {
    const double widest = oneMinusCosine;
    return {glm::vec3(aboutZ(widest * uv.x, uv.y)), widest > 0 ? roundedDensity(1 / (2 * pi * widest)) : 0};
}

DirectionSample sampleConeNaive(float oneMinusCosine, glm::vec2 uv) {
    const float cosMax = 1 - oneMinusCosine;
    const float cosine = (1 - uv.x) + uv.x * cosMax;
    const float sine = std::sqrt(1 - cosine * cosine);
    const float angle = 2 * std::numbers::pi_v<float> * uv.y;
    return {glm::vec3(sine * std::cos(angle), sine * std::sin(angle), cosine),
            1 / (2 * std::numbers::pi_v<float> * (1 - cosMax))};
}

TriangleSample sampleTriangle(float area, glm::vec2 uv) {
    const double root = std::sqrt(static_cast<double>(uv.x));
    const double v = uv.y;
    return {glm::vec3(1 - root, root * (1 - v), root * v), roundedDensity(1 / static_cast<double>(area))};
}

std::optional<float> coneOfSphere(float distance, float radius) {
    if (!(distance > radius))
        return std::nullopt;
    return static_cast<float>(versineOfSphere(distance, radius));
}

float coneOfSphereNaive(float distance, float radius) {
    const float sine = radius / distance;
    return 1 - std::sqrt(1 - sine * sine);
}

DirectionSample sampleSphereLight(glm::vec3 from, glm::vec3 center, float radius, glm::vec2 uv) {
    const dvec3 towards = dvec3(center) - dvec3(from);
    const double distance = std::sqrt(glm::dot(towards, towards));
    if (!(radius > 0))
        return {};
    if (!(distance > radius))
        return sampleSphere(uv);
    const double widest = versineOfSphere(distance, radius);
    const dvec3 local = aboutZ(widest * uv.x, uv.y);
    const glm::dmat3 worldFromCone = *basisAround(towards / distance);
    return {glm::vec3(worldFromCone * local), widest > 0 ? roundedDensity(1 / (2 * pi * widest)) : 0};
}

double solidAngle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    return sphericalTriangle(from, a, b, c).solidAngle();
}

float solidAngleNaive(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 unitA = glm::normalize(a - from);
    const glm::vec3 unitB = glm::normalize(b - from);
    const glm::vec3 unitC = glm::normalize(c - from);
    const glm::vec3 ab = glm::normalize(glm::cross(unitA, unitB));
    const glm::vec3 bc = glm::normalize(glm::cross(unitB, unitC));
    const glm::vec3 ca = glm::normalize(glm::cross(unitC, unitA));
    return std::acos(-glm::dot(ab, ca)) + std::acos(-glm::dot(bc, ab)) + std::acos(-glm::dot(ca, bc)) -
           std::numbers::pi_v<float>;
}

DirectionSample sampleSphericalTriangle(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec2 uv) {
    const SphericalTriangle t = sphericalTriangle(from, a, b, c);
    const double whole = t.solidAngle();
    if (!(whole > 0))
        return {};
    // The corner d on the edge from a to c for which (a, b, d) has the share u of the area. With h half the
    // angle from a to d: tan(area / 2) = tan h det(a, b, tangent) / (1 + a·b + tan h (b·tangent)).
    const dvec3 tangent = tangentTowards(t.a, t.c);
    const double half = 0.5 * uv.x * whole;
    const double sine = std::sin(half);
    const dvec3 sum = t.a + t.b;
    const double opposite = sine * (0.5 * glm::dot(sum, sum));
    const double adjacent = std::cos(half) * std::abs(glm::dot(t.a, glm::cross(t.b - t.a, tangent))) -
                            sine * glm::dot(t.b - t.a, tangent);
    const double scale = opposite * opposite + adjacent * adjacent;
    dvec3 d = t.a;
    if (scale > 0)
        d = (adjacent * adjacent - opposite * opposite) / scale * t.a +
            2 * opposite * adjacent / scale * tangent;
    // Heights above b's tangent plane are uniform along the arc from b to d.
    const dvec3 chord = d - t.b;
    const double versine = uv.y * (0.5 * glm::dot(chord, chord));
    const dvec3 direction =
        (1 - versine) * t.b + std::sqrt(std::max(0.0, versine * (2 - versine))) * tangentTowards(t.b, d);
    return {glm::vec3(direction), roundedDensity(1 / whole)};
}

DirectionSample sampleSphericalTriangleNaive(glm::vec3 from, glm::vec3 a, glm::vec3 b, glm::vec3 c,
                                             glm::vec2 uv) {
    const glm::vec3 unitA = glm::normalize(a - from);
    const glm::vec3 unitB = glm::normalize(b - from);
    const glm::vec3 unitC = glm::normalize(c - from);
    const glm::vec3 ab = glm::normalize(glm::cross(unitA, unitB));
    const glm::vec3 ca = glm::normalize(glm::cross(unitC, unitA));
    const float whole = solidAngleNaive(from, a, b, c);
    const float alpha = std::acos(-glm::dot(ab, ca));
    const float area = uv.x * whole;
    const float s = std::sin(area - alpha);
    const float t = std::cos(area - alpha);
    const float cosC = glm::dot(unitA, unitB);
    const float u = t - std::cos(alpha);
    const float v = s + std::sin(alpha) * cosC;
    const float q = ((v * t - u * s) * std::cos(alpha) - v) / ((v * s + u * t) * std::sin(alpha));
    const glm::vec3 d =
        q * unitA + std::sqrt(1 - q * q) * glm::normalize(unitC - glm::dot(unitC, unitA) * unitA);
    const float z = 1 - uv.y * (1 - glm::dot(d, unitB));
    return {z * unitB + std::sqrt(1 - z * z) * glm::normalize(d - glm::dot(d, unitB) * unitB), 1 / whole};
}

DiscreteDistribution::DiscreteDistribution(std::span<const float> weights) {
    constexpr double parts = 0x1p24;
    QX_CHECK(static_cast<double>(weights.size()) <= parts);
    double total = 0;
    double positive = 0;
    for (const float weight : weights) {
        QX_CHECK(weight >= 0 && std::isfinite(weight));
        total += weight;
        positive += weight > 0 ? 1 : 0;
    }
    QX_CHECK(total > 0);
    cumulative_.reserve(weights.size());
    probability_.reserve(weights.size());
    const double shared = parts - positive;
    double sum = 0;
    double seen = 0;
    double before = 0;
    for (const float weight : weights) {
        sum += weight;
        seen += weight > 0 ? 1 : 0;
        const double until = seen + std::round(shared * (sum / total));
        cumulative_.push_back(static_cast<float>(until / parts));
        probability_.push_back(static_cast<float>((until - before) / parts));
        before = until;
    }
}

DiscreteDistribution::Drawn DiscreteDistribution::sample(float u) const {
    const float inside = std::clamp(u, 0.0f, 1 - 0x1p-24f);
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), inside);
    const auto index = static_cast<std::size_t>(found - cumulative_.begin());
    const float probability = probability_[index];
    const float start = cumulative_[index] - probability;
    return {index, probability, std::min((inside - start) / probability, 1 - 0x1p-24f)};
}

float DiscreteDistribution::probability(std::size_t index) const {
    return probability_[index];
}

GridDistribution::GridDistribution(std::span<const float> weights, int width, int height)
    : width_(width), height_(height) {
    QX_CHECK(width > 0 && height > 0);
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    QX_CHECK(weights.size() == columns * rows);
    // Rows are weighed by their sums over a common power of two that keeps those in the range of float.
    std::vector<double> sums;
    double largest = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        double sum = 0;
        for (const float weight : weights.subspan(row * columns, columns))
            sum += weight;
        sums.push_back(sum);
        largest = std::max(largest, sum);
    }
    QX_CHECK(largest > 0);
    const int exponent = std::ilogb(largest);
    std::vector<float> rowWeights;
    const std::vector<float> even(columns, 1.0f);
    for (std::size_t row = 0; row < rows; ++row) {
        const auto scaled = static_cast<float>(std::scalbn(sums[row], -exponent));
        rowWeights.push_back(sums[row] > 0 ? std::max(scaled, std::numeric_limits<float>::min()) : 0);
        rows_.emplace_back(sums[row] > 0 ? weights.subspan(row * columns, columns) : std::span(even));
    }
    row_.emplace_back(rowWeights);
}

GridDistribution::Drawn GridDistribution::sample(glm::vec2 uv) const {
    const DiscreteDistribution::Drawn row = row_.front().sample(uv.y);
    const DiscreteDistribution::Drawn column = rows_[row.index].sample(uv.x);
    const double x = (static_cast<double>(column.index) + column.rest) / width_;
    const double y = (static_cast<double>(row.index) + row.rest) / height_;
    return {glm::vec2(std::min(static_cast<float>(x), 1 - 0x1p-24f),
                      std::min(static_cast<float>(y), 1 - 0x1p-24f)),
            row.probability * column.probability * static_cast<float>(width_) * static_cast<float>(height_)};
}

float GridDistribution::density(glm::vec2 point) const {
    if (!(point.x >= 0 && point.x < 1 && point.y >= 0 && point.y < 1))
        return 0;
    const auto column = std::min(static_cast<int>(static_cast<double>(point.x) * width_), width_ - 1);
    const auto row = std::min(static_cast<int>(static_cast<double>(point.y) * height_), height_ - 1);
    return row_.front().probability(static_cast<std::size_t>(row)) *
           rows_[static_cast<std::size_t>(row)].probability(static_cast<std::size_t>(column)) *
           static_cast<float>(width_) * static_cast<float>(height_);
}

float powerHeuristic(float own, float other) {
    // Squares of floats stay in the range of double.
    const double a = static_cast<double>(own) * own;
    const double b = static_cast<double>(other) * other;
    return own > 0 ? static_cast<float>(a / (a + b)) : 0;
}

float powerHeuristicNaive(float own, float other) {
    return own * own / (own * own + other * other);
}

std::optional<glm::vec3> playRoulette(glm::vec3 throughput, float u) {
    const float largest = std::max({throughput.x, throughput.y, throughput.z});
    if (!(largest > 0))
        return std::nullopt;
    if (largest >= 1)
        return throughput;
    const float q = std::ceil(largest * 0x1p24f) * 0x1p-24f;
    if (u >= q)
        return std::nullopt;
    return throughput / q;
}

std::optional<glm::vec3> playRouletteNaive(glm::vec3 throughput, float u) {
    if (u >= std::max({throughput.x, throughput.y, throughput.z}))
        return std::nullopt;
    return throughput;
}

}  // namespace quincunx

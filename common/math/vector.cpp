#include "math/vector.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/check.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double sumOfSquares(glm::dvec3 v) {
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

/// Σ v² within a relative u (1 + 4 u): the errors of squares and sums are carried along.
double carefulSumOfSquares(glm::dvec3 v) {
    const glm::dvec3 squares = v * v;
    const double xy = squares.x + squares.y;
    const double xyz = xy + squares.z;
    // Exact errors of the two sums (Knuth), whichever term is larger.
    const double yRounded = xy - squares.x;
    const double zRounded = xyz - xy;
    const double sumErrors = ((squares.x - (xy - yRounded)) + (squares.y - yRounded)) +
                             ((xy - (xyz - zRounded)) + (squares.z - zRounded));
    const double squareErrors =
        std::fma(v.x, v.x, -squares.x) + std::fma(v.y, v.y, -squares.y) + std::fma(v.z, v.z, -squares.z);
    return xyz + (sumErrors + squareErrors);
}

/// Sums of squares between these are right as they are: what vanished is below 2^-1022, and 2^-1022 / 2^-900
/// is far less than u.
constexpr double smallestSafeSquare = 0x1p-900;
constexpr double largestSafeSquare = 0x1p1000;

struct Scaled {
    glm::dvec3 vector;  ///< largest component in [1, 2)
    int exponent;
};

/// v is finite and not zero. Exact unless a component is 2^-1022 of the largest.
Scaled scaleToOne(glm::dvec3 v) {
    const int exponent = std::ilogb(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
    return {{std::scalbn(v.x, -exponent), std::scalbn(v.y, -exponent), std::scalbn(v.z, -exponent)},
            exponent};
}

}  // namespace

float dotNaive(glm::vec3 a, glm::vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

glm::vec3 crossNaive(glm::vec3 a, glm::vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double length(glm::dvec3 v) {
    const double squared = carefulSumOfSquares(v);
    if (squared >= smallestSafeSquare && squared <= largestSafeSquare)
        return std::sqrt(squared);
    if (!isFinite(v))
        return infinity;
    if (v == glm::dvec3(0))
        return 0;
    const Scaled scaled = scaleToOne(v);
    return std::scalbn(std::sqrt(carefulSumOfSquares(scaled.vector)), scaled.exponent);
}

float lengthNaive(glm::vec3 v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

std::optional<glm::dvec3> normalize(glm::dvec3 v) {
    const double squared = carefulSumOfSquares(v);
    if (squared >= smallestSafeSquare && squared <= largestSafeSquare)
        return v / std::sqrt(squared);
    if (!isFinite(v) || v == glm::dvec3(0))
        return std::nullopt;
    const glm::dvec3 scaled = scaleToOne(v).vector;
    return scaled / std::sqrt(carefulSumOfSquares(scaled));
}

std::optional<glm::vec3> normalizePrescaled(glm::vec3 v) {
    float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!isFinite(v) || largest == 0)
        return std::nullopt;
    // Subnormal components first: the power of two that scales them is itself out of range.
    if (largest < 0x1p-100f) {
        v *= 0x1p100f;
        largest *= 0x1p100f;
    }
    // 2^-e of the largest component, from its exponent bits (e + 127); half of it where that is subnormal.
    const std::uint32_t exponentBits = std::bit_cast<std::uint32_t>(largest) & 0x7f800000u;
    const auto power = std::bit_cast<float>(std::max(0x7f000000u - exponentBits, 0x00800000u));
    const glm::vec3 scaled = v * power;
    return scaled / std::sqrt(scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z);
}

glm::vec3 normalizeNaive(glm::vec3 v) {
    return v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

glm::dvec3 normalizeNaive(glm::dvec3 v) {
    return v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

std::optional<float> angleBetween(glm::vec3 a, glm::vec3 b) {
    if (!isFinite(a) || !isFinite(b) || a == glm::vec3(0) || b == glm::vec3(0))
        return std::nullopt;
    return static_cast<float>(std::atan2(std::sqrt(sumOfSquares(crossInDouble(a, b))), dotInDouble(a, b)));
}

float angleBetweenNaive(glm::vec3 unitA, glm::vec3 unitB) {
    return std::acos(dotNaive(unitA, unitB));
}

std::optional<glm::dmat3> basisAround(glm::dvec3 direction) {
    const std::optional<glm::dvec3> unit = normalize(direction);
    if (!unit)
        return std::nullopt;
    const glm::dvec3 n = *unit;
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    return glm::dmat3(glm::dvec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
                      glm::dvec3(b, sign + n.y * n.y * a, -n.y), n);
}

std::optional<glm::mat3> basisAround(glm::vec3 direction) {
    const std::optional<glm::dmat3> basis = basisAround(glm::dvec3(direction));
    return basis ? std::optional(glm::mat3(*basis)) : std::nullopt;
}

glm::mat3 basisAroundNaive(glm::vec3 unitDirection) {
    const glm::vec3 n = unitDirection;
    if (n.z == -1)
        return {glm::vec3(0, -1, 0), glm::vec3(-1, 0, 0), n};
    const float a = 1 / (1 + n.z);
    const float b = -n.x * n.y * a;
    return {glm::vec3(1 - n.x * n.x * a, b, -n.x), glm::vec3(b, 1 - n.y * n.y * a, -n.y), n};
}

glm::vec3 reflectNaive(glm::vec3 towardsSurface, glm::vec3 unitNormal) {
    return towardsSurface - 2 * dotNaive(unitNormal, towardsSurface) * unitNormal;
}

glm::vec3 mirrorDirectionNaive(glm::vec3 awayFromSurface, glm::vec3 unitNormal) {
    return -awayFromSurface + 2 * dotNaive(unitNormal, awayFromSurface) * unitNormal;
}

std::optional<glm::vec3> halfVector(glm::vec3 wi, glm::vec3 wo) {
    std::optional<glm::vec3> result;  // the one object of all returns, so that it is written in place
    const double squaredWi = sumOfSquares(wi);
    const double squaredWo = sumOfSquares(wo);
    if (!(squaredWi > 0 && squaredWo > 0 && squaredWi < infinity && squaredWo < infinity))
        return result;
    // (wi/|wi| + wo/|wo|) |wi| |wo|² / |wo|, by one root. Between 2^-447 and 2^386 a component.
    const double both = std::sqrt(squaredWi * squaredWo);
    glm::dvec3 half = squaredWo * glm::dvec3(wi) + both * glm::dvec3(wo);
    double squared = sumOfSquares(half);
    // |half| / |wo| both = 2 cos(θ/2): below 2^-4 too much has cancelled.
    if (squared < 0x1p-8 * (squaredWo * squaredWo) * squaredWi) [[unlikely]] {
        const glm::dvec3 unitWi = glm::dvec3(wi) * (1 / std::sqrt(squaredWi));
        const glm::dvec3 unitWo = glm::dvec3(wo) * (1 / std::sqrt(squaredWo));
        half = glm::cross(crossInDouble(wi, wo), unitWi - unitWo);
        squared = sumOfSquares(half);  // between 2^-596 and 2^518 if not zero
        if (!(squared > 0))
            return result;
    }
    const double reciprocal = 1 / std::sqrt(squared);
    result.emplace(static_cast<float>(half.x * reciprocal), static_cast<float>(half.y * reciprocal),
                   static_cast<float>(half.z * reciprocal));
    return result;
}

glm::vec3 halfVectorNaive(glm::vec3 unitWi, glm::vec3 unitWo) {
    return normalizeNaive(unitWi + unitWo);
}

float cosinePower(glm::vec3 a, glm::vec3 b, float exponent) {
    QX_CHECK(exponent >= 0 && std::isfinite(exponent));
    const double scaledCosine = dotInDouble(a, b);
    if (!(scaledCosine > 0 && scaledCosine < infinity))
        return 0;
    const double squares = sumOfSquares(a) * sumOfSquares(b);
    const double sineSquared = sumOfSquares(crossInDouble(a, b)) / squares;
    const double logCosine =
        sineSquared < 0.5 ? 0.5 * std::log1p(-sineSquared) : std::log(scaledCosine / std::sqrt(squares));
    return static_cast<float>(std::exp(exponent * logCosine));
}

float cosinePowerNaive(glm::vec3 unitA, glm::vec3 unitB, float exponent) {
    return std::pow(std::max(dotNaive(unitA, unitB), 0.0f), exponent);
}

}  // namespace quincunx

#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include <glm/glm.hpp>

/// Directions and lengths, in any one frame and unit.
///
/// Float data are computed in double and rounded once: the product of two floats is exact in double, and the
/// sum of their squares can neither overflow nor vanish there. With u = 2^-53, a relative error of k u before
/// the last rounding is at most k 2^-29 ulp of the float, so every "0.5 ulp" below reads "0.5 ulp + 2^-26".
/// ulps count as in math/ulp.h.
///
/// What that costs against the textbook's form in float (bench_vector, whole arrays): normalize what the
/// division by the length costs and 1.5 times a product with its reciprocal, cross 1.1, length and
/// reflect 1.8 times; where the last digit of a small difference is the point, dot 3, cosinePower 3.3,
/// angleBetween 6 and halfVector 8 times.
///
/// Each routine has its textbook form beside it, `...Naive`, for `stress` and the tests alone.
namespace quincunx {

inline bool isFinite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool isFinite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// a·b with a relative error of at most 2^-53 (1 + 2^-50), so that the sign is that of the exact value: the
/// three products are exact, and the errors of their sum are carried along (Ogita, Rump, Oishi, "Accurate sum
/// and dot product", SIAM J. Sci. Comput. 26, 2005, algorithm 4.4). Where the second sum cancels it is exact
/// (Sterbenz), so only the last rounding is left. Input that is not finite gives no finite number.
/// Held by Dot.*.
inline double dotInDouble(glm::vec3 a, glm::vec3 b) {
    const double x = static_cast<double>(a.x) * b.x;
    const double y = static_cast<double>(a.y) * b.y;
    const double z = static_cast<double>(a.z) * b.z;
    const double xy = x + y;
    const double yRounded = xy - x;
    const double xyError = (x - (xy - yRounded)) + (y - yRounded);
    const double xyz = xy + z;
    const double zRounded = xyz - xy;
    const double xyzError = (xy - (xyz - zRounded)) + (z - zRounded);
    return xyz + (xyError + xyzError);
}

/// a·b to 0.5 ulp, of the exact value's sign; infinite beyond the range of float. Held by Dot.*.
inline float dot(glm::vec3 a, glm::vec3 b) {
    return static_cast<float>(dotInDouble(a, b));
}

float dotNaive(glm::vec3 a, glm::vec3 b);

/// ab − cd to 0.5 ulp; infinite beyond the range of float. Held by Cross.*.
inline float differenceOfProducts(float a, float b, float c, float d) {
    return static_cast<float>(static_cast<double>(a) * b - static_cast<double>(c) * d);
}

/// ab − cd to 1.5 ulp unless a product leaves the range of double: Kahan's form with two fused multiply-adds
/// (Jeannerod, Louvet, Muller, "Further analysis of Kahan's algorithm for the accurate computation of 2×2
/// determinants", Math. Comp. 82, 2013). Held by Cross.*.
inline double differenceOfProducts(double a, double b, double c, double d) {
    const double cd = c * d;
    const double rest = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + rest;
}

/// a × b, each component to 0.5 ulp (float) or 1.5 ulp (double); infinite beyond the range. Held by Cross.*.
inline glm::vec3 cross(glm::vec3 a, glm::vec3 b) {
    return {differenceOfProducts(a.y, b.z, a.z, b.y), differenceOfProducts(a.z, b.x, a.x, b.z),
            differenceOfProducts(a.x, b.y, a.y, b.x)};
}
inline glm::dvec3 cross(glm::dvec3 a, glm::dvec3 b) {
    return {differenceOfProducts(a.y, b.z, a.z, b.y), differenceOfProducts(a.z, b.x, a.x, b.z),
            differenceOfProducts(a.x, b.y, a.y, b.x)};
}

glm::vec3 crossNaive(glm::vec3 a, glm::vec3 b);

/// a × b of float vectors with each component within a relative 2^-53; it never leaves the range.
inline glm::dvec3 crossInDouble(glm::vec3 a, glm::vec3 b) {
    const glm::dvec3 c(a);
    const glm::dvec3 d(b);
    return {c.y * d.z - c.z * d.y, c.z * d.x - c.x * d.z, c.x * d.y - c.y * d.x};
}

/// |v| to 0.5 ulp. Infinite where |v| exceeds the range of float, and where a component is not a number, so
/// that no comparison "shorter than" accepts it. Held by Length.*.
inline float length(glm::vec3 v) {
    const glm::dvec3 d(v);
    const double squared = d.x * d.x + d.y * d.y + d.z * d.z;
    return squared >= 0 ? static_cast<float>(std::sqrt(squared)) : std::numeric_limits<float>::infinity();
}

/// |v| to 1.5 ulp: squares summed with their errors (u), a root (u), by powers of two that keep the squares
/// in range (Blue, "A portable Fortran program to find the Euclidean norm of a vector", ACM TOMS 4, 1978).
/// Degenerate input as for float. Held by Length.*.
double length(glm::dvec3 v);

float lengthNaive(glm::vec3 v);

/// v / |v|, each component to 0.5 ulp, for every finite v but zero. None for zero and for components that are
/// infinite or not numbers. Held by Normalize.*.
inline std::optional<glm::vec3> normalize(glm::vec3 v) {
    const glm::dvec3 d(v);
    const double squared = d.x * d.x + d.y * d.y + d.z * d.z;
    if (!(squared > 0 && squared < std::numeric_limits<double>::infinity())) [[unlikely]]
        return std::nullopt;
    return glm::vec3(d * (1 / std::sqrt(squared)));
}

/// v / |v|, each component to 2.5 ulp, for every finite v but zero; none as for float. The square of the
/// length is off by u, so its root by 3/2 u and the quotient by 5/2 u. Powers of two keep the squares in
/// range (Blue 1978). Held by Normalize.*.
std::optional<glm::dvec3> normalize(glm::dvec3 v);

/// v / |v| in float arithmetic alone, each component to 2.5 ulp: what a shader can do. Scaled by the power of
/// two of the largest component (Blue 1978). None as for `normalize`. Held by Normalize.*.
std::optional<glm::vec3> normalizePrescaled(glm::vec3 v);

/// `normalize`, or `fallback` where there is no direction.
inline glm::vec3 normalizeOr(glm::vec3 v, glm::vec3 fallback) {
    return normalize(v).value_or(fallback);
}

glm::vec3 normalizeNaive(glm::vec3 v);
glm::dvec3 normalizeNaive(glm::dvec3 v);

/// The angle between two directions of any length, in [0, π] radians, to a relative error of 6.0e-8 (half an
/// ulp): atan2(|a × b|, a·b) from exact products. Zero for parallel vectors and for angles below 2^-150,
/// which float cannot hold. None if a vector is zero or not finite. Held by Angle.*.
std::optional<float> angleBetween(glm::vec3 a, glm::vec3 b);

float angleBetweenNaive(glm::vec3 unitA, glm::vec3 unitB);

/// A right-handed orthonormal basis whose third column is the direction, of any length: |BᵀB − I| ≤ 1.1e-7 in
/// every entry, det = +1. Two neighbouring directions get neighbouring bases except across z = 0 (Duff et
/// al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017; in double, rounded once: a column of
/// entries near 1/√3 is off by 2 √3 2^-25 in its square). None as for `normalize`. Held by Basis.*.
std::optional<glm::mat3> basisAround(glm::vec3 direction);
/// The same for double: |BᵀB − I| ≤ 1e-15.
std::optional<glm::dmat3> basisAround(glm::dvec3 direction);

/// Frisvad, "Building an orthonormal basis from a 3D unit vector without normalization", JGT 16(3), 2012.
glm::mat3 basisAroundNaive(glm::vec3 unitDirection);

/// The direction in which a ray goes on that comes in along `towardsSurface`: l − 2 (n·l)/(n·n) n. The normal
/// may have any length and either side; |result| = |towardsSurface|. Each component is within half an ulp of
/// itself plus 13 u |l|, so within half an ulp(1) |l|. To bounce on and on, `normalize` the result each time.
/// None if the normal is zero, if something is not finite, or if the result leaves the range of float.
/// Held by Reflect.*.
inline std::optional<glm::vec3> reflect(glm::vec3 towardsSurface, glm::vec3 normal) {
    const glm::dvec3 l(towardsSurface);
    const glm::dvec3 n(normal);
    const double squared = glm::dot(n, n);
    if (!(squared > 0 && squared < std::numeric_limits<double>::infinity())) [[unlikely]]
        return std::nullopt;
    const glm::vec3 reflected(l - 2 * (glm::dot(n, l) / squared) * n);
    return isFinite(reflected) ? std::optional(reflected) : std::nullopt;
}

glm::vec3 reflectNaive(glm::vec3 towardsSurface, glm::vec3 unitNormal);

/// The mirror direction of a vector that, as the result, points away from the surface (to a light, to the
/// eye): 2 (n·l)/(n·n) n − l. Error and exceptions as for `reflect`. Held by Reflect.*.
inline std::optional<glm::vec3> mirrorDirection(glm::vec3 awayFromSurface, glm::vec3 normal) {
    return reflect(-awayFromSurface, normal);
}

glm::vec3 mirrorDirectionNaive(glm::vec3 awayFromSurface, glm::vec3 unitNormal);

/// The unit vector halfway between two directions of any length that both point away from the surface:
/// wi/|wi| + wo/|wo|, normalized. |error| ≤ 6e-8 (rounding to float alone takes √3 2^-25 = 5.2e-8) however
/// close to opposite they are: there the half vector is (wi × wo) × (wi/|wi| − wo/|wo|), whose factors do not
/// cancel. None if they are exactly opposite (every perpendicular is as good as another: take
/// `basisAround(wi)`'s first column if one must be had), if one is zero, or not finite. Held by HalfVector.*.
std::optional<glm::vec3> halfVector(glm::vec3 wi, glm::vec3 wo);

glm::vec3 halfVectorNaive(glm::vec3 unitWi, glm::vec3 unitWo);

/// cosⁿ of the angle between two directions of any length, the highlight of Phong (mirror direction and eye)
/// and of Blinn–Phong (normal and half vector), to 0.5 + 4e-6 ulp for every exponent. Within 45° of the peak
/// the logarithm is that of 1 − sin², sin² = |a × b|²/(|a|²|b|²), so that the exponent does not magnify the
/// rounding of a cosine near 1: n ln cos is within 19 u of itself and above −104 where the result is not
/// zero, and 104 · 19 · 2^-29 < 4e-6. Zero where the angle is 90° or more, for every exponent (also 0: the
/// limit of 0ⁿ for n ↓ 0), and where a vector is zero or not finite. Exponent 0 gives 1 elsewhere. Exponents
/// below zero, infinite or not a number are a bug of the caller. Held by CosinePower.*.
float cosinePower(glm::vec3 a, glm::vec3 b, float exponent);

float cosinePowerNaive(glm::vec3 unitA, glm::vec3 unitB, float exponent);

}  // namespace quincunx

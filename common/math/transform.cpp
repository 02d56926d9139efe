#include "math/transform.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "math/exact.h"
#include "math/vector.h"

namespace quincunx {
namespace {

/// sign(det M) cof M, each entry within a relative u.
[[gnu::always_inline]] inline glm::dmat3 signedCofactors(const glm::mat4& m) {
    const glm::dvec3 x(m[0]);
    const glm::dvec3 y(m[1]);
    const glm::dvec3 z(m[2]);
    const glm::dvec3 first = glm::cross(y, z);
    const glm::dvec3 terms = x * first;
    const double sum = terms.x + terms.y + terms.z;
    // The sum is within 4 u of the terms' magnitudes: beyond 2^-48 of them its sign is right.
    const double magnitude = std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z);
    const double signedDeterminant = std::abs(sum) >= 0x1p-48 * magnitude ? sum : determinant(glm::mat3(m));
    const double sign = signedDeterminant < 0 ? -1 : 1;
    return {sign * first, sign * glm::cross(z, x), sign * glm::cross(x, y)};
}

/// 2^exponent, in the range of normal doubles.
double powerOfTwo(int exponent) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

/// The bits of |x|, which order as |x| does; infinities and what is not a number come last.
std::uint64_t magnitudeBits(double x) {
    return std::bit_cast<std::uint64_t>(x) & 0x7fffffffffffffffu;
}

/// ⌊log2⌋ of the largest |component| of a vector of normal doubles and zeros; 1024 if one is not finite,
/// −1023 if all are zero.
int exponentOfLargest(glm::dvec3 v) {
    const std::uint64_t most = std::max(std::max(magnitudeBits(v.x), magnitudeBits(v.y)), magnitudeBits(v.z));
    return static_cast<int>(most >> 52) - 1023;
}

/// m without its column and row.
glm::mat3 minorOf(const glm::mat4& m, int column, int row) {
    glm::mat3 minor;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            minor[c][r] = m[c < column ? c : c + 1][r < row ? r : r + 1];
    return minor;
}

/// Sums that are smaller than this share of their terms have cancelled too far for double: they are within
/// 5 u of the terms' magnitudes, so above it within 5 · 2^-33 of themselves.
constexpr double mostCancelled = 0x1p-20;

/// Σ of three terms, and Σ|term|.
struct Sum {
    double value;
    double magnitude;
    bool cancelled() const { return std::abs(value) < mostCancelled * magnitude; }
};

Sum sumOf(double a, double b, double c) {
    return {a + b + c, std::abs(a) + std::abs(b) + std::abs(c)};
}

/// Cofactors of a column, given another one of its half of the matrix, and the 2×2 minors of the other half:
/// rows 01, 02, 03, 12, 13, 23.
struct ColumnSums {
    Sum row[4];
};

[[gnu::always_inline]] inline ColumnSums columnSums(const double* v, const double* w) {
    return {{sumOf(v[1] * w[5], -v[2] * w[4], v[3] * w[3]), sumOf(-v[0] * w[5], v[2] * w[2], -v[3] * w[1]),
             sumOf(v[0] * w[4], -v[1] * w[2], v[3] * w[0]), sumOf(-v[0] * w[3], v[1] * w[1], -v[2] * w[0])}};
}

[[gnu::always_inline]] inline void minorsOfTwo(const double* a, const double* b, double* minors) {
    minors[0] = a[0] * b[1] - a[1] * b[0];
    minors[1] = a[0] * b[2] - a[2] * b[0];
    minors[2] = a[0] * b[3] - a[3] * b[0];
    minors[3] = a[1] * b[2] - a[2] * b[1];
    minors[4] = a[1] * b[3] - a[3] * b[1];
    minors[5] = a[2] * b[3] - a[3] * b[2];
}

bool isAffine(const glm::mat4& m) {
    return m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1;
}

/// `inverse` of any matrix.
std::optional<glm::mat4> inverseProjective(const glm::mat4& m) {
    std::optional<glm::mat4> result;
    double entries[4][4];
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            entries[column][row] = m[column][row];
    double first[6];
    double second[6];
    minorsOfTwo(entries[0], entries[1], first);
    minorsOfTwo(entries[2], entries[3], second);
    const ColumnSums columns[4] = {columnSums(entries[1], second), columnSums(entries[0], second),
                                   columnSums(entries[3], first), columnSums(entries[2], first)};
    const double terms[6] = {first[0] * second[5], -first[1] * second[4], first[2] * second[3],
                             first[3] * second[2], -first[4] * second[1], first[5] * second[0]};
    double det = 0;
    double magnitude = 0;
    for (const double term : terms) {
        det += term;
        magnitude += std::abs(term);
    }
    if (std::abs(det) <= mostCancelled * magnitude)
        det = determinant(m);
    // Not finite exactly if an entry is not: each is in a minor of its two columns, and that in a term.
    if (det == 0 || !std::isfinite(det))
        return result;
    const double reciprocal = 1 / det;
    float* entriesOut = &result.emplace()[0][0];
    float probe = 0;  // not a number if an entry is not finite
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            const Sum& sum = columns[column].row[row];
            double cofactor = column % 2 == 0 ? sum.value : -sum.value;
            if (sum.cancelled()) [[unlikely]] {
                const double minor = determinant(minorOf(m, column, row));
                cofactor = (column + row) % 2 == 0 ? minor : -minor;
            }
            const auto entry = static_cast<float>(cofactor * reciprocal);
            entriesOut[4 * row + column] = entry;
            probe += 0 * entry;
        }
    }
    if (probe != 0)
        result.reset();
    return result;
}

}  // namespace

glm::mat3 normalMatrix(const glm::mat4& worldFromModel) {
    // Products of floats stay in the range of double, so cofactors are finite exactly if the matrix is.
    const glm::dmat3 cofactors = signedCofactors(worldFromModel);
    constexpr int none = -1023;
    int highest = none;
    int lowest = 1025;
    for (int column = 0; column < 3; ++column) {
        const int exponent = exponentOfLargest(cofactors[column]);
        highest = std::max(highest, exponent);
        lowest = exponent == none ? lowest : std::min(lowest, exponent);
    }
    if (highest == none || highest == 1024)
        return glm::mat3(1);
    const int centre = lowest + (highest - lowest) / 2;
    // Within 2^±300, so exact and in the range of double.
    const double scale = powerOfTwo(std::min(-centre, 124 - highest));
    return glm::mat3(scale * cofactors);
}

glm::mat3 normalMatrixNaive(const glm::mat4& worldFromModel) {
    return glm::transpose(glm::inverse(glm::mat3(worldFromModel)));
}

std::optional<glm::vec3> transformNormal(const glm::mat4& worldFromModel, glm::vec3 normal) {
    // Not finite if something is not; else between 2^-447 and 2^386 a component, or zero.
    const glm::dvec3 world = signedCofactors(worldFromModel) * glm::dvec3(normal);
    const double squared = glm::dot(world, world);
    if (!(squared > 0 && squared < std::numeric_limits<double>::infinity()))
        return std::nullopt;
    return glm::vec3(world * (1 / std::sqrt(squared)));
}

std::optional<glm::mat4> inverseAffine(const glm::mat4& m) {
    std::optional<glm::mat4> result;  // the one object of all returns, so that it is written in place
    QX_CHECK(isAffine(m));
    const glm::dvec3 x(m[0]);
    const glm::dvec3 y(m[1]);
    const glm::dvec3 z(m[2]);
    const glm::dvec3 t(m[3]);
    const glm::dvec3 rows[3] = {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
    const Sum sum = sumOf(x.x * rows[0].x, x.y * rows[0].y, x.z * rows[0].z);
    const double volume = sum.cancelled() ? determinant(glm::mat3(m)) : sum.value;
    // Not finite exactly if one of the nine entries is not.
    if (volume == 0 || !std::isfinite(volume))
        return result;
    const double reciprocal = 1 / volume;
    double origin[3];
    for (int row = 0; row < 3; ++row) {
        const Sum shift = sumOf(rows[row].x * t.x, rows[row].y * t.y, rows[row].z * t.z);
        origin[row] = shift.value;
        if (shift.cancelled()) [[unlikely]] {
            // Cramer: the determinant of the matrix with t in the place of the column.
            glm::mat3 replaced(m);
            replaced[row] = glm::vec3(m[3]);
            origin[row] = determinant(replaced);
        }
    }
    float* entries = &result.emplace()[0][0];
    float probe = 0;  // not a number if an entry is not finite
    for (int row = 0; row < 3; ++row) {
        const glm::dvec3 cofactors = rows[row];
        const auto x0 = static_cast<float>(cofactors.x * reciprocal);
        const auto y0 = static_cast<float>(cofactors.y * reciprocal);
        const auto z0 = static_cast<float>(cofactors.z * reciprocal);
        const auto t0 = static_cast<float>(-origin[row] * reciprocal);
        entries[row] = x0;
        entries[4 + row] = y0;
        entries[8 + row] = z0;
        entries[12 + row] = t0;
        entries[4 * row + 3] = 0;
        probe += (0 * x0 + 0 * y0) + (0 * z0 + 0 * t0);
    }
    entries[15] = 1;
    if (probe != 0)
        result.reset();
    return result;
}

glm::mat4 inverseAffineNaive(const glm::mat4& m) {
    const glm::mat3 linear = glm::inverse(glm::mat3(m));
    glm::mat4 result{linear};
    result[3] = glm::vec4(-(linear * glm::vec3(m[3])), 1);
    return result;
}

glm::mat4 inverseRigid(const glm::mat4& m) {
    const glm::mat3 rotation(m);
    const glm::vec3 origin(m[3]);
    glm::mat4 result{glm::transpose(rotation)};
    result[3] = glm::vec4(-dot(rotation[0], origin), -dot(rotation[1], origin), -dot(rotation[2], origin), 1);
    return result;
}

glm::mat4 inverseRigidNaive(const glm::mat4& m) {
    const glm::mat3 transposed = glm::transpose(glm::mat3(m));
    glm::mat4 result{transposed};
    result[3] = glm::vec4(-(transposed * glm::vec3(m[3])), 1);
    return result;
}

std::optional<glm::mat4> inverse(const glm::mat4& m) {
    return isAffine(m) ? inverseAffine(m) : inverseProjective(m);
}

glm::mat4 inverseNaive(const glm::mat4& m) {
    return glm::inverse(m);
}

glm::mat4 lookAt(glm::vec3 eye, glm::vec3 target, glm::vec3 up) {
    QX_CHECK(quincunx::isFinite(eye) && quincunx::isFinite(target) && quincunx::isFinite(up));
    glm::dmat3 rotation(1);
    const glm::dvec3 view = glm::dvec3(target) - glm::dvec3(eye);
    const double viewSquared = glm::dot(view, view);
    if (viewSquared > 0) {
        const glm::dvec3 forward = view * (1 / std::sqrt(viewSquared));
        const glm::dvec3 upwards(up);
        glm::dvec3 side = glm::cross(view, upwards);
        double sideSquared = glm::dot(side, side);
        // sin² of the angle between view and up; below 2^-32 the products have cancelled to 2^-36 and less.
        if (sideSquared <= 0x1p-32 * viewSquared * glm::dot(upwards, upwards)) [[unlikely]] {
            const std::optional<glm::dvec3> careful = normalize(cross(view, upwards));
            side = careful ? *careful : basisAround(view).value()[0];
            sideSquared = glm::dot(side, side);
        }
        const glm::dvec3 right = side * (1 / std::sqrt(sideSquared));
        rotation = glm::dmat3(right, glm::cross(right, forward), -forward);
    }
    glm::mat4 worldFromCamera{glm::mat3(rotation)};
    worldFromCamera[3] = glm::vec4(eye, 1);
    return worldFromCamera;
}

glm::mat4 lookAtNaive(glm::vec3 eye, glm::vec3 target, glm::vec3 up) {
    const glm::vec3 forward = normalizeNaive(target - eye);
    const glm::vec3 right = normalizeNaive(crossNaive(forward, up));
    return glm::mat4(glm::vec4(right, 0), glm::vec4(crossNaive(right, forward), 0), glm::vec4(-forward, 0),
                     glm::vec4(eye, 1));
}

glm::mat4 cameraFromWorld(const glm::mat4& worldFromCamera) {
    return inverseRigid(worldFromCamera);
}

}  // namespace quincunx

#include "math/transform.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/check.h"
#include "math/exact.h"
#include "math/vector.h"

namespace quincunx {
namespace {

/// sign(det M) cof M, each entry within a relative u.
glm::dmat3 signedCofactors(const glm::mat3& m) {
    const glm::dvec3 first = crossInDouble(m[1], m[2]);
    const glm::dvec3 terms = glm::dvec3(m[0]) * first;
    const double sum = terms.x + terms.y + terms.z;
    // The sum is within 4 u of the terms' magnitudes: beyond 2^-48 of them its sign is right.
    const double magnitude = std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z);
    const double signedDeterminant = std::abs(sum) > 0x1p-48 * magnitude ? sum : determinant(m);
    const double sign = signedDeterminant < 0 ? -1 : 1;
    return {sign * first, sign * crossInDouble(m[2], m[0]), sign * crossInDouble(m[0], m[1])};
}

/// Whether all of the `Count` floats of a matrix are finite.
template <int Count>
bool allFinite(const float* entries) {
    constexpr std::uint32_t exponentBits = 0x7f800000u;
    std::uint32_t found = 0;
    for (int i = 0; i < Count; ++i)
        found |= (std::bit_cast<std::uint32_t>(entries[i]) & exponentBits) == exponentBits ? 1u : 0u;
    return found == 0;
}

bool isFinite(const glm::mat3& m) {
    return allFinite<9>(&m[0][0]);
}

bool isFinite(const glm::mat4& m) {
    return allFinite<16>(&m[0][0]);
}

/// ⌊log2 |x|⌋ of a normal double.
int exponentOf(double x) {
    return static_cast<int>((std::bit_cast<std::uint64_t>(x) >> 52) & 0x7ff) - 1023;
}

/// 2^exponent, in the range of normal doubles.
double powerOfTwo(int exponent) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

double largest(glm::dvec3 v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// m without its column and row.
glm::mat3 minorOf(const glm::mat4& m, int column, int row) {
    glm::mat3 minor;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            minor[c][r] = m[c < column ? c : c + 1][r < row ? r : r + 1];
    return minor;
}

/// Sums that are smaller than this share of their terms have cancelled too far for double.
constexpr double mostCancelled = 0x1p-8;

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

ColumnSums columnSums(const double* v, const double* w) {
    return {{sumOf(v[1] * w[5], -v[2] * w[4], v[3] * w[3]), sumOf(-v[0] * w[5], v[2] * w[2], -v[3] * w[1]),
             sumOf(v[0] * w[4], -v[1] * w[2], v[3] * w[0]), sumOf(-v[0] * w[3], v[1] * w[1], -v[2] * w[0])}};
}

void minorsOfTwo(const double* a, const double* b, double* minors) {
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

}  // namespace

glm::mat3 normalMatrix(const glm::mat4& worldFromModel) {
    const glm::mat3 linear(worldFromModel);
    if (!isFinite(linear))
        return glm::mat3(1);
    const glm::dmat3 cofactors = signedCofactors(linear);
    int highest = 0;
    int lowest = 0;
    bool any = false;
    for (int column = 0; column < 3; ++column) {
        const double most = largest(cofactors[column]);
        if (most == 0)
            continue;
        const int exponent = exponentOf(most);
        highest = any ? std::max(highest, exponent) : exponent;
        lowest = any ? std::min(lowest, exponent) : exponent;
        any = true;
    }
    if (!any)
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
    const glm::mat3 linear(worldFromModel);
    if (!isFinite(linear) || !quincunx::isFinite(normal))
        return std::nullopt;
    const std::optional<glm::dvec3> world = normalize(signedCofactors(linear) * glm::dvec3(normal));
    return world ? std::optional(glm::vec3(*world)) : std::nullopt;
}

std::optional<glm::mat4> inverseAffine(const glm::mat4& m) {
    QX_CHECK(isAffine(m));
    const glm::dvec3 x(m[0]);
    const glm::dvec3 y(m[1]);
    const glm::dvec3 z(m[2]);
    const glm::dvec3 t(m[3]);
    const glm::dvec3 rows[3] = {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
    const Sum sum = sumOf(x.x * rows[0].x, x.y * rows[0].y, x.z * rows[0].z);
    const double volume = sum.cancelled() ? determinant(glm::mat3(m)) : sum.value;
    if (volume == 0 || !isFinite(m))
        return std::nullopt;
    const double reciprocal = 1 / volume;
    glm::mat4 result(1);
    for (int row = 0; row < 3; ++row) {
        const glm::dvec3 cofactors = rows[row];
        result[0][row] = static_cast<float>(cofactors.x * reciprocal);
        result[1][row] = static_cast<float>(cofactors.y * reciprocal);
        result[2][row] = static_cast<float>(cofactors.z * reciprocal);
        const Sum origin = sumOf(cofactors.x * t.x, cofactors.y * t.y, cofactors.z * t.z);
        double value = origin.value;
        if (origin.cancelled()) [[unlikely]] {
            // Cramer: the determinant of the matrix with t in the place of the column.
            glm::mat3 replaced(m);
            replaced[row] = glm::vec3(m[3]);
            value = determinant(replaced);
        }
        result[3][row] = static_cast<float>(-value * reciprocal);
    }
    return isFinite(result) ? std::optional(result) : std::nullopt;
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
    if (isAffine(m))
        return inverseAffine(m);
    if (!isFinite(m))
        return std::nullopt;
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
    if (det == 0)
        return std::nullopt;
    const double reciprocal = 1 / det;
    glm::mat4 result;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            const Sum& sum = columns[column].row[row];
            double cofactor = column % 2 == 0 ? sum.value : -sum.value;
            if (sum.cancelled()) [[unlikely]] {
                const double minor = determinant(minorOf(m, column, row));
                cofactor = (column + row) % 2 == 0 ? minor : -minor;
            }
            result[row][column] = static_cast<float>(cofactor * reciprocal);
        }
    }
    return isFinite(result) ? std::optional(result) : std::nullopt;
}

glm::mat4 inverseNaive(const glm::mat4& m) {
    return glm::inverse(m);
}

glm::mat4 lookAt(glm::vec3 eye, glm::vec3 target, glm::vec3 up) {
    QX_CHECK(quincunx::isFinite(eye) && quincunx::isFinite(target) && quincunx::isFinite(up));
    glm::dmat3 rotation(1);
    const glm::dvec3 view = glm::dvec3(target) - glm::dvec3(eye);
    if (const auto forward = normalize(view)) {
        const std::optional<glm::dvec3> side = normalize(cross(view, glm::dvec3(up)));
        const glm::dvec3 right = side ? *side : basisAround(view).value()[0];
        rotation = glm::dmat3(right, glm::cross(right, *forward), -*forward);
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

#include "math/transform.h"

#include <algorithm>
#include <cmath>

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

double largest(glm::dvec3 v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool isFinite(const glm::mat3& m) {
    return quincunx::isFinite(m[0]) && quincunx::isFinite(m[1]) && quincunx::isFinite(m[2]);
}

bool isFinite(const glm::mat4& m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(m[column][row]))
                return false;
    return true;
}

/// m without its column and row.
glm::mat3 minorOf(const glm::mat4& m, int column, int row) {
    glm::mat3 minor;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            minor[c][r] = m[c < column ? c : c + 1][r < row ? r : r + 1];
    return minor;
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
        const int exponent = std::ilogb(most);
        highest = any ? std::max(highest, exponent) : exponent;
        lowest = any ? std::min(lowest, exponent) : exponent;
        any = true;
    }
    if (!any)
        return glm::mat3(1);
    const int centre = lowest + (highest - lowest) / 2;
    // Within 2^±300, so exact and in the range of double.
    const double scale = std::ldexp(1.0, std::min(-centre, 124 - highest));
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

std::optional<glm::mat4> inverse(const glm::mat4& m) {
    if (!isFinite(m))
        return std::nullopt;
    const double det = determinant(m);
    if (det == 0)
        return std::nullopt;
    glm::mat4 result;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            const double minor = determinant(minorOf(m, row, column));
            result[column][row] = static_cast<float>(((column + row) % 2 == 0 ? minor : -minor) / det);
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
        const glm::dvec3 side = cross(view, glm::dvec3(up));
        const glm::dvec3 right = normalize(side).value_or((*basisAround(view))[0]);
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
    const glm::mat3 rotation(worldFromCamera);
    const glm::vec3 origin(worldFromCamera[3]);
    glm::mat4 inverse{glm::transpose(rotation)};
    inverse[3] =
        glm::vec4(-dot(rotation[0], origin), -dot(rotation[1], origin), -dot(rotation[2], origin), 1);
    return inverse;
}

}  // namespace quincunx

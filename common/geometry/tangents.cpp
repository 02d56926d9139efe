#include "geometry/tangents.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/check.h"
#include "math/vector.h"

namespace quincunx {

namespace {

/// Which way the texture lies on a triangle.
struct Lie {
    glm::dvec3 tangent{0};
    bool isMirrored = false;
};

/// None for triangles that say nothing. Coordinates are those of the texture, t downwards.
std::optional<Lie> lieOf(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec2, 3>& st) {
    const glm::dvec3 e1 = p[1] - p[0];
    const glm::dvec3 e2 = p[2] - p[0];
    const glm::dvec2 d1 = st[1] - st[0];
    const glm::dvec2 d2 = st[2] - st[0];
    const double determinant = differenceOfProducts(d1.x, d2.y, d2.x, d1.y);
    if (!(std::abs(determinant) > 0) || !std::isfinite(determinant) || cross(e1, e2) == glm::dvec3(0))
        return std::nullopt;
    const glm::dvec3 along(differenceOfProducts(e1.x, d2.y, e2.x, d1.y),
                           differenceOfProducts(e1.y, d2.y, e2.y, d1.y),
                           differenceOfProducts(e1.z, d2.y, e2.z, d1.y));
    // On an upright picture t grows downwards, so that s and t turn clockwise.
    return Lie{determinant > 0 ? along : -along, determinant > 0};
}

/// `v` without what it has along the unit vector `normal`, of unit length.
std::optional<glm::dvec3> inPlane(const glm::dvec3& v, const glm::dvec3& normal) {
    const std::optional<glm::dvec3> direction = normalize(v);
    if (!direction)
        return std::nullopt;
    return normalize(cross(cross(normal, *direction), normal));
}

}  // namespace

void makeTangents(Mesh& mesh, int texcoordSet, const glm::mat3& textureFromTexcoord) {
    QX_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    QX_CHECK(texcoordSet == 0 || texcoordSet == 1);
    const std::size_t count = mesh.positions.size();
    const std::vector<glm::vec2>& texcoords = texcoordSet == 0 ? mesh.texcoords : mesh.texcoords1;
    const glm::dmat3 matrix(textureFromTexcoord);

    // Sums for the upright and the mirrored triangles of each vertex, which become vertices of their own.
    std::array<std::vector<glm::dvec3>, 2> sums;
    sums[0].resize(count, glm::dvec3(0));
    std::array<std::vector<bool>, 2> spoken{std::vector<bool>(count, false), std::vector<bool>(count, false)};
    std::vector<signed char> sideOfTriangle(mesh.triangleCount(), -1);
    for (std::size_t t = 0; t < mesh.triangleCount() && !texcoords.empty(); ++t) {
        const std::uint32_t* const corner = &mesh.indices[3 * t];
        std::array<glm::dvec3, 3> p;
        std::array<glm::dvec2, 3> st;
        for (std::size_t c = 0; c < 3; ++c) {
            p[c] = glm::dvec3(mesh.positions[corner[c]]);
            st[c] = glm::dvec2(matrix * glm::dvec3(glm::dvec2(texcoords[corner[c]]), 1));
        }
        const std::optional<Lie> lie = lieOf(p, st);
        if (!lie)
            continue;
        const std::size_t side = lie->isMirrored ? 1 : 0;
        sideOfTriangle[t] = static_cast<signed char>(side);
        if (sums[side].empty())
            sums[side].resize(count, glm::dvec3(0));
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t v = corner[c];
            spoken[side][v] = true;
            const auto tangent = inPlane(lie->tangent, glm::dvec3(mesh.normals[v]));
            if (!tangent)
                continue;
            const glm::dvec3 e1 = p[(c + 1) % 3] - p[c];
            const glm::dvec3 e2 = p[(c + 2) % 3] - p[c];
            const double angle = std::atan2(length(cross(e1, e2)), glm::dot(e1, e2));
            sums[side][v] += angle * *tangent;
        }
    }

    const auto tangentOf = [&](std::size_t v, std::size_t side) {
        const glm::dvec3 normal(mesh.normals[v]);
        std::optional<glm::dvec3> tangent;
        if (!sums[side].empty())
            tangent = inPlane(sums[side][v], normal);
        if (!tangent) {
            const auto basis = basisAround(normal);
            tangent = basis ? (*basis)[0] : glm::dvec3(1, 0, 0);
        }
        return glm::vec4(glm::vec3(*tangent), side == 0 ? 1.0f : -1.0f);
    };
    std::vector<glm::vec4> tangents(count);
    std::vector<std::uint32_t> mirroredTwin(count);
    std::vector<std::size_t> twins;
    for (std::size_t v = 0; v < count; ++v) {
        const bool isBoth = spoken[0][v] && spoken[1][v];
        tangents[v] = tangentOf(v, spoken[1][v] && !isBoth ? 1 : 0);
        mirroredTwin[v] = static_cast<std::uint32_t>(isBoth ? count + twins.size() : v);
        if (isBoth)
            twins.push_back(v);
    }
    QX_CHECK_LE(count + twins.size(), std::size_t{std::numeric_limits<std::uint32_t>::max()});
    for (const std::size_t v : twins)
        tangents.push_back(tangentOf(v, 1));
    for (std::size_t t = 0; t < sideOfTriangle.size(); ++t)
        if (sideOfTriangle[t] == 1)
            for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
                mesh.indices[i] = mirroredTwin[mesh.indices[i]];
    const auto withTwins = [&](auto& values) {
        if (values.empty())
            return;
        values.reserve(count + twins.size());
        for (const std::size_t v : twins)
            values.push_back(values[v]);
    };
    withTwins(mesh.positions);
    withTwins(mesh.normals);
    withTwins(mesh.texcoords);
    withTwins(mesh.texcoords1);
    withTwins(mesh.colors);
    mesh.tangents = std::move(tangents);
}

glm::vec3 triangleTangentNaive(const glm::vec3& e1, const glm::vec3& e2, glm::vec2 st1, glm::vec2 st2) {
    const float f = 1.0f / (st1.x * st2.y - st2.x * st1.y);
    return f * (st2.y * e1 - st1.y * e2);
}

}  // namespace quincunx

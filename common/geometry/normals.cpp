#include "geometry/normals.h"

#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/check.h"

namespace quincunx {

namespace {

constexpr std::size_t grain = 8192;

glm::dvec3 edge(const glm::vec3& from, const glm::vec3& to) {
    return glm::dvec3(to) - glm::dvec3(from);
}

/// Angle between two edges, of which the length of the cross product is known. Stable near 0 and pi.
double angle(const glm::dvec3& u, const glm::dvec3& v, double crossLength) {
    return std::atan2(crossLength, glm::dot(u, v));
}

struct TriangleShare {
    glm::dvec3 normal;  ///< unit, or 0
    glm::dvec3 angles;  ///< at each corner, radians
};

TriangleShare shareOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::dvec3 ab = edge(a, b);
    const glm::dvec3 bc = edge(b, c);
    const glm::dvec3 ca = edge(c, a);
    const glm::dvec3 normal = glm::cross(ab, -ca);
    const double length = glm::length(normal);
    if (length == 0)
        return {glm::dvec3(0), glm::dvec3(0)};
    return {normal / length, {angle(ab, -ca, length), angle(bc, -ab, length), angle(ca, -bc, length)}};
}

struct Sum {
    glm::dvec3 weighted{0};
    double weight = 0;
    std::uint32_t terms = 0;
    std::uint32_t firstTriangle = 0;
};

}  // namespace

glm::dvec3 triangleNormal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::dvec3 normal = glm::cross(edge(a, b), edge(a, c));
    const double length = glm::length(normal);
    return length == 0 ? glm::dvec3(0) : normal / length;
}

std::vector<glm::vec3> smoothNormals(std::span<const glm::vec3> positions,
                                     std::span<const std::uint32_t> positionIndices,
                                     std::span<const std::uint32_t> groups, std::size_t groupCount) {
    QX_CHECK_EQ(positionIndices.size(), groups.size());
    QX_CHECK_EQ(groups.size() % 3, 0u);
    const std::size_t triangles = groups.size() / 3;
    std::vector<TriangleShare> shares(triangles);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, grain), [&](const auto& range) {
        for (std::size_t t = range.begin(); t != range.end(); ++t)
            if (groups[3 * t] != noGroup || groups[3 * t + 1] != noGroup || groups[3 * t + 2] != noGroup)
                shares[t] = shareOf(positions[positionIndices[3 * t]], positions[positionIndices[3 * t + 1]],
                                    positions[positionIndices[3 * t + 2]]);
    });
    // Added up in the order of the triangles, whatever the number of threads.
    std::vector<Sum> sums(groupCount);
    for (std::size_t t = 0; t < triangles; ++t) {
        const TriangleShare& share = shares[t];
        if (share.normal == glm::dvec3(0))
            continue;
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t group = groups[3 * t + corner];
            if (group == noGroup)
                continue;
            Sum& sum = sums[group];
            if (sum.terms == 0)
                sum.firstTriangle = static_cast<std::uint32_t>(t);
            sum.weighted += share.angles[corner] * share.normal;
            sum.weight += share.angles[corner];
            ++sum.terms;
        }
    }
    std::vector<glm::vec3> normals(groupCount);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groupCount, grain), [&](const auto& range) {
        for (std::size_t g = range.begin(); g != range.end(); ++g) {
            const Sum& sum = sums[g];
            // Each term carries a relative rounding error of at most 8 · 2^-53 (three roundings in the cross
            // product of exact edges, length, division, angle, product), and adding n terms one of
            // n · 2^-53 of the total weight: a sum below that says nothing.
            const double noise = (sum.terms + 8.0) * 0x1p-53 * sum.weight;
            const double length = glm::length(sum.weighted);
            if (sum.terms == 0)
                normals[g] = glm::vec3(0, 0, 1);
            else if (length <= noise)
                normals[g] = glm::vec3(shares[sum.firstTriangle].normal);
            else
                normals[g] = glm::vec3(sum.weighted / length);
        }
    });
    return normals;
}

void makeSmoothNormals(Mesh& mesh) {
    mesh.normals = smoothNormals(mesh.positions, mesh.indices, mesh.indices, mesh.positions.size());
}

void makeFlatNormals(Mesh& mesh) {
    const std::size_t corners = mesh.indices.size();
    std::vector<glm::vec3> positions(corners);
    std::vector<glm::vec3> normals(corners);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, corners / 3, grain), [&](const auto& range) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
            for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
                positions[i] = mesh.positions[mesh.indices[i]];
            const glm::dvec3 normal =
                triangleNormal(positions[3 * t], positions[3 * t + 1], positions[3 * t + 2]);
            const glm::vec3 unit = normal == glm::dvec3(0) ? glm::vec3(0, 0, 1) : glm::vec3(normal);
            for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
                normals[i] = unit;
        }
    });
    const auto atCorners = [&](auto& values) {
        if (values.empty())
            return;
        std::remove_reference_t<decltype(values)> own(corners);
        for (std::size_t i = 0; i < corners; ++i)
            own[i] = values[mesh.indices[i]];
        values = std::move(own);
    };
    atCorners(mesh.texcoords);
    atCorners(mesh.texcoords1);
    atCorners(mesh.colors);
    mesh.tangents.clear();
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
}

}  // namespace quincunx

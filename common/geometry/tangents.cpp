#include "geometry/tangents.h"

#include <cmath>

#include "base/check.h"
#include "math/vector.h"

namespace quincunx {
namespace {

using glm::dvec2;
using glm::dvec3;

/// (0,0,0) for what has no direction.
dvec3 unit(const dvec3& v) {
    return normalize(v).value_or(dvec3(0));
}

/// Some unit vector across the unit vector `n`, or x for no `n`.
dvec3 across(const dvec3& n) {
    const dvec3 a = glm::abs(n);
    const dvec3 axis = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0)
                       : a.y <= a.z             ? dvec3(0, 1, 0)
                                                : dvec3(0, 0, 1);
    const dvec3 result = unit(axis - glm::dot(axis, n) * n);
    return result == dvec3(0) ? dvec3(1, 0, 0) : result;
}

double angleBetween(const dvec3& a, const dvec3& b) {
    const dvec3 sine = glm::cross(a, b);
    return std::atan2(length(sine), glm::dot(a, b));
}

/// What the triangles with one sign of the bitangent add up to at a vertex.
struct Sum {
    dvec3 tangent{0};
    double angles = 0;
};

}  // namespace

std::vector<glm::vec4> vertexTangents(const Mesh& mesh, std::span<const glm::vec2> texcoords) {
    QX_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    QX_CHECK_EQ(texcoords.size(), mesh.positions.size());
    struct Sums {
        Sum upright;  ///< w = 1
        Sum mirrored;
    };
    std::vector<Sums> sums(mesh.positions.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t corner[3] = {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
        const dvec3 p[3] = {mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]};
        const dvec2 st[3] = {texcoords[corner[0]], texcoords[corner[1]], texcoords[corner[2]]};
        const dvec3 e1 = p[1] - p[0];
        const dvec3 e2 = p[2] - p[0];
        const dvec2 d1 = st[1] - st[0];
        const dvec2 d2 = st[2] - st[0];
        const double span = d1.x * d2.y - d2.x * d1.y;
        // span · dP/ds, whose direction is all that is wanted.
        const dvec3 alongS = unit((span > 0 ? 1.0 : -1.0) * (e1 * d2.y - e2 * d1.y));
        if (!(std::abs(span) > 0) || !std::isfinite(span) || alongS == dvec3(0))
            continue;
        const dvec3 plane = glm::cross(e1, e2);
        for (int k = 0; k < 3; ++k) {
            const dvec3 n = unit(mesh.normals[corner[k]]);
            const dvec3 tangent = unit(alongS - glm::dot(alongS, n) * n);
            if (tangent == dvec3(0))
                continue;
            // ∂P/∂s × ∂P/∂t points along the plane's normal divided by the span; −∂P/∂t is up.
            const bool upright = (glm::dot(plane, n) < 0) == (span > 0);
            Sum& sum = upright ? sums[corner[k]].upright : sums[corner[k]].mirrored;
            const double angle = angleBetween(unit(p[(k + 1) % 3] - p[k]), unit(p[(k + 2) % 3] - p[k]));
            sum.tangent += angle * tangent;
            sum.angles += angle;
        }
    }
    std::vector<glm::vec4> tangents(mesh.positions.size());
    for (std::size_t v = 0; v < tangents.size(); ++v) {
        const bool upright = sums[v].upright.angles >= sums[v].mirrored.angles;
        const dvec3 n = unit(mesh.normals[v]);
        const dvec3 sum = upright ? sums[v].upright.tangent : sums[v].mirrored.tangent;
        const dvec3 tangent = unit(sum - glm::dot(sum, n) * n);
        tangents[v] = glm::vec4(tangent == dvec3(0) ? across(n) : tangent, upright ? 1 : -1);
    }
    return tangents;
}

}  // namespace quincunx

#include "geometry/tangent_frames.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/check.h"
#include "geometry/tangents.h"

namespace quincunx {

namespace {

enum class Side : std::uint8_t { none, upright, mirrored, both };

Side joined(Side a, Side b) {
    return static_cast<Side>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}

/// How the texture lies on a triangle, seen by each of its corners' normals.
std::array<Side, 3> sidesOf(const Mesh& mesh, const std::vector<glm::vec2>& texcoords, std::size_t triangle) {
    const std::uint32_t* const corner = &mesh.indices[3 * triangle];
    const glm::dvec3 p(mesh.positions[corner[0]]);
    const glm::dvec2 st(texcoords[corner[0]]);
    const glm::dvec3 plane =
        glm::cross(glm::dvec3(mesh.positions[corner[1]]) - p, glm::dvec3(mesh.positions[corner[2]]) - p);
    const glm::dvec2 d1 = glm::dvec2(texcoords[corner[1]]) - st;
    const glm::dvec2 d2 = glm::dvec2(texcoords[corner[2]]) - st;
    const double span = d1.x * d2.y - d2.x * d1.y;
    std::array<Side, 3> sides{};
    if (!(std::abs(span) > 0) || !std::isfinite(span) || plane == glm::dvec3(0))
        return sides;
    for (std::size_t c = 0; c < 3; ++c) {
        const bool isBehind = glm::dot(plane, glm::dvec3(mesh.normals[corner[c]])) < 0;
        // On an upright picture t grows downwards, so that s and t turn clockwise.
        sides[c] = isBehind == (span > 0) ? Side::upright : Side::mirrored;
    }
    return sides;
}

void splitMirrored(Mesh& mesh, std::vector<glm::vec2>& texcoords) {
    const std::size_t count = mesh.positions.size();
    std::vector<Side> sides(count, Side::none);
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
        const std::array<Side, 3> own = sidesOf(mesh, texcoords, t);
        for (std::size_t c = 0; c < 3; ++c) {
            Side& side = sides[mesh.indices[3 * t + c]];
            side = joined(side, own[c]);
        }
    }
    std::vector<std::uint32_t> twinOf(count);
    std::vector<std::size_t> twins;
    for (std::size_t v = 0; v < count; ++v)
        if (sides[v] == Side::both) {
            QX_CHECK_LT(count + twins.size(), std::size_t{std::numeric_limits<std::uint32_t>::max()});
            twinOf[v] = static_cast<std::uint32_t>(count + twins.size());
            twins.push_back(v);
        }
    if (twins.empty())
        return;
    for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
        const std::array<Side, 3> own = sidesOf(mesh, texcoords, t);
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t& corner = mesh.indices[3 * t + c];
            if (own[c] == Side::mirrored && sides[corner] == Side::both)
                corner = twinOf[corner];
        }
    }
    const auto withTwins = [&](auto& values) {
        if (values.empty())
            return;
        values.reserve(count + twins.size());
        for (const std::size_t v : twins)
            values.push_back(values[v]);
    };
    withTwins(texcoords);
    withTwins(mesh.positions);
    withTwins(mesh.normals);
    withTwins(mesh.texcoords);
    withTwins(mesh.texcoords1);
    withTwins(mesh.colors);
}

}  // namespace

void makeTangents(Mesh& mesh, int texcoordSet, const glm::mat3& textureFromTexcoord) {
    QX_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    QX_CHECK(texcoordSet == 0 || texcoordSet == 1);
    const glm::dmat3 matrix(textureFromTexcoord);
    std::vector<glm::vec2> texcoords = texcoordSet == 0 ? mesh.texcoords : mesh.texcoords1;
    for (glm::vec2& st : texcoords)
        st = glm::vec2(matrix * glm::dvec3(glm::dvec2(st), 1));
    // Equal coordinates say nothing.
    texcoords.resize(mesh.positions.size(), glm::vec2(0));
    mesh.tangents.clear();
    splitMirrored(mesh, texcoords);
    mesh.tangents = vertexTangents(mesh, texcoords);
}

}  // namespace quincunx

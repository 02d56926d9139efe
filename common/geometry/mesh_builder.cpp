#include "geometry/mesh_builder.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "geometry/normals.h"
#include "math/transform.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr float turn = 2 * std::numbers::pi_v<float>;

glm::vec3 unit(glm::vec3 v) {
    return normalizeOr(v, {0, 1, 0});
}

}  // namespace

std::uint32_t MeshBuilder::vertex(glm::vec3 position, glm::vec3 normal) {
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const std::array corners = {a, b, c};
    polygon(corners);
}

void MeshBuilder::quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const std::array corners = {a, b, c, d};
    polygon(corners);
}

void MeshBuilder::polygon(std::span<const glm::vec3> corners) {
    QX_CHECK_GE(corners.size(), 3u);
    const glm::vec3 normal(triangleNormal(corners[0], corners[1], corners[2]));
    const std::uint32_t first = vertex(corners[0], normal);
    for (std::size_t i = 1; i < corners.size(); ++i) {
        const std::uint32_t at = vertex(corners[i], normal);
        if (i > 1)
            mesh_.indices.insert(mesh_.indices.end(), {first, at - 1, at});
    }
}

void MeshBuilder::box(glm::vec3 min, glm::vec3 max, Faces faces) {
    const auto corner = [&](int i) {
        return glm::vec3((i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y,
                         (i & 4) != 0 ? max.z : min.z);
    };
    const auto face = [&](int a, int b, int c, int d) {
        if (faces.inward)
            quad(corner(d), corner(c), corner(b), corner(a));
        else
            quad(corner(a), corner(b), corner(c), corner(d));
    };
    face(4, 5, 7, 6);
    face(5, 1, 3, 7);
    face(0, 4, 6, 2);
    face(6, 7, 3, 2);
    if (faces.back)
        face(1, 0, 2, 3);
    if (faces.bottom)
        face(0, 1, 5, 4);
}

void MeshBuilder::tube(std::span<const glm::vec3> points, float radius, int sides, bool closed) {
    QX_CHECK_GE(points.size(), closed ? 3u : 2u);
    QX_CHECK_GE(sides, 3);
    const std::size_t count = points.size();
    const auto direction = [&](std::size_t i) {
        const glm::vec3 before = points[i == 0 ? (closed ? count - 1 : 0) : i - 1];
        const glm::vec3 after = points[i + 1 == count ? (closed ? 0 : count - 1) : i + 1];
        return unit(after - before);
    };
    std::vector<std::uint32_t> starts;
    // The first ring's axes are carried along, so that the skin does not twist.
    glm::vec3 side = (*basisAround(direction(0)))[0];
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 along = direction(i);
        side = normalizeOr(side - glm::dot(side, along) * along, (*basisAround(along))[0]);
        const glm::vec3 up = glm::cross(along, side);
        for (int k = 0; k < sides; ++k) {
            const float angle = turn * static_cast<float>(k) / static_cast<float>(sides);
            const glm::vec3 out = std::cos(angle) * side + std::sin(angle) * up;
            const std::uint32_t at = vertex(points[i] + radius * out, out);
            if (k == 0)
                starts.push_back(at);
        }
    }
    const auto ringAt = [&](std::size_t i, int k) {
        return starts[i] + static_cast<std::uint32_t>(k % sides);
    };
    for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
        const std::size_t next = (i + 1) % count;
        for (int k = 0; k < sides; ++k)
            mesh_.indices.insert(mesh_.indices.end(), {ringAt(i, k), ringAt(i, k + 1), ringAt(next, k + 1),
                                                       ringAt(i, k), ringAt(next, k + 1), ringAt(next, k)});
    }
    if (closed)
        return;
    for (const bool end : {false, true}) {
        std::vector<glm::vec3> cap;
        cap.reserve(static_cast<std::size_t>(sides));
        for (int k = 0; k < sides; ++k)
            cap.push_back(mesh_.positions[ringAt(end ? count - 1 : 0, end ? k : sides - 1 - k)]);
        polygon(cap);
    }
}

void MeshBuilder::column(glm::vec3 bottom, float height, float bottomRadius, float topRadius, int sides,
                         bool capBelow) {
    QX_CHECK_GE(sides, 3);
    const float slope = (bottomRadius - topRadius) / height;
    std::vector<glm::vec3> below;
    std::vector<glm::vec3> above;
    std::vector<std::uint32_t> at;
    for (int k = 0; k < sides; ++k) {
        const float angle = turn * static_cast<float>(k) / static_cast<float>(sides);
        const glm::vec3 out(std::sin(angle), 0, std::cos(angle));
        const glm::vec3 normal = unit(out + glm::vec3(0, slope, 0));
        below.push_back(bottom + bottomRadius * out);
        above.push_back(bottom + glm::vec3(0, height, 0) + topRadius * out);
        at.push_back(vertex(below.back(), normal));
        vertex(above.back(), normal);
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
        const std::uint32_t here = at[k];
        const std::uint32_t next = at[(k + 1) % at.size()];
        if (bottomRadius > 0)
            mesh_.indices.insert(mesh_.indices.end(), {here, next, here + 1});
        if (topRadius > 0)
            mesh_.indices.insert(mesh_.indices.end(), {next, next + 1, here + 1});
    }
    if (topRadius > 0)
        polygon(above);
    if (capBelow && bottomRadius > 0) {
        const std::vector<glm::vec3> reversed(below.rbegin(), below.rend());
        polygon(reversed);
    }
}

void MeshBuilder::disc(glm::vec3 centre, float radius, int sides) {
    std::vector<glm::vec3> rim;
    for (int k = 0; k < sides; ++k) {
        const float angle = turn * static_cast<float>(k) / static_cast<float>(sides);
        rim.push_back(centre + radius * glm::vec3(std::sin(angle), 0, std::cos(angle)));
    }
    polygon(rim);
}

void MeshBuilder::append(const Mesh& mesh, const glm::mat4& place) {
    QX_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    const glm::mat3 normals = normalMatrix(place);
    const bool mirrors = glm::determinant(glm::mat3(place)) < 0;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        vertex(glm::vec3(place * glm::vec4(mesh.positions[i], 1)), unit(normals * mesh.normals[i]));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t b = first + mesh.indices[i + 1];
        const std::uint32_t c = first + mesh.indices[i + 2];
        mesh_.indices.insert(mesh_.indices.end(),
                             {first + mesh.indices[i], mirrors ? c : b, mirrors ? b : c});
    }
}

Mesh MeshBuilder::take(std::string name) {
    Mesh result = std::move(mesh_);
    result.name = std::move(name);
    mesh_ = {};
    return result;
}

Mesh loft(std::span<const std::vector<glm::vec3>> rings, bool capStart, bool capEnd, std::string name) {
    QX_CHECK_GE(rings.size(), 2u);
    const std::size_t sides = rings[0].size();
    QX_CHECK_GE(sides, 3u);
    Mesh mesh;
    mesh.name = std::move(name);
    for (const std::vector<glm::vec3>& ring : rings) {
        QX_CHECK_EQ(ring.size(), sides);
        mesh.positions.insert(mesh.positions.end(), ring.begin(), ring.end());
    }
    const auto at = [&](std::size_t ring, std::size_t k) {
        return static_cast<std::uint32_t>(ring * sides + k % sides);
    };
    for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring)
        for (std::size_t k = 0; k < sides; ++k)
            mesh.indices.insert(mesh.indices.end(), {at(ring, k), at(ring, k + 1), at(ring + 1, k + 1),
                                                     at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    for (const bool end : {false, true}) {
        if (!(end ? capEnd : capStart))
            continue;
        const std::size_t ring = end ? rings.size() - 1 : 0;
        glm::vec3 middle(0);
        for (const glm::vec3& point : rings[ring])
            middle += point / static_cast<float>(sides);
        const auto centre = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(middle);
        for (std::size_t k = 0; k < sides; ++k)
            mesh.indices.insert(mesh.indices.end(),
                                {centre, at(ring, end ? k : k + 1), at(ring, end ? k + 1 : k)});
    }
    makeSmoothNormals(mesh);
    return mesh;
}

Mesh subset(const Mesh& mesh, const std::vector<bool>& keep, std::string name) {
    QX_CHECK_EQ(keep.size(), mesh.triangleCount());
    constexpr std::uint32_t unused = 0xffffffffu;
    std::vector<std::uint32_t> newIndex(mesh.positions.size(), unused);
    Mesh result;
    result.name = std::move(name);
    for (std::size_t triangle = 0; triangle < keep.size(); ++triangle) {
        if (!keep[triangle])
            continue;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t old = mesh.indices[3 * triangle + corner];
            if (newIndex[old] == unused) {
                newIndex[old] = static_cast<std::uint32_t>(result.positions.size());
                result.positions.push_back(mesh.positions[old]);
                result.normals.push_back(mesh.normals[old]);
            }
            result.indices.push_back(newIndex[old]);
        }
    }
    return result;
}

glm::vec2 superellipse(float radians, float a, float b, float exponent) {
    const float c = std::cos(radians);
    const float s = std::sin(radians);
    return {a * std::copysign(std::pow(std::abs(c), 2 / exponent), c),
            b * std::copysign(std::pow(std::abs(s), 2 / exponent), s)};
}

}  // namespace quincunx

#include "labs/26_ray_tracing/penumbra.h"

#include <cmath>

#include "base/interrupt.h"

namespace quincunx {
namespace {

constexpr std::array<glm::vec3, 4> boardCorners{glm::vec3(-0.6f, 2, -1.1f), glm::vec3(1.3f, 2, -0.5f),
                                                glm::vec3(0.7f, 2, 1.4f), glm::vec3(-1.2f, 2, 0.8f)};

WhittedContents contentsOf(const AreaLight& lamp, const std::array<glm::vec3, 4>& board) {
    WhittedContents contents;
    contents.materials.emplace_back();
    Mesh mesh;
    mesh.name = "board";
    mesh.positions.assign(board.begin(), board.end());
    mesh.indices = {0, 1, 2, 0, 2, 3};
    contents.parts.push_back({mesh, 0});
    contents.lights.push_back(lamp);
    return contents;
}

}  // namespace

PenumbraBench::PenumbraBench()
    : lamp{{-0.7f, 4, -0.7f}, {1.4f, 0, 0}, {0, 0, 1.4f}, glm::vec3(1)},
      board(boardCorners),
      scene(contentsOf(lamp, board)) {
    for (int i = 0; i < 12; ++i)
        for (int k = 0; k < 24; ++k)
            points.emplace_back(0.31f + 0.19f * static_cast<float>(k), 0,
                                -1.9f + 0.33f * static_cast<float>(i));
}

double exactVisibleShare(const AreaLight& lamp, const std::array<glm::vec3, 4>& board, glm::vec3 point) {
    const glm::dvec3 from(point);
    const glm::dvec3 corner = glm::dvec3(lamp.corner) - from;
    const glm::dvec3 u(lamp.edgeU);
    const glm::dvec3 v(lamp.edgeV);
    const glm::dvec3 normal = glm::cross(u, v);
    std::vector<glm::dvec2> polygon;
    for (const glm::vec3& boardCorner : board) {
        const glm::dvec3 way = glm::dvec3(boardCorner) - from;
        const glm::dvec3 onLamp = glm::dot(normal, corner) / glm::dot(normal, way) * way - corner;
        polygon.emplace_back(glm::dot(glm::cross(onLamp, v), normal) / glm::dot(normal, normal),
                             glm::dot(glm::cross(u, onLamp), normal) / glm::dot(normal, normal));
    }
    for (int side = 0; side < 4; ++side) {
        const int axis = side / 2;
        const auto inside = [&](glm::dvec2 p) { return side % 2 == 0 ? p[axis] : 1 - p[axis]; };
        std::vector<glm::dvec2> clipped;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2 a = polygon[i];
            const glm::dvec2 b = polygon[(i + 1) % polygon.size()];
            const double atA = inside(a);
            const double atB = inside(b);
            if (atA >= 0)
                clipped.push_back(a);
            if ((atA < 0) != (atB < 0))
                clipped.push_back(a + atA / (atA - atB) * (b - a));
        }
        polygon = std::move(clipped);
    }
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i];
        const glm::dvec2 b = polygon[(i + 1) % polygon.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return 1 - 0.5 * std::abs(twice);
}

double penumbraError(const PenumbraBench& bench, const std::vector<std::vector<glm::vec2>>& sets) {
    double sum = 0;
    for (std::size_t i = 0; i < bench.points.size(); ++i) {
        throwIfInterrupted();
        const double error = visibleShare(bench.scene, 0, bench.points[i], sets[i % sets.size()]) -
                             exactVisibleShare(bench.lamp, bench.board, bench.points[i]);
        sum += error * error;
    }
    return std::sqrt(sum / static_cast<double>(bench.points.size()));
}

double slopeOf(const std::vector<double>& counts, const std::vector<double>& errors) {
    double x = 0;
    double y = 0;
    double xx = 0;
    double xy = 0;
    const auto n = static_cast<double>(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const double lx = std::log(counts[i]);
        const double ly = std::log(errors[i]);
        x += lx;
        y += ly;
        xx += lx * lx;
        xy += lx * ly;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace quincunx

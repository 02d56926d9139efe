#include "math/spaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "math/vector.h"

namespace quincunx {
namespace {

bool isFinite(glm::dvec4 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

/// m · result = right, or none if m is singular to double or not finite.
std::optional<glm::dvec4> solve(const glm::mat4& m, glm::dvec4 right) {
    double rows[4][5];
    int unknown[4] = {0, 1, 2, 3};  // by column
    for (int row = 0; row < 4; ++row) {
        double most = 0;
        for (int column = 0; column < 4; ++column) {
            rows[row][column] = m[column][row];
            most = std::max(most, std::abs(rows[row][column]));
        }
        rows[row][4] = right[row];
        if (!(most > 0) || !std::isfinite(most))
            return std::nullopt;
        const int exponent = -std::ilogb(most);
        for (double& entry : rows[row])
            entry = std::scalbn(entry, exponent);
    }
    for (int step = 0; step < 4; ++step) {
        int pivotRow = step;
        int pivotColumn = step;
        for (int row = step; row < 4; ++row)
            for (int column = step; column < 4; ++column)
                if (std::abs(rows[row][column]) > std::abs(rows[pivotRow][pivotColumn])) {
                    pivotRow = row;
                    pivotColumn = column;
                }
        if (!(std::abs(rows[pivotRow][pivotColumn]) > 0))
            return std::nullopt;
        std::swap(rows[step], rows[pivotRow]);
        for (auto& row : rows)
            std::swap(row[step], row[pivotColumn]);
        std::swap(unknown[step], unknown[pivotColumn]);
        for (int row = step + 1; row < 4; ++row) {
            const double factor = rows[row][step] / rows[step][step];
            for (int column = step; column < 5; ++column)
                rows[row][column] -= factor * rows[step][column];
        }
    }
    glm::dvec4 result(0);
    for (int step = 3; step >= 0; --step) {
        double value = rows[step][4];
        for (int column = step + 1; column < 4; ++column)
            value -= rows[step][column] * result[unknown[column]];
        result[unknown[step]] = value / rows[step][step];
    }
    return isFinite(result) ? std::optional(result) : std::nullopt;
}

glm::dvec3 windowFromNdc(const Viewport& viewport, glm::dvec3 ndc) {
    QX_CHECK(viewport.width > 0 && viewport.height > 0 && viewport.nearDepth != viewport.farDepth);
    return {viewport.x + (ndc.x + 1) / 2 * viewport.width, viewport.y + (ndc.y + 1) / 2 * viewport.height,
            viewport.nearDepth + (ndc.z + 1) / 2 * (viewport.farDepth - viewport.nearDepth)};
}

glm::dvec3 ndcFromWindow(const Viewport& viewport, glm::dvec3 window) {
    QX_CHECK(viewport.width > 0 && viewport.height > 0 && viewport.nearDepth != viewport.farDepth);
    return {(window.x - viewport.x) * 2 / viewport.width - 1,
            (window.y - viewport.y) * 2 / viewport.height - 1,
            (window.z - viewport.nearDepth) * 2 / (viewport.farDepth - viewport.nearDepth) - 1};
}

}  // namespace

Homogenized detail::homogenizeFarAway(glm::vec4 p) {
    const glm::vec3 direction = std::signbit(p.w) && p.w != 0 ? -glm::vec3(p) : glm::vec3(p);
    if (const auto unit = normalize(direction); unit && std::isfinite(p.w))
        return {HomogeneousKind::direction, *unit};
    return {};
}

HomogenizedInDouble homogenize(glm::dvec4 p) {
    const glm::dvec3 quotient(p.x / p.w, p.y / p.w, p.z / p.w);
    if (isFinite(quotient) && std::isfinite(p.w))
        return {p.w > 0 ? HomogeneousKind::point : HomogeneousKind::behind, quotient};
    const std::optional<glm::dvec3> unit = normalize(p.w < 0 ? -glm::dvec3(p) : glm::dvec3(p));
    return unit && std::isfinite(p.w) ? HomogenizedInDouble{HomogeneousKind::direction, *unit}
                                      : HomogenizedInDouble{};
}

glm::vec3 homogenizeNaive(glm::vec4 p) {
    const float reciprocal = 1 / p.w;
    return {p.x * reciprocal, p.y * reciprocal, p.z * reciprocal};
}

glm::mat4 scaleThroughW(float d) {
    QX_CHECK(d > 0 && std::isfinite(d));
    const float power = std::scalbn(1.0f, std::ilogb(d));
    glm::mat4 m(power);
    m[3][3] = power / d;
    return m;
}

glm::mat4 scaleThroughWNaive(float d) {
    glm::mat4 m(1);
    m[3][3] = 1 / d;
    return m;
}

glm::mat4 viewportMatrix(const Viewport& viewport) {
    const glm::dvec3 centre = windowFromNdc(viewport, glm::dvec3(0));
    glm::mat4 m(1);
    m[0][0] = static_cast<float>(viewport.width / 2);
    m[1][1] = static_cast<float>(viewport.height / 2);
    m[2][2] = static_cast<float>((viewport.farDepth - viewport.nearDepth) / 2);
    m[3] = glm::vec4(glm::vec3(centre), 1);
    return m;
}

VertexInSpaces throughSpaces(const SpaceChain& chain, glm::dvec3 model) {
    VertexInSpaces vertex;
    vertex.model = glm::dvec4(model, 1);
    vertex.world = glm::dmat4(chain.worldFromModel) * vertex.model;
    vertex.eye = glm::dmat4(chain.eyeFromWorld) * vertex.world;
    vertex.clip = glm::dmat4(chain.clipFromEye) * vertex.eye;
    vertex.ndc = homogenize(vertex.clip);
    const double w = vertex.clip.w;
    if (vertex.ndc.kind == HomogeneousKind::point)
        vertex.window = windowFromNdc(chain.viewport, vertex.ndc.value);
    vertex.inView =
        w > 0 && std::abs(vertex.clip.x) <= w && std::abs(vertex.clip.y) <= w && std::abs(vertex.clip.z) <= w;
    return vertex;
}

std::optional<glm::vec3> windowFromModel(const SpaceChain& chain, glm::vec3 model) {
    const std::optional<glm::dvec3> window = throughSpaces(chain, glm::dvec3(model)).window;
    if (!window)
        return std::nullopt;
    const glm::vec3 rounded(*window);
    return isFinite(rounded) ? std::optional(rounded) : std::nullopt;
}

std::optional<glm::vec3> modelFromWindow(const SpaceChain& chain, glm::dvec3 window) {
    if (!isFinite(window))
        return std::nullopt;
    const auto eye = solve(chain.clipFromEye, glm::dvec4(ndcFromWindow(chain.viewport, window), 1));
    const auto world = eye ? solve(chain.eyeFromWorld, *eye) : std::nullopt;
    const auto model = world ? solve(chain.worldFromModel, *world) : std::nullopt;
    if (!model)
        return std::nullopt;
    const HomogenizedInDouble point = homogenize(*model);
    const glm::vec3 rounded(point.value);
    return point.isPoint() && isFinite(rounded) ? std::optional(rounded) : std::nullopt;
}

glm::vec3 modelFromWindowNaive(const SpaceChain& chain, glm::vec3 window) {
    const glm::mat4 modelFromClip =
        glm::inverse(chain.clipFromEye * chain.eyeFromWorld * chain.worldFromModel);
    const glm::vec3 ndc(ndcFromWindow(chain.viewport, glm::dvec3(window)));
    return homogenizeNaive(modelFromClip * glm::vec4(ndc, 1));
}

glm::mat4 eyeFromModel(const glm::dmat4& worldFromModel, const glm::dmat4& worldFromEye) {
    const glm::dmat3 eyeFromWorld = glm::transpose(glm::dmat3(worldFromEye));
    glm::mat4 result{glm::mat3(eyeFromWorld * glm::dmat3(worldFromModel))};
    const glm::dvec3 apart = glm::dvec3(worldFromModel[3]) - glm::dvec3(worldFromEye[3]);
    result[3] = glm::vec4(glm::vec3(eyeFromWorld * apart), 1);
    return result;
}

glm::mat4 eyeFromModelNaive(const glm::dmat4& worldFromModel, const glm::dmat4& worldFromEye) {
    return glm::inverse(glm::mat4(worldFromEye)) * glm::mat4(worldFromModel);
}

}  // namespace quincunx

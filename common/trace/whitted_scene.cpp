#include "trace/whitted_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "geometry/ray_triangle.h"
#include "math/vector.h"
#include "trace/fresnel.h"

namespace quincunx {
namespace {

/// Numbers rounded once from double: half a float's unit in the last place, and what double leaves.
glm::vec3 errorOf(glm::dvec3 point, double size) {
    return glm::vec3(1.0000001 * (0x1p-24 * glm::abs(point) + glm::dvec3(0x1p-48 * size + 0x1p-149)));
}

}  // namespace

WhittedScene::WhittedScene(WhittedContents contents, Structure structure)
    : WhittedScene(std::move(contents),
                   [structure](TriangleView triangles) { return makeAccelerator(structure, triangles); }) {}

WhittedScene::WhittedScene(WhittedContents contents, const MakeAccelerator& make)
    : contents_(std::move(contents)) {
    const auto check = [&](std::uint32_t material) {
        if (material >= contents_.materials.size())
            throw InputError(fmt::format("there is no material {}", material), "a scene", "add it");
        return contents_.materials[material].glass;
    };
    for (const WhittedContents::Part& part : contents_.parts) {
        if (check(part.material))
            throw InputError("triangles are of glass", "a scene", "make them a solid");
        const auto first = static_cast<std::uint32_t>(positions_.size());
        const Mesh& mesh = part.mesh;
        positions_.insert(positions_.end(), mesh.positions.begin(), mesh.positions.end());
        normals_.resize(positions_.size(), glm::vec3(0));
        std::copy(mesh.normals.begin(), mesh.normals.end(), normals_.begin() + first);
        for (const std::uint32_t index : mesh.indices)
            indices_.push_back(first + index);
        materialOfTriangle_.resize(indices_.size() / 3, part.material);
    }
    for (const WhittedContents::Solid& solid : contents_.solids) {
        solids_.emplace_back(solid.shape);
        const Bounds bounds = solids_.back().bounds();
        boxes_.push_back({glm::dvec3(bounds.min), glm::dvec3(bounds.max)});
        const std::vector<std::uint32_t> used = solids_.back().materials();
        std::size_t ofGlass = 0;
        for (const std::uint32_t material : used)
            ofGlass += check(material);
        if (ofGlass != 0 && ofGlass != used.size())
            throw InputError("some of its parts are of glass, and some are not", "a solid", "split it");
        isGlass_.push_back(ofGlass != 0);
    }
    accelerator_ = make(triangleView());
}

/// Slabs, never wrongly denied: quotients are off by 3 · 2^-53 of themselves, and an axis along which the ray
/// stands still is left to the solid.
bool WhittedScene::SolidBox::mayBeMet(const Ray& ray, double tMax) const {
    double enter = 0;
    double exit = tMax;
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0)
            continue;
        const double inverse = 1.0 / ray.direction[axis];
        const double a = (min[axis] - ray.origin[axis]) * inverse;
        const double b = (max[axis] - ray.origin[axis]) * inverse;
        enter = std::max(enter, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    return enter * (1 - 0x1p-49) <= exit * (1 + 0x1p-49);
}

std::optional<WhittedHit> WhittedScene::nearest(const Ray& ray, CsgScratch& scratch,
                                                TraversalCounts* counts) const {
    WhittedHit hit;
    hit.t = std::numeric_limits<double>::infinity();
    const glm::dvec3 direction(ray.direction);
    if (const auto found = accelerator_->nearest(ray, {}, counts)) {
        const Triangle corners = triangle(found->triangle);
        const glm::dvec3 a(corners.a);
        const glm::dvec3 b(corners.b);
        const glm::dvec3 c(corners.c);
        // Weights that sum to 1 in double: the point is in the plane, wherever rounding put it there.
        const double wb = found->weights.y;
        const double wc = found->weights.z;
        const glm::dvec3 point = (1 - wb - wc) * a + wb * b + wc * c;
        hit.t = found->t;
        hit.point = glm::vec3(point);
        const glm::dvec3 largest = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
        hit.pointError = errorOf(point, largest.x + largest.y + largest.z);
        hit.normal = normalize(cross(b - a, c - a)).value_or(-direction);
        hit.front = found->front;
        hit.material = materialOfTriangle_[found->triangle];
        hit.shading = hit.normal;
        const std::size_t i = 3 * static_cast<std::size_t>(found->triangle);
        const glm::dvec3 smooth = (1 - wb - wc) * glm::dvec3(normals_[indices_[i]]) +
                                  wb * glm::dvec3(normals_[indices_[i + 1]]) +
                                  wc * glm::dvec3(normals_[indices_[i + 2]]);
        if (const auto unit = normalize(smooth); unit && glm::dot(*unit, hit.normal) > 0)
            hit.shading = *unit;
    }
    for (std::size_t i = 0; i < solids_.size(); ++i) {
        if (!boxes_[i].mayBeMet(ray, hit.t))
            continue;
        if (const auto found = solids_[i].nearest(ray, {}, scratch); found && found->t < hit.t) {
            hit.t = found->t;
            hit.point = found->point;
            hit.pointError = found->pointError;
            hit.normal = hit.shading = found->normal;
            hit.front = found->front;
            hit.material = found->material;
        }
    }
    for (std::size_t i = 0; i < contents_.lights.size(); ++i) {
        const AreaLight& light = contents_.lights[i];
        const std::array<glm::vec3, 4> corners{light.at({0, 0}), light.at({1, 0}), light.at({1, 1}),
                                               light.at({0, 1})};
        if (const auto found = intersectQuadrilateral(ray, corners); found && found->hit.t < hit.t) {
            hit.t = found->hit.t;
            hit.light = static_cast<std::int32_t>(i);
            hit.front = found->hit.front;
        }
    }
    if (std::isinf(hit.t))
        return std::nullopt;
    return hit;
}

Blocker WhittedScene::findBlocker(const Ray& ray, RayInterval interval, CsgScratch& scratch,
                                  TraversalCounts* counts) const {
    if (const auto hit = accelerator_->nearest(ray, interval, counts))
        return {Blocker::Kind::triangle, hit->triangle};
    for (std::size_t i = 0; i < solids_.size(); ++i)
        if (!isGlass_[i] && boxes_[i].mayBeMet(ray, static_cast<double>(interval.tMax)) &&
            solids_[i].occluded(ray, interval, scratch))
            return {Blocker::Kind::solid, static_cast<std::uint32_t>(i)};
    return {};
}

bool WhittedScene::blocks(Blocker blocker, const Ray& ray, RayInterval interval, CsgScratch& scratch) const {
    switch (blocker.kind) {
        case Blocker::Kind::none:
            return false;
        case Blocker::Kind::triangle:
            return intersectTriangle(ray, triangle(blocker.index), Sides::both, interval).has_value();
        case Blocker::Kind::solid:
            return solids_[blocker.index].occluded(ray, interval, scratch);
    }
    return false;
}

glm::vec3 WhittedScene::throughGlass(const Ray& ray, CsgScratch& scratch) const {
    glm::vec3 left(1);
    const double length = glm::length(glm::dvec3(ray.direction));
    for (std::size_t i = 0; i < solids_.size(); ++i) {
        if (!isGlass_[i] || !boxes_[i].mayBeMet(ray, 1))
            continue;
        const std::span<const CsgCrossing> crossings = solids_[i].crossings(ray, scratch);
        for (std::size_t k = 0; k < crossings.size(); k += 2) {
            const double enter = std::max(crossings[k].t, 0.0);
            const double leave = std::min(crossings[k + 1].t, 1.0);
            if (enter >= leave)
                continue;
            const WhittedMaterial& glass = contents_.materials[solids_[i].material(crossings[k].leaf)];
            const float surfaces = static_cast<float>((crossings[k].t > 0) + (crossings[k + 1].t < 1));
            left *= std::pow(1 - normalReflectance(glass.ior), surfaces) *
                    glm::exp(-glass.absorption * static_cast<float>((leave - enter) * length));
        }
    }
    return left;
}

glm::vec3 WhittedScene::sky(glm::vec3 direction) const {
    const float height = glm::clamp(direction.y / glm::length(direction), -1.0f, 1.0f);
    if (height < 0)
        return glm::mix(contents_.skyHorizon, contents_.skyNadir, std::sqrt(-height));
    return glm::mix(contents_.skyHorizon, contents_.skyZenith, std::sqrt(height));
}

glm::vec3 leaveSurface(glm::vec3 point, glm::vec3 pointError, glm::dvec3 normal, glm::dvec3 direction) {
    const glm::dvec3 out = glm::dot(normal, direction) < 0 ? -normal : normal;
    // Twice: once to reach the surface, once for the normal's rounding and this sum's.
    const double height = 2 * glm::dot(glm::abs(out), glm::dvec3(pointError));
    glm::vec3 origin(glm::dvec3(point) + height * out);
    for (int axis = 0; axis < 3; ++axis)
        if (out[axis] != 0)
            origin[axis] = std::nextafter(
                origin[axis],
                static_cast<float>(std::copysign(std::numeric_limits<float>::infinity(), out[axis])));
    return origin;
}

glm::vec3 leaveSurfaceNaive(glm::vec3 point, glm::vec3 normal, glm::vec3 direction, float epsilon) {
    return point + (glm::dot(normal, direction) < 0 ? -epsilon : epsilon) * normal;
}

}  // namespace quincunx

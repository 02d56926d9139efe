#include "passes/frame_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/check.h"
#include "math/projection.h"
#include "math/transform.h"
#include "math/vector.h"
#include "passes/material.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Of the magnitudes that a sum is made of: see SceneBounds::look.
constexpr double slack = 0x1p-21;

using Box = AnchoredBox;

Box boxOf(const glm::mat4& anchoredFromModel, const glm::dvec3& centre, const glm::dvec3& half) {
    Box box;
    for (int row = 0; row < 3; ++row) {
        double c = anchoredFromModel[3][row];
        double h = 0;
        double magnitude = std::abs(c);
        for (int column = 0; column < 3; ++column) {
            const double m = anchoredFromModel[column][row];
            c += m * centre[column];
            h += std::abs(m) * half[column];
            magnitude += std::abs(m) * (std::abs(centre[column]) + half[column]);
        }
        box.centre[row] = c;
        box.half[row] = h + slack * magnitude;
    }
    return box;
}

/// What a light can do to a box.
class Reach {
  public:
    Reach(const Light& light, const glm::vec3& anchor)
        : light_(light), position_(glm::dvec3(light.position) - glm::dvec3(anchor)) {
        const double direction = glm::length(glm::dvec3(light.direction));
        direction_ = direction > 0 ? glm::dvec3(light.direction) / direction : glm::dvec3(0);
        // The shader compares cosines: off by 2^-22, which is an angle of 2^-10.5 at the axis, and less
        // farther from it.
        const double angle = light.outerConeRadians + 0x1p-10;
        cone_ = light.kind == Light::Kind::spot && angle < std::numbers::pi / 2 && direction > 0;
        sine_ = std::sin(angle);
        cosine_ = std::cos(angle);
    }

    const glm::dvec3& position() const { return position_; }

    /// False where the light is exactly 0 throughout the box.
    bool mayLight(const Box& box) const {
        if (light_.kind == Light::Kind::directional)
            return true;
        const glm::dvec3 v = box.centre - position_;
        const double radius = glm::length(box.half);
        if (cone_) {
            // A ball around the box, against the plane that touches the cone on its side.
            const double along = glm::dot(v, direction_);
            const double across = std::sqrt(std::max(glm::dot(v, v) - along * along, 0.0));
            const double rounding = slack * (glm::length(v) + radius);
            if (across * cosine_ - along * sine_ > radius + rounding)
                return false;
        }
        return !endsBefore(box);
    }
    /// What the light's end lets through: nothing beyond its range.
    bool endsBefore(const Box& box) const {
        return light_.kind != Light::Kind::directional && light_.range > 0 &&
               nearest(box) > (1 + slack) * light_.range;
    }
    double nearest(const Box& box) const {
        return glm::length(glm::max(glm::abs(box.centre - position_) - box.half, glm::dvec3(0)));
    }
    double farthest(const Box& box) const { return glm::length(glm::abs(box.centre - position_) + box.half); }

  private:
    const Light& light_;
    glm::dvec3 position_;
    glm::dvec3 direction_{0};
    bool cone_ = false;
    double sine_ = 0;
    double cosine_ = 1;
};

/// A range of boxes in some frame.
struct Span {
    glm::dvec3 min{infinity};
    glm::dvec3 max{-infinity};

    void add(const glm::dvec3& centre, const glm::dvec3& half) {
        min = glm::min(min, centre - half);
        max = glm::max(max, centre + half);
    }
};

bool isSame(const glm::mat4& a, const glm::mat4& b) {
    return std::memcmp(&a, &b, sizeof(glm::mat4)) == 0;
}

bool isSame(const Camera& a, const Camera& b) {
    return isSame(a.worldFromCamera, b.worldFromCamera) && a.fovYRadians == b.fovYRadians;
}

glm::mat4 clipFromAnchored(const Camera& camera, float aspect, const glm::vec3& anchor) {
    return glm::mat4(
        glm::dmat4(perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance)) *
        glm::dmat4(cameraFromWorld(relativeTo(anchor, camera.worldFromCamera))));
}

/// The largest share of a light that may arrive in a box, for choosing the strongest lights.
double strengthAt(const Light& light, const Reach& reach, const Box& box) {
    const glm::vec3 radiance = light.color * light.intensity;
    const double power = std::max({radiance.r, radiance.g, radiance.b});
    if (light.kind == Light::Kind::directional)
        return power;
    const double distance = std::max(reach.nearest(box), 1e-3 * glm::length(box.half));
    return power / std::max(distance * distance, std::numeric_limits<double>::min());
}

/// What an instance is to light.
struct Placed {
    bool casts = false;  ///< there is something to draw, and it does not blend
    bool flat = false;
};

/// What of a light the visible instances get, and which instances stand in its way.
LightReach reachOf(const Light& light, std::size_t index, const Reach& reach, const std::vector<Box>& boxes,
                   const std::vector<Placed>& placed, const std::vector<std::uint32_t>& receivers) {
    LightReach result;
    result.light = index;
    result.receivers = receivers.size();
    const bool directional = light.kind == Light::Kind::directional;
    const bool oriented = light.kind == Light::Kind::point || normalize(light.direction).has_value();
    if (receivers.empty() || !oriented)
        return result;
    const glm::dmat3 basis(directional ? glm::transpose(shadowBasis(light)) : glm::mat3(1));
    const auto inLight = [&](const Box& box) {
        Box turned{basis * box.centre, glm::dvec3(0)};
        for (int column = 0; column < 3; ++column)
            turned.half += glm::abs(basis[column]) * box.half[column];
        return turned;
    };
    Span receiving;
    double farthest = 0;
    for (const std::uint32_t i : receivers) {
        const Box& box = boxes[i];
        if (directional) {
            const Box turned = inLight(box);
            receiving.add(turned.centre, turned.half);
        } else {
            farthest = std::max(farthest, reach.farthest(box));
        }
    }
    // The way of a directional light is -z: what lies wholly beyond the last receiver shades nothing.
    const auto mayCast = [&](const Box& box, const Box& turned) {
        if (!directional)
            return reach.nearest(box) <= farthest && reach.mayLight(box);
        return !(turned.centre.x - turned.half.x > receiving.max.x ||
                 turned.centre.x + turned.half.x < receiving.min.x ||
                 turned.centre.y - turned.half.y > receiving.max.y ||
                 turned.centre.y + turned.half.y < receiving.min.y ||
                 turned.centre.z + turned.half.z < receiving.min.z);
    };
    const bool alone = receivers.size() == 1;
    Span casting;
    Span castingInWorld;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        if (!placed[i].casts)
            continue;
        const Box& box = boxes[i];
        const Box turned = directional ? inLight(box) : Box{};
        if (!mayCast(box, turned) || (placed[i].flat && alone && receivers.front() == i))
            continue;
        result.casters.push_back(static_cast<std::uint32_t>(i));
        castingInWorld.add(box.centre, box.half);
        if (directional)
            casting.add(turned.centre, turned.half);
    }
    if (result.casters.empty())
        return result;
    for (const std::uint32_t i : receivers) {
        const Box& box = boxes[i];
        const Box turned = directional ? inLight(box) : Box{};
        const bool meets = !directional || !(turned.centre.x - turned.half.x > casting.max.x ||
                                             turned.centre.x + turned.half.x < casting.min.x ||
                                             turned.centre.y - turned.half.y > casting.max.y ||
                                             turned.centre.y + turned.half.y < casting.min.y ||
                                             turned.centre.z - turned.half.z > casting.max.z);
        result.shadowed += meets ? 1 : 0;
    }
    result.extent.casters = {glm::vec3(castingInWorld.min), glm::vec3(castingInWorld.max)};
    result.extent.castersMin = casting.min;
    result.extent.castersMax = casting.max;
    result.extent.receiversMin = receiving.min;
    result.extent.receiversMax = receiving.max;
    return result;
}

}  // namespace

ViewPlanes::ViewPlanes(const glm::mat4& clipFromAnchored, Kind kind) : count_(kind == Kind::all ? 6 : 4) {
    const glm::dmat4 clip(clipFromAnchored);
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const double sign = side == 0 ? 1 : -1;
            Plane& plane = planes_[static_cast<std::size_t>(2 * axis + side)];
            for (int column = 0; column < 3; ++column) {
                plane.normal[column] = clip[column][3] + sign * clip[column][axis];
                plane.magnitude[column] = std::abs(clip[column][3]) + std::abs(clip[column][axis]);
            }
            plane.offset = clip[3][3] + sign * clip[3][axis];
            plane.offsetMagnitude = std::abs(clip[3][3]) + std::abs(clip[3][axis]);
        }
}

bool ViewPlanes::mayMeet(const AnchoredBox& box) const {
    return std::none_of(
        planes_.begin(), planes_.begin() + static_cast<std::ptrdiff_t>(count_), [&](const Plane& plane) {
            const double reach = glm::dot(glm::abs(plane.normal), box.half);
            const double value = glm::dot(plane.normal, box.centre) + plane.offset + reach;
            const double magnitude =
                glm::dot(plane.magnitude, glm::abs(box.centre) + box.half) + plane.offsetMagnitude;
            return value < -slack * magnitude;
        });
}

SceneBounds::SceneBounds(const Scene& scene) {
    meshes_.reserve(scene.meshes.size());
    for (const Mesh& mesh : scene.meshes) {
        const Bounds bounds = mesh.bounds();
        MeshBounds entry;
        entry.empty = mesh.triangleCount() == 0 || bounds.empty();
        if (!entry.empty) {
            entry.centre = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
            entry.half = 0.5 * (glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
            entry.flat =
                bounds.min.x == bounds.max.x || bounds.min.y == bounds.max.y || bounds.min.z == bounds.max.z;
        }
        meshes_.push_back(entry);
    }
}

Visibility SceneBounds::look(const FrameView& view) const {
    const Scene& scene = view.scene;
    QX_CHECK_EQ(scene.meshes.size(), meshes_.size());
    QX_CHECK_EQ(view.worldFromModelAtOpen.size(), view.worldFromModelAtClose.size());
    const bool posed = !view.worldFromModelAtOpen.empty();
    if (posed)
        QX_CHECK_EQ(view.worldFromModelAtOpen.size(), scene.instances.size());
    const float aspect = static_cast<float>(view.width) / static_cast<float>(view.height);
    Visibility result;
    result.instances = scene.instances.size();
    result.anchorWorld = anchorOf(view.camera);
    const glm::vec3& anchor = result.anchorWorld;
    result.eyeAnchored = glm::vec3(relativeTo(anchor, view.camera.worldFromCamera)[3]);
    result.clipFromAnchored = clipFromAnchored(view.camera, aspect, anchor);
    const bool exposes = view.settings.shutterSeconds > 0;
    result.cameraMoves = exposes && !isSame(view.cameraAtOpen, view.cameraAtClose);

    const ViewPlanes planes(result.clipFromAnchored);
    const std::size_t count = scene.instances.size();
    std::vector<Placed> placed(count);
    std::vector<Box>& boxes = result.boxes;
    boxes.resize(count);
    const glm::dvec3 forward = -glm::dvec3(view.camera.worldFromCamera[2]);
    double nearest = infinity;
    double farthest = 0;
    std::vector<std::uint32_t> receivers;
    receivers.reserve(count);
    std::vector<std::uint32_t> blended;
    std::vector<double> distances;
    Span seen;
    for (std::size_t i = 0; i < count; ++i) {
        const Instance& instance = scene.instances[i];
        const MeshBounds& mesh = meshes_[instance.mesh];
        if (mesh.empty)
            continue;
        const Material& material = scene.materials[instance.material];
        const bool blends = material.alphaMode == Material::AlphaMode::blend;
        const bool mirrors = mirrorsSurroundings(material);
        const glm::mat4 anchored = relativeTo(anchor, instance.worldFromModel);
        const Box box = boxOf(anchored, mesh.centre, mesh.half);
        boxes[i] = box;
        placed[i] = {!blends, mesh.flat};
        result.surroundings.mirrors += mirrors ? 1 : 0;
        const bool visible = planes.mayMeet(box);
        const auto index = static_cast<std::uint32_t>(i);
        if (!visible && !view.settings.drawsUnseen)
            continue;
        if (blends) {
            const glm::dvec3 towards = box.centre - glm::dvec3(result.eyeAnchored);
            blended.push_back(index);
            distances.push_back(glm::dot(towards, towards));
        } else {
            result.solid.push_back(index);
            if (visible && exposes && posed &&
                !isSame(view.worldFromModelAtOpen[i], view.worldFromModelAtClose[i]))
                result.moving.push_back(index);
        }
        if (!visible)
            continue;
        result.surroundings.mirrorsInView += mirrors ? 1 : 0;
        receivers.push_back(index);
        const double distance = glm::dot(box.centre - glm::dvec3(result.eyeAnchored), forward);
        const double reach = glm::dot(glm::abs(forward), box.half);
        nearest = std::min(nearest, distance - reach);
        farthest = std::max(farthest, distance + reach);
        seen.add(box.centre, box.half);
    }
    result.blended.reserve(blended.size());
    for (const std::uint32_t i : farthestFirst(distances))
        result.blended.push_back(blended[i]);

    const auto near = static_cast<double>(view.camera.nearDistance);
    farthest = std::min(farthest, static_cast<double>(view.camera.farDistance));
    result.depths = {view.camera, aspect, std::max(nearest, near), farthest};
    result.depths.camera.worldFromCamera = relativeTo(anchor, view.camera.worldFromCamera);
    if (!(std::isfinite(farthest) && farthest > result.depths.nearest))
        result.depths.farthest = result.depths.nearest = near;

    // Which lights matter, the strongest if there are too many.
    const Box all{0.5 * (seen.min + seen.max), 0.5 * (seen.max - seen.min)};
    struct Candidate {
        std::size_t light;
        double strength;
    };
    std::vector<Candidate> candidates;
    std::vector<Reach> reaches;
    reaches.reserve(scene.lights.size());
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        reaches.emplace_back(light, anchor);
        const glm::vec3 radiance = light.color * light.intensity;
        const bool any = radiance != glm::vec3(0) &&
                         std::any_of(receivers.begin(), receivers.end(),
                                     [&](std::uint32_t i) { return reaches.back().mayLight(boxes[i]); });
        if (any)
            candidates.push_back({l, strengthAt(light, reaches.back(), all)});
        else
            ++result.lightsWithoutEffect;
    }
    if (candidates.size() > maxShaderLights) {
        result.lightsLeftOut = candidates.size() - maxShaderLights;
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const Candidate& a, const Candidate& b) { return a.strength > b.strength; });
        candidates.resize(maxShaderLights);
        std::sort(candidates.begin(), candidates.end(),
                  [](const Candidate& a, const Candidate& b) { return a.light < b.light; });
    }
    std::vector<std::uint32_t> lit;
    for (const Candidate& candidate : candidates) {
        const Reach& reach = reaches[candidate.light];
        lit.clear();
        for (const std::uint32_t i : receivers)
            if (reach.mayLight(boxes[i]))
                lit.push_back(i);
        result.lights.push_back(
            reachOf(scene.lights[candidate.light], candidate.light, reach, boxes, placed, lit));
    }
    if (result.surroundings.mirrorsInView > 0)
        look(scene, result.surroundings);
    return result;
}

void SceneBounds::look(const Scene& scene, Surroundings& surroundings) const {
    struct Seen {
        Box box;
        std::uint32_t instance;
        bool blends;
    };
    std::vector<Seen> seen;
    Span mirrors;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const MeshBounds& mesh = meshes_[instance.mesh];
        if (mesh.empty)
            continue;
        const Material& material = scene.materials[instance.material];
        const Box box = boxOf(instance.worldFromModel, mesh.centre, mesh.half);
        if (mirrorsSurroundings(material))
            mirrors.add(box.centre, box.half);
        seen.push_back(
            {box, static_cast<std::uint32_t>(i), material.alphaMode == Material::AlphaMode::blend});
    }
    const glm::vec3 middle(0.5 * (mirrors.min + mirrors.max));
    surroundings.positionWorld = isFinite(middle) ? middle : glm::vec3(0);
    const glm::dvec3 position(surroundings.positionWorld);
    std::vector<double> distances;
    std::vector<std::uint32_t> blended;
    double farthest = 0;
    for (const Seen& object : seen) {
        const glm::dvec3 towards = object.box.centre - position;
        const glm::dvec3 outside = glm::abs(towards) - object.box.half;
        if (outside.x <= 0 && outside.y <= 0 && outside.z <= 0)
            continue;
        farthest = std::max(farthest, glm::length(glm::abs(towards) + object.box.half));
        if (object.blends) {
            blended.push_back(object.instance);
            distances.push_back(glm::dot(towards, towards));
        } else {
            surroundings.solid.push_back(object.instance);
        }
    }
    for (const std::uint32_t i : farthestFirst(distances))
        surroundings.blended.push_back(blended[i]);
    const auto reach = static_cast<float>(1.001 * farthest);
    surroundings.farDistance = std::isfinite(reach) && reach > 1e-6f ? reach : 1.0f;
    surroundings.nearDistance = 1e-4f * surroundings.farDistance;
    std::vector<double> strengths;
    for (const Light& light : scene.lights)
        strengths.push_back(strengthAt(light, Reach(light, glm::vec3(0)), {position, glm::dvec3(1)}));
    for (const std::uint32_t l : farthestFirst(strengths))
        if (surroundings.lights.size() < maxShaderLights)
            surroundings.lights.push_back(l);
    std::sort(surroundings.lights.begin(), surroundings.lights.end());
}

glm::vec3 anchorOf(const Camera& camera) {
    const glm::vec3 eye(camera.worldFromCamera[3]);
    int exponent = 0;
    if (!isFinite(eye) || !(camera.nearDistance > 0) || !std::isfinite(camera.nearDistance))
        return glm::vec3(0);
    std::frexp(512.0 * static_cast<double>(camera.nearDistance), &exponent);
    const double cell = std::ldexp(1.0, exponent);
    const glm::dvec3 anchor = glm::round(glm::dvec3(eye) / cell) * cell;
    // Multiples of a power of two near a float have no more digits than it; the nearest beyond the largest
    // float would not be one.
    const glm::vec3 rounded(anchor);
    return isFinite(rounded) ? rounded : glm::vec3(0);
}

glm::mat4 relativeTo(const glm::vec3& anchorWorld, const glm::mat4& worldFromModel) {
    glm::mat4 relative = worldFromModel;
    for (int axis = 0; axis < 3; ++axis)
        relative[3][axis] -= anchorWorld[axis];
    return relative;
}

std::vector<std::uint32_t> farthestFirst(std::span<const double> distances) {
    std::vector<std::uint32_t> order(distances.size());
    std::iota(order.begin(), order.end(), 0u);
    // NaN is below every number: then this is a strict weak order over all of them.
    const auto key = [&](std::uint32_t i) { return std::isnan(distances[i]) ? -infinity : distances[i]; };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) > key(b); });
    return order;
}

}  // namespace quincunx

#include "scene/animation.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "math/rotation_interpolation.h"
#include "math/vector.h"
#include "scene/placement.h"

namespace quincunx {

namespace {

using Interpolation = Animation::Interpolation;
using Path = Animation::Path;

/// Which nodes are moved, by a channel of their own or of one above.
std::vector<bool> movedNodes(const Scene& scene) {
    std::vector<bool> moved(scene.nodes.size(), false);
    for (const Animation& animation : scene.animations)
        for (const Animation::Channel& channel : animation.channels) {
            QX_CHECK_LT(channel.node, moved.size());
            moved[channel.node] = true;
        }
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        if (const std::size_t parent = scene.nodes[i].parent; parent != Node::noParent) {
            QX_CHECK_LT(parent, i);
            if (moved[parent])
                moved[i] = true;
        }
    return moved;
}

glm::dvec4 betweenRotations(const glm::vec4& a, const glm::vec4& b, double share) {
    const glm::quat from(a.w, a.x, a.y, a.z);
    const glm::quat to(b.w, b.x, b.y, b.z);
    const std::optional<glm::quat> between = slerp(from, to, static_cast<float>(share));
    return between ? glm::dvec4(between->x, between->y, between->z, between->w) : glm::dvec4(a);
}

/// The cubic Hermite spline of glTF 2.0, appendix C.5.
glm::dvec4 hermite(const glm::dvec4& value, const glm::dvec4& tangent, const glm::dvec4& nextTangent,
                   const glm::dvec4& nextValue, double t, double seconds) {
    const double t2 = t * t;
    const double t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * value + seconds * (t3 - 2 * t2 + t) * tangent +
           (3 * t2 - 2 * t3) * nextValue + seconds * (t3 - t2) * nextTangent;
}

glm::dvec4 sample(const Animation::Sampler& sampler, bool isRotation, double seconds) {
    const bool isCubic = sampler.interpolation == Interpolation::cubicSpline;
    const std::size_t stride = isCubic ? 3 : 1;
    const std::vector<float>& keys = sampler.seconds;
    QX_CHECK(!keys.empty());
    QX_CHECK_EQ(sampler.values.size(), stride * keys.size());
    const auto value = [&](std::size_t key) { return sampler.values[stride * key + (isCubic ? 1 : 0)]; };
    const auto after = static_cast<std::size_t>(
        std::upper_bound(keys.begin(), keys.end(), seconds,
                         [](double time, float key) { return time < static_cast<double>(key); }) -
        keys.begin());
    if (after == 0)
        return glm::dvec4(value(0));
    const std::size_t before = after - 1;
    if (after == keys.size() || sampler.interpolation == Interpolation::step)
        return glm::dvec4(value(before));
    const double length = static_cast<double>(keys[after]) - static_cast<double>(keys[before]);
    const double share = (seconds - static_cast<double>(keys[before])) / length;
    if (isCubic) {
        const glm::dvec4 result =
            hermite(glm::dvec4(value(before)), glm::dvec4(sampler.values[3 * before + 2]),
                    glm::dvec4(sampler.values[3 * after]), glm::dvec4(value(after)), share, length);
        // Opposite keys meet half-way in no rotation.
        return isRotation && result == glm::dvec4(0) ? glm::dvec4(value(before)) : result;
    }
    if (isRotation)
        return betweenRotations(value(before), value(after), share);
    return (1 - share) * glm::dvec4(value(before)) + share * glm::dvec4(value(after));
}

struct Frame {
    glm::dvec3 translation;
    glm::dvec4 rotation;
    glm::dvec3 scale;
};

void place(Scene& scene, const Attachment& attachment, const glm::dmat4& worldFromThing) {
    const bool isFinite = isFiniteAsFloat(worldFromThing);
    switch (attachment.thing) {
        case Attachment::Thing::instance: {
            QX_CHECK_LT(attachment.index, scene.instances.size());
            glm::mat4 nowhere(0);
            nowhere[3][3] = 1;
            scene.instances[attachment.index].worldFromModel = isFinite ? glm::mat4(worldFromThing) : nowhere;
            break;
        }
        case Attachment::Thing::light: {
            QX_CHECK_LT(attachment.index, scene.lights.size());
            Light& light = scene.lights[attachment.index];
            light.position = isFinite ? glm::vec3(glm::dvec3(worldFromThing[3])) : glm::vec3(0);
            light.direction =
                (isFinite ? viewDirection(worldFromThing) : std::nullopt).value_or(glm::vec3(0, 0, -1));
            break;
        }
        case Attachment::Thing::camera: {
            QX_CHECK_LT(attachment.index, scene.cameras.size());
            std::optional<glm::mat4> frame = cameraFrame(worldFromThing);
            if (!frame) {
                frame = glm::mat4(1);
                if (isFinite) {
                    if (const auto axes = basisAround(glm::dvec3(worldFromThing[2])))
                        frame = glm::mat4(glm::dmat4(*axes));
                    (*frame)[3] = glm::vec4(worldFromThing[3]);
                }
            }
            scene.cameras[attachment.index].worldFromCamera = *frame;
            break;
        }
    }
}

/// Places what hangs from the nodes, `parent_from_node` of which are `frames`.
void placeAll(Scene& scene, std::vector<glm::dmat4> frames) {
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (const std::size_t parent = scene.nodes[i].parent; parent != Node::noParent) {
            QX_CHECK_LT(parent, i);
            frames[i] = frames[parent] * frames[i];
        }
    for (const Attachment& attachment : scene.attachments) {
        QX_CHECK_LT(attachment.node, frames.size());
        place(scene, attachment, frames[attachment.node] * glm::dmat4(attachment.nodeFromThing));
    }
}

}  // namespace

bool isAnimated(const Scene& scene) {
    if (scene.attachments.empty() || scene.animations.empty())
        return false;
    const std::vector<bool> moved = movedNodes(scene);
    return std::any_of(scene.attachments.begin(), scene.attachments.end(), [&](const Attachment& attachment) {
        QX_CHECK_LT(attachment.node, moved.size());
        return moved[attachment.node];
    });
}

double animationSeconds(const Scene& scene) {
    double last = 0;
    for (const Animation& animation : scene.animations)
        for (const Animation::Channel& channel : animation.channels) {
            QX_CHECK_LT(channel.sampler, animation.samplers.size());
            const std::vector<float>& keys = animation.samplers[channel.sampler].seconds;
            QX_CHECK(!keys.empty());
            last = std::max(last, static_cast<double>(keys.back()));
        }
    return last;
}

void pose(Scene& scene, double seconds) {
    if (!isAnimated(scene))
        return;
    const double round = animationSeconds(scene);
    double time = round > 0 && std::isfinite(seconds) ? std::fmod(seconds, round) : 0;
    if (time < 0)
        time += round;

    std::vector<Frame> moving(scene.nodes.size());
    for (std::size_t i = 0; i < moving.size(); ++i) {
        const Node& node = scene.nodes[i];
        const glm::quat& q = node.rotation;
        moving[i] = {glm::dvec3(node.translation), glm::dvec4(q.x, q.y, q.z, q.w), glm::dvec3(node.scale)};
    }
    for (const Animation& animation : scene.animations)
        for (const Animation::Channel& channel : animation.channels) {
            const glm::dvec4 value =
                sample(animation.samplers[channel.sampler], channel.path == Path::rotation, time);
            Frame& frame = moving[channel.node];
            switch (channel.path) {
                case Path::translation:
                    frame.translation = glm::dvec3(value);
                    break;
                case Path::rotation:
                    frame.rotation = value;
                    break;
                case Path::scale:
                    frame.scale = glm::dvec3(value);
                    break;
            }
        }
    std::vector<glm::dmat4> frames(scene.nodes.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const Node& node = scene.nodes[i];
        frames[i] = node.matrix ? glm::dmat4(*node.matrix)
                                : composedFrame(moving[i].translation, moving[i].rotation, moving[i].scale);
    }
    placeAll(scene, std::move(frames));
}

void poseAtRest(Scene& scene) {
    std::vector<glm::dmat4> frames(scene.nodes.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
        frames[i] = restFrame(scene.nodes[i]);
    placeAll(scene, std::move(frames));
}

}  // namespace quincunx

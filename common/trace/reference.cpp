#include "trace/reference.h"

#include <cmath>
#include <limits>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/check.h"
#include "trace/texture_lookup.h"

namespace quincunx {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

double power(double base, double exponent) {
    return exponent == 0 ? 1 : std::pow(base, exponent);
}

double highlight(const dvec3& n, const dvec3& l, const dvec3& v, double shininess,
                 PhongModel::Reflection reflection) {
    const double cosine = glm::dot(n, l);
    if (cosine <= 0)
        return 0;
    if (reflection == PhongModel::Reflection::phong)
        return power(std::max(0.0, glm::dot(2 * cosine * n - l, v)), shininess);
    const dvec3 sum = l + v;
    const double length = glm::length(sum);
    return length > 0 ? power(std::max(0.0, glm::dot(n, sum / length)), shininess) : 0;
}

/// Unit vector towards the light, and the share of color · intensity that arrives.
struct Arriving {
    dvec3 direction;
    double strength;
};

Arriving arrivingLight(const Light& light, const dvec3& position) {
    if (light.kind == Light::Kind::directional)
        return {glm::normalize(-dvec3(light.direction)), 1};
    const dvec3 towards = dvec3(light.position) - position;
    const double distance = glm::length(towards);
    if (distance == 0)
        return {dvec3(0), 0};
    Arriving arriving{towards / distance, 1 / (distance * distance)};
    if (light.range > 0)
        arriving.strength *= std::max(0.0, 1 - std::pow(distance / static_cast<double>(light.range), 4));
    if (light.kind == Light::Kind::spot) {
        const double cosine = glm::dot(-arriving.direction, glm::normalize(dvec3(light.direction)));
        const double cosOuter = std::cos(static_cast<double>(light.outerConeRadians));
        const double cosInner =
            std::cos(static_cast<double>(std::min(light.innerConeRadians, light.outerConeRadians)));
        if (cosine <= cosOuter && cosine < cosInner)
            arriving.strength = 0;
        else if (cosine < cosInner) {
            const double share = (cosine - cosOuter) / (cosInner - cosOuter);
            arriving.strength *= share * share * (3 - 2 * share);
        }
    }
    return arriving;
}

/// What of a light reaches a point past everything else.
bool reaches(const TraceScene& scene, const SurfacePoint& point, const Light& light) {
    if (light.kind != Light::Kind::directional)
        return scene.visible(point, light.position);
    return !scene.occluded(TraceScene::leave(point, -light.direction));
}

/// A point that is seen, and the side of it.
struct Seen {
    SurfacePoint point;
    dvec3 normal{0};  ///< unit length, on the side that is seen
};

dvec3 shade(const TraceScene& scene, const Seen& seen, const dvec3& eye, const PhongModel& model) {
    const Material& material = scene.scene().materials[seen.point.material];
    dvec3 base(1);
    if (const std::optional<TextureUse>& use = material.baseColorTexture)
        base = dvec3(lookUp(scene.scene().textures[use->texture],
                            glm::vec2(use->textureFromTexcoord * glm::vec3(seen.point.texcoord, 1))));
    dvec3 sum(0);
    if (model.emission)
        sum += dvec3(material.emission);
    if (model.ambient)
        sum += dvec3(material.ambient) * dvec3(scene.scene().ambientLight) * base;
    if (!model.diffuse && !model.specular)
        return sum;
    const dvec3 position(seen.point.position);
    const dvec3 v = glm::normalize(eye - position);
    for (const Light& light : scene.scene().lights) {
        const auto [l, strength] = arrivingLight(light, position);
        if (model.shadows && glm::dot(seen.normal, l) > 0 && !reaches(scene, seen.point, light))
            continue;
        dvec3 reflected(0);
        if (model.diffuse)
            reflected += dvec3(material.diffuse) * base * std::max(0.0, glm::dot(seen.normal, l));
        if (model.specular)
            reflected +=
                dvec3(material.specular) *
                highlight(seen.normal, l, v, static_cast<double>(material.shininess), model.reflection);
        sum += dvec3(light.color) * (static_cast<double>(light.intensity) * strength) * reflected;
    }
    return sum;
}

/// What OpenGL would draw where the ray goes.
std::optional<Seen> firstSeen(const TraceScene& scene, const Ray& ray, RayInterval interval) {
    const std::optional<SurfacePoint> point = nearestDrawn(scene, ray, interval);
    if (!point)
        return {};
    const bool solid = point->instance >= scene.scene().instances.size();
    const dvec3 normal = glm::normalize(dvec3(point->shadingNormal));
    return Seen{*point, point->front || solid ? normal : -normal};
}

/// Calls `write(x, y, seen)` for every pixel, with what the ray through its centre meets first, or nothing.
/// Pixels are seen in any order, on many threads; rows that `stop` forestalls not at all.
template <typename Write>
void lookThroughPixels(const TraceScene& scene, const Camera& camera, int width, int height,
                       const std::atomic<bool>* stop, const Write& write) {
    QX_CHECK_GT(width, 0);
    QX_CHECK_GT(height, 0);
    // Directions have depth 1 along the view, so that a ray's t is the depth that near and far are planes of.
    const double halfHeight = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const double halfWidth = halfHeight * width / height;
    const dmat3 worldFromCamera(camera.worldFromCamera);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    const RayInterval depths{camera.nearDistance, camera.farDistance};
    tbb::parallel_for(tbb::blocked_range<int>(0, height), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            if (stop && stop->load(std::memory_order_relaxed))
                return;
            for (int x = 0; x < width; ++x) {
                const dvec3 direction(((2 * x + 1.0) / width - 1) * halfWidth,
                                      (1 - (2 * y + 1.0) / height) * halfHeight, -1);
                write(x, y, firstSeen(scene, {eye, glm::vec3(worldFromCamera * direction)}, depths));
            }
        }
    });
}

}  // namespace

Image traceReference(const TraceScene& scene, const Camera& camera, int width, int height,
                     const PhongModel& model, const std::atomic<bool>* stop) {
    const dvec3 eye(camera.worldFromCamera[3]);
    Image image(width, height, 4, Encoding::linear);
    lookThroughPixels(scene, camera, width, height, stop, [&](int x, int y, const std::optional<Seen>& seen) {
        const dvec3 color = seen ? shade(scene, *seen, eye, model)
                                 : glm::mix(dvec3(scene.scene().backgroundBottom),
                                            dvec3(scene.scene().backgroundTop), (height - y - 0.5) / height);
        float* const pixel = image.pixel(x, y);
        for (int channel = 0; channel < 3; ++channel)
            pixel[channel] = static_cast<float>(color[channel]);
        pixel[3] = 1;
    });
    return image;
}

Image traceLitMask(const TraceScene& scene, const Camera& camera, int width, int height, std::size_t light,
                   const std::atomic<bool>* stop) {
    QX_CHECK_LT(light, scene.scene().lights.size());
    const Light& source = scene.scene().lights[light];
    Image image(width, height, 1, Encoding::linear);
    lookThroughPixels(scene, camera, width, height, stop, [&](int x, int y, const std::optional<Seen>& seen) {
        float& lit = *image.pixel(x, y);
        if (!seen) {
            lit = -1;
            return;
        }
        const Arriving arriving = arrivingLight(source, dvec3(seen->point.position));
        lit = arriving.strength > 0 && glm::dot(seen->normal, arriving.direction) > 0 &&
                      reaches(scene, seen->point, source)
                  ? 1.0f
                  : 0.0f;
    });
    return image;
}

StillLife placedBy(StillLife stillLife, const glm::mat4& worldFromWorld) {
    for (StillLife::Object& object : stillLife.objects)
        object.worldFromModel = glm::mat4(dmat4(worldFromWorld) * dmat4(object.worldFromModel));
    return stillLife;
}

Scene placedBy(Scene scene, const glm::mat4& worldFromWorld) {
    for (Instance& instance : scene.instances)
        instance.worldFromModel = glm::mat4(dmat4(worldFromWorld) * dmat4(instance.worldFromModel));
    return scene;
}

}  // namespace quincunx

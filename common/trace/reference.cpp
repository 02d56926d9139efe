#include "trace/reference.h"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/check.h"
#include "geometry/shapes.h"

namespace quincunx {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

/// An object ready for rays from one camera.
struct Placed {
    Solid solid;
    const Material* material;
    dmat4 worldFromModel;
    dmat3 modelFromWorld;   ///< of directions
    dmat3 normalFromModel;  ///< cofactors, with the sign that keeps normals pointing out of the solid
    dmat3 modelFromCamera;  ///< of directions
    dvec3 eye;              ///< model space
};

dmat3 cofactors(const dmat3& m) {
    return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

std::optional<Placed> place(const StillLife::Object& object, const dmat4& worldFromWorld,
                            const dmat4& worldFromCamera) {
    const dmat4 worldFromModel = worldFromWorld * dmat4(object.worldFromModel);
    const dmat3 linear(worldFromModel);
    const dmat3 cofactor = cofactors(linear);
    const double determinant = glm::dot(linear[0], cofactor[0]);
    if (!(std::abs(determinant) > 0) || !std::isfinite(determinant))
        return {};
    const dmat3 modelFromWorld = glm::transpose(cofactor) / determinant;
    Placed placed{.solid = Solid(object.shape),
                  .material = &object.material,
                  .worldFromModel = worldFromModel,
                  .modelFromWorld = modelFromWorld,
                  .normalFromModel = determinant > 0 ? cofactor : -cofactor,
                  .modelFromCamera = modelFromWorld * dmat3(worldFromCamera),
                  .eye = modelFromWorld * dvec3(worldFromCamera[3] - worldFromModel[3])};
    return placed;
}

/// False only if the ray is certain to miss the ball around the solid: the discriminant's rounding errors are
/// below 32 ε |origin|² |direction|².
bool mayMeet(const Placed& placed, const dvec3& origin, const dvec3& direction) {
    const dvec3 m = origin - dvec3(0, placed.solid.boundingCentreY(), 0);
    const double mm = glm::dot(m, m);
    const double md = glm::dot(m, direction);
    const double dd = glm::dot(direction, direction);
    const double radius = placed.solid.boundingRadius();
    return md * md - (mm - radius * radius) * dd >= -0x1p-48 * (mm + radius * radius) * dd;
}

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

/// What rays to the lights start above the surface, as a share of the distance to the world's origin and the
/// size of the solids: hits are off by some 1e-13 of these.
constexpr double liftOff = 1e-9;

bool isOccluded(const std::vector<Placed>& placed, const dvec3& position, const dvec3& normal,
                const Light& light) {
    const bool endless = light.kind == Light::Kind::directional;
    double size = glm::length(position);
    for (const Placed& object : placed)
        size = std::max(size, object.solid.size() * glm::length(object.worldFromModel[0]));
    const dvec3 from = position + liftOff * size * normal;
    const dvec3 direction = endless ? -glm::normalize(dvec3(light.direction)) : dvec3(light.position) - from;
    for (const Placed& object : placed) {
        const dvec3 origin = object.modelFromWorld * (from - dvec3(object.worldFromModel[3]));
        const dvec3 modelDirection = object.modelFromWorld * direction;
        if (!mayMeet(object, origin, modelDirection))
            continue;
        const std::optional<Hit> hit = object.solid.intersect({origin, modelDirection});
        if (hit && (endless || hit->t < 1))
            return true;
    }
    return false;
}

dvec3 shade(const StillLife& scene, const std::vector<Placed>& placed, const Material& material,
            const dvec3& position, const dvec3& normal, const dvec3& eye, const PhongModel& model) {
    dvec3 sum(0);
    if (model.emission)
        sum += dvec3(material.emission);
    if (model.ambient)
        sum += dvec3(material.ambient) * dvec3(scene.ambientLight);
    if (!model.diffuse && !model.specular)
        return sum;
    const dvec3 v = glm::normalize(eye - position);
    for (const Light& light : scene.lights) {
        const auto [l, strength] = arrivingLight(light, position);
        if (model.shadows && glm::dot(normal, l) > 0 && isOccluded(placed, position, normal, light))
            continue;
        dvec3 reflected(0);
        if (model.diffuse)
            reflected += dvec3(material.diffuse) * std::max(0.0, glm::dot(normal, l));
        if (model.specular)
            reflected += dvec3(material.specular) *
                         highlight(normal, l, v, static_cast<double>(material.shininess), model.reflection);
        sum += dvec3(light.color) * (static_cast<double>(light.intensity) * strength) * reflected;
    }
    return sum;
}

/// A surface point in the world.
struct Seen {
    const Placed* object = nullptr;
    dvec3 position;
    dvec3 normal;  ///< unit length
};

std::vector<Placed> placeAll(const StillLife& scene, const dmat4& worldFromWorld,
                             const dmat4& worldFromCamera) {
    std::vector<Placed> placed;
    for (const StillLife::Object& object : scene.objects)
        if (std::optional<Placed> ready = place(object, worldFromWorld, worldFromCamera))
            placed.push_back(std::move(*ready));
    return placed;
}

/// Calls `write(x, y, seen)` for every pixel, with what the ray through its centre meets first, or nothing.
/// Pixels are seen in any order, on many threads; rows that `stop` forestalls not at all.
template <typename Write>
void lookThroughPixels(const std::vector<Placed>& placed, const Camera& camera, int width, int height,
                       const std::atomic<bool>* stop, const Write& write) {
    // Directions have depth 1 along the view, so that a ray's t is the depth that near and far are planes of.
    const double halfHeight = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const double halfWidth = halfHeight * width / height;
    const double near = camera.nearDistance;
    const double far = camera.farDistance;
    const auto look = [&](int x, int y) {
        const dvec3 direction(((2 * x + 1.0) / width - 1) * halfWidth,
                              (1 - (2 * y + 1.0) / height) * halfHeight, -1);
        const Placed* nearest = nullptr;
        Hit nearestHit;
        nearestHit.t = far - near;
        for (const Placed& object : placed) {
            const dvec3 modelDirection = object.modelFromCamera * direction;
            if (!mayMeet(object, object.eye, modelDirection))
                continue;
            const std::optional<Hit> hit =
                object.solid.intersect({object.eye + near * modelDirection, modelDirection});
            if (hit && hit->t < nearestHit.t) {
                nearestHit = *hit;
                nearest = &object;
            }
        }
        if (nearest == nullptr)
            return write(x, y, std::optional<Seen>());
        return write(
            x, y,
            std::optional<Seen>({nearest, dvec3(nearest->worldFromModel * dvec4(nearestHit.position, 1)),
                                 glm::normalize(nearest->normalFromModel * nearestHit.normal)}));
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, height), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            if (stop && stop->load(std::memory_order_relaxed))
                return;
            for (int x = 0; x < width; ++x)
                look(x, y);
        }
    });
}

}  // namespace

Image traceReference(const StillLife& scene, const Camera& camera, int width, int height,
                     const PhongModel& model, const glm::mat4& worldFromWorld,
                     const std::atomic<bool>* stop) {
    QX_CHECK_GT(width, 0);
    QX_CHECK_GT(height, 0);
    const dmat4 worldFromCamera(camera.worldFromCamera);
    const dvec3 eye(worldFromCamera[3]);
    const std::vector<Placed> placed = placeAll(scene, dmat4(worldFromWorld), worldFromCamera);
    Image image(width, height, 4, Encoding::linear);
    lookThroughPixels(
        placed, camera, width, height, stop, [&](int x, int y, const std::optional<Seen>& seen) {
            const dvec3 color =
                seen ? shade(scene, placed, *seen->object->material, seen->position, seen->normal, eye, model)
                     : glm::mix(dvec3(scene.backgroundBottom), dvec3(scene.backgroundTop),
                                (height - y - 0.5) / height);
            float* const pixel = image.pixel(x, y);
            for (int channel = 0; channel < 3; ++channel)
                pixel[channel] = static_cast<float>(color[channel]);
            pixel[3] = 1;
        });
    return image;
}

Image traceLitMask(const StillLife& scene, const Camera& camera, int width, int height, std::size_t light,
                   const std::atomic<bool>* stop) {
    QX_CHECK_GT(width, 0);
    QX_CHECK_GT(height, 0);
    QX_CHECK_LT(light, scene.lights.size());
    const Light& source = scene.lights[light];
    const std::vector<Placed> placed = placeAll(scene, dmat4(1), dmat4(camera.worldFromCamera));
    Image image(width, height, 1, Encoding::linear);
    lookThroughPixels(placed, camera, width, height, stop,
                      [&](int x, int y, const std::optional<Seen>& seen) {
                          float& lit = *image.pixel(x, y);
                          if (!seen) {
                              lit = -1;
                              return;
                          }
                          const Arriving arriving = arrivingLight(source, seen->position);
                          lit = arriving.strength > 0 && glm::dot(seen->normal, arriving.direction) > 0 &&
                                        !isOccluded(placed, seen->position, seen->normal, source)
                                    ? 1.0f
                                    : 0.0f;
                      });
    return image;
}

}  // namespace quincunx

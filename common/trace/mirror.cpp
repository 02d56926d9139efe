#include "trace/mirror.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/check.h"
#include "trace/trace_scene.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::dvec4;

/// All but the mirrors: tiles as triangles, solids in closed form.
TraceScene mattScene(const MirrorHall& hall) {
    MirrorHall flat = hall;
    flat.contents.objects.clear();
    constexpr int unused = 3;  // segments: there is nothing round left
    Scene scene = tessellate(flat, unused);
    std::vector<TracedSolid> solids;
    for (const StillLife::Object& object : hall.contents.objects) {
        solids.push_back({object.shape, scene.materials.size(), object.worldFromModel});
        scene.materials.push_back(object.material);
    }
    return TraceScene(std::move(scene), std::move(solids));
}

/// The mirrors; the tints are the materials' `specular`. The ball is known by its being a solid.
TraceScene mirrorScene(const MirrorHall& hall, MirrorsSeen mirrors) {
    constexpr int unused = 3;
    Scene scene = tessellateMirrors(hall, false, mirrors.panel, unused);
    std::vector<TracedSolid> solids;
    if (mirrors.ball) {
        solids.push_back({Sphere{hall.ball.radius}, scene.materials.size(),
                          glm::translate(glm::mat4(1), hall.ball.centre)});
        scene.materials.emplace_back().specular = hall.ballTint;
    }
    return TraceScene(std::move(scene), std::move(solids));
}

/// A hall ready for rays.
class Tracer {
  public:
    explicit Tracer(const MirrorHall& hall, MirrorsSeen mirrors = {false, false})
        : matt_(mattScene(hall)), mirrors_(mirrorScene(hall, mirrors)) {}

    /// What a ray sees that meets no mirror.
    dvec3 traceMatt(const Ray& ray) const {
        const std::optional<SurfacePoint> point = nearestDrawn(matt_, ray);
        return point ? shade(*point) : dvec3(0);
    }

    /// The first thing along a ray that is not a mirror.
    std::optional<SurfacePoint> mattAlong(const Ray& ray) const { return nearestDrawn(matt_, ray); }

    /// What a mirror that is in front of all else does to a ray.
    struct Bounce {
        int mirror = 0;  ///< 1 the ball, 2 the panel
        dvec3 tint{0};
        dvec3 direction{0};  ///< unit length
        Ray ray;
    };
    std::optional<Bounce> bounce(const Ray& ray) const {
        const std::optional<SurfacePoint> mirror = nearestDrawn(mirrors_, ray);
        if (!mirror)
            return {};
        if (const auto matt = nearestDrawn(matt_, ray); matt && matt->t <= mirror->t)
            return {};
        Bounce found;
        found.mirror = mirror->instance >= mirrors_.scene().instances.size() ? 1 : 2;
        found.tint = dvec3(mirrors_.scene().materials[mirror->material].specular);
        const dvec3 normal = glm::normalize(dvec3(mirror->geometricNormal));
        const dvec3 direction(ray.direction);
        found.direction = glm::normalize(direction - 2 * glm::dot(normal, direction) * normal);
        found.ray = TraceScene::leave(*mirror, glm::vec3(found.direction));
        return found;
    }

    /// What a ray sees that mirrors turn once.
    dvec3 traceMirror(const Ray& ray) const {
        const std::optional<Bounce> turned = bounce(ray);
        return turned ? turned->tint * traceMatt(turned->ray) : traceMatt(ray);
    }

  private:
    dvec3 shade(const SurfacePoint& point) const {
        const Scene& scene = matt_.scene();
        const Material& material = scene.materials[point.material];
        const dvec3 normal = glm::normalize(dvec3(point.geometricNormal));
        dvec3 sum = dvec3(material.emission) + dvec3(material.ambient) * dvec3(scene.ambientLight);
        for (const Light& light : scene.lights) {
            QX_CHECK(light.kind == Light::Kind::point);
            const dvec3 towards = dvec3(light.position) - dvec3(point.position);
            const double distance = glm::length(towards);
            if (distance == 0)
                continue;
            const double cosine = std::max(0.0, glm::dot(normal, towards) / distance);
            sum += dvec3(material.diffuse) * dvec3(light.color) *
                   (static_cast<double>(light.intensity) * cosine / (distance * distance));
        }
        return sum;
    }

    TraceScene matt_;
    TraceScene mirrors_;
};

/// The ray through the centre of a pixel.
Ray centreRay(const Camera& camera, int width, int height, int x, int y) {
    return cameraRay(camera, width, height, glm::vec2(x, y) + 0.5f);
}

template <typename Look>
Image look(int width, int height, const std::atomic<bool>* stop, const Look& write) {
    QX_CHECK_GT(width, 0);
    QX_CHECK_GT(height, 0);
    Image image(width, height, 4, Encoding::linear);
    tbb::parallel_for(tbb::blocked_range<int>(0, height), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            if (stop != nullptr && stop->load(std::memory_order_relaxed))
                return;
            for (int x = 0; x < width; ++x) {
                const dvec4 value = write(x, y);
                for (int c = 0; c < 4; ++c)
                    image.pixel(x, y)[c] = static_cast<float>(value[c]);
            }
        }
    });
    return image;
}

}  // namespace

Image traceMirrors(const MirrorHall& hall, const Camera& camera, int width, int height, MirrorsSeen mirrors,
                   const std::atomic<bool>* stop) {
    const Tracer tracer(hall, mirrors);
    return look(width, height, stop, [&](int x, int y) {
        return dvec4(tracer.traceMirror(centreRay(camera, width, height, x, y)), 1);
    });
}

Image traceReflectionVectors(const MirrorHall& hall, const Camera& camera, int width, int height,
                             MirrorsSeen mirrors) {
    const Tracer tracer(hall, mirrors);
    return look(width, height, nullptr, [&](int x, int y) {
        const auto turned = tracer.bounce(centreRay(camera, width, height, x, y));
        return turned ? dvec4(turned->direction, turned->mirror) : dvec4(0);
    });
}

Image traceLookupAngles(const MirrorHall& hall, const Camera& camera, int width, int height,
                        glm::vec3 mapPosition, MirrorsSeen mirrors) {
    const Tracer tracer(hall, mirrors);
    return look(width, height, nullptr, [&](int x, int y) {
        const auto turned = tracer.bounce(centreRay(camera, width, height, x, y));
        if (!turned)
            return dvec4(0);
        const std::optional<SurfacePoint> met = tracer.mattAlong(turned->ray);
        if (!met)
            return dvec4(0, 0, 0, turned->mirror);
        const dvec3 seen = dvec3(met->position) - dvec3(mapPosition);
        const double angle =
            std::atan2(glm::length(glm::cross(seen, turned->direction)), glm::dot(seen, turned->direction));
        return dvec4(angle, 0, 0, turned->mirror);
    });
}

Image tracePanorama(const MirrorHall& hall, glm::vec3 position, int width, int height, int samples,
                    const std::atomic<bool>* stop) {
    QX_CHECK_GE(samples, 1);
    const Tracer tracer(hall);
    return look(width, height, stop, [&](int x, int y) {
        dvec3 sum(0);
        for (int j = 0; j < samples; ++j)
            for (int i = 0; i < samples; ++i) {
                const double around = 2 * std::numbers::pi * ((x + (i + 0.5) / samples) / width - 0.5);
                const double down = std::numbers::pi * (y + (j + 0.5) / samples) / height;
                const dvec3 direction(std::sin(down) * std::cos(around), std::cos(down),
                                      std::sin(down) * std::sin(around));
                sum += tracer.traceMatt({position, glm::vec3(direction)});
            }
        return dvec4(sum / static_cast<double>(samples * samples), 1);
    });
}

}  // namespace quincunx

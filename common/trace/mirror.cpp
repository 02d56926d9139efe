#include "trace/mirror.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
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
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

struct PlacedSolid {
    Solid solid;
    const Material* material;
    dmat4 worldFromModel;
    dmat4 modelFromWorld;
};

struct PlacedTiling {
    const Tiling* tiling;
    dvec3 corner;
    dvec3 edgeU;
    dvec3 edgeV;
    dvec3 normal;  ///< unit length
};

/// Where a ray meets something, and what is there.
struct Met {
    double t = std::numeric_limits<double>::infinity();
    const Material* material = nullptr;
    dvec3 normal{0};
};

PlacedTiling place(const Tiling& tiling) {
    const dvec3 u(tiling.edgeU);
    const dvec3 v(tiling.edgeV);
    return {&tiling, dvec3(tiling.corner), u, v, glm::normalize(glm::cross(u, v))};
}

/// The distance along the ray to the front of a rectangle, and where on it, as shares of its edges.
std::optional<std::pair<double, dvec2>> meet(const PlacedTiling& placed, const DRay& ray) {
    const double facing = glm::dot(placed.normal, ray.direction);
    if (!(facing < 0))
        return {};
    const double t = glm::dot(placed.normal, placed.corner - ray.origin) / facing;
    if (!(t >= 0))
        return {};
    const dvec3 from = ray.origin + t * ray.direction - placed.corner;
    const dvec2 share(glm::dot(from, placed.edgeU) / glm::dot(placed.edgeU, placed.edgeU),
                      glm::dot(from, placed.edgeV) / glm::dot(placed.edgeV, placed.edgeV));
    if (share.x < 0 || share.x > 1 || share.y < 0 || share.y > 1)
        return {};
    return std::pair(t, share);
}

/// A hall ready for rays.
class Tracer {
  public:
    explicit Tracer(const MirrorHall& hall)
        : hall_(hall), panel_(place(hall.panel)), ball_(Sphere{hall.ball.radius}) {
        for (const StillLife::Object& object : hall.contents.objects) {
            const dmat4 worldFromModel(object.worldFromModel);
            solids_.push_back(
                {Solid(object.shape), &object.material, worldFromModel, glm::inverse(worldFromModel)});
        }
        for (const Tiling& tiling : hall.tilings)
            tilings_.push_back(place(tiling));
    }

    /// What a ray sees that meets no mirror.
    dvec3 traceMatt(const DRay& ray) const {
        const Met met = nearest(ray);
        return met.material != nullptr ? shade(met, ray.origin + met.t * ray.direction) : dvec3(0);
    }

    /// How far along a ray the first thing lies that is not a mirror.
    std::optional<double> distanceAlong(const DRay& ray) const {
        const Met met = nearest(ray);
        return met.material != nullptr ? std::optional(met.t) : std::nullopt;
    }

    /// What a mirror that is in front of all else does to a ray.
    struct Bounce {
        int mirror = 0;  ///< 1 the ball, 2 the panel
        dvec3 tint;
        DRay ray;
    };
    std::optional<Bounce> bounce(const DRay& ray, MirrorsSeen mirrors) const {
        Bounce found;
        double t = nearest(ray).t;
        dvec3 normal(0);
        if (mirrors.ball) {
            const std::optional<Hit> hit =
                ball_.intersect({ray.origin - dvec3(hall_.ball.centre), ray.direction});
            if (hit && hit->t < t) {
                t = hit->t;
                normal = hit->normal;
                found.mirror = 1;
                found.tint = dvec3(hall_.ballTint);
            }
        }
        if (mirrors.panel) {
            const auto hit = meet(panel_, ray);
            if (hit && hit->first < t) {
                t = hit->first;
                normal = panel_.normal;
                found.mirror = 2;
                found.tint = dvec3(hall_.panelTint);
            }
        }
        if (found.mirror == 0)
            return {};
        found.ray = {ray.origin + t * ray.direction,
                     ray.direction - 2 * glm::dot(normal, ray.direction) * normal};
        return found;
    }

    /// What a ray sees that mirrors turn once.
    dvec3 traceMirror(const DRay& ray, MirrorsSeen mirrors) const {
        const std::optional<Bounce> turned = bounce(ray, mirrors);
        return turned ? turned->tint * traceMatt(turned->ray) : traceMatt(ray);
    }

  private:
    Met nearest(const DRay& ray) const {
        Met met;
        for (const PlacedTiling& placed : tilings_) {
            const auto hit = meet(placed, ray);
            if (!hit || hit->first >= met.t)
                continue;
            const Tiling& tiling = *placed.tiling;
            const int i = std::min(static_cast<int>(hit->second.x * tiling.countU), tiling.countU - 1);
            const int j = std::min(static_cast<int>(hit->second.y * tiling.countV), tiling.countV - 1);
            met = {hit->first, (i + j) % 2 == 0 ? &tiling.even : &tiling.odd, placed.normal};
        }
        for (const PlacedSolid& placed : solids_) {
            const DRay modelRay{dvec3(placed.modelFromWorld * dvec4(ray.origin, 1)),
                                dmat3(placed.modelFromWorld) * ray.direction};
            if (!mayMeet(placed.solid, modelRay))
                continue;
            const std::optional<Hit> hit = placed.solid.intersect(modelRay);
            if (hit && hit->t < met.t)
                met = {hit->t, placed.material,
                       glm::normalize(glm::transpose(dmat3(placed.modelFromWorld)) * hit->normal)};
        }
        return met;
    }

    /// False only if the ray is certain to miss the ball around the solid: the discriminant's rounding errors
    /// are below 32 ε |origin|² |direction|².
    static bool mayMeet(const Solid& solid, const DRay& ray) {
        const dvec3 m = ray.origin - dvec3(0, solid.boundingCentreY(), 0);
        const double mm = glm::dot(m, m);
        const double md = glm::dot(m, ray.direction);
        const double dd = glm::dot(ray.direction, ray.direction);
        const double radius = solid.boundingRadius();
        return md * md - (mm - radius * radius) * dd >= -0x1p-48 * (mm + radius * radius) * dd;
    }

    dvec3 shade(const Met& met, dvec3 position) const {
        const Material& material = *met.material;
        dvec3 sum = dvec3(material.emission) + dvec3(material.ambient) * dvec3(hall_.contents.ambientLight);
        for (const Light& light : hall_.contents.lights) {
            QX_CHECK(light.kind == Light::Kind::point);
            const dvec3 towards = dvec3(light.position) - position;
            const double distance = glm::length(towards);
            if (distance == 0)
                continue;
            const double cosine = std::max(0.0, glm::dot(met.normal, towards) / distance);
            sum += dvec3(material.diffuse) * dvec3(light.color) *
                   (static_cast<double>(light.intensity) * cosine / (distance * distance));
        }
        return sum;
    }

    const MirrorHall& hall_;
    PlacedTiling panel_;
    Solid ball_;
    std::vector<PlacedSolid> solids_;
    std::vector<PlacedTiling> tilings_;
};

/// The ray through the centre of a pixel.
class Eye {
  public:
    Eye(const Camera& camera, int width, int height)
        : worldFromCamera_(camera.worldFromCamera), width_(width), height_(height) {
        halfHeight_ = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
        halfWidth_ = halfHeight_ * width / height;
    }
    DRay ray(int x, int y) const {
        const dvec3 direction(((2 * x + 1.0) / width_ - 1) * halfWidth_,
                              (1 - (2 * y + 1.0) / height_) * halfHeight_, -1);
        return {dvec3(worldFromCamera_[3]), glm::normalize(dmat3(worldFromCamera_) * direction)};
    }

  private:
    dmat4 worldFromCamera_;
    int width_;
    int height_;
    double halfHeight_ = 0;
    double halfWidth_ = 0;
};

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
    const Tracer tracer(hall);
    const Eye eye(camera, width, height);
    return look(width, height, stop,
                [&](int x, int y) { return dvec4(tracer.traceMirror(eye.ray(x, y), mirrors), 1); });
}

Image traceReflectionVectors(const MirrorHall& hall, const Camera& camera, int width, int height,
                             MirrorsSeen mirrors) {
    const Tracer tracer(hall);
    const Eye eye(camera, width, height);
    return look(width, height, nullptr, [&](int x, int y) {
        const auto turned = tracer.bounce(eye.ray(x, y), mirrors);
        return turned ? dvec4(turned->ray.direction, turned->mirror) : dvec4(0);
    });
}

Image traceLookupAngles(const MirrorHall& hall, const Camera& camera, int width, int height,
                        glm::vec3 mapPosition, MirrorsSeen mirrors) {
    const Tracer tracer(hall);
    const Eye eye(camera, width, height);
    return look(width, height, nullptr, [&](int x, int y) {
        const auto turned = tracer.bounce(eye.ray(x, y), mirrors);
        if (!turned)
            return dvec4(0);
        const std::optional<double> t = tracer.distanceAlong(turned->ray);
        if (!t)
            return dvec4(0, 0, 0, turned->mirror);
        const dvec3 seen = turned->ray.origin + *t * turned->ray.direction - dvec3(mapPosition);
        const double angle = std::atan2(glm::length(glm::cross(seen, turned->ray.direction)),
                                        glm::dot(seen, turned->ray.direction));
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
                sum += tracer.traceMatt(
                    {dvec3(position),
                     {std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around)}});
            }
        return dvec4(sum / static_cast<double>(samples * samples), 1);
    });
}

}  // namespace quincunx

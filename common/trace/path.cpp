#include "trace/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "base/check.h"
#include "math/vector.h"
#include "trace/brdf_glsl.h"
#include "trace/light_sampling.h"
#include "trace/sampling.h"

namespace quincunx {
namespace {

float largest(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}

/// Whether a path goes on; its weight grows by what the paths that end here would have brought. Always draws
/// a number, so that a path's later ones are for the same things as its neighbours'.
bool goesOn(glm::vec3& weight, float squeeze, const PathLimits& limits, PathSampler& sampler) {
    const float u = sampler.next();
    const float w = squeeze * largest(weight);
    if (!(w > limits.cutoff))
        return false;
    if (w >= limits.rouletteThreshold)
        return true;
    // A multiple of 2^-24, as u is: the path survives with just this probability.
    const float survival = std::ceil(w / limits.rouletteThreshold * 0x1p24f) * 0x1p-24f;
    if (u >= survival)
        return false;
    weight /= survival;
    return true;
}

void countRay(PathCounts* counts, std::size_t level) {
    if (counts != nullptr)
        ++counts->raysAtLevel[std::min(level, PathCounts::levels - 1)];
}

TraversalCounts* traversalOf(PathCounts* counts) {
    return counts != nullptr ? &counts->traversal : nullptr;
}

/// Whether directions lie on the sides of the true surface that their sides of the shading one say.
bool sidesAgree(const PathVertex& vertex, glm::vec3 wiLocal, glm::vec3 wi) {
    const glm::vec3 n = vertex.point.geometricNormal;
    const glm::vec3 wo = vertex.worldFromLocal * vertex.wo;
    return (wiLocal.z * vertex.wo.z > 0) == (glm::dot(n, wi) * glm::dot(n, wo) > 0);
}

}  // namespace

std::uint64_t PathCounts::rays() const {
    std::uint64_t sum = shadowRays;
    for (const std::uint64_t count : raysAtLevel)
        sum += count;
    return sum;
}

PathCounts& PathCounts::operator+=(const PathCounts& other) {
    for (std::size_t i = 0; i < levels; ++i)
        raysAtLevel[i] += other.raysAtLevel[i];
    shadowRays += other.shadowRays;
    traversal += other.traversal;
    return *this;
}

namespace {

Bsdf scatteringOf(const SurfaceValues& values, OpaqueModel model) {
    const glm::vec3 color = glm::min(glm::vec3(values.baseColor), glm::vec3(1));
    if (model != OpaqueModel::metallicRoughness && values.transmission < 0.5f && values.metallic < 1) {
        if (model == OpaqueModel::lambert)
            return Lambert{color};
        const glm::vec3 diffuse = glm::min(values.diffuse, glm::vec3(1));
        const glm::vec3 specular = glm::min(values.specular, glm::vec3(1) - diffuse);
        if (model == OpaqueModel::phong)
            return PhongBsdf{diffuse, specular, values.shininess};
        return BlinnPhongBsdf{diffuse, specular, values.shininess};
    }
    return bsdfOf({.baseColor = color,
                   .metallic = values.metallic,
                   .roughness = values.roughness,
                   .transmission = values.transmission,
                   .ior = values.ior});
}

}  // namespace

std::optional<PathVertex> meet(const PathScene& scene, const Ray& ray, PathSampler* sampler,
                               PathCounts* counts) {
    const TraceScene& surfaces = scene.scene();
    std::optional<SurfacePoint> met = surfaces.nearest(ray, {}, traversalOf(counts));
    if (!met)
        return {};
    SurfaceValues values = surfaces.valuesAt(*met);
    if (surfaces.blends() && sampler != nullptr)
        for (float cover = 1; (cover = surfaces.coverAt(*met, values)) < 1 && sampler->next() >= cover;) {
            met = surfaces.nearest(TraceScene::leave(*met, ray.direction), {}, traversalOf(counts));
            if (!met)
                return {};
            values = surfaces.valuesAt(*met);
        }
    PathVertex vertex;
    vertex.point = *met;
    const Material& material = surfaces.scene().materials[met->material];
    vertex.bsdf = scatteringOf(values, scene.model());
    if (met->front || material.doubleSided)
        vertex.emitted = values.emission;
    const glm::vec3 back = -ray.direction;
    glm::vec3 normal = met->shadingNormal;
    // Interpolated normals may have turned away from the eye where the surface has not.
    if ((glm::dot(normal, back) > 0) != met->front)
        normal = met->geometricNormal;
    if (!met->front && !std::holds_alternative<Dielectric>(vertex.bsdf))
        normal = -normal;
    glm::vec3 tangent = met->tangent;
    if (normal != met->shadingNormal && normal != -met->shadingNormal)
        tangent = normalizeOr(
            glm::cross(normal, std::abs(normal.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)),
            glm::vec3(1, 0, 0));
    vertex.worldFromLocal = {tangent, glm::cross(normal, tangent), normal};
    vertex.wo = vertex.toLocal(back);
    // What rounding has laid below the horizon.
    if (vertex.wo.z == 0)
        vertex.wo.z = 0x1p-24f;
    return vertex;
}

std::optional<Scattered> scatter(const PathVertex& vertex, PathSampler& sampler) {
    const float choice = sampler.next();
    const std::optional<BsdfSample> drawn = sample(vertex.bsdf, vertex.wo, choice, sampler.next2());
    if (!drawn)
        return {};
    const glm::vec3 wi = vertex.worldFromLocal * drawn->wi;
    if (!sidesAgree(vertex, drawn->wi, wi))
        return {};
    float squeeze = 1;
    if (const auto* const glass = std::get_if<Dielectric>(&vertex.bsdf);
        glass != nullptr && drawn->wi.z * vertex.wo.z < 0)
        squeeze = vertex.wo.z > 0 ? glass->ior * glass->ior : 1 / (glass->ior * glass->ior);
    return Scattered{TraceScene::leave(vertex.point, wi), drawn->weight, drawn->density, drawn->delta,
                     squeeze};
}

std::optional<DirectLight> drawDirectLight(const PathScene& scene, const PathVertex& vertex,
                                           PathSampler& sampler, PathCounts* counts) {
    const float choice = sampler.next();
    const std::optional<LightDraw> draw =
        scene.lights().draw(scene.scene(), vertex.point, choice, sampler.next2());
    if (!draw)
        return {};
    const glm::vec3 wi = vertex.toLocal(draw->wi);
    const glm::vec3 f = evaluate(vertex.bsdf, vertex.wo, wi);
    DirectLight direct;
    direct.light = f * std::abs(wi.z) * draw->weight;
    if (!(largest(direct.light) > 0) || !sidesAgree(vertex, wi, draw->wi))
        return {};
    direct.lightDensity = draw->density;
    direct.bsdfDensity = density(vertex.bsdf, vertex.wo, wi);
    if (counts != nullptr)
        ++counts->shadowRays;
    const TraceScene& surfaces = scene.scene();
    const float clear = draw->endless ? surfaces.clearShareAlong(vertex.point, draw->wi, traversalOf(counts))
                        : draw->delta ? surfaces.clearShare(vertex.point, draw->from, traversalOf(counts))
                                      : surfaces.clearShare(vertex.point, draw->end, traversalOf(counts));
    if (clear == 0)
        return {};
    direct.light *= clear;
    return direct;
}

glm::vec3 tracePathNaive(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits,
                         PathCounts* counts) {
    glm::vec3 radiance(0);
    glm::vec3 weight(1);
    float squeeze = 1;
    for (int bounce = 0;; ++bounce) {
        countRay(counts, static_cast<std::size_t>(bounce));
        const std::optional<PathVertex> vertex = meet(scene, ray, &sampler, counts);
        if (!vertex)
            return radiance + weight * scene.lights().environment(ray.direction);
        radiance += weight * vertex->emitted;
        if (bounce == limits.maxBounces)
            return radiance;
        const std::optional<Scattered> next = scatter(*vertex, sampler);
        if (!next)
            return radiance;
        weight *= next->weight;
        squeeze *= next->squeeze;
        if (!goesOn(weight, squeeze, limits, sampler))
            return radiance;
        ray = next->ray;
    }
}

glm::vec3 tracePathNee(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits,
                       PathCounts* counts) {
    glm::vec3 radiance(0);
    glm::vec3 weight(1);
    float squeeze = 1;
    std::optional<SurfacePoint> from;  // where a shadow ray was shot last
    for (int bounce = 0;; ++bounce) {
        countRay(counts, static_cast<std::size_t>(bounce));
        const std::optional<PathVertex> vertex = meet(scene, ray, &sampler, counts);
        if (!vertex) {
            if (!from || scene.lights().density(ray.direction) == 0)
                radiance += weight * scene.lights().environment(ray.direction);
            return radiance;
        }
        if (!from || scene.lights().density(*from, vertex->point) == 0)
            radiance += weight * vertex->emitted;
        if (bounce == limits.maxBounces)
            return radiance;
        if (const std::optional<DirectLight> direct = drawDirectLight(scene, *vertex, sampler, counts))
            radiance += weight * direct->light;
        const std::optional<Scattered> next = scatter(*vertex, sampler);
        if (!next)
            return radiance;
        weight *= next->weight;
        squeeze *= next->squeeze;
        if (!goesOn(weight, squeeze, limits, sampler))
            return radiance;
        ray = next->ray;
        // No shadow ray finds a light by a mirror or through smooth glass.
        from = next->delta ? std::nullopt : std::optional(vertex->point);
    }
}

glm::vec3 tracePathMis(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits,
                       PathCounts* counts) {
    glm::vec3 radiance(0);
    glm::vec3 weight(1);
    float squeeze = 1;
    std::optional<SurfacePoint> from;  // where both ways were taken last …
    float density = 0;                 // … and that of the way that was gone
    for (int bounce = 0;; ++bounce) {
        countRay(counts, static_cast<std::size_t>(bounce));
        const std::optional<PathVertex> vertex = meet(scene, ray, &sampler, counts);
        if (!vertex) {
            const float share = from ? powerHeuristic(density, scene.lights().density(ray.direction)) : 1.0f;
            return radiance + weight * share * scene.lights().environment(ray.direction);
        }
        if (vertex->emitted != glm::vec3(0)) {
            const float share =
                from ? powerHeuristic(density, scene.lights().density(*from, vertex->point)) : 1.0f;
            radiance += weight * share * vertex->emitted;
        }
        if (bounce == limits.maxBounces)
            return radiance;
        if (const std::optional<DirectLight> direct = drawDirectLight(scene, *vertex, sampler, counts)) {
            // Lights without extent are found in this way alone.
            const float share =
                direct->lightDensity > 0 ? powerHeuristic(direct->lightDensity, direct->bsdfDensity) : 1.0f;
            radiance += weight * share * direct->light;
        }
        const std::optional<Scattered> next = scatter(*vertex, sampler);
        if (!next)
            return radiance;
        weight *= next->weight;
        squeeze *= next->squeeze;
        if (!goesOn(weight, squeeze, limits, sampler))
            return radiance;
        ray = next->ray;
        from = next->delta ? std::nullopt : std::optional(vertex->point);
        density = next->density;
    }
}

namespace {

glm::vec3 traceBranch(const PathScene& scene, const Ray& ray, const std::optional<SurfacePoint>& from,
                      PathSampler& sampler, int branches, int level, const PathLimits& limits,
                      PathCounts* counts) {
    countRay(counts, static_cast<std::size_t>(level));
    const std::optional<PathVertex> vertex = meet(scene, ray, &sampler, counts);
    if (!vertex)
        return !from || scene.lights().density(ray.direction) == 0 ? scene.lights().environment(ray.direction)
                                                                   : glm::vec3(0);
    glm::vec3 radiance(0);
    if (!from || scene.lights().density(*from, vertex->point) == 0)
        radiance += vertex->emitted;
    if (level == limits.maxBounces)
        return radiance;
    glm::vec3 arriving(0);
    for (int i = 0; i < branches; ++i) {
        if (const std::optional<DirectLight> direct = drawDirectLight(scene, *vertex, sampler, counts))
            arriving += direct->light;
        if (const std::optional<Scattered> next = scatter(*vertex, sampler))
            arriving += next->weight * traceBranch(scene, next->ray,
                                                   next->delta ? std::nullopt : std::optional(vertex->point),
                                                   sampler, branches, level + 1, limits, counts);
    }
    return radiance + arriving / static_cast<float>(branches);
}

}  // namespace

glm::vec3 traceTree(const PathScene& scene, const Ray& ray, PathSampler& sampler, int branches,
                    const PathLimits& limits, PathCounts* counts) {
    QX_CHECK_GE(branches, 1);
    return traceBranch(scene, ray, {}, sampler, branches, 0, limits, counts);
}

glm::vec3 tracePath(PathMethod method, const PathScene& scene, const Ray& ray, PathSampler& sampler,
                    const PathLimits& limits, PathCounts* counts) {
    switch (method) {
        case PathMethod::naive:
            return tracePathNaive(scene, ray, sampler, limits, counts);
        case PathMethod::nee:
            return tracePathNee(scene, ray, sampler, limits, counts);
        case PathMethod::mis:
            break;
    }
    return tracePathMis(scene, ray, sampler, limits, counts);
}

void TermEstimate::Mean::add(glm::dvec3 value) {
    ++count_;
    const glm::dvec3 off = value - mean_;
    mean_ += off / count_;
    squares_ += off * (value - mean_);
}

glm::vec3 TermEstimate::Mean::error() const {
    return count_ < 2 ? glm::vec3(std::numeric_limits<float>::infinity())
                      : glm::vec3(glm::sqrt(squares_ / (count_ * (count_ - 1))));
}

TermEstimate::TermEstimate(const PathScene& scene, const Ray& ray, std::uint64_t seed,
                           const PathLimits& limits)
    : scene_(scene),
      vertex_(meet(scene, ray)),
      beyond_(vertex_ ? glm::vec3(0) : scene.lights().environment(ray.direction)),
      seed_(seed),
      limits_(limits) {}

void TermEstimate::add(int samples) {
    QX_CHECK_GE(samples, 0);
    QX_CHECK_LE(samples, std::numeric_limits<int>::max() - samples_);
    const int end = samples_ + samples;
    for (; samples_ < end && vertex_; ++samples_) {
        PathSampler sampler(0, static_cast<std::uint32_t>(samples_), seed_);
        glm::vec3 straight(0);
        glm::vec3 around(0);
        if (const std::optional<DirectLight> light = drawDirectLight(scene_, *vertex_, sampler))
            straight +=
                light->light *
                (light->lightDensity > 0 ? powerHeuristic(light->lightDensity, light->bsdfDensity) : 1.0f);
        if (const std::optional<Scattered> next = scatter(*vertex_, sampler)) {
            // By the numbers that the path below begins with: it meets the same.
            PathSampler again = sampler;
            const std::optional<PathVertex> met = meet(scene_, next->ray, &again);
            const glm::vec3 shining = met ? met->emitted : scene_.lights().environment(next->ray.direction);
            const float drawn = met ? scene_.lights().density(vertex_->point, met->point)
                                    : scene_.lights().density(next->ray.direction);
            straight += next->weight * shining * (next->delta ? 1.0f : powerHeuristic(next->density, drawn));
            if (met)
                around += next->weight * (tracePathMis(scene_, next->ray, sampler, limits_) - met->emitted);
        }
        direct_.add(straight);
        indirect_.add(around);
    }
    samples_ = end;
}

EquationTerms TermEstimate::terms() const {
    EquationTerms terms;
    if (!vertex_) {
        terms.direct = beyond_;
        return terms;
    }
    terms.emitted = vertex_->emitted;
    terms.direct = direct_.mean();
    terms.indirect = indirect_.mean();
    terms.directError = direct_.error();
    terms.indirectError = indirect_.error();
    return terms;
}

EquationTerms estimateTerms(const PathScene& scene, const Ray& ray, int samples, std::uint64_t seed,
                            const PathLimits& limits) {
    QX_CHECK_GE(samples, 2);
    TermEstimate estimate(scene, ray, seed, limits);
    estimate.add(samples);
    return estimate.terms();
}

std::optional<glm::vec3> traceDirect(const TraceScene& traced, const Ray& ray) {
    const std::optional<SurfacePoint> point = traced.nearest(ray);
    if (!point)
        return {};
    const Scene& scene = traced.scene();
    const Material& material = scene.materials[point->material];
    const SurfaceValues values = traced.valuesAt(*point);
    const glm::vec3 color(values.baseColor);
    const glsl::MicrofacetSurface surface = glsl::metallicRoughness(color, values.metallic, values.roughness);
    const glm::vec3 n = material.doubleSided && !point->front ? -point->shadingNormal : point->shadingNormal;
    const glm::vec3 wo = normalizeOr(-ray.direction, n);
    glm::vec3 radiance = values.emission + scene.ambientLight * color * values.occlusion;
    for (const Light& light : scene.lights) {
        const LightArrival incoming = arriveFrom(light, point->position);
        if (!(incoming.strength > 0) || !(glm::dot(n, incoming.wi) > 0))
            continue;
        const bool lit = light.kind == Light::Kind::directional
                             ? !traced.occluded(TraceScene::leave(*point, incoming.wi))
                             : traced.visible(*point, light.position);
        if (lit)
            radiance += light.color * light.intensity * incoming.strength *
                        glsl::microfacetShare(surface, n, incoming.wi, wo);
    }
    return glm::min(radiance, glm::vec3(65504));
}

}  // namespace quincunx

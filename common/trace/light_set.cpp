#include "trace/light_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "geometry/normals.h"
#include "geometry/ray_shapes.h"
#include "math/vector.h"
#include "trace/environment_glsl.h"
#include "trace/light_sampling.h"

namespace quincunx {
namespace {

using glm::dvec3;

constexpr float pi = std::numbers::pi_v<float>;
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

float luminance(glm::vec3 c) {
    return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

/// Finite, 0 at least, and small enough for sums.
float sane(float value) {
    return value > 0 ? std::min(value, 1e18f) : 0;
}

/// The brightest that a material shines, on average: a texture counts with the mean of its texels.
glm::vec3 meanEmission(const Scene& scene, const Material& material) {
    glm::vec3 emission(sane(material.emission.r), sane(material.emission.g), sane(material.emission.b));
    if (!material.emissionTexture || emission == glm::vec3(0))
        return emission;
    const Image8& image = scene.textures[material.emissionTexture->texture].image;
    if (image.pixelCount() == 0)
        return emission;
    // Codes, not light: it is only for the share of rays that a light gets.
    double sum = 0;
    for (const std::uint8_t code : image.data)
        sum += code;
    return emission * static_cast<float>(sum / (255.0 * static_cast<double>(image.data.size())) + 1e-3);
}

/// The ball that a solid is in the world, if it is one.
struct WorldBall {
    dvec3 centre;
    double radius;
};
std::optional<WorldBall> worldBall(const TracedSolid& solid) {
    const Sphere* const sphere = std::get_if<Sphere>(&solid.shape);
    if (sphere == nullptr)
        return {};
    const glm::dmat3 m{glm::mat3(solid.worldFromModel)};
    const glm::dmat3 squared = glm::transpose(m) * m;
    const double scale = squared[0][0];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            // A rotation in float is orthogonal to a few roundings.
            if (std::abs(squared[i][j] - (i == j ? scale : 0)) > 0x1p-20 * scale)
                return {};
    return WorldBall{dvec3(solid.worldFromModel[3]), sphere->radius * std::sqrt(scale)};
}

/// What a surface sends out, less where it blends.
glm::vec3 shiningOf(const TraceScene& scene, const SurfacePoint& point) {
    const SurfaceValues values = scene.valuesAt(point);
    return scene.coverAt(point, values) * values.emission;
}

}  // namespace

LightSet::LightSet(const TraceScene& traced) {
    const Scene& scene = traced.scene();
    const Bounds bounds = traced.bounds();
    const float radius = bounds.radius();
    firstOfInstance_.assign(scene.instances.size() + traced.solids().size(), none);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Material& material = scene.materials[instance.material];
        const float emitted = luminance(meanEmission(scene, material));
        if (!(emitted > 0))
            continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        firstOfInstance_[i] = static_cast<std::uint32_t>(lightOfTriangle_.size());
        const bool mirrored = glm::determinant(glm::dmat3(instance.worldFromModel)) < 0;
        for (std::uint32_t triangle = 0; triangle < mesh.triangleCount(); ++triangle) {
            const auto corner = [&](std::size_t k) {
                return glm::vec3(glm::dmat4(instance.worldFromModel) *
                                 glm::dvec4(mesh.positions[mesh.indices[3 * triangle + k]], 1));
            };
            Shining light{.kind = Shining::Kind::triangle,
                          .bothSides = material.doubleSided,
                          .instance = i,
                          .triangle = triangle,
                          .a = corner(0),
                          .b = corner(1),
                          .c = corner(2)};
            light.area = static_cast<float>(0.5 * glm::length(glm::cross(dvec3(light.b) - dvec3(light.a),
                                                                         dvec3(light.c) - dvec3(light.a))));
            light.power = pi * light.area * emitted * (light.bothSides ? 2.0f : 1.0f);
            light.normal = glm::vec3(triangleNormal(light.a, light.b, light.c));
            if (mirrored)
                light.normal = -light.normal;
            const bool shines = light.power > 0 && std::isfinite(light.power);
            lightOfTriangle_.push_back(shines ? static_cast<std::uint32_t>(lights_.size()) : none);
            if (shines)
                lights_.push_back(light);
        }
    }
    for (std::uint32_t i = 0; i < traced.solids().size(); ++i) {
        const TracedSolid& solid = traced.solids()[i];
        const float emitted = luminance(meanEmission(scene, scene.materials[solid.material]));
        const std::optional<WorldBall> ball = worldBall(solid);
        if (!(emitted > 0) || !ball || !(ball->radius > 0))
            continue;
        Shining light{.kind = Shining::Kind::ball,
                      .instance = static_cast<std::uint32_t>(scene.instances.size()) + i,
                      .centre = ball->centre,
                      .radius = ball->radius};
        light.power = 4 * pi * pi * static_cast<float>(ball->radius * ball->radius) * emitted;
        if (!(light.power > 0) || !std::isfinite(light.power))
            continue;
        firstOfInstance_[light.instance] = static_cast<std::uint32_t>(lightOfTriangle_.size());
        lightOfTriangle_.push_back(static_cast<std::uint32_t>(lights_.size()));
        lights_.push_back(light);
    }
    for (std::uint32_t i = 0; i < scene.lights.size(); ++i) {
        const Light& source = scene.lights[i];
        Shining light{.kind = Shining::Kind::punctual, .index = i};
        const float strength = pi * sane(source.intensity) *
                               luminance({sane(source.color.r), sane(source.color.g), sane(source.color.b)});
        light.power = strength * (source.kind == Light::Kind::directional ? pi * radius * radius : 4 * pi);
        if (light.power > 0 && std::isfinite(light.power))
            lights_.push_back(light);
    }
    if (scene.environment && scene.environment->panorama.pixelCount() > 0)
        addEnvironment(*scene.environment, radius);
    if (lights_.empty())
        return;
    std::vector<float> powers;
    for (const Shining& light : lights_)
        powers.push_back(light.power);
    byPower_.emplace(powers);
}

void LightSet::addEnvironment(const Environment& environment, float sceneRadius) {
    const Image& source = environment.panorama;
    panorama_ = Image(source.width, source.height, 3, Encoding::linear);
    for (int y = 0; y < source.height; ++y)
        for (int x = 0; x < source.width; ++x)
            for (int c = 0; c < 3; ++c)
                panorama_.pixel(x, y)[c] =
                    sane(source.pixel(x, y)[source.channels >= 3 ? c : 0] * environment.tint[c]);
    // A cell's weight is the mean of what is read within it, so that none that shines has none.
    std::vector<float> weights;
    double sum = 0;
    for (int y = 0; y < source.height; ++y) {
        const float sine = std::sin(pi * (static_cast<float>(y) + 0.5f) / static_cast<float>(source.height));
        for (int x = 0; x < source.width; ++x) {
            float mean = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const float* const p = panorama_.pixel((x + dx + source.width) % source.width,
                                                           std::clamp(y + dy, 0, source.height - 1));
                    mean += luminance({p[0], p[1], p[2]}) * (dx == 0 ? 0.75f : 0.125f) *
                            (dy == 0 ? 0.75f : 0.125f);
                }
            weights.push_back(mean * sine);
            sum += static_cast<double>(mean) * sine;
        }
    }
    if (!(sum > 0))
        return;
    panoramaDistribution_.emplace(weights, source.width, source.height);
    // ∫ L dω over all directions, times the disk that the scene's ball shows to each.
    const double radiance =
        sum * 2 * std::numbers::pi * std::numbers::pi / static_cast<double>(panorama_.pixelCount());
    Shining light{.kind = Shining::Kind::environment};
    light.power = sane(static_cast<float>(radiance) * pi * std::max(sceneRadius * sceneRadius, 1e-30f));
    environmentLight_ = lights_.size();
    lights_.push_back(light);
}

glm::vec3 LightSet::environment(glm::vec3 direction) const {
    if (panorama_.pixelCount() == 0)
        return glm::vec3(0);
    const glm::vec2 uv = glsl::panoramaPlace(direction);
    const float s = uv.x * static_cast<float>(panorama_.width) - 0.5f;
    const float t = uv.y * static_cast<float>(panorama_.height) - 0.5f;
    const float left = std::floor(s);
    const float top = std::floor(t);
    const auto texel = [&](int x, int y) {
        const float* const p =
            panorama_.pixel((x + panorama_.width) % panorama_.width, std::clamp(y, 0, panorama_.height - 1));
        return glm::vec3(p[0], p[1], p[2]);
    };
    const int x = static_cast<int>(left);
    const int y = static_cast<int>(top);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), s - left),
                    glm::mix(texel(x, y + 1), texel(x + 1, y + 1), s - left), t - top);
}

std::optional<LightDraw> LightSet::drawTriangle(const TraceScene& scene, const Shining& light,
                                                const SurfacePoint& to, glm::vec2 uv) const {
    const glm::vec3 weights = sampleTriangle(light.area, uv).weights;
    LightDraw draw;
    SurfacePoint& end = draw.end;
    end.position = glm::vec3(static_cast<double>(weights.x) * dvec3(light.a) +
                             static_cast<double>(weights.y) * dvec3(light.b) +
                             static_cast<double>(weights.z) * dvec3(light.c));
    // Half an ulp of the position; the weights are off from 1 in sum by an ulp, which moves it along itself.
    end.positionError = 0x1.8p-23f * glm::abs(end.position) + std::numeric_limits<float>::denorm_min();
    end.geometricNormal = light.normal;
    const dvec3 between = dvec3(end.position) - dvec3(to.position);
    const double squared = glm::dot(between, between);
    if (!(squared > 0))
        return {};
    draw.wi = glm::vec3(between / std::sqrt(squared));
    float cosine = -glm::dot(light.normal, draw.wi);
    if (light.bothSides)
        cosine = std::abs(cosine);
    if (!(cosine > 0))
        return {};
    // The weight of question 24, cos′ A / r², is one over this density.
    draw.density = static_cast<float>(squared) / (cosine * light.area);
    end.instance = light.instance;
    end.triangle = light.triangle;
    end.weights = weights;
    const Instance& instance = scene.scene().instances[light.instance];
    end.material = instance.material;
    const Mesh& mesh = scene.scene().meshes[instance.mesh];
    if (!mesh.texcoords.empty()) {
        const std::uint32_t* const corner = &mesh.indices[3 * std::size_t{light.triangle}];
        end.texcoord = weights.x * mesh.texcoords[corner[0]] + weights.y * mesh.texcoords[corner[1]] +
                       weights.z * mesh.texcoords[corner[2]];
    }
    draw.weight = shiningOf(scene, end);
    return draw;
}

/// 1 − cos of the half angle that a ball fills, seen from outside at a squared distance.
double oneMinusCosineOf(double radius, double squaredDistance) {
    const double sine2 = radius * radius / squaredDistance;
    return sine2 / (1 + std::sqrt(1 - sine2));
}

std::optional<LightDraw> LightSet::drawBall(const TraceScene& scene, const Shining& light,
                                            const SurfacePoint& to, glm::vec2 uv) const {
    const dvec3 between = light.centre - dvec3(to.position);
    const double squared = glm::dot(between, between);
    // From within, its front is not seen; on it, what is seen of it is grazed.
    if (!(squared > light.radius * light.radius * (1 + 0x1p-20)))
        return {};
    const double narrow = oneMinusCosineOf(light.radius, squared);
    const DirectionSample sample = sampleCone(static_cast<float>(narrow), uv);
    const auto axes = basisAround(between);
    if (!axes)
        return {};
    LightDraw draw;
    const dvec3 wi = *axes * dvec3(sample.direction);
    draw.wi = glm::vec3(wi);
    draw.density = sample.density;
    // Where the ray meets the ball; at its outline, the nearest point to the ray.
    const double along = glm::dot(between, wi);
    const double off = squared - along * along;
    const double half = std::sqrt(std::max(light.radius * light.radius - off, 0.0));
    const dvec3 normal = glm::normalize((along - half) * wi - between);
    SurfacePoint& end = draw.end;
    end.position = glm::vec3(light.centre + light.radius * normal);
    end.positionError = 0x1.8p-23f * glm::abs(end.position) + static_cast<float>(0x1p-40 * light.radius) +
                        std::numeric_limits<float>::denorm_min();
    end.geometricNormal = glm::vec3(normal);
    end.instance = light.instance;
    end.material = scene.solids()[light.instance - scene.scene().instances.size()].material;
    draw.weight = shiningOf(scene, end);
    return draw;
}

std::optional<LightDraw> LightSet::drawPunctual(const TraceScene& scene, const Shining& light,
                                                const SurfacePoint& to) const {
    const Light& source = scene.scene().lights[light.index];
    const LightArrival incoming = arriveFrom(source, to.position);
    const glm::vec3 radiance = source.color * source.intensity;
    LightDraw draw;
    draw.delta = true;
    draw.endless = source.kind == Light::Kind::directional;
    draw.from = source.position;
    draw.wi = incoming.wi;
    if (draw.wi == glm::vec3(0) || !(incoming.strength > 0))
        return {};
    draw.weight = pi * incoming.strength * glm::vec3(sane(radiance.r), sane(radiance.g), sane(radiance.b));
    return draw;
}

std::optional<LightDraw> LightSet::drawEnvironment(glm::vec2 uv) const {
    const GridDistribution::Drawn drawn = panoramaDistribution_->sample(uv);
    LightDraw draw;
    draw.endless = true;
    draw.wi = glsl::panoramaDirection(drawn.point);
    const float sine = std::sin(pi * drawn.point.y);
    if (!(sine > 0))
        return {};
    draw.density = drawn.density / (2 * pi * pi * sine);
    draw.weight = environment(draw.wi);
    return draw;
}

std::optional<LightDraw> LightSet::draw(const TraceScene& scene, const SurfacePoint& to, float choice,
                                        glm::vec2 uv) const {
    if (!byPower_)
        return {};
    const DiscreteDistribution::Drawn drawn = byPower_->sample(choice);
    const Shining& light = lights_[drawn.index];
    std::optional<LightDraw> draw;
    switch (light.kind) {
        case Shining::Kind::triangle:
            draw = drawTriangle(scene, light, to, uv);
            break;
        case Shining::Kind::ball:
            draw = drawBall(scene, light, to, uv);
            break;
        case Shining::Kind::punctual:
            draw = drawPunctual(scene, light, to);
            break;
        case Shining::Kind::environment:
            draw = drawEnvironment(uv);
            break;
    }
    if (!draw)
        return {};
    if (draw->delta) {
        draw->weight /= drawn.probability;
        return draw;
    }
    draw->density *= drawn.probability;
    if (!(draw->density > 0) || !std::isfinite(draw->density))
        return {};
    draw->weight /= draw->density;
    return draw;
}

float LightSet::density(const SurfacePoint& to, const SurfacePoint& seen) const {
    const std::uint32_t first = firstOfInstance_[seen.instance];
    if (first == none)
        return 0;
    const std::uint32_t index = lightOfTriangle_[first + seen.triangle];
    if (index == none)
        return 0;
    const Shining& light = lights_[index];
    const float probability = byPower_->probability(index);
    if (light.kind == Shining::Kind::ball) {
        const dvec3 between = light.centre - dvec3(to.position);
        const double squared = glm::dot(between, between);
        if (!(squared > light.radius * light.radius * (1 + 0x1p-20)))
            return 0;
        return probability / (2 * pi * static_cast<float>(oneMinusCosineOf(light.radius, squared)));
    }
    const dvec3 between = dvec3(seen.position) - dvec3(to.position);
    const double squared = glm::dot(between, between);
    if (!(squared > 0))
        return 0;
    float cosine = -glm::dot(light.normal, glm::vec3(between / std::sqrt(squared)));
    if (light.bothSides)
        cosine = std::abs(cosine);
    return cosine > 0 ? probability * static_cast<float>(squared) / (cosine * light.area) : 0;
}

float LightSet::density(glm::vec3 direction) const {
    if (!environmentLight_)
        return 0;
    const glm::vec2 uv = glsl::panoramaPlace(direction);
    const float sine = std::sin(pi * uv.y);
    return sine > 0 ? byPower_->probability(*environmentLight_) * panoramaDistribution_->density(uv) /
                          (2 * pi * pi * sine)
                    : 0;
}

}  // namespace quincunx

#include "passes/shadow_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"
#include "math/projection.h"
#include "math/transform.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr GLuint shadowBinding = 2;
constexpr GLuint shadowUnit = 3;
constexpr float widestSpotRadians = 80 * std::numbers::pi_v<float> / 180;

/// Uniform block of shaders/lib/shadow.glsl, std140.
struct ShadowBlock {
    std::array<glm::mat4, maxShadowViews> shadowFromWorld{};
    std::array<glm::mat4, maxShadowViews> worldFromShadow{};
    std::array<glm::vec4, maxShadowViews> tiles{};
    glm::vec4 distances{0};
    glm::vec4 eyeForward{0};
    glm::vec4 lightPosition{0};
    glm::vec4 bias{0};
    glm::ivec4 mode{0};
};

std::array<glm::vec3, 8> cornersOf(const Bounds& bounds) {
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] = {(i & 1) != 0 ? bounds.max.x : bounds.min.x, (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                      (i & 4) != 0 ? bounds.max.z : bounds.min.z};
    return corners;
}

bool isUsable(const Bounds& bounds) {
    return isFinite(bounds.min) && isFinite(bounds.max) && bounds.min.x <= bounds.max.x &&
           bounds.min.y <= bounds.max.y && bounds.min.z <= bounds.max.z;
}

struct Box {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};

    void add(glm::dvec3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

/// The corners of the camera's view between two distances, world space.
std::array<glm::dvec3, 8> sliceCorners(const Camera& camera, float aspect, double from, double to) {
    const double tangent = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const glm::dmat4 worldFromCamera(camera.worldFromCamera);
    std::array<glm::dvec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
        const double distance = (i & 4) != 0 ? to : from;
        const double x = ((i & 1) != 0 ? 1 : -1) * tangent * static_cast<double>(aspect) * distance;
        const double y = ((i & 2) != 0 ? 1 : -1) * tangent * distance;
        corners[i] = glm::dvec3(worldFromCamera * glm::dvec4(x, y, -distance, 1));
    }
    return corners;
}

double distanceAlongView(const Camera& camera, glm::dvec3 p) {
    return -glm::dot(glm::dvec3(camera.worldFromCamera[2]), p - glm::dvec3(camera.worldFromCamera[3]));
}

/// Distances along the view where the slices end: the mean of even steps and of steps of equal ratio.
std::vector<double> splitDistances(double near, double far, int count) {
    std::vector<double> splits;
    for (int i = 1; i <= count; ++i) {
        const double share = static_cast<double>(i) / count;
        splits.push_back(0.5 * (near + (far - near) * share) + 0.5 * near * std::pow(far / near, share));
    }
    splits.back() = far;
    return splits;
}

/// A box's view along the light: x and y of `wanted`, depths of `casters`.
glm::mat4 boxView(const glm::mat3& worldFromLight, const Box& wanted, const Box& casters) {
    // A box without extent would have no matrix: it gets a little of the casters' size.
    const double extent = glm::length(casters.max - casters.min);
    const double size = extent > 0 ? extent : 1;
    const auto range = [&](double low, double high) {
        // As floats the two ends must differ: 2^-22 of them is two of their roundings on either side.
        const double rounding = 0x1p-22 * std::max(std::abs(low), std::abs(high));
        const double margin = std::max(rounding, (1e-3 * size - (high - low)) / 2);
        return std::pair(static_cast<float>(low - margin), static_cast<float>(high + margin));
    };
    const auto [left, right] = range(wanted.min.x, wanted.max.x);
    const auto [bottom, top] = range(wanted.min.y, wanted.max.y);
    const auto [near, far] = range(-casters.max.z, -casters.min.z);
    return orthographic(left, right, bottom, top, near, far) * glm::mat4(glm::transpose(worldFromLight));
}

/// The box around all vertices in a turned frame. In float: the sums are rounded by 2^-22 of their size,
/// which is added all around.
Box boundsAlong(const Scene& scene, const glm::mat3& frameFromWorld) {
    glm::vec3 low(std::numeric_limits<float>::infinity());
    glm::vec3 high(-std::numeric_limits<float>::infinity());
    for (const Instance& instance : scene.instances) {
        const glm::mat4 frameFromModel = glm::mat4(frameFromWorld) * instance.worldFromModel;
        for (const glm::vec3& position : scene.meshes[instance.mesh].positions) {
            const glm::vec3 p(frameFromModel * glm::vec4(position, 1));
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    const glm::dvec3 margin(0x1p-22 * glm::max(glm::abs(glm::dvec3(low)), glm::abs(glm::dvec3(high))));
    return {glm::dvec3(low) - margin, glm::dvec3(high) + margin};
}

ShadowViews directionalViews(const Light& light, const Scene& casters, const Bounds& bounds,
                             const Camera& camera, float aspect, int cascades) {
    const glm::mat3 basis = shadowBasis(light);
    const glm::dmat3 lightFromWorld = glm::transpose(glm::dmat3(basis));
    const Box all = boundsAlong(casters, glm::mat3(lightFromWorld));
    if (!std::isfinite(glm::length(all.max - all.min)))
        return {ShadowViews::Kind::cascades, {}};
    double farthest = camera.nearDistance;
    for (const glm::vec3& corner : cornersOf(bounds))
        farthest = std::max(farthest, distanceAlongView(camera, glm::dvec3(corner)));
    ShadowViews views{ShadowViews::Kind::cascades, {}};
    if (cascades == 1) {
        views.views.push_back({boxView(basis, all, all), std::numeric_limits<float>::infinity()});
        return views;
    }
    const double near = camera.nearDistance;
    const double far = std::max(std::min(farthest, static_cast<double>(camera.farDistance)), 1.001 * near);
    double from = near;
    for (const double to : splitDistances(near, far, cascades)) {
        Box slice;
        for (const glm::dvec3& corner : sliceCorners(camera, aspect, from, to))
            slice.add(lightFromWorld * corner);
        slice.min = glm::clamp(slice.min, all.min, all.max);
        slice.max = glm::clamp(slice.max, all.min, all.max);
        views.views.push_back({boxView(basis, slice, all), static_cast<float>(to)});
        from = to;
    }
    views.views.back().viewDistance = std::numeric_limits<float>::infinity();
    return views;
}

/// Near and far planes of views from a point light: as far as the farthest caster, and from a thousandth of
/// that; what is nearer is clamped into the map.
std::pair<float, float> reachOf(glm::vec3 position, const Bounds& casters) {
    float far = 0;
    for (const glm::vec3& corner : cornersOf(casters))
        far = std::max(far, length(corner - position));
    far = std::max(far * 1.001f, 1e-6f);
    return {far * 1e-3f, far};
}

ShadowViews spotView(const Light& light, const Bounds& casters) {
    const std::optional<glm::mat3> basis = basisAround(-light.direction);
    if (!basis)
        return {ShadowViews::Kind::single, {}};
    glm::mat4 worldFromLight(*basis);
    worldFromLight[3] = glm::vec4(light.position, 1);
    const auto [near, far] = reachOf(light.position, casters);
    return {ShadowViews::Kind::single,
            {{perspective(2 * light.outerConeRadians, 1, near, far) * cameraFromWorld(worldFromLight), 0}}};
}

ShadowViews cubeViews(const Light& light, const Bounds& casters, const ShadowMapParams& params) {
    const auto [near, far] = reachOf(light.position, casters);
    // Wider than a right angle by the taps that reach over the edge of a face.
    const float border = static_cast<float>(2 * (params.radius + 1)) / static_cast<float>(params.resolution);
    const float fov = 2 * std::atan(1 + std::min(border, 1.0f));
    ShadowViews views{ShadowViews::Kind::cube, {}};
    for (int face = 0; face < 6; ++face) {
        glm::vec3 direction(0);
        direction[face / 2] = face % 2 == 0 ? 1.0f : -1.0f;
        const glm::vec3 up = face / 2 == 1 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
        glm::mat4 worldFromLight = lookAt(glm::vec3(0), direction, up);
        worldFromLight[3] = glm::vec4(light.position, 1);
        views.views.push_back({perspective(fov, 1, near, far) * cameraFromWorld(worldFromLight), 0});
    }
    return views;
}

/// What a tile's constant bias is worth: one texel's width along the light, in normalized depth.
float depthOfTexel(const ShadowViews& views, int resolution) {
    const glm::mat4& clip = views.views.front().clipFromWorld;
    // NDC runs over 2 in x and in depth: a texel is 2/resolution of x, the rows' lengths turn it into world
    // units and into depth.
    const auto rowLength = [&](int row) {
        return length(glm::vec3(clip[0][row], clip[1][row], clip[2][row]));
    };
    // A perspective view's texel grows with the distance and its depth flattens with the square of it; at the
    // far plane, where near/far is 1e-3, one is worth 2e-3 / (rowLength(0) resolution).
    if (views.kind != ShadowViews::Kind::cascades)
        return 2e-3f / (rowLength(0) * static_cast<float>(resolution));
    return rowLength(2) / rowLength(0) / static_cast<float>(resolution);
}

ShadowBlock makeBlock(const ShadowMap::Lookup& lookup) {
    const ShadowMapParams& params = lookup.params;
    const std::vector<ShadowView>& views = lookup.views.views;
    QX_CHECK_LE(views.size(), maxShadowViews);
    const int columns = lookup.map.width() / params.resolution;
    const int rows = lookup.map.height() / params.resolution;
    ShadowBlock block;
    for (std::size_t i = 0; i < views.size(); ++i) {
        block.shadowFromWorld[i] = shadowFromClip() * views[i].clipFromWorld;
        block.worldFromShadow[i] = inverse(block.shadowFromWorld[i]).value_or(glm::mat4(1));
        const int row = static_cast<int>(i) / columns;
        block.tiles[i] = {static_cast<float>(static_cast<int>(i) % columns) / static_cast<float>(columns),
                          static_cast<float>(row) / static_cast<float>(rows), 1 / static_cast<float>(columns),
                          1 / static_cast<float>(rows)};
        if (i < 4)
            block.distances[static_cast<int>(i)] = views[i].viewDistance;
    }
    const glm::mat4& worldFromCamera = lookup.camera.worldFromCamera;
    const glm::vec3 forward = -glm::vec3(worldFromCamera[2]);
    block.eyeForward = glm::vec4(forward, -dot(forward, glm::vec3(worldFromCamera[3])));
    block.lightPosition = glm::vec4(lookup.lightPosition, 1);
    const bool plane = params.bias == ShadowBias::receiverPlane;
    if (params.bias == ShadowBias::constant && !views.empty())
        block.bias.x = params.biasScale * depthOfTexel(lookup.views, params.resolution);
    block.bias.y = plane ? params.biasScale : 0;
    block.bias.z = 1 / static_cast<float>(params.resolution);
    block.mode = {static_cast<int>(lookup.views.kind), static_cast<int>(views.size()),
                  views.empty() ? -1 : lookup.lightIndex, params.radius};
    return block;
}

/// The kind of views that a light has, whatever there is to see.
ShadowViews::Kind kindFor(const Light& light) {
    if (light.kind == Light::Kind::directional)
        return ShadowViews::Kind::cascades;
    return light.kind == Light::Kind::spot && light.outerConeRadians <= widestSpotRadians
               ? ShadowViews::Kind::single
               : ShadowViews::Kind::cube;
}

}  // namespace

glm::mat4 shadowFromClip() {
    return {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0.5f, 0.5f, 0.5f, 1};
}

glm::mat3 shadowBasis(const Light& light) {
    return glm::mat3(lookAt(glm::vec3(0), light.direction, {0, 1, 0}));
}

int cascadesFor(const ViewDepths& depths) {
    int cascades = 1;
    for (double ratio = depths.farthest / depths.nearest; ratio > 4 && cascades < 4; ratio /= 4)
        ++cascades;
    return cascades;
}

ShadowViews fitShadowViews(const Light& light, const ShadowExtent& extent, const ShadowMapParams& params,
                           const ViewDepths& depths) {
    ShadowViews none{kindFor(light), {}};
    if (!isUsable(extent.casters) || (light.kind != Light::Kind::point && !normalize(light.direction)))
        return none;
    if (light.kind == Light::Kind::directional) {
        const Box casters{extent.castersMin, extent.castersMax};
        const Box wanted{glm::max(extent.receiversMin, extent.castersMin),
                         glm::min(extent.receiversMax, extent.castersMax)};
        const bool meet = wanted.min.x <= wanted.max.x && wanted.min.y <= wanted.max.y;
        if (!meet || !std::isfinite(glm::length(casters.max - casters.min)))
            return none;
        const glm::mat3 basis = shadowBasis(light);
        if (params.cascades == 1) {
            none.views.push_back({boxView(basis, wanted, casters), std::numeric_limits<float>::infinity()});
            return none;
        }
        const glm::dmat3 lightFromWorld = glm::transpose(glm::dmat3(basis));
        double from = depths.nearest;
        for (const double to : splitDistances(depths.nearest, depths.farthest, params.cascades)) {
            Box slice;
            for (const glm::dvec3& corner : sliceCorners(depths.camera, depths.aspect, from, to))
                slice.add(lightFromWorld * corner);
            slice.min = glm::clamp(slice.min, wanted.min, wanted.max);
            slice.max = glm::clamp(slice.max, wanted.min, wanted.max);
            none.views.push_back({boxView(basis, slice, casters), static_cast<float>(to)});
            from = to;
        }
        none.views.back().viewDistance = std::numeric_limits<float>::infinity();
        return none;
    }
    const bool open = light.kind != Light::Kind::spot || light.outerConeRadians > 0;
    if (!open || !isFinite(light.position) || !std::isfinite(reachOf(light.position, extent.casters).second))
        return none;
    return none.kind == ShadowViews::Kind::single ? spotView(light, extent.casters)
                                                  : cubeViews(light, extent.casters, params);
}

ShadowViews fitShadowViews(const Light& light, const Scene& casters, const Camera& camera, float aspect,
                           const ShadowMapParams& params) {
    QX_CHECK_GE(params.cascades, 1);
    QX_CHECK_LE(params.cascades, 4);
    const bool directional = light.kind == Light::Kind::directional;
    const Bounds bounds = casters.bounds();
    if (!isUsable(bounds) || (light.kind != Light::Kind::point && !normalize(light.direction)))
        return {directional ? ShadowViews::Kind::cascades : ShadowViews::Kind::single, {}};
    const bool placed =
        directional || (isFinite(light.position) && std::isfinite(reachOf(light.position, bounds).second));
    const bool open = light.kind != Light::Kind::spot || light.outerConeRadians > 0;
    if (!placed || !open)
        return {directional ? ShadowViews::Kind::cascades : ShadowViews::Kind::single, {}};
    if (directional)
        return directionalViews(light, casters, bounds, camera, aspect, params.cascades);
    if (light.kind == Light::Kind::spot && light.outerConeRadians <= widestSpotRadians)
        return spotView(light, bounds);
    return cubeViews(light, bounds, params);
}

glm::ivec2 ShadowMap::size(std::size_t views, int resolution) {
    const int columns = views <= 3 ? static_cast<int>(views) : static_cast<int>((views + 1) / 2);
    const int rows = views <= 3 ? 1 : 2;
    return {std::max(columns, 1) * resolution, rows * resolution};
}

void ShadowMap::draw(graph::PassContext& context, ForwardScene& casters, const ShadowViews& views,
                     const ShadowMapParams& params) {
    const glm::ivec2 size = ShadowMap::size(views.views.size(), params.resolution);
    const int columns = size.x / params.resolution;
    glClear(GL_DEPTH_BUFFER_BIT);
    // What lies before a view's near plane still casts its shadow: it is clamped to it.
    glEnable(GL_DEPTH_CLAMP);
    const bool offset = params.bias == ShadowBias::slope;
    if (offset) {
        glEnable(GL_POLYGON_OFFSET_FILL);
        // A tap's texel was sampled up to `reach` texels away along s and t: reach (|a| + |b|) <= 2 reach
        // max(|a|, |b|), the slope that OpenGL multiplies. One unit is one rounding of the map's depth; two
        // are compared.
        const float reach = static_cast<float>(params.radius) + (params.bilinear ? 1.0f : 0.5f);
        glPolygonOffset(2 * reach * params.biasScale, 2 * params.biasScale);
    }
    for (std::size_t i = 0; i < views.views.size(); ++i) {
        const int tile = static_cast<int>(i);
        glViewport(tile % columns * params.resolution, tile / columns * params.resolution, params.resolution,
                   params.resolution);
        casters.drawDepth(context, views.views[i].clipFromWorld, params.backFaces);
    }
    if (offset)
        glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_DEPTH_CLAMP);
    glViewport(0, 0, size.x, size.y);
}

void ShadowMap::drawShadowed(graph::PassContext& context, ForwardScene& scene, const ForwardView& view,
                             const Lookup& lookup, bool mask) {
    const ShadowMapParams& params = lookup.params;
    const ShadowBlock block = makeBlock(lookup);
    const auto bytes = std::as_bytes(std::span(&block, 1));
    if (!block_)
        block_.emplace("shadow block", GL_UNIFORM_BUFFER, bytes, GL_DYNAMIC_DRAW);
    else if (!std::equal(bytes.begin(), bytes.end(), sent_.begin(), sent_.end()))
        block_->upload(bytes);
    sent_.assign(bytes.begin(), bytes.end());
    block_->bindUniform(shadowBinding, 0, sizeof(ShadowBlock));
    lookup.map.bind(shadowUnit);
    const GLenum filter = params.bilinear ? GL_LINEAR : GL_NEAREST;
    const gl::Sampler::Use sampler(
        context.sampler({.minification = filter, .magnification = filter, .compare = true}), shadowUnit);

    gl::ProgramFiles files{.label = "phong shadowed",
                           .vertex = "passes/phong.vert",
                           .fragment = "passes/phong_shadowed.frag",
                           .defines = {{"BLINN_PHONG", ""}},
                           .blocks = SceneBuffers::bindings(),
                           .samplers = {{"shadowMap", shadowUnit}}};
    files.blocks.push_back({"ShadowBlock", shadowBinding});
    if (mask)
        files.defines.emplace_back("LIT_MASK", "");
    if (params.bilinear)
        files.defines.emplace_back("SHADOW_BILINEAR", "");
    scene.draw(context, view, files);
}

}  // namespace quincunx

#include "passes/frame_shadows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr GLuint shadowBinding = 5;
constexpr GLuint firstShadowUnit = 11;  // and one a kind of light
constexpr std::size_t maxFrameShadowViews = 6 * maxShaderLights;
constexpr int mostTexels = 8192;

/// Uniform block of shaders/lib/frame_shadows.glsl, std140.
struct FrameShadowBlock {
    std::array<glm::mat4, maxFrameShadowViews> shadowFromWorld{};
    std::array<glm::mat4, maxFrameShadowViews> worldFromShadow{};
    std::array<glm::vec4, maxFrameShadowViews> tiles{};
    std::array<glm::ivec4, maxShaderLights> lights{};
    std::array<glm::vec4, maxShaderLights> texels{};
    std::array<glm::vec4, maxShaderLights> distances{};
    glm::vec4 eyeForward{0};
    glm::ivec4 mode{0};
};

struct KindNames {
    const char* define;
    const char* sampler;
};
KindNames namesOf(Light::Kind kind) {
    switch (kind) {
        case Light::Kind::directional:
            return {"SHADOWS_DIRECTIONAL", "directionalShadowMap"};
        case Light::Kind::point:
            return {"SHADOWS_POINT", "pointShadowMap"};
        case Light::Kind::spot:
            break;
    }
    return {"SHADOWS_SPOT", "spotShadowMap"};
}

GLint unitOf(Light::Kind kind) {
    return static_cast<GLint>(firstShadowUnit) + static_cast<GLint>(kind);
}

}  // namespace

ShadowAtlas makeShadowAtlas(const Visibility& visibility, const Scene& scene, Light::Kind kind,
                            const FrameSettings& settings) {
    QX_CHECK_GE(settings.shadowResolution, 1);
    ShadowAtlas atlas;
    atlas.kind = kind;
    atlas.resolution = kind == Light::Kind::directional ? settings.shadowResolution
                                                        : std::max(settings.shadowResolution / 2, 1);
    ShadowMapParams params{.bilinear = true, .radius = settings.shadowRadius};
    if (kind == Light::Kind::directional) {
        QX_CHECK_GE(settings.shadowCascades, 0);
        QX_CHECK_LE(settings.shadowCascades, 4);
        params.cascades =
            settings.shadowCascades > 0 ? settings.shadowCascades : cascadesFor(visibility.depths);
        if (params.cascades > 1)
            atlas.resolution = std::max(atlas.resolution / 2, 1);
    }
    params.resolution = atlas.resolution;
    for (std::size_t i = 0; i < visibility.lights.size(); ++i) {
        const LightReach& reach = visibility.lights[i];
        Light light = scene.lights[reach.light];
        if (light.kind != kind || reach.casters.empty())
            continue;
        light.position -= visibility.anchorWorld;
        for (const ShadowView& view : fitShadowViews(light, reach.extent, params, visibility.depths).views) {
            ShadowAtlas::Tile tile{i, view.clipFromWorld, view.viewDistance, {}};
            // What lies beyond its near and far planes is clamped to them.
            const ViewPlanes planes(view.clipFromWorld, ViewPlanes::Kind::sides);
            for (const std::uint32_t caster : reach.casters)
                if (settings.drawsUnseen || planes.mayMeet(visibility.boxes[caster]))
                    tile.casters.push_back(caster);
            atlas.tiles.push_back(std::move(tile));
        }
    }
    const int count = std::max(static_cast<int>(atlas.tiles.size()), 1);
    while (atlas.columns * atlas.columns < count)
        ++atlas.columns;
    atlas.rows = (count + atlas.columns - 1) / atlas.columns;
    while (atlas.resolution > 1 && atlas.width() > mostTexels)
        atlas.resolution /= 2;
    return atlas;
}

void drawShadowAtlas(graph::PassContext& context, MaterialPass& materials, const Scene& scene,
                     const Visibility& visibility, const ShadowAtlas& atlas) {
    glClear(GL_DEPTH_BUFFER_BIT);
    if (atlas.tiles.empty())
        return;
    // What lies before a view's near plane still casts its shadow: it is clamped to it.
    glEnable(GL_DEPTH_CLAMP);
    for (std::size_t i = 0; i < atlas.tiles.size(); ++i) {
        const ShadowAtlas::Tile& tile = atlas.tiles[i];
        if (tile.casters.empty())
            continue;
        const int place = static_cast<int>(i);
        glViewport(place % atlas.columns * atlas.resolution, place / atlas.columns * atlas.resolution,
                   atlas.resolution, atlas.resolution);
        materials.drawDepth(context, scene, tile.clipFromAnchored, visibility.anchorWorld, tile.casters,
                            {.view = static_cast<std::size_t>(atlas.kind) * maxFrameShadowViews + i});
    }
    glDisable(GL_DEPTH_CLAMP);
    glViewport(0, 0, atlas.width(), atlas.height());
}

void FrameShadows::addTo(MaterialParams& params, Light::Kind kind) {
    const KindNames names = namesOf(kind);
    params.defines.emplace_back(names.define, "");
    params.samplers.push_back({names.sampler, unitOf(kind)});
    const gl::BlockBinding block{"FrameShadowBlock", shadowBinding};
    if (std::find(params.blocks.begin(), params.blocks.end(), block) == params.blocks.end())
        params.blocks.push_back(block);
}

void FrameShadows::bind(graph::PassContext& context, const Visibility& visibility,
                        const std::vector<Map>& maps, int radius) {
    FrameShadowBlock block;
    block.mode.x = radius;
    const glm::mat4& anchoredFromCamera = visibility.depths.camera.worldFromCamera;
    const glm::vec3 forward = -glm::vec3(anchoredFromCamera[2]);
    block.eyeForward = glm::vec4(forward, -glm::dot(forward, glm::vec3(anchoredFromCamera[3])));
    std::size_t view = 0;
    for (const Map& map : maps)
        for (std::size_t i = 0; i < map.atlas.tiles.size(); ++i, ++view) {
            const ShadowAtlas& atlas = map.atlas;
            const ShadowAtlas::Tile& tile = atlas.tiles[i];
            QX_CHECK_LT(view, maxFrameShadowViews);
            block.shadowFromWorld[view] = shadowFromClip() * tile.clipFromAnchored;
            block.worldFromShadow[view] =
                quincunx::inverse(block.shadowFromWorld[view]).value_or(glm::mat4(1));
            const int column = static_cast<int>(i) % atlas.columns;
            const int row = static_cast<int>(i) / atlas.columns;
            const glm::vec2 scale(1 / static_cast<float>(atlas.columns), 1 / static_cast<float>(atlas.rows));
            block.tiles[view] = {scale.x * static_cast<float>(column), scale.y * static_cast<float>(row),
                                 scale.x, scale.y};
            glm::ivec4& light = block.lights[tile.light];
            if (light.y == 0)
                light.x = static_cast<int>(view);
            if (light.y < 4)
                block.distances[tile.light][light.y] = tile.viewDistance;
            ++light.y;
            block.texels[tile.light].x = 1 / static_cast<float>(atlas.resolution);
        }
    QX_CHECK_LE(visibility.lights.size(), maxShaderLights);
    const auto bytes = std::as_bytes(std::span(&block, 1));
    if (!block_)
        block_.emplace("frame shadow block", GL_UNIFORM_BUFFER, bytes, GL_DYNAMIC_DRAW);
    else if (!std::equal(bytes.begin(), bytes.end(), sent_.begin(), sent_.end()))
        block_->upload(bytes);
    sent_.assign(bytes.begin(), bytes.end());
    block_->bindUniform(shadowBinding, 0, sizeof(FrameShadowBlock));
    for (const Map& map : maps) {
        map.texture.bind(static_cast<GLuint>(unitOf(map.atlas.kind)));
        samplers_.push_back(std::make_unique<gl::Sampler::Use>(
            context.sampler({.minification = GL_LINEAR, .magnification = GL_LINEAR, .compare = true}),
            static_cast<GLuint>(unitOf(map.atlas.kind))));
    }
}

void FrameShadows::unbind() {
    samplers_.clear();
}

}  // namespace quincunx

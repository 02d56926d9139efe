#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/transform.h"
#include "passes/frame_renderer.h"
#include "scene/finish.h"
#include "scene/import.h"
#include "scene/still_life.h"

/// Scenes for planned frames, and a renderer to draw them with.
namespace quincunx::test {

inline EffectSet allEffects() {
    EffectSet all;
    for (std::size_t i = 0; i < effects().size(); ++i)
        all.set(i);
    return all;
}

class Frames : public testing::Test {
  protected:
    Frames() : context_(gl::createOffscreenContext(gl::Backend::automatic)) {}

    Image drawn(const FrameView& view) {
        graph::FrameGraph graph;
        const graph::Resource picture = renderer_.build(graph, view);
        graph.addOutput(picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(picture));
    }

    /// Law 1 for that view, in eight bits and in float.
    void expectForcingChangesNothing(FrameView view, const std::string& what) {
        for (const graph::Format format : {graph::Format::rgba8Srgb, graph::Format::rgba32f}) {
            view.pictureFormat = format;
            view.settings.forced = {};
            const Image planned = drawn(view);
            view.settings.forced = allEffects();
            const Image forced = drawn(view);
            for (const PlannedEffect& effect : renderer_.plan().effects)
                ASSERT_TRUE(effect.added) << effect.name;
            ASSERT_EQ(planned, forced) << what;
        }
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    FrameRenderer renderer_;
};

inline Camera cameraFor(const Scene& scene, float aspect) {
    return scene.cameras.empty() ? frameBounds(scene.bounds(), aspect) : scene.cameras.front();
}

/// Textures of every use, over materials that mirror, cut out and blend.
inline Scene texturedStillLife() {
    Scene scene = tessellate(makeStillLife(), 16);
    Random random(1);
    for (const Encoding encoding : {Encoding::srgb, Encoding::linear}) {
        Image8 image(8, 8, 4, encoding);
        for (std::uint8_t& texel : image.data)
            texel = static_cast<std::uint8_t>(64 + random.below(192));
        scene.textures.push_back({.name = "noise", .image = std::move(image)});
    }
    const std::size_t color = scene.textures.size() - 2;
    const std::size_t numbers = scene.textures.size() - 1;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        Material& material = scene.materials[i];
        material.baseColorTexture = color;
        material.metallicRoughnessTexture = numbers;
        material.normalTexture = numbers;
        material.occlusionTexture = numbers;
        material.emissionTexture = color;
        material.emission = glm::vec3(0.1f);
        material.metallic = 1;
        material.roughness = 0.3f;
        material.alphaMode = static_cast<Material::AlphaMode>(i % 3);
        material.baseColor.a = 0.7f;
    }
    return scene;
}

/// Scenes of a few objects of every kind, with lights and cameras of every kind, near the origin or far away.
struct RandomScene {
    Scene scene;
    std::vector<glm::mat4> open;
    std::vector<glm::mat4> close;
    FrameView view;

    RandomScene(std::uint64_t seed, const std::vector<Mesh>& meshes);
};

inline glm::vec3 randomPoint(Random& random, float reach) {
    return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

inline glm::vec3 randomDirection(Random& random) {
    for (;;) {
        const glm::vec3 p = randomPoint(random, 1);
        const float length = glm::length(p);
        if (length > 0.1f && length < 1)
            return p / length;
    }
}

inline Material randomMaterial(Random& random) {
    const glm::vec3 color(random.uniform(), random.uniform(), random.uniform());
    Material material = makeMaterial(
        "m",
        {.diffuse = color, .metallic = random.below(3) == 0 ? 1.0f : 0.0f, .roughness = random.uniform()});
    material.baseColor.a = random.uniform();
    material.alphaMode = static_cast<Material::AlphaMode>(random.below(3));
    material.alphaCutoff = random.uniform();
    material.doubleSided = random.below(3) == 0;
    if (random.below(4) == 0)
        material.emission = 3.0f * color;
    return material;
}

inline Light randomLight(Random& random, const glm::vec3& origin) {
    Light light;
    light.kind = static_cast<Light::Kind>(random.below(3));
    light.position = origin + randomPoint(random, 6);
    light.direction = randomDirection(random);
    light.color = {random.uniform(), random.uniform(), random.uniform()};
    light.intensity = light.kind == Light::Kind::directional ? 1.0f : 20.0f;
    light.outerConeRadians = static_cast<float>(random.uniform(0, 1.57));
    light.innerConeRadians = light.outerConeRadians * random.uniform();
    if (random.below(2) == 0)
        light.range = static_cast<float>(random.uniform(0.5, 8));
    return light;
}

inline FrameSettings randomSettings(Random& random) {
    FrameSettings settings;
    settings.shadowResolution = 64;
    settings.environmentResolution = 16;
    const auto sometimes = [&](float value) { return random.below(3) == 0 ? value : 0.0f; };
    settings.exposureStops = sometimes(1.5f);
    settings.toneCurve = static_cast<ToneCurve>(random.below(3));
    settings.bloomStrength = sometimes(0.7f);
    settings.blurSigmaPixels = sometimes(1.3f);
    settings.greyscale = sometimes(0.6f);
    settings.fxaa = random.below(3) == 0;
    settings.shutterSeconds = sometimes(0.02f);
    return settings;
}

inline RandomScene::RandomScene(std::uint64_t seed, const std::vector<Mesh>& meshes)
    : view{.scene = scene, .camera = {}, .width = 48, .height = 32} {
    Random random(seed);
    const float away[] = {0, 0, 0, 1e3f, 1e6f};
    const glm::vec3 origin = away[random.below(5)] * randomDirection(random);
    scene.meshes = meshes;
    const std::uint64_t materials = 1 + random.below(3);
    for (std::uint64_t i = 0; i < materials; ++i)
        scene.materials.push_back(randomMaterial(random));
    const std::uint64_t objects = random.below(7);
    for (std::uint64_t i = 0; i < objects; ++i) {
        glm::mat4 placement(1);
        const glm::vec3 axis = randomDirection(random);
        const glm::vec3 other = glm::normalize(glm::cross(axis, randomDirection(random)));
        const float size = 0.3f + random.uniform();
        placement[0] = glm::vec4(size * axis, 0);
        placement[1] = glm::vec4(size * other, 0);
        placement[2] = glm::vec4((random.below(4) == 0 ? -size : size) * glm::cross(axis, other), 0);
        placement[3] = glm::vec4(origin + randomPoint(random, 4), 1);
        scene.instances.push_back(
            {"object", random.below(meshes.size()), random.below(materials), placement});
    }
    const std::uint64_t lights = random.below(5);
    for (std::uint64_t i = 0; i < lights; ++i)
        scene.lights.push_back(randomLight(random, origin));
    scene.backgroundTop = {random.uniform(), random.uniform(), random.uniform()};
    scene.backgroundBottom = {random.uniform(), random.uniform(), random.uniform()};
    Camera camera;
    const float inside = random.below(4) == 0 ? 0.5f : 6.0f;  // often within an object
    const glm::vec3 eye = origin + randomPoint(random, inside);
    camera.worldFromCamera = lookAt(eye, eye + randomDirection(random), {0, 1, 0});
    camera.fovYRadians = static_cast<float>(random.uniform(0.2, 2.5));
    camera.nearDistance = random.below(4) == 0 ? 1e-3f : 0.1f;
    camera.farDistance = random.below(4) == 0 ? std::numeric_limits<float>::infinity() : 100;
    if (random.below(4) == 0) {
        camera.apertureRadius = 0.1f;
        camera.focusDistance = 4;
    }
    view.camera = view.cameraAtOpen = view.cameraAtClose = camera;
    if (random.below(3) == 0)
        view.cameraAtOpen.worldFromCamera =
            lookAt(eye + randomPoint(random, 0.2f), eye + randomDirection(random), {0, 1, 0});
    for (const Instance& instance : scene.instances) {
        open.push_back(instance.worldFromModel);
        close.push_back(instance.worldFromModel);
        if (random.below(4) == 0)
            close.back()[3].x += 0.3f;
    }
    view.worldFromModelAtOpen = open;
    view.worldFromModelAtClose = close;
    view.settings = randomSettings(random);
}

inline std::vector<Mesh> smallMeshes() {
    Mesh quad;
    quad.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    quad.normals.assign(4, {0, 1, 0});
    quad.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    Mesh nothing;
    return {tessellate(Sphere{}, 12), tessellate(Capsule{}, 8), tessellate(Torus{}, 12), quad, nothing};
}

/// A ball before the camera on a quad, a sun, and room for what the tests add.
inline Scene ballOnAFloor() {
    Scene scene;
    scene.meshes = smallMeshes();
    scene.materials = {makeMaterial("matt", {.diffuse = {0.6f, 0.5f, 0.4f}, .roughness = 0.9f})};
    scene.instances = {{"ball", 0, 0, glm::mat4(1)}};
    scene.lights.emplace_back();
    scene.lights.back().name = "key";
    scene.lights.back().direction = glm::normalize(glm::vec3(-1, -2, -1));
    return scene;
}

inline FrameView lookingAtTheBall(const Scene& scene) {
    FrameView view{.scene = scene, .camera = {}, .width = 48, .height = 32};
    view.camera.worldFromCamera = lookAt({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    view.cameraAtOpen = view.cameraAtClose = view.camera;
    view.settings.shadowResolution = 64;
    view.settings.environmentResolution = 16;
    return view;
}

/// Where the camera of `lookingAtTheBall` does not see it.
inline glm::mat4 placedBehind() {
    glm::mat4 placement(1);
    placement[3] = {0, 0, 20, 1};
    return placement;
}

}  // namespace quincunx::test

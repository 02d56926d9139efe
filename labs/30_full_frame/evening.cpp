#include "labs/30_full_frame/evening.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "geometry/shapes.h"
#include "math/transform.h"
#include "scene/colonnade.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr double orbitRadius = 3.95;
constexpr double orbitHeight = 2.1;
constexpr double orbitSeconds = 9;
constexpr int planetCount = 3;

glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1), position);
}

std::string planetName(int i) {
    return "planet " + std::to_string(i + 1);
}

glm::mat4 planetPlacement(int i, double seconds) {
    const double angle = turn * (seconds / orbitSeconds + static_cast<double>(i) / planetCount);
    return at({static_cast<float>(orbitRadius * std::sin(angle)),
               static_cast<float>(orbitHeight + 0.25 * std::sin(3 * angle)),
               static_cast<float>(orbitRadius * std::cos(angle))});
}

Material glass(std::string name, const glm::vec3& color, float opacity) {
    Material material = makeMaterial(std::move(name), {.diffuse = color, .roughness = 0.35f});
    material.alphaMode = Material::AlphaMode::blend;
    material.baseColor.a = opacity;
    return material;
}

Material flame() {
    Material material = makeMaterial("flame", {.diffuse = glm::vec3(0), .roughness = 1});
    material.emission = {9, 3.6f, 0.9f};
    // What blends casts no shadow: a lamp inside is not locked in.
    material.alphaMode = Material::AlphaMode::blend;
    material.baseColor = glm::vec4(0, 0, 0, 0.92f);
    return material;
}

void add(Scene& scene, const std::string& name, const Shape& shape, int segments, const Material& material,
         const glm::mat4& placement) {
    scene.meshes.push_back(tessellate(shape, segments));
    scene.meshes.back().name = name;
    scene.materials.push_back(material);
    scene.instances.push_back({name, scene.meshes.size() - 1, scene.materials.size() - 1, placement});
}

Light lamp(const std::string& name, const glm::vec3& position) {
    Light light;
    light.kind = Light::Kind::point;
    light.name = name;
    light.position = position;
    light.color = {1, 0.52f, 0.2f};
    light.intensity = 2.6f;
    light.range = 9;
    return light;
}

}  // namespace

Scene makeEvening(int segments) {
    StillLife temple = makeColonnade();
    Scene scene = tessellate(temple, segments);
    scene.name = "evening";
    for (Material& material : scene.materials) {
        material.roughness = 0.75f;
        if (material.name == "gold")
            material = makeMaterial("gold", {.diffuse = {0.56f, 0.31f, 0.06f},
                                             .specular = {1.0f, 0.72f, 0.32f},
                                             .metallic = 1,
                                             .roughness = 0.22f});
    }
    add(scene, "chrome ball", Sphere{0.8}, segments * 2,
        makeMaterial(
            "chrome",
            {.diffuse = glm::vec3(0.05f), .specular = glm::vec3(0.93f), .metallic = 1, .roughness = 0.03f}),
        at({3.1f, 0.8f, 5.2f}));
    const glm::vec3 tints[] = {{0.75f, 0.12f, 0.16f}, {0.14f, 0.5f, 0.3f}, {0.16f, 0.3f, 0.8f}};
    // The nearest first: the order in the scene is not the one to draw them in.
    for (int i = 2; i >= 0; --i)
        add(scene, "pane " + std::to_string(i + 1), Drum{0.75, 0.04, 0.02}, segments,
            glass("glass " + std::to_string(i + 1), tints[i], 0.42f),
            at({-0.6f + 0.62f * static_cast<float>(i), 0.8f, 6.4f + 0.45f * static_cast<float>(i)}) *
                glm::rotate(glm::mat4(1), 1.45f, {1, 0.15f, 0}));
    const Material paint = makeMaterial("planet", {.diffuse = {0.8f, 0.36f, 0.1f}, .roughness = 0.45f});
    for (int i = 0; i < planetCount; ++i)
        add(scene, planetName(i), Sphere{0.3}, segments, paint, planetPlacement(i, 0));
    const glm::vec3 flames[] = {{-4.6f, 0.75f, 3.6f}, {4.9f, 0.75f, 2.4f}};
    for (int i = 0; i < 2; ++i) {
        const std::string name = "lantern " + std::to_string(i + 1);
        add(scene, name + "'s foot", Drum{0.3, 0.26, 0.06}, segments,
            makeMaterial("iron", {.diffuse = glm::vec3(0.05f), .roughness = 0.8f}),
            at(flames[i] - glm::vec3(0, 0.48f, 0)));
        add(scene, name, Sphere{0.22}, segments, flame(), at(flames[i]));
        scene.lights.push_back(lamp(name, flames[i]));
    }
    scene.lights[0].name = "sun";
    scene.lights[0].direction = glm::normalize(glm::vec3(0.78f, -0.36f, -0.62f));
    scene.lights[0].color = {1, 0.55f, 0.28f};
    scene.lights[0].intensity = 0.62f;
    Light spot;
    spot.kind = Light::Kind::spot;
    spot.name = "on the egg";
    spot.position = {0, 6.2f, 1.4f};
    spot.direction = glm::normalize(glm::vec3(0, 1.8f, 0) - spot.position);
    spot.color = {0.75f, 0.85f, 1};
    spot.intensity = 16;
    spot.innerConeRadians = 0.14f;
    spot.outerConeRadians = 0.26f;
    scene.lights.push_back(spot);
    scene.ambientLight = {0.055f, 0.07f, 0.13f};
    scene.backgroundTop = {0.015f, 0.03f, 0.10f};
    scene.backgroundBottom = {0.42f, 0.20f, 0.12f};
    Camera camera = temple.camera;
    camera.worldFromCamera = lookAt({1.2f, 3.4f, 13.2f}, {0.2f, 1.35f, 1.0f}, {0, 1, 0});
    camera.focusDistance = 12;
    scene.cameras = {camera};
    return scene;
}

void poseEvening(Scene& scene, double seconds) {
    for (int i = 0; i < planetCount; ++i) {
        const auto found =
            std::find_if(scene.instances.begin(), scene.instances.end(),
                         [&](const Instance& instance) { return instance.name == planetName(i); });
        if (found != scene.instances.end())
            found->worldFromModel = planetPlacement(i, seconds);
    }
}

}  // namespace quincunx

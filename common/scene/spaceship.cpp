#include "scene/spaceship.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "base/random.h"
#include "math/transform.h"
#include "scene/finish.h"
#include "scene/still_life.h"

namespace quincunx {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int starCount = 700;

glm::mat4 at(glm::vec3 p) {
    return glm::translate(glm::mat4(1), p);
}

glm::mat4 turned(float degrees, glm::vec3 axis) {
    return glm::rotate(glm::mat4(1), degrees * pi / 180, axis);
}

/// From a shape's frame, whose axis is y, to one whose axis is the ship's, x.
glm::mat4 lengthwise() {
    return turned(-90, {0, 0, 1});
}

/// Octahedra on a sphere around everything, of all brightnesses, the faint ones far more often.
Mesh stars(Random& random) {
    Mesh mesh;
    mesh.name = "stars";
    constexpr float distance = 60;
    for (int i = 0; i < starCount; ++i) {
        const double z = random.uniform(-1, 1);
        const double angle = random.uniform(0, 2 * std::numbers::pi);
        const double ring = std::sqrt(1 - z * z);
        const glm::vec3 centre = distance * glm::vec3(ring * std::cos(angle), ring * std::sin(angle), z);
        const auto size = static_cast<float>(0.03 + 0.12 * std::pow(random.uniform(0, 1), 8.0));
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const glm::vec3& corner : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0),
                                        glm::vec3(0, -1, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
            mesh.positions.push_back(centre + size * corner);
            mesh.normals.push_back(corner);
        }
        for (const std::uint32_t x : {0u, 1u})
            for (const std::uint32_t y : {2u, 3u})
                for (const std::uint32_t z2 : {4u, 5u}) {
                    const bool even = ((x & 1u) ^ (y & 1u) ^ (z2 & 1u)) == 0;
                    mesh.indices.insert(mesh.indices.end(),
                                        {first + x, first + (even ? y : z2), first + (even ? z2 : y)});
                }
    }
    return mesh;
}

}  // namespace

Scene makeSpaceship(int segments) {
    const Material hull = makeMaterial("white hull", {{0.62f, 0.63f, 0.66f}, {0.35f, 0.35f, 0.38f}, 40});
    const Material ring = makeMaterial("ring", {{0.30f, 0.33f, 0.38f}, {0.4f, 0.42f, 0.45f}, 60});
    const Material trim = makeMaterial("orange trim", {{0.62f, 0.19f, 0.03f}, {0.25f, 0.2f, 0.15f}, 30});
    const Material glass = makeMaterial("glass", {{0.01f, 0.03f, 0.07f}, {0.9f, 0.95f, 1.0f}, 220});
    const Material nozzle = makeMaterial("nozzle", {{0.07f, 0.07f, 0.08f}, {0.3f, 0.3f, 0.3f}, 20});
    const Material flame = makeMaterial(
        "flame",
        {.diffuse = {0, 0, 0}, .specular = {0, 0, 0}, .shininess = 1, .emission = {2.6f, 7.5f, 16.0f}});
    const Material lamp = makeMaterial(
        "lamp",
        {.diffuse = {0, 0, 0}, .specular = {0, 0, 0}, .shininess = 1, .emission = {9.0f, 5.0f, 1.6f}});
    const Material planet = makeMaterial("planet", {{0.16f, 0.26f, 0.40f}, {0.06f, 0.06f, 0.06f}, 6});
    const Material moon = makeMaterial("moon", {{0.32f, 0.28f, 0.25f}, {0, 0, 0}, 1});

    StillLife ship;
    ship.objects = {
        {"planet", Sphere{9}, planet, at({-7.5f, -9.2f, -13}), 2},
        {"moon", Sphere{0.75}, moon, at({4.6f, 3.1f, -12}), 1},
        {"hull", Capsule{0.46, 1.5}, hull, lengthwise(), 1},
        {"nose band", Torus{0.455, 0.035}, trim, at({1.35f, 0, 0}) * lengthwise(), 1},
        {"middle band", Torus{0.455, 0.035}, trim, at({-0.75f, 0, 0}) * lengthwise(), 1},
        {"bridge", Egg{0.26}, glass,
         at({1.25f, 0.33f, 0}) * turned(-72, {0, 0, 1}) * glm::scale(glm::mat4(1), {0.8f, 1, 1}), 1},
        {"habitat ring", Torus{1.32, 0.13}, ring, at({0.25f, 0, 0}) * lengthwise(), 1.6f},
        {"tower", Capsule{0.07, 0.32}, trim, at({-0.35f, 0.72f, 0}) * turned(18, {0, 0, 1}), 0.4f},
    };
    for (int i = 0; i < 4; ++i)
        ship.objects.push_back(
            {"spoke " + std::to_string(i + 1), Capsule{0.05, 0.62}, ring,
             at({0.25f, 0, 0}) * turned(45.0f + 90.0f * static_cast<float>(i), {1, 0, 0}) * at({0, 0.75f, 0}),
             0.35f});
    for (int i = 0; i < 3; ++i) {
        const glm::mat4 place =
            turned(90.0f + 120.0f * static_cast<float>(i), {1, 0, 0}) * at({-1.95f, 0, 0.34f}) * lengthwise();
        ship.objects.push_back(
            {"engine " + std::to_string(i + 1), Drum{0.23, 0.38, 0.07}, nozzle, place, 0.6f});
        ship.objects.push_back({"flame " + std::to_string(i + 1), Sphere{0.17}, flame,
                                place * at({0, -0.38f, 0}) * glm::scale(glm::mat4(1), {1, 1.7f, 1}), 0.5f});
    }
    for (int i = 0; i < 12; ++i) {
        const float angle = 2 * pi * (static_cast<float>(i) + 0.5f) / 12;
        ship.objects.push_back({"ring lamp " + std::to_string(i + 1), Sphere{0.04}, lamp,
                                at({0.12f, 1.32f * std::cos(angle), 1.32f * std::sin(angle)}), 0.25f});
    }
    for (int i = 0; i < 10; ++i)
        ship.objects.push_back({"window " + std::to_string(i + 1), Sphere{0.035}, lamp,
                                at({-0.55f + 0.17f * static_cast<float>(i), 0.13f, 0.44f}), 0.25f});

    Scene scene = tessellate(ship, segments);
    scene.name = "spaceship";
    Random random(2);
    scene.instances.push_back({"stars", scene.meshes.size(), scene.materials.size(), glm::mat4(1)});
    scene.meshes.push_back(stars(random));
    scene.materials.push_back(makeMaterial(
        "starlight",
        {.diffuse = {0, 0, 0}, .specular = {0, 0, 0}, .shininess = 1, .emission = {2.2f, 2.3f, 2.6f}}));

    Light sun;
    sun.name = "sun";
    sun.direction = glm::normalize(glm::vec3(-0.75f, -0.42f, -0.52f));
    sun.color = {1.0f, 0.93f, 0.82f};
    sun.intensity = 1.5f;
    Light glow;
    glow.name = "planetshine";
    glow.direction = glm::normalize(glm::vec3(0.45f, 0.8f, 0.25f));
    glow.color = {0.35f, 0.55f, 0.95f};
    glow.intensity = 0.22f;
    scene.lights = {sun, glow};

    Camera camera;
    camera.worldFromCamera = lookAt({-3.6f, 1.5f, 5.4f}, {0.0f, 0.02f, 0}, {0, 1, 0});
    camera.fovYRadians = 40 * pi / 180;
    camera.nearDistance = 0.5f;
    camera.farDistance = 120;
    scene.cameras = {camera};
    scene.ambientLight = {0.012f, 0.016f, 0.026f};
    scene.backgroundTop = {0.0012f, 0.0016f, 0.0045f};
    scene.backgroundBottom = {0.004f, 0.003f, 0.008f};
    return scene;
}

}  // namespace quincunx

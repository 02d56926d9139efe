#include "trace/path_scenes.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "base/random.h"
#include "math/transform.h"

namespace quincunx {
namespace {

Material matt(std::string name, glm::vec3 color) {
    Material material;
    material.name = std::move(name);
    material.baseColor = glm::vec4(color, 1);
    material.roughness = 0.9f;
    material.diffuse = color;
    material.specular = glm::vec3(0);
    return material;
}

Material metal(std::string name, glm::vec3 color, float roughness) {
    Material material = matt(std::move(name), color);
    material.metallic = 1;
    material.roughness = roughness;
    material.diffuse = glm::vec3(0.2f) * color;
    material.specular = color;
    return material;
}

Material glass(std::string name, glm::vec3 tint) {
    Material material = matt(std::move(name), tint);
    material.transmission = 1;
    material.ior = 1.5f;
    material.roughness = 0;
    return material;
}

/// A rectangle from a corner along two edges; its front is where `u` × `v` points.
void addPanel(Scene& scene, const std::string& name, Material material, glm::vec3 corner, glm::vec3 u,
              glm::vec3 v) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
    mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.instances.push_back({name, scene.meshes.size(), scene.materials.size(), glm::mat4(1)});
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back(std::move(material));
}

/// The walls of a box, fronts inwards: −x, +x, −y, +y, −z, +z.
void addRoom(Scene& scene, glm::vec3 min, glm::vec3 max, const std::array<Material, 6>& materials) {
    const glm::vec3 size = max - min;
    const glm::vec3 x(size.x, 0, 0);
    const glm::vec3 y(0, size.y, 0);
    const glm::vec3 z(0, 0, size.z);
    addPanel(scene, "left wall", materials[0], min, y, z);
    addPanel(scene, "right wall", materials[1], min + x, z, y);
    addPanel(scene, "floor", materials[2], min, z, x);
    addPanel(scene, "ceiling", materials[3], min + y, x, z);
    addPanel(scene, "back wall", materials[4], min, x, y);
    addPanel(scene, "front wall", materials[5], min + z, y, x);
}

void addSolid(PathSet& set, Shape shape, Material material, const glm::mat4& worldFromModel) {
    set.solids.push_back({std::move(shape), set.scene.materials.size(), worldFromModel});
    set.scene.materials.push_back(std::move(material));
}

glm::mat4 at(glm::vec3 position, float turn = 0, glm::vec3 axis = {0, 1, 0}) {
    return glm::rotate(glm::translate(glm::mat4(1), position), glm::radians(turn), axis);
}

void darken(Scene& scene) {
    scene.ambientLight = glm::vec3(0);
}

}  // namespace

PathSet makeChamber() {
    PathSet set;
    Scene& scene = set.scene;
    scene.name = "chamber";
    darken(scene);
    const Material plaster = matt("plaster", {0.74f, 0.71f, 0.66f});
    addRoom(scene, {-2, 0, -2}, {2, 3, 4.6f},
            {matt("petrol", {0.06f, 0.30f, 0.36f}), matt("fired clay", {0.62f, 0.19f, 0.09f}),
             matt("floor", {0.58f, 0.53f, 0.46f}), plaster, plaster, plaster});
    Material panel = matt("light", glm::vec3(0));
    panel.emission = {13.0f, 11.2f, 8.8f};
    addPanel(scene, "light", panel, {-0.7f, 2.98f, -0.6f}, {1.4f, 0, 0}, {0, 0, 1.4f});
    Material stone = matt("stone", {0.36f, 0.38f, 0.43f});
    stone.roughness = 0.35f;
    addSolid(set, Drum{0.62, 0.30, 0.05}, stone, at({-0.82f, 0.30f, -0.55f}));
    addSolid(set, Egg{0.42}, glass("glass", {0.97f, 0.99f, 0.98f}), at({-0.82f, 1.02f, -0.55f}));
    addSolid(set, Torus{0.62, 0.15}, metal("gold", {1.00f, 0.70f, 0.28f}, 0.18f),
             at({0.78f, 0.77f, -0.75f}, 90, glm::normalize(glm::vec3(1, 0, 0.45f))));
    addSolid(set, Sphere{0.34}, metal("steel", {0.62f, 0.64f, 0.68f}, 0.05f), at({0.22f, 0.34f, 0.55f}));
    addSolid(set, Sphere{0.22}, glass("water drop", {0.90f, 0.97f, 1.0f}), at({1.10f, 0.22f, 0.80f}));
    Camera camera;
    camera.worldFromCamera = lookAt({0.05f, 1.52f, 4.3f}, {0, 1.28f, 0}, {0, 1, 0});
    camera.fovYRadians = glm::radians(43.0f);
    scene.cameras = {camera};
    return set;
}

PathSet makeFurnace(float albedo) {
    PathSet set;
    set.model = OpaqueModel::lambert;
    set.scene.name = "furnace";
    darken(set.scene);
    Material wall = matt("wall", glm::vec3(albedo));
    wall.emission = glm::vec3(1);
    addRoom(set.scene, {-1, -1, -1}, {1, 1, 1}, {wall, wall, wall, wall, wall, wall});
    Camera camera;
    camera.worldFromCamera = lookAt({0.3f, 0.2f, 0.9f}, {-0.1f, -0.2f, -1}, {0, 1, 0});
    camera.fovYRadians = glm::radians(60.0f);
    set.scene.cameras = {camera};
    return set;
}

double furnaceRadiance(double albedo) {
    return 1 / (1 - albedo);
}

PathSet makeShell(float inner, float innerAlbedo, float outerAlbedo) {
    PathSet set;
    set.model = OpaqueModel::lambert;
    set.scene.name = "shell";
    darken(set.scene);
    Material ball = matt("ball", glm::vec3(innerAlbedo));
    ball.emission = glm::vec3(1);
    addSolid(set, Sphere{inner}, ball, glm::mat4(1));
    addSolid(set, Sphere{1}, matt("shell", glm::vec3(outerAlbedo)), glm::mat4(1));
    Camera camera;
    camera.worldFromCamera = lookAt({0, 0, 0.5f * (1 + inner)}, {0, 0, 0}, {0, 1, 0});
    camera.fovYRadians = glm::radians(100.0f);
    set.scene.cameras = {camera};
    return set;
}

ShellRadiance shellRadiance(double inner, double innerAlbedo, double outerAlbedo) {
    // ball = 1 + innerAlbedo shell; shell = outerAlbedo (f ball + (1 − f) shell).
    const double f = inner * inner;
    const double shell = outerAlbedo * f / (1 - outerAlbedo * (1 - f) - outerAlbedo * f * innerAlbedo);
    return {1 + innerAlbedo * shell, shell};
}

PathSet makeBallOverFloor(float albedo, float radius, float height) {
    PathSet set;
    set.model = OpaqueModel::lambert;
    set.scene.name = "ball over a floor";
    darken(set.scene);
    addPanel(set.scene, "floor", matt("floor", glm::vec3(albedo)), {-100, 0, -100}, {0, 0, 200}, {200, 0, 0});
    Material ball = matt("ball", glm::vec3(0));
    ball.emission = glm::vec3(1);
    addSolid(set, Sphere{radius}, ball, at({0, height, 0}));
    Camera camera;
    camera.worldFromCamera = lookAt({0, 2, 6}, {0, 0.6f, 0}, {0, 1, 0});
    set.scene.cameras = {camera};
    return set;
}

double ballOverFloorRadiance(double albedo, double radius, double height, double distanceOnFloor) {
    const double distance = std::hypot(height, distanceOnFloor);
    return albedo * (height / distance) * (radius / distance) * (radius / distance);
}

PathSet makeBallField(std::uint64_t seed) {
    PathSet set;
    set.model = OpaqueModel::lambert;
    Scene& scene = set.scene;
    scene.name = "field of balls";
    darken(scene);
    Random random(seed);
    const auto color = [&](double low, double high) {
        return glm::vec3(random.uniform(low, high), random.uniform(low, high), random.uniform(low, high));
    };
    addSolid(set, Sphere{1000}, matt("ground", glm::vec3(0.48f)), at({0, -1000, 0}));
    addSolid(set, Sphere{1}, glass("big glass", glm::vec3(1)), at({0, 1, 0}));
    addSolid(set, Sphere{1}, matt("big clay", {0.42f, 0.18f, 0.10f}), at({-4, 1, 0}));
    addSolid(set, Sphere{1}, metal("big metal", {0.72f, 0.61f, 0.50f}, 0), at({4, 1, 0}));
    for (int row = -11; row < 11; ++row)
        for (int column = -11; column < 11; ++column) {
            const glm::vec3 centre(static_cast<double>(row) + random.uniform(0.05, 0.85), 0.2f,
                                   static_cast<double>(column) + random.uniform(0.05, 0.85));
            const double kind = random.uniformDouble();
            const glm::vec3 tone = kind < 0.8 ? color(0, 1) * color(0, 1) : color(0.5, 1);
            const auto roughness = static_cast<float>(random.uniform(0, 0.6));
            if (glm::distance(centre, glm::vec3(4, 0.2f, 0)) < 0.9f)
                continue;
            addSolid(set, Sphere{0.2},
                     kind < 0.8    ? matt("matt", tone)
                     : kind < 0.95 ? metal("metal", tone, roughness)
                                   : glass("glass", glm::vec3(1)),
                     at(centre));
        }
    Environment& sky = scene.environment.emplace();
    sky.panorama = Image(1, 32, 3, Encoding::linear);
    for (int y = 0; y < 32; ++y) {
        const double up = std::cos(3.14159265358979 * (y + 0.5) / 32);
        const auto share = static_cast<float>(0.5 * (up + 1));
        const glm::vec3 light = glm::mix(glm::vec3(1), glm::vec3(0.5f, 0.7f, 1), share);
        for (int c = 0; c < 3; ++c)
            sky.panorama.pixel(0, y)[c] = light[c];
    }
    Camera camera;
    camera.worldFromCamera = lookAt({13, 2, 3}, {0, 0, 0}, {0, 1, 0});
    camera.fovYRadians = glm::radians(20.0f);
    camera.apertureRadius = 0.05f;
    camera.focusDistance = 10;
    scene.cameras = {camera};
    return set;
}

}  // namespace quincunx

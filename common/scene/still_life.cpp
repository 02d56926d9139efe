#include "scene/still_life.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;

/// A chess pawn standing on y = 0: base ring, hollow stem, collar, head.
Turned pawn() {
    constexpr double head = 0.36;
    constexpr double neck = 0.10;
    // The neck's arc touches the head 40 degrees below its equator.
    const double neckStart = (head + neck) * std::cos(40 * std::numbers::pi / 180);
    Lathe lathe(0);
    lathe.line(0.46).arc(0.11, 180).line(0.04).arc(0.24, -90).line(0.14).arc(0.08, -90).line(0.11).arc(0.06,
                                                                                                       180);
    return lathe.line(lathe.position().x - neckStart).arc(neck, -130).arc(head, 130).finish();
}

/// A vase standing on y = 0: foot ring, belly, neck, flared lip, and a throat with a round floor.
Turned vase() {
    constexpr double flare = 0.22;
    constexpr double lip = 0.035;
    Lathe lathe(0);
    lathe.line(0.30).arc(0.05, 180).arc(0.06, -150).arc(0.55, 120).arc(0.20, -60);
    lathe.arc(flare, -65).arc(lip, 180).arc(flare + 2 * lip, 65).line(0.30);
    return lathe.arc(lathe.position().x, -90).finish();
}

glm::mat4 at(float x, float y, float z) {
    return glm::translate(glm::mat4(1), {x, y, z});
}

glm::mat4 tilted(float degrees, const glm::vec3& axis) {
    return glm::rotate(glm::mat4(1), degrees * degree, axis);
}

Camera cameraLooking(const glm::vec3& from, const glm::vec3& to, float fovYRadians) {
    const glm::vec3 back = glm::normalize(from - to);
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back));
    const glm::vec3 up = glm::cross(back, right);
    Camera camera;
    camera.worldFromCamera =
        glm::mat4(glm::vec4(right, 0), glm::vec4(up, 0), glm::vec4(back, 0), glm::vec4(from, 1));
    camera.fovYRadians = fovYRadians;
    camera.nearDistance = 1;
    camera.farDistance = 40;
    return camera;
}

}  // namespace

StillLife makeStillLife() {
    const Material lacquer = makeMaterial("black lacquer", {.diffuse = {0.022f, 0.019f, 0.021f},
                                                            .specular = {0.085f, 0.075f, 0.07f},
                                                            .shininess = 9,
                                                            .metallic = 0,
                                                            .roughness = 0.35f});
    const Material brass = makeMaterial("brass", {.diffuse = {0.16f, 0.085f, 0.02f},
                                                  .specular = {0.95f, 0.66f, 0.28f},
                                                  .shininess = 36,
                                                  .metallic = 1,
                                                  .roughness = 0.3f});
    const Material gold = makeMaterial("gold", {.diffuse = {0.4f, 0.205f, 0.03f},
                                                .specular = {1, 0.7f, 0.26f},
                                                .shininess = 30,
                                                .metallic = 1,
                                                .roughness = 0.25f});
    const Material pearl = makeMaterial("pearl", {.diffuse = {0.5f, 0.43f, 0.41f},
                                                  .specular = {0.42f, 0.4f, 0.4f},
                                                  .shininess = 50,
                                                  .metallic = 0,
                                                  .roughness = 0.25f,
                                                  .emission = {0.11f, 0.055f, 0.04f}});
    const Material ivory = makeMaterial("ivory", {.diffuse = {0.7f, 0.57f, 0.37f},
                                                  .specular = {0.2f, 0.18f, 0.15f},
                                                  .shininess = 14,
                                                  .metallic = 0,
                                                  .roughness = 0.45f});
    const Material jade = makeMaterial("jade", {.diffuse = {0.04f, 0.31f, 0.155f},
                                                .specular = {0.45f, 0.52f, 0.46f},
                                                .shininess = 60,
                                                .metallic = 0,
                                                .roughness = 0.25f});
    const Material glaze = makeMaterial("red glaze", {.diffuse = {0.44f, 0.012f, 0.01f},
                                                      .specular = {0.8f, 0.76f, 0.72f},
                                                      .shininess = 300,
                                                      .metallic = 0,
                                                      .roughness = 0.12f});
    const Material ultramarine = makeMaterial("ultramarine", {.diffuse = {0.018f, 0.04f, 0.42f},
                                                              .specular = {0.45f, 0.5f, 0.62f},
                                                              .shininess = 90,
                                                              .metallic = 0,
                                                              .roughness = 0.2f});

    StillLife scene;
    scene.objects = {
        {"plinth", Drum{2.6, 0.20, 0.08}, lacquer, at(0, -0.20f, 0)},
        {"band", Torus{2.60, 0.045}, brass, at(0, -0.22f, 0)},
        {"pearl", Sphere{0.64}, pearl, at(0, 0.64f, 0)},
        {"ring", Torus{0.86, 0.115}, gold,
         at(0, 0.64f, 0) * tilted(27, glm::normalize(glm::vec3(1, 0, 0.9f)))},
        {"pawn", pawn(), ivory, at(-1.32f, 0, -1.12f)},
        {"vase", vase(), jade, at(1.32f, 0, -1.12f)},
        {"egg", Egg{0.44}, glaze, at(-1.30f, 0.44f, 1.20f) * tilted(-13, {0, 0, 1})},
        {"wreath", Torus{0.42, 0.19}, ultramarine, at(1.30f, 0.19f, 1.18f)},
    };

    Light key;
    key.kind = Light::Kind::point;
    key.name = "warm key";
    key.position = {-4.6f, 4.4f, 2.6f};
    key.color = {1.0f, 0.84f, 0.64f};
    key.intensity = 44;
    Light rim;
    rim.kind = Light::Kind::directional;
    rim.name = "cool rim";
    rim.direction = glm::normalize(glm::vec3(-0.95f, -0.42f, 0.50f));
    rim.color = {0.42f, 0.62f, 1.0f};
    rim.intensity = 0.95f;
    scene.lights = {key, rim};

    scene.camera = cameraLooking({1.5f, 4.3f, 8.3f}, {0, 0.24f, 0.05f}, 30 * degree);
    scene.ambientLight = {0.075f, 0.082f, 0.105f};
    scene.backgroundTop = {0.008f, 0.012f, 0.024f};
    scene.backgroundBottom = {0.062f, 0.046f, 0.044f};
    return scene;
}

Scene tessellate(const StillLife& stillLife, int segments) {
    Scene scene;
    scene.name = "still life";
    for (const StillLife::Object& object : stillLife.objects) {
        scene.instances.push_back(
            {object.name, scene.meshes.size(), scene.materials.size(), object.worldFromModel});
        const long scaled = std::lround(static_cast<float>(segments) * object.detail);
        scene.meshes.push_back(
            tessellate(object.shape, static_cast<int>(std::clamp(scaled, 3L, 4096L)), object.name));
        scene.materials.push_back(object.material);
    }
    scene.lights = stillLife.lights;
    scene.cameras = {stillLife.camera};
    scene.ambientLight = stillLife.ambientLight;
    scene.backgroundTop = stillLife.backgroundTop;
    scene.backgroundBottom = stillLife.backgroundBottom;
    return scene;
}

}  // namespace quincunx

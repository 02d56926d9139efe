#include "scene/colonnade.h"

#include <cmath>
#include <numbers>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "math/transform.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;
constexpr int columnCount = 10;
constexpr float ringRadius = 3.2f;
constexpr float gapAzimuth = 14 * degree;

glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1), position);
}

/// A column of height 2.9 standing on y = 0: base, tapering shaft in three drums' width, capital.
Turned column() {
    Lathe lathe(0);
    lathe.line(0.28).arc(0.06, 180).line(0.04).arc(0.04, -90).line(2.42);
    lathe.arc(0.05, -90).line(0.06).arc(0.05, 180).line(0.03);
    return lathe.line(lathe.position().x).finish();
}

}  // namespace

StillLife makeColonnade() {
    const Material terrace = makeMaterial("sandstone", {{0.56f, 0.46f, 0.34f}, {0.02f, 0.02f, 0.02f}, 12});
    const Material marble = makeMaterial("marble", {{0.74f, 0.71f, 0.66f}, {0.10f, 0.10f, 0.10f}, 40});
    const Material gold = makeMaterial("gold", {{0.56f, 0.31f, 0.06f}, {1.0f, 0.75f, 0.35f}, 60});
    const Material terracotta =
        makeMaterial("terracotta", {{0.55f, 0.17f, 0.08f}, {0.05f, 0.05f, 0.05f}, 16});
    const Material verdigris = makeMaterial("verdigris", {{0.09f, 0.33f, 0.28f}, {0.22f, 0.3f, 0.28f}, 30});
    const Material lapis = makeMaterial("lapis", {{0.05f, 0.10f, 0.42f}, {0.4f, 0.4f, 0.45f}, 80});

    StillLife scene;
    scene.objects = {
        {"terrace", Drum{15, 0.3, 0.1}, terrace, at({0, -0.3f, 0}), 2},
        {"lower step", Drum{4.3, 0.12, 0.03}, marble, at({0, 0.12f, 0}), 2},
        {"upper step", Drum{3.8, 0.12, 0.03}, marble, at({0, 0.36f, 0}), 2},
        {"stone ring", Torus{ringRadius, 0.26}, marble, at({0, 3.45f, 0}), 2.5f},
        {"pedestal", Drum{0.62, 0.42, 0.05}, verdigris, at({0, 0.9f, 0}), 1},
        {"golden egg", Egg{0.52}, gold, at({0, 1.83f, 0}), 1},
        {"terracotta ball", Sphere{0.62}, terracotta, at({-2.95f, 0.62f, 4.7f}), 1},
        {"lapis ball", Sphere{0.34}, lapis, at({-1.75f, 0.34f, 5.5f}), 1},
        {"obelisk", Capsule{0.16, 1.1}, verdigris,
         at({4.5f, 1.2f, 4.2f}) * glm::rotate(glm::mat4(1), 11 * degree, {0, 0, 1}), 0.7f},
        {"hoop", Torus{0.62, 0.07}, gold,
         at({1.5f, 0.68f, 5.5f}) * glm::rotate(glm::mat4(1), 84 * degree, {1, 0.25f, 0}), 1},
    };
    for (int i = 0; i < columnCount; ++i) {
        // A gap in the ring looks at the camera.
        const float turn = gapAzimuth + (static_cast<float>(i) + 0.5f) * 2 * std::numbers::pi_v<float> /
                                            static_cast<float>(columnCount);
        scene.objects.push_back({"column " + std::to_string(i + 1), column(), marble,
                                 at({ringRadius * std::sin(turn), 0.48f, ringRadius * std::cos(turn)}),
                                 0.5f});
    }

    Light sun;
    sun.kind = Light::Kind::directional;
    sun.name = "sun";
    sun.direction = glm::normalize(glm::vec3(-0.62f, -0.62f, -0.48f));
    sun.color = {1.0f, 0.88f, 0.70f};
    sun.intensity = 1.15f;
    scene.lights = {sun};

    scene.camera.worldFromCamera = lookAt({3.4f, 6.1f, 13.0f}, {0.15f, 1.15f, 0.6f}, {0, 1, 0});
    scene.camera.fovYRadians = 34 * degree;
    scene.camera.nearDistance = 0.5f;
    scene.camera.farDistance = 60;
    scene.ambientLight = {0.20f, 0.26f, 0.36f};
    scene.backgroundTop = {0.13f, 0.28f, 0.56f};
    scene.backgroundBottom = {0.72f, 0.66f, 0.56f};
    return scene;
}

}  // namespace quincunx

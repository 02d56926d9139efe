#include "scene/mirror_hall.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "math/transform.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;

Material matt(std::string name, glm::vec3 color, glm::vec3 emission = glm::vec3(0)) {
    return makeMaterial(std::move(name),
                        {.diffuse = color, .specular = glm::vec3(0), .shininess = 1, .emission = emission});
}

glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1), position);
}

glm::mat4 tilted(float degrees, glm::vec3 axis) {
    return glm::rotate(glm::mat4(1), degrees * degree, axis);
}

/// A column standing on y = 0, with base and capital.
Turned column() {
    Lathe lathe(0);
    lathe.line(0.30).arc(0.06, 180).line(0.05).arc(0.04, -90).line(2.3);
    lathe.arc(0.05, -90).line(0.07).arc(0.06, 180).line(0.03);
    return lathe.line(lathe.position().x).finish();
}

/// Adds the quad of one tile to a mesh.
void addTile(Mesh& mesh, const Tiling& tiling, glm::vec3 normal, int i, int j) {
    const auto corner = [&](int u, int v) {
        const auto share = [](int k, int count) { return static_cast<float>(k) / static_cast<float>(count); };
        return tiling.corner + share(u, tiling.countU) * tiling.edgeU +
               share(v, tiling.countV) * tiling.edgeV;
    };
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
    mesh.normals.insert(mesh.normals.end(), 4, normal);
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

void addInstance(Scene& scene, Mesh mesh, const Material& material, const glm::mat4& worldFromModel) {
    if (mesh.indices.empty())
        return;
    scene.instances.push_back({mesh.name, scene.meshes.size(), scene.materials.size(), worldFromModel});
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back(material);
}

void addTiling(Scene& scene, const Tiling& tiling) {
    const glm::vec3 normal = glm::normalize(glm::cross(tiling.edgeU, tiling.edgeV));
    Mesh even{.name = tiling.name};
    Mesh odd{.name = tiling.name + ", other tiles"};
    for (int j = 0; j < tiling.countV; ++j)
        for (int i = 0; i < tiling.countU; ++i)
            addTile((i + j) % 2 == 0 ? even : odd, tiling, normal, i, j);
    addInstance(scene, std::move(even), tiling.even, glm::mat4(1));
    addInstance(scene, std::move(odd), tiling.odd, glm::mat4(1));
}

}  // namespace

MirrorHall makeMirrorHall() {
    MirrorHall hall;
    const glm::vec3 low(-5.5f, 0, -6.5f);
    const glm::vec3 high(5.5f, 5.5f, 6.5f);
    hall.walls = {low, high};
    const glm::vec3 x(high.x - low.x, 0, 0);
    const glm::vec3 y(0, high.y - low.y, 0);
    const glm::vec3 z(0, 0, high.z - low.z);

    const Material cream = matt("cream stone", {0.72f, 0.66f, 0.55f});
    const Material slate = matt("slate", {0.10f, 0.11f, 0.13f});
    const Material plaster = matt("plaster", {0.74f, 0.70f, 0.63f});
    const Material plasterShade = matt("plaster, darker", {0.66f, 0.61f, 0.54f});
    const Material rust = matt("rust", {0.58f, 0.20f, 0.10f});
    const Material rustShade = matt("rust, darker", {0.47f, 0.15f, 0.08f});
    const Material teal = matt("teal", {0.06f, 0.30f, 0.34f});
    const Material tealShade = matt("teal, darker", {0.04f, 0.22f, 0.26f});
    const Material oak = matt("oak", {0.28f, 0.16f, 0.08f});
    const Material oakShade = matt("oak, darker", {0.20f, 0.11f, 0.05f});
    const Material brass = matt("brass", {0.62f, 0.43f, 0.14f});

    // Each seen from inside.
    hall.tilings = {
        {"floor", {low.x, low.y, high.z}, x, -z, 11, 13, cream, slate},
        {"ceiling", {low.x, high.y, low.z}, x, z, 8, 9, oak, oakShade},
        {"back wall", low, x, y, 11, 6, plaster, plasterShade},
        {"front wall", {high.x, low.y, high.z}, -x, y, 11, 6, plaster, plasterShade},
        {"left wall", {low.x, low.y, high.z}, -z, y, 13, 6, rust, rustShade},
        {"right wall", {high.x, low.y, low.z}, z, y, 13, 6, teal, tealShade},
    };
    const float lift = 0.02f;  // of what lies on a wall, off it
    const Material frame = matt("window frame", {0.85f, 0.82f, 0.75f});
    for (int i = 0; i < 3; ++i) {
        const float left = -4.1f + 3.0f * static_cast<float>(i);
        const Material day =
            matt("daylight", glm::vec3(0), glm::vec3(0.62f, 0.80f, 1.0f) * (i == 1 ? 1.25f : 1.1f));
        hall.tilings.push_back({"window frame",
                                {left - 0.15f, 1.25f, low.z + 0.5f * lift},
                                {2.5f, 0, 0},
                                {0, 3.3f, 0},
                                1,
                                1,
                                frame,
                                frame});
        for (int pane = 0; pane < 6; ++pane)
            hall.tilings.push_back({"window pane",
                                    {left + 1.13f * static_cast<float>(pane % 2),
                                     1.4f + 1.02f * static_cast<float>(pane / 2), low.z + lift},
                                    {1.07f, 0, 0},
                                    {0, 0.96f, 0},
                                    1,
                                    1,
                                    day,
                                    day});
    }
    const Material lamp = matt("ceiling lamp", glm::vec3(0), {1.5f, 1.2f, 0.8f});
    for (const float along : {-3.4f, 1.2f})
        hall.tilings.push_back(
            {"ceiling lamp", {-1.5f, high.y - lift, along}, {3, 0, 0}, {0, 0, 1.4f}, 1, 1, lamp, lamp});
    const Material door = matt("door", {0.16f, 0.09f, 0.05f});
    hall.tilings.push_back(
        {"door", {1.2f, 0.01f, high.z - lift}, {-2.4f, 0, 0}, {0, 3.3f, 0}, 2, 3, door, oak});

    hall.ball = {{-1.45f, 1.62f, -0.5f}, 0.95f};
    hall.ballTint = {0.95f, 0.94f, 0.92f};
    const glm::vec3 panelCorner(0.0f, lift, 1.75f);
    const glm::vec3 panelU(3.4f, 0, 0);
    const glm::vec3 panelV(0, 0, -3.4f);
    hall.panel = {"mirror in the floor", panelCorner, panelU, panelV, 1, 1, brass, brass};
    hall.panelTint = {0.86f, 0.90f, 0.93f};
    const float rim = 0.12f;
    const auto addRim = [&](glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
        hall.tilings.push_back({"brass rim", corner, u, v, 1, 1, brass, brass});
    };
    const glm::vec3 outerU(panelU.x + 2 * rim, 0, 0);
    addRim(panelCorner + glm::vec3(-rim, 0, rim), outerU, {0, 0, -rim});
    addRim(panelCorner + panelV + glm::vec3(-rim, 0, 0), outerU, {0, 0, -rim});
    addRim(panelCorner + glm::vec3(-rim, 0, 0), {rim, 0, 0}, panelV);
    addRim(panelCorner + panelU, {rim, 0, 0}, panelV);

    const Material marble = matt("marble", {0.80f, 0.77f, 0.71f});
    const Material vermilion = matt("vermilion", {0.72f, 0.10f, 0.05f});
    const Material ochre = matt("ochre", {0.80f, 0.48f, 0.09f});
    const Material ultramarine = matt("ultramarine", {0.07f, 0.12f, 0.52f});
    const Material leaf = matt("leaf green", {0.16f, 0.42f, 0.12f});
    hall.contents.objects = {
        {"plinth", Drum{0.62, 0.32, 0.06}, oak, at({-1.45f, 0.33f, -0.5f}), 1},
        {"left column", column(), marble, at({0.55f, 0, -3.0f}), 1},
        {"right column", column(), marble, at({3.15f, 0, -3.0f}), 1},
        {"ring", Torus{0.62, 0.17}, vermilion,
         at({1.85f, 0.79f, -2.7f}) * tilted(90, {1, 0, 0}) * tilted(24, {0, 0, 1}), 1},
        {"egg", Egg{0.42}, ochre, at({4.25f, 0.42f, -0.4f}), 1},
        {"blue ball", Sphere{0.46}, ultramarine, at({-3.1f, 0.46f, 0.9f}), 1},
        {"green ball", Sphere{0.30}, leaf, at({-0.55f, 0.30f, 1.35f}), 1},
        {"pill", Capsule{0.24, 0.62}, leaf, at({-3.5f, 0.86f, -2.2f}), 1},
        {"drum", Drum{0.42, 0.55, 0.07}, vermilion, at({-2.6f, 0.55f, 2.7f}), 1},
        {"yellow ring", Torus{0.5, 0.14}, ochre, at({1.2f, 0.14f, 3.7f}), 1},
    };

    Light daylight;
    daylight.kind = Light::Kind::point;
    daylight.name = "daylight";
    daylight.position = {0.4f, 3.6f, -3.4f};
    daylight.color = {0.70f, 0.85f, 1.0f};
    daylight.intensity = 3.2f;
    Light evening;
    evening.kind = Light::Kind::point;
    evening.name = "lamp";
    evening.position = {-0.4f, 4.4f, 2.4f};
    evening.color = {1.0f, 0.80f, 0.52f};
    evening.intensity = 10;
    hall.contents.lights = {daylight, evening};
    hall.contents.ambientLight = {0.20f, 0.21f, 0.25f};
    hall.contents.camera.worldFromCamera = lookAt({0.95f, 3.0f, 6.2f}, {0.60f, 0.98f, -0.6f}, {0, 1, 0});
    hall.contents.camera.fovYRadians = 48 * degree;
    hall.contents.camera.nearDistance = 0.1f;
    hall.contents.camera.farDistance = 2000;
    return hall;
}

MirrorHall emptied(MirrorHall hall) {
    hall.contents.objects.clear();
    return hall;
}

MirrorHall movedAway(MirrorHall hall, glm::vec3 centre, float factor) {
    const auto move = [&](glm::vec3 p) { return centre + factor * (p - centre); };
    for (Tiling& tiling : hall.tilings) {
        tiling.corner = move(tiling.corner);
        tiling.edgeU *= factor;
        tiling.edgeV *= factor;
    }
    hall.walls = {move(hall.walls.min), move(hall.walls.max)};
    const glm::mat4 place = at(centre) * glm::scale(glm::mat4(1), glm::vec3(factor)) * at(-centre);
    for (StillLife::Object& object : hall.contents.objects)
        object.worldFromModel = place * object.worldFromModel;
    for (Light& light : hall.contents.lights) {
        light.position = move(light.position);
        light.intensity *= factor * factor;
    }
    return hall;
}

MirrorHall turnedSolids(MirrorHall hall, glm::vec3 about, float radians) {
    const glm::mat4 turn = at(about) * glm::rotate(glm::mat4(1), radians, {0, 1, 0}) * at(-about);
    for (StillLife::Object& object : hall.contents.objects)
        object.worldFromModel = turn * object.worldFromModel;
    return hall;
}

Scene tessellate(const MirrorHall& hall, int segments) {
    Scene scene = tessellate(hall.contents, segments);
    scene.name = "mirror hall";
    for (const Tiling& tiling : hall.tilings)
        addTiling(scene, tiling);
    return scene;
}

Scene tessellateMirrors(const MirrorHall& hall, bool ball, bool panel, int segments) {
    Scene scene;
    scene.name = "mirrors";
    const auto mirror = [](std::string name, glm::vec3 tint) {
        return makeMaterial(std::move(name), {.diffuse = glm::vec3(0), .specular = tint});
    };
    if (ball)
        addInstance(scene, tessellate(Sphere{hall.ball.radius}, segments, "ball"),
                    mirror("ball", hall.ballTint), at(hall.ball.centre));
    if (panel) {
        Tiling tiling = hall.panel;
        tiling.even = mirror("panel", hall.panelTint);
        addTiling(scene, tiling);
    }
    return scene;
}

}  // namespace quincunx

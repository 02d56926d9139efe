#include "labs/21_accumulation/toy_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "geometry/mesh_builder.h"
#include "geometry/shapes.h"
#include "math/transform.h"
#include "scene/animation.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr int quarterTurns = 12;  // of the pinwheel in a round
constexpr float trainFrom = -5.2f;
constexpr float trainTo = 4.4f;
constexpr float railZ = -1.45f;
constexpr glm::vec3 hub{2.05f, 2.25f, -2.6f};

glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1), position);
}

/// Puts a scene together.
class Table {
  public:
    explicit Table(int segments) : segments_(segments) {}

    std::size_t material(const std::string& name, const Finish& finish) {
        scene.materials.push_back(makeMaterial(name, finish));
        return scene.materials.size() - 1;
    }
    std::size_t place(Mesh mesh, std::size_t material, const glm::mat4& worldFromModel) {
        scene.instances.push_back({mesh.name, scene.meshes.size(), material, worldFromModel});
        scene.meshes.push_back(std::move(mesh));
        return scene.instances.size() - 1;
    }
    std::size_t place(const std::string& name, const Shape& shape, std::size_t material,
                      const glm::mat4& worldFromModel, float detail = 1) {
        const auto segments = std::lround(static_cast<float>(segments_) * detail);
        return place(tessellate(shape, static_cast<int>(std::clamp(segments, 3L, 4096L)), name), material,
                     worldFromModel);
    }
    /// What is placed in the node's frame, and goes where it goes.
    void attach(std::size_t instance, std::size_t node) {
        scene.attachments.push_back(
            {Attachment::Thing::instance, instance, node, scene.instances[instance].worldFromModel});
    }
    std::size_t node(const std::string& name, glm::vec3 translation) {
        scene.nodes.push_back({.name = name, .translation = translation});
        return scene.nodes.size() - 1;
    }
    int sides() const { return std::max(segments_, 6); }

    Scene scene;

  private:
    int segments_;
};

/// White, with threads of one colour both ways.
Texture gingham() {
    constexpr int side = 64;
    Texture texture;
    texture.name = "gingham";
    texture.image = Image8(side, side, 4, Encoding::srgb);
    constexpr std::array<std::array<int, 3>, 3> colors = {{{238, 232, 220}, {150, 176, 190}, {64, 108, 138}}};
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const int threads = (x >= side / 2 ? 1 : 0) + (y >= side / 2 ? 1 : 0);
            for (int c = 0; c < 3; ++c)
                texture.image.pixel(x, y)[c] = static_cast<std::uint8_t>(
                    colors[static_cast<std::size_t>(threads)][static_cast<std::size_t>(c)]);
            texture.image.pixel(x, y)[3] = 255;
        }
    return texture;
}

void addCloth(Table& table) {
    constexpr float half = 11;
    constexpr float tile = 1.1f;
    Mesh cloth{.name = "cloth",
               .positions = {{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}},
               .normals = std::vector<glm::vec3>(4, glm::vec3(0, 1, 0)),
               .texcoords = {},
               .indices = {0, 1, 2, 0, 2, 3}};
    for (const glm::vec3& p : cloth.positions)
        cloth.texcoords.emplace_back(p.x / tile, p.z / tile);
    const std::size_t linen = table.material(
        "linen", {.diffuse = glm::vec3(0.75f), .specular = glm::vec3(0.02f), .roughness = 0.9f});
    table.scene.textures.push_back(gingham());
    table.scene.materials[linen].baseColorTexture = TextureUse(table.scene.textures.size() - 1);
    table.place(std::move(cloth), linen, glm::mat4(1));
}

void addDolls(Table& table) {
    const std::size_t wood = table.material(
        "limewood", {.diffuse = {0.70f, 0.47f, 0.27f}, .specular = glm::vec3(0.12f), .shininess = 18});
    constexpr std::array<glm::vec3, 5> coats = {{{0.62f, 0.05f, 0.045f},
                                                 {0.80f, 0.36f, 0.03f},
                                                 {0.06f, 0.34f, 0.12f},
                                                 {0.03f, 0.14f, 0.45f},
                                                 {0.30f, 0.05f, 0.33f}}};
    for (std::size_t i = 0; i < coats.size(); ++i) {
        const auto number = static_cast<float>(i);
        const glm::vec3 foot(2.0f - 1.12f * number, 0, 4.1f - 2.15f * number);
        const std::string name = "doll " + std::to_string(i + 1);
        const std::size_t coat = table.material(
            name + "'s coat", {.diffuse = coats[i], .specular = glm::vec3(0.35f), .shininess = 60});
        table.place(name + "'s body", Capsule{0.27, 0.22}, coat, at(foot + glm::vec3(0, 0.49f, 0)));
        table.place(name + "'s head", Sphere{0.24}, wood, at(foot + glm::vec3(0, 1.10f, 0)));
    }
}

void addTrain(Table& table) {
    const std::size_t red = table.material(
        "red paint", {.diffuse = {0.55f, 0.03f, 0.03f}, .specular = glm::vec3(0.3f), .shininess = 50});
    const std::size_t blue = table.material(
        "blue paint", {.diffuse = {0.03f, 0.13f, 0.40f}, .specular = glm::vec3(0.3f), .shininess = 50});
    const std::size_t black = table.material(
        "black paint", {.diffuse = glm::vec3(0.03f), .specular = glm::vec3(0.25f), .shininess = 40});
    const std::size_t brass = table.material("brass", {.diffuse = {0.30f, 0.18f, 0.04f},
                                                       .specular = {0.9f, 0.65f, 0.28f},
                                                       .shininess = 36,
                                                       .metallic = 1,
                                                       .roughness = 0.3f});
    const int sides = table.sides();
    MeshBuilder body;
    MeshBuilder wagon;
    MeshBuilder iron;
    MeshBuilder fittings;
    body.box({-0.95f, 0.22f, -0.36f}, {0.95f, 0.40f, 0.36f});   // frame
    body.box({-0.90f, 0.40f, -0.34f}, {-0.22f, 1.12f, 0.34f});  // cab
    iron.box({-1.0f, 1.12f, -0.42f}, {-0.12f, 1.22f, 0.42f});   // its roof
    const std::array boiler = {glm::vec3(-0.22f, 0.68f, 0), glm::vec3(0.92f, 0.68f, 0)};
    body.tube(boiler, 0.30f, sides);
    for (const float x : {0.06f, 0.86f}) {
        const std::array band = {glm::vec3(x, 0.68f, 0), glm::vec3(x + 0.07f, 0.68f, 0)};
        fittings.tube(band, 0.315f, sides);
    }
    iron.column({0.66f, 0.94f, 0}, 0.36f, 0.09f, 0.15f, sides);  // chimney
    fittings.column({0.28f, 0.94f, 0}, 0.16f, 0.10f, 0.07f, sides);
    for (const float x : {-1.95f, -3.55f}) {
        wagon.box({x - 0.62f, 0.24f, -0.36f}, {x + 0.62f, 0.34f, 0.36f});
        for (const float z : {-0.36f, 0.30f})
            wagon.box({x - 0.62f, 0.34f, z}, {x + 0.62f, 0.66f, z + 0.06f});
        for (const float end : {-0.62f, 0.56f})
            wagon.box({x + end, 0.34f, -0.30f}, {x + end + 0.06f, 0.66f, 0.30f});
        iron.box({x + 0.62f, 0.26f, -0.05f}, {x + 1.0f, 0.32f, 0.05f});  // coupling
    }
    const auto wheel = [&](float x, float radius) {
        for (const float z : {-0.45f, 0.37f}) {
            const std::array axle = {glm::vec3(x, radius, z), glm::vec3(x, radius, z + 0.08f)};
            iron.tube(axle, radius, sides);
        }
    };
    for (const float x : {-0.6f, 0.02f, 0.62f})
        wheel(x, 0.26f);
    for (const float x : {-2.32f, -1.58f, -3.92f, -3.18f})
        wheel(x, 0.2f);
    const std::size_t train = table.node("train", {trainFrom, 0, railZ});
    table.attach(table.place(body.take("locomotive"), red, glm::mat4(1)), train);
    table.attach(table.place(wagon.take("wagons"), blue, glm::mat4(1)), train);
    table.attach(table.place(iron.take("iron"), black, glm::mat4(1)), train);
    table.attach(table.place(fittings.take("fittings"), brass, glm::mat4(1)), train);
    constexpr std::array<glm::vec3, 4> loads = {
        {{-1.68f, 0.60f, 0.03f}, {-2.22f, 0.60f, -0.04f}, {-3.28f, 0.60f, -0.02f}, {-3.82f, 0.60f, 0.05f}}};
    for (std::size_t i = 0; i < loads.size(); ++i)
        table.attach(table.place("load " + std::to_string(i + 1), Sphere{0.25}, i % 2 == 0 ? brass : red,
                                 at(loads[i])),
                     train);
    Animation ride{.name = "ride"};
    ride.samplers.push_back({.seconds = {0, static_cast<float>(roundSeconds)},
                             .values = {{trainFrom, 0, railZ, 0}, {trainTo, 0, railZ, 0}}});
    ride.channels.push_back({0, train, Animation::Path::translation});
    table.scene.animations.push_back(std::move(ride));
}

void addPinwheel(Table& table) {
    const std::size_t stick = table.material(
        "stick", {.diffuse = {0.45f, 0.28f, 0.14f}, .specular = glm::vec3(0.08f), .shininess = 12});
    const std::size_t brass = table.scene.materials.size();
    table.material("pin",
                   {.diffuse = {0.30f, 0.18f, 0.04f}, .specular = {0.9f, 0.65f, 0.28f}, .shininess = 36});
    std::array<std::size_t, 2> papers = {
        table.material("red paper", {.diffuse = {0.72f, 0.07f, 0.06f}, .specular = glm::vec3(0.04f)}),
        table.material("white paper", {.diffuse = glm::vec3(0.82f), .specular = glm::vec3(0.04f)})};
    MeshBuilder pole;
    pole.column({hub.x, 0, hub.z - 0.12f}, hub.y, 0.05f, 0.05f, table.sides());
    pole.column({hub.x, 0, hub.z - 0.12f}, 0.16f, 0.42f, 0.34f, 2 * table.sides());
    table.place(pole.take("stick"), stick, glm::mat4(1));

    constexpr int vanes = 8;
    constexpr float reach = 1.28f;
    std::array<MeshBuilder, 2> sheets;
    for (int i = 0; i < vanes; ++i) {
        const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / vanes;
        const auto point = [&](float radius, float turn, float height) {
            return glm::vec3(radius * std::cos(angle + turn), radius * std::sin(angle + turn), height);
        };
        MeshBuilder& sheet = sheets[static_cast<std::size_t>(i % 2)];
        // Folded: one edge lies flat, the other stands up and catches the wind.
        const glm::vec3 centre(0, 0, 0.02f);
        const glm::vec3 tip = point(reach, 0, 0);
        const glm::vec3 back = point(0.86f * reach, 0.48f, 0.05f);
        const glm::vec3 fold = point(0.52f * reach, 0.40f, 0.22f);
        sheet.triangle(centre, tip, fold);
        sheet.triangle(tip, back, fold);
    }
    const std::size_t wheel = table.node("pinwheel", hub);
    for (std::size_t i = 0; i < 2; ++i) {
        table.scene.materials[papers[i]].doubleSided = true;
        table.attach(
            table.place(sheets[i].take(i == 0 ? "red vanes" : "white vanes"), papers[i], glm::mat4(1)),
            wheel);
    }
    table.attach(table.place("pin", Sphere{0.09}, brass, at({0, 0, 0.08f})), wheel);
    Animation spin{.name = "spin"};
    Animation::Sampler keys;
    for (int i = 0; i <= quarterTurns; ++i) {
        const float half = std::numbers::pi_v<float> / 4 * static_cast<float>(i);
        keys.seconds.push_back(static_cast<float>(roundSeconds) * static_cast<float>(i) / quarterTurns);
        keys.values.emplace_back(0, 0, std::sin(half), std::cos(half));
    }
    spin.samplers.push_back(std::move(keys));
    spin.channels.push_back({0, wheel, Animation::Path::rotation});
    table.scene.animations.push_back(std::move(spin));
}

void addLights(Scene& scene) {
    Light lamp;
    lamp.kind = Light::Kind::spot;
    lamp.name = "lamp";
    lamp.position = {-6.2f, 7.6f, 2.6f};
    lamp.direction = glm::normalize(glm::vec3(0.3f, 0.2f, -0.6f) - lamp.position);
    lamp.color = {1.0f, 0.83f, 0.62f};
    lamp.intensity = 108;
    lamp.innerConeRadians = 0.42f;
    lamp.outerConeRadians = 0.66f;
    Light fill;
    fill.kind = Light::Kind::directional;
    fill.name = "window";
    fill.direction = glm::normalize(glm::vec3(-0.75f, -0.62f, -0.6f));
    fill.color = {0.55f, 0.70f, 1.0f};
    fill.intensity = 0.16f;
    scene.lights = {lamp, fill};
    scene.ambientLight = {0.11f, 0.12f, 0.15f};
    scene.backgroundTop = {0.020f, 0.026f, 0.034f};
    scene.backgroundBottom = {0.055f, 0.050f, 0.045f};
}

}  // namespace

Scene makeToyTable(int segments) {
    Table table(segments);
    addCloth(table);
    addDolls(table);
    addTrain(table);
    addPinwheel(table);
    Scene scene = std::move(table.scene);
    scene.name = "toy table";
    addLights(scene);
    Camera camera;
    camera.worldFromCamera = lookAt({-0.5f, 3.3f, 9.6f}, {0.15f, 0.95f, -0.6f}, {0, 1, 0});
    camera.fovYRadians = 0.56f;
    camera.nearDistance = 1;
    camera.farDistance = 60;
    camera.apertureRadius = 0.14f;
    // The third doll's.
    camera.focusDistance = 9.9f;
    scene.cameras = {camera};
    pose(scene, 0);
    return scene;
}

}  // namespace quincunx

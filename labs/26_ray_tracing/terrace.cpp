#include "labs/26_ray_tracing/terrace.h"

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "geometry/mesh_builder.h"
#include "math/transform.h"

namespace quincunx {
namespace {

/// Indices into the materials.
enum Finish : std::uint32_t {
    floorTiles,
    stone,
    silver,
    gold,
    brass,
    clearGlass,
    greenGlass,
    lensGlass,
    glaze,
    core,
    coral,
    finishCount
};

std::vector<WhittedMaterial> finishes() {
    std::vector<WhittedMaterial> all(finishCount);
    all[floorTiles] = {.diffuse = {0.66f, 0.58f, 0.46f},
                       .otherTile = glm::vec3(0.10f, 0.15f, 0.19f),
                       .tileSize = 1.2f,
                       .ior = 1.35f};
    all[stone] = {.diffuse = {0.60f, 0.54f, 0.46f}};
    all[silver] = {.diffuse = glm::vec3(0), .mirror = {0.90f, 0.91f, 0.92f}};
    all[gold] = {.diffuse = glm::vec3(0), .mirror = {0.95f, 0.66f, 0.28f}};
    all[brass] = {.diffuse = glm::vec3(0), .mirror = {0.78f, 0.60f, 0.32f}};
    all[clearGlass] = {
        .diffuse = glm::vec3(0), .ior = 1.5f, .glass = true, .absorption = {0.05f, 0.03f, 0.02f}};
    all[greenGlass] = {
        .diffuse = glm::vec3(0), .ior = 1.5f, .glass = true, .absorption = {1.3f, 0.25f, 0.75f}};
    all[lensGlass] = {
        .diffuse = glm::vec3(0), .ior = 1.6f, .glass = true, .absorption = {0.03f, 0.02f, 0.02f}};
    all[glaze] = {.diffuse = {0.03f, 0.16f, 0.30f}, .ior = 1.5f};
    all[core] = {.diffuse = {0.78f, 0.22f, 0.06f}, .ior = 1.3f};
    all[coral] = {.diffuse = {0.72f, 0.16f, 0.11f}, .ior = 1.5f};
    return all;
}

constexpr float sculptureHeight = 2.15f;
const glm::vec3 sculptureAt(0.35f, sculptureHeight, -1.5f);
const glm::vec3 lensAt(2.35f, 1.25f, 1.15f);

/// A post turned on a lathe, standing on y = 0, `height` high.
Mesh post(float height) {
    constexpr int sides = 18;
    constexpr int rings = 26;
    std::vector<std::vector<glm::vec3>> profile;
    for (int i = 0; i <= rings; ++i) {
        const float s = static_cast<float>(i) / rings;
        // A vase: a foot, a belly low down, a slender neck, a collar.
        const float belly = std::exp(-30 * (s - 0.30f) * (s - 0.30f));
        const float collar = std::exp(-600 * (s - 0.80f) * (s - 0.80f));
        const float ends = std::exp(-220 * s * s) + std::exp(-220 * (1 - s) * (1 - s));
        const float radius = 0.062f + 0.105f * belly + 0.045f * collar + 0.075f * ends;
        std::vector<glm::vec3> ring;
        for (int k = 0; k < sides; ++k) {
            const float angle = -2 * std::numbers::pi_v<float> * static_cast<float>(k) / sides;
            ring.emplace_back(radius * std::cos(angle), s * height, radius * std::sin(angle));
        }
        profile.push_back(std::move(ring));
    }
    return loft(profile, true, true, "post");
}

void moveMesh(Mesh& mesh, glm::vec3 by) {
    for (glm::vec3& position : mesh.positions)
        position += by;
}

void addBalustrade(WhittedContents& contents, glm::vec3 from, glm::vec3 to, int posts) {
    const Mesh one = post(0.95f);
    const glm::vec3 along = glm::normalize(to - from);
    MeshBuilder builder;
    const auto slab = [&](float low, float high, float halfWidth) {
        const glm::vec3 across = halfWidth * glm::vec3(std::abs(along.z), 0, std::abs(along.x));
        builder.box(glm::min(from, to) - across + glm::vec3(0, low, 0),
                    glm::max(from, to) + across + glm::vec3(0, high, 0));
    };
    slab(0, 0.24f, 0.2f);
    slab(1.19f, 1.38f, 0.2f);
    for (int i = 0; i <= posts; i += posts / 3) {
        const glm::vec3 at = glm::mix(from, to, static_cast<float>(i) / static_cast<float>(posts));
        builder.box(at - glm::vec3(0.27f, 0, 0.27f), at + glm::vec3(0.27f, 1.55f, 0.27f));
    }
    contents.parts.push_back({builder.take("rail"), stone});
    for (int i = 0; i < posts; ++i) {
        if (i % (posts / 3) == 0 && i != 0)
            continue;
        Mesh mesh = one;
        moveMesh(mesh, glm::mix(from, to, (static_cast<float>(i) + 0.5f) / static_cast<float>(posts)) +
                           glm::vec3(0, 0.24f, 0));
        contents.parts.push_back({std::move(mesh), stone});
    }
}

Csg roundedCubeOf(std::uint32_t material) {
    const Csg cube = Csg::box({sculptureAt - 0.85f, sculptureAt + 0.85f}, material);
    return intersect(cube, Csg::ball({sculptureAt, 1.16f}, material));
}

Csg rodsOf(std::uint32_t material) {
    constexpr float radius = 0.52f;
    constexpr float reach = 1.05f;
    Csg all = Csg::cylinder({sculptureAt - glm::vec3(reach, 0, 0), {2 * reach, 0, 0}, radius}, material);
    all = unite(all,
                Csg::cylinder({sculptureAt - glm::vec3(0, reach, 0), {0, 2 * reach, 0}, radius}, material));
    return unite(all,
                 Csg::cylinder({sculptureAt - glm::vec3(0, 0, reach), {0, 0, 2 * reach}, radius}, material));
}

Csg sculptureOf(Sculpture sculpture) {
    switch (sculpture) {
        case Sculpture::drilled:
            return subtract(roundedCubeOf(glaze), rodsOf(core));
        case Sculpture::united:
            return unite(roundedCubeOf(glaze), rodsOf(core));
        case Sculpture::common:
            return intersect(roundedCubeOf(glaze), rodsOf(core));
    }
    return roundedCubeOf(glaze);
}

}  // namespace

Csg roundedCube() {
    return roundedCubeOf(glaze);
}

Csg rods() {
    return rodsOf(core);
}

Csg lens() {
    // Two spheres' common part, as a glass for reading is ground.
    return intersect(Csg::ball({lensAt + glm::vec3(-0.35f, 0, 1.45f), 1.7f}, lensGlass),
                     Csg::ball({lensAt + glm::vec3(0.35f, 0, -1.45f), 1.7f}, lensGlass));
}

WhittedContents makeTerrace(Sculpture sculpture, float lampSize) {
    WhittedContents contents;
    contents.materials = finishes();

    MeshBuilder ground;
    ground.quad({-14, 0, 9}, {14, 0, 9}, {14, 0, -6.2f}, {-14, 0, -6.2f});
    contents.parts.push_back({ground.take("floor"), floorTiles});
    addBalustrade(contents, {-9.6f, 0, -5.8f}, {9.6f, 0, -5.8f}, 42);

    // The plinth: a drum with a hollow moulding turned out of it, and a slab.
    const glm::vec3 foot(sculptureAt.x, 0, sculptureAt.z);
    Csg plinth =
        unite(Csg::box({foot + glm::vec3(-0.85f, 0, -0.85f), foot + glm::vec3(0.85f, 0.22f, 0.85f)}, stone),
              Csg::cylinder({foot + glm::vec3(0, 0.22f, 0), {0, 0.85f, 0}, 0.66f}, stone));
    plinth = unite(
        plinth, Csg::box({foot + glm::vec3(-0.8f, 1.07f, -0.8f), foot + glm::vec3(0.8f, 1.3f, 0.8f)}, stone));
    contents.solids.push_back({plinth});
    contents.solids.push_back({sculptureOf(sculpture)});
    if (sculpture == Sculpture::drilled)
        contents.solids.push_back({Csg::ball({sculptureAt, 0.34f}, gold)});

    contents.solids.push_back({Csg::ball({{-2.15f, 1.15f, -0.9f}, 1.15f}, silver)});
    contents.solids.push_back({Csg::ball({{-0.75f, 0.62f, 1.55f}, 0.62f}, clearGlass)});
    contents.solids.push_back({Csg::ball({{-2.55f, 0.42f, 1.75f}, 0.42f}, greenGlass)});
    contents.solids.push_back({Csg::ball({{0.62f, 0.33f, 2.35f}, 0.33f}, coral)});
    contents.solids.push_back({Csg::ball({{3.9f, 0.55f, -0.9f}, 0.55f}, gold)});

    contents.solids.push_back({lens()});
    const glm::vec3 lensAxis = glm::normalize(glm::vec3(-0.35f, 0, 1.45f));
    const Csg ring = subtract(Csg::cylinder({lensAt - 0.09f * lensAxis, 0.18f * lensAxis, 0.93f}, brass),
                              Csg::cylinder({lensAt - 0.2f * lensAxis, 0.4f * lensAxis, 0.815f}, brass));
    const Csg stand = unite(Csg::cylinder({{lensAt.x, 0.0f, lensAt.z}, {0, 0.35f, 0}, 0.07f}, brass),
                            Csg::cylinder({{lensAt.x, 0.0f, lensAt.z}, {0, 0.06f, 0}, 0.42f}, brass));
    contents.solids.push_back({unite(ring, stand)});

    const float side = 2.2f * lampSize;
    const glm::vec3 lampAt(-4.6f, 6.4f, 3.4f);
    const glm::vec3 down = glm::normalize(glm::vec3(0.3f, 0.6f, -0.6f) - lampAt);
    const glm::vec3 u = glm::normalize(glm::cross(down, glm::vec3(0, 1, 0)));
    const glm::vec3 v = glm::cross(down, u);
    contents.lights.push_back({lampAt - 0.5f * side * (u + v), side * u, side * v,
                               glm::vec3(56.0f, 46.0f, 34.0f) / (lampSize * lampSize)});
    contents.skyZenith = {0.05f, 0.11f, 0.30f};
    contents.skyHorizon = {0.80f, 0.53f, 0.40f};
    contents.skyNadir = 0.35f * contents.skyHorizon;
    contents.ambient = {0.16f, 0.19f, 0.26f};
    return contents;
}

Camera terraceCamera() {
    Camera camera;
    camera.worldFromCamera = lookAt({-2.9f, 3.9f, 8.3f}, {0.1f, 1.05f, -0.35f}, {0, 1, 0});
    camera.fovYRadians = glm::radians(36.0f);
    camera.farDistance = 100;
    return camera;
}

}  // namespace quincunx

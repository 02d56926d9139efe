// The views that shadow maps are drawn from.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/shadow_map.h"
#include "trace/shadow_glsl.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float pi = std::numbers::pi_v<float>;

glm::vec3 direction(Random& random) {
    const double z = random.uniform(-1, 1);
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double ring = std::sqrt(1 - z * z);
    return {ring * std::cos(angle), ring * std::sin(angle), z};
}

glm::vec3 pointIn(Random& random, double half) {
    return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

/// Balls and drums, turned and stretched, some mirrored, within a cube of `size` about `centre`.
Scene randomScene(Random& random, float size, glm::vec3 centre) {
    Scene scene;
    scene.meshes.push_back(tessellate(Sphere{}, 6));
    scene.meshes.push_back(tessellate(Drum{.radius = 1, .halfHeight = 0.1, .rimRadius = 0.05}, 6));
    scene.materials.emplace_back();
    for (int i = 0; i < 5; ++i) {
        glm::mat4 place = glm::translate(glm::mat4(1), centre + pointIn(random, 0.5 * size));
        place = glm::rotate(place, static_cast<float>(random.uniform(0, 6)), direction(random));
        place = glm::scale(place, 0.2f * size * glm::vec3(random.uniform(-1, 1), random.uniform(0.1, 1), 1));
        scene.instances.push_back({"solid", i % 2 == 0 ? 0u : 1u, 0, place});
    }
    return scene;
}

std::vector<glm::vec3> verticesOf(const Scene& scene) {
    std::vector<glm::vec3> vertices;
    for (const Instance& instance : scene.instances)
        for (const glm::vec3& position : scene.meshes[instance.mesh].positions)
            vertices.emplace_back(instance.worldFromModel * glm::vec4(position, 1));
    return vertices;
}

/// How far a point lies beyond a view's planes, as a share of the view's width (x, y) or depth (z); 0 inside.
struct Beyond {
    double sides = 0;
    double depth = 0;
};
Beyond beyond(const glm::mat4& clipFromWorld, glm::vec3 world) {
    glm::dvec4 clip(0);
    glm::dvec4 terms(0);
    for (int column = 0; column < 4; ++column) {
        const glm::dvec4 term =
            glm::dvec4(clipFromWorld[column]) * (column < 3 ? static_cast<double>(world[column]) : 1.0);
        clip += term;
        terms += glm::abs(term);
    }
    // The matrix's entries carry three roundings (the rotation's, the projection's and their product's) of
    // 2^-24 of themselves, and so do the vertex' coordinates: 2^-22 of the terms in all.
    const glm::dvec4 slack = 0x1p-22 * terms;
    const auto over = [&](int axis) {
        return std::max(0.0, std::abs(clip[axis]) - clip.w - slack[axis] - slack.w) / (2 * std::abs(clip.w));
    };
    return {std::max(over(0), over(1)), over(2)};
}

Camera randomCamera(Random& random, glm::vec3 centre, float size) {
    Camera camera;
    const glm::vec3 eye = centre + static_cast<float>(random.uniform(0.1, 3)) * size * direction(random);
    camera.worldFromCamera = lookAt(eye, centre + pointIn(random, 0.5 * size), {0, 1, 0});
    camera.fovYRadians = static_cast<float>(random.uniform(0.2, 2));
    camera.nearDistance = 0.02f * size;
    camera.farDistance = random.below(4) == 0 ? infinity : 20 * size;
    return camera;
}

/// Scenes of all sizes, at the world's origin and up to a thousand times their size away from it.
template <typename Check>
void forRandomScenes(std::uint64_t seed, const Check& check) {
    Random random(seed);
    for (int i = 0; i < 200; ++i) {
        SCOPED_TRACE(i);
        const auto size = static_cast<float>(std::exp2(random.uniform(-20, 20)));
        const auto far = static_cast<float>(i % 3 == 0 ? std::exp2(random.uniform(-4, 10)) : 0);
        const glm::vec3 centre = far * size * direction(random);
        check(random, randomScene(random, size, centre), centre, size);
    }
}

TEST(ShadowViews, ABoxHoldsEveryVertex) {
    forRandomScenes(1, [](Random& random, const Scene& scene, glm::vec3 centre, float size) {
        Light sun;
        sun.direction = direction(random);
        const ShadowViews views =
            fitShadowViews(sun, scene, randomCamera(random, centre, size), 1.5f, {.cascades = 1});
        ASSERT_EQ(views.kind, ShadowViews::Kind::cascades);
        ASSERT_EQ(views.views.size(), 1u);
        EXPECT_EQ(views.views[0].viewDistance, infinity);
        for (const glm::vec3& vertex : verticesOf(scene)) {
            const Beyond outside = beyond(views.views[0].clipFromWorld, vertex);
            ASSERT_EQ(outside.sides, 0);
            ASSERT_EQ(outside.depth, 0);
        }
    });
}

TEST(ShadowViews, ABoxIsNoWiderThanItsScene) {
    forRandomScenes(2, [](Random& random, const Scene& scene, glm::vec3 centre, float size) {
        Light sun;
        sun.direction = direction(random);
        const ShadowViews views =
            fitShadowViews(sun, scene, randomCamera(random, centre, size), 1.5f, {.cascades = 1});
        glm::dvec3 low(2);
        glm::dvec3 high(-2);
        for (const glm::vec3& vertex : verticesOf(scene)) {
            const glm::dvec3 ndc(glm::dmat4(views.views.at(0).clipFromWorld) * glm::dvec4(vertex, 1));
            low = glm::min(low, ndc);
            high = glm::max(high, ndc);
        }
        // The box has 2^-22 of the largest coordinate on either side, at most a thousand times the scene's
        // size: 5e-4 of its width, and float's resolution of the coordinates as much again.
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(low[axis], -1, 2e-3) << axis;
            EXPECT_NEAR(high[axis], 1, 2e-3) << axis;
        }
    });
}

TEST(ShadowViews, CascadesHoldWhatTheCameraSeesOfTheSceneAndAllThatCanShadeIt) {
    std::size_t seen = 0;
    forRandomScenes(3, [&seen](Random& random, const Scene& scene, glm::vec3 centre, float size) {
        Light sun;
        sun.direction = direction(random);
        const Camera camera = randomCamera(random, centre, size);
        const auto aspect = static_cast<float>(random.uniform(0.3, 3));
        const auto count = static_cast<int>(2 + random.below(3));
        const ShadowViews views = fitShadowViews(sun, scene, camera, aspect, {.cascades = count});
        ASSERT_EQ(views.views.size(), static_cast<std::size_t>(count));
        for (std::size_t i = 1; i < views.views.size(); ++i)
            EXPECT_GT(views.views[i].viewDistance, views.views[i - 1].viewDistance);
        EXPECT_EQ(views.views.back().viewDistance, infinity);

        const glm::dmat4 cameraFromWorld_ = glm::inverse(glm::dmat4(camera.worldFromCamera));
        const double tangent = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
        for (const glm::vec3& vertex : verticesOf(scene)) {
            // What casts is between the light and what it shades: in depth every view holds everything.
            for (const ShadowView& view : views.views)
                ASSERT_EQ(beyond(view.clipFromWorld, vertex).depth, 0);
            const glm::dvec3 eye(cameraFromWorld_ * glm::dvec4(vertex, 1));
            const double distance = -eye.z;
            const bool visible = distance >= static_cast<double>(camera.nearDistance) &&
                                 distance <= static_cast<double>(camera.farDistance) &&
                                 std::abs(eye.y) <= tangent * distance &&
                                 std::abs(eye.x) <= tangent * static_cast<double>(aspect) * distance;
            if (!visible)
                continue;
            ++seen;
            // As lib/shadow.glsl chooses.
            std::size_t i = 0;
            while (i + 1 < views.views.size() && distance > static_cast<double>(views.views[i].viewDistance))
                ++i;
            // The slice's corners and the distance that chooses it are rounded apart, by 2^-22 of the
            // distances involved, up to a thousand times the scene's size.
            ASSERT_LE(beyond(views.views[i].clipFromWorld, vertex).sides, 1e-3);
        }
    });
    EXPECT_GT(seen, 5000u);
}

TEST(ShadowViews, CascadesNearTheEyeAreNarrower) {
    Random random(4);
    const Scene scene = randomScene(random, 10, {0, 0, 0});
    Camera camera;
    camera.worldFromCamera = lookAt({0, 0, 12}, {0, 0, 0}, {0, 1, 0});
    camera.fovYRadians = 0.5f;
    Light sun;
    sun.direction = glm::normalize(glm::vec3(-1, -1, 0));
    const ShadowViews views = fitShadowViews(sun, scene, camera, 1, {.cascades = 4});
    const auto texelsAUnit = [](const ShadowView& view) {
        const glm::mat4& m = view.clipFromWorld;
        return glm::length(glm::vec3(m[0][0], m[1][0], m[2][0]));
    };
    EXPECT_GT(texelsAUnit(views.views.at(0)), 1.5f * texelsAUnit(views.views.at(3)));
}

TEST(ShadowViews, SixFacesHoldEveryVertexOnTheSideThatTheLookupChooses) {
    forRandomScenes(5, [](Random& random, const Scene& scene, glm::vec3 centre, float size) {
        Light lamp;
        lamp.kind = random.below(2) == 0 ? Light::Kind::point : Light::Kind::spot;
        lamp.outerConeRadians = 0.5f * pi;  // too wide for one view
        lamp.position = centre + static_cast<float>(random.uniform(0, 2)) * size * direction(random);
        const ShadowViews views =
            fitShadowViews(lamp, scene, randomCamera(random, centre, size), 1, {.radius = 2});
        ASSERT_EQ(views.kind, ShadowViews::Kind::cube);
        ASSERT_EQ(views.views.size(), 6u);
        for (const glm::vec3& vertex : verticesOf(scene)) {
            if (vertex == lamp.position)
                continue;
            const int face = glsl::cubeFace(vertex - lamp.position);
            const glm::mat4& view = views.views[static_cast<std::size_t>(face)].clipFromWorld;
            const glm::dvec4 clip = glm::dmat4(view) * glm::dvec4(vertex, 1);
            // What is nearer than a thousandth of the reach is clamped into the map, and the light's own
            // position is rounded.
            if (clip.w <= 0x1p-18 * static_cast<double>(glm::length(lamp.position)))
                continue;
            ASSERT_GT(clip.w, 0);
            ASSERT_EQ(beyond(view, vertex).sides, 0);
            ASSERT_LE(clip.z, clip.w);
        }
    });
}

TEST(ShadowViews, ASpotsViewHoldsItsCone) {
    std::size_t lit = 0;
    forRandomScenes(6, [&lit](Random& random, const Scene& scene, glm::vec3 centre, float size) {
        Light spot;
        spot.kind = Light::Kind::spot;
        spot.outerConeRadians = static_cast<float>(random.uniform(0.01, 79.0 / 180 * std::numbers::pi));
        spot.position = centre + 1.5f * size * direction(random);
        spot.direction = glm::normalize(centre - spot.position);
        const ShadowViews views = fitShadowViews(spot, scene, randomCamera(random, centre, size), 1, {});
        ASSERT_EQ(views.kind, ShadowViews::Kind::single);
        ASSERT_EQ(views.views.size(), 1u);
        for (const glm::vec3& vertex : verticesOf(scene)) {
            const glm::dvec3 towards = glm::dvec3(vertex) - glm::dvec3(spot.position);
            if (glm::dot(glm::normalize(towards), glm::dvec3(spot.direction)) <
                std::cos(static_cast<double>(spot.outerConeRadians)))
                continue;
            ++lit;
            const Beyond outside = beyond(views.views[0].clipFromWorld, vertex);
            ASSERT_LE(outside.sides, 1e-3);  // as above: positions a thousand sizes away are rounded
            ASSERT_EQ(outside.depth, 0);
        }
    });
    EXPECT_GT(lit, 5000u);
}

Scene onePoint(glm::vec3 at) {
    Scene scene;
    scene.meshes.push_back(
        {.name = "point", .positions = {at, at, at}, .normals = {}, .texcoords = {}, .indices = {0, 1, 2}});
    scene.materials.emplace_back();
    scene.instances.push_back({"point", 0, 0, glm::mat4(1)});
    return scene;
}

Light lightOf(Light::Kind kind) {
    Light light;
    light.kind = kind;
    light.position = {0, 5, 0};
    return light;
}

constexpr Light::Kind allKinds[] = {Light::Kind::directional, Light::Kind::spot, Light::Kind::point};

TEST(ShadowViews, WhatHasNoSizeOrNoPlaceHasNoViewsOrFiniteOnes) {
    Random random(7);
    Scene empty;
    Scene infinite = randomScene(random, 1, {0, 0, 0});
    infinite.meshes[0].positions[0].x = infinity;
    Scene notANumber = randomScene(random, 1, {0, 0, 0});
    notANumber.instances[0].worldFromModel[3].y = std::numeric_limits<float>::quiet_NaN();
    Scene overflowing = randomScene(random, 1, {0, 0, 0});
    overflowing.instances[0].worldFromModel[0] *= 1e38f;
    overflowing.instances[0].worldFromModel[1] *= 1e38f;
    Camera away;  // looks to where nothing is
    away.worldFromCamera = lookAt({0, 3, 0}, {0, 90, 0}, {0, 0, 1});
    for (const Scene& scene :
         {empty, infinite, notANumber, overflowing, onePoint({0, 0, 0}), onePoint({1e6f, 0, 3}),
          randomScene(random, 1, {3e4f, 0, 0}), randomScene(random, 1e-9f, {0, 0, 0}),
          randomScene(random, 1e-12f, {0, 0, 0}), randomScene(random, 1e18f, {0, 0, 0})})
        for (const Light::Kind kind : allKinds)
            for (const int cascades : {1, 4}) {
                const ShadowViews views =
                    fitShadowViews(lightOf(kind), scene, away, 1.5f, {.cascades = cascades});
                for (const ShadowView& view : views.views)
                    for (int column = 0; column < 4; ++column)
                        for (int row = 0; row < 4; ++row)
                            EXPECT_TRUE(std::isfinite(view.clipFromWorld[column][row]));
            }
    for (const Light::Kind kind : allKinds)
        EXPECT_TRUE(fitShadowViews(lightOf(kind), empty, away, 1, {}).views.empty());
}

TEST(ShadowViews, ALightThatLightsNothingHasNoViews) {
    Random random(8);
    const Scene scene = randomScene(random, 1, {0, 0, 0});
    for (const Light::Kind kind : {Light::Kind::directional, Light::Kind::spot}) {
        Light nowhere = lightOf(kind);
        nowhere.direction = {0, 0, 0};
        EXPECT_TRUE(fitShadowViews(nowhere, scene, {}, 1, {}).views.empty());
    }
    Light shut = lightOf(Light::Kind::spot);
    shut.outerConeRadians = 0;
    EXPECT_TRUE(fitShadowViews(shut, scene, {}, 1, {}).views.empty());
    for (const Light::Kind kind : {Light::Kind::point, Light::Kind::spot}) {
        Light lost = lightOf(kind);
        lost.position.y = infinity;
        EXPECT_TRUE(fitShadowViews(lost, scene, {}, 1, {}).views.empty());
    }
}

TEST(ShadowViews, ALightStraightDownHasAView) {
    Random random(9);
    const Scene scene = randomScene(random, 1, {0, 0, 0});
    for (const glm::vec3& way : {glm::vec3(0, -1, 0), glm::vec3(0, 1, 0)}) {
        Light sun;
        sun.direction = way;
        const ShadowViews views = fitShadowViews(sun, scene, {}, 1, {});
        ASSERT_EQ(views.views.size(), 1u);
        for (const glm::vec3& vertex : verticesOf(scene))
            ASSERT_EQ(beyond(views.views[0].clipFromWorld, vertex).sides, 0);
    }
}

TEST(ShadowMapSize, HoldsEveryTileOnce) {
    for (std::size_t views = 1; views <= maxShadowViews; ++views) {
        const glm::ivec2 size = ShadowMap::size(views, 64);
        EXPECT_GE(size.x / 64 * (size.y / 64), static_cast<int>(views));
        EXPECT_LT(size.x / 64 * (size.y / 64), static_cast<int>(views) + 2);
    }
}

}  // namespace
}  // namespace quincunx

#include "trace/trace_scene.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "base/random.h"
#include "math/vector.h"
#include "scene/still_life.h"

namespace quincunx {
namespace {

glm::vec3 randomDirection(Random& random) {
    for (;;) {
        const glm::vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (glm::dot(v, v) > 0.01f && glm::dot(v, v) <= 1)
            return *normalize(v);
    }
}

Mesh ball(int segments = 16) {
    return tessellate(Sphere{1}, segments, "ball");
}

/// Turned, squeezed and mirrored, `offset` from the origin.
glm::mat4 placement(glm::vec3 offset, float scale, bool mirrored) {
    glm::mat4 m = glm::translate(glm::mat4(1), offset);
    m = glm::rotate(m, 0.7f, glm::vec3(1, 2, 3));
    return glm::scale(m, scale * glm::vec3(mirrored ? -1.3f : 1.3f, 0.8f, 1));
}

Scene oneBall(const glm::mat4& worldFromModel, int segments = 16) {
    Scene scene;
    scene.meshes = {ball(segments)};
    scene.materials = {Material{}};
    scene.instances = {{"ball", 0, 0, worldFromModel}};
    return scene;
}

/// The same ball twice, so that it is an instance of a shared mesh; the second one is far away.
Scene sharedBall(const glm::mat4& worldFromModel, float away) {
    Scene scene = oneBall(worldFromModel, 24);
    scene.instances.push_back({"other", 0, 0, glm::translate(glm::mat4(1), glm::vec3(0, away, 0))});
    return scene;
}

struct Place {
    const char* name;
    glm::vec3 offset;
    float scale;
};
constexpr Place places[] = {{"at the origin", {0.3f, -0.2f, 0.1f}, 1},
                            {"far away", {1e6f, -1e6f, 5e5f}, 1000},
                            {"small", {1e-6f, 0, 2e-6f}, 1e-6f},
                            {"huge", {0, 0, 0}, 1e6f}};

TEST(TraceScene, RaysThatLeaveAConvexSurfaceMeetNothing) {
    for (const Place& place : places)
        for (const bool mirrored : {false, true})
            for (const bool isShared : {false, true}) {
                const glm::mat4 m = placement(place.offset, place.scale, mirrored);
                const TraceScene scene(isShared ? sharedBall(m, 1e9f) : oneBall(m));
                Random random(7);
                int met = 0;
                int again = 0;
                for (int i = 0; i < 400; ++i) {
                    const glm::vec3 towards = place.offset + place.scale * 0.7f * randomDirection(random);
                    const glm::vec3 from = place.offset + place.scale * 3.0f * randomDirection(random);
                    const auto point = scene.nearest({from, towards - from});
                    if (!point)
                        continue;
                    ++met;
                    ASSERT_TRUE(point->front) << place.name;
                    glm::vec3 away = randomDirection(random);
                    if (i % 2 == 0)  // grazing
                        away = normalizeOr(0.99999f * point->tangent + 1e-4f * away, away);
                    if (glm::dot(away, point->geometricNormal) < 0)
                        away = -away;
                    again += scene.nearest(TraceScene::leave(*point, away)).has_value();
                }
                EXPECT_GT(met, 200) << place.name;
                EXPECT_EQ(again, 0) << place.name << (mirrored ? ", mirrored" : "")
                                    << (isShared ? ", shared" : "");
            }
}

TEST(TraceScene, RaysThatEnterASurfaceMeetItsOtherSide) {
    for (const Place& place : places)
        for (const bool isShared : {false, true}) {
            const glm::mat4 m = placement(place.offset, place.scale, false);
            const TraceScene scene(isShared ? sharedBall(m, 1e9f) : oneBall(m));
            Random random(8);
            for (int i = 0; i < 200; ++i) {
                const glm::vec3 from = place.offset + place.scale * 3.0f * randomDirection(random);
                const auto point = scene.nearest({from, place.offset - from});
                ASSERT_TRUE(point) << place.name;
                const glm::vec3 inwards = -point->geometricNormal;
                const auto back = scene.nearest(TraceScene::leave(*point, inwards));
                ASSERT_TRUE(back) << place.name;
                EXPECT_FALSE(back->front);
                EXPECT_GT(back->t, 0.5 * place.scale) << place.name;
            }
        }
}

TEST(TraceScene, SolidsAreLeftAndEnteredToo) {
    for (const Place& place : places)
        for (const bool round : {false, true}) {
            Scene scene;
            scene.materials = {Material{}};
            const glm::mat4 m =
                round ? glm::scale(glm::translate(glm::mat4(1), place.offset), glm::vec3(place.scale))
                      : placement(place.offset, place.scale, true);
            const TraceScene traced(scene, {{Sphere{1}, 0, m}});
            Random random(9);
            for (int i = 0; i < 300; ++i) {
                const glm::vec3 from = place.offset + place.scale * 3.0f * randomDirection(random);
                const auto point = traced.nearest({from, place.offset - from});
                ASSERT_TRUE(point) << place.name;
                EXPECT_TRUE(point->front);
                glm::vec3 away = randomDirection(random);
                if (glm::dot(away, point->geometricNormal) < 0)
                    away = -away;
                EXPECT_FALSE(traced.nearest(TraceScene::leave(*point, away))) << place.name;
                EXPECT_TRUE(traced.nearest(TraceScene::leave(*point, -point->geometricNormal)));
            }
        }
}

TEST(TraceScene, WhatLiesBeforeTheIntervalIsPassed) {
    Scene scene;
    scene.materials.emplace_back();
    const glm::mat4 moved = glm::translate(glm::mat4(1), {3, -2, 40});
    const glm::mat4 squeezed = glm::scale(moved, {2, 2, 1});
    for (const glm::mat4& placement : {moved, squeezed}) {
        const TraceScene traced(scene, {{Sphere{1}, 0, placement}});
        const Ray ray{glm::vec3(3, -2, 44), {0, 0, -1}};
        const auto behind = traced.nearest(ray, {3.5f, 100});
        ASSERT_TRUE(behind);
        EXPECT_EQ(behind->t, 5);
        EXPECT_EQ(behind->position, glm::vec3(3, -2, 39));
        EXPECT_EQ(behind->geometricNormal, glm::vec3(0, 0, -1));
        EXPECT_FALSE(behind->front);
        EXPECT_FALSE(traced.nearest(ray, {3.5f, 4.5f}));
        EXPECT_FALSE(traced.occluded(ray, {5.5f, 100}));
    }
}

TEST(TraceScene, SharedMeshesAreMetWhereFlattenedOnesAre) {
    const glm::mat4 m = placement({0.5f, 0, -1}, 2, true);
    const TraceScene flat(oneBall(m, 24));
    const TraceScene shared(sharedBall(m, 1e9f));
    Random random(10);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 from = 8.0f * randomDirection(random);
        const Ray ray{from, 2.0f * randomDirection(random) - from};
        const auto a = flat.nearest(ray);
        const auto b = shared.nearest(ray);
        if (!a || !b) {
            // Rays are rounded once in the model's frame: one at the outline may be lost.
            EXPECT_EQ(a.has_value(), b.has_value());
            continue;
        }
        ++met;
        EXPECT_NEAR(a->t, b->t, 1e-5);
        EXPECT_LT(glm::distance(a->position, b->position), 1e-4f);
        EXPECT_GT(glm::dot(a->shadingNormal, b->shadingNormal), 0.999f);
        EXPECT_EQ(a->front, b->front);
        EXPECT_EQ(a->instance, b->instance);
    }
    EXPECT_GT(met, 1000);
}

TEST(TraceScene, PositionErrorHoldsTheSurface) {
    // A point of a plane through corners of no round numbers.
    Scene scene;
    scene.materials = {Material{}};
    Mesh mesh;
    mesh.positions = {{1000.1f, 3.7f, -2.3f}, {-900.3f, 1.1f, 7.7f}, {13.3f, 2.9f, 800.7f}};
    mesh.indices = {0, 1, 2};
    scene.meshes = {mesh};
    scene.instances = {{"plane", 0, 0, glm::mat4(1)}};
    const TraceScene traced(scene);
    const glm::dvec3 a(mesh.positions[0]);
    const glm::dvec3 n = glm::cross(glm::dvec3(mesh.positions[1]) - a, glm::dvec3(mesh.positions[2]) - a);
    Random random(11);
    double worst = 0;
    int met = 0;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 from(random.uniform(-200, 200), 50, random.uniform(0, 400));
        const auto point = traced.nearest({from, randomDirection(random)});
        if (!point)
            continue;
        ++met;
        const double off = std::abs(glm::dot(n, glm::dvec3(point->position) - a));
        const double allowed = glm::dot(glm::abs(n), glm::dvec3(point->positionError));
        worst = std::max(worst, off / allowed);
    }
    EXPECT_GT(met, 200);
    EXPECT_LE(worst, 1);
    EXPECT_GT(worst, 0.3);  // measured 0.9: no bound that could be a tenth of what it is
}

TEST(TraceScene, CutOutsLetRaysThroughTheirHoles) {
    Scene scene;
    Texture texture;
    texture.image = Image8(2, 1, 4, Encoding::srgb);
    texture.image.data = {255, 255, 255, 0, 255, 255, 255, 255};
    texture.magnification = Texture::Filter::nearest;
    scene.textures = {texture};
    Material leaf;
    leaf.baseColorTexture = TextureUse(0);
    leaf.alphaMode = Material::AlphaMode::mask;
    scene.materials = {leaf, Material{}};
    Mesh quad;
    quad.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    quad.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes = {quad};
    scene.instances = {{"leaf", 0, 0, glm::mat4(1)},
                       {"leaf behind", 0, 0, glm::translate(glm::mat4(1), {0, 0, -1})},
                       {"wall", 0, 1, glm::translate(glm::mat4(1), {0, 0, -2})}};
    const TraceScene traced(scene);
    const auto left = traced.nearest({{-0.5f, 0, 3}, {0, 0, -1}});
    const auto right = traced.nearest({{0.5f, 0, 3}, {0, 0, -1}});
    ASSERT_TRUE(left && right);
    EXPECT_EQ(left->instance, 2u);
    EXPECT_EQ(right->instance, 0u);
    EXPECT_FALSE(traced.occluded({{-0.5f, 0, 3}, {0, 0, -1}}, {0, 4.5f}));
    EXPECT_TRUE(traced.occluded({{0.5f, 0, 3}, {0, 0, -1}}, {0, 4.5f}));
}

TEST(TraceScene, PointsOfAPlaneSeeOneAnotherAndWhatIsBehindAWallDoesNot) {
    for (const float offset : {0.0f, 4096.0f, 1048576.0f}) {
        const float scale = std::max(1.0f, offset / 1000);
        Scene scene;
        scene.materials = {Material{}};
        Mesh floor;
        floor.positions = {{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
        floor.indices = {0, 1, 2, 0, 2, 3};
        Mesh wall;
        wall.positions = {{0, 0, -9}, {0, 0, 9}, {0, 9, 9}, {0, 9, -9}};
        wall.indices = {0, 1, 2, 0, 2, 3};
        scene.meshes = {floor, wall};
        const glm::mat4 m = glm::scale(glm::translate(glm::mat4(1), glm::vec3(offset)), glm::vec3(scale));
        scene.instances = {{"floor", 0, 0, m}, {"wall", 1, 0, m}};
        const TraceScene traced(scene);
        Random random(12);
        const auto on = [&](double left, double right) {
            const glm::vec3 above(random.uniform(left, right), 5, random.uniform(-8, 8));
            return traced.nearest({glm::vec3(m * glm::vec4(above, 1)), {0, -1, 0}});
        };
        for (int i = 0; i < 500; ++i) {
            const auto a = on(0.5, 8);
            const auto b = on(0.5, 8);
            const auto behind = on(-8, -0.5);
            ASSERT_TRUE(a && b && behind);
            EXPECT_TRUE(traced.visible(*a, *b)) << offset;
            EXPECT_FALSE(traced.visible(*a, *behind)) << offset;
        }
    }
}

TEST(TraceScene, AStillLifeIsMetWhereItsTrianglesTendTo) {
    const StillLife life = makeStillLife();
    const TraceScene exact(life);
    const TraceScene triangles(tessellate(life, 96));
    int met = 0;
    int apart = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x) {
            const Ray ray = cameraRay(life.camera, 32, 24, glm::vec2(x, y) + 0.5f);
            const auto a = exact.nearest(ray);
            const auto b = triangles.nearest(ray);
            if (a.has_value() != b.has_value() || !a) {
                apart += a.has_value() != b.has_value();
                continue;
            }
            ++met;
            apart += std::abs(a->t - b->t) > 0.02 || a->material != b->material ||
                     glm::dot(a->shadingNormal, b->shadingNormal) < 0.98f;
        }
    EXPECT_GT(met, 300);
    EXPECT_LE(apart, 32);  // measured 24: outlines, and rims that 96 segments cut into few steps
}

TEST(TraceScene, TextureCoordinatesAndNumbersThatAreNoneDoNoHarm) {
    Scene scene = oneBall(glm::mat4(1));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (glm::vec2& texcoord : scene.meshes[0].texcoords)
        texcoord = glm::vec2(nan);
    scene.meshes[0].colors.assign(scene.meshes[0].positions.size(), glm::vec4(nan));
    scene.materials[0].emission = glm::vec3(nan, std::numeric_limits<float>::infinity(), -1);
    Texture texture;
    texture.image = Image8(1, 1, 3, Encoding::srgb);
    scene.textures = {texture};
    scene.materials[0].baseColorTexture = TextureUse(0);
    const TraceScene traced(scene);
    const auto point = traced.nearest({{0.1f, 0.2f, 5}, {0, 0, -1}});
    ASSERT_TRUE(point);
    const SurfaceValues values = traced.valuesAt(*point);
    for (int i = 0; i < 3; ++i) {
        EXPECT_GE(values.baseColor[i], 0);
        EXPECT_TRUE(std::isfinite(values.emission[i]));
        EXPECT_GE(values.emission[i], 0);
    }
}

TEST(CameraRay, GoesThroughTheLensAndMeetsWhatIsSharp) {
    Camera camera;
    camera.worldFromCamera = placement({1, 2, 3}, 1, false);
    camera.worldFromCamera = glm::translate(glm::rotate(glm::mat4(1), 0.5f, glm::vec3(0, 1, 0)), {1, 2, 3});
    camera.apertureRadius = 0.25f;
    camera.focusDistance = 4;
    const Ray middle = cameraRay(camera, 40, 30, {13, 7});
    const glm::vec3 forward = -glm::vec3(camera.worldFromCamera[2]);
    const auto sharp = [&](const Ray& ray) {
        const glm::vec3 eye(camera.worldFromCamera[3]);
        const float t = (4 - glm::dot(ray.origin - eye, forward)) / glm::dot(ray.direction, forward);
        return ray.origin + t * ray.direction;
    };
    for (const glm::vec2 lens : {glm::vec2(1, 0), glm::vec2(-0.5f, 0.7f)}) {
        const Ray ray = cameraRay(camera, 40, 30, {13, 7}, lens);
        EXPECT_LT(glm::distance(sharp(ray), sharp(middle)), 4e-6f);
        EXPECT_NEAR(glm::distance(ray.origin, middle.origin), 0.25f * glm::length(lens), 1e-6f);
        EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6f);
    }
}

TEST(MovedBy, MakesThePictureFarAwayTheOneAtTheOrigin) {
    const glm::mat4 m = placement({0.5f, 0.25f, -1}, 1, false);
    Scene here = oneBall(m);
    Scene there = movedBy(here, {1048576, 0, -524288});
    // The move rounds to a sixteenth; taken back, nothing more is lost.
    const Scene back = movedBy(there, {-1048576, 0, 524288});
    const glm::vec3 off = glm::vec3(back.instances[0].worldFromModel[3] - m[3]);
    EXPECT_LE(glm::length(off), 0.06f);
    EXPECT_EQ(
        movedBy(there, {-1048576, 0, 524288}).instances[0].worldFromModel,
        movedBy(movedBy(back, {1048576, 0, -524288}), {-1048576, 0, 524288}).instances[0].worldFromModel);
}

}  // namespace
}  // namespace quincunx

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "scene/import.h"

namespace quincunx {
namespace {

struct Seen {
    bool inside;
    double side;  ///< share of the half picture, 1 at the edge
};

Seen look(const Camera& camera, float aspect, const glm::dvec3& point) {
    const glm::dmat4 world(camera.worldFromCamera);
    const glm::dvec3 away = point - glm::dvec3(world[3]);
    const double depth = -glm::dot(away, glm::dvec3(world[2]));
    const double top = std::tan(static_cast<double>(camera.fovYRadians) / 2) * depth;
    const double side =
        std::max(std::abs(glm::dot(away, glm::dvec3(world[0]))) / (top * static_cast<double>(aspect)),
                 std::abs(glm::dot(away, glm::dvec3(world[1]))) / top);
    return {depth > static_cast<double>(camera.nearDistance) &&
                depth < static_cast<double>(camera.farDistance) && side <= 1,
            side};
}

TEST(FrameBounds, SeesEveryCornerOfBoxesOfAnySizeAndPlace) {
    Random random(4);
    for (int round = 0; round < 2000; ++round) {
        const double size = std::exp2(random.uniform(-60, 60));
        // Up to 2^14 sizes away from the origin, where the eye's place is rounded by less than 2^-10 sizes.
        const double away = size * std::exp2(random.uniform(-4, 14));
        Bounds bounds;
        for (int corner = 0; corner < 2; ++corner) {
            glm::vec3 p;
            for (int axis = 0; axis < 3; ++axis)
                p[axis] = static_cast<float>((axis == round % 3 ? away : 0) +
                                             size * (corner ? 1 : -1) * random.uniform(0.2, 1));
            bounds.extend(p);
        }
        const float aspect = static_cast<float>(std::exp2(random.uniform(-2, 2)));
        const Camera camera = frameBounds(bounds, aspect);
        double widest = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 p(corner & 1 ? bounds.max.x : bounds.min.x,
                               corner & 2 ? bounds.max.y : bounds.min.y,
                               corner & 4 ? bounds.max.z : bounds.min.z);
            const Seen seen = look(camera, aspect, p);
            ASSERT_TRUE(seen.inside) << round << " size " << size << " away " << away;
            widest = std::max(widest, seen.side);
        }
        // Tight: the margin leaves 1/1.1 = 0.909 of the picture, less where the eye would come too near to
        // the end of a long box.
        EXPECT_GT(widest, 0.5);
        EXPECT_LT(widest, 0.94);
        EXPECT_GT(camera.worldFromCamera[3].y, bounds.centre().y) << "from above";
        EXPECT_NEAR(glm::determinant(glm::dmat3(glm::dmat4(camera.worldFromCamera))), 1, 1e-6);
    }
}

TEST(FrameBounds, HasAnAnswerForPointsPlanesAndNothing) {
    const float largest = std::numeric_limits<float>::max();
    Bounds nothing;
    Bounds origin;
    origin.extend(glm::vec3(0));
    Bounds point;
    point.extend(glm::vec3(1e6f, 2, 3));
    Bounds plane;
    plane.extend(glm::vec3(-1, 0, -1));
    plane.extend(glm::vec3(1, 0, 1));
    Bounds everything;
    everything.extend(glm::vec3(-largest));
    everything.extend(glm::vec3(largest));
    Bounds denormal;
    denormal.extend(glm::vec3(0));
    denormal.extend(glm::vec3(std::numeric_limits<float>::denorm_min()));
    for (const Bounds& bounds : {nothing, origin, point, plane, everything, denormal}) {
        const Camera camera = frameBounds(bounds, 1.5f);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                EXPECT_TRUE(std::isfinite(camera.worldFromCamera[column][row]));
        EXPECT_GT(camera.nearDistance, std::numeric_limits<float>::min());
        EXPECT_GT(camera.farDistance, camera.nearDistance);
        EXPECT_TRUE(std::isfinite(camera.farDistance));
        EXPECT_NE(glm::vec3(camera.worldFromCamera[3]), bounds.centre());
    }
    EXPECT_TRUE(look(frameBounds(point, 1), 1, glm::dvec3(point.min)).inside);
}

TEST(StudioLights, AreUnitDirectionsOfWhichTheKeyIsBrightestAndTheRimComesFromBehind) {
    const std::vector<Light> lights = studioLights();
    ASSERT_EQ(lights.size(), 3u);
    for (const Light& light : lights) {
        EXPECT_EQ(light.kind, Light::Kind::directional);
        EXPECT_NEAR(glm::length(light.direction), 1, 1e-6);
        EXPECT_LT(light.direction.y, 0) << "from above";
        EXPECT_LE(light.intensity, lights[0].intensity);
    }
    Bounds unit;
    unit.extend(glm::vec3(-1));
    unit.extend(glm::vec3(1));
    const glm::vec3 back(frameBounds(unit, 1).worldFromCamera[2]);
    EXPECT_LT(glm::dot(lights[0].direction, back), 0) << "falls on what the camera sees";
    EXPECT_GT(glm::dot(lights[2].direction, back), 0);
}

TEST(SceneBounds, AreThoseOfTheVerticesInTheWorld) {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.indices = {0, 1, 2};
    scene.meshes.push_back(mesh);
    Instance turned;
    turned.worldFromModel = glm::mat4({0, -2, 0, 0}, {2, 0, 0, 0}, {0, 0, 1, 0}, {10, 0, 0, 1});
    scene.instances = {Instance{}, turned};
    const Bounds bounds = scene.bounds();
    // The box of the turned box would begin at 10 - 2 · 1; the vertices do not reach there.
    EXPECT_EQ(bounds.min, glm::vec3(0, -2, 0));
    EXPECT_EQ(bounds.max, glm::vec3(12, 1, 1));
    EXPECT_EQ(scene.triangleCount(), 2u);
    scene.instances[1].worldFromModel[3].x = std::numeric_limits<float>::infinity();
    EXPECT_EQ(scene.bounds().max, glm::vec3(1)) << "what is not finite is left out";
    EXPECT_TRUE(Scene{}.bounds().empty());
}

}  // namespace
}  // namespace quincunx

#include "passes/frame_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Scene boxesAround(Random& random, const glm::vec3& origin, double reach, int count) {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, 1}};
    mesh.indices = {0, 1, 2};
    scene.meshes = {mesh};
    scene.materials.emplace_back();
    for (int i = 0; i < count; ++i) {
        const auto size = static_cast<float>(std::pow(10.0, random.uniform(-4, 0)));
        glm::mat4 placement(size);
        placement[3] =
            glm::vec4(origin + glm::vec3(random.uniform(-reach, reach), random.uniform(-reach, reach),
                                         random.uniform(-reach, reach)),
                      1);
        scene.instances.push_back({"box", 0, 0, placement});
    }
    return scene;
}

/// Whether a vertex of the instance lies in the view, in extended precision from the numbers as given.
bool isSeen(const Scene& scene, std::size_t i, const Camera& camera, float aspect) {
    using Real = long double;
    const glm::mat4& placement = scene.instances[i].worldFromModel;
    const glm::mat4& world = camera.worldFromCamera;
    const Real tangent = std::tan(static_cast<Real>(camera.fovYRadians) / 2);
    for (const glm::vec3& p : scene.meshes[0].positions) {
        Real eye[3] = {0, 0, 0};
        Real relative[3];
        for (int row = 0; row < 3; ++row) {
            relative[row] = static_cast<Real>(placement[3][row]) - static_cast<Real>(world[3][row]);
            for (int column = 0; column < 3; ++column)
                relative[row] += static_cast<Real>(placement[column][row]) * static_cast<Real>(p[column]);
        }
        for (int axis = 0; axis < 3; ++axis)
            for (int row = 0; row < 3; ++row)
                eye[axis] += static_cast<Real>(world[axis][row]) * relative[row];
        const Real depth = -eye[2];
        if (depth >= camera.nearDistance && depth <= camera.farDistance &&
            std::abs(eye[1]) <= tangent * depth && std::abs(eye[0]) <= tangent * aspect * depth)
            return true;
    }
    return false;
}

TEST(FrameVisibility, LeavesNothingOutThatIsInViewNearOrFarFromTheOrigin) {
    Random random(7);
    std::size_t seen = 0;
    std::size_t kept = 0;
    std::size_t all = 0;
    for (const double away : {0.0, 1e3, 1e5, 1e6})
        for (int round = 0; round < 40; ++round) {
            const glm::vec3 origin(away, -0.7 * away, 0.3 * away);
            const Scene scene = boxesAround(random, origin, 5, 300);
            Camera camera;
            const glm::vec3 eye = origin + glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0);
            const glm::vec3 target = eye + glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), -1);
            camera.worldFromCamera = lookAt(eye, target, {0, 1, 0});
            camera.nearDistance = round % 2 == 0 ? 1e-3f : 0.1f;
            camera.farDistance = round % 3 == 0 ? 1e4f : 1e6f;
            const FrameView view{.scene = scene, .camera = camera, .width = 320, .height = 200};
            const Visibility visibility = SceneBounds(scene).look(view);
            std::vector<bool> drawn(scene.instances.size());
            for (const std::uint32_t i : visibility.solid)
                drawn[i] = true;
            for (std::size_t i = 0; i < drawn.size(); ++i) {
                const bool inView = isSeen(scene, i, camera, 1.6f);
                EXPECT_TRUE(drawn[i] || !inView) << away << " " << round << " " << i;
                seen += inView ? 1 : 0;
                kept += drawn[i] ? 1 : 0;
                ++all;
            }
        }
    // It is no use keeping everything.
    EXPECT_GT(seen, all / 20);
    EXPECT_LT(kept, seen + all / 20);
}

TEST(FrameVisibility, KeepsWhatIsNoNumber) {
    Random random(1);
    Scene scene = boxesAround(random, glm::vec3(0), 1, 1);
    scene.instances[0].worldFromModel[3].x = std::numeric_limits<float>::quiet_NaN();
    const FrameView view{.scene = scene, .camera = {}, .width = 32, .height = 32};
    EXPECT_EQ(SceneBounds(scene).look(view).visible(), 1u);
}

TEST(FrameVisibility, SkipsMeshesWithNothingToDraw) {
    Scene scene;
    scene.meshes.resize(2);
    scene.meshes[1].positions = {{0, 0, -2}};  // no triangles
    scene.materials.emplace_back();
    scene.instances = {{"nothing", 0, 0, glm::mat4(1)}, {"a point", 1, 0, glm::mat4(1)}};
    const FrameView view{.scene = scene, .camera = {}, .width = 32, .height = 32};
    EXPECT_EQ(SceneBounds(scene).look(view).visible(), 0u);
}

TEST(FrameVisibility, SortsBlendedObjectsFarthestFirst) {
    EXPECT_EQ(farthestFirst(std::vector<double>{1, 3, 2}), (std::vector<std::uint32_t>{1, 2, 0}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(farthestFirst(std::vector<double>{nan, 5, 5, infinity, 0}),
              (std::vector<std::uint32_t>{3, 1, 2, 4, 0}));
}

TEST(FrameVisibility, EveryBlendedObjectIsDrawnOnceAtEqualDistances) {
    // LearnOpenGL's map from distance to object loses those that are equally far.
    Random random(3);
    std::vector<double> distances;
    for (int i = 0; i < 1000; ++i)
        distances.push_back(static_cast<double>(random.below(7)));
    const std::vector<std::uint32_t> order = farthestFirst(distances);
    std::vector<bool> drawn(distances.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        EXPECT_FALSE(drawn[order[i]]);
        drawn[order[i]] = true;
        if (i > 0) {
            EXPECT_GE(distances[order[i - 1]], distances[order[i]]);
        }
    }
    EXPECT_EQ(order.size(), distances.size());
}

TEST(FrameVisibility, KeepsEveryCasterThatShadesWhatIsSeen) {
    // A sheet in view, a lamp, and boxes anywhere: a box whose centre lies on the way from a point of the
    // sheet to the light is a caster.
    Random random(11);
    for (int round = 0; round < 300; ++round) {
        Scene scene = boxesAround(random, glm::vec3(0), 4, 30);
        Light light;
        light.kind = static_cast<Light::Kind>(round % 3);
        light.position = {random.uniform(-4, 4), random.uniform(2, 6), random.uniform(-4, 4)};
        const glm::vec3 seen(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        light.direction = glm::normalize(seen - light.position);
        light.outerConeRadians = 0.4f;
        scene.lights = {light};
        glm::mat4 sheet(0.2f);
        sheet[3] = glm::vec4(seen, 1);
        scene.instances.push_back({"sheet", 0, 0, sheet});
        const auto share = static_cast<float>(random.uniform(0.1, 0.9));
        glm::mat4 between(0.05f);
        between[3] =
            glm::vec4(light.kind == Light::Kind::directional ? seen - 10.0f * share * light.direction
                                                             : seen + share * (light.position - seen),
                      1);
        scene.instances.push_back({"between", 0, 0, between});
        Camera camera;
        camera.worldFromCamera = lookAt(seen + glm::vec3(0, 0, 1), seen, {0, 1, 0});
        camera.farDistance = 2;
        camera.fovYRadians = 0.5f;
        const FrameView view{.scene = scene, .camera = camera, .width = 32, .height = 32};
        const Visibility visibility = SceneBounds(scene).look(view);
        ASSERT_EQ(visibility.lights.size(), 1u) << round;
        const std::vector<std::uint32_t>& casters = visibility.lights[0].casters;
        EXPECT_TRUE(std::find(casters.begin(), casters.end(), 31u) != casters.end()) << round;
        EXPECT_GT(visibility.lights[0].shadowed, 0u);
    }
}

TEST(FrameVisibility, TakesTheStrongestLightsWhereThereAreTooMany) {
    Random random(5);
    Scene scene = boxesAround(random, {0, 0, -4}, 1, 5);
    for (int i = 0; i < 20; ++i) {
        scene.lights.emplace_back();
        scene.lights.back().intensity = static_cast<float>((i * 7) % 20);
    }
    const FrameView view{.scene = scene, .camera = {}, .width = 32, .height = 32};
    const Visibility visibility = SceneBounds(scene).look(view);
    ASSERT_EQ(visibility.lights.size(), 8u);
    EXPECT_EQ(visibility.lightsLeftOut, 11u);
    EXPECT_EQ(visibility.lightsWithoutEffect, 1u);  // the one of intensity 0
    for (const LightReach& reach : visibility.lights)
        EXPECT_GE(scene.lights[reach.light].intensity, 12);
}

TEST(FrameVisibility, DrawsRelativeToAPointNearTheEye) {
    Camera camera;
    EXPECT_EQ(anchorOf(camera), glm::vec3(0));
    camera.worldFromCamera[3] = {1e6f, -3e6f, 12, 1};
    const glm::vec3 anchor = anchorOf(camera);
    EXPECT_LE(glm::length(glm::dvec3(anchor) - glm::dvec3(1e6, -3e6, 12)), 32 * 1.8);
    glm::mat4 placement(1);
    placement[3] = {1e6f + 3, -3e6f + 0.25f, 5, 1};
    const glm::mat4 relative = relativeTo(anchor, placement);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(static_cast<double>(relative[3][axis]),
                  static_cast<double>(placement[3][axis]) - static_cast<double>(anchor[axis]));
    camera.worldFromCamera[3].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(anchorOf(camera), glm::vec3(0));
}

}  // namespace
}  // namespace quincunx

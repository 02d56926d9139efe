// The two laws of planned frames, and what the table says of scenes that are known.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/transform.h"
#include "passes/frame_renderer.h"
#include "scene/colonnade.h"
#include "scene/export_gltf.h"
#include "scene/finish.h"
#include "scene/import.h"
#include "scene/spaceship.h"
#include "scene/town.h"
#include "tests/common/frames/frame_scenes.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::allEffects;
using test::ballOnAFloor;
using test::cameraFor;
using test::lookingAtTheBall;
using test::RandomScene;
using test::smallMeshes;
using test::texturedStillLife;

class FrameLaws : public test::Frames {};

TEST_F(FrameLaws, ForcingEveryEffectChangesNoBitOfTheBuiltInScenes) {
    const std::pair<const char*, Scene> scenes[] = {{"still life", tessellate(makeStillLife(), 24)},
                                                    {"colonnade", tessellate(makeColonnade(), 24)},
                                                    {"spaceship", makeSpaceship(16)},
                                                    {"town", makeTown().scene}};
    for (const auto& [name, scene] : scenes) {
        renderer_.reset();
        FrameView view{.scene = scene, .camera = cameraFor(scene, 1.5f), .width = 96, .height = 64};
        view.settings.shadowResolution = 256;
        expectForcingChangesNothing(view, name);
        view.settings.toneCurve = ToneCurve::filmic;
        view.settings.fxaa = true;
        view.settings.bloomStrength = 0.4f;
        expectForcingChangesNothing(view, name);
    }
}

TEST_F(FrameLaws, ForcingEveryEffectChangesNoBitOfImportedScenes) {
    const Scene scene = texturedStillLife();
    const test::TemporaryFolder folder;
    for (const char* name : {"scene.gltf", "scene.glb"}) {
        exportScene(scene, folder / name);
        const ImportedScene imported = importScene(folder / name);
        EXPECT_TRUE(imported.warnings.empty()) << imported.warnings.front();
        renderer_.reset();
        FrameView view{
            .scene = imported.scene, .camera = cameraFor(imported.scene, 1.5f), .width = 96, .height = 64};
        view.settings.shadowResolution = 256;
        expectForcingChangesNothing(view, name);
        EXPECT_TRUE(renderer_.plan().find("environment map").decision.calledFor);
        EXPECT_TRUE(renderer_.plan().find("transparency order").decision.calledFor);
    }
}

class RandomFrames : public FrameLaws, public testing::WithParamInterface<int> {};

constexpr int scenesACase = 63;
constexpr int randomCases = 8;

TEST_P(RandomFrames, ForcingEveryEffectChangesNoBit) {
    const std::vector<Mesh> meshes = smallMeshes();
    std::size_t calledFor = 0;
    for (int i = 0; i < scenesACase; ++i) {
        const auto seed = static_cast<std::uint64_t>(GetParam() * scenesACase + i);
        RandomScene random(seed, meshes);
        renderer_.reset();
        random.view.pictureFormat = i % 2 == 0 ? graph::Format::rgba8Srgb : graph::Format::rgba32f;
        const Image planned = drawn(random.view);
        for (const PlannedEffect& effect : renderer_.plan().effects) {
            ASSERT_FALSE(effect.decision.reason.empty()) << effect.name;
            calledFor += effect.decision.calledFor ? 1 : 0;
        }
        random.view.settings.forced = allEffects();
        ASSERT_EQ(planned, drawn(random.view)) << "seed " << seed;
    }
    // Scenes call for some effects and not for others.
    EXPECT_GT(calledFor, std::size_t{scenesACase});
    EXPECT_LT(calledFor, scenesACase * effects().size() * 2 / 3);
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomFrames, testing::Range(0, randomCases));

/// What a warm frame asks of the device.
struct Demand {
    std::map<std::string, std::uint64_t> calls;
    std::size_t programs = 0;
    std::size_t targetBytes = 0;
    bool operator==(const Demand&) const = default;
};

class EffectsThatAreNotCalledFor : public testing::Test {
  protected:
    static Demand demandOf(const FrameView& view) {
        const std::unique_ptr<gl::Context> context = gl::createOffscreenContext(gl::Backend::automatic);
        gl::Executor executor;
        FrameRenderer renderer;
        Demand demand;
        for (int i = 0; i < 2; ++i) {
            const gl::CallRecorder recorder;
            graph::FrameGraph graph;
            graph.addOutput(renderer.build(graph, view));
            executor.run(graph);
            demand.calls = recorder.calls();
        }
        demand.programs = executor.programs().size();
        demand.targetBytes = executor.targetBytes();
        return demand;
    }
};

TEST_F(EffectsThatAreNotCalledFor, CostNothingWhenTheirCauseIsOutOfView) {
    const Scene plain = ballOnAFloor();
    const Demand demand = demandOf(lookingAtTheBall(plain));

    Scene withGlass = plain;
    withGlass.materials.push_back(plain.materials[0]);
    withGlass.materials.back().alphaMode = Material::AlphaMode::blend;
    withGlass.instances.push_back({"glass", 0, 1, test::placedBehind()});
    // The sun comes from the front: the glass behind the camera casts nothing, since what blends does not.
    EXPECT_EQ(demandOf(lookingAtTheBall(withGlass)), demand);

    Scene withMirror = plain;
    withMirror.materials.push_back(
        makeMaterial("mirror", {.diffuse = glm::vec3(0.9f), .metallic = 1, .roughness = 0}));
    glm::mat4 aside = test::placedBehind();
    aside[3].x = 50;  // where it shades nothing that is seen
    withMirror.instances.push_back({"mirror", 0, 1, aside});
    EXPECT_EQ(demandOf(lookingAtTheBall(withMirror)), demand);

    Scene withSpot = plain;
    withSpot.lights.emplace_back();
    withSpot.lights.back().kind = Light::Kind::spot;
    withSpot.lights.back().position = {0, 0, 8};
    withSpot.lights.back().direction = {0, 0, 1};  // away from the ball
    EXPECT_EQ(demandOf(lookingAtTheBall(withSpot)), demand);

    Scene withLamp = plain;
    withLamp.lights.emplace_back();
    withLamp.lights.back().kind = Light::Kind::point;
    withLamp.lights.back().position = {0, 0, 8};
    withLamp.lights.back().range = 5;
    EXPECT_EQ(demandOf(lookingAtTheBall(withLamp)), demand);
}

TEST_F(EffectsThatAreNotCalledFor, AddNothingToTheBarestFrame) {
    Scene scene = ballOnAFloor();
    scene.lights.clear();
    const FrameView view = lookingAtTheBall(scene);
    const Demand demand = demandOf(view);
    // One for the background, one for the ball; a picture of eight bits and its depth.
    EXPECT_EQ(demand.programs, 2);
    EXPECT_EQ(demand.targetBytes, 48 * 32 * (4 + 4));
    std::uint64_t draws = 0;
    for (const auto& [name, count] : demand.calls) {
        if (name.starts_with("glDraw") && name != "glDrawBuffers")
            draws += count;
        EXPECT_THAT(
            name, testing::Not(testing::AnyOf(testing::StartsWith("glGen"), testing::StartsWith("glTexImage"),
                                              testing::StartsWith("glCompile"))));
    }
    EXPECT_EQ(draws, 2);
}

Decision decisionOf(const FrameView& view, std::string_view effect) {
    FrameRenderer renderer;
    return renderer.plan(view).find(effect).decision;
}

using testing::HasSubstr;

TEST(CalledFor, ShadowsNeedALightThatCastsOntoSomethingInView) {
    Scene scene = ballOnAFloor();
    FrameView view = lookingAtTheBall(scene);
    Decision decision = decisionOf(view, "directional shadows");
    EXPECT_TRUE(decision.calledFor);  // a ball shades its own far side
    EXPECT_THAT(decision.reason, HasSubstr("the sun 'key' casts onto 1 of 1 visible object"));
    EXPECT_FALSE(decisionOf(view, "spot shadows").calledFor);
    EXPECT_THAT(decisionOf(view, "spot shadows").reason, HasSubstr("no spot light"));

    // A sheet alone has nothing to cast a shadow on it; with a ball towards the sun, far out of view, it has.
    scene.instances[0].mesh = 3;
    EXPECT_FALSE(decisionOf(view, "directional shadows").calledFor);
    glm::mat4 towardsTheSun(1);
    towardsTheSun[3] = glm::vec4(-30.0f * scene.lights[0].direction, 1);
    scene.instances.push_back({"ball", 0, 0, towardsTheSun});
    EXPECT_TRUE(decisionOf(view, "directional shadows").calledFor);
    EXPECT_THAT(decisionOf(view, "directional shadows").reason, HasSubstr("casts onto 1 of 1"));
    // Beyond the sheet it shades nothing that is seen.
    scene.instances[1].worldFromModel[3] = glm::vec4(30.0f * scene.lights[0].direction, 1);
    EXPECT_FALSE(decisionOf(view, "directional shadows").calledFor);
    // Without anything in view there is nothing to shade.
    scene.instances.resize(1);
    scene.instances[0].worldFromModel = test::placedBehind();
    EXPECT_FALSE(decisionOf(view, "directional shadows").calledFor);
    EXPECT_THAT(decisionOf(view, "directional shadows").reason, HasSubstr("nothing is in view"));
}

TEST(CalledFor, TransparencyOrderNeedsBlendedTrianglesInView) {
    Scene scene = ballOnAFloor();
    const FrameView view = lookingAtTheBall(scene);
    EXPECT_THAT(decisionOf(view, "transparency order").reason, HasSubstr("nothing in the scene blends"));
    scene.materials[0].alphaMode = Material::AlphaMode::blend;
    EXPECT_TRUE(decisionOf(view, "transparency order").calledFor);
    scene.instances[0].worldFromModel = test::placedBehind();
    const Decision behind = decisionOf(view, "transparency order");
    EXPECT_FALSE(behind.calledFor);
    EXPECT_THAT(behind.reason, HasSubstr("nothing in view blends (1 out of view)"));
}

TEST(CalledFor, PostProcessingNeedsToBeAskedFor) {
    const Scene scene = ballOnAFloor();
    FrameView view = lookingAtTheBall(scene);
    for (const char* effect : {"bloom", "tone map", "blur", "greyscale", "fxaa"})
        EXPECT_FALSE(decisionOf(view, effect).calledFor) << effect;
    view.settings = {
        .exposureStops = 1, .bloomStrength = 0.5f, .blurSigmaPixels = 2, .greyscale = 1, .fxaa = true};
    for (const char* effect : {"bloom", "tone map", "blur", "greyscale", "fxaa"})
        EXPECT_TRUE(decisionOf(view, effect).calledFor) << effect;
}

TEST_F(FrameLaws, EveryEffectThatIsCalledForChangesThePicture) {
    // The other side of the first law: no row is there for nothing.
    Scene scene = ballOnAFloor();
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().alphaMode = Material::AlphaMode::blend;
    scene.materials.back().baseColor = {0.9f, 0.1f, 0.1f, 0.5f};
    scene.materials.push_back(
        makeMaterial("mirror", {.diffuse = glm::vec3(0.9f), .metallic = 1, .roughness = 0}));
    glm::mat4 floor(4);
    floor[3] = {0, -1, 0, 1};
    scene.instances.push_back({"floor", 3, 0, floor});
    glm::mat4 glass(1);
    glass[3] = {0.8f, 0.2f, 1.5f, 1};
    scene.instances.push_back({"near glass", 0, 1, glass});
    glass[3] = {1.2f, 0.4f, 0.2f, 1};
    scene.instances.push_back({"far glass", 2, 1, glass});
    glm::mat4 mirror(1);
    mirror[3] = {-1.8f, 0, 0, 1};
    scene.instances.push_back({"mirror", 0, 2, mirror});
    scene.backgroundTop = {0.2f, 0.4f, 0.9f};
    scene.backgroundBottom = {0.7f, 0.6f, 0.5f};
    Light spot;
    spot.kind = Light::Kind::spot;
    spot.position = {2, 4, 2};
    spot.direction = glm::normalize(glm::vec3(-2, -4, -2));
    spot.intensity = 20;
    Light lamp = spot;
    lamp.kind = Light::Kind::point;
    lamp.position = {-2, 3, 2};
    scene.lights.push_back(spot);
    scene.lights.push_back(lamp);
    FrameView view = lookingAtTheBall(scene);
    view.camera.worldFromCamera = lookAt({0, 2, 6}, {0, 0, 0}, {0, 1, 0});
    view.camera.apertureRadius = 0.2f;
    view.camera.focusDistance = 3;
    view.cameraAtClose = view.camera;
    view.cameraAtOpen = view.camera;
    view.cameraAtOpen.worldFromCamera = lookAt({0.5f, 2, 6}, {0, 0, 0}, {0, 1, 0});
    view.settings = {.exposureStops = 1,
                     .toneCurve = ToneCurve::filmic,
                     .bloomStrength = 0.8f,
                     .bloomThreshold = 0.3f,
                     .blurSigmaPixels = 1,
                     .greyscale = 0.5f,
                     .fxaa = true,
                     .shutterSeconds = 0.02f,
                     .shadowResolution = 256};
    const Image full = drawn(view);
    for (std::size_t i = 0; i < effects().size(); ++i) {
        EXPECT_TRUE(renderer_.plan().effects[i].decision.calledFor) << effects()[i].name;
        FrameView less = view;
        less.settings.leftOut.set(i);
        EXPECT_NE(drawn(less), full) << effects()[i].name;
    }
}

TEST_F(FrameLaws, ShadowMapsLeaveWhatIsLitAsItIs) {
    // A large ball that fills the view, and shades its own far side; a small one shades its upper left.
    Scene scene = ballOnAFloor();
    scene.instances[0].worldFromModel = glm::mat4(glm::mat3(4));
    scene.instances[0].worldFromModel[3].z = -4;
    glm::mat4 ball(glm::mat3(0.4f));
    ball[3] = {0.3f, 0.9f, 0.7f, 1};
    scene.instances.push_back({"ball", 0, 0, ball});
    Light& light = scene.lights.front();
    light.position = {5, 0.5f, 1.5f};
    light.direction = glm::normalize(glm::vec3(-5, 0.2f, -1.2f));
    light.outerConeRadians = 1.2f;
    light.innerConeRadians = 1;
    for (const Light::Kind kind : {Light::Kind::directional, Light::Kind::spot, Light::Kind::point}) {
        light.kind = kind;
        light.intensity = kind == Light::Kind::directional ? 2.0f : 40.0f;
        FrameView view = lookingAtTheBall(scene);
        view.width = 96;
        view.height = 64;
        view.pictureFormat = graph::Format::rgba32f;
        view.settings.shadowResolution = 128;
        const Image shaded = drawn(view);
        view.settings.leftOut = allEffects();
        const Image unshaded = drawn(view);
        int darker = 0;
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                const float lost = unshaded.pixel(x, y)[1] - shaded.pixel(x, y)[1];
                darker += lost > 0;
                if (x > view.width / 2 && y > view.height / 2) {
                    ASSERT_EQ(lost, 0) << static_cast<int>(kind) << ": " << x << " " << y;
                }
            }
        EXPECT_GT(darker, 20) << static_cast<int>(kind);
    }
}

}  // namespace
}  // namespace quincunx

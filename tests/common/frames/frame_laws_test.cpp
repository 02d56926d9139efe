// The two laws of planned frames, and what the table says of scenes that are known.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "geometry/shapes.h"
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
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

EffectSet allEffects() {
    EffectSet all;
    for (std::size_t i = 0; i < effects().size(); ++i)
        all.set(i);
    return all;
}

class FrameLaws : public testing::Test {
  protected:
    FrameLaws() : context_(gl::createOffscreenContext(gl::Backend::automatic)) {}

    Image drawn(const FrameView& view) {
        graph::FrameGraph graph;
        const graph::Resource picture = renderer_.build(graph, view);
        graph.addOutput(picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(picture));
    }

    /// Law 1 for that view, in eight bits and in float.
    void expectForcingChangesNothing(FrameView view, const std::string& what) {
        for (const graph::Format format : {graph::Format::rgba8Srgb, graph::Format::rgba32f}) {
            view.pictureFormat = format;
            view.settings.forced = {};
            const Image planned = drawn(view);
            view.settings.forced = allEffects();
            const Image forced = drawn(view);
            for (const PlannedEffect& effect : renderer_.plan().effects)
                ASSERT_TRUE(effect.added) << effect.name;
            ASSERT_EQ(planned, forced) << what;
        }
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    FrameRenderer renderer_;
};

Camera cameraFor(const Scene& scene, float aspect) {
    return scene.cameras.empty() ? frameBounds(scene.bounds(), aspect) : scene.cameras.front();
}

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
    // Textures of every use, over materials that mirror, cut out and blend.
    Scene scene = tessellate(makeStillLife(), 16);
    Random random(1);
    for (const Encoding encoding : {Encoding::srgb, Encoding::linear}) {
        Image8 image(8, 8, 4, encoding);
        for (std::uint8_t& texel : image.data)
            texel = static_cast<std::uint8_t>(64 + random.below(192));
        scene.textures.push_back({.name = "noise", .image = std::move(image)});
    }
    const std::size_t color = scene.textures.size() - 2;
    const std::size_t numbers = scene.textures.size() - 1;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        Material& material = scene.materials[i];
        material.baseColorTexture = color;
        material.metallicRoughnessTexture = numbers;
        material.normalTexture = numbers;
        material.occlusionTexture = numbers;
        material.emissionTexture = color;
        material.emission = glm::vec3(0.1f);
        material.metallic = 1;
        material.roughness = 0.3f;
        material.alphaMode = static_cast<Material::AlphaMode>(i % 3);
        material.baseColor.a = 0.7f;
    }
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

/// Scenes of a few objects of every kind, with lights and cameras of every kind, near the origin or far away.
struct RandomScene {
    Scene scene;
    std::vector<glm::mat4> open;
    std::vector<glm::mat4> close;
    FrameView view;

    RandomScene(std::uint64_t seed, const std::vector<Mesh>& meshes);
};

glm::vec3 randomPoint(Random& random, float reach) {
    return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

glm::vec3 randomDirection(Random& random) {
    for (;;) {
        const glm::vec3 p = randomPoint(random, 1);
        const float length = glm::length(p);
        if (length > 0.1f && length < 1)
            return p / length;
    }
}

Material randomMaterial(Random& random) {
    const glm::vec3 color(random.uniform(), random.uniform(), random.uniform());
    Material material = makeMaterial(
        "m",
        {.diffuse = color, .metallic = random.below(3) == 0 ? 1.0f : 0.0f, .roughness = random.uniform()});
    material.baseColor.a = random.uniform();
    material.alphaMode = static_cast<Material::AlphaMode>(random.below(3));
    material.alphaCutoff = random.uniform();
    material.doubleSided = random.below(3) == 0;
    if (random.below(4) == 0)
        material.emission = 3.0f * color;
    return material;
}

Light randomLight(Random& random, const glm::vec3& origin) {
    Light light;
    light.kind = static_cast<Light::Kind>(random.below(3));
    light.position = origin + randomPoint(random, 6);
    light.direction = randomDirection(random);
    light.color = {random.uniform(), random.uniform(), random.uniform()};
    light.intensity = light.kind == Light::Kind::directional ? 1.0f : 20.0f;
    light.outerConeRadians = static_cast<float>(random.uniform(0, 1.57));
    light.innerConeRadians = light.outerConeRadians * random.uniform();
    if (random.below(2) == 0)
        light.range = static_cast<float>(random.uniform(0.5, 8));
    return light;
}

FrameSettings randomSettings(Random& random) {
    FrameSettings settings;
    settings.shadowResolution = 64;
    settings.environmentResolution = 16;
    const auto sometimes = [&](float value) { return random.below(3) == 0 ? value : 0.0f; };
    settings.exposureStops = sometimes(1.5f);
    settings.toneCurve = static_cast<ToneCurve>(random.below(3));
    settings.bloomStrength = sometimes(0.7f);
    settings.blurSigmaPixels = sometimes(1.3f);
    settings.greyscale = sometimes(0.6f);
    settings.fxaa = random.below(3) == 0;
    settings.shutterSeconds = sometimes(0.02f);
    return settings;
}

RandomScene::RandomScene(std::uint64_t seed, const std::vector<Mesh>& meshes)
    : view{.scene = scene, .camera = {}, .width = 48, .height = 32} {
    Random random(seed);
    const float away[] = {0, 0, 0, 1e3f, 1e6f};
    const glm::vec3 origin = away[random.below(5)] * randomDirection(random);
    scene.meshes = meshes;
    const std::uint64_t materials = 1 + random.below(3);
    for (std::uint64_t i = 0; i < materials; ++i)
        scene.materials.push_back(randomMaterial(random));
    const std::uint64_t objects = random.below(7);
    for (std::uint64_t i = 0; i < objects; ++i) {
        glm::mat4 placement(1);
        const glm::vec3 axis = randomDirection(random);
        const glm::vec3 other = glm::normalize(glm::cross(axis, randomDirection(random)));
        const float size = 0.3f + random.uniform();
        placement[0] = glm::vec4(size * axis, 0);
        placement[1] = glm::vec4(size * other, 0);
        placement[2] = glm::vec4((random.below(4) == 0 ? -size : size) * glm::cross(axis, other), 0);
        placement[3] = glm::vec4(origin + randomPoint(random, 4), 1);
        scene.instances.push_back(
            {"object", random.below(meshes.size()), random.below(materials), placement});
    }
    const std::uint64_t lights = random.below(5);
    for (std::uint64_t i = 0; i < lights; ++i)
        scene.lights.push_back(randomLight(random, origin));
    scene.backgroundTop = {random.uniform(), random.uniform(), random.uniform()};
    scene.backgroundBottom = {random.uniform(), random.uniform(), random.uniform()};
    Camera camera;
    const float inside = random.below(4) == 0 ? 0.5f : 6.0f;  // often within an object
    const glm::vec3 eye = origin + randomPoint(random, inside);
    camera.worldFromCamera = lookAt(eye, eye + randomDirection(random), {0, 1, 0});
    camera.fovYRadians = static_cast<float>(random.uniform(0.2, 2.5));
    camera.nearDistance = random.below(4) == 0 ? 1e-3f : 0.1f;
    camera.farDistance = random.below(4) == 0 ? std::numeric_limits<float>::infinity() : 100;
    if (random.below(4) == 0) {
        camera.apertureRadius = 0.1f;
        camera.focusDistance = 4;
    }
    view.camera = view.cameraAtOpen = view.cameraAtClose = camera;
    if (random.below(3) == 0)
        view.cameraAtOpen.worldFromCamera =
            lookAt(eye + randomPoint(random, 0.2f), eye + randomDirection(random), {0, 1, 0});
    for (const Instance& instance : scene.instances) {
        open.push_back(instance.worldFromModel);
        close.push_back(instance.worldFromModel);
        if (random.below(4) == 0)
            close.back()[3].x += 0.3f;
    }
    view.worldFromModelAtOpen = open;
    view.worldFromModelAtClose = close;
    view.settings = randomSettings(random);
}

std::vector<Mesh> smallMeshes() {
    Mesh quad;
    quad.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    quad.normals.assign(4, {0, 1, 0});
    quad.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    Mesh nothing;
    return {tessellate(Sphere{}, 12), tessellate(Capsule{}, 8), tessellate(Torus{}, 12), quad, nothing};
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

/// A ball before the camera on a quad, a sun, and room for what the tests add.
Scene ballOnAFloor() {
    Scene scene;
    scene.meshes = smallMeshes();
    scene.materials = {makeMaterial("matt", {.diffuse = {0.6f, 0.5f, 0.4f}, .roughness = 0.9f})};
    scene.instances = {{"ball", 0, 0, glm::mat4(1)}};
    scene.lights.emplace_back();
    scene.lights.back().name = "key";
    scene.lights.back().direction = glm::normalize(glm::vec3(-1, -2, -1));
    return scene;
}

FrameView lookingAtTheBall(const Scene& scene) {
    FrameView view{.scene = scene, .camera = {}, .width = 48, .height = 32};
    view.camera.worldFromCamera = lookAt({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    view.cameraAtOpen = view.cameraAtClose = view.camera;
    view.settings.shadowResolution = 64;
    return view;
}

/// Where the camera of `lookingAtTheBall` does not see it.
glm::mat4 behindTheCamera() {
    glm::mat4 placement(1);
    placement[3] = {0, 0, 20, 1};
    return placement;
}

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
    withGlass.instances.push_back({"glass", 0, 1, behindTheCamera()});
    // The sun comes from the front: the glass behind the camera casts nothing, since what blends does not.
    EXPECT_EQ(demandOf(lookingAtTheBall(withGlass)), demand);

    Scene withMirror = plain;
    withMirror.materials.push_back(
        makeMaterial("mirror", {.diffuse = glm::vec3(0.9f), .metallic = 1, .roughness = 0}));
    glm::mat4 aside = behindTheCamera();
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
    scene.instances[0].worldFromModel = behindTheCamera();
    EXPECT_FALSE(decisionOf(view, "directional shadows").calledFor);
    EXPECT_THAT(decisionOf(view, "directional shadows").reason, HasSubstr("nothing is in view"));
}

TEST(CalledFor, TransparencyOrderNeedsBlendedTrianglesInView) {
    Scene scene = ballOnAFloor();
    const FrameView view = lookingAtTheBall(scene);
    EXPECT_THAT(decisionOf(view, "transparency order").reason, HasSubstr("nothing in the scene blends"));
    scene.materials[0].alphaMode = Material::AlphaMode::blend;
    EXPECT_TRUE(decisionOf(view, "transparency order").calledFor);
    scene.instances[0].worldFromModel = behindTheCamera();
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

TEST_F(FrameLaws, TargetsOfOnePixelAndOfTheWidestHold) {
    const Scene scene = ballOnAFloor();
    FrameView view = lookingAtTheBall(scene);
    view.settings.fxaa = true;
    view.settings.bloomStrength = 0.5f;
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(16384, 1), std::pair(1, 16384)}) {
        view.width = width;
        view.height = height;
        const Image picture = drawn(view);
        EXPECT_EQ(picture.width, width);
        EXPECT_EQ(picture.height, height);
    }
    view.width = 0;
    EXPECT_THROW(drawn(view), InputError);
}

}  // namespace
}  // namespace quincunx

// Planned frames of scenes and views that are hard to draw.

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "base/error.h"
#include "image/compare.h"
#include "math/projection.h"
#include "scene/colonnade.h"
#include "scene/export_gltf.h"
#include "scene/import.h"
#include "scene/spaceship.h"
#include "scene/town.h"
#include "tests/common/frames/frame_scenes.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::ballOnAFloor;
using test::lookingAtTheBall;
using test::RandomScene;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();

Material glowing(const glm::vec3& color) {
    Material material = makeMaterial("glow", {.diffuse = glm::vec3(0), .roughness = 1, .emission = color});
    material.doubleSided = true;
    return material;
}

glm::mat4 placed(const glm::vec3& at, float size = 1) {
    glm::mat4 placement(glm::mat3{size});
    placement[3] = glm::vec4(at, 1);
    return placement;
}

bool isFinite(const Image& image) {
    return std::all_of(image.data.begin(), image.data.end(), [](float x) { return std::isfinite(x); });
}

class FrameHardCases : public test::Frames {
  protected:
    /// In float; law 1 holds, and every pixel is a number.
    Image drawnBothWays(FrameView view, const std::string& what) {
        expectForcingChangesNothing(view, what);
        view.pictureFormat = graph::Format::rgba32f;
        const Image picture = drawn(view);
        EXPECT_TRUE(isFinite(picture)) << what;
        return picture;
    }
    void expectCullingChangesNothing(FrameView view, const std::string& what) {
        view.settings.drawsUnseen = false;
        const Image culled = drawn(view);
        const std::size_t seen = renderer_.plan().drawn;
        view.settings.drawsUnseen = true;
        ASSERT_EQ(culled, drawn(view)) << what;
        left_ += renderer_.plan().drawn - seen;
        kept_ += seen;
    }
    std::size_t left_ = 0;  ///< objects that culling left out
    std::size_t kept_ = 0;
};

using FrameCulling = FrameHardCases;

TEST_F(FrameCulling, ChangesNoBitOfTheBuiltInAndImportedScenes) {
    const test::TemporaryFolder folder;
    exportScene(test::texturedStillLife(), folder / "scene.gltf");
    const std::pair<const char*, Scene> scenes[] = {{"still life", tessellate(makeStillLife(), 12)},
                                                    {"colonnade", tessellate(makeColonnade(), 12)},
                                                    {"spaceship", makeSpaceship(12)},
                                                    {"town", makeTown().scene},
                                                    {"imported", importScene(folder / "scene.gltf").scene}};
    Random random(1);
    for (const auto& [name, scene] : scenes) {
        renderer_.reset();
        const Bounds bounds = scene.bounds();
        const glm::vec3 middle = 0.5f * (bounds.min + bounds.max);
        const float size = glm::length(bounds.max - bounds.min);
        for (int i = 0; i < 6; ++i) {
            FrameView view{.scene = scene, .camera = {}, .width = 60, .height = 40};
            const glm::vec3 eye = middle + 0.4f * test::randomPoint(random, size);
            view.camera.worldFromCamera =
                lookAt(eye, middle + 0.3f * test::randomPoint(random, size), {0, 1, 0});
            view.camera.nearDistance = 1e-3f * size;
            view.camera.farDistance = i % 2 == 0 ? infinity : size;
            view.camera.fovYRadians = i % 3 == 0 ? 0.3f : 1.2f;
            view.settings.shadowResolution = 64;
            view.settings.environmentResolution = 16;
            expectCullingChangesNothing(view, name);
        }
    }
    EXPECT_GT(left_, 1000u);  // measured 2946, and 3930 that were kept
    EXPECT_GT(kept_, 100u);
}

TEST_F(FrameCulling, ChangesNoBitOfRandomScenes) {
    const std::vector<Mesh> meshes = test::smallMeshes();
    for (std::uint64_t seed = 1000; seed < 1100; ++seed) {
        RandomScene random(seed, meshes);
        renderer_.reset();
        expectCullingChangesNothing(random.view, "seed " + std::to_string(seed));
    }
    EXPECT_GT(left_, 50u);  // measured 167, and 76 that were kept
    EXPECT_GT(kept_, 50u);
}

/// The share of pixels that show the farther of two slanted sheets, the nearer a share of z² / near before
/// it.
class DeepViews : public FrameHardCases {
  protected:
    double wrongShare(float near, float far, float distance, double stepsOfDepth) {
        Scene scene;
        scene.meshes = test::smallMeshes();
        // The farther one is drawn first, and keeps its place where the depths are equal.
        scene.materials = {glowing({0, 1, 0}), glowing({1, 0, 0})};
        const double step = static_cast<double>(distance) * static_cast<double>(distance) / near;
        glm::mat4 sheet = lookAt(glm::vec3(0), glm::normalize(glm::vec3(0.2f, -1, 0.35f)), {0, 0, 1});
        for (int column = 0; column < 3; ++column)
            sheet[column] *= 4 * distance;
        sheet = sheet * glm::mat4(glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)));
        sheet[3] = {0, 0, -distance, 1};
        scene.instances.push_back({"far", 3, 0, sheet});
        sheet[3].z += static_cast<float>(stepsOfDepth * step);
        scene.instances.push_back({"near", 3, 1, sheet});
        renderer_.reset();
        FrameView view{.scene = scene, .camera = {}, .width = 64, .height = 64};
        view.camera.fovYRadians = 0.05f;
        view.camera.nearDistance = near;
        view.camera.farDistance = far;
        const Image picture = drawnBothWays(view, "deep view");
        int wrong = 0;
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x)
                wrong += picture.pixel(x, y)[1] > 0 ? 1 : 0;
        return wrong / (64.0 * 64.0);
    }
};

TEST_F(DeepViews, KeepTheOrderOfWhatTheDepthTellsApart) {
    for (const auto& [near, far] : {std::pair(1.0f, 1e7f), std::pair(1e-3f, 1e4f), std::pair(1.0f, infinity)})
        for (const float steps : {10.0f, 100.0f, 1000.0f, 1e4f})
            EXPECT_EQ(wrongShare(near, far, steps * near, 0x1p-21), 0) << near << " " << far << " " << steps;
}

TEST_F(DeepViews, LoseTheOrderOfWhatIsMuchNearerTogether) {
    // A quarter of a step of the depth at 1, which is 2^-24: what is behind shows through.
    EXPECT_GT(wrongShare(1, 1e7f, 1000, 0x1p-26), 0.1);
}

TEST_F(FrameHardCases, ViewersInsideGeometrySeeItsBacksOrThroughIt) {
    Scene scene = ballOnAFloor();
    scene.backgroundTop = scene.backgroundBottom = {0.25f, 0.5f, 0.125f};
    scene.lights.clear();
    scene.materials[0] = glowing({0.5f, 0.25f, 1});
    FrameView view = lookingAtTheBall(scene);
    view.camera.worldFromCamera = glm::mat4(1);
    view.camera.nearDistance = 0.01f;
    for (const bool doubleSided : {false, true}) {
        scene.materials[0].doubleSided = doubleSided;
        const glm::vec3 expected = doubleSided ? glm::vec3(0.5f, 0.25f, 1) : scene.backgroundTop;
        const Image picture = drawnBothWays(view, "inside");
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                for (int c = 0; c < 3; ++c)
                    ASSERT_EQ(picture.pixel(x, y)[c], expected[c]) << doubleSided << " " << x << " " << y;
    }
    // Glass all around, a mirror all around, and a light inside together with the eye.
    scene.lights.emplace_back();
    scene.lights[0].kind = Light::Kind::point;
    for (const int kind : {0, 1, 2}) {
        Material& material = scene.materials[0];
        material = makeMaterial("m", {.diffuse = {0.4f, 0.5f, 0.6f},
                                      .metallic = kind == 1 ? 1.0f : 0.0f,
                                      .roughness = kind == 1 ? 0.0f : 0.8f});
        material.doubleSided = true;
        material.alphaMode = kind == 0 ? Material::AlphaMode::blend : Material::AlphaMode::opaque;
        material.baseColor.a = 0.5f;
        renderer_.reset();
        drawnBothWays(view, "inside, kind " + std::to_string(kind));
    }
}

TEST_F(FrameHardCases, CastersBeforeAndAcrossTheLightsNearPlaneCastTheirShadows) {
    // A lamp 4 above a floor, whose map begins at a thousandth of its reach; right below it a sheet that
    // covers a cone, and one that stands upright in it, from above the lamp to below it.
    Scene scene = ballOnAFloor();
    glm::mat4 floor = placed({0, -1, 0}, 3);
    scene.instances = {{"floor", 3, 0, floor}};
    scene.materials[0].doubleSided = true;
    Light& light = scene.lights[0];
    light.position = {0, 3, 0};
    light.direction = {0, -1, 0};
    light.outerConeRadians = 1;
    light.intensity = 30;
    FrameView view = lookingAtTheBall(scene);
    view.camera.worldFromCamera = lookAt({0, 2, 6}, {0, -1, 0}, {0, 1, 0});
    view.settings.shadowResolution = 256;
    for (const Light::Kind kind : {Light::Kind::spot, Light::Kind::point}) {
        light.kind = kind;
        renderer_.reset();
        scene.instances.resize(1);
        const Image lit = drawnBothWays(view, "no caster");
        const int x = view.width / 2;
        const int y = view.height / 2;
        ASSERT_GT(lit.pixel(x, y)[1], 0.05f);
        // 1e-3 of the lamp's distance below it, less than the near plane's.
        scene.instances.push_back({"cap", 3, 0, placed({0, 2.997f, 0}, 0.003f)});
        renderer_.reset();
        const Image capped = drawnBothWays(view, "a caster before the near plane");
        EXPECT_LT(capped.pixel(x, y)[1], 0.1f * lit.pixel(x, y)[1]);
        // Upright in the plane of x and y, wide enough to shade a line below the lamp, across the near plane.
        glm::mat4 upright(glm::mat3(glm::vec3(0.6f, 0, 0), glm::vec3(0, 0, 0.6f), glm::vec3(0, 0.6f, 0)));
        upright[3] = {0, 2.6f, -0.02f, 1};
        scene.instances[1].worldFromModel = upright;
        renderer_.reset();
        const Image split = drawnBothWays(view, "a caster across the near plane");
        // What lies beyond the sheet is in its shadow, what lies before it is not.
        int beyond = 0;
        int before = 0;
        for (int row = 0; row < view.height; ++row) {
            const bool dark = split.pixel(x, row)[1] < 0.1f * lit.pixel(x, row)[1];
            if (lit.pixel(x, row)[1] > 0.05f)
                (row < y ? beyond : before) += dark ? 1 : 0;
        }
        EXPECT_GT(beyond, 1) << static_cast<int>(kind);
        EXPECT_EQ(before, 0) << static_cast<int>(kind);
    }
}

/// A row of posts that stands along the view, from 2 to 300 units away, under a slanting sun.
Scene avenue() {
    Scene scene = ballOnAFloor();
    scene.materials[0].doubleSided = true;
    scene.instances = {{"ground", 3, 0, placed({0, -1, -150}, 200)}};
    for (int i = 0; i < 24; ++i) {
        const float away = 2 * std::pow(1.24f, static_cast<float>(i));
        glm::mat4 post = placed({i % 2 == 0 ? -1.5f : 1.5f, 0, 2 - away}, 0.25f);
        post[1] *= 4;
        scene.instances.push_back({"post", 0, 0, post});
    }
    scene.lights[0].direction = glm::normalize(glm::vec3(-2, -1.5f, -0.3f));
    return scene;
}

class FrameShadowMaps : public FrameHardCases {
  protected:
    FrameShadowMaps() : scene_(avenue()), view_(lookingAtTheBall(scene_)) {
        view_.camera.worldFromCamera = lookAt({0, 1.5f, 4}, {0, 0, -8}, {0, 1, 0});
        view_.camera.farDistance = 400;
        view_.width = 120;
        view_.height = 80;
        view_.pictureFormat = graph::Format::rgba32f;
    }
    Image withMap(int resolution, int cascades) {
        view_.settings.shadowResolution = resolution;
        view_.settings.shadowCascades = cascades;
        return drawn(view_);
    }
    Scene scene_;
    FrameView view_;
};

TEST_F(FrameShadowMaps, SlicesOfADeepViewShadeBetterWithTheSameTexels) {
    const Image reference = withMap(8192, 1);
    const double whole = rmse(reference, withMap(512, 1));
    const double sliced = rmse(reference, withMap(512, 4));
    const double chosen = rmse(reference, withMap(512, 0));
    // Measured 0.0504 and 0.0236: the same number of texels, in slices.
    EXPECT_GT(whole, 0.04);
    EXPECT_LT(sliced, 0.6 * whole);
    EXPECT_EQ(chosen, sliced);
    view_.settings.shadowResolution = 256;
    view_.settings.shadowCascades = 0;
    drawnBothWays(view_, "sliced");
    expectCullingChangesNothing(view_, "sliced");
}

TEST_F(FrameShadowMaps, AViewOfLittleDepthIsNotCut) {
    const auto cascades = [](double nearest, double farthest) {
        return cascadesFor({.nearest = nearest, .farthest = farthest});
    };
    EXPECT_EQ(cascades(2, 8), 1);
    EXPECT_EQ(cascades(2, 9), 2);
    EXPECT_EQ(cascades(1, 17), 3);
    EXPECT_EQ(cascades(1, 65), 4);
    EXPECT_EQ(cascades(1e-3, 1e7), 4);
}

TEST_F(FrameShadowMaps, CastersAreDrawnOnlyIntoTheViewsThatSeeThem) {
    // A lamp among the posts: each stands in one or two of its six views.
    scene_.lights[0].kind = Light::Kind::point;
    scene_.lights[0].position = {0, 1, -6};
    scene_.lights[0].intensity = 50;
    withMap(256, 0);
    const std::size_t culled = renderer_.plan().shadowTriangles;
    view_.settings.drawsUnseen = true;
    withMap(256, 0);
    const std::size_t all = renderer_.plan().shadowTriangles;
    EXPECT_LT(culled, all / 4);  // measured 3372 of 17292
    view_.settings.drawsUnseen = false;
    expectCullingChangesNothing(view_, "a lamp");
}

TEST_F(FrameHardCases, DegenerateBoundsGivePicturesOfNumbers) {
    Scene scene = ballOnAFloor();
    scene.materials.push_back(makeMaterial(
        "mirror", {.diffuse = glm::vec3(0), .specular = glm::vec3(0.9f), .metallic = 1, .roughness = 0}));
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().alphaMode = Material::AlphaMode::blend;
    scene.materials.back().baseColor.a = 0.5f;
    Light lamp = scene.lights[0];
    lamp.kind = Light::Kind::point;
    lamp.position = {1, 2, 3};
    lamp.intensity = 10;
    scene.lights.push_back(lamp);
    scene.instances.push_back({"odd", 0, 0, glm::mat4(0)});
    const FrameView view = lookingAtTheBall(scene);
    const auto withRow = [](int column, const glm::vec4& value) {
        glm::mat4 placement(1);
        placement[column] = value;
        return placement;
    };
    const glm::mat4 placements[] = {
        glm::mat4(0),                       // no extent, and no fourth coordinate
        withRow(0, glm::vec4(0)),           // flat
        placed({0, 0, 0}, 0),               // a point
        placed({0, 0, 0}, 1e-30f),          // smaller than floats tell
        placed({0, 0, 0}, 1e18f),           // larger than all else
        withRow(3, {notANumber, 0, 0, 1}),  // nowhere
        withRow(3, {infinity, 0, 0, 1}),    // infinitely far
        withRow(1, {0, infinity, 0, 0}),    // infinitely high
    };
    for (std::size_t i = 0; i < std::size(placements); ++i)
        for (std::size_t material = 0; material < scene.materials.size(); ++material) {
            scene.instances[1].worldFromModel = placements[i];
            scene.instances[1].material = material;
            renderer_.reset();
            drawnBothWays(view, "placement " + std::to_string(i) + ", material " + std::to_string(material));
        }
}

TEST_F(FrameHardCases, EmptyScenesAreTheirBackground) {
    Scene scene;
    scene.backgroundTop = scene.backgroundBottom = {0.5f, 0.25f, 0.125f};
    FrameView view = lookingAtTheBall(scene);
    view.settings.shutterSeconds = 0.1f;
    const auto expectBackground = [&](const std::string& what) {
        renderer_.reset();
        const Image picture = drawnBothWays(view, what);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                for (int c = 0; c < 3; ++c)
                    ASSERT_EQ(picture.pixel(x, y)[c], scene.backgroundTop[c]) << what;
    };
    expectBackground("nothing at all");
    for (const Light::Kind kind : {Light::Kind::directional, Light::Kind::spot, Light::Kind::point}) {
        scene.lights.emplace_back();
        scene.lights.back().kind = kind;
    }
    expectBackground("lights");
    scene.meshes = test::smallMeshes();
    scene.materials.emplace_back();
    expectBackground("meshes that nothing uses");
    scene.instances.push_back({"nothing", 4, 0, glm::mat4(1)});
    expectBackground("an instance of no triangles");
    scene.instances.push_back({"behind", 0, 0, test::placedBehind()});
    expectBackground("an instance behind the camera");
}

TEST_F(FrameHardCases, AMillionUnitsFromTheOriginThePictureIsTheSameBitForBit) {
    // Placements of a few bits, so that they can be moved by 2^20 without rounding.
    Scene scene = ballOnAFloor();
    scene.materials.push_back(makeMaterial(
        "mirror", {.diffuse = glm::vec3(0), .specular = glm::vec3(0.9f), .metallic = 1, .roughness = 0}));
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().alphaMode = Material::AlphaMode::blend;
    scene.materials.back().baseColor = {0.9f, 0.2f, 0.1f, 0.5f};
    scene.instances.push_back({"floor", 3, 0, placed({0, -1, 0}, 4)});
    scene.instances.push_back({"mirror", 0, 1, placed({-1.75f, 0, 0.5f}, 0.75f)});
    scene.instances.push_back({"glass", 0, 2, placed({1.5f, 0.25f, 1}, 0.75f)});
    Light spot = scene.lights[0];
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
    view.settings.shadowResolution = 256;
    const Image near = drawnBothWays(view, "at the origin");
    const glm::vec3 away(0x1p20f, -0x1p20f, 0x1p19f);
    for (Instance& instance : scene.instances)
        instance.worldFromModel[3] += glm::vec4(away, 0);
    for (Light& light : scene.lights)
        light.position += away;
    view.camera.worldFromCamera[3] += glm::vec4(away, 0);
    view.cameraAtOpen = view.cameraAtClose = view.camera;
    renderer_.reset();
    EXPECT_EQ(drawnBothWays(view, "far away"), near);
    for (const char* effect :
         {"directional shadows", "spot shadows", "point shadows", "environment map", "transparency order"})
        EXPECT_TRUE(renderer_.plan().find(effect).decision.calledFor) << effect;
}

TEST_F(FrameHardCases, AMirrorShowsNeitherSeamsNorPoles) {
    // A white metal in an even surrounding reflects just that, also where faces of the map meet and straight
    // up and down.
    Scene scene = ballOnAFloor();
    scene.lights.clear();
    scene.backgroundTop = scene.backgroundBottom = glm::vec3(0.5f);
    scene.materials[0] = makeMaterial(
        "mirror", {.diffuse = glm::vec3(0), .specular = glm::vec3(1), .metallic = 1, .roughness = 0});
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            FrameView view = lookingAtTheBall(scene);
            glm::vec3 eye(0);
            eye[axis] = 3 * sign;
            view.camera.worldFromCamera =
                lookAt(eye, {0, 0, 0}, axis == 1 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0));
            const Image picture = drawnBothWays(view, "mirror");
            for (int y = 0; y < picture.height; ++y)
                for (int x = 0; x < picture.width; ++x)
                    ASSERT_NEAR(picture.pixel(x, y)[1], 0.5f, 0.01f)
                        << axis << " " << sign << " " << x << " " << y;
        }
}

TEST_F(FrameHardCases, TargetsOfOnePixelAndOfTheWidestHoldWithEveryEffect) {
    const Scene scene = ballOnAFloor();
    FrameView view = lookingAtTheBall(scene);
    view.settings.fxaa = true;
    view.settings.bloomStrength = 0.5f;
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(16384, 1), std::pair(1, 16384)}) {
        view.width = width;
        view.height = height;
        const Image picture = drawnBothWays(view, std::to_string(width) + "x" + std::to_string(height));
        EXPECT_EQ(picture.width, width);
        EXPECT_EQ(picture.height, height);
    }
    for (const auto& [width, height] :
         {std::pair(0, 0), std::pair(0, 4), std::pair(4, 0), std::pair(-1, 4)}) {
        view.width = width;
        view.height = height;
        EXPECT_THROW(drawn(view), InputError);
    }
}

}  // namespace
}  // namespace quincunx

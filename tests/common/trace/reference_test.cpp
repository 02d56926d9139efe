#include "trace/reference.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/random.h"
#include "trace/phong_glsl.h"

namespace quincunx {
namespace {

using glm::dmat3;
using glm::dvec3;
using glm::vec3;

using Reflection = PhongModel::Reflection;

StillLife ballScene() {
    StillLife scene;
    Material material;
    material.ambient = {0.3f, 0.2f, 0.1f};
    material.diffuse = {0.5f, 0.25f, 0.75f};
    material.specular = {0.125f, 0.5f, 0.25f};
    material.emission = {0.01f, 0.02f, 0.03f};
    material.shininess = 20;
    scene.objects = {{"ball", Sphere{1}, material, glm::mat4(1)}};
    Light sun;
    sun.direction = glm::normalize(vec3(-1, -2, -2));
    sun.color = {1, 0.5f, 0.25f};
    sun.intensity = 2;
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.position = {3, 1, 4};
    lamp.color = {0.25f, 1, 0.5f};
    lamp.intensity = 12;
    Light spot = lamp;
    spot.kind = Light::Kind::spot;
    spot.position = {-2, 0, 4};
    spot.direction = glm::normalize(vec3(2, 0, -4));
    spot.innerConeRadians = 0.05f;
    spot.outerConeRadians = 0.2f;
    scene.lights = {sun, lamp, spot};
    scene.camera.worldFromCamera = glm::translate(glm::mat4(1), {0, 0, 5});
    scene.camera.fovYRadians = 0.5f;
    scene.ambientLight = {0.5f, 0.25f, 0.125f};
    scene.backgroundTop = {0.1f, 0.2f, 0.9f};
    scene.backgroundBottom = {0.4f, 0.3f, 0.2f};
    return scene;
}

Image trace(const StillLife& scene, int width, int height, const PhongModel& model = {},
            const glm::mat4& worldFromWorld = glm::mat4(1)) {
    return traceReference(TraceScene(placedBy(scene, worldFromWorld)), scene.camera, width, height, model);
}

PhongModel only(bool PhongModel::*term) {
    PhongModel model{.ambient = false, .diffuse = false, .specular = false, .emission = false};
    model.*term = true;
    return model;
}

double worstDifference(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i])));
    return worst;
}

/// Where the ray through a pixel's centre meets the unit ball carried by `linear`, and the normal there, by
/// the textbook quadratic in long double.
struct BallHit {
    dvec3 position;
    dvec3 normal;
};

std::optional<BallHit> meetBall(const Camera& camera, int width, int height, int x, int y,
                                const dmat3& linear) {
    const double tangent = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const dvec3 direction((2.0 * x + 1 - width) / height * tangent, (height - 2.0 * y - 1) / height * tangent,
                          -1);
    const dvec3 eye(camera.worldFromCamera[3]);
    const dmat3 inverse = glm::inverse(linear);
    const dvec3 o = inverse * eye;
    const dvec3 d = inverse * direction;
    const long double a = glm::dot(d, d);
    const long double b = glm::dot(o, d);
    const long double c = glm::dot(o, o) - 1;
    const long double discriminant = b * b - a * c;
    if (discriminant < 0)
        return {};
    const auto t = static_cast<double>((-b - std::sqrt(discriminant)) / a);
    const dvec3 p = o + t * d;
    return BallHit{linear * p, glm::normalize(glm::transpose(inverse) * p)};
}

/// What the shaders' functions make of the same point, in float.
vec3 shadeAsShaders(const StillLife& scene, const BallHit& hit, bool blinn) {
    const Material& m = scene.objects.front().material;
    const glsl::PhongMaterial material{m.ambient, m.diffuse, m.specular, m.emission, m.shininess};
    vec3 sum = m.emission + m.ambient * scene.ambientLight;
    const vec3 position(hit.position);
    const vec3 wo = glsl::safeNormalize(vec3(scene.camera.worldFromCamera[3]) - position);
    for (const Light& l : scene.lights) {
        const glsl::PhongLight light{static_cast<int>(l.kind), l.position,         l.direction,
                                     l.color * l.intensity,    l.innerConeRadians, l.outerConeRadians};
        sum += glsl::reflectLight(material, light, position, vec3(hit.normal), wo, blinn);
    }
    return sum;
}

// The two are written apart, one in double with pow, one in float with the shaders' stable forms.
TEST(Reference, AgreesWithTheShadersFunctionsOnABallUnderAnyAffineMap) {
    const StillLife scene = ballScene();
    const dmat3 plain(1);
    const dmat3 sheared(dvec3(1, 0, 0), dvec3(0.6, 0.8, 0), dvec3(-0.3, 0.2, 1.1));
    const dmat3 mirrored(dvec3(-1, 0, 0), dvec3(0.25, 1.25, 0), dvec3(0, 0, 0.5));
    for (const dmat3& linear : {plain, sheared, mirrored}) {
        for (const Reflection reflection : {Reflection::phong, Reflection::blinnPhong}) {
            const int width = 48;
            const int height = 40;
            const Image image =
                trace(scene, width, height, {.reflection = reflection}, glm::mat4(glm::mat3(linear)));
            const dmat3 asUsed{glm::mat3(linear)};
            double worst = 0;
            int hits = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto hit = meetBall(scene.camera, width, height, x, y, asUsed);
                    if (!hit)
                        continue;
                    ++hits;
                    const vec3 expected = shadeAsShaders(scene, *hit, reflection == Reflection::blinnPhong);
                    for (int channel = 0; channel < 3; ++channel)
                        worst = std::max(worst, std::abs(static_cast<double>(image.pixel(x, y)[channel] -
                                                                             expected[channel])));
                }
            EXPECT_GT(hits, 200);
            // Float: a few ε of values up to 4, and ε √shininess of the highlight. Measured: 3.2e-6.
            EXPECT_LE(worst, 4e-6);
        }
    }
}

TEST(Reference, PixelInTheMiddleIsTheClosedForm) {
    StillLife scene = ballScene();
    scene.lights.resize(1);
    scene.lights[0].direction = {0, 0, -1};
    const Image image = trace(scene, 5, 5);
    const Material& m = scene.objects[0].material;
    for (int channel = 0; channel < 3; ++channel) {
        const double expected =
            static_cast<double>(m.emission[channel]) +
            static_cast<double>(m.ambient[channel]) * static_cast<double>(scene.ambientLight[channel]) +
            2.0 * static_cast<double>(scene.lights[0].color[channel]) *
                (static_cast<double>(m.diffuse[channel]) + static_cast<double>(m.specular[channel]));
        EXPECT_FLOAT_EQ(image.pixel(2, 2)[channel], static_cast<float>(expected));
    }
    EXPECT_EQ(image.pixel(2, 2)[3], 1);
}

TEST(Reference, BackgroundIsMixedAtRowCentres) {
    StillLife scene = ballScene();
    scene.objects.clear();
    const Image image = trace(scene, 3, 8);
    for (int y = 0; y < 8; ++y)
        for (int channel = 0; channel < 3; ++channel) {
            const double share = (8 - y - 0.5) / 8;
            EXPECT_FLOAT_EQ(
                image.pixel(1, y)[channel],
                static_cast<float>((1 - share) * static_cast<double>(scene.backgroundBottom[channel]) +
                                   share * static_cast<double>(scene.backgroundTop[channel])));
        }
}

TEST(Reference, FourTermsAddUpToTheWhole) {
    StillLife scene = makeStillLife();
    scene.backgroundTop = scene.backgroundBottom = vec3(0);
    for (const Reflection reflection : {Reflection::phong, Reflection::blinnPhong}) {
        Image sum(80, 60, 4, Encoding::linear);
        for (const auto term :
             {&PhongModel::ambient, &PhongModel::diffuse, &PhongModel::specular, &PhongModel::emission}) {
            PhongModel model = only(term);
            model.reflection = reflection;
            const Image part = trace(scene, 80, 60, model);
            EXPECT_GT(*std::max_element(part.data.begin(), part.data.end()), 0.01f);
            for (std::size_t i = 0; i < sum.data.size(); ++i)
                sum.data[i] += i % 4 == 3 ? 0.25f : part.data[i];
        }
        // Four roundings to float and three sums of values below 4.
        EXPECT_LE(worstDifference(sum, trace(scene, 80, 60, {.reflection = reflection})), 7 * 4 * 0x1p-24);
    }
}

TEST(Reference, IsLinearInTheLights) {
    StillLife scene = makeStillLife();
    const PhongModel model{.ambient = false, .emission = false};
    scene.backgroundTop = scene.backgroundBottom = vec3(0);
    const Image once = trace(scene, 80, 60, model);
    StillLife brighter = scene;
    for (Light& light : brighter.lights)
        light.intensity *= 4;
    const Image four = trace(brighter, 80, 60, model);
    for (std::size_t i = 0; i < once.data.size(); ++i)
        if (i % 4 != 3) {
            ASSERT_EQ(four.data[i], 4 * once.data[i]);
        }
    Image sum(80, 60, 4, Encoding::linear);
    for (const Light& light : scene.lights) {
        StillLife lit = scene;
        lit.lights = {light};
        const Image part = trace(lit, 80, 60, model);
        for (std::size_t i = 0; i < sum.data.size(); ++i)
            sum.data[i] += i % 4 == 3 ? 0.5f : part.data[i];
    }
    EXPECT_LE(worstDifference(sum, once), 3 * 4 * 0x1p-24);
}

TEST(Reference, IsTheSameOnAnyNumberOfThreads) {
    const StillLife scene = makeStillLife();
    std::vector<Image> pictures;
    for (const std::size_t threads : {1u, 2u, 7u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        pictures.push_back(trace(scene, 120, 90));
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_EQ(pictures[0], pictures[2]);
}

TEST(Reference, MirroredSceneGivesTheMirroredPicture) {
    // The width is a power of two, so that the two halves' directions are each other's exact mirror images.
    StillLife scene = makeStillLife();
    scene.camera.worldFromCamera = glm::translate(glm::mat4(1), {0, 0.5f, 12});
    const Image picture = trace(scene, 64, 48);
    StillLife mirrored = scene;
    for (Light& light : mirrored.lights) {
        light.position.x *= -1;
        light.direction.x *= -1;
    }
    const Image other = trace(mirrored, 64, 48, {}, glm::scale(glm::mat4(1), {-1, 1, 1}));
    double worst = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            for (int channel = 0; channel < 4; ++channel)
                worst = std::max(worst, std::abs(static_cast<double>(picture.pixel(x, y)[channel]) -
                                                 static_cast<double>(other.pixel(63 - x, y)[channel])));
    EXPECT_EQ(worst, 0);
    EXPECT_GT(worstDifference(picture, other), 0.1) << "the scene is its own mirror image";
}

TEST(Reference, ScaledWorldSeenFromScaledEyeLooksTheSame) {
    // Directional lights only: a lamp's fall-off has a scale. Powers of two change no rounding but in the
    // sums of positions, which scale as a whole.
    StillLife scene = makeStillLife();
    scene.lights = {scene.lights.back()};
    const Image picture = trace(scene, 64, 48);
    for (const float scale : {0x1p-40f, 0x1p40f}) {
        StillLife other = scene;
        other.camera.worldFromCamera[3] = glm::vec4(scale * vec3(scene.camera.worldFromCamera[3]), 1);
        other.camera.nearDistance *= scale;
        other.camera.farDistance *= scale;
        EXPECT_EQ(picture, trace(other, 64, 48, {}, glm::scale(glm::mat4(1), vec3(scale))));
    }
}

TEST(Reference, ReflectionModelsDiffer) {
    const StillLife scene = makeStillLife();
    EXPECT_GT(
        worstDifference(trace(scene, 64, 48), trace(scene, 64, 48, {.reflection = Reflection::blinnPhong})),
        0.05);
}

TEST(Reference, ExtremeShininessStaysFinite) {
    for (const float shininess : {0.0f, 1e-30f, 1e5f}) {
        StillLife scene = makeStillLife();
        for (StillLife::Object& object : scene.objects)
            object.material.shininess = shininess;
        for (const Reflection reflection : {Reflection::phong, Reflection::blinnPhong}) {
            const Image image = trace(scene, 64, 48, {.reflection = reflection});
            for (const float value : image.data) {
                ASSERT_TRUE(std::isfinite(value));
                ASSERT_GE(value, 0);
            }
        }
    }
}

TEST(Reference, CutsAtTheNearAndFarPlanes) {
    StillLife scene = ballScene();
    const Image whole = trace(scene, 15, 15);
    StillLife empty = scene;
    empty.objects.clear();
    const Image background = trace(empty, 15, 15);
    EXPECT_NE(whole, background);
    scene.camera.farDistance = 3.99f;
    EXPECT_EQ(trace(scene, 15, 15), background);
    scene.camera.farDistance = 100;
    scene.camera.nearDistance = 6.01f;
    EXPECT_EQ(trace(scene, 15, 15), background);
    // Between: the inside of the ball's far half, its normals still pointing out, away from the eye.
    scene.camera.nearDistance = 5;
    const Image inside = trace(scene, 15, 15, only(&PhongModel::emission));
    EXPECT_EQ(inside.pixel(7, 7)[0], scene.objects[0].material.emission.r);
    scene.lights = {scene.lights[0]};
    scene.lights[0].direction = {0, 0, -1};
    EXPECT_EQ(trace(scene, 15, 15, only(&PhongModel::diffuse)).pixel(7, 7)[0], 0);
}

TEST(Reference, FlattenedObjectsAreNotDrawn) {
    StillLife scene = ballScene();
    const Image flat = trace(scene, 9, 9, {}, glm::scale(glm::mat4(1), {1, 0, 1}));
    scene.objects.clear();
    EXPECT_EQ(flat, trace(scene, 9, 9));
}

TEST(Reference, StopsWhenAsked) {
    const StillLife scene = makeStillLife();
    const std::atomic<bool> stop = true;
    const Image image = traceReference(TraceScene(scene), scene.camera, 32, 24, {}, &stop);
    EXPECT_EQ(image, Image(32, 24, 4, Encoding::linear));
}

TEST(StillLife, HasAQuincunxOnItsPlinthAndSomethingThatGlows) {
    const StillLife stillLife = makeStillLife();
    const Scene scene = tessellate(stillLife, 12);
    ASSERT_EQ(scene.meshes.size(), stillLife.objects.size());
    ASSERT_EQ(scene.instances.size(), stillLife.objects.size());
    ASSERT_EQ(scene.materials.size(), stillLife.objects.size());
    int glowing = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        EXPECT_EQ(scene.instances[i].name, stillLife.objects[i].name);
        EXPECT_EQ(scene.meshes[scene.instances[i].mesh].triangleCount(),
                  triangleCount(stillLife.objects[i].shape, 12));
        glowing += scene.materials[i].emission != vec3(0);
    }
    EXPECT_EQ(glowing, 1);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 2u);
}

}  // namespace
}  // namespace quincunx

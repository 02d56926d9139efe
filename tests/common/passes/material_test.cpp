#include "passes/material.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/paths.h"
#include "base/random.h"
#include "geometry/shapes.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/forward.h"
#include "passes/targets.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

/// A square of `columns` × `rows` cells over −1 … 1 in x and y at z = 0, facing +z; texture coordinates from
/// 0 at the top left to 1.
Mesh makeSquare(int cells = 1) {
    Mesh mesh;
    mesh.name = "square";
    const auto side = static_cast<std::uint32_t>(cells) + 1;
    for (std::uint32_t j = 0; j < side; ++j)
        for (std::uint32_t i = 0; i < side; ++i) {
            const vec2 st(static_cast<float>(i) / static_cast<float>(cells),
                          static_cast<float>(j) / static_cast<float>(cells));
            mesh.positions.emplace_back(2 * st.x - 1, 1 - 2 * st.y, 0);
            mesh.texcoords.push_back(st);
        }
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    for (std::uint32_t j = 0; j + 1 < side; ++j)
        for (std::uint32_t i = 0; i + 1 < side; ++i) {
            const std::uint32_t a = j * side + i;
            for (const std::uint32_t v : {a, a + side, a + side + 1, a, a + side + 1, a + 1})
                mesh.indices.push_back(v);
        }
    return mesh;
}

/// Nearest texels, no mipmaps.
Texture makePixels(int width, int height, Encoding encoding, const std::vector<int>& rgba) {
    Texture texture;
    texture.image = Image8(width, height, 4, encoding);
    QX_CHECK_EQ(rgba.size(), texture.image.data.size());
    std::transform(rgba.begin(), rgba.end(), texture.image.data.begin(),
                   [](int value) { return static_cast<std::uint8_t>(value); });
    texture.magnification = texture.minification = Texture::Filter::nearest;
    texture.mipmaps = Texture::Mipmaps::none;
    return texture;
}

/// What is seen straight ahead in parallel rays, of x and y −1 … 1.
glm::mat4 straightAhead() {
    return orthographic(-1, 1, -1, 1, -10, 10);
}

std::vector<std::uint32_t> allOf(const Scene& scene) {
    std::vector<std::uint32_t> all(scene.instances.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

/// A copy of the shaders, for edits; assets come from it while this lives.
class EditedShaders {
  public:
    EditedShaders() {
        std::filesystem::copy(assetRoot() / "shaders", folder_ / "shaders",
                              std::filesystem::copy_options::recursive);
        setenv("QUINCUNX_ROOT", folder_.path().c_str(), 1);
    }
    ~EditedShaders() { unsetenv("QUINCUNX_ROOT"); }
    EditedShaders(const EditedShaders&) = delete;
    EditedShaders& operator=(const EditedShaders&) = delete;

    /// Replaces the first `from`, which must be there.
    void replace(const std::string& file, const std::string& from, const std::string& to) {
        const auto path = folder_ / "shaders" / file;
        std::ifstream in(path);
        std::string text((std::istreambuf_iterator<char>(in)), {});
        in.close();
        const std::size_t place = text.find(from);
        ASSERT_NE(place, std::string::npos) << file << " no longer holds: " << from;
        std::ofstream(path) << text.replace(place, from.size(), to);
    }
    void add(const std::string& file, const std::string& text) { folder_.file("shaders/" + file, text); }

  private:
    test::TemporaryFolder folder_;
};

double largestDifference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        largest =
            std::max(largest, std::abs(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i])));
    return largest;
}

double sumOf(const Image& image) {
    return std::accumulate(image.data.begin(), image.data.end(), 0.0);
}

vec4 at(const Image& image, int x, int y) {
    const float* p = image.pixel(x, y);
    return {p[0], p[1], p[2], p[3]};
}

/// Draws pictures on a back end.
class Easel {
  public:
    static constexpr int size = 64;

    explicit Easel(gl::Backend backend) : context_(gl::createOffscreenContext(backend)) {}

    /// All instances of the scene over black, in linear light.
    Image drawn(const Scene& scene, const glm::mat4& clipFromWorld, vec3 eye,
                const MaterialParams& params = {}) {
        MaterialPass pass(scene);
        return drawnBy(pass, scene, clipFromWorld, eye, params);
    }

    Image drawnBy(MaterialPass& pass, const Scene& scene, const glm::mat4& clipFromWorld, vec3 eye,
                  const MaterialParams& params = {}) {
        const std::vector<std::uint32_t> all = allOf(scene);
        return drawnBy(pass, scene,
                       {.frame = makeFrameBlock(scene, scene.lights, clipFromWorld, eye), .visible = all},
                       params);
    }

    Image drawnBy(MaterialPass& pass, const Scene& scene, const MaterialView& view,
                  const MaterialParams& params = {}) {
        graph::FrameGraph graph;
        const PictureTargets targets = addPictureTargets(graph, {graph::Format::rgba32f, size, size, 1});
        graph.addPass({"draw", {}, {targets.color, targets.depth}, [&](graph::PassContext& context) {
                           glClearColor(0, 0, 0, 0);
                           glClearDepth(1);
                           glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
                           pass.draw(context, scene, view, params);
                       }});
        addResolvePass(graph, targets);
        graph.addOutput(targets.picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(targets.picture));
    }

    /// One square that fills the picture when seen straight ahead.
    static Scene squareScene() {
        Scene scene;
        scene.meshes.push_back(makeSquare());
        scene.materials.emplace_back();
        scene.instances.push_back({"square", 0, 0, glm::mat4(1)});
        scene.ambientLight = vec3(1);
        return scene;
    }
    Image seenStraight(const Scene& scene, const MaterialParams& params = {}) {
        return drawn(scene, straightAhead(), {0, 0, 5}, params);
    }

  protected:
    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
};

class Materials : public testing::TestWithParam<gl::Backend>, protected Easel {
  protected:
    Materials() : Easel(GetParam()) {}
};

/// Mutations, on one back end.
class BrokenMaterials : public Materials {};

TEST_P(Materials, ASquareUnderAmbientLightHasItsBaseColour) {
    Scene scene = squareScene();
    scene.ambientLight = {1, 0.5f, 2};
    scene.materials[0].baseColor = {0.25f, 0.5f, 0.75f, 0.1f};
    const Image picture = seenStraight(scene);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            ASSERT_EQ(at(picture, x, y), vec4(0.25f, 0.25f, 1.5f, 1)) << x << ", " << y;
}

// ---- light
// ---------------------------------------------------------------------------------------------------

/// glTF 2.0, appendix B, in double: what a surface of one channel sends to the eye of the lights of a scene.
double appendixB(double base, double metallic, double roughness, const dvec3& n, const dvec3& wi,
                 const dvec3& wo) {
    const double cosLight = glm::dot(n, wi);
    const double cosEye = glm::dot(n, wo);
    if (cosLight <= 0)
        return 0;
    const dvec3 h = glm::normalize(wi + wo);
    const double cosHalf = glm::dot(n, h);
    const double a2 = std::pow(roughness, 4);
    const double d = a2 / std::pow(cosHalf * cosHalf * (a2 - 1) + 1, 2);  // times π
    const double v = 0.5 / (cosLight * std::sqrt(cosEye * cosEye * (1 - a2) + a2) +
                            cosEye * std::sqrt(cosLight * cosLight * (1 - a2) + a2));
    const double f0 = 0.04 + (base - 0.04) * metallic;
    const double f = f0 + (1 - f0) * std::pow(1 - glm::dot(wo, h), 5);
    return ((1 - f) * base * (1 - metallic) + f * d * v) * cosLight;
}

/// Nine balls, metallic along y and rough along x, under a sun and a lamp of limited range.
class BallsOfAllKinds {
  public:
    static constexpr double radius = 0.9;

    BallsOfAllKinds() {
        scene.meshes.push_back(tessellate(Sphere{radius}, 256));
        for (int row = -1; row <= 1; ++row)
            for (int column = -1; column <= 1; ++column) {
                Material material;
                material.baseColor = {0.8f, 0.4f, 0.1f, 1};
                material.metallic = 0.5f * static_cast<float>(row + 1);
                material.roughness = 0.6f + 0.35f * static_cast<float>(column);
                glm::mat4 worldFromModel(1);
                worldFromModel[3] = {2 * column, 2 * row, 0, 1};
                scene.instances.push_back({"ball", 0, scene.materials.size(), worldFromModel});
                scene.materials.push_back(material);
            }
        scene.ambientLight = {0.05f, 0.1f, 0.2f};
        Light sun;
        sun.direction = glm::normalize(vec3(-1, -1, -1));
        sun.color = {1, 0.9f, 0.8f};
        sun.intensity = 2;
        Light lamp;
        lamp.kind = Light::Kind::point;
        lamp.position = {-3, 2, 3};
        lamp.intensity = 20;
        lamp.range = 6;
        scene.lights = {sun, lamp};
        eye = {0, 0, 9};
        clipFromWorld = perspective(0.75f, 1, 1, 20) * cameraFromWorld(lookAt(eye, {0, 0, 0}, {0, 1, 0}));
    }

    /// Against the closed form over all pixels well inside a ball, relative to the mean of those.
    double relativeRmse(const Image& picture) const {
        double squares = 0;
        double sum = 0;
        int count = 0;
        const double scale = std::tan(0.375);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const dvec3 direction =
                    glm::normalize(dvec3(scale * (2 * (x + 0.5) / picture.width - 1),
                                         scale * (1 - 2 * (y + 0.5) / picture.height), -1));
                for (const Instance& instance : scene.instances) {
                    const dvec3 centre(instance.worldFromModel[3]);
                    const dvec3 towards = centre - dvec3(eye);
                    const double along = glm::dot(towards, direction);
                    const double miss2 = glm::dot(towards, towards) - along * along;
                    if (miss2 > 0.95 * 0.95 * radius * radius)
                        continue;
                    const dvec3 position =
                        dvec3(eye) + direction * (along - std::sqrt(radius * radius - miss2));
                    for (int channel = 0; channel < 3; ++channel) {
                        const double expected = sent(scene.materials[instance.material], position,
                                                     (position - centre) / radius, channel);
                        squares += std::pow(picture.pixel(x, y)[channel] - expected, 2);
                        sum += expected;
                        ++count;
                    }
                }
            }
        EXPECT_GT(count, 3000);
        return std::sqrt(squares / count) / (sum / count);
    }

    Scene scene;
    vec3 eye{0};
    glm::mat4 clipFromWorld{1};

  private:
    double sent(const Material& material, const dvec3& position, const dvec3& n, int channel) const {
        const double base = material.baseColor[channel];
        const dvec3 wo = glm::normalize(dvec3(eye) - position);
        double radiance = scene.ambientLight[channel] * base;
        for (const Light& light : scene.lights) {
            dvec3 wi = -dvec3(light.direction);
            double strength = light.color[channel] * light.intensity;
            if (light.kind == Light::Kind::point) {
                const dvec3 towards = dvec3(light.position) - position;
                const double distance = glm::length(towards);
                wi = towards / distance;
                strength *= std::max(1 - std::pow(distance / light.range, 4), 0.0) / (distance * distance);
            }
            radiance += strength * appendixB(base, material.metallic, material.roughness, n, wi, wo);
        }
        return radiance;
    }
};

// Measured at 256 segments: 0.0025 of the mean. It is what the facets leave, whose normals are off most where
// the sharpest highlight (α = 0.0625) is steepest: it falls with the square of their size.
constexpr double ballsBound = 4e-3;

TEST_P(Materials, BallsOfAllKindsAgreeWithTheClosedFormAtEachPixel) {
    BallsOfAllKinds balls;
    const double rmse = balls.relativeRmse(drawn(balls.scene, balls.clipFromWorld, balls.eye));
    EXPECT_LE(rmse, ballsBound);
    balls.scene.meshes[0] = tessellate(Sphere{BallsOfAllKinds::radius}, 64);
    EXPECT_GT(balls.relativeRmse(drawn(balls.scene, balls.clipFromWorld, balls.eye)), 4 * rmse);
    RecordProperty("rmse", std::to_string(rmse));
}

TEST_P(BrokenMaterials, BrokenReflectionIsNoticed) {
    struct Break {
        const char* file;
        const char* from;
        const char* to;
    };
    const BallsOfAllKinds balls;
    for (const Break& broken :
         {Break{"lib/brdf.glsl", "max(r * r, leastAlpha)", "max(r, leastAlpha)"},
          Break{"lib/brdf.glsl", "0.04f * (1.0f - m)", "0.08f * (1.0f - m)"},
          Break{"lib/brdf.glsl", "masking + v", "masking + 0.9f * v"},
          Break{"lib/brdf.glsl", "(vec3(1.0f) - fresnel) * surface.diffuse", "surface.diffuse"},
          Break{"lib/material.glsl", "if (light.reach.x > 0.0)", "if (false)"},
          Break{"lib/material.glsl", "ambientLight.rgb * color.rgb", "ambientLight.rgb * surface.diffuse"}}) {
        EditedShaders edited;
        edited.replace(broken.file, broken.from, broken.to);
        executor_ = gl::Executor();
        EXPECT_GT(balls.relativeRmse(drawn(balls.scene, balls.clipFromWorld, balls.eye)), 4 * ballsBound)
            << broken.to;
    }
}

TEST_P(Materials, HardSurfacesAreFiniteAndAtMostTheLargestHalf) {
    BallsOfAllKinds balls;
    Random random(1);
    for (Material& material : balls.scene.materials) {
        material.roughness = random.below(2) == 0 ? 0.0f : 1.0f;
        material.metallic = random.below(2) == 0 ? 0.0f : 1.0f;
    }
    // At the eye, the highlight of a mirror is in the middle of the ball.
    balls.scene.lights[0].direction = {0, 0, -1};
    balls.scene.lights[0].intensity = 1e6f;
    balls.scene.lights[1].position = {0, 0, static_cast<float>(BallsOfAllKinds::radius)};
    const Image picture = drawn(balls.scene, balls.clipFromWorld, balls.eye);
    float largest = 0;
    for (const float value : picture.data) {
        ASSERT_TRUE(std::isfinite(value) && value >= 0);
        largest = std::max(largest, value);
    }
    EXPECT_EQ(largest, 65504);
}

// ---- textures
// ------------------------------------------------------------------------------------------------

/// Red, green, blue, white: rows from the top.
const std::vector<int> fourColours = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};

Scene texturedScene(Scene scene, Texture texture, const TextureUse& use) {
    scene.textures.push_back(std::move(texture));
    scene.materials[0].baseColorTexture = use;
    return scene;
}

/// The colours in the middle of the picture's quarters: top left, top right, bottom left, bottom right.
std::array<vec4, 4> quarters(const Image& picture) {
    const int low = picture.width / 4;
    const int high = 3 * picture.width / 4;
    return {at(picture, low, low), at(picture, high, low), at(picture, low, high), at(picture, high, high)};
}
const vec4 red(1, 0, 0, 1);
const vec4 green(0, 1, 0, 1);
const vec4 blue(0, 0, 1, 1);
const vec4 white(1);

TEST_P(Materials, TexturesLieWithTheirTopAtTheTop) {
    const Scene scene = texturedScene(squareScene(), makePixels(2, 2, Encoding::linear, fourColours), {0});
    EXPECT_THAT(quarters(seenStraight(scene)), testing::ElementsAre(red, green, blue, white));
}

TEST_P(Materials, TransformsAndSecondCoordinatesMoveTextures) {
    TextureUse half(0);
    half.textureFromTexcoord[2] = {0.5f, 0, 1};  // s + ½
    const Texture pixels = makePixels(2, 2, Encoding::linear, fourColours);
    EXPECT_THAT(quarters(seenStraight(texturedScene(squareScene(), pixels, half))),
                testing::ElementsAre(green, red, white, blue));
    TextureUse turned(0);
    turned.textureFromTexcoord = glm::mat3(glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1));
    EXPECT_THAT(quarters(seenStraight(texturedScene(squareScene(), pixels, turned))),
                testing::ElementsAre(red, blue, green, white));

    Scene second = squareScene();
    for (const vec2& st : second.meshes[0].texcoords)
        second.meshes[0].texcoords1.emplace_back(st.x, 1 - st.y);
    TextureUse upsideDown(0);
    upsideDown.texcoordSet = 1;
    EXPECT_THAT(quarters(seenStraight(texturedScene(second, pixels, upsideDown))),
                testing::ElementsAre(blue, white, red, green));
    upsideDown.textureFromTexcoord[2] = {0.5f, 0, 1};
    EXPECT_THAT(quarters(seenStraight(texturedScene(second, pixels, upsideDown))),
                testing::ElementsAre(white, blue, green, red));

    EditedShaders edited;
    edited.replace("lib/material.glsl", "st = texcoord1;", "st = texcoord;");
    executor_ = gl::Executor();
    EXPECT_THAT(quarters(seenStraight(texturedScene(second, pixels, upsideDown))),
                testing::ElementsAre(green, red, white, blue));
}

TEST_P(Materials, EachTextureHasCoordinatesOfItsOwn) {
    Scene scene = squareScene();
    for (const vec2& st : scene.meshes[0].texcoords)
        scene.meshes[0].texcoords1.emplace_back(1 - st.x, st.y);
    scene.textures.push_back(makePixels(2, 1, Encoding::linear, {255, 0, 0, 255, 0, 0, 0, 255}));
    scene.textures.push_back(makePixels(2, 1, Encoding::linear, {0, 255, 0, 255, 0, 0, 0, 255}));
    scene.materials[0].baseColorTexture = TextureUse(0);
    scene.materials[0].emission = vec3(1);
    scene.materials[0].emissionTexture = TextureUse(1);
    scene.materials[0].emissionTexture->texcoordSet = 1;
    EXPECT_THAT(quarters(seenStraight(scene)), testing::ElementsAre(red, green, red, green));
}

TEST_P(Materials, TexturesAreRepeatedMirroredAndClamped) {
    TextureUse far(0);
    far.textureFromTexcoord = glm::mat3(2, 0, 0, 0, 1, 0, 0, 0, 1);  // s from 0 to 2
    Texture pixels = makePixels(2, 2, Encoding::linear, fourColours);
    const auto topRow = [&](Texture::Wrap wrap) {
        pixels.wrapS = wrap;
        const Image picture = seenStraight(texturedScene(squareScene(), pixels, far));
        std::array<vec4, 4> row;
        for (int i = 0; i < 4; ++i)
            row[static_cast<std::size_t>(i)] = at(picture, size / 8 + i * size / 4, size / 4);
        return row;
    };
    EXPECT_THAT(topRow(Texture::Wrap::repeat), testing::ElementsAre(red, green, red, green));
    EXPECT_THAT(topRow(Texture::Wrap::mirroredRepeat), testing::ElementsAre(red, green, green, red));
    EXPECT_THAT(topRow(Texture::Wrap::clampToEdge), testing::ElementsAre(red, green, green, green));
}

TEST_P(Materials, FiltersAreThoseOfTheTexture) {
    Texture pixels = makePixels(2, 1, Encoding::linear, {255, 255, 255, 255, 0, 0, 0, 255});
    pixels.wrapS = Texture::Wrap::clampToEdge;
    const auto middle = [&] {
        const Image picture = seenStraight(texturedScene(squareScene(), pixels, {0}));
        return at(picture, size / 2 - 8, size / 2).x;
    };
    EXPECT_EQ(middle(), 1);
    pixels.magnification = Texture::Filter::linear;
    // 7.5 of 64 pixels before the middle of the edge between two texels that are 32 apart. The driver blends
    // in 1/128 steps.
    EXPECT_NEAR(middle(), 0.5 + 7.5 / 32, 1 / 128.0);

    // 128 × 128 texels in turn on 64 × 64 pixels: level 1 is grey.
    std::vector<int> stripes;
    for (int i = 0; i < 128 * 128; ++i)
        for (int channel = 0; channel < 4; ++channel)
            stripes.push_back(i % 2 == 0 || channel == 3 ? 255 : 0);
    Texture fine = makePixels(128, 128, Encoding::linear, stripes);
    const auto value = [&] { return at(seenStraight(texturedScene(squareScene(), fine, {0})), 20, 20).x; };
    EXPECT_TRUE(value() == 0 || value() == 1);
    fine.mipmaps = Texture::Mipmaps::nearest;
    EXPECT_NEAR(value(), 0.5, 0.01);
    fine.mipmaps = Texture::Mipmaps::linear;
    fine.minification = Texture::Filter::linear;
    EXPECT_NEAR(value(), 0.5, 0.01);
}

TEST_P(Materials, ColoursAreDecodedAndNumbersAreNot) {
    Texture grey = makePixels(1, 1, Encoding::srgb, {128, 128, 128, 128});
    EXPECT_NEAR(at(seenStraight(texturedScene(squareScene(), grey, {0})), 9, 9).x, 0.21586, 1e-3);
    grey.image.encoding = Encoding::linear;
    EXPECT_NEAR(at(seenStraight(texturedScene(squareScene(), grey, {0})), 9, 9).x, 128 / 255.0, 1e-6);
}

TEST_P(Materials, EachTextureDoesItsPart) {
    Scene scene = squareScene();
    scene.ambientLight = {0.5f, 0.5f, 0.5f};
    Light light;
    light.direction = {0, 0, -1};
    scene.lights = {light};
    // Occlusion 51/255, roughness 102/255 of the factor, metallic 204/255 of the factor.
    scene.textures.push_back(makePixels(1, 1, Encoding::linear, {51, 102, 204, 255}));
    scene.textures.push_back(makePixels(1, 1, Encoding::linear, {153, 255, 0, 255}));
    Material& material = scene.materials[0];
    material.baseColor = {0.5f, 0.5f, 0.5f, 1};
    material.metallic = 0.5f;
    material.roughness = 1;
    material.metallicRoughnessTexture = TextureUse(0);
    material.occlusionTexture = TextureUse(0);
    material.occlusionStrength = 0.5f;
    material.emission = {0.25f, 0.25f, 0.25f};
    material.emissionTexture = TextureUse(1);
    const vec3 eye(0, 0, 1e6f);
    const vec4 seen = at(drawn(scene, straightAhead(), eye), size / 2, size / 2);
    const dvec3 ahead(0, 0, 1);
    const double reflected = appendixB(0.5, 0.4, 0.4, ahead, ahead, ahead);
    const double around = 0.5 * 0.5 * (1 + 0.5 * (0.2 - 1));
    EXPECT_NEAR(seen.x, reflected + around + 0.25 * 0.6, 1e-5);
    EXPECT_NEAR(seen.y, reflected + around + 0.25, 1e-5);
    EXPECT_NEAR(seen.z, reflected + around, 1e-5);
}

TEST_P(Materials, VertexColoursMultiply) {
    Scene scene = squareScene();
    scene.materials[0].baseColor = {1, 0.5f, 1, 1};
    scene.meshes[0].colors.assign(4, {0.5f, 0.5f, 0.25f, 1});
    const vec4 seen = at(seenStraight(scene), 30, 30);
    EXPECT_NEAR(seen.x, 0.5, 1e-6);
    EXPECT_NEAR(seen.y, 0.25, 1e-6);
    EXPECT_NEAR(seen.z, 0.25, 1e-6);
}

// ---- normal maps
// ---------------------------------------------------------------------------------------------

/// 4 × 4 cells: of a normal map, or, the same, of a mesh whose vertices have these normals.
struct Bumps {
    Scene mapped;
    Scene meshed;

    explicit Bumps(const glm::mat4& worldFromModel) {
        for (Scene* scene : {&mapped, &meshed}) {
            scene->materials.emplace_back();
            scene->materials[0].roughness = 0.4f;
            scene->instances.push_back({"square", 0, 0, worldFromModel});
            scene->ambientLight = vec3(0);
            Light light;
            light.direction = glm::normalize(vec3(-1, -2, -4));
            scene->lights = {light};
        }
        mapped.meshes.push_back(makeSquare());
        meshed.meshes.emplace_back();
        Mesh& mesh = meshed.meshes[0];
        Random random(3);
        std::vector<int> texels;
        for (int cell = 0; cell < 16; ++cell) {
            const int x = static_cast<int>(random.below(200)) + 28;
            const int y = static_cast<int>(random.below(200)) + 28;
            texels.insert(texels.end(), {x, y, 255, 255});
            const vec3 normal = glm::normalize(
                vec3(static_cast<float>(x) / 127.5f - 1, static_cast<float>(y) / 127.5f - 1, 1));
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            for (const vec2 corner : {vec2(0, 0), vec2(0, 1), vec2(1, 1), vec2(1, 0)}) {
                const vec2 st = 0.25f * (vec2(cell % 4, cell / 4) + corner);
                mesh.positions.emplace_back(2 * st.x - 1, 1 - 2 * st.y, 0);
                mesh.normals.push_back(normal);
            }
            for (const std::uint32_t v : {0u, 1u, 2u, 0u, 2u, 3u})
                mesh.indices.push_back(first + v);
        }
        mapped.textures.push_back(makePixels(4, 4, Encoding::linear, texels));
        mapped.materials[0].normalTexture = TextureUse(0);
    }
};

// Measured: 5e-7. Normals of the two pictures differ by some roundings, 2^-24 each, which the highlight (α =
// 0.16) makes up to 2/α times as large.
TEST_P(Materials, ANormalMapLooksLikeTheSurfaceItImitates) {
    glm::mat4 turned(0);
    turned[0] = {0, 1, 0, 0};
    turned[1] = {-1, 0, 0, 0};
    turned[2] = {0, 0, 1, 0};
    turned[3] = {0, 0, 0, 1};
    glm::mat4 mirrored(1);
    mirrored[0].x = -1;
    for (const glm::mat4& placement : {glm::mat4(1), turned, mirrored}) {
        const Bumps bumps(placement);
        const Image map = seenStraight(bumps.mapped);
        const Image mesh = seenStraight(bumps.meshed);
        EXPECT_GT(sumOf(map), 64 * 64);
        EXPECT_LE(largestDifference(map, mesh), 1e-5);
    }
}

TEST_P(BrokenMaterials, BrokenNormalMapsAreNoticed) {
    glm::mat4 mirrored(1);
    mirrored[0].x = -1;
    const Bumps bumps(mirrored);
    const Image mesh = seenStraight(bumps.meshed);
    struct Break {
        const char* file;
        const char* from;
        const char* to;
    };
    for (const Break& broken :
         {Break{"lib/material.glsl", "cross(n, tangentWorld.xyz)", "cross(tangentWorld.xyz, n)"},
          Break{"passes/material.vert", "? -1.0 : 1.0", "? 1.0 : 1.0"},
          Break{"lib/material.glsl", "* 2.0 - 1.0", "* 1.5 - 0.5"}}) {
        EditedShaders edited;
        edited.replace(broken.file, broken.from, broken.to);
        executor_ = gl::Executor();
        EXPECT_GT(largestDifference(seenStraight(bumps.mapped), mesh), 1e-2) << broken.to;
    }
}

// Moving, turning or mirroring a map by its transform or by the mesh's own coordinates is the same.
TEST_P(Materials, TangentsFollowTheTransformOfTheMap) {
    for (const glm::mat3& transform :
         {glm::mat3(0, 1, 0, 1, 0, 0, 0.25f, 0, 1), glm::mat3(0, -1, 0, 1, 0, 0, 0, 1, 1),
          glm::mat3(-1, 0, 0, 0, 1, 0, 1, 0, 1)}) {
        Bumps transformed(glm::mat4(1));
        Bumps placed(glm::mat4(1));
        transformed.mapped.materials[0].normalTexture->textureFromTexcoord = transform;
        for (vec2& st : placed.mapped.meshes[0].texcoords)
            st = vec2(transform * vec3(st, 1));
        EXPECT_LE(largestDifference(seenStraight(transformed.mapped), seenStraight(placed.mapped)), 1e-5);
    }
}

TEST_P(Materials, TheScaleFlattensANormalMap) {
    Bumps bumps(glm::mat4(1));
    bumps.mapped.materials[0].normalScale = 0;
    Scene flat = bumps.mapped;
    flat.materials[0].normalTexture.reset();
    EXPECT_LE(largestDifference(seenStraight(bumps.mapped), seenStraight(flat)), 1e-6);
}

// ---- alpha
// ---------------------------------------------------------------------------------------------------

TEST_P(Materials, AMaskCutsOutJustWhatIsBelowTheCutoff) {
    Scene scene = texturedScene(
        squareScene(),
        makePixels(2, 2, Encoding::linear,
                   {255, 255, 255, 0, 255, 255, 255, 100, 255, 255, 255, 150, 255, 255, 255, 255}),
        {0});
    const auto covered = [&](float cutoff, float factor) {
        scene.materials[0].alphaMode = Material::AlphaMode::mask;
        scene.materials[0].alphaCutoff = cutoff;
        scene.materials[0].baseColor.a = factor;
        const Image picture = seenStraight(scene, {.background = false});
        int count = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                count += picture.pixel(x, y)[3] == 1 ? 1 : 0;
        return count * 4 / (size * size);
    };
    EXPECT_EQ(covered(0, 1), 4);
    EXPECT_EQ(covered(0.2f, 1), 3);
    EXPECT_EQ(covered(0.5f, 1), 2);
    EXPECT_EQ(covered(0.5f, 0.8f), 1);
    EXPECT_EQ(covered(1, 1), 1);
    EXPECT_EQ(covered(1.01f, 1), 0);
}

TEST_P(Materials, BlendedOnesLieOverTheOthersInTheOrderGiven) {
    Scene scene = squareScene();
    scene.materials.resize(3);
    const std::array<vec4, 3> colours = {vec4(1, 0, 0, 1), vec4(0, 1, 0, 0.5f), vec4(0, 0, 1, 0.25f)};
    scene.instances.clear();
    for (std::size_t i = 0; i < 3; ++i) {
        scene.materials[i].baseColor = colours[i];
        scene.materials[i].alphaMode = i == 0 ? Material::AlphaMode::opaque : Material::AlphaMode::blend;
        glm::mat4 placement(1);
        placement[3].z = static_cast<float>(i);
        scene.instances.push_back({"pane", 0, i, placement});
    }
    MaterialPass pass(scene);
    const auto seen = [&](const std::vector<std::uint32_t>& order) {
        return at(drawnBy(pass, scene,
                          {.frame = makeFrameBlock(scene, scene.lights, straightAhead(), {0, 0, 5}),
                           .visible = order}),
                  5, 5);
    };
    EXPECT_EQ(seen({1, 2, 0}), vec4(0.375f, 0.375f, 0.25f, 1));
    EXPECT_EQ(seen({0, 2, 1}), vec4(0.375f, 0.5f, 0.125f, 1));
    EXPECT_EQ(seen({2, 0}), vec4(0.75f, 0, 0.25f, 1));
    // Alpha modes may change from frame to frame.
    scene.materials[2].alphaMode = Material::AlphaMode::opaque;
    EXPECT_EQ(seen({0, 1, 2}), vec4(0, 0, 1, 1));
    // What lies behind something opaque is not seen, and hides nothing.
    scene.instances[1].worldFromModel[3].z = -1;
    EXPECT_EQ(seen({2, 1, 0}), vec4(0, 0, 1, 1));
}

TEST_P(Materials, OfABlendedBallTheFarSideComesFirst) {
    Scene scene;
    scene.meshes.push_back(tessellate(Sphere{0.5}, 24));
    scene.materials.emplace_back();
    scene.materials[0].alphaMode = Material::AlphaMode::blend;
    scene.materials[0].baseColor = {1, 1, 1, 0.5f};
    scene.materials[0].doubleSided = true;
    scene.ambientLight = vec3(1);
    scene.instances.push_back({"ball", 0, 0, glm::mat4(1)});
    MaterialPass pass(scene);
    EXPECT_FLOAT_EQ(at(drawnBy(pass, scene, straightAhead(), {0, 0, 5}), size / 2, size / 2).x, 0.75f);
    EXPECT_EQ(pass.counts().drawCalls, 2u);
    EXPECT_EQ(pass.counts().instances, 1u);
    scene.materials[0].doubleSided = false;
    EXPECT_FLOAT_EQ(at(drawnBy(pass, scene, straightAhead(), {0, 0, 5}), size / 2, size / 2).x, 0.5f);
}

TEST_P(Materials, BacksAreSeenAndLitOnlyWhereTheyAreASide) {
    Scene scene = squareScene();
    scene.ambientLight = vec3(0);
    Light light;
    light.direction = {0, 0, -1};
    scene.lights = {light};
    const double front = sumOf(seenStraight(scene, {.background = false}));
    scene.instances[0].worldFromModel = glm::mat4(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1);
    EXPECT_EQ(sumOf(seenStraight(scene, {.background = false})), 0);
    scene.materials[0].doubleSided = true;
    EXPECT_NEAR(sumOf(seenStraight(scene, {.background = false})), front, 1e-4 * front);
    // A mirror image shows its front.
    scene.materials[0].doubleSided = false;
    scene.instances[0].worldFromModel = glm::mat4(1);
    scene.instances[0].worldFromModel[0].x = -1;
    EXPECT_NEAR(sumOf(seenStraight(scene, {.background = false})), front, 1e-4 * front);
}

// ---- only what a material uses
// --------------------------------------------------------------------------------

/// Materials of three kinds on three balls: plain, textured and bent by a normal map, cut out.
Scene threeKinds() {
    Scene scene;
    scene.meshes.push_back(tessellate(Sphere{0.45}, 48));
    Random random(9);
    std::vector<int> texels;
    for (int i = 0; i < 16 * 16 * 4; ++i)
        texels.push_back(static_cast<int>(random.below(256)));
    scene.textures.push_back(makePixels(16, 16, Encoding::srgb, texels));
    scene.textures[0].magnification = scene.textures[0].minification = Texture::Filter::linear;
    scene.textures[0].mipmaps = Texture::Mipmaps::linear;
    scene.textures.push_back(scene.textures[0]);
    scene.textures[1].image.encoding = Encoding::linear;
    scene.materials.resize(3);
    scene.materials[0].baseColor = {0.7f, 0.3f, 0.2f, 1};
    scene.materials[0].metallic = 0.3f;
    scene.materials[1].baseColorTexture = TextureUse(0);
    scene.materials[1].normalTexture = TextureUse(1);
    scene.materials[1].metallic = 0.7f;
    scene.materials[2].baseColorTexture = TextureUse(0);
    scene.materials[2].alphaMode = Material::AlphaMode::mask;
    for (std::size_t i = 0; i < 3; ++i) {
        glm::mat4 placement(1);
        placement[3] = {0.5f * static_cast<float>(i) - 0.5f, 0.4f * static_cast<float>(i % 2) - 0.2f, 0, 1};
        scene.instances.push_back({"ball", 0, i, placement});
    }
    Light sun;
    sun.direction = glm::normalize(vec3(-1, -1, -2));
    Light spot;
    spot.kind = Light::Kind::spot;
    spot.position = {1, 1, 2};
    spot.direction = glm::normalize(vec3(-1, -1, -2));
    spot.outerConeRadians = 0.6f;
    spot.intensity = 8;
    spot.range = 4;
    scene.lights = {sun, spot};
    return scene;
}

const char* const hookedFragment = R"(#version 330 core

uniform float forTest;
#define LIT_SHARE(light, position, n) (forTest == 0.0 ? 1.0 : 0.5)
#define ENVIRONMENT_IRRADIANCE(position, n) vec3(0.25)
#define ENVIRONMENT_RADIANCE(position, r, roughness) vec3(r.z, 0.5, 0.5 * roughness)
#define ENVIRONMENT_BRDF(cosEye, roughness) vec2(1.0 - 0.5 * cosEye, 0.0)

#include "lib/material.glsl"

invariant out vec4 color;

void main() {
    color = materialColor();
}
)";

TEST_P(Materials, AFeatureThatIsForcedOnChangesNoBitWhereItIsNotUsed) {
    const Scene scene = threeKinds();
    MaterialPass pass(scene);
    const glm::mat4 clip =
        perspective(0.5f, 1, 1, 9) * cameraFromWorld(lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    const Image planned = drawnBy(pass, scene, clip, {0, 0, 4});
    EXPECT_GT(sumOf(planned), 64 * 64);
    for (std::uint32_t i = 0; i <= materialFeatureCount; ++i) {
        MaterialParams params;
        params.forced = i == materialFeatureCount ? MaterialFeatures::all()
                                                  : MaterialFeatures{}.with(static_cast<MaterialFeature>(i));
        EXPECT_EQ(drawnBy(pass, scene, clip, {0, 0, 4}, params), planned) << describe(params.forced);
    }
}

TEST(MaterialBackends, DrawTheSameBits) {
    const Scene scene = threeKinds();
    const glm::mat4 clip =
        perspective(0.5f, 1, 1, 9) * cameraFromWorld(lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    EXPECT_EQ(Easel(gl::Backend::osmesa).drawn(scene, clip, {0, 0, 4}),
              Easel(gl::Backend::egl).drawn(scene, clip, {0, 0, 4}));
}

TEST_P(Materials, ShadowsAndSurroundingsThatAreForcedOnChangeNoBit) {
    EditedShaders edited;
    edited.add("passes/hooked.frag", hookedFragment);
    Scene scene = threeKinds();
    scene.materials[1].metallic = 0.2f;  // nothing mirrors
    MaterialPass pass(scene);
    const glm::mat4 clip =
        perspective(0.5f, 1, 1, 9) * cameraFromWorld(lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    const Image planned = drawnBy(pass, scene, clip, {0, 0, 4});
    MaterialParams params;
    params.fragment = params.environmentFragment = "passes/hooked.frag";
    params.forced = MaterialFeatures{}.with(MaterialFeature::environment);
    EXPECT_EQ(drawnBy(pass, scene, clip, {0, 0, 4}, params), planned);
    params.forced = MaterialFeatures::all();
    EXPECT_EQ(drawnBy(pass, scene, clip, {0, 0, 4}, params), planned);
}

TEST_P(BrokenMaterials, ForcedFeaturesThatLeakAreNoticed) {
    const Scene scene = threeKinds();
    const glm::mat4 clip =
        perspective(0.5f, 1, 1, 9) * cameraFromWorld(lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    const Image planned = drawn(scene, clip, {0, 0, 4});
    EditedShaders edited;
    edited.replace("lib/material.glsl", "#ifdef FORCED_FEATURES", "#ifdef NEVER");
    executor_ = gl::Executor();
    MaterialParams params;
    params.forced = MaterialFeatures{}.with(MaterialFeature::vertexColors);
    EXPECT_NE(drawn(scene, clip, {0, 0, 4}, params), planned);
}

TEST_P(Materials, SurroundingsTakeThePlaceOfAmbientLightOnWhatMirrors) {
    EditedShaders edited;
    edited.add("passes/hooked.frag", hookedFragment);
    Scene scene = squareScene();
    scene.materials[0].baseColor = {0.5f, 0.5f, 0.5f, 1};
    scene.materials[0].metallic = 0.5f;
    scene.materials[0].roughness = 0.25f;
    MaterialParams params;
    params.environmentFragment = "passes/hooked.frag";
    const vec4 seen = at(drawn(scene, straightAhead(), {0, 0, 1e6f}, params), size / 2, size / 2);
    // f0 = 0.27, of which half is mirrored straight ahead; the rest of 1 falls on the diffuse 0.25.
    const double matt = (1 - 0.135) * 0.25 * 0.25;
    EXPECT_NEAR(seen.x, matt + 0.135, 1e-5);
    EXPECT_NEAR(seen.y, matt + 0.135 * 0.5, 1e-5);
    EXPECT_NEAR(seen.z, matt + 0.135 * 0.125, 1e-5);
    scene.materials[0].metallic = 0.4f;
    scene.materials[0].roughness = 0.5f;
    EXPECT_EQ(at(drawn(scene, straightAhead(), {0, 0, 1e6f}, params), size / 2, size / 2),
              vec4(0.5f, 0.5f, 0.5f, 1));
}

TEST(MaterialFeatures, AreThoseThatChangeAPixel) {
    const Mesh plain = makeSquare();
    Mesh rich = plain;
    rich.colors.assign(4, vec4(1));
    rich.texcoords1 = rich.texcoords;
    Material material;
    EXPECT_EQ(featuresOf(material, plain), MaterialFeatures{});
    EXPECT_EQ(describe(featuresOf(material, plain)), "no features");
    EXPECT_EQ(featuresOf(material, rich), MaterialFeatures{}.with(MaterialFeature::vertexColors));
    material.emissionTexture = TextureUse(0);
    material.occlusionTexture = TextureUse(0);
    material.occlusionStrength = 0;
    EXPECT_EQ(featuresOf(material, plain), MaterialFeatures{});
    material.emission = vec3(1);
    material.occlusionStrength = 1;
    material.occlusionTexture->texcoordSet = 1;
    EXPECT_EQ(describe(featuresOf(material, plain)), "occlusion texture, emission texture");
    EXPECT_EQ(describe(featuresOf(material, rich)),
              "occlusion texture, emission texture, vertex colours, second texture coordinates");
    EXPECT_EQ(describe(MaterialFeatures::all()).find("environment") != std::string::npos, true);
}

TEST_P(Materials, PlainMaterialsShareOneProgram) {
    BallsOfAllKinds balls;
    MaterialParams params;
    params.background = false;
    MaterialPass pass(balls.scene);
    drawnBy(pass, balls.scene, balls.clipFromWorld, balls.eye, params);
    EXPECT_EQ(executor_.programs().size(), 1u);
    EXPECT_EQ(pass.counts().programs, 1u);
    EXPECT_EQ(pass.counts().drawCalls, 9u);

    Scene scene = threeKinds();
    executor_ = gl::Executor();
    drawn(scene, balls.clipFromWorld, balls.eye, params);
    EXPECT_EQ(executor_.programs().size(), 3u);
}

// ---- cost
// ----------------------------------------------------------------------------------------------------

std::uint64_t callsOf(const gl::CallRecorder& recorder) {
    std::uint64_t sum = 0;
    for (const auto& [name, count] : recorder.calls())
        sum += count;
    return sum;
}

TEST_P(Materials, InstancesOfOneMeshAndMaterialTakeAConstantNumberOfCalls) {
    std::vector<std::uint64_t> calls;
    for (const int count : {1, 2, 37, 128, 129}) {
        Scene scene = squareScene();
        scene.instances.clear();
        for (int i = 0; i < count; ++i) {
            glm::mat4 placement(0.5f);
            placement[3] = {0.01f * static_cast<float>(i) - 0.5f, 0, 0, 1};
            scene.instances.push_back({"square", 0, 0, placement});
        }
        MaterialPass pass(scene);
        const Image first = drawnBy(pass, scene, straightAhead(), {0, 0, 5});
        const gl::CallRecorder recorder;
        EXPECT_EQ(drawnBy(pass, scene, straightAhead(), {0, 0, 5}), first);
        calls.push_back(callsOf(recorder));
        EXPECT_EQ(pass.counts().drawCalls, count > 128 ? 2u : 1u);
        EXPECT_EQ(recorder.calls().at("glDrawElementsInstancedBaseVertex"), pass.counts().drawCalls);
        EXPECT_EQ(recorder.calls().count("glBufferData"), 0u) << "nothing has changed";
        EXPECT_EQ(pass.counts().instances, static_cast<std::size_t>(count));
    }
    EXPECT_EQ(calls[1], calls[0]);
    EXPECT_EQ(calls[2], calls[0]);
    EXPECT_EQ(calls[3], calls[0]);
    EXPECT_EQ(calls[4], calls[0] + 3);  // a second batch: its draw call, its range of the buffer, and back
}

TEST_P(Materials, InstancesArePlacedOneByOneAcrossBatches) {
    // 160 dots on a grid of 16 × 10, drawn as two batches, against the same dots drawn one a frame.
    Scene scene = squareScene();
    scene.instances.clear();
    for (int i = 0; i < 160; ++i) {
        glm::mat4 placement(1);
        placement[0].x = placement[1].y = 0.03f;
        placement[3] = {0.125f * static_cast<float>(i % 16) - 0.9375f,
                        0.125f * static_cast<float>(i / 16) - 0.5625f, 0, 1};
        scene.instances.push_back({"dot", 0, 0, placement});
    }
    MaterialPass pass(scene);
    const Image together = drawnBy(pass, scene, straightAhead(), {0, 0, 5});
    const FrameBlock frame = makeFrameBlock(scene, scene.lights, straightAhead(), {0, 0, 5});
    double sum = 0;
    for (const std::uint32_t i : {0u, 1u, 63u, 127u, 128u, 129u, 159u}) {
        const std::array<std::uint32_t, 1> one = {i};
        const Image alone = drawnBy(pass, scene, {.frame = frame, .visible = one}, {.background = false});
        for (std::size_t k = 0; k < alone.data.size(); ++k)
            if (alone.data[k] != 0) {
                ASSERT_EQ(alone.data[k], together.data[k]);
                sum += 1;
            }
    }
    EXPECT_GE(sum, 7 * 4);
}

TEST_P(Materials, AFrameCostsNothingForWhatIsNotListed) {
    std::vector<std::uint64_t> calls;
    for (const int hidden : {0, 2000}) {
        Scene scene = threeKinds();
        for (int i = 0; i < hidden; ++i) {
            scene.materials.push_back(scene.materials[0]);
            scene.instances.push_back({"hidden", 0, scene.materials.size() - 1, glm::mat4(1)});
        }
        MaterialPass pass(scene);
        const std::array<std::uint32_t, 3> visible = {0, 1, 2};
        const MaterialView view = {.frame = makeFrameBlock(scene, scene.lights, straightAhead(), {0, 0, 5}),
                                   .visible = visible};
        drawnBy(pass, scene, view);
        scene.instances[1].worldFromModel[3].y += 0.1f;
        scene.materials[0].roughness = 0.9f;
        const gl::CallRecorder recorder;
        drawnBy(pass, scene, view);
        calls.push_back(callsOf(recorder));
        EXPECT_EQ(pass.counts().instances, 3u);
    }
    EXPECT_EQ(calls[0], calls[1]);
}

TEST_P(Materials, AnEmptyListDrawsTheBackgroundAlone) {
    Scene scene = squareScene();
    scene.backgroundTop = scene.backgroundBottom = {0.5f, 0.25f, 1};
    MaterialPass pass(scene);
    const MaterialView view = {.frame = makeFrameBlock(scene, scene.lights, straightAhead(), {0, 0, 5})};
    EXPECT_EQ(at(drawnBy(pass, scene, view), 3, 3), vec4(0.5f, 0.25f, 1, 1));
    EXPECT_EQ(at(drawnBy(pass, scene, view, {.background = false}), 3, 3), vec4(0));
    const Scene nothing;
    EXPECT_EQ(sumOf(drawn(nothing, straightAhead(), {0, 0, 5}, {.background = false})), 0);
}

TEST_P(Materials, AFrameLeavesNoStateBehind) {
    Scene scene = threeKinds();
    scene.materials[0].alphaMode = Material::AlphaMode::blend;
    scene.materials[1].doubleSided = true;
    scene.instances[0].worldFromModel[0].x = -1;
    drawn(scene, straightAhead(), {0, 0, 5});
    for (const GLenum capability : {GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE})
        EXPECT_EQ(glIsEnabled(capability), GL_FALSE);
    GLboolean mask = GL_FALSE;
    glGetBooleanv(GL_DEPTH_WRITEMASK, &mask);
    EXPECT_EQ(mask, GL_TRUE);
    GLint value = 0;
    glGetIntegerv(GL_FRONT_FACE, &value);
    EXPECT_EQ(value, GL_CCW);
    glGetIntegerv(GL_CULL_FACE_MODE, &value);
    EXPECT_EQ(value, GL_BACK);
}

TEST_P(Materials, FarFromTheOriginAnAnchorKeepsThePictureSharp) {
    const vec3 far(1048576, 0, -2097152);
    BallsOfAllKinds balls;
    const Image near = drawn(balls.scene, balls.clipFromWorld, balls.eye);
    MaterialPass pass(balls.scene);
    Scene moved = balls.scene;
    for (Instance& instance : moved.instances)
        instance.worldFromModel[3] += vec4(far, 0);
    const std::vector<std::uint32_t> all = allOf(moved);
    // Camera and lights come relative to the anchor.
    EXPECT_EQ(
        drawnBy(pass, moved,
                {.frame = makeFrameBlock(balls.scene, balls.scene.lights, balls.clipFromWorld, balls.eye),
                 .anchorWorld = far,
                 .visible = all}),
        near);
}

// ---- depth
// ---------------------------------------------------------------------------------------------------

TEST_P(Materials, DepthAloneIsThatOfThePicture) {
    Scene scene = threeKinds();
    scene.instances[1].worldFromModel[0].x = -1;
    scene.materials[2].doubleSided = true;
    MaterialPass pass(scene);
    const glm::mat4 clip =
        perspective(0.5f, 1, 1, 9) * cameraFromWorld(lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    const std::vector<std::uint32_t> all = allOf(scene);
    const MaterialView view = {.frame = makeFrameBlock(scene, scene.lights, clip, {0, 0, 4}), .visible = all};
    const auto depthOf = [&](bool alone, bool backFaces) {
        graph::FrameGraph graph;
        const PictureTargets targets = addPictureTargets(graph, {graph::Format::rgba32f, size, size, 1});
        graph.addPass({"draw", {}, {targets.color, targets.depth}, [&](graph::PassContext& context) {
                           glClearDepth(1);
                           glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
                           if (alone)
                               pass.drawDepth(context, scene, clip, vec3(0), all, {.backFaces = backFaces});
                           else
                               pass.draw(context, scene, view);
                       }});
        graph.addOutput(targets.depth);
        executor_.run(graph);
        return gl::readPixels(executor_.output(targets.depth));
    };
    const Image depth = depthOf(false, false);
    EXPECT_EQ(depthOf(true, false), depth);
    // Farther where solids are, the same where a cut-out ball shows both its sides, 1 elsewhere.
    const Image backs = depthOf(true, true);
    int farther = 0;
    for (std::size_t i = 0; i < depth.data.size(); ++i) {
        EXPECT_GE(backs.data[i], depth.data[i]);
        farther += backs.data[i] > depth.data[i] ? 1 : 0;
    }
    EXPECT_GT(farther, 300);
}

INSTANTIATE_TEST_SUITE_P(On, Materials, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const testing::TestParamInfo<gl::Backend>& backend) {
                             return std::string(gl::backendName(backend.param));
                         });

INSTANTIATE_TEST_SUITE_P(On, BrokenMaterials, testing::Values(gl::Backend::egl),
                         [](const testing::TestParamInfo<gl::Backend>& backend) {
                             return std::string(gl::backendName(backend.param));
                         });

}  // namespace
}  // namespace quincunx

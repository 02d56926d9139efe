#include "passes/environment_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "trace/environment_glsl.h"

namespace quincunx {
namespace {

constexpr int faceCount = 6;

/// The unit direction of the middle of a texel.
glm::dvec3 texelDirection(int face, int x, int y, int size) {
    return glm::normalize(glm::dvec3(glsl::cubeDirection(
        face, (glm::vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f) / static_cast<float>(size))));
}

/// Faces whose texels are a function of their directions.
template <typename Light>
std::vector<Image> facesOf(int size, const Light& light) {
    std::vector<Image> faces;
    for (int face = 0; face < faceCount; ++face) {
        Image image(size, size, 4, Encoding::linear);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const glm::dvec3 color = light(texelDirection(face, x, y, size));
                for (int c = 0; c < 3; ++c)
                    image.pixel(x, y)[c] = static_cast<float>(color[c]);
                image.pixel(x, y)[3] = 1;
            }
        faces.push_back(std::move(image));
    }
    return faces;
}

glm::dvec3 texelOf(const Image& image, int x, int y) {
    return {image.pixel(x, y)[0], image.pixel(x, y)[1], image.pixel(x, y)[2]};
}

class EnvironmentMaps : public testing::TestWithParam<gl::Backend> {
  protected:
    EnvironmentMaps() : context_(gl::createOffscreenContext(GetParam())) {}

    /// Runs `make` as the pass of a frame.
    void run(const std::function<void(graph::PassContext&)>& make) {
        graph::FrameGraph graph;
        graph.addOutput(addEnvironmentPass(graph, make));
        executor_.run(graph);
    }

    void fromFaces(EnvironmentMap& map, const std::vector<Image>& faces, EnvironmentParams params) {
        run([&](graph::PassContext& context) { map.fromFaces(context, faces, params); });
    }

    /// The largest difference between the texels of a cube's level and a function of their directions.
    template <typename Light>
    static double worst(const gl::TextureCube& cube, int level, const Light& light) {
        double found = 0;
        const int size = cube.sizeOf(level);
        for (int face = 0; face < faceCount; ++face) {
            const Image image = gl::readPixels(cube, face, level);
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const glm::dvec3 off =
                        texelOf(image, x, y) - glm::dvec3(light(texelDirection(face, x, y, size)));
                    found = std::max({found, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
                }
        }
        return found;
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
};

INSTANTIATE_TEST_SUITE_P(On, EnvironmentMaps, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const auto& instance) { return std::string(gl::backendName(instance.param)); });

TEST_P(EnvironmentMaps, AConstantSurroundingStaysConstantAtEveryLevelAndSize) {
    const glm::dvec3 light(0.25, 1.5, 3);
    const auto constant = [&](glm::dvec3) { return light; };
    for (const int size : {1, 2, 5, 32}) {
        EnvironmentMap map;
        fromFaces(map, facesOf(size, constant),
                  {.size = size, .levels = 100, .samples = 16, .format = GL_RGBA32F});
        ASSERT_EQ(map.levels(), gl::TextureCube::fullLevels(size));
        // Sums of equal terms over sums of their weights, in float: up to 1536 of them.
        for (int level = 0; level < map.levels(); ++level)
            EXPECT_LE(worst(map.radiance(), level, constant), 3e-5) << size << " level " << level;
        EXPECT_LE(worst(map.irradiance(), 0, constant), 3e-5) << size;
    }
}

TEST_P(EnvironmentMaps, IrradianceOfLightThatGrowsWithHeightIsThatOfItsClosedForm) {
    const glm::dvec3 zenith(1.5, 1.0, 0.5);
    const glm::dvec3 nadir(0.1, 0.2, 0.9);
    EnvironmentMap map;
    run([&](graph::PassContext& context) {
        map.fromGradient(context, zenith, nadir, {.size = 64, .levels = 1, .format = GL_RGBA32F});
    });
    EXPECT_LE(
        worst(map.radiance(), 0, [&](glm::dvec3 d) { return glm::mix(nadir, zenith, 0.5 + 0.5 * d.y); }),
        1e-6);
    // The cosine lobe multiplies the first spherical harmonics by 2/3 (Ramamoorthi and Hanrahan 2001). 1536
    // texels weighted by their middles.
    EXPECT_LE(
        worst(map.irradiance(), 0, [&](glm::dvec3 n) { return glm::mix(nadir, zenith, 0.5 + n.y / 3); }),
        0.002);
}

TEST_P(EnvironmentMaps, RoughnessZeroIsTheMapItselfBitForBit) {
    Random random(5);
    const int size = 16;
    const std::vector<Image> faces = facesOf(size, [&](glm::dvec3) {
        return glm::dvec3(random.uniform(0, 4), random.uniform(0, 1), random.uniform(0, 1000));
    });
    EnvironmentMap map;
    fromFaces(map, faces,
              {.size = size, .levels = 3, .samples = 4, .irradiance = false, .format = GL_RGBA32F});
    for (int face = 0; face < faceCount; ++face)
        EXPECT_EQ(gl::readPixels(map.radiance(), face, 0).data, faces[static_cast<std::size_t>(face)].data)
            << face;
}

/// The rotation of the cube onto itself that carries x to y and y to z, or one quarter turn about an axis.
std::vector<glm::dmat3> cubeRotations() {
    return {glm::dmat3(0, 1, 0, 0, 0, 1, 1, 0, 0), glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0),
            glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0), glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1)};
}

/// Light of all colours with sharp and soft edges, no two directions alike.
glm::dvec3 patchyLight(glm::dvec3 d) {
    return {d.x > 0.3 ? 2.0 : 0.1, 0.5 + 0.5 * d.y * d.z,
            std::exp(4 * glm::dot(d, glm::normalize(glm::dvec3(1, 2, -3))))};
}

TEST_P(EnvironmentMaps, TurningTheSurroundingsByQuartersTurnsEveryLevel) {
    const int size = 16;
    const EnvironmentParams params{.size = size, .levels = 5, .samples = 32, .format = GL_RGBA32F};
    EnvironmentMap map;
    fromFaces(map, facesOf(size, patchyLight), params);
    const auto lightOf = [](const gl::TextureCube& cube, int level) {
        std::vector<Image> images;
        for (int face = 0; face < faceCount; ++face)
            images.push_back(gl::readPixels(cube, face, level));
        return [images, edge = cube.sizeOf(level)](glm::dvec3 d) {
            const glm::vec3 place = glsl::cubePlace(glm::vec3(d));
            const auto index = [&](float s) {
                return std::clamp(static_cast<int>(s * static_cast<float>(edge)), 0, edge - 1);
            };
            return texelOf(images[static_cast<std::size_t>(place.z)], index(place.x), index(place.y));
        };
    };
    for (const glm::dmat3& rotation : cubeRotations()) {
        const glm::dmat3 back = glm::transpose(rotation);
        EnvironmentMap turned;
        fromFaces(turned, facesOf(size, [&](glm::dvec3 d) { return patchyLight(back * d); }), params);
        for (int level = 0; level < map.levels(); ++level) {
            const auto expected = lightOf(map.radiance(), level);
            // Light up to 55; roundings of sums, and of lookups that are made between other texels' numbers.
            EXPECT_LE(worst(turned.radiance(), level, [&](glm::dvec3 d) { return expected(back * d); }), 2e-3)
                << level;
        }
        const auto expected = lightOf(map.irradiance(), 0);
        EXPECT_LE(worst(turned.irradiance(), 0, [&](glm::dvec3 d) { return expected(back * d); }), 2e-3);
    }
}

/// The mean over the sphere of what a level holds.
glm::dvec3 meanLight(const gl::TextureCube& cube, int level) {
    glm::dvec3 sum(0);
    double weight = 0;
    const int size = cube.sizeOf(level);
    for (int face = 0; face < faceCount; ++face) {
        const Image image = gl::readPixels(cube, face, level);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const glm::vec2 xy((2 * static_cast<float>(x) + 1) / static_cast<float>(size) - 1,
                                   (2 * static_cast<float>(y) + 1) / static_cast<float>(size) - 1);
                const double angle = glsl::cubeTexelAngle(xy, 2 / static_cast<float>(size));
                sum += angle * texelOf(image, x, y);
                weight += angle;
            }
    }
    return sum / weight;
}

TEST_P(EnvironmentMaps, PrefilteringKeepsTheLight) {
    EnvironmentMap map;
    fromFaces(map, facesOf(64, patchyLight), {.size = 64, .levels = 5, .samples = 64, .format = GL_RGBA32F});
    const glm::dvec3 source = meanLight(map.radiance(), 0);
    for (int level = 1; level < map.levels(); ++level)
        for (int c = 0; c < 3; ++c)
            // Measured 0.06 at most, where a few coarse texels are all that is read: each is the mean of
            // four, whatever their angles, which differ by up to 5.2 over a face.
            EXPECT_NEAR(meanLight(map.radiance(), level)[c] / source[c], 1, level < 3 ? 0.03 : 0.08) << level;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(meanLight(map.irradiance(), 0)[c] / source[c], 1, 0.01);
}

TEST_P(EnvironmentMaps, NeighboursAcrossAnEdgeDifferNoMoreThanNeighboursWithinAFace) {
    EnvironmentMap map;
    fromFaces(map, facesOf(64, patchyLight), {.size = 64, .levels = 5, .samples = 64, .format = GL_RGBA32F});
    for (int level = 2; level < map.levels(); ++level) {
        const int size = map.radiance().sizeOf(level);
        std::vector<Image> images;
        for (int face = 0; face < faceCount; ++face)
            images.push_back(gl::readPixels(map.radiance(), face, level));
        double within = 0;
        double across = 0;
        for (int face = 0; face < faceCount; ++face)
            for (int i = 0; i < size; ++i) {
                const Image& image = images[static_cast<std::size_t>(face)];
                for (int j = 1; j < size; ++j) {
                    within = std::max(within, glm::length(texelOf(image, i, j) - texelOf(image, i, j - 1)));
                    within = std::max(within, glm::length(texelOf(image, j, i) - texelOf(image, j - 1, i)));
                }
                // One texel's width beyond the edge s = 1.
                const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(size);
                const glm::vec3 place =
                    glsl::cubePlace(glsl::cubeDirection(face, {1 + 0.5f / static_cast<float>(size), t}));
                const auto index = [&](float s) {
                    return std::clamp(static_cast<int>(s * static_cast<float>(size)), 0, size - 1);
                };
                across = std::max(across, glm::length(texelOf(image, size - 1, i) -
                                                      texelOf(images[static_cast<std::size_t>(place.z)],
                                                              index(place.x), index(place.y))));
            }
        EXPECT_LE(across, 1.2 * within) << level;
    }
}

TEST_P(EnvironmentMaps, APanoramaGoesOntoTheFacesWhereItsDirectionsAre) {
    const int width = 256;
    Image panorama(width, width / 2, 3, Encoding::linear);
    const auto smooth = [](glm::dvec3 d) {
        return glm::dvec3(0.5 + 0.5 * d.x, 0.5 + 0.5 * d.y, 0.5 + 0.5 * d.z);
    };
    for (int y = 0; y < panorama.height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec3 d(glsl::panoramaDirection(
                {(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                 (static_cast<float>(y) + 0.5f) / static_cast<float>(panorama.height)}));
            for (int c = 0; c < 3; ++c)
                panorama.pixel(x, y)[c] = static_cast<float>(smooth(d)[c]);
        }
    EnvironmentMap map;
    run([&](graph::PassContext& context) {
        map.fromPanorama(context, panorama, glm::vec3(0),
                         {.size = 33, .levels = 1, .irradiance = false, .format = GL_RGBA32F});
    });
    // An odd size, so that texels lie on the poles; a pixel of the panorama is 0.025 radians.
    EXPECT_LE(worst(map.radiance(), 0, smooth), 0.007);
}

TEST_P(EnvironmentMaps, UnusableLightInAPanoramaIsMadeUsable) {
    Image panorama(8, 4, 1, Encoding::linear);
    std::fill(panorama.data.begin(), panorama.data.end(), 1.0f);
    panorama.data[3] = std::nanf("");
    panorama.data[9] = -INFINITY;
    panorama.data[17] = INFINITY;
    panorama.data[21] = 1e30f;
    EnvironmentMap map;
    run([&](graph::PassContext& context) { map.fromPanorama(context, panorama, glm::vec3(0), {.size = 8}); });
    for (int level = 0; level < map.levels(); ++level)
        for (int face = 0; face < faceCount; ++face)
            for (const float value : gl::readPixels(map.radiance(), face, level).data)
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << level;
    EXPECT_THROW(
        run([&](graph::PassContext& context) { map.fromPanorama(context, Image(), glm::vec3(0), {}); }),
        InputError);
}

TEST_P(EnvironmentMaps, RenderedFacesSeeWhatLiesInTheirDirections) {
    // Eight quads far away, one an octant, seen from a point that is not the origin.
    Scene scene;
    const glm::vec3 centre(3, -2, 5);
    const auto octant = [](int i) {
        return glm::vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    };
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner = octant(i);
        Mesh mesh;
        mesh.name = "octant";
        mesh.positions = {{corner.x * 10, 0, 0}, {0, corner.y * 10, 0}, {0, 0, corner.z * 10}};
        mesh.normals.assign(3, -corner / std::sqrt(3.0f));
        mesh.indices = {0, 1, 2};
        Material material;
        material.emission = 0.5f + 0.25f * corner;
        material.ambient = material.diffuse = material.specular = glm::vec3(0);
        material.doubleSided = true;
        glm::mat4 place(1);
        place[3] = glm::vec4(centre, 1);
        scene.instances.push_back({"octant", scene.meshes.size(), scene.materials.size(), place});
        scene.meshes.push_back(mesh);
        scene.materials.push_back(material);
    }
    ForwardScene drawn(scene);
    EnvironmentMap map;
    run([&](graph::PassContext& context) {
        map.render(context, {.position = centre},
                   [&](graph::PassContext& inner, const ForwardView& view) { drawn.draw(inner, view); },
                   {.size = 16, .levels = 1, .irradiance = false, .format = GL_RGBA32F});
    });
    EXPECT_EQ(map.position(), centre);
    // No texel's middle lies on a border between octants, for an even size.
    EXPECT_LE(worst(map.radiance(), 0,
                    [](glm::dvec3 d) {
                        return 0.5 + 0.25 * glm::dvec3(glm::sign(d.x), glm::sign(d.y), glm::sign(d.z));
                    }),
              1e-6);
}

TEST_P(EnvironmentMaps, AMapOfTheSameFormIsMadeInWhatThereIs) {
    EnvironmentMap map;
    run([&](graph::PassContext& context) {
        map.fromGradient(context, glm::vec3(1), glm::vec3(0), {.size = 16});
    });
    const std::size_t bytes = map.bytes();
    EXPECT_GT(bytes, 0u);
    const gl::CallRecorder recorder;
    run([&](graph::PassContext& context) {
        map.fromGradient(context, glm::vec3(1), glm::vec3(0), {.size = 16});
    });
    EXPECT_EQ(recorder.calls().count("glGenTextures"), 0u);
    EXPECT_EQ(recorder.calls().count("glGenFramebuffers"), 0u);
    EXPECT_EQ(map.bytes(), bytes);
}

TEST_P(EnvironmentMaps, AMapThatNobodyReadsIsNotMade) {
    graph::FrameGraph graph;
    bool made = false;
    addEnvironmentPass(graph, [&](graph::PassContext&) { made = true; });
    executor_.run(graph);
    EXPECT_FALSE(made);
}

TEST(EnvironmentBrdf, IsTheIntegralOfGgx) {
    constexpr int size = 9;
    const Image table = environmentBrdfTable(size, 128);
    const Image converged = environmentBrdfTable(size, 16384);
    double worst = 0;
    for (std::size_t i = 0; i < table.data.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(table.data[i]) - converged.data[i]));
    EXPECT_LE(worst, 0.006);  // measured 0.0047
    for (int i = 0; i < size; ++i) {
        // A mirror reflects all, or Schlick's share: 1 − (1 − c)^5 and (1 − c)^5.
        const double cosine = std::max(i / (size - 1.0), 1e-3);
        EXPECT_NEAR(table.pixel(i, 0)[0], 1 - std::pow(1 - cosine, 5), 2e-3);
        EXPECT_NEAR(table.pixel(i, 0)[1], std::pow(1 - cosine, 5), 2e-3);
        // Masking takes light away, more the rougher; nothing is added.
        for (int j = 0; j < size; ++j)
            EXPECT_LE(table.pixel(i, j)[0] + table.pixel(i, j)[1], 1 + 1e-6);
    }
}

TEST(EnvironmentBrdf, RoughnessOneSeenFromAboveIsItsClosedForm) {
    // For alpha = 1, D is 1/π, and seen from straight above masking and shadowing leave 2c / (1 + c) of light
    // at the cosine c: the integral of D G / 4 over the hemisphere is that of c / (1 + c) over c = 0 … 1.
    const Image table = environmentBrdfTable(3, 16384);
    EXPECT_NEAR(table.pixel(2, 2)[0] + table.pixel(2, 2)[1], 1 - std::log(2.0), 1e-3);
}

}  // namespace
}  // namespace quincunx

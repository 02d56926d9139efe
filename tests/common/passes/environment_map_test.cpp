#include "passes/environment_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
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

}  // namespace
}  // namespace quincunx

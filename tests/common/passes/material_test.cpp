#include "passes/material.h"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/shapes.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/forward.h"
#include "passes/targets.h"

namespace quincunx {
namespace {

using glm::dvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

/// Two triangles over −1 … 1 in x and y at z = 0, facing +z; texture coordinates from 0 at the top left to 1.
Mesh makeSquare() {
    Mesh mesh;
    mesh.name = "square";
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

[[maybe_unused]] Texture makeTexture(int width, int height, Encoding encoding,
                                     std::initializer_list<int> rgba) {
    Texture texture;
    texture.image = Image8(width, height, 4, encoding);
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

class Materials : public testing::TestWithParam<gl::Backend> {
  protected:
    static constexpr int size = 64;

    Materials() : context_(gl::createOffscreenContext(GetParam())) {}

    /// All instances of the scene over black, in linear light.
    Image drawn(const Scene& scene, const glm::mat4& clipFromWorld, vec3 eye,
                const MaterialParams& params = {}) {
        MaterialPass pass(scene);
        return drawnBy(pass, scene, clipFromWorld, eye, params);
    }

    Image drawnBy(MaterialPass& pass, const Scene& scene, const glm::mat4& clipFromWorld, vec3 eye,
                  const MaterialParams& params = {}) {
        std::vector<std::uint32_t> all(scene.instances.size());
        for (std::uint32_t i = 0; i < all.size(); ++i)
            all[i] = i;
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

    static Scene squareScene() {
        Scene scene;
        scene.meshes.push_back(makeSquare());
        scene.materials.emplace_back();
        scene.instances.push_back({"square", 0, 0, glm::mat4(1)});
        scene.ambientLight = vec3(0);
        return scene;
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
};

TEST_P(Materials, ASquareUnderAmbientLightHasItsBaseColour) {
    Scene scene = squareScene();
    scene.ambientLight = {1, 0.5f, 2};
    scene.materials[0].baseColor = {0.25f, 0.5f, 0.75f, 0.1f};
    const Image picture = drawn(scene, straightAhead(), {0, 0, 5});
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float* p = picture.pixel(x, y);
            ASSERT_EQ(vec4(p[0], p[1], p[2], p[3]), vec4(0.25f, 0.25f, 1.5f, 1)) << x << ", " << y;
        }
}

INSTANTIATE_TEST_SUITE_P(On, Materials, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const testing::TestParamInfo<gl::Backend>& backend) {
                             return std::string(gl::backendName(backend.param));
                         });

}  // namespace
}  // namespace quincunx

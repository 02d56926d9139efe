#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "geometry/shapes.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/forward.h"
#include "passes/labels.h"
#include "passes/lines.h"
#include "passes/targets.h"

namespace quincunx {
namespace {

class Passes : public testing::TestWithParam<gl::Backend> {
  protected:
    static constexpr int width = 96;
    static constexpr int height = 64;
    static constexpr glm::vec2 viewport{width, height};

    Passes() : context_(gl::createOffscreenContext(GetParam())) {}

    /// What `draw` draws over black, in linear light.
    template <typename Draw>
    Image drawn(Draw draw) {
        graph::FrameGraph graph;
        const PictureTargets targets = addPictureTargets(graph, {graph::Format::rgba32f, width, height, 1});
        graph.addPass({"draw", {}, {targets.color, targets.depth}, [&](graph::PassContext& context) {
                           glClearColor(0, 0, 0, 0);
                           glClearDepth(1);
                           glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
                           draw(context);
                       }});
        addResolvePass(graph, targets);
        graph.addOutput(targets.picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(targets.picture));
    }

    static double sumOf(const Image& image, int channel) {
        double sum = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                sum += image.pixel(x, y)[channel];
        return sum;
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
};

// Pixels as units, the origin in the middle, y up.
glm::mat4 clipFromPixels(glm::vec2 viewport) {
    return orthographic(-viewport.x / 2, viewport.x / 2, -viewport.y / 2, viewport.y / 2, -1, 1);
}

TEST_P(Passes, ALineCoversItsLengthTimesItsWidthAndItsRoundEnds) {
    Lines lines;
    const Image picture = drawn([&](graph::PassContext& context) {
        lines.segment({-20, -10, 0}, {20, 10, 0}, {.color = {1, 1, 1, 1}, .widthPixels = 6});
        lines.draw(context, {.clipFromWorld = clipFromPixels(viewport), .viewportPixels = viewport});
    });
    const double length = std::hypot(40.0, 20.0);
    const double area = length * 6 + std::acos(-1.0) * 9;
    // Measured 297.8 against 296.6. A ramp one pixel wide adds π/12 = 0.3 around the two round ends; the
    // rest is the sampling of some 120 pixels of edge at their centres.
    EXPECT_NEAR(sumOf(picture, 0), area, 2);
    EXPECT_FLOAT_EQ(picture.pixel(width / 2, height / 2)[0], 1);
}

TEST_P(Passes, ADashedLineIsHalfALine) {
    Lines lines;
    const auto draw = [&](float dash) {
        return sumOf(drawn([&](graph::PassContext& context) {
                         lines.clear();
                         lines.segment({-40, 0, 0}, {40, 0, 0}, {.widthPixels = 4, .dashPixels = dash});
                         lines.draw(context,
                                    {.clipFromWorld = clipFromPixels(viewport), .viewportPixels = viewport});
                     }),
                     3);
    };
    // The round end at the start lies in a gap, the one at the end in a dash: up to 13 pixels of 333.
    EXPECT_NEAR(draw(5) / draw(0), 0.5, 0.03);
}

TEST_P(Passes, ALineThatPassesTheEyeIsCutAtTheNearPlane) {
    const glm::mat4 clipFromEye = perspective(1.5f, 1.5f, 0.1f, 100);
    Lines lines;
    const auto covered = [&](glm::vec3 from, glm::vec3 to) {
        return sumOf(drawn([&](graph::PassContext& context) {
                         lines.clear();
                         lines.segment(from, to, {.widthPixels = 2});
                         lines.draw(context, {.clipFromWorld = clipFromEye, .viewportPixels = viewport});
                     }),
                     3);
    };
    EXPECT_EQ(covered({0, 0, 1}, {3, 1, 5}), 0);
    const double front = covered({1, -1, -0.1f}, {1, -1, -10});
    EXPECT_GT(front, 0);
    EXPECT_NEAR(covered({1, -1, 50}, {1, -1, -10}), front, 1e-3 * front);
}

TEST_P(Passes, LinesHideBehindSurfacesAndLieOnThemWithABias) {
    Scene scene;
    scene.meshes.push_back(tessellate(Drum{.radius = 20, .halfHeight = 1, .rimRadius = 0.5}, 24));
    scene.materials.emplace_back();
    glm::mat4 lowered(1);
    lowered[3].y = -1;  // its top at y = 0
    scene.instances.push_back({"floor", 0, 0, lowered});
    scene.lights.emplace_back();
    ForwardScene forward(scene);
    Camera camera;
    camera.worldFromCamera = lookAt({0, 4, 8}, {0, 0, 0}, {0, 1, 0});
    const ForwardView view = forwardView(camera, viewport.x / viewport.y);
    Lines lines;
    const glm::vec4 red(1, 0, 0, 1);
    const auto redness = [&](float y, float bias) {
        const Image picture = drawn([&](graph::PassContext& context) {
            forward.draw(context, view);
            lines.clear();
            lines.segment({-2, y, 0}, {2, y, 0}, {.color = red, .widthPixels = 3});
            lines.draw(context,
                       {.clipFromWorld = view.clipFromWorld, .viewportPixels = viewport, .depthBias = bias});
        });
        double sum = 0;
        for (int y2 = 0; y2 < height; ++y2)
            for (int x = 0; x < width; ++x)
                sum += picture.pixel(x, y2)[0] > 0.5f && picture.pixel(x, y2)[1] < 0.2f ? 1 : 0;
        return sum;
    };
    EXPECT_EQ(redness(-0.5f, 0), 0);
    // The line is some 35 pixels long and 3 wide; one row at least is covered in full.
    EXPECT_GT(redness(0.5f, 0), 30);
    EXPECT_GT(redness(0, 1e-4f), 30);
}

TEST_P(Passes, TextFillsWhatItsExtentSaysAndNothingElse) {
    Labels labels;
    const std::string words = "Rᵀ·x ≤ θ";
    const Image picture = drawn([&](graph::PassContext& context) {
        labels.text(words, {10, 20}, {.sizePixels = 18});
        labels.draw(context, viewport);
    });
    const glm::vec2 extent = labels.extent(words, 18);
    EXPECT_EQ(extent.y, 18);
    EXPECT_GT(extent.x, 50);
    double inside = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float value = picture.pixel(x, y)[0];
            const bool within = x >= 9 && static_cast<float>(x) <= 10 + extent.x && y >= 20 && y < 38;
            inside += within ? value : 0;
            if (!within) {
                EXPECT_EQ(value, 0) << x << ", " << y;
            }
        }
    EXPECT_GT(inside, 60);
}

TEST_P(Passes, TextAtOneSizeIsTheSameWhereverItStands) {
    Labels labels;
    const auto at = [&](glm::vec2 position, Labels::Anchor anchor) {
        return drawn([&](graph::PassContext& context) {
            labels.clear();
            labels.text("eye space", position, {.sizePixels = 14, .anchor = anchor});
            labels.draw(context, viewport);
        });
    };
    const Image left = at({5, 5}, Labels::Anchor::topLeft);
    const glm::vec2 extent = labels.extent("eye space", 14);
    const Image right = at(glm::vec2(5, 5) + extent, Labels::Anchor::bottomRight);
    EXPECT_EQ(left, right);
    EXPECT_GT(sumOf(left, 0), 20);
}

TEST_P(Passes, APlateCoversExactlyItsPixels) {
    Labels labels;
    const Image picture = drawn([&](graph::PassContext& context) {
        labels.plate({8, 4}, {16, 10}, {1, 0.5f, 0.25f, 0.5f});
        labels.draw(context, viewport);
    });
    EXPECT_FLOAT_EQ(static_cast<float>(sumOf(picture, 0)), 16 * 10 * 0.5f);
    EXPECT_FLOAT_EQ(picture.pixel(8, 4)[1], 0.25f);
    EXPECT_FLOAT_EQ(picture.pixel(23, 13)[2], 0.125f);
    EXPECT_EQ(picture.pixel(24, 13)[3], 0);
}

TEST_P(Passes, MalformedTextIsDrawnWithoutReadingBeyondIt) {
    Labels labels;
    EXPECT_NO_THROW(drawn([&](graph::PassContext& context) {
        labels.text("\xC3", {0, 0}, {});
        labels.text("a\xE2\x88", {0, 20}, {});
        labels.text("\xFF\xFEok", {0, 40}, {});
        labels.draw(context, viewport);
    }));
}

TEST_P(Passes, LinesAndLabelsLeaveNoStateBehind) {
    Lines lines;
    Labels labels;
    drawn([&](graph::PassContext& context) {
        lines.segment({0, 0, 0}, {9, 9, 0}, {});
        lines.draw(context, {.clipFromWorld = clipFromPixels(viewport), .viewportPixels = viewport});
        labels.text("x", {0, 0}, {});
        labels.draw(context, viewport);
        EXPECT_EQ(glIsEnabled(GL_BLEND), GL_FALSE);
        EXPECT_EQ(glIsEnabled(GL_DEPTH_TEST), GL_FALSE);
        GLboolean mask = GL_FALSE;
        glGetBooleanv(GL_DEPTH_WRITEMASK, &mask);
        EXPECT_EQ(mask, GL_TRUE);
        GLint function = 0;
        glGetIntegerv(GL_DEPTH_FUNC, &function);
        EXPECT_EQ(function, GL_LESS);
    });
}

TEST_P(Passes, AMirroredPlacementKeepsItsFrontFaces) {
    Scene scene;
    scene.meshes.push_back(tessellate(Sphere{}, 24));
    scene.materials.emplace_back();
    scene.instances.push_back({"ball", 0, 0, glm::mat4(1)});
    scene.lights.emplace_back();
    scene.lights.back().direction = {0, 0, -1};
    ForwardScene forward(scene);
    Camera camera;
    camera.worldFromCamera = lookAt({0, 0, 4}, {0, 0, 0}, {0, 1, 0});
    const auto draw = [&](float mirror) {
        forward.scene().instances[0].worldFromModel[0][0] = mirror;
        return drawn([&](graph::PassContext& context) {
            forward.draw(context, forwardView(camera, viewport.x / viewport.y));
        });
    };
    const Image straight = draw(1);
    const Image mirrored = draw(-1);
    EXPECT_GT(sumOf(straight, 0), 100);
    EXPECT_NEAR(sumOf(mirrored, 0), sumOf(straight, 0), 0.01 * sumOf(straight, 0));
}

TEST(PixelOf, AgreesWithTheViewportTransformAndRefusesWhatIsBehind) {
    const glm::mat4 clipFromEye = perspective(1.5707964f, 2, 0.5f, 100);
    const auto pixel = pixelOf({0, 1, -2}, clipFromEye, {200, 100});
    ASSERT_TRUE(pixel.has_value());
    EXPECT_NEAR(pixel->x, 100, 1e-4);
    EXPECT_NEAR(pixel->y, 25, 1e-4);
    EXPECT_FALSE(pixelOf({0, 1, 2}, clipFromEye, {200, 100}).has_value());
    EXPECT_FALSE(pixelOf({0, 0, 0}, clipFromEye, {200, 100}).has_value());
    EXPECT_FALSE(pixelOf({0, 0, -0.4f}, clipFromEye, {200, 100}).has_value());
}

INSTANTIATE_TEST_SUITE_P(OnBoth, Passes, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const testing::TestParamInfo<gl::Backend>& backend) {
                             return std::string(gl::backendName(backend.param));
                         });

}  // namespace
}  // namespace quincunx

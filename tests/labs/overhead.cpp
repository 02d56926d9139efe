// The engine beside a program written by hand: the same picture, by hardly more calls. Times are measured by
// bench_engine_overhead.
#include <gtest/gtest.h>

#include "gl/context.h"
#include "tests/bench/bare_shading.h"
#include "tests/bench/engine_shading.h"

namespace quincunx {
namespace {

class OverheadTest : public testing::TestWithParam<gl::Backend> {
  protected:
    std::unique_ptr<gl::Context> bareContext_ = gl::createOffscreenContext(GetParam());
    std::unique_ptr<gl::Context> engineContext_ = gl::createOffscreenContext(GetParam());
};

TEST_P(OverheadTest, DrawsThePictureOfTheBareProgramWithHardlyMoreCalls) {
    constexpr int width = 320;
    constexpr int height = 240;
    bareContext_->makeCurrent();
    auto bare = std::make_unique<BareShading>(width, height);
    const Camera camera = bare->camera();
    bare->draw(camera);
    const auto bareCalls = callsOf([&] { bare->draw(walking(camera, 100)); });
    const Image8 expected = bare->picture();
    bare.reset();

    engineContext_->makeCurrent();
    EngineShading engine(width, height);
    engine.draw(camera);
    EXPECT_NE(engine.picture(), expected) << "the walk shows in the picture";
    const auto engineCalls = callsOf([&] { engine.draw(walking(camera, 100)); });
    EXPECT_EQ(engine.picture(), expected);

    EXPECT_EQ(engineCalls.at("glDrawElementsBaseVertex"), bareCalls.at("glDrawElementsBaseVertex"));
    EXPECT_LE(static_cast<double>(sumOf(engineCalls)), 1.1 * static_cast<double>(sumOf(bareCalls)));
}

INSTANTIATE_TEST_SUITE_P(Offscreen, OverheadTest, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const auto& param) { return std::string(gl::backendName(param.param)); });

}  // namespace
}  // namespace quincunx

#include "gl/window.h"

#include <cstdlib>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "tests/common/gl/gl_test.h"
#include "tests/support/xvfb.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

TEST(Window, OpensOnADisplayAndDraws) {
    const quincunx::test::Xvfb display;
    for (int i = 0; i < 2; ++i) {
        Window window("probe", 320, 200);
        EXPECT_EQ(window.screenSize(), glm::ivec2(320, 200));
        EXPECT_EQ(window.framebufferSize(), glm::ivec2(320, 200)) << "Xvfb is not high-DPI";
        EXPECT_EQ(window.contentScale(), 1.0f);
        EXPECT_FALSE(window.renderer().empty());
        glClearColor(0.2f, 0.4f, 0.6f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        std::uint8_t pixel[4] = {};
        glReadPixels(160, 100, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
        EXPECT_THAT(pixel, testing::ElementsAre(51, 102, 153, testing::_));
        window.swapBuffers();
        window.pollEvents();
        EXPECT_FALSE(window.shouldClose());
        glfwSetWindowShouldClose(window.glfw(), GLFW_TRUE);
        EXPECT_TRUE(window.shouldClose());
    }
}

TEST(Window, TakesTurnsWithAnOffscreenContext) {
    const quincunx::test::Xvfb display;
    Window window("probe", 64, 64);
    const auto egl = createOffscreenContext(Backend::egl);
    const Buffer buffer("on EGL", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    window.makeCurrent();
    EXPECT_EQ(glIsBuffer(buffer.get()), GL_FALSE);
    window.swapBuffers();
    egl->makeCurrent();
    EXPECT_EQ(glIsBuffer(buffer.get()), GL_TRUE);
}

class NoDisplay : public testing::Test {
  protected:
    void SetUp() override {
        unsetenv("DISPLAY");
        unsetenv("WAYLAND_DISPLAY");
    }
};

TEST_F(NoDisplay, IsAnErrorWithARemedy) {
    EXPECT_FALSE(displayAvailable());
    EXPECT_THAT(messageOf<EnvironmentError>([] { Window("probe", 64, 64); }),
                AllOf(HasSubstr("DISPLAY"), HasSubstr("--backend egl")));
}

TEST_F(NoDisplay, ADisplayThatDoesNotAnswerIsAnErrorWithGlfwsWords) {
    setenv("DISPLAY", ":54321", 1);
    EXPECT_FALSE(displayAvailable());
    EXPECT_THAT(messageOf<EnvironmentError>([] { Window("probe", 64, 64); }),
                AllOf(HasSubstr("X11"), HasSubstr(":54321"), HasSubstr("--backend egl")));
}

TEST_F(NoDisplay, AnEmptyWindowIsRefused) {
    const quincunx::test::Xvfb display;
    EXPECT_THAT(messageOf<InputError>([] { Window("probe", 0, 64); }), HasSubstr("1×1"));
}

}  // namespace
}  // namespace quincunx::gl

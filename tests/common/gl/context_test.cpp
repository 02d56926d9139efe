#include "gl/context.h"

#include "gl/window.h"
#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

class ContextTest : public test::OnBackend {};

TEST_P(ContextTest, IsAtLeast33Core) {
    GLint major = 0;
    GLint minor = 0;
    GLint profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_GE(major * 10 + minor, 33);
    EXPECT_EQ(profile & GL_CONTEXT_CORE_PROFILE_BIT, GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_FALSE(context_->renderer().empty());
    EXPECT_THAT(context_->version(), HasSubstr("."));
    EXPECT_EQ(context_->backend(), GetParam());
}

TEST_P(ContextTest, KnowsLlvmpipeAsSoftware) {
    const bool llvmpipe = context_->renderer().find("llvmpipe") != std::string::npos;
    EXPECT_TRUE(!llvmpipe || context_->isSoftware()) << context_->renderer();
}

TEST_P(ContextTest, CanBeMadeManyTimes) {
    for (int i = 0; i < 20; ++i) {
        context_.reset();
        context_ = createOffscreenContext(GetParam());
        const Buffer buffer("probe", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
        EXPECT_EQ(glIsBuffer(buffer.get()), GL_TRUE);
    }
}

TEST_P(ContextTest, ObjectsMayOutliveTheLastContext) {
    Buffer buffer("late", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    const Texture2D texture("late", GL_RGBA8, 4, 4);
    context_.reset();
}

QX_ON_BOTH_BACKENDS(ContextTest);

/// Colour of a texture cleared to `red`, made, drawn and read on the current context.
std::uint8_t clearedRed(float red) {
    const Texture2D texture("probe", GL_RGBA8, 2, 2);
    const Texture2D* colors[] = {&texture};
    const Framebuffer framebuffer("probe", colors, nullptr);
    framebuffer.bind();
    glClearColor(red, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    return readPixels8(texture).data[0];
}

TEST(Contexts, OfDifferentLibrariesFollowEachOther) {
    for (const Backend backend : {Backend::osmesa, Backend::egl, Backend::egl, Backend::osmesa}) {
        const auto context = createOffscreenContext(backend);
        EXPECT_EQ(clearedRed(0.6f), 153) << backendName(backend);
    }
}

TEST(Contexts, OfDifferentLibrariesTakeTurns) {
    const auto osmesa = createOffscreenContext(Backend::osmesa);
    const Buffer first("first", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    const auto egl = createOffscreenContext(Backend::egl);
    EXPECT_EQ(glIsBuffer(first.get()), GL_FALSE) << "a new context shares nothing";
    EXPECT_EQ(clearedRed(0.2f), 51);
    for (int i = 0; i < 3; ++i) {
        osmesa->makeCurrent();
        EXPECT_EQ(glIsBuffer(first.get()), GL_TRUE);
        EXPECT_EQ(clearedRed(0.4f), 102);
        egl->makeCurrent();
        EXPECT_EQ(glIsBuffer(first.get()), GL_FALSE);
        EXPECT_EQ(clearedRed(0.8f), 204);
    }
    osmesa->makeCurrent();
}

TEST(Contexts, AutomaticIsEglWhereThereIsOne) {
    EXPECT_EQ(createOffscreenContext(Backend::automatic)->backend(), Backend::egl);
}

TEST(Contexts, AWindowIsNoOffscreenBackend) {
    EXPECT_THAT(messageOf<InputError>([] { createOffscreenContext(Backend::window); }),
                HasSubstr("offscreen backend"));
}

TEST(Backend, NamesAreReadAndWritten) {
    for (const Backend backend : {Backend::automatic, Backend::osmesa, Backend::egl, Backend::window})
        EXPECT_EQ(parseBackend(backendName(backend)), backend);
    EXPECT_EQ(parseBackend("auto"), Backend::automatic);
    EXPECT_THAT(messageOf<InputError>([] { parseBackend("vulkan"); }),
                AllOf(HasSubstr("\"vulkan\""), HasSubstr("auto, osmesa, egl or window")));
}

}  // namespace
}  // namespace quincunx::gl

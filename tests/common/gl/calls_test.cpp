#include "gl/calls.h"

#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::HasSubstr;
using testing::Pair;
using testing::StartsWith;
using testing::UnorderedElementsAre;

class CallsTest : public test::OnBackend {};

TEST_P(CallsTest, AreCountedOneByOne) {
    const std::uint64_t before = callCount();
    glViewport(0, 0, 1, 1);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_DEPTH_TEST);
    glGetError();
    EXPECT_EQ(callCount() - before, 4u);
}

TEST_P(CallsTest, AreCountedByName) {
    const CallRecorder outer;
    {
        const CallRecorder inner;
        glEnable(GL_BLEND);
        glEnable(GL_DEPTH_TEST);
        glViewport(0, 0, 1, 1);
        EXPECT_THAT(inner.calls(), UnorderedElementsAre(Pair("glEnable", 2u), Pair("glViewport", 1u)));
    }
    glDisable(GL_BLEND);
    EXPECT_THAT(outer.calls(),
                UnorderedElementsAre(Pair("glEnable", 2u), Pair("glViewport", 1u), Pair("glDisable", 1u)));
}

TEST_P(CallsTest, AnErrorNamesCallAndError) {
    EXPECT_THAT(messageOf<GlError>([] { glEnable(0x1234); }), StartsWith("glEnable: GL_INVALID_ENUM"));
    EXPECT_THAT(messageOf<GlError>([] { glViewport(0, 0, -1, 1); }),
                StartsWith("glViewport: GL_INVALID_VALUE"));
    EXPECT_THAT(messageOf<GlError>([] { glBindFramebuffer(GL_FRAMEBUFFER, 4242); }),
                StartsWith("glBindFramebuffer: GL_INVALID_OPERATION"))
        << "the name was never generated";
}

TEST_P(CallsTest, AnErrorIsForgottenOnceThrown) {
    EXPECT_THROW(glEnable(0x1234), GlError);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    EXPECT_NO_THROW(glEnable(GL_BLEND));
}

TEST_P(CallsTest, WhatTheDriverSaysIsInTheMessage) {
    ASSERT_NE(GLAD_GL_KHR_debug, 0);
    // Mesa's own words for this error repeat the bad value.
    EXPECT_THAT(messageOf<GlError>([] { glEnable(0x1234); }), HasSubstr("0x1234"));
}

TEST_P(CallsTest, DebugMessagesOfTypeErrorOrSeverityHighAreErrors) {
    ASSERT_NE(GLAD_GL_KHR_debug, 0);
    const auto insert = [](GLenum type, GLenum severity) {
        glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, type, 7, severity, -1, "made up\n");
    };
    EXPECT_EQ(messageOf<GlError>([&] { insert(GL_DEBUG_TYPE_ERROR, GL_DEBUG_SEVERITY_MEDIUM); }),
              "glDebugMessageInsert: made up");
    EXPECT_EQ(messageOf<GlError>([&] { insert(GL_DEBUG_TYPE_PERFORMANCE, GL_DEBUG_SEVERITY_HIGH); }),
              "glDebugMessageInsert: made up");
    EXPECT_NO_THROW(insert(GL_DEBUG_TYPE_PERFORMANCE, GL_DEBUG_SEVERITY_MEDIUM));
    EXPECT_NO_THROW(insert(GL_DEBUG_TYPE_OTHER, GL_DEBUG_SEVERITY_NOTIFICATION));
}

TEST_P(CallsTest, AFunctionTheDriverLacksIsAnErrorNotACrash) {
    const auto function = glad_glViewport;
    glad_glViewport = nullptr;
    const std::string message = messageOf<GlError>([] { glViewport(0, 0, 1, 1); });
    glad_glViewport = function;
    EXPECT_THAT(message, StartsWith("glViewport: the driver does not have"));
}

TEST_P(CallsTest, DestructorsDoNotThrow) {
    { const Handle<DeleteProgram> bogus(424242); }
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    EXPECT_NO_THROW(glEnable(GL_BLEND)) << "the error must not show up at another call";
}

QX_ON_BOTH_BACKENDS(CallsTest);

TEST(GlError, EndsTheProgramAsNotPossibleHere) {
    EXPECT_EQ(GlError("x").exitStatus(), ExitStatus::notPossibleHere);
}

}  // namespace
}  // namespace quincunx::gl

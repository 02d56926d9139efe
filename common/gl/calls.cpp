#include "gl/calls.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <glad/gl.h>

namespace quincunx::gl {
namespace {

std::uint64_t calls = 0;
std::vector<std::map<std::string, std::uint64_t>*> recorders;
bool messagePending = false;
std::string pendingMessage;

std::string errorName(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        default:
            return fmt::format("GL error {:#06x}", error);
    }
}

/// Forgets further errors too, so that the next call starts clean; bounded, because a lost context reports
/// errors without end.
[[noreturn]] void fail(const char* name, GLenum error) {
    for (int i = 0; i < 8 && error != GL_NO_ERROR && glad_glGetError() != GL_NO_ERROR; ++i) {
    }
    std::string message = std::move(pendingMessage);
    pendingMessage.clear();
    messagePending = false;
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.pop_back();
    std::string what = error == GL_NO_ERROR ? "" : errorName(error);
    if (!message.empty())
        what += (what.empty() ? "" : ": ") + printable(message, 1000);
    throw GlError(what, name, error == GL_OUT_OF_MEMORY ? "use a smaller picture or model" : "");
}

void beforeCall(const char* name, GLADapiproc function, int /*argumentCount*/, ...) {
    if (function == nullptr)
        throw GlError("the driver does not have this function", name);
}

void afterCall(void* /*result*/, const char* name, GLADapiproc function, int /*argumentCount*/, ...) {
    ++calls;
    for (auto* recorder : recorders)
        ++(*recorder)[name];
    if (function == reinterpret_cast<GLADapiproc>(glad_glGetError))
        return;
    const GLenum error = glad_glGetError();
    if (error != GL_NO_ERROR || messagePending) [[unlikely]]
        fail(name, error);
}

/// Messages of the shader compiler are left to glGetShaderInfoLog, which has all of them.
void GLAD_API_PTR takeMessage(GLenum source, GLenum type, GLuint /*id*/, GLenum severity, GLsizei length,
                              const GLchar* message, const void* /*user*/) {
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER || messagePending)
        return;
    if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH)
        return;
    messagePending = true;
    pendingMessage =
        length < 0 ? std::string(message) : std::string(message, static_cast<std::size_t>(length));
}

}  // namespace

void watchCalls() {
    gladSetGLPreCallback(beforeCall);
    gladSetGLPostCallback(afterCall);
    gladInstallGLDebug();
    messagePending = false;
    if (GLAD_GL_KHR_debug != 0) {
        glad_glEnable(GL_DEBUG_OUTPUT);
        glad_glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glad_glDebugMessageCallback(takeMessage, nullptr);
        glad_glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr,
                                   GL_FALSE);
    }
}

std::uint64_t callCount() {
    return calls;
}

CallRecorder::CallRecorder() {
    recorders.push_back(&calls_);
}

CallRecorder::~CallRecorder() {
    std::erase(recorders, &calls_);
}

}  // namespace quincunx::gl

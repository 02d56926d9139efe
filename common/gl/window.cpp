#include "gl/window.h"

#include <cstdlib>
#include <string>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "base/error.h"
#include "gl/backends.h"

namespace quincunx::gl {
namespace {

std::string lastFault;
int windowCount = 0;

void rememberFault(int /*code*/, const char* message) {
    lastFault = message == nullptr ? "" : message;
}

bool displayNamed() {
    for (const char* name : {"WAYLAND_DISPLAY", "DISPLAY"})
        if (const char* value = std::getenv(name); value != nullptr && *value != '\0')
            return true;
    return false;
}

EnvironmentError windowFault(std::string_view what) {
    std::string line(what);
    if (!lastFault.empty())
        line += ": " + printable(lastFault);
    return EnvironmentError(line, "backend window", "a window needs a display: use --backend egl");
}

}  // namespace

Window::Window(std::string_view title, int widthScreen, int heightScreen) {
    lastFault.clear();
    if (!displayNamed())
        throw windowFault("neither DISPLAY nor WAYLAND_DISPLAY is set");
    if (widthScreen < 1 || heightScreen < 1)
        throw InputError("a window needs a size of at least 1×1", "window", "make it larger");
    glfwSetErrorCallback(rememberFault);
    if (windowCount == 0 && glfwInit() == GLFW_FALSE)
        throw windowFault("GLFW cannot start");
    ++windowCount;
    try {
        glfwDefaultWindowHints();
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        glfwWindowHint(GLFW_DEPTH_BITS, 0);
        glfwWindowHint(GLFW_STENCIL_BITS, 0);
        window_ = glfwCreateWindow(widthScreen, heightScreen, std::string(title).c_str(), nullptr, nullptr);
        if (window_ == nullptr)
            throw windowFault("no window with OpenGL 3.3");
        makeCurrent();
        glfwSwapInterval(1);
    } catch (...) {
        if (window_ != nullptr)
            glfwDestroyWindow(window_);
        if (--windowCount == 0)
            glfwTerminate();
        throw;
    }
}

Window::~Window() {
    detail::release(*this);
    glfwDestroyWindow(window_);
    if (--windowCount == 0)
        glfwTerminate();
}

void Window::makeCurrent() {
    detail::makeCurrent(*this, {.bind =
                                    [this] {
                                        glfwMakeContextCurrent(window_);
                                        if (glfwGetCurrentContext() != window_)
                                            throw windowFault("the context cannot be made current");
                                    },
                                .unbind = [] { glfwMakeContextCurrent(nullptr); },
                                .getProcAddress = glfwGetProcAddress});
}

glm::ivec2 Window::framebufferSize() const {
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
}

glm::ivec2 Window::screenSize() const {
    glm::ivec2 size(0);
    glfwGetWindowSize(window_, &size.x, &size.y);
    return size;
}

float Window::contentScale() const {
    float x = 1;
    float y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x;
}

bool Window::shouldClose() const {
    return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::swapBuffers() {
    glfwSwapBuffers(window_);
}

void Window::pollEvents() {
    glfwPollEvents();
}

bool displayAvailable() {
    if (!displayNamed())
        return false;
    if (windowCount > 0)
        return true;
    glfwSetErrorCallback(rememberFault);
    // Stays started for the window to come: a server that resets when its last client leaves may be out of
    // reach for a moment after.
    return glfwInit() == GLFW_TRUE;
}

}  // namespace quincunx::gl

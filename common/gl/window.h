#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include <glm/glm.hpp>

#include "gl/context.h"

struct GLFWwindow;

namespace quincunx::gl {

/// A GLFW window with a current context. Sizes are told in both units: screen coordinates, in which the mouse
/// moves, and framebuffer pixels, in which OpenGL draws; on high-DPI displays they differ.
class Window final : public Context {
  public:
    /// Throws EnvironmentError when there is no display or no OpenGL 3.3 on it.
    Window(std::string_view title, int widthScreen, int heightScreen);
    ~Window() override;

    Backend backend() const override { return Backend::window; }
    void makeCurrent() override;

    GLFWwindow* glfw() const { return window_; }
    glm::ivec2 framebufferSize() const;  ///< pixels
    glm::ivec2 screenSize() const;       ///< screen coordinates
    float contentScale() const;          ///< of the monitor: 1 at 96 dpi, 2 on a "retina" display
    bool shouldClose() const;
    void swapBuffers();
    void pollEvents();

  private:
    GLFWwindow* window_ = nullptr;
};

/// True when DISPLAY or WAYLAND_DISPLAY names a display and it answers.
bool displayAvailable();

}  // namespace quincunx::gl

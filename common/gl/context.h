#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace quincunx::gl {

/// Where pictures are drawn. `automatic` is, for an offscreen picture, EGL and then OSMesa.
enum class Backend { automatic, osmesa, egl, window };

/// "auto", "osmesa", "egl" or "window"; anything else is an InputError that lists them.
Backend parseBackend(std::string_view name);
std::string_view backendName(Backend backend);

/// A current OpenGL 3.3 core context, with its functions loaded, GL calls counted and GL errors turned into
/// exceptions (gl/calls.h). One context at a time is current; destruction releases it.
class Context {
  public:
    virtual ~Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    virtual Backend backend() const = 0;
    virtual void makeCurrent() = 0;

    /// "llvmpipe (LLVM 15.0.6, 256 bits)" and the like, as GL_RENDERER says.
    std::string renderer() const;
    /// As GL_VERSION says.
    std::string version() const;
    /// True where timer queries cover only part of the work, so that time is taken around glFinish.
    bool isSoftware() const;

  protected:
    Context() = default;
};

/// A context without a display. Libraries are loaded when asked for, so the program starts without them.
/// Throws EnvironmentError naming the package to install when the backend (with `automatic`: every backend)
/// cannot be had. `Backend::window` is not an offscreen backend: InputError.
std::unique_ptr<Context> createOffscreenContext(Backend backend);

}  // namespace quincunx::gl

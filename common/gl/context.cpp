#include "gl/context.h"

#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "gl/backends.h"
#include "gl/bindings.h"
#include "gl/calls.h"

namespace quincunx::gl {
namespace {

const Context* currentContext = nullptr;
std::function<void()> unbindCurrent;

void unbindWhatIsCurrent() {
    if (currentContext != nullptr)
        unbindCurrent();
    currentContext = nullptr;
    detail::forgetBindings();
}

std::string stringOf(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

}  // namespace

namespace detail {

void makeCurrent(const Context& context, const Binding& binding) {
    if (currentContext == &context)
        return;
    unbindWhatIsCurrent();
    binding.bind();
    const int version = gladLoadGL(binding.getProcAddress);
    const int major = GLAD_VERSION_MAJOR(version);
    const int minor = GLAD_VERSION_MINOR(version);
    if (major * 10 + minor < 33) {
        binding.unbind();
        throw EnvironmentError(fmt::format("the driver has OpenGL {}.{}, 3.3 is needed", major, minor),
                               backendName(context.backend()), "use another --backend or a newer driver");
    }
    currentContext = &context;
    unbindCurrent = binding.unbind;
    watchCalls();
}

void release(const Context& context) {
    if (currentContext == &context)
        unbindWhatIsCurrent();
}

bool anyCurrent() {
    return currentContext != nullptr;
}

}  // namespace detail

Backend parseBackend(std::string_view name) {
    for (const Backend backend : {Backend::automatic, Backend::osmesa, Backend::egl, Backend::window})
        if (name == backendName(backend))
            return backend;
    throw InputError(fmt::format("unknown backend \"{}\"", printable(name, 40)), "--backend",
                     "choose auto, osmesa, egl or window");
}

std::string_view backendName(Backend backend) {
    switch (backend) {
        case Backend::osmesa:
            return "osmesa";
        case Backend::egl:
            return "egl";
        case Backend::window:
            return "window";
        case Backend::automatic:
            break;
    }
    return "auto";
}

std::string Context::renderer() const {
    return stringOf(GL_RENDERER);
}

std::string Context::version() const {
    return stringOf(GL_VERSION);
}

bool Context::isSoftware() const {
    const std::string name = renderer();
    static constexpr std::array<std::string_view, 4> softwareNames = {"llvmpipe", "softpipe", "swrast",
                                                                      "Software"};
    for (const std::string_view software : softwareNames)
        if (name.find(software) != std::string::npos)
            return true;
    return false;
}

std::unique_ptr<Context> createOffscreenContext(Backend backend) {
    switch (backend) {
        case Backend::osmesa:
            return detail::createOsmesaContext();
        case Backend::egl:
            return detail::createEglContext();
        case Backend::window:
            throw InputError("a window is no offscreen backend", "--backend", "choose auto, osmesa or egl");
        case Backend::automatic:
            break;
    }
    std::string eglFault;
    try {
        return detail::createEglContext();
    } catch (const EnvironmentError& error) {
        eglFault = error.what();
    }
    try {
        return detail::createOsmesaContext();
    } catch (const EnvironmentError& error) {
        throw EnvironmentError(fmt::format("no offscreen backend: {}; {}", eglFault, error.what()));
    }
}

}  // namespace quincunx::gl

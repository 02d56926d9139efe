#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include "base/error.h"
#include "gl/backends.h"

namespace quincunx::gl {
namespace {

constexpr std::string_view remedy =
    "install the packages libegl1 and libgl1-mesa-dri, or use --backend osmesa";

struct EglLibrary {
    decltype(&eglGetProcAddress) getProcAddress = nullptr;
    decltype(&eglQueryString) queryString = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bindApi = nullptr;
    decltype(&eglChooseConfig) chooseConfig = nullptr;
    decltype(&eglCreateContext) createContext = nullptr;
    decltype(&eglDestroyContext) destroyContext = nullptr;
    decltype(&eglCreatePbufferSurface) createPbufferSurface = nullptr;
    decltype(&eglDestroySurface) destroySurface = nullptr;
    decltype(&eglMakeCurrent) makeCurrent = nullptr;
    decltype(&eglReleaseThread) releaseThread = nullptr;
    decltype(&eglGetError) getError = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC getPlatformDisplay = nullptr;
    PFNEGLQUERYDEVICESEXTPROC queryDevices = nullptr;            ///< null without EGL_EXT_device_enumeration
    PFNEGLQUERYDEVICESTRINGEXTPROC queryDeviceString = nullptr;  ///< null without EGL_EXT_device_query
    std::string clientExtensions;
};

bool hasExtension(std::string_view list, std::string_view extension) {
    for (std::size_t at = list.find(extension); at != std::string_view::npos;
         at = list.find(extension, at + 1)) {
        const std::size_t end = at + extension.size();
        if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ' '))
            return true;
    }
    return false;
}

std::string_view orEmpty(const char* text) {
    return text == nullptr ? std::string_view() : std::string_view(text);
}

/// Loaded once and kept: drivers don't stand being unloaded.
const EglLibrary& egl() {
    static const EglLibrary library = [] {
        void* handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (handle == nullptr)
            throw EnvironmentError("libEGL is not installed", "backend egl", remedy);
        EglLibrary functions;
        const auto find = [handle](const char* symbol, auto& function) {
            detail::findSymbol(handle, symbol, function, "libEGL", remedy);
        };
        find("eglGetProcAddress", functions.getProcAddress);
        find("eglQueryString", functions.queryString);
        find("eglInitialize", functions.initialize);
        find("eglBindAPI", functions.bindApi);
        find("eglChooseConfig", functions.chooseConfig);
        find("eglCreateContext", functions.createContext);
        find("eglDestroyContext", functions.destroyContext);
        find("eglCreatePbufferSurface", functions.createPbufferSurface);
        find("eglDestroySurface", functions.destroySurface);
        find("eglMakeCurrent", functions.makeCurrent);
        find("eglReleaseThread", functions.releaseThread);
        find("eglGetError", functions.getError);
        functions.clientExtensions = orEmpty(functions.queryString(EGL_NO_DISPLAY, EGL_EXTENSIONS));
        const auto load = [&]<typename F>(const char* name, F& function) {
            function = reinterpret_cast<F>(functions.getProcAddress(name));
        };
        load("eglGetPlatformDisplayEXT", functions.getPlatformDisplay);
        if (functions.getPlatformDisplay == nullptr)
            throw EnvironmentError("this libEGL has no platform displays", "backend egl", remedy);
        load("eglQueryDevicesEXT", functions.queryDevices);
        load("eglQueryDeviceStringEXT", functions.queryDeviceString);
        return functions;
    }();
    return library;
}

/// One place to look for a driver.
struct Candidate {
    EGLenum platform = 0;
    void* native = EGL_DEFAULT_DISPLAY;
    std::string name;
};

/// Hardware devices first, then the platform without surfaces (which takes the default device), then devices
/// in software.
std::vector<Candidate> candidates() {
    std::vector<Candidate> hardware;
    std::vector<Candidate> software;
    const std::string& client = egl().clientExtensions;
    if (hasExtension(client, "EGL_EXT_platform_device") && egl().queryDevices != nullptr) {
        std::array<EGLDeviceEXT, 32> devices{};
        EGLint count = 0;
        if (egl().queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_FALSE)
            count = 0;
        for (EGLint i = 0; i < count; ++i) {
            EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
            const bool isSoftware = egl().queryDeviceString != nullptr &&
                                    hasExtension(orEmpty(egl().queryDeviceString(device, EGL_EXTENSIONS)),
                                                 "EGL_MESA_device_software");
            (isSoftware ? software : hardware)
                .push_back({EGL_PLATFORM_DEVICE_EXT, device, fmt::format("device {}", i)});
        }
    }
    std::vector<Candidate> all = std::move(hardware);
    if (hasExtension(client, "EGL_MESA_platform_surfaceless"))
        all.push_back({EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, "surfaceless"});
    all.insert(all.end(), software.begin(), software.end());
    return all;
}

std::string eglFault(std::string_view call) {
    return fmt::format("{} failed with EGL error {:#06x}", call, egl().getError());
}

class EglContext final : public Context {
  public:
    explicit EglContext(const Candidate& candidate) {
        try {
            create(candidate);
            makeCurrent();
        } catch (...) {
            destroy();
            throw;
        }
    }

    ~EglContext() override { destroy(); }

    Backend backend() const override { return Backend::egl; }

    void makeCurrent() override {
        detail::makeCurrent(
            *this, {.bind =
                        [this] {
                            if (egl().bindApi(EGL_OPENGL_API) == EGL_FALSE ||
                                egl().makeCurrent(display_, surface_, surface_, context_) == EGL_FALSE)
                                throw EnvironmentError(eglFault("eglMakeCurrent"), "backend egl", remedy);
                        },
                    .unbind =
                        [display = display_] {
                            egl().makeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
                            egl().releaseThread();
                        },
                    .getProcAddress = egl().getProcAddress});
    }

  private:
    /// The display stays initialised to the end of the process: others may use the same one.
    void create(const Candidate& candidate) {
        display_ = egl().getPlatformDisplay(candidate.platform, candidate.native, nullptr);
        if (display_ == EGL_NO_DISPLAY)
            throw EnvironmentError(eglFault("eglGetPlatformDisplay"));
        if (egl().initialize(display_, nullptr, nullptr) == EGL_FALSE)
            throw EnvironmentError(eglFault("eglInitialize"));
        if (egl().bindApi(EGL_OPENGL_API) == EGL_FALSE)
            throw EnvironmentError("the driver has OpenGL ES only");
        const std::string_view extensions = orEmpty(egl().queryString(display_, EGL_EXTENSIONS));
        const bool surfaceless = hasExtension(extensions, "EGL_KHR_surfaceless_context");
        EGLConfig config = EGL_NO_CONFIG_KHR;
        if (!surfaceless || !hasExtension(extensions, "EGL_KHR_no_config_context")) {
            const std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, surfaceless ? 0 : EGL_PBUFFER_BIT,
                                                  EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
            EGLint count = 0;
            if (egl().chooseConfig(display_, wanted.data(), &config, 1, &count) == EGL_FALSE || count < 1)
                throw EnvironmentError("no configuration for OpenGL");
        }
        constexpr std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                      3,
                                                      EGL_CONTEXT_MINOR_VERSION,
                                                      3,
                                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                      EGL_NONE};
        context_ = egl().createContext(display_, config, EGL_NO_CONTEXT, attributes.data());
        if (context_ == EGL_NO_CONTEXT)
            throw EnvironmentError(
                fmt::format("no OpenGL 3.3 core context: {}", eglFault("eglCreateContext")));
        if (!surfaceless) {
            constexpr std::array<EGLint, 5> size = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
            surface_ = egl().createPbufferSurface(display_, config, size.data());
            if (surface_ == EGL_NO_SURFACE)
                throw EnvironmentError(eglFault("eglCreatePbufferSurface"));
        }
    }

    void destroy() {
        detail::release(*this);
        if (surface_ != EGL_NO_SURFACE)
            egl().destroySurface(display_, surface_);
        if (context_ != EGL_NO_CONTEXT)
            egl().destroyContext(display_, context_);
    }

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;
};

}  // namespace

std::unique_ptr<Context> detail::createEglContext() {
    /// The candidate that worked; found again at once for the process' next context.
    static std::optional<Candidate> known;
    if (known)
        return std::make_unique<EglContext>(*known);
    std::string faults;
    for (const Candidate& candidate : candidates()) {
        try {
            auto context = std::make_unique<EglContext>(candidate);
            known = candidate;
            return context;
        } catch (const EnvironmentError& error) {
            faults += fmt::format("{}{}: {}", faults.empty() ? "" : ", ", candidate.name, error.what());
        }
    }
    throw EnvironmentError(faults.empty() ? "no driver without a display" : faults, "backend egl", remedy);
}

}  // namespace quincunx::gl

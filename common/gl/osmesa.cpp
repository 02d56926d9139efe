#include <array>
#include <cstdint>

#include "base/error.h"
#include "gl/backends.h"

namespace quincunx::gl {
namespace {

constexpr int osmesaFormat = 0x22;
constexpr int osmesaProfile = 0x33;
constexpr int osmesaCoreProfile = 0x34;
constexpr int osmesaContextMajorVersion = 0x36;
constexpr int osmesaContextMinorVersion = 0x37;

/// libOSMesa's functions, as documented in Mesa's GL/osmesa.h.
struct OsmesaLibrary {
    using OsContext = struct OpaqueOsContext*;
    OsContext (*createContextAttribs)(const int* attributes, OsContext shared) = nullptr;
    void (*destroyContext)(OsContext) = nullptr;
    GLboolean (*makeCurrent)(OsContext, void* buffer, GLenum type, GLsizei width, GLsizei height) = nullptr;
    GLADapiproc (*getProcAddress)(const char* name) = nullptr;
};

/// Loaded once and kept: drivers don't stand being unloaded.
const OsmesaLibrary& osmesa() {
    static const OsmesaLibrary library = [] {
        void* handle = nullptr;
        for (const char* file : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"})
            if (handle == nullptr)
                handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
        if (handle == nullptr)
            throw EnvironmentError("libOSMesa is not installed", "backend osmesa",
                                   "install the package libosmesa6");
        OsmesaLibrary functions;
        const auto find = [handle](const char* symbol, auto& function) {
            detail::findSymbol(handle, symbol, function, "libOSMesa",
                               "install libosmesa6 of Mesa 11.2 or newer");
        };
        find("OSMesaCreateContextAttribs", functions.createContextAttribs);
        find("OSMesaDestroyContext", functions.destroyContext);
        find("OSMesaMakeCurrent", functions.makeCurrent);
        find("OSMesaGetProcAddress", functions.getProcAddress);
        return functions;
    }();
    return library;
}

GLADapiproc osmesaFunction(const char* name) {
    return osmesa().getProcAddress(name);
}

class OsmesaContext final : public Context {
  public:
    OsmesaContext() {
        constexpr std::array<int, 9> attributes = {osmesaFormat,
                                                   GL_RGBA,
                                                   osmesaProfile,
                                                   osmesaCoreProfile,
                                                   osmesaContextMajorVersion,
                                                   3,
                                                   osmesaContextMinorVersion,
                                                   3,
                                                   0};
        context_ = osmesa().createContextAttribs(attributes.data(), nullptr);
        if (context_ == nullptr)
            throw EnvironmentError("libOSMesa has no OpenGL 3.3 core context", "backend osmesa",
                                   "use --backend egl");
        try {
            makeCurrent();
        } catch (...) {
            osmesa().destroyContext(context_);
            throw;
        }
    }

    ~OsmesaContext() override {
        detail::release(*this);
        osmesa().destroyContext(context_);
    }

    Backend backend() const override { return Backend::osmesa; }

    void makeCurrent() override {
        detail::makeCurrent(*this,
                            {.bind =
                                 [this] {
                                     if (osmesa().makeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE,
                                                              side, side) == GL_FALSE)
                                         throw EnvironmentError("OSMesaMakeCurrent failed", "backend osmesa",
                                                                "use --backend egl");
                                 },
                             .unbind = [] { osmesa().makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); },
                             .getProcAddress = osmesaFunction});
    }

  private:
    static constexpr int side = 4;  ///< of the default framebuffer, which nothing is drawn into
    OsmesaLibrary::OsContext context_ = nullptr;
    std::array<std::uint8_t, side * side * 4> buffer_{};
};

}  // namespace

std::unique_ptr<Context> detail::createOsmesaContext() {
    return std::make_unique<OsmesaContext>();
}

}  // namespace quincunx::gl

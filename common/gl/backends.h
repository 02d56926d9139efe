#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <dlfcn.h>
#include <glad/gl.h>

#include "base/error.h"
#include "gl/context.h"

/// What the kinds of contexts share among themselves; users of contexts include gl/context.h.
namespace quincunx::gl::detail {

/// How a context is bound to the thread.
struct Binding {
    std::function<void()> bind;    ///< throws EnvironmentError on failure
    std::function<void()> unbind;  ///< must not throw
    GLADloadfunc getProcAddress = nullptr;
};

/// Unbinds what was current, binds `context`, loads its functions and watches its calls. Contexts of
/// different libraries follow each other safely, because one is unbound before the other is bound. Throws
/// EnvironmentError, with no context left current, if it is older than 3.3.
void makeCurrent(const Context& context, const Binding& binding);

/// Unbinds `context` if it is current.
void release(const Context& context);

/// True while any context is current; objects that die without one are left to their context's end.
bool anyCurrent();

/// Sets `function` to a symbol of a library that dlopen gave; throws EnvironmentError if it has none.
template <typename Function>
void findSymbol(void* library, const char* symbol, Function& function, const char* libraryName,
                std::string_view remedy) {
    function = reinterpret_cast<Function>(dlsym(library, symbol));
    if (function == nullptr)
        throw EnvironmentError(std::string("this ") + libraryName + " is too old", symbol, remedy);
}

std::unique_ptr<Context> createOsmesaContext();
std::unique_ptr<Context> createEglContext();

}  // namespace quincunx::gl::detail

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "gl/context.h"
#include "gl/objects.h"
#include "graph/graph.h"

namespace quincunx::gl::test {

/// The message of the error of this very kind that `action` throws.
template <typename Kind>
std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Kind& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("another kind of error: ") + error.what();
    }
    return "no error";
}

/// A test with a current context; instantiated for OSMesa and for EGL, and failing where either is missing.
class OnBackend : public testing::TestWithParam<Backend> {
  protected:
    OnBackend() : context_(createOffscreenContext(GetParam())) {}

    std::unique_ptr<Context> context_;
};

inline std::string nameOfBackend(const testing::TestParamInfo<Backend>& info) {
    return std::string(backendName(info.param));
}

/// An asset root of its own with the folder shaders/, for the time of its life.
class ShaderFolder {
  public:
    ShaderFolder();
    ~ShaderFolder();
    ShaderFolder(const ShaderFolder&) = delete;
    ShaderFolder& operator=(const ShaderFolder&) = delete;

    /// Writes shaders/`name`, with a modification time later than that of any write before.
    void write(std::string_view name, std::string_view text);
    void remove(std::string_view name);
    std::filesystem::path root() const { return root_; }

  private:
    std::filesystem::path root_;
    std::string rootBefore_;
    int writes_ = 0;
};

/// A vertex shader that covers the target with one triangle from gl_VertexID alone.
extern const std::string_view coverVertexShader;

/// Draws a fragment shader over the whole target that is bound, with an empty vertex array of its own.
void cover();

}  // namespace quincunx::gl::test

#define QX_ON_BOTH_BACKENDS(suite)                                                                       \
    INSTANTIATE_TEST_SUITE_P(On, suite,                                                                  \
                             testing::Values(quincunx::gl::Backend::osmesa, quincunx::gl::Backend::egl), \
                             quincunx::gl::test::nameOfBackend)

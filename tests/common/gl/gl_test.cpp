#include "tests/common/gl/gl_test.h"

#include <chrono>
#include <cstdlib>
#include <system_error>

#include <unistd.h>

#include "base/file.h"

namespace quincunx::gl::test {
namespace fs = std::filesystem;

const std::string_view coverVertexShader = R"(#version 330 core
void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1);
}
)";

ShaderFolder::ShaderFolder() {
    std::string name = (fs::temp_directory_path() / "quincunx-shaders-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
        throw EnvironmentError("cannot make a temporary folder", name);
    root_ = name;
    fs::create_directory(root_ / "shaders");
    if (const char* before = std::getenv("QUINCUNX_ROOT"))
        rootBefore_ = before;
    setenv("QUINCUNX_ROOT", root_.c_str(), 1);
}

ShaderFolder::~ShaderFolder() {
    if (rootBefore_.empty())
        unsetenv("QUINCUNX_ROOT");
    else
        setenv("QUINCUNX_ROOT", rootBefore_.c_str(), 1);
    std::error_code ignored;
    fs::remove_all(root_, ignored);
}

void ShaderFolder::write(std::string_view name, std::string_view text) {
    const fs::path file = root_ / "shaders" / name;
    writeFile(file, text);
    fs::last_write_time(file, fs::file_time_type::clock::now() + std::chrono::seconds(++writes_));
}

void ShaderFolder::remove(std::string_view name) {
    fs::remove(root_ / "shaders" / name);
}

void cover() {
    const VertexArray nothing("nothing");
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace quincunx::gl::test

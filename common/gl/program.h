#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "gl/objects.h"

namespace quincunx::gl {

/// A shader did not compile or link: "shaders/labs/10_shading/phong.frag:12: what the compiler said".
class ShaderError : public Error {
  public:
    using Error::Error;
};

/// GLSL as its author wrote it: files under shaders/, pulled together by `#include "path/from/shaders.glsl"`
/// (relative to the including file first, then to shaders/). Each file is included once. Cycles, depth over
/// 32, a total over 4 MiB, missing files, and `#version` other than 330 core are ShaderErrors with file and
/// line.
struct ShaderSource {
    std::string text;                          ///< what the compiler gets, with #line directives
    std::vector<std::filesystem::path> files;  ///< indexed by the source-string numbers of those #lines
};
ShaderSource loadShader(const std::filesystem::path& file,
                        const std::vector<std::pair<std::string, std::string>>& defines = {});

/// The driver's log with its "0:12(3): error" places turned into "file:line: ".
std::string authorsLog(std::string_view driverLog, const ShaderSource& source);

/// Which files make a program and which `#define`s they see.
struct ProgramFiles {
    std::string label;
    std::string vertex;    ///< relative to shaders/
    std::string fragment;  ///< relative to shaders/
    std::string geometry;  ///< empty: none
    std::vector<std::pair<std::string, std::string>> defines;
};

/// A linked program. Uniforms are set by name; a name that the program does not have active is a GlError
/// when `required`, else ignored; a value of another type than the uniform's is a GlError.
class Program {
  public:
    Program() = default;
    /// Throws ShaderError with the author's file and line.
    explicit Program(ProgramFiles files);

    void use() const;
    void set(std::string_view name, int value) const;
    void set(std::string_view name, float value) const;
    void set(std::string_view name, const glm::vec2& value) const;
    void set(std::string_view name, const glm::vec3& value) const;
    void set(std::string_view name, const glm::vec4& value) const;
    void set(std::string_view name, const glm::mat3& value) const;
    void set(std::string_view name, const glm::mat4& value) const;
    bool has(std::string_view name) const;

    /// Builds again if a source file changed since. Returns false when nothing changed. A broken edit throws
    /// ShaderError and keeps the last good program.
    bool reloadIfChanged();
    const ProgramFiles& files() const { return files_; }
    GLuint get() const { return handle_.get(); }

  private:
    struct Uniform {
        std::string name;
        GLint location = -1;
        GLenum type = 0;
    };
    const Uniform* find(std::string_view name) const;

    ProgramFiles files_;
    std::vector<std::pair<std::filesystem::path, std::filesystem::file_time_type>> sources_;
    std::vector<Uniform> uniforms_;  ///< sorted by name
    Handle<DeleteProgram> handle_;
};

/// Programs by their files and defines: each is built once; all are reloaded together.
class ProgramCache {
  public:
    /// Builds the program the first time it is asked for.
    const Program& get(const ProgramFiles& files);
    /// Rebuilds what changed on disk. Returns the message of the first broken edit, or nothing.
    std::optional<std::string> reloadChanged();
    std::size_t size() const { return programs_.size(); }

  private:
    std::vector<std::unique_ptr<Program>> programs_;
};

}  // namespace quincunx::gl

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "gl/objects.h"

namespace quincunx::gl {

/// A shader did not compile or link: "shaders/passes/phong.frag:12: what the compiler said".
class ShaderError : public Error {
  public:
    using Error::Error;
};

/// GLSL as its author wrote it: files under shaders/, pulled together by `#include "path/from/shaders.glsl"`
/// (relative to the including file first, then to shaders/). Each file is included once, so that it needs no
/// guards, and outside `#if`. The first line of the main file is `#version 330 core`. Cycles, depth over 32,
/// a total over 4 MiB, missing files, `#line` and another `#version` are ShaderErrors with file and line. The
/// text is numbered through, without `#line`: Mesa's compiler forgets the file number of a `#line` in most
/// messages.
struct ShaderSource {
    /// Where a line of the text was written.
    struct Origin {
        std::size_t file = 0;  ///< index into `files`
        std::size_t line = 0;  ///< from 1
    };
    std::string text;                          ///< what the compiler gets
    std::vector<std::filesystem::path> files;  ///< the main file, then what it includes
    std::vector<Origin> lines;                 ///< of each line of `text`
};
ShaderSource loadShader(const std::filesystem::path& file,
                        const std::vector<std::pair<std::string, std::string>>& defines = {});

/// Reads all files under shaders/ now, and from then on no file: for processes that may open none. Programs
/// are built from what was read, and see a file changed when `replaceKeptShader` (its name is relative to
/// shaders/) has given it another text. Not to be called while other threads build programs.
void keepShadersInMemory();
void replaceKeptShader(const std::string& name, std::string text);

/// The driver's log with its places ("0:12(3): error: …" of Mesa, "0(12) : error …" of NVIDIA, "ERROR: 0:12:
/// …" of others) turned into "shaders/dir/file.frag:12: …".
std::string authorsLog(std::string_view driverLog, const ShaderSource& source);

/// Which buffer binding a uniform block reads; GLSL 3.30 cannot say it.
struct BlockBinding {
    std::string block;
    GLuint binding = 0;
    bool operator==(const BlockBinding&) const = default;
};

/// Which texture unit a sampler reads from the start.
struct SamplerBinding {
    std::string uniform;
    GLint unit = 0;
    bool operator==(const SamplerBinding&) const = default;
};

/// Which files make a program, which `#define`s they see, and where its uniform blocks and samplers are
/// bound. Blocks and samplers that the program does not use are passed over.
struct ProgramFiles {
    std::string label = {};
    std::string vertex = {};    ///< relative to shaders/
    std::string fragment = {};  ///< relative to shaders/
    std::string geometry = {};  ///< empty: none
    std::vector<std::pair<std::string, std::string>> defines = {};
    std::vector<BlockBinding> blocks = {};
    std::vector<SamplerBinding> samplers = {};
    std::vector<std::string> feedback = {};  ///< outputs that transform feedback captures, interleaved
};

/// The state of a file on disk, to see later whether it changed.
struct FileStamp {
    std::filesystem::path file;
    std::filesystem::file_time_type time{};
    std::uintmax_t size = 0;  ///< bytes; 0 when missing
    bool operator==(const FileStamp&) const = default;
};

/// A linked program. Uniforms are set by name; one that the compiler found unused is ignored, a name that the
/// sources never mention is a GlError, and so is a value of another type than the uniform's (`int` is for
/// int, bool, samplers, and with a value ≥ 0 for uint). Elements of arrays are "name[2]".
class Program {
  public:
    Program() = default;
    /// Throws ShaderError with the author's file and line.
    explicit Program(ProgramFiles files);

    void use() const;
    /// Sets a uniform, making this the program in use if it is not. What it has already costs no call.
    void set(std::string_view name, int value) const;
    void set(std::string_view name, float value) const;
    void set(std::string_view name, const glm::vec2& value) const;
    void set(std::string_view name, const glm::vec3& value) const;
    void set(std::string_view name, const glm::vec4& value) const;
    void set(std::string_view name, const glm::mat3& value) const;
    void set(std::string_view name, const glm::mat4& value) const;
    bool has(std::string_view name) const;

    /// Builds again if a source file changed since. Returns false when nothing changed, or when a file is
    /// missing or empty at the moment, as while an editor saves it. A broken edit throws ShaderError, once
    /// until the next change, and keeps the last good program.
    bool reloadIfChanged();
    /// What the last broken edit threw; empty when the program is as its files are.
    const std::string& brokenEdit() const { return brokenEdit_; }
    const ProgramFiles& files() const { return files_; }
    GLuint get() const { return handle_.get(); }

  private:
    struct Uniform {
        std::string name;
        GLint location = -1;
        GLenum type = 0;
    };
    using UniformValue = std::array<std::byte, sizeof(glm::mat4)>;
    struct Built {
        Handle<DeleteProgram> handle;
        std::vector<Uniform> uniforms;
        std::vector<std::string> words;
    };
    static Built build(const ProgramFiles& files, std::vector<FileStamp>& visited);
    void adopt(Built&& built);
    template <typename Accepts>
    const Uniform* find(std::string_view name, std::string_view given, Accepts&& accepts) const;
    template <typename T, typename Send>
    void send(const Uniform* uniform, const T& value, Send&& call) const;

    ProgramFiles files_;
    std::vector<FileStamp> sources_;              ///< of the last attempt to build
    std::vector<Uniform> uniforms_;               ///< sorted by name
    std::vector<std::string> words_;              ///< identifiers of the sources, sorted
    mutable std::map<GLint, UniformValue> sent_;  ///< by location: what the program has
    std::string brokenEdit_;
    Handle<DeleteProgram> handle_;
};

/// Programs by their files and defines: each is built once; all are reloaded together.
class ProgramCache {
  public:
    /// Builds the program the first time it is asked for; labels make no difference.
    const Program& get(const ProgramFiles& files);
    /// Rebuilds what changed on disk. Returns the message of the first edit that is broken still, or nothing.
    std::optional<std::string> reloadChanged();
    /// How many programs `reloadChanged` has rebuilt so far.
    std::uint64_t rebuilds() const { return rebuilds_; }
    std::size_t size() const { return programs_.size(); }

  private:
    std::vector<std::unique_ptr<Program>> programs_;
    std::uint64_t rebuilds_ = 0;
};

}  // namespace quincunx::gl

#include "gl/program.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include "base/check.h"
#include "base/error.h"
#include "gl/backends.h"
#include "gl/bindings.h"
#include "gl/calls.h"
#include "gl/shader_source.h"

namespace quincunx::gl {
namespace {

/// A shader object, needed only until its program is linked.
struct DeleteShader {
    void operator()(GLuint name) const {
        if (!detail::anyCurrent())
            return;
        try {
            glDeleteShader(name);
        } catch (const GlError&) {
        }
    }
};

std::string shaderLog(GLuint shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return log;
}

std::string programLog(GLuint program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return log;
}

Handle<DeleteShader> compile(GLenum stage, const ShaderSource& source) {
    Handle<DeleteShader> shader(glCreateShader(stage));
    const char* text = source.text.data();
    const auto length = static_cast<GLint>(source.text.size());
    glShaderSource(shader.get(), 1, &text, &length);
    glCompileShader(shader.get());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE) {
        const std::string error = detail::firstError(authorsLog(shaderLog(shader.get()), source));
        const std::string name = detail::displayName(source.files[0]);
        throw ShaderError(error, error.find("shaders/") == std::string::npos ? name : std::string());
    }
    return shader;
}

bool isSampler(GLenum type) {
    switch (type) {
        case GL_SAMPLER_1D:
        case GL_SAMPLER_2D:
        case GL_SAMPLER_3D:
        case GL_SAMPLER_CUBE:
        case GL_SAMPLER_1D_SHADOW:
        case GL_SAMPLER_2D_SHADOW:
        case GL_SAMPLER_1D_ARRAY:
        case GL_SAMPLER_2D_ARRAY:
        case GL_SAMPLER_1D_ARRAY_SHADOW:
        case GL_SAMPLER_2D_ARRAY_SHADOW:
        case GL_SAMPLER_2D_MULTISAMPLE:
        case GL_SAMPLER_2D_MULTISAMPLE_ARRAY:
        case GL_SAMPLER_CUBE_SHADOW:
        case GL_SAMPLER_BUFFER:
        case GL_SAMPLER_2D_RECT:
        case GL_SAMPLER_2D_RECT_SHADOW:
        case GL_INT_SAMPLER_1D:
        case GL_INT_SAMPLER_2D:
        case GL_INT_SAMPLER_3D:
        case GL_INT_SAMPLER_CUBE:
        case GL_INT_SAMPLER_1D_ARRAY:
        case GL_INT_SAMPLER_2D_ARRAY:
        case GL_INT_SAMPLER_2D_MULTISAMPLE:
        case GL_INT_SAMPLER_2D_MULTISAMPLE_ARRAY:
        case GL_INT_SAMPLER_BUFFER:
        case GL_INT_SAMPLER_2D_RECT:
        case GL_UNSIGNED_INT_SAMPLER_1D:
        case GL_UNSIGNED_INT_SAMPLER_2D:
        case GL_UNSIGNED_INT_SAMPLER_3D:
        case GL_UNSIGNED_INT_SAMPLER_CUBE:
        case GL_UNSIGNED_INT_SAMPLER_1D_ARRAY:
        case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY:
        case GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE:
        case GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE_ARRAY:
        case GL_UNSIGNED_INT_SAMPLER_BUFFER:
        case GL_UNSIGNED_INT_SAMPLER_2D_RECT:
            return true;
        default:
            return false;
    }
}

std::string typeName(GLenum type) {
    static constexpr std::pair<GLenum, const char*> names[] = {
        {GL_FLOAT, "float"},
        {GL_FLOAT_VEC2, "vec2"},
        {GL_FLOAT_VEC3, "vec3"},
        {GL_FLOAT_VEC4, "vec4"},
        {GL_INT, "int"},
        {GL_INT_VEC2, "ivec2"},
        {GL_INT_VEC3, "ivec3"},
        {GL_INT_VEC4, "ivec4"},
        {GL_UNSIGNED_INT, "uint"},
        {GL_UNSIGNED_INT_VEC2, "uvec2"},
        {GL_UNSIGNED_INT_VEC3, "uvec3"},
        {GL_UNSIGNED_INT_VEC4, "uvec4"},
        {GL_BOOL, "bool"},
        {GL_BOOL_VEC2, "bvec2"},
        {GL_BOOL_VEC3, "bvec3"},
        {GL_BOOL_VEC4, "bvec4"},
        {GL_FLOAT_MAT2, "mat2"},
        {GL_FLOAT_MAT3, "mat3"},
        {GL_FLOAT_MAT4, "mat4"},
        {GL_SAMPLER_2D, "sampler2D"},
        {GL_SAMPLER_3D, "sampler3D"},
        {GL_SAMPLER_CUBE, "samplerCube"},
        {GL_SAMPLER_2D_SHADOW, "sampler2DShadow"},
        {GL_SAMPLER_2D_ARRAY, "sampler2DArray"},
    };
    for (const auto& [known, name] : names)
        if (known == type)
            return name;
    return isSampler(type) ? "a sampler" : fmt::format("type {:#06x}", type);
}

/// The names under which elements of an array uniform are found: "weights", "weights[0]", "weights[1]" …
template <typename Add>
void addElements(const std::string& name, GLint size, Add&& add) {
    constexpr std::string_view firstElement = "[0]";
    if (!name.ends_with(firstElement)) {
        add(name);
        return;
    }
    const std::string base = name.substr(0, name.size() - firstElement.size());
    add(base);
    for (GLint i = 0; i < size; ++i)
        add(fmt::format("{}[{}]", base, i));
}

/// "light" of "light[2].position".
std::string_view firstWord(std::string_view name) {
    return name.substr(0, name.find_first_of(".["));
}

}  // namespace

Program::Program(ProgramFiles files) : files_(std::move(files)) {
    std::vector<FileStamp> visited;
    adopt(build(files_, visited));
    sources_ = std::move(visited);
}

Program::Built Program::build(const ProgramFiles& files, std::vector<FileStamp>& visited) {
    struct Stage {
        GLenum type;
        const std::string* file;
    };
    const std::array<Stage, 3> stages = {Stage{GL_VERTEX_SHADER, &files.vertex},
                                         Stage{GL_GEOMETRY_SHADER, &files.geometry},
                                         Stage{GL_FRAGMENT_SHADER, &files.fragment}};
    Built built;
    std::string text;
    std::string names;
    std::vector<Handle<DeleteShader>> shaders;
    for (const Stage& stage : stages) {
        if (stage.file->empty())
            continue;
        const ShaderSource source = detail::loadShader(*stage.file, files.defines, visited);
        shaders.push_back(compile(stage.type, source));
        text += source.text;
        names += (names.empty() ? "" : " + ") + detail::displayName(source.files[0]);
    }
    built.handle = Handle<DeleteProgram>(glCreateProgram());
    const GLuint name = built.handle.get();
    for (const auto& shader : shaders)
        glAttachShader(name, shader.get());
    if (!files.feedback.empty()) {
        std::vector<const char*> captured;
        for (const std::string& output : files.feedback)
            captured.push_back(output.c_str());
        glTransformFeedbackVaryings(name, static_cast<GLsizei>(captured.size()), captured.data(),
                                    GL_INTERLEAVED_ATTRIBS);
    }
    glLinkProgram(name);
    GLint linked = GL_FALSE;
    glGetProgramiv(name, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE)
        throw ShaderError(fmt::format("does not link: {}", detail::firstError(programLog(name))), names);
    for (const auto& shader : shaders)
        glDetachShader(name, shader.get());
    setLabel(GL_PROGRAM, name, files.label);
    for (const BlockBinding& block : files.blocks)
        if (const GLuint index = glGetUniformBlockIndex(name, block.block.c_str()); index != GL_INVALID_INDEX)
            glUniformBlockBinding(name, index, block.binding);
    for (const SamplerBinding& sampler : files.samplers)
        if (const GLint location = glGetUniformLocation(name, sampler.uniform.c_str()); location >= 0) {
            detail::useProgram(name);
            glUniform1i(location, sampler.unit);
        }

    GLint count = 0;
    GLint maxLength = 0;
    glGetProgramiv(name, GL_ACTIVE_UNIFORMS, &count);
    glGetProgramiv(name, GL_ACTIVE_UNIFORM_MAX_LENGTH, &maxLength);
    std::string uniformName(static_cast<std::size_t>(std::max(maxLength, 1)), '\0');
    for (GLint i = 0; i < count; ++i) {
        GLsizei length = 0;
        GLint size = 0;
        GLenum type = 0;
        glGetActiveUniform(name, static_cast<GLuint>(i), static_cast<GLsizei>(uniformName.size()), &length,
                           &size, &type, uniformName.data());
        addElements(uniformName.substr(0, static_cast<std::size_t>(length)), size,
                    [&](const std::string& element) {
                        const GLint location = glGetUniformLocation(name, element.c_str());
                        if (location >= 0)
                            built.uniforms.push_back({element, location, type});
                    });
    }
    std::sort(built.uniforms.begin(), built.uniforms.end(),
              [](const Uniform& a, const Uniform& b) { return a.name < b.name; });
    built.words = detail::identifiers(text);
    return built;
}

void Program::adopt(Built&& built) {
    handle_ = std::move(built.handle);
    uniforms_ = std::move(built.uniforms);
    words_ = std::move(built.words);
    sent_.clear();
}

void Program::use() const {
    QX_CHECK(handle_);
    detail::useProgram(get());
}

/// Null for a uniform that the compiler found unused.
template <typename Accepts>
const Program::Uniform* Program::find(std::string_view name, std::string_view given,
                                      Accepts&& accepts) const {
    const auto found = std::lower_bound(uniforms_.begin(), uniforms_.end(), name,
                                        [](const Uniform& a, std::string_view b) { return a.name < b; });
    const auto where = [&] { return fmt::format("program \"{}\", uniform \"{}\"", files_.label, name); };
    if (found == uniforms_.end() || found->name != name) {
        if (!std::binary_search(words_.begin(), words_.end(), firstWord(name), std::less<>()))
            throw GlError("the shaders have no such name", where());
        return nullptr;
    }
    if (!accepts(found->type))
        throw GlError(fmt::format("is {}, but was given {}", typeName(found->type), given), where());
    use();
    return &*found;
}

template <typename T, typename Send>
void Program::send(const Uniform* uniform, const T& value, Send&& call) const {
    if (uniform == nullptr)
        return;
    UniformValue now{};
    static_assert(sizeof(T) <= sizeof(now));
    std::memcpy(now.data(), &value, sizeof(T));
    const auto known = sent_.find(uniform->location);
    if (known != sent_.end() && known->second == now)
        return;
    call();
    sent_.insert_or_assign(uniform->location, now);
}

void Program::set(std::string_view name, int value) const {
    const auto accepts = [&](GLenum type) {
        return type == GL_INT || type == GL_BOOL || (type == GL_UNSIGNED_INT && value >= 0) ||
               isSampler(type);
    };
    const Uniform* uniform = find(name, value < 0 ? "a negative int" : "int", accepts);
    send(uniform, value, [&] {
        if (uniform->type == GL_UNSIGNED_INT)
            glUniform1ui(uniform->location, static_cast<GLuint>(value));
        else
            glUniform1i(uniform->location, value);
    });
}

void Program::set(std::string_view name, float value) const {
    const Uniform* uniform = find(name, "float", [](GLenum type) { return type == GL_FLOAT; });
    send(uniform, value, [&] { glUniform1f(uniform->location, value); });
}

void Program::set(std::string_view name, const glm::vec2& value) const {
    const Uniform* uniform = find(name, "vec2", [](GLenum type) { return type == GL_FLOAT_VEC2; });
    send(uniform, value, [&] { glUniform2f(uniform->location, value.x, value.y); });
}

void Program::set(std::string_view name, const glm::vec3& value) const {
    const Uniform* uniform = find(name, "vec3", [](GLenum type) { return type == GL_FLOAT_VEC3; });
    send(uniform, value, [&] { glUniform3f(uniform->location, value.x, value.y, value.z); });
}

void Program::set(std::string_view name, const glm::vec4& value) const {
    const Uniform* uniform = find(name, "vec4", [](GLenum type) { return type == GL_FLOAT_VEC4; });
    send(uniform, value, [&] { glUniform4f(uniform->location, value.x, value.y, value.z, value.w); });
}

void Program::set(std::string_view name, const glm::mat3& value) const {
    const Uniform* uniform = find(name, "mat3", [](GLenum type) { return type == GL_FLOAT_MAT3; });
    send(uniform, value, [&] { glUniformMatrix3fv(uniform->location, 1, GL_FALSE, glm::value_ptr(value)); });
}

void Program::set(std::string_view name, const glm::mat4& value) const {
    const Uniform* uniform = find(name, "mat4", [](GLenum type) { return type == GL_FLOAT_MAT4; });
    send(uniform, value, [&] { glUniformMatrix4fv(uniform->location, 1, GL_FALSE, glm::value_ptr(value)); });
}

bool Program::has(std::string_view name) const {
    const auto found = std::lower_bound(uniforms_.begin(), uniforms_.end(), name,
                                        [](const Uniform& a, std::string_view b) { return a.name < b; });
    return found != uniforms_.end() && found->name == name;
}

bool Program::reloadIfChanged() {
    bool changed = false;
    for (const FileStamp& before : sources_) {
        const FileStamp now = detail::stampOf(before.file);
        if (now.size == 0 && before.size != 0)
            return false;
        changed = changed || now != before;
    }
    if (!changed)
        return false;
    std::vector<FileStamp> visited;
    try {
        adopt(build(files_, visited));
    } catch (const ShaderError& error) {
        brokenEdit_ = error.what();
        // Files that the broken edit did not get to are watched still, from now on.
        for (const FileStamp& before : sources_)
            if (std::none_of(visited.begin(), visited.end(),
                             [&](const FileStamp& stamp) { return stamp.file == before.file; }))
                visited.push_back(detail::stampOf(before.file));
        sources_ = std::move(visited);
        throw;
    }
    brokenEdit_.clear();
    sources_ = std::move(visited);
    return true;
}

const Program& ProgramCache::get(const ProgramFiles& files) {
    const auto same = [&](const std::unique_ptr<Program>& program) {
        const ProgramFiles& other = program->files();
        return other.vertex == files.vertex && other.fragment == files.fragment &&
               other.geometry == files.geometry && other.defines == files.defines &&
               other.blocks == files.blocks && other.samplers == files.samplers &&
               other.feedback == files.feedback;
    };
    const auto known = std::find_if(programs_.begin(), programs_.end(), same);
    if (known != programs_.end())
        return **known;
    programs_.push_back(std::make_unique<Program>(files));
    return *programs_.back();
}

std::optional<std::string> ProgramCache::reloadChanged() {
    std::optional<std::string> broken;
    for (const auto& program : programs_) {
        try {
            rebuilds_ += program->reloadIfChanged() ? 1 : 0;
        } catch (const ShaderError&) {
        }
        if (!broken && !program->brokenEdit().empty())
            broken = program->brokenEdit();
    }
    return broken;
}

}  // namespace quincunx::gl

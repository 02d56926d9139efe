#include "gl/bindings.h"

#include <array>
#include <optional>

#include "base/check.h"

namespace quincunx::gl::detail {
namespace {

/// No object has this name.
constexpr GLuint unknown = ~GLuint{0};
// The least numbers of texture units and uniform bindings that OpenGL 3.3 allows a driver.
constexpr std::size_t unitCount = 48;
constexpr std::size_t uniformBindingCount = 36;

struct UniformBuffer {
    GLuint buffer = unknown;
    GLintptr offsetBytes = 0;
    GLsizeiptr sizeBytes = 0;

    bool operator==(const UniformBuffer&) const = default;
};

struct Bindings {
    GLuint program = unknown;
    GLuint vertexArray = unknown;
    GLuint activeUnit = unknown;
    std::array<GLuint, unitCount> textures;
    std::array<GLuint, unitCount> cubes;
    std::optional<bool> seamlessCubes;
    std::array<UniformBuffer, uniformBindingCount> uniformBuffers;

    Bindings() {
        textures.fill(unknown);
        cubes.fill(unknown);
    }
};

Bindings bound;

/// Calls `bind` unless `before` is `now` already. A call that throws has bound nothing.
template <typename T, typename Bind>
void change(T& before, const T& now, Bind&& bind) {
    if (before == now)
        return;
    bind();
    before = now;
}

void activate(GLuint unit) {
    change(bound.activeUnit, unit, [&] { glActiveTexture(GL_TEXTURE0 + unit); });
}

void forget(GLuint& name, GLuint deleted) {
    if (name == deleted)
        name = unknown;
}

}  // namespace

void useProgram(GLuint program) {
    change(bound.program, program, [&] { glUseProgram(program); });
}

void bindVertexArray(GLuint vertexArray) {
    change(bound.vertexArray, vertexArray, [&] { glBindVertexArray(vertexArray); });
}

void bindTexture(GLuint unit, GLuint texture) {
    QX_CHECK_LT(unit, unitCount);
    change(bound.textures[unit], texture, [&] {
        activate(unit);
        glBindTexture(GL_TEXTURE_2D, texture);
    });
}

void bindTextureForEditing(GLuint texture) {
    constexpr GLuint unit = unitCount - 1;
    activate(unit);
    bindTexture(unit, texture);
}

void bindCube(GLuint unit, GLuint texture) {
    QX_CHECK_LT(unit, unitCount);
    change(bound.cubes[unit], texture, [&] {
        activate(unit);
        glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
    });
}

void bindCubeForEditing(GLuint texture) {
    constexpr GLuint unit = unitCount - 1;
    activate(unit);
    bindCube(unit, texture);
}

void filterCubesSeamlessly(bool seamless) {
    change(bound.seamlessCubes, std::optional(seamless), [&] {
        seamless ? glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS) : glDisable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    });
}

void bindUniformBuffer(GLuint binding, GLuint buffer, GLintptr offsetBytes, GLsizeiptr sizeBytes) {
    QX_CHECK_LT(binding, uniformBindingCount);
    change(bound.uniformBuffers[binding], {buffer, offsetBytes, sizeBytes},
           [&] { glBindBufferRange(GL_UNIFORM_BUFFER, binding, buffer, offsetBytes, sizeBytes); });
}

void forgetProgram(GLuint program) {
    forget(bound.program, program);
}

void forgetVertexArray(GLuint vertexArray) {
    forget(bound.vertexArray, vertexArray);
}

void forgetTexture(GLuint texture) {
    for (GLuint& name : bound.textures)
        forget(name, texture);
    for (GLuint& name : bound.cubes)
        forget(name, texture);
}

void forgetBuffer(GLuint buffer) {
    for (UniformBuffer& binding : bound.uniformBuffers)
        forget(binding.buffer, buffer);
}

void forgetBindings() {
    bound = Bindings();
}

}  // namespace quincunx::gl::detail

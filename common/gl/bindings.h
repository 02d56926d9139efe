#pragma once

#include <glad/gl.h>

/// What is bound on the current context, so that binding it once more makes no GL call. Whoever binds
/// programs, vertex arrays, textures or uniform buffers goes through here, or puts back what was bound.
namespace quincunx::gl::detail {

void useProgram(GLuint program);
void bindVertexArray(GLuint vertexArray);
/// As GL_TEXTURE_2D of a unit; which unit is active then is not said.
void bindTexture(GLuint unit, GLuint texture);
/// As GL_TEXTURE_2D of the active unit, for calls that change or read a texture. That unit, the last that
/// OpenGL 3.3 guarantees, is not one that shaders sample, so what is bound for drawing stays bound.
void bindTextureForEditing(GLuint texture);
/// The same for GL_TEXTURE_CUBE_MAP, of which a unit holds one beside the other.
void bindCube(GLuint unit, GLuint texture);
void bindCubeForEditing(GLuint texture);
/// Whether cube maps are filtered across the edges of their faces.
void filterCubesSeamlessly(bool seamless);
/// The part of a buffer that the uniform blocks of a binding read.
void bindUniformBuffer(GLuint binding, GLuint buffer, GLintptr offsetBytes, GLsizeiptr sizeBytes);

/// To be called when an object is deleted: its name may come back for another.
void forgetProgram(GLuint program);
void forgetVertexArray(GLuint vertexArray);
void forgetTexture(GLuint texture);
void forgetBuffer(GLuint buffer);
/// To be called when another context becomes current.
void forgetBindings();

}  // namespace quincunx::gl::detail

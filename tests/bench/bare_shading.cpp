#include "bare_shading.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "gl/program.h"
#include "math/projection.h"
#include "math/transform.h"
#include "scene/still_life.h"

namespace quincunx {
namespace {

constexpr int factor = 2;
constexpr int segments = 48;
constexpr GLuint frameBinding = 0;
constexpr GLuint objectBinding = 1;

struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec2 texcoord;
};

GLuint compiled(GLenum stage, const char* file,
                const std::vector<std::pair<std::string, std::string>>& defines) {
    const std::string text = gl::loadShader(file, defines).text;
    const char* start = text.c_str();
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &start, nullptr);
    glCompileShader(shader);
    return shader;
}

GLuint linked(const char* vertex, const char* fragment,
              const std::vector<std::pair<std::string, std::string>>& defines = {}) {
    const GLuint vertexShader = compiled(GL_VERTEX_SHADER, vertex, defines);
    const GLuint fragmentShader = compiled(GL_FRAGMENT_SHADER, fragment, defines);
    const GLuint program = glCreateProgram();
    glAttachShader(program, vertexShader);
    glAttachShader(program, fragmentShader);
    glLinkProgram(program);
    glDeleteShader(vertexShader);
    glDeleteShader(fragmentShader);
    GLint ok = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    QX_CHECK_EQ(ok, GL_TRUE);
    return program;
}

void bindBlock(GLuint program, const char* block, GLuint binding) {
    glUniformBlockBinding(program, glGetUniformBlockIndex(program, block), binding);
}

void attribute(GLuint location, GLint components, std::size_t offset) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(offset));
}

void storage(GLuint texture, GLint internalFormat, int width, int height, GLenum format, GLenum type) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, internalFormat, width, height, 0, format, type, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

template <typename T>
void fill(GLenum target, GLuint buffer, const std::vector<T>& contents) {
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(contents.size() * sizeof(T)), contents.data(),
                 GL_STATIC_DRAW);
}

}  // namespace

BareShading::BareShading(int width, int height)
    : width_(width), height_(height), aspect_(static_cast<float>(width) / static_cast<float>(height)) {
    const StillLife stillLife = makeStillLife();
    camera_ = stillLife.camera;
    const Scene scene = tessellate(stillLife, segments);
    frame_ = makeFrameBlock(scene, scene.lights, camera_, aspect_);

    background_ = linked("passes/fullscreen.vert", "passes/background.frag");
    phong_ = linked("passes/phong.vert", "passes/phong.frag", {{"BLINN_PHONG", ""}});
    downsample_ = linked("passes/fullscreen.vert", "passes/downsample.frag");
    bindBlock(background_, "FrameBlock", frameBinding);
    bindBlock(phong_, "FrameBlock", frameBinding);
    bindBlock(phong_, "ObjectBlock", objectBinding);

    glGenBuffers(bufferCount, buffers_);
    glGenTextures(textureCount, textures_);
    glGenVertexArrays(1, &vertexArray_);
    glGenVertexArrays(1, &noAttributes_);
    uploadScene(scene);
    makeTargets();

    glUseProgram(phong_);
    glUniform1i(glGetUniformLocation(phong_, "baseColorTexture"), 0);
    glUseProgram(downsample_);
    glUniform1i(glGetUniformLocation(downsample_, "fine"), 1);
    glUniform1i(glGetUniformLocation(downsample_, "factor"), factor);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, textures_[fineColor]);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, textures_[white]);
    glBindBufferBase(GL_UNIFORM_BUFFER, frameBinding, buffers_[frameBuffer]);
    glBindVertexArray(noAttributes_);
    glEnable(GL_CULL_FACE);
    glEnable(GL_FRAMEBUFFER_SRGB);
}

void BareShading::uploadScene(const Scene& scene) {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<ObjectBlock> objects;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        draws_.push_back({static_cast<GLsizei>(mesh.indices.size()), indices.size() * sizeof(std::uint32_t),
                          static_cast<GLint>(vertices.size())});
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            vertices.push_back({mesh.positions[i], mesh.normals[i],
                                mesh.texcoords.empty() ? glm::vec2(0) : mesh.texcoords[i]});
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        objects.push_back(makeObjectBlock(scene.materials[instance.material], instance.worldFromModel));
    }
    glBindVertexArray(vertexArray_);
    fill(GL_ARRAY_BUFFER, buffers_[vertexBuffer], vertices);
    attribute(SceneBuffers::positionLocation, 3, offsetof(Vertex, position));
    attribute(SceneBuffers::normalLocation, 3, offsetof(Vertex, normal));
    attribute(SceneBuffers::texcoordLocation, 2, offsetof(Vertex, texcoord));
    fill(GL_ELEMENT_ARRAY_BUFFER, buffers_[indexBuffer], indices);
    fill(GL_UNIFORM_BUFFER, buffers_[objectBuffer], objects);
    fill(GL_UNIFORM_BUFFER, buffers_[frameBuffer], std::vector{frame_});

    constexpr std::array<std::uint8_t, 4> texel = {255, 255, 255, 255};
    storage(textures_[white], GL_RGBA8, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, texel.data());
}

void BareShading::makeTargets() {
    storage(textures_[fineColor], GL_RGBA16F, width_ * factor, height_ * factor, GL_RGBA, GL_HALF_FLOAT);
    storage(textures_[fineDepth], GL_DEPTH_COMPONENT32F, width_ * factor, height_ * factor,
            GL_DEPTH_COMPONENT, GL_FLOAT);
    storage(textures_[pixels], GL_SRGB8_ALPHA8, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE);
    glGenFramebuffers(1, &fineFramebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, fineFramebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures_[fineColor], 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, textures_[fineDepth], 0);
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures_[pixels], 0);
}

BareShading::~BareShading() {
    glDeleteProgram(background_);
    glDeleteProgram(phong_);
    glDeleteProgram(downsample_);
    glDeleteFramebuffers(1, &fineFramebuffer_);
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteVertexArrays(1, &vertexArray_);
    glDeleteVertexArrays(1, &noAttributes_);
    glDeleteTextures(textureCount, textures_);
    glDeleteBuffers(bufferCount, buffers_);
}

void BareShading::draw(const Camera& camera) {
    frame_.clipFromWorld = perspective(camera.fovYRadians, aspect_, camera.nearDistance, camera.farDistance) *
                           cameraFromWorld(camera.worldFromCamera);
    frame_.eyeWorld = camera.worldFromCamera[3];

    glBindFramebuffer(GL_FRAMEBUFFER, fineFramebuffer_);
    glViewport(0, 0, width_ * factor, height_ * factor);
    glClear(GL_DEPTH_BUFFER_BIT);
    // Binding ranges for the objects has taken the frame's block from this target.
    glBindBuffer(GL_UNIFORM_BUFFER, buffers_[frameBuffer]);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(frame_), &frame_);
    glUseProgram(background_);
    glDrawArrays(GL_TRIANGLES, 0, 3);

    glEnable(GL_DEPTH_TEST);
    glUseProgram(phong_);
    glBindVertexArray(vertexArray_);
    for (std::size_t i = 0; i < draws_.size(); ++i) {
        glBindBufferRange(GL_UNIFORM_BUFFER, objectBinding, buffers_[objectBuffer],
                          static_cast<GLintptr>(i * sizeof(ObjectBlock)), sizeof(ObjectBlock));
        glDrawElementsBaseVertex(GL_TRIANGLES, draws_[i].indexCount, GL_UNSIGNED_INT,
                                 reinterpret_cast<const void*>(draws_[i].firstIndexByte),
                                 draws_[i].baseVertex);
    }
    glDisable(GL_DEPTH_TEST);

    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
    glUseProgram(downsample_);
    glBindVertexArray(noAttributes_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

Image8 BareShading::picture() const {
    Image8 image(width_, height_, 4, Encoding::srgb);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.data.data());
    const auto row = static_cast<std::ptrdiff_t>(width_) * 4;
    for (int y = 0; y < height_ / 2; ++y)
        std::swap_ranges(image.data.begin() + y * row, image.data.begin() + (y + 1) * row,
                         image.data.begin() + (height_ - 1 - y) * row);
    return image;
}

}  // namespace quincunx

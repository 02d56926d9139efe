// What planning adds to a frame that calls for no effect: CPU time of the process and GL calls of the still
// life as FrameRenderer draws it, beside a program that draws the same picture by hand without any check of
// its calls.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "base/check.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "gl/program.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/frame_renderer.h"
#include "scene/still_life.h"
#include "tests/bench/contender.h"

namespace {

using namespace quincunx;

constexpr int segments = 48;

Scene stillLife() {
    return tessellate(makeStillLife(), segments);
}

/// Nothing is called for, or left out that is: the frame is the scene and its background.
FrameSettings plainSettings() {
    FrameSettings settings;
    settings.leftOut.set();
    return settings;
}

class Planned {
  public:
    Planned(int width, int height) : width_(width), height_(height), scene_(stillLife()) {}
    void draw(const Camera& camera) {
        graph::FrameGraph graph;
        picture_ = renderer_.build(graph, {.scene = scene_,
                                           .camera = camera,
                                           .width = width_,
                                           .height = height_,
                                           .settings = plainSettings()});
        graph.addOutput(picture_);
        executor_.run(graph);
    }
    Image8 picture() const { return gl::readPixels8(executor_.output(picture_)); }

  private:
    int width_;
    int height_;
    Scene scene_;
    FrameRenderer renderer_;
    gl::Executor executor_;
    graph::Resource picture_;
};

/// Uniform blocks of shaders/lib/material.glsl and shaders/lib/instances.glsl.
struct alignas(256) MaterialBlock {
    glm::vec4 baseColor{1};
    glm::vec4 emission{0};
    glm::vec4 factors{0};
    glm::ivec4 usedBits{0};
    std::array<glm::vec4, 10> textureRows{};
};
struct alignas(256) InstanceBlock {
    glm::mat4 worldFromModel{1};
    std::array<glm::vec4, 3> worldNormalFromModel{};
};

class Bare {
  public:
    Bare(int width, int height)
        : width_(width), height_(height), aspect_(static_cast<float>(width) / static_cast<float>(height)) {
        const Scene scene = stillLife();
        frame_ = makeFrameBlock(scene, scene.lights, Camera{}, aspect_);
        background_ = linked({.vertex = "passes/fullscreen.vert", .fragment = "passes/background.frag"});
        shade_ = linked(materialProgram({}));
        for (const auto& [block, binding] :
             {std::pair("FrameBlock", 0u), std::pair("InstanceBlock", 1u), std::pair("MaterialBlock", 2u)})
            glUniformBlockBinding(shade_, glGetUniformBlockIndex(shade_, block), binding);
        glUniformBlockBinding(background_, glGetUniformBlockIndex(background_, "FrameBlock"), 0);
        upload(scene);
        glGenTextures(2, targets_.data());
        storage(targets_[0], GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE);
        storage(targets_[1], GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT);
        glGenFramebuffers(1, &framebuffer_);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, targets_[0], 0);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, targets_[1], 0);
    }

    /// What a frame asks for that another pass may have changed: target, camera, programs, vertices, state.
    void draw(const Camera& camera) {
        frame_.clipFromWorld =
            perspective(camera.fovYRadians, aspect_, camera.nearDistance, camera.farDistance) *
            cameraFromWorld(camera.worldFromCamera);
        frame_.eyeWorld = camera.worldFromCamera[3];
        glEnable(GL_FRAMEBUFFER_SRGB);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glViewport(0, 0, width_, height_);
        glClear(GL_DEPTH_BUFFER_BIT);
        glBindBuffer(GL_UNIFORM_BUFFER, buffers_[frameBuffer]);
        glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(frame_), &frame_);
        glBindBufferRange(GL_UNIFORM_BUFFER, 0, buffers_[frameBuffer], 0, sizeof(frame_));
        glUseProgram(background_);
        glBindVertexArray(noAttributes_);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glEnable(GL_DEPTH_TEST);
        glEnable(GL_CULL_FACE);
        glUseProgram(shade_);
        glBindVertexArray(vertexArray_);
        for (std::size_t i = 0; i < draws_.size(); ++i) {
            glBindBufferRange(GL_UNIFORM_BUFFER, 2, buffers_[materialBuffer],
                              static_cast<GLintptr>(i * sizeof(MaterialBlock)), sizeof(MaterialBlock));
            glBindBufferRange(GL_UNIFORM_BUFFER, 1, buffers_[instanceBuffer],
                              static_cast<GLintptr>(i * sizeof(InstanceBlock)), 16384);
            glDrawElementsInstancedBaseVertex(GL_TRIANGLES, draws_[i].count, GL_UNSIGNED_INT,
                                              reinterpret_cast<const void*>(draws_[i].firstByte), 1,
                                              draws_[i].baseVertex);
        }
        glDisable(GL_CULL_FACE);
        glDisable(GL_DEPTH_TEST);
    }

  private:
    enum { vertexBuffer, indexBuffer, frameBuffer, materialBuffer, instanceBuffer, bufferCount };
    struct Draw {
        GLsizei count;
        std::size_t firstByte;
        GLint baseVertex;
    };
    struct Vertex {
        glm::vec3 position;
        glm::vec3 normal;
    };

    static GLuint linked(const gl::ProgramFiles& files) {
        const GLuint program = glCreateProgram();
        for (const auto& [stage, file] :
             {std::pair(GL_VERTEX_SHADER, files.vertex), std::pair(GL_FRAGMENT_SHADER, files.fragment)}) {
            const std::string text = gl::loadShader(file, files.defines).text;
            const char* start = text.c_str();
            const GLuint shader = glCreateShader(static_cast<GLenum>(stage));
            glShaderSource(shader, 1, &start, nullptr);
            glCompileShader(shader);
            glAttachShader(program, shader);
            glDeleteShader(shader);
        }
        glLinkProgram(program);
        GLint ok = GL_FALSE;
        glGetProgramiv(program, GL_LINK_STATUS, &ok);
        QX_CHECK_EQ(ok, GL_TRUE);
        return program;
    }
    template <typename T>
    void fill(GLenum target, GLuint buffer, const std::vector<T>& contents) {
        glBindBuffer(target, buffer);
        glBufferData(target, static_cast<GLsizeiptr>(contents.size() * sizeof(T)), contents.data(),
                     GL_STATIC_DRAW);
    }
    void storage(GLuint texture, GLint internalFormat, GLenum format, GLenum type) const {
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexImage2D(GL_TEXTURE_2D, 0, internalFormat, width_, height_, 0, format, type, nullptr);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    }
    void upload(const Scene& scene) {
        glGenBuffers(bufferCount, buffers_.data());
        glGenVertexArrays(1, &vertexArray_);
        glGenVertexArrays(1, &noAttributes_);
        std::vector<Vertex> vertices;
        std::vector<std::uint32_t> indices;
        std::vector<MaterialBlock> materials;
        std::vector<InstanceBlock> instances;
        for (const Instance& instance : scene.instances) {
            const Mesh& mesh = scene.meshes[instance.mesh];
            draws_.push_back({static_cast<GLsizei>(mesh.indices.size()),
                              indices.size() * sizeof(std::uint32_t), static_cast<GLint>(vertices.size())});
            for (std::size_t i = 0; i < mesh.positions.size(); ++i)
                vertices.push_back({mesh.positions[i], mesh.normals[i]});
            indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
            const Material& material = scene.materials[instance.material];
            materials.push_back({material.baseColor,
                                 glm::vec4(material.emission, 0),
                                 glm::vec4(material.metallic, material.roughness, 1, 1),
                                 glm::ivec4(0),
                                 {}});
            const glm::mat3 normals = normalMatrix(instance.worldFromModel);
            instances.push_back(
                {instance.worldFromModel,
                 {glm::vec4(normals[0], 0), glm::vec4(normals[1], 0), glm::vec4(normals[2], 0)}});
        }
        instances.resize(instances.size() + 16384 / sizeof(InstanceBlock));
        glBindVertexArray(vertexArray_);
        fill(GL_ARRAY_BUFFER, buffers_[vertexBuffer], vertices);
        for (GLuint location : {0u, 1u}) {
            glEnableVertexAttribArray(location);
            glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                                  reinterpret_cast<const void*>(location * sizeof(glm::vec3)));
        }
        fill(GL_ELEMENT_ARRAY_BUFFER, buffers_[indexBuffer], indices);
        fill(GL_UNIFORM_BUFFER, buffers_[frameBuffer], std::vector{frame_});
        fill(GL_UNIFORM_BUFFER, buffers_[materialBuffer], materials);
        fill(GL_UNIFORM_BUFFER, buffers_[instanceBuffer], instances);
    }

    int width_;
    int height_;
    float aspect_;
    FrameBlock frame_;
    GLuint background_ = 0;
    GLuint shade_ = 0;
    GLuint framebuffer_ = 0;
    GLuint vertexArray_ = 0;
    GLuint noAttributes_ = 0;
    std::array<GLuint, bufferCount> buffers_{};
    std::array<GLuint, 2> targets_{};
    std::vector<Draw> draws_;
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    for (const auto& [width, height, frames] : {std::tuple(640, 480, 3), std::tuple(64, 48, 20)}) {
        Contender<Planned> planned(width, height, true);
        Contender<Bare> bare(width, height, false);
        std::vector<double> ours;
        std::vector<double> theirs;
        std::vector<double> ratios;
        for (int round = 0; round < 31; ++round) {
            const bool oursFirst = round % 2 == 0;
            const double first = oursFirst ? planned.batch(frames).first : bare.batch(frames).first;
            const double second = oursFirst ? bare.batch(frames).first : planned.batch(frames).first;
            ours.push_back(oursFirst ? first : second);
            theirs.push_back(oursFirst ? second : first);
            ratios.push_back(ours.back() / theirs.back());
        }
        const std::uint64_t plannedCalls = sumOf(planned.calls());
        const std::uint64_t bareCalls = sumOf(bare.calls());
        std::printf(
            "ratio planned / bare at %dx%d: CPU time %.3f (%.3f ms / %.3f ms; round by round %.3f), GL "
            "calls %.3f (%d / %d)\n",
            width, height, median(ours) / median(theirs), median(ours) * 1e3, median(theirs) * 1e3,
            median(ratios), static_cast<double>(plannedCalls) / static_cast<double>(bareCalls),
            static_cast<int>(plannedCalls), static_cast<int>(bareCalls));
    }
    return 0;
}

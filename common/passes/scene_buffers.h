#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "gl/objects.h"
#include "gl/program.h"
#include "scene/scene.h"

namespace quincunx {

/// Lights that a shader can see (maxLights in shaders/lib/frame.glsl).
inline constexpr std::size_t maxShaderLights = 8;

/// Uniform block FrameBlock of shaders/lib/frame.glsl, std140.
struct FrameBlock {
    struct Light {
        glm::vec4 position{0};
        glm::vec4 direction{0};
        glm::vec4 radiance{0};

        bool operator==(const Light&) const = default;
    };
    glm::mat4 clipFromWorld{1};
    glm::vec4 eyeWorld{0};
    glm::vec4 ambientLight{0};
    glm::vec4 backgroundTop{0};
    glm::vec4 backgroundBottom{0};
    glm::ivec4 lightCount{0};
    std::array<Light, maxShaderLights> lights{};

    bool operator==(const FrameBlock&) const = default;
};

/// Uniform block ObjectBlock of shaders/lib/object.glsl, std140, padded to the largest alignment that OpenGL
/// allows a driver to ask of offsets into a uniform buffer.
struct alignas(256) ObjectBlock {
    glm::mat4 worldFromModel{1};
    std::array<glm::vec4, 3> worldNormalFromModel{};  ///< columns
    glm::vec4 ambient{0};
    glm::vec4 diffuse{0};
    glm::vec4 specular{0};
    glm::vec4 emission{0};
    std::array<glm::vec4, 5> padding{};  ///< to 256 bytes, so that blocks compare bytewise
};

/// The frame's camera and lights; ambient light and background are the scene's. More lights than
/// `maxShaderLights` are an InputError.
FrameBlock makeFrameBlock(const Scene& scene, const std::vector<Light>& lights, const Camera& camera,
                          float aspect);
FrameBlock makeFrameBlock(const Scene& scene, const std::vector<Light>& lights,
                          const glm::mat4& clipFromWorld, glm::vec3 eyeWorld);

/// A material and placement as shaders read it. `worldNormalFromModel` is the cofactor matrix, so that
/// normals stay perpendicular under shear and point outside under mirrors.
ObjectBlock makeObjectBlock(const Material& material, const glm::mat4& worldFromModel);

/// A scene on the device: all meshes in one set of buffers, so that a frame binds once and then needs two
/// calls an instance.
class SceneBuffers {
  public:
    /// How vertices are laid out: `shared` between the triangles that meet in them, with their own normals,
    /// or three apart for each triangle (`faceted`), with the triangle's plane normal and its centroid.
    enum class Layout { shared, faceted };

    SceneBuffers(const Scene& scene, Layout layout);

    /// Attribute locations in the vertex shaders.
    static constexpr GLuint positionLocation = 0;
    static constexpr GLuint normalLocation = 1;
    static constexpr GLuint texcoordLocation = 2;
    static constexpr GLuint centroidLocation = 3;  ///< faceted only, model space
    /// Bindings of the uniform blocks, for ProgramFiles.
    static const std::vector<gl::BlockBinding>& bindings();

    /// Sends what has changed since the last frame.
    void update(const FrameBlock& frame, const std::vector<ObjectBlock>& objects);
    /// The same for programs that read no frame block.
    void updateObjects(const std::vector<ObjectBlock>& objects);
    /// Binds the frame's uniform block.
    void bindFrame() const;
    /// Binds the vertices; then `draw` each instance with the program in use.
    void bindVertices() const;
    void draw(std::size_t instance) const;

    std::size_t instanceCount() const { return draws_.size(); }
    std::uint64_t vertexCount() const { return vertexCount_; }      ///< of all instances
    std::uint64_t triangleCount() const { return triangleCount_; }  ///< of all instances

  private:
    struct Draw {
        GLsizei indexCount = 0;
        std::size_t firstIndexByte = 0;
        GLint baseVertex = 0;
        const gl::Texture2D* texture = nullptr;
    };
    gl::Buffer vertices_;
    gl::Buffer indices_;
    FrameBlock frame_;  ///< before the buffer that is made from it
    gl::Buffer frameBuffer_;
    gl::Buffer objectBuffer_;
    gl::VertexArray vertexArray_;
    std::vector<gl::Texture2D> textures_;
    std::vector<Draw> draws_;
    std::vector<ObjectBlock> objects_;
    std::uint64_t vertexCount_ = 0;
    std::uint64_t triangleCount_ = 0;
    bool indexed_ = true;
};

}  // namespace quincunx

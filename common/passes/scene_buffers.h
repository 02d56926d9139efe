#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <optional>
#include <span>
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
        glm::vec4 reach{0};

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

/// The frame block on the device.
class FrameUniforms {
  public:
    FrameUniforms();
    /// Sends what has changed since the last frame.
    void update(const FrameBlock& frame);
    void bind() const;

  private:
    FrameBlock block_;  ///< before the buffer that is made from it
    gl::Buffer buffer_;
};

/// A texture with its wraps and filters. Images that a driver cannot hold are an InputError.
gl::Texture2D makeTexture(const Texture& texture);

/// Attributes that vertices have besides position and normal.
struct VertexExtras {
    bool texcoords = true;
    bool texcoords1 = false;
    bool colors = false;
    /// Tangents, made for this map where the mesh has none.
    std::optional<TextureUse> tangentsFor = {};
};

/// Meshes on the device. Those with the same extra attributes share buffers and a vertex array, so that a
/// frame binds few, and no mesh pays for attributes that it has no use for.
class MeshBuffers {
  public:
    /// Attribute locations in the vertex shaders.
    static constexpr GLuint positionLocation = 0;
    static constexpr GLuint normalLocation = 1;
    static constexpr GLuint texcoordLocation = 2;
    static constexpr GLuint texcoord1Location = 4;
    static constexpr GLuint tangentLocation = 5;
    static constexpr GLuint colorLocation = 6;

    /// `extras` has one entry a mesh; attributes that a mesh lacks are sent as 0 where they are asked for,
    /// and colours as white. What is not asked for reads as 0, too.
    MeshBuffers(const std::vector<Mesh>& meshes, const std::vector<VertexExtras>& extras);

    /// Binds the vertex array that holds a mesh; then `draw` it with the program in use.
    void bind(std::size_t mesh) const;
    void draw(std::size_t mesh) const;
    void drawInstanced(std::size_t mesh, std::size_t count) const;

    /// Triangles in orders of one's own: `begin` a frame's, `add` a mesh with its triangles in some order,
    /// which returns what to draw it by, and `send` them; then bind and draw. What is as it was is not sent
    /// again.
    class Ordered {
      public:
        void begin() { indices_.clear(); }
        std::size_t add(const MeshBuffers& meshes, std::size_t mesh,
                        std::span<const std::uint32_t> triangles);
        void send(const MeshBuffers& meshes);
        void bind(const MeshBuffers& meshes, std::size_t mesh) const;
        void draw(const MeshBuffers& meshes, std::size_t mesh, std::size_t first) const;

      private:
        std::vector<std::uint32_t> indices_;
        std::vector<std::uint32_t> sent_;
        gl::Buffer buffer_;
        std::vector<gl::VertexArray> arrays_;  ///< by store
    };

    std::size_t size() const { return ranges_.size(); }
    std::uint64_t vertexCount(std::size_t mesh) const { return ranges_[mesh].vertexCount; }
    std::uint64_t triangleCount(std::size_t mesh) const {
        return static_cast<std::uint64_t>(ranges_[mesh].indexCount) / 3;
    }
    std::uint64_t bytes() const;

  private:
    struct Range {
        std::size_t store = 0;
        GLsizei indexCount = 0;
        std::size_t firstIndexByte = 0;
        GLint baseVertex = 0;
        std::uint64_t vertexCount = 0;
    };
    struct Store {
        VertexExtras extras;
        gl::Buffer vertices;
        gl::VertexArray vertexArray;
    };
    static void attach(const Store& store, gl::VertexArray& vertexArray);

    std::vector<Range> ranges_;
    std::vector<std::uint32_t> indexCopy_;
    gl::Buffer indices_;
    std::vector<Store> stores_;
};

/// A scene on the device: all meshes in one set of buffers, so that a frame binds once and then needs two
/// calls an instance.
class SceneBuffers {
  public:
    /// How vertices are laid out: `shared` between the triangles that meet in them, with their own normals,
    /// or three apart for each triangle (`faceted`), with the triangle's plane normal and its centroid.
    enum class Layout { shared, faceted };

    SceneBuffers(const Scene& scene, Layout layout);

    /// Attribute locations in the vertex shaders.
    static constexpr GLuint positionLocation = MeshBuffers::positionLocation;
    static constexpr GLuint normalLocation = MeshBuffers::normalLocation;
    static constexpr GLuint texcoordLocation = MeshBuffers::texcoordLocation;
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
        std::size_t mesh = 0;
        GLint firstVertex = 0;  ///< faceted
        GLsizei vertexCount = 0;
        const gl::Texture2D* texture = nullptr;
    };
    std::optional<MeshBuffers> shared_;
    gl::Buffer facets_;
    gl::VertexArray facetArray_;
    FrameUniforms frame_;
    gl::Buffer objectBuffer_;
    std::vector<gl::Texture2D> textures_;  ///< empty where no material uses it
    std::vector<Draw> draws_;
    std::vector<ObjectBlock> objects_;
    std::uint64_t vertexCount_ = 0;
    std::uint64_t triangleCount_ = 0;
};

}  // namespace quincunx

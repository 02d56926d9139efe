#include "passes/scene_buffers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "geometry/normals.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr GLuint frameBinding = 0;
constexpr GLuint objectBinding = 1;

struct SharedVertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec2 texcoord;
};

struct FacetVertex {
    glm::vec3 position;
    glm::vec3 planeNormal;
    glm::vec2 texcoord;
    glm::vec3 centroid;
};

template <typename T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

std::vector<SharedVertex> sharedVertices(const Mesh& mesh) {
    std::vector<SharedVertex> vertices(mesh.positions.size());
    for (std::size_t i = 0; i < vertices.size(); ++i)
        vertices[i] = {mesh.positions[i], mesh.normals.empty() ? glm::vec3(0) : mesh.normals[i],
                       mesh.texcoords.empty() ? glm::vec2(0) : mesh.texcoords[i]};
    return vertices;
}

std::vector<FacetVertex> facetVertices(const Mesh& mesh) {
    std::vector<FacetVertex> vertices;
    vertices.reserve(mesh.indices.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t corner[3] = {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
        const glm::vec3 a = mesh.positions[corner[0]];
        const glm::vec3 b = mesh.positions[corner[1]];
        const glm::vec3 c = mesh.positions[corner[2]];
        const glm::vec3 normal = glm::vec3(triangleNormal(a, b, c));
        const glm::vec3 centroid((glm::dvec3(a) + glm::dvec3(b) + glm::dvec3(c)) / 3.0);
        for (const std::uint32_t v : corner)
            vertices.push_back({mesh.positions[v], normal,
                                mesh.texcoords.empty() ? glm::vec2(0) : mesh.texcoords[v], centroid});
    }
    return vertices;
}

GLenum wrapMode(Texture::Wrap wrap) {
    switch (wrap) {
        case Texture::Wrap::mirroredRepeat:
            return GL_MIRRORED_REPEAT;
        case Texture::Wrap::clampToEdge:
            return GL_CLAMP_TO_EDGE;
        case Texture::Wrap::repeat:
            break;
    }
    return GL_REPEAT;
}

}  // namespace

FrameBlock makeFrameBlock(const Scene& scene, const std::vector<Light>& lights, const Camera& camera,
                          float aspect) {
    return makeFrameBlock(scene, lights,
                          perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance) *
                              cameraFromWorld(camera.worldFromCamera),
                          glm::vec3(camera.worldFromCamera[3]));
}

FrameBlock makeFrameBlock(const Scene& scene, const std::vector<Light>& lights,
                          const glm::mat4& clipFromWorld, glm::vec3 eyeWorld) {
    if (lights.size() > maxShaderLights)
        throw InputError(
            fmt::format("{} lights, more than the {} that are drawn", lights.size(), maxShaderLights),
            scene.name, "take some lights away");
    FrameBlock block;
    block.clipFromWorld = clipFromWorld;
    block.eyeWorld = glm::vec4(eyeWorld, 1);
    block.ambientLight = glm::vec4(scene.ambientLight, 0);
    block.backgroundTop = glm::vec4(scene.backgroundTop, 1);
    block.backgroundBottom = glm::vec4(scene.backgroundBottom, 1);
    block.lightCount.x = static_cast<int>(lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Light& light = lights[i];
        block.lights[i] = {glm::vec4(light.position, static_cast<float>(light.kind)),
                           glm::vec4(light.direction, light.innerConeRadians),
                           glm::vec4(light.color * light.intensity, light.outerConeRadians)};
    }
    return block;
}

ObjectBlock makeObjectBlock(const Material& material, const glm::mat4& worldFromModel) {
    ObjectBlock block;
    block.worldFromModel = worldFromModel;
    const glm::mat3 normals = normalMatrix(worldFromModel);
    for (int column = 0; column < 3; ++column)
        block.worldNormalFromModel[static_cast<std::size_t>(column)] = glm::vec4(normals[column], 0);
    block.ambient = glm::vec4(material.ambient, 0);
    block.diffuse = glm::vec4(material.diffuse,
                              material.alphaMode == Material::AlphaMode::mask ? material.alphaCutoff : 0);
    block.specular = glm::vec4(material.specular, material.shininess);
    block.emission = glm::vec4(material.emission, material.baseColor.a);
    return block;
}

const std::vector<gl::BlockBinding>& SceneBuffers::bindings() {
    static const std::vector<gl::BlockBinding> blocks = {{"FrameBlock", frameBinding},
                                                         {"ObjectBlock", objectBinding}};
    return blocks;
}

SceneBuffers::SceneBuffers(const Scene& scene, Layout layout)
    : frameBuffer_("frame block", GL_UNIFORM_BUFFER, std::as_bytes(std::span(&frame_, 1)), GL_DYNAMIC_DRAW),
      objectBuffer_("object blocks", GL_UNIFORM_BUFFER, {}, GL_DYNAMIC_DRAW),
      vertexArray_("scene"),
      indexed_(layout == Layout::shared) {
    struct Range {
        Draw draw;
        std::uint64_t vertices = 0;
        std::uint64_t triangles = 0;
    };
    std::vector<Range> ranges;
    std::vector<SharedVertex> shared;
    std::vector<FacetVertex> facets;
    std::vector<std::uint32_t> indices;
    for (const Mesh& mesh : scene.meshes) {
        Range range;
        range.triangles = mesh.triangleCount();
        range.draw.indexCount = static_cast<GLsizei>(mesh.indices.size());
        if (indexed_) {
            range.draw.baseVertex = static_cast<GLint>(shared.size());
            range.draw.firstIndexByte = indices.size() * sizeof(std::uint32_t);
            const std::vector<SharedVertex> vertices = sharedVertices(mesh);
            shared.insert(shared.end(), vertices.begin(), vertices.end());
            indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
            range.vertices = vertices.size();
        } else {
            range.draw.baseVertex = static_cast<GLint>(facets.size());
            const std::vector<FacetVertex> vertices = facetVertices(mesh);
            facets.insert(facets.end(), vertices.begin(), vertices.end());
            range.vertices = vertices.size();
        }
        ranges.push_back(range);
    }

    using Attribute = gl::VertexArray::Attribute;
    if (indexed_) {
        vertices_ = gl::Buffer("vertices", GL_ARRAY_BUFFER, bytesOf(shared));
        constexpr GLsizei stride = sizeof(SharedVertex);
        vertexArray_.attribute(vertices_, Attribute{positionLocation, 3, GL_FLOAT, false, stride, 0});
        vertexArray_.attribute(
            vertices_, Attribute{normalLocation, 3, GL_FLOAT, false, stride, offsetof(SharedVertex, normal)});
        vertexArray_.attribute(vertices_, Attribute{texcoordLocation, 2, GL_FLOAT, false, stride,
                                                    offsetof(SharedVertex, texcoord)});
        indices_ = gl::Buffer("indices", GL_ARRAY_BUFFER, bytesOf(indices));
        vertexArray_.indices(indices_);
    } else {
        vertices_ = gl::Buffer("facets", GL_ARRAY_BUFFER, bytesOf(facets));
        constexpr GLsizei stride = sizeof(FacetVertex);
        vertexArray_.attribute(vertices_, Attribute{positionLocation, 3, GL_FLOAT, false, stride, 0});
        vertexArray_.attribute(vertices_, Attribute{normalLocation, 3, GL_FLOAT, false, stride,
                                                    offsetof(FacetVertex, planeNormal)});
        vertexArray_.attribute(vertices_, Attribute{texcoordLocation, 2, GL_FLOAT, false, stride,
                                                    offsetof(FacetVertex, texcoord)});
        vertexArray_.attribute(vertices_, Attribute{centroidLocation, 3, GL_FLOAT, false, stride,
                                                    offsetof(FacetVertex, centroid)});
    }

    for (const Texture& texture : scene.textures) {
        textures_.emplace_back(texture.name, texture.image);
        textures_.back().setWrap(wrapMode(texture.wrapS), wrapMode(texture.wrapT));
    }
    Image8 white(1, 1, 4, Encoding::linear);
    std::fill(white.data.begin(), white.data.end(), std::uint8_t{255});
    textures_.emplace_back("white", white);
    textures_.back().setFilter(GL_NEAREST, GL_NEAREST);

    for (const Instance& instance : scene.instances) {
        const Range& range = ranges[instance.mesh];
        draws_.push_back(range.draw);
        const Material& material = scene.materials[instance.material];
        draws_.back().texture = &textures_[material.baseColorTexture ? material.baseColorTexture->texture : scene.textures.size()];
        vertexCount_ += range.vertices;
        triangleCount_ += range.triangles;
    }
}

void SceneBuffers::update(const FrameBlock& frame, const std::vector<ObjectBlock>& objects) {
    if (!(frame == frame_)) {
        frame_ = frame;
        frameBuffer_.upload(std::as_bytes(std::span(&frame_, 1)));
    }
    updateObjects(objects);
}

void SceneBuffers::updateObjects(const std::vector<ObjectBlock>& objects) {
    QX_CHECK_EQ(objects.size(), draws_.size());
    const auto haveSameBytes = [](const ObjectBlock& a, const ObjectBlock& b) {
        return std::memcmp(&a, &b, sizeof(ObjectBlock)) == 0;
    };
    const bool same =
        std::equal(objects.begin(), objects.end(), objects_.begin(), objects_.end(), haveSameBytes);
    if (!same) {
        objects_ = objects;
        objectBuffer_.upload(bytesOf(objects_));
    }
}

void SceneBuffers::bindFrame() const {
    frameBuffer_.bindUniform(frameBinding, 0, sizeof(FrameBlock));
}

void SceneBuffers::bindVertices() const {
    vertexArray_.bind();
}

void SceneBuffers::draw(std::size_t instance) const {
    const Draw& draw = draws_[instance];
    draw.texture->bind(0);
    objectBuffer_.bindUniform(objectBinding, instance * sizeof(ObjectBlock), sizeof(ObjectBlock));
    if (indexed_)
        glDrawElementsBaseVertex(GL_TRIANGLES, draw.indexCount, GL_UNSIGNED_INT,
                                 reinterpret_cast<const void*>(draw.firstIndexByte), draw.baseVertex);
    else
        glDrawArrays(GL_TRIANGLES, draw.baseVertex, draw.indexCount);
}

}  // namespace quincunx

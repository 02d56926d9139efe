#include "passes/scene_buffers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "geometry/normals.h"
#include "geometry/tangent_frames.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr GLuint frameBinding = 0;
constexpr GLuint objectBinding = 1;

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

/// The mesh with tangents, where extras ask for some and it can have them.
std::optional<Mesh> withTangents(const Mesh& mesh, const VertexExtras& extras) {
    if (!extras.tangentsFor || !mesh.tangents.empty() || mesh.normals.empty())
        return std::nullopt;
    const int set = extras.tangentsFor->texcoordSet == 1 && !mesh.texcoords1.empty() ? 1 : 0;
    if (set == 0 && mesh.texcoords.empty())
        return std::nullopt;
    Mesh result = mesh;
    makeTangents(result, set, extras.tangentsFor->textureFromTexcoord);
    return result;
}

/// The floats of one mesh's vertices: position, normal, and the extras in the order of their locations.
void appendVertices(const Mesh& mesh, const VertexExtras& extras, std::vector<float>& floats) {
    const auto append = [&floats](const auto& values, std::size_t i, auto otherwise) {
        const auto value = values.empty() ? otherwise : values[i];
        for (int k = 0; k < value.length(); ++k)
            floats.push_back(value[k]);
    };
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append(mesh.positions, i, glm::vec3(0));
        append(mesh.normals, i, glm::vec3(0));
        if (extras.texcoords)
            append(mesh.texcoords, i, glm::vec2(0));
        if (extras.texcoords1)
            append(mesh.texcoords1, i, glm::vec2(0));
        if (extras.tangentsFor)
            append(mesh.tangents, i, glm::vec4(0));
        if (extras.colors)
            append(mesh.colors, i, glm::vec4(1));
    }
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

GLenum minification(const Texture& texture) {
    const bool linear = texture.minification == Texture::Filter::linear;
    switch (texture.mipmaps) {
        case Texture::Mipmaps::nearest:
            return linear ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
        case Texture::Mipmaps::linear:
            return linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
        case Texture::Mipmaps::none:
            break;
    }
    return linear ? GL_LINEAR : GL_NEAREST;
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
                           glm::vec4(light.color * light.intensity, light.outerConeRadians),
                           glm::vec4(light.kind == Light::Kind::directional ? 0 : light.range, 0, 0, 0)};
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
    // The factor is the brightest that a texture makes of it, mostly in few places.
    block.emission =
        glm::vec4(material.emissionTexture ? glm::vec3(0) : material.emission, material.baseColor.a);
    return block;
}

const std::vector<gl::BlockBinding>& SceneBuffers::bindings() {
    static const std::vector<gl::BlockBinding> blocks = {{"FrameBlock", frameBinding},
                                                         {"ObjectBlock", objectBinding}};
    return blocks;
}

FrameUniforms::FrameUniforms()
    : buffer_("frame block", GL_UNIFORM_BUFFER, std::as_bytes(std::span(&block_, 1)), GL_DYNAMIC_DRAW) {}

void FrameUniforms::update(const FrameBlock& frame) {
    if (frame == block_)
        return;
    block_ = frame;
    buffer_.upload(std::as_bytes(std::span(&block_, 1)));
}

void FrameUniforms::bind() const {
    buffer_.bindUniform(frameBinding, 0, sizeof(FrameBlock));
}

gl::Texture2D makeTexture(const Texture& texture) {
    gl::Texture2D result(texture.name, texture.image);
    result.setWrap(wrapMode(texture.wrapS), wrapMode(texture.wrapT));
    result.setFilter(minification(texture),
                     texture.magnification == Texture::Filter::linear ? GL_LINEAR : GL_NEAREST);
    return result;
}

MeshBuffers::MeshBuffers(const std::vector<Mesh>& meshes, const std::vector<VertexExtras>& extras) {
    QX_CHECK_EQ(extras.size(), meshes.size());
    struct Contents {
        VertexExtras extras;
        std::size_t vertices = 0;
        std::vector<float> floats;
    };
    std::vector<Contents> contents;
    std::vector<std::uint32_t>& indices = indexCopy_;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        const auto fits = [&](const Contents& store) {
            return store.extras.texcoords == extras[m].texcoords &&
                   store.extras.texcoords1 == extras[m].texcoords1 &&
                   store.extras.colors == extras[m].colors &&
                   store.extras.tangentsFor.has_value() == extras[m].tangentsFor.has_value();
        };
        auto store = std::find_if(contents.begin(), contents.end(), fits);
        if (store == contents.end())
            store = contents.insert(contents.end(), {extras[m], 0, {}});
        const std::optional<Mesh> made = withTangents(meshes[m], extras[m]);
        const Mesh& mesh = made ? *made : meshes[m];
        Range range;
        range.store = static_cast<std::size_t>(store - contents.begin());
        range.indexCount = static_cast<GLsizei>(mesh.indices.size());
        range.firstIndexByte = indices.size() * sizeof(std::uint32_t);
        range.baseVertex = static_cast<GLint>(store->vertices);
        range.vertexCount = mesh.positions.size();
        ranges_.push_back(range);
        appendVertices(mesh, extras[m], store->floats);
        store->vertices += mesh.positions.size();
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
    }
    indices_ = gl::Buffer("indices", GL_ARRAY_BUFFER, bytesOf(indices));
    for (const Contents& content : contents) {
        Store& store = stores_.emplace_back(content.extras,
                                            gl::Buffer("vertices", GL_ARRAY_BUFFER, bytesOf(content.floats)),
                                            gl::VertexArray("scene"));
        attach(store, store.vertexArray);
        store.vertexArray.indices(indices_);
    }
}

void MeshBuffers::attach(const Store& store, gl::VertexArray& vertexArray) {
    struct Attribute {
        GLuint location;
        GLint components;
    };
    std::vector<Attribute> attributes = {{positionLocation, 3}, {normalLocation, 3}};
    if (store.extras.texcoords)
        attributes.push_back({texcoordLocation, 2});
    if (store.extras.texcoords1)
        attributes.push_back({texcoord1Location, 2});
    if (store.extras.tangentsFor)
        attributes.push_back({tangentLocation, 4});
    if (store.extras.colors)
        attributes.push_back({colorLocation, 4});
    GLint floats = 0;
    for (const Attribute& attribute : attributes)
        floats += attribute.components;
    std::size_t offset = 0;
    for (const Attribute& attribute : attributes) {
        vertexArray.attribute(store.vertices, {attribute.location, attribute.components, GL_FLOAT, false,
                                               floats * static_cast<GLsizei>(sizeof(float)), offset});
        offset += static_cast<std::size_t>(attribute.components) * sizeof(float);
    }
}

std::size_t MeshBuffers::Ordered::add(const MeshBuffers& meshes, std::size_t mesh,
                                      std::span<const std::uint32_t> triangles) {
    const std::size_t first = indices_.size();
    const std::uint32_t* const from =
        meshes.indexCopy_.data() + meshes.ranges_[mesh].firstIndexByte / sizeof(std::uint32_t);
    QX_CHECK_EQ(triangles.size(), meshes.triangleCount(mesh));
    indices_.reserve(first + 3 * triangles.size());
    for (const std::uint32_t triangle : triangles)
        indices_.insert(indices_.end(), from + std::size_t{3} * triangle,
                        from + std::size_t{3} * triangle + 3);
    return first;
}

void MeshBuffers::Ordered::send(const MeshBuffers& meshes) {
    if (indices_.empty())
        return;
    if (!buffer_) {
        buffer_ = gl::Buffer("ordered indices", GL_ARRAY_BUFFER, {}, GL_DYNAMIC_DRAW);
        for (const Store& store : meshes.stores_) {
            gl::VertexArray& array = arrays_.emplace_back("ordered");
            attach(store, array);
            array.indices(buffer_);
        }
    }
    if (indices_ == sent_)
        return;
    buffer_.upload(bytesOf(indices_));
    sent_ = indices_;
}

void MeshBuffers::Ordered::bind(const MeshBuffers& meshes, std::size_t mesh) const {
    arrays_[meshes.ranges_[mesh].store].bind();
}

void MeshBuffers::Ordered::draw(const MeshBuffers& meshes, std::size_t mesh, std::size_t first) const {
    const Range& range = meshes.ranges_[mesh];
    glDrawElementsBaseVertex(GL_TRIANGLES, range.indexCount, GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(first * sizeof(std::uint32_t)), range.baseVertex);
}

void MeshBuffers::bind(std::size_t mesh) const {
    stores_[ranges_[mesh].store].vertexArray.bind();
}

void MeshBuffers::draw(std::size_t mesh) const {
    const Range& range = ranges_[mesh];
    glDrawElementsBaseVertex(GL_TRIANGLES, range.indexCount, GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(range.firstIndexByte), range.baseVertex);
}

void MeshBuffers::drawInstanced(std::size_t mesh, std::size_t count) const {
    const Range& range = ranges_[mesh];
    glDrawElementsInstancedBaseVertex(GL_TRIANGLES, range.indexCount, GL_UNSIGNED_INT,
                                      reinterpret_cast<const void*>(range.firstIndexByte),
                                      static_cast<GLsizei>(count), range.baseVertex);
}

std::uint64_t MeshBuffers::bytes() const {
    std::uint64_t sum = indices_.size();
    for (const Store& store : stores_)
        sum += store.vertices.size();
    return sum;
}

SceneBuffers::SceneBuffers(const Scene& scene, Layout layout)
    : objectBuffer_("object blocks", GL_UNIFORM_BUFFER, {}, GL_DYNAMIC_DRAW) {
    std::vector<Draw> byMesh(scene.meshes.size());
    std::vector<std::uint64_t> vertexCounts(scene.meshes.size());
    if (layout == Layout::shared) {
        shared_.emplace(scene.meshes, std::vector<VertexExtras>(scene.meshes.size()));
        for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
            byMesh[m].mesh = m;
            vertexCounts[m] = shared_->vertexCount(m);
        }
    } else {
        std::vector<FacetVertex> facets;
        for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
            const std::vector<FacetVertex> vertices = facetVertices(scene.meshes[m]);
            byMesh[m].mesh = m;
            byMesh[m].firstVertex = static_cast<GLint>(facets.size());
            byMesh[m].vertexCount = static_cast<GLsizei>(vertices.size());
            vertexCounts[m] = vertices.size();
            facets.insert(facets.end(), vertices.begin(), vertices.end());
        }
        using Attribute = gl::VertexArray::Attribute;
        facets_ = gl::Buffer("facets", GL_ARRAY_BUFFER, bytesOf(facets));
        facetArray_ = gl::VertexArray("facets");
        constexpr GLsizei stride = sizeof(FacetVertex);
        facetArray_.attribute(facets_, Attribute{positionLocation, 3, GL_FLOAT, false, stride, 0});
        facetArray_.attribute(facets_, Attribute{normalLocation, 3, GL_FLOAT, false, stride,
                                                 offsetof(FacetVertex, planeNormal)});
        facetArray_.attribute(facets_, Attribute{texcoordLocation, 2, GL_FLOAT, false, stride,
                                                 offsetof(FacetVertex, texcoord)});
        facetArray_.attribute(facets_, Attribute{centroidLocation, 3, GL_FLOAT, false, stride,
                                                 offsetof(FacetVertex, centroid)});
    }

    textures_.resize(scene.textures.size());
    for (const Instance& instance : scene.instances) {
        const auto& use = scene.materials[instance.material].baseColorTexture;
        if (use && !textures_[use->texture])
            textures_[use->texture] = makeTexture(scene.textures[use->texture]);
    }
    Image8 white(1, 1, 4, Encoding::linear);
    std::fill(white.data.begin(), white.data.end(), std::uint8_t{255});
    textures_.emplace_back("white", white);
    textures_.back().setFilter(GL_NEAREST, GL_NEAREST);

    for (const Instance& instance : scene.instances) {
        draws_.push_back(byMesh[instance.mesh]);
        const Material& material = scene.materials[instance.material];
        draws_.back().texture = &textures_[material.baseColorTexture ? material.baseColorTexture->texture
                                                                     : scene.textures.size()];
        vertexCount_ += vertexCounts[instance.mesh];
        triangleCount_ += scene.meshes[instance.mesh].triangleCount();
    }
}

void SceneBuffers::update(const FrameBlock& frame, const std::vector<ObjectBlock>& objects) {
    frame_.update(frame);
    updateObjects(objects);
}

void SceneBuffers::updateObjects(const std::vector<ObjectBlock>& objects) {
    QX_CHECK_EQ(objects.size(), draws_.size());
    const auto bytesOf = [](const std::vector<ObjectBlock>& blocks) {
        return std::as_bytes(std::span(blocks));
    };
    const bool same = std::ranges::equal(bytesOf(objects), bytesOf(objects_));
    if (!same) {
        objects_ = objects;
        objectBuffer_.upload(bytesOf(objects_));
    }
}

void SceneBuffers::bindFrame() const {
    frame_.bind();
}

void SceneBuffers::bindVertices() const {
    if (!shared_)
        facetArray_.bind();
    else if (shared_->size() > 0)
        shared_->bind(0);
}

void SceneBuffers::draw(std::size_t instance) const {
    const Draw& draw = draws_[instance];
    draw.texture->bind(0);
    objectBuffer_.bindUniform(objectBinding, instance * sizeof(ObjectBlock), sizeof(ObjectBlock));
    if (shared_)
        shared_->draw(draw.mesh);
    else
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
}

}  // namespace quincunx

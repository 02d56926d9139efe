#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <span>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "geometry/normals.h"
#include "geometry/tangent_frames.h"
#include "image/io.h"
#include "math/trs.h"
#include "math/vector.h"
#include "scene/animation.h"
#include "scene/gltf_buffers.h"
#include "scene/gltf_json.h"
#include "scene/import_formats.h"
#include "scene/import_support.h"
#include "scene/placement.h"

namespace quincunx {

namespace {

constexpr std::array supportedExtensions{"KHR_lights_punctual",   "KHR_materials_emissive_strength",
                                         "KHR_materials_ior",     "KHR_materials_transmission",
                                         "KHR_mesh_quantization", "KHR_texture_transform"};

bool supported(const std::string& extension) {
    return std::find(supportedExtensions.begin(), supportedExtensions.end(), extension) !=
           supportedExtensions.end();
}

std::optional<JsonView> extension(const JsonView& json, const char* name) {
    const auto extensions = json.find("extensions");
    return extensions ? extensions->find(name) : std::nullopt;
}

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
constexpr std::size_t attributeCount = 6;
constexpr std::size_t texcoordSlots = 2;

/// What a drawn part of a mesh is made of: parts made of the same are made once.
struct PartKey {
    std::array<std::size_t, attributeCount> attributes{};  ///< accessors
    std::size_t indices = none;
    std::size_t mode = 0;
    int madeTangentsFor = -1;  ///< the texture coordinates of a normal map that tangents are made for
    std::array<float, 6> normalMatrix{};
    auto operator<=>(const PartKey&) const = default;
};

/// Numbers between 0 and 1, as a factor of a material.
float unitNumber(double number) {
    return static_cast<float>(std::clamp(number, 0.0, 1.0));
}

glm::vec3 nonNegative(const std::array<double, 3>& c) {
    return glm::vec3(glm::max(glm::dvec3(c[0], c[1], c[2]), 0.0));
}

/// Numbers of our own that glTF has no place for (exportScene writes them).
std::optional<JsonView> ownExtras(const JsonView& json) {
    const auto extras = json.find("extras");
    // Others may keep anything there.
    return extras && extras->isObject() ? extras->find("quincunx") : std::nullopt;
}

class GltfReader {
  public:
    GltfReader(std::string_view contents, const std::filesystem::path& file)
        : where_(printable(file.string())),
          folder_(file.parent_path()),
          most_((std::size_t{1} << 16) + contents.size()),
          container_(openGltf(contents, where_)),
          document_(parseBoundedJson(container_.json, where_)),
          root_(ofVersionTwo(JsonView(document_, where_), where_)),
          buffers_(root_, container_.binary, folder_, contents.size()),
          shelf_(scene_, warnings_) {
        scene_.name = file.stem().string();
    }

    ImportedScene read() {
        checkRequiredExtensions();
        if (root_.countOf("skins") > 0)
            warnings_.add("skins are not drawn: meshes stay as they were modelled");
        readTextures();
        readMaterials();
        readNodes();
        if (scene_.triangleCount() == 0)
            throw InputError("holds no triangles", where_, "use a model with triangles");
        return {std::move(scene_), warnings_.lines()};
    }

  private:
    /// `root`, once it is known to be laid out as the rest of this file expects.
    static JsonView ofVersionTwo(const JsonView& root, const std::string& where) {
        const auto version = root.at("asset").find("version");
        if (!version || !version->string().starts_with("2."))
            throw InputError(
                fmt::format("glTF of version {}", version ? printable(version->string(), 20) : "1"), where,
                "convert it to glTF 2.0");
        return root;
    }

    void checkRequiredExtensions() {
        if (const auto required = root_.find("extensionsRequired"))
            for (std::size_t i = 0; i < required->size(); ++i)
                if (const std::string name = (*required)[i].string(); !supported(name))
                    throw InputError(
                        fmt::format("requires the extension {}, which is not supported", printable(name, 80)),
                        where_, "export the model without it");
        if (const auto used = root_.find("extensionsUsed"))
            for (std::size_t i = 0; i < used->size(); ++i)
                if (const std::string name = (*used)[i].string(); !supported(name))
                    warnings_.add(fmt::format("drawn without the extension {}", printable(name, 80)));
    }

    // Materials ------------------------------------------------------------------------------------------

    struct TextureKey {
        std::size_t index;
        Encoding encoding;
        auto operator<=>(const TextureKey&) const = default;
    };

    /// Calls `visit` with every texture that a material refers to, and what its numbers are.
    template <typename Visit>
    void forEachTexture(const JsonView& material, const Visit& visit) {
        if (const auto pbr = material.find("pbrMetallicRoughness")) {
            if (const auto texture = pbr->find("baseColorTexture"))
                visit(*texture, Encoding::srgb);
            if (const auto texture = pbr->find("metallicRoughnessTexture"))
                visit(*texture, Encoding::linear);
        }
        if (const auto texture = material.find("emissiveTexture"))
            visit(*texture, Encoding::srgb);
        for (const char* key : {"normalTexture", "occlusionTexture"})
            if (const auto texture = material.find(key))
                visit(*texture, Encoding::linear);
    }

    /// The textures in use, in the order of the file. One that is used as colour and as numbers becomes two.
    void readTextures() {
        std::set<TextureKey> used;
        for (std::size_t i = 0; i < root_.countOf("materials"); ++i)
            forEachTexture(root_.entry("materials", i), [&](const JsonView& reference, Encoding encoding) {
                used.insert({reference.at("index").index(), encoding});
            });
        for (const TextureKey& key : used)
            textures_[key] = readTexture(root_.entry("textures", key.index), key.encoding);
    }

    void readMaterials() {
        const std::size_t count = root_.countOf("materials");
        texcoordSets_.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            scene_.materials.push_back(readMaterial(root_.entry("materials", i), i));
    }

    static glm::vec4 unitColor(const std::array<double, 4>& c) {
        return glm::vec4(glm::clamp(glm::dvec4(c[0], c[1], c[2], c[3]), 0.0, 1.0));
    }

    Material readMaterial(const JsonView& json, std::size_t index) {
        Material material;
        material.name = printable(json.stringOr("name", fmt::format("material {}", index)));
        material.metallic = 1;
        material.roughness = 1;
        TexcoordSets& sets = texcoordSets_[index];
        sets = texcoordSetsOf(json);
        if (const auto pbr = json.find("pbrMetallicRoughness")) {
            if (const auto color = pbr->numbers<4>("baseColorFactor"))
                material.baseColor = unitColor(*color);
            material.metallic = unitNumber(pbr->numberOr("metallicFactor", 1));
            material.roughness = unitNumber(pbr->numberOr("roughnessFactor", 1));
            if (const auto texture = pbr->find("baseColorTexture"))
                material.baseColorTexture = readUse(*texture, Encoding::srgb, sets);
            if (const auto texture = pbr->find("metallicRoughnessTexture"))
                material.metallicRoughnessTexture = readUse(*texture, Encoding::linear, sets);
        }
        if (const auto emission = json.numbers<3>("emissiveFactor")) {
            const auto strengthened = extension(json, "KHR_materials_emissive_strength");
            const double strength = strengthened ? strengthened->numberOr("emissiveStrength", 1) : 1;
            material.emission = glm::vec3(glm::clamp(
                glm::dvec3((*emission)[0], (*emission)[1], (*emission)[2]) * strength, 0.0, mostEmission));
        }
        if (const auto texture = json.find("emissiveTexture")) {
            material.emissionTexture = readUse(*texture, Encoding::srgb, sets);
            // The factor is the brightest that the texture makes of it, mostly in few places.
            if (!material.emissionTexture)
                material.emission = glm::vec3(0);
        }
        if (const auto texture = json.find("normalTexture")) {
            material.normalTexture = readUse(*texture, Encoding::linear, sets);
            material.normalScale = static_cast<float>(texture->numberOr("scale", 1));
        }
        if (const auto texture = json.find("occlusionTexture")) {
            material.occlusionTexture = readUse(*texture, Encoding::linear, sets);
            material.occlusionStrength = unitNumber(texture->numberOr("strength", 1));
        }
        const std::string alphaMode = json.stringOr("alphaMode", "OPAQUE");
        if (alphaMode == "MASK")
            material.alphaMode = Material::AlphaMode::mask;
        else if (alphaMode == "BLEND")
            material.alphaMode = Material::AlphaMode::blend;
        material.alphaCutoff = static_cast<float>(std::max(json.numberOr("alphaCutoff", 0.5), 0.0));
        material.doubleSided = json.booleanOr("doubleSided", false);
        if (const auto glass = extension(json, "KHR_materials_transmission")) {
            material.transmission = unitNumber(glass->numberOr("transmissionFactor", 0));
            if (glass->has("transmissionTexture"))
                warnings_.add("textures of transmission are not read: their factor holds everywhere");
            if (material.transmission > 0)
                warnings_.add("glass is drawn opaque: light goes through it where paths are traced");
        }
        if (const auto glass = extension(json, "KHR_materials_ior")) {
            // 0 stands for an index beyond all bounds, which mirrors everything.
            const double ior = glass->numberOr("ior", 1.5);
            material.ior = static_cast<float>(ior == 0 ? mostIor : std::clamp(ior, 1.0, mostIor));
        }
        fillPhong(material);
        if (const auto own = ownExtras(json)) {
            if (const auto ambient = own->numbers<3>("ambient"))
                material.ambient = nonNegative(*ambient);
            if (const auto diffuse = own->numbers<3>("diffuse"))
                material.diffuse = nonNegative(*diffuse);
            if (const auto specular = own->numbers<3>("specular"))
                material.specular = nonNegative(*specular);
            material.shininess =
                static_cast<float>(std::max(own->numberOr("shininess", material.shininess), 0.0));
        }
        return material;
    }

    /// The Phong numbers; those of a metallic–roughness texture enter with their average.
    void fillPhong(Material& material) {
        Material average = material;
        if (material.metallicRoughnessTexture) {
            const std::size_t texture = material.metallicRoughnessTexture->texture;
            const auto [entry, isNew] = averages_.try_emplace(texture, 1, 1);
            if (isNew)
                entry->second = averageGreenAndBlue(scene_.textures[texture].image);
            average.roughness *= entry->second.x;
            average.metallic *= entry->second.y;
        }
        fillPhongFromMetallicRoughness(average);
        material.ambient = average.ambient;
        material.diffuse = average.diffuse;
        material.specular = average.specular;
        material.shininess = average.shininess;
    }

    /// Grey pictures have it in all three.
    static glm::vec2 averageGreenAndBlue(const Image8& pixels) {
        if (pixels.pixelCount() == 0)
            return glm::vec2(1);
        std::uint64_t green = 0;
        std::uint64_t blue = 0;
        const auto stride = static_cast<std::size_t>(pixels.channels);
        const bool isColor = stride >= 3;
        for (std::size_t i = 0; i < pixels.data.size(); i += stride) {
            green += pixels.data[i + (isColor ? 1 : 0)];
            blue += pixels.data[i + (isColor ? 2 : 0)];
        }
        const double whole = 255 * static_cast<double>(pixels.pixelCount());
        return {static_cast<double>(green) / whole, static_cast<double>(blue) / whole};
    }

    /// Which of a file's sets of texture coordinates become the mesh's two, for a material.
    struct TexcoordSets {
        std::array<std::size_t, texcoordSlots> set{0, 1};
        auto operator<=>(const TexcoordSets&) const = default;
    };

    /// The set that a reference asks for.
    static std::size_t texcoordSetOf(const JsonView& reference) {
        const std::size_t set = reference.indexOr("texCoord", 0);
        const auto transform = extension(reference, "KHR_texture_transform");
        return transform ? transform->indexOr("texCoord", set) : set;
    }

    /// The first two, unless the material asks for others: the first two that it asks for.
    TexcoordSets texcoordSetsOf(const JsonView& material) {
        std::vector<std::size_t> asked;
        forEachTexture(material, [&](const JsonView& reference, Encoding) {
            if (const std::size_t set = texcoordSetOf(reference);
                std::find(asked.begin(), asked.end(), set) == asked.end())
                asked.push_back(set);
        });
        TexcoordSets sets;
        if (std::any_of(asked.begin(), asked.end(), [](std::size_t set) { return set >= texcoordSlots; }))
            for (std::size_t slot = 0; slot < texcoordSlots; ++slot)
                sets.set[slot] = slot < asked.size() ? asked[slot] : none;
        return sets;
    }

    /// What a material makes of a texture; none if there is no such picture.
    std::optional<TextureUse> readUse(const JsonView& reference, Encoding encoding,
                                      const TexcoordSets& sets) {
        const auto texture = textures_.at({reference.at("index").index(), encoding});
        if (!texture)
            return {};
        TextureUse use(*texture);
        const auto slot = std::find(sets.set.begin(), sets.set.end(), texcoordSetOf(reference));
        if (slot == sets.set.end()) {
            warnings_.add("textures by a third set of texture coordinates are not drawn");
            return {};
        }
        use.texcoordSet = static_cast<int>(slot - sets.set.begin());
        if (const auto transform = extension(reference, "KHR_texture_transform"))
            use.textureFromTexcoord = textureTransform(*transform);
        return use;
    }

    static glm::mat3 textureTransform(const JsonView& json) {
        if (const auto own = ownExtras(json))
            if (const auto m = own->numbers<6>("textureFromTexcoord"))
                return glm::mat3(glm::dmat3((*m)[0], (*m)[1], 0, (*m)[2], (*m)[3], 0, (*m)[4], (*m)[5], 1));
        const auto offset = json.numbers<2>("offset").value_or(std::array<double, 2>{0, 0});
        const auto scale = json.numbers<2>("scale").value_or(std::array<double, 2>{1, 1});
        return textureTransformMatrix({offset[0], offset[1]}, json.numberOr("rotation", 0),
                                      {scale[0], scale[1]});
    }

    Texture::Wrap readWrap(const JsonView& sampler, const char* key) {
        switch (sampler.indexOr(key, 10497)) {
            case 33071:
                return Texture::Wrap::clampToEdge;
            case 33648:
                return Texture::Wrap::mirroredRepeat;
            default:
                return Texture::Wrap::repeat;
        }
    }

    std::optional<std::size_t> imageOf(const JsonView& texture) {
        const auto source = texture.optionalIndex("source");
        if (!source)
            warnings_.add("textures of formats other than PNG and JPEG are not drawn");
        return source;
    }

    static void readFilters(const JsonView& sampler, Texture& texture) {
        using Filter = Texture::Filter;
        using Mipmaps = Texture::Mipmaps;
        if (sampler.indexOr("magFilter", 9729) == 9728)
            texture.magnification = Filter::nearest;
        switch (sampler.indexOr("minFilter", 9987)) {
            case 9728:
                texture.minification = Filter::nearest;
                texture.mipmaps = Mipmaps::none;
                break;
            case 9729:
                texture.mipmaps = Mipmaps::none;
                break;
            case 9984:
                texture.minification = Filter::nearest;
                texture.mipmaps = Mipmaps::nearest;
                break;
            case 9985:
                texture.mipmaps = Mipmaps::nearest;
                break;
            case 9986:
                texture.minification = Filter::nearest;
                break;
            default:
                break;
        }
    }

    std::optional<std::size_t> readTexture(const JsonView& json, Encoding encoding) {
        const auto image = imageOf(json);
        if (!image)
            return {};
        Texture like;
        if (const auto sampler = json.optionalIndex("sampler")) {
            const JsonView entry = root_.entry("samplers", *sampler);
            like.wrapS = readWrap(entry, "wrapS");
            like.wrapT = readWrap(entry, "wrapT");
            readFilters(entry, like);
        }
        const JsonView picture = root_.entry("images", *image);
        like.name = printable(picture.stringOr("name", nameOfImage(picture, *image)));
        return shelf_.texture(keyOfImage(picture, *image), like, encoding,
                              [&] { return decode(picture, *image); });
    }

    /// Tells pictures apart: files are read once even where several entries name them.
    static std::string keyOfImage(const JsonView& json, std::size_t index) {
        if (const auto uri = json.find("uri"))
            if (std::string name = uri->string(); !name.starts_with("data:"))
                return "file " + name;
        return fmt::format("image {}", index);
    }

    std::string nameOfImage(const JsonView& json, std::size_t index) const {
        if (const auto uri = json.find("uri"))
            if (std::string name = uri->string(); !name.starts_with("data:"))
                return printable(name);
        return fmt::format("image {}", index);
    }

    Image8 decode(const JsonView& json, std::size_t index) {
        std::string storage;
        std::string_view bytes;
        if (const auto uri = json.find("uri")) {
            storage = buffers_.resolve(*uri);
            bytes = storage;
        } else {
            bytes = buffers_.view(json.at("bufferView").index()).bytes;
        }
        return readImage8FromMemory(std::as_bytes(std::span(bytes)),
                                    fmt::format("{}: {}", where_, nameOfImage(json, index)));
    }

    /// The index of the material for primitives that name none.
    std::size_t defaultMaterial() {
        if (!defaultMaterial_) {
            defaultMaterial_ = scene_.materials.size();
            Material material;
            material.name = "default";
            material.metallic = 0;
            material.baseColor = glm::vec4(0.8f, 0.8f, 0.8f, 1);
            fillPhongFromMetallicRoughness(material);
            scene_.materials.push_back(material);
        }
        return *defaultMaterial_;
    }

    // Meshes ---------------------------------------------------------------------------------------------

    struct Part {
        std::size_t mesh;
        std::size_t material;
    };

    const std::vector<Part>& partsOfMesh(std::size_t index) {
        const auto known = parts_.find(index);
        if (known != parts_.end())
            return known->second;
        throwIfInterrupted();
        const JsonView mesh = root_.entry("meshes", index);
        const std::string name = printable(mesh.stringOr("name", fmt::format("mesh {}", index)));
        std::vector<Part> parts;
        const JsonView primitives = mesh.at("primitives");
        for (std::size_t i = 0; i < primitives.size(); ++i)
            if (const auto part = readPrimitive(primitives[i], name))
                parts.push_back(*part);
        return parts_[index] = std::move(parts);
    }

    std::optional<Part> readPrimitive(const JsonView& json, const std::string& name) {
        const std::size_t mode = json.indexOr("mode", 4);
        if (mode > 6)
            json.fail("has a mode that glTF 2.0 does not know");
        if (mode < 4) {
            warnings_.add(mode == 0 ? "points are not drawn" : "lines are not drawn");
            return {};
        }
        if (json.has("targets"))
            warnings_.add("morph targets are not drawn");
        const JsonView attributes = json.at("attributes");
        const auto positions = attributes.find("POSITION");
        if (!positions) {
            warnings_.add("primitives without positions are not drawn");
            return {};
        }
        PartKey key;
        key.mode = mode;
        key.indices = json.optionalIndex("indices").value_or(none);
        std::size_t material = 0;
        TexcoordSets sets;
        if (const auto named = json.optionalIndex("material")) {
            if (*named >= texcoordSets_.size())
                json.fail(fmt::format("names material {}, which is not there", *named));
            material = *named;
            sets = texcoordSets_[material];
        } else {
            material = defaultMaterial();
        }
        const AttributeNames names = attributeNames(sets);
        for (std::size_t i = 0; i < attributeCount; ++i)
            key.attributes[i] =
                names[i].empty() ? none : attributes.optionalIndex(names[i].c_str()).value_or(none);
        const std::optional<TextureUse>& normalMap = scene_.materials[material].normalTexture;
        if (normalMap && key.attributes[tangentAttribute] == none) {
            const glm::mat3& m = normalMap->textureFromTexcoord;
            key.madeTangentsFor = normalMap->texcoordSet;
            key.normalMatrix = {m[0].x, m[0].y, m[1].x, m[1].y, m[2].x, m[2].y};
        }
        const auto known = meshes_.find(key);
        if (known != meshes_.end())
            return Part{known->second, material};
        Mesh mesh = makeMesh(json, attributes, names, mode, normalMap);
        if (mesh.indices.empty())
            return {};
        mesh.name = name;
        scene_.meshes.push_back(std::move(mesh));
        meshes_[key] = scene_.meshes.size() - 1;
        return Part{scene_.meshes.size() - 1, material};
    }

    /// In the order of PartKey::attributes.
    using AttributeNames = std::array<std::string, attributeCount>;
    static constexpr std::size_t tangentAttribute = 4;
    static AttributeNames attributeNames(const TexcoordSets& sets) {
        const auto texcoord = [&](std::size_t slot) {
            return sets.set[slot] == none ? "" : fmt::format("TEXCOORD_{}", sets.set[slot]);
        };
        return {"POSITION", "NORMAL", texcoord(0), texcoord(1), "TANGENT", "COLOR_0"};
    }

    /// What the file says of vertices; null where it says nothing.
    struct Vertices {
        const std::vector<glm::vec3>* positions = nullptr;
        const std::vector<glm::vec3>* normals = nullptr;
        const std::vector<glm::vec2>* texcoords = nullptr;
        const std::vector<glm::vec2>* texcoords1 = nullptr;
        const std::vector<glm::vec4>* tangents = nullptr;
        const std::vector<glm::vec4>* colors = nullptr;
    };

    Vertices readVertices(const JsonView& attributes, const AttributeNames& names) {
        Vertices v;
        const JsonView positionReference = attributes.at("POSITION");
        v.positions = &buffers_.vec3s(positionReference);
        const auto bad = std::find_if_not(v.positions->begin(), v.positions->end(),
                                          [](const glm::vec3& p) { return isFinite(p); });
        if (bad != v.positions->end())
            positionReference.fail(
                fmt::format("has a position, number {}, that is not finite", bad - v.positions->begin()));
        const auto take = [&](const std::string& name, auto*& values, const auto& read) {
            const auto reference = name.empty() ? std::nullopt : attributes.find(name.c_str());
            if (!reference)
                return;
            values = &read(*reference);
            if (values->size() != v.positions->size())
                reference->fail("has another number of elements than the positions");
        };
        using Reference = const JsonView&;
        const auto vec2s = [&](Reference r) -> const std::vector<glm::vec2>& { return buffers_.vec2s(r); };
        const auto vec3s = [&](Reference r) -> const std::vector<glm::vec3>& { return buffers_.vec3s(r); };
        const auto vec4s = [&](Reference r) -> const std::vector<glm::vec4>& { return buffers_.vec4s(r); };
        const auto colors = [&](Reference r) -> const std::vector<glm::vec4>& { return buffers_.colors(r); };
        take(names[1], v.normals, vec3s);
        take(names[2], v.texcoords, vec2s);
        take(names[3], v.texcoords1, vec2s);
        take(names[tangentAttribute], v.tangents, vec4s);
        take(names[5], v.colors, colors);
        return v;
    }

    Mesh makeMesh(const JsonView& json, const JsonView& attributes, const AttributeNames& names,
                  std::size_t mode, const std::optional<TextureUse>& normalMap) {
        Vertices vertices = readVertices(attributes, names);
        const std::size_t vertexCount = vertices.positions->size();
        // Made normals do not go with the file's tangents (glTF 2.0, section 3.7.2.1).
        if (!vertices.normals)
            vertices.tangents = nullptr;
        Mesh mesh;
        std::vector<std::uint32_t> corners;
        if (const auto reference = json.find("indices")) {
            corners = buffers_.indices(*reference);
            for (const std::uint32_t corner : corners)
                if (corner >= vertexCount)
                    reference->fail(fmt::format("names vertex {} of only {}", corner, vertexCount));
        } else {
            buffers_.charge(vertexCount * sizeof(std::uint32_t), json);
            corners.resize(vertexCount);
            std::iota(corners.begin(), corners.end(), 0u);
        }
        mesh.indices = triangles(std::move(corners), mode, json);
        takeVertices(mesh, vertices, json);
        if (!vertices.normals) {
            buffers_.charge(mesh.indices.size() * bytesOfVertex(mesh), json);
            makeFlatNormals(mesh);
        } else {
            mendNormals(mesh);
        }
        if (vertices.tangents) {
            mendTangents(mesh);
        } else if (normalMap) {
            // Sums while they are made, and twice the vertices at most.
            buffers_.charge(mesh.positions.size() * (bytesOfVertex(mesh) + 96), json);
            makeTangents(mesh, normalMap->texcoordSet, normalMap->textureFromTexcoord);
        }
        return mesh;
    }

    static std::size_t bytesOfVertex(const Mesh& mesh) {
        return sizeof(glm::vec3) * 2 + (mesh.texcoords.empty() ? 0 : sizeof(glm::vec2)) +
               (mesh.texcoords1.empty() ? 0 : sizeof(glm::vec2)) +
               (mesh.colors.empty() ? 0 : sizeof(glm::vec4));
    }

    /// Separate triangles of a list, a strip or a fan (glTF 2.0, section 3.7.2.1).
    std::vector<std::uint32_t> triangles(std::vector<std::uint32_t> corners, std::size_t mode,
                                         const JsonView& json) {
        if (mode == 4) {
            if (corners.size() % 3 != 0)
                warnings_.add("triangles that lack a corner are not drawn");
            corners.resize(corners.size() / 3 * 3);
            return corners;
        }
        const std::size_t count = corners.size() < 3 ? 0 : corners.size() - 2;
        buffers_.charge(3 * count * sizeof(std::uint32_t), json);
        std::vector<std::uint32_t> list;
        list.reserve(3 * count);
        for (std::size_t i = 0; i < count; ++i) {
            if (mode == 5)
                list.insert(list.end(), {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
            else
                list.insert(list.end(), {corners[i + 1], corners[i + 2], corners[0]});
        }
        return list;
    }

    /// Copies the vertices into the mesh; only those in use, if the mesh uses few of a large common store.
    void takeVertices(Mesh& mesh, const Vertices& vertices, const JsonView& json) {
        std::vector<std::uint32_t> used;
        if (mesh.indices.size() < vertices.positions->size()) {
            used = mesh.indices;
            std::sort(used.begin(), used.end());
            used.erase(std::unique(used.begin(), used.end()), used.end());
            for (std::uint32_t& index : mesh.indices)
                index = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), index) -
                                                   used.begin());
        } else {
            used.resize(vertices.positions->size());
            std::iota(used.begin(), used.end(), 0u);
        }
        const auto take = [&](auto& to, const auto* from) {
            if (!from)
                return;
            buffers_.charge(used.size() * sizeof(to[0]), json);
            to.reserve(used.size());
            for (const std::uint32_t vertex : used)
                to.push_back((*from)[vertex]);
        };
        take(mesh.positions, vertices.positions);
        take(mesh.normals, vertices.normals);
        take(mesh.texcoords, vertices.texcoords);
        take(mesh.texcoords1, vertices.texcoords1);
        take(mesh.tangents, vertices.tangents);
        take(mesh.colors, vertices.colors);
        for (std::vector<glm::vec2>* texcoords : {&mesh.texcoords, &mesh.texcoords1})
            for (glm::vec2& t : *texcoords)
                if (!std::isfinite(t.x) || !std::isfinite(t.y))
                    t = glm::vec2(0);
    }

    /// Brings normals to unit length; those without a direction are made.
    static void mendNormals(Mesh& mesh) {
        std::vector<std::size_t> missing;
        for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
            if (const auto unit = unitOrAsItIs(glm::dvec3(mesh.normals[i])))
                mesh.normals[i] = *unit;
            else
                missing.push_back(i);
        }
        if (missing.empty())
            return;
        const std::vector<glm::vec3> made =
            smoothNormals(mesh.positions, mesh.indices, mesh.indices, mesh.positions.size());
        for (const std::size_t i : missing)
            mesh.normals[i] = made[i];
    }

    /// Brings tangents to unit length, their signs to 1 or −1; those without a direction become some
    /// perpendicular of the normal.
    static void mendTangents(Mesh& mesh) {
        for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
            glm::vec4& tangent = mesh.tangents[i];
            std::optional<glm::vec3> unit = unitOrAsItIs(glm::dvec3(glm::vec3(tangent)));
            if (!unit)
                if (const auto basis = basisAround(mesh.normals[i]))
                    unit = (*basis)[0];
            tangent = glm::vec4(unit.value_or(glm::vec3(1, 0, 0)), tangent.w < 0 ? -1.0f : 1.0f);
        }
    }

    // Nodes ----------------------------------------------------------------------------------------------

    static glm::dmat4 localTransform(const JsonView& node) {
        if (const auto m = node.numbers<16>("matrix")) {
            glm::dmat4 matrix;
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    matrix[column][row] = (*m)[static_cast<std::size_t>(4 * column + row)];
            return matrix;
        }
        const auto t = node.numbers<3>("translation").value_or(std::array<double, 3>{0, 0, 0});
        const auto q = node.numbers<4>("rotation").value_or(std::array<double, 4>{0, 0, 0, 1});
        const auto s = node.numbers<3>("scale").value_or(std::array<double, 3>{1, 1, 1});
        if (q == std::array<double, 4>{0, 0, 0, 0})
            node.fail("has a rotation of zero length");
        return composedFrame({t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}, {s[0], s[1], s[2]});
    }

    /// A node that moves, or from which one hangs that does.
    static Node keptNode(const JsonView& json, bool isMoved) {
        Node node;
        node.name = printable(json.stringOr("name", ""));
        if (json.has("matrix")) {
            const glm::mat4 matrix(localTransform(json));
            if (!isMoved) {
                node.matrix = matrix;
                return node;
            }
            // Not allowed by section 3.5.3. Shear, which keys cannot keep, is lost.
            const std::optional<Trs> parts = decompose(matrix);
            if (!parts)
                json.fail("has a matrix that cannot be animated");
            node.translation = parts->translation;
            node.rotation = glm::quat_cast(parts->rotation);
            node.scale = parts->scale;
            return node;
        }
        if (const auto t = json.numbers<3>("translation"))
            node.translation = glm::vec3(glm::dvec3((*t)[0], (*t)[1], (*t)[2]));
        if (const auto q = json.numbers<4>("rotation"))
            node.rotation = glm::quat(static_cast<float>((*q)[3]), static_cast<float>((*q)[0]),
                                      static_cast<float>((*q)[1]), static_cast<float>((*q)[2]));
        if (node.rotation == glm::quat(0, 0, 0, 0))
            json.fail("has a rotation of zero length");
        if (const auto s = json.numbers<3>("scale"))
            node.scale = glm::vec3(glm::dvec3((*s)[0], (*s)[1], (*s)[2]));
        return node;
    }

    Environment readEnvironment(const JsonView& json) {
        const std::size_t width = json.at("width").index();
        const std::size_t height = json.at("height").index();
        const std::string_view bytes = buffers_.view(json.at("bufferView").index()).bytes;
        constexpr std::size_t pixelBytes = 3 * sizeof(float);
        if (width < 1 || height < 1 || width > maxImageSide || height > maxImageSide ||
            bytes.size() != width * height * pixelBytes)
            json.fail("has another size than its pixels");
        buffers_.charge(bytes.size(), json);
        Environment environment;
        environment.panorama = Image(static_cast<int>(width), static_cast<int>(height), 3, Encoding::linear);
        std::memcpy(environment.panorama.data.data(), bytes.data(), bytes.size());
        for (const float value : environment.panorama.data)
            if (!std::isfinite(value))
                json.fail("has a pixel that is not finite");
        if (const auto tint = json.numbers<3>("tint"))
            environment.tint = nonNegative(*tint);
        return environment;
    }

    std::vector<std::size_t> rootNodes() {
        std::vector<std::size_t> roots;
        const std::size_t nodes = root_.countOf("nodes");
        if (root_.countOf("scenes") > 0) {
            const JsonView scene = root_.entry("scenes", root_.indexOr("scene", 0));
            scene_.name = printable(scene.stringOr("name", scene_.name));
            if (const auto own = ownExtras(scene)) {
                if (const auto ambient = own->numbers<3>("ambientLight"))
                    scene_.ambientLight = nonNegative(*ambient);
                if (const auto top = own->numbers<3>("backgroundTop"))
                    scene_.backgroundTop = nonNegative(*top);
                if (const auto bottom = own->numbers<3>("backgroundBottom"))
                    scene_.backgroundBottom = nonNegative(*bottom);
                if (const auto environment = own->find("environment"))
                    scene_.environment = readEnvironment(*environment);
            }
            if (const auto list = scene.find("nodes"))
                for (std::size_t i = 0; i < list->size(); ++i)
                    roots.push_back((*list)[i].index());
            return roots;
        }
        // Without scenes, all that hangs from no other node.
        std::vector<bool> isChild(nodes, false);
        for (std::size_t i = 0; i < nodes; ++i)
            if (const auto children = root_.entry("nodes", i).find("children"))
                for (std::size_t c = 0; c < children->size(); ++c)
                    if (const std::size_t child = (*children)[c].index(); child < nodes)
                        isChild[child] = true;
        for (std::size_t i = 0; i < nodes; ++i)
            if (!isChild[i])
                roots.push_back(i);
        return roots;
    }

    /// What is known of a node of the file.
    struct Place {
        std::size_t parent = none;
        bool isReached = false;
        bool isMoved = false;      ///< by a channel
        bool bearsThings = false;  ///< itself or below it
        std::size_t kept = none;   ///< its own node of the scene, or the nearest one above
        bool isKeptItself = false;
        glm::dmat4 keptFromNode{1};  ///< world_from_node where nothing above is kept
    };

    /// The nodes of the scene, each after its parent.
    std::vector<std::size_t> reachNodes() {
        std::vector<std::size_t> order;
        std::vector<std::size_t> open = rootNodes();
        std::reverse(open.begin(), open.end());
        while (!open.empty()) {
            const std::size_t index = open.back();
            open.pop_back();
            const JsonView node = root_.entry("nodes", index);
            if (places_[index].isReached)
                node.fail("hangs from two nodes, or from itself");
            places_[index].isReached = true;
            order.push_back(index);
            if (const auto children = node.find("children"))
                for (std::size_t i = children->size(); i-- > 0;) {
                    const std::size_t child = (*children)[i].index();
                    if (child >= places_.size())
                        node.fail(fmt::format("has a child {}, which is not there", child));
                    // A child of two is found out when it is reached for the second time.
                    places_[child].parent = index;
                    open.push_back(child);
                }
        }
        return order;
    }

    /// Which nodes the scene keeps: those that move and bear something, and those above them. They come in
    /// the file's order, as far as parents are before their children there.
    void keepNodes(const std::vector<std::size_t>& order) {
        std::vector<bool> isKept(places_.size(), false);
        for (std::size_t i = order.size(); i-- > 0;) {
            const std::size_t index = order[i];
            Place& place = places_[index];
            const JsonView node = root_.entry("nodes", index);
            place.bearsThings = place.bearsThings || node.has("mesh") || node.has("camera") ||
                                extension(node, "KHR_lights_punctual");
            if (place.isMoved && place.bearsThings)
                isKept[index] = true;
            if (place.parent != none) {
                places_[place.parent].bearsThings |= place.bearsThings;
                if (isKept[index])
                    isKept[place.parent] = true;
            }
        }
        std::vector<std::vector<std::size_t>> keptChildren(places_.size());
        std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready;
        for (const std::size_t index : order)
            if (isKept[index]) {
                if (const std::size_t parent = places_[index].parent; parent != none)
                    keptChildren[parent].push_back(index);
                else
                    ready.push(index);
            }
        while (!ready.empty()) {
            const std::size_t index = ready.top();
            ready.pop();
            Place& place = places_[index];
            Node node = keptNode(root_.entry("nodes", index), place.isMoved);
            if (place.parent != none)
                node.parent = places_[place.parent].kept;
            place.kept = scene_.nodes.size();
            worldFromKept_.push_back(place.parent == none ? restFrame(node)
                                                          : worldFromKept_[node.parent] * restFrame(node));
            isMovedKept_.push_back(place.isMoved || (place.parent != none && isMovedKept_[node.parent]));
            scene_.nodes.push_back(std::move(node));
            for (const std::size_t child : keptChildren[index])
                ready.push(child);
        }
    }

    void readNodes() {
        places_.resize(root_.countOf("nodes"));
        const std::vector<std::size_t> order = reachNodes();
        markMovedNodes();
        keepNodes(order);
        readAnimations();
        std::vector<std::size_t> bearers;
        std::set<std::size_t> meshes;
        for (const std::size_t index : order) {
            Place& place = places_[index];
            const JsonView node = root_.entry("nodes", index);
            // Products with the identity would turn −0 into 0.
            if (place.kept == none) {
                const glm::dmat4 local = localTransform(node);
                if (place.parent != none) {
                    const Place& parent = places_[place.parent];
                    place.kept = parent.kept;
                    const bool isRoot = parent.kept != none && places_[place.parent].isKeptItself;
                    place.keptFromNode = isRoot ? local : parent.keptFromNode * local;
                } else {
                    place.keptFromNode = local;
                }
            } else {
                place.isKeptItself = true;
            }
            if (place.bearsThings)
                bearers.push_back(index);
            if (const auto mesh = node.optionalIndex("mesh"))
                meshes.insert(*mesh);
        }
        for (const std::size_t mesh : meshes)
            partsOfMesh(mesh);
        std::sort(bearers.begin(), bearers.end());
        for (const std::size_t index : bearers)
            readNode(root_.entry("nodes", index), places_[index]);
        std::sort(scene_.attachments.begin(), scene_.attachments.end(),
                  [](const Attachment& a, const Attachment& b) {
                      return std::pair(a.thing, a.index) < std::pair(b.thing, b.index);
                  });
        poseAtRest(scene_);
    }

    void readNode(const JsonView& node, const Place& place) {
        const bool hangs = place.kept != none;
        const bool moves = hangs && isMovedKept_[place.kept];
        const glm::dmat4 worldFromNode =
            hangs ? worldFromKept_[place.kept] * place.keptFromNode : place.keptFromNode;
        if (!isFiniteAsFloat(worldFromNode) || !isFiniteAsFloat(place.keptFromNode))
            node.fail("has a transform that overflows");
        const glm::mat4 matrix(worldFromNode);
        const auto attach = [&](Attachment::Thing thing, std::size_t index) {
            if (moves)
                scene_.attachments.push_back({thing, index, place.kept, glm::mat4(place.keptFromNode)});
        };
        if (const auto mesh = node.optionalIndex("mesh"))
            for (const Part& part : partsOfMesh(*mesh)) {
                if (scene_.instances.size() == most_)
                    node.fail(fmt::format("makes more than {} instances", most_));
                const std::string& meshName = scene_.meshes[part.mesh].name;
                scene_.instances.push_back(
                    {printable(node.stringOr("name", meshName)), part.mesh, part.material, matrix});
                attach(Attachment::Thing::instance, scene_.instances.size() - 1);
            }
        if (const auto camera = node.optionalIndex("camera"))
            if (readCamera(root_.entry("cameras", *camera), worldFromNode))
                attach(Attachment::Thing::camera, scene_.cameras.size() - 1);
        if (const auto light = extension(node, "KHR_lights_punctual")) {
            const auto lights = extension(root_, "KHR_lights_punctual");
            if (!lights)
                light->fail("names a light of a file without lights");
            if (readLight(lights->entry("lights", light->at("light").index()), worldFromNode))
                attach(Attachment::Thing::light, scene_.lights.size() - 1);
        }
    }

    // Animations -----------------------------------------------------------------------------------------

    /// The node that a channel moves, if it moves one of the scene.
    std::optional<std::size_t> targetOf(const JsonView& channel) {
        const JsonView target = channel.at("target");
        const std::string path = target.at("path").string();
        const auto node = target.optionalIndex("node");
        if (node && *node >= places_.size())
            target.fail(fmt::format("names node {}, which is not there", *node));
        if (path == "weights") {
            warnings_.add("morph targets are not drawn");
            return {};
        }
        if (path != "translation" && path != "rotation" && path != "scale") {
            warnings_.add(fmt::format("animations of {} are not played", printable(path, 40)));
            return {};
        }
        return node && places_[*node].isReached ? node : std::nullopt;
    }

    template <typename Visit>
    void forEachChannel(const Visit& visit) {
        for (std::size_t a = 0; a < root_.countOf("animations"); ++a) {
            const JsonView animation = root_.entry("animations", a);
            const JsonView channels = animation.at("channels");
            for (std::size_t c = 0; c < channels.size(); ++c)
                if (const auto node = targetOf(channels[c]))
                    visit(a, channels[c], *node);
        }
    }

    void markMovedNodes() {
        forEachChannel([&](std::size_t, const JsonView&, std::size_t node) { places_[node].isMoved = true; });
    }

    void readAnimations() {
        /// Of one animation: channels that move what is kept, and the samplers that they name.
        struct Used {
            std::set<std::size_t> samplers;
            std::vector<Animation::Channel> channels;
        };
        std::map<std::size_t, Used> used;
        forEachChannel([&](std::size_t animation, const JsonView& channel, std::size_t node) {
            if (places_[node].kept == none)
                return;
            const std::size_t sampler = channel.at("sampler").index();
            const std::string path = channel.at("target").at("path").string();
            used[animation].samplers.insert(sampler);
            used[animation].channels.push_back({sampler, places_[node].kept,
                                                path == "rotation" ? Animation::Path::rotation
                                                : path == "scale"  ? Animation::Path::scale
                                                                   : Animation::Path::translation});
        });
        for (auto& [index, parts] : used) {
            const JsonView json = root_.entry("animations", index);
            Animation animation;
            animation.name = printable(json.stringOr("name", ""));
            std::map<std::size_t, std::size_t> renumbered;
            for (const std::size_t sampler : parts.samplers) {
                renumbered[sampler] = animation.samplers.size();
                animation.samplers.push_back(readSampler(json.entry("samplers", sampler)));
            }
            for (Animation::Channel& channel : parts.channels) {
                const JsonView sampler = json.entry("samplers", channel.sampler);
                channel.sampler = renumbered.at(channel.sampler);
                checkValues(animation.samplers[channel.sampler], channel.path, sampler);
            }
            animation.channels = std::move(parts.channels);
            scene_.animations.push_back(std::move(animation));
        }
    }

    Animation::Sampler readSampler(const JsonView& json) {
        Animation::Sampler sampler;
        const std::string interpolation = json.stringOr("interpolation", "LINEAR");
        if (interpolation == "STEP")
            sampler.interpolation = Animation::Interpolation::step;
        else if (interpolation == "CUBICSPLINE")
            sampler.interpolation = Animation::Interpolation::cubicSpline;
        else if (interpolation != "LINEAR")
            json.fail("has an interpolation that glTF 2.0 does not know");
        const JsonView input = json.at("input");
        sampler.seconds = buffers_.scalars(input);
        for (std::size_t i = 0; i < sampler.seconds.size(); ++i) {
            const float seconds = sampler.seconds[i];
            if (!(seconds >= 0) || !std::isfinite(seconds))
                input.fail(fmt::format("has a key, number {}, whose time cannot be", i));
            if (i > 0 && seconds < sampler.seconds[i - 1])
                input.fail(fmt::format("has keys that are not in the order of time, at number {}", i));
        }
        const JsonView output = json.at("output");
        if (buffers_.components(output) == 3) {
            const std::vector<glm::vec3>& values = buffers_.vec3s(output);
            buffers_.charge(values.size() * sizeof(glm::vec4), output);
            sampler.values.reserve(values.size());
            for (const glm::vec3& value : values)
                sampler.values.emplace_back(value, 0);
        } else {
            const std::vector<glm::vec4>& values = buffers_.vec4s(output);
            buffers_.charge(values.size() * sizeof(glm::vec4), output);
            sampler.values = values;
        }
        const std::size_t perKey = sampler.interpolation == Animation::Interpolation::cubicSpline ? 3 : 1;
        if (sampler.values.size() != perKey * sampler.seconds.size())
            output.fail(
                fmt::format("has {} values for {} keys", sampler.values.size(), sampler.seconds.size()));
        for (std::size_t i = 0; i < sampler.values.size(); ++i)
            for (int c = 0; c < 4; ++c)
                if (!std::isfinite(sampler.values[i][c]))
                    output.fail(fmt::format("has a value, number {}, that is not finite", i));
        return sampler;
    }

    void checkValues(const Animation::Sampler& sampler, Animation::Path path, const JsonView& json) {
        const bool isRotation = path == Animation::Path::rotation;
        const JsonView output = json.at("output");
        if (buffers_.components(output) != (isRotation ? 4u : 3u))
            output.fail("has values of another kind than what they move");
        if (!isRotation)
            return;
        const bool isCubic = sampler.interpolation == Animation::Interpolation::cubicSpline;
        for (std::size_t i = isCubic ? 1 : 0; i < sampler.values.size(); i += isCubic ? 3 : 1)
            if (sampler.values[i] == glm::vec4(0))
                output.fail(fmt::format("has a rotation, number {}, of zero length", i));
    }

    // Cameras and lights ---------------------------------------------------------------------------------

    bool readCamera(const JsonView& json, const glm::dmat4& worldFromNode) {
        if (json.at("type").string() != "perspective") {
            warnings_.add("cameras that are not perspective are left out");
            return false;
        }
        const JsonView perspective = json.at("perspective");
        Camera camera;
        camera.fovYRadians = static_cast<float>(perspective.at("yfov").number());
        camera.nearDistance = static_cast<float>(perspective.at("znear").number());
        const auto zfar = perspective.find("zfar");
        camera.farDistance =
            zfar ? static_cast<float>(zfar->number()) : std::numeric_limits<float>::infinity();
        // pi, rounded down.
        if (!(camera.fovYRadians > 0 && camera.fovYRadians < 3.141592f) || !(camera.nearDistance > 0) ||
            !(camera.farDistance > camera.nearDistance))
            json.fail("has an angle or a distance that cannot be");
        if (const auto own = ownExtras(json)) {
            camera.apertureRadius = static_cast<float>(std::max(own->numberOr("apertureRadius", 0), 0.0));
            if (const auto focus = own->find("focusDistance"))
                camera.focusDistance = static_cast<float>(focus->number());
            else
                camera.focusDistance = std::numeric_limits<float>::infinity();
            if (!(camera.focusDistance > 0))
                json.fail("has an angle or a distance that cannot be");
        }
        const auto frame = cameraFrame(worldFromNode);
        if (!frame) {
            warnings_.add("cameras in frames without volume are left out");
            return false;
        }
        camera.worldFromCamera = *frame;
        if (scene_.cameras.size() == most_)
            return false;
        scene_.cameras.push_back(camera);
        return true;
    }

    bool readLight(const JsonView& json, const glm::dmat4& worldFromNode) {
        Light light;
        light.name = printable(json.stringOr("name", ""));
        const std::string type = json.at("type").string();
        if (type == "directional")
            light.kind = Light::Kind::directional;
        else if (type == "point")
            light.kind = Light::Kind::point;
        else if (type == "spot")
            light.kind = Light::Kind::spot;
        else
            json.fail("is of a type that is not known");
        light.position = glm::vec3(glm::dvec3(worldFromNode[3]));
        if (const auto direction = viewDirection(worldFromNode))
            light.direction = *direction;
        if (const auto color = json.numbers<3>("color"))
            light.color = nonNegative(*color);
        constexpr double pi = 3.14159265358979323846;
        light.intensity = static_cast<float>(std::max(json.numberOr("intensity", 1), 0.0) / pi);
        light.range = static_cast<float>(std::max(json.numberOr("range", 0), 0.0));
        if (light.kind == Light::Kind::spot) {
            const auto spot = json.find("spot");
            const double outer =
                std::clamp(spot ? spot->numberOr("outerConeAngle", pi / 4) : pi / 4, 0.0, pi / 2);
            light.outerConeRadians = static_cast<float>(outer);
            light.innerConeRadians =
                static_cast<float>(std::clamp(spot ? spot->numberOr("innerConeAngle", 0) : 0, 0.0, outer));
        }
        if (scene_.lights.size() == most_)
            return false;
        scene_.lights.push_back(light);
        return true;
    }

    std::string where_;
    std::filesystem::path folder_;
    /// Of instances, lights or cameras. A small file can ask for many: as many as it has nodes times parts.
    std::size_t most_;
    GltfContainer container_;
    nlohmann::json document_;
    JsonView root_;
    GltfBuffers buffers_;
    Scene scene_;
    Warnings warnings_;
    TextureShelf shelf_;

    std::map<TextureKey, std::optional<std::size_t>> textures_;  ///< → Scene::textures
    std::vector<TexcoordSets> texcoordSets_;                     ///< of each material
    std::optional<std::size_t> defaultMaterial_;
    std::map<std::size_t, glm::vec2> averages_;  ///< texture → roughness and metalness
    std::map<PartKey, std::size_t> meshes_;
    std::unordered_map<std::size_t, std::vector<Part>> parts_;
    std::vector<Place> places_;  ///< of the file's nodes
    // Of the scene's nodes:
    std::vector<glm::dmat4> worldFromKept_;
    std::vector<bool> isMovedKept_;
};

}  // namespace

ImportedScene importGltf(std::string_view contents, const std::filesystem::path& file) {
    return GltfReader(contents, file).read();
}

}  // namespace quincunx

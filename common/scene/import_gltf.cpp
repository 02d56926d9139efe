#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "geometry/normals.h"
#include "image/io.h"
#include "scene/gltf_buffers.h"
#include "scene/gltf_json.h"
#include "scene/import_formats.h"
#include "scene/import_support.h"

namespace quincunx {

namespace {

constexpr std::array supportedExtensions{"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                         "KHR_mesh_quantization"};

bool supported(const std::string& extension) {
    return std::find(supportedExtensions.begin(), supportedExtensions.end(), extension) !=
           supportedExtensions.end();
}

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::optional<JsonView> extension(const JsonView& json, const char* name) {
    const auto extensions = json.find("extensions");
    return extensions ? extensions->find(name) : std::nullopt;
}

/// A drawn part of a mesh: what it is made of tells equal ones apart, so that they are made once.
using PrimitiveKey = std::tuple<std::size_t, std::size_t, std::size_t, std::size_t, std::size_t>;
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

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
        noteWhatIsNotDrawn();
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

    void noteWhatIsNotDrawn() {
        if (root_.countOf("animations") > 0)
            warnings_.add("animations are not played");
        if (root_.countOf("skins") > 0)
            warnings_.add("skins are not drawn: meshes stay as they were modelled");
    }

    // Materials ------------------------------------------------------------------------------------------

    void readMaterials() {
        const std::size_t count = root_.countOf("materials");
        texcoordSets_.resize(count, 0);
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
        if (const auto pbr = json.find("pbrMetallicRoughness")) {
            if (const auto color = pbr->numbers<4>("baseColorFactor"))
                material.baseColor = unitColor(*color);
            material.metallic = static_cast<float>(std::clamp(pbr->numberOr("metallicFactor", 1), 0.0, 1.0));
            material.roughness =
                static_cast<float>(std::clamp(pbr->numberOr("roughnessFactor", 1), 0.0, 1.0));
            if (const auto texture = pbr->find("baseColorTexture")) {
                material.baseColorTexture = readTexture(*texture);
                texcoordSets_[index] = texture->indexOr("texCoord", 0);
            }
            if (const auto texture = pbr->find("metallicRoughnessTexture"))
                averageMetallicRoughness(*texture, material);
        }
        if (const auto emission = json.numbers<3>("emissiveFactor")) {
            const auto strengthened = extension(json, "KHR_materials_emissive_strength");
            const double strength = strengthened ? strengthened->numberOr("emissiveStrength", 1) : 1;
            material.emission = glm::vec3(
                glm::clamp(glm::dvec3((*emission)[0], (*emission)[1], (*emission)[2]) * strength, 0.0, 1e6));
        }
        if (json.has("emissiveTexture")) {
            // The factor is the brightest that the texture makes of it, mostly in few places.
            warnings_.add("emissive textures are not drawn, and their materials do not glow");
            material.emission = glm::vec3(0);
        }
        for (const auto& [key, what] :
             {std::pair{"normalTexture", "normal maps"}, std::pair{"occlusionTexture", "occlusion maps"}})
            if (json.has(key))
                warnings_.add(fmt::format("{} are not drawn", what));
        const std::string alphaMode = json.stringOr("alphaMode", "OPAQUE");
        if (alphaMode == "MASK")
            material.alphaMode = Material::AlphaMode::mask;
        else if (alphaMode == "BLEND")
            material.alphaMode = Material::AlphaMode::blend;
        if (material.alphaMode == Material::AlphaMode::blend)
            warnings_.add("blended surfaces are drawn opaque");
        material.alphaCutoff = static_cast<float>(std::max(json.numberOr("alphaCutoff", 0.5), 0.0));
        material.doubleSided = json.booleanOr("doubleSided", false);
        fillPhongFromMetallicRoughness(material);
        return material;
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

    std::optional<std::size_t> readTexture(const JsonView& reference) {
        const JsonView texture = root_.entry("textures", reference.at("index").index());
        const auto image = imageOf(texture);
        if (!image)
            return {};
        Texture::Wrap wrapS = Texture::Wrap::repeat;
        Texture::Wrap wrapT = Texture::Wrap::repeat;
        if (const auto sampler = texture.optionalIndex("sampler")) {
            const JsonView json = root_.entry("samplers", *sampler);
            wrapS = readWrap(json, "wrapS");
            wrapT = readWrap(json, "wrapT");
        }
        const JsonView json = root_.entry("images", *image);
        return shelf_.texture(nameOfImage(json, *image), wrapS, wrapT, [&] { return decode(json, *image); });
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

    /// The roughness in a texture's green channel and the metalness in its blue one, as one number each.
    void averageMetallicRoughness(const JsonView& reference, Material& material) {
        const JsonView texture = root_.entry("textures", reference.at("index").index());
        const auto image = imageOf(texture);
        if (!image)
            return;
        const auto [entry, isNew] = averages_.try_emplace(*image, 1, 1);
        if (isNew) {
            try {
                const Image8 pixels = decode(root_.entry("images", *image), *image);
                if (pixels.channels >= 3) {
                    std::uint64_t green = 0;
                    std::uint64_t blue = 0;
                    for (std::size_t i = 0; i < pixels.data.size();
                         i += static_cast<std::size_t>(pixels.channels)) {
                        green += pixels.data[i + 1];
                        blue += pixels.data[i + 2];
                    }
                    const double whole = 255 * static_cast<double>(pixels.pixelCount());
                    entry->second =
                        glm::vec2(static_cast<double>(green) / whole, static_cast<double>(blue) / whole);
                }
                warnings_.add("metallic-roughness textures are drawn as their average");
            } catch (const InputError& error) {
                warnings_.add(fmt::format("drawn without a texture: {}", error.what()));
            }
        }
        material.roughness *= entry->second.x;
        material.metallic *= entry->second.y;
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
        if (attributes.has("COLOR_0"))
            warnings_.add("colours of vertices are not drawn");
        std::size_t material = 0;
        std::size_t texcoordSet = 0;
        if (const auto named = json.optionalIndex("material")) {
            if (*named >= texcoordSets_.size())
                json.fail(fmt::format("names material {}, which is not there", *named));
            material = *named;
            texcoordSet = texcoordSets_[material];
        } else {
            material = defaultMaterial();
        }
        const std::string texcoordName = fmt::format("TEXCOORD_{}", texcoordSet);
        const PrimitiveKey key{positions->index(), attributes.optionalIndex("NORMAL").value_or(none),
                               attributes.optionalIndex(texcoordName.c_str()).value_or(none),
                               json.optionalIndex("indices").value_or(none), mode};
        const auto known = meshes_.find(key);
        if (known != meshes_.end())
            return Part{known->second, material};
        Mesh mesh = makeMesh(json, attributes, texcoordName.c_str(), mode);
        if (mesh.indices.empty())
            return {};
        mesh.name = name;
        scene_.meshes.push_back(std::move(mesh));
        meshes_[key] = scene_.meshes.size() - 1;
        return Part{scene_.meshes.size() - 1, material};
    }

    Mesh makeMesh(const JsonView& json, const JsonView& attributes, const char* texcoordName,
                  std::size_t mode) {
        const JsonView positionReference = attributes.at("POSITION");
        const std::vector<glm::vec3>& positions = buffers_.vec3s(positionReference);
        const auto bad = std::find_if_not(positions.begin(), positions.end(), finite);
        if (bad != positions.end())
            positionReference.fail(
                fmt::format("has a position, number {}, that is not finite", bad - positions.begin()));
        const std::vector<glm::vec3>* normals = nullptr;
        const std::vector<glm::vec2>* texcoords = nullptr;
        if (const auto reference = attributes.find("NORMAL")) {
            normals = &buffers_.vec3s(*reference);
            if (normals->size() != positions.size())
                reference->fail("has another number of elements than the positions");
        }
        if (const auto reference = attributes.find(texcoordName)) {
            texcoords = &buffers_.vec2s(*reference);
            if (texcoords->size() != positions.size())
                reference->fail("has another number of elements than the positions");
        }

        Mesh mesh;
        std::vector<std::uint32_t> corners;
        if (const auto reference = json.find("indices")) {
            corners = buffers_.indices(*reference);
            for (const std::uint32_t corner : corners)
                if (corner >= positions.size())
                    reference->fail(fmt::format("names vertex {} of only {}", corner, positions.size()));
        } else {
            buffers_.charge(positions.size() * sizeof(std::uint32_t), json);
            corners.resize(positions.size());
            std::iota(corners.begin(), corners.end(), 0u);
        }
        mesh.indices = triangles(std::move(corners), mode, json);
        takeVertices(mesh, positions, normals, texcoords, json);
        if (!normals) {
            buffers_.charge(mesh.indices.size() * 32, json);
            makeFlatNormals(mesh);
        } else {
            mendNormals(mesh);
        }
        return mesh;
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
    void takeVertices(Mesh& mesh, const std::vector<glm::vec3>& positions,
                      const std::vector<glm::vec3>* normals, const std::vector<glm::vec2>* texcoords,
                      const JsonView& json) {
        std::vector<std::uint32_t> used;
        if (mesh.indices.size() < positions.size()) {
            used = mesh.indices;
            std::sort(used.begin(), used.end());
            used.erase(std::unique(used.begin(), used.end()), used.end());
            for (std::uint32_t& index : mesh.indices)
                index = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), index) -
                                                   used.begin());
        } else {
            used.resize(positions.size());
            std::iota(used.begin(), used.end(), 0u);
        }
        buffers_.charge(used.size() * 32, json);
        mesh.positions.reserve(used.size());
        for (const std::uint32_t vertex : used)
            mesh.positions.push_back(positions[vertex]);
        if (normals) {
            mesh.normals.reserve(used.size());
            for (const std::uint32_t vertex : used)
                mesh.normals.push_back((*normals)[vertex]);
        }
        if (texcoords) {
            mesh.texcoords.reserve(used.size());
            for (const std::uint32_t vertex : used) {
                const glm::vec2 t = (*texcoords)[vertex];
                mesh.texcoords.push_back(std::isfinite(t.x) && std::isfinite(t.y) ? t : glm::vec2(0));
            }
        }
    }

    /// Brings normals to unit length; those without a direction are made.
    static void mendNormals(Mesh& mesh) {
        std::vector<std::size_t> missing;
        for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
            const glm::dvec3 normal(mesh.normals[i]);
            const double length = glm::length(normal);
            if (length > 0 && std::isfinite(length))
                mesh.normals[i] = glm::vec3(normal / length);
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
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (length == 0)
            node.fail("has a rotation of zero length");
        const double x = q[0] / length;
        const double y = q[1] / length;
        const double z = q[2] / length;
        const double w = q[3] / length;
        const glm::dvec3 right(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w));
        const glm::dvec3 up(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w));
        const glm::dvec3 back(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y));
        return glm::dmat4(glm::dvec4(right * s[0], 0), glm::dvec4(up * s[1], 0), glm::dvec4(back * s[2], 0),
                          glm::dvec4(t[0], t[1], t[2], 1));
    }

    std::vector<std::size_t> rootNodes() {
        std::vector<std::size_t> roots;
        const std::size_t nodes = root_.countOf("nodes");
        if (root_.countOf("scenes") > 0) {
            const JsonView scene = root_.entry("scenes", root_.indexOr("scene", 0));
            scene_.name = printable(scene.stringOr("name", scene_.name));
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

    void readNodes() {
        struct Visit {
            std::size_t node;
            glm::dmat4 worldFromParent;
        };
        std::vector<Visit> open;
        std::vector<bool> seen(root_.countOf("nodes"), false);
        const std::vector<std::size_t> roots = rootNodes();
        for (std::size_t i = roots.size(); i-- > 0;)
            open.push_back({roots[i], glm::dmat4(1)});
        while (!open.empty()) {
            const Visit visit = open.back();
            open.pop_back();
            const JsonView node = root_.entry("nodes", visit.node);
            if (seen[visit.node])
                node.fail("hangs from two nodes, or from itself");
            seen[visit.node] = true;
            const glm::dmat4 worldFromNode = visit.worldFromParent * localTransform(node);
            readNode(node, worldFromNode);
            if (const auto children = node.find("children"))
                for (std::size_t i = children->size(); i-- > 0;)
                    open.push_back({(*children)[i].index(), worldFromNode});
        }
    }

    void readNode(const JsonView& node, const glm::dmat4& worldFromNode) {
        const glm::mat4 matrix(worldFromNode);
        for (int column = 0; column < 4; ++column)
            if (!finite(glm::vec3(matrix[column])) || !std::isfinite(matrix[column][3]))
                node.fail("has a transform that overflows");
        if (const auto mesh = node.optionalIndex("mesh"))
            for (const Part& part : partsOfMesh(*mesh)) {
                if (scene_.instances.size() == most_)
                    node.fail(fmt::format("makes more than {} instances", most_));
                const std::string& meshName = scene_.meshes[part.mesh].name;
                scene_.instances.push_back(
                    {printable(node.stringOr("name", meshName)), part.mesh, part.material, matrix});
            }
        if (const auto camera = node.optionalIndex("camera"))
            readCamera(root_.entry("cameras", *camera), worldFromNode);
        if (const auto light = extension(node, "KHR_lights_punctual")) {
            const auto lights = extension(root_, "KHR_lights_punctual");
            if (!lights)
                light->fail("names a light of a file without lights");
            readLight(lights->entry("lights", light->at("light").index()), worldFromNode);
        }
    }

    /// Where a node's frame looks: its -z axis; nothing if that has no length.
    static std::optional<glm::dvec3> viewDirection(const glm::dmat4& worldFromNode) {
        const glm::dvec3 back(worldFromNode[2]);
        const double length = glm::length(back);
        if (!(length > 0))
            return {};
        return -back / length;
    }

    void readCamera(const JsonView& json, const glm::dmat4& worldFromNode) {
        if (json.at("type").string() != "perspective") {
            warnings_.add("cameras that are not perspective are left out");
            return;
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
        // The node's scale is no part of a camera's frame.
        const auto forward = viewDirection(worldFromNode);
        const glm::dvec3 up(worldFromNode[1]);
        const glm::dvec3 right = forward ? glm::cross(*forward, up) : glm::dvec3(0);
        const double length = glm::length(right);
        if (!(length > 0)) {
            warnings_.add("cameras in frames without volume are left out");
            return;
        }
        const glm::dvec3 unitRight = right / length;
        const glm::dvec3 unitUp = glm::cross(unitRight, *forward);
        camera.worldFromCamera =
            glm::mat4(glm::dmat4(glm::dvec4(unitRight, 0), glm::dvec4(unitUp, 0), glm::dvec4(-*forward, 0),
                                 glm::dvec4(glm::dvec3(worldFromNode[3]), 1)));
        if (scene_.cameras.size() < most_)
            scene_.cameras.push_back(camera);
    }

    void readLight(const JsonView& json, const glm::dmat4& worldFromNode) {
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
            light.direction = glm::vec3(*direction);
        if (const auto color = json.numbers<3>("color"))
            light.color = glm::vec3(glm::max(glm::dvec3((*color)[0], (*color)[1], (*color)[2]), 0.0));
        constexpr double pi = 3.14159265358979323846;
        light.intensity = static_cast<float>(std::max(json.numberOr("intensity", 1), 0.0) / pi);
        if (json.has("range"))
            warnings_.add("ranges of lights are not drawn");
        light.range = static_cast<float>(std::max(json.numberOr("range", 0), 0.0));
        if (const auto spot = json.find("spot")) {
            const double outer = std::clamp(spot->numberOr("outerConeAngle", pi / 4), 0.0, pi / 2);
            light.outerConeRadians = static_cast<float>(outer);
            light.innerConeRadians =
                static_cast<float>(std::clamp(spot->numberOr("innerConeAngle", 0), 0.0, outer));
        }
        if (scene_.lights.size() < most_)
            scene_.lights.push_back(light);
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

    std::vector<std::size_t> texcoordSets_;  ///< that the base colour texture of each material uses
    std::optional<std::size_t> defaultMaterial_;
    std::map<std::size_t, glm::vec2> averages_;  ///< image → roughness and metalness
    std::map<PrimitiveKey, std::size_t> meshes_;
    std::unordered_map<std::size_t, std::vector<Part>> parts_;
};

}  // namespace

ImportedScene importGltf(std::string_view contents, const std::filesystem::path& file) {
    return GltfReader(contents, file).read();
}

}  // namespace quincunx

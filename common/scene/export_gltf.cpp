#include "scene/export_gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "image/io.h"
#include "math/vector.h"
#include "scene/import_formats.h"
#include "scene/import_support.h"
#include "scene/placement.h"

namespace quincunx {

namespace {

using nlohmann::json;

// Codes of glTF 2.0, sections 3.6.2.2, 5.11.5 and 5.26.
constexpr int typeUnsignedInt = 5125;
constexpr int typeFloat = 5126;
constexpr int vertexTarget = 34962;
constexpr int indexTarget = 34963;
constexpr int repeatCode = 10497;
constexpr int mirroredRepeatCode = 33648;
constexpr int clampToEdgeCode = 33071;

void put32(std::string& out, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        out += static_cast<char>(value >> (8 * i) & 0xff);
}

std::string base64(std::string_view bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= count ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

class GltfWriter {
  public:
    GltfWriter(const Scene& scene, const std::filesystem::path& file)
        : scene_(scene), where_(printable(file.string())) {}

    std::string write(bool isBinary) {
        if (scene_.triangleCount() == 0)
            throw InputError("a scene without triangles is not written", where_, "add something to it");
        document_["asset"] = {{"version", "2.0"}, {"generator", "Quincunx"}};
        writeTextures();
        for (std::size_t i = 0; i < scene_.materials.size(); ++i)
            document_["materials"].push_back(material(scene_.materials[i], fmt::format("material {}", i)));
        writeNodes();
        writeAnimations();
        for (const std::string& extension : extensions_)
            document_["extensionsUsed"].push_back(extension);
        return isBinary ? binaryFile() : textFile();
    }

  private:
    // Numbers --------------------------------------------------------------------------------------------

    [[noreturn]] void failNotFinite(std::string_view place) const {
        throw InputError(fmt::format("{} of the scene has a number that is not finite", printable(place)),
                         where_, "mend the scene");
    }

    double number(float value, std::string_view place) const {
        if (!std::isfinite(value))
            failNotFinite(place);
        return static_cast<double>(value);
    }
    double unit(float value, std::string_view place) const {
        return std::clamp(number(value, place), 0.0, 1.0);
    }
    template <int N>
    json numbers(const glm::vec<N, float>& values, std::string_view place) const {
        json array = json::array();
        for (int i = 0; i < N; ++i)
            array.push_back(number(values[i], place));
        return array;
    }
    json matrix(const glm::mat4& m, std::string_view place) const {
        json array = json::array();
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                array.push_back(number(m[column][row], place));
        for (int column = 0; column < 4; ++column)
            if (m[column][3] != (column == 3 ? 1.0f : 0.0f))
                throw InputError(fmt::format("{} of the scene is placed by a matrix whose last row is not "
                                             "0 0 0 1",
                                             printable(place)),
                                 where_, "place it by an affine matrix");
        return array;
    }

    // Bytes ----------------------------------------------------------------------------------------------

    std::size_t view(std::string_view bytes, int target = 0) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        json entry{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
        if (target != 0)
            entry["target"] = target;
        bytes_ += bytes;
        checkSize(bytes_.size());
        return add("bufferViews", std::move(entry));
    }

    void checkSize(std::size_t size) const {
        if (size > largestModelFile)
            throw InputError("the scene makes a file of more than 2 GiB", where_, "export a part of it");
    }

    std::size_t add(const char* list, json entry) {
        json& array = document_[list];
        array.push_back(std::move(entry));
        return array.size() - 1;
    }

    template <typename T>
    static std::string_view bytesOf(const std::vector<T>& values) {
        return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
    }

    /// An accessor of vectors of N floats; with its bounds where glTF asks for them.
    template <int N>
    std::size_t accessor(const std::vector<glm::vec<N, float>>& values, std::string_view place, int target,
                         bool hasBounds = false) {
        glm::vec<N, float> low(std::numeric_limits<float>::infinity());
        glm::vec<N, float> high(-std::numeric_limits<float>::infinity());
        for (const auto& value : values) {
            for (int i = 0; i < N; ++i)
                if (!std::isfinite(value[i]))
                    failNotFinite(place);
            low = glm::min(low, value);
            high = glm::max(high, value);
        }
        constexpr std::array types{"SCALAR", "VEC2", "VEC3", "VEC4"};
        json entry{{"bufferView", view(bytesOf(values), target)},
                   {"componentType", typeFloat},
                   {"count", values.size()},
                   {"type", types[N - 1]}};
        if (hasBounds) {
            entry["min"] = numbers(low, place);
            entry["max"] = numbers(high, place);
        }
        return add("accessors", std::move(entry));
    }

    // Textures and materials -----------------------------------------------------------------------------

    void writeTextures() {
        std::set<std::size_t> used;
        for (const Material& material : scene_.materials)
            for (const auto* use :
                 {&material.baseColorTexture, &material.metallicRoughnessTexture, &material.normalTexture,
                  &material.occlusionTexture, &material.emissionTexture})
                if (*use) {
                    QX_CHECK_LT((*use)->texture, scene_.textures.size());
                    used.insert((*use)->texture);
                }
        for (const std::size_t index : used) {
            const Texture& texture = scene_.textures[index];
            if (texture.image.width < 1 || texture.image.height < 1)
                throw InputError(fmt::format("texture {} of the scene has no pixels", index), where_,
                                 "mend the scene");
            const std::vector<unsigned char> png = encodedPng(texture.image, where_);
            const std::size_t source =
                add("images", {{"bufferView", view({reinterpret_cast<const char*>(png.data()), png.size()})},
                               {"mimeType", "image/png"},
                               {"name", texture.name}});
            textures_[index] = add("textures", {{"source", source}, {"sampler", sampler(texture)}});
        }
    }

    std::size_t sampler(const Texture& texture) {
        const auto wrap = [](Texture::Wrap mode) {
            switch (mode) {
                case Texture::Wrap::mirroredRepeat:
                    return mirroredRepeatCode;
                case Texture::Wrap::clampToEdge:
                    return clampToEdgeCode;
                case Texture::Wrap::repeat:
                    break;
            }
            return repeatCode;
        };
        // 9728 nearest, 9729 linear; with mipmaps 9984 on, which count within a level, then between them.
        const int linear = texture.minification == Texture::Filter::linear ? 1 : 0;
        int minification = 9728 + linear;
        if (texture.mipmaps != Texture::Mipmaps::none)
            minification = 9984 + linear + (texture.mipmaps == Texture::Mipmaps::linear ? 2 : 0);
        const json entry{{"magFilter", texture.magnification == Texture::Filter::linear ? 9729 : 9728},
                         {"minFilter", minification},
                         {"wrapS", wrap(texture.wrapS)},
                         {"wrapT", wrap(texture.wrapT)}};
        const auto [known, isNew] = samplers_.try_emplace(entry.dump(), 0);
        if (isNew)
            known->second = add("samplers", entry);
        return known->second;
    }

    json textureInfo(const TextureUse& use, std::string_view place) {
        json info{{"index", textures_.at(use.texture)}};
        QX_CHECK(use.texcoordSet == 0 || use.texcoordSet == 1);
        if (use.texcoordSet != 0)
            info["texCoord"] = use.texcoordSet;
        const glm::mat3& m = use.textureFromTexcoord;
        if (m == glm::mat3(1))
            return info;
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 2; ++row)
                number(m[column][row], place);
        extensions_.insert("KHR_texture_transform");
        // The columns are sx (cos r, -sin r) and sy (sin r, cos r).
        const glm::dvec2 a(m[0]);
        const glm::dvec2 b(m[1]);
        double rotation = 0;
        glm::dvec2 scale(a.x, b.y);
        if (a.y != 0 || b.x != 0) {
            rotation = a != glm::dvec2(0) ? std::atan2(-a.y, a.x) : std::atan2(b.x, b.y);
            scale = {std::hypot(a.x, a.y), std::sin(rotation) * b.x + std::cos(rotation) * b.y};
        }
        const glm::dvec2 offset(m[2]);
        json transform{{"offset", {offset.x, offset.y}}, {"scale", {scale.x, scale.y}}};
        if (rotation != 0)
            transform["rotation"] = rotation;
        glm::mat3 affine = m;
        affine[0].z = affine[1].z = 0;
        affine[2].z = 1;
        if (textureTransformMatrix(offset, rotation, scale) != affine)
            transform["extras"]["quincunx"]["textureFromTexcoord"] = {a.x, a.y, b.x, b.y, offset.x, offset.y};
        info["extensions"]["KHR_texture_transform"] = std::move(transform);
        return info;
    }

    json material(const Material& m, const std::string& place) {
        json pbr{{"baseColorFactor", json::array()},
                 {"metallicFactor", unit(m.metallic, place)},
                 {"roughnessFactor", unit(m.roughness, place)}};
        for (int i = 0; i < 4; ++i)
            pbr["baseColorFactor"].push_back(unit(m.baseColor[i], place));
        if (m.baseColorTexture)
            pbr["baseColorTexture"] = textureInfo(*m.baseColorTexture, place);
        if (m.metallicRoughnessTexture)
            pbr["metallicRoughnessTexture"] = textureInfo(*m.metallicRoughnessTexture, place);
        json out{{"name", m.name}, {"pbrMetallicRoughness", std::move(pbr)}};
        writeEmission(m, place, out);
        if (m.normalTexture) {
            out["normalTexture"] = textureInfo(*m.normalTexture, place);
            out["normalTexture"]["scale"] = number(m.normalScale, place);
        }
        if (m.occlusionTexture) {
            out["occlusionTexture"] = textureInfo(*m.occlusionTexture, place);
            out["occlusionTexture"]["strength"] = unit(m.occlusionStrength, place);
        }
        constexpr std::array modes{"OPAQUE", "MASK", "BLEND"};
        out["alphaMode"] = modes[static_cast<std::size_t>(m.alphaMode)];
        if (m.alphaMode == Material::AlphaMode::mask || m.alphaCutoff != 0.5f)
            out["alphaCutoff"] = number(m.alphaCutoff, place);
        if (m.doubleSided)
            out["doubleSided"] = true;
        if (m.transmission != 0) {
            extensions_.insert("KHR_materials_transmission");
            out["extensions"]["KHR_materials_transmission"]["transmissionFactor"] =
                unit(m.transmission, place);
        }
        if (m.ior != 1.5f) {
            extensions_.insert("KHR_materials_ior");
            out["extensions"]["KHR_materials_ior"]["ior"] = std::clamp(number(m.ior, place), 1.0, mostIor);
        }
        Material derived = m;
        fillPhongFromMetallicRoughness(derived);
        const bool isDerived = derived.ambient == m.ambient && derived.diffuse == m.diffuse &&
                               derived.specular == m.specular && derived.shininess == m.shininess;
        if (!isDerived || m.metallicRoughnessTexture)
            out["extras"]["quincunx"] = {{"ambient", numbers(m.ambient, place)},
                                         {"diffuse", numbers(m.diffuse, place)},
                                         {"specular", numbers(m.specular, place)},
                                         {"shininess", number(m.shininess, place)}};
        return out;
    }

    void writeEmission(const Material& m, std::string_view place, json& out) {
        const glm::vec3 emission = glm::clamp(m.emission, 0.0f, static_cast<float>(mostEmission));
        if (!isFinite(m.emission))
            failNotFinite(place);
        if (m.emissionTexture)
            out["emissiveTexture"] = textureInfo(*m.emissionTexture, place);
        if (m.emission == glm::vec3(0))
            return;
        // Factors end at 1. Divided by a power of two, they lose nothing.
        const float brightest = std::max({emission.x, emission.y, emission.z});
        float strength = 1;
        while (strength < brightest)
            strength *= 2;
        out["emissiveFactor"] = numbers(emission / strength, place);
        if (strength > 1) {
            extensions_.insert("KHR_materials_emissive_strength");
            out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
        }
    }

    // Meshes ---------------------------------------------------------------------------------------------

    json primitive(std::size_t index) {
        const Mesh& mesh = scene_.meshes[index];
        const std::string place = fmt::format("mesh {}", index);
        const std::size_t count = mesh.positions.size();
        json attributes{{"POSITION", accessor(mesh.positions, place, vertexTarget, true)}};
        const auto write = [&](const char* name, const auto& values) {
            if (values.empty())
                return;
            QX_CHECK_EQ(values.size(), count);
            attributes[name] = accessor(values, place, vertexTarget);
        };
        write("NORMAL", mesh.normals);
        write("TEXCOORD_0", mesh.texcoords);
        write("TEXCOORD_1", mesh.texcoords1);
        write("TANGENT", mesh.tangents);
        std::vector<glm::vec4> colors = mesh.colors;
        for (glm::vec4& color : colors)
            if (std::isfinite(color.x + color.y + color.z + color.w))
                color = glm::clamp(color, 0.0f, 1.0f);
        write("COLOR_0", colors);
        for (const std::uint32_t corner : mesh.indices)
            QX_CHECK_LT(corner, count);
        const std::size_t indices =
            add("accessors", {{"bufferView", view(bytesOf(mesh.indices), indexTarget)},
                              {"componentType", typeUnsignedInt},
                              {"count", mesh.indices.size()},
                              {"type", "SCALAR"}});
        return {{"attributes", std::move(attributes)}, {"indices", indices}};
    }

    /// The meshes of the file: one for each pair of mesh and material in use, in that order. Pairs of one
    /// mesh share its accessors, by which the reader knows them.
    void writeMeshes() {
        for (const Instance& instance : scene_.instances) {
            QX_CHECK_LT(instance.mesh, scene_.meshes.size());
            QX_CHECK_LT(instance.material, scene_.materials.size());
            if (!scene_.meshes[instance.mesh].indices.empty())
                meshes_[{instance.mesh, instance.material}] = 0;
        }
        json shared;
        std::optional<std::size_t> sharedMesh;
        for (auto& [pair, index] : meshes_) {
            if (sharedMesh != pair.first) {
                shared = primitive(pair.first);
                sharedMesh = pair.first;
            }
            json part = shared;
            part["material"] = pair.second;
            index = add("meshes", {{"name", scene_.meshes[pair.first].name},
                                   {"primitives", json::array({std::move(part)})}});
        }
    }

    // Nodes ----------------------------------------------------------------------------------------------

    /// (x, y, z, w), made unit length unless it is.
    glm::vec4 unitRotation(const glm::vec4& q, std::string_view place) const {
        const double length = glm::length(glm::dvec4(q));
        if (!std::isfinite(length))
            failNotFinite(place);
        if (length == 0)
            throw InputError(fmt::format("{} of the scene has a rotation of zero length", place), where_,
                             "mend the scene");
        return std::abs(length - 1) <= unitTolerance ? q : glm::vec4(glm::dvec4(q) / length);
    }

    /// A node below the scene's node that the thing hangs from, or at the top.
    void addThing(json node, Attachment::Thing thing, std::size_t index, const glm::mat4& worldFromThing,
                  const std::string& place) {
        const auto attachment = attachments_.find({thing, index});
        const bool hangs = attachment != attachments_.end();
        const glm::mat4& frame = hangs ? attachment->second.nodeFromThing : worldFromThing;
        json entries = matrix(frame, place);
        // Bit for bit: 0 and -0 differ.
        const glm::mat4 identity(1);
        if (std::memcmp(&frame, &identity, sizeof frame) != 0)
            node["matrix"] = std::move(entries);
        const std::size_t number = add("nodes", std::move(node));
        if (hangs)
            document_["nodes"][attachment->second.node]["children"].push_back(number);
        else
            document_["scenes"][0]["nodes"].push_back(number);
    }

    json environmentEntry(const Environment& environment) {
        const Image& panorama = environment.panorama;
        std::vector<glm::vec3> pixels;
        for (std::size_t i = 0; i < panorama.pixelCount(); ++i) {
            const float* const p = panorama.data.data() + i * static_cast<std::size_t>(panorama.channels);
            pixels.emplace_back(panorama.channels >= 3 ? glm::vec3(p[0], p[1], p[2]) : glm::vec3(p[0]));
            if (!isFinite(pixels.back()))
                failNotFinite("the environment");
        }
        if (pixels.empty())
            throw InputError("the environment of the scene has no pixels", where_, "mend the scene");
        return {{"bufferView", view(bytesOf(pixels))},
                {"width", panorama.width},
                {"height", panorama.height},
                {"tint", numbers(environment.tint, "the environment")}};
    }

    void writeNodes() {
        document_["scene"] = 0;
        json& top = document_["scenes"][0];
        top["name"] = scene_.name;
        const Scene usual;
        if (scene_.ambientLight != usual.ambientLight || scene_.backgroundTop != usual.backgroundTop ||
            scene_.backgroundBottom != usual.backgroundBottom)
            top["extras"]["quincunx"] = {
                {"ambientLight", numbers(scene_.ambientLight, "the ambient light")},
                {"backgroundTop", numbers(scene_.backgroundTop, "the background")},
                {"backgroundBottom", numbers(scene_.backgroundBottom, "the background")}};
        if (scene_.environment)
            top["extras"]["quincunx"]["environment"] = environmentEntry(*scene_.environment);
        for (const Attachment& attachment : scene_.attachments) {
            QX_CHECK_LT(attachment.node, scene_.nodes.size());
            attachments_[{attachment.thing, attachment.index}] = attachment;
        }
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const Node& node = scene_.nodes[i];
            const std::string place = fmt::format("node {}", i);
            json entry{{"name", node.name}};
            if (node.matrix) {
                entry["matrix"] = matrix(*node.matrix, place);
            } else {
                const glm::quat& q = node.rotation;
                entry["translation"] = numbers(node.translation, place);
                entry["rotation"] = numbers(unitRotation({q.x, q.y, q.z, q.w}, place), place);
                entry["scale"] = numbers(node.scale, place);
            }
            add("nodes", std::move(entry));
            if (node.parent == Node::noParent) {
                document_["scenes"][0]["nodes"].push_back(i);
            } else {
                QX_CHECK_LT(node.parent, i);
                document_["nodes"][node.parent]["children"].push_back(i);
            }
        }
        writeMeshes();
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& instance = scene_.instances[i];
            if (const auto mesh = meshes_.find({instance.mesh, instance.material}); mesh != meshes_.end())
                addThing({{"name", instance.name}, {"mesh", mesh->second}}, Attachment::Thing::instance, i,
                         instance.worldFromModel, fmt::format("instance {}", i));
        }
        writeLights();
        for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
            const std::string place = fmt::format("camera {}", i);
            const std::size_t camera = add("cameras", cameraEntry(scene_.cameras[i], place));
            addThing({{"camera", camera}}, Attachment::Thing::camera, i, scene_.cameras[i].worldFromCamera,
                     place);
        }
    }

    json cameraEntry(const Camera& camera, const std::string& place) const {
        json perspective{{"yfov", number(camera.fovYRadians, place)},
                         {"znear", number(camera.nearDistance, place)}};
        if (!std::isinf(camera.farDistance))
            perspective["zfar"] = number(camera.farDistance, place);
        json entry{{"type", "perspective"}, {"perspective", std::move(perspective)}};
        const Camera usual;
        if (camera.apertureRadius != usual.apertureRadius || camera.focusDistance != usual.focusDistance) {
            json& own = entry["extras"]["quincunx"];
            own["apertureRadius"] = number(camera.apertureRadius, place);
            if (!std::isinf(camera.focusDistance))
                own["focusDistance"] = number(camera.focusDistance, place);
        }
        return entry;
    }

    void writeLights() {
        if (scene_.lights.empty())
            return;
        extensions_.insert("KHR_lights_punctual");
        for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
            const Light& light = scene_.lights[i];
            const std::string place = fmt::format("light {}", i);
            constexpr std::array types{"directional", "point", "spot"};
            constexpr double pi = 3.14159265358979323846;
            json entry{{"name", light.name},
                       {"type", types[static_cast<std::size_t>(light.kind)]},
                       {"color", numbers(light.color, place)},
                       {"intensity", number(light.intensity, place) * pi}};
            if (number(light.range, place) > 0)
                entry["range"] = light.range;
            if (light.kind == Light::Kind::spot)
                entry["spot"] = {{"innerConeAngle", number(light.innerConeRadians, place)},
                                 {"outerConeAngle", number(light.outerConeRadians, place)}};
            document_["extensions"]["KHR_lights_punctual"]["lights"].push_back(std::move(entry));
            // The light shines along the node's -z; how it is turned about that does not matter.
            glm::mat4 frame(1);
            if (!isFinite(light.direction))
                failNotFinite(place);
            if (const auto axes = basisAround(-light.direction)) {
                frame = glm::mat4(*axes);
                frame[2] = glm::vec4(-light.direction, 0);
            }
            frame[3] = glm::vec4(light.position, 1);
            addThing({{"name", light.name}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}},
                     Attachment::Thing::light, i, frame, place);
        }
    }

    // Animations -----------------------------------------------------------------------------------------

    void writeAnimations() {
        for (std::size_t a = 0; a < scene_.animations.size(); ++a) {
            const Animation& animation = scene_.animations[a];
            const std::string place = fmt::format("animation {}", a);
            json entry{{"name", animation.name}, {"samplers", json::array()}, {"channels", json::array()}};
            std::map<std::size_t, bool> isRotation;
            constexpr std::array paths{"translation", "rotation", "scale"};
            for (const Animation::Channel& channel : animation.channels) {
                QX_CHECK_LT(channel.sampler, animation.samplers.size());
                QX_CHECK_LT(channel.node, scene_.nodes.size());
                isRotation[channel.sampler] = channel.path == Animation::Path::rotation;
                entry["channels"].push_back(
                    {{"sampler", channel.sampler},
                     {"target",
                      {{"node", channel.node}, {"path", paths[static_cast<std::size_t>(channel.path)]}}}});
            }
            for (std::size_t s = 0; s < animation.samplers.size(); ++s)
                entry["samplers"].push_back(samplerEntry(animation.samplers[s], isRotation[s], place));
            if (!animation.channels.empty())
                add("animations", std::move(entry));
        }
    }

    json samplerEntry(const Animation::Sampler& sampler, bool isRotation, const std::string& place) {
        using Interpolation = Animation::Interpolation;
        constexpr std::array names{"STEP", "LINEAR", "CUBICSPLINE"};
        std::vector<glm::vec1> seconds;
        for (const float time : sampler.seconds)
            seconds.emplace_back(time);
        json entry{{"interpolation", names[static_cast<std::size_t>(sampler.interpolation)]},
                   {"input", accessor(seconds, place, 0, true)}};
        if (isRotation) {
            std::vector<glm::vec4> values = sampler.values;
            const bool isCubic = sampler.interpolation == Interpolation::cubicSpline;
            for (std::size_t i = 0; i < values.size(); ++i)
                if (!isCubic)
                    values[i] = unitRotation(values[i], place);
            entry["output"] = accessor(values, place, 0);
        } else {
            std::vector<glm::vec3> values;
            for (const glm::vec4& value : sampler.values)
                values.emplace_back(value);
            entry["output"] = accessor(values, place, 0);
        }
        return entry;
    }

    // Files ----------------------------------------------------------------------------------------------

    std::string text() const { return document_.dump(-1, ' ', false, json::error_handler_t::replace); }

    std::string textFile() {
        document_["buffers"][0] = {{"byteLength", bytes_.size()},
                                   {"uri", "data:application/octet-stream;base64," + base64(bytes_)}};
        std::string file = text();
        checkSize(file.size());
        return file;
    }

    std::string binaryFile() {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        document_["buffers"][0] = {{"byteLength", bytes_.size()}};
        std::string chunk = text();
        chunk.resize((chunk.size() + 3) / 4 * 4, ' ');
        const std::size_t size = 12 + 8 + chunk.size() + 8 + bytes_.size();
        checkSize(size);
        std::string file = "glTF";
        file.reserve(size);
        put32(file, 2);
        put32(file, static_cast<std::uint32_t>(size));
        put32(file, static_cast<std::uint32_t>(chunk.size()));
        file += "JSON";
        file += chunk;
        put32(file, static_cast<std::uint32_t>(bytes_.size()));
        file += std::string_view("BIN\0", 4);
        file += bytes_;
        return file;
    }

    const Scene& scene_;
    std::string where_;
    json document_;
    std::string bytes_;
    std::set<std::string> extensions_;
    std::map<std::string, std::size_t> samplers_;
    std::map<std::size_t, std::size_t> textures_;                        ///< scene's → file's
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> meshes_;  ///< mesh, material → file's mesh
    std::map<std::pair<Attachment::Thing, std::size_t>, Attachment> attachments_;
};

}  // namespace

void exportScene(const Scene& scene, const std::filesystem::path& file) {
    const std::string extension = lowerCaseExtension(file);
    if (extension != ".gltf" && extension != ".glb")
        throw InputError("not a kind of model that can be written", printable(file.string()),
                         "use .gltf or .glb");
    writeFile(file, GltfWriter(scene, file).write(extension == ".glb"));
}

}  // namespace quincunx

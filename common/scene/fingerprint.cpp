#include "scene/fingerprint.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

namespace quincunx {
namespace {

/// Multiply and shift, eight bytes at a time: the finalizer of splitmix64 (Steele, Lea, Flood, "Fast
/// splittable pseudorandom number generators", OOPSLA 2014), chained.
class Mixer {
  public:
    void word(std::uint64_t bits) {
        state_ ^= bits + 0x9e3779b97f4a7c15u;
        state_ = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9u;
        state_ = (state_ ^ (state_ >> 27)) * 0x94d049bb133111ebu;
        state_ ^= state_ >> 31;
    }

    void bytes(const void* data, std::size_t size) {
        word(size);
        const auto* const at = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; i += 8) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, at + i, std::min<std::size_t>(8, size - i));
            word(bits);
        }
    }

    template <typename T>
    void value(const T& x) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        bytes(&x, sizeof x);
    }
    void value(const glm::vec3& v) { bytes(&v, sizeof v); }
    void value(const glm::vec4& v) { bytes(&v, sizeof v); }
    void value(const glm::mat3& m) { bytes(&m, sizeof m); }
    void value(const glm::mat4& m) { bytes(&m, sizeof m); }

    template <typename T>
    void array(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes(values.data(), values.size() * sizeof(T));
    }

    template <typename... T>
    void values(const T&... x) {
        (value(x), ...);
    }

    std::uint64_t state() const { return state_; }

  private:
    std::uint64_t state_ = 0;
};

}  // namespace

std::uint64_t fingerprint(const Scene& scene) {
    Mixer mix;
    mix.value(scene.meshes.size());
    for (const Mesh& mesh : scene.meshes) {
        mix.array(mesh.positions);
        mix.array(mesh.normals);
        mix.array(mesh.texcoords);
        mix.array(mesh.texcoords1);
        mix.array(mesh.tangents);
        mix.array(mesh.colors);
        mix.array(mesh.indices);
    }
    mix.value(scene.materials.size());
    for (const Material& m : scene.materials) {
        mix.values(m.baseColor, m.metallic, m.roughness, m.normalScale, m.occlusionStrength, m.emission,
                   m.alphaMode, m.alphaCutoff, m.doubleSided, m.transmission, m.ior);
        for (const auto& use : {m.baseColorTexture, m.metallicRoughnessTexture, m.normalTexture,
                                m.occlusionTexture, m.emissionTexture}) {
            mix.value(use.has_value());
            if (use)
                mix.values(use->texture, use->texcoordSet, use->textureFromTexcoord);
        }
        mix.values(m.ambient, m.diffuse, m.specular, m.shininess);
    }
    mix.value(scene.textures.size());
    for (const Texture& t : scene.textures) {
        mix.values(t.image.width, t.image.height, t.image.channels, t.image.encoding, t.wrapS, t.wrapT,
                   t.magnification, t.minification, t.mipmaps);
        mix.array(t.image.data);
    }
    mix.value(scene.instances.size());
    for (const Instance& i : scene.instances)
        mix.values(i.mesh, i.material, i.worldFromModel);
    mix.value(scene.lights.size());
    for (const Light& l : scene.lights)
        mix.values(l.kind, l.position, l.direction, l.color, l.intensity, l.range, l.innerConeRadians,
                   l.outerConeRadians);
    mix.value(scene.cameras.size());
    for (const Camera& c : scene.cameras)
        mix.values(c.worldFromCamera, c.fovYRadians, c.nearDistance, c.farDistance, c.apertureRadius,
                   c.focusDistance);
    mix.value(scene.nodes.size());
    for (const Node& n : scene.nodes) {
        mix.values(n.parent, n.translation, glm::vec4(n.rotation.x, n.rotation.y, n.rotation.z, n.rotation.w),
                   n.scale, n.matrix.has_value());
        if (n.matrix)
            mix.value(*n.matrix);
    }
    mix.value(scene.attachments.size());
    for (const Attachment& a : scene.attachments)
        mix.values(a.thing, a.index, a.node, a.nodeFromThing);
    mix.value(scene.animations.size());
    for (const Animation& a : scene.animations) {
        mix.value(a.samplers.size());
        for (const Animation::Sampler& s : a.samplers) {
            mix.value(s.interpolation);
            mix.array(s.seconds);
            mix.array(s.values);
        }
        mix.value(a.channels.size());
        for (const Animation::Channel& c : a.channels)
            mix.values(c.sampler, c.node, c.path);
    }
    mix.value(scene.environment.has_value());
    if (scene.environment) {
        const Image& panorama = scene.environment->panorama;
        mix.values(panorama.width, panorama.height, panorama.channels, panorama.encoding,
                   scene.environment->tint);
        mix.array(panorama.data);
    }
    mix.values(scene.ambientLight, scene.backgroundTop, scene.backgroundBottom);
    return std::max<std::uint64_t>(mix.state(), 1);
}

}  // namespace quincunx

#include "tests/common/scene/random_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "math/vector.h"
#include "scene/animation.h"
#include "scene/import_support.h"

namespace quincunx::test {

namespace {

class Maker {
  public:
    explicit Maker(std::uint64_t seed) : random_(seed) {}

    Scene make() {
        scene_.name = "random \"scene\"";
        const std::size_t materials = 1 + random_.below(4);
        for (std::size_t i = 0; i < materials; ++i)
            addMaterial();
        const std::size_t meshes = 1 + random_.below(4);
        for (std::size_t i = 0; i < meshes; ++i)
            addMesh();
        // Every mesh once; then any.
        const std::size_t instances = meshes + random_.below(6);
        for (std::size_t i = 0; i < instances; ++i)
            scene_.instances.push_back({fmt::format("instance {}", i), i < meshes ? i : random_.below(meshes),
                                        random_.below(materials), affine()});
        for (std::size_t i = random_.below(4); i > 0; --i)
            addLight();
        for (std::size_t i = random_.below(3); i > 0; --i)
            addCamera();
        if (chance(0.6))
            addMotion();
        if (chance(0.5)) {
            scene_.ambientLight = unit3();
            scene_.backgroundTop = unit3();
            scene_.backgroundBottom = unit3();
        }
        if (chance(0.3)) {
            Environment& environment = scene_.environment.emplace();
            environment.panorama = Image(1 + static_cast<int>(random_.below(5)),
                                         1 + static_cast<int>(random_.below(5)), 3, Encoding::linear);
            for (float& value : environment.panorama.data)
                value = std::abs(coordinate());
            environment.tint = unit3();
        }
        poseAtRest(scene_);
        return std::move(scene_);
    }

  private:
    bool chance(double p) { return random_.uniformDouble() < p; }
    float unit() { return random_.uniform(); }
    float coordinate() {
        return static_cast<float>(random_.uniform(-1, 1) * std::exp2(random_.uniform(-9, 9)));
    }
    glm::vec3 unit3() { return {unit(), unit(), unit()}; }
    glm::vec3 point() { return {coordinate(), coordinate(), coordinate()}; }
    glm::vec3 direction() {
        for (;;)
            if (const auto v = normalize(glm::vec3(random_.uniform(-1, 1), random_.uniform(-1, 1), unit())))
                return *v;
    }
    glm::quat rotation() {
        for (;;) {
            const glm::dvec4 q(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1),
                               random_.uniform(-1, 1));
            if (glm::length(q) > 0.1) {
                const glm::vec4 u(q / glm::length(q));
                return {u.w, u.x, u.y, u.z};
            }
        }
    }
    glm::mat4 affine() {
        glm::mat4 m(1);
        if (chance(0.2))
            return m;
        for (int column = 0; column < 4; ++column)
            m[column] = glm::vec4(point(), column == 3 ? 1 : 0);
        if (chance(0.2))
            m[1].x = -0.0f;
        return m;
    }
    glm::mat4 rigid() {
        glm::mat4 m = glm::mat4_cast(rotation());
        m[3] = glm::vec4(point(), 1);
        return m;
    }

    TextureUse addTexture(Encoding encoding) {
        Texture texture;
        texture.name = fmt::format("texture {}", scene_.textures.size());
        texture.image = Image8(1 + static_cast<int>(random_.below(5)), 1 + static_cast<int>(random_.below(5)),
                               1 + static_cast<int>(random_.below(4)), encoding);
        for (std::uint8_t& byte : texture.image.data)
            byte = static_cast<std::uint8_t>(random_.bits());
        texture.wrapS = static_cast<Texture::Wrap>(random_.below(3));
        texture.wrapT = static_cast<Texture::Wrap>(random_.below(3));
        texture.magnification = static_cast<Texture::Filter>(random_.below(2));
        texture.minification = static_cast<Texture::Filter>(random_.below(2));
        texture.mipmaps = static_cast<Texture::Mipmaps>(random_.below(3));
        scene_.textures.push_back(texture);
        TextureUse use(scene_.textures.size() - 1);
        use.texcoordSet = static_cast<int>(random_.below(2));
        glm::mat3& m = use.textureFromTexcoord;
        switch (random_.below(4)) {
            case 0:
                break;
            case 1:
                m[0].x = coordinate();
                m[1].y = coordinate();
                m[2] = glm::vec3(coordinate(), coordinate(), 1);
                break;
            default:  // sheared too
                for (int column = 0; column < 3; ++column)
                    m[column] = glm::vec3(coordinate(), coordinate(), column == 2 ? 1 : 0);
        }
        return use;
    }

    void addMaterial() {
        Material m;
        m.name = fmt::format("material {} \\ \"\xc3\xa9\"", scene_.materials.size());
        m.baseColor = glm::vec4(unit3(), unit());
        m.metallic = unit();
        m.roughness = unit();
        m.alphaMode = static_cast<Material::AlphaMode>(random_.below(3));
        m.alphaCutoff = chance(0.5) ? 0.5f : unit();
        m.doubleSided = chance(0.5);
        if (chance(0.5))
            m.emission = unit3() * (chance(0.5) ? 1.0f : 5000.0f);
        if (chance(0.4))
            m.baseColorTexture = addTexture(Encoding::srgb);
        if (chance(0.4))
            m.metallicRoughnessTexture = addTexture(Encoding::linear);
        if (chance(0.4)) {
            m.normalTexture = addTexture(Encoding::linear);
            m.normalScale = coordinate();
        }
        if (chance(0.4)) {
            m.occlusionTexture = addTexture(Encoding::linear);
            m.occlusionStrength = unit();
        }
        if (chance(0.4))
            m.emissionTexture = addTexture(Encoding::srgb);
        if (chance(0.3)) {
            m.transmission = unit();
            m.ior = 1 + 2 * unit();
        }
        fillPhongFromMetallicRoughness(m);
        if (chance(0.5)) {
            m.ambient = unit3();
            m.diffuse = unit3();
            m.specular = unit3();
            m.shininess = 100 * unit();
        }
        scene_.materials.push_back(m);
    }

    void addMesh() {
        Mesh mesh;
        mesh.name = fmt::format("mesh {}", scene_.meshes.size());
        const std::size_t count = 3 + random_.below(30);
        const bool isTextured = true;
        const bool hasSecond = chance(0.5);
        const bool isColored = chance(0.5);
        for (std::size_t i = 0; i < count; ++i) {
            mesh.positions.push_back(point());
            mesh.normals.push_back(direction());
            if (isTextured)
                mesh.texcoords.emplace_back(coordinate(), coordinate());
            if (hasSecond)
                mesh.texcoords1.emplace_back(coordinate(), coordinate());
            if (isColored)
                mesh.colors.emplace_back(unit3(), unit());
            // Else the reader would make them for normal maps.
            mesh.tangents.emplace_back(direction(), chance(0.5) ? 1 : -1);
        }
        for (std::size_t i = 0; i < 3 * count; ++i)
            mesh.indices.push_back(static_cast<std::uint32_t>(random_.below(count)));
        scene_.meshes.push_back(mesh);
    }

    void addLight() {
        Light light;
        light.kind = static_cast<Light::Kind>(random_.below(3));
        light.name = fmt::format("light {}", scene_.lights.size());
        light.position = point();
        light.direction = direction();
        light.color = unit3();
        light.intensity = 1000 * unit();
        light.range = chance(0.5) ? 0 : 100 * unit();
        if (light.kind == Light::Kind::spot) {
            light.outerConeRadians = 1.5f * unit();
            light.innerConeRadians = light.outerConeRadians * unit();
        }
        scene_.lights.push_back(light);
    }

    void addCamera() {
        Camera camera;
        camera.worldFromCamera = rigid();
        camera.fovYRadians = 0.1f + 2 * unit();
        camera.nearDistance = 0.01f + unit();
        camera.farDistance = chance(0.3) ? std::numeric_limits<float>::infinity() : 2 + 1000 * unit();
        if (chance(0.5)) {
            camera.apertureRadius = unit();
            camera.focusDistance = chance(0.3) ? std::numeric_limits<float>::infinity() : 0.1f + unit();
        }
        scene_.cameras.push_back(camera);
    }

    Animation::Sampler sampler(bool isRotation) {
        Animation::Sampler s;
        s.interpolation = static_cast<Animation::Interpolation>(random_.below(3));
        const bool isCubic = s.interpolation == Animation::Interpolation::cubicSpline;
        float time = chance(0.5) ? 0 : unit();
        for (std::size_t i = 1 + random_.below(5); i > 0; --i) {
            s.seconds.push_back(time);
            time += unit();
            for (int k = 0; k < (isCubic ? 3 : 1); ++k) {
                const glm::quat q = rotation();
                s.values.push_back(isRotation ? glm::vec4(q.x, q.y, q.z, q.w) : glm::vec4(point(), 0));
            }
        }
        return s;
    }

    /// A chain or tree of nodes: the last one of each branch moves, the others do or do not.
    void addMotion() {
        const std::size_t count = 1 + random_.below(5);
        Animation first;
        first.name = "first";
        Animation second;
        second.name = "second";
        std::vector<bool> isParent(count, false);
        for (std::size_t i = 0; i < count; ++i) {
            Node node;
            node.name = fmt::format("node {}", i);
            if (i > 0 && chance(0.7)) {
                node.parent = random_.below(i);
                isParent[node.parent] = true;
            }
            node.translation = point();
            node.rotation = rotation();
            node.scale = point();
            scene_.nodes.push_back(node);
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (isParent[i] && chance(0.3)) {
                scene_.nodes[i] = {scene_.nodes[i].name, scene_.nodes[i].parent, {},
                                   {1, 0, 0, 0},         glm::vec3(1),           affine()};
                continue;
            }
            Animation& animation = chance(0.5) ? first : second;
            const auto path = static_cast<Animation::Path>(random_.below(3));
            animation.channels.push_back({animation.samplers.size(), i, path});
            animation.samplers.push_back(sampler(path == Animation::Path::rotation));
        }
        for (Animation* animation : {&first, &second})
            if (!animation->channels.empty())
                scene_.animations.push_back(*animation);
        // Something hangs from every node that moves, so that none is left out.
        std::vector<bool> moves(count, false);
        for (const Animation& animation : scene_.animations)
            for (const Animation::Channel& channel : animation.channels)
                moves[channel.node] = true;
        for (std::size_t i = 0; i < count; ++i)
            if (moves[i]) {
                scene_.instances.push_back({"rider", 0, 0, glm::mat4(1)});
                scene_.attachments.push_back(
                    {Attachment::Thing::instance, scene_.instances.size() - 1, i, affine()});
            }
        const auto moved = [&] {
            for (;;)
                if (const std::size_t i = random_.below(count); moves[i])
                    return i;
        };
        if (!scene_.lights.empty()) {
            glm::mat4 frame = glm::mat4(*basisAround(direction()));
            frame[3] = glm::vec4(point(), 1);
            scene_.attachments.push_back({Attachment::Thing::light, 0, moved(), frame});
        }
        if (!scene_.cameras.empty())
            scene_.attachments.push_back({Attachment::Thing::camera, 0, moved(), rigid()});
    }

    Random random_;
    Scene scene_;
};

}  // namespace

Scene randomScene(std::uint64_t seed) {
    return Maker(seed).make();
}

}  // namespace quincunx::test

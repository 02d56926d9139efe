#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "image/image.h"
#include "scene/motion.h"

namespace quincunx {

/// A texture: its pixels, how it is repeated and how it is filtered. Filled by an importer or by code.
struct Texture {
    enum class Wrap { repeat, mirroredRepeat, clampToEdge };
    enum class Filter { nearest, linear };
    enum class Mipmaps { none, nearest, linear };
    std::string name;
    Image8 image;
    Wrap wrapS = Wrap::repeat;
    Wrap wrapT = Wrap::repeat;
    Filter magnification = Filter::linear;
    Filter minification = Filter::linear;  ///< within a level
    Mipmaps mipmaps = Mipmaps::linear;     ///< between levels
};

/// A texture as a material reads it.
struct TextureUse {
    TextureUse() = default;
    TextureUse(std::size_t index) : texture(index) {}

    std::size_t texture = 0;           ///< index into Scene::textures
    int texcoordSet = 0;               ///< 0: Mesh::texcoords, 1: Mesh::texcoords1
    glm::mat3 textureFromTexcoord{1};  ///< affine (KHR_texture_transform)
    bool operator==(const TextureUse&) const = default;
};

/// How a surface answers light. Colours are linear RGB. The metallic–roughness numbers are glTF's (section
/// 3.9.2); the Phong numbers are what the classic shading models read. Importers fill both.
struct Material {
    enum class AlphaMode { opaque, mask, blend };
    std::string name;

    glm::vec4 baseColor{1};                              ///< factor, with alpha
    std::optional<TextureUse> baseColorTexture;          ///< sRGB with alpha, multiplied with the factor
    float metallic = 0;                                  ///< 0 dielectric … 1 metal
    float roughness = 0.5f;                              ///< 0 mirror … 1 matt
    std::optional<TextureUse> metallicRoughnessTexture;  ///< linear: G times roughness, B times metallic
    std::optional<TextureUse> normalTexture;             ///< linear: a normal in the tangent frame
    float normalScale = 1;                               ///< of the normal's x and y
    std::optional<TextureUse> occlusionTexture;  ///< linear: R, the share of ambient light that arrives
    float occlusionStrength = 1;                 ///< 0 none … 1 as the texture says
    glm::vec3 emission{0};                       ///< radiance, W/(m² sr) a channel
    std::optional<TextureUse> emissionTexture;   ///< sRGB, multiplied with the emission
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    float transmission = 0;  ///< share of what is not mirrored that goes through: 0 none … 1 glass
    float ior = 1.5f;        ///< index of refraction of the inside, ≥ 1

    glm::vec3 ambient{0.04f};   ///< share of the ambient light sent back
    glm::vec3 diffuse{0.8f};    ///< Lambertian albedo, multiplied with the texture
    glm::vec3 specular{0.04f};  ///< weight of the highlight
    float shininess = 32;       ///< Phong exponent ≥ 0
};

/// A light. Position and direction are in world space.
struct Light {
    enum class Kind { directional, point, spot };
    Kind kind = Kind::directional;
    std::string name;
    glm::vec3 position{0};             ///< point and spot
    glm::vec3 direction{0, -1, 0};     ///< directional and spot: the way the light travels, unit length
    glm::vec3 color{1};                ///< linear RGB
    float intensity = 1;               ///< lux for directional, candela for point and spot, all divided by pi
    float range = 0;                   ///< distance where it ends; 0: no end
    float innerConeRadians = 0;        ///< spot: full strength inside
    float outerConeRadians = 0.7854f;  ///< spot: dark outside
};

/// The eye. It looks along −z of its own frame, y up, right-handed.
struct Camera {
    glm::mat4 worldFromCamera{1};  ///< rigid
    float fovYRadians = 0.7854f;   ///< full vertical angle
    float nearDistance = 0.1f;     ///< > 0
    float farDistance = 100;       ///< > near; infinity allowed
    float apertureRadius = 0;      ///< of a thin lens, in the world's unit; 0: a pinhole, all is sharp
    float focusDistance = 5;       ///< along the view, of what a lens shows sharp; > 0, infinity allowed
};

/// One mesh placed in the world.
struct Instance {
    std::string name;
    std::size_t mesh = 0;      ///< index into Scene::meshes
    std::size_t material = 0;  ///< index into Scene::materials
    glm::mat4 worldFromModel{1};
};

/// Light that comes from infinitely far away, from all around.
struct Environment {
    Image panorama;     ///< radiance, linear RGB, laid out as panoramaDirection in environment_math.glsl
    glm::vec3 tint{1};  ///< multiplied with it
};

/// All that is drawn: plain data, no GL.
struct Scene {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Instance> instances;
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    std::vector<Node> nodes;              ///< parents before children; none where nothing moves
    std::vector<Attachment> attachments;  ///< what `pose` places; all else stays where it is
    std::vector<Animation> animations;
    std::optional<Environment> environment;
    glm::vec3 ambientLight{0.1f};   ///< linear RGB, from every direction
    glm::vec3 backgroundTop{0};     ///< linear RGB at the top row, blending to …
    glm::vec3 backgroundBottom{0};  ///< … this at the bottom row

    /// World-space bounds of all instances.
    Bounds bounds() const;
    std::size_t triangleCount() const;
};

}  // namespace quincunx

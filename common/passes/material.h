#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gl/executor.h"
#include "passes/scene_buffers.h"

/// Metallic–roughness materials (glTF 2.0, section 3.9 and appendix B), drawn by programs that hold only what
/// a material uses.
namespace quincunx {

/// What a material can ask of its program. Numbered as in shaders/lib/material.glsl.
enum class MaterialFeature : std::uint32_t {
    baseColorTexture,
    metallicRoughnessTexture,
    normalMap,
    occlusionTexture,
    emissionTexture,
    vertexColors,
    secondTexcoords,    ///< some texture reads Mesh::texcoords1
    textureTransforms,  ///< some texture is moved, turned or scaled
    alphaMask,
    alphaBlend,
    doubleSided,
    environment,  ///< it mirrors its surroundings
};
inline constexpr std::uint32_t materialFeatureCount = 12;

/// A set of features.
struct MaterialFeatures {
    std::uint32_t bits = 0;

    static constexpr MaterialFeatures all() { return {(1u << materialFeatureCount) - 1}; }
    constexpr bool has(MaterialFeature feature) const {
        return ((bits >> static_cast<std::uint32_t>(feature)) & 1u) != 0;
    }
    constexpr MaterialFeatures with(MaterialFeature feature, bool on = true) const {
        return {on ? bits | (1u << static_cast<std::uint32_t>(feature)) : bits};
    }
    constexpr MaterialFeatures without(MaterialFeature feature) const {
        return {bits & ~(1u << static_cast<std::uint32_t>(feature))};
    }
    friend constexpr MaterialFeatures operator|(MaterialFeatures a, MaterialFeatures b) {
        return {a.bits | b.bits};
    }
    auto operator<=>(const MaterialFeatures&) const = default;
};

/// "base colour texture, normal map"; "no features" for none.
std::string describe(MaterialFeatures features);

/// What the material uses on that mesh. What cannot change a pixel is left out: textures multiplied with 0,
/// occlusion of strength 0, transforms that are the identity.
MaterialFeatures featuresOf(const Material& material, const Mesh& mesh);

/// Metals (metallic ≥ 0.5), which show little else, and what is smooth (roughness ≤ 0.3): the surfaces that
/// an environment map is worth its cost for. All others are lit by Scene::ambientLight.
bool mirrorsSurroundings(const Material& material);

/// Which programs draw the materials. Programs for shadows and environments are fragment shaders of their own
/// that define the hooks named in shaders/lib/material.glsl and include it, with the blocks and samplers that
/// these need. Free for them: texture units 1 to 3 and from 8 on, uniform bindings 2 and from 4 on.
struct MaterialParams {
    std::string fragment = "passes/material.frag";
    /// Of materials that mirror their surroundings; empty: there is no environment map.
    std::string environmentFragment = {};
    std::vector<std::pair<std::string, std::string>> defines = {};
    std::vector<gl::BlockBinding> blocks = {};
    std::vector<gl::SamplerBinding> samplers = {};
    /// Features that every program gets, whether its materials use them or not: the picture stays the same,
    /// bit for bit.
    MaterialFeatures forced = {};
    bool background = true;  ///< draw the frame block's gradient first
    /// The triangles of what blends and is not convex are drawn farthest first, as seen from the frame's eye.
    bool ordersTriangles = false;
};

/// What a frame shows of a scene, and from where. Indices are those of Scene::instances, none twice. Whether
/// an instance blends is its material's to say, not that of the list it is in.
struct MaterialView {
    FrameBlock frame = {};     ///< camera and lights, relative to the anchor
    glm::vec3 anchorWorld{0};  ///< taken off placements, so that what is far from the origin stays sharp
    std::span<const std::uint32_t> visible = {};
    std::span<const std::uint32_t> blended = {};  ///< listed after `visible`; may be empty
};

/// How the depths of materials are drawn.
struct DepthOfMaterials {
    /// The far sides of solids instead of the near ones; what is double-sided or cut out is drawn from both.
    bool backFaces = false;
    /// Which of a frame's views this is: each keeps its instances on the device, and sends them when they
    /// change.
    std::size_t view = 0;
};

/// The program for materials with these features.
gl::ProgramFiles materialProgram(MaterialFeatures features, const MaterialParams& params = {});

/// A scene's meshes, textures and materials on the device, drawn as often a frame as wanted. Instances of one
/// mesh and material are drawn together, 128 a call.
class MaterialPass {
  public:
    /// In the context that is current: uploads the meshes, and the textures and vertex attributes that
    /// materials of instances use. Tangents that a normal map needs and the mesh lacks are made from its
    /// texture coordinates.
    explicit MaterialPass(const Scene& scene);

    /// What the last `draw` did.
    struct Counts {
        std::size_t instances = 0;
        std::size_t drawCalls = 0;
        std::size_t programs = 0;  ///< different ones
        std::uint64_t triangles = 0;
        std::uint64_t orderedTriangles = 0;  ///< of those that were sorted
    };

    /// Draws instances into the bound target, whose depth is clear: opaque ones first, ordered by program,
    /// material and mesh, then those with an alpha mask, then blended ones over them, in the order in which
    /// they are listed (farthest first for a right picture; of what is double-sided, the far sides first).
    /// Takes no time for what is not listed. `scene` may differ from the constructor's in placements, lights
    /// and the numbers and alpha modes of materials; meshes, textures, and which instance and material uses
    /// which of them are the constructor's. Radiance above 65504, the largest half, is drawn as that. Leaves
    /// depth test, culling and blending off.
    void draw(graph::PassContext& context, const Scene& scene, const MaterialView& view,
              const MaterialParams& params = {});
    const Counts& counts() const { return counts_; }

    /// Positions alone, into the bound depth target's viewport, as a light sees them, instanced in the same
    /// way. `clipFromAnchored` is of positions relative to `anchorWorld`. Blended materials cast whole
    /// shadows.
    void drawDepth(graph::PassContext& context, const Scene& scene, const glm::mat4& clipFromAnchored,
                   const glm::vec3& anchorWorld, std::span<const std::uint32_t> casters,
                   const DepthOfMaterials& params = {});

  private:
    /// A material on meshes with or without attributes that it asks for.
    struct Surface {
        std::size_t material = 0;
        std::size_t exampleMesh = 0;  ///< any of its meshes
        MaterialFeatures features;
        std::uint64_t seen = 0;  ///< the last look at visible surfaces that met it
        std::size_t block = 0;   ///< where its MaterialBlock is, in bytes
    };
    /// What one call can draw.
    struct Group {
        std::size_t surface = 0;
        std::size_t mesh = 0;
    };
    /// Placement as shaders read it; std140.
    struct InstanceBlock {
        glm::mat4 worldFromModel{0};
        glm::mat3x4 worldNormalFromModel{0};
        glm::vec4 padding{0};
    };
    struct Placement {
        InstanceBlock block;
        glm::mat4 worldFromModel{0};  ///< the scene's
        glm::vec3 anchorWorld{0};     ///< that the block is relative to
        bool known = false;
        bool mirrored = false;  ///< makes clockwise of counter-clockwise
    };
    /// Instances that stand together in the instance buffer.
    struct Batch {
        std::size_t surface = 0;
        std::size_t mesh = 0;
        std::size_t firstSlot = 0;
        std::size_t count = 0;
        bool mirrored = false;
        std::optional<std::uint32_t> ordered = {};  ///< an instance whose triangles are sorted, alone in this
    };
    struct Frame {
        std::vector<Batch> batches;
        std::size_t blendedFrom = 0;  ///< index of the first batch that is blended
    };

    /// The instances of a list on the device.
    struct InstanceStore {
        gl::Buffer buffer;
        std::vector<InstanceBlock> sent;
    };

    void regroup(const Scene& scene);
    bool surfacesAreAsKnown(const Scene& scene);
    const Placement& place(const Scene& scene, const glm::vec3& anchorWorld, std::uint32_t instance);
    /// Of the instances in `listed_`.
    Frame batch(const Scene& scene, const glm::vec3& anchorWorld, bool ordersTriangles = false);
    bool overlapsItself(const Scene& scene, std::size_t mesh);
    void orderTriangles(const Scene& scene, const glm::vec3& eyeAnchored, const Frame& frame);
    void drawOrderedBatch(const Batch& batch, std::size_t first);
    void sendInstances(InstanceStore& store);
    void sendMaterials(const Scene& scene, const Frame& frame);
    void bindMaterial(const Scene& scene, const Surface& surface, MaterialFeatures used) const;
    void drawBatch(const InstanceStore& store, const Batch& batch);

    MeshBuffers meshes_;
    std::vector<gl::Texture2D> textures_;  ///< empty where no material uses it
    FrameUniforms frameUniforms_;
    InstanceStore forColor_;
    MeshBuffers::Ordered ordered_;
    std::vector<std::optional<bool>> overlapsItself_;  ///< by mesh, where it was asked for
    std::vector<std::size_t> firstOrdered_;            ///< by batch that is ordered, in order
    std::vector<InstanceStore> forDepth_;              ///< by view
    gl::Buffer materialBuffer_;
    std::vector<Surface> surfaces_;
    std::vector<Group> groups_;             ///< in the order of drawing
    std::vector<std::uint32_t> groupOf_;    ///< by instance
    std::vector<Placement> placements_;     ///< by instance
    std::vector<std::uint32_t> listed_;     ///< scratch
    std::vector<std::uint64_t> keys_;       ///< scratch
    std::vector<InstanceBlock> instances_;  ///< scratch
    std::vector<std::byte> materials_;      ///< scratch
    std::vector<std::byte> sentMaterials_;
    std::uint64_t look_ = 0;  ///< counts looks at visible surfaces
    Counts counts_;
};

}  // namespace quincunx

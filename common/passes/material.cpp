#include "passes/material.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "math/transform.h"
#include "passes/forward.h"
#include "passes/triangle_order.h"

namespace quincunx {
namespace {

constexpr GLuint instanceBinding = 1;
constexpr GLuint materialBinding = 3;
constexpr std::size_t maxInstances = 128;  // as in shaders/lib/instances.glsl

/// A texture of a material, in the order of the slots of shaders/lib/material.glsl.
struct Slot {
    MaterialFeature feature;
    std::optional<TextureUse> Material::*use;
    const char* sampler;
    GLuint unit;
};
constexpr std::array<Slot, 5> slots = {{
    {MaterialFeature::baseColorTexture, &Material::baseColorTexture, "baseColorTexture", 0},
    {MaterialFeature::metallicRoughnessTexture, &Material::metallicRoughnessTexture,
     "metallicRoughnessTexture", 4},
    {MaterialFeature::normalMap, &Material::normalTexture, "normalTexture", 5},
    {MaterialFeature::occlusionTexture, &Material::occlusionTexture, "occlusionTexture", 6},
    {MaterialFeature::emissionTexture, &Material::emissionTexture, "emissionTexture", 7},
}};

struct FeatureName {
    const char* name;
    const char* define;
};
constexpr std::array<FeatureName, materialFeatureCount> featureNames = {{
    {"base colour texture", "BASE_COLOR_TEXTURE"},
    {"metallic-roughness texture", "METALLIC_ROUGHNESS_TEXTURE"},
    {"normal map", "NORMAL_MAP"},
    {"occlusion texture", "OCCLUSION_TEXTURE"},
    {"emission texture", "EMISSION_TEXTURE"},
    {"vertex colours", "VERTEX_COLORS"},
    {"second texture coordinates", "SECOND_TEXCOORDS"},
    {"texture transforms", "TEXTURE_TRANSFORMS"},
    {"alpha mask", "ALPHA_MASK"},
    {"alpha blending", "ALPHA_BLEND"},
    {"double-sided", "DOUBLE_SIDED"},
    {"environment", nullptr},  // another fragment shader
}};

/// Uniform block MaterialBlock of shaders/lib/material.glsl, std140, padded to the largest alignment that
/// OpenGL allows a driver to ask of offsets.
struct alignas(256) MaterialBlock {
    glm::vec4 baseColor{1};
    glm::vec4 emission{0};
    glm::vec4 factors{0};
    glm::ivec4 usedBits{0};
    std::array<glm::vec4, 10> textureRows{};
    std::array<glm::vec4, 2> padding{};
};

MaterialBlock makeBlock(const Material& material, MaterialFeatures features) {
    MaterialBlock block;
    block.baseColor = material.baseColor;
    block.emission = glm::vec4(material.emission,
                               material.alphaMode == Material::AlphaMode::mask ? material.alphaCutoff : 0);
    block.factors =
        glm::vec4(material.metallic, material.roughness, material.normalScale, material.occlusionStrength);
    block.usedBits.x = static_cast<int>(features.bits);
    for (std::size_t i = 0; i < slots.size(); ++i) {
        if (!features.has(slots[i].feature))
            continue;
        const TextureUse& use = *(material.*slots[i].use);
        if (use.texcoordSet == 1 && features.has(MaterialFeature::secondTexcoords))
            block.usedBits.y |= 1 << i;
        const glm::mat3& m = use.textureFromTexcoord;
        block.textureRows[2 * i] = {m[0].x, m[1].x, m[2].x, 0};
        block.textureRows[2 * i + 1] = {m[0].y, m[1].y, m[2].y, 0};
    }
    return block;
}

/// 0 opaque, 1 cut out, 2 blended: the order of drawing.
int stageOf(MaterialFeatures features) {
    return features.has(MaterialFeature::alphaBlend) ? 2 : features.has(MaterialFeature::alphaMask) ? 1 : 0;
}

/// What a depth map has to know of a material.
MaterialFeatures featuresOfDepth(MaterialFeatures features) {
    if (!features.has(MaterialFeature::alphaMask))
        return {};
    const MaterialFeatures read = MaterialFeatures{}
                                      .with(MaterialFeature::alphaMask)
                                      .with(MaterialFeature::baseColorTexture)
                                      .with(MaterialFeature::vertexColors)
                                      .with(MaterialFeature::secondTexcoords)
                                      .with(MaterialFeature::textureTransforms);
    return {features.bits & read.bits};
}

void addDefines(MaterialFeatures features, gl::ProgramFiles& files) {
    for (std::uint32_t i = 0; i < materialFeatureCount; ++i)
        if (featureNames[i].define != nullptr && features.has(static_cast<MaterialFeature>(i)))
            files.defines.emplace_back(featureNames[i].define, "");
    if (std::any_of(slots.begin(), slots.end(), [&](const Slot& slot) { return features.has(slot.feature); }))
        files.defines.emplace_back("TEXTURED", "");
    for (const Slot& slot : slots)
        if (features.has(slot.feature))
            files.samplers.push_back({slot.sampler, static_cast<GLint>(slot.unit)});
}

std::vector<gl::BlockBinding> blockBindings() {
    return {{"FrameBlock", SceneBuffers::bindings()[0].binding},
            {"InstanceBlock", instanceBinding},
            {"MaterialBlock", materialBinding}};
}

gl::ProgramFiles depthProgram(MaterialFeatures features) {
    gl::ProgramFiles files{.label = "depth of materials",
                           .vertex = "passes/material_depth.vert",
                           .fragment = "passes/material_depth.frag",
                           .blocks = blockBindings()};
    addDefines(features, files);
    return files;
}

std::vector<VertexExtras> extrasOf(const Scene& scene) {
    std::vector<VertexExtras> extras(scene.meshes.size(), {.texcoords = false});
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        const MaterialFeatures features = featuresOf(material, scene.meshes[instance.mesh]);
        VertexExtras& extra = extras[instance.mesh];
        // What a factor of 0 multiplies away today may count tomorrow.
        extra.texcoords = extra.texcoords || std::any_of(slots.begin(), slots.end(), [&](const Slot& slot) {
                              return (material.*slot.use).has_value();
                          });
        extra.texcoords1 = extra.texcoords1 || features.has(MaterialFeature::secondTexcoords);
        extra.colors = extra.colors || features.has(MaterialFeature::vertexColors);
        if (features.has(MaterialFeature::normalMap) && !extra.tangentsFor)
            extra.tangentsFor = material.normalTexture;
    }
    return extras;
}

/// Bits of a key: the mesh and material, whether it is mirrored, and where in the list it stands.
constexpr int groupShift = 33;
constexpr int mirroredShift = 32;

/// GL's fixed state while instances are drawn; back to what it was at the end.
class DrawState {
  public:
    DrawState() { glEnable(GL_DEPTH_TEST); }
    DrawState(const DrawState&) = delete;
    DrawState& operator=(const DrawState&) = delete;
    void cull(bool on) { change(culls_, on, GL_CULL_FACE); }
    void frontIsClockwise(bool on) {
        if (on != clockwise_)
            glFrontFace(on ? GL_CW : GL_CCW);
        clockwise_ = on;
    }
    void blend() {
        if (blends_)
            return;
        change(blends_, true, GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glDepthMask(GL_FALSE);
    }
    void restore() {
        if (blends_) {
            glDepthMask(GL_TRUE);
            change(blends_, false, GL_BLEND);
        }
        cull(false);
        frontIsClockwise(false);
        glDisable(GL_DEPTH_TEST);
    }

  private:
    static void change(bool& state, bool on, GLenum capability) {
        if (state != on)
            on ? glEnable(capability) : glDisable(capability);
        state = on;
    }
    bool culls_ = false;
    bool clockwise_ = false;
    bool blends_ = false;
};

}  // namespace

std::string describe(MaterialFeatures features) {
    std::string words;
    for (std::uint32_t i = 0; i < materialFeatureCount; ++i)
        if (features.has(static_cast<MaterialFeature>(i)))
            words += (words.empty() ? "" : ", ") + std::string(featureNames[i].name);
    return words.empty() ? "no features" : words;
}

bool mirrorsSurroundings(const Material& material) {
    return material.metallic >= 0.5f || material.roughness <= 0.3f;
}

MaterialFeatures featuresOf(const Material& material, const Mesh& mesh) {
    const auto isMultipliedAway = [&](MaterialFeature feature) {
        switch (feature) {
            case MaterialFeature::metallicRoughnessTexture:
                return material.metallic == 0 && material.roughness == 0;
            case MaterialFeature::occlusionTexture:
                return material.occlusionStrength == 0;
            case MaterialFeature::emissionTexture:
                return material.emission == glm::vec3(0);
            default:
                return false;
        }
    };
    MaterialFeatures features;
    for (const Slot& slot : slots) {
        const std::optional<TextureUse>& use = material.*slot.use;
        if (!use || isMultipliedAway(slot.feature))
            continue;
        features = features.with(slot.feature);
        if (use->texcoordSet == 1 && !mesh.texcoords1.empty())
            features = features.with(MaterialFeature::secondTexcoords);
        if (use->textureFromTexcoord != glm::mat3(1))
            features = features.with(MaterialFeature::textureTransforms);
    }
    return features.with(MaterialFeature::vertexColors, !mesh.colors.empty())
        .with(MaterialFeature::alphaMask, material.alphaMode == Material::AlphaMode::mask)
        .with(MaterialFeature::alphaBlend, material.alphaMode == Material::AlphaMode::blend)
        .with(MaterialFeature::doubleSided, material.doubleSided)
        .with(MaterialFeature::environment, mirrorsSurroundings(material));
}

gl::ProgramFiles materialProgram(MaterialFeatures features, const MaterialParams& params) {
    const MaterialFeatures all = features | params.forced;
    const bool environment = all.has(MaterialFeature::environment) && !params.environmentFragment.empty();
    gl::ProgramFiles files{.label = "material: " + describe(all),
                           .vertex = "passes/material.vert",
                           .fragment = environment ? params.environmentFragment : params.fragment,
                           .defines = params.defines,
                           .blocks = blockBindings(),
                           .samplers = params.samplers};
    files.blocks.insert(files.blocks.end(), params.blocks.begin(), params.blocks.end());
    addDefines(all, files);
    if (all != features)
        files.defines.emplace_back("FORCED_FEATURES", "");
    return files;
}

MaterialPass::MaterialPass(const Scene& scene)
    : meshes_(scene.meshes, extrasOf(scene)),
      materialBuffer_("material blocks", GL_UNIFORM_BUFFER, {}, GL_DYNAMIC_DRAW),
      placements_(scene.instances.size()) {
    textures_.resize(scene.textures.size());
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        for (const Slot& slot : slots) {
            const std::optional<TextureUse>& use = material.*slot.use;
            if (use && !textures_[use->texture])
                textures_[use->texture] = makeTexture(scene.textures[use->texture]);
        }
    }
    regroup(scene);
}

void MaterialPass::regroup(const Scene& scene) {
    QX_CHECK_EQ(scene.instances.size(), placements_.size());
    surfaces_.clear();
    groups_.clear();
    std::map<std::pair<std::size_t, MaterialFeatures>, std::size_t> surfaceOf;
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> groupOf;
    groupOf_.resize(scene.instances.size());
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const auto [material, mesh] = std::pair(scene.instances[i].material, scene.instances[i].mesh);
        const MaterialFeatures features = featuresOf(scene.materials[material], scene.meshes[mesh]);
        const auto surface = surfaceOf.try_emplace({material, features}, surfaces_.size());
        if (surface.second)
            surfaces_.push_back({material, mesh, features});
        const std::size_t s = surface.first->second;
        const auto group = groupOf.try_emplace({s, mesh}, static_cast<std::uint32_t>(groups_.size()));
        if (group.second)
            groups_.push_back({s, mesh});
        groupOf_[i] = group.first->second;
    }
    // Numbered in the order of drawing.
    std::vector<std::uint32_t> order(groups_.size());
    for (std::uint32_t g = 0; g < order.size(); ++g)
        order[g] = g;
    const auto key = [&](std::uint32_t g) {
        const Surface& surface = surfaces_[groups_[g].surface];
        return std::tuple(stageOf(surface.features),
                          surface.features.without(MaterialFeature::environment).bits, surface.features.bits,
                          groups_[g].surface, groups_[g].mesh);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    std::vector<Group> ordered(groups_.size());
    std::vector<std::uint32_t> newNumber(groups_.size());
    for (std::uint32_t g = 0; g < order.size(); ++g) {
        ordered[g] = groups_[order[g]];
        newNumber[order[g]] = g;
    }
    groups_ = std::move(ordered);
    for (std::uint32_t& group : groupOf_)
        group = newNumber[group];
}

bool MaterialPass::surfacesAreAsKnown(const Scene& scene) {
    ++look_;
    for (const std::uint32_t i : listed_) {
        QX_CHECK_LT(i, groupOf_.size());
        Surface& surface = surfaces_[groups_[groupOf_[i]].surface];
        if (surface.seen == look_)
            continue;
        surface.seen = look_;
        if (featuresOf(scene.materials[surface.material], scene.meshes[surface.exampleMesh]) !=
            surface.features)
            return false;
    }
    return true;
}

const MaterialPass::Placement& MaterialPass::place(const Scene& scene, const glm::vec3& anchorWorld,
                                                   std::uint32_t instance) {
    const glm::mat4& worldFromModel = scene.instances[instance].worldFromModel;
    Placement& placement = placements_[instance];
    if (placement.known && placement.anchorWorld == anchorWorld &&
        std::memcmp(&placement.worldFromModel, &worldFromModel, sizeof(glm::mat4)) == 0)
        return placement;
    placement.known = true;
    placement.anchorWorld = anchorWorld;
    placement.worldFromModel = worldFromModel;
    placement.block.worldFromModel = worldFromModel;
    placement.block.worldFromModel[3] -= glm::vec4(anchorWorld, 0);
    const glm::mat3 normals = normalMatrix(worldFromModel);
    for (int column = 0; column < 3; ++column)
        placement.block.worldNormalFromModel[column] = glm::vec4(normals[column], 0);
    placement.mirrored = glm::determinant(glm::dmat3(glm::mat3(worldFromModel))) < 0;
    return placement;
}

bool MaterialPass::overlapsItself(const Scene& scene, std::size_t mesh) {
    overlapsItself_.resize(scene.meshes.size());
    std::optional<bool>& known = overlapsItself_[mesh];
    if (!known)
        known = !isConvex(scene.meshes[mesh]);
    return *known;
}

void MaterialPass::orderTriangles(const Scene& scene, const glm::vec3& eyeAnchored, const Frame& frame) {
    ordered_.begin();
    firstOrdered_.clear();
    for (const Batch& batch : frame.batches)
        if (batch.ordered) {
            const std::vector<std::uint32_t> triangles = trianglesFarthestFirst(
                scene.meshes[batch.mesh], placements_[*batch.ordered].block.worldFromModel, eyeAnchored);
            firstOrdered_.push_back(ordered_.add(meshes_, batch.mesh, triangles));
            counts_.orderedTriangles += triangles.size();
        }
    ordered_.send(meshes_);
}

MaterialPass::Frame MaterialPass::batch(const Scene& scene, const glm::vec3& anchorWorld,
                                        bool ordersTriangles) {
    QX_CHECK_EQ(scene.instances.size(), placements_.size());
    if (!surfacesAreAsKnown(scene))
        regroup(scene);
    const auto featuresAt = [&](std::uint32_t instance) {
        return surfaces_[groups_[groupOf_[instance]].surface].features;
    };
    keys_.clear();
    keys_.reserve(listed_.size());
    for (const bool blended : {false, true}) {
        for (std::size_t k = 0; k < listed_.size(); ++k) {
            if ((stageOf(featuresAt(listed_[k])) == 2) != blended)
                continue;
            const std::uint64_t mirrored = place(scene, anchorWorld, listed_[k]).mirrored ? 1 : 0;
            keys_.push_back(std::uint64_t{groupOf_[listed_[k]]} << groupShift | mirrored << mirroredShift |
                            k);
        }
        if (!blended)
            std::sort(keys_.begin(), keys_.end());
    }

    Frame frame;
    instances_.clear();
    std::uint64_t last = ~std::uint64_t{0};
    for (const std::uint64_t key : keys_) {
        const std::uint64_t kind = key >> mirroredShift;
        const Group& group = groups_[key >> groupShift];
        const MaterialFeatures features = surfaces_[group.surface].features;
        const bool blended = stageOf(features) == 2;
        const bool ordered = blended && ordersTriangles && overlapsItself(scene, group.mesh);
        // The far sides of one come before the near sides of the same, not of the next.
        const bool alone = ordered || (blended && features.has(MaterialFeature::doubleSided));
        if (kind != last || alone || frame.batches.back().count == maxInstances) {
            last = kind;
            // Uniform buffers are bound at multiples of 256 bytes.
            if (instances_.size() % 2 != 0)
                instances_.emplace_back();
            frame.batches.push_back({group.surface, group.mesh, instances_.size(), 0, (kind & 1) != 0, {}});
            if (ordered)
                frame.batches.back().ordered = listed_[key & 0xffffffffu];
            if (!blended)
                frame.blendedFrom = frame.batches.size();
        }
        instances_.push_back(placements_[listed_[key & 0xffffffffu]].block);
        ++frame.batches.back().count;
    }
    return frame;
}

void MaterialPass::sendInstances(InstanceStore& store) {
    // A binding covers a whole block, also for the last batch.
    instances_.resize(instances_.size() + maxInstances);
    if (!store.buffer)
        store.buffer = gl::Buffer("instances", GL_UNIFORM_BUFFER, {}, GL_DYNAMIC_DRAW);
    const bool same =
        store.sent.size() == instances_.size() &&
        std::memcmp(store.sent.data(), instances_.data(), instances_.size() * sizeof(InstanceBlock)) == 0;
    if (same)
        return;
    store.buffer.upload(std::as_bytes(std::span(instances_)));
    std::swap(store.sent, instances_);
}

void MaterialPass::sendMaterials(const Scene& scene, const Frame& frame) {
    materials_.clear();
    ++look_;
    for (const Batch& batch : frame.batches) {
        Surface& surface = surfaces_[batch.surface];
        if (surface.seen == look_)
            continue;
        surface.seen = look_;
        surface.block = materials_.size();
        const MaterialBlock block = makeBlock(scene.materials[surface.material], surface.features);
        const auto bytes = std::as_bytes(std::span(&block, 1));
        materials_.insert(materials_.end(), bytes.begin(), bytes.end());
    }
    if (materials_ == sentMaterials_)
        return;
    materialBuffer_.upload(materials_);
    std::swap(materials_, sentMaterials_);
}

void MaterialPass::bindMaterial(const Scene& scene, const Surface& surface, MaterialFeatures used) const {
    materialBuffer_.bindUniform(materialBinding, surface.block, sizeof(MaterialBlock));
    const Material& material = scene.materials[surface.material];
    for (const Slot& slot : slots)
        if (used.has(slot.feature))
            textures_[(material.*slot.use)->texture].bind(slot.unit);
}

void MaterialPass::drawBatch(const InstanceStore& store, const Batch& batch) {
    store.buffer.bindUniform(instanceBinding, batch.firstSlot * sizeof(InstanceBlock),
                             maxInstances * sizeof(InstanceBlock));
    meshes_.bind(batch.mesh);
    meshes_.drawInstanced(batch.mesh, batch.count);
    ++counts_.drawCalls;
    counts_.instances += batch.count;
    counts_.triangles += batch.count * meshes_.triangleCount(batch.mesh);
}

void MaterialPass::drawOrderedBatch(const Batch& batch, std::size_t first) {
    forColor_.buffer.bindUniform(instanceBinding, batch.firstSlot * sizeof(InstanceBlock),
                                 maxInstances * sizeof(InstanceBlock));
    ordered_.bind(meshes_, batch.mesh);
    ordered_.draw(meshes_, batch.mesh, first);
    ++counts_.drawCalls;
    ++counts_.instances;
    counts_.triangles += meshes_.triangleCount(batch.mesh);
}

void MaterialPass::draw(graph::PassContext& context, const Scene& scene, const MaterialView& view,
                        const MaterialParams& params) {
    counts_ = {};
    frameUniforms_.update(view.frame);
    frameUniforms_.bind();
    if (params.background)
        drawBackground(context);
    listed_.assign(view.visible.begin(), view.visible.end());
    listed_.insert(listed_.end(), view.blended.begin(), view.blended.end());
    if (listed_.empty())
        return;
    const Frame batches = batch(scene, view.anchorWorld, params.ordersTriangles);
    orderTriangles(scene, glm::vec3(view.frame.eyeWorld), batches);
    auto firstOrdered = firstOrdered_.cbegin();
    sendInstances(forColor_);
    sendMaterials(scene, batches);

    DrawState state;
    const Surface* bound = nullptr;
    std::optional<MaterialFeatures> program;
    for (std::size_t b = 0; b < batches.batches.size(); ++b) {
        const Batch& batch = batches.batches[b];
        const Surface& surface = surfaces_[batch.surface];
        // Without an environment map, what would mirror it is drawn like the rest.
        const MaterialFeatures used = params.environmentFragment.empty()
                                          ? surface.features.without(MaterialFeature::environment)
                                          : surface.features;
        if (program != used) {
            program = used;
            context.programs().get(materialProgram(used, params)).use();
            ++counts_.programs;
        }
        if (bound != &surface) {
            bound = &surface;
            bindMaterial(scene, surface, surface.features);
        }
        const bool doubleSided = surface.features.has(MaterialFeature::doubleSided);
        const bool blended = b >= batches.blendedFrom;
        state.frontIsClockwise(batch.mirrored);
        if (blended)
            state.blend();
        if (batch.ordered) {
            // Both sides of a double-sided one in one order: of what is not convex some near sides lie behind
            // far ones.
            state.cull(!doubleSided);
            drawOrderedBatch(batch, *firstOrdered++);
            continue;
        }
        state.cull(blended || !doubleSided);
        if (blended && doubleSided) {
            glCullFace(GL_FRONT);
            drawBatch(forColor_, batch);
            glCullFace(GL_BACK);
            counts_.instances -= batch.count;
        }
        drawBatch(forColor_, batch);
    }
    state.restore();
}

void MaterialPass::drawDepth(graph::PassContext& context, const Scene& scene,
                             const glm::mat4& clipFromAnchored, const glm::vec3& anchorWorld,
                             std::span<const std::uint32_t> casters, const DepthOfMaterials& params) {
    counts_ = {};
    if (casters.empty())
        return;
    listed_.assign(casters.begin(), casters.end());
    const Frame batches = batch(scene, anchorWorld);
    if (forDepth_.size() <= params.view)
        forDepth_.resize(params.view + 1);
    InstanceStore& store = forDepth_[params.view];
    sendInstances(store);
    sendMaterials(scene, batches);

    DrawState state;
    if (params.backFaces)
        glCullFace(GL_FRONT);
    std::optional<MaterialFeatures> program;
    for (const Batch& batch : batches.batches) {
        const Surface& surface = surfaces_[batch.surface];
        const MaterialFeatures features = featuresOfDepth(surface.features);
        if (program != features) {
            program = features;
            const gl::Program& depth = context.programs().get(depthProgram(features));
            depth.set("depthClipFromAnchored", clipFromAnchored);
            depth.use();
            ++counts_.programs;
        }
        const bool cutOut = features.has(MaterialFeature::alphaMask);
        if (cutOut)
            bindMaterial(scene, surface, features);
        state.cull(!cutOut && !surface.features.has(MaterialFeature::doubleSided));
        state.frontIsClockwise(batch.mirrored);
        drawBatch(store, batch);
    }
    if (params.backFaces)
        glCullFace(GL_BACK);
    state.restore();
}

}  // namespace quincunx

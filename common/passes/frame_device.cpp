#include "passes/frame_device.h"

#include <cstring>

#include "base/check.h"

namespace quincunx {
namespace {

template <typename T>
void append(std::vector<std::byte>& bytes, const T& value) {
    const auto* const begin = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(T));
}

/// Bytes that are equal where the map is: of the lights and of each object that it shows.
std::vector<std::byte> shownBy(const Scene& scene, const Surroundings& surroundings,
                               const FrameBlock& block) {
    std::vector<std::byte> bytes;
    append(bytes, surroundings.positionWorld);
    append(bytes, block.ambientLight);
    append(bytes, block.backgroundTop);
    append(bytes, block.backgroundBottom);
    append(bytes, block.lightCount);
    append(bytes, block.lights);
    for (const auto* instances : {&surroundings.solid, &surroundings.blended})
        for (const std::uint32_t i : *instances) {
            const Instance& instance = scene.instances[i];
            const Material& material = scene.materials[instance.material];
            append(bytes, i);
            append(bytes, instance.worldFromModel);
            append(bytes, material.baseColor);
            append(bytes, material.emission);
            append(bytes, glm::vec3(material.metallic, material.roughness, material.alphaCutoff));
            append(bytes, material.alphaMode);
        }
    return bytes;
}

}  // namespace

MaterialPass& FrameDevice::materials(const Scene& scene) {
    if (!materials_)
        materials_.emplace(scene);
    return *materials_;
}

FrameShadows& FrameDevice::shadows() {
    if (!shadows_)
        shadows_.emplace();
    return *shadows_;
}

const SceneBuffers& FrameDevice::movingMeshes(const Scene& scene) {
    if (!movingMeshes_) {
        movingMeshes_.emplace(scene, SceneBuffers::Layout::shared);
        movingMeshes_->updateObjects(std::vector<ObjectBlock>(scene.instances.size()));
    }
    return *movingMeshes_;
}

EnvironmentMap& FrameDevice::environment(graph::PassContext& context, const FrameView& view,
                                         const Surroundings& surroundings) {
    const Scene& scene = view.scene;
    const int resolution = view.settings.environmentResolution;
    QX_CHECK_GE(resolution, 1);
    std::vector<Light> lights;
    for (const std::size_t l : surroundings.lights) {
        lights.push_back(scene.lights[l]);
        lights.back().position -= surroundings.positionWorld;
    }
    FrameBlock block = makeFrameBlock(scene, lights, glm::mat4(1), glm::vec3(0));
    std::vector<std::byte> shows = shownBy(scene, surroundings, block);
    append(shows, resolution);
    if (environment_ && shows == environmentShows_)
        return *environment_;
    if (!environment_)
        environment_.emplace();
    ++environmentsTaken_;
    MaterialPass& drawn = materials(scene);
    environment_->render(context,
                         {.position = glm::vec3(0),
                          .nearDistance = surroundings.nearDistance,
                          .farDistance = surroundings.farDistance,
                          .zenith = scene.backgroundTop,
                          .nadir = scene.backgroundBottom},
                         [&](graph::PassContext& inner, const ForwardView& face) {
                             block.clipFromWorld = face.clipFromWorld;
                             block.eyeWorld = glm::vec4(face.eyeWorld, 1);
                             drawn.draw(inner, scene,
                                        {.frame = block,
                                         .anchorWorld = surroundings.positionWorld,
                                         .visible = surroundings.solid,
                                         .blended = surroundings.blended},
                                        {.background = false});
                         },
                         {.size = resolution, .levels = 6, .samples = 32});
    environmentShows_ = std::move(shows);
    return *environment_;
}

}  // namespace quincunx

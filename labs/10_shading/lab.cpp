#include "labs/10_shading/lab.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "image/filter.h"
#include "math/transform.h"
#include "passes/targets.h"
#include "scene/import.h"

namespace quincunx {

namespace {

/// Where `compare` shows one of the three models, in pixels of the drawn picture, and how.
struct Column {
    int left = 0;
    int width = 1;
    float aspect = 1;
    Camera camera;  ///< sees as much of the scene as the whole picture's does
};

Column columnOf(int index, int width, int height, const Camera& camera) {
    Column column;
    column.left = width * index / 3;
    column.width = std::max(width * (index + 1) / 3 - column.left, 1);
    column.aspect = static_cast<float>(column.width) / static_cast<float>(height);
    const float whole = static_cast<float>(width) / static_cast<float>(height);
    column.camera = fittedToAspect(camera, column.aspect, std::min(whole, composedAspect));
    return column;
}

float scaledShininess(const Material& material, float times) {
    constexpr float most = 1e5f;  // what the shaders' bound on cosine powers is derived for
    return std::min(material.shininess * times, most);
}

/// A white line between two pictures.
void fillColumn(int left, int width, int height) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(left, 0, width, height);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
}

}  // namespace

ShadingLab::ShadingLab() : stillLife_(makeStillLife()) {}

void ShadingLab::useScene(Scene scene) {
    if (scene.lights.empty())
        scene.lights = studioLights();
    scene.backgroundTop = stillLife_.backgroundTop;
    scene.backgroundBottom = stillLife_.backgroundBottom;
    scene_ = std::make_shared<const Scene>(std::move(scene));
    builtIn_ = false;
    tessellation.setIdle("imported models keep their own triangles");
    shared_.reset();
    facets_.reset();
}

Camera ShadingLab::defaultCamera() const {
    if (builtIn_)
        return stillLife_.camera;
    return scene_->cameras.empty() ? frameBounds(scene_->bounds(), composedAspect) : scene_->cameras.front();
}

Bounds ShadingLab::sceneBounds() const {
    return builtIn_ ? quincunx::tessellate(stillLife_, 8).bounds() : scene_->bounds();
}

glm::mat4 ShadingLab::worldFromScene() const {
    glm::mat4 result(1);
    result[0][0] = mirror ? -1.0f : 1.0f;
    result[1][0] = shear;
    return result;
}

PhongModel ShadingLab::model() const {
    return {reflection.as<PhongModel::Reflection>(), ambient, diffuse, specular, emission};
}

std::vector<Light> ShadingLab::turnedLights() const {
    std::vector<Light> lights = builtIn_ ? stillLife_.lights : scene_->lights;
    const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(static_cast<float>(lightTurn)), {0, 1, 0}));
    for (Light& light : lights) {
        light.position = turn * light.position;
        light.direction = turn * light.direction;
    }
    return lights;
}

void ShadingLab::prepareScene() {
    if (!builtIn_ || builtTessellation_ == tessellation)
        return;
    scene_ = std::make_shared<const Scene>(quincunx::tessellate(stillLife_, tessellation));
    builtTessellation_ = tessellation;
    shared_.reset();
    facets_.reset();
}

std::optional<SceneBuffers>& ShadingLab::buffersFor(ShadingModel model) {
    std::optional<SceneBuffers>& buffers =
        layoutFor(model) == SceneBuffers::Layout::shared ? shared_ : facets_;
    if (!buffers)
        buffers.emplace(*scene_, layoutFor(model));
    return buffers;
}

std::vector<ObjectBlock> ShadingLab::objectBlocks() const {
    std::vector<ObjectBlock> blocks;
    blocks.reserve(scene_->instances.size());
    for (const Instance& instance : scene_->instances) {
        Material material = scene_->materials[instance.material];
        material.ambient *= ambient ? 1 : 0;
        material.diffuse *= diffuse ? 1 : 0;
        material.specular *= specular ? 1 : 0;
        material.emission *= emission ? 1 : 0;
        material.shininess = scaledShininess(material, shininessScale);
        const glm::mat4 worldFromModel = worldFromScene() * instance.worldFromModel;
        blocks.push_back(makeObjectBlock(material, worldFromModel));
        const glm::mat3 chosen = normals.as<Normals>() == Normals::model ? glm::mat3(worldFromModel)
                                 : normals.as<Normals>() == Normals::inverseTranspose
                                     ? normalMatrixNaive(worldFromModel)
                                     : normalMatrix(worldFromModel);
        for (int column = 0; column < 3; ++column)
            blocks.back().worldNormalFromModel[static_cast<std::size_t>(column)] =
                glm::vec4(chosen[column], 0);
    }
    return blocks;
}

graph::Resource ShadingLab::build(graph::FrameGraph& graph, const Frame& frame) {
    prepareScene();
    const PictureTargets targets =
        addPictureTargets(graph, {frame.pictureFormat, frame.width, frame.height, supersample});
    graph.addPass({.name = "shade",
                   .reads = {},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, frame, targets](graph::PassContext& context) {
                       drawScene(context, frame, targets.factor);
                   }});
    addResolvePass(graph, targets);
    return targets.picture;
}

void ShadingLab::drawScene(graph::PassContext& context, const Frame& frame, int factor) {
    const std::vector<ObjectBlock> objects = objectBlocks();
    ForwardParams params;
    const bool blinnPhong = model().reflection == PhongModel::Reflection::blinnPhong;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        params.doubleSided.push_back(scene_->materials[scene_->instances[i].material].doubleSided);
        params.mirrored.push_back(glm::determinant(glm::mat3(objects[i].worldFromModel)) < 0);
    }
    const auto draw = [&](ShadingModel one, const Camera& camera, float aspect) {
        params.program = shadingProgram(one, blinnPhong);
        SceneBuffers& buffers = *buffersFor(one);
        buffers.update(makeFrameBlock(*scene_, turnedLights(), camera, aspect), objects);
        drawForward(context, buffers, params);
        counters_["triangles"] += buffers.triangleCount();
        counters_["vertices"] += buffers.vertexCount();
    };

    counters_.clear();
    glClear(GL_DEPTH_BUFFER_BIT);
    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    const Shading mode = shading.as<Shading>();
    if (mode != Shading::compare) {
        draw(static_cast<ShadingModel>(mode), frame.camera, aspect);
        return;
    }
    const int width = frame.width * factor;
    const int height = frame.height * factor;
    for (int i = 0; i < 3; ++i) {
        const Column column = columnOf(i, width, height, frame.camera);
        glViewport(column.left, 0, column.width, height);
        draw(static_cast<ShadingModel>(i), column.camera, column.aspect);
        if (i > 0)
            fillColumn(column.left - factor, 2 * factor, height);
    }
    glViewport(0, 0, width, height);
}

std::function<TraceScene()> ShadingLab::exactScene() const {
    const auto sharpen = [times = static_cast<float>(shininessScale)](Material& material) {
        material.shininess = scaledShininess(material, times);
    };
    const glm::mat4 placement = worldFromScene();
    if (!builtIn_)
        return [sharpen, placement, scene = scene_, lights = turnedLights()] {
            Scene exact = placedBy(*scene, placement);
            exact.lights = lights;
            std::for_each(exact.materials.begin(), exact.materials.end(), sharpen);
            return TraceScene(std::move(exact));
        };
    StillLife exact = placedBy(stillLife_, placement);
    exact.lights = turnedLights();
    for (StillLife::Object& object : exact.objects)
        sharpen(object.material);
    return [exact] { return TraceScene(exact); };
}

Lab::ReferenceJob ShadingLab::reference(const Frame& frame) const {
    const auto trace = [make = exactScene(), model = model()](const Camera& camera, int width, int height,
                                                              const std::atomic<bool>& stop) {
        return traceReference(make(), camera, width, height, model, &stop);
    };
    const bool compare = shading.as<Shading>() == Shading::compare;
    return [trace, frame, compare, factor = static_cast<int>(supersample)](const std::atomic<bool>& stop) {
        const int width = frame.width * factor;
        const int height = frame.height * factor;
        if (!compare)
            return boxDownsample(trace(frame.camera, width, height, stop), factor);
        Image fine(width, height, 4, Encoding::linear);
        for (int i = 0; i < 3; ++i) {
            const Column column = columnOf(i, width, height, frame.camera);
            const Image picture = trace(column.camera, column.width, height, stop);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < column.width && column.left + x < width; ++x)
                    for (int c = 0; c < 4; ++c)
                        fine.pixel(column.left + x, y)[c] = picture.pixel(x, y)[c];
            for (int y = 0; y < height && i > 0; ++y)
                for (int x = std::max(column.left - factor, 0); x < std::min(column.left + factor, width);
                     ++x)
                    std::fill_n(fine.pixel(x, y), 4, 1.0f);
        }
        return boxDownsample(fine, factor);
    };
}

Exercise ShadingLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the highlights", {{"specular", "off"}}},
                        {"the diffuse light", {{"diffuse", "off"}}},
                        {"where the light comes from", {{"light-turn", "50"}}}};
    exercise.freeKnobs = {"supersample"};
    exercise.shader = "passes/phong.frag";
    exercise.scenes = {{{"light-turn", "70"}}, {{"reflection", "phong"}, {"shininess-scale", "0.3"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::ShadingLab)

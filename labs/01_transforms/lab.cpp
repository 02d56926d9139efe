#include "labs/01_transforms/lab.h"

#include <cmath>
#include <span>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "math/projection.h"
#include "math/transform.h"
#include "scene/import.h"

namespace quincunx {

TransformsLab::TransformsLab()
    : boat_(makeBoat()),
      sea_(makeSea()),
      worldFromSea_(sea_.scene().instances[0].worldFromModel),
      vertices_(namedVertices(boat_.scene())) {
    for (const Instance& part : boat_.scene().instances)
        boatFromPart_.push_back(part.worldFromModel);
}

Camera TransformsLab::defaultCamera() const {
    Camera camera;
    camera.worldFromCamera = lookAt({2.7f, 2.2f, 6.4f}, {0.25f, 0.92f, 0}, {0, 1, 0});
    camera.fovYRadians = glm::radians(static_cast<float>(fov));
    camera.nearDistance = nearPlane;
    camera.farDistance = farPlane;
    return camera;
}

Bounds TransformsLab::sceneBounds() const {
    Bounds bounds = sea_.scene().bounds();
    bounds.extend(glm::vec3(0, 2.5f, 0));
    return bounds;
}

glm::mat4 TransformsLab::worldFromBoat(int orderIndex) const {
    const glm::mat4 identity(1);
    const glm::mat4 translation = glm::translate(
        identity,
        {static_cast<float>(translateX), static_cast<float>(translateY), static_cast<float>(translateZ)});
    const glm::mat4 rotation = glm::rotate(identity, glm::radians(static_cast<float>(heading)), {0, 1, 0}) *
                               glm::rotate(identity, glm::radians(static_cast<float>(heel)), {1, 0, 0});
    glm::mat4 scale = glm::scale(
        identity, {static_cast<float>(scaleX), static_cast<float>(scaleY), mirror ? -scaleZ : +scaleZ});
    scale[1][0] = shear;
    const std::string& letters = order.options()[static_cast<std::size_t>(orderIndex)];
    glm::mat4 product(1);
    for (const char letter : letters)
        product *= letter == 'T' ? translation : letter == 'R' ? rotation : scale;
    return product;
}

glm::mat4 TransformsLab::clipFromEye(float aspect) const {
    if (!(nearPlane < farPlane))
        throw InputError(fmt::format("the far plane at {} is not beyond the near plane at {}",
                                     static_cast<float>(farPlane), static_cast<float>(nearPlane)),
                         "--far", "give a larger --far or a smaller --near");
    return perspective(glm::radians(static_cast<float>(fov)), aspect, nearPlane, farPlane);
}

glm::mat4 TransformsLab::inverted(const glm::mat4& pose, Inverse routine) {
    switch (routine) {
        case Inverse::rigid:
            return inverseRigid(pose);
        case Inverse::rigidNaive:
            return inverseRigidNaive(pose);
        case Inverse::affine:
            return inverseAffine(pose).value_or(glm::mat4(1));
        case Inverse::affineNaive:
            return inverseAffineNaive(pose);
        case Inverse::general:
            return quincunx::inverse(pose).value_or(glm::mat4(1));
        case Inverse::generalNaive:
            return inverseNaive(pose);
        case Inverse::inDouble:
            return glm::mat4(glm::inverse(glm::dmat4(pose)));
    }
    return glm::mat4(1);
}

SpaceChain TransformsLab::chain(const Frame& frame) const {
    SpaceChain result;
    result.worldFromModel = worldFromBoat();
    result.eyeFromWorld = inverted(frame.camera.worldFromCamera, inverse.as<Inverse>());
    result.clipFromEye = clipFromEye(static_cast<float>(frame.width) / static_cast<float>(frame.height));
    result.viewport = {.width = static_cast<double>(frame.width),
                       .height = static_cast<double>(frame.height)};
    return result;
}

void TransformsLab::markIdleKnobs() {
    const View shown = view.as<View>();
    for (FloatKnob* plane : {&nearPlane, &farPlane})
        plane->setIdle(shown == View::orders ? "the orders are shown with planes of their own" : "");
    order.setIdle(shown == View::orders ? "all orders are shown" : "");
    vertex.setIdle(shown == View::spaces ? "" : "no vertex is marked here");
    const char* why = shown == View::picture ? "" : "for --view=picture only";
    worldOffset.setIdle(why);
    precision.setIdle(why);
    rebaseEvery.setIdle(shown != View::picture                            ? why
                        : precision.as<Precision>() == Precision::rebased ? ""
                                                                          : "for --precision=rebased only");
}

graph::Resource TransformsLab::build(graph::FrameGraph& graph, const Frame& frame) {
    counters_.clear();
    const PictureTargets targets = addPictureTargets(
        graph,
        {.format = frame.pictureFormat, .width = frame.width, .height = frame.height, .factor = supersample});
    graph.addPass({.name = "transform",
                   .reads = {},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, frame, factor = targets.factor](graph::PassContext& context) {
                       glClearColor(1, 1, 1, 1);
                       glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
                       switch (view.as<View>()) {
                           case View::spaces:
                               drawSpaces(context, frame, factor);
                               break;
                           case View::orders:
                               drawOrders(context, frame, factor);
                               break;
                           case View::picture:
                               drawPicture(context, frame);
                               break;
                       }
                   }});
    addResolvePass(graph, targets);
    // For measurements: which pixel each vertex of the boat lights up, and with which depth.
    for (const bool chosenOnly : {true, false}) {
        const graph::Resource marks = graph.addResource({chosenOnly ? "marked pixel" : "vertex pixels",
                                                         graph::Format::rgba32f, frame.width, frame.height});
        graph.addPass({.name = chosenOnly ? "mark the vertex" : "mark all vertices",
                       .reads = {},
                       .writes = {marks},
                       .execute = [this, frame, chosenOnly](graph::PassContext& context) {
                           drawMarks(context, frame, chosenOnly);
                       }});
    }
    return targets.picture;
}

void TransformsLab::drawScene(graph::PassContext& context, const glm::mat4& worldFromBoat,
                              const glm::mat4& worldFromSea, const ForwardView& forward, bool withSea) {
    ForwardView next = forward;
    if (withSea) {
        sea_.scene().instances[0].worldFromModel = worldFromSea;
        sea_.draw(context, next);
        next.background = false;
        counters_["triangles"] += sea_.triangleCount();
    }
    for (std::size_t i = 0; i < boatFromPart_.size(); ++i)
        boat_.scene().instances[i].worldFromModel = worldFromBoat * boatFromPart_[i];
    boat_.draw(context, next);
    counters_["triangles"] += boat_.triangleCount();
}

glm::dvec3 TransformsLab::subtractedFor(glm::dvec3 eyeWorld) const {
    switch (precision.as<Precision>()) {
        case Precision::absolute:
            return glm::dvec3(0);
        case Precision::eyeRelative:
            return eyeWorld;
        case Precision::rebased: {
            const double step = static_cast<float>(rebaseEvery);
            return step * glm::floor(eyeWorld / step);
        }
    }
    return glm::dvec3(0);
}

TransformsLab::PlacedView TransformsLab::placedView(const Frame& frame) const {
    const double away = static_cast<float>(worldOffset);
    const glm::dvec3 offset(away, 0, away);
    glm::dmat4 worldFromEye(frame.camera.worldFromCamera);
    glm::dmat4 worldFromModel(worldFromBoat());
    glm::dmat4 worldFromSea(worldFromSea_);
    for (glm::dmat4* placed : {&worldFromEye, &worldFromModel, &worldFromSea})
        (*placed)[3] += glm::dvec4(offset, 0);
    // A world of the same axes with another origin.
    const glm::dvec4 origin(subtractedFor(glm::dvec3(worldFromEye[3])), 0);
    for (glm::dmat4* placed : {&worldFromEye, &worldFromModel, &worldFromSea})
        (*placed)[3] -= origin;
    const glm::mat4 pose(worldFromEye);
    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    return {glm::mat4(worldFromModel), glm::mat4(worldFromSea),
            clipFromEye(aspect) * inverted(pose, inverse.as<Inverse>()), glm::vec3(pose[3])};
}

void TransformsLab::drawPicture(graph::PassContext& context, const Frame& frame) {
    const PlacedView placed = placedView(frame);
    drawScene(context, placed.worldFromBoat, placed.worldFromSea,
              {.clipFromWorld = placed.clipFromWorld, .eyeWorld = placed.eyeWorld}, true);
}

void TransformsLab::drawMarks(graph::PassContext& context, const Frame& frame, bool chosenOnly) {
    if (!marks_) {
        std::vector<glm::vec3> positions;
        for (std::size_t i = 0; i < boatFromPart_.size(); ++i)
            for (const glm::vec3& position : boat().meshes[boat().instances[i].mesh].positions)
                positions.emplace_back(boatFromPart_[i] * glm::vec4(position, 1));
        marks_.emplace(MarkBuffers{
            gl::Buffer("vertices of the boat", GL_ARRAY_BUFFER, std::as_bytes(std::span(positions))),
            gl::VertexArray("vertices of the boat"), static_cast<GLsizei>(positions.size())});
        marks_->vertexArray.attribute(marks_->positions, {0, 3, GL_FLOAT, false, sizeof(glm::vec3), 0});
    }
    GLint first = 0;
    if (chosenOnly) {
        const BoatVertex chosen = chosenVertex();
        for (std::size_t i = 0; i < chosen.instance; ++i)
            first += static_cast<GLint>(boat().meshes[boat().instances[i].mesh].positions.size());
        first += static_cast<GLint>(chosen.vertex);
    }
    const SpaceChain spaces = chain(frame);
    const gl::Program& program = context.programs().get({.label = "marks",
                                                         .vertex = "labs/01_transforms/mark.vert",
                                                         .fragment = "labs/01_transforms/mark.frag"});
    program.use();
    program.set("worldFromModel", spaces.worldFromModel);
    program.set("eyeFromWorld", spaces.eyeFromWorld);
    program.set("clipFromEye", spaces.clipFromEye);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    marks_->vertexArray.bind();
    glDrawArrays(GL_POINTS, first, chosenOnly ? 1 : marks_->count);
}

Exercise TransformsLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"where the boat is", {{"translate-x", "0"}, {"translate-z", "0"}}},
                        {"the boat's heading", {{"heading", "0"}}},
                        {"the boat's size", {{"scale-x", "1"}, {"scale-y", "1"}}}};
    exercise.freeKnobs = {"supersample", "inverse", "precision"};
    exercise.shader = "passes/phong.vert";
    exercise.scenes = {{{"heading", "100"}}, {{"scale-z", "1.6"}, {"heel", "-20"}}};
    exercise.shaderKnobs = {{"view", "picture"}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::TransformsLab)

#include "labs/22_intersections/lab.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "gl/upload.h"
#include "math/transform.h"
#include "passes/fullscreen.h"
#include "scene/import.h"

namespace quincunx {

namespace {

const glm::vec3 lookedAt(0.25f, 0.75f, -0.25f);    // what the camera turns about, before the offset
const glm::vec3 probeOrigin(-3.75f, 2.25f, 2.5f);  // likewise
const glm::vec3 probeAim(-1.75f, 1.25f, 0.25f);    // where the ray goes for angles of 0

float textSize(const Frame& frame) {
    return std::clamp(static_cast<float>(frame.height) / 30, 8.0f, 24.0f);
}

std::string spelled(glm::vec3 v) {
    return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.x, v.y, v.z);
}

}  // namespace

glm::vec3 IntersectionsLab::place() const {
    return static_cast<float>(static_cast<int>(offset)) * glm::vec3(1, 0, -1);
}

std::vector<Exhibit> IntersectionsLab::exhibits() const {
    std::vector<Exhibit> all = makeExhibits(place());
    if (shape.index() == 0)
        return all;
    return {all[static_cast<std::size_t>(shape.index() - 1)]};
}

Lens IntersectionsLab::lens(const Frame& frame, double aspect) const {
    const float whole = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    const Camera camera =
        fittedToAspect(frame.camera, static_cast<float>(aspect), std::min(whole, composedAspect));
    return makeLens(camera, lookedAt, distance, place(), aspect);
}

Camera IntersectionsLab::defaultCamera() const {
    Camera camera;
    camera.worldFromCamera = lookAt({-0.75f, 2.6f, 10.0f}, lookedAt, {0, 1, 0});
    camera.fovYRadians = glm::radians(40.0f);
    camera.farDistance = 200;
    return camera;
}

Bounds IntersectionsLab::sceneBounds() const {
    return {{-4, 0, -2.5f}, {4.25f, 2, 2}};
}

Ray IntersectionsLab::probeRay() const {
    const glm::vec3 straight = probeAim - probeOrigin;
    const double turn = std::atan2(straight.x, straight.z) + glm::radians(static_cast<double>(probeTurn));
    const double flat = std::hypot(straight.x, straight.z);
    const double tilt =
        std::clamp(std::atan2(straight.y, flat) + glm::radians(static_cast<double>(probeTilt)),
                   -0.5 * glm::pi<double>(), 0.5 * glm::pi<double>());
    return {place() + probeOrigin,
            glm::vec3(std::cos(tilt) * std::sin(turn), std::sin(tilt), std::cos(tilt) * std::cos(turn))};
}

std::vector<IntersectionsLab::Panel> IntersectionsLab::panels(const Frame& frame) const {
    if (view.as<View>() != View::beside || frame.width < 2)
        return {{0, frame.width, view.as<View>() == View::map}};
    const int half = frame.width / 2;
    return {{0, half, false}, {half, frame.width - half, true}};
}

std::vector<double> IntersectionsLab::stateOf(const Frame& frame) const {
    std::vector<double> state{static_cast<double>(frame.width),
                              static_cast<double>(frame.height),
                              frame.camera.fovYRadians,
                              static_cast<double>(view.index()),
                              static_cast<double>(shape.index()),
                              static_cast<double>(method.index()),
                              static_cast<double>(triangleWay.index()),
                              distance,
                              static_cast<double>(offset),
                              static_cast<double>(supersample)};
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            state.push_back(frame.camera.worldFromCamera[column][row]);
    return state;
}

void IntersectionsLab::castPanels(const Frame& frame) {
    std::vector<double> state = stateOf(frame);
    if (state == castState_)
        return;
    castState_.clear();
    casts_.clear();
    counters_.clear();
    uploaded_ = false;
    const std::vector<Exhibit> shown = exhibits();
    for (const Panel& panel : panels(frame)) {
        const Lens seenBy = lens(frame, static_cast<double>(panel.width) / frame.height);
        const glm::dmat4 clip = clipFromWorld(seenBy);
        casts_.push_back(
            panel.map ? castMap(shown, seenBy, clip, panel.width, frame.height, approach())
                      : castScene(shown, seenBy, clip, panel.width, frame.height, approach(), supersample));
        for (const auto& [name, count] : casts_.back().counts)
            counters_[name] += count;
    }
    castState_ = std::move(state);
}

glm::dmat4 IntersectionsLab::clipFromWorld(const Lens& seenBy) const {
    return seenBy.clipFromLocal(place()) * glm::translate(glm::dmat4(1), -glm::dvec3(place()));
}

Lab::ReferenceJob IntersectionsLab::reference(const Frame& frame) const {
    // Only where nothing is drawn over what was cast.
    if (view.as<View>() != View::scene || probe)
        return {};
    const Lens seenBy = lens(frame, static_cast<double>(frame.width) / frame.height);
    return [exhibits = exhibits(), seenBy, clip = clipFromWorld(seenBy), frame,
            samples = static_cast<int>(supersample)](const std::atomic<bool>& stop) {
        Image exact =
            castScene(exhibits, seenBy, clip, frame.width, frame.height, {Method::stable}, samples, &stop)
                .color;
        for (std::size_t i = 0; i < exact.pixelCount(); ++i)
            exact.data[4 * i + 3] = 1;  // of the depth no more is needed
        return exact;
    };
}

void IntersectionsLab::markIdleKnobs() {
    triangleWay.setIdle(method.as<Method>() == Method::naive ? "" : "only the naive method has several");
    supersample.setIdle(view.as<View>() == View::map ? "the map has one ray a pixel" : "");
    const char* const withoutProbe = probe ? "" : "the shown ray is off";
    probeTurn.setIdle(withoutProbe);
    probeTilt.setIdle(withoutProbe);
}

graph::Resource IntersectionsLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    const graph::Resource depth =
        graph.addResource({"depth", graph::Format::depth32f, frame.width, frame.height});
    graph.addPass({.name = "show",
                   .reads = {},
                   .writes = {picture, depth},
                   .execute = [this, frame](graph::PassContext& context) { draw(context, frame); }});
    return picture;
}

void IntersectionsLab::draw(graph::PassContext& context, const Frame& frame) {
    castPanels(frame);
    constexpr int unit = 1;
    if (!texture_ || texture_->width() != frame.width || texture_->height() != frame.height) {
        texture_.emplace("cast", GL_RGBA32F, frame.width, frame.height);
        uploaded_ = false;
    }
    const std::vector<Panel> shown = panels(frame);
    for (std::size_t i = 0; i < shown.size() && !uploaded_; ++i)
        gl::upload(*texture_, shown[i].left, 0, casts_[i].color);
    uploaded_ = true;

    const gl::Program& program =
        context.programs().get(fullscreenProgram("show cast", "labs/22_intersections/show.frag"));
    program.use();
    program.set("rays", unit);
    texture_->bind(unit);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    context.drawFullscreen();
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);

    labels_.clear();
    for (const Panel& panel : shown) {
        const Lens seenBy = lens(frame, static_cast<double>(panel.width) / frame.height);
        lines_.clear();
        if (panel.map)
            addLegend(panel, frame);
        if (probe && !(panel.map && shown.size() > 1))
            addProbe(panel, frame);
        glViewport(panel.left, 0, panel.width, frame.height);
        lines_.draw(context, {.clipFromWorld = glm::mat4(seenBy.clipFromLocal(place())),
                              .viewportPixels = {panel.width, frame.height},
                              .depthBias = 1e-4f});
    }
    glViewport(0, 0, frame.width, frame.height);
    if (shown.size() > 1)
        labels_.plate({shown[1].left - 1, 0}, {2, frame.height}, {1, 1, 1, 1});
    labels_.draw(context, {frame.width, frame.height});
}

void IntersectionsLab::addProbe(const Panel& panel, const Frame& frame) {
    const std::vector<Exhibit> shown = exhibits();
    const Ray ray = probeRay();
    const glm::vec3 from = ray.origin - place();
    const Seen stable = look(shown, ray, {Method::stable});
    const float size = textSize(frame);
    const float width = std::max(2.0f, size / 6);
    const Lines::Style shaft{.color = {1.0f, 0.78f, 0.12f, 1}, .widthPixels = width};
    Lines::Style beyond = shaft;
    beyond.color.a = 0.5f;
    beyond.dashPixels = 2.5f * width;
    lines_.circle(from, ray.direction, 0.06f, shaft, 24);

    glm::vec3 mark = from + 3.0f * ray.direction;
    std::string words;
    if (stable.exhibit < 0) {
        lines_.segment(from, from + 14.0f * ray.direction, beyond);
        words = "no hit";
    } else {
        const glm::vec3 at = stable.hit.point - place();
        lines_.segment(from, at, shaft);
        lines_.segment(at, at + 1.5f * ray.direction, beyond);
        lines_.arrow(at, at + 0.75f * stable.hit.normal, 0.16f,
                     {.color = {0.25f, 0.9f, 1.0f, 1}, .widthPixels = width});
        lines_.circle(at, stable.hit.normal, 0.07f, {.color = {1, 1, 1, 1}, .widthPixels = width}, 24);
        mark = at;
        words = fmt::format("{}: t = {:.4f}\npoint {}\nnormal {}",
                            shown[static_cast<std::size_t>(stable.exhibit)].name, stable.hit.t,
                            spelled(stable.hit.point), spelled(stable.hit.normal));
    }
    const Judged judged = judge(shown, ray, approach());
    words += fmt::format("\n{} ", method.text());
    words += judged.verdict == Verdict::right       ? "agrees"
             : judged.verdict == Verdict::falseMiss ? "misses it"
             : judged.verdict == Verdict::falseHit  ? "hits what is not there"
                                                    : fmt::format("t: {:.1f} ulp off", judged.ulps);
    const glm::mat4 clipFromLocal(
        lens(frame, static_cast<double>(panel.width) / frame.height).clipFromLocal(place()));
    const glm::vec2 extent = labels_.extent(words, size);
    glm::vec2 where = pixelOf(mark, clipFromLocal, {panel.width, frame.height})
                          .value_or(0.5f * glm::vec2(panel.width, frame.height));
    where.x = std::clamp(where.x - 0.5f * extent.x, 0.5f * size,
                         std::max(0.5f * size, static_cast<float>(panel.width) - extent.x - 0.5f * size));
    where.y = std::clamp(where.y - extent.y - 2.5f * size, 0.5f * size,
                         static_cast<float>(frame.height) - extent.y - 0.5f * size);
    labels_.text(words, where + glm::vec2(panel.left, 0),
                 {.sizePixels = size, .color = {1, 1, 1, 1}, .backing = {0.01f, 0.015f, 0.03f, 0.72f}});
}

void IntersectionsLab::addLegend(const Panel& panel, const Frame& frame) {
    const float size = textSize(frame);
    const Cast& cast = casts_[panel.left > 0 ? 1 : 0];
    struct Row {
        const char* count;
        const char* words;
        Judged example;
    };
    const std::array rows{Row{"false hits", "hit where there is none", {Verdict::falseHit, 0}},
                          Row{"false misses", "no hit where there is one", {Verdict::falseMiss, 0}},
                          Row{"wrong t", "t off by 1 … 2¹⁶ ulp", {Verdict::wrongT, 65536}}};
    const double pixels = static_cast<double>(panel.width) * frame.height;
    const float left = static_cast<float>(panel.left) + 0.7f * size;
    float top = static_cast<float>(frame.height) - (static_cast<float>(rows.size()) * 1.25f + 0.7f) * size;
    for (const Row& row : rows) {
        const float box = 0.8f * size;
        if (row.example.verdict == Verdict::wrongT)
            for (int i = 0; i < 8; ++i)
                labels_.plate({left + static_cast<float>(i) * box * 2 / 8, top + 0.1f * size}, {box / 4, box},
                              glm::vec4(colorOf({Verdict::wrongT, std::exp2(2.0 * i)}), 1));
        else
            labels_.plate({left, top + 0.1f * size}, {box * 2, box}, glm::vec4(colorOf(row.example), 1));
        labels_.text(fmt::format("{}: {:.2f}%", row.words,
                                 100 * static_cast<double>(cast.counts.at(row.count)) / pixels),
                     {left + 2.2f * size, top}, {.sizePixels = size, .color = {0.92f, 0.93f, 0.95f, 1}});
        top += 1.25f * size;
    }
}

Exercise IntersectionsLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the probe", {{"probe", "off"}}}, {"the shapes", {{"shape", "sphere"}}}};
    exercise.freeKnobs = {"supersample"};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::IntersectionsLab)

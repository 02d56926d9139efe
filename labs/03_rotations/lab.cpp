#include "labs/03_rotations/lab.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "math/quaternion.h"
#include "math/transform.h"
#include "passes/targets.h"
#include "scene/import.h"

namespace quincunx {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;
constexpr glm::vec3 white(0.85f);
constexpr glm::vec3 faint(0.30f, 0.32f, 0.36f);
constexpr glm::vec3 lostColor(1.0f, 0.62f, 0.05f);
constexpr std::array<const char*, 3> angleNames = {"pitch", "head", "roll"};
constexpr std::array<const char*, 3> axisNames = {"x", "y", "z"};
constexpr std::array<const char*, 3> ringNames = {"outer", "middle", "inner"};

/// Letters must be lighter than the enamel to be read.
glm::vec3 lettering(int axis) {
    return axis == 0   ? glm::vec3(1.0f, 0.30f, 0.24f)
           : axis == 1 ? glm::vec3(0.25f, 0.85f, 0.32f)
                       : glm::vec3(0.32f, 0.52f, 1.0f);
}

glm::vec3 methodColor(Method method) {
    return method == Method::euler                                           ? glm::vec3(1.0f, 0.32f, 0.12f)
           : method == Method::matrix || method == Method::matrixGramSchmidt ? glm::vec3(0.95f, 0.72f, 0.10f)
           : method == Method::nlerp                                         ? glm::vec3(0.35f, 0.60f, 1.0f)
                                                                             : glm::vec3(0.28f, 0.92f, 0.45f);
}

std::string productText(EulerOrder order) {
    std::string text = "M =";
    for (const int axis : eulerAxes(order))
        text += fmt::format(" R{}({})", axisNames[static_cast<std::size_t>(axis)],
                            angleNames[static_cast<std::size_t>(axis)]);
    return text;
}

/// Pixels from the top left, y down, to clip space.
glm::mat4 clipFromPixels(glm::vec2 size) {
    glm::mat4 m(1);
    m[0][0] = 2 / size.x;
    m[1][1] = -2 / size.y;
    m[3] = glm::vec4(-1, 1, 0, 1);
    return m;
}

}  // namespace

RotationsLab::RotationsLab() : gimbal_(makeGimbalScene()), flight_(makeFlightScene(ghosts + 1)) {}

EulerAngles RotationsLab::angles() const {
    return {head * degree, pitch * degree, roll * degree};
}

EulerAngles RotationsLab::startAngles() const {
    return {fromHead * degree, fromPitch * degree, fromRoll * degree};
}

EulerAngles RotationsLab::lockedAngles() const {
    EulerAngles locked = angles();
    const int middle = eulerAxes(eulerOrder())[1];
    locked.about(middle) = std::copysign(90 * degree, locked.about(middle));
    return locked;
}

Camera RotationsLab::defaultCamera() const {
    Camera camera;
    camera.worldFromCamera = lookAt({4.3f, 2.6f, 6.2f}, {0, -0.16f, 0}, {0, 1, 0});
    camera.fovYRadians = 33 * degree;
    camera.nearDistance = 1;
    camera.farDistance = 40;
    return camera;
}

Bounds RotationsLab::sceneBounds() const {
    return {.min = glm::vec3(-1.9f, -2.2f, -1.9f), .max = glm::vec3(1.9f)};
}

void RotationsLab::markIdleKnobs() {
    const View shown = view.as<View>();
    const bool flies = shown == View::interpolation;
    const char* const fixedTurn = shown == View::drift ? "the drift is of a turn of its own" : "";
    for (Knob* knob : {static_cast<Knob*>(&head), static_cast<Knob*>(&pitch), static_cast<Knob*>(&roll)})
        knob->setIdle(fixedTurn);
    order.setIdle(fixedTurn);
    for (Knob* knob : {static_cast<Knob*>(&fromHead), static_cast<Knob*>(&fromPitch),
                       static_cast<Knob*>(&fromRoll), static_cast<Knob*>(&t), static_cast<Knob*>(&method)})
        knob->setIdle(flies ? "" : "for --view=interpolation only");
    renormalizeEvery.setIdle(shown == View::drift ? "" : "for --view=drift only");
    rings.setIdle(shown == View::gimbal ? ""
                  : shown == View::lock ? "the lock is shown by its rings"
                                        : "no gimbal is shown");
}

graph::Resource RotationsLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const PictureTargets targets =
        addPictureTargets(graph, {frame.pictureFormat, frame.width, frame.height, supersample});
    graph.addPass({.name = "rotations",
                   .reads = {},
                   .writes = {targets.color, targets.depth},
                   .execute = [this, frame, targets](graph::PassContext& context) {
                       drawFrame(context, frame, targets.factor);
                   }});
    addResolvePass(graph, targets);
    return targets.picture;
}

RotationsLab::Panel RotationsLab::panelOf(const Frame& frame, int factor, int column, int row, int columns,
                                          int rows) const {
    const int width = frame.width * factor;
    const int height = frame.height * factor;
    Panel panel;
    panel.left = width * column / columns;
    panel.width = std::max(width * (column + 1) / columns - panel.left, 1);
    panel.bottom = height * (rows - 1 - row) / rows;
    panel.height = std::max(height * (rows - row) / rows - panel.bottom, 1);
    panel.unit = static_cast<float>(height) / 480;
    const float aspect = static_cast<float>(panel.width) / static_cast<float>(panel.height);
    // The gimbal is as wide as it is high: it is composed for a square.
    panel.view = forwardView(fittedToAspect(frame.camera, aspect, 1.0f), aspect);
    return panel;
}

void RotationsLab::say(const std::string& words, glm::vec2 at, float size, Labels::Anchor anchor,
                       glm::vec3 color, const Panel& panel) {
    Labels::Style style;
    style.sizePixels = std::clamp(size * panel.unit, 4.0f, 512.0f);
    style.color = glm::vec4(color, 1);
    style.backing = {0.004f, 0.006f, 0.010f, 0.35f};
    style.anchor = anchor;
    labels_.text(words, at, style);
}

/// Draws the labels over all else, and makes room for the next panel's.
void RotationsLab::finish(graph::PassContext& context, const Panel& panel) {
    labels_.draw(context, panel.size());
    labels_.clear();
    lines_.clear();
}

void RotationsLab::drawFrame(graph::PassContext& context, const Frame& frame, int factor) {
    counters_.clear();
    glClear(GL_DEPTH_BUFFER_BIT);
    const auto use = [](const Panel& panel) {
        glViewport(panel.left, panel.bottom, panel.width, panel.height);
    };
    const View shown = view.as<View>();
    if (shown == View::gimbal) {
        const Panel panel = panelOf(frame, factor, 0, 0, 1, 1);
        drawGimbal(context, panel, angles(), false);
    } else if (shown == View::lock) {
        for (int column = 0; column < 2; ++column) {
            const Panel panel = panelOf(frame, factor, column, 0, 2, 1);
            use(panel);
            drawGimbal(context, panel, column == 0 ? angles() : lockedAngles(), true);
        }
    } else if (shown == View::drift) {
        for (int column = 0; column < 2; ++column) {
            const Panel panel = panelOf(frame, factor, column, 0, 2, 1);
            use(panel);
            drawDrift(context, panel, column == 0 ? 0 : renormalizeEvery);
        }
    } else {
        const std::array<Method, 4> methods = {Method::euler, Method::matrix, Method::nlerp,
                                               method.as<Method>()};
        // In one row where the picture is wide enough for four.
        const int columns = frame.width >= 2 * frame.height ? 4 : 2;
        for (int i = 0; i < 4; ++i) {
            const Panel panel = panelOf(frame, factor, i % columns, i / columns, columns, 4 / columns);
            use(panel);
            drawFlight(context, panel, methods[static_cast<std::size_t>(i)]);
        }
    }
    glViewport(0, 0, frame.width * factor, frame.height * factor);
}

void RotationsLab::drawGimbal(graph::PassContext& context, const Panel& panel, EulerAngles angles,
                              bool showAxes) {
    const EulerOrder sequence = eulerOrder();
    const std::array<int, 3> axes = eulerAxes(sequence);
    placeGimbal(gimbal_.scene(), angles, sequence, showAxes || rings);
    gimbal_.draw(context, panel.view);
    counters_["triangles"] += gimbal_.triangleCount();

    const glm::dmat3 directions = gimbalAxes(angles, sequence);
    const double volume = std::abs(glm::dot(directions[0], glm::cross(directions[1], directions[2])));
    const auto pixel = [&](glm::vec3 world) {
        return pixelOf(world, panel.view.clipFromWorld, panel.size());
    };
    if (showAxes) {
        const float unit = panel.unit;
        for (int ring = 0; ring < 3; ++ring) {
            const int axis = axes[static_cast<std::size_t>(ring)];
            const glm::vec3 direction(directions[ring]);
            const float length = 1.95f - 0.13f * static_cast<float>(ring);
            lines_.arrow(-length * direction, length * direction, 0.13f,
                         {glm::vec4(lettering(axis), 0.95f), (ring == 0 ? 8.0f : 3.0f) * unit});
        }
        // The direction that no combination of the rings turns about, where there is one.
        if (volume < 1e-3) {
            const glm::vec3 lost(glm::normalize(glm::cross(directions[0], directions[1])));
            lines_.segment(-1.95f * lost, 1.95f * lost, {glm::vec4(lostColor, 1), 3.2f * unit, 9 * unit});
            lines_.circle(1.55f * lost, lost, 0.20f, {glm::vec4(lostColor, 1), 2.2f * unit});
            if (const std::optional<glm::vec2> at = pixel(1.72f * lost); notes && at)
                say("no ring turns\nabout this", *at + glm::vec2(10, 0) * unit, 13, Labels::Anchor::topLeft,
                    lostColor, panel);
        }
        // Solid where seen, faint where the rings hide them.
        lines_.draw(context, {panel.view.clipFromWorld, panel.size(), true});
        lines_.clear();
        for (int ring = 0; ring < 3; ++ring) {
            const int axis = axes[static_cast<std::size_t>(ring)];
            const glm::vec3 direction(directions[ring]);
            lines_.segment(-1.6f * direction, 1.6f * direction,
                           {glm::vec4(lettering(axis), 0.5f), (ring == 0 ? 8.0f : 3.0f) * unit});
        }
        lines_.draw(context, {panel.view.clipFromWorld, panel.size(), false});
        lines_.clear();
    }
    if (notes) {
        const float line = 19 * panel.unit;
        const float margin = 10 * panel.unit;
        say(productText(sequence), {margin, margin}, 16, Labels::Anchor::topLeft, white, panel);
        for (int ring = 0; ring < 3; ++ring) {
            const int axis = axes[static_cast<std::size_t>(ring)];
            say(fmt::format("{} ring: {} {:+.0f}° about {}", ringNames[static_cast<std::size_t>(ring)],
                            angleNames[static_cast<std::size_t>(axis)], angles.about(axis) / degree,
                            axisNames[static_cast<std::size_t>(axis)]),
                {margin, margin + line * static_cast<float>(ring + 1) * 1.05f + 4 * panel.unit}, 14,
                Labels::Anchor::topLeft, lettering(axis), panel);
        }
        say(fmt::format("the three axes span {:.3f}", volume),
            {margin, static_cast<float>(panel.height) - margin}, 14, Labels::Anchor::bottomLeft,
            volume < 1e-3 ? lostColor : white, panel);
    }
    finish(context, panel);
}

void RotationsLab::drawFlight(graph::PassContext& context, const Panel& panel, Method way) {
    const Flight path = flight();
    std::array<glm::mat3, ghosts + 1> poses;
    for (std::size_t i = 0; i < ghosts; ++i)
        poses[i] = poseAt(path, way, static_cast<float>(i) / static_cast<float>(ghosts - 1));
    poses[ghosts] = poseAt(path, way, t);
    placeFlight(flight_.scene(), poses);
    flight_.draw(context, panel.view);
    counters_["triangles"] += flight_.triangleCount();

    const glm::vec3 color = methodColor(way);
    constexpr int steps = 96;
    std::array<glm::vec3, steps + 1> trail;
    for (int i = 0; i <= steps; ++i)
        trail[static_cast<std::size_t>(i)] = flightPosition(poseAt(path, way, static_cast<float>(i) / steps));
    for (const float height : {-0.5f, 0.0f, 0.5f})
        lines_.circle({0, globeRadius * height, 0}, {0, 1, 0}, globeRadius * std::sqrt(1 - height * height),
                      {glm::vec4(faint, 0.32f), panel.unit});
    for (int i = 0; i < 6; ++i) {
        const float angle = static_cast<float>(i) * 30 * degree;
        lines_.circle({0, 0, 0}, {std::cos(angle), 0, std::sin(angle)}, globeRadius,
                      {glm::vec4(faint, 0.32f), panel.unit});
    }
    lines_.polyline(trail, {glm::vec4(color, 0.95f), 2.2f * panel.unit});
    // Dots at equal times.
    for (int i = 0; i <= steps; i += 4)
        lines_.segment(trail[static_cast<std::size_t>(i)], trail[static_cast<std::size_t>(i)] * 1.0001f,
                       {glm::vec4(glm::mix(color, glm::vec3(1), 0.55f), 1), 5.5f * panel.unit});
    lines_.draw(context, {panel.view.clipFromWorld, panel.size(), true});
    lines_.clear();
    lines_.polyline(trail, {glm::vec4(color, 0.25f), 1.4f * panel.unit});
    lines_.draw(context, {panel.view.clipFromWorld, panel.size(), false});
    lines_.clear();
    if (notes) {
        drawSpeed(context, panel, way, color);
        const float margin = 8 * panel.unit;
        const std::string name = way == Method::euler ? fmt::format("Euler angles, {}", order.text())
                                 : way == Method::matrix
                                     ? std::string("matrix entries")
                                     : std::string(methodNames[static_cast<std::size_t>(way)]);
        say(name, {margin, margin}, 16, Labels::Anchor::topLeft, color, panel);
        say(fmt::format("{:.1f}° from slerp", angleToSlerp(path, way, t) / degree),
            {static_cast<float>(panel.width) - margin, margin}, 13, Labels::Anchor::topRight, white, panel);
    }
    finish(context, panel);
}

void RotationsLab::drawDrift(graph::PassContext& context, const Panel& panel, int every) {
    if (drifts_.size() > 8)
        drifts_.clear();
    const auto found = drifts_.find(every);
    const Drift& drift =
        found != drifts_.end()
            ? found->second
            : drifts_.emplace(every, measureDrift(smallTurn({1, 2, 3}), every)).first->second;
    // As a program would that takes |q| = 1 for granted.
    placeBody(gimbal_.scene(), 2.0f * matrixFromQuaternionNaive(drift.last));
    gimbal_.draw(context, panel.view);
    counters_["triangles"] += gimbal_.triangleCount();

    const glm::vec3 color = every == 0 ? lettering(0) : lettering(1);
    const glm::vec2 size = panel.size();
    const float margin = 12 * panel.unit;
    const float height = 0.24f * size.y;
    const float width = size.x - 2 * margin;
    const glm::vec2 origin(margin, size.y - margin - 18 * panel.unit);
    // From 1e-8 at the bottom to 1 at the top, a line for each factor of a hundred.
    constexpr double lowest = -8;
    const auto up = [&](double error) {
        return origin.y - height * static_cast<float>(std::clamp(
                                       (std::log10(std::max(error, 1e-12)) - lowest) / -lowest, 0.0, 1.0));
    };
    for (int power = -8; power <= 0; power += 2) {
        const float y = up(std::pow(10.0, power));
        lines_.segment({origin.x, y, 0}, {origin.x + width, y, 0}, {glm::vec4(faint, 0.7f), panel.unit});
        if (notes)
            say(fmt::format("1e{}", power), {origin.x, y}, 10, Labels::Anchor::bottomLeft, white, panel);
    }
    std::vector<glm::vec3> curve;
    for (std::size_t i = 0; i < drift.byDoubles.size(); ++i)
        curve.emplace_back(
            origin.x + width * static_cast<float>(i) / static_cast<float>(drift.byDoubles.size() - 1),
            up(drift.byDoubles[i]), 0);
    lines_.polyline(curve, {glm::vec4(color, 1), 2.5f * panel.unit});
    lines_.draw(context, {clipFromPixels(size), size, false});
    if (notes) {
        say(every == 0 ? "never made unit length" : fmt::format("made unit length every {} products", every),
            {margin, margin}, 16, Labels::Anchor::topLeft, color, panel);
        say(fmt::format("| |q| − 1 | up to {:.1e}", drift.largest), {margin, margin + 24 * panel.unit}, 14,
            Labels::Anchor::topLeft, white, panel);
        say("products: 1", {origin.x, size.y - margin}, 12, Labels::Anchor::bottomLeft, white, panel);
        say("a million", {origin.x + width, size.y - margin}, 12, Labels::Anchor::bottomRight, white, panel);
    }
    finish(context, panel);
}

void RotationsLab::drawSpeed(graph::PassContext& context, const Panel& panel, Method way, glm::vec3 color) {
    const Flight path = flight();
    const glm::vec2 size = panel.size();
    const float margin = 8 * panel.unit;
    const float height = 34 * panel.unit;
    const float width = std::min(size.x - 2 * margin, 150 * panel.unit);
    const glm::vec2 origin(margin, size.y - margin);
    constexpr double fastest = 2.5;  // times the even speed, at the top of the graph
    constexpr int steps = 64;
    std::array<glm::vec3, steps + 1> curve;
    double least = fastest * 100;
    double most = 0;
    for (int i = 0; i <= steps; ++i) {
        const double speed = relativeSpeed(path, way, static_cast<float>(i) / steps);
        least = std::min(least, speed);
        most = std::max(most, speed);
        const auto up = static_cast<float>(std::min(speed, fastest) / fastest);
        curve[static_cast<std::size_t>(i)] = {origin.x + width * static_cast<float>(i) / steps,
                                              origin.y - height * up, 0};
    }
    const float even = origin.y - height / static_cast<float>(fastest);
    const glm::vec4 pale(faint, 1);
    lines_.segment({origin.x, origin.y, 0}, {origin.x + width, origin.y, 0}, {pale, panel.unit});
    lines_.segment({origin.x, even, 0}, {origin.x + width, even, 0}, {pale, panel.unit, 4 * panel.unit});
    lines_.polyline(curve, {glm::vec4(color, 1), 2 * panel.unit});
    const float now = origin.x + width * t;
    lines_.segment({now, origin.y, 0}, {now, origin.y - height, 0}, {glm::vec4(white, 0.8f), panel.unit});
    lines_.draw(context, {clipFromPixels(size), size, false});
    lines_.clear();
    say(fmt::format("speed {:.2f} … {:.2f}", least, most), {origin.x + width + margin, origin.y}, 12,
        Labels::Anchor::bottomLeft, white, panel);
}

Exercise RotationsLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the gimbal's rings", {{"rings", "off"}}},
                        {"the aeroplane's pose", {{"head", "0"}, {"pitch", "0"}, {"roll", "0"}}},
                        {"the notes", {{"notes", "off"}}}};
    exercise.freeKnobs = {"supersample"};
    exercise.shader = "passes/phong.vert";
    exercise.scenes = {{{"head", "60"}, {"pitch", "-20"}}, {{"view", "interpolation"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::RotationsLab)

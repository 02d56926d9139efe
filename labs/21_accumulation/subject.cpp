#include "labs/21_accumulation/subject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "labs/21_accumulation/toy_table.h"
#include "math/transform.h"
#include "scene/animation.h"

namespace quincunx {
namespace {

constexpr float distance = 4;        // from the eye to the sheet
constexpr float viewTangent = 0.1f;  // half of the view's height over its distance
constexpr double unitsASecond = 3;
constexpr double turnsASecond = 0.25;
constexpr double middleSeconds = 2;
constexpr double edgeDegrees = 17;  // of the still edge, from upright
constexpr double edgeOffset = 0.013;
constexpr float lampHeight = 8;
constexpr float sheetHeight = 4;
constexpr float eyeHeight = 3;
constexpr float floorTangent = 0.35f;

Mesh sheet(const char* name, float right, float half) {
    return {.name = name,
            .positions = {{-half, -half, 0}, {right, -half, 0}, {right, half, 0}, {-half, half, 0}},
            .normals = std::vector<glm::vec3>(4, glm::vec3(0, 0, 1)),
            .texcoords = {},
            .indices = {0, 1, 2, 0, 2, 3}};
}

glm::mat4 turned(double radians, glm::vec3 origin) {
    const auto c = static_cast<float>(std::cos(radians));
    const auto s = static_cast<float>(std::sin(radians));
    return {glm::vec4(c, s, 0, 0), glm::vec4(-s, c, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(origin, 1)};
}

double radiansOf(double degrees) {
    return degrees * std::numbers::pi / 180;
}

void addMotion(Scene& scene, Subject subject) {
    const bool turns = subject == Subject::turningEdge;
    scene.nodes.push_back({.name = "sheet", .translation = {0, 0, -distance}});
    scene.attachments.push_back({Attachment::Thing::instance, 0, 0, glm::mat4(1)});
    Animation animation{.name = "motion"};
    Animation::Sampler keys;
    constexpr int quarters = 4;
    for (int i = 0; i <= quarters; ++i) {
        const auto seconds = static_cast<float>(roundSeconds * i / quarters);
        keys.seconds.push_back(seconds);
        const double half = std::numbers::pi * turnsASecond * (static_cast<double>(seconds) - middleSeconds);
        if (turns)
            keys.values.emplace_back(0, 0, static_cast<float>(std::sin(half)),
                                     static_cast<float>(std::cos(half)));
        else
            keys.values.emplace_back(
                static_cast<float>(unitsASecond * (static_cast<double>(seconds) - middleSeconds)), 0,
                -distance, 0);
    }
    animation.samplers.push_back(std::move(keys));
    animation.channels.push_back({0, 0, turns ? Animation::Path::rotation : Animation::Path::translation});
    scene.animations.push_back(std::move(animation));
    pose(scene, middleSeconds);
}

Scene makePenumbra() {
    Scene scene;
    scene.name = "penumbra";
    Material matt;
    matt.ambient = glm::vec3(0);
    matt.specular = glm::vec3(0);
    matt.doubleSided = true;
    scene.materials = {matt};
    scene.meshes = {sheet("floor", 12, 12), sheet("sheet", 0, 12)};
    const glm::mat4 lying(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, -1, 0), glm::vec4(0, 1, 0, 0),
                          glm::vec4(0, 0, 0, 1));
    glm::mat4 raised = lying;
    raised[3].y = sheetHeight;
    scene.instances = {{"floor", 0, 0, lying}, {"sheet", 1, 0, raised}};
    Light lamp;
    lamp.kind = Light::Kind::spot;
    lamp.name = "lamp";
    lamp.position = {0, lampHeight, 0};
    lamp.direction = {0, -1, 0};
    lamp.intensity = lampHeight * lampHeight;
    lamp.innerConeRadians = 0.55f;
    lamp.outerConeRadians = 0.6f;
    scene.lights = {lamp};
    scene.ambientLight = glm::vec3(0);
    Camera camera;
    camera.worldFromCamera = lying;
    camera.worldFromCamera[3].y = eyeHeight;
    camera.fovYRadians = 2 * std::atan(floorTangent);
    camera.nearDistance = 0.5f;
    camera.farDistance = 10;
    scene.cameras = {camera};
    return scene;
}

/// The share of the shutter's time, from −½ to ½ of `turn`, in which an edge that turns with it covers a
/// point at `angle`: the sheet lies where cos(angle − turned) ≤ 0, half of all directions.
double shareOfTurn(double angle, double turn) {
    // Covered while angle − turned lies in [π/2, 3π/2] + 2πk.
    constexpr double pi = std::numbers::pi;
    const double low = angle - turn / 2;
    const double high = angle + turn / 2;
    if (!(turn > 0))
        return std::cos(angle) <= 0 ? 1 : 0;
    double covered = 0;
    for (int k = -2; k <= 2; ++k)
        covered +=
            std::max(0.0, std::min(high, 1.5 * pi + 2 * pi * k) - std::max(low, 0.5 * pi + 2 * pi * k));
    return covered / turn;
}

}  // namespace

Scene makeSubject(Subject subject) {
    if (subject == Subject::penumbra)
        return makePenumbra();
    Scene scene;
    scene.name = "edge";
    Material glow;
    glow.ambient = glow.diffuse = glow.specular = glm::vec3(0);
    glow.emission = glm::vec3(1);
    scene.materials = {glow};
    scene.meshes = {sheet("sheet", 0, 20)};
    glm::mat4 place = turned(0, {0, 0, -distance});
    if (subject == Subject::edge) {
        const double angle = radiansOf(edgeDegrees);
        place = turned(angle, {static_cast<float>(edgeOffset), 0, -distance});
    }
    scene.instances = {{"sheet", 0, 0, place}};
    scene.ambientLight = glm::vec3(0);
    Camera camera;
    camera.fovYRadians = 2 * std::atan(viewTangent);
    camera.nearDistance = 0.5f;
    camera.farDistance = 30;
    scene.cameras = {camera};
    if (subject == Subject::movingEdge || subject == Subject::turningEdge)
        addMotion(scene, subject);
    return scene;
}

AccumulatedEffects effectsOf(Subject subject) {
    switch (subject) {
        case Subject::toys:
            return {true, true, true, true};
        case Subject::edge:
            return {.antialiasing = true};
        case Subject::movingEdge:
        case Subject::turningEdge:
            return {.motionBlur = true};
        case Subject::defocusedEdge:
            return {.depthOfField = true};
        case Subject::penumbra:
            return {.softShadows = true};
    }
    return {};
}

double shareOfDisc(double cut) {
    const double u = std::clamp(cut, -1.0, 1.0);
    return (std::acos(u) - u * std::sqrt((1 - u) * (1 + u))) / std::numbers::pi;
}

double shareOfSquare(double cut) {
    return (1 - std::clamp(cut, -1.0, 1.0)) / 2;
}

double coverage(glm::dvec2 n, double d) {
    // By symmetry n ≥ 0: x → 1 − x turns the sign of n.x and takes it off d.
    for (int axis = 0; axis < 2; ++axis)
        if (n[axis] < 0) {
            d -= n[axis];
            n[axis] = -n[axis];
        }
    const double a = std::min(n.x, n.y);
    const double b = std::max(n.x, n.y);
    if (d <= 0 || b == 0)
        return d < 0 ? 0 : b == 0 ? 1 : 0;
    if (d >= a + b)
        return 1;
    if (d <= a)
        return d * d / (2 * a * b);
    if (d <= b)
        return (d - a / 2) / b;
    return 1 - (a + b - d) * (a + b - d) / (2 * a * b);
}

Image exactEdge(const EdgeSettings& settings, int width, int height) {
    Image exact(width, height, 1, Encoding::linear);
    const double tangent = std::tan(static_cast<double>(settings.camera.fovYRadians) / 2);
    const double pixel = 2 * tangent / height;  // at distance 1
    const double lensShare =
        1 - static_cast<double>(distance) / static_cast<double>(settings.camera.focusDistance);
    const double blur = static_cast<double>(settings.camera.apertureRadius) * lensShare;
    const double since = std::remainder(settings.seconds - middleSeconds, roundSeconds);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // The pixel's centre, at distance 1 along the view, and in the plane of the sheet.
            const glm::dvec2 view((x + 0.5 - 0.5 * width) * pixel, (0.5 * height - y - 0.5) * pixel);
            const glm::dvec2 place = view * static_cast<double>(distance);
            double share = 0;
            switch (settings.subject) {
                case Subject::toys:
                    break;
                case Subject::edge: {
                    const double angle = radiansOf(edgeDegrees);
                    const glm::dvec2 n(std::cos(angle), std::sin(angle));
                    const double side = pixel * static_cast<double>(distance);
                    const glm::dvec2 corner = place - 0.5 * side - glm::dvec2(edgeOffset, 0);
                    share = coverage(n, -glm::dot(n, corner) / side);
                    break;
                }
                case Subject::movingEdge: {
                    const double way = unitsASecond * settings.shutterSeconds;
                    const double ahead = unitsASecond * since - place.x;  // of the edge, halfway through
                    share = way > 0 ? std::clamp(0.5 + ahead / way, 0.0, 1.0) : ahead >= 0;
                    break;
                }
                case Subject::turningEdge: {
                    const double turn = 2 * std::numbers::pi * turnsASecond;
                    share = shareOfTurn(std::atan2(place.y, place.x) - turn * since,
                                        turn * settings.shutterSeconds);
                    break;
                }
                case Subject::defocusedEdge:
                    share = blur == 0 ? place.x <= 0 : shareOfDisc(place.x / std::abs(blur));
                    break;
                case Subject::penumbra: {
                    // The way to a point of the lamp passes the sheet's edge where lamp.x (h/H) + x (1 − h/H)
                    // = 0.
                    const double rise = static_cast<double>(sheetHeight) / static_cast<double>(lampHeight);
                    const double cut = -view.x * static_cast<double>(eyeHeight) * (1 - rise) / rise;
                    const auto radius = static_cast<double>(settings.lamp.radius);
                    share = radius == 0                                     ? cut <= 0
                            : settings.lamp.shape == AreaLight::Shape::disc ? shareOfDisc(cut / radius)
                                                                            : shareOfSquare(cut / radius);
                    break;
                }
            }
            exact.pixel(x, y)[0] = static_cast<float>(share);
        }
    return exact;
}

}  // namespace quincunx

#include "labs/03_rotations/gimbal.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "base/check.h"
#include "geometry/shapes.h"

namespace quincunx {
namespace {

constexpr float quarter = std::numbers::pi_v<float> / 2;

struct Part {
    const char* name;
    Material material;
    glm::mat4 bodyFromPart;  ///< of a ball of radius 1
};

Material material(const char* name, glm::vec3 diffuse, glm::vec3 specular, float shininess,
                  glm::vec3 emission = glm::vec3(0)) {
    Material result;
    result.name = name;
    result.baseColor = glm::vec4(diffuse, 1);
    result.ambient = result.diffuse = diffuse;
    result.specular = specular;
    result.shininess = shininess;
    result.emission = emission;
    return result;
}

glm::mat4 ellipsoid(glm::vec3 centre, glm::vec3 halfAxes) {
    return glm::scale(glm::translate(glm::mat4(1), centre), halfAxes);
}

const std::vector<Part>& aeroplane() {
    static const std::vector<Part> parts = [] {
        const Material shell = material("shell", {0.62f, 0.60f, 0.56f}, {0.45f, 0.45f, 0.45f}, 40);
        const Material trim = material("trim", {0.62f, 0.09f, 0.02f}, {0.5f, 0.45f, 0.4f}, 60);
        const Material glass = material("glass", {0.012f, 0.03f, 0.06f}, {0.8f, 0.85f, 0.9f}, 220);
        const glm::vec3 dim(0.02f);
        return std::vector<Part>{
            {"fuselage", shell, ellipsoid({0, 0, 0}, {0.155f, 0.16f, 0.74f})},
            {"canopy", glass, ellipsoid({0, 0.125f, 0.17f}, {0.09f, 0.10f, 0.23f})},
            {"wing", shell, ellipsoid({0, -0.02f, 0.06f}, {0.80f, 0.028f, 0.20f})},
            {"tailplane", trim, ellipsoid({0, 0.03f, -0.61f}, {0.34f, 0.02f, 0.11f})},
            {"fin", trim, ellipsoid({0, 0.20f, -0.61f}, {0.02f, 0.22f, 0.13f})},
            {"spinner", trim, ellipsoid({0, 0, 0.68f}, {0.078f, 0.078f, 0.13f})},
            {"port light", material("red light", dim, dim, 10, {1.0f, 0.02f, 0.02f}),
             ellipsoid(portLightBody, glm::vec3(0.058f))},
            {"starboard light", material("green light", dim, dim, 10, {0.02f, 0.9f, 0.12f}),
             ellipsoid(starboardLightBody, glm::vec3(0.058f))},
        };
    }();
    return parts;
}

std::size_t addMesh(Scene& scene, const Shape& shape, int segments, const char* name) {
    scene.meshes.push_back(tessellate(shape, segments, name));
    return scene.meshes.size() - 1;
}

void addInstance(Scene& scene, std::string name, std::size_t mesh, const Material& material) {
    scene.instances.push_back({std::move(name), mesh, scene.materials.size(), glm::mat4(1)});
    scene.materials.push_back(material);
}

void addAeroplane(Scene& scene, std::size_t ball, float brightness) {
    for (const Part& part : aeroplane()) {
        Material worn = part.material;
        // The paler ones keep a share of their colour, on slate.
        const glm::vec3 slate(0.10f, 0.12f, 0.16f);
        worn.ambient = worn.diffuse = glm::mix(slate, worn.diffuse, brightness);
        worn.specular *= brightness;
        worn.emission *= brightness;
        addInstance(scene, part.name, ball, worn);
    }
}

void placeAeroplane(Scene& scene, std::size_t first, const glm::mat4& worldFromBody) {
    for (std::size_t i = 0; i < aeroplane().size(); ++i)
        scene.instances[first + i].worldFromModel = worldFromBody * aeroplane()[i].bodyFromPart;
}

void addStudio(Scene& scene) {
    Light key;
    key.kind = Light::Kind::directional;
    key.name = "warm key";
    key.direction = glm::normalize(glm::vec3(0.55f, -0.75f, -0.62f));
    key.color = {1.0f, 0.90f, 0.76f};
    key.intensity = 1.15f;
    Light fill = key;
    fill.name = "fill";
    fill.direction = glm::normalize(glm::vec3(-0.8f, -0.1f, -0.5f));
    fill.color = {0.62f, 0.74f, 1.0f};
    fill.intensity = 0.42f;
    Light rim = key;
    rim.name = "cool rim";
    rim.direction = glm::normalize(glm::vec3(-0.35f, -0.45f, 0.85f));
    rim.color = {0.5f, 0.68f, 1.0f};
    rim.intensity = 0.8f;
    scene.lights = {key, fill, rim};
    scene.ambientLight = {0.10f, 0.11f, 0.135f};
    scene.backgroundTop = {0.009f, 0.013f, 0.026f};
    scene.backgroundBottom = {0.060f, 0.056f, 0.058f};
}

glm::vec3 unit(int axis) {
    glm::vec3 v(0);
    v[axis] = 1;
    return v;
}

/// Shapes stand along y; this lays them along an axis.
glm::mat4 alongAxis(int axis) {
    return axis == 0   ? glm::rotate(glm::mat4(1), -quarter, glm::vec3(0, 0, 1))
           : axis == 2 ? glm::rotate(glm::mat4(1), quarter, glm::vec3(1, 0, 0))
                       : glm::mat4(1);
}

/// A pin of unit radius and half length 1, scaled to lie from `inner` to `outer` along an axis.
glm::mat4 pin(int axis, float inner, float outer, float radius) {
    const float half = (outer - inner) / 2;
    return glm::translate(glm::mat4(1), unit(axis) * ((inner + outer) / 2)) * alongAxis(axis) *
           glm::scale(glm::mat4(1), {radius, half, radius});
}

constexpr std::array<float, 4> radii = {1.50f, 1.26f, 1.02f, 1.78f};  // outer, middle, inner, cradle
constexpr float bandHalfWidth = 0.075f;
constexpr float bandHalfThickness = 0.036f;
constexpr std::size_t ringCount = 3;
/// The solid middle of the globe: small enough that mixed matrices do not sink out of sight.
constexpr float coreRadius = 0.5f;

/// Instances of the gimbal, in order: three rings, the pins of each (two), their caps (two), the cradle's
/// parts.
enum Instance : std::size_t {
    firstRing = 0,
    firstPin = 3,
    firstCap = 9,
    rod = 15,
    cradle,
    stem,
    foot,
    footBand,
    firstPlanePart
};

}  // namespace

glm::vec3 axisColor(int axis) {
    return axis == 0   ? glm::vec3(0.72f, 0.045f, 0.03f)
           : axis == 1 ? glm::vec3(0.05f, 0.46f, 0.09f)
                       : glm::vec3(0.06f, 0.17f, 0.85f);
}

float ringRadius(int ring) {
    return radii[static_cast<std::size_t>(ring)];
}

Scene makeGimbalScene() {
    Scene scene;
    scene.name = "gimbal";
    const Material steel = material("steel", {0.055f, 0.058f, 0.065f}, {0.5f, 0.52f, 0.56f}, 50);
    const Material lacquer = material("black lacquer", {0.022f, 0.019f, 0.021f}, {0.10f, 0.09f, 0.085f}, 12);
    const Material brass = material("brass", {0.22f, 0.12f, 0.03f}, {0.95f, 0.68f, 0.30f}, 40);
    const std::size_t ball = addMesh(scene, Sphere{1}, 48, "ball");
    const std::size_t bar = addMesh(scene, Capsule{1, 0.0001}, 32, "bar");
    // Thin tubes need many steps around to be round across.
    std::array<std::size_t, 4> tori{};
    for (std::size_t i = 0; i < tori.size(); ++i)
        tori[i] = addMesh(scene, Torus{radii[i], bandHalfThickness}, 420, "ring");
    for (std::size_t ring = 0; ring < ringCount; ++ring)
        addInstance(scene, "ring", tori[ring], steel);
    for (std::size_t i = 0; i < 2 * ringCount; ++i)
        addInstance(scene, "pin", bar, steel);
    for (std::size_t i = 0; i < 2 * ringCount; ++i)
        addInstance(scene, "cap", ball, brass);
    addInstance(scene, "rod", bar, steel);
    addInstance(scene, "cradle", tori[3], steel);
    addInstance(scene, "stem", bar, steel);
    addInstance(scene, "foot", addMesh(scene, Drum{0.95, 0.07, 0.05}, 96, "foot"), lacquer);
    addInstance(scene, "foot band", addMesh(scene, Torus{0.94, 0.022}, 320, "band"), brass);
    QX_CHECK_EQ(scene.instances.size(), static_cast<std::size_t>(firstPlanePart));
    addAeroplane(scene, ball, 1);
    addStudio(scene);
    return scene;
}

void placeGimbal(Scene& scene, EulerAngles angles, EulerOrder order, bool rings) {
    const std::array<int, 3> axes = eulerAxes(order);
    const auto turn = [&](int ring) {
        EulerAngles only;
        only.about(axes[static_cast<std::size_t>(ring)]) = angles.about(axes[static_cast<std::size_t>(ring)]);
        return glm::mat4(matrixFromEuler(only, order).value_or(glm::mat3(1)));
    };
    const glm::mat4 nothing(0);  // shrunk to a point: not seen
    const glm::mat4 shown = rings ? glm::mat4(1) : nothing;
    const glm::mat4 band = glm::scale(glm::mat4(1), {1, bandHalfWidth / bandHalfThickness, 1});
    glm::mat4 carried(1);  // the frame that the ring turns in
    for (int ring = 0; ring < 3; ++ring) {
        const auto index = static_cast<std::size_t>(ring);
        const int axis = axes[index];
        const int next = ring < 2 ? axes[index + 1] : axes[0];
        const float outside = ring == 0 ? radii[3] : radii[index - 1];
        for (std::size_t side = 0; side < 2; ++side) {
            const float sign = side == 0 ? 1.0f : -1.0f;
            scene.instances[firstPin + 2 * index + side].worldFromModel =
                shown * carried * pin(axis, sign * radii[index], sign * outside, 0.026f);
            scene.instances[firstCap + 2 * index + side].worldFromModel =
                shown * carried *
                ellipsoid(unit(axis) * (sign * (outside + 0.03f)), glm::vec3(ring == 0 ? 0.075f : 0.058f));
        }
        carried = carried * turn(ring);
        // The ring lies in the plane of its own axis and the next one's.
        const int normal = 3 - axis - next;
        scene.instances[firstRing + index].worldFromModel = shown * carried * alongAxis(normal) * band;
        Material& enamel = scene.materials[scene.instances[firstRing + index].material];
        enamel.ambient = enamel.diffuse = axisColor(axis) * 0.8f;
        enamel.specular = glm::vec3(0.55f);
        enamel.shininess = 70;
    }
    scene.instances[rod].worldFromModel = shown * carried * pin(axes[2], -radii[2], radii[2], 0.017f);
    // The cradle stands upright and holds the outer axis.
    const int cradleNormal = axes[0] == 2 ? 0 : 2;
    scene.instances[cradle].worldFromModel = shown * alongAxis(cradleNormal) * band;
    scene.instances[stem].worldFromModel = shown * pin(1, -2.06f, -radii[3], 0.07f);
    scene.instances[foot].worldFromModel = shown * glm::translate(glm::mat4(1), {0, -2.10f, 0});
    scene.instances[footBand].worldFromModel = shown * glm::translate(glm::mat4(1), {0, -2.10f, 0});
    placeAeroplane(scene, firstPlanePart, carried);
}

void placeBody(Scene& scene, const glm::mat3& worldFromBody) {
    placeGimbal(scene, {}, EulerOrder::zxy, false);
    placeAeroplane(scene, firstPlanePart, glm::mat4(worldFromBody));
}

Scene makeFlightScene(std::size_t count) {
    Scene scene;
    scene.name = "flight";
    const std::size_t globe = addMesh(scene, Sphere{coreRadius}, 96, "globe");
    const std::size_t ball = addMesh(scene, Sphere{1}, 32, "ball");
    addInstance(scene, "globe", globe, material("sea", {0.018f, 0.045f, 0.085f}, {0.12f, 0.14f, 0.16f}, 24));
    for (std::size_t i = 0; i < count; ++i)
        addAeroplane(scene, ball, i + 1 == count ? 1.0f : 0.55f);
    addStudio(scene);
    return scene;
}

glm::vec3 flightPosition(const glm::mat3& worldFromBody) {
    return worldFromBody * glm::vec3(0, 1.15f * globeRadius, 0);
}

void placeFlight(Scene& scene, std::span<const glm::mat3> worldFromBody) {
    const std::size_t parts = aeroplane().size();
    QX_CHECK_EQ(scene.instances.size(), 1 + parts * worldFromBody.size());
    for (std::size_t i = 0; i < worldFromBody.size(); ++i) {
        const float size = i + 1 == worldFromBody.size() ? 0.62f : 0.30f;
        const glm::mat4 pose = glm::translate(glm::mat4(1), flightPosition(worldFromBody[i])) *
                               glm::mat4(size * worldFromBody[i]);
        placeAeroplane(scene, 1 + parts * i, pose);
    }
}

}  // namespace quincunx

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "geometry/mesh_builder.h"
#include "geometry/shapes.h"
#include "scene/car.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float degree = pi / 180;

constexpr std::size_t wheelCount = 4;
constexpr std::size_t partsPerWheel = 2;

/// A curve through points (x ascending), by cubics with Catmull and Rom's tangents.
float curveThrough(std::span<const glm::vec2> points, float x) {
    std::size_t i = 1;
    while (i + 2 < points.size() && x > points[i].x)
        ++i;
    i = std::max<std::size_t>(i, 1);
    const glm::vec2 a = points[i - 1];
    const glm::vec2 b = points[i];
    const glm::vec2 before = points[i >= 2 ? i - 2 : 0];
    const glm::vec2 after = points[std::min(i + 1, points.size() - 1)];
    const float width = b.x - a.x;
    const float t = std::clamp((x - a.x) / width, 0.0f, 1.0f);
    const float slopeA = (b.y - before.y) / (b.x - before.x) * width;
    const float slopeB = (after.y - a.y) / (after.x - a.x) * width;
    const float t2 = t * t;
    const float t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * a.y + (t3 - 2 * t2 + t) * slopeA + (3 * t2 - 2 * t3) * b.y +
           (t3 - t2) * slopeB;
}

constexpr float rear = -0.82f;
constexpr float front = 3.08f;

float halfWidth(float z) {
    static constexpr std::array<glm::vec2, 9> points = {{{rear, 0.60f},
                                                         {-0.7f, 0.70f},
                                                         {-0.45f, 0.78f},
                                                         {0, 0.82f},
                                                         {1.2f, 0.84f},
                                                         {2.2f, 0.82f},
                                                         {2.7f, 0.77f},
                                                         {2.95f, 0.68f},
                                                         {front, 0.56f}}};
    return curveThrough(points, z);
}

float topOf(float z) {
    static constexpr std::array<glm::vec2, 9> points = {{{rear, 0.70f},
                                                         {-0.65f, 0.82f},
                                                         {-0.3f, 0.90f},
                                                         {0.4f, 0.93f},
                                                         {1.3f, 0.94f},
                                                         {1.8f, 0.91f},
                                                         {2.4f, 0.85f},
                                                         {2.85f, 0.76f},
                                                         {front, 0.64f}}};
    return curveThrough(points, z);
}

float bottomOf(float z) {
    static constexpr std::array<glm::vec2, 6> points = {
        {{rear, 0.36f}, {-0.6f, 0.27f}, {0, 0.23f}, {2.3f, 0.23f}, {2.85f, 0.27f}, {front, 0.36f}}};
    return curveThrough(points, z);
}

std::vector<glm::vec3> bodyRing(float z, float scale) {
    constexpr int sides = 28;
    const float middle = 0.5f * (topOf(z) + bottomOf(z));
    const float half = 0.5f * (topOf(z) - bottomOf(z));
    std::vector<glm::vec3> ring;
    for (int k = 0; k < sides; ++k) {
        const glm::vec2 p =
            superellipse(2 * pi * static_cast<float>(k) / sides, scale * halfWidth(z), scale * half, 3.4f);
        ring.emplace_back(p.x, middle + p.y, z);
    }
    return ring;
}

Mesh body() {
    std::vector<std::vector<glm::vec3>> rings;
    const auto rounded = [&](float end, float outwards) {
        // A quarter of an ellipse closes the end.
        std::vector<std::vector<glm::vec3>> cap;
        for (const float angle : {18.0f, 36.0f, 54.0f, 70.0f}) {
            std::vector<glm::vec3> ring = bodyRing(end, std::cos(angle * degree));
            for (glm::vec3& p : ring)
                p.z += outwards * 0.16f * std::sin(angle * degree);
            cap.push_back(std::move(ring));
        }
        return cap;
    };
    const auto back = rounded(rear, -1);
    rings.insert(rings.end(), back.rbegin(), back.rend());
    constexpr int stations = 16;
    for (int i = 0; i <= stations; ++i)
        rings.push_back(bodyRing(rear + (front - rear) * static_cast<float>(i) / stations, 1));
    const auto nose = rounded(front, 1);
    rings.insert(rings.end(), nose.begin(), nose.end());
    const Mesh closed = loft(rings, true, true, "car body");
    // Open where the driver sits.
    std::vector<bool> keep(closed.triangleCount(), true);
    for (std::size_t i = 0; i < keep.size(); ++i) {
        const auto corner = [&](std::size_t k) { return closed.positions[closed.indices[3 * i + k]]; };
        const glm::vec3 middle = (corner(0) + corner(1) + corner(2)) / 3.0f;
        const float across = std::pow(std::abs(middle.x) / 0.735f, 3.2f);
        const float along = std::pow(std::abs(middle.z - 0.6f) / 1.15f, 3.2f);
        keep[i] = !(middle.y > 0.8f && across + along < 1 && middle.z < 1.62f);
    }
    return subset(closed, keep, "car body");
}

/// The upper part: glass between pillars, and a roof.
struct Cabin {
    Mesh shell;
    Mesh glass;
};

Cabin cabin() {
    struct Row {
        float height;
        float halfWidth;
        float front;
        float back;
    };
    static constexpr std::array<Row, 12> rows = {{{0.84f, 0.745f, 1.86f, -0.66f},
                                                  {0.955f, 0.735f, 1.72f, -0.55f},
                                                  {1.06f, 0.712f, 1.585f, -0.465f},
                                                  {1.17f, 0.68f, 1.435f, -0.37f},
                                                  {1.28f, 0.64f, 1.27f, -0.265f},
                                                  {1.37f, 0.60f, 1.12f, -0.165f},
                                                  {1.42f, 0.565f, 1.01f, -0.09f},
                                                  {1.455f, 0.52f, 0.90f, -0.01f},
                                                  {1.482f, 0.44f, 0.75f, 0.10f},
                                                  {1.50f, 0.33f, 0.62f, 0.20f},
                                                  {1.51f, 0.2f, 0.53f, 0.30f},
                                                  {1.515f, 0.08f, 0.46f, 0.37f}}};
    constexpr std::size_t firstGlass = 1;
    constexpr std::size_t lastGlass = 4;
    constexpr std::size_t sides = 40;
    std::vector<std::vector<glm::vec3>> rings;
    for (const Row& row : rows) {
        std::vector<glm::vec3> ring;
        const float middle = 0.5f * (row.front + row.back);
        for (std::size_t k = 0; k < sides; ++k) {
            const glm::vec2 p = superellipse(2 * pi * static_cast<float>(k) / static_cast<float>(sides),
                                             0.5f * (row.front - row.back), row.halfWidth, 3.2f);
            ring.emplace_back(p.y, row.height, middle + p.x);
        }
        rings.push_back(std::move(ring));
    }
    const Mesh whole = loft(rings, false, true, "cabin");
    std::vector<bool> isGlass(whole.triangleCount(), false);
    for (std::size_t triangle = 0; triangle < isGlass.size(); ++triangle) {
        const std::size_t row = triangle / (2 * sides);
        const std::size_t k = triangle / 2 % sides;
        // Degrees from the front, to either side.
        const float around = 360.0f * (static_cast<float>(k) + 0.5f) / static_cast<float>(sides);
        const float angle = around > 180 ? 360 - around : around;
        const bool pillar =
            (angle > 35 && angle < 45) || (angle > 85 && angle < 95) || (angle > 130 && angle < 145);
        isGlass[triangle] = row >= firstGlass && row <= lastGlass && !pillar;
    }
    Cabin result;
    result.glass = subset(whole, isGlass, "car glass");
    isGlass.flip();
    result.shell = subset(whole, isGlass, "car roof");
    return result;
}

glm::mat4 at(glm::vec3 place) {
    return glm::translate(glm::mat4(1), place);
}

glm::mat4 turnedBy(float degrees, glm::vec3 axis) {
    return glm::rotate(glm::mat4(1), degrees * degree, axis);
}

/// An arc in an upright plane across x, from and to angles above the +z direction.
std::vector<glm::vec3> arch(glm::vec3 centre, float radius, float fromDegrees, float toDegrees, int steps) {
    std::vector<glm::vec3> points;
    for (int i = 0; i <= steps; ++i) {
        const float angle =
            (fromDegrees + (toDegrees - fromDegrees) * static_cast<float>(i) / static_cast<float>(steps)) *
            degree;
        points.push_back(centre + radius * glm::vec3(0, std::sin(angle), std::cos(angle)));
    }
    return points;
}

/// The dark opening that a wheel stands in, flat on the flank, with its rim.
void wheelHouse(MeshBuilder& builder, glm::vec3 centre, float side) {
    std::vector<glm::vec3> outline = arch({side * 0.82f, centre.y, centre.z}, 0.42f, -12, 192, 14);
    if (side > 0)
        std::reverse(outline.begin(), outline.end());
    builder.polygon(outline);
    const glm::vec3 inwards(-side * 0.26f, 0, 0);
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::vec3 a = outline[i];
        const glm::vec3 b = outline[(i + 1) % outline.size()];
        builder.quad(a, a + inwards, b + inwards, b);
    }
}

struct BodyParts {
    MeshBuilder paint;
    MeshBuilder dark;
    MeshBuilder chrome;
    MeshBuilder lamps;
    MeshBuilder tailLamps;
    MeshBuilder plates;
    MeshBuilder lining;
};

void addOutside(BodyParts& parts, const CarBuild& build) {
    parts.paint.append(body());
    const auto axle = static_cast<float>(build.wheelbase);
    const auto radius = static_cast<float>(build.wheelRadius);
    for (const float side : {-1.0f, 1.0f}) {
        for (const float z : {0.0f, axle}) {
            // The wheel's house is dark; a lip of paint runs round it.
            const glm::vec3 centre(side * 0.80f, radius + 0.02f, z);
            parts.paint.tube(arch(centre, 0.425f, -12, 192, 14), 0.052f, 6);
            wheelHouse(parts.dark, centre, side);
        }
        const auto bead = tessellate(Sphere{0.145}, 12);
        parts.lamps.append(
            bead, at({side * 0.50f, 0.60f, 3.10f}) * glm::scale(glm::mat4(1), glm::vec3(1, 1, 0.72f)));
        parts.chrome.append(tessellate(Torus{0.145, 0.026}, 14),
                            at({side * 0.50f, 0.60f, 3.105f}) * turnedBy(90, {1, 0, 0}));
        parts.tailLamps.append(tessellate(Sphere{0.085}, 10),
                               at({side * 0.53f, 0.60f, rear - 0.075f}) *
                                   glm::scale(glm::mat4(1), glm::vec3(1.1f, 1.25f, 0.6f)));
        parts.chrome.append(tessellate(Capsule{0.02, 0.07}, 5),
                            at({side * 0.845f, 0.80f, 0.36f}) * turnedBy(90, {1, 0, 0}));
        // The mirror on its arm.
        parts.chrome.tube(
            std::array{glm::vec3(side * 0.74f, 0.93f, 1.42f), glm::vec3(side * 0.90f, 1.01f, 1.44f)}, 0.015f,
            6);
        parts.paint.append(
            tessellate(Sphere{0.085}, 10),
            at({side * 0.94f, 1.03f, 1.45f}) * glm::scale(glm::mat4(1), glm::vec3(1, 0.8f, 0.62f)));
        // A strip along the flank.
        std::vector<glm::vec3> strip;
        for (int i = 0; i <= 8; ++i) {
            const float z = 0.5f + 0.16f * static_cast<float>(i);
            strip.emplace_back(side * (halfWidth(z) + 0.004f), 0.585f, z);
        }
        parts.chrome.tube(strip, 0.014f, 4);
    }
    const auto bumper = [&](float z, float outwards) {
        std::vector<glm::vec3> bar;
        for (int i = -6; i <= 6; ++i) {
            const float x = 0.135f * static_cast<float>(i);
            bar.emplace_back(x, 0.35f, z + outwards * (0.26f - 0.42f * x * x));
        }
        parts.chrome.tube(bar, 0.048f, 7);
    };
    bumper(front, 1);
    bumper(rear, -1);
    for (int slat = 0; slat < 3; ++slat) {
        const float y = 0.455f + 0.05f * static_cast<float>(slat);
        parts.dark.tube(std::array{glm::vec3(-0.24f, y, front + 0.125f), glm::vec3(0.24f, y, front + 0.125f)},
                        0.016f, 6);
    }
    parts.plates.box({-0.24f, 0.30f, front + 0.28f}, {0.24f, 0.42f, front + 0.315f});
    parts.plates.box({-0.24f, 0.48f, rear - 0.175f}, {0.24f, 0.60f, rear - 0.15f});
    parts.dark.tube(std::array{glm::vec3(0.42f, 0.24f, rear + 0.1f), glm::vec3(0.42f, 0.24f, rear - 0.2f)},
                    0.03f, 8);
}

/// What the driver sees of the car: outer skins face outwards and are not seen from here.
void addInside(BodyParts& parts) {
    parts.lining.box({-0.70f, 0.30f, -0.45f}, {0.70f, 0.90f, 1.52f}, {.inward = true});
    // The dashboard, its hood over the instruments, and the pillars of the windscreen.
    parts.dark.tube(std::array{glm::vec3(-0.68f, 0.86f, 1.50f), glm::vec3(0.68f, 0.86f, 1.50f)}, 0.10f, 12);
    parts.dark.append(tessellate(Capsule{0.07, 0.14}, 12),
                      at({0.34f, 0.94f, 1.40f}) * turnedBy(90, {0, 0, 1}));
    for (const float side : {-1.0f, 1.0f})
        parts.lining.tube(
            std::array{glm::vec3(side * 0.655f, 0.90f, 1.55f), glm::vec3(side * 0.60f, 1.13f, 1.30f),
                       glm::vec3(side * 0.515f, 1.37f, 0.97f)},
            0.028f, 8);
    for (const float side : {-1.0f, 1.0f})
        parts.lining.tube(
            std::array{glm::vec3(side * 0.70f, 0.915f, -0.2f), glm::vec3(side * 0.69f, 0.92f, 0.8f),
                       glm::vec3(side * 0.655f, 0.925f, 1.25f), glm::vec3(side * 0.58f, 0.93f, 1.58f)},
            0.05f, 6);
    parts.lining.tube(std::array{glm::vec3(-0.52f, 1.375f, 0.96f), glm::vec3(-0.26f, 1.40f, 1.0f),
                                 glm::vec3(0.26f, 1.40f, 1.0f), glm::vec3(0.52f, 1.375f, 0.96f)},
                      0.032f, 8);
    parts.dark.append(tessellate(Capsule{0.022, 0.06}, 12),
                      at({-0.05f, 1.35f, 1.06f}) * turnedBy(90, {0, 0, 1}));
    // The wheel, tilted towards the driver, with two spokes.
    const glm::mat4 wheel = at({0.34f, 0.95f, 1.20f}) * turnedBy(-62, {1, 0, 0});
    parts.dark.append(tessellate(Torus{0.185, 0.014}, 24), wheel);
    MeshBuilder spokes;
    spokes.tube(std::array{glm::vec3(-0.18f, 0, 0), glm::vec3(0.18f, 0, 0)}, 0.013f, 6);
    spokes.tube(std::array{glm::vec3(0, 0, 0), glm::vec3(0, 0, 0.18f)}, 0.013f, 6);
    spokes.append(tessellate(Drum{0.045, 0.02, 0.01}, 12));
    parts.chrome.append(spokes.take("spokes"), wheel);
    parts.dark.tube(std::array{glm::vec3(0.34f, 0.94f, 1.21f), glm::vec3(0.34f, 0.86f, 1.45f)}, 0.03f, 8);
}

Material paintOf(std::string name, glm::vec3 color) {
    return makeMaterial(
        std::move(name),
        {.diffuse = color, .specular = glm::vec3(0.35f), .shininess = 90, .roughness = 0.15f});
}

struct Wheel {
    Mesh tyre;
    Mesh rim;
};

Wheel wheel(const CarBuild& build) {
    const glm::mat4 lying = turnedBy(90, {0, 0, 1});
    MeshBuilder tyre;
    tyre.append(tessellate(Drum{build.wheelRadius, 0.105, 0.045}, 18), lying);
    MeshBuilder rim;
    rim.append(tessellate(Drum{0.215, 0.112, 0.02}, 12), lying);
    for (const float side : {-1.0f, 1.0f}) {
        rim.append(tessellate(Sphere{0.06}, 6), at({side * 0.105f, 0, 0}));
        for (int hole = 0; hole < 5; ++hole) {
            const float angle = 72 * degree * static_cast<float>(hole);
            MeshBuilder disc;
            disc.disc({0, 0, 0}, 0.036f, 8);
            tyre.append(disc.take({}), at({side * 0.116f, 0.14f * std::sin(angle), 0.14f * std::cos(angle)}) *
                                           turnedBy(-90 * side, {0, 0, 1}));
        }
    }
    return {tyre.take("car tyre"), rim.take("car rim")};
}

}  // namespace

CarInstances addCar(Scene& scene, glm::vec3 paint, glm::vec3 roof) {
    const CarBuild build;
    CarInstances car;
    car.first = scene.instances.size();
    const auto addMaterial = [&](Material made) {
        scene.materials.push_back(std::move(made));
        return scene.materials.size() - 1;
    };
    const auto addMesh = [&](Mesh mesh) {
        scene.meshes.push_back(std::move(mesh));
        return scene.meshes.size() - 1;
    };
    const auto place = [&](std::string name, std::size_t mesh, std::size_t materialIndex) {
        scene.instances.push_back({std::move(name), mesh, materialIndex, glm::mat4(1)});
    };
    const auto add = [&](Mesh mesh, std::size_t materialIndex) {
        const std::string name = mesh.name;
        place(name, addMesh(std::move(mesh)), materialIndex);
    };

    car.paint = addMaterial(paintOf("car paint", paint));
    const std::size_t roofPaint = addMaterial(paintOf("car roof", roof));
    const std::size_t glass = addMaterial(makeMaterial("car glass", {.diffuse = {0.05f, 0.085f, 0.11f},
                                                                     .specular = glm::vec3(0.75f),
                                                                     .shininess = 180,
                                                                     .roughness = 0.05f}));
    const std::size_t dark = addMaterial(makeMaterial(
        "car rubber", {.diffuse = glm::vec3(0.018f), .specular = glm::vec3(0.06f), .shininess = 14}));
    const std::size_t chrome = addMaterial(makeMaterial("chrome", {.diffuse = {0.30f, 0.32f, 0.35f},
                                                                   .specular = glm::vec3(0.9f),
                                                                   .shininess = 70,
                                                                   .metallic = 1,
                                                                   .roughness = 0.15f}));
    const std::size_t lamp = addMaterial(makeMaterial("headlamp", {.diffuse = {0.75f, 0.72f, 0.6f},
                                                                   .specular = glm::vec3(0.6f),
                                                                   .shininess = 100,
                                                                   .roughness = 0.1f,
                                                                   .emission = {0.22f, 0.2f, 0.13f}}));
    const std::size_t tailLamp =
        addMaterial(makeMaterial("tail lamp", {.diffuse = {0.55f, 0.01f, 0.01f},
                                               .specular = glm::vec3(0.5f),
                                               .shininess = 90,
                                               .roughness = 0.15f,
                                               .emission = {0.16f, 0.004f, 0.004f}}));
    const std::size_t plate = addMaterial(makeMaterial("number plate", {.diffuse = {0.8f, 0.8f, 0.76f}}));
    const std::size_t lining = addMaterial(makeMaterial("lining", {.diffuse = {0.12f, 0.085f, 0.06f}}));
    const std::size_t rimPaint = addMaterial(paintOf("rim", {0.72f, 0.68f, 0.58f}));

    BodyParts parts;
    addOutside(parts, build);
    addInside(parts);
    Cabin top = cabin();
    add(parts.paint.take("car body"), car.paint);
    add(std::move(top.shell), roofPaint);
    add(std::move(top.glass), glass);
    add(parts.dark.take("car dark parts"), dark);
    add(parts.chrome.take("car chrome"), chrome);
    add(parts.lamps.take("car headlamps"), lamp);
    add(parts.tailLamps.take("car tail lamps"), tailLamp);
    add(parts.plates.take("car plates"), plate);
    add(parts.lining.take("car lining"), lining);

    Wheel one = wheel(build);
    const std::size_t tyre = addMesh(std::move(one.tyre));
    const std::size_t rim = addMesh(std::move(one.rim));
    for (std::size_t i = 0; i < wheelCount; ++i) {
        place("car tyre", tyre, dark);
        place("car rim", rim, rimPaint);
    }
    car.count = scene.instances.size() - car.first;
    placeCar(scene, car, glm::mat4(1), 0, 0, build);
    return car;
}

void placeCar(Scene& scene, const CarInstances& car, const glm::mat4& worldFromCar, double steeringRadians,
              double distanceTravelled, const CarBuild& build) {
    const std::size_t wheels = car.first + car.count - wheelCount * partsPerWheel;
    for (std::size_t i = car.first; i < wheels; ++i)
        scene.instances[i].worldFromModel = worldFromCar;
    const double roll = std::fmod(distanceTravelled / build.wheelRadius, 2 * std::numbers::pi);
    const glm::dmat3 rolled = turnMatrix(glm::dvec3(1, 0, 0), roll);
    for (std::size_t i = 0; i < wheelCount; ++i) {
        const bool steered = i < 2;
        const glm::dmat3 turn = steered ? turnMatrix(glm::dvec3(0, 1, 0), steeringRadians) : glm::dmat3(1);
        const RigidPose carFromWheel{turn * rolled, glm::dvec3(i % 2 == 0 ? 0.77 : -0.77, build.wheelRadius,
                                                               steered ? build.wheelbase : 0)};
        for (std::size_t part = 0; part < partsPerWheel; ++part)
            scene.instances[wheels + partsPerWheel * i + part].worldFromModel =
                worldFromCar * carFromWheel.matrix();
    }
}

CarInstances addCarLike(Scene& scene, const CarInstances& model, glm::vec3 paint) {
    CarInstances car{scene.instances.size(), model.count, scene.materials.size()};
    scene.materials.push_back(paintOf("car paint", paint));
    for (std::size_t i = 0; i < model.count; ++i) {
        Instance part = scene.instances[model.first + i];
        if (part.material == model.paint)
            part.material = car.paint;
        scene.instances.push_back(std::move(part));
    }
    return car;
}

}  // namespace quincunx

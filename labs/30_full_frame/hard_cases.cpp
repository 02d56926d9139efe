#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "labs/30_full_frame/lab.h"
#include "math/projection.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "passes/frame_visibility.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr float aspect = 1.6f;

/// Where a point is in the camera's frame, from the numbers as stored.
QuadVector inCamera(const Camera& camera, const glm::mat4& worldFromModel, const glm::vec3& model) {
    const glm::mat4& world = camera.worldFromCamera;
    std::array<Quad, 3> relative{};
    for (int row = 0; row < 3; ++row) {
        relative[static_cast<std::size_t>(row)] = Quad(worldFromModel[3][row]) - Quad(world[3][row]);
        for (int column = 0; column < 3; ++column)
            relative[static_cast<std::size_t>(row)] +=
                Quad(worldFromModel[column][row]) * Quad(model[column]);
    }
    const auto along = [&](int axis) {
        return Quad(world[axis][0]) * relative[0] + Quad(world[axis][1]) * relative[1] +
               Quad(world[axis][2]) * relative[2];
    };
    return {along(0), along(1), along(2)};
}

bool isInView(const Camera& camera, const QuadVector& p) {
    const Quad tangentY = tangent(Quad(camera.fovYRadians) / 2);
    const Quad depth = -p.z;
    const auto within = [&](Quad value, Quad limit) { return value <= limit && -value <= limit; };
    return depth >= Quad(camera.nearDistance) && depth <= Quad(camera.farDistance) &&
           within(p.y, tangentY * depth) && within(p.x, tangentY * Quad(aspect) * depth);
}

/// Gribb and Hartmann's planes and the box's reach, all in float and in the world.
bool mayBeVisibleNaive(const glm::mat4& clipFromWorld, const glm::vec3& centre, const glm::vec3& half) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f}) {
            float value = clipFromWorld[3][3] + sign * clipFromWorld[3][axis];
            for (int column = 0; column < 3; ++column) {
                const float n = clipFromWorld[column][3] + sign * clipFromWorld[column][axis];
                value += n * centre[column] + std::abs(n) * half[column];
            }
            if (value < 0)
                return false;
        }
    return true;
}

Camera cameraAt(StressInputs& draw, double away) {
    Camera camera;
    const glm::vec3 eye(away * draw.direction());
    camera.worldFromCamera = lookAt(glm::vec3(0), glm::vec3(draw.direction()), {0, 1, 0});
    camera.worldFromCamera[3] = glm::vec4(eye, 1);
    camera.fovYRadians = static_cast<float>(draw.random().uniform(0.3, 1.5));
    return camera;
}

glm::mat4 clipFromWorldNaive(const Camera& camera) {
    return perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance) *
           cameraFromWorld(camera.worldFromCamera);
}

/// Small boxes at the view's edges, of which a corner is in view. Failures: those that are left out.
HardCaseFigures runCulling(std::uint64_t inputs, std::uint64_t seed, double least, double most, float near,
                           float far) {
    StressInputs draw(seed);
    Tally tally;
    Scene scene;
    Mesh box;
    box.positions = {{-1, -1, -1}, {1, 1, 1}, {1, -1, 1}};
    box.indices = {0, 1, 2};
    scene.meshes = {box};
    scene.materials.emplace_back();
    scene.instances.push_back({"box", 0, 0, glm::mat4(1)});
    const SceneBounds bounds(scene);
    const auto logarithmic = [&](double low, double high) {
        return low * std::pow(high / low, draw.random().uniformDouble());
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        Camera camera = cameraAt(draw, logarithmic(least, most));
        camera.nearDistance = near;
        camera.farDistance = far;
        const double depth =
            logarithmic(2.0 * static_cast<double>(near), std::min(1e3, static_cast<double>(far)));
        const double size = depth * logarithmic(1e-4, 1e-2);
        // A corner a little inside one of the side planes, the box mostly outside.
        const double across = std::tan(0.5 * static_cast<double>(camera.fovYRadians)) * depth;
        const bool level = draw.random().below(2) == 0;
        const double sign = draw.random().below(2) == 0 ? 1 : -1;
        const double edge = sign * (across * (level ? static_cast<double>(aspect) : 1.0) + 0.9 * size);
        const double other = draw.random().uniform(-0.9, 0.9) * across;
        const glm::dmat4 world(camera.worldFromCamera);
        const glm::dvec3 centre(world * glm::dvec4(level ? edge : other, level ? other : edge, -depth, 1));
        glm::mat4 placement(static_cast<float>(size));
        placement[3] = glm::vec4(glm::vec3(centre), 1);
        scene.instances[0].worldFromModel = placement;
        bool seen = false;
        for (const glm::vec3& corner : box.positions)
            seen = seen || isInView(camera, inCamera(camera, placement, corner));
        const FrameView view{.scene = scene, .camera = camera, .width = 320, .height = 200};
        const bool naive = mayBeVisibleNaive(clipFromWorldNaive(camera), glm::vec3(placement[3]),
                                             glm::vec3(placement[0][0]));
        const bool stable = bounds.look(view).visible() == 1;
        tally.add(seen && !naive ? infinity : 0, seen && !stable ? infinity : 0, [&] {
            return fmt::format("eye={} box={} size={:a}", hexVector(camera.worldFromCamera[3]),
                               hexVector(placement[3]), placement[0][0]);
        });
    }
    return tally.figures();
}

HardCaseFigures runCullingFarAway(std::uint64_t inputs, std::uint64_t seed) {
    return runCulling(inputs, seed, 1e5, 1e6, 0.1f, 1e4f);
}

HardCaseFigures runCullingDeepViews(std::uint64_t inputs, std::uint64_t seed) {
    return runCulling(inputs, seed, 1, 1e3, 1e-3f, 1e4f);
}

/// Where a vertex of an object 1.6 … 100 units before the eye falls, the eye 10³ … 10⁶ units from the
/// origin, in pixels of a picture of 1728 by 1080.
HardCaseFigures runFarFromOrigin(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const glm::dvec2 half(864, 540);
    while (tally.figures().inputs < inputs) {
        Camera camera = cameraAt(draw, std::pow(10.0, draw.random().uniform(3, 6)));
        const double depth = std::pow(10.0, draw.random().uniform(0.2, 2));
        const glm::dvec3 direction(draw.random().uniform(-0.3, 0.3), draw.random().uniform(-0.3, 0.3), -1);
        glm::mat4 placement(1);
        placement[3] =
            glm::vec4(glm::vec3(glm::dmat4(camera.worldFromCamera) * glm::dvec4(depth * direction, 1)), 1);
        const glm::vec3 vertex(0.25 * draw.direction());
        const QuadVector exact = inCamera(camera, placement, vertex);
        const Quad tangentY = tangent(Quad(camera.fovYRadians) / 2);
        if (-exact.z < Quad(1))
            continue;
        const glm::dvec2 place(static_cast<double>(exact.x / (-exact.z * tangentY * Quad(aspect))),
                               static_cast<double>(exact.y / (-exact.z * tangentY)));
        const auto error = [&](const glm::mat4& clipFromWorld, const glm::mat4& worldFromModel) {
            const glm::vec4 clip = clipFromWorld * (worldFromModel * glm::vec4(vertex, 1));
            const glm::dvec2 found(static_cast<double>(clip.x) / static_cast<double>(clip.w),
                                   static_cast<double>(clip.y) / static_cast<double>(clip.w));
            return glm::length((found - place) * half);
        };
        const glm::vec3 anchor = anchorOf(camera);
        const glm::mat4 clipFromAnchored(
            glm::dmat4(perspective(camera.fovYRadians, aspect, camera.nearDistance, camera.farDistance)) *
            glm::dmat4(cameraFromWorld(relativeTo(anchor, camera.worldFromCamera))));
        tally.add(error(clipFromWorldNaive(camera), placement),
                  error(clipFromAnchored, relativeTo(anchor, placement)), [&] {
                      return fmt::format("eye={} object={} vertex={}", hexVector(camera.worldFromCamera[3]),
                                         hexVector(placement[3]), hexVector(vertex));
                  });
    }
    return tally.figures();
}

/// Panes in a grid around the eye, many of them equally far, some of no place at all. Failures: panes that
/// are not drawn, or drawn over a nearer one.
HardCaseFigures runBlendedOrder(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    constexpr std::size_t panes = 120;
    for (std::uint64_t done = 0; done < inputs; done += panes) {
        std::vector<double> distances;
        for (std::size_t i = 0; i < panes; ++i) {
            const auto x = static_cast<double>(draw.random().below(11)) - 5;
            const auto z = static_cast<double>(draw.random().below(11)) - 5;
            distances.push_back(draw.random().below(50) == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                             : x * x + z * z);
        }
        // The textbook's map from distance to pane.
        std::map<float, std::size_t> sorted;
        for (std::size_t i = 0; i < panes; ++i)
            sorted[static_cast<float>(distances[i])] = i;
        std::vector<bool> drawnNaive(panes);
        for (const auto& [distance, i] : sorted)
            drawnNaive[i] = true;
        std::vector<bool> drawn(panes);
        double last = infinity;
        for (const std::uint32_t i : farthestFirst(distances)) {
            drawn[i] = !drawn[i] && (std::isnan(distances[i]) || distances[i] <= last);
            last = std::isnan(distances[i]) ? -infinity : distances[i];
        }
        for (std::size_t i = 0; i < panes && done + i < inputs; ++i)
            tally.add(drawnNaive[i] ? 0 : infinity, drawn[i] ? 0 : infinity,
                      [&] { return fmt::format("pane {} at {:a}", i, distances[i]); });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> FullFrameLab::hardCases() {
    return {
        {"what is in view", "the camera 1e5 … 1e6 from the origin", "", 0,
         "planes relative to the eye, slack for the device's rounding (SceneBounds::look)",
         runCullingFarAway},
        {"what is in view", "near 1e-3, far 1e4, the camera up to 1e3 away", "", 0,
         "planes relative to the eye, slack for the device's rounding (SceneBounds::look)",
         runCullingDeepViews},
        // Anchored coordinates are at most 32 (half a cell of 64, the least power of two above 512 near
        // distances of 0.1) on each axis, plus the object's distance d, and are summed with errors of 2^-22
        // of that in each of two products, and as much again for the matrix that was rounded: 4 · 2^-22 (32
        // √3 / d
        // + 1) of d, which is √2 · 540 / tan(0.15) pixels. At d = 1 that is 0.28 pixels.
        {"a vertex on the screen", "the camera 1e3 … 1e6 from the origin", " px", 0.28,
         "placements relative to an anchor near the eye (anchorOf)", runFarFromOrigin},
        {"order of what blends", "equal distances, and none at all", "", 0,
         "stable sort, NaN last (farthestFirst)", runBlendedOrder},
    };
}

}  // namespace quincunx

#include "trace/path_hard_cases.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "math/vector.h"
#include "trace/light_set.h"
#include "trace/trace_scene.h"

namespace quincunx {
namespace {

glm::vec3 randomDirection(Random& random) {
    for (;;) {
        const glm::vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (glm::dot(v, v) > 0.01f && glm::dot(v, v) <= 1)
            return *normalize(v);
    }
}

/// The textbook's ray: the origin is moved by a constant.
Ray leaveNaive(const SurfacePoint& point, glm::vec3 direction) {
    const float side = glm::dot(point.geometricNormal, direction) < 0 ? -1.0f : 1.0f;
    return {point.position + side * 1e-4f * point.geometricNormal, direction};
}

/// A slab of a room: a floor and, `gap` above it, a ceiling.
TraceScene makeGap(glm::vec3 offset, float scale, float gap) {
    Scene scene;
    scene.materials = {Material{}};
    Mesh floor;
    floor.positions = {{-1, 0.1f, -1.1f}, {-1.05f, -0.1f, 1}, {1, 0.07f, 1.02f}};
    floor.indices = {0, 1, 2};
    Mesh ceiling = floor;
    for (glm::vec3& position : ceiling.positions)
        position.y += gap;
    scene.meshes = {floor, ceiling};
    glm::mat4 m(scale);
    m[3] = glm::vec4(offset, 1);
    scene.instances = {{"floor", 0, 0, m}, {"ceiling", 1, 0, m}};
    return TraceScene(scene, {}, Structure::bruteForce);
}

/// A ray from the floor up must meet the ceiling, and not the floor: what else it does is a failure.
HardCaseFigures leaveFloor(std::uint64_t inputs, std::uint64_t seed, glm::vec3 offset, float scale,
                           float gap) {
    const TraceScene scene = makeGap(offset, scale, gap);
    Random random(seed);
    Tally tally;
    while (tally.figures().inputs < inputs) {
        const glm::vec3 above =
            offset + scale * glm::vec3(random.uniform(-0.4, 0), 0.5f * gap, random.uniform(0.2, 0.5));
        const auto point = scene.nearest({above, {0.01f, -1, 0.02f}});
        if (!point || point->instance != 0)
            continue;
        const glm::vec3 up = normalizeOr(point->geometricNormal + 0.15f * randomDirection(random), {0, 1, 0});
        const auto failure = [&](const Ray& ray) {
            const auto met = scene.nearest(ray);
            return met && met->instance == 1 ? 0 : std::numeric_limits<double>::infinity();
        };
        tally.add(failure(leaveNaive(*point, up)), failure(TraceScene::leave(*point, up)),
                  [&] { return hexVector(point->position) + " along " + hexVector(up); });
    }
    return tally.figures();
}

HardCaseFigures leaveFar(std::uint64_t inputs, std::uint64_t seed) {
    return leaveFloor(inputs, seed, {1.1e6f, -1.3e6f, 0.7e6f}, 1000, 0.5f);
}
HardCaseFigures leaveSmall(std::uint64_t inputs, std::uint64_t seed) {
    return leaveFloor(inputs, seed, {0, 0, 0}, 1e-5f, 0.5f);
}

/// The mean of very many values: of 2^18 samples in [¼, ¾), as floats are summed and as doubles are.
HardCaseFigures runningMean(std::uint64_t inputs, std::uint64_t seed) {
    Tally tally;
    const std::uint64_t runs = (inputs + 4999) / 5000;
    std::uint64_t input = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        Random random(seed + run);
        float naive = 0;
        double stable = 0;
        std::uint64_t sum = 0;  // exact, in units of 2^-24
        constexpr std::uint32_t samples = 1u << 18;
        for (std::uint32_t i = 0; i < samples; ++i) {
            const auto units = (1u << 22) + random.below(1u << 23);
            const float value = static_cast<float>(units) * 0x1p-24f;
            sum += units;
            const auto n = static_cast<float>(i);
            naive = naive * (n / (n + 1)) + value / (n + 1);
            stable += (static_cast<double>(value) - stable) / (i + 1.0);
        }
        const double exact = static_cast<double>(sum) * 0x1p-24 / samples;
        const double naiveError = std::abs(static_cast<double>(naive) - exact) / exact;
        const double stableError = std::abs(stable - exact) / exact;
        for (; input < (run + 1) * 5000 && (input < inputs || run + 1 < runs); ++input)
            tally.add(naiveError, stableError, [&] { return std::to_string(seed + run); });
    }
    return tally.figures();
}

/// Panoramas with pixels that are no numbers, infinite or below zero: whether what is drawn is light.
HardCaseFigures brokenPanorama(std::uint64_t inputs, std::uint64_t seed) {
    Random random(seed);
    Scene scene;
    scene.materials = {Material{}};
    Environment& environment = scene.environment.emplace();
    environment.panorama = Image(16, 8, 3, Encoding::linear);
    for (float& value : environment.panorama.data)
        switch (random.below(8)) {
            case 0:
                value = std::numeric_limits<float>::quiet_NaN();
                break;
            case 1:
                value = std::numeric_limits<float>::infinity();
                break;
            case 2:
                value = -1;
                break;
            default:
                value = random.uniform();
        }
    const TraceScene traced(scene, {{Sphere{1}, 0, glm::mat4(1)}});
    const LightSet lights(traced);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 direction = randomDirection(random);
        const Image& panorama = environment.panorama;
        const float* const texel =
            panorama.pixel(static_cast<int>(random.below(16)), static_cast<int>(random.below(8)));
        const auto judge = [](glm::vec3 light) {
            for (int c = 0; c < 3; ++c)
                if (!(light[c] >= 0) || !std::isfinite(light[c]))
                    return std::numeric_limits<double>::infinity();
            return 0.0;
        };
        const float density = lights.density(direction);
        tally.add(judge({texel[0], texel[1], texel[2]}),
                  judge(lights.environment(direction)) + (density >= 0 && std::isfinite(density) ? 0.0 : 1.0),
                  [&] { return hexVector(direction); });
    }
    return tally.figures();
}

constexpr HardCase cases[] = {
    {"TraceScene::leave", "a scene of 1000 units, 10⁶ from the origin", "wrong surfaces met", 0,
     "bounds of the position's rounding, along the normal", leaveFar},
    {"TraceScene::leave", "a room of 10⁻⁵", "wrong surfaces met", 0,
     "bounds of the position's rounding, along the normal", leaveSmall},
    {"mean of samples", "2¹⁸ samples of a pixel", "relative error", 1e-12,
     "Welford, Technometrics 4(3), 1962, in double", runningMean},
    {"LightSet::environment", "panoramas with NaN, infinities and negative light", "no light", 0,
     "what is no light is dark, before anything is drawn", brokenPanorama},
};

}  // namespace

std::span<const HardCase> pathHardCases() {
    return cases;
}

}  // namespace quincunx

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "lab/studio.h"
#include "labs/18_environment_mapping/lab.h"
#include "labs/18_environment_mapping/mirror_figures.h"

namespace quincunx {
namespace {

constexpr int width = 200;
constexpr int height = 150;
constexpr double degreesPerRadian = 57.29577951308232;

/// The lab with one sample a pixel and a map as fine as the picture needs.
struct Bench {
    EnvironmentMappingLab lab;
    Studio& studio;
    Frame frame;

    explicit Bench(Studio& drawing) : studio(drawing), frame(drawing.frame(lab, width, height)) {
        lab.supersample.set(1);
        lab.resolution.set(512);
        lab.tessellation.set(48);
    }
    /// The mean error over one mirror.
    double error(EnvironmentMappingLab::Reflector reflector) {
        lab.reflector.set(static_cast<int>(reflector));
        const MirrorHall hall = lab.currentHall();
        const Image traced = traceMirrors(hall, frame.camera, width, height, lab.mirrors(), &interruptFlag());
        const Image vectors = traceReflectionVectors(hall, frame.camera, width, height, lab.mirrors());
        return compareMirrors(studio.linearPicture(lab, frame), traced, vectors,
                              reflector == EnvironmentMappingLab::Reflector::ball ? 1 : 2)
            .meanError;
    }
};

std::vector<Measurement> measurePlanes(Studio& studio) {
    using Reflector = EnvironmentMappingLab::Reflector;
    Bench bench(studio);
    std::vector<Measurement> figures;

    const Image vectors = traceReflectionVectors(bench.lab.currentHall(), bench.frame.camera, width, height);
    const double ballSpread = degreesPerRadian * vectorSpread(vectors, 1);
    const double planeSpread = degreesPerRadian * vectorSpread(vectors, 2);
    constexpr int lookups = 8;  // texels along an edge of the faces that are counted
    figures.push_back({"ball: spread of the reflection vectors", ballSpread, "degrees", {}});
    figures.push_back({"plane: spread of the reflection vectors", planeSpread, "degrees", {}});
    figures.push_back({"plane: spread over the ball's", planeSpread / ballSpread, "times", atMost(0.25)});
    figures.push_back({"ball: share of the map that is looked up", 100 * shareOfMap(vectors, 1, lookups), "%",
                       atLeast(50)});
    figures.push_back({"plane: share of the map that is looked up", 100 * shareOfMap(vectors, 2, lookups),
                       "%", atMost(10)});

    static constexpr std::array distances = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f};
    for (const Reflector reflector : {Reflector::ball, Reflector::plane}) {
        const char* const name = reflector == Reflector::ball ? "ball" : "plane";
        std::vector<double> errors;
        std::vector<double> angles;
        for (const float distance : distances) {
            bench.lab.distance.set(distance);
            errors.push_back(bench.error(reflector));
            angles.push_back(
                meanAngle(traceLookupAngles(bench.lab.currentHall(), bench.frame.camera, width, height,
                                            bench.lab.mapPosition(), bench.lab.mirrors()),
                          reflector == Reflector::ball ? 1 : 2));
            figures.push_back(
                {fmt::format("{}, all {:g} times as far away: lookups are off by", name, distance),
                 degreesPerRadian * angles.back(),
                 "degrees",
                 {}});
            figures.push_back({fmt::format("{}, all {:g} times as far away: mean error", name, distance),
                               errors.back(),
                               "of linear light",
                               {}});
        }
        // The angle is the offset from where the map was taken over the distance. Wrong pixels line the edges
        // of what is seen in bands as wide as that, until the map's texels and the pixels themselves are as
        // wide.
        const auto slope = [&](const std::vector<double>& values) {
            return std::log2(values.back() / values[1]) /
                   std::log2(static_cast<double>(distances.back()) / distances[1]);
        };
        figures.push_back({fmt::format("{}: slope of that angle over the distance, log-log", name),
                           slope(angles), "", equals(-1, 0.15)});
        figures.push_back({fmt::format("{}: slope of the error over the distance, log-log", name),
                           slope(errors), "", atMost(-0.5)});
    }
    bench.lab.distance.set(1);

    // A hall without solids is the box that the projection takes it for; only texels' size is left.
    bench.lab.solids.set(false);
    for (const Reflector reflector : {Reflector::ball, Reflector::plane}) {
        const char* const name = reflector == Reflector::ball ? "ball" : "plane";
        bench.lab.boxProjection.set(false);
        const double plain = bench.error(reflector);
        bench.lab.boxProjection.set(true);
        const double corrected = bench.error(reflector);
        figures.push_back({fmt::format("{}, empty hall: mean error", name), plain, "of linear light", {}});
        figures.push_back(
            {fmt::format("{}, empty hall: with box projection", name), corrected, "of linear light", {}});
        figures.push_back({fmt::format("{}, empty hall: error left by box projection", name),
                           corrected / plain, "times", atMost(0.1)});
    }
    bench.lab.solids.set(true);
    const double corrected = bench.error(Reflector::plane);
    bench.lab.boxProjection.set(false);
    figures.push_back({"plane, furnished hall: error left by box projection",
                       corrected / bench.error(Reflector::plane), "times", atMost(0.8)});
    return figures;
}

}  // namespace

std::vector<Question> EnvironmentMappingLab::questions() {
    return {
        {95, "Why does classic environment mapping fail on flat mirrors, where it does well on curved ones?",
         "A lookup knows the reflected direction and nothing of the point that it leaves from: every point "
         "reflects "
         "as if it stood where the map was taken, or, which is the same, as if all that it sees were "
         "infinitely far "
         "away. Over a ball the direction changes fast, sweeps most of the map, and hides that it is looked "
         "up from "
         "the wrong place. Over a plane it hardly changes: a few degrees of the map are stretched over the "
         "whole "
         "mirror, near things do not meet their mirror images, and what straight edges would show is wrong "
         "by the point's whole offset. The error falls with the distance of what is reflected. If the "
         "surroundings "
         "are a box, the ray can be followed to its wall first (box projection), which mends the plane too.",
         "", [](Studio& studio) { return measurePlanes(studio); }},
    };
}

}  // namespace quincunx

#include <cmath>
#include <memory>

#include "base/interrupt.h"
#include "labs/22_intersections/lab.h"
#include "labs/22_intersections/measure.h"
#include "labs/22_intersections/triangle_cases.h"

namespace quincunx {
namespace {

struct Answers {
    std::vector<Ray> rays;
    std::vector<std::optional<Quad>> exact;
};

/// A wrong hit or miss counts as an error of 1, a right one by the relative error of t.
double errorOf(const std::optional<double>& got, const std::optional<Quad>& exact) {
    if (got.has_value() != exact.has_value())
        return 1;
    if (!got || *exact == 0)
        return 0;
    return std::min(1.0, std::abs(static_cast<double>((Quad(*got) - *exact) / *exact)));
}

/// Arithmetic of one shape, seen from afar: all rays of a frame, against exact arithmetic on the same rays.
Sweep arithmeticSweep(IntersectionsLab& lab, const std::string& shape, const std::string& title,
                      const std::string& distance) {
    Sweep sweep;
    sweep.name = "arithmetic-" + shape;
    sweep.title = title;
    sweep.reference = "exact arithmetic on the same rays";
    sweep.metric = "mean relative error of t, 1 for a wrong hit or miss";
    sweep.width = 160;
    sweep.height = 120;
    for (const std::string& method : lab.method.options())
        sweep.points.push_back({{"method", method}, {"shape", shape}, {"distance", distance}});
    const auto answers = std::make_shared<Answers>();
    sweep.measure = [&lab, answers](Studio&, const Frame& frame) {
        const std::vector<Exhibit> exhibits = lab.exhibits();
        const Exhibit& exhibit = exhibits.front();
        const auto count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
        if (answers->rays.size() != count) {
            *answers = {};
            // A window of the frame around the shape, so that a good part of the rays comes near it.
            Lens lens = lab.lens(frame, static_cast<double>(frame.width) / frame.height);
            const glm::dvec3 centre(exhibit.around.centre);
            const double radius = exhibit.around.radius;
            lens.eye += centre - (lens.eye + lens.reach * lens.forward);
            lens.halfHeight = 1.2 * radius;
            for (int y = 0; y < frame.height; ++y)
                for (int x = 0; x < frame.width; ++x)
                    answers->rays.push_back(lens.rayAt((x + 0.5) / frame.width, (y + 0.5) / frame.height));
            for (const Ray& ray : answers->rays) {
                throwIfInterrupted();
                answers->exact.push_back(meetExactly(exhibit, ray));
            }
        }
        SweepSample sample;
        const Approach approach = lab.approach();
        for (std::size_t i = 0; i < count; ++i) {
            const std::optional<double> t = meetDistance(exhibit, answers->rays[i], approach);
            sample.error += errorOf(t, answers->exact[i]) / static_cast<double>(count);
            sample.counters["wrong hits and misses"] += t.has_value() != answers->exact[i].has_value();
            sample.counters["hits"] += answers->exact[i].has_value();
        }
        sample.counters["rays"] = count;
        const Timing timing = timeRuns(approach.method == Method::exact ? 3 : 9, [&] {
            for (const Ray& ray : answers->rays)
                keep(meetDistance(exhibit, ray, approach));
        });
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        return sample;
    };
    return sweep;
}

/// The ways to meet a triangle, on rays at edges, corners, slivers and anywhere.
Sweep triangleSweep(IntersectionsLab& lab) {
    Sweep sweep;
    sweep.name = "triangles";
    sweep.title = "ways to meet a triangle: rays at edges, corners, slivers, and anywhere";
    sweep.reference = "exact arithmetic on the same rays";
    sweep.metric = "share of wrong hits and misses";
    sweep.width = 160;
    sweep.height = 120;
    for (const std::string& way : lab.triangleWay.options())
        sweep.points.push_back({{"method", "naive"}, {"triangle-way", way}});
    sweep.points.push_back({{"method", "stable"}, {"triangle-way", "woop"}});
    const auto rays = std::make_shared<std::vector<AimedRay>>();
    sweep.measure = [&lab, rays](Studio&, const Frame& frame) {
        const auto count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height) / 4;
        if (rays->size() != 4 * count) {
            rays->clear();
            for (const Aim aim : aims) {
                const std::vector<AimedRay> more = aimedRays(aim, count, frame.seed);
                rays->insert(rays->end(), more.begin(), more.end());
            }
        }
        const int way = lab.method.as<Method>() == Method::naive ? lab.triangleWay.index() : triangleWays - 1;
        SweepSample sample;
        std::uint64_t wrong = 0;
        for (const AimedRay& aimed : *rays)
            wrong += meetTriangle(way, aimed).has_value() != aimed.hits;
        sample.error = static_cast<double>(wrong) / static_cast<double>(rays->size());
        sample.counters["wrong hits and misses"] = wrong;
        sample.counters["rays"] = rays->size();
        const Timing timing = timeRuns(9, [&] {
            for (const AimedRay& aimed : *rays)
                keep(meetTriangle(way, aimed));
        });
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> IntersectionsLab::sweeps() {
    std::vector<Sweep> sweeps;
    sweeps.push_back(
        arithmeticSweep(*this, "sphere", "a sphere from afar: float, double, bounded, exact", "256"));
    sweeps.push_back(
        arithmeticSweep(*this, "can", "a cylinder with caps: float, double, bounded, exact", "256"));
    sweeps.push_back(triangleSweep(*this));
    return sweeps;
}

}  // namespace quincunx

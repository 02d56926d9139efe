#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/random.h"
#include "image/compare.h"
#include "labs/26_ray_tracing/lab.h"
#include "labs/26_ray_tracing/measure.h"
#include "labs/26_ray_tracing/penumbra.h"
#include "trace/grid.h"

namespace quincunx {
namespace {

constexpr int answerWidth = 96;
constexpr int answerHeight = 72;

double number(std::uint64_t count) {
    return static_cast<double>(count);
}

double differenceOf(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(a.data[i]) - b.data[i]));
    return worst;
}

std::vector<Measurement> measureFunctions() {
    const WhittedScene scene(makeTerrace());
    WhittedCounts counts;
    WhittedSettings settings;
    settings.shadowRays = 4;
    renderWhitted(scene, terraceCamera(), answerWidth, answerHeight, settings, &counts);
    const double pixels = answerWidth * answerHeight;
    return {{"pixels, each a call of trace() by main()", pixels, "calls", {}},
            {"calls of trace() by shade(): mirrored and refracted rays", number(counts.childRays), "calls",
             atLeast(0.2 * pixels)},
            {"calls of trace(), less those two",
             number(counts.traceCalls) - pixels - number(counts.childRays), "calls", equals(0)},
            {"calls of findClosestIntersection(), less those of trace()",
             number(counts.findCalls) - number(counts.traceCalls), "calls", equals(0)},
            {"calls of shade(): where trace() met something", number(counts.shadeCalls), "calls",
             atMost(number(counts.traceCalls) - 1)},
            {"calls of trace() that met nothing: the sky",
             number(counts.traceCalls - counts.shadeCalls),
             "calls",
             {}},
            {"shadow rays, sent by shade()", number(counts.shadowRays), "rays", {}},
            {"deepest call", number(counts.deepest), "", atLeast(2)}};
}

std::vector<Measurement> measureRecursion() {
    const WhittedScene scene(makeTerrace());
    const Camera camera = terraceCamera();
    const Image reference = recursionReference(scene, camera, answerWidth, answerHeight);
    const double mean = meanLuminance(reference);
    std::vector<Measurement> figures;
    struct Cut {
        double rays = 0;
        double error = 0;
        double bias = 0;
    };
    const auto cut = [&](RecursionEnd end, int depth, float weight) {
        WhittedCounts counts;
        const Image image = renderWhitted(scene, camera, answerWidth, answerHeight,
                                          recursionSettings(end, depth, weight), &counts);
        return Cut{number(counts.traceCalls), rmse(reference, image), meanLuminance(image) / mean - 1};
    };
    Cut byDepth;
    for (const int depth : {1, 2, 4, 8}) {
        byDepth = cut(RecursionEnd::depth, depth, 0);
        figures.push_back({fmt::format("depth {}: rays", depth), byDepth.rays, "rays", {}});
        figures.push_back({fmt::format("depth {}: error", depth), byDepth.error, "RMSE", {}});
    }
    Cut byWeight;
    for (const float weight : {1 / 8.0f, 1 / 32.0f, 1 / 128.0f}) {
        byWeight = cut(RecursionEnd::weight, 0, weight);
        figures.push_back({fmt::format("weight 1/{:g}: rays", 1 / weight), byWeight.rays, "rays", {}});
        figures.push_back({fmt::format("weight 1/{:g}: error", 1 / weight), byWeight.error, "RMSE", {}});
    }
    const Cut depthFour = cut(RecursionEnd::depth, 4, 0);
    figures.push_back(
        {"weight 1/128 over depth 4: rays", byWeight.rays / depthFour.rays, "times", atMost(1)});
    figures.push_back(
        {"weight 1/128 over depth 4: error", byWeight.error / depthFour.error, "times", atMost(0.7)});

    // Roulette keeps the mean: Student's t of the pictures' means against the reference's.
    constexpr float threshold = 1 / 8.0f;
    constexpr int runs = 24;
    const Cut biased = cut(RecursionEnd::weight, 0, threshold);
    double sum = 0;
    double squares = 0;
    double error = 0;
    for (int run = 0; run < runs; ++run) {
        throwIfInterrupted();
        const Image image = renderWhitted(
            scene, camera, answerWidth, answerHeight,
            recursionSettings(RecursionEnd::roulette, 0, threshold, static_cast<std::uint64_t>(run) + 1));
        const double relative = meanLuminance(image) / mean - 1;
        sum += relative;
        squares += relative * relative;
        error += rmse(reference, image) / runs;
    }
    const double average = sum / runs;
    const double deviation = std::sqrt((squares - runs * average * average) / (runs - 1));
    const double standardError = deviation / std::sqrt(static_cast<double>(runs));
    figures.push_back({"cut at weight 1/8: light lost", -100 * biased.bias, "%", atLeast(0.2)});
    figures.push_back(
        {"the same in standard errors of the mean below", -biased.bias / standardError, "", atLeast(6)});
    figures.push_back({"roulette below 1/8, 24 pictures: light lost", -100 * average, "%", {}});
    // 23 degrees of freedom: |t| > 4 once in 1800 times; the seeds are fixed.
    figures.push_back(
        {"roulette: |t| of the mean being right", std::abs(average) / standardError, "", atMost(4)});
    figures.push_back({"roulette: error of one picture", error, "RMSE", {}});
    figures.push_back(
        {"variance paid: error of roulette over that of the cut", error / biased.error, "times", {}});
    return figures;
}

std::vector<Measurement> measureShadowCache() {
    const WhittedScene scene(makeTerrace());
    WhittedSettings settings;
    settings.shadowRays = 16;
    WhittedCounts with;
    WhittedCounts without;
    const Image cached = renderWhitted(scene, terraceCamera(), answerWidth, answerHeight, settings, &with);
    settings.shadowCache = false;
    const Image plain = renderWhitted(scene, terraceCamera(), answerWidth, answerHeight, settings, &without);
    return {{"difference of the pictures with and without", differenceOf(cached, plain), "", equals(0)},
            {"shadow rays", number(with.shadowRays), "rays", {}},
            {"of these stopped by something opaque",
             100 * number(with.blockedRays) / number(with.shadowRays),
             "%",
             {}},
            {"rays that had a last blocker to try", number(with.cacheTries), "rays", {}},
            {"tries that hit", 100 * number(with.cacheHits) / number(with.cacheTries), "%", atLeast(60)},
            {"stopped rays that needed no walk", 100 * number(with.cacheHits) / number(with.blockedRays), "%",
             atLeast(60)},
            {"walks through the structure with, over without",
             number(with.shadowWalks) / number(without.shadowWalks), "times", atMost(0.95)},
            {"stopped rays that are the same", number(with.blockedRays) - number(without.blockedRays), "rays",
             equals(0)}};
}

struct GridWalks {
    TraversalCounts counts;
    std::vector<std::optional<AcceleratorHit>> hits;
};

GridWalks walkAll(const Grid& grid, const std::vector<Ray>& rays, int threads) {
    GridWalks walks{{}, std::vector<std::optional<AcceleratorHit>>(rays.size())};
    std::vector<TraversalCounts> counts(static_cast<std::size_t>(threads));
    {
        // Every thread takes every so-manieth ray: they meet the same triangles at the same time.
        std::vector<std::jthread> workers;
        for (std::size_t thread = 0; thread < counts.size(); ++thread)
            workers.emplace_back([&, thread] {
                for (std::size_t i = thread; i < rays.size(); i += counts.size())
                    walks.hits[i] = grid.nearest(rays[i], {}, &counts[thread]);
            });
    }
    for (const TraversalCounts& count : counts)
        walks.counts += count;
    return walks;
}

std::vector<Measurement> measureMailboxes() {
    const WhittedScene scene(makeTerrace());
    const std::vector<Ray> rays = raysOfPicture(scene, terraceCamera(), 2 * answerWidth, 2 * answerHeight);
    const double count = number(rays.size());
    const GridWalks none = walkAll(Grid(scene.triangleView(), {.mailboxes = Mailboxes::none}), rays, 1);
    std::uint64_t different = 0;
    std::uint64_t uneven = 0;
    std::vector<Measurement> figures{
        {"tests a ray without mailboxes", number(none.counts.triangles) / count, "", {}}};
    for (const auto& [mailboxes, name] : {std::pair{Mailboxes::ofThread, "a box a triangle and thread"},
                                          std::pair{Mailboxes::ofRay, "kept with the ray"}}) {
        const Grid grid(scene.triangleView(), {.mailboxes = mailboxes});
        const GridWalks one = walkAll(grid, rays, 1);
        figures.push_back(
            {fmt::format("{}: tests a ray", name), number(one.counts.triangles) / count, "", {}});
        figures.push_back({fmt::format("{}: with over without", name),
                           number(one.counts.triangles) / number(none.counts.triangles), "times",
                           atMost(0.9)});
        for (const int threads : {1, 4}) {
            const GridWalks walks = walkAll(grid, rays, threads);
            uneven += walks.counts.triangles != one.counts.triangles;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const auto& a = walks.hits[i];
                const auto& b = none.hits[i];
                different +=
                    a.has_value() != b.has_value() || (a && (a->t != b->t || a->triangle != b->triangle));
            }
        }
    }
    figures.push_back(
        {"walks on four threads that take other numbers of tests", number(uneven), "", equals(0)});
    figures.push_back(
        {"hits that differ from those without, one thread and four", number(different), "hits", equals(0)});
    return figures;
}

std::vector<Measurement> measureSoftShadows() {
    const PenumbraBench bench;
    std::vector<Measurement> figures;
    const std::vector<double> counts{4, 16, 64, 256};
    std::vector<double> random;
    std::vector<double> sobol;
    std::vector<double> jittered;
    for (const double count : counts) {
        const int samples = static_cast<int>(count);
        for (const auto& [pattern, errors] :
             {std::pair{SamplePattern::random, &random}, std::pair{SamplePattern::jittered, &jittered},
              std::pair{SamplePattern::sobol, &sobol}})
            errors->push_back(penumbraError(bench, lightSets(pattern, samples, 1)));
    }
    for (const SamplePattern pattern : allSamplePatterns)
        figures.push_back({fmt::format("16 shadow rays, {}", samplePatternName(pattern)),
                           penumbraError(bench, lightSets(pattern, 16, 1)),
                           "RMSE of the share",
                           {}});
    figures.push_back({"1 shadow ray: a hard shadow",
                       penumbraError(bench, lightSets(SamplePattern::regular, 1, 1)), "RMSE of the share",
                       atLeast(0.1)});
    figures.push_back(
        {"slope of error against rays, random", slopeOf(counts, random), "", equals(-0.5, 0.06)});
    figures.push_back({"the same, jittered", slopeOf(counts, jittered), "", equals(-0.75, 0.1)});
    figures.push_back({"the same, Sobol", slopeOf(counts, sobol), "", atMost(-0.65)});
    figures.push_back({"256 rays: Sobol over random", sobol.back() / random.back(), "times", atMost(0.4)});
    return figures;
}

std::vector<Measurement> measureConstructedSolids() {
    CsgScratch scratch;
    Random random(48);
    const auto any = [&] { return static_cast<float>(random.uniform(-1, 1)); };
    const Csg cube = Csg::box({{-1, -1, -1}, {1, 1, 1}});
    const Csg can = Csg::cylinder({{0, 0, -1}, {0, 0, 2}, 0.5f});  // ends in the cube's faces
    const Csg drilled = subtract(cube, can);
    const CsgSolid nothing(subtract(drilled, drilled));
    const CsgSolid once(drilled);
    const CsgSolid twice(unite(drilled, drilled));
    const CsgSolid filled(unite(drilled, can));
    const CsgSolid whole(cube);
    std::uint64_t left = 0;
    std::uint64_t changed = 0;
    std::uint64_t seams = 0;
    std::uint64_t missed = 0;
    std::uint64_t missedByFloats = 0;
    // Two halves with a gap of 2^-14 between them.
    const Csg lowHalf = Csg::box({{-1, -1, -1}, {1, 1, 0}});
    const Csg highHalf = Csg::box({{-1, -1, 0x1p-14f}, {1, 1, 1}});
    const CsgSolid low(lowHalf);
    const CsgSolid high(highHalf);
    const CsgSolid apart(unite(lowHalf, highHalf));
    constexpr int rays = 20000;
    for (int i = 0; i < rays; ++i) {
        const glm::vec3 through(0.9f * any(), 0.9f * any(), 0.9f * any());
        const glm::vec3 direction(any(), any(), any());
        if (direction == glm::vec3(0))
            continue;
        const Ray ray{through - 5.0f * direction, direction};
        left += nothing.crossings(ray, scratch).size();
        const std::size_t before = once.crossings(ray, scratch).size();
        changed += twice.crossings(ray, scratch).size() != before;
        seams += filled.crossings(ray, scratch).size() != whole.crossings(ray, scratch).size();
        const Ray across{through - 5.0f * glm::vec3(direction.x, direction.y, 3),
                         {direction.x, direction.y, 3}};
        const bool meetsBoth =
            low.crossings(across, scratch).size() == 2 && high.crossings(across, scratch).size() == 2;
        missed += meetsBoth && apart.crossings(across, scratch).size() != 4;
        missedByFloats += meetsBoth && csgCrossingsNaive(unite(lowHalf, highHalf), across, 1e-4f).size() != 4;
    }
    // A lens: the common part of two balls, by the lengths that rays have in it.
    const CsgSolid lens(intersect(Csg::ball({{0, 0, -0.5f}, 1}), Csg::ball({{0, 0, 0.5f}, 1})));
    constexpr int side = 200;
    double volume = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::vec3 at(2 * (static_cast<float>(x) + 0.5f) / side - 1,
                               2 * (static_cast<float>(y) + 0.5f) / side - 1, -3);
            const auto list = lens.crossings({at, {0, 0, 1}}, scratch);
            for (std::size_t i = 0; i < list.size(); i += 2)
                volume += (list[i + 1].t - list[i].t) * 4 / (side * side);
        }
    Csg nested = cube;
    for (int i = 1; i < Csg::deepest; ++i)
        nested = i % 2 == 0 ? unite(nested, can) : subtract(nested, can);
    return {{"crossings left of A − A, 20000 rays", number(left), "", equals(0)},
            {"rays on which A ∪ A is not A", number(changed), "rays", equals(0)},
            {"a plug put back into its hole: rays that find a seam", number(seams), "rays", equals(0)},
            {"a gap of 2^-14 between two boxes: rays that miss it", number(missed), "rays", equals(0)},
            {"the same by floats that take 1e-4 as equal", number(missedByFloats), "rays", atLeast(1)},
            {"volume of a lens over π 5/12", volume / (5 * 3.14159265358979 / 12), "", equals(1, 1e-3)},
            {"operators nested", Csg::deepest - 1.0, "deep", {}},
            {"crossings of the nested solid on the axis",
             number(CsgSolid(nested).crossings({{0, 0, -5}, {0, 0, 1}}, scratch).size()), "", equals(0)}};
}

}  // namespace

std::vector<Question> RayTracingLab::questions() {
    return {
        {66, "Which parts does a simple ray tracer have, and which of them calls which?",
         "main() makes a ray for every pixel and calls trace(). trace() answers one question, what colour "
         "comes "
         "along this ray: it calls findClosestIntersection(), which tries the ray on the scene through its "
         "structure, and hands what was met to shade(); where nothing was, it returns the background. "
         "shade() "
         "adds up the light at the point, with shadow rays towards the lamps, and calls trace() again for "
         "the "
         "mirrored and for the refracted ray: so the two call one another, and a pixel is a tree of rays.",
         "", [](Studio&) { return measureFunctions(); }},
        {20, "How does the recursion of a ray tracer end well, other than at a fixed depth?",
         "Every ray carries the share that it has in its pixel: 1 at the eye, times the mirrored or "
         "refracted "
         "part at each surface. Below a threshold it is not traced, so that rays go deep where they matter "
         "and "
         "nowhere else. Some light is lost that way, always in the same direction. Russian roulette loses "
         "none "
         "in the mean: below the threshold a ray goes on only with a probability p in proportion to its "
         "share, "
         "and what it brings back then counts 1/p. That is paid for in noise.",
         "", [](Studio&) { return measureRecursion(); }},
        {47, "What does a shadow cache hold, and what is it good for?",
         "The last thing that stood before a lamp, one entry for each lamp and each depth of the recursion, "
         "and "
         "nothing where the last shadow ray got through. Neighbouring points mostly lie in the same shadow, "
         "so "
         "the next shadow ray tries that thing first. If it blocks, the structure need not be walked at all, "
         "for "
         "any blocker will do; if not, one test was wasted. The picture cannot change. Each thread has a "
         "cache "
         "of its own.",
         "", [](Studio&) { return measureShadowCache(); }},
        {82, "What are mailboxes in a grid for, and how do they work?",
         "A triangle lies in every cell that it overlaps, so a ray on its way through the cells comes upon "
         "the "
         "same triangle several times. Each ray gets a number, and each triangle a box for the number of the "
         "last ray that was tested against it. Is it the present one, the outcome is known already and the "
         "test "
         "is left out. Threads that shared boxes would overwrite each other's numbers, and race: so every "
         "thread has boxes of its own, or the ray itself remembers its last few triangles.",
         "", [](Studio&) { return measureMailboxes(); }},
        {83, "How does a ray tracer make the soft shadow of a lamp that has an area?",
         "With several shadow rays from the point, each to another place of the lamp, the mean of what they "
         "bring is the share of the lamp that is seen. Where they end decides how good that is: on a regular "
         "grid the penumbra falls into steps, at random it is noisy, and spread evenly but irregularly, by "
         "jitter or a low-discrepancy set, it takes far fewer rays for the same error.",
         "", [](Studio&) { return measureSoftShadows(); }},
        {48, "What is constructive solid geometry, and how is it ray traced?",
         "Solids are put together from simple ones by union, intersection and difference, nested at will. A "
         "ray "
         "cuts each simple solid in intervals; the operators are applied to those: both sorted lists are "
         "merged, "
         "and a crossing is kept where the result turns from out to in or back. The first that is left is "
         "the "
         "visible point; a surface of what was subtracted is seen from within, its normal turned. Where "
         "surfaces coincide their crossings must be known to be equal: a tolerance leaves skins, or closes "
         "gaps.",
         "", [](Studio&) { return measureConstructedSolids(); }},
    };
}

}  // namespace quincunx

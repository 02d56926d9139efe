#include <array>
#include <chrono>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "labs/27_path_tracing/lab.h"
#include "labs/27_path_tracing/measure.h"

namespace quincunx {
namespace {

/// A mean farther off than this many of its standard errors comes by chance once in 150 000 times.
constexpr double farOff = 4.5;

std::vector<Measurement> measureEquation() {
    constexpr float albedo = 0.6f;
    const double rho = static_cast<double>(albedo);
    const PathStage furnace(makeFurnace(albedo));
    const Ray ray = cameraRay(furnace.camera, 16, 12, {5.5f, 8.5f});
    const EquationTerms terms = estimateTerms(furnace.paths, ray, 20000, 49);
    const PathStage chamber(makeChamber());
    const Ray onFloor = cameraRay(chamber.camera, 16, 12, {7.5f, 10.5f});
    const EquationTerms seen = estimateTerms(chamber.paths, onFloor, 8000, 49);
    const MeanAndError whole = meanOf(
        8000, 50, [&](PathSampler& sampler) { return tracePathMis(chamber.paths, onFloor, sampler).g; });
    const auto off = [](float mean, double exact, float error) {
        return std::abs(static_cast<double>(mean) - exact) / static_cast<double>(error);
    };
    const double both = std::hypot(whole.error(), std::hypot(static_cast<double>(seen.directError.g),
                                                             static_cast<double>(seen.indirectError.g)));
    return {
        {"furnace: emitted, Le", terms.emitted.g, "", equals(1)},
        {"furnace: scattered here, straight from what shines", terms.direct.g, "", {}},
        {"… off from albedo · Le", off(terms.direct.g, rho, terms.directError.g), "standard errors",
         atMost(farOff)},
        {"furnace: scattered here, after others", terms.indirect.g, "", {}},
        {"… off from albedo² Le / (1 − albedo)",
         off(terms.indirect.g, rho * rho / (1 - rho), terms.indirectError.g), "standard errors",
         atMost(farOff)},
        {"furnace: the sum against Le / (1 − albedo), relative",
         std::abs(static_cast<double>(terms.sum().g) * (1 - rho) - 1), "", atMost(0.02)},
        {"chamber, a point of the floor: share that comes straight from the light",
         static_cast<double>(seen.direct.g / seen.sum().g),
         "",
         {}},
        {"chamber: the sum of the terms against whole paths, off",
         std::abs(static_cast<double>(seen.sum().g) - whole.mean) / both, "standard errors", atMost(farOff)}};
}

/// A panel above a point: ∫ cos θ cos θ′ / r² dA in closed form (Lambert's sum over the edges).
double panelIrradiance(glm::dvec3 point, const std::array<glm::dvec3, 4>& corners) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - point);
        const glm::dvec3 b = glm::normalize(corners[(i + 1) % 4] - point);
        const glm::dvec3 normal = glm::cross(a, b);
        sum += std::atan2(glm::length(normal), glm::dot(a, b)) * normal.y / glm::length(normal);
    }
    return std::abs(sum) / 2;
}

std::vector<Measurement> measureAreaLight() {
    PathSet set;
    set.model = OpaqueModel::lambert;
    set.scene.ambientLight = glm::vec3(0);
    Mesh panel;
    panel.positions = {{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}};
    panel.indices = {0, 1, 2, 0, 2, 3};  // faces down
    Mesh floor;
    floor.positions = {{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
    floor.indices = {0, 1, 2, 0, 2, 3};
    set.scene.meshes = {panel, floor};
    set.scene.materials.resize(2);
    set.scene.materials[0].emission = glm::vec3(1);
    set.scene.materials[1].baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1);
    set.scene.instances = {{"light", 0, 0, glm::mat4(1)}, {"floor", 1, 1, glm::mat4(1)}};
    set.scene.cameras = {Camera{}};
    const PathStage stage(std::move(set));
    const Ray ray{{0.8f, 0.5f, 0.3f}, {0, -1, 0}};
    const double exact =
        0.5 / 3.14159265358979323846 *
        panelIrradiance({static_cast<double>(ray.origin.x), 0, static_cast<double>(ray.origin.z)},
                        {glm::dvec3(-0.5, 1, -0.5), {0.5, 1, -0.5}, {0.5, 1, 0.5}, {-0.5, 1, 0.5}});
    std::vector<double> counts;
    std::vector<double> errors;
    MeanAndError all;
    std::uint32_t path = 0;
    for (const int samples : {1, 4, 16, 64, 256}) {
        const int repeats = 200;
        double squares = 0;
        for (int repeat = 0; repeat < repeats; ++repeat) {
            MeanAndError mean;
            for (int i = 0; i < samples; ++i) {
                PathSampler sampler(24, path++, 24);
                const double value =
                    static_cast<double>(tracePathNee(stage.paths, ray, sampler, {.maxBounces = 1}).g);
                mean.add(value);
                all.add(value);
            }
            squares += (mean.mean - exact) * (mean.mean - exact) / repeats;
        }
        counts.push_back(samples);
        errors.push_back(std::sqrt(squares) / exact);
    }
    return {{"light of the panel in closed form", exact, "", {}},
            {"mean of one random shadow ray at a time", all.mean, "", {}},
            {"… off", all.off(exact), "standard errors", atMost(farOff)},
            {"relative error of 1 shadow ray", errors.front(), "", {}},
            {"relative error of 256", errors.back(), "", {}},
            // 200 repeats know each error to 5 %, so the slope over four factors of four to 0.02.
            {"slope of the error over the rays", logSlope(counts, errors), "", equals(-0.5, 0.06)}};
}

std::vector<Measurement> measureTree() {
    const PathStage shell(makeShell(0.4f, 0.6f, 0.8f));
    const Ray ray{{0, 0, -0.7f}, {0.3f, 0.2f, -1}};
    const PathLimits limits{.maxBounces = 5, .rouletteThreshold = 0};
    constexpr int branches = 4;
    PathCounts treeCounts;
    const auto start = std::chrono::steady_clock::now();
    const MeanAndError tree = meanOf(24, 68, [&](PathSampler& sampler) {
        return traceTree(shell.paths, ray, sampler, branches, limits, &treeCounts).g;
    });
    const auto middle = std::chrono::steady_clock::now();
    PathCounts pathCounts;
    MeanAndError paths;
    for (std::uint32_t i = 0; pathCounts.rays() < treeCounts.rays(); ++i) {
        PathSampler sampler(0, i, 69);
        paths.add(static_cast<double>(tracePathNee(shell.paths, ray, sampler, limits, &pathCounts).g));
    }
    const auto end = std::chrono::steady_clock::now();
    using Seconds = std::chrono::duration<double>;
    std::vector<Measurement> figures;
    for (std::size_t level = 0; level <= 5; ++level)
        figures.push_back({fmt::format("rays at level {}: a tree of {} branches", level, branches),
                           static_cast<double>(treeCounts.raysAtLevel[level]) / tree.count, "a tree",
                           equals(std::pow(branches, level))});
    for (const std::size_t level : {1, 5})
        figures.push_back({fmt::format("rays at level {}: paths", level),
                           static_cast<double>(pathCounts.raysAtLevel[level]) / paths.count, "a path",
                           equals(1)});
    const double perRay = (tree.variance() / tree.count) / (paths.variance() / paths.count);
    figures.push_back({"share of the tree's rays at its last level",
                       static_cast<double>(treeCounts.raysAtLevel[5]) /
                           static_cast<double>(treeCounts.rays() - treeCounts.shadowRays),
                       "", atLeast(0.74)});
    figures.push_back(
        {"variance of the tree over that of paths, for as many rays", perRay, "times", atLeast(2)});
    figures.push_back({"… for as much time, here",
                       perRay * Seconds(middle - start).count() / Seconds(end - middle).count(),
                       "times",
                       {}});
    figures.push_back({"both means apart",
                       std::abs(tree.mean - paths.mean) / std::hypot(tree.error(), paths.error()),
                       "standard errors", atMost(farOff)});
    return figures;
}

std::vector<Measurement> measureMethods() {
    std::vector<Measurement> figures;
    const PathStage shell(makeShell(0.4f, 0.6f, 0.8f));
    constexpr double inner = 0.4f;
    constexpr double albedo = 0.6f;
    constexpr double outer = 0.8f;
    const ShellRadiance exact = shellRadiance(inner, albedo, outer);
    const Ray ray{{0, 0, -0.7f}, {0.3f, 0.2f, -1}};
    static constexpr std::array names = {"found by chance", "with shadow rays", "with both"};
    figures.push_back({"closed box, light in closed form", exact.shell, "", {}});
    for (std::size_t i = 0; i < names.size(); ++i) {
        const MeanAndError light = meanOf(12000, 84, [&](PathSampler& sampler) {
            return tracePath(static_cast<PathMethod>(i), shell.paths, ray, sampler).g;
        });
        figures.push_back({fmt::format("path tracing, light {}: mean", names[i]), light.mean, "", {}});
        figures.push_back({"… off", light.off(exact.shell), "standard errors", atMost(farOff)});
    }
    const MeanAndError tree = meanOf(60, 84, [&](PathSampler& sampler) {
        return traceTree(shell.paths, ray, sampler, 3, {.maxBounces = 6, .rouletteThreshold = 0}).g;
    });
    figures.push_back({"Monte Carlo ray tracing, a tree of seven levels: mean", tree.mean, "", {}});
    // What seven levels have of the light: six times scattered, by the same exchange, step by step.
    double ball = 1;
    double reached = 0;
    for (int bounce = 0; bounce < 6; ++bounce) {
        const double next = outer * (inner * inner * ball + (1 - inner * inner) * reached);
        ball = 1 + albedo * reached;
        reached = next;
    }
    figures.push_back({"… of seven levels in closed form", reached, "", {}});
    figures.push_back({"… off from that", tree.off(reached), "standard errors", atMost(farOff)});
    return figures;
}

}  // namespace

std::vector<Question> PathTracingLab::questions() {
    return {
        {24, "How does path tracing get soft shadows from a light with an area?",
         "At every surface that the path comes to, one shadow ray goes to one random point of the light. If "
         "nothing is in between, the light counts with f Le cos θ cos θ′ A / r²: θ at the surface, θ′ at the "
         "light, A the light's area, r the distance; that is one over the density of having chosen this "
         "direction. Half hidden, half the rays get through. The mean is the area light's true one, and its "
         "error falls with the root of the number of paths.",
         "", [](Studio&) { return measureAreaLight(); }},
        {49, "The rendering equation: what does it say, and what is each of its parts?",
         "Lo(x, ω) = Le(x, ω) + ∫ f(x, ω′, ω) Li(x, ω′) (n·ω′) dω′. The radiance Lo that leaves a point x in "
         "a direction ω is what the surface emits itself, Le, and what it scatters of the radiance Li that "
         "arrives from every direction ω′ of the hemisphere Ω: each weighted by the BRDF f, the share that "
         "is "
         "sent from ω′ to ω, and by the cosine to the normal n, since light that comes in slantwise is "
         "spread "
         "over more surface. Li is the Lo of the point that is seen along ω′, so the equation holds itself "
         "within itself: light that has been scattered once, twice, without end. Here the terms are "
         "estimated apart, and add up to what whole paths bring.",
         "", [](Studio&) { return measureEquation(); }},
        {68, "What makes path tracing efficient?",
         "It follows one random ray from each surface instead of many. With b rays a surface their number "
         "grows by b from level to level, and nearly all the work goes into the last level, whose light "
         "counts least in the pixel, as it is darkened at every surface on its way. A path spends as much "
         "work on each level; the time goes into more paths a pixel, which average out the pixel, the lens "
         "and the light as well.",
         "", [](Studio&) { return measureTree(); }},
        {84, "Which algorithms are there for global illumination, and how do two of them work?",
         "Path tracing: from the eye a ray goes into the scene, at every surface on in one random direction, "
         "and collects what shines; the mean over many paths is the solution of the rendering equation. "
         "Distribution (Monte Carlo) ray tracing does the same with many rays a surface. Bidirectional path "
         "tracing joins paths from the eye with paths from the lights; Metropolis light transport changes "
         "paths that bring light a little, and so finds their neighbours. Photon mapping shoots light from "
         "the lights and stores where it arrives; radiosity cuts matt surfaces into patches and solves for "
         "the light that they exchange. In a closed box whose light is known, the ways that this lab has, "
         "three ways of path tracing, agree with the closed form, and so does the tree with its own, which "
         "ends at seven levels. Radiosity and photon mapping "
         "are not part of this lab: they are held against path tracing where they are built.",
         "", [](Studio&) { return measureMethods(); }},
    };
}

}  // namespace quincunx

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "labs/26_ray_tracing/lab.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/vector.h"
#include "trace/scattering_hard_cases.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Quad magnitudeOf(Quad x) {
    return x < 0 ? -x : x;
}

/// Of crossings against exact ends, in units of the error that each states; infinite where their number is
/// another.
double errorOfCrossings(std::span<const CsgCrossing> got, const std::vector<Quad>& exact) {
    if (got.size() != exact.size())
        return infinity;
    double error = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        const Quad off = magnitudeOf(Quad(got[i].t) - exact[i]);
        if (off != 0)
            error = worse(error, got[i].error > 0 ? static_cast<double>(off / Quad(got[i].error)) : infinity);
    }
    return error;
}

/// The same of floats; their unit is what the stable form states.
double errorOfFloats(const std::vector<float>& got, const std::vector<Quad>& exact,
                     std::span<const CsgCrossing> stable) {
    if (got.size() != exact.size() || stable.size() != exact.size())
        return infinity;
    double error = 0;
    for (std::size_t i = 0; i < got.size(); ++i)
        error = worse(error, static_cast<double>(magnitudeOf(Quad(got[i]) - exact[i]) /
                                                 Quad(std::max(stable[i].error, 1e-300))));
    return error;
}

/// Where the line is in a box, for directions without a zero: quotients of floats' differences are compared
/// by products of at most 100 bits, so exactly.
struct QuadSpan {
    Quad enter = 0;
    Quad leave = 0;
    bool some = false;
};

QuadSpan spanOf(const Ray& ray, const Bounds& box) {
    QuadSpan span{Quad(-1e300), Quad(1e300), true};
    for (int axis = 0; axis < 3; ++axis) {
        const Quad d = ray.direction[axis];
        const Quad low = (Quad(box.min[axis]) - Quad(ray.origin[axis])) / d;
        const Quad high = (Quad(box.max[axis]) - Quad(ray.origin[axis])) / d;
        span.enter = std::max(span.enter, std::min(low, high));
        span.leave = std::min(span.leave, std::max(low, high));
    }
    span.some = span.enter < span.leave;
    return span;
}

std::vector<Quad> combined(Csg::Operator op, const QuadSpan& a, const QuadSpan& b) {
    const auto in = [](const QuadSpan& span, Quad t) {
        return span.some && t > span.enter && t < span.leave;
    };
    std::vector<Quad> ends;
    for (const QuadSpan& span : {a, b})
        if (span.some)
            ends.insert(ends.end(), {span.enter, span.leave});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<Quad> result;
    bool inside = false;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const Quad behind = i + 1 < ends.size() ? (ends[i] + ends[i + 1]) / Quad(2) : ends[i] + Quad(1);
        const bool inA = in(a, behind);
        const bool inB = in(b, behind);
        const bool now = op == Csg::Operator::unite       ? inA || inB
                         : op == Csg::Operator::intersect ? inA && inB
                                                          : inA && !inB;
        if (now != inside)
            result.push_back(ends[i]);
        inside = now;
    }
    return result;
}

HardCaseFigures runSharedFaces(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs input(seed);
    Random& random = input.random();
    Tally tally;
    CsgScratch scratch;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double size = input.magnitude(-20, 20);
        const double place = size * input.magnitude(-2, 6);
        Bounds a;
        Bounds b;
        for (int axis = 0; axis < 3; ++axis) {
            a.min[axis] = static_cast<float>(place * random.uniform(-1, 1));
            a.max[axis] = static_cast<float>(a.min[axis] + size * random.uniform(0.5, 1));
            // Both faces shared, one of them, or neither.
            b.min[axis] = random.below(3) != 0
                              ? a.min[axis]
                              : static_cast<float>(a.min[axis] + size * random.uniform(-0.3, 0.3));
            b.max[axis] = random.below(3) != 0
                              ? a.max[axis]
                              : static_cast<float>(a.max[axis] + size * random.uniform(-0.1, 0.3));
        }
        const glm::dvec3 within =
            glm::mix(glm::dvec3(a.min), glm::dvec3(a.max),
                     glm::dvec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)));
        const glm::vec3 direction = input.unitVector();
        const Ray ray{glm::vec3(within - 3 * size * glm::dvec3(direction)), direction};
        const auto op = static_cast<Csg::Operator>(random.below(3));
        const Csg csg = Csg::combine(op, Csg::box(a), Csg::box(b));
        const std::vector<Quad> exact = combined(op, spanOf(ray, a), spanOf(ray, b));
        const CsgSolid solid(csg);
        const auto stable = solid.crossings(ray, scratch);
        tally.add(errorOfFloats(csgCrossingsNaive(csg, ray, 1e-4f), exact, stable),
                  errorOfCrossings(stable, exact), [&] {
                      return hexVector(ray.origin) + " " + hexVector(ray.direction) + " " + hexVector(a.min) +
                             hexVector(a.max) + hexVector(b.min) + hexVector(b.max);
                  });
    }
    return tally.figures();
}

HardCaseFigures runSilhouettes(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs input(seed);
    Tally tally;
    CsgScratch scratch;
    while (tally.figures().inputs < inputs) {
        const Ball ball{glm::vec3(input.magnitude(-3, 10) * input.direction()),
                        static_cast<float>(input.magnitude(-6, 3))};
        const glm::dvec3 d = input.direction();
        const double pass = ball.radius * (1 + input.sign() * input.magnitude(-26, -8));
        const glm::dvec3 origin = glm::dvec3(ball.centre) + pass * input.perpendicular(d) -
                                  static_cast<double>(ball.radius) * input.magnitude(0, 6) * d;
        const Ray ray{glm::vec3(origin), glm::vec3(d)};
        const QuadVector f = QuadVector(ball.centre) - QuadVector(ray.origin);
        const QuadVector direction(ray.direction);
        const Quad a = dotQuad(direction, direction);
        const Quad b = dotQuad(direction, f);
        const Quad c = dotQuad(f, f) - Quad(ball.radius) * Quad(ball.radius);
        const Quad discriminant = b * b - a * c;
        // Products of 48 bits, squared, in 113: only what is nearer to zero than that is not known.
        if (magnitudeOf(discriminant) < Quad(0x1p-90) * b * b)
            continue;
        std::vector<Quad> exact;
        if (discriminant > 0) {
            const Quad root = squareRoot(discriminant);
            exact = {(b - root) / a, (b + root) / a};
        }
        // United with itself, so that the list passes through a merge of ties.
        const Csg csg = unite(Csg::ball(ball), Csg::ball(ball));
        const CsgSolid solid(csg);
        const auto stable = solid.crossings(ray, scratch);
        tally.add(errorOfFloats(csgCrossingsNaive(csg, ray, 1e-4f), exact, stable),
                  errorOfCrossings(stable, exact), [&] {
                      return hexVector(ray.origin) + " " + hexVector(ray.direction) + " " +
                             hexVector(ball.centre) + fmt::format(" {:a}", ball.radius);
                  });
    }
    return tally.figures();
}

/// How far above the surface a ray starts, in units of |n|·(error of the point); infinite where it does not
/// start above it.
double errorOfStart(const Triangle& triangle, glm::vec3 start, glm::dvec3 side, glm::vec3 pointError) {
    const QuadVector a(triangle.a);
    const QuadVector n = crossQuad(QuadVector(triangle.b) - a, QuadVector(triangle.c) - a);
    const Quad length = lengthQuad(n);
    const Quad height = dotQuad(n, QuadVector(start) - a) / length;
    const Quad facing = dotQuad(n, QuadVector(side)) / length;
    const Quad above = facing < 0 ? -height : height;
    if (!(above > 0))
        return infinity;
    const Quad unit = (magnitudeOf(n.x) * Quad(pointError.x) + magnitudeOf(n.y) * Quad(pointError.y) +
                       magnitudeOf(n.z) * Quad(pointError.z)) /
                      length;
    return static_cast<double>(above / unit);
}

HardCaseFigures runRaysThatLeave(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs input(seed);
    Random& random = input.random();
    Tally tally;
    CsgScratch scratch;
    while (tally.figures().inputs < inputs) {
        // Up to 10⁶ from the origin, or 10⁻⁶ small.
        const double size = input.magnitude(-20, 4);
        const glm::dvec3 place = (random.below(2) == 0 ? input.magnitude(0, 20) : size) * input.direction();
        WhittedContents contents;
        contents.materials.emplace_back();
        Mesh mesh;
        for (int k = 0; k < 3; ++k)
            mesh.positions.emplace_back(place + size * input.direction());
        mesh.indices = {0, 1, 2};
        const Triangle triangle{mesh.positions[0], mesh.positions[1], mesh.positions[2]};
        const glm::dvec3 middle =
            (glm::dvec3(triangle.a) + glm::dvec3(triangle.b) + glm::dvec3(triangle.c)) / 3.0;
        contents.parts.push_back({mesh, 0});
        const WhittedScene scene(std::move(contents), Structure::bruteForce);
        const glm::dvec3 d = input.direction();
        const Ray ray{glm::vec3(middle - 4 * size * d), glm::vec3(d)};
        const auto hit = scene.nearest(ray, scratch, nullptr);
        if (!hit)
            continue;
        // Towards a lamp that grazes the surface.
        const double rise = input.sign() * input.magnitude(-24, 0);
        const glm::dvec3 leaving = glm::normalize(input.perpendicular(hit->normal) + rise * hit->normal);
        const glm::vec3 stable = leaveSurface(hit->point, hit->pointError, hit->normal, leaving);
        const glm::vec3 naive =
            leaveSurfaceNaive(hit->point, glm::vec3(hit->normal), glm::vec3(leaving), 1e-4f);
        tally.add(errorOfStart(triangle, naive, leaving, hit->pointError),
                  errorOfStart(triangle, stable, leaving, hit->pointError), [&] {
                      return hexVector(triangle.a) + hexVector(triangle.b) + hexVector(triangle.c) + " " +
                             hexVector(ray.origin) + hexVector(ray.direction);
                  });
    }
    return tally.figures();
}

HardCaseFigures runAcne(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs input(seed);
    Tally tally;
    CsgScratch scratch;
    while (tally.figures().inputs < inputs) {
        const double radius = input.magnitude(-20, 6);
        const glm::dvec3 place =
            radius * input.magnitude(-2, std::min(18.0, 20 - std::log2(radius))) * input.direction();
        const Ball ball{glm::vec3(place), static_cast<float>(radius)};
        const CsgSolid solid(Csg::ball(ball));
        const glm::dvec3 d = input.direction();
        const Ray ray{glm::vec3(glm::dvec3(ball.centre) - 4 * radius * d +
                                0.9 * radius * input.random().uniformDouble() * input.perpendicular(d)),
                      glm::vec3(d)};
        const auto hit = solid.nearest(ray, {}, scratch);
        const auto naiveT = raySphereNaive(ray, ball);
        if (!hit)
            continue;
        const glm::dvec3 toLamp =
            glm::normalize(input.perpendicular(hit->normal) + input.magnitude(-24, 0) * hit->normal);
        const glm::vec3 lamp(toLamp);
        if (glm::dot(glm::dvec3(lamp), hit->normal) <= 0)
            continue;
        const Ray shadow{leaveSurface(hit->point, hit->pointError, hit->normal, toLamp), lamp};
        // The lamp is above the tangent plane, so nothing of the ball is before it.
        const double stable = solid.occluded(shadow, {}, scratch) ? infinity : 0.0;
        double naive = infinity;
        if (naiveT) {
            const glm::vec3 point = ray.origin + *naiveT * ray.direction;
            const glm::vec3 normal = (point - ball.centre) / ball.radius;
            naive =
                raySphereNaive({leaveSurfaceNaive(point, normal, lamp, 1e-4f), lamp}, ball) ? infinity : 0.0;
        }
        tally.add(naive, stable, [&] {
            return hexVector(ball.centre) + fmt::format(" {:a} ", ball.radius) + hexVector(ray.origin) +
                   hexVector(ray.direction) + hexVector(lamp);
        });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> RayTracingLab::hardCases() {
    std::vector<HardCase> cases{
        {"CsgSolid::crossings", "boxes that share faces, of 2^-20 to 2^20", "stated errors of t", 1,
         "Roth 1982; Requicha 1980; ties by expansions (Shewchuk 1997)", runSharedFaces},
        {"CsgSolid::crossings of balls", "rays that pass at 1 ± 2^-26 … 2^-8 radii", "stated errors of t", 1,
         "Haines et al., Ray Tracing Gems, ch. 7, and expansions", runSilhouettes},
        {"leaveSurface", "surfaces 10⁶ from the origin and 10⁻⁶ small, grazing rays",
         "heights, in |n|·(error of the point)", 6, "Pharr, Jakob, Humphreys, PBRT 3.9", runRaysThatLeave},
        {"leaveSurface of balls", "lamps that graze balls up to 2^18 radii from the origin",
         "rays wrongly shadowed", 0, "Pharr, Jakob, Humphreys, PBRT 3.9", runAcne},
    };
    // What is mirrored and refracted, total reflection included.
    const std::span<const HardCase> boundaries = boundaryHardCases();
    cases.insert(cases.end(), boundaries.begin(), boundaries.end());
    return cases;
}

}  // namespace quincunx

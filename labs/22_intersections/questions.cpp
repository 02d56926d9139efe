#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "geometry/intersection_hard_cases.h"
#include "geometry/intersection_oracle.h"
#include "geometry/overlap.h"
#include "geometry/polygon_tests.h"
#include "labs/22_intersections/lab.h"
#include "labs/22_intersections/measure.h"
#include "labs/22_intersections/triangle_cases.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"

namespace quincunx {
namespace {

constexpr double halfUlp = 0.51;  // what the headers promise of t as a float

/// The hard cases of a routine: how often each form is wrong, and by how much the stable one is off.
std::vector<Measurement> measureRoutine(std::string_view routine, std::uint64_t inputs = 20'000) {
    std::vector<Measurement> figures;
    for (const HardCase& hardCase : intersectionHardCases()) {
        if (hardCase.routine != routine)
            continue;
        const HardCaseFigures found = hardCase.run(inputs, 22);
        const double share = 100.0 / static_cast<double>(found.inputs);
        figures.push_back({fmt::format("{}: float, wrong answers", hardCase.hardInput),
                           share * static_cast<double>(found.naiveFailures),
                           "%",
                           {}});
        figures.push_back({fmt::format("{}: ours, wrong answers", hardCase.hardInput),
                           share * static_cast<double>(found.stableFailures), "%", equals(0)});
        if (std::string_view(hardCase.unit) == "ulp")
            figures.push_back({fmt::format("{}: ours, t off by", hardCase.hardInput), found.stableError,
                               "ulp", atMost(halfUlp)});
    }
    return figures;
}

std::vector<Measurement> measureTriangles() {
    constexpr std::size_t count = 20'000;
    std::vector<std::vector<AimedRay>> sets;
    for (const Aim aim : aims)
        sets.push_back(aimedRays(aim, count, 79));
    std::vector<Measurement> figures;
    for (int way = 0; way < triangleWays; ++way) {
        for (std::size_t k = 0; k < sets.size(); ++k) {
            std::size_t agreeing = 0;
            for (const AimedRay& aimed : sets[k])
                agreeing += meetTriangle(way, aimed).has_value() == aimed.hits;
            const bool watertight = way + 1 == triangleWays;
            // Away from edges, float is right but for the few rays that pass one within its rounding.
            const std::optional<Bound> bound = watertight               ? std::optional(equals(100))
                                               : aims[k] == Aim::random ? std::optional(atLeast(98))
                                                                        : std::nullopt;
            figures.push_back(
                {fmt::format("{}, {}: agrees with exact arithmetic", nameOfWay(way), nameOf(aims[k])),
                 100.0 * static_cast<double>(agreeing) / count, "%", bound});
        }
        const Timing timing = timeRuns(5, [&] {
            for (const AimedRay& aimed : sets[0])
                keep(meetTriangle(way, aimed));
        });
        figures.push_back({fmt::format("{}: speed", nameOfWay(way)),
                           count / timing.medianSeconds * 1e-6,
                           "million rays/s",
                           {}});
    }
    return figures;
}

/// A convex polygon in the plane: corners of a 64th, none on a line with its neighbours.
std::vector<glm::vec2> convexPolygon(StressInputs& draw) {
    std::vector<glm::vec2> corners;
    const auto count = static_cast<int>(4 + draw.random().below(5));
    const double start = draw.random().uniform(0, 6.28);
    for (int i = 0; i < count; ++i) {
        const double angle = start + 6.283185307179586 * i / count;
        corners.emplace_back(std::round(64 * 3 * std::cos(angle)) / 64,
                             std::round(64 * 2 * std::sin(angle)) / 64);
    }
    return corners;
}

std::vector<Measurement> measurePolygons() {
    constexpr std::size_t count = 20'000;
    struct Case {
        Ray ray;
        std::vector<glm::vec3> corners;
        glm::vec2 point;
        std::vector<glm::vec2> flat;
        bool hits;
        bool inside;
    };
    std::vector<Measurement> figures;
    for (const Aim aim : {Aim::random, Aim::edge, Aim::corner}) {
        StressInputs draw(15);
        std::vector<Case> cases;
        for (std::size_t i = 0; i < count; ++i) {
            Case one{};
            one.flat = convexPolygon(draw);
            // Whole combinations of two whole vectors: flat without rounding.
            const glm::vec3 u(1, 0.25f, -0.5f);
            const glm::vec3 v(-0.125f, 0.75f, 0.5f);
            for (const glm::vec2& c : one.flat)
                one.corners.push_back(c.x * u + c.y * v);
            const std::size_t k = draw.random().below(static_cast<std::uint32_t>(one.flat.size()));
            const glm::vec2 a = one.flat[k];
            const glm::vec2 b = one.flat[(k + 1) % one.flat.size()];
            one.point = aim == Aim::random
                            ? glm::vec2(draw.random().uniform(-3.5, 3.5), draw.random().uniform(-2.5, 2.5))
                        : aim == Aim::edge ? a + static_cast<float>(draw.random().uniform(0, 1)) * (b - a)
                                           : a;
            const glm::vec3 target = one.point.x * u + one.point.y * v;
            const glm::vec3 origin = target + draw.vectorOfMagnitude(0, 6);
            one.ray = {origin, target - origin};
            one.inside = locate(one.point, one.flat) != PointLocation::outside;
            for (std::size_t t = 1; t + 1 < one.corners.size() && !one.hits; ++t)
                one.hits =
                    intersectTriangleOracle(one.ray, {one.corners[0], one.corners[t], one.corners[t + 1]})
                        .has_value();
            cases.push_back(std::move(one));
        }
        static constexpr std::array names{"crossings",    "angle sum",     "areas",
                                          "triangle fan", "Plücker in 2D", "cross products"};
        for (std::size_t way = 0; way < names.size(); ++way) {
            std::size_t agreeing = 0;
            for (const Case& one : cases)
                agreeing += insideNaive(insideMethods[way], one.point, one.flat) == one.inside;
            figures.push_back({fmt::format("point in polygon, {}, {}: agrees", nameOf(aim), names[way]),
                               100.0 * static_cast<double>(agreeing) / count, "%",
                               aim == Aim::random ? std::optional(atLeast(98)) : std::nullopt});
        }
        std::size_t naive = 0;
        std::size_t stable = 0;
        for (const Case& one : cases) {
            naive += intersectPolygonNaive(one.ray, one.corners).has_value() == one.hits;
            stable += intersectPolygon(one.ray, one.corners).has_value() == one.hits;
        }
        figures.push_back({fmt::format("ray, {}: plane, projection, crossings in float agree", nameOf(aim)),
                           100.0 * static_cast<double>(naive) / count,
                           "%",
                           {}});
        figures.push_back({fmt::format("ray, {}: ours agrees", nameOf(aim)),
                           100.0 * static_cast<double>(stable) / count, "%", equals(100)});
        const auto speed = [&](const auto& meetPolygon) {
            return count * 1e-6 / timeRuns(5, [&] {
                                      for (const Case& one : cases)
                                          keep(meetPolygon(one.ray, one.corners));
                                  }).medianSeconds;
        };
        if (aim == Aim::random) {
            figures.push_back({"ray against polygon in float: speed",
                               speed([](const Ray& r, const auto& c) { return intersectPolygonNaive(r, c); }),
                               "million rays/s",
                               {}});
            figures.push_back({"ray against polygon, ours: speed",
                               speed([](const Ray& r, const auto& c) { return intersectPolygon(r, c); }),
                               "million rays/s",
                               {}});
        }
    }
    return figures;
}

std::vector<Measurement> measureSpherePlane() {
    StressInputs draw(17);
    constexpr int count = 50'000;
    int cardUnit = 0;
    int card = 0;
    int fixed = 0;
    int ours = 0;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 n = draw.vectorOfMagnitude(-3, 3);
        const glm::vec3 unit = normalizeOr(n, glm::vec3(0, 1, 0));
        const Ball ball{draw.vectorOfMagnitude(-2, 3), static_cast<float>(draw.magnitude(-2, 2))};
        const Plane plane{n, static_cast<float>(draw.random().uniform(-4, 4))};
        const Plane unitPlane{unit, plane.offset};
        const bool exact = ballMeetsPlaneExact(ball, plane);
        card += ballMeetsPlaneNaive(ball, plane) != exact;
        cardUnit += ballMeetsPlaneNaive(ball, unitPlane) != ballMeetsPlaneExact(ball, unitPlane);
        fixed += (std::abs(glm::dot(n, ball.centre) + plane.offset) <= ball.radius * glm::length(n)) != exact;
        ours += (sideOf(ball, plane) == Side::crossing) != exact;
    }
    const double share = 100.0 / count;
    std::vector<Measurement> figures{
        {"the card's n·c + d ≤ r, normals of any length: wrong", share * card, "%", atLeast(10)},
        {"the card's, unit normals: wrong for balls behind", share * cardUnit, "%", atLeast(10)},
        {"|n·c + d| ≤ r |n| in float: wrong", share * fixed, "%", atMost(0.1)},
        {"ours: wrong", share * ours, "%", equals(0)}};
    for (Measurement& figure : measureRoutine("sphere-plane"))
        figures.push_back(std::move(figure));
    return figures;
}

struct RatioFigures {
    double naiveWrong = 0;
    double stableWrong = 0;
    double naiveUlps = 0;
    double stableUlps = 0;
};

/// Rays that pass a ball or a cylinder of radius 1 within 1.2 radii, from `distance` away.
template <typename Naive, typename Stable, typename Exact>
RatioFigures byRatio(double distance, bool inPlane, const Naive& naive, const Stable& stable,
                     const Exact& exact) {
    StressInputs draw(43);
    constexpr int count = 10'000;
    RatioFigures figures;
    for (int i = 0; i < count; ++i) {
        glm::dvec3 away = draw.direction();
        if (inPlane)
            away = glm::normalize(glm::dvec3(away.x, away.y, 0.2 * away.z));
        const glm::dvec3 aside =
            inPlane ? glm::normalize(glm::dvec3(-away.y, away.x, 0)) : draw.perpendicular(away);
        const glm::vec3 origin(distance * away);
        const glm::vec3 direction((draw.random().uniform(0, 1.2) * aside - glm::dvec3(origin)) / distance);
        const Ray ray{origin, direction};
        const std::optional<Quad> t = exact(ray);
        const auto judge = [&](const auto& got, double& wrong, double& ulps) {
            if (got.has_value() != t.has_value())
                wrong += 100.0 / count;
            else if (got)
                ulps = std::max(ulps, ulpError(static_cast<float>(*got), *t));
        };
        judge(naive(ray), figures.naiveWrong, figures.naiveUlps);
        judge(stable(ray), figures.stableWrong, figures.stableUlps);
    }
    return figures;
}

template <typename Naive, typename Stable, typename Exact>
std::vector<Measurement> measureByRatio(const std::string& what, bool inPlane, const Naive& naive,
                                        const Stable& stable, const Exact& exact) {
    std::vector<Measurement> figures;
    double first = 0;
    for (const int exponent : {2, 5, 8, 11, 14, 17}) {
        const RatioFigures found = byRatio(std::exp2(exponent), inPlane, naive, stable, exact);
        const std::string where = fmt::format("{}, {} radii away", what, 1 << exponent);
        figures.push_back({where + ": textbook, wrong hits and misses", found.naiveWrong, "%", {}});
        figures.push_back({where + ": textbook, t off by up to", found.naiveUlps, "ulp", {}});
        figures.push_back({where + ": ours, wrong hits and misses", found.stableWrong, "%", equals(0)});
        figures.push_back({where + ": ours, t off by up to", found.stableUlps, "ulp", atMost(halfUlp)});
        if (exponent == 2)
            first = found.naiveWrong;
        if (exponent == 17)
            figures.push_back({what + ": wrong answers of the textbook, far less near",
                               found.naiveWrong - first, "percentage points", atLeast(5)});
    }
    return figures;
}

std::vector<Measurement> measureRaySphere() {
    const Ball ball{{0, 0, 0}, 1};
    std::vector<Measurement> figures = measureByRatio(
        "sphere", false, [&](const Ray& ray) { return raySphereNaive(ray, ball); },
        [&](const Ray& ray) { return raySphereDistance(ray, ball); },
        [&](const Ray& ray) { return raySphereExact(ray, ball); });
    const auto t = [&](glm::vec3 o, glm::vec3 d) { return raySphereDistance({o, d}, ball).value_or(-1); };
    figures.push_back({"tangent ray from (-3, 1, 0): t", t({-3, 1, 0}, {1, 0, 0}), "", equals(3)});
    figures.push_back(
        {"from the centre, direction of length 2: t", t({0, 0, 0}, {0, 2, 0}), "", equals(0.5)});
    figures.push_back({"sphere behind the ray: t (-1: none)", t({3, 0, 0}, {1, 0, 0}), "", equals(-1)});
    figures.push_back({"from the surface outwards: t", t({1, 0, 0}, {1, 0, 0}), "", equals(0)});
    return figures;
}

std::vector<Measurement> measureRayCylinder() {
    const Cylinder cylinder{{0, 0, 0}, {0, 0, 1}, 1};
    std::vector<Measurement> figures = measureByRatio(
        "cylinder", true, [&](const Ray& ray) { return rayCylinderNaive(ray, 1); },
        [&](const Ray& ray) { return rayCylinderDistance(ray, cylinder); },
        [&](const Ray& ray) { return rayCylinderExact(ray, cylinder); });
    StressInputs draw(106);
    int naive = 0;
    int stable = 0;
    for (int i = 0; i < 10'000; ++i) {
        const Ray ray{draw.vectorOfMagnitude(-2, 2), {0, 0, static_cast<float>(draw.sign())}};
        naive += rayCylinderNaive(ray, 1).has_value();
        stable += rayCylinderDistance(ray, cylinder).has_value();
    }
    figures.push_back({"parallel to the axis: textbook reports a hit", naive / 100.0, "%", {}});
    figures.push_back({"parallel to the axis: ours reports a hit", stable / 100.0, "%", equals(0)});
    // The answer put into the surface's equation, as the card asks.
    double worst = 0;
    for (int i = 0; i < 10'000; ++i) {
        const Ray ray{draw.vectorOfMagnitude(1, 4), draw.unitVector()};
        if (const std::optional<double> t = rayCylinderDistance(ray, cylinder)) {
            const glm::dvec3 p = glm::dvec3(ray.origin) + *t * glm::dvec3(ray.direction);
            worst = std::max(worst, std::abs(p.x * p.x + p.y * p.y - 1));
        }
    }
    // t to 2^-31, t |d| below 2^6, and 2 |p|: 2^-24.
    figures.push_back({"x² + y² - r² at the point found, worst", worst, "", atMost(0x1p-24)});
    return figures;
}

std::vector<Measurement> measureBox() {
    std::vector<Measurement> figures = measureRoutine("ray-box");
    StressInputs draw(44);
    int card = 0;
    int ours = 0;
    for (int i = 0; i < 10'000; ++i) {
        // The box lies behind: the line meets it, the ray does not.
        const Bounds box{{-1, -1, -1}, {1, 1, 1}};
        const glm::vec3 origin = draw.vectorOfMagnitude(2, 5);
        const Ray ray{origin, origin - 0.5f * draw.unitVector()};
        card += rayBoxNaive(ray, box).has_value();
        ours += rayBox(ray, box).has_value();
    }
    figures.push_back({"boxes behind the ray: the card reports a hit", card / 100.0, "%", atLeast(99)});
    figures.push_back({"boxes behind the ray: ours reports a hit", ours / 100.0, "%", equals(0)});
    return figures;
}

std::vector<Measurement> measureBoxPlane() {
    StressInputs draw(107);
    constexpr std::size_t count = 20'000;
    std::vector<Bounds> boxes;
    std::vector<Plane> planes;
    std::size_t agreeing = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 low = draw.vectorOfMagnitude(-2, 3);
        boxes.push_back({low, low + glm::abs(draw.vectorOfMagnitude(-2, 2))});
        planes.push_back({glm::vec3(draw.magnitude(-3, 3) * draw.nearAxis()),
                          static_cast<float>(draw.random().uniform(-6, 6))});
        agreeing += sideOf(boxes.back(), planes.back()) == sideByEightCorners(boxes.back(), planes.back());
    }
    const auto nanoseconds = [&](const auto& side) {
        return 1e9 / count * timeRuns(9, [&] {
                                 for (std::size_t i = 0; i < count; ++i)
                                     keep(side(boxes[i], planes[i]));
                             }).medianSeconds;
    };
    const double two = nanoseconds([](const Bounds& b, const Plane& p) { return sideOf(b, p); });
    const double eight =
        nanoseconds([](const Bounds& b, const Plane& p) { return sideByEightCorners(b, p); });
    std::vector<Measurement> figures{
        {"boxes for which two corners say what eight say", static_cast<double>(agreeing), "boxes",
         equals(static_cast<double>(count))},
        {"two corners", two, "ns", {}},
        {"eight corners", eight, "ns", {}},
        {"eight corners over two", eight / two, "times", {}}};
    for (Measurement& figure : measureRoutine("box-plane"))
        figures.push_back(std::move(figure));
    return figures;
}

std::vector<Measurement> measureTetrahedron() {
    const std::array<glm::vec3, 4> corners{glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0),
                                           glm::vec3(0, 0, 1)};
    const auto side = [&](float height) {
        return static_cast<double>(static_cast<int>(sideOf(corners, Plane{{0, 0, 1}, -height})));
    };
    std::vector<Measurement> figures{
        {"plane below the tetrahedron: side", side(-0.5f), "", equals(1)},
        {"plane through it: side", side(0.5f), "", equals(0)},
        {"plane that touches its tip: side", side(1), "", equals(0)},
        {"plane an ulp above its tip: side", side(std::nextafter(1.0f, 2.0f)), "", equals(-1)}};
    for (Measurement& figure : measureRoutine("tetrahedron-plane"))
        figures.push_back(std::move(figure));
    return figures;
}

}  // namespace

std::vector<Question> IntersectionsLab::questions() {
    return {
        {15, "How can a ray be tested against a flat convex polygon?",
         "Meet the polygon's plane, drop the coordinate in which the normal is largest, and ask in two "
         "dimensions "
         "whether the point lies in the polygon: a half line from it crosses the boundary an odd number of "
         "times. "
         "An edge owns its lower end but not its upper one, or corners count twice. Rounding of the point "
         "decides "
         "near edges; looking along the ray instead, where the ray is a point, leaves only signs of "
         "determinants, "
         "and those can be exact.",
         "", [](Studio&) { return measurePolygons(); }},
        {16, "When do two spheres intersect?",
         "When their centres are no farther apart than the radii together: |c1 - c2|² ≤ (r1 + r2)², squared "
         "to "
         "spare the root. The touching case needs exact arithmetic, since rounding decides it either way.",
         "", [](Studio&) { return measureRoutine("sphere-sphere"); }},
        {17, "When do a sphere and a plane intersect?",
         "When the centre's distance from the plane is at most the radius. n·c + d is that distance only for "
         "a "
         "unit normal and only up to its sign: |n·c + d| ≤ r |n|, or (n·c + d)² ≤ r² n·n without a root.",
         "the formula needs a unit normal, and the magnitude of n·c + d: without it every sphere behind the "
         "plane "
         "counts as a hit",
         [](Studio&) { return measureSpherePlane(); }},
        {43, "How is the intersection of a ray and a sphere computed?",
         "Put o + t d into |p - c|² = r²: a quadratic in t with a = d·d, b = 2 (o - c)·d, c' = |o - c|² - "
         "r². No "
         "real root: a miss. Both roots negative: the sphere is behind. One of each sign: the origin is "
         "inside, and "
         "the larger root counts. b² - 4ac' cancels when the sphere is far or small, so take the centre's "
         "distance l from the ray instead: r² - |l|² does not, and t = b' ± √((r² - l²)/a).",
         "", [](Studio&) { return measureRaySphere(); }},
        {44, "How is a ray tested efficiently against an axis-aligned box?",
         "As three slabs. Each gives the two t at which the ray crosses its planes; the ray is inside all "
         "three "
         "from the largest of the smaller ones to the smallest of the larger ones, if that interval is not "
         "empty "
         "and does not end before 0. A ray parallel to a slab is inside it always or never.",
         "tmin < tmax loses flat boxes and touching rays (it must be ≤), and without tmax ≥ 0 boxes behind "
         "the ray "
         "are hit",
         [](Studio&) { return measureBox(); }},
        {79, "How can a ray be tested against a triangle?",
         "Either meet the plane and ask whether the point is in the triangle (crossings, angles, areas, a "
         "fan of "
         "triangles, Plücker's lines in the plane, cross products), or solve for t and the two weights at "
         "once "
         "(Möller and Trumbore), or look along the ray and take the signs of three edge functions (Woop, "
         "Benthin "
         "and Wald). All agree inside; at edges and corners only the last leaves no gap between neighbours, "
         "and "
         "only exact signs make it right.",
         "", [](Studio&) { return measureTriangles(); }},
        {80, "How is a tetrahedron tested against a plane?",
         "Put its four corners into the plane's equation. All signs equal and none zero: the plane misses "
         "it, and "
         "the sign says on which side it lies. Otherwise they intersect. Being convex, it needs nothing "
         "else; the "
         "same holds for triangles, polygons and frusta.",
         "", [](Studio&) { return measureTetrahedron(); }},
        {106, "How is the intersection of a ray and an infinite cylinder about the z axis computed?",
         "Put o + t d into x² + y² = r²: (dx² + dy²) t² + 2 (ox dx + oy dy) t + ox² + oy² - r² = 0. The "
         "smaller "
         "root is where the ray enters, the larger where it leaves; the point is o + t d. With dx = dy = 0 "
         "the ray "
         "is parallel to the axis and never meets the side. As for the sphere, r² less the squared distance "
         "of ray "
         "and axis cancels less than the discriminant.",
         "x² + y² = r² has no norm bars and r is squared", [](Studio&) { return measureRayCylinder(); }},
        {107, "Why do two corners suffice to test an axis-aligned box against a plane?",
         "n·v + d is a sum of one term an axis, so it is largest at the corner that takes max where n is "
         "positive "
         "and min where it is negative, and smallest at the opposite one. If even the largest is below 0, or "
         "even "
         "the smallest above, the box lies on one side; otherwise the plane cuts it, touching included.",
         "equal signs must not include two zeros: a box that lies in the plane has both and does intersect",
         [](Studio&) { return measureBoxPlane(); }},
    };
}

}  // namespace quincunx

#include "trace/accelerator_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "geometry/ray_shapes.h"
#include "geometry/ray_triangle.h"
#include "math/stress_inputs.h"
#include "trace/accelerator.h"
#include "trace/bsp.h"
#include "trace/grid.h"
#include "trace/slabs.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double wrongIf(bool wrong) {
    return wrong ? infinity : 0;
}

std::string hex(const Ray& ray) {
    return "o=" + hexVector(ray.origin) + " d=" + hexVector(ray.direction);
}

struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;

    TriangleView view() const { return {positions, indices}; }
    void add(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
        for (const glm::vec3& p : {a, b, c}) {
            indices.push_back(static_cast<std::uint32_t>(positions.size()));
            positions.push_back(p);
        }
    }
};

enum class SceneKind { surface, faraway, small, sizes, coincident, lattice, stadium };

glm::vec3 pointIn(StressInputs& inputs, double low, double high) {
    Random& random = inputs.random();
    return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

/// A bumpy surface of 2 · 5² triangles.
void addSurface(Soup& soup, StressInputs& inputs, glm::vec3 origin, float size) {
    constexpr int side = 5;
    std::array<std::array<glm::vec3, side + 1>, side + 1> points;
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x)
            points[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] =
                origin + size * (glm::vec3(x, y, 0) + 0.3f * pointIn(inputs, -1, 1));
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; ++x) {
            soup.add(points[y][x], points[y][x + 1], points[y + 1][x]);
            soup.add(points[y + 1][x], points[y][x + 1], points[y + 1][x + 1]);
        }
}

Soup makeSoup(SceneKind kind, StressInputs& inputs) {
    Soup soup;
    Random& random = inputs.random();
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    switch (kind) {
        case SceneKind::surface:
            addSurface(soup, inputs, glm::vec3(0), 1);
            break;
        case SceneKind::faraway:
            addSurface(soup, inputs, glm::vec3(1e6f, -1e6f, 1e6f), 1);
            break;
        case SceneKind::small:
            addSurface(soup, inputs, glm::vec3(0), 1e-6f);
            break;
        case SceneKind::sizes:
            for (int i = 0; i < 40; ++i) {
                const auto size = static_cast<float>(inputs.magnitude(-40, 105));
                soup.add(size * inputs.unitVector(), size * inputs.unitVector(), size * inputs.unitVector());
            }
            break;
        case SceneKind::coincident: {
            const std::array<glm::vec3, 4> p = {pointIn(inputs, -1, 1), pointIn(inputs, -1, 1),
                                                pointIn(inputs, -1, 1), pointIn(inputs, -1, 1)};
            for (int i = 0; i < 8; ++i) {
                soup.add(p[0], p[1], p[2]);
                soup.add(p[2], p[1], p[3]);
            }
            soup.add(p[0], p[0], p[1]);
            soup.add(p[3], p[3], p[3]);
            soup.add(p[0], p[1], glm::vec3(nan, 0, 0));
            soup.add(p[0], glm::vec3(0, inf, 0), p[1]);
            break;
        }
        case SceneKind::lattice: {
            const auto corner = [&] {
                return glm::vec3(random.below(5), random.below(5), random.below(5)) - 2.0f;
            };
            for (int i = 0; i < 60; ++i)
                soup.add(corner(), corner(), corner());
            break;
        }
        case SceneKind::stadium:
            addSurface(soup, inputs, pointIn(inputs, -100, 100), 1e-4f);
            soup.add({-1e4f, -1e4f, -10}, {1e4f, -1e4f, -10}, {0, 1e4f, -10});
            soup.add({-1e4f, -1e4f, 1e4f}, {1e4f, -1e4f, -10}, {0, 1e4f, 300});
            break;
    }
    return soup;
}

/// At corners, at edges, along the axes, in the planes of triangles, between corners; of any length.
Ray makeRay(const Soup& soup, StressInputs& inputs) {
    Random& random = inputs.random();
    const TriangleView triangles = soup.view();
    const auto corner = [&] { return soup.positions[random.below(soup.positions.size())]; };
    const Triangle triangle = triangles[random.below(triangles.size())];
    const float size = glm::length(triangle.b - triangle.a);
    Ray ray;
    ray.origin = random.below(4) == 0 ? corner() : corner() + 4 * size * inputs.unitVector();
    switch (random.below(6)) {
        case 0:
            ray.direction = corner() - ray.origin;
            break;
        case 1:
            ray.direction = glm::mix(triangle.a, triangle.b, random.uniform()) - ray.origin;
            break;
        case 2:
            ray.direction = glm::vec3(0);
            ray.direction[static_cast<int>(random.below(3))] = random.below(2) == 0 ? 1.0f : -1.0f;
            if (random.below(2) == 0)
                ray.direction[static_cast<int>(random.below(3))] *= -1.0f;  // −0 is a direction's too
            ray.origin = corner();
            ray.origin -= 3 * size * ray.direction;
            break;
        case 3:
            ray.origin = triangle.a + 2.0f * (triangle.a - triangle.b);
            ray.direction = glm::mix(triangle.b, triangle.c, 0.5f) - ray.origin;
            break;
        case 4:
            ray.direction = (triangle.a + triangle.b + triangle.c) / 3.0f - ray.origin;
            break;
        default:
            ray.direction = inputs.unitVector();
            break;
    }
    if (random.below(4) == 0)
        ray.direction *= static_cast<float>(inputs.magnitude(-90, 20));
    return ray;
}

/// The textbook's: a box for each triangle by the flashcard's slabs, then Möller and Trumbore, in float.
std::optional<double> nearestNaive(TriangleView triangles, const Ray& ray) {
    std::optional<double> nearest;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle triangle = triangles[i];
        Bounds box;
        for (const glm::vec3& p : {triangle.a, triangle.b, triangle.c})
            box.extend(p);
        if (!rayBoxNaive(ray, box))
            continue;
        const auto hit = intersectMollerTrumboreNaive(ray, triangle);
        if (hit && (!nearest || hit->t < *nearest))
            nearest = hit->t;
    }
    return nearest;
}

bool same(const std::optional<AcceleratorHit>& a, const std::optional<AcceleratorHit>& b) {
    if (!a || !b)
        return a.has_value() == b.has_value();
    return a->t == b->t && a->triangle == b->triangle && a->weights == b->weights && a->front == b->front;
}

template <SceneKind kind>
HardCaseFigures runScenes(std::uint64_t count, std::uint64_t seed) {
    constexpr std::size_t raysOfScene = 100;
    StressInputs inputs(seed);
    Tally tally;
    while (tally.figures().inputs < count) {
        const Soup soup = makeSoup(kind, inputs);
        const auto oracle = makeAccelerator(Structure::bruteForce, soup.view());
        std::vector<std::unique_ptr<Accelerator>> structures;
        for (const Structure structure : allStructures)
            if (structure != Structure::bruteForce && isAvailable(structure))
                structures.push_back(makeAccelerator(structure, soup.view()));

        const RayInterval interval = inputs.random().below(3) == 0 ? RayInterval{0.25f, 1.0f} : RayInterval{};
        std::vector<Ray> rays(std::min<std::size_t>(raysOfScene, count - tally.figures().inputs));
        for (Ray& ray : rays)
            ray = makeRay(soup, inputs);
        std::vector<std::vector<std::optional<AcceleratorHit>>> together(structures.size());
        for (std::size_t s = 0; s < structures.size(); ++s) {
            together[s].resize(rays.size());
            structures[s]->nearestOfEach(rays, interval, together[s]);
        }
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto exact = oracle->nearest(rays[i], interval);
            bool wrong = false;
            for (std::size_t s = 0; s < structures.size(); ++s)
                wrong = wrong || !same(exact, structures[s]->nearest(rays[i], interval)) ||
                        !same(exact, together[s][i]) ||
                        structures[s]->occluded(rays[i], interval) != exact.has_value();
            // The textbook's form knows no interval.
            const auto all = oracle->nearest(rays[i]);
            const auto naive = nearestNaive(soup.view(), rays[i]);
            const bool naiveWrong = all.has_value() != naive.has_value() ||
                                    (all && !(std::abs(*naive - all->t) <= 0x1p-10 * std::abs(all->t)));
            tally.add(wrongIf(naiveWrong), wrongIf(wrong), [&] { return hex(rays[i]); });
        }
    }
    return tally.figures();
}

/// Boxes, half of them flat; rays that touch corners, edges and faces, start on them, lie in them, of any
/// length.
HardCaseFigures runBoxes(std::uint64_t count, std::uint64_t seed) {
    StressInputs inputs(seed);
    Random& random = inputs.random();
    Tally tally;
    while (tally.figures().inputs < count) {
        Bounds box;
        const double size = inputs.magnitude(-20, 20);
        const double away = random.below(2) == 0 ? 0 : inputs.magnitude(0, 20) * size;
        const glm::vec3 centre(away * inputs.direction());
        box.extend(centre + static_cast<float>(size) * pointIn(inputs, -1, 1));
        box.extend(centre + static_cast<float>(size) * pointIn(inputs, -1, 1));
        const auto axis = static_cast<int>(random.below(3));
        if (random.below(2) == 0)
            box.max[axis] = box.min[axis];
        const auto place = [&] {
            glm::vec3 p;
            for (int i = 0; i < 3; ++i) {
                const auto choice = random.below(3);
                p[i] = choice == 0   ? box.min[i]
                       : choice == 1 ? box.max[i]
                                     : glm::mix(box.min[i], box.max[i], random.uniform());
            }
            return p;
        };
        Ray ray;
        ray.origin =
            random.below(2) == 0 ? place() : place() + static_cast<float>(4 * size) * inputs.unitVector();
        ray.direction = place() - ray.origin;
        if (random.below(2) == 0) {
            const auto along = static_cast<int>(random.below(3));
            ray.direction[along] = random.below(2) == 0 ? 0.0f : -0.0f;
            ray.origin[along] = place()[along];
        }
        if (random.below(2) == 0)
            ray.direction *= static_cast<float>(inputs.magnitude(-130, 60));
        if (!isUsable(ray) || !rayBox(ray, box))
            continue;
        const auto missed = [&]<typename Real>(Real) {
            Real enter = 0;
            return !SlabRay<Real>(ray).meets(box.min, box.max, 0, std::numeric_limits<Real>::infinity(),
                                             enter);
        };
        const bool wrong = missed(0.0) || (floatIsEnough(ray) && missed(0.0f));
        tally.add(wrongIf(!rayBoxNaive(ray, box)), wrongIf(wrong),
                  [&] { return hex(ray) + " min=" + hexVector(box.min) + " max=" + hexVector(box.max); });
    }
    return tally.figures();
}

/// The textbook's walk: t at the next border of each axis, summed up in float.
std::vector<glm::ivec3> cellsAlongNaive(const Grid& grid, const Ray& ray) {
    const glm::vec3 size(grid.cellSize());
    const glm::vec3 origin(ray.origin - glm::vec3(grid.origin()));
    glm::ivec3 cell(glm::floor(origin / size));
    glm::vec3 next;
    glm::vec3 delta;
    for (int axis = 0; axis < 3; ++axis) {
        const int ahead = ray.direction[axis] > 0 ? 1 : 0;
        next[axis] =
            (static_cast<float>(cell[axis] + ahead) * size[axis] - origin[axis]) / ray.direction[axis];
        delta[axis] = std::abs(size[axis] / ray.direction[axis]);
    }
    std::vector<glm::ivec3> cells;
    const glm::ivec3 last = grid.resolution() - 1;
    const auto steps = static_cast<std::size_t>(last.x + last.y + last.z + 3);
    while (cells.size() < steps && glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
           glm::all(glm::lessThanEqual(cell, last))) {
        cells.push_back(cell);
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        cell[axis] += ray.direction[axis] > 0 ? 1 : -1;
        next[axis] += delta[axis];
    }
    return cells;
}

/// Rays through a layer of 512 × 512 cells, half of them along cell borders; places along each that are
/// 10^-3 cells from all borders must be in cells that are visited.
HardCaseFigures runGridWalk(std::uint64_t count, std::uint64_t seed) {
    Soup corners;
    corners.add({0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 1e-6f});
    corners.add({1, 1e-6f, 1}, {1 - 1e-6f, 0, 1}, {1, 0, 1 - 1e-6f});
    const Grid grid(corners.view(), {.cellsPerTriangle = 0x1p17});
    StressInputs inputs(seed);
    Random& random = inputs.random();
    Tally tally;
    while (tally.figures().inputs < count) {
        const glm::dvec3 size = grid.cellSize();
        Ray ray{glm::vec3(random.uniform(0, 1), 5e-7, random.uniform(0, 1)), glm::vec3(inputs.direction())};
        ray.direction.y = 0;
        if (random.below(2) == 0) {
            const int along = random.below(2) == 0 ? 0 : 2;
            ray.direction[2 - along] = random.below(2) == 0 ? 0.0f : -0.0f;
            if (random.below(2) == 0)
                ray.origin[2 - along] = static_cast<float>(
                    grid.origin()[2 - along] + static_cast<double>(random.below(512)) * size[2 - along]);
        }
        if (ray.direction == glm::vec3(0))
            continue;
        const std::vector<glm::ivec3> stable = grid.cellsAlong(ray);
        const std::vector<glm::ivec3> naive = cellsAlongNaive(grid, ray);
        bool stableWrong = false;
        bool naiveWrong = false;
        for (int sample = 0; sample < 64; ++sample) {
            const double t = random.uniform(0, 1.5);
            const glm::dvec3 place =
                (glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction) - grid.origin()) / size;
            const glm::ivec3 cell(glm::floor(place));
            const glm::dvec3 within = place - glm::floor(place);
            if (std::min({within.x, within.z, 1 - within.x, 1 - within.z}) < 1e-3 ||
                glm::any(glm::lessThan(cell, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(cell, grid.resolution())))
                continue;
            stableWrong = stableWrong || std::find(stable.begin(), stable.end(), cell) == stable.end();
            naiveWrong = naiveWrong || std::find(naive.begin(), naive.end(), cell) == naive.end();
        }
        tally.add(wrongIf(naiveWrong), wrongIf(stableWrong), [&] { return hex(ray); });
    }
    return tally.figures();
}

/// The textbook's recursion, whose only ends are few triangles and depth: (lo + hi) / 2 of the cell, axes in
/// turn.
int depthNaive(const std::vector<Bounds>& boxes, Bounds cell, int depth) {
    constexpr int cap = 22;
    if (boxes.size() <= 2 || depth == cap)
        return depth;
    const int axis = depth % 3;
    const float plane = (cell.min[axis] + cell.max[axis]) / 2;
    std::vector<Bounds> left;
    std::vector<Bounds> right;
    for (const Bounds& box : boxes) {
        if (box.min[axis] <= plane)
            left.push_back(box);
        if (box.max[axis] >= plane)
            right.push_back(box);
    }
    Bounds lower = cell;
    Bounds upper = cell;
    lower.max[axis] = plane;
    upper.min[axis] = plane;
    // One way down is enough to know how deep it gets; the whole tree has 2^22 leaves.
    return left.size() >= right.size() ? depthNaive(left, lower, depth + 1)
                                       : depthNaive(right, upper, depth + 1);
}

/// Triangles that no plane parts: all the same, in the plane of the cut, across the whole cell, as large as
/// floats go.
HardCaseFigures runBspDepth(std::uint64_t count, std::uint64_t seed) {
    StressInputs inputs(seed);
    Random& random = inputs.random();
    Tally tally;
    while (tally.figures().inputs < count) {
        Soup soup;
        const auto triangles = 3 + random.below(40);
        const auto kind = random.below(4);
        const float size = kind == 3 ? 3e38f : 1.0f;
        Triangle triangle{pointIn(inputs, 0.1, 0.9), pointIn(inputs, 0.1, 0.9), pointIn(inputs, 0.1, 0.9)};
        if (kind == 1)
            triangle.a.x = triangle.b.x = triangle.c.x = 0.5f;
        if (kind >= 2)
            triangle = {glm::vec3(-size), glm::vec3(size, -size, size), glm::vec3(size)};
        std::vector<Bounds> boxes(triangles);
        for (Bounds& box : boxes) {
            soup.add(triangle.a, triangle.b, triangle.c);
            for (const glm::vec3& p : {triangle.a, triangle.b, triangle.c})
                box.extend(p);
        }
        const double allowed = std::log2(static_cast<double>(triangles)) + 2;
        const int stable = Bsp(soup.view()).depth();
        const Bounds cell = kind >= 2 ? boxes[0] : Bounds{glm::vec3(0), glm::vec3(1)};
        const int naive = depthNaive(boxes, cell, 0);
        tally.add(std::max(0.0, naive - allowed), std::max(0.0, stable - allowed),
                  [&] { return fmt::format("{} triangles, kind {}", triangles, kind); });
    }
    return tally.figures();
}

}  // namespace

std::span<const HardCase> acceleratorHardCases() {
    static constexpr const char* hits = "wrong hits";
    static constexpr const char* filtered = "float with a bound, exact where it is open; Ize, JCGT 2(2) 2013";
    static constexpr HardCase cases[] = {
        {"structures", "rays at corners and edges, in planes, along axes", hits, 0, filtered,
         &runScenes<SceneKind::surface>},
        {"structures", "the same, 10^6 from the origin", hits, 0, filtered, &runScenes<SceneKind::faraway>},
        {"structures", "the same, 10^-6 small", hits, 0, filtered, &runScenes<SceneKind::small>},
        {"structures", "triangles of 2^-40 … 2^105 together", hits, 0, filtered,
         &runScenes<SceneKind::sizes>},
        {"structures", "coincident, degenerate, not finite triangles", hits, 0, filtered,
         &runScenes<SceneKind::coincident>},
        {"structures", "corners on a lattice", hits, 0, filtered, &runScenes<SceneKind::lattice>},
        {"structures", "10^-4 small in 10^4 large", hits, 0, filtered, &runScenes<SceneKind::stadium>},
        {"SlabRay", "corners, faces, flat boxes, directions of ±0 and 2^-130 … 2^60", "boxes missed", 0,
         "Ize, JCGT 2(2) 2013", &runBoxes},
        {"Grid", "512 × 512 cells, along borders", "cells missed", 0, "t from the cell's number, in double",
         &runGridWalk},
        {"Bsp", "triangles that no plane parts", "levels beyond log2 n + 2", 0,
         "ends where a cut parts nothing; lo/2 + hi/2", &runBspDepth},
    };
    return cases;
}

}  // namespace quincunx

#include "geometry/triangle_hard_cases.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "geometry/polygon_tests.h"
#include "geometry/predicates.h"
#include "geometry/ray_triangle.h"
#include "math/exact_sum.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What relative errors of 2^-34 leave of half an ulp.
constexpr double halfUlp = 0.501;

std::string hex(glm::dvec2 v) {
    return fmt::format("({:a},{:a})", v.x, v.y);
}
std::string hex(glm::dvec3 v) {
    return hexVector(v);
}
std::string hex(const Ray& ray) {
    return "o=" + hex(glm::dvec3(ray.origin)) + " d=" + hex(glm::dvec3(ray.direction));
}
std::string hex(const Triangle& triangle) {
    return "a=" + hex(glm::dvec3(triangle.a)) + " b=" + hex(glm::dvec3(triangle.b)) +
           " c=" + hex(glm::dvec3(triangle.c));
}

/// The error of a decision: none, or a failure.
double wrongIf(bool wrong) {
    return wrong ? infinity : 0;
}

int signOf(double x) {
    return (x > 0) - (x < 0);
}

// Oracles: determinants multiplied out, as long sums.

int exactSign(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    ExactSum sum;
    const std::array<glm::dvec2, 3> points = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 p = points[i];
        const glm::dvec2 q = points[(i + 1) % 3];
        sum.add({p.x, q.y});
        sum.subtract({p.y, q.x});
    }
    return sum.sign();
}

/// Of ((b − a) × (c − a)) · (w d − a'): d a point (w = 1) or, without the last term, a direction (w = 0).
int exactSign(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d, bool isPoint) {
    ExactSum sum;
    const auto addTriple = [&sum](glm::dvec3 p, glm::dvec3 q, glm::dvec3 r, double sign) {
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const int k = (i + 2) % 3;
            sum.add({sign * p[i], q[j], r[k]});
            sum.subtract({sign * p[i], q[k], r[j]});
        }
    };
    addTriple(d, a, b, 1);
    addTriple(d, b, c, 1);
    addTriple(d, c, a, 1);
    if (isPoint)
        addTriple(a, b, c, -1);
    return sum.sign();
}

/// In the polygon, points on edges given to the cell on their right or above.
bool exactlyOwns(std::span<const glm::vec2> polygon, glm::vec2 point) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec2 a = polygon[i];
        const glm::vec2 b = polygon[(i + 1) % polygon.size()];
        if ((a.y > point.y) == (b.y > point.y))
            continue;
        inside ^= exactSign(glm::dvec2(a), glm::dvec2(b), glm::dvec2(point)) == (b.y > point.y ? 1 : -1);
    }
    return inside;
}

bool exactlyOnBoundary(std::span<const glm::vec2> polygon, glm::vec2 point) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec2 a = polygon[i];
        const glm::vec2 b = polygon[(i + 1) % polygon.size()];
        const glm::vec2 low = glm::min(a, b);
        const glm::vec2 high = glm::max(a, b);
        if (low.x <= point.x && point.x <= high.x && low.y <= point.y && point.y <= high.y &&
            exactSign(glm::dvec2(a), glm::dvec2(b), glm::dvec2(point)) == 0)
            return true;
    }
    return false;
}

PointLocation exactLocation(std::span<const glm::vec2> polygon, glm::vec2 point) {
    if (exactlyOnBoundary(polygon, point))
        return PointLocation::boundary;
    return exactlyOwns(polygon, point) ? PointLocation::inside : PointLocation::outside;
}

// Orientations.

template <typename V>
HardCaseFigures runOrientation2D(std::uint64_t inputs, std::uint64_t seed) {
    using Float = typename V::value_type;
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        V a(12, 12);
        V b(24, 24);
        V c;
        if (i % 2 == 0) {
            // Neighbours of (½, ½), Kettner et al. 2008.
            const Float ulp = std::numeric_limits<Float>::epsilon() / 2;
            c = V(Float(0.5) + static_cast<Float>(draw.random().below(256)) * ulp,
                  Float(0.5) + static_cast<Float>(draw.random().below(256)) * ulp);
        } else {
            const double scale = draw.magnitude(-100, 100);
            const auto point = [&] {
                return scale * glm::dvec2(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1));
            };
            a = V(point());
            b = V(point());
            c = V(glm::mix(glm::dvec2(a), glm::dvec2(b), draw.random().uniform(-2, 3)));
        }
        const int exact = exactSign(glm::dvec2(a), glm::dvec2(b), glm::dvec2(c));
        const bool consistent = orientation(b, c, a) == exact && orientation(b, a, c) == -exact;
        tally.add(wrongIf(signOf(orientationNaive(a, b, c)) != exact),
                  wrongIf(orientation(a, b, c) != exact || !consistent), [&] {
                      return "a=" + hex(glm::dvec2(a)) + " b=" + hex(glm::dvec2(b)) +
                             " c=" + hex(glm::dvec2(c));
                  });
    }
    return tally.figures();
}

template <typename V>
HardCaseFigures runOrientation3D(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double scale = draw.magnitude(-40, 40);
        const V a(scale * draw.direction());
        const V b(scale * draw.direction());
        const V c(scale * draw.direction());
        const glm::dvec3 origin(a);
        const V d(origin + draw.random().uniform(-1, 2) * (glm::dvec3(b) - origin) +
                  draw.random().uniform(-1, 2) * (glm::dvec3(c) - origin));
        const int exact = exactSign(glm::dvec3(a), glm::dvec3(b), glm::dvec3(c), glm::dvec3(d), true);
        const bool consistent = orientation(b, c, a, d) == exact && orientation(a, c, b, d) == -exact;
        tally.add(wrongIf(signOf(orientationNaive(a, b, c, d)) != exact),
                  wrongIf(orientation(a, b, c, d) != exact || !consistent), [&] {
                      return "a=" + hex(glm::dvec3(a)) + " b=" + hex(glm::dvec3(b)) +
                             " c=" + hex(glm::dvec3(c)) + " d=" + hex(glm::dvec3(d));
                  });
    }
    return tally.figures();
}

HardCaseFigures runFacing(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // The view runs within 2^-30 … 2^-4 radians of the plane, or is a rounded direction in it.
        const Triangle t{draw.vectorOfMagnitude(-2, 2), draw.vectorOfMagnitude(-2, 2),
                         draw.vectorOfMagnitude(-2, 2)};
        const glm::dvec3 e1 = glm::dvec3(t.b) - glm::dvec3(t.a);
        const glm::dvec3 e2 = glm::dvec3(t.c) - glm::dvec3(t.a);
        const double lift = i % 2 == 0 ? 0 : draw.sign() * draw.magnitude(-30, -4);
        const glm::vec3 view(draw.random().uniform(-4, 4) * e1 + draw.random().uniform(-4, 4) * e2 +
                             lift * glm::cross(e1, e2));
        const int exact =
            -exactSign(glm::dvec3(t.a), glm::dvec3(t.b), glm::dvec3(t.c), glm::dvec3(view), false);
        tally.add(wrongIf(static_cast<int>(facingAlongNaive(t.a, t.b, t.c, view)) != exact),
                  wrongIf(static_cast<int>(facingAlong(t.a, t.b, t.c, view)) != exact),
                  [&] { return hex(t) + " view=" + hex(glm::dvec3(view)); });
    }
    return tally.figures();
}

// Points in polygons.

/// A convex polygon: corners on a circle, in order, at any scale.
std::vector<glm::vec2> convexPolygon(StressInputs& draw, double scale) {
    std::vector<glm::vec2> polygon;
    do {
        polygon.clear();
        double angle = 0;
        const auto corners = static_cast<double>(3 + draw.random().below(6));
        for (double k = 0; k < corners; ++k) {
            angle = 2 * 3.141592653589793 * (k + draw.random().uniform(0, 0.9)) / corners;
            polygon.emplace_back(scale * std::cos(angle), scale * std::sin(angle));
        }
    } while (!isConvex(polygon));
    return polygon;
}

/// A point on or beside an edge, up to rounding, or a corner.
glm::vec2 besideEdge(StressInputs& draw, std::span<const glm::vec2> polygon) {
    const std::size_t i = draw.random().below(polygon.size());
    const glm::dvec2 a(polygon[i]);
    const glm::dvec2 b(polygon[(i + 1) % polygon.size()]);
    if (draw.random().below(8) == 0)
        return glm::vec2(a);
    return glm::vec2(glm::mix(a, b, draw.random().uniform(0, 1)));
}

std::string hex(std::span<const glm::vec2> polygon, glm::vec2 point) {
    std::string text = "p=" + hex(glm::dvec2(point)) + " polygon=";
    for (const glm::vec2 corner : polygon)
        text += hex(glm::dvec2(corner));
    return text;
}

/// A naive way may say what it likes of the boundary; of the rest, and the stable one of all, must be right.
template <InsideMethod Method>
HardCaseFigures runConvex(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto polygon = convexPolygon(draw, draw.magnitude(-20, 20));
        const glm::vec2 point = besideEdge(draw, polygon);
        const PointLocation exact = exactLocation(polygon, point);
        const bool naive = insideNaive(Method, point, polygon);
        bool stableIsRight = locate(point, polygon) == exact;
        if constexpr (Method == InsideMethod::angleSum) {
            const auto turns = windingNumber(point, polygon);
            stableIsRight = turns.has_value() == (exact != PointLocation::boundary) &&
                            (!turns || (*turns == 1) == (exact == PointLocation::inside));
        } else if constexpr (Method == InsideMethod::triangleFan) {
            stableIsRight = locateByTriangleFan(point, polygon) == exact;
        } else if constexpr (Method != InsideMethod::crossings) {
            stableIsRight = locateInConvex(point, polygon) == exact;
        }
        tally.add(wrongIf(exact != PointLocation::boundary && naive != (exact == PointLocation::inside)),
                  wrongIf(!stableIsRight), [&] { return hex(polygon, point); });
    }
    return tally.figures();
}

HardCaseFigures runScanline(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // Corners on a grid, so that the half line runs through corners and along edges; chains that cross
        // and touch themselves.
        std::vector<glm::vec2> polygon;
        const auto coordinate = [&] { return static_cast<float>(draw.random().below(13)) - 6; };
        for (std::uint64_t n = 3 + draw.random().below(8); n > 0; --n)
            polygon.emplace_back(coordinate(), coordinate());
        const glm::vec2 point(coordinate(), coordinate());
        const PointLocation exact = exactLocation(polygon, point);
        const bool naive = insideByCrossingsNaive(point, polygon);
        tally.add(wrongIf(exact != PointLocation::boundary && naive != (exact == PointLocation::inside)),
                  wrongIf(locate(point, polygon) != exact ||
                          containsHalfOpen(point, polygon) != exactlyOwns(polygon, point)),
                  [&] { return hex(polygon, point); });
    }
    return tally.figures();
}

HardCaseFigures runPartition(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // A square cut into four triangles at an inner point: how many own a point on a cut?
        const auto size = static_cast<float>(draw.magnitude(-60, 60));
        const std::array<glm::vec2, 4> square = {glm::vec2(0), glm::vec2(size, 0), glm::vec2(size, size),
                                                 glm::vec2(0, size)};
        const glm::vec2 centre(size * static_cast<float>(draw.random().uniform(0.1, 0.9)),
                               size * static_cast<float>(draw.random().uniform(0.1, 0.9)));
        const glm::dvec2 corner(square[draw.random().below(4)]);
        const glm::vec2 point(glm::mix(glm::dvec2(centre), corner, draw.random().uniform(0, 0.999)));
        int naive = 0;
        int stable = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::array cell = {square[k], square[(k + 1) % 4], centre};
            naive += insideByCrossingsNaive(point, cell) ? 1 : 0;
            stable += containsHalfOpen(point, cell) ? 1 : 0;
        }
        tally.add(wrongIf(naive != 1), wrongIf(stable != 1),
                  [&] { return hex(square, point) + " centre=" + hex(glm::dvec2(centre)); });
    }
    return tally.figures();
}

// Gaps.

/// A height field of 8 × 8 cells around the corner (4, 4), cut along one diagonal or the other.
class HeightField {
  public:
    struct Kind {
        glm::dvec3 cell{1};     ///< the unit of width, depth and height
        glm::dvec3 offset{0};   ///< of the field in the world
        double distance = 100;  ///< of the rays' origins, about
        double jitter = 0.3;    ///< of corners, heights too, in cells
    };

    HeightField(StressInputs& draw, const Kind& kind) : kind_(kind) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const glm::dvec3 shift(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1),
                                       draw.random().uniform(-1, 1));
                corners_[index(x, y)] =
                    glm::vec3(kind.offset + kind.cell * (glm::dvec3(x, y, 0) + kind.jitter * shift));
            }
        falling_ = draw.random().bits();
    }

    glm::vec3 corner(int x, int y) const { return corners_[index(x, y)]; }

    /// Calls `test(triangle)` for those within two cells of the corner (4, 4); whether one returns true.
    template <typename Test>
    bool any(const Test& test) const {
        for (int y = 2; y < 6; ++y)
            for (int x = 2; x < 6; ++x) {
                const glm::vec3 a = corner(x, y);
                const glm::vec3 b = corner(x + 1, y);
                const glm::vec3 c = corner(x + 1, y + 1);
                const glm::vec3 d = corner(x, y + 1);
                const bool falling = (falling_ >> (8 * y + x) & 1) != 0;
                if (falling ? test(Triangle{a, b, d}) || test(Triangle{b, c, d})
                            : test(Triangle{a, b, c}) || test(Triangle{a, c, d}))
                    return true;
            }
        return false;
    }

    /// A ray at a target on the field from above, less than 25° from the vertical (in cells, so that the
    /// slopes of the field, below 45°, turn no triangle away).
    Ray rayAt(StressInputs& draw, glm::dvec3 target) const {
        const double reach = kind_.distance * draw.random().uniform(0.5, 1.5);
        const double angle = draw.random().uniform(0, 6.283185307179586);
        const double lean = draw.random().uniform(0, 0.4) * reach;
        const glm::vec3 origin(target + glm::dvec3(lean * std::cos(angle) * kind_.cell.x / kind_.cell.z,
                                                   lean * std::sin(angle) * kind_.cell.y / kind_.cell.z,
                                                   reach));
        return {origin, glm::vec3(target - glm::dvec3(origin))};
    }

  private:
    static constexpr int side = 9;
    static std::size_t index(int x, int y) { return static_cast<std::size_t>(side * y + x); }

    Kind kind_;
    std::array<glm::vec3, 81> corners_;
    std::uint64_t falling_ = 0;
};

/// Every input is two rays, at a corner and at an edge that triangles share: neither may pass.
template <typename Naive>
HardCaseFigures runGaps(const HeightField::Kind& kind, const Naive& naive, std::uint64_t inputs,
                        std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    std::optional<HeightField> field;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        if (i % 16 == 0)
            field.emplace(draw, kind);
        const glm::dvec3 centre(field->corner(4, 4));
        const glm::dvec3 along = glm::mix(
            centre, glm::dvec3(draw.random().below(2) == 0 ? field->corner(5, 4) : field->corner(4, 3)),
            draw.random().uniform(0, 1));
        const std::array<Ray, 2> rays = {field->rayAt(draw, centre), field->rayAt(draw, along)};
        bool naiveLeaks = false;
        bool stableLeaks = false;
        for (const Ray& ray : rays) {
            naiveLeaks |= !field->any([&](const Triangle& t) { return naive(ray, t).has_value(); });
            const ShearedRay sheared(ray);
            stableLeaks |= !field->any([&](const Triangle& t) { return sheared.intersect(t).has_value(); });
        }
        tally.add(wrongIf(naiveLeaks), wrongIf(stableLeaks),
                  [&] { return hex(rays[0]) + " " + hex(rays[1]); });
    }
    return tally.figures();
}

constexpr HeightField::Kind jittered{};
constexpr HeightField::Kind needles{
    .cell = {1, 1e-4, 0.5}, .offset = glm::dvec3(0), .distance = 50, .jitter = 0.3};
constexpr HeightField::Kind faraway{
    .cell = glm::dvec3(1), .offset = glm::dvec3(1e5), .distance = 100, .jitter = 0.3};
constexpr HeightField::Kind flat{
    .cell = glm::dvec3(1), .offset = glm::dvec3(0), .distance = 100, .jitter = 0};
constexpr HeightField::Kind small{
    .cell = glm::dvec3(0x1p-12), .offset = glm::dvec3(0), .distance = 10, .jitter = 0.3};
constexpr HeightField::Kind least{
    .cell = glm::dvec3(0x1p-120), .offset = glm::dvec3(0), .distance = 0x1p-113, .jitter = 0.3};
constexpr HeightField::Kind vast{
    .cell = glm::dvec3(0x1p100), .offset = glm::dvec3(0), .distance = 0x1p107, .jitter = 0.3};

template <const HeightField::Kind& kind>
HardCaseFigures runMollerTrumboreGaps(std::uint64_t inputs, std::uint64_t seed) {
    return runGaps(kind, intersectMollerTrumboreNaive, inputs, seed);
}

template <InsideMethod Method>
HardCaseFigures runPlaneGaps(std::uint64_t inputs, std::uint64_t seed) {
    return runGaps(
        jittered, [](const Ray& ray, const Triangle& t) { return intersectPlaneNaive(ray, t, Method); },
        inputs, seed);
}

HardCaseFigures runPlueckerGaps(std::uint64_t inputs, std::uint64_t seed) {
    return runGaps(jittered, intersectPlueckerNaive, inputs, seed);
}

// Where.

/// ulp of a float t; a hit that is none, or the other way round, is a failure.
double tError(const std::optional<TriangleHit>& hit, const std::optional<TriangleHit>& exact) {
    if (hit.has_value() != exact.has_value())
        return infinity;
    return hit ? ulpError(static_cast<float>(hit->t), Quad(exact->t)) : 0;
}

template <typename Naive, typename Draw>
HardCaseFigures runHits(std::uint64_t inputs, const Naive& naive, const Draw& next) {
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto [ray, triangle] = next(i);
        const auto exact = intersectTriangleOracle(ray, triangle);
        tally.add(tError(naive(ray, triangle), exact), tError(intersectTriangle(ray, triangle), exact),
                  [&, &r = ray, &t = triangle] { return hex(r) + " " + hex(t); });
    }
    return tally.figures();
}

struct RayAndTriangle {
    Ray ray;
    Triangle triangle;
};

/// A fair triangle of a size, at a place, met inside by a ray from around the origin.
RayAndTriangle aimedInside(StressInputs& draw, double size, double distance) {
    for (;;) {
        const glm::dvec3 centre = distance * draw.direction();
        const glm::dvec3 x = draw.direction();
        const glm::dvec3 y = draw.perpendicular(x);
        const Triangle triangle{glm::vec3(centre + size * x), glm::vec3(centre + size * (y - 0.5 * x)),
                                glm::vec3(centre - size * (y + 0.5 * x))};
        const glm::vec3 origin(centre + distance * draw.direction());
        const Ray ray{origin, glm::vec3(centre - glm::dvec3(origin))};
        const double cosine = glm::dot(glm::cross(x, y), glm::normalize(centre - glm::dvec3(origin)));
        if (std::abs(cosine) > 0.1)
            return {ray, triangle};
    }
}

template <int Low, int High, bool Woop>
HardCaseFigures runScales(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runHits(inputs, Woop ? intersectWoopNaive : intersectMollerTrumboreNaive, [&](std::uint64_t) {
        const double size = draw.magnitude(Low, High);
        return aimedInside(draw, size, size * draw.magnitude(0, 10));
    });
}

HardCaseFigures runGrazing(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runHits(inputs, intersectMollerTrumboreNaive, [&](std::uint64_t) {
        const glm::dvec3 x = draw.direction();
        const glm::dvec3 y = draw.perpendicular(x);
        const glm::dvec3 centre = draw.magnitude(0, 4) * draw.direction();
        const Triangle triangle{glm::vec3(centre + x), glm::vec3(centre + y - 0.5 * x),
                                glm::vec3(centre - y - 0.5 * x)};
        const double angle = draw.sign() * draw.magnitude(-20, -4);
        const double turn = draw.random().uniform(0, 6.283185307179586);
        const glm::dvec3 along = std::cos(turn) * x + std::sin(turn) * y + std::tan(angle) * glm::cross(x, y);
        const glm::vec3 origin(centre - draw.magnitude(0, 6) * along);
        return RayAndTriangle{{origin, glm::vec3(centre - glm::dvec3(origin))}, triangle};
    });
}

HardCaseFigures runNeedles(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runHits(inputs, intersectMollerTrumboreNaive, [&](std::uint64_t) {
        const glm::dvec3 x = draw.direction();
        const glm::dvec3 y = draw.magnitude(-24, -4) * draw.perpendicular(x);
        const glm::dvec3 a = draw.magnitude(0, 4) * draw.direction();
        const Triangle triangle{glm::vec3(a), glm::vec3(a + x),
                                glm::vec3(a + draw.random().uniform(0, 1) * x + y)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-2, 6);
        const double s = draw.random().uniform(0, 1);
        const glm::dvec3 target =
            glm::mix(glm::dvec3(triangle.a), glm::mix(glm::dvec3(triangle.b), glm::dvec3(triangle.c), s),
                     draw.random().uniform(0, 1));
        return RayAndTriangle{{origin, glm::vec3(target - glm::dvec3(origin))}, triangle};
    });
}

HardCaseFigures runDirections(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runHits(inputs, intersectMollerTrumboreNaive, [&](std::uint64_t) {
        RayAndTriangle one = aimedInside(draw, draw.magnitude(-4, 4), draw.magnitude(-4, 8));
        one.ray.direction =
            glm::vec3(draw.magnitude(-110, 110) * glm::normalize(glm::dvec3(one.ray.direction)));
        return one;
    });
}

/// Triangles on an integer grid, with rays at their corners and edges, in their planes, and beside; some
/// without area: hit or not is all that counts.
HardCaseFigures runDecisions(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto grid = [&] {
            const auto even = [&] { return 2 * static_cast<float>(draw.random().below(4096)); };
            return glm::vec3(even(), even(), even());
        };
        Triangle triangle{grid(), grid(), grid()};
        if (i % 8 == 0)
            triangle.c = triangle.a + 0.5f * (triangle.b - triangle.a);
        const glm::vec3 middle = 0.5f * (triangle.b + triangle.c);
        // From a grid point, from the other side of an edge in the plane, or from a corner.
        const std::array<glm::vec3, 3> origins = {grid(), middle + (middle - triangle.a), triangle.b};
        const std::array<glm::vec3, 4> targets = {triangle.b, middle, triangle.a, grid()};
        const glm::vec3 origin = origins[i % 8 < 6 ? 0 : i % 8 - 5];
        const Ray ray{origin, targets[draw.random().below(4)] - origin};
        const auto exact = intersectTriangleOracle(ray, triangle);
        tally.add(wrongIf(intersectMollerTrumboreNaive(ray, triangle).has_value() != exact.has_value()),
                  wrongIf(intersectTriangle(ray, triangle).has_value() != exact.has_value()),
                  [&] { return hex(ray) + " " + hex(triangle); });
    }
    return tally.figures();
}

/// The packed form of many rays: where it hits, and t relative.
HardCaseFigures runPacked(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    constexpr std::uint64_t raysOfOne = 64;
    std::array<float, raysOfOne> naive{};
    std::array<float, raysOfOne> stable{};
    for (std::uint64_t i = 0; i < inputs; i += raysOfOne) {
        const double scale = draw.magnitude(-60, 30);
        const Triangle triangle{glm::vec3(scale * draw.direction()), glm::vec3(scale * draw.direction()),
                                glm::vec3(scale * draw.direction())};
        RayArrays rays;
        for (std::uint64_t k = 0; k < raysOfOne; ++k) {
            const glm::vec3 origin(scale * draw.magnitude(0, 8) * draw.direction());
            // At an edge, or anywhere near.
            const glm::dvec3 edge =
                glm::mix(glm::dvec3(triangle.b), glm::dvec3(triangle.c), draw.random().uniform(0, 1));
            const glm::dvec3 target =
                k % 2 == 0 ? edge : glm::mix(glm::dvec3(triangle.a), edge, draw.random().uniform(0, 1.5));
            rays.add({origin, glm::vec3(target - glm::dvec3(origin))});
        }
        intersectMollerTrumborePackedNaive(rays, triangle, naive);
        intersectPacked(rays, triangle, stable);
        for (std::uint64_t k = 0; k < raysOfOne && i + k < inputs; ++k) {
            const Ray ray = rays.at(k);
            const auto exact = intersectTriangleOracle(ray, triangle);
            const auto error = [&](float t) {
                if (std::isfinite(t) != exact.has_value())
                    return infinity;
                return exact ? std::abs(t - exact->t) / exact->t : 0;
            };
            tally.add(error(naive[k]), error(stable[k]), [&] { return hex(ray) + " " + hex(triangle); });
        }
    }
    return tally.figures();
}

// Polygons and quadrilaterals in space.

HardCaseFigures runRayPolygon(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // Grid polygons in the plane of two integer vectors, exactly flat, and rays at points of the grid.
        const auto integer = [&](std::uint64_t reach) {
            return static_cast<float>(draw.random().below(2 * reach + 1)) - static_cast<float>(reach);
        };
        glm::vec3 u(0);
        glm::vec3 v(0);
        glm::vec3 offset(0);
        while (glm::dot(offset, glm::cross(u, v)) == 0) {
            u = {integer(3), integer(3), integer(3)};
            v = {integer(3), integer(3), integer(3)};
            offset = {integer(20), integer(20), integer(20)};
        }
        const auto scale = static_cast<float>(std::exp2(std::floor(draw.random().uniform(-60, 60))));
        const glm::vec3 corner(integer(50), integer(50), integer(50));
        std::vector<glm::vec2> coordinates;
        std::vector<glm::vec3> polygon;
        bool hasArea = false;
        while (!hasArea) {
            coordinates.clear();
            polygon.clear();
            for (std::uint64_t n = 3 + draw.random().below(5); n > 0; --n) {
                coordinates.emplace_back(integer(3), integer(3));
                polygon.push_back(scale * (corner + coordinates.back().x * u + coordinates.back().y * v));
            }
            for (std::size_t k = 2; k < coordinates.size(); ++k)
                hasArea |= orientation(coordinates[0], coordinates[k - 1], coordinates[k]) != 0;
        }
        const glm::vec2 at(integer(3), integer(3));
        const glm::vec3 target = scale * (corner + at.x * u + at.y * v);
        const Ray ray{target + scale * offset, -scale * offset};
        const PointLocation exact = exactLocation(coordinates, at);
        const auto hit = intersectPolygon(ray, polygon);
        const auto naive = intersectPolygonNaive(ray, polygon);
        const bool stableIsRight = hit.has_value() == (exact != PointLocation::outside) &&
                                   (!hit || hit->boundary == (exact == PointLocation::boundary));
        // t is 1.
        tally.add(naive.has_value() == (exact == PointLocation::inside) || exact == PointLocation::boundary
                      ? (naive ? ulpError(static_cast<float>(naive->t), Quad(1)) : 0)
                      : infinity,
                  stableIsRight ? (hit ? ulpError(static_cast<float>(hit->t), Quad(1)) : 0) : infinity,
                  [&] { return hex(ray) + " " + hex(coordinates, at); });
    }
    return tally.figures();
}

HardCaseFigures runQuadDirections(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const Parallelogram quad{draw.vectorOfMagnitude(-2, 2), draw.unitVector(), draw.unitVector()};
        const glm::dvec3 target = glm::dvec3(quad.corner) +
                                  draw.random().uniform(0.05, 0.95) * glm::dvec3(quad.u) +
                                  draw.random().uniform(0.05, 0.95) * glm::dvec3(quad.v);
        const glm::vec3 origin(target + draw.magnitude(-2, 4) * draw.direction());
        const Ray ray{origin, glm::vec3(draw.magnitude(-60, 10) * (target - glm::dvec3(origin)))};
        // t = ((corner − origin) · n) / (d · n), n = u × v; both sums are long.
        ExactSum slope;
        ExactSum height;
        for (int axis = 0; axis < 3; ++axis) {
            const int j = (axis + 1) % 3;
            const int k = (axis + 2) % 3;
            const auto add = [&](ExactSum& sum, double factor) {
                sum.add({factor, quad.u[j], quad.v[k]});
                sum.subtract({factor, quad.u[k], quad.v[j]});
            };
            add(slope, ray.direction[axis]);
            add(height, quad.corner[axis]);
            add(height, -static_cast<double>(origin[axis]));
        }
        const ExactSum::Scaled s = slope.scaled();
        const ExactSum::Scaled h = height.scaled();
        const double t = std::scalbn(h.mantissa / s.mantissa, h.exponent - s.exponent);
        const auto error = [&](const std::optional<ParallelogramHit>& hit) {
            return hit ? ulpError(static_cast<float>(hit->t), Quad(t)) : infinity;
        };
        tally.add(error(intersectParallelogramNaive(ray, quad)), error(intersectParallelogram(ray, quad)),
                  [&] {
                      return hex(ray) + " q=" + hex(glm::dvec3(quad.corner)) +
                             " u=" + hex(glm::dvec3(quad.u)) + " v=" + hex(glm::dvec3(quad.v));
                  });
    }
    return tally.figures();
}

HardCaseFigures runQuadGaps(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // Corners of few bits, so that the edge of two is the same. Sides lean so little that both face up.
        const auto few = [&](double reach) {
            return static_cast<float>(std::floor(draw.random().uniform(-reach, reach) * 0x1p10)) * 0x1p-10f;
        };
        const Parallelogram left{{few(100), few(100), few(100)},
                                 {1 + few(0.3), few(0.3), few(0.3)},
                                 {few(0.3), 1 + few(0.3), few(0.3)}};
        const Parallelogram right{left.corner + left.u, {1 + few(0.3), few(0.3), few(0.3)}, left.v};
        const glm::dvec3 target =
            glm::dvec3(right.corner) + draw.random().uniform(0.01, 0.99) * glm::dvec3(left.v);
        const glm::vec3 origin(target + glm::dvec3(few(1), few(1), 10));
        const Ray ray{origin, glm::vec3(target - glm::dvec3(origin))};
        tally.add(
            wrongIf(!intersectParallelogramNaive(ray, left) && !intersectParallelogramNaive(ray, right)),
            wrongIf(!intersectParallelogram(ray, left) && !intersectParallelogram(ray, right)), [&] {
                return hex(ray) + " q=" + hex(glm::dvec3(left.corner)) + " u=" + hex(glm::dvec3(left.u)) +
                       " v=" + hex(glm::dvec3(left.v)) + " right u=" + hex(glm::dvec3(right.u));
            });
    }
    return tally.figures();
}

}  // namespace

std::span<const HardCase> triangleHardCases() {
    constexpr const char* decisions = "wrong decisions";
    constexpr const char* gaps = "gaps";
    constexpr const char* shewchuk = "filter, exact sums; Shewchuk 1997";
    constexpr const char* watertight = "shear, edge functions, exact signs; Woop, Benthin, Wald 2013";
    static constexpr HardCase cases[] = {
        {"orientation", "2D, float: neighbours of (½, ½) by a line; near lines", decisions, 0, shewchuk,
         &runOrientation2D<glm::vec2>},
        {"orientation (double)", "2D: neighbours of (½, ½) by a line; near lines", decisions, 0, shewchuk,
         &runOrientation2D<glm::dvec2>},
        {"orientation 3D", "float: fourth point on the plane but for rounding", decisions, 0, shewchuk,
         &runOrientation3D<glm::vec3>},
        {"orientation 3D (double)", "fourth point on the plane but for rounding", decisions, 0, shewchuk,
         &runOrientation3D<glm::dvec3>},
        {"facingAlong", "views in the triangle's plane, and 2^-30 … 2^-4 rad off", decisions, 0, shewchuk,
         &runFacing},
        {"locate", "half lines through corners and along edges, chains that cross", decisions, 0,
         "half-open crossings, exact signs; Shimrat 1962", &runScanline},
        {"locate", "points on edges of convex polygons", decisions, 0,
         "half-open crossings, exact signs; Shimrat 1962", &runConvex<InsideMethod::crossings>},
        {"containsHalfOpen", "points on the cuts of a square", decisions, 0,
         "half-open crossings, exact signs", &runPartition},
        {"windingNumber", "angle sum: points on edges of convex polygons", decisions, 0,
         "signed crossings, exact signs", &runConvex<InsideMethod::angleSum>},
        {"locateInConvex", "sum of areas: points on edges", decisions, 0, "exact signs of the areas",
         &runConvex<InsideMethod::areas>},
        {"locateByTriangleFan", "triangle fan: points on edges", decisions, 0, "half-open triangles",
         &runConvex<InsideMethod::triangleFan>},
        {"locateInConvex", "Plücker's lines: points on edges", decisions, 0, "exact signs of the sides",
         &runConvex<InsideMethod::pluecker>},
        {"locateInConvex", "cross products: points on edges", decisions, 0, "exact signs of the sides",
         &runConvex<InsideMethod::crossProducts>},
        {"intersectTriangle", "shared corners and edges, cells of 1", gaps, 0, watertight,
         &runMollerTrumboreGaps<jittered>},
        {"intersectTriangle", "shared corners and edges, needles of 1 × 1e-4", gaps, 0, watertight,
         &runMollerTrumboreGaps<needles>},
        {"intersectTriangle", "shared corners and edges, cells of 1 at 1e5", gaps, 0, watertight,
         &runMollerTrumboreGaps<faraway>},
        {"intersectTriangle", "shared corners and edges, flat grid", gaps, 0, watertight,
         &runMollerTrumboreGaps<flat>},
        {"intersectTriangle", "shared corners and edges, cells of 2^-12 from 10 away", gaps, 0, watertight,
         &runMollerTrumboreGaps<small>},
        {"intersectTriangle", "shared corners and edges, cells of 2^-120", gaps, 0, watertight,
         &runMollerTrumboreGaps<least>},
        {"intersectTriangle", "shared corners and edges, cells of 2^100", gaps, 0, watertight,
         &runMollerTrumboreGaps<vast>},
        {"intersectTriangle", "shared corners and edges, against plane and crossings", gaps, 0, watertight,
         &runPlaneGaps<InsideMethod::crossings>},
        {"intersectTriangle", "shared corners and edges, against plane and angle sum", gaps, 0, watertight,
         &runPlaneGaps<InsideMethod::angleSum>},
        {"intersectTriangle", "shared corners and edges, against plane and areas", gaps, 0, watertight,
         &runPlaneGaps<InsideMethod::areas>},
        {"intersectTriangle", "shared corners and edges, against plane and cross products", gaps, 0,
         watertight, &runPlaneGaps<InsideMethod::crossProducts>},
        {"intersectTriangle", "shared corners and edges, against Plücker coordinates", gaps, 0, watertight,
         &runPlueckerGaps},
        {"intersectTriangle", "triangles of 2^-60 … 2^-8", "ulp of t", halfUlp, watertight,
         &runScales<-60, -8, false>},
        {"intersectTriangle", "triangles of 2^20 … 2^60", "ulp of t", halfUlp, watertight,
         &runScales<20, 60, false>},
        {"intersectTriangle", "triangles of 2^-130 … 2^100, against the published form", "ulp of t", halfUlp,
         watertight, &runScales<-130, 100, true>},
        {"intersectTriangle", "planes at 2^-20 … 2^-4 rad to the ray", "ulp of t", halfUlp, watertight,
         &runGrazing},
        {"intersectTriangle", "needles of 2^-24 … 2^-4", "ulp of t", halfUlp, watertight, &runNeedles},
        {"intersectTriangle", "directions of 2^-110 … 2^110", "ulp of t", halfUlp, watertight,
         &runDirections},
        {"intersectTriangle", "grid triangles: rays at corners and edges, in the plane; without area",
         decisions, 0, watertight, &runDecisions},
        {"intersectPacked", "edges, scales of 2^-60 … 2^30", "relative error of t", 0x1p-14,
         "float with a bound, the rest exactly", &runPacked},
        {"intersectPolygon", "corners, edges, chains that cross, 2^-60 … 2^60", "ulp of t", halfUlp,
         "crossings seen along the ray, exact signs", &runRayPolygon},
        {"intersectParallelogram", "directions of 2^-60 … 2^10", "ulp of t", halfUlp,
         "Cramer's rule, exact determinants", &runQuadDirections},
        {"intersectParallelogram", "the edge of two", gaps, 0, "Cramer's rule, exact determinants",
         &runQuadGaps},
    };
    return cases;
}

}  // namespace quincunx

#include "geometry/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/multiprecision/mpfr.hpp>
#include <gtest/gtest.h>

#include "base/random.h"

namespace quincunx {
namespace {

using glm::dvec2;
using glm::dvec3;
using Exact = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60>>;

constexpr double epsilon = 0x1p-53;
constexpr double pi = std::numbers::pi;

/// Signed distance of (ρ, y) from a profile, written for each shape from its definition, in any arithmetic.
template <typename T>
T hypotenuse(const T& a, const T& b) {
    using std::sqrt;
    return sqrt(T(a * a + b * b));
}

template <typename T>
T distanceInPlane(const Sphere& s, const T& rho, const T& y) {
    return hypotenuse<T>(rho, y) - s.radius;
}

template <typename T>
T distanceInPlane(const Torus& s, const T& rho, const T& y) {
    return hypotenuse<T>(rho - s.majorRadius, y) - s.minorRadius;
}

template <typename T>
T distanceInPlane(const Capsule& s, const T& rho, const T& y) {
    using std::abs;
    const T beyond = abs(y) - s.halfLength;
    return hypotenuse<T>(rho, beyond > 0 ? beyond : T(0)) - s.radius;
}

template <typename T>
T distanceInPlane(const Drum& s, const T& rho, const T& y) {
    using std::abs;
    const T a = rho - (T(s.radius) - s.rimRadius);
    const T b = abs(y) - (T(s.halfHeight) - s.rimRadius);
    const T larger = a > b ? a : b;
    return (larger < 0 ? larger : T(0)) + hypotenuse<T>(a > 0 ? a : T(0), b > 0 ? b : T(0)) - s.rimRadius;
}

template <typename T>
T distanceInPlane(const Egg& s, const T& rho, const T& y) {
    using std::sqrt;
    const T r = s.radius;
    if (y <= 0)
        return hypotenuse<T>(rho, y) - r;
    // Above the line from (-r, 0) through (0, r) lies the cap.
    if (y - r >= rho)
        return hypotenuse<T>(rho, y - r) - (2 - sqrt(T(2))) * r;
    return hypotenuse<T>(rho + r, y) - 2 * r;
}

template <typename T>
T distanceFrom(const Shape& shape, const T& x, const T& y, const T& z) {
    const T rho = hypotenuse<T>(x, z);
    return std::visit(
        [&](const auto& s) -> T {
            if constexpr (requires { s.profile; })
                return T(0);
            else
                return distanceInPlane<T>(s, rho, y);
        },
        shape);
}

double distanceFrom(const Shape& shape, const dvec3& p) {
    return distanceFrom<double>(shape, p.x, p.y, p.z);
}

struct Named {
    std::string name;
    Shape shape;
};

/// A solid with hollows, ring, stem and ball.
Turned bottle() {
    Lathe lathe(-1);
    lathe.line(0.4).arc(0.1, 180).line(0.1).arc(0.1, -90).line(0.3);
    lathe.arc(0.1, -90).line(0.2).arc(0.05, 180);
    return lathe.line(lathe.position().x).finish();
}

std::vector<Named> shapes(double scale = 1) {
    return {{"sphere", Sphere{0.75 * scale}},
            {"torus", Torus{1.0 * scale, 0.25 * scale}},
            {"thin torus", Torus{1.0 * scale, 0.0078125 * scale}},
            {"fat torus", Torus{1.0 * scale, 0.984375 * scale}},
            {"capsule", Capsule{0.375 * scale, 0.5 * scale}},
            {"drum", Drum{1.25 * scale, 0.5 * scale, 0.125 * scale}},
            {"disc", Drum{1.25 * scale, 0.125 * scale, 0.125 * scale}},
            {"egg", Egg{0.625 * scale}}};
}

std::vector<Named> shapesWithTurned() {
    std::vector<Named> all = shapes();
    all.push_back({"bottle", bottle()});
    return all;
}

dvec3 randomDirection(Random& random) {
    const double y = random.uniform(-1, 1);
    const double angle = random.uniform(0, 2 * pi);
    const double rho = std::sqrt(1 - y * y);
    return {rho * std::cos(angle), y, rho * std::sin(angle)};
}

dvec3 randomPoint(Random& random, double reach) {
    return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

/// What is left between a hit and the exact answer, in units of ε · size.
struct Residual {
    double surface = 0;  ///< |distance of the position from the surface|
    double ray = 0;      ///< distance of the position from the ray's line
    double along = 0;    ///< | |origin - foot of the position| - t |direction| | · cos, less 8 ε |origin|

    void take(const Residual& other) {
        surface = std::max(surface, other.surface);
        ray = std::max(ray, other.ray);
        along = std::max(along, other.along);
    }
};

Residual residual(const Shape& shape, const DRay& ray, const Hit& hit, double size) {
    const auto exact = [](const dvec3& v) { return std::array<Exact, 3>{v.x, v.y, v.z}; };
    const auto o = exact(ray.origin);
    const auto d = exact(ray.direction);
    const auto p = exact(hit.position);
    Exact dd = 0;
    Exact pd = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        dd += d[i] * d[i];
        pd += (p[i] - o[i]) * d[i];
    }
    const Exact foot = pd / dd;
    Exact off = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Exact difference = o[i] + foot * d[i] - p[i];
        off += difference * difference;
    }
    const double unit = epsilon * size;
    const double cosine = std::abs(glm::dot(hit.normal, glm::normalize(ray.direction)));
    const double length = sqrt(dd).convert_to<double>();
    const double alongError = abs(Exact(foot - hit.t)).convert_to<double>() * length;
    return {abs(distanceFrom<Exact>(shape, p[0], p[1], p[2])).convert_to<double>() / unit,
            sqrt(off).convert_to<double>() / unit,
            (alongError - 8 * epsilon * glm::length(ray.origin)) * cosine / unit};
}

/// The contract of Solid::intersect.
constexpr double surfaceLimit = 8;
constexpr double rayLimit = 64;

void expectWithinContract(const Residual& worst, const std::string& name) {
    EXPECT_LE(worst.surface, surfaceLimit) << name;
    EXPECT_LE(worst.ray, rayLimit) << name;
    EXPECT_LE(worst.along, rayLimit) << name;
}

// Measured, in ε · size, worst of all shapes: surface 2.5, ray 3.4, along 0.8.
TEST(ShapeIntersection, HitsLieOnTheSurfaceAndOnTheRay) {
    for (const auto& [name, shape] : shapes()) {
        const Solid solid(shape);
        Random random(7);
        Residual worst;
        int hits = 0;
        for (int i = 0; i < 4000; ++i) {
            const DRay ray{randomPoint(random, 2 * solid.size()),
                           randomDirection(random) * std::exp2(random.uniform(-60, 60))};
            if (const std::optional<Hit> hit = solid.intersect(ray)) {
                worst.take(residual(shape, ray, *hit, solid.size()));
                EXPECT_GE(hit->t, 0);
                EXPECT_NEAR(glm::length(hit->normal), 1, 4 * epsilon);
                ++hits;
            }
        }
        EXPECT_GT(hits, name == "thin torus" ? 10 : 200) << name;
        expectWithinContract(worst, name);
    }
}

// Measured, in ε · size, worst of all shapes: surface 2.5, ray 4.4, along 0 (8 ε |origin| covers it).
TEST(ShapeIntersection, FarOriginsCostNoAccuracy) {
    for (const auto& [name, shape] : shapes()) {
        const Solid solid(shape);
        Random random(11);
        Residual worst;
        int hits = 0;
        for (int i = 0; i < 2000; ++i) {
            const dvec3 target = randomPoint(random, solid.size());
            const dvec3 away = randomDirection(random) * (1e6 * solid.size());
            const DRay ray{target + away, -away};
            if (const std::optional<Hit> hit = solid.intersect(ray)) {
                worst.take(residual(shape, ray, *hit, solid.size()));
                ++hits;
            }
        }
        EXPECT_GT(hits, name == "thin torus" ? 10 : 200) << name;
        expectWithinContract(worst, name);
    }
}

TEST(ShapeIntersection, ScalesWithPowersOfTwoBitForBit) {
    for (const double scale : {0x1p-40, 0x1p-20, 0x1p20, 0x1p40}) {
        const std::vector<Named> plain = shapes();
        const std::vector<Named> scaled = shapes(scale);
        for (std::size_t k = 0; k < plain.size(); ++k) {
            const Solid solid(plain[k].shape);
            const Solid other(scaled[k].shape);
            Random random(13);
            for (int i = 0; i < 500; ++i) {
                const dvec3 origin = randomPoint(random, 2 * solid.size());
                const dvec3 direction = randomDirection(random);
                const std::optional<Hit> a = solid.intersect({origin, direction});
                const std::optional<Hit> b = other.intersect({scale * origin, direction});
                ASSERT_EQ(a.has_value(), b.has_value()) << plain[k].name;
                if (a) {
                    EXPECT_EQ(a->t * scale, b->t) << plain[k].name;
                    EXPECT_EQ(a->position * scale, b->position) << plain[k].name;
                    EXPECT_EQ(a->normal, b->normal) << plain[k].name;
                }
            }
        }
    }
}

TEST(ShapeIntersection, TinyShapesAreMetAsWellAsLargeOnes) {
    for (const double scale : {1e-6, 1e6}) {
        for (const auto& [name, shape] : shapes(scale)) {
            const Solid solid(shape);
            Random random(17);
            Residual worst;
            for (int i = 0; i < 1000; ++i) {
                const DRay ray{randomPoint(random, 2 * solid.size()), randomDirection(random)};
                if (const std::optional<Hit> hit = solid.intersect(ray))
                    worst.take(residual(shape, ray, *hit, solid.size()));
            }
            expectWithinContract(worst, name + " of size " + std::to_string(scale));
        }
    }
}

/// Walks along the ray by the signed distance, which never steps over the surface, and says how far the
/// distance keeps its sign: to `t`, or for as long as the ray is near the solid.
bool keepsItsSideUntil(const Shape& shape, const DRay& ray, double end, double size) {
    const double start = distanceFrom(shape, ray.origin);
    const double least = 1e-9 * size;
    for (double t = 0; t < end;) {
        const double distance = distanceFrom(shape, ray.origin + t * ray.direction);
        if (std::abs(distance) > least && (distance < 0) != (start < 0))
            return false;
        t += std::max(std::abs(distance), 1e-4 * size);
    }
    return true;
}

TEST(ShapeIntersection, FindsTheNearestHitAndMissesNone) {
    for (const auto& [name, shape] : shapes()) {
        const Solid solid(shape);
        Random random(19);
        int inside = 0;
        for (int i = 0; i < 4000; ++i) {
            const DRay ray{randomPoint(random, solid.size()), randomDirection(random)};
            const bool startsInside = distanceFrom(shape, ray.origin) < 0;
            inside += startsInside;
            const std::optional<Hit> hit = solid.intersect(ray);
            EXPECT_TRUE(hit || !startsInside) << name << ": no way out";
            const double end = hit ? hit->t * (1 - 1e-9) : 4 * solid.size();
            EXPECT_TRUE(keepsItsSideUntil(shape, ray, end, solid.size())) << name << " ray " << i;
            if (hit && std::abs(glm::dot(hit->normal, ray.direction)) > 1e-6) {
                EXPECT_EQ(glm::dot(hit->normal, ray.direction) > 0, startsInside) << name;
            }
        }
        if (name != "thin torus") {
            EXPECT_GT(inside, 50) << name;
        }
    }
}

TEST(ShapeIntersection, NormalsAreTheGradientOfTheDistance) {
    // Central differences of step h = 2^-17 are good to h²/6 times a third derivative below 2 / minorRadius²,
    // and to ε / h: together below 1e-5 but next to a joint, where the second derivative jumps (h / radius).
    for (const auto& [name, shape] : shapes()) {
        if (name == "thin torus")
            continue;
        const Solid solid(shape);
        Random random(23);
        for (int i = 0; i < 1000; ++i) {
            const std::optional<Hit> hit =
                solid.intersect({randomPoint(random, 2 * solid.size()), randomDirection(random)});
            if (!hit)
                continue;
            constexpr double h = 0x1p-17;
            dvec3 gradient(0);
            for (int axis = 0; axis < 3; ++axis) {
                dvec3 step(0);
                step[axis] = h;
                gradient[axis] =
                    (distanceFrom(shape, hit->position + step) - distanceFrom(shape, hit->position - step)) /
                    (2 * h);
            }
            EXPECT_LT(glm::length(gradient - hit->normal), 1e-4) << name;
        }
    }
}

TEST(ShapeIntersection, ExactTangentsHit) {
    // Whole numbers, so that the tangent is one exactly.
    const auto expectAt = [](const Shape& shape, const DRay& ray, double t, const std::string& what) {
        const std::optional<Hit> hit = intersect(shape, ray);
        ASSERT_TRUE(hit) << what;
        // Near a tangent, t is no better than the square root of the accuracy: √(2 · 64 ε D · D).
        EXPECT_NEAR(hit->t, t, std::sqrt(2 * rayLimit * epsilon) * Solid(shape).size()) << what;
    };
    expectAt(Sphere{5}, {{-20, 5, 0}, {1, 0, 0}}, 20, "sphere, top");
    expectAt(Sphere{5}, {{3 - 40, 4 + 30, 0}, {4, -3, 0}}, 10, "sphere, slanted");
    expectAt(Torus{4, 1}, {{-20, 1, 0}, {1, 0, 0}}, 16, "torus, along its top");
    expectAt(Torus{4, 1}, {{-20, 0, 5}, {1, 0, 0}}, 20, "torus, outer equator");
    expectAt(Torus{4, 1}, {{0, 0, 3}, {1, 0, 0}}, 0, "torus, inner equator");
    expectAt(Torus{4, 1}, {{5, -20, 0}, {0, 1, 0}}, 20, "torus, up its outside");
    expectAt(Torus{4, 1}, {{0, -20, 3}, {0, 1, 0}}, 20, "torus, up its inside");
    expectAt(Capsule{3, 4}, {{3, 2, -7}, {0, 0, 1}}, 7, "capsule, side");
    expectAt(Capsule{3, 4}, {{-9, 7, 0}, {1, 0, 0}}, 9, "capsule, top");
    expectAt(Drum{6, 4, 2}, {{6, 1, -9}, {0, 0, 1}}, 9, "drum, side");
    expectAt(Drum{6, 4, 2}, {{-9, 4, 0}, {1, 0, 0}}, 5, "drum, along its top, from where the rim ends");
}

TEST(ShapeIntersection, NearTangentsAreToldApart) {
    // Rays past convex shapes at 1e-12 of their size: 70 times the stated accuracy, so all must be right.
    for (const auto& [name, shape] : shapes()) {
        if (name.find("torus") != std::string::npos)
            continue;
        const Solid solid(shape);
        Random random(29);
        for (int i = 0; i < 2000; ++i) {
            const dvec3 outside = randomDirection(random) * (3 * solid.size());
            const std::optional<Hit> seen = solid.intersect({outside, -outside});
            ASSERT_TRUE(seen);
            const dvec3 tangent = glm::normalize(glm::cross(seen->normal, randomDirection(random)));
            const double gap = 1e-12 * solid.size();
            const dvec3 start = seen->position - 2 * solid.size() * tangent;
            EXPECT_FALSE(solid.intersect({start + gap * seen->normal, tangent})) << name;
            EXPECT_TRUE(solid.intersect({start - gap * seen->normal, tangent})) << name;
        }
    }
}

TEST(ShapeIntersection, RaysAlongTheAxisMeetThePoles) {
    for (const auto& [name, shape] : shapesWithTurned()) {
        const Solid solid(shape);
        const std::optional<Hit> hit = solid.intersect({{0, 10, 0}, {0, -1, 0}});
        if (name.find("torus") != std::string::npos) {
            EXPECT_FALSE(hit) << name;
            continue;
        }
        ASSERT_TRUE(hit) << name;
        EXPECT_EQ(hit->normal, dvec3(0, 1, 0)) << name;
    }
}

TEST(ShapeIntersection, JointsLeakNoRays) {
    // Rays to the points where two pieces of a profile meet must meet one of them.
    for (const auto& [name, shape] : shapesWithTurned()) {
        const Solid solid(shape);
        Random random(31);
        for (const Solid::Part& part : solid.parts()) {
            const ProfilePiece& piece = part.piece;
            const dvec2 start = piece.kind == ProfilePiece::Kind::line
                                    ? piece.from
                                    : piece.centre + piece.radius * dvec2(std::cos(piece.startRadians),
                                                                          std::sin(piece.startRadians));
            for (int i = 0; i < 500; ++i) {
                const double angle = random.uniform(0, 2 * pi);
                const dvec3 joint(start.x * std::cos(angle), start.y, start.x * std::sin(angle));
                const dvec3 origin = randomDirection(random) * (3 * solid.size());
                const std::optional<Hit> hit = solid.intersect({origin, joint - origin});
                // Where the joint's tangent plane is seen edge on, the ray may pass by.
                if (hit)
                    EXPECT_LE(hit->t, 1 + 1e-6) << name;
                else
                    EXPECT_TRUE(false) << name << ": a ray to a joint passed";
            }
        }
    }
}

// Positions as integers, so that equal ones are the same vertex.
std::vector<std::size_t> weld(const Mesh& mesh) {
    std::map<std::array<float, 3>, std::size_t> first;
    std::vector<std::size_t> result;
    for (const glm::vec3& p : mesh.positions)
        result.push_back(first.try_emplace({p.x, p.y, p.z}, first.size()).first->second);
    return result;
}

TEST(ShapeTessellation, IsClosedAndOrientedAtAnyFineness) {
    for (const auto& [name, shape] : shapesWithTurned()) {
        for (const int segments : {3, 4, 5, 8, 17, 64}) {
            const Mesh mesh = tessellate(shape, segments, name);
            ASSERT_EQ(mesh.triangleCount(), triangleCount(shape, segments)) << name;
            ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
            ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
            const std::vector<std::size_t> vertex = weld(mesh);
            std::map<std::pair<std::size_t, std::size_t>, int> edges;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
                for (std::size_t k = 0; k < 3; ++k) {
                    ASSERT_LT(mesh.indices[i + k], mesh.positions.size());
                    const std::size_t a = vertex[mesh.indices[i + k]];
                    const std::size_t b = vertex[mesh.indices[i + (k + 1) % 3]];
                    ASSERT_NE(a, b) << name << ": a triangle without area, segments " << segments;
                    ++edges[{a, b}];
                }
            for (const auto& [edge, count] : edges) {
                ASSERT_EQ(count, 1) << name;
                ASSERT_TRUE(edges.contains({edge.second, edge.first})) << name << ": a hole";
            }
            // Euler: vertices - edges + faces is 2 for a ball and 0 for a ring.
            const auto vertices = static_cast<long>(*std::max_element(vertex.begin(), vertex.end()) + 1);
            const long euler =
                vertices - static_cast<long>(edges.size() / 2) + static_cast<long>(mesh.triangleCount());
            EXPECT_EQ(euler, name.find("torus") != std::string::npos ? 0 : 2) << name;
        }
    }
}

double volume(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const dvec3 a = mesh.positions[mesh.indices[i]];
        const dvec3 b = mesh.positions[mesh.indices[i + 1]];
        const dvec3 c = mesh.positions[mesh.indices[i + 2]];
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

TEST(ShapeTessellation, VolumeConvergesToTheClosedFormWithOrderTwo) {
    const double drumFlat = 1.25 - 0.125;
    const std::vector<std::pair<Shape, double>> known = {
        {Sphere{0.75}, 4.0 / 3 * pi * 0.75 * 0.75 * 0.75},
        {Torus{1, 0.25}, 2 * pi * pi * 0.25 * 0.25},
        {Capsule{0.375, 0.5}, pi * 0.375 * 0.375 * (1 + 4.0 / 3 * 0.375)},
        // The disc of the flat radius swept by a ball (Steiner's formula), and the cylinder between.
        {Drum{1.25, 0.125, 0.125}, pi * drumFlat * drumFlat * 0.25 + pi * pi * drumFlat * 0.125 * 0.125 +
                                       4.0 / 3 * pi * 0.125 * 0.125 * 0.125}};
    for (const auto& [shape, exact] : known) {
        const double coarse = exact - volume(tessellate(shape, 64));
        const double fine = exact - volume(tessellate(shape, 128));
        EXPECT_GT(fine, 0) << shape.index();
        EXPECT_NEAR(coarse / fine, 4, 0.35) << shape.index();
    }
}

TEST(ShapeTessellation, VerticesAndNormalsAreTheSurfacesOwn) {
    // One rounding to float each; the normal of a rounded place on a circle of radius r is off by that over
    // r.
    for (const auto& [name, shape] : shapes()) {
        const Mesh mesh = tessellate(shape, 48);
        const Solid solid(shape);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const dvec3 p = mesh.positions[i];
            const dvec3 n = mesh.normals[i];
            EXPECT_LE(std::abs(distanceFrom(shape, p)), 0x1p-24 * 2 * solid.size()) << name;
            EXPECT_NEAR(glm::length(n), 1, 0x1p-23) << name;
            // The surface next to the vertex, seen along its normal.
            const double back = 1e-3 * solid.size();
            const std::optional<Hit> hit = solid.intersect({p + back * n, -n});
            ASSERT_TRUE(hit) << name;
            if (name != "thin torus") {
                EXPECT_LT(glm::length(hit->normal - n), 4e-6) << name;
            }
        }
    }
}

TEST(ShapeTessellation, FacesLookOutAndComeToTheSurfaceWithOrderTwo) {
    for (const auto& [name, shape] : shapes()) {
        if (name == "thin torus")  // its tube keeps the least number of steps
            continue;
        const auto worstGap = [&](int segments) {
            const Mesh mesh = tessellate(shape, segments);
            double worst = 0;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                const auto corner = [&](std::size_t k) { return dvec3(mesh.positions[mesh.indices[i + k]]); };
                const dvec3 face = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
                for (std::size_t k = 0; k < 3; ++k)
                    EXPECT_GT(glm::dot(face, dvec3(mesh.normals[mesh.indices[i + k]])), 0) << name;
                const dvec3 middle = (corner(0) + corner(1) + corner(2)) / 3.0;
                worst = std::max(worst, std::abs(distanceFrom(shape, middle)));
            }
            return worst;
        };
        // Steps along short arcs are whole numbers, 3 and 20 for the drum's rim: 1.8 instead of 2.
        const double order = std::log2(worstGap(96) / worstGap(768)) / 3;
        EXPECT_NEAR(order, 2, 0.25) << name;
    }
}

TEST(ShapeTessellation, CountsArePredictable) {
    EXPECT_EQ(triangleCount(Sphere{1}, 64), 2u * 64 * 31);
    EXPECT_EQ(triangleCount(Torus{3, 1}, 64), 2u * 64 * 16);
    EXPECT_EQ(triangleCount(Sphere{1}, 3), 6u);
    EXPECT_EQ(tessellate(Sphere{1}, 2048).triangleCount(), 2u * 2048 * 1023);
}

TEST(Lathe, FollowsItsMoves) {
    // A ball drawn as two quarters, and a hollow: the mesh's volume is that of the closed form.
    const Turned ball = Lathe(-1).arc(1, 90).arc(1, 90).finish();
    EXPECT_NEAR(volume(tessellate(ball, 512)), 4.0 / 3 * pi, 4e-4);
    const std::optional<Hit> hit = intersect(ball, {{0, 0, 3}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_DOUBLE_EQ(hit->t, 2);
}

}  // namespace
}  // namespace quincunx

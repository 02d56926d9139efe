#include "geometry/intersection_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "geometry/intersection_oracle.h"
#include "geometry/overlap.h"
#include "geometry/ray_shapes.h"
#include "math/expansion.h"
#include "math/quadratic.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Half an ulp, and what a relative error of 2^-31 adds to it.
constexpr double halfUlp = 0.5 + 0x1p-7;

std::string hex(glm::vec3 v) {
    return hexVector(v);
}

std::string describe(const Ray& ray) {
    return fmt::format("o={} d={}", hex(ray.origin), hex(ray.direction));
}
std::string describe(const Ball& ball) {
    return fmt::format("c={} r={:a}", hex(ball.centre), ball.radius);
}
std::string describe(const Cylinder& cylinder) {
    return fmt::format("base={} axis={} r={:a}", hex(cylinder.base), hex(cylinder.axis), cylinder.radius);
}
std::string describe(const Plane& plane) {
    return fmt::format("n={} w={:a}", hex(plane.normal), plane.offset);
}
std::string describe(const Bounds& box) {
    return fmt::format("min={} max={}", hex(box.min), hex(box.max));
}
template <typename First, typename Second>
std::string describe(const First& first, const Second& second) {
    return fmt::format("{} {}", describe(first), describe(second));
}

/// ulps of t as a float; infinite for a hit that is none and a miss that is one.
template <typename Number>
double hitError(const std::optional<Number>& got, const std::optional<Quad>& exact) {
    if (got.has_value() != exact.has_value())
        return infinity;
    return got ? ulpError(static_cast<float>(*got), *exact) : 0;
}

/// A yes or no: wrong is a failure.
double verdictError(bool got, bool exact) {
    return got == exact ? 0 : infinity;
}

bool fits(glm::vec3 v) {
    return isFinite(v) && v != glm::vec3(0);
}

/// A whole number within ± limit, as a float holds it.
float whole(StressInputs& draw, int limit) {
    return static_cast<float>(
        static_cast<int>(draw.random().below(static_cast<std::uint32_t>(2 * limit + 1))) - limit);
}

glm::vec3 wholeVector(StressInputs& draw, int limit) {
    return {whole(draw, limit), whole(draw, limit), whole(draw, limit)};
}

struct SphereInput {
    Ray ray;
    Ball ball;
};

template <typename Draw>
HardCaseFigures runSphere(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const SphereInput input = make(draw, i);
        const std::optional<Quad> exact = raySphereExact(input.ray, input.ball);
        tally.add(hitError(raySphereNaive(input.ray, input.ball), exact),
                  hitError(raySphereDistance(input.ray, input.ball), exact),
                  [&] { return describe(input.ray, input.ball); });
    }
    return tally.figures();
}

/// A ray that passes the ball at `passing` radii, from `distance` away, with a direction of any length.
SphereInput aimed(StressInputs& draw, Ball ball, double distance, double passing, double stretch) {
    const glm::dvec3 away = draw.direction();
    const glm::dvec3 aside = draw.perpendicular(away);
    const glm::vec3 origin(glm::dvec3(ball.centre) + distance * away);
    const glm::dvec3 target = glm::dvec3(ball.centre) + passing * static_cast<double>(ball.radius) * aside;
    return {{origin, glm::vec3(stretch * (target - glm::dvec3(origin)) / distance)}, ball};
}

HardCaseFigures runSphereFar(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const Ball ball{draw.vectorOfMagnitude(-2, 10), 1};
        return aimed(draw, ball, draw.magnitude(4, 20), draw.random().uniform(0, 1.2), 1);
    });
}

HardCaseFigures runSphereNearlyTangent(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const Ball ball{draw.vectorOfMagnitude(-2, 3), static_cast<float>(draw.magnitude(-3, 3))};
        return aimed(draw, ball, ball.radius * draw.magnitude(0.1, 12),
                     1 + draw.sign() * draw.magnitude(-40, -3), draw.magnitude(-3, 3));
    });
}

/// Whole numbers with d ⟂ (q − c) and |q − c| = r: the ray q + t d is tangent; (a, b, c) is a multiple of a
/// Pythagorean quadruple.
HardCaseFigures runSphereTangent(std::uint64_t inputs, std::uint64_t seed) {
    static constexpr std::array<std::array<int, 4>, 6> quadruples{
        {{1, 2, 2, 3}, {2, 3, 6, 7}, {1, 4, 8, 9}, {4, 4, 7, 9}, {2, 6, 9, 11}, {6, 6, 7, 11}}};
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const auto& q = quadruples[draw.random().below(quadruples.size())];
        const float scale = static_cast<float>(1 + draw.random().below(40));
        const glm::vec3 offset =
            scale * glm::vec3(draw.sign() * q[0], draw.sign() * q[1], draw.sign() * q[2]);
        // Perpendicular to the offset: its cross product with any whole vector.
        glm::vec3 direction;
        do
            direction = glm::cross(offset / scale, wholeVector(draw, 6));
        while (direction == glm::vec3(0));
        const glm::vec3 centre = wholeVector(draw, 2000);
        const float back = static_cast<float>(draw.random().below(200));
        const float length = static_cast<float>(std::exp2(static_cast<double>(draw.random().below(9)) - 4));
        return SphereInput{{centre + offset - back * direction, length * direction},
                           {centre, scale * static_cast<float>(q[3])}};
    });
}

HardCaseFigures runSphereGround(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const float r = static_cast<float>(draw.magnitude(8, 22));
        const Ball ground{{0, -r, 0}, r};
        const glm::vec3 origin(draw.random().uniform(-1, 1), draw.magnitude(-8, 3),
                               draw.random().uniform(-1, 1));
        const double angle = draw.random().uniform(0, 6.283);
        return SphereInput{
            {origin, glm::vec3(std::cos(angle), draw.sign() * draw.magnitude(-22, 0), std::sin(angle))},
            ground};
    });
}

HardCaseFigures runSphereScales(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const double scale = draw.magnitude(-60, 60);
        const Ball ball{glm::vec3(scale * glm::dvec3(draw.vectorOfMagnitude(-2, 5))),
                        static_cast<float>(scale * draw.magnitude(-4, 4))};
        return aimed(draw, ball, ball.radius * draw.magnitude(-3, 8), draw.random().uniform(0, 1.3),
                     draw.magnitude(-60, 60));
    });
}

HardCaseFigures runSphereOnSurface(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const Ball ball{draw.vectorOfMagnitude(-4, 6), static_cast<float>(draw.magnitude(-4, 4))};
        const glm::dvec3 outwards = draw.direction();
        const glm::vec3 origin(glm::dvec3(ball.centre) +
                               ball.radius * (1 + draw.sign() * draw.magnitude(-30, -4)) * outwards);
        return SphereInput{{origin, draw.unitVector()}, ball};
    });
}

HardCaseFigures runSphereBits(std::uint64_t inputs, std::uint64_t seed) {
    return runSphere(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        const Ball ball{draw.finiteVector(), std::abs(draw.finiteFloat())};
        const Ray ray{draw.finiteVector(), draw.finiteVector()};
        if (i % 2 == 0)
            return SphereInput{ray, ball};
        // Aimed, as far as the range lets.
        const glm::vec3 towards(0.25f * ball.centre - 0.25f * ray.origin);
        return SphereInput{{ray.origin, fits(towards) ? towards : ray.direction}, ball};
    });
}

/// Doubles: a ball of radius 1, 2^20 … 2^50 away, passed within 1.2 radii.
HardCaseFigures runSphereDouble(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const DBall ball{draw.doubleVectorOfMagnitude(-2, 10), 1};
        const glm::dvec3 away = draw.direction();
        const glm::dvec3 origin = ball.centre + draw.magnitude(20, 50) * away;
        const glm::dvec3 target = ball.centre + draw.random().uniform(0, 1.2) * draw.perpendicular(away);
        const DRay ray{origin, target - origin};
        const std::optional<Quad> exact = raySphereExact(ray, ball);
        const auto error = [&](const std::optional<double>& got) {
            if (got.has_value() != exact.has_value())
                return infinity;
            return got ? ulpError(*got, *exact) : 0;
        };
        tally.add(error(raySphereNaive(ray, ball)), error(raySphereDistance(ray, ball)), [&] {
            return fmt::format("o=({:a},{:a},{:a}) d=({:a},{:a},{:a}) c=({:a},{:a},{:a})", ray.origin.x,
                               ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
                               ball.centre.x, ball.centre.y, ball.centre.z);
        });
    }
    return tally.figures();
}

template <typename Draw>
HardCaseFigures runCylinder(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto [ray, radius] = make(draw, i);
        const Cylinder cylinder{{0, 0, 0}, {0, 0, 1}, radius};
        const std::optional<Quad> exact = rayCylinderExact(ray, cylinder);
        tally.add(hitError(rayCylinderNaive(ray, radius), exact),
                  hitError(rayCylinderDistance(ray, cylinder), exact),
                  [&, &ray = ray] { return describe(ray, cylinder); });
    }
    return tally.figures();
}

using RayAndRadius = std::pair<Ray, float>;

HardCaseFigures runCylinderSteep(std::uint64_t inputs, std::uint64_t seed) {
    return runCylinder(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const double tilt = draw.magnitude(-70, 0);
        const double angle = draw.random().uniform(0, 6.283);
        const glm::vec3 origin(draw.random().uniform(-2, 2), draw.random().uniform(-2, 2),
                               draw.random().uniform(-1, 1));
        return RayAndRadius{{origin, glm::vec3(tilt * std::cos(angle), tilt * std::sin(angle), draw.sign())},
                            1.0f};
    });
}

HardCaseFigures runCylinderParallel(std::uint64_t inputs, std::uint64_t seed) {
    return runCylinder(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        return RayAndRadius{{draw.vectorOfMagnitude(-2, 2),
                             glm::vec3(draw.sign() * 0.0, draw.sign() * 0.0, draw.magnitude(-20, 20))},
                            1.0f};
    });
}

HardCaseFigures runCylinderThin(std::uint64_t inputs, std::uint64_t seed) {
    return runCylinder(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const float radius = static_cast<float>(draw.magnitude(-20, 0));
        const double angle = draw.random().uniform(0, 6.283);
        const double distance = draw.magnitude(0, 10);
        const glm::dvec3 away(std::cos(angle), std::sin(angle), 0);
        const glm::dvec3 aside(-away.y, away.x, 0);
        const glm::vec3 origin(distance * away);
        const glm::dvec3 target = draw.random().uniform(-1.3, 1.3) * radius * aside;
        return RayAndRadius{
            {origin, glm::vec3(target - glm::dvec3(origin) + glm::dvec3(0, 0, draw.random().uniform(-1, 1)))},
            radius};
    });
}

/// Cylinders anywhere with any axis: the z axis of the naive form is turned onto it in float.
HardCaseFigures runCylinderAnyAxis(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 axis = draw.direction();
        const Cylinder cylinder{draw.vectorOfMagnitude(-3, 8), glm::vec3(draw.magnitude(-6, 6) * axis),
                                static_cast<float>(draw.magnitude(-6, 3))};
        const glm::dvec3 aside = draw.perpendicular(axis);
        const glm::dvec3 target = glm::dvec3(cylinder.base) + draw.random().uniform(-9, 9) * axis +
                                  draw.random().uniform(-1.2, 1.2) * cylinder.radius * aside;
        const glm::dvec3 from = i % 3 == 0 ? draw.turned(axis, -20, -1) : draw.direction();
        const glm::vec3 origin(target + draw.magnitude(-3, 10) * from);
        const glm::vec3 direction(draw.magnitude(-10, 10) * (target - glm::dvec3(origin)));
        const Ray ray{origin, fits(direction) ? direction : glm::vec3(axis)};
        const std::optional<Quad> exact = rayCylinderExact(ray, cylinder);
        const glm::mat3 zFromWorld = glm::transpose(basisAround(cylinder.axis).value_or(glm::mat3(1)));
        const Ray turned{zFromWorld * (ray.origin - cylinder.base), zFromWorld * ray.direction};
        tally.add(hitError(rayCylinderNaive(turned, cylinder.radius), exact),
                  hitError(rayCylinderDistance(ray, cylinder), exact),
                  [&] { return describe(ray, cylinder); });
    }
    return tally.figures();
}

/// A can of whole numbers and rays to its rims, caps, sides and edges, some in the planes of its caps.
HardCaseFigures runCapped(std::uint64_t inputs, std::uint64_t seed) {
    static constexpr std::array<std::array<int, 3>, 4> triples{
        {{3, 4, 5}, {5, 12, 13}, {8, 15, 17}, {0, 1, 1}}};
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto& triple = triples[draw.random().below(triples.size())];
        const float radius = static_cast<float>(triple[2]);
        const float height = static_cast<float>(1 + draw.random().below(30));
        const Cylinder can{{0, 0, 0}, {0, 0, height}, radius};
        glm::vec3 target(draw.sign() * triple[0], draw.sign() * triple[1], 0);
        switch (draw.random().below(4)) {
            case 0:
                target.z = draw.random().below(2) == 0 ? 0 : height;
                break;
            case 1:
                target.z = height * static_cast<float>(draw.random().below(9)) / 8;
                break;
            case 2:
                target *= static_cast<float>(draw.random().below(9)) / 8;
                target.z = draw.random().below(2) == 0 ? 0 : height;
                break;
            default:
                target = glm::vec3(draw.random().uniform(-1.2, 1.2) * radius,
                                   draw.random().uniform(-1.2, 1.2) * radius,
                                   draw.random().uniform(-0.2, 1.2) * height);
        }
        glm::vec3 direction = i % 2 == 0 ? wholeVector(draw, 12) : draw.unitVector();
        if (i % 5 == 0)
            direction.z = 0;
        if (i % 7 == 0)
            direction = {-target.y, target.x, i % 14 == 0 ? 0.0f : whole(draw, 3)};
        if (i % 11 == 0)
            direction = {0, 0, static_cast<float>(draw.sign())};
        if (direction == glm::vec3(0))
            direction = {0, 0, 1};
        const Ray ray{target - static_cast<float>(draw.random().below(6)) * direction, direction};
        const std::optional<Quad> exact = rayCappedCylinderExact(ray, can);
        tally.add(hitError(rayCappedCylinderNaive(ray, radius, height), exact),
                  hitError(rayCappedCylinderDistance(ray, can), exact), [&] { return describe(ray, can); });
    }
    return tally.figures();
}

template <typename Draw>
HardCaseFigures runPlane(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto [ray, plane] = make(draw, i);
        const std::optional<Quad> exact = rayPlaneExact(ray, plane);
        tally.add(hitError(rayPlaneNaive(ray, plane), exact), hitError(rayPlaneDistance(ray, plane), exact),
                  [&, ray = ray, plane = plane] { return describe(ray, plane); });
    }
    return tally.figures();
}

using RayAndPlane = std::pair<Ray, Plane>;

HardCaseFigures runPlaneGrazing(std::uint64_t inputs, std::uint64_t seed) {
    return runPlane(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        const glm::dvec3 n = draw.direction();
        const glm::vec3 point = draw.vectorOfMagnitude(-3, 10);
        const double size = draw.magnitude(-30, 30);
        const glm::vec3 normal(size * n);
        const Plane plane{normal, static_cast<float>(-glm::dot(glm::dvec3(normal), glm::dvec3(point)))};
        const glm::dvec3 along = draw.perpendicular(n);
        const glm::vec3 origin(glm::dvec3(point) + draw.magnitude(-20, 3) * n * draw.sign());
        const glm::dvec3 direction = i % 4 == 0 ? along : along - draw.sign() * draw.magnitude(-24, 0) * n;
        return RayAndPlane{{origin, glm::vec3(draw.magnitude(-30, 30) * direction)}, plane};
    });
}

HardCaseFigures runPlaneTouching(std::uint64_t inputs, std::uint64_t seed) {
    return runPlane(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        glm::vec3 n;
        do
            n = wholeVector(draw, 9);
        while (n == glm::vec3(0));
        const glm::vec3 point = wholeVector(draw, 4000);
        const Plane plane{n, -glm::dot(n, point)};
        glm::vec3 direction = i % 2 == 0 ? glm::cross(n, wholeVector(draw, 9)) : wholeVector(draw, 9);
        if (direction == glm::vec3(0))
            direction = n;
        const glm::vec3 origin = i % 3 == 0 ? point : point + wholeVector(draw, 2);
        const float length = std::exp2(static_cast<float>(draw.random().below(61)) - 40);
        return RayAndPlane{{origin, length * direction}, plane};
    });
}

template <typename Draw>
HardCaseFigures runBox(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const std::pair<Ray, Bounds> input = make(draw, i);
        const auto& [ray, box] = input;
        const std::optional<ExactSpan> exact = rayBoxExact(ray, box);
        const auto error = [&](const std::optional<RaySpan>& got) {
            if (got.has_value() != exact.has_value())
                return infinity;
            if (!got)
                return 0.0;
            return std::max(ulpError(static_cast<float>(std::max(got->enter, 0.0)), exact->enter),
                            ulpError(static_cast<float>(got->exit), exact->exit));
        };
        tally.add(error(rayBoxNaive(ray, box)), error(rayBox(ray, box)),
                  [&] { return describe(input.first, input.second); });
    }
    return tally.figures();
}

using RayAndBox = std::pair<Ray, Bounds>;

Bounds randomBox(StressInputs& draw, glm::vec3 centre, double size, bool mayBeFlat) {
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = size * draw.random().uniform(0.2, 1);
        box.min[axis] = static_cast<float>(centre[axis] - half);
        box.max[axis] = static_cast<float>(centre[axis] + half);
    }
    if (mayBeFlat && draw.random().below(2) == 0) {
        const int axis = static_cast<int>(draw.random().below(3));
        box.max[axis] = box.min[axis];
    }
    return box;
}

/// On a corner, an edge, a face, or inside, by how many axes are free.
glm::vec3 pointOf(StressInputs& draw, const Bounds& box) {
    glm::vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
        const auto kind = draw.random().below(3);
        point[axis] = kind == 0   ? box.min[axis]
                      : kind == 1 ? box.max[axis]
                                  : static_cast<float>(draw.random().uniform(box.min[axis], box.max[axis]));
    }
    return point;
}

HardCaseFigures runBoxInFaces(std::uint64_t inputs, std::uint64_t seed) {
    return runBox(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const Bounds box = randomBox(draw, draw.vectorOfMagnitude(-2, 6), draw.magnitude(-3, 3), true);
        const glm::vec3 on = pointOf(draw, box);
        glm::vec3 direction;
        do
            for (int axis = 0; axis < 3; ++axis)
                direction[axis] = static_cast<float>(
                    draw.random().below(2) == 0 ? draw.sign() * 0.0 : draw.random().uniform(-1, 1));
        while (direction == glm::vec3(0));
        const float back = draw.random().below(3) == 0 ? 0 : static_cast<float>(draw.magnitude(-2, 6));
        return RayAndBox{{on - back * direction, direction}, box};
    });
}

HardCaseFigures runBoxCorners(std::uint64_t inputs, std::uint64_t seed) {
    return runBox(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const glm::vec3 centre = draw.vectorOfMagnitude(0, 20);
        const Bounds box = randomBox(draw, centre, 1, true);
        const glm::vec3 origin = draw.vectorOfMagnitude(-2, 4);
        glm::vec3 direction = pointOf(draw, box) - origin;
        if (direction == glm::vec3(0))
            direction = {1, 0, 0};
        return RayAndBox{{origin, direction}, box};
    });
}

HardCaseFigures runBoxDirections(std::uint64_t inputs, std::uint64_t seed) {
    return runBox(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        const Bounds box = randomBox(draw, draw.vectorOfMagnitude(-2, 2), 1, true);
        const glm::vec3 on = pointOf(draw, box);
        glm::vec3 direction;
        do
            for (int axis = 0; axis < 3; ++axis)
                direction[axis] = static_cast<float>(
                    draw.sign() * draw.magnitude(i % 2 == 0 ? -149 : -4, i % 3 == 0 ? 127 : 4));
        while (direction == glm::vec3(0));
        glm::vec3 origin = on - static_cast<float>(draw.magnitude(-3, 3)) * direction;
        for (int axis = 0; axis < 3; ++axis)
            if (!std::isfinite(origin[axis]) || draw.random().below(4) == 0)
                origin[axis] = on[axis];
        return RayAndBox{{origin, direction}, box};
    });
}

HardCaseFigures runBoxInside(std::uint64_t inputs, std::uint64_t seed) {
    return runBox(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const Bounds box = randomBox(draw, draw.vectorOfMagnitude(-2, 8), draw.magnitude(-4, 4), false);
        glm::vec3 direction = draw.vectorOfMagnitude(-20, 20);
        if (draw.random().below(3) == 0)
            direction[static_cast<int>(draw.random().below(3))] = static_cast<float>(draw.sign() * 0.0);
        if (direction == glm::vec3(0))
            direction = {0, 0, 1};
        return RayAndBox{{pointOf(draw, box), direction}, box};
    });
}

template <typename Draw>
HardCaseFigures runBalls(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const std::pair<Ball, Ball> balls = make(draw, i);
        const bool exact = ballsOverlapExact(balls.first, balls.second);
        tally.add(verdictError(ballsOverlapNaive(balls.first, balls.second), exact),
                  verdictError(ballsOverlap(balls.first, balls.second), exact),
                  [&] { return describe(balls.first, balls.second); });
    }
    return tally.figures();
}

HardCaseFigures runBallsTouching(std::uint64_t inputs, std::uint64_t seed) {
    static constexpr std::array<std::array<int, 4>, 4> quadruples{
        {{1, 2, 2, 3}, {2, 3, 6, 7}, {4, 13, 16, 21}, {6, 10, 15, 19}}};
    return runBalls(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        const double scale = draw.magnitude(0, 12);
        const float factor = static_cast<float>(static_cast<int>(scale));
        const auto& q = quadruples[draw.random().below(quadruples.size())];
        const glm::vec3 offset =
            factor * glm::vec3(draw.sign() * q[0], draw.sign() * q[1], draw.sign() * q[2]);
        const float whole = factor * static_cast<float>(q[3]);
        float ra = std::floor(whole * static_cast<float>(draw.random().uniform(0, 1)));
        const float rb = whole - ra;
        if (i % 3 == 1)
            ra = std::nextafter(ra, 0.0f);
        if (i % 3 == 2)
            ra = std::nextafter(ra, 1e30f);
        const float size = std::exp2(static_cast<float>(draw.random().below(80)) - 40);
        return std::pair<Ball, Ball>{{glm::vec3(0), size * ra}, {size * offset, size * rb}};
    });
}

HardCaseFigures runBallsScales(std::uint64_t inputs, std::uint64_t seed) {
    return runBalls(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        const double scale = i % 3 == 0   ? draw.magnitude(40, 120)
                             : i % 3 == 1 ? draw.magnitude(-146, -70)
                                          : 1;
        const glm::dvec3 place = i % 3 == 2 ? 1e5 * draw.direction() : glm::dvec3(0);
        const double ra = draw.magnitude(-4, 2);
        const double rb = draw.magnitude(-4, 2);
        const glm::dvec3 offset = (ra + rb) * (1 + draw.sign() * draw.magnitude(-26, -1)) * draw.direction();
        return std::pair<Ball, Ball>{{glm::vec3(scale * place), static_cast<float>(scale * ra)},
                                     {glm::vec3(scale * (place + offset)), static_cast<float>(scale * rb)}};
    });
}

HardCaseFigures runBallPlane(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 n = draw.direction();
        const glm::vec3 normal(draw.magnitude(-30, 30) * n);
        Ball ball{draw.vectorOfMagnitude(0, 14), static_cast<float>(draw.magnitude(-4, 4))};
        const glm::dvec3 foot = glm::dvec3(ball.centre) +
                                draw.sign() * ball.radius * (1 + draw.sign() * draw.magnitude(-26, -1)) * n;
        Plane plane{normal, static_cast<float>(-glm::dot(glm::dvec3(normal), foot))};
        if (i % 4 == 0) {
            // Whole numbers that touch exactly: n = (2, 3, 6), |n| = 7.
            const glm::vec3 centre = wholeVector(draw, 4000);
            const float radius = static_cast<float>(1 + draw.random().below(50));
            const glm::vec3 n7(2, 3, 6);
            plane = {n7, -glm::dot(n7, centre) + static_cast<float>(draw.sign()) * 7 * radius};
            ball = {centre, i % 8 == 0 ? radius : std::nextafter(radius, draw.sign() > 0 ? 0.0f : 1e9f)};
        }
        const int side = planeSignExact(plane, ball.centre);
        const bool exact = ballMeetsPlaneExact(ball, plane);
        const Side expected = exact ? Side::crossing : side < 0 ? Side::behind : Side::inFront;
        tally.add(verdictError(ballMeetsPlaneNaive(ball, plane), exact),
                  verdictError(sideOf(ball, plane) == expected, true), [&] { return describe(ball, plane); });
    }
    return tally.figures();
}

Side exactSide(std::span<const glm::vec3> points, const Plane& plane) {
    int lowest = 1;
    int highest = -1;
    for (const glm::vec3& point : points) {
        lowest = std::min(lowest, planeSignExact(plane, point));
        highest = std::max(highest, planeSignExact(plane, point));
    }
    return lowest > 0 ? Side::inFront : highest < 0 ? Side::behind : Side::crossing;
}

HardCaseFigures runBoxPlane(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        Bounds box;
        Plane plane;
        if (i % 2 == 0) {
            const glm::vec3 low = wholeVector(draw, 50);
            box = {low, low + glm::abs(wholeVector(draw, 9))};
            plane.normal = wholeVector(draw, 3);
            if (plane.normal == glm::vec3(0))
                plane.normal = {0, 0, 1};
            plane.offset = -glm::dot(plane.normal, cornersOf(box)[draw.random().below(8)]);
        } else {
            box = randomBox(draw, glm::vec3(1e4 * draw.direction()), draw.magnitude(-3, 3), false);
            const glm::vec3 corner = cornersOf(box)[draw.random().below(8)];
            plane.normal = glm::vec3(draw.magnitude(-20, 20) * draw.nearAxis());
            plane.offset = static_cast<float>(-glm::dot(glm::dvec3(plane.normal), glm::dvec3(corner)));
        }
        const Side exact = exactSide(cornersOf(box), plane);
        tally.add(verdictError(boxMeetsPlaneNaive(box, plane), exact == Side::crossing),
                  verdictError(sideOf(box, plane) == exact && sideByEightCorners(box, plane) == exact, true),
                  [&] { return describe(box, plane); });
    }
    return tally.figures();
}

HardCaseFigures runTetrahedronPlane(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 n = draw.direction();
        const double size = draw.magnitude(-20, 20);
        const glm::vec3 normal(draw.magnitude(-10, 10) * n);
        const glm::dvec3 tip = size * glm::dvec3(draw.vectorOfMagnitude(-2, 10));
        const Plane plane{normal, static_cast<float>(-glm::dot(glm::dvec3(normal), tip))};
        std::array<glm::vec3, 4> corners;
        corners[0] = glm::vec3(tip);
        for (std::size_t k = 1; k < 4; ++k)
            corners[k] = glm::vec3(tip + size * (draw.random().uniform(0.01, 1) * n +
                                                 draw.random().uniform(0, 1) * draw.perpendicular(n)));
        const Side exact = exactSide(corners, plane);
        tally.add(verdictError(pointsMeetPlaneNaive(corners, plane), exact == Side::crossing),
                  verdictError(sideOf(corners, plane) == exact, true), [&] {
                      return fmt::format("{} {} {} {} {}", hex(corners[0]), hex(corners[1]), hex(corners[2]),
                                         hex(corners[3]), describe(plane));
                  });
    }
    return tally.figures();
}

/// In float, planes from a product of float matrices, and normalised: what every tutorial does.
bool mayBeVisibleNaive(const Bounds& box, const glm::mat4& clipFromWorld) {
    const glm::mat4 rows = glm::transpose(clipFromWorld);
    for (const glm::vec4& plane : {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1],
                                   rows[3] + rows[2], rows[3] - rows[2]}) {
        const glm::vec3 centre = 0.5f * (box.min + box.max);
        const glm::vec3 extent = box.max - centre;
        const glm::vec3 n(plane);
        if (glm::dot(n, centre) + plane.w < -glm::dot(glm::abs(n), extent))
            return false;
    }
    return true;
}

/// Boxes around points that are seen, far from the world's origin.
HardCaseFigures runFrustum(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 eye(1e5 * draw.direction());
        const glm::dvec3 forward = draw.direction();
        const glm::dvec3 up = draw.perpendicular(forward);
        const glm::dmat4 cameraFromWorld = glm::lookAt(glm::dvec3(eye), glm::dvec3(eye) + forward, up);
        const glm::dmat4 clipFromCamera = glm::perspective(1.0, 1.5, 1e-3, 1e6);
        const glm::dmat4 clipFromWorld = clipFromCamera * cameraFromWorld;
        // A point at the border of what is seen, drawn until rounding it to float leaves it inside.
        glm::vec3 point;
        for (;;) {
            const double depth = draw.magnitude(-6, 4);
            const double height = depth * std::tan(0.5);
            const glm::dvec3 right = glm::cross(forward, up);
            const bool atSide = draw.random().below(2) == 0;
            const double border = draw.sign() * (1 - draw.magnitude(-30, -4));
            const double free = draw.random().uniform(-1, 1);
            point = glm::vec3(glm::dvec3(eye) + depth * forward + height * (atSide ? free : border) * up +
                              1.5 * height * (atSide ? border : free) * right);
            const auto row = [&](int r) {
                return Quad(clipFromWorld[0][r]) * point.x + Quad(clipFromWorld[1][r]) * point.y +
                       Quad(clipFromWorld[2][r]) * point.z + Quad(clipFromWorld[3][r]);
            };
            const Quad w = row(3);
            bool seen = true;
            for (int r = 0; r < 3; ++r)
                seen = seen && row(r) <= w && row(r) >= -w;
            if (seen)
                break;
        }
        Bounds box{point, point};
        for (int axis = 0; axis < 3; ++axis)
            box.max[axis] = point[axis] + static_cast<float>(draw.magnitude(-12, -5));
        tally.add(verdictError(mayBeVisibleNaive(box, glm::mat4(clipFromCamera) * glm::mat4(cameraFromWorld)),
                               true),
                  verdictError(mayBeVisible(box, frustumOf(clipFromWorld)), true),
                  [&] { return fmt::format("{} eye={}", describe(box), hex(eye)); });
    }
    return tally.figures();
}

template <typename Draw>
HardCaseFigures runQuadratic(std::uint64_t inputs, std::uint64_t seed, const Draw& make) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 k = make(draw, i);
        const Expansion discriminant = Expansion::product(k.y, k.y) - Expansion::product(4.0 * k.x, k.z);
        const int count = 1 + discriminant.sign();
        Quad first = 0;
        Quad second = 0;
        if (count > 0) {
            // The root away from zero does not cancel; the other is c/a divided by it.
            const Quad spread = squareRoot(discriminant.toQuad());
            const Quad b = k.y;
            const Quad larger = (b < 0 ? -b + spread : -b - spread) / (2 * Quad(k.x));
            const Quad smaller = larger == 0 ? Quad(0) : Quad(k.z) / Quad(k.x) / larger;
            first = larger < smaller ? larger : smaller;
            second = larger < smaller ? smaller : larger;
        }
        const auto error = [&](int found, float x, float y) {
            if (found != count)
                return infinity;
            return count == 0 ? 0.0 : std::max(ulpError(x, first), ulpError(y, second));
        };
        const QuadraticRoots roots = solveQuadratic(k.x, k.y, k.z);
        const QuadraticRootsNaive naive = solveQuadraticNaive(k.x, k.y, k.z);
        tally.add(error(naive.count, naive.first, naive.second),
                  error(roots.count, static_cast<float>(roots.first), static_cast<float>(roots.second)),
                  [&] { return fmt::format("a,b,c={}", hex(k)); });
    }
    return tally.figures();
}

HardCaseFigures runQuadraticCancelling(std::uint64_t inputs, std::uint64_t seed) {
    return runQuadratic(inputs, seed, [](StressInputs& draw, std::uint64_t) {
        const double a = draw.sign() * draw.magnitude(-10, 10);
        const double b = draw.sign() * draw.magnitude(-10, 10);
        return glm::vec3(a, b, draw.sign() * b * b / (4 * a) / draw.magnitude(8, 40));
    });
}

HardCaseFigures runQuadraticDouble(std::uint64_t inputs, std::uint64_t seed) {
    return runQuadratic(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        if (i % 3 == 0) {
            // (p x + q)² of whole numbers, some moved by an ulp of c.
            const float p = static_cast<float>(1 + draw.random().below(2000));
            const float q = whole(draw, 2000);
            return glm::vec3(p * p, 2 * p * q, i % 2 == 0 ? q * q : std::nextafter(q * q, 1e9f));
        }
        const double a = draw.sign() * draw.magnitude(-10, 10);
        const double b = draw.sign() * draw.magnitude(-10, 10);
        return glm::vec3(a, b, b * b / (4 * a) * (1 + draw.sign() * draw.magnitude(-24, -1)));
    });
}

HardCaseFigures runQuadraticScales(std::uint64_t inputs, std::uint64_t seed) {
    return runQuadratic(inputs, seed, [](StressInputs& draw, std::uint64_t i) {
        glm::vec3 k(draw.sign() * draw.magnitude(-70, 70), draw.sign() * draw.magnitude(-70, 70),
                    draw.sign() * draw.magnitude(-70, 70));
        if (i % 4 == 0)
            k.y = 0;
        if (i % 8 < 2)
            k.z = 0;
        return k;
    });
}

constexpr const char* sphereSource = "Ray Tracing Gems (2019), ch. 7; exact where a bound leaves it open";
constexpr const char* filterSource = "Shewchuk (1997): a bound on rounding, then expansions";

constexpr std::array cases{
    HardCase{"ray-sphere", "radius 1, 2^4 … 2^20 away", "ulp", halfUlp, sphereSource, &runSphereFar},
    HardCase{"ray-sphere", "2^-40 … 2^-3 of the radius from tangent", "ulp", halfUlp, sphereSource,
             &runSphereNearlyTangent},
    HardCase{"ray-sphere", "exact tangents of whole numbers", "ulp", halfUlp, sphereSource,
             &runSphereTangent},
    HardCase{"ray-sphere", "a ground of radius 2^8 … 2^22, seen from just above", "ulp", halfUlp,
             sphereSource, &runSphereGround},
    HardCase{"ray-sphere", "sizes and directions of 2^-60 … 2^60", "ulp", halfUlp, sphereSource,
             &runSphereScales},
    HardCase{"ray-sphere", "from 2^-30 … 2^-4 of the radius off the surface", "ulp", halfUlp, sphereSource,
             &runSphereOnSurface},
    HardCase{"ray-sphere", "any finite floats", "ulp", halfUlp, sphereSource, &runSphereBits},
    HardCase{"ray-sphere", "doubles: radius 1, 2^20 … 2^50 away", "ulp", 6, sphereSource, &runSphereDouble},
    HardCase{"ray-cylinder", "2^-70 … 1 radian from the axis", "ulp", halfUlp, filterSource,
             &runCylinderSteep},
    HardCase{"ray-cylinder", "parallel to the axis", "ulp", halfUlp, filterSource, &runCylinderParallel},
    HardCase{"ray-cylinder", "radius 2^-20 … 1, up to 2^10 away", "ulp", halfUlp, filterSource,
             &runCylinderThin},
    HardCase{"ray-cylinder", "any axis and place", "ulp", halfUlp, filterSource, &runCylinderAnyAxis},
    HardCase{"ray-can", "rims, caps, tangents, rays in a cap's plane", "ulp", halfUlp, filterSource,
             &runCapped},
    HardCase{"ray-plane", "2^-24 … 1 radian to the plane, normals of any length", "ulp", halfUlp,
             filterSource, &runPlaneGrazing},
    HardCase{"ray-plane", "whole numbers: in the plane, parallel, short directions", "ulp", halfUlp,
             filterSource, &runPlaneTouching},
    HardCase{"ray-box", "from and in faces, along ±0", "ulp", halfUlp,
             "Kay and Kajiya (1986), compared exactly", &runBoxInFaces},
    HardCase{"ray-box", "at corners, edges and flat boxes up to 2^20 away", "ulp", halfUlp,
             "Kay and Kajiya (1986), compared exactly", &runBoxCorners},
    HardCase{"ray-box", "components of 2^-149 … 2^127", "ulp", halfUlp,
             "Kay and Kajiya (1986), compared exactly", &runBoxDirections},
    HardCase{"ray-box", "from inside and from the surface", "ulp", halfUlp,
             "Kay and Kajiya (1986), compared exactly", &runBoxInside},
    HardCase{"sphere-sphere", "touching whole numbers, ±1 ulp", "wrong", 0, filterSource, &runBallsTouching},
    HardCase{"sphere-sphere", "2^-146 … 2^120, and far from the origin", "wrong", 0, filterSource,
             &runBallsScales},
    HardCase{"sphere-plane", "normals of 2^-30 … 2^30, touching", "wrong", 0, filterSource, &runBallPlane},
    HardCase{"box-plane", "planes through corners, edges, faces", "wrong", 0, filterSource, &runBoxPlane},
    HardCase{"tetrahedron-plane", "a corner (almost) in the plane", "wrong", 0, filterSource,
             &runTetrahedronPlane},
    HardCase{"frustum-box", "camera at 1e5, boxes at the frustum's border", "wrong", 0,
             "Gribb and Hartmann (2001), in double", &runFrustum},
    HardCase{"quadratic", "b² above 4ac by 2^8 … 2^40", "ulp", 0.5 + 0x1p-26,
             "Goldberg (1991); Numerical Recipes, 5.6", &runQuadraticCancelling},
    HardCase{"quadratic", "double roots, and nearly so", "ulp", 0.5 + 0x1p-26,
             "Goldberg (1991); Numerical Recipes, 5.6", &runQuadraticDouble},
    HardCase{"quadratic", "coefficients of 2^-70 … 2^70, and 0", "ulp", 0.5 + 0x1p-26,
             "Goldberg (1991); Numerical Recipes, 5.6", &runQuadraticScales},
};

}  // namespace

std::span<const HardCase> intersectionHardCases() {
    return cases;
}

}  // namespace quincunx

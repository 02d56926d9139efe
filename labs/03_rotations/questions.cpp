#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "labs/03_rotations/lab.h"
#include "math/quad_rotation.h"
#include "math/rotation_hard_cases.h"
#include "math/rotation_interpolation.h"

namespace quincunx {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double oneDegree = pi / 180;
constexpr int inputCount = 100'000;
constexpr int pairCount = 10'000;

/// Rodrigues' formula in double for a unit axis: nothing of it is shared with quaternions.
glm::dvec3 rodrigues(glm::dvec3 p, glm::dvec3 n, double radians) {
    return p * std::cos(radians) + glm::cross(n, p) * std::sin(radians) +
           n * (glm::dot(n, p) * (1 - std::cos(radians)));
}

/// The matrix of a turn about a unit axis, written out in double.
glm::dmat3 turnMatrix(glm::dvec3 n, double radians) {
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    const glm::dmat3 across(0, n.z, -n.y, -n.z, 0, n.x, n.y, -n.x, 0);
    return c * glm::dmat3(1) + s * across + (1 - c) * glm::outerProduct(n, n);
}

std::vector<Measurement> measureSandwich() {
    StressInputs draw(75);
    double againstRodrigues = 0;
    double againstMatrix = 0;
    double angle = 0;
    double naive = 0;
    int naiveWrong = 0;
    for (int i = 0; i < inputCount; ++i) {
        const glm::vec3 axis = draw.vectorOfMagnitude(-20, 20);
        const glm::dvec3 n = glm::normalize(glm::dvec3(axis));
        const glm::vec3 p = draw.unitVector();
        const auto t = static_cast<float>(draw.random().uniform(-pi, pi));
        const glm::quat q = quaternionFromAxisAngle(axis, 2 * t).value_or(glm::quat(1, 0, 0, 0));
        const glm::dvec3 turned(rotate(q, p).value_or(glm::vec3(0)));
        againstRodrigues =
            std::max(againstRodrigues, glm::length(turned - rodrigues(glm::dvec3(p), n, 2.0 * t)));
        againstMatrix = std::max(againstMatrix, glm::length(turned - turnMatrix(n, 2.0 * t) * glm::dvec3(p)));
        // Seen along the axis, p turns by 2t.
        const glm::dvec3 before = glm::cross(n, glm::dvec3(p));
        const glm::dvec3 after = glm::cross(n, turned);
        const double seen = std::atan2(glm::dot(n, glm::cross(before, after)), glm::dot(before, after));
        if (glm::length(before) > 0.1)
            angle = std::max(angle, std::abs(std::remainder(seen - 2.0 * t, 2 * pi)));
        const glm::dvec3 byCard(rotateNaive(quaternionFromAxisAngleNaive(axis, 2 * t), p));
        const double off = glm::length(byCard - rodrigues(glm::dvec3(p), n, 2.0 * t));
        naiveWrong += off < 1e-3 ? 0 : 1;
        const glm::dvec3 unitCard(rotateNaive(quaternionFromAxisAngleNaive(glm::vec3(n), 2 * t), p));
        naive = std::max(naive, glm::length(unitCard - rodrigues(glm::dvec3(p), n, 2.0 * t)));
    }
    // q is rounded to float (a turn of up to 2^-23), and so is the result (6e-8).
    return {{"q p q⁻¹ against Rodrigues in double, worst", againstRodrigues, "of |p|", atMost(1.8e-7)},
            {"against the matrix in double, worst", againstMatrix, "of |p|", atMost(1.8e-7)},
            // The same seen along the axis, where p is 0.1 to 1 from it.
            {"angle turned less 2t, worst", angle, "rad", atMost(1.8e-6)},
            {"the card's formula with a unit axis, worst", naive, "of |p|", {}},
            {"with an axis as it comes: wrong by more than 1e-3", 100.0 * naiveWrong / inputCount, "%",
             atLeast(90)}};
}

struct PathFigures {
    double angle = 0;  ///< worst distance to slerp, radians
    double ratio = 0;  ///< largest speed over smallest, worst path
};

/// Over pairs of rotations `degrees` apart.
PathFigures measurePath(double degrees, std::optional<glm::quat> (*between)(glm::quat, glm::quat, float)) {
    StressInputs draw(20);
    PathFigures figures;
    for (int i = 0; i < 40; ++i) {
        const glm::quat a(randomRotation(draw));
        const glm::quat b =
            product(quaternionFromAxisAngle(draw.unitVector(), static_cast<float>(degrees * oneDegree))
                        .value_or(glm::quat(1, 0, 0, 0)),
                    a);
        double least = 1e9;
        double most = 0;
        constexpr int steps = 256;
        std::optional<glm::quat> last;
        for (int step = 0; step <= steps; ++step) {
            const float t = static_cast<float>(step) / steps;
            const std::optional<glm::quat> q = between(a, b, t);
            const std::optional<glm::quat> right = slerp(a, b, t);
            if (!q || !right)
                continue;
            figures.angle = std::max<double>(figures.angle, rotationAngleBetween(*q, *right).value_or(0));
            if (last) {
                const double speed = rotationAngleBetween(*last, *q).value_or(0);
                least = std::min(least, speed);
                most = std::max(most, speed);
            }
            last = q;
        }
        figures.ratio = std::max(figures.ratio, most / least);
    }
    return figures;
}

std::optional<glm::quat> byMatrices(glm::quat a, glm::quat b, float t) {
    const std::optional<glm::mat3> from = matrixFromQuaternion(a);
    const std::optional<glm::mat3> to = matrixFromQuaternion(b);
    return from && to ? matrixLerp(*from, *to, t) : std::nullopt;
}

/// Largest speed over smallest of the point of a chord, seen from the centre of its arc of `radians`.
double chordSpeedRatio(double radians) {
    const double c = std::cos(radians / 2);
    return 1 / (c * c);
}

std::vector<Measurement> measureInterpolation() {
    std::vector<Measurement> figures;
    double slerpError = 0;
    StressInputs draw(7);
    for (int i = 0; i < pairCount; ++i) {
        const glm::quat a(randomRotation(draw));
        const glm::quat b(randomRotation(draw));
        const auto t = static_cast<float>(draw.random().uniformDouble());
        const QuadQuaternion exact = slerpQuad(QuadQuaternion(a), QuadQuaternion(b), t);
        const glm::quat got = slerp(a, b, t).value_or(glm::quat(1, 0, 0, 0));
        slerpError = std::max(slerpError, angleBetweenQuad(normalizeQuad(QuadQuaternion(got)), exact));
    }
    figures.push_back({"slerp against 113 bits, worst", slerpError, "rad", atMost(1.2e-7)});
    const double apart = 120;
    const PathFigures even = measurePath(apart, &slerp);
    // 256 steps of 120°/256, each end rounded by 2^-23 rad.
    figures.push_back({"120° apart: slerp, fastest over slowest", even.ratio, "times",
                       equals(1, 4 * 0x1p-23 / (apart * oneDegree / 256))});
    const PathFigures chord = measurePath(apart, &nlerp);
    figures.push_back({"nlerp, fastest over slowest", chord.ratio, "times",
                       equals(chordSpeedRatio(apart * oneDegree / 2), 0.01)});
    figures.push_back({"nlerp, farthest from slerp", chord.angle / oneDegree, "degrees", atMost(8.16)});
    const PathFigures mixed = measurePath(apart, &byMatrices);
    figures.push_back({"matrix lerp, fastest over slowest", mixed.ratio, "times",
                       equals(chordSpeedRatio(apart * oneDegree), 0.03)});
    figures.push_back({"matrix lerp, farthest from slerp", mixed.angle / oneDegree, "degrees",
                       atLeast(chord.angle / oneDegree)});
    const glm::mat3 half = matrixFromQuaternion(glm::quat(0, 0, 0, 1)).value_or(glm::mat3(1));
    figures.push_back({"180° apart: determinant of the matrix half-way",
                       glm::determinant(matrixLerpNaive(glm::mat3(1), half, 0.5f)), "", equals(0, 1e-12)});
    return figures;
}

std::vector<Measurement> measureDoubleCover() {
    StressInputs draw(9);
    double matrices = 0;
    double opposite = 0;
    int naiveFailures = 0;
    int failures = 0;
    for (int i = 0; i < pairCount; ++i) {
        const glm::dquat first = randomRotation(draw);
        const glm::quat a(first);
        const glm::mat3 one = matrixFromQuaternion(a).value_or(glm::mat3(0));
        const glm::mat3 other = matrixFromQuaternion(-a).value_or(glm::mat3(1));
        for (int column = 0; column < 3; ++column)
            matrices = std::max<double>(matrices, glm::length(one[column] - other[column]));
        const auto t = static_cast<float>(draw.random().uniformDouble());
        const std::optional<glm::quat> between = slerp(a, -a, t);
        opposite = std::max<double>(opposite, between ? *rotationAngleBetween(a, *between) : pi);
        const glm::quat near(turnedInFour(draw, first, -24, -8));
        const glm::quat naive = slerpNaive(a, near, t);
        naiveFailures += isFinite(naive) ? 0 : 1;
        const std::optional<glm::quat> stable = slerp(a, near, t);
        failures += stable && isFinite(*stable) ? 0 : 1;
    }
    return {{"matrix of q less that of −q", matrices, "", equals(0)},
            // Twice the angle of rounding.
            {"slerp from q to −q: farthest from q", opposite, "rad", atMost(2.4e-7)},
            {"nearly equal q: slerp by acos gives no number", 100.0 * naiveFailures / pairCount, "%",
             atLeast(10)},
            {"nearly equal q: slerp here gives no number", static_cast<double>(failures), "", equals(0)}};
}

std::vector<Measurement> measureQuaternions() {
    std::vector<Measurement> figures = measureSandwich();
    for (const Measurement& figure : measureInterpolation())
        figures.push_back(figure);
    for (const Measurement& figure : measureDoubleCover())
        figures.push_back(figure);
    return figures;
}

glm::quat eulerTurn(double headDegrees, double pitchDegrees, double rollDegrees, EulerOrder order) {
    return quaternionFromEuler(
               {static_cast<float>(headDegrees * oneDegree), static_cast<float>(pitchDegrees * oneDegree),
                static_cast<float>(rollDegrees * oneDegree)},
               order)
        .value_or(glm::quat(1, 0, 0, 0));
}

/// The angle of Rx Ry Rx⁻¹ Ry⁻¹, degrees.
double commutatorDegrees(double degrees) {
    const auto radians = static_cast<float>(degrees * oneDegree);
    const glm::quat x = quaternionFromAxisAngle({1, 0, 0}, radians).value_or(glm::quat(1, 0, 0, 0));
    const glm::quat y = quaternionFromAxisAngle({0, 1, 0}, radians).value_or(glm::quat(1, 0, 0, 0));
    return rotationAngleBetween(product(x, y), product(y, x)).value_or(0) / oneDegree;
}

std::vector<Measurement> measureOrders() {
    std::vector<Measurement> figures;
    double nearest = 180;
    double farthest = 0;
    for (std::size_t i = 0; i < eulerOrders.size(); ++i)
        for (std::size_t j = i + 1; j < eulerOrders.size(); ++j) {
            const double angle = rotationAngleBetween(eulerTurn(90, 40, 30, eulerOrders[i]),
                                                      eulerTurn(90, 40, 30, eulerOrders[j]))
                                     .value_or(0) /
                                 oneDegree;
            nearest = std::min(nearest, angle);
            farthest = std::max(farthest, angle);
        }
    figures.push_back(
        {"head 90°, pitch 40°, roll 30°: two nearest of the six orders", nearest, "degrees", atLeast(10)});
    figures.push_back({"two farthest of the six orders", farthest, "degrees", {}});
    // cos of half the angle is 1 − 2 sin⁴(a/2): 120° for 90°, and a² for small a.
    figures.push_back({"90° about x and y, undone in the wrong order, leaves", commutatorDegrees(90),
                       "degrees", equals(120, 2e-5)});
    figures.push_back({"1°: leaves, over the square of the angle",
                       commutatorDegrees(1) * oneDegree / (oneDegree * oneDegree), "", equals(1, 1e-3)});
    return figures;
}

std::vector<Measurement> measureLock() {
    std::vector<Measurement> figures;
    const auto span = [](double pitchDegrees) {
        const glm::dmat3 axes =
            gimbalAxes({0.6f, static_cast<float>(pitchDegrees * oneDegree), -0.3f}, EulerOrder::zxy);
        return std::abs(glm::dot(axes[0], glm::cross(axes[1], axes[2])));
    };
    figures.push_back({"pitch 0°: volume spanned by the three axes", span(0), "", equals(1, 1e-15)});
    // The cosine of π/2 rounded to float, 4.4e-8.
    figures.push_back({"pitch 90°: volume spanned by the three axes", span(90), "", atMost(4.4e-8)});
    figures.push_back(
        {"pitch 90°: head +40° undone by roll, angle left",
         rotationAngleBetween(eulerTurn(20, 90, 10, EulerOrder::zxy), eulerTurn(60, 90, -30, EulerOrder::zxy))
                 .value_or(pi) /
             oneDegree,
         "degrees", atMost(3e-5)});
    figures.push_back(
        {"pitch 0°: the same, angle left",
         rotationAngleBetween(eulerTurn(20, 0, 10, EulerOrder::zxy), eulerTurn(60, 0, -30, EulerOrder::zxy))
                 .value_or(0) /
             oneDegree,
         "degrees", atLeast(40)});
    const HardCaseFigures locked = runEulerLock(30'000, 104);
    const HardCaseFigures matrices = runEulerMatrix(30'000, 104);
    figures.push_back({"locked, six orders: extracted angles that are no numbers",
                       static_cast<double>(locked.stableFailures), "", equals(0)});
    figures.push_back({"locked, six orders: angles turn as the quaternion, worst", locked.stableError, "rad",
                       atMost(1.8e-7)});
    figures.push_back({"the textbook's asin and atan2: worst", locked.naiveError, "rad", {}});
    figures.push_back(
        {"the textbook's: no numbers", static_cast<double>(locked.naiveFailures), "of 30000", {}});
    figures.push_back({"near lock: matrix to angles to matrix, worst", matrices.stableError, "‖M − M'‖/√2",
                       atMost(2.5e-7)});
    return figures;
}

std::vector<Measurement> measureEuler() {
    std::vector<Measurement> figures = measureOrders();
    for (const Measurement& figure : measureLock())
        figures.push_back(figure);
    return figures;
}

}  // namespace

std::vector<Question> RotationsLab::questions() {
    return {
        {75, "How does a quaternion turn a point or a vector p by the angle 2t about an axis u?",
         "With u of unit length, q = (cos t, sin t u) and p' = q p q⁻¹, p taken as a quaternion without real "
         "part. Half the angle stands in q because q acts from both sides. q and −q turn alike. For |q| = 1 "
         "the inverse is the conjugate; dividing by |q|² makes any length right. To go from one turn to "
         "another at constant speed, walk the arc between the two quaternions (slerp), to the nearer of b "
         "and "
         "−b; the chord made unit length (nlerp) takes the same path, faster in the middle; mixed matrix "
         "entries are no rotations.",
         "the formula holds for an axis of unit length only", [](Studio&) { return measureQuaternions(); }},
        {104, "A turn is made of head, pitch and roll about the world's axes: does the order matter?",
         "Yes: turns about different axes do not commute, so the six orders give six rotations; two turns by "
         "a small angle a miss each other by a². Whatever the order, when the middle turn is ±90° it lays "
         "the "
         "last axis on the first: head and roll then do the same, and about one direction nothing turns. "
         "That "
         "is the gimbal lock. The rotation is still well defined; of the two angles only their sum or "
         "difference is, so extraction sets one to zero.",
         "", [](Studio&) { return measureEuler(); }},
    };
}

}  // namespace quincunx

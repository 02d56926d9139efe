#include "math/rotation_hard_cases.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "math/euler.h"
#include "math/quad_rotation.h"
#include "math/quaternion.h"
#include "math/rotation_interpolation.h"
#include "math/ulp.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

/// What math/vector.h calls 0.5 ulp.
constexpr double halfUlp = 0.5 + 0x1p-26;
/// Rounding a unit quaternion to float: 2^-23, and 1 % for what double arithmetic adds.
constexpr double roundedTurn = 1.2e-7;

std::string hex(glm::quat q) {
    return fmt::format("(w={:a},{:a},{:a},{:a})", q.w, q.x, q.y, q.z);
}
std::string hex(glm::vec3 v) {
    return hexVector(v);
}
std::string hex(float x) {
    return fmt::format("{:a}", x);
}
std::string hex(const glm::mat3& m) {
    return "columns" + hex(m[0]) + hex(m[1]) + hex(m[2]);
}

bool isFinite(const glm::mat3& m) {
    return quincunx::isFinite(m[0]) && quincunx::isFinite(m[1]) && quincunx::isFinite(m[2]);
}

double ulps(glm::quat got, const QuadQuaternion& exact) {
    return worse(worse(ulpError(got.w, exact.w), ulpError(got.x, exact.v.x)),
                 worse(ulpError(got.y, exact.v.y), ulpError(got.z, exact.v.z)));
}

double lengthOf(const QuadQuaternion& q) {
    return static_cast<double>(squareRoot(dotQuad(q, q)));
}

/// The angle to the exact rotation (of length 1), or the distance from the unit sphere.
double turnError(glm::quat got, const QuadQuaternion& exact) {
    if (!quincunx::isFinite(got))
        return infinity;
    const QuadQuaternion q(got);
    const double length = lengthOf(q);
    return length > 0 ? std::max(angleBetweenQuad(normalizeQuad(q), exact), std::abs(length - 1)) : infinity;
}

template <typename Exact>
double turnError(const std::optional<glm::quat>& got, const Exact& exact) {
    return got ? turnError(*got, exact) : infinity;
}

double distance(glm::vec3 got, const QuadVector& exact) {
    const QuadVector d = QuadVector(got) - exact;
    const auto squared = static_cast<double>(dotQuad(d, d));
    return squared >= 0 ? std::sqrt(squared) : infinity;
}

double lengthOf(const QuadVector& v) {
    return static_cast<double>(lengthQuad(v));
}

double orthonormalityError(const glm::mat3& m) {
    double error = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            error = worse(error, std::abs(dotInDouble(m[i], m[j]) - (i == j ? 1 : 0)));
    return error;
}

glm::quat ofLength(glm::dquat unit, double length) {
    return glm::quat(unit * length);
}

/// Half of the pairs exactly opposite, the others 2^-24 … 2^-1 from it.
std::pair<glm::quat, glm::quat> oppositePair(StressInputs& draw) {
    const glm::dquat a = randomRotation(draw);
    const glm::dquat b = draw.random().below(2) == 0 ? a : turnedInFour(draw, a, -24, -1);
    return {glm::quat(a), glm::quat(-b)};
}

glm::quat fromAxisAngle(glm::dvec3 axis, double radians) {
    const glm::dvec3 v = std::sin(radians / 2) * axis;
    return glm::quat(glm::dquat(std::cos(radians / 2), v.x, v.y, v.z));
}

float anyAngle(StressInputs& draw) {
    static constexpr std::array<double, 5> special = {0, pi, 2 * pi, -pi, 4 * pi};
    const std::uint64_t choice = draw.random().below(10);
    return static_cast<float>(choice < special.size() ? special[choice]
                                                      : draw.sign() * draw.magnitude(-60, 30));
}

/// `naive` and `stable` take (a, b, t).
template <typename Draw, typename Naive, typename Stable, typename Exact>
HardCaseFigures runPath(std::uint64_t inputs, std::uint64_t seed, double lowT, double highT,
                        const Draw& drawPair, const Naive& naive, const Stable& stable, const Exact& exact) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const std::pair<glm::quat, glm::quat> ends = drawPair(draw);
        const auto t = i % 16 == 0   ? 0.0f
                       : i % 16 == 1 ? 1.0f
                                     : static_cast<float>(draw.random().uniform(lowT, highT));
        const QuadQuaternion between = exact(QuadQuaternion(ends.first), QuadQuaternion(ends.second), t);
        tally.add(turnError(naive(ends.first, ends.second, t), between),
                  turnError(stable(ends.first, ends.second, t), between),
                  [&] { return "a=" + hex(ends.first) + " b=" + hex(ends.second) + " t=" + hex(t); });
    }
    return tally.figures();
}

template <typename Draw>
HardCaseFigures runSlerp(std::uint64_t inputs, std::uint64_t seed, const Draw& drawPair, double lowT = 0,
                         double highT = 1) {
    return runPath(inputs, seed, lowT, highT, drawPair, slerpNaive, slerp, slerpQuad);
}

template <typename Draw>
HardCaseFigures runEulerRoundTrip(std::uint64_t inputs, std::uint64_t seed, const Draw& middle) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const EulerOrder order = eulerOrders[i % 6];
        const std::array<int, 3> axes = eulerAxes(order);
        std::array<double, 3> angles{};
        angles[static_cast<std::size_t>(axes[0])] = draw.random().uniform(-pi, pi);
        angles[static_cast<std::size_t>(axes[1])] = middle(draw);
        angles[static_cast<std::size_t>(axes[2])] = draw.random().uniform(-pi, pi);
        glm::dquat product(1, 0, 0, 0);
        for (const int axis : axes) {
            glm::dvec3 unit(0);
            unit[axis] = 1;
            product = product * glm::angleAxis(angles[static_cast<std::size_t>(axis)], unit);
        }
        const glm::quat q(product);
        const QuadQuaternion exact = normalizeQuad(QuadQuaternion(q));
        const auto back = [&](EulerAngles got) {
            return std::isfinite(got.head) && std::isfinite(got.pitch) && std::isfinite(got.roll)
                       ? angleBetweenQuad(quaternionFromEulerQuad(got, order), exact)
                       : infinity;
        };
        const std::optional<EulerAngles> stable = eulerFromQuaternion(q, order);
        tally.add(back(eulerFromMatrixNaive(matrixFromQuaternionNaive(q), order)),
                  stable ? back(*stable) : infinity,
                  [&] { return fmt::format("{} q={}", eulerOrderName(order), hex(q)); });
    }
    return tally.figures();
}

}  // namespace

glm::dquat randomRotation(StressInputs& draw) {
    const double share = draw.random().uniformDouble();
    const double first = draw.random().uniform(0, 2 * pi);
    const double second = draw.random().uniform(0, 2 * pi);
    const double a = std::sqrt(1 - share);
    const double b = std::sqrt(share);
    return {b * std::cos(second), a * std::sin(first), a * std::cos(first), b * std::sin(second)};
}

glm::dquat turnedInFour(StressInputs& draw, glm::dquat unit, double lowExponent, double highExponent) {
    for (;;) {
        const glm::dquat other = randomRotation(draw);
        const glm::dquat across = other - unit * glm::dot(unit, other);
        const double squared = glm::dot(across, across);
        if (squared < 0.01)
            continue;
        const double angle = draw.magnitude(lowExponent, highExponent);
        return unit * std::cos(angle) + across * (std::sin(angle) / std::sqrt(squared));
    }
}

HardCaseFigures runQuaternionNormalize(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::quat q = ofLength(randomRotation(draw), draw.magnitude(-148, 127));
        if (i % 2 == 0)
            q = {draw.finiteFloat(), draw.finiteFloat(), draw.finiteFloat(), draw.finiteFloat()};
        const bool zero = q == glm::quat(0, 0, 0, 0);
        const QuadQuaternion exact = zero ? QuadQuaternion() : normalizeQuad(QuadQuaternion(q));
        const std::optional<glm::quat> stable = normalize(q);
        tally.add(zero ? infinity : ulps(normalizeNaive(q), exact),
                  zero ? (stable ? infinity : 0) : (stable ? ulps(*stable, exact) : infinity),
                  [&] { return "q=" + hex(q); });
    }
    return tally.figures();
}

HardCaseFigures runRelativeRotation(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dquat first = randomRotation(draw);
        const glm::quat a = inverseNaive(glm::quat(first));
        const glm::quat b(turnedInFour(draw, first, -22, -1));
        const QuadVector exact = productQuad(QuadQuaternion(a), QuadQuaternion(b)).v;
        const double length = lengthOf(exact);
        const auto error = [&](glm::quat got) {
            const double off = distance({got.x, got.y, got.z}, exact);
            return length > 0 ? off / length : (off == 0 ? 0 : infinity);
        };
        tally.add(error(productNaive(a, b)), error(product(a, b)),
                  [&] { return "a=" + hex(a) + " b=" + hex(b); });
    }
    return tally.figures();
}

HardCaseFigures runQuaternionInverse(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::quat q = ofLength(randomRotation(draw), draw.magnitude(-120, 120));
        const QuadQuaternion exact =
            Quad(1) / dotQuad(QuadQuaternion(q), QuadQuaternion(q)) * conjugateQuad(QuadQuaternion(q));
        const std::optional<glm::quat> stable = inverse(q);
        tally.add(ulps(inverseNaive(q), exact), stable ? ulps(*stable, exact) : infinity,
                  [&] { return "q=" + hex(q); });
    }
    return tally.figures();
}

HardCaseFigures runQuaternionRotate(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::quat q = ofLength(randomRotation(draw), draw.magnitude(-60, 60));
        const glm::vec3 p = draw.vectorOfMagnitude(-60, 60);
        const QuadVector exact = rotateQuad(QuadQuaternion(q), QuadVector(p));
        const double length = lengthOf(exact);
        const std::optional<glm::vec3> stable = rotate(q, p);
        tally.add(distance(rotateNaive(q, p), exact) / length,
                  stable ? distance(*stable, exact) / length : infinity,
                  [&] { return "q=" + hex(q) + " p=" + hex(p); });
    }
    return tally.figures();
}

HardCaseFigures runQuaternionToMatrix(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::quat q = ofLength(randomRotation(draw), draw.magnitude(-60, 60));
        const QuadMatrix exact = matrixQuad(QuadQuaternion(q));
        const auto error = [&](const glm::mat3& m) {
            return isFinite(m) ? std::max(orthonormalityError(m), distanceQuad(toQuad(m), exact)) : infinity;
        };
        const std::optional<glm::mat3> stable = matrixFromQuaternion(q);
        tally.add(error(matrixFromQuaternionNaive(q)), stable ? error(*stable) : infinity,
                  [&] { return "q=" + hex(q); });
    }
    return tally.figures();
}

namespace {

/// ‖R(got) − nearest rotation‖ as an angle, or the distance from the unit sphere.
double nearestError(const std::optional<glm::quat>& got, const QuadMatrix& exact) {
    if (!got || !quincunx::isFinite(*got))
        return infinity;
    const QuadQuaternion q(*got);
    const double length = lengthOf(q);
    return length > 0 ? std::max(distanceQuad(matrixQuad(q), exact), std::abs(length - 1)) : infinity;
}

void tallyMatrix(Tally& tally, const glm::mat3& m) {
    const QuadMatrix exact = nearestRotationQuad(toQuad(m));
    tally.add(nearestError(quaternionFromMatrixNaive(m), exact), nearestError(quaternionFromMatrix(m), exact),
              [&] { return "m=" + hex(m); });
}

}  // namespace

HardCaseFigures runMatrixToQuaternion(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double radians = i % 4 == 0 ? pi : pi - draw.magnitude(-24, -2);
        const glm::dvec3 axis = i % 3 == 0 ? draw.nearAxis() : draw.direction();
        const glm::dvec3 v = std::sin(radians / 2) * axis;
        tallyMatrix(tally, glm::mat3(glm::mat3_cast(glm::dquat(std::cos(radians / 2), v.x, v.y, v.z))));
    }
    return tally.figures();
}

HardCaseFigures runStretchedMatrixToQuaternion(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dmat3 axes = draw.rotation();
        glm::dmat3 stretch(0);
        for (int k = 0; k < 3; ++k)
            stretch[k][k] = draw.magnitude(-4, 4);
        const double size = draw.magnitude(-50, 50);
        tallyMatrix(tally, glm::mat3(size * draw.rotation() * axes * stretch * glm::transpose(axes)));
    }
    return tally.figures();
}

HardCaseFigures runAxisAngle(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 axis = draw.vectorOfMagnitude(-70, 60);
        const float radians = anyAngle(draw);
        const QuadQuaternion exact = quaternionFromAxisAngleQuad(QuadVector(axis), radians);
        const std::optional<glm::quat> stable = quaternionFromAxisAngle(axis, radians);
        tally.add(ulps(quaternionFromAxisAngleNaive(axis, radians), exact),
                  stable ? ulps(*stable, exact) : infinity,
                  [&] { return "axis=" + hex(axis) + " radians=" + hex(radians); });
    }
    return tally.figures();
}

HardCaseFigures runRodrigues(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 axis = draw.vectorOfMagnitude(-70, 60);
        const glm::vec3 p = draw.vectorOfMagnitude(-60, 60);
        const float radians = anyAngle(draw);
        const QuadVector exact =
            rotateQuad(quaternionFromAxisAngleQuad(QuadVector(axis), radians), QuadVector(p));
        const double length = lengthOf(exact);
        const std::optional<glm::vec3> stable = rotateAboutAxis(p, axis, radians);
        tally.add(distance(rotateAboutAxisNaive(p, axis, radians), exact) / length,
                  stable ? distance(*stable, exact) / length : infinity,
                  [&] { return "p=" + hex(p) + " axis=" + hex(axis) + " radians=" + hex(radians); });
    }
    return tally.figures();
}

HardCaseFigures runAxisAngleExtraction(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 axis = draw.direction();
        const glm::quat q =
            fromAxisAngle(axis, (i % 2 == 0 ? 0 : 2 * pi) + draw.sign() * draw.magnitude(-24, 0));
        const QuadQuaternion exactQ(q);
        const Quad sine = lengthQuad(exactQ.v);
        const bool reversed = exactQ.w < 0;
        const Quad angle = 2 * arcTangent(sine, reversed ? -exactQ.w : exactQ.w);
        const QuadVector exact = (reversed ? -angle : angle) / sine * exactQ.v;
        const auto error = [&](const AxisAngle& got) {
            const glm::dvec3 r = static_cast<double>(got.radians) * glm::dvec3(got.axis);
            // The longer way round is as good an answer.
            const glm::dvec3 other = (got.radians - 2 * pi) * glm::dvec3(got.axis);
            const auto off = [&](glm::dvec3 v) { return lengthOf(QuadVector(v) - exact); };
            return quincunx::isFinite(r) ? std::min(off(r), off(other)) / static_cast<double>(angle)
                                         : infinity;
        };
        const std::optional<AxisAngle> stable = axisAngleFromQuaternion(q);
        tally.add(error(axisAngleFromQuaternionNaive(q)), stable ? error(*stable) : infinity,
                  [&] { return "q=" + hex(q); });
    }
    return tally.figures();
}

HardCaseFigures runRotationVector(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 r = i % 100 == 0 ? glm::vec3(0) : draw.vectorOfMagnitude(-140, 1);
        const Quad angle = lengthQuad(QuadVector(r));
        const QuadSineCosine half = sineCosine(angle / 2);
        const QuadQuaternion exact =
            angle > 0 ? QuadQuaternion(half.cosine, half.sine / angle * QuadVector(r)) : QuadQuaternion();
        const std::optional<glm::quat> stable = quaternionFromRotationVector(r);
        tally.add(ulps(quaternionFromRotationVectorNaive(r), exact), stable ? ulps(*stable, exact) : infinity,
                  [&] { return "r=" + hex(r); });
    }
    return tally.figures();
}

HardCaseFigures runShortestArc(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = draw.direction();
        const auto from = static_cast<glm::vec3>(draw.magnitude(-60, 60) * direction);
        glm::vec3 to(-draw.magnitude(-60, 60) * draw.turned(direction, -24, 0));
        if (i % 4 == 0)
            to = static_cast<float>(std::exp2(std::floor(draw.random().uniform(-60, 60)))) * -from;
        const QuadVector start = normalizeQuad(QuadVector(from));
        const QuadVector goal = normalizeQuad(QuadVector(to));
        const Quad halfCosine = lengthQuad(start + goal) / 2;
        const Quad halfSine = lengthQuad(start - goal) / 2;
        const auto error = [&](glm::quat q) {
            if (!quincunx::isFinite(q) || q == glm::quat(0, 0, 0, 0))
                return infinity;
            const QuadQuaternion unit = normalizeQuad(QuadQuaternion(q));
            const double missed = lengthOf(rotateQuad(unit, start) - goal);
            const double excess = std::abs(static_cast<double>(
                2 * (arcTangent(lengthQuad(unit.v), unit.w) - arcTangent(halfSine, halfCosine))));
            return std::max(std::max(missed, excess), std::abs(lengthOf(QuadQuaternion(q)) - 1));
        };
        const std::optional<glm::quat> stable = shortestArc(from, to);
        tally.add(error(shortestArcNaive(normalizeNaive(from), normalizeNaive(to))),
                  stable ? error(*stable) : infinity, [&] { return "from=" + hex(from) + " to=" + hex(to); });
    }
    return tally.figures();
}

HardCaseFigures runRotationAngle(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dquat first = randomRotation(draw);
        const glm::quat a(first);
        const glm::quat b(turnedInFour(draw, first, -22, -1) * draw.sign());
        const QuadQuaternion between = productQuad(conjugateQuad(QuadQuaternion(a)), QuadQuaternion(b));
        const Quad exact = 2 * arcTangent(lengthQuad(between.v), between.w < 0 ? -between.w : between.w);
        const auto error = [&](double got) {
            return exact == 0 ? (got == 0 ? 0 : infinity)
                              : std::abs(static_cast<double>((Quad(got) - exact) / exact));
        };
        const std::optional<float> stable = rotationAngleBetween(a, b);
        tally.add(error(rotationAngleBetweenNaive(a, b)), stable ? error(*stable) : infinity,
                  [&] { return "a=" + hex(a) + " b=" + hex(b); });
    }
    return tally.figures();
}

HardCaseFigures runQuaternionDrift(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    glm::quat naive(1, 0, 0, 0);
    glm::quat stable(1, 0, 0, 0);
    glm::quat turn(1, 0, 0, 0);
    const auto error = [](glm::quat q) {
        return quincunx::isFinite(q) ? std::abs(lengthOf(QuadQuaternion(q)) - 1) : infinity;
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        if (i % (1u << 20) == 0) {
            turn = fromAxisAngle(draw.direction(), draw.random().uniform(0.01, 1));
            naive = stable = glm::quat(1, 0, 0, 0);
        }
        naive = productNaive(turn, naive);
        stable = compose(turn, stable).value_or(glm::quat(0, 0, 0, 0));
        tally.add(error(naive), error(stable), [&] { return "turn=" + hex(turn) + " q=" + hex(stable); });
    }
    return tally.figures();
}

HardCaseFigures runSlerpNear(std::uint64_t inputs, std::uint64_t seed) {
    return runSlerp(inputs, seed, [](StressInputs& draw) {
        const glm::dquat a = randomRotation(draw);
        return std::pair(glm::quat(a), glm::quat(turnedInFour(draw, a, -24, -1)));
    });
}

HardCaseFigures runSlerpOpposite(std::uint64_t inputs, std::uint64_t seed) {
    return runSlerp(inputs, seed, oppositePair);
}

HardCaseFigures runSlerpHalfTurn(std::uint64_t inputs, std::uint64_t seed) {
    return runSlerp(inputs, seed, [](StressInputs& draw) {
        const glm::dquat first = randomRotation(draw);
        const glm::quat a(first);
        if (draw.random().below(2) == 0) {
            // A product with i, j or k has a·b = 0 exactly; its nearest neighbours lie on either side.
            glm::quat b = draw.random().below(2) == 0 ? glm::quat(-a.x, a.w, a.z, -a.y)
                                                      : glm::quat(-a.z, -a.y, a.x, a.w);
            if (draw.random().below(2) == 0)
                b.w = std::nextafter(b.w, static_cast<float>(2 * draw.sign()));
            return std::pair(a, b);
        }
        const glm::dquat across(-first.x, first.w, first.z, -first.y);
        const double angle = draw.sign() * draw.magnitude(-24, -1);
        return std::pair(a, glm::quat(across * std::cos(angle) + first * std::sin(angle)));
    });
}

HardCaseFigures runSlerpAnyLength(std::uint64_t inputs, std::uint64_t seed) {
    return runSlerp(inputs, seed, [](StressInputs& draw) {
        return std::pair(ofLength(randomRotation(draw), draw.magnitude(-60, 60)),
                         ofLength(randomRotation(draw), draw.magnitude(-60, 60)));
    });
}

HardCaseFigures runSlerpBeyond(std::uint64_t inputs, std::uint64_t seed) {
    return runSlerp(inputs, seed, oppositePair, -4, 5);
}

HardCaseFigures runNlerpOpposite(std::uint64_t inputs, std::uint64_t seed) {
    return runPath(inputs, seed, 0, 1, oppositePair, nlerpNaive, nlerp,
                   [](const QuadQuaternion& from, const QuadQuaternion& to, Quad t) {
                       const QuadQuaternion a = normalizeQuad(from);
                       QuadQuaternion b = normalizeQuad(to);
                       if (dotQuad(from, to) < 0)
                           b = Quad(-1) * b;
                       return normalizeQuad((1 - t) * a + t * b);
                   });
}

HardCaseFigures runMatrixLerp(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dmat3 first = draw.rotation();
        const glm::dvec3 axis = draw.direction();
        const double radians = pi - draw.magnitude(-4, 0);
        const glm::dvec3 v = std::sin(radians / 2) * axis;
        const glm::mat3 a(first);
        const glm::mat3 b(glm::mat3_cast(glm::dquat(std::cos(radians / 2), v.x, v.y, v.z)) * first);
        const auto t = static_cast<float>(draw.random().uniform(0, 1));
        QuadMatrix mixture;
        for (int column = 0; column < 3; ++column)
            mixture[static_cast<std::size_t>(column)] =
                (1 - Quad(t)) * QuadVector(a[column]) + Quad(t) * QuadVector(b[column]);
        const QuadMatrix exact = nearestRotationQuad(mixture);
        tally.add(distanceQuad(toQuad(matrixLerpNaive(a, b, t)), exact),
                  nearestError(matrixLerp(a, b, t), exact),
                  [&] { return "a=" + hex(a) + " b=" + hex(b) + " t=" + hex(t); });
    }
    return tally.figures();
}

HardCaseFigures runEulerLock(std::uint64_t inputs, std::uint64_t seed) {
    return runEulerRoundTrip(inputs, seed, [](StressInputs& draw) { return draw.sign() * pi / 2; });
}

HardCaseFigures runEulerNearLock(std::uint64_t inputs, std::uint64_t seed) {
    return runEulerRoundTrip(inputs, seed, [](StressInputs& draw) {
        return draw.sign() * (pi / 2 - draw.sign() * draw.magnitude(-24, -4));
    });
}

HardCaseFigures runEulerMatrix(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const EulerOrder order = eulerOrders[i % 6];
        const std::array<int, 3> axes = eulerAxes(order);
        EulerAngles angles;
        angles.about(axes[0]) = static_cast<float>(draw.random().uniform(-pi, pi));
        angles.about(axes[2]) = static_cast<float>(draw.random().uniform(-pi, pi));
        // Float π/2 is 4.4e-8 short of it: the matrix is that of a locked gimbal.
        angles.about(axes[1]) =
            static_cast<float>(draw.sign() * (i % 3 == 0 ? pi / 2 : pi / 2 - draw.magnitude(-24, 0)));
        const glm::mat3 m = matrixFromEuler(angles, order).value_or(glm::mat3(0));
        const auto back = [&](EulerAngles got) {
            return std::isfinite(got.head) && std::isfinite(got.pitch) && std::isfinite(got.roll)
                       ? distanceQuad(matrixQuad(quaternionFromEulerQuad(got, order)), toQuad(m))
                       : infinity;
        };
        const std::optional<EulerAngles> stable = eulerFromMatrix(m, order);
        tally.add(back(eulerFromMatrixNaive(m, order)), stable ? back(*stable) : infinity,
                  [&] { return fmt::format("{} m={}", eulerOrderName(order), hex(m)); });
    }
    return tally.figures();
}

std::span<const HardCase> quaternionHardCases() {
    static constexpr HardCase cases[] = {
        {"normalize (quaternion)", "lengths 2^-148 … 2^127, any bit patterns", "ulp", halfUlp,
         "squares summed in double", &runQuaternionNormalize},
        {"product", "a⁻¹b of rotations 2^-21 … 1 rad apart", "relative error", 1e-7,
         "products exact in double", &runRelativeRotation},
        {"inverse (quaternion)", "lengths 2^-120 … 2^120", "ulp", halfUlp, "q* / |q|² in double",
         &runQuaternionInverse},
        {"rotate", "q and p of length 2^-60 … 2^60", "|error| / |p|", 6e-8,
         "p + (2w (v × p) + 2 v × (v × p)) / |q|²", &runQuaternionRotate},
        {"matrixFromQuaternion", "q of length 2^-60 … 2^60", "|RRᵀ − I|, or rad", 1.1e-7,
         "divided by |q|² in double", &runQuaternionToMatrix},
        {"quaternionFromMatrix", "π and 2^-24 … 2^-2 rad less, near and on axes", "rad", roundedTurn,
         "Shepperd 1978; Bar-Itzhack 2000", &runMatrixToQuaternion},
        {"quaternionFromMatrix", "stretched 256 times along any axes, scaled by 2^-50 … 2^50", "rad",
         roundedTurn, "Horn 1987, by Jacobi's method", &runStretchedMatrixToQuaternion},
        {"quaternionFromAxisAngle", "axes of length 2^-70 … 2^60; 0, π, 2π, to 2^30 rad", "ulp", halfUlp,
         "axis normalized, sine and cosine in double", &runAxisAngle},
        {"rotateAboutAxis", "axes of length 2^-70 … 2^60; 0, π, 2π, to 2^30 rad", "|error| / |p|", 6e-8,
         "Rodrigues with 2 sin² a/2", &runRodrigues},
        {"axisAngleFromQuaternion", "turns by 2^-24 … 1 rad, also past 2π", "relative error", 1.3e-7,
         "2 atan2(|v|, |w|)", &runAxisAngleExtraction},
        {"quaternionFromRotationVector", "lengths 0 and 2^-140 … 2", "ulp", halfUlp, "sin(a/2)/a in double",
         &runRotationVector},
        {"shortestArc", "opposite, exactly and to 2^-24 … 1 rad; any lengths", "rad", roundedTurn,
         "|a × b|² / (|a||b| − a·b) for the sum that cancels", &runShortestArc},
        {"rotationAngleBetween", "rotations 2^-21 … 1 rad apart, and −q", "relative error", 1e-7,
         "4 atan2(|a − b|, |a + b|); Kahan 2006", &runRotationAngle},
        {"compose", "one product after another, 10⁶ times", "| |q| − 1 |", 5.5e-8,
         "made unit length in double", &runQuaternionDrift},
    };
    return cases;
}

std::span<const HardCase> orientationHardCases() {
    static constexpr HardCase cases[] = {
        {"slerp", "2^-24 … 2^-1 apart", "rad", roundedTurn, "continued fraction of tan(sφ)/tan φ",
         &runSlerpNear},
        {"slerp", "b = −a, exactly and to 2^-24 … 2^-1", "rad", roundedTurn,
         "continued fraction of tan(sφ)/tan φ", &runSlerpOpposite},
        {"slerp", "rotations half a turn apart, a·b = 0 and next to it", "rad", roundedTurn,
         "sign of a·b exact; Shewchuk 1997", &runSlerpHalfTurn},
        {"slerp", "lengths 2^-60 … 2^60", "rad", roundedTurn, "lengths made equal in double",
         &runSlerpAnyLength},
        {"slerp", "t from −4 to 5, b near −a", "rad", roundedTurn, "sine and cosine of sφ", &runSlerpBeyond},
        {"nlerp", "b = −a, exactly and to 2^-24 … 2^-1", "rad", roundedTurn, "the nearer of b and −b",
         &runNlerpOpposite},
        {"matrixLerp", "2^-4 … 1 rad short of half a turn", "rad", roundedTurn,
         "nearest rotation in double; Horn 1987", &runMatrixLerp},
        {"eulerFromQuaternion", "locked: the middle angle ±90°, six orders", "rad", 1.8e-7,
         "outer angle rounded, the others from the remainder; Day 2012", &runEulerLock},
        {"eulerFromQuaternion", "2^-24 … 2^-4 from lock, six orders", "rad", 1.8e-7,
         "outer angle rounded, the others from the remainder; Day 2012", &runEulerNearLock},
        {"eulerFromMatrix", "locked and 2^-24 … 1 from it, six orders", "‖M − M'‖/√2", 2.5e-7,
         "nearest rotation, then as from a quaternion", &runEulerMatrix},
    };
    return cases;
}

}  // namespace quincunx

#include "labs/03_rotations/paths.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "math/rotation_interpolation.h"

namespace quincunx {
namespace {

const glm::quat identity(1, 0, 0, 0);

glm::mat3 matrixOf(const std::optional<glm::quat>& q) {
    return matrixFromQuaternion(q.value_or(identity)).value_or(glm::mat3(1));
}

}  // namespace

glm::mat3 poseAt(const Flight& flight, Method method, float t) {
    const glm::quat a = quaternionFromEuler(flight.from, flight.order).value_or(identity);
    const glm::quat b = quaternionFromEuler(flight.to, flight.order).value_or(identity);
    switch (method) {
        case Method::euler:
            return matrixFromEuler(eulerLerp(flight.from, flight.to, t), flight.order).value_or(glm::mat3(1));
        case Method::matrix:
            return matrixLerpNaive(matrixOf(a), matrixOf(b), t);
        case Method::matrixGramSchmidt:
            return matrixLerpGramSchmidtNaive(matrixOf(a), matrixOf(b), t);
        case Method::nlerp:
            return matrixOf(slerpFast<0>(a, b, t));
        case Method::slerp1:
            return matrixOf(slerpFast<1>(a, b, t));
        case Method::slerp2:
            return matrixOf(slerpFast<2>(a, b, t));
        case Method::slerp3:
            return matrixOf(slerpFast<3>(a, b, t));
        case Method::slerp5:
            return matrixOf(slerpFast<5>(a, b, t));
        case Method::slerpNaive:
            return matrixOf(slerpNearerNaive(a, b, t));
        case Method::slerp:
            break;
    }
    return matrixOf(slerp(a, b, t));
}

double relativeSpeed(const Flight& flight, Method method, float t) {
    constexpr float step = 0x1p-9f;
    const float before = std::max(t - step, 0.0f);
    const float after = std::min(t + step, 1.0f);
    const std::optional<glm::quat> first = quaternionFromMatrix(poseAt(flight, method, before));
    const std::optional<glm::quat> last = quaternionFromMatrix(poseAt(flight, method, after));
    const std::optional<glm::quat> a = quaternionFromEuler(flight.from, flight.order);
    const std::optional<glm::quat> b = quaternionFromEuler(flight.to, flight.order);
    if (!first || !last || !a || !b)
        return 0;
    const double whole = rotationAngleBetween(*a, *b).value_or(0);
    const double part = rotationAngleBetween(*first, *last).value_or(0);
    return whole > 0 ? part / ((after - before) * whole) : 0;
}

double angleToSlerp(const Flight& flight, Method method, float t) {
    const std::optional<glm::quat> got = quaternionFromMatrix(poseAt(flight, method, t));
    const std::optional<glm::quat> right = quaternionFromMatrix(poseAt(flight, Method::slerp, t));
    return got && right ? rotationAngleBetween(*got, *right).value_or(0) : std::numbers::pi;
}

}  // namespace quincunx

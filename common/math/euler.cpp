#include "math/euler.h"

#include <cmath>
#include <numbers>

#include "base/check.h"

namespace quincunx {
namespace {

/// +1 if (first, second, third) are an even permutation of x, y, z; else −1.
int parity(const std::array<int, 3>& axes) {
    return (axes[1] - axes[0] + 3) % 3 == 1 ? 1 : -1;
}

bool isFinite(EulerAngles angles) {
    return std::isfinite(angles.head) && std::isfinite(angles.pitch) && std::isfinite(angles.roll);
}

glm::dmat3 turnAbout(int axis, double radians) {
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    glm::dmat3 m(1);
    m[next][next] = c;
    m[next][last] = s;
    m[last][next] = -s;
    m[last][last] = c;
    return m;
}

/// Extraction from a rotation in double; m[column][row].
EulerAngles extract(const glm::dmat3& m, EulerOrder order) {
    const std::array<int, 3> axes = eulerAxes(order);
    const int i = axes[0];
    const int j = axes[1];
    const int k = axes[2];
    const double sign = parity(axes);
    EulerAngles angles;
    // M = Ri(α) Rj(β) Rk(γ): column k of M is Ri(α) Rj(β) ek = sin β ei ± cos β (∓ sin α, cos α).
    const double y = -sign * m[k][j];
    const double x = m[k][k];
    const double squared = x * x + y * y;
    // In lock, cos β is lost in the rounding of the entries: 8 u.
    double alpha = 0;
    double cosAlpha = 1;
    double sinAlpha = 0;
    if (squared > 0x1p-100) [[likely]] {
        const double scale = 1 / std::sqrt(squared);
        alpha = std::atan2(y, x);
        cosAlpha = x * scale;
        sinAlpha = y * scale;
    }
    angles.about(i) = static_cast<float>(alpha);

    // Sine and cosine of the rounded angle: the rounding is 2^-23 at most, its square is lost.
    const double rounding = alpha - static_cast<double>(angles.about(i));
    const double c = cosAlpha + sinAlpha * rounding;
    const double s = sign * (sinAlpha - cosAlpha * rounding);
    // Rows j and k of Ri(−α) M, which is Rj(β) Rk(γ) but for the rounding of α.
    const auto rowJ = [&](int column) { return c * m[column][j] + s * m[column][k]; };
    const double cosMiddle = c * m[k][k] - s * m[k][j];
    const double sinMiddle = sign * m[k][i];
    angles.about(j) = static_cast<float>(std::atan2(sinMiddle, cosMiddle));
    angles.about(k) = static_cast<float>(std::atan2(sign * rowJ(i), rowJ(j)));
    return angles;
}

glm::dquat quaternionAbout(int axis, double radians) {
    glm::dquat q(std::cos(radians / 2), 0, 0, 0);
    (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(radians / 2);
    return q;
}

}  // namespace

std::string_view eulerOrderName(EulerOrder order) {
    static constexpr std::array<std::string_view, 6> names = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
    return names[static_cast<std::size_t>(order)];
}

std::array<int, 3> eulerAxes(EulerOrder order) {
    const std::string_view name = eulerOrderName(order);
    return {name[0] - 'x', name[1] - 'x', name[2] - 'x'};
}

std::optional<glm::mat3> matrixFromEuler(EulerAngles angles, EulerOrder order) {
    if (!isFinite(angles))
        return std::nullopt;
    const std::array<int, 3> axes = eulerAxes(order);
    const int i = axes[0];
    const int j = axes[1];
    const int k = axes[2];
    // The product written out for i, j, k = x, y, z; where these are an odd permutation, all turns reverse.
    const double sign = parity(axes);
    const double a = angles.about(i);
    const double b = angles.about(j);
    const double c = angles.about(k);
    const double sinA = sign * std::sin(a);
    const double cosA = std::cos(a);
    const double sinB = sign * std::sin(b);
    const double cosB = std::cos(b);
    const double sinC = sign * std::sin(c);
    const double cosC = std::cos(c);
    const auto f = [](double x) { return static_cast<float>(x); };
    glm::mat3 m;
    m[i][i] = f(cosB * cosC);
    m[j][i] = f(-cosB * sinC);
    m[k][i] = f(sinB);
    m[i][j] = f(cosA * sinC + sinA * sinB * cosC);
    m[j][j] = f(cosA * cosC - sinA * sinB * sinC);
    m[k][j] = f(-sinA * cosB);
    m[i][k] = f(sinA * sinC - cosA * sinB * cosC);
    m[j][k] = f(sinA * cosC + cosA * sinB * sinC);
    m[k][k] = f(cosA * cosB);
    return m;
}

std::optional<glm::quat> quaternionFromEuler(EulerAngles angles, EulerOrder order) {
    if (!isFinite(angles))
        return std::nullopt;
    const std::array<int, 3> axes = eulerAxes(order);
    return glm::quat(quaternionAbout(axes[0], angles.about(axes[0])) *
                     quaternionAbout(axes[1], angles.about(axes[1])) *
                     quaternionAbout(axes[2], angles.about(axes[2])));
}

std::optional<EulerAngles> eulerFromQuaternion(glm::quat q, EulerOrder order) {
    const std::optional<glm::dmat3> m = matrixFromQuaternion(glm::dquat(q));
    return m ? std::optional(extract(*m, order)) : std::nullopt;
}

std::optional<EulerAngles> eulerFromMatrix(const glm::mat3& m, EulerOrder order) {
    const std::optional<glm::dquat> q = nearestQuaternion(m);
    return q ? std::optional(extract(*matrixFromQuaternion(*q), order)) : std::nullopt;
}

glm::mat3 matrixFromEulerNaive(EulerAngles angles, EulerOrder order) {
    const auto turn = [&](int axis) {
        const float c = std::cos(angles.about(axis));
        const float s = std::sin(angles.about(axis));
        const int next = (axis + 1) % 3;
        const int last = (axis + 2) % 3;
        glm::mat3 m(1);
        m[next][next] = c;
        m[next][last] = s;
        m[last][next] = -s;
        m[last][last] = c;
        return m;
    };
    const std::array<int, 3> axes = eulerAxes(order);
    return turn(axes[0]) * turn(axes[1]) * turn(axes[2]);
}

EulerAngles eulerFromMatrixNaive(const glm::mat3& m, EulerOrder order) {
    const std::array<int, 3> axes = eulerAxes(order);
    const auto sign = static_cast<float>(parity(axes));
    EulerAngles angles;
    angles.about(axes[0]) = std::atan2(-sign * m[axes[2]][axes[1]], m[axes[2]][axes[2]]);
    angles.about(axes[1]) = std::asin(sign * m[axes[2]][axes[0]]);
    angles.about(axes[2]) = std::atan2(-sign * m[axes[1]][axes[0]], m[axes[0]][axes[0]]);
    return angles;
}

glm::dmat3 gimbalAxes(EulerAngles angles, EulerOrder order) {
    QX_CHECK(isFinite(angles));
    const std::array<int, 3> axes = eulerAxes(order);
    const glm::dmat3 outer = turnAbout(axes[0], angles.about(axes[0]));
    const glm::dmat3 middle = turnAbout(axes[1], angles.about(axes[1]));
    glm::dmat3 result(0);
    result[0][axes[0]] = 1;
    result[1] = outer[axes[1]];
    result[2] = (outer * middle)[axes[2]];
    return result;
}

EulerAngles eulerLerp(EulerAngles a, EulerAngles b, float t) {
    QX_CHECK(isFinite(a) && isFinite(b) && std::isfinite(t));
    EulerAngles between;
    for (int axis = 0; axis < 3; ++axis) {
        const double from = a.about(axis);
        const double way = std::remainder(b.about(axis) - from, 2 * std::numbers::pi);
        between.about(axis) = static_cast<float>(from + t * way);
    }
    return between;
}

}  // namespace quincunx

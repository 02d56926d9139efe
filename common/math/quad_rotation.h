#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "math/euler.h"
#include "math/quad_oracle.h"
#include "math/quaternion.h"

/// Rotations in quadruple precision: the oracle of `stress`, sweeps and answers for math/quaternion.h,
/// math/rotation_interpolation.h and math/euler.h. The formulas are those of the textbooks, which 113 bits
/// make good enough: what cancels loses 30 of them. Held against MPFR by QuadRotation.*.
namespace quincunx {

struct QuadQuaternion {
    Quad w = 1;
    QuadVector v;

    QuadQuaternion() = default;
    QuadQuaternion(Quad w_, const QuadVector& v_) : w(w_), v(v_) {}
    explicit QuadQuaternion(glm::quat q) : w(q.w), v(q.x, q.y, q.z) {}
    explicit QuadQuaternion(glm::dquat q) : w(q.w), v(q.x, q.y, q.z) {}
};

inline QuadQuaternion operator+(const QuadQuaternion& a, const QuadQuaternion& b) {
    return {a.w + b.w, a.v + b.v};
}
inline QuadQuaternion operator-(const QuadQuaternion& a, const QuadQuaternion& b) {
    return {a.w - b.w, a.v - b.v};
}
inline QuadQuaternion operator*(Quad s, const QuadQuaternion& q) {
    return {s * q.w, s * q.v};
}
inline Quad dotQuad(const QuadQuaternion& a, const QuadQuaternion& b) {
    return a.w * b.w + dotQuad(a.v, b.v);
}
inline QuadQuaternion conjugateQuad(const QuadQuaternion& q) {
    return {q.w, Quad(-1) * q.v};
}
inline QuadQuaternion productQuad(const QuadQuaternion& a, const QuadQuaternion& b) {
    return {a.w * b.w - dotQuad(a.v, b.v), a.w * b.v + b.w * a.v + crossQuad(a.v, b.v)};
}
/// q is not zero.
inline QuadQuaternion normalizeQuad(const QuadQuaternion& q) {
    return Quad(1) / squareRoot(dotQuad(q, q)) * q;
}
/// q p q⁻¹; q is not zero.
inline QuadVector rotateQuad(const QuadQuaternion& q, const QuadVector& p) {
    const QuadVector turned = productQuad(productQuad(q, {0, p}), conjugateQuad(q)).v;
    return Quad(1) / dotQuad(q, q) * turned;
}
/// The axis is not zero, |radians| ≤ 2^40.
inline QuadQuaternion quaternionFromAxisAngleQuad(const QuadVector& axis, Quad radians) {
    const QuadSineCosine half = sineCosine(radians / 2);
    return {half.cosine, half.sine * normalizeQuad(axis)};
}
/// Shoemake's formula by way of b or −b, whichever is nearer; a and b not zero, of any length.
inline QuadQuaternion slerpQuad(const QuadQuaternion& from, const QuadQuaternion& to, Quad t) {
    const QuadQuaternion a = normalizeQuad(from);
    QuadQuaternion b = normalizeQuad(to);
    if (dotQuad(from, to) < 0)
        b = Quad(-1) * b;
    const QuadQuaternion apart = b - a;
    const QuadQuaternion together = b + a;
    const Quad sine = squareRoot(dotQuad(apart, apart));
    if (!(sine > Quad(0x1p-100)))
        return a;
    const Quad theta = 2 * arcTangent(sine, squareRoot(dotQuad(together, together)));
    const Quad weightA = sineCosine((1 - t) * theta).sine;
    const Quad weightB = sineCosine(t * theta).sine;
    return normalizeQuad(weightA * a + weightB * b);
}

/// |a| and |b| = 1. Radians, in double: the angle between the rotations, small ones to full accuracy.
inline double angleBetweenQuad(const QuadQuaternion& a, const QuadQuaternion& b) {
    const QuadQuaternion apart = a - b;
    const QuadQuaternion together = a + b;
    const Quad squared = std::min(dotQuad(apart, apart), dotQuad(together, together));
    const auto chord = static_cast<double>(squareRoot(squared));
    return 4 * std::asin(std::min(1.0, chord / 2));
}

/// Column vectors, as glm's.
using QuadMatrix = std::array<QuadVector, 3>;

inline QuadMatrix toQuad(const glm::mat3& m) {
    return {QuadVector(m[0]), QuadVector(m[1]), QuadVector(m[2])};
}
inline QuadMatrix matrixQuad(const QuadQuaternion& q) {
    return {rotateQuad(q, {1, 0, 0}), rotateQuad(q, {0, 1, 0}), rotateQuad(q, {0, 0, 1})};
}
/// ‖A − B‖ / √2, the square root of the sum of squared differences: for rotations that are close, the angle
/// between them.
inline double distanceQuad(const QuadMatrix& a, const QuadMatrix& b) {
    Quad sum = 0;
    for (std::size_t column = 0; column < 3; ++column) {
        const QuadVector difference = a[column] - b[column];
        sum += dotQuad(difference, difference);
    }
    return std::sqrt(static_cast<double>(sum) / 2);
}

/// The rotation nearest to m: its orthogonal polar factor, by Newton's iteration X ← (X + X⁻ᵀ)/2 (Higham,
/// "Functions of Matrices", 2008, section 8.3). det m > 0.
inline QuadMatrix nearestRotationQuad(QuadMatrix m) {
    // Scaled first to det 1, to double accuracy: few steps follow where m is a scaled rotation.
    const Quad volume = dotQuad(m[0], crossQuad(m[1], m[2]));
    const Quad scale = 1 / std::cbrt(static_cast<double>(volume));
    for (QuadVector& column : m)
        column = scale * column;
    for (int step = 0; step < 200; ++step) {
        const QuadMatrix cofactors = {crossQuad(m[1], m[2]), crossQuad(m[2], m[0]), crossQuad(m[0], m[1])};
        const Quad inverseDeterminant = 1 / dotQuad(m[0], cofactors[0]);
        QuadMatrix next;
        for (std::size_t column = 0; column < 3; ++column)
            next[column] = Quad(0.5) * (m[column] + inverseDeterminant * cofactors[column]);
        const double change = distanceQuad(m, next);
        m = next;
        if (change < 0x1p-55)  // quadratic: what is left is below 2^-109
            break;
    }
    return m;
}

/// The product of the three rotations; |angles| ≤ 2^40.
inline QuadQuaternion quaternionFromEulerQuad(EulerAngles angles, EulerOrder order) {
    static const std::array<QuadVector, 3> units = {QuadVector(1, 0, 0), QuadVector(0, 1, 0),
                                                    QuadVector(0, 0, 1)};
    QuadQuaternion product;
    for (const int axis : eulerAxes(order))
        product = productQuad(
            product, quaternionFromAxisAngleQuad(units[static_cast<std::size_t>(axis)], angles.about(axis)));
    return product;
}

}  // namespace quincunx

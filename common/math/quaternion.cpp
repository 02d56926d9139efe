#include "math/quaternion.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "math/exact.h"

namespace quincunx {
namespace {

/// Squares of quaternions between these are right as they are.
constexpr double smallestSafeSquare = 0x1p-900;
constexpr double largestSafeSquare = 0x1p1000;

double squaredNormOf(glm::dquat q) {
    return (q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z);
}

/// q times the power of two that brings its largest component to [1, 2); none for zero and what is not
/// finite.
std::optional<glm::dquat> scaledToOne(glm::dquat q) {
    const double largest =
        std::max(std::max(std::abs(q.w), std::abs(q.x)), std::max(std::abs(q.y), std::abs(q.z)));
    const double sum = std::abs(q.w) + std::abs(q.x) + std::abs(q.y) + std::abs(q.z);
    if (!(largest > 0) || std::isnan(sum) || std::isinf(largest))
        return std::nullopt;
    const int exponent = -std::ilogb(largest);
    return glm::dquat(std::scalbn(q.w, exponent), std::scalbn(q.x, exponent), std::scalbn(q.y, exponent),
                      std::scalbn(q.z, exponent));
}

/// q itself where its square is right, else the scaled one.
std::optional<glm::dquat> inSafeRange(glm::dquat q) {
    const double squared = squaredNormOf(q);
    if (squared >= smallestSafeSquare && squared <= largestSafeSquare) [[likely]]
        return q;
    return scaledToOne(q);
}

glm::quat rounded(glm::dquat q) {
    return glm::quat(static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                     static_cast<float>(q.z));
}

double norm(glm::dvec3 v) {
    return std::sqrt(glm::dot(v, v));
}

using Symmetric4 = std::array<std::array<double, 4>, 4>;

/// Horn's matrix, in the order w, x, y, z: the eigenvalues of a rotation's are 3, −1, −1, −1.
Symmetric4 hornMatrix(const glm::dmat3& m) {
    Symmetric4 n;
    n[0][0] = m[0][0] + m[1][1] + m[2][2];
    n[1][1] = m[0][0] - m[1][1] - m[2][2];
    n[2][2] = -m[0][0] + m[1][1] - m[2][2];
    n[3][3] = -m[0][0] - m[1][1] + m[2][2];
    n[0][1] = n[1][0] = m[1][2] - m[2][1];
    n[0][2] = n[2][0] = m[2][0] - m[0][2];
    n[0][3] = n[3][0] = m[0][1] - m[1][0];
    n[1][2] = n[2][1] = m[0][1] + m[1][0];
    n[1][3] = n[3][1] = m[2][0] + m[0][2];
    n[2][3] = n[3][2] = m[1][2] + m[2][1];
    return n;
}

/// The eigenvector of the largest eigenvalue, by cyclic Jacobi rotations (Golub, Van Loan, "Matrix
/// Computations", 4th ed., section 8.5). Quadratic convergence: eight sweeps are more than a 4×4 matrix
/// needs.
glm::dquat largestEigenvector(Symmetric4 a) {
    Symmetric4 v{};
    for (std::size_t i = 0; i < 4; ++i)
        v[i][i] = 1;
    for (int sweep = 0; sweep < 8; ++sweep)
        for (std::size_t p = 0; p < 3; ++p)
            for (std::size_t q = p + 1; q < 4; ++q) {
                if (a[p][q] == 0)
                    continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::sqrt(t * t + 1);
                const double s = t * c;
                for (std::size_t k = 0; k < 4; ++k) {
                    const double kp = a[k][p];
                    const double kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (std::size_t k = 0; k < 4; ++k) {
                    const double pk = a[p][k];
                    const double qk = a[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                }
                a[p][q] = a[q][p] = 0;
                for (std::size_t k = 0; k < 4; ++k) {
                    const double kp = v[k][p];
                    const double kq = v[k][q];
                    v[k][p] = c * kp - s * kq;
                    v[k][q] = s * kp + c * kq;
                }
            }
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if (a[i][i] > a[largest][largest])
            largest = i;
    return {v[0][largest], v[1][largest], v[2][largest], v[3][largest]};
}

/// True if some 2×2 minor differs from zero; with products of floats exact in double the answer is exact.
bool hasRankTwo(const glm::mat3& m) {
    for (int first = 0; first < 3; ++first)
        if (crossInDouble(m[first], m[(first + 1) % 3]) != glm::dvec3(0))
            return true;
    return false;
}

glm::dquat withPositiveW(glm::dquat q) {
    return q.w < 0 ? -q : q;
}

/// m is finite and not zero; its largest entry is scaled to 1.
glm::dquat nearestByJacobi(const glm::dmat3& m, double largest) {
    const glm::dquat q = largestEigenvector(hornMatrix(m * std::exp2(-std::ilogb(largest))));
    return withPositiveW(q / std::sqrt(squaredNormOf(q)));
}

/// The largest magnitude of an entry; infinite if an entry is not finite.
double largestEntry(const glm::dmat3& m) {
    double largest = 0;
    for (int column = 0; column < 3; ++column) {
        if (!isFinite(m[column]))
            return std::numeric_limits<double>::infinity();
        for (int row = 0; row < 3; ++row)
            largest = std::max(largest, std::abs(m[column][row]));
    }
    return largest;
}

std::optional<glm::dquat> nearestOfAny(const glm::mat3& m) {
    const glm::dmat3 wide(m);
    const double largest = largestEntry(wide);
    if (!isUsable(largest) || !hasRankTwo(m) || determinant(m) < 0)
        return std::nullopt;
    return nearestByJacobi(wide, largest);
}

/// Hands `use` the nearest rotation (w, x, y, z; w ≥ 0) of what is close to a multiple of one; false if m is
/// farther from that. Numbers one by one, not as vectors: those would go through memory.
template <typename Matrix, typename Use>
bool nearestOfNearly(const Matrix& m, const Use& use) {
    const double m00 = m[0][0], m01 = m[0][1], m02 = m[0][2];
    const double m10 = m[1][0], m11 = m[1][1], m12 = m[1][2];
    const double m20 = m[2][0], m21 = m[2][1], m22 = m[2][2];
    const double squaredSize = ((m00 * m00 + m01 * m01) + (m02 * m02 + m10 * m10)) +
                               ((m11 * m11 + m12 * m12) + (m20 * m20 + m21 * m21)) + m22 * m22;
    // √x = (1 + x)/2 − (x − 1)²/8 + …: where x is near 1, as for every rotation, no root need be waited for.
    const double meanSquare = squaredSize * (1.0 / 3);
    const double s = std::abs(meanSquare - 1) < 0x1p-16 ? 0.5 * (1 + meanSquare) : std::sqrt(meanSquare);
    // The diagonal of N + s I is 4 s times the squares of w, x, y, z.
    const double ww = (s + m00) + (m11 + m22);
    const double xx = (s + m00) - (m11 + m22);
    const double yy = (s - m00) + (m11 - m22);
    const double zz = (s - m00) - (m11 - m22);
    const double wx = m12 - m21;
    const double wy = m20 - m02;
    const double wz = m01 - m10;
    const double xy = m01 + m10;
    const double zx = m20 + m02;
    const double yz = m12 + m21;
    // The column with the largest diagonal entry, found without a branch: which it is cannot be foreseen.
    const double columns[4][4] = {{ww, wx, wy, wz}, {wx, xx, xy, zx}, {wy, xy, yy, yz}, {wz, zx, yz, zz}};
    const int amongFirst = xx > ww ? 1 : 0;
    const int amongLast = zz > yy ? 3 : 2;
    const double* const column = columns[std::max(yy, zz) > std::max(ww, xx) ? amongLast : amongFirst];
    const double cw = column[0], cx = column[1], cy = column[2], cz = column[3];
    const double w = (ww * cw + wx * cx) + (wy * cy + wz * cz);
    const double x = (wx * cw + xx * cx) + (xy * cy + zx * cz);
    const double y = (wy * cw + xy * cx) + (yy * cy + yz * cz);
    const double z = (wz * cw + zx * cx) + (yz * cy + zz * cz);
    // With λ the largest eigenvalue of N, at most 3 s, |q| / |column| ≤ λ + s. Where the quotient's square is
    // above 16 s² (1 − τ): λ > s (3 − 2τ); the squares of the other eigenvalues' distances from −s sum up to
    // less than 16 τ s² (the eigenvalues' sum is 0, that of their squares 12 s²); the column is within √τ of
    // the eigenvector, and multiplied once more within τ.
    constexpr double tau = 0x1p-32;
    const double squared = (w * w + x * x) + (y * y + z * z);
    const double squaredColumn = (cw * cw + cx * cx) + (cy * cy + cz * cz);
    if (!(squared >= 16 * (1 - tau) * (s * s) * squaredColumn && squared > smallestSafeSquare &&
          squared < largestSafeSquare)) [[unlikely]]
        return false;
    const double scale = std::copysign(1 / std::sqrt(squared), w);
    use(w * scale, x * scale, y * scale, z * scale);
    return true;
}

/// Axis of length 1 and the double sine and cosine of half the angle.
struct HalfTurn {
    glm::dvec3 axis{0};
    double sine = 0;
    double cosine = 1;
};

std::optional<HalfTurn> halfTurn(glm::vec3 axis, float radians) {
    const glm::dvec3 d(axis);
    const double squared = glm::dot(d, d);
    if (!isUsable(squared) || !std::isfinite(radians))
        return std::nullopt;
    const double half = 0.5 * static_cast<double>(radians);
    return HalfTurn{d * (1 / std::sqrt(squared)), std::sin(half), std::cos(half)};
}

}  // namespace

std::optional<glm::dquat> normalize(glm::dquat q) {
    const std::optional<glm::dquat> safe = inSafeRange(q);
    if (!safe)
        return std::nullopt;
    const double length = std::sqrt(squaredNormOf(*safe));
    return glm::dquat(safe->w / length, safe->x / length, safe->y / length, safe->z / length);
}

glm::quat normalizeNaive(glm::quat q) {
    const float length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {q.w / length, q.x / length, q.y / length, q.z / length};
}

glm::quat productNaive(glm::quat a, glm::quat b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z, a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x};
}

glm::quat inverseNaive(glm::quat unitQ) {
    return {unitQ.w, -unitQ.x, -unitQ.y, -unitQ.z};
}

std::optional<glm::dvec3> rotate(glm::dquat q, glm::dvec3 p) {
    // Products with p need more room than |q|² does.
    const double given = squaredNormOf(q);
    const std::optional<glm::dquat> safe = given >= 0x1p-20 && given <= 0x1p20 ? q : scaledToOne(q);
    if (!safe)
        return std::nullopt;
    const double twice = 2 / squaredNormOf(*safe);
    const glm::dvec3 v(safe->x, safe->y, safe->z);
    const glm::dvec3 across = glm::cross(v, p);
    const glm::dvec3 turned = p + twice * (safe->w * across + glm::cross(v, across));
    return isFinite(turned) ? std::optional(turned) : std::nullopt;
}

glm::vec3 rotateNaive(glm::quat unitQ, glm::vec3 p) {
    const glm::quat turned =
        productNaive(productNaive(unitQ, glm::quat(0, p.x, p.y, p.z)), inverseNaive(unitQ));
    return {turned.x, turned.y, turned.z};
}

std::optional<glm::dmat3> matrixFromQuaternion(glm::dquat q) {
    const std::optional<glm::dquat> safe = inSafeRange(q);
    if (!safe)
        return std::nullopt;
    const double twice = 2 / squaredNormOf(*safe);
    const glm::dvec3 v(safe->x, safe->y, safe->z);
    const glm::dvec3 scaled = twice * v;
    const glm::dvec3 squares = v * scaled;
    const glm::dvec3 wv = safe->w * scaled;
    const double xy = v.x * scaled.y;
    const double yz = v.y * scaled.z;
    const double zx = v.z * scaled.x;
    return glm::dmat3(1 - (squares.y + squares.z), xy + wv.z, zx - wv.y,  //
                      xy - wv.z, 1 - (squares.z + squares.x), yz + wv.x,  //
                      zx + wv.y, yz - wv.x, 1 - (squares.x + squares.y));
}

glm::mat3 matrixFromQuaternionNaive(glm::quat q) {
    return {
        1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z),     2 * (q.x * q.z - q.w * q.y),
        2 * (q.x * q.y - q.w * q.z),     1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + q.w * q.x),
        2 * (q.x * q.z + q.w * q.y),     2 * (q.y * q.z - q.w * q.x),     1 - 2 * (q.x * q.x + q.y * q.y)};
}

std::optional<glm::dquat> nearestQuaternion(const glm::mat3& m) {
    std::optional<glm::dquat> q;
    if (nearestOfNearly(m, [&](double w, double x, double y, double z) { q = glm::dquat(w, x, y, z); }))
        [[likely]]
        return q;
    return nearestOfAny(m);
}

std::optional<glm::dquat> nearestQuaternion(const glm::dmat3& m) {
    std::optional<glm::dquat> q;
    if (nearestOfNearly(m, [&](double w, double x, double y, double z) { q = glm::dquat(w, x, y, z); }))
        [[likely]]
        return q;
    const double largest = largestEntry(m);
    if (!isUsable(largest))
        return std::nullopt;
    const glm::dmat3 scaled = m * std::exp2(-std::ilogb(largest));
    // Nine products of three entries below 2, each with three roundings.
    if (glm::dot(scaled[0], glm::cross(scaled[1], scaled[2])) <= 0x1p-44)
        return std::nullopt;
    return nearestByJacobi(m, largest);
}

std::optional<glm::quat> quaternionFromMatrix(const glm::mat3& m) {
    std::optional<glm::quat> near;
    if (nearestOfNearly(m, [&](double w, double x, double y, double z) {
            near = rounded({w, x, y, z});
        })) [[likely]]
        return near;
    const std::optional<glm::dquat> q = nearestOfAny(m);
    return q ? std::optional(rounded(*q)) : std::nullopt;
}

glm::quat quaternionFromMatrixNaive(const glm::mat3& r) {
    const float w = std::sqrt(1 + r[0][0] + r[1][1] + r[2][2]) / 2;
    return {w, (r[1][2] - r[2][1]) / (4 * w), (r[2][0] - r[0][2]) / (4 * w), (r[0][1] - r[1][0]) / (4 * w)};
}

std::optional<glm::quat> quaternionFromAxisAngle(glm::vec3 axis, float radians) {
    const std::optional<HalfTurn> turn = halfTurn(axis, radians);
    if (!turn)
        return std::nullopt;
    return rounded(
        {turn->cosine, turn->sine * turn->axis.x, turn->sine * turn->axis.y, turn->sine * turn->axis.z});
}

glm::quat quaternionFromAxisAngleNaive(glm::vec3 unitAxis, float radians) {
    const float t = radians / 2;
    return {std::cos(t), std::sin(t) * unitAxis.x, std::sin(t) * unitAxis.y, std::sin(t) * unitAxis.z};
}

std::optional<AxisAngle> axisAngleFromQuaternion(glm::quat q) {
    if (!isUsable(squaredNorm(q)))
        return std::nullopt;
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = norm(v);
    if (sine == 0)
        return AxisAngle{};
    const double w = q.w;
    return AxisAngle{glm::vec3(v * std::copysign(1 / sine, w)),
                     static_cast<float>(2 * std::atan2(sine, std::abs(w)))};
}

AxisAngle axisAngleFromQuaternionNaive(glm::quat q) {
    const float sine = std::sqrt(1 - q.w * q.w);
    return {{q.x / sine, q.y / sine, q.z / sine}, 2 * std::acos(q.w)};
}

std::optional<glm::quat> quaternionFromRotationVector(glm::vec3 r) {
    const glm::dvec3 d(r);
    const double angle = norm(d);
    if (!std::isfinite(angle))
        return std::nullopt;
    const double sinc = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
    return rounded({std::cos(angle / 2), sinc * d.x, sinc * d.y, sinc * d.z});
}

std::optional<glm::vec3> rotationVectorFromQuaternion(glm::quat q) {
    if (!isUsable(squaredNorm(q)))
        return std::nullopt;
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = norm(v);
    if (sine == 0)
        return glm::vec3(0);
    const double w = q.w;
    return glm::vec3(2 * std::atan2(sine, std::abs(w)) / (w < 0 ? -sine : sine) * v);
}

glm::quat quaternionFromRotationVectorNaive(glm::vec3 r) {
    const float angle = lengthNaive(r);
    return quaternionFromAxisAngleNaive(r / angle, angle);
}

glm::vec3 rotationVectorFromQuaternionNaive(glm::quat unitQ) {
    const AxisAngle turn = axisAngleFromQuaternionNaive(unitQ);
    return turn.radians * turn.axis;
}

std::optional<glm::vec3> rotateAboutAxis(glm::vec3 p, glm::vec3 axis, float radians) {
    const std::optional<HalfTurn> turn = halfTurn(axis, radians);
    if (!turn)
        return std::nullopt;
    const glm::dvec3 from(p);
    const glm::dvec3 across = glm::cross(turn->axis, from);
    const double sine = 2 * turn->sine * turn->cosine;
    const double versine = 2 * turn->sine * turn->sine;
    const glm::vec3 turned(from + (sine * across + versine * glm::cross(turn->axis, across)));
    return isFinite(turned) ? std::optional(turned) : std::nullopt;
}

glm::vec3 rotateAboutAxisNaive(glm::vec3 p, glm::vec3 n, float radians) {
    const float c = std::cos(radians);
    return c * p + std::sin(radians) * crossNaive(n, p) + (1 - c) * dotNaive(n, p) * n;
}

std::optional<glm::mat3> matrixFromAxisAngle(glm::vec3 axis, float radians) {
    const std::optional<HalfTurn> turn = halfTurn(axis, radians);
    if (!turn)
        return std::nullopt;
    const glm::dvec3 v = turn->sine * turn->axis;
    const std::optional<glm::dmat3> m = matrixFromQuaternion(glm::dquat(turn->cosine, v.x, v.y, v.z));
    return m ? std::optional(glm::mat3(*m)) : std::nullopt;
}

std::optional<glm::quat> shortestArc(glm::vec3 from, glm::vec3 to) {
    const glm::dvec3 a(from);
    const glm::dvec3 b(to);
    const double squaredA = glm::dot(a, a);
    const double squaredB = glm::dot(b, b);
    if (!isUsable(squaredA) || !isUsable(squaredB)) [[unlikely]]
        return std::nullopt;
    const double lengths = productOfLengths(squaredA, squaredB);
    const glm::dvec3 across = crossInDouble(from, to);
    const double along = glm::dot(a, b);
    const double squaredAcross = glm::dot(across, across);
    if (along >= 0) {
        const double w = lengths + along;
        const double scale = 1 / std::sqrt(w * w + squaredAcross);
        return rounded({w * scale, across.x * scale, across.y * scale, across.z * scale});
    }
    if (squaredAcross == 0) {
        const glm::vec3 axis = (*basisAround(from))[0];
        return glm::quat(0, axis.x, axis.y, axis.z);
    }
    // |across|² = (lengths + along)(lengths − along).
    const double w = squaredAcross / (lengths - along);
    const double scale = 1 / std::sqrt(w * w + squaredAcross);
    return rounded({w * scale, across.x * scale, across.y * scale, across.z * scale});
}

glm::quat shortestArcNaive(glm::vec3 unitFrom, glm::vec3 unitTo) {
    const glm::vec3 across = crossNaive(unitFrom, unitTo);
    return normalizeNaive({1 + dotNaive(unitFrom, unitTo), across.x, across.y, across.z});
}

std::optional<float> rotationAngleBetween(glm::quat a, glm::quat b) {
    const double squaredA = squaredNorm(a);
    const double squaredB = squaredNorm(b);
    if (!isUsable(squaredA) || !isUsable(squaredB)) [[unlikely]]
        return std::nullopt;
    const glm::dquat p = glm::dquat(a) * (1 / std::sqrt(squaredA));
    const glm::dquat q = glm::dquat(b) * (1 / std::sqrt(squaredB));
    const double apart = squaredNormOf(p - q);
    const double together = squaredNormOf(p + q);
    return static_cast<float>(
        4 * std::atan2(std::sqrt(std::min(apart, together)), std::sqrt(std::max(apart, together))));
}

float rotationAngleBetweenNaive(glm::quat a, glm::quat b) {
    return 2 * std::acos(std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z));
}

}  // namespace quincunx

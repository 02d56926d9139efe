#include "math/rigid_motion.h"

#include <algorithm>
#include <cmath>

#include "math/exact.h"
#include "math/transform.h"
#include "math/vector.h"

namespace quincunx {
namespace {

/// Between these, squares of lengths neither lose bits below the range nor leave it.
constexpr double smallestSafeSquare = 0x1p-900;
constexpr double largestSafeSquare = 0x1p900;

struct HalfTurn {
    double cosine = 1;
    glm::dvec3 sine{0};  ///< along the axis
};

/// The unit quaternion of a turn; that of no turn where there is none.
HalfTurn halfTurn(glm::dvec3 axis, double radians) {
    const double squared = glm::dot(axis, axis);
    double scale = 1 / std::sqrt(squared);
    if (!(squared > smallestSafeSquare && squared < largestSafeSquare && std::isfinite(radians)))
        [[unlikely]] {
        const std::optional<glm::dvec3> unit = normalize(axis);
        if (!unit || !std::isfinite(radians))
            return {};
        axis = *unit;
        scale = 1;
    }
    return {std::cos(radians / 2), std::sin(radians / 2) * scale * axis};
}

/// `normalize` of math/vector.h to 3 u, inline for the usual lengths.
std::optional<glm::dvec3> unitOf(glm::dvec3 v) {
    const double squared = glm::dot(v, v);
    if (squared > smallestSafeSquare && squared < largestSafeSquare) [[likely]]
        return v * (1 / std::sqrt(squared));
    return normalize(v);
}

/// (cos, sin) of an angle and a little more, |rest| ≤ 2^-12: what the series leaves out is below 2^-64.
glm::dvec2 directionOf(double radians, double rest) {
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    const double sine = rest - rest * rest * rest / 6;
    const double versine = rest * rest * (0.5 - rest * rest / 24);
    return {c - (s * sine + c * versine), s + (c * sine - s * versine)};
}

glm::dmat3 matrixOf(double w, double x, double y, double z) {
    const double xx = 2 * x * x;
    const double yy = 2 * y * y;
    const double zz = 2 * z * z;
    const double xy = 2 * x * y;
    const double xz = 2 * x * z;
    const double yz = 2 * y * z;
    const double wx = 2 * w * x;
    const double wy = 2 * w * y;
    const double wz = 2 * w * z;
    return {glm::dvec3(1 - (yy + zz), xy + wz, xz - wy), glm::dvec3(xy - wz, 1 - (xx + zz), yz + wx),
            glm::dvec3(xz + wy, yz - wx, 1 - (xx + yy))};
}

bool isFinite(const glm::mat3& m) {
    return quincunx::isFinite(m[0]) && quincunx::isFinite(m[1]) && quincunx::isFinite(m[2]);
}

/// I − XᵀX: its diagonal, and what is beside it (yz, zx, xy).
struct Residual {
    glm::dvec3 diagonal;
    glm::dvec3 beside;

    double largest() const {
        const glm::dvec3 a = glm::abs(diagonal);
        const glm::dvec3 b = glm::abs(beside);
        return std::max({a.x, a.y, a.z, b.x, b.y, b.z});
    }
};

Residual residualOf(const glm::dmat3& x) {
    return {{1 - glm::dot(x[0], x[0]), 1 - glm::dot(x[1], x[1]), 1 - glm::dot(x[2], x[2])},
            {-glm::dot(x[1], x[2]), -glm::dot(x[2], x[0]), -glm::dot(x[0], x[1])}};
}

/// X + X (I − XᵀX)/2
glm::dmat3 newtonSchulz(const glm::dmat3& x, const Residual& r) {
    const glm::dvec3 d = 0.5 * r.diagonal;
    const glm::dvec3 b = 0.5 * r.beside;
    return {x[0] + (x[0] * d.x + x[1] * b.z + x[2] * b.y), x[1] + (x[0] * b.z + x[1] * d.y + x[2] * b.x),
            x[2] + (x[0] * b.y + x[1] * b.x + x[2] * d.z)};
}

glm::dmat3 newtonSchulz(const glm::dmat3& x) {
    return newtonSchulz(x, residualOf(x));
}

/// x · (y × z), off by 8 u for columns of unit length: enough for the sign of what is nearly a rotation.
double roughDeterminant(const glm::dmat3& x) {
    return glm::dot(x[0], glm::cross(x[1], x[2]));
}

double frobenius(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

glm::dmat3 cofactors(const glm::dmat3& m) {
    return {cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])};
}

/// The nearest rotation, in double. `m` is finite.
std::optional<glm::dmat3> polarRotation(const glm::mat3& m) {
    glm::dmat3 x(m);
    // Newton and Schulz's steps square the residual e, times 2¼ at most; the last leaves 2^-80.
    constexpr double nearly = 0x1p-6;
    constexpr double there = 0x1p-41;
    Residual residual = residualOf(x);
    if (residual.largest() <= nearly && roughDeterminant(x) > 0) {
        while (residual.largest() > there) {
            x = newtonSchulz(x, residual);
            residual = residualOf(x);
        }
        return newtonSchulz(x, residual);
    }
    const double exact = determinant(m);
    if (!(exact > 0))
        return std::nullopt;
    float largest = 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            largest = std::max(largest, std::abs(m[column][row]));
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    x = scale * x;
    double det = scale * scale * scale * exact;
    // Scaled steps take a condition of 2^40 below 2 in eight; six more square the error to nothing.
    constexpr int mostSteps = 32;
    for (int step = 0; step < mostSteps; ++step) {
        const glm::dmat3 inverseTranspose = cofactors(x) / det;
        const double gamma = std::sqrt(frobenius(inverseTranspose) / frobenius(x));
        if (!(gamma > 0 && gamma < 0x1p80))
            return std::nullopt;
        x = 0.5 * gamma * x + (0.5 / gamma) * inverseTranspose;
        if (residualOf(x).largest() <= 0x1p-20)
            return newtonSchulz(newtonSchulz(x));
        det = glm::dot(x[0], cross(x[1], x[2]));
    }
    return std::nullopt;
}

/// x = y × z of the frame, unit length; with z, unit length.
struct LeftAndFacing {
    glm::dvec3 left;
    glm::dvec3 facing;
};

std::optional<LeftAndFacing> leftAndFacing(const glm::mat3& frame) {
    if (!quincunx::isFinite(frame[1]) || !quincunx::isFinite(frame[2]))
        return std::nullopt;
    const std::optional<glm::dvec3> left = unitOf(crossInDouble(frame[1], frame[2]));
    const std::optional<glm::dvec3> facing = unitOf(glm::dvec3(frame[2]));
    if (!left || !facing)
        return std::nullopt;
    return LeftAndFacing{*left, *facing};
}

}  // namespace

glm::dmat3 turnMatrix(glm::dvec3 axis, double radians) {
    const HalfTurn half = halfTurn(axis, radians);
    return matrixOf(half.cosine, half.sine.x, half.sine.y, half.sine.z);
}

glm::mat3 turnMatrix(glm::vec3 axis, float radians) {
    return glm::mat3(turnMatrix(glm::dvec3(axis), static_cast<double>(radians)));
}

glm::mat3 turnMatrixNaive(glm::vec3 axis, float radians) {
    const glm::vec3 n = axis / std::sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
    const float c = std::cos(radians);
    const float s = std::sin(radians);
    const glm::vec3 t = (1 - c) * n;
    return {glm::vec3(c + t.x * n.x, t.x * n.y + s * n.z, t.x * n.z - s * n.y),
            glm::vec3(t.y * n.x - s * n.z, c + t.y * n.y, t.y * n.z + s * n.x),
            glm::vec3(t.z * n.x + s * n.y, t.z * n.y - s * n.x, c + t.z * n.z)};
}

std::optional<glm::mat3> gramSchmidt(const glm::mat3& frame) {
    const std::optional<LeftAndFacing> axes = leftAndFacing(frame);
    if (!axes)
        return std::nullopt;
    return glm::mat3(axes->left, glm::cross(axes->facing, axes->left), axes->facing);
}

glm::mat3 gramSchmidtNaive(const glm::mat3& frame) {
    const glm::vec3 z = normalizeNaive(frame[2]);
    const glm::vec3 y = normalizeNaive(frame[1] - dotNaive(frame[1], z) * z);
    return {crossNaive(y, z), y, z};
}

std::optional<glm::mat3> orthonormalizedByDuff(const glm::mat3& frame) {
    if (!leftAndFacing(frame))
        return std::nullopt;
    const glm::dmat3 basis = *basisAround(glm::dvec3(frame[2]));
    const glm::dvec3 up = *normalize(glm::dvec3(frame[1]));
    const std::optional<glm::dvec3> roll =
        normalize(glm::dvec3(glm::dot(basis[0], up), glm::dot(basis[1], up), 0));
    if (!roll)
        return std::nullopt;
    const glm::dvec3 y = roll->x * basis[0] + roll->y * basis[1];
    return glm::mat3(glm::cross(y, basis[2]), y, basis[2]);
}

std::optional<glm::mat3> nearestRotation(const glm::mat3& m) {
    if (!isFinite(m))
        return std::nullopt;
    const std::optional<glm::dmat3> rotation = polarRotation(m);
    return rotation ? std::optional(glm::mat3(*rotation)) : std::nullopt;
}

glm::mat3 newtonSchulzStep(const glm::mat3& nearlyRotation) {
    return glm::mat3(newtonSchulz(glm::dmat3(nearlyRotation)));
}

glm::mat3 turnLeftMirroredNaive(const glm::mat3& worldFromBody, float epsilon) {
    const glm::vec3 z = normalizeNaive(worldFromBody[2] + epsilon * worldFromBody[0]);
    return {crossNaive(z, worldFromBody[1]), worldFromBody[1], z};
}

glm::mat3 turnLeftNaive(const glm::mat3& worldFromBody, float epsilon) {
    const glm::vec3 z = normalizeNaive(worldFromBody[2] + epsilon * worldFromBody[0]);
    return {crossNaive(worldFromBody[1], z), worldFromBody[1], z};
}

glm::mat3 turnedNaive(const glm::mat3& worldFromBody, glm::vec3 axisBody, float radians) {
    return worldFromBody * turnMatrixNaive(axisBody, radians);
}

std::optional<glm::mat3> turned(const glm::mat3& worldFromBody, glm::vec3 axisBody, float radians) {
    if (!quincunx::isFinite(axisBody) || !std::isfinite(radians))
        return std::nullopt;
    glm::dmat3 start(worldFromBody);
    const Residual residual = residualOf(start);
    // A rotation rounded to float departs by 1.1e-7; one step then leaves 3 (1.1e-7)² = 4e-14.
    constexpr double roundedRotation = 2e-7;
    if (residual.largest() <= roundedRotation && roughDeterminant(start) > 0) [[likely]] {
        start = newtonSchulz(start, residual);
    } else {
        const std::optional<glm::dmat3> nearest =
            isFinite(worldFromBody) ? polarRotation(worldFromBody) : std::nullopt;
        if (!nearest)
            return std::nullopt;
        start = *nearest;
    }
    return glm::mat3(start * turnMatrix(glm::dvec3(axisBody), static_cast<double>(radians)));
}

void Orientation::turnAboutBody(glm::dvec3 axisBody, double radians) {
    const auto [c, s] = halfTurn(axisBody, radians);
    const double w = w_ * c - (x_ * s.x + y_ * s.y + z_ * s.z);
    const double x = w_ * s.x + x_ * c + (y_ * s.z - z_ * s.y);
    const double y = w_ * s.y + y_ * c + (z_ * s.x - x_ * s.z);
    const double z = w_ * s.z + z_ * c + (x_ * s.y - y_ * s.x);
    const double correction = 1.5 - 0.5 * (w * w + x * x + y * y + z * z);
    w_ = w * correction;
    x_ = x * correction;
    y_ = y * correction;
    z_ = z * correction;
}

void Orientation::turnAboutWorld(glm::dvec3 axisWorld, double radians) {
    // q ↦ r q is the conjugate of q* ↦ q* r*.
    x_ = -x_;
    y_ = -y_;
    z_ = -z_;
    turnAboutBody(axisWorld, -radians);
    x_ = -x_;
    y_ = -y_;
    z_ = -z_;
}

glm::dmat3 Orientation::worldFromBody() const {
    return matrixOf(w_, x_, y_, z_);
}

void AngleSum::add(double radians) {
    if (!std::isfinite(radians))
        return;
    const double sum = high_ + radians;
    const double rounded = sum - high_;
    low_ += (high_ - (sum - rounded)) + (radians - rounded);
    high_ = sum + low_;
    low_ -= high_ - sum;
}

glm::dvec2 AngleSum::direction() const {
    return directionOf(high_, low_);
}

glm::vec2 angleSumDirectionNaive(float radians) {
    return {std::cos(radians), std::sin(radians)};
}

glm::dvec2 arcOffset(double distance, double curvature) {
    if (!std::isfinite(distance) || !std::isfinite(curvature))
        return glm::dvec2(0);
    const double phi = 0.5 * curvature * distance;
    if (!std::isfinite(phi))
        return glm::dvec2(0);
    const double rest = std::fma(0.5 * curvature, distance, -phi);
    const glm::dvec2 middle = directionOf(phi, rest);
    const double chord = phi == 0 ? distance : distance * (middle.y / phi);
    return chord * middle;
}

glm::vec2 arcOffsetNaive(float distance, float curvature) {
    const float angle = curvature * distance;
    return {std::sin(angle) / curvature, (1 - std::cos(angle)) / curvature};
}

RigidPose RigidPose::inverse() const {
    const glm::dmat3 transposed = glm::transpose(rotation);
    return {transposed, -(transposed * origin)};
}

glm::mat4 RigidPose::matrix() const {
    glm::mat4 result{glm::mat3(rotation)};
    result[3] = glm::vec4(glm::vec3(origin), 1);
    return result;
}

RigidPose operator*(const RigidPose& aFromB, const RigidPose& bFromC) {
    return {aFromB.rotation * bFromC.rotation, aFromB.rotation * bFromC.origin + aFromB.origin};
}

RigidPose cameraFacing(const RigidPose& worldFromBody, glm::dvec3 eyeBody) {
    const glm::dmat3& body = worldFromBody.rotation;
    return {glm::dmat3(-body[0], body[1], -body[2]), worldFromBody.origin + body * eyeBody};
}

glm::mat4 cameraFromModel(const RigidPose& worldFromCamera, const RigidPose& worldFromModel) {
    const glm::dmat3 cameraFromWorldAxes = glm::transpose(worldFromCamera.rotation);
    return RigidPose{cameraFromWorldAxes * worldFromModel.rotation,
                     cameraFromWorldAxes * (worldFromModel.origin - worldFromCamera.origin)}
        .matrix();
}

glm::mat4 cameraFromModelNaive(const glm::mat4& worldFromCamera, const glm::mat4& worldFromModel) {
    return inverseNaive(worldFromCamera) * worldFromModel;
}

glm::mat4 cameraFromWorldNaive(const glm::mat4& worldFromCamera) {
    const glm::vec3 t(worldFromCamera[3]);
    glm::mat4 inverse{glm::transpose(glm::mat3(worldFromCamera))};
    inverse[3] =
        glm::vec4(-dotNaive(glm::vec3(worldFromCamera[0]), t), -dotNaive(glm::vec3(worldFromCamera[1]), t),
                  -dotNaive(glm::vec3(worldFromCamera[2]), t), 1);
    return inverse;
}

}  // namespace quincunx

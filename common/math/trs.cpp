#include "math/trs.h"

#include <cmath>

#include "base/check.h"
#include "math/exact.h"
#include "math/vector.h"

namespace quincunx {
namespace {

/// |v| of a vector made of floats or their products, whose squares are in the range of double.
double plainLength(glm::dvec3 v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/// The axes of R: known where M says them, completed to a right-handed system where it does not. `side` is
/// −1 if M mirrors.
glm::dmat3 rotationOf(const glm::mat3& m, double side) {
    const glm::dvec3 x(m[0]);
    const glm::dvec3 y(m[1]);
    const glm::dvec3 z(m[2]);
    const glm::dvec3 xy = crossInDouble(m[0], m[1]);
    const glm::dvec3 zero(0);
    const auto frame = [](glm::dvec3 axisX, glm::dvec3 axisZ) {
        const glm::dvec3 unitX = axisX / plainLength(axisX);
        const glm::dvec3 unitZ = axisZ / plainLength(axisZ);
        return glm::dmat3(unitX, glm::cross(unitZ, unitX), unitZ);
    };
    if (xy != zero)
        return frame(side * x, side * xy);
    if (x != zero) {
        // y is zero or along x, so R's y axis is open: it stands on x and z.
        const glm::dvec3 xz = crossInDouble(m[0], m[2]);
        if (xz != zero) {
            const glm::dvec3 unitX = x / plainLength(x);
            const glm::dvec3 unitY = -xz / plainLength(xz);
            return {unitX, unitY, glm::cross(unitX, unitY)};
        }
        const glm::dmat3 basis = basisAround(x).value();
        return {basis[2], basis[0], basis[1]};
    }
    if (y != zero) {
        const glm::dvec3 yz = crossInDouble(m[1], m[2]);
        if (yz != zero) {
            const glm::dvec3 unitX = yz / plainLength(yz);
            const glm::dvec3 unitY = y / plainLength(y);
            return {unitX, unitY, glm::cross(unitX, unitY)};
        }
        const glm::dmat3 basis = basisAround(y).value();
        return {basis[1], basis[2], basis[0]};
    }
    return z != zero ? basisAround(z).value() : glm::dmat3(1);
}

}  // namespace

glm::mat4 compose(const Trs& placement) {
    const glm::dmat3 rotation(placement.rotation);
    const glm::dvec3 scale(placement.scale);
    const glm::dvec3 shear(placement.shear);
    glm::mat4 m(1);
    m[0] = glm::vec4(glm::vec3(scale.x * rotation[0]), 0);
    m[1] = glm::vec4(glm::vec3(shear.x * rotation[0] + scale.y * rotation[1]), 0);
    m[2] = glm::vec4(glm::vec3(shear.y * rotation[0] + shear.z * rotation[1] + scale.z * rotation[2]), 0);
    m[3] = glm::vec4(placement.translation, 1);
    return m;
}

std::optional<Trs> decompose(const glm::mat4& m) {
    QX_CHECK(m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1);
    const glm::mat3 linear(m);
    if (!isFinite(linear[0]) || !isFinite(linear[1]) || !isFinite(linear[2]) || !isFinite(glm::vec3(m[3])))
        return std::nullopt;
    const double volume = determinant(linear);
    const double side = volume < 0 ? -1 : 1;
    const glm::dmat3 rotation = rotationOf(linear, side);
    const glm::dvec3 xy = crossInDouble(linear[0], linear[1]);
    const double lengthX = plainLength(linear[0]);
    const double area = plainLength(xy);

    glm::dvec3 scale(side * lengthX, 0, 0);
    glm::dvec3 shear(0);
    if (lengthX > 0) {
        shear.x = side * dotInDouble(linear[0], linear[1]) / lengthX;
        shear.y = side * dotInDouble(linear[0], linear[2]) / lengthX;
    } else {
        // R's x axis is not M's: what y and z have along it is zero by construction of R.
        shear.x = 0;
        shear.y = 0;
    }
    if (area > 0) {
        scale.y = area / lengthX;
        shear.z = glm::dot(rotation[1], glm::dvec3(linear[2]));
        scale.z = std::abs(volume) / area;
    } else if (lengthX > 0) {
        scale.z = plainLength(crossInDouble(linear[0], linear[2])) / lengthX;
    } else {
        const double lengthY = plainLength(linear[1]);
        scale.y = lengthY;
        if (lengthY > 0) {
            shear.z = dotInDouble(linear[1], linear[2]) / lengthY;
            scale.z = plainLength(crossInDouble(linear[1], linear[2])) / lengthY;
        } else {
            scale.z = plainLength(linear[2]);
        }
    }
    const Trs placement{glm::vec3(m[3]), glm::mat3(rotation), glm::vec3(scale), glm::vec3(shear)};
    return isFinite(placement.scale) && isFinite(placement.shear) ? std::optional(placement) : std::nullopt;
}

Trs decomposeNaive(const glm::mat4& m) {
    Trs placement;
    placement.translation = glm::vec3(m[3]);
    for (int axis = 0; axis < 3; ++axis) {
        placement.scale[axis] = lengthNaive(glm::vec3(m[axis]));
        placement.rotation[axis] = glm::vec3(m[axis]) / placement.scale[axis];
    }
    return placement;
}

}  // namespace quincunx

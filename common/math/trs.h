#pragma once

#include <optional>

#include <glm/glm.hpp>

/// Placements taken apart and put together: translation, rotation, scale, shear. Column vectors; the scale
/// acts first, the translation last.
namespace quincunx {

/// An affine placement M = T R U with the upper triangular
///
///         | scale.x  shear.x  shear.y |
///     U = |    0     scale.y  shear.z |
///         |    0        0     scale.z |
///
/// so that shear.x is how far the tip of the model's y axis leans along the turned x axis, shear.y and
/// shear.z how far that of the z axis leans along x and y, in units of the world. Shears are lengths, not
/// quotients: they have values where a scale is zero.
struct Trs {
    glm::vec3 translation{0};
    glm::mat3 rotation{1};  ///< orthonormal, det +1
    glm::vec3 scale{1};     ///< negative: mirrored along that axis
    glm::vec3 shear{0};     ///< xy, xz, yz
};

/// T R U. Each entry is a sum of up to three products of floats in double, rounded once: within half an ulp
/// plus 2^-52 Σ|product|. Held by Trs.*.
glm::mat4 compose(const Trs& placement);

/// The one way to take an affine matrix apart (its last row is 0 0 0 1; a bug of the caller otherwise) with
/// scale.y ≥ 0 and scale.z ≥ 0: any mirror is a negative scale.x, wherever the model was mirrored, since
/// diag(1, −1, 1) is a half turn of diag(−1, 1, 1). Singular matrices have one too: a direction that the
/// matrix leaves open (the axis of a zero scale) is perpendicular to those that are known, and where two are
/// open, `basisAround` the known one decides; the zero matrix has the identity.
///
/// R and U are the factors of a QR decomposition found by cross products, which do not cancel: the x axis of
/// R is that of M, its z axis is along x × y. Rotation and translation are within 0.5 ulp + 2^-49 of exact
/// (|RᵀR − I| ≤ 1.1e-7), scale within 0.5 ulp + 2^-26, shear.x and shear.y within 0.5 ulp + 2^-26, shear.z
/// within 0.5 ulp + 2^-50 of the z axis' length. None if M is not finite or a length exceeds the range of
/// float. Held by Trs.*.
std::optional<Trs> decompose(const glm::mat4& m);

/// Lengths of the columns, and the columns over them, in float: knows no mirror and no shear.
Trs decomposeNaive(const glm::mat4& m);

}  // namespace quincunx

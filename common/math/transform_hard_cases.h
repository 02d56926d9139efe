#pragma once

#include <cstdint>
#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What transforms rest on: inverses, placements taken apart, the division by w, large worlds, the way back
/// from the window, depth, oblique near planes.
std::span<const HardCase> transformHardCases();

/// Inverses of placements scaled by 2^-62 … 2^62, and by 2^-20 … 2^20 along each axis; ulp of an entry.
HardCaseFigures runInverseUniform(std::uint64_t inputs, std::uint64_t seed);
HardCaseFigures runInversePerAxis(std::uint64_t inputs, std::uint64_t seed);
/// Inverses of projections with near planes of 2^-40 … 2^20 and far planes 1 + 2^-20 … 2^40 times as far; ulp
/// of an entry.
HardCaseFigures runInverseProjection(std::uint64_t inputs, std::uint64_t seed);
/// Inverses of rigid placements 2^-10 … 2^40 away, nearly at right angles to an axis; ulp of an entry.
HardCaseFigures runInverseRigid(std::uint64_t inputs, std::uint64_t seed);
/// Scales of placements that are mirrored, sheared, flattened and scaled by 2^-60 … 2^60; ulp of a length.
HardCaseFigures runDecompose(std::uint64_t inputs, std::uint64_t seed);
/// p / w of any finite floats; ulp of a component. Points that no float holds are directions.
HardCaseFigures runHomogenize(std::uint64_t inputs, std::uint64_t seed);
/// Scales of 2^-140 … 2^120 through w; ulp of a component.
HardCaseFigures runScaleThroughW(std::uint64_t inputs, std::uint64_t seed);
/// Where vertices land that are 2^10 … 1e8 from the world's origin and near the eye, by a float shader;
/// pixels of a 1920×1080 picture.
HardCaseFigures runLargeWorld(std::uint64_t inputs, std::uint64_t seed);
/// The model's point behind a pixel, for near planes down to 2^-10 and far planes up to 2^20; distance over
/// what the bound of `modelFromWindow` allows.
HardCaseFigures runUnproject(std::uint64_t inputs, std::uint64_t seed);
/// Distances of depths 2^-24 … 1 short of the far plane, far/near up to 2^40; ulp.
HardCaseFigures runDistanceFromDepth(std::uint64_t inputs, std::uint64_t seed);
/// Boxes of 2^-60 … 2^127, off the axis by up to 2^20 times their size; ulp of an entry.
HardCaseFigures runOrthographic(std::uint64_t inputs, std::uint64_t seed);
/// Oblique near planes for far/near up to 2^30, planes of any length; error of the third row over its largest
/// entry.
HardCaseFigures runNearPlane(std::uint64_t inputs, std::uint64_t seed);

}  // namespace quincunx

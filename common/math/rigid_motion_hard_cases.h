#pragma once

#include <cstdint>
#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What a car and the cameras in it rest on: turns that add up, frames made orthonormal again, inverses of
/// rigid poses, places far from the world's origin, motion along arcs.
std::span<const HardCase> rigidMotionHardCases();

/// One frame turned left `inputs` times as the card says, by ε = 0.01; |RᵀR − I|. A frame that is mirrored is
/// a failure.
HardCaseFigures runTurnLeft(std::uint64_t inputs, std::uint64_t seed);
/// One frame of floats turned `inputs` times about axes of its own, by 2^-30 … 2^20 radians; |RᵀR − I|.
HardCaseFigures runTurnedOrthonormal(std::uint64_t inputs, std::uint64_t seed);
/// The same with the state in double; difference of an entry from the exact product of all turns.
HardCaseFigures runOrientation(std::uint64_t inputs, std::uint64_t seed);
/// `inputs` angles of 2^-30 … 2^10 radians added up, most of one sign; error of cosine and sine.
HardCaseFigures runAngleSum(std::uint64_t inputs, std::uint64_t seed);
/// Turns by 2^-60 … 2^60 radians about axes of length 2^-100 … 2^100; error of an entry.
HardCaseFigures runTurnMatrix(std::uint64_t inputs, std::uint64_t seed);
/// Frames with columns of length 2^-60 … 2^60, y within 2^-22 … 1 radian of z or of −z; error of an entry.
HardCaseFigures runGramSchmidt(std::uint64_t inputs, std::uint64_t seed);
/// Rotations times stretches, the condition σ1/(σ2 + σ3) up to 2^20, of any size; error of an entry. One in
/// eight is mirrored and has no nearest rotation.
HardCaseFigures runNearestRotation(std::uint64_t inputs, std::uint64_t seed);
/// Cameras 2^0 … 2^100 from the origin; ulp of an entry of (T R)⁻¹ for the given floats, R rounded.
HardCaseFigures runRigidInverse(std::uint64_t inputs, std::uint64_t seed);
/// A camera and a model 2^-3 … 2^8 apart and 2^10 … 2^40 from the origin; pixels of a 1920×1080 picture.
HardCaseFigures runCameraFromModel(std::uint64_t inputs, std::uint64_t seed);
/// Arcs of curvature 0 and ±2^-100 … 2^6, 2^-10 … 2^20 long; error over the length or the circle's diameter,
/// whichever is less.
HardCaseFigures runArcOffset(std::uint64_t inputs, std::uint64_t seed);

}  // namespace quincunx

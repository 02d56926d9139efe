#pragma once

#include <cstdint>
#include <span>

#include <glm/gtc/quaternion.hpp>

#include "math/hard_case.h"
#include "math/stress_inputs.h"

namespace quincunx {

/// Quaternions, axis and angle, matrices, shortest arcs and drift.
std::span<const HardCase> quaternionHardCases();
/// slerp, nlerp and the interpolation of matrices; Euler angles.
std::span<const HardCase> orientationHardCases();

/// A rotation, evenly over all of them, of length 1 to a few 2^-53 (Shoemake, "Uniform random rotations",
/// Graphics Gems III, 1992).
glm::dquat randomRotation(StressInputs& draw);
/// `unit` moved by an angle of 2^e on the sphere in four dimensions, e uniform in [lowExponent,
/// highExponent).
glm::dquat turnedInFour(StressInputs& draw, glm::dquat unit, double lowExponent, double highExponent);

/// Errors of rotations are the angle between what is given and the exact one, in radians, or the distance
/// from the unit sphere where that is larger.
HardCaseFigures runQuaternionNormalize(std::uint64_t inputs, std::uint64_t seed);
/// a*b of unit quaternions 2^-22 … 2^-1 apart: relative error of the vector part, which says how they differ.
HardCaseFigures runRelativeRotation(std::uint64_t inputs, std::uint64_t seed);
HardCaseFigures runQuaternionInverse(std::uint64_t inputs, std::uint64_t seed);
/// Vectors of 2^-60 … 2^60 turned by quaternions of 2^-60 … 2^60; |error| / |p|.
HardCaseFigures runQuaternionRotate(std::uint64_t inputs, std::uint64_t seed);
/// The largest entry of |RRᵀ − I| for such quaternions.
HardCaseFigures runQuaternionToMatrix(std::uint64_t inputs, std::uint64_t seed);
/// Rotations by π and by 2^-24 … 2^-2 less, some exactly about an axis.
HardCaseFigures runMatrixToQuaternion(std::uint64_t inputs, std::uint64_t seed);
/// R S with R any rotation and S stretching by 2^-4 … 2^4 along any three axes.
HardCaseFigures runStretchedMatrixToQuaternion(std::uint64_t inputs, std::uint64_t seed);
/// Axes of 2^-70 … 2^60, angles 0, π, 2π, 2^-60 … 2^30; ulp of a component.
HardCaseFigures runAxisAngle(std::uint64_t inputs, std::uint64_t seed);
/// Vectors turned by Rodrigues' formula about such axes; |error| / |p|.
HardCaseFigures runRodrigues(std::uint64_t inputs, std::uint64_t seed);
/// Axis and angle of turns by 2^-24 … 1 and as far from 2π; relative error of the rotation vector.
HardCaseFigures runAxisAngleExtraction(std::uint64_t inputs, std::uint64_t seed);
/// Rotation vectors of length 0 and 2^-140 … 2; ulp of a component of the quaternion.
HardCaseFigures runRotationVector(std::uint64_t inputs, std::uint64_t seed);
/// Directions exactly opposite and 2^-24 … 1 rad from it, lengths 2^-60 … 2^60. Where the turned direction
/// ends, radians from the goal, or the excess over the smallest turn.
HardCaseFigures runShortestArc(std::uint64_t inputs, std::uint64_t seed);
/// Unit quaternions 2^-22 … 2^-1 apart, or their opposites; relative error of the angle between the
/// rotations.
HardCaseFigures runRotationAngle(std::uint64_t inputs, std::uint64_t seed);
/// Products of one rotation after another, begun anew every 2^20; | |q| − 1 | after each.
HardCaseFigures runQuaternionDrift(std::uint64_t inputs, std::uint64_t seed);

/// Quaternions 2^-24 … 2^-1 apart in four dimensions.
HardCaseFigures runSlerpNear(std::uint64_t inputs, std::uint64_t seed);
/// Exactly opposite, and 2^-24 … 2^-1 from it: the same rotation, or nearly.
HardCaseFigures runSlerpOpposite(std::uint64_t inputs, std::uint64_t seed);
/// Rotations half a turn apart, exactly and to 2^-24 … 2^-1.
HardCaseFigures runSlerpHalfTurn(std::uint64_t inputs, std::uint64_t seed);
/// Lengths 2^-60 … 2^60.
HardCaseFigures runSlerpAnyLength(std::uint64_t inputs, std::uint64_t seed);
/// t from −4 to 5.
HardCaseFigures runSlerpBeyond(std::uint64_t inputs, std::uint64_t seed);
/// As runSlerpOpposite, against the exact nlerp.
HardCaseFigures runNlerpOpposite(std::uint64_t inputs, std::uint64_t seed);
/// Matrices 2^-4 … 1 rad from half a turn apart, against the polar factor of the exact mixture.
HardCaseFigures runMatrixLerp(std::uint64_t inputs, std::uint64_t seed);
/// Middle angle exactly ±90°, all six orders: from quaternion to angles and back.
HardCaseFigures runEulerLock(std::uint64_t inputs, std::uint64_t seed);
/// Middle angle within 2^-24 … 2^-4 of ±90°.
HardCaseFigures runEulerNearLock(std::uint64_t inputs, std::uint64_t seed);
/// Any rotation: from matrix to angles and back to the matrix.
HardCaseFigures runEulerMatrix(std::uint64_t inputs, std::uint64_t seed);

}  // namespace quincunx

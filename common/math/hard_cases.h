#pragma once

#include <cstdint>
#include <span>

#include "math/hard_case.h"

namespace quincunx {

/// What shading rests on: normals, half vectors, reflections, highlights, grazing light, the normal matrix.
std::span<const HardCase> shadingHardCases();
/// What every lab's camera and geometry rest on: lengths, angles, products, bases, poses, projections,
/// inverses.
std::span<const HardCase> frameHardCases();

/// Unit normals of 2^-148 … 2^127, and of any finite bit patterns; ulp of a component.
HardCaseFigures runNormalizeMagnitudes(std::uint64_t inputs, std::uint64_t seed);
HardCaseFigures runNormalizeBitPatterns(std::uint64_t inputs, std::uint64_t seed);
/// The same of doubles, 2^-1070 … 2^1020.
HardCaseFigures runNormalizeDouble(std::uint64_t inputs, std::uint64_t seed);
/// Half vectors of unit directions 2^-24 … 1 radian short of opposite; |h − exact|. Pairs that are exactly
/// opposite after rounding have no answer: the stable form must say so, or its error is infinite.
HardCaseFigures runHalfVectorOpposite(std::uint64_t inputs, std::uint64_t seed);
/// Reflection by normals of length 2^-100 … 2^100, normalized first by the naive form; ulp(1) |l|.
HardCaseFigures runReflectAnyNormal(std::uint64_t inputs, std::uint64_t seed);
/// World normals of models that are sheared, mirrored and scaled by 1e-30 … 1e30; largest error of a
/// component.
HardCaseFigures runNormalMatrix(std::uint64_t inputs, std::uint64_t seed);
/// The highlight cosⁿ for exponents 0 and 2^0 … 1e5, near the peak; ulp.
HardCaseFigures runCosinePower(std::uint64_t inputs, std::uint64_t seed);
/// n·l for light that grazes the surface, 2^-24 … 2^-1 radians above or below it; ulp. A wrong sign, or zero
/// for a value that float can hold, counts as infinite.
HardCaseFigures runGrazingDot(std::uint64_t inputs, std::uint64_t seed);

/// Lengths of 2^-148 … 2^126; ulp.
HardCaseFigures runLength(std::uint64_t inputs, std::uint64_t seed);
/// Angles of 2^-22 … 1 radian and as far from π; relative error. Zero for distinct directions counts as 1.
HardCaseFigures runAngle(std::uint64_t inputs, std::uint64_t seed);
/// Cross products of directions 2^-23 … 2^-1 radians apart; ulp of a component.
HardCaseFigures runCross(std::uint64_t inputs, std::uint64_t seed);
/// Bases around the axes and around directions within 2^-24 … 1 radian of them; largest entry of |BᵀB − I|.
HardCaseFigures runBasis(std::uint64_t inputs, std::uint64_t seed);
/// Camera poses with `up` along the view or within 2^-24 … 1 radian of it; largest entry of |RRᵀ − I|.
HardCaseFigures runLookAt(std::uint64_t inputs, std::uint64_t seed);
/// Projections with near planes of 2^-60 … 2^60 and far planes up to 2^60 times as far; ulp of an entry.
HardCaseFigures runPerspective(std::uint64_t inputs, std::uint64_t seed);
/// Inverses of matrices that are 2^-22 … 2^-1 from singular; ulp of an entry.
HardCaseFigures runInverse(std::uint64_t inputs, std::uint64_t seed);

}  // namespace quincunx

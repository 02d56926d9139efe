#pragma once

namespace quincunx {

/// The real solutions of a x² + b x + c = 0.
struct QuadraticRoots {
    /// How many different ones: 0, 1 or 2; `everywhere` if a = b = c = 0.
    int count = 0;
    double first = 0;   ///< the smaller
    double second = 0;  ///< the larger; equal to `first` if there is one
    static constexpr int everywhere = -1;
};

/// Solves a x² + b x + c = 0 for finite float coefficients. The count is exact, and each root has a relative
/// error of at most 4 · 2^-53, so rounded to float it is within 0.5 ulp + 2^-26: products of two floats are
/// exact in double, so the discriminant is rounded once and its sign is right; the root of larger magnitude
/// is q/a with q = −(b + sgn(b) √D)/2, where nothing cancels, and the other one c/q (Press et al., "Numerical
/// Recipes", section 5.6; Goldberg, "What every computer scientist should know about floating-point
/// arithmetic", 1991). Roots reach 2^±278, beyond float but not beyond double. a = 0 gives the linear
/// equation's root. Held by Quadratic.*.
QuadraticRoots solveQuadratic(float a, float b, float c);

/// (−b ± √(b² − 4ac)) / 2a in float, whatever comes out.
struct QuadraticRootsNaive {
    int count = 0;
    float first = 0;
    float second = 0;
};
QuadraticRootsNaive solveQuadraticNaive(float a, float b, float c);

}  // namespace quincunx

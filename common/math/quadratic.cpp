#include "math/quadratic.h"

#include <algorithm>
#include <cmath>

namespace quincunx {

QuadraticRoots solveQuadratic(float a, float b, float c) {
    if (a == 0) {
        if (b == 0)
            return {c == 0 ? QuadraticRoots::everywhere : 0, 0, 0};
        const double root = -static_cast<double>(c) / b + 0.0;  // no −0
        return {1, root, root};
    }
    const double linear = b;
    const double discriminant = linear * linear - 4.0 * a * c;
    if (discriminant < 0)
        return {};
    if (discriminant == 0) {
        const double root = -linear / (2.0 * a) + 0.0;
        return {1, root, root};
    }
    const double q = -0.5 * (linear + std::copysign(std::sqrt(discriminant), linear));
    const double x = q / a;
    const double y = c / q + 0.0;
    return {2, std::min(x, y), std::max(x, y)};
}

QuadraticRootsNaive solveQuadraticNaive(float a, float b, float c) {
    const float discriminant = b * b - 4 * a * c;
    if (discriminant < 0)
        return {};
    const float root = std::sqrt(discriminant);
    const float x = (-b - root) / (2 * a);
    const float y = (-b + root) / (2 * a);
    return {discriminant == 0 ? 1 : 2, std::min(x, y), std::max(x, y)};
}

}  // namespace quincunx

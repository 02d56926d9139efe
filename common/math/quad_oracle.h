#pragma once

#include <array>
#include <cfloat>
#include <cstddef>

#include <glm/glm.hpp>

/// Quadruple precision: the oracle that the shipped program has for `stress`. The tests hold it against MPFR
/// (QuadOracle.*). Slow, and for oracles alone; the routines that are measured do without it.
namespace quincunx {

#if LDBL_MANT_DIG == 113
using Quad = long double;
#else
__extension__ typedef __float128 Quad;  // NOLINT(modernize-use-using): __extension__ takes no using
#endif

/// √x for x ≥ 0, within 3 units of 2^-113, relative. x = 0 or in the range of normal doubles, squares of
/// doubles included.
Quad squareRoot(Quad x);

/// The elementary functions below are within 2^-100 of the value, relative; `logarithm` absolutely where its
/// value is less than 1.

/// eˣ, |x| ≤ 1000.
Quad exponential(Quad x);
/// ln x, x in the range of normal doubles.
Quad logarithm(Quad x);
/// tan x, 0 ≤ x ≤ π/2 − 2^-25; within 2^-80 at the end of that range.
Quad tangent(Quad x);
/// The angle of (x, y) in (−π, π], not both zero, the larger in the range of normal doubles.
Quad arcTangent(Quad y, Quad x);

/// Three quads, for formulas written as in a book.
struct QuadVector {
    Quad x = 0;
    Quad y = 0;
    Quad z = 0;

    QuadVector() = default;
    QuadVector(Quad x_, Quad y_, Quad z_) : x(x_), y(y_), z(z_) {}
    explicit QuadVector(glm::vec3 v) : x(v.x), y(v.y), z(v.z) {}
    explicit QuadVector(glm::dvec3 v) : x(v.x), y(v.y), z(v.z) {}
};

inline QuadVector operator+(const QuadVector& a, const QuadVector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline QuadVector operator-(const QuadVector& a, const QuadVector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline QuadVector operator*(Quad s, const QuadVector& v) {
    return {s * v.x, s * v.y, s * v.z};
}
inline Quad dotQuad(const QuadVector& a, const QuadVector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline QuadVector crossQuad(const QuadVector& a, const QuadVector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Quad lengthQuad(const QuadVector& v) {
    return squareRoot(dotQuad(v, v));
}
/// v is not zero.
inline QuadVector normalizeQuad(const QuadVector& v) {
    return Quad(1) / lengthQuad(v) * v;
}

/// The adjugate of a matrix of floats and its determinant, by Laplace's expansion: within 2^-110 of the sum
/// of the terms' magnitudes. Entries [column][row]; the inverse is the one over the other.
struct QuadAdjugate {
    std::array<std::array<Quad, 4>, 4> entries{};
    Quad determinant = 0;

    Quad inverseEntry(int column, int row) const {
        return entries[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)] / determinant;
    }
};
QuadAdjugate adjugateQuad(const glm::mat4& m);

}  // namespace quincunx

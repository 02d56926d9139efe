#pragma once

#include <cmath>
#include <concepts>

#include <boost/multiprecision/gmp.hpp>
#include <boost/multiprecision/mpfr.hpp>

/// Exact and nearly exact arithmetic that tests measure against.
namespace quincunx::oracle {

/// Exact: for what + − × ÷ of floats yield.
using Rational =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

/// 91 decimal digits, over 300 bits: for roots and elementary functions. The exponent does not run out.
using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<91>,
                                           boost::multiprecision::et_off>;

/// Three of them, for formulas written as in a book.
template <typename Number>
struct Vector {
    Number x;
    Number y;
    Number z;

    Vector(Number x_, Number y_, Number z_) : x(x_), y(y_), z(z_) {}
    /// Exactly the given floats or doubles.
    template <typename V>
    requires std::floating_point<typename V::value_type>
    explicit Vector(const V& v)
        : x(static_cast<double>(v.x)), y(static_cast<double>(v.y)), z(static_cast<double>(v.z)) {}

    friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector operator*(const Number& s, const Vector& v) { return {s * v.x, s * v.y, s * v.z}; }
    friend Number dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend Vector cross(const Vector& a, const Vector& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};

using RealVector = Vector<Real>;
using RationalVector = Vector<Rational>;

inline Real length(const RealVector& v) {
    return sqrt(dot(v, v));
}

/// v is not zero.
inline RealVector normalize(const RealVector& v) {
    return Real(1 / length(v)) * v;
}

}  // namespace quincunx::oracle

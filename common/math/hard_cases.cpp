#include "math/hard_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "math/exact.h"
#include "math/projection.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What math/vector.h calls 0.5 ulp.
constexpr double halfUlp = 0.5 + 0x1p-26;

std::string hex(double x) {
    return fmt::format("{:a}", x);
}

std::string hexMatrix(const glm::mat4& m, int size) {
    std::string text;
    for (int column = 0; column < size; ++column)
        for (int row = 0; row < size; ++row)
            text += fmt::format("{}{:a}", text.empty() ? "" : ",", m[column][row]);
    return "columns(" + text + ")";
}

/// The largest ulp error of the components.
template <typename V>
double componentUlps(const V& got, const QuadVector& exact) {
    return worse(worse(ulpError(got.x, exact.x), ulpError(got.y, exact.y)), ulpError(got.z, exact.z));
}

template <typename V>
double componentUlps(const std::optional<V>& got, const QuadVector& exact) {
    return got ? componentUlps(*got, exact) : infinity;
}

double largestDifference(glm::vec3 got, const QuadVector& exact) {
    const QuadVector d = QuadVector(got) - exact;
    return worse(worse(std::abs(static_cast<double>(d.x)), std::abs(static_cast<double>(d.y))),
                 std::abs(static_cast<double>(d.z)));
}

double distance(glm::vec3 got, const QuadVector& exact) {
    const QuadVector d = QuadVector(got) - exact;
    const auto squared = static_cast<double>(dotQuad(d, d));
    return squared >= 0 ? std::sqrt(squared) : infinity;
}

/// The largest entry of |BᵀB − I| to 1e-15: products of floats are exact in double.
double orthonormalityError(const glm::mat3& basis) {
    double error = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            error = worse(error, std::abs(dotInDouble(basis[i], basis[j]) - (i == j ? 1 : 0)));
    return error;
}

template <typename V, typename Draw>
HardCaseFigures runNormalize(std::uint64_t inputs, const Draw& draw) {
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const V v = draw();
        const QuadVector exact = normalizeQuad(QuadVector(v));
        tally.add(componentUlps(normalizeNaive(v), exact), componentUlps(normalize(v), exact),
                  [&] { return "v=" + hexVector(v); });
    }
    return tally.figures();
}

}  // namespace

HardCaseFigures runNormalizeMagnitudes(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runNormalize<glm::vec3>(inputs, [&] { return draw.vectorOfMagnitude(-148, 127); });
}

HardCaseFigures runNormalizeBitPatterns(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runNormalize<glm::vec3>(inputs, [&] { return draw.finiteVector(); });
}

HardCaseFigures runNormalizeDouble(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runNormalize<glm::dvec3>(inputs, [&] { return draw.doubleVectorOfMagnitude(-1070, 1020); });
}

HardCaseFigures runHalfVectorOpposite(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 wi(direction);
        const glm::vec3 wo = i % 8 == 0 ? -wi : glm::vec3(draw.turned(-direction, -24, 0));
        const QuadVector across = crossQuad(QuadVector(wi), QuadVector(wo));
        const std::optional<glm::vec3> half = halfVector(wi, wo);
        double stableError = 0;
        double naiveError = infinity;
        if (dotQuad(across, across) == 0) {
            stableError = half ? infinity : 0;
        } else {
            const QuadVector exact =
                normalizeQuad(normalizeQuad(QuadVector(wi)) + normalizeQuad(QuadVector(wo)));
            stableError = half ? distance(*half, exact) : infinity;
            naiveError = distance(halfVectorNaive(wi, wo), exact);
        }
        tally.add(naiveError, stableError, [&] { return "wi=" + hexVector(wi) + " wo=" + hexVector(wo); });
    }
    return tally.figures();
}

HardCaseFigures runReflectAnyNormal(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 l = draw.vectorOfMagnitude(-10, 10);
        const glm::vec3 n = draw.vectorOfMagnitude(-100, 100);
        const QuadVector exactNormal(n);
        const QuadVector exact = QuadVector(l) - 2 * dotQuad(exactNormal, QuadVector(l)) /
                                                     dotQuad(exactNormal, exactNormal) * exactNormal;
        const double unit = 0x1p-23 * length(glm::dvec3(l));
        const std::optional<glm::vec3> stable = reflect(l, n);
        tally.add(largestDifference(reflectNaive(l, normalizeNaive(n)), exact) / unit,
                  stable ? largestDifference(*stable, exact) / unit : infinity,
                  [&] { return "l=" + hexVector(l) + " n=" + hexVector(n); });
    }
    return tally.figures();
}

HardCaseFigures runNormalMatrix(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // A shear of up to 16 and axes up to 16 times as long as others keep κ below 2^13, so that the bound
        // of `transformNormal` is that of rounding. Every eighth model is flattened.
        glm::dmat3 shape(1);
        for (int axis = 0; axis < 3; ++axis)
            shape[axis][axis] = draw.sign() * draw.magnitude(-2, 2);
        shape[1][0] = draw.sign() * draw.magnitude(-4, 4);
        if (i % 8 == 0)
            shape[2] = glm::dvec3(0);
        const double scale = draw.magnitude(-99.66, 99.66);  // 1e-30 … 1e30
        const glm::mat4 worldFromModel{glm::mat3(scale * (draw.rotation() * shape))};
        glm::vec3 normal = draw.unitVector();
        if (normal.z == 0)
            normal = glm::vec3(0, 0, 1);
        const QuadVector x{glm::vec3(worldFromModel[0])};
        const QuadVector y{glm::vec3(worldFromModel[1])};
        const QuadVector z{glm::vec3(worldFromModel[2])};
        const QuadVector yz = crossQuad(y, z);
        const Quad side = dotQuad(x, yz) < 0 ? -1 : 1;
        const QuadVector exact =
            normalizeQuad(side * (Quad(normal.x) * yz + Quad(normal.y) * crossQuad(z, x) +
                                  Quad(normal.z) * crossQuad(x, y)));
        const std::optional<glm::vec3> stable = transformNormal(worldFromModel, normal);
        tally.add(largestDifference(normalizeNaive(normalMatrixNaive(worldFromModel) * normal), exact),
                  stable ? largestDifference(*stable, exact) : infinity,
                  [&] { return "M=" + hexMatrix(worldFromModel, 3) + " n=" + hexVector(normal); });
    }
    return tally.figures();
}

HardCaseFigures runCosinePower(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto exponent = i % 8 == 0 ? 0.0f : static_cast<float>(draw.magnitude(0, 16.6096));  // … 1e5
        // Up to where the highlight has faded to e^-20: n θ²/2 = 20.
        const double widest = std::min(1.5, std::sqrt(40.0 / std::max(exponent, 1.0f)));
        const glm::dvec3 direction = draw.direction();
        const double angle = draw.random().uniform(0, widest);
        const glm::vec3 a(direction);
        const glm::vec3 b(std::cos(angle) * direction + std::sin(angle) * draw.perpendicular(direction));
        const QuadVector exactA(a);
        const QuadVector exactB(b);
        const Quad cosine =
            dotQuad(exactA, exactB) / squareRoot(dotQuad(exactA, exactA) * dotQuad(exactB, exactB));
        const Quad exact = exponential(Quad(exponent) * logarithm(cosine));
        tally.add(ulpError(cosinePowerNaive(a, b, exponent), exact),
                  ulpError(cosinePower(a, b, exponent), exact),
                  [&] { return "a=" + hexVector(a) + " b=" + hexVector(b) + " exponent=" + hex(exponent); });
    }
    return tally.figures();
}

HardCaseFigures runGrazingDot(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    const auto error = [](float got, Quad exact) {
        const bool sameSign = (got > 0) == (exact > 0) && (got < 0) == (exact < 0);
        return sameSign ? ulpError(got, exact) : infinity;
    };
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = draw.direction();
        const double height = draw.sign() * draw.magnitude(-24, -1);
        const glm::vec3 n(direction);
        const glm::vec3 l(std::sin(height) * direction + std::cos(height) * draw.perpendicular(direction));
        const Quad exact = dotQuad(QuadVector(n), QuadVector(l));
        tally.add(error(dotNaive(n, l), exact), error(dot(n, l), exact),
                  [&] { return "n=" + hexVector(n) + " l=" + hexVector(l); });
    }
    return tally.figures();
}

HardCaseFigures runLength(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 v = draw.vectorOfMagnitude(-148, 126);
        const Quad exact = lengthQuad(QuadVector(v));
        tally.add(ulpError(lengthNaive(v), exact), ulpError(length(v), exact),
                  [&] { return "v=" + hexVector(v); });
    }
    return tally.figures();
}

HardCaseFigures runAngle(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 a(direction);
        const glm::vec3 b(draw.turned(draw.sign() * direction, -22, 0));
        const Quad exact = arcTangent(lengthQuad(crossQuad(QuadVector(a), QuadVector(b))),
                                      dotQuad(QuadVector(a), QuadVector(b)));
        const auto error = [&](double got) {
            return exact == 0 ? (got == 0 ? 0 : infinity)
                              : std::abs(static_cast<double>((Quad(got) - exact) / exact));
        };
        const std::optional<float> stable = angleBetween(a, b);
        tally.add(error(angleBetweenNaive(a, b)), stable ? error(*stable) : infinity,
                  [&] { return "a=" + hexVector(a) + " b=" + hexVector(b); });
    }
    return tally.figures();
}

HardCaseFigures runCross(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = draw.direction();
        const glm::vec3 a(direction);
        const glm::vec3 b(draw.turned(direction, -23, -1));
        const QuadVector exact = crossQuad(QuadVector(a), QuadVector(b));
        tally.add(componentUlps(crossNaive(a, b), exact), componentUlps(cross(a, b), exact),
                  [&] { return "a=" + hexVector(a) + " b=" + hexVector(b); });
    }
    return tally.figures();
}

HardCaseFigures runBasis(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::vec3 n(i % 4 == 0 ? draw.direction() : draw.nearAxis());
        const std::optional<glm::mat3> stable = basisAround(n);
        tally.add(orthonormalityError(basisAroundNaive(n)), stable ? orthonormalityError(*stable) : infinity,
                  [&] { return "n=" + hexVector(n); });
    }
    return tally.figures();
}

HardCaseFigures runLookAt(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 direction = i % 4 == 0 ? draw.nearAxis() : draw.direction();
        const glm::vec3 eye = i % 2 == 0 ? glm::vec3(0) : draw.vectorOfMagnitude(-4, 4);
        const glm::vec3 target(glm::dvec3(eye) + draw.magnitude(-4, 4) * direction);
        const glm::vec3 up(i % 3 == 0 ? direction : draw.turned(direction, -24, 0));
        const auto error = [](const glm::mat4& pose) {
            return orthonormalityError(glm::transpose(glm::mat3(pose)));
        };
        tally.add(error(lookAtNaive(eye, target, up)), error(lookAt(eye, target, up)), [&] {
            return "eye=" + hexVector(eye) + " target=" + hexVector(target) + " up=" + hexVector(up);
        });
    }
    return tally.figures();
}

HardCaseFigures runPerspective(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto fovY = static_cast<float>(draw.random().uniform(0.01, 3.1));
        const auto aspect = static_cast<float>(draw.magnitude(-3, 3));
        const auto near = static_cast<float>(draw.magnitude(-60, 60));
        const float far = std::max(static_cast<float>(near * (1 + draw.magnitude(-20, 60))),
                                   std::nextafter(near, std::numeric_limits<float>::infinity()));
        const Quad tangentY = tangent(Quad(fovY) / 2);
        const Quad depth = Quad(far) - near;
        const QuadVector diagonal(1 / (tangentY * aspect), 1 / tangentY, -(Quad(far) + near) / depth);
        const Quad shift = -2 * Quad(near) * far / depth;
        const auto error = [&](const glm::mat4& clipFromCamera) {
            return worse(
                componentUlps(glm::vec3(clipFromCamera[0][0], clipFromCamera[1][1], clipFromCamera[2][2]),
                              diagonal),
                ulpError(clipFromCamera[3][2], shift));
        };
        tally.add(
            error(perspectiveNaive(fovY, aspect, near, far)), error(perspective(fovY, aspect, near, far)),
            [&] { return fmt::format("fovY={:a} aspect={:a} near={:a} far={:a}", fovY, aspect, near, far); });
    }
    return tally.figures();
}

HardCaseFigures runInverse(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::dmat4 singular(0);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 3; ++row)
                singular[column][row] = draw.random().uniform(-1, 1);
        const glm::dvec3 mix(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1),
                             draw.random().uniform(-1, 1));
        const double rest = draw.magnitude(-22, -1);
        for (int column = 0; column < 4; ++column)
            singular[column][3] =
                glm::dot(mix, glm::dvec3(singular[column])) + rest * draw.random().uniform(-1, 1);
        const glm::mat4 m(singular);

        // Quad rounds sums of 96-bit products by 2^-113 of entries near 1.
        const QuadAdjugate exact = adjugateQuad(m);
        const auto error = [&](const glm::mat4& got) {
            double worst = 0;
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    worst = worse(worst, ulpError(got[column][row], exact.inverseEntry(column, row)));
            return worst;
        };
        const std::optional<glm::mat4> stable = inverse(m);
        const bool invertible = exact.determinant != 0;
        tally.add(invertible ? error(inverseNaive(m)) : infinity,
                  stable.has_value() == invertible ? (stable ? error(*stable) : 0) : infinity,
                  [&] { return "M=" + hexMatrix(m, 4); });
    }
    return tally.figures();
}

std::span<const HardCase> shadingHardCases() {
    static constexpr HardCase cases[] = {
        {"normalize", "lengths 2^-148 … 2^127", "ulp", halfUlp, "squares summed in double; Blue 1978",
         &runNormalizeMagnitudes},
        {"normalize", "any finite bit patterns", "ulp", halfUlp, "squares summed in double; Blue 1978",
         &runNormalizeBitPatterns},
        {"halfVector", "wi opposite wo, exactly and within 2^-24 … 1 rad", "distance", 6e-8,
         "(wi × wo) × (wi − wo) where the sum cancels", &runHalfVectorOpposite},
        {"reflect", "normals of length 2^-100 … 2^100", "ulp(1) |l|", halfUlp,
         "l − 2 (n·l)/(n·n) n in double", &runReflectAnyNormal},
        {"normalMatrix", "sheared, mirrored, flattened, scaled by 1e-30 … 1e30", "component error", 3e-8,
         "sign(det) cof M, no division", &runNormalMatrix},
        {"cosinePower", "exponents 0 and 1 … 1e5 near the peak", "ulp", 0.5 + 4e-6,
         "log1p(−sin²) within 45° of the peak", &runCosinePower},
        {"dot", "light grazing at 2^-24 … 2^-1 rad", "ulp", halfUlp,
         "compensated sum of exact products; Ogita, Rump, Oishi 2005", &runGrazingDot},
    };
    return cases;
}

std::span<const HardCase> frameHardCases() {
    static constexpr HardCase cases[] = {
        {"normalize (double)", "lengths 2^-1070 … 2^1020", "ulp", 2.5, "Blue 1978", &runNormalizeDouble},
        {"length", "lengths 2^-148 … 2^126", "ulp", halfUlp, "squares summed in double; Blue 1978",
         &runLength},
        {"angleBetween", "2^-22 … 1 rad from 0 and from π", "relative error", 6e-8,
         "atan2(|a × b|, a·b) of exact products", &runAngle},
        {"cross", "directions 2^-23 … 2^-1 rad apart", "ulp", halfUlp,
         "exact products; Jeannerod, Louvet, Muller 2013", &runCross},
        {"basisAround", "on and within 2^-24 … 1 rad of the axes", "|BᵀB − I|", 1.1e-7, "Duff et al. 2017",
         &runBasis},
        {"lookAt", "up along the view, and within 2^-24 … 1 rad of it", "|RRᵀ − I|", 1.1e-7,
         "Kahan's cross product, basis of Duff et al. where up says nothing", &runLookAt},
        {"perspective", "near 2^-60 … 2^60", "ulp", halfUlp, "2n (f/(f − n)) in double", &runPerspective},
        {"inverse", "2^-22 … 2^-1 from singular", "ulp", 0.53,
         "adjugate over determinant, exact sums where they cancel; Shewchuk 1997", &runInverse},
    };
    return cases;
}

}  // namespace quincunx

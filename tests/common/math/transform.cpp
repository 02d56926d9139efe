#include "math/transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "math/exact.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"
#include "math/vector.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using oracle::Rational;
using oracle::RationalVector;
using oracle::Real;
using oracle::RealVector;

constexpr double halfUlp = 0.5 + 0x1p-26;
constexpr float infinity = std::numeric_limits<float>::infinity();

glm::mat4 modelFrom(const glm::dmat3& linear) {
    return glm::mat4{glm::mat3(linear)};
}

/// sign(det) cof M n exactly; the sign is + for det = 0.
RationalVector exactNormal(const glm::mat4& m, glm::vec3 n) {
    const RationalVector x(glm::vec3{m[0]});
    const RationalVector y(glm::vec3{m[1]});
    const RationalVector z(glm::vec3{m[2]});
    const Rational sign = dot(x, cross(y, z)) < 0 ? -1 : 1;
    return Rational(sign * n.x) * cross(y, z) + Rational(sign * n.y) * cross(z, x) +
           Rational(sign * n.z) * cross(x, y);
}

RealVector real(const RationalVector& v) {
    return {Real(v.x), Real(v.y), Real(v.z)};
}

double largestDifference(glm::vec3 got, const RealVector& exact) {
    const RealVector d = RealVector(got) - exact;
    return std::max({std::abs(static_cast<double>(d.x)), std::abs(static_cast<double>(d.y)),
                     std::abs(static_cast<double>(d.z))});
}

// Measured: 2.98e-8, half an ulp below 1.
TEST(NormalMatrix, TransformsNormalsOfEveryModelToWithinRounding) {
    StressInputs draw(1);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
        glm::dmat3 shape(1);
        for (int axis = 0; axis < 3; ++axis)
            shape[axis][axis] = draw.sign() * draw.magnitude(-2, 2);
        shape[1][0] = draw.sign() * draw.magnitude(-4, 4);
        const glm::mat4 m = modelFrom(draw.magnitude(-120, 120) * (draw.rotation() * shape));
        const glm::vec3 n = draw.vectorOfMagnitude(-20, 20);
        worst = std::max(worst, largestDifference(transformNormal(m, n).value(),
                                                  oracle::normalize(real(exactNormal(m, n)))));
    }
    EXPECT_LE(worst, 3e-8);
}

TEST(NormalMatrix, IsTheCofactorMatrixUpToAPowerOfTwo) {
    StressInputs draw(2);
    for (int i = 0; i < 5000; ++i) {
        const glm::dmat3 shape(draw.magnitude(-30, 30) * draw.direction(),
                               draw.magnitude(-30, 30) * draw.direction(),
                               draw.magnitude(-30, 30) * draw.direction());
        const glm::mat4 m = modelFrom(draw.magnitude(-60, 60) * shape);
        const glm::mat3 got = normalMatrix(m);
        // The power of two, from one entry that is not small.
        const RationalVector first = exactNormal(m, glm::vec3(1, 0, 0));
        const glm::vec3 column0 = got[0];
        const bool byX = std::abs(column0.x) > std::abs(column0.y);
        const double ratio = (byX ? column0.x : column0.y) / static_cast<double>(byX ? first.x : first.y);
        const Real scale = ldexp(Real(1), static_cast<int>(std::lround(std::log2(ratio))));
        for (int column = 0; column < 3; ++column) {
            const glm::vec3 axis(column == 0, column == 1, column == 2);
            const RealVector exact = scale * real(exactNormal(m, axis));
            ASSERT_LE(ulpError(got[column].x, exact.x), halfUlp);
            ASSERT_LE(ulpError(got[column].y, exact.y), halfUlp);
            ASSERT_LE(ulpError(got[column].z, exact.z), halfUlp);
        }
    }
}

TEST(NormalMatrix, OfARotationIsThatRotation) {
    StressInputs draw(3);
    for (int i = 0; i < 2000; ++i) {
        const glm::mat3 rotation(draw.rotation());
        for (const float scale : {1.0f, 0x1p-90f, 0x1p90f}) {
            const glm::mat3 normals = normalMatrix(glm::mat4(scale * rotation));
            const double unit = length(glm::dvec3(normals[0]));
            for (int column = 0; column < 3; ++column)
                ASSERT_LE(glm::length(glm::dvec3(normals[column]) / unit - glm::dvec3(rotation[column])),
                          4e-7);
        }
    }
}

TEST(NormalMatrix, KeepsNormalsOutwardAndPerpendicularWhenMirroredAndSheared) {
    StressInputs draw(4);
    for (int i = 0; i < 10000; ++i) {
        glm::dmat3 linear = draw.rotation();
        for (int axis = 0; axis < 3; ++axis)
            linear[axis] *= draw.sign() * draw.magnitude(-3, 3);
        linear[2] += draw.random().uniform(-2, 2) * linear[0];
        const glm::mat4 m = modelFrom(draw.magnitude(-60, 60) * linear);
        // A triangle on a sphere about the origin, its corner standing for "outward".
        const glm::dvec3 corner = draw.direction();
        const glm::vec3 tangent(draw.perpendicular(corner));
        const glm::dvec3 outward = glm::dmat3(m) * corner;
        const glm::vec3 world = transformNormal(m, glm::vec3(corner)).value();
        ASSERT_GT(glm::dot(glm::dvec3(world), outward), 0);
        const glm::dvec3 worldTangent = glm::normalize(glm::dmat3(m) * glm::dvec3(tangent));
        // n·t = 0 holds in the model to the roundings of n, t and M, magnified by the shear: 64 · 1e-7.
        ASSERT_NEAR(glm::dot(glm::dvec3(world), worldTangent), 0, 1e-5);
        const glm::vec3 byMatrix = normalMatrix(m) * glm::vec3(corner);
        ASSERT_GT(glm::dot(glm::dvec3(byMatrix), outward), 0);
    }
}

TEST(NormalMatrix, ServesFlattenedModels) {
    // Squashed onto the plane z = 0: whatever pointed up or down points up or down there.
    const glm::mat4 flat = modelFrom(glm::dmat3(glm::dvec3(2, 0, 0), glm::dvec3(1, 3, 0), glm::dvec3(0)));
    EXPECT_EQ(transformNormal(flat, glm::vec3(0.6f, 0, 0.8f)), glm::vec3(0, 0, 1));
    EXPECT_EQ(transformNormal(flat, glm::vec3(0.6f, 0, -0.8f)), glm::vec3(0, 0, -1));
    EXPECT_FALSE(transformNormal(flat, glm::vec3(1, 0, 0)).has_value());
    const glm::mat3 normals = normalMatrix(flat);
    EXPECT_EQ(normals[0], glm::vec3(0));
    EXPECT_EQ(normals[2], glm::vec3(0, 0, 1.5f));
}

TEST(NormalMatrix, IsTheIdentityWhereThereAreNoNormals) {
    const glm::dvec3 line(1, 2, 3);
    for (const glm::mat4& m : {glm::mat4(0), modelFrom(glm::dmat3(line, 2.0 * line, -line)),
                               glm::mat4(infinity), glm::mat4(std::nanf(""))}) {
        EXPECT_EQ(normalMatrix(m), glm::mat3(1));
        EXPECT_FALSE(transformNormal(m, glm::vec3(0, 0, 1)).has_value());
    }
    EXPECT_FALSE(transformNormal(glm::mat4(1), glm::vec3(0)).has_value());
    EXPECT_FALSE(transformNormal(glm::mat4(1), glm::vec3(0, infinity, 0)).has_value());
}

TEST(NormalMatrix, StaysInRangeForScalesOfAllSizes) {
    for (const double scale : {1e-37, 1e-30, 1e-20, 1.0, 1e20, 1e30, 1e37}) {
        const glm::mat3 uniform = normalMatrix(modelFrom(glm::dmat3(scale)));
        EXPECT_GE(uniform[0][0], 0.5f);
        EXPECT_LE(uniform[0][0], 2.0f);
        const glm::mat4 uneven =
            modelFrom(glm::dmat3(glm::dvec3(scale, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1 / scale)));
        const glm::mat3 normals = normalMatrix(uneven);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(std::isnormal(normals[axis][axis]));
            glm::vec3 n(0);
            n[axis] = 1;
            EXPECT_EQ(transformNormal(uneven, n), n);
            EXPECT_EQ(normalize(normals * n), n);
        }
    }
}

/// The signed determinant of m without a column and a row, exactly.
Rational exactCofactor(const glm::mat4& m, int column, int row) {
    std::array<glm::vec3, 3> minor{};
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            minor[static_cast<std::size_t>(c)][r] = m[c < column ? c : c + 1][r < row ? r : r + 1];
    const Rational value =
        dot(RationalVector(minor[0]), cross(RationalVector(minor[1]), RationalVector(minor[2])));
    return (column + row) % 2 == 0 ? value : Rational(-value);
}

void expectExactInverse(const glm::mat4& m) {
    std::array<std::array<Rational, 4>, 4> cofactors;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            cofactors[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)] =
                exactCofactor(m, column, row);
    Rational det = 0;
    for (int row = 0; row < 4; ++row)
        det += Rational(m[0][row]) * cofactors[0][static_cast<std::size_t>(row)];
    const std::optional<glm::mat4> got = inverse(m);
    if (det == 0) {
        ASSERT_FALSE(got.has_value());
        return;
    }
    bool fits = true;
    double worst = 0;
    for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 4; ++row) {
            const Rational exact = cofactors[row][column] / det;
            fits = fits && abs(exact) < Rational(0x1.ffffffp127);
            if (got)
                worst =
                    std::max(worst, ulpError((*got)[static_cast<int>(column)][static_cast<int>(row)], exact));
        }
    }
    ASSERT_EQ(got.has_value(), fits);
    ASSERT_LE(worst, 0.53);
}

// The four families of hard inputs: uniform scales, scales per axis, nearly singular, any bits.
TEST(Inverse, IsRoundedOnceInEveryEntryAndRefusesOnlyWhatHasNone) {
    StressInputs draw(5);
    for (int i = 0; i < 1000; ++i) {
        const auto translation = glm::vec4(draw.vectorOfMagnitude(-10, 20), 1);
        glm::mat4 m = modelFrom(draw.magnitude(-62, 62) * draw.rotation());
        m[3] = translation;
        expectExactInverse(m);

        glm::dmat3 perAxis = draw.rotation();
        for (int axis = 0; axis < 3; ++axis)
            perAxis[axis] *= draw.magnitude(-20, 20);
        m = modelFrom(perAxis);
        m[3] = translation;
        expectExactInverse(m);

        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                m[column][row] = static_cast<float>(draw.random().uniform(-1, 1));
        m[3] = 0.5f * m[0] - 2.0f * m[1];
        expectExactInverse(m);
        m[3][1] += static_cast<float>(draw.magnitude(-22, -1));
        expectExactInverse(m);

        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                m[column][row] = draw.finiteFloat();
        expectExactInverse(m);
    }
}

TEST(Inverse, RefusesSingularAndUnboundedMatrices) {
    EXPECT_FALSE(inverse(glm::mat4(0)).has_value());
    EXPECT_FALSE(inverse(glm::mat4(infinity)).has_value());
    EXPECT_FALSE(inverse(glm::mat4(0x1p-149f)).has_value());  // 2^149 exceeds float
    glm::mat4 repeated(1);
    repeated[2] = repeated[1];
    EXPECT_FALSE(inverse(repeated).has_value());
    EXPECT_EQ(inverse(glm::mat4(4)), glm::mat4(0.25f));
}

TEST(Inverse, OfAnAffineMatrixIsAffineAndTheSameByBothRoutines) {
    StressInputs draw(8);
    for (int i = 0; i < 5000; ++i) {
        glm::mat4 m = modelFrom(glm::dmat3(draw.magnitude(-9, 9) * draw.direction(),
                                           draw.magnitude(-9, 9) * draw.direction(),
                                           draw.magnitude(-9, 9) * draw.direction()));
        m[3] = glm::vec4(draw.vectorOfMagnitude(-20, 20), 1);
        const std::optional<glm::mat4> byClass = inverseAffine(m);
        ASSERT_EQ(byClass, inverse(m));
        ASSERT_EQ((glm::vec4((*byClass)[0].w, (*byClass)[1].w, (*byClass)[2].w, (*byClass)[3].w)),
                  glm::vec4(0, 0, 0, 1));
    }
    glm::mat4 projective(1);
    projective[2][3] = -1;
    EXPECT_DEATH(inverseAffine(projective), "isAffine");
    glm::mat4 flat(1);
    flat[2][2] = 0;
    EXPECT_FALSE(inverseAffine(flat).has_value());
}

TEST(Inverse, RefusesWhateverEntryIsNotFinite) {
    for (const float bad : {infinity, -infinity, std::nanf("")})
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row) {
                glm::mat4 m(2);
                m[1][2] = 1;
                m[column][row] = bad;
                EXPECT_FALSE(inverse(m).has_value()) << column << row;
                if (row < 3) {
                    m[3][3] = 1;
                    EXPECT_FALSE(inverseAffine(m).has_value()) << column << row;
                }
            }
}

TEST(Inverse, OfARigidMatrixIsTheTransposedRotation) {
    StressInputs draw(9);
    for (int i = 0; i < 5000; ++i) {
        glm::mat4 m = modelFrom(draw.rotation());
        m[3] = glm::vec4(draw.vectorOfMagnitude(-30, 30), 1);
        const glm::mat4 rigid = inverseRigid(m);
        const glm::mat4 general = inverse(m).value();
        // R is orthonormal to 1.1e-7, and so is the translation right to that share of its length.
        for (int column = 0; column < 3; ++column)
            ASSERT_LE(glm::length(glm::vec3(rigid[column] - general[column])), 4e-7f);
        ASSERT_LE(glm::length(glm::vec3(rigid[3] - general[3])), 6e-7f * glm::length(glm::vec3(m[3])));
    }
}

void expectPose(const glm::mat4& pose, glm::vec3 eye) {
    const glm::mat3 rotation(pose);
    const glm::mat3 rows = glm::transpose(rotation);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            ASSERT_LE(std::abs(dotInDouble(rows[i], rows[j]) - (i == j ? 1 : 0)), 1.1e-7);
    ASSERT_GT(determinant(rotation), 0);
    ASSERT_EQ(glm::vec3(pose[3]), eye);
    ASSERT_EQ((glm::vec4(pose[0].w, pose[1].w, pose[2].w, pose[3].w)), glm::vec4(0, 0, 0, 1));
}

// Measured: |RRᵀ − I| 1.0e-7, view direction 2.98e-8.
TEST(LookAt, IsRigidAndLooksAtTheTargetWithUpUpwards) {
    StressInputs draw(6);
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 direction = i % 4 == 0 ? draw.nearAxis() : draw.direction();
        const glm::vec3 eye = i % 2 == 0 ? glm::vec3(0) : draw.vectorOfMagnitude(-30, 30);
        const glm::vec3 target(glm::dvec3(eye) + draw.magnitude(-30, 30) * direction);
        const glm::vec3 up(draw.magnitude(-60, 60) *
                           (i % 3 == 0 ? direction : draw.turned(direction, -24, 0.5)));
        const glm::mat4 pose = lookAt(eye, target, up);
        expectPose(pose, eye);
        if (eye == target)
            continue;
        const RealVector view = RealVector(target) - RealVector(eye);
        const RealVector unitView = oracle::normalize(view);
        ASSERT_LE(largestDifference(-glm::vec3(pose[2]), unitView), 3e-8);
        // The picture's right is that of view × up, to rounding, and to what the rounding of the view to
        // double (where eye and target differ by more than 2^29 in size) becomes when up is close to it.
        const RealVector side = cross(view, RealVector(up));
        if (dot(side, side) != 0) {
            const double condition = static_cast<double>(
                Real(oracle::length(view) * oracle::length(RealVector(up)) / oracle::length(side)));
            ASSERT_LE(largestDifference(glm::vec3(pose[0]), oracle::normalize(side)),
                      3e-8 + 0x1p-52 * condition);
        }
    }
}

TEST(LookAt, HasADocumentedPoseForDegenerateInput) {
    const glm::vec3 eye(1, 2, 3);
    EXPECT_EQ(lookAt(eye, eye, {0, 1, 0})[3], glm::vec4(eye, 1));
    EXPECT_EQ(glm::mat3(lookAt(eye, eye, {0, 1, 0})), glm::mat3(1));
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 view(0);
            view[axis] = side;
            for (const glm::vec3 up : {view, -view, 1e-30f * view, glm::vec3(0)}) {
                const glm::mat4 pose = lookAt(eye, eye + view, up);
                expectPose(pose, eye);
                EXPECT_EQ(glm::vec3(pose[2]), -view);
                EXPECT_EQ(glm::vec3(pose[0]), glm::vec3(basisAround(view).value()[0]));
            }
        }
    }
    EXPECT_EQ(lookAt({0, 0, 5}, {0, 0, 0}, {0, 1, 0})[3], glm::vec4(0, 0, 5, 1));
    EXPECT_EQ(glm::mat3(lookAt({0, 0, 5}, {0, 0, 0}, {0, 1, 0})), glm::mat3(1));
    EXPECT_DEATH(lookAt(eye, {infinity, 0, 0}, {0, 1, 0}), "isFinite");
}

TEST(LookAt, HasARigidInverseRoundedOnce) {
    StressInputs draw(7);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 eye = draw.vectorOfMagnitude(-20, 20);
        const glm::mat4 worldFromCamera = lookAt(eye, draw.vectorOfMagnitude(-20, 20), draw.unitVector());
        const glm::mat4 inverted = cameraFromWorld(worldFromCamera);
        for (int row = 0; row < 3; ++row) {
            const Rational exact = dot(RationalVector(glm::vec3(worldFromCamera[row])), RationalVector(eye));
            ASSERT_LE(ulpError(inverted[3][row], Rational(-exact)), halfUlp);
            for (int column = 0; column < 3; ++column)
                ASSERT_EQ(inverted[column][row], worldFromCamera[row][column]);
        }
        // The eye is the camera's origin: to rounding of float arithmetic, four products of size |eye|.
        const glm::vec4 origin = inverted * glm::vec4(eye, 1);
        ASSERT_LE(glm::length(glm::vec3(origin)), 4e-7f * length(eye));
    }
}

}  // namespace
}  // namespace quincunx

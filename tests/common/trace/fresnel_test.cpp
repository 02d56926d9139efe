#include "trace/fresnel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "math/stress_inputs.h"
#include "tests/support/oracle.h"

namespace quincunx {
namespace {

using glm::vec3;
using oracle::Real;

Real fresnelByAngles(float cosine, float eta) {
    const Real in = acos(Real(cosine));
    const Real sine = sin(in) / Real(eta);
    if (sine >= 1)
        return 1;
    const Real out = asin(sine);
    const Real across = sin(in - out) / sin(in + out);
    const Real along = tan(in - out) / tan(in + out);
    return (across * across + along * along) / 2;
}

// Fresnel's formulas as he wrote them, by the angles.
TEST(FresnelDielectric, AgreesWithTheFormulasOfAngles) {
    StressInputs draw(1);
    for (int i = 0; i < 300; ++i) {
        const auto cosine = static_cast<float>(draw.random().uniform(0.001, 0.999));
        const auto eta = static_cast<float>(draw.magnitude(-1.5, 1.5));
        EXPECT_NEAR(fresnelDielectric(cosine, eta), static_cast<double>(fresnelByAngles(cosine, eta)),
                    3.1e-8);
    }
}

TEST(FresnelDielectric, HasTheClosedFormsOfBooks) {
    EXPECT_FLOAT_EQ(fresnelDielectric(1, 1.5f), 0.04f);
    EXPECT_FLOAT_EQ(fresnelDielectric(1, 1 / 1.5f), 0.04f);
    EXPECT_EQ(fresnelDielectric(0, 1.5f), 1);
    EXPECT_EQ(fresnelDielectric(0.3f, 1), 0);
    EXPECT_EQ(fresnelDielectric(0, 1), 0);
    // At Brewster's angle, tan = eta, the light that swings along the plane is not mirrored at all.
    for (const double eta : {1.1, 1.5, 2.4, 0.7}) {
        const double e = eta * eta;
        EXPECT_NEAR(fresnelDielectric(static_cast<float>(1 / std::sqrt(1 + e)), static_cast<float>(eta)),
                    0.5 * (e - 1) * (e - 1) / ((e + 1) * (e + 1)), 2e-7);
    }
    EXPECT_EQ(fresnelDielectric(-0.4f, 1.5f), fresnelDielectric(0.4f, 1.5f));
    EXPECT_EQ(fresnelDielectric(1.0000002f, 1.5f), fresnelDielectric(1, 1.5f));
}

// Light that takes the way back is mirrored as much; a cosine of 0.01 magnifies roundings a hundred times and
// more.
TEST(FresnelDielectric, IsTheSameFromBothSides) {
    StressInputs draw(2);
    for (int i = 0; i < 2000; ++i) {
        const double cosine = draw.random().uniform(0.01, 1);
        const double eta = draw.random().uniform(1.05, 3);
        const BoundaryShare outside = shareAtBoundary(cosine, eta);
        const BoundaryShare inside = shareAtBoundary(outside.cosTransmitted, 1 / eta);
        EXPECT_NEAR(inside.mirrored, outside.mirrored, 2e-12);
        EXPECT_NEAR(inside.cosTransmitted, cosine, 2e-12);
    }
}

TEST(FresnelDielectric, FallsWithTheCosineAndStaysWithinUnity) {
    for (const float eta : {0.2f, 0.7f, 0.999999f, 1.0000001f, 1.5f, 4.0f, 1e9f}) {
        float last = 1;
        for (int i = 0; i <= 1000; ++i) {
            const float share = fresnelDielectric(static_cast<float>(i) / 1000, eta);
            EXPECT_TRUE(share >= 0 && share <= 1);
            // Beyond 2 + √3 the polarization along the plane makes a dip at Brewster's angle.
            if (eta > 0.27f && eta < 3.7f) {
                EXPECT_LE(share, last + 1e-7f) << eta << " " << i;
            }
            last = share;
        }
    }
}

TEST(FresnelConductor, IsADielectricWithoutLoss) {
    StressInputs draw(3);
    for (int i = 0; i < 5000; ++i) {
        const auto cosine = static_cast<float>(draw.random().uniform(0, 1));
        const auto eta = static_cast<float>(draw.magnitude(-1.5, 1.5));
        EXPECT_NEAR(fresnelConductor(cosine, eta, 0), fresnelDielectric(cosine, eta), 6e-8);
    }
    EXPECT_EQ(fresnelConductor(0, 1, 0), 0);
}

TEST(FresnelConductor, HasTheClosedFormAtNormalIncidence) {
    // Copper in red light mirrors 96 %.
    for (const auto& [eta, k] : {std::pair(0.2, 3.9), std::pair(1.0, 1.0), std::pair(3.1, 3.3)})
        EXPECT_NEAR(fresnelConductor(1, static_cast<float>(eta), static_cast<float>(k)),
                    ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k), 1e-7);
    EXPECT_EQ(fresnelConductor(0, 0.2f, 3.9f), 1);
}

double worstSchlick(float eta) {
    double worst = 0;
    for (int i = 0; i <= 4000; ++i) {
        const float cosine = static_cast<float>(i) / 4000;
        worst = std::max(worst, std::abs(static_cast<double>(fresnelSchlick(normalReflectance(eta), cosine)) -
                                         fresnelDielectric(cosine, eta)));
    }
    return worst;
}

TEST(Schlick, IsExactAtTheEndsAndOffBetween) {
    EXPECT_EQ(fresnelSchlick(0.04f, 1), 0.04f);
    EXPECT_EQ(fresnelSchlick(0.04f, 0), 1);
    EXPECT_FLOAT_EQ(normalReflectance(1.5f), 0.04f);
    EXPECT_NEAR(worstSchlick(1.5f), 0.0357, 1e-3);
    EXPECT_NEAR(worstSchlick(1.33f), 0.0599, 1e-3);
    EXPECT_NEAR(worstSchlick(2.4f), 0.0740, 1e-3);
    // From inside glass it mirrors 9 % where all light is mirrored.
    EXPECT_LT(fresnelSchlick(0.04f, 0.7f), 0.05f);
    EXPECT_EQ(fresnelDielectric(0.7f, 1 / 1.5f), 1);
}

TEST(Refract, KeepsSnellsLawAndThePlane) {
    StressInputs draw(4);
    for (int i = 0; i < 5000; ++i) {
        const vec3 n = draw.unitVector();
        const vec3 d = draw.unitVector();
        const auto eta = static_cast<float>(draw.random().uniform(1.01, 2.5));
        const auto t = refract(d, n, eta);
        ASSERT_TRUE(t);
        const glm::dvec3 into(*t);
        const glm::dvec3 normal(n);
        const glm::dvec3 from(d);
        EXPECT_NEAR(glm::length(glm::cross(normal, into)) * eta, glm::length(glm::cross(normal, from)), 4e-7);
        EXPECT_NEAR(glm::dot(glm::cross(normal, from), into), 0, 2e-7);
        EXPECT_GT(glm::dot(normal, into) * glm::dot(normal, from), 0);
        EXPECT_NEAR(glm::length(into), 1, 6e-8);
    }
}

TEST(Refract, ReturnsOnTheWayItCame) {
    StressInputs draw(5);
    for (int i = 0; i < 2000; ++i) {
        const vec3 n = draw.unitVector();
        const vec3 d = draw.unitVector();
        if (std::abs(glm::dot(d, n)) < 0.05f)
            continue;
        const auto into = refract(d, n, 1.5f);
        const auto back = refract(-*into, n, 1 / 1.5f);
        ASSERT_TRUE(back);
        EXPECT_LT(glm::length(glm::dvec3(*back) + glm::dvec3(d)), 4e-6);
    }
}

TEST(Refract, HasNoAnswerWhereThereIsNone) {
    EXPECT_FALSE(refract(vec3(1, -0.1f, 0), vec3(0, 1, 0), 1 / 1.5f));
    EXPECT_FALSE(refract(vec3(0), vec3(0, 1, 0), 1.5f));
    EXPECT_FALSE(refract(vec3(0, -1, 0), vec3(0), 1.5f));
    EXPECT_FALSE(refract(vec3(0, -1, 0), vec3(std::numeric_limits<float>::quiet_NaN()), 1.5f));
    // Exactly at the critical angle, 3-4-5: along the surface.
    const auto along = refract(vec3(0.75f, -1, 0), vec3(0, 1, 0), 0.6f);
    const auto exact = refract(vec3(3, -4, 0), vec3(0, 1, 0), 0.625f);
    ASSERT_TRUE(exact);
    EXPECT_FALSE(along && along->y > 0);
    EXPECT_EQ(*refract(vec3(0, -2, 0), vec3(0, 3, 0), 1.5f), vec3(0, -1, 0));
}

}  // namespace
}  // namespace quincunx

#include "geometry/ray_shapes_packed.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "math/stress_inputs.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// 2^-14 of the value, as the header promises, and what float holds of it.
void expectNear(float got, double exact, int i) {
    if (std::isinf(static_cast<float>(exact))) {
        EXPECT_EQ(got, static_cast<float>(exact)) << i;
        return;
    }
    EXPECT_LE(std::abs(got - exact), 0x1p-14 * exact + 0x1p-149) << i;
}

glm::vec3 someVector(StressInputs& draw, int kind) {
    if (kind == 0)
        return draw.vectorOfMagnitude(-3, 3);
    if (kind == 1)
        return draw.finiteVector();
    glm::vec3 v;
    do
        for (int axis = 0; axis < 3; ++axis)
            v[axis] = static_cast<float>(static_cast<int>(draw.random().below(9)) - 4);
    while (v == glm::vec3(0));
    return v;
}

struct Inputs {
    RayArrays rays;
    BallArrays balls;
    BoxArrays boxes;
};

/// Usual ones, any bits, whole numbers (tangents, axis-parallel rays, rays in faces), and edge cases of
/// sizes.
Inputs inputsOf(std::uint64_t seed, int count) {
    StressInputs draw(seed);
    Inputs in;
    for (int i = 0; i < count; ++i) {
        const int kind = i % 8 == 0 ? 1 : i % 2 == 0 ? 0 : 2;
        const Ball ball{someVector(draw, kind), kind == 2 ? static_cast<float>(draw.random().below(4))
                                                          : std::abs(someVector(draw, kind).x)};
        const glm::vec3 a = someVector(draw, kind);
        const glm::vec3 b = someVector(draw, kind);
        Ray ray{someVector(draw, kind), someVector(draw, kind)};
        if (i % 3 == 0 && ball.centre != ray.origin && kind != 1)
            ray.direction = ball.centre + 0.9f * ball.radius * draw.unitVector() - ray.origin;
        if (i % 7 == 0)
            ray.direction[i % 3] = i % 2 == 0 ? 0.0f : -0.0f;
        in.rays.add(ray);
        in.balls.add(ball);
        in.boxes.add({glm::min(a, b), glm::max(a, b)});
    }
    return in;
}

TEST(PackedRayShapes, DecideAsTheScalarOnes) {
    const Inputs in = inputsOf(1, 1500);
    std::vector<float> t(1500);
    int hits = 0;
    for (std::size_t k = 0; k < 60; ++k) {
        const Ball ball = in.balls.at(k * 7);
        const Bounds box = in.boxes.at(k * 7);
        const Ray ray = in.rays.at(k * 11);
        const auto expectBalls = [&](auto rayAt, auto ballAt) {
            for (std::size_t i = 0; i < t.size(); ++i) {
                const std::optional<double> exact = raySphereDistance(rayAt(i), ballAt(i));
                ASSERT_EQ(t[i] < infinity, exact && static_cast<float>(*exact) < infinity) << k << " " << i;
                hits += exact.has_value();
                if (exact)
                    expectNear(t[i], *exact, static_cast<int>(i));
            }
        };
        const auto expectBoxes = [&](auto rayAt, auto boxAt) {
            for (std::size_t i = 0; i < t.size(); ++i) {
                const std::optional<RaySpan> exact = rayBox(rayAt(i), boxAt(i));
                ASSERT_EQ(t[i] < infinity, exact && static_cast<float>(exact->enter) < infinity)
                    << k << " " << i;
                if (exact)
                    expectNear(t[i], exact->enter, static_cast<int>(i));
            }
        };
        intersectPacked(in.rays, ball, t);
        expectBalls([&](std::size_t i) { return in.rays.at(i); }, [&](std::size_t) { return ball; });
        intersectPacked(ray, in.balls, t);
        expectBalls([&](std::size_t) { return ray; }, [&](std::size_t i) { return in.balls.at(i); });
        intersectPacked(in.rays, box, t);
        expectBoxes([&](std::size_t i) { return in.rays.at(i); }, [&](std::size_t) { return box; });
        intersectPacked(ray, in.boxes, t);
        expectBoxes([&](std::size_t) { return ray; }, [&](std::size_t i) { return in.boxes.at(i); });
    }
    EXPECT_GT(hits, 3000);
}

TEST(PackedRayShapes, LeaveLittleToTheScalarOnesInAUsualScene) {
    StressInputs draw(2);
    RayArrays rays;
    for (int i = 0; i < 20000; ++i)
        rays.add({draw.vectorOfMagnitude(1, 3), draw.unitVector()});
    std::vector<float> t(rays.size());
    // Measured: 3 and 0.
    EXPECT_LE(intersectPacked(rays, Ball{{0, 0, 0}, 1}, t), 20u);
    EXPECT_LE(intersectPacked(rays, Bounds{{-1, -1, -1}, {1, 1, 1}}, t), 20u);
}

TEST(PackedRayShapes, ParallelRaysBesideABoxAreNoHarderThanOthers) {
    StressInputs draw(4);
    for (int axis = 0; axis < 3; ++axis) {
        RayArrays rays;
        for (int i = 0; i < 5000; ++i) {
            Ray ray{draw.vectorOfMagnitude(-1, 2), glm::vec3(0)};
            ray.direction[axis] = i % 2 == 0 ? 1.0f : -1.0f;
            rays.add(ray);
        }
        std::vector<float> t(rays.size());
        EXPECT_LE(intersectPacked(rays, Bounds{{-1, -1, -1}, {1, 1, 1}}, t), 5u) << axis;
        EXPECT_GT(std::count(t.begin(), t.end(), infinity), 1000) << axis;
    }
}

TEST(PackedRayShapes, NaiveOnesAgreeWhereNothingIsHard) {
    StressInputs draw(3);
    RayArrays rays;
    for (int i = 0; i < 4000; ++i)
        rays.add({draw.vectorOfMagnitude(1, 2), draw.unitVector()});
    std::vector<float> stable(rays.size());
    std::vector<float> naive(rays.size());
    const auto differing = [&] {
        int count = 0;
        for (std::size_t i = 0; i < stable.size(); ++i)
            count += std::isinf(stable[i]) != std::isinf(naive[i]) ||
                     (!std::isinf(stable[i]) && std::abs(naive[i] - stable[i]) > 1e-3f * stable[i]);
        return count;
    };
    const Ball ball{{0, 0, 0}, 1};
    intersectPacked(rays, ball, stable);
    intersectPackedNaive(rays, ball, naive);
    EXPECT_LE(differing(), 2);
    const Bounds box{{-1, -1, -1}, {1, 1, 1}};
    intersectPacked(rays, box, stable);
    intersectPackedNaive(rays, box, naive);
    EXPECT_EQ(differing(), 0);
    intersectPacked(rays, Bounds{}, stable);
    EXPECT_EQ(stable[0], infinity);
}

}  // namespace
}  // namespace quincunx

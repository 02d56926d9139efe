#include "scene/car.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "base/random.h"
#include "math/exact.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double u = 0x1p-53;

double distance(const CarState& a, const CarState& b) {
    return glm::length(a.position - b.position);
}

/// A car at speed, its wheels held.
CarState rolling(double speed, double steering) {
    CarState car;
    car.speed = speed;
    car.steering = steering;
    return car;
}

CarControls holding(const CarState& car, const CarBuild& build = {}) {
    return {car.speed / build.topSpeed, car.steering / build.mostSteering};
}

TEST(Car, DrivesACircleOfTheBicyclesRadius) {
    const CarBuild build;
    for (const double steering : {-0.6, -0.2, 1e-9, 0.35, 0.6}) {
        const CarState start = rolling(6, steering);
        const double radius = build.wheelbase / std::tan(steering);
        const double half = pi * std::abs(radius) / start.speed;
        const CarState there = advanced(start, holding(start), half);
        // Half way round: two radii to the side, facing back; a positive angle goes left, towards +x.
        EXPECT_NEAR(there.position.x, 2 * radius, 16 * u * pi * std::abs(radius));
        EXPECT_NEAR(there.position.z, 0, 64 * u * pi * std::abs(radius));
        EXPECT_NEAR(std::abs(there.heading.radians()), pi, 8 * u * pi);
        EXPECT_EQ(there.position.y, 0);
    }
}

TEST(Car, EndsAtTheSamePlaceInAnyNumberOfSteps) {
    for (const double steering : {0.0, 0.3, -0.55}) {
        const CarState start = rolling(7, steering);
        const CarState once = advanced(start, holding(start), 20);
        for (const int steps : {2, 50, 1000, 30'000}) {
            CarState car = start;
            for (int i = 0; i < steps; ++i)
                car = advanced(car, holding(start), 20.0 / steps);
            EXPECT_LE(distance(car, once), steps * 64 * u * 140) << steps;
            EXPECT_NEAR(car.distanceTravelled, 140, 1e-9);
        }
    }
}

TEST(Car, GainsSpeedUpToItsLimitAndStopsForGood) {
    const CarBuild build;
    CarState car;
    // v²/2a metres to the top speed, then the rest of the time at it.
    car = advanced(car, {1, 0}, 10);
    const double gaining = build.topSpeed / build.acceleration;
    EXPECT_EQ(car.speed, build.topSpeed);
    EXPECT_NEAR(car.position.z, build.topSpeed * (10 - gaining / 2), 1e-12);
    // Reverse first brakes to nothing, then goes back.
    const double braking = build.topSpeed / build.braking;
    const CarState stopped = advanced(car, {-1, 0}, braking);
    EXPECT_NEAR(stopped.speed, 0, 1e-12);
    const CarState back = advanced(car, {-1, 0}, braking + 10);
    EXPECT_EQ(back.speed, -build.topReverseSpeed);
    EXPECT_LT(back.position.z, stopped.position.z);
    // With no pedal it rolls out and stays.
    const CarState out = advanced(car, {}, 1e4);
    EXPECT_EQ(out.speed, 0);
    EXPECT_EQ(advanced(out, {}, 1e4).position, out.position);
}

TEST(Car, WheelsTurnAtTheirRateToTheirLimit) {
    const CarBuild build;
    CarState car;
    car = advanced(car, {0, 1}, 0.1);
    EXPECT_DOUBLE_EQ(car.steering, 0.1 * build.steeringRate);
    car = advanced(car, {0, 1}, 10);
    EXPECT_EQ(car.steering, build.mostSteering);
    car = advanced(car, {0, -1}, 10);
    EXPECT_EQ(car.steering, -build.mostSteering);
    EXPECT_EQ(car.position, glm::dvec3(0));
}

TEST(Car, TakesAnyControlsAndStaysFinite) {
    Random random(5);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    CarState car;
    for (int i = 0; i < 20'000; ++i) {
        const double values[] = {nan, inf, -inf, 1e300, random.uniform(-2, 2), 0};
        const CarControls controls{values[random.below(6)], values[random.below(6)]};
        car = advanced(car, controls, i % 100 == 0 ? 0 : random.uniform(0, 0.1));
        ASSERT_TRUE(std::isfinite(car.position.x) && std::isfinite(car.position.z) &&
                    std::isfinite(car.heading.radians()) && std::isfinite(car.speed));
        ASSERT_LE(std::abs(car.steering), CarBuild().mostSteering);
    }
}

TEST(Car, AMillionStepsAreOne) {
    // Round and round: 10⁶ steps of 10 ms, 70 km.
    const CarState start = rolling(7, 0.25);
    CarState car = start;
    for (int i = 0; i < 1'000'000; ++i)
        car = advanced(car, holding(start), 0.01);
    const CarState once = advanced(start, holding(start), 10'000);
    // Measured 2e-8 m: the heading, 7700 radians, is that of 10⁶ rounded angles of 0.0078.
    EXPECT_LE(distance(car, once), 1e-6);
    CarState naive = start;
    for (int i = 0; i < 1'000'000; ++i)
        naive = advancedNaive(naive, holding(start), 0.01);
    EXPECT_GE(distance(naive, once), 0.1);
}

TEST(Car, ThePoseIsRigidAndFacesTheHeading) {
    Random random(6);
    for (int i = 0; i < 500; ++i) {
        CarState car;
        car.heading = AngleSum(random.uniform(-1e6, 1e6));
        car.position = {random.uniform(-9, 9), 0, random.uniform(-9, 9)};
        const RigidPose pose = poseOf(car);
        EXPECT_NEAR(glm::determinant(pose.rotation), 1, 8 * u);
        EXPECT_NEAR(pose.rotation[2].x, std::sin(car.heading.radians()), 4 * u);
        EXPECT_NEAR(pose.rotation[2].z, std::cos(car.heading.radians()), 4 * u);
        EXPECT_EQ(pose.origin, car.position);
    }
}

TEST(Car, CamerasAreRigidAndSeeWhatTheySay) {
    Random random(7);
    for (int i = 0; i < 300; ++i) {
        CarState car;
        car.heading = AngleSum(random.uniform(-10, 10));
        car.position = {random.uniform(-90, 90), 0, random.uniform(-90, 90)};
        const RigidPose pose = poseOf(car);
        const auto seen = [&](const Camera& camera, glm::dvec3 pointInCar) {
            const glm::dvec3 world = pose.origin + pose.rotation * pointInCar;
            return glm::vec3(cameraFromWorld(camera.worldFromCamera) * glm::vec4(glm::vec3(world), 1));
        };
        for (const Camera& camera : {driverCamera(pose), chaseCamera(pose), birdCamera(pose, 30)}) {
            const glm::mat3 axes(camera.worldFromCamera);
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    EXPECT_NEAR(glm::dot(glm::dvec3(axes[a]), glm::dvec3(axes[b])), a == b ? 1 : 0, 1.1e-7);
            EXPECT_GT(determinant(axes), 0);
        }
        // 20 m ahead of the driver: in the middle of the picture. The driver's left is to the left.
        const glm::vec3 ahead = seen(driverCamera(pose), driversEye + glm::dvec3(0, 0, 20));
        EXPECT_LE(glm::length(ahead - glm::vec3(0, 0, -20)), 4e-5f);
        EXPECT_LT(seen(driverCamera(pose), driversEye + glm::dvec3(1, 0, 20)).x, -0.9f);
        // The chase camera has the car before it, the bird's the bonnet above the boot.
        EXPECT_LT(seen(chaseCamera(pose), {0, 1, 0}).z, -5);
        EXPECT_GT(seen(birdCamera(pose, 30), {0, 0, 3}).y, seen(birdCamera(pose, 30), {0, 0, 0}).y + 2.9f);
    }
}

TEST(CarModel, StandsOnTheGroundOnFourWheelsThatRollAndSteer) {
    Scene scene;
    const CarInstances car = addCar(scene);
    const Bounds bounds = scene.bounds();
    EXPECT_NEAR(bounds.min.y, 0, 0.01);
    EXPECT_NEAR(bounds.max.y, 1.52, 0.02);
    EXPECT_NEAR(bounds.min.x, -bounds.max.x, 0.02);
    EXPECT_LT(bounds.max.z - bounds.min.z, 5);
    EXPECT_LE(scene.triangleCount(), 9000u);
    EXPECT_GE(scene.triangleCount(), 2000u);
    for (const Instance& part : scene.instances)
        for (const glm::vec3 normal : scene.meshes[part.mesh].normals)
            ASSERT_NEAR(glm::length(normal), 1, 1e-5) << part.name;

    // A whole turn of the wheels on: as before; half a turn: upside down. Steered: turned about the upright.
    const Instance& frontWheel = scene.instances[car.first + car.count - 8];
    const glm::mat4 before = frontWheel.worldFromModel;
    const double circumference = 2 * pi * CarBuild().wheelRadius;
    placeCar(scene, car, glm::mat4(1), 0, circumference);
    EXPECT_LE(glm::length(frontWheel.worldFromModel[1] - before[1]), 1e-6f);
    placeCar(scene, car, glm::mat4(1), 0, circumference / 4);
    // The top of the wheel has come forwards.
    EXPECT_LE(glm::length(glm::vec3(frontWheel.worldFromModel[1]) - glm::vec3(0, 0, 1)), 1e-6f);
    placeCar(scene, car, glm::mat4(1), 0.5, 0);
    EXPECT_NEAR(frontWheel.worldFromModel[2].x, std::sin(0.5), 1e-6);
    EXPECT_EQ(scene.instances.back().worldFromModel[2].x, 0);

    const CarInstances other = addCarLike(scene, car, {0, 0, 1});
    EXPECT_EQ(other.count, car.count);
    EXPECT_EQ(scene.materials[other.paint].diffuse, glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.meshes.size(), 11u);
}

}  // namespace
}  // namespace quincunx

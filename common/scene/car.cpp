#include "scene/car.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "math/transform.h"

namespace quincunx {
namespace {

double clamped(double x) {
    return std::isnan(x) ? 0 : std::clamp(x, -1.0, 1.0);
}

/// Speed and way of a car while `seconds` go by.
struct Drive {
    double speed = 0;
    double distance = 0;
    double secondsLeft = 0;

    /// Towards a speed at a constant rate, until it is reached or the time is up.
    void towards(double target, double rate) {
        const double needed = std::abs(target - speed) / rate;
        const double time = std::min(needed, secondsLeft);
        const double next =
            needed <= secondsLeft ? target : speed + std::copysign(rate * time, target - speed);
        distance += 0.5 * (speed + next) * time;
        speed = next;
        secondsLeft -= time;
    }
};

struct Step {
    double speed = 0;
    double distance = 0;
    double steering = 0;      ///< at the end
    double meanSteering = 0;  ///< over the step
};

Step stepOf(const CarState& car, const CarControls& controls, double seconds, const CarBuild& build) {
    const double throttle = clamped(controls.throttle);
    Drive drive{car.speed, 0, seconds};
    if (throttle == 0) {
        drive.towards(0, build.coasting);
    } else {
        if (throttle * drive.speed < 0)
            drive.towards(0, std::abs(throttle) * build.braking);
        const double top = throttle > 0 ? build.topSpeed : build.topReverseSpeed;
        const double target = throttle * top;
        const bool faster = std::abs(drive.speed) > std::abs(target);
        drive.towards(target, faster ? build.coasting : std::abs(throttle) * build.acceleration);
    }
    drive.distance += drive.speed * drive.secondsLeft;

    Step step{drive.speed, drive.distance, car.steering, car.steering};
    const double target = clamped(controls.steering) * build.mostSteering;
    const double needed = std::abs(target - car.steering) / build.steeringRate;
    if (seconds > 0 && needed > 0) {
        const double time = std::min(needed, seconds);
        step.steering = needed <= seconds
                            ? target
                            : car.steering + std::copysign(build.steeringRate * time, target - car.steering);
        step.meanSteering =
            (0.5 * (car.steering + step.steering) * time + step.steering * (seconds - time)) / seconds;
    }
    return step;
}

}  // namespace

CarState advanced(const CarState& car, const CarControls& controls, double seconds, const CarBuild& build) {
    QX_CHECK(seconds >= 0 && std::isfinite(seconds));
    const Step step = stepOf(car, controls, seconds, build);
    const double curvature = std::tan(step.meanSteering) / build.wheelbase;
    const glm::dvec2 forwards = car.heading.direction();  // (cos, sin): along z and x
    const glm::dvec2 offset = arcOffset(step.distance, curvature);
    CarState next = car;
    next.position.z += forwards.x * offset.x - forwards.y * offset.y;
    next.position.x += forwards.y * offset.x + forwards.x * offset.y;
    next.heading.add(curvature * step.distance);
    next.speed = step.speed;
    next.steering = step.steering;
    next.distanceTravelled += step.distance;
    return next;
}

CarState advancedNaive(const CarState& car, const CarControls& controls, double seconds,
                       const CarBuild& build) {
    const Step step = stepOf(car, controls, seconds, build);
    const auto way = static_cast<float>(car.speed * seconds);
    const auto heading = static_cast<float>(car.heading.radians());
    const auto bend = static_cast<float>(std::tan(step.steering) / build.wheelbase);
    CarState next = car;
    next.position.x = static_cast<float>(car.position.x) + way * std::sin(heading);
    next.position.z = static_cast<float>(car.position.z) + way * std::cos(heading);
    next.heading = AngleSum(static_cast<double>(heading + way * bend));
    next.speed = step.speed;
    next.steering = step.steering;
    next.distanceTravelled += static_cast<double>(way);
    return next;
}

RigidPose poseOf(const CarState& car) {
    const glm::dvec2 forwards = car.heading.direction();
    const double c = forwards.x;
    const double s = forwards.y;
    return {glm::dmat3(glm::dvec3(c, 0, -s), glm::dvec3(0, 1, 0), glm::dvec3(s, 0, c)), car.position};
}

Camera driverCamera(const RigidPose& worldFromCar) {
    Camera camera;
    camera.worldFromCamera = cameraFacing(worldFromCar, driversEye).matrix();
    camera.fovYRadians = 1.05f;
    camera.nearDistance = 0.08f;
    camera.farDistance = 1500;
    return camera;
}

Camera chaseCamera(const RigidPose& worldFromCar) {
    const auto place = [&](glm::dvec3 pointInCar) {
        return glm::vec3(worldFromCar.origin + worldFromCar.rotation * pointInCar);
    };
    Camera camera;
    camera.worldFromCamera =
        lookAt(place({0, 2.7, -6.4}), place({0, 1.1, 4}), glm::vec3(worldFromCar.rotation[1]));
    camera.fovYRadians = 0.9f;
    camera.nearDistance = 0.4f;
    camera.farDistance = 1500;
    return camera;
}

Camera birdCamera(const RigidPose& worldFromCar, float heightMetres) {
    QX_CHECK(heightMetres > 0);
    // Straight down there is no world's up: the way the car faces is up.
    Camera camera;
    const glm::vec3 over(worldFromCar.origin + worldFromCar.rotation * glm::dvec3(0, 0, 4));
    camera.worldFromCamera =
        lookAt(over + glm::vec3(0, heightMetres, 0), over, glm::vec3(worldFromCar.rotation[2]));
    camera.fovYRadians = 0.7f;
    camera.nearDistance = heightMetres / 16;
    camera.farDistance = heightMetres * 4;
    return camera;
}

}  // namespace quincunx

#pragma once

#include <array>
#include <cstddef>

#include <glm/glm.hpp>

#include "math/rigid_motion.h"
#include "scene/scene.h"

namespace quincunx {

/// A small car: how it moves, what it looks like, and where the cameras in and behind it are.
///
/// The car's frame is right-handed, in metres: origin on the ground below the middle of the rear axle, y up,
/// and it faces +z; +x is therefore to the driver's left. World frame: y up, the ground at y = 0. Heading 0
/// faces the world's +z, and grows to the left, towards +x.

/// Sizes and limits. Angles in radians, lengths in metres, times in seconds.
struct CarBuild {
    double wheelbase = 2.3;
    double wheelRadius = 0.33;
    double topSpeed = 14;        ///< m/s forwards
    double topReverseSpeed = 4;  ///< m/s
    double acceleration = 4;     ///< m/s² at full throttle
    double braking = 9;          ///< m/s² against the motion
    double coasting = 1.2;       ///< m/s² with no pedal
    double mostSteering = 0.6;   ///< of the front wheels, to either side
    double steeringRate = 1.6;   ///< radians a second
};

/// Where the car is and how it moves; plain data.
struct CarState {
    glm::dvec3 position{0};        ///< of the car's origin, world
    AngleSum heading;              ///< radians to the left of the world's +z
    double speed = 0;              ///< m/s along the way it faces; negative: backwards
    double steering = 0;           ///< radians of the front wheels to the left
    double distanceTravelled = 0;  ///< metres, backwards counts negative: how far the wheels have rolled

    bool operator==(const CarState&) const = default;
};

/// What the driver does.
struct CarControls {
    double throttle = 0;  ///< 1 forwards … −1 backwards; against the motion it brakes
    double steering = 0;  ///< 1 full left … −1 full right

    bool operator==(const CarControls&) const = default;
};

/// The car after `seconds` ≥ 0 of unchanging controls. The rear axle follows the front wheels' angle δ on a
/// circle of curvature tan δ / wheelbase (the bicycle model: Rajamani, "Vehicle Dynamics and Control",
/// section 2.2, for the reference point on the rear axle). Speed changes at a constant rate up to its limit,
/// and the arc is gone exactly (`arcOffset`), so that with the wheels held a path does not depend on how it
/// is cut into steps: n steps end within n · 64 u of the length. While the wheels turn, a step takes their
/// mean angle. Controls are clamped to −1 … 1; those that are not numbers are 0. Held by Car.*.
CarState advanced(const CarState& car, const CarControls& controls, double seconds,
                  const CarBuild& build = {});

/// What a game loop does: position += speed · dt · direction, heading += rate · dt, in float. Arcs become
/// polygons, and where they end depends on the frame rate.
CarState advancedNaive(const CarState& car, const CarControls& controls, double seconds,
                       const CarBuild& build = {});

/// world_from_car = T R.
RigidPose poseOf(const CarState& car);

/// The driver's eye, in the car's frame.
inline constexpr glm::dvec3 driversEye{0.34, 1.17, 0.62};

/// The camera at the driver's eye, seeing what the car faces: R is that of the car turned half round about y,
/// since a camera looks along its −z.
Camera driverCamera(const RigidPose& worldFromCar);
/// Behind and above the car, looking ahead over its roof.
Camera chaseCamera(const RigidPose& worldFromCar);
/// From `heightMetres` > 0 straight above, the way it faces up in the picture.
Camera birdCamera(const RigidPose& worldFromCar, float heightMetres);

/// The instances that a car has in a scene.
struct CarInstances {
    std::size_t first = 0;
    std::size_t count = 0;
    std::size_t paint = 0;  ///< index into Scene::materials: change its colour at will
};

/// Adds the model of a car: about 7000 triangles, its own materials. `paint` and `roof`: linear RGB.
CarInstances addCar(Scene& scene, glm::vec3 paint = {0.52f, 0.025f, 0.02f},
                    glm::vec3 roof = {0.78f, 0.70f, 0.56f});

/// Puts a car's instances where `worldFromCar` says (rigid for a car as it should be), wheels rolled and
/// steered.
void placeCar(Scene& scene, const CarInstances& car, const glm::mat4& worldFromCar, double steeringRadians,
              double distanceTravelled, const CarBuild& build = {});
/// Another car of the same model: shares meshes, has its own paint.
CarInstances addCarLike(Scene& scene, const CarInstances& model, glm::vec3 paint);

}  // namespace quincunx

#pragma once

#include <cstddef>
#include <span>

#include <glm/glm.hpp>

#include "math/euler.h"
#include "scene/scene.h"

/// What the lab shows. World and body: right-handed, y up, the aeroplane's nose along +z, its port wing along
/// +x; angles in radians.
namespace quincunx {

/// The colour of an axis, linear RGB: x (pitch) red, y (head) green, z (roll) blue.
glm::vec3 axisColor(int axis);

/// Where the aeroplane's navigation lights are, in its own frame: red to port, green to starboard.
inline constexpr glm::vec3 portLightBody{0.80f, -0.02f, 0.06f};
inline constexpr glm::vec3 starboardLightBody{-0.80f, -0.02f, 0.06f};

/// An aeroplane in three rings, each of which turns in the next larger one, in a cradle on a foot.
Scene makeGimbalScene();
/// Turns the rings and the body. The rings wear the colours of their axes. Without `rings` the aeroplane
/// flies alone.
void placeGimbal(Scene& scene, EulerAngles angles, EulerOrder order, bool rings);

/// The aeroplane alone, carried by any matrix.
void placeBody(Scene& scene, const glm::mat3& worldFromBody);

/// Radius of the ring of a gimbal: 0 outer, 1 middle, 2 inner.
float ringRadius(int ring);

/// The core of a globe of radius `globeRadius`, and `count` small aeroplanes, the last of them larger and
/// brighter.
Scene makeFlightScene(std::size_t count);
inline constexpr float globeRadius = 1.42f;
/// Puts each aeroplane on the globe, belly down, where its pose carries the globe's north pole. A pose that
/// is no rotation shears the aeroplane and sinks it.
void placeFlight(Scene& scene, std::span<const glm::mat3> worldFromBody);
/// Where that is.
glm::vec3 flightPosition(const glm::mat3& worldFromBody);

}  // namespace quincunx

#pragma once

#include "scene/scene.h"

namespace quincunx {

/// True if something of the scene hangs from a node that a channel moves, or from a node below such a one:
/// what `pose` may place. A scene whose keys all say the same counts as animated.
bool isAnimated(const Scene& scene);

/// The time of the last key of all animations, in seconds; 0 without keys.
double animationSeconds(const Scene& scene);

/// Places the instances, lights and cameras that hang from nodes as they are at that time (glTF 2.0,
/// sections 3.5.3 and 3.11); does nothing in a scene that is not animated.
///
/// All animations play at once, over and over, each round as long as `animationSeconds`, before time 0 as
/// after it. Before its first key and after its last one a channel holds that key's value; a round of no
/// length, or a time that is not finite, shows time 0. Where two channels move the same, the later one in
/// the list wins. Between equal key times the later key counts.
///
/// Computed from the keys and the nodes at rest in double and rounded once, whatever was posed before: the
/// same time gives the same placement, bit for bit. Cameras and the directions of lights are unit vectors
/// again, whatever the scale; in a frame without volume they keep what is left of it. A placement beyond the
/// range of float lets an instance vanish (all of it at the origin), and puts a light or a camera at the
/// origin. Held by Pose.*.
void pose(Scene& scene, double seconds);

/// Places what hangs from nodes as the nodes are at rest, where no key speaks.
void poseAtRest(Scene& scene);

}  // namespace quincunx

#pragma once

#include <glm/glm.hpp>

#include "geometry/mesh.h"
#include "scene/scene.h"

namespace quincunx {

/// A camera that a person moves about a scene, in one of two ways: orbiting a pivot, or flying.
///
/// The pose is kept in double as a position and three angles, so that no orientation is degenerate: straight
/// up and straight down are poses like others, and no sequence of calls gives a number that is not finite.
/// World frame: right-handed, y up. Angles in radians. Drags are in heights of the picture, x to the right
/// and y downwards, so that neither the window's size nor the display's density changes what a drag does.
class CameraControl {
  public:
    enum class Mode { orbit, fly };

    /// Starts from `start`, which `camera` returns unchanged, bit for bit, until something moves. `bounds`
    /// (may be empty) says what the scene's size is: distances, speeds and depth planes follow from it.
    CameraControl(const Camera& start, const Bounds& bounds);

    Mode mode() const { return mode_; }
    /// The pivot of the orbit becomes the point ahead that is nearest to the middle of the bounds.
    void setMode(Mode mode);
    /// Back to the start, in the same mode.
    void reset();

    /// Orbit: turns about the pivot as if the drag held the scene, half a circle for one height. Fly: turns
    /// the eye on the spot towards the drag, a quarter circle for one height. Both end at the poles.
    void turn(glm::dvec2 dragHeights);
    /// Moves the eye across the view so that what lies at the pivot's distance follows the drag.
    void pan(glm::dvec2 dragHeights);
    /// Wheel, positive away from the person. Orbit: towards the pivot, each notch a tenth of the way. Fly: a
    /// fifth faster.
    void zoom(double notches);
    /// Flies: x to the right, y up in the world, z forwards, in seconds at full speed. A movement cut into
    /// any number of frames ends at the same place.
    void fly(glm::dvec3 seconds);

    /// With depth planes that hold the bounds, and what the knobs may make of them, three radii around.
    Camera camera() const;
    /// Of flight, in world units per second.
    double speed() const { return speed_; }

  private:
    glm::dmat3 worldFromCamera() const;
    void setPivot();
    void keepInReach();

    Camera start_;
    glm::dvec3 centre_;
    double radius_;
    Mode mode_ = Mode::orbit;
    bool moved_ = false;

    glm::dvec3 position_{0};
    double yaw_ = 0;    ///< about the world's y, counter-clockwise from above; 0 looks along −z
    double pitch_ = 0;  ///< upwards, −π/2 … π/2
    double roll_ = 0;   ///< about the view, counter-clockwise as the person sees it
    double distance_ = 1;
    double speed_ = 1;
};

}  // namespace quincunx

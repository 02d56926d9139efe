#include "scene/camera_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace quincunx {
namespace {

constexpr double pi = std::numbers::pi;

/// How far the eye may go, and how near to the pivot, in radii of the scene.
constexpr double farthestRadii = 1e3;
constexpr double nearestRadii = 1e-3;

/// What a camera can hold as a float.
constexpr double largestCoordinate = std::numeric_limits<float>::max();
constexpr double smallestDistance = std::numeric_limits<float>::min();

glm::dvec3 clampLength(const glm::dvec3& v, double longest) {
    const double length = glm::length(v);
    return length > longest ? v * (longest / length) : v;
}

}  // namespace

CameraControl::CameraControl(const Camera& start, const Bounds& bounds)
    : start_(start), centre_(bounds.centre()), radius_(bounds.radius()) {
    // A scene of one point has no size to go by.
    if (!(radius_ > 0))
        radius_ = 1;
    reset();
}

void CameraControl::reset() {
    const glm::dmat3 world(start_.worldFromCamera);
    const glm::dvec3 right = world[0];
    const glm::dvec3 forward = -world[2];
    position_ = glm::dvec3(start_.worldFromCamera[3]);
    const double level = std::hypot(forward.x, forward.z);
    pitch_ = std::atan2(forward.y, level);
    // Upright views have no heading of their own: theirs is what lies to the right.
    yaw_ = level > 0 ? std::atan2(-forward.x, -forward.z) : std::atan2(-right.z, right.x);
    roll_ = 0;
    const glm::dmat3 upright = worldFromCamera();
    roll_ = std::atan2(glm::dot(right, upright[1]), glm::dot(right, upright[0]));
    speed_ = radius_;
    setPivot();
    moved_ = false;
}

void CameraControl::setMode(Mode mode) {
    mode_ = mode;
    setPivot();
}

void CameraControl::setPivot() {
    const glm::dvec3 towards = centre_ - position_;
    const double ahead = glm::dot(towards, -worldFromCamera()[2]);
    distance_ = ahead > 0 ? ahead : glm::length(towards);
    distance_ = std::clamp(distance_, nearestRadii * radius_, farthestRadii * radius_);
}

void CameraControl::turn(glm::dvec2 dragHeights) {
    const glm::dvec3 pivot = position_ - worldFromCamera()[2] * distance_;
    const double radians = mode_ == Mode::orbit ? pi : pi / 2;
    yaw_ = std::remainder(yaw_ - radians * dragHeights.x, 2 * pi);
    pitch_ = std::clamp(pitch_ - radians * dragHeights.y, -pi / 2, pi / 2);
    if (mode_ == Mode::orbit)
        position_ = pivot + worldFromCamera()[2] * distance_;
    keepInReach();
}

void CameraControl::pan(glm::dvec2 dragHeights) {
    const double height = 2 * distance_ * std::tan(static_cast<double>(start_.fovYRadians) / 2);
    const glm::dmat3 world = worldFromCamera();
    position_ += (world[1] * dragHeights.y - world[0] * dragHeights.x) * height;
    keepInReach();
}

void CameraControl::zoom(double notches) {
    if (mode_ == Mode::fly) {
        speed_ = std::clamp(speed_ * std::pow(1.2, notches), nearestRadii * radius_, farthestRadii * radius_);
        return;
    }
    const glm::dvec3 back = worldFromCamera()[2];
    const glm::dvec3 pivot = position_ - back * distance_;
    distance_ =
        std::clamp(distance_ * std::pow(0.9, notches), nearestRadii * radius_, farthestRadii * radius_);
    position_ = pivot + back * distance_;
    keepInReach();
}

void CameraControl::fly(glm::dvec3 seconds) {
    const glm::dmat3 world = worldFromCamera();
    position_ += (world[0] * seconds.x + glm::dvec3(0, 1, 0) * seconds.y - world[2] * seconds.z) * speed_;
    keepInReach();
}

void CameraControl::keepInReach() {
    position_ = centre_ + clampLength(position_ - centre_, farthestRadii * radius_);
    position_ = glm::clamp(position_, glm::dvec3(-largestCoordinate), glm::dvec3(largestCoordinate));
    moved_ = true;
}

glm::dmat3 CameraControl::worldFromCamera() const {
    const double sy = std::sin(yaw_);
    const double cy = std::cos(yaw_);
    const double sp = std::sin(pitch_);
    const double cp = std::cos(pitch_);
    const glm::dvec3 right(cy, 0, -sy);
    const glm::dvec3 up(sy * sp, cp, cy * sp);
    const glm::dvec3 back(sy * cp, -sp, cy * cp);
    return {right * std::cos(roll_) + up * std::sin(roll_), up * std::cos(roll_) - right * std::sin(roll_),
            back};
}

Camera CameraControl::camera() const {
    if (!moved_)
        return start_;
    // The nearest 1/1024 of the depth is cut off: with 24 bits a step of depth at the far plane is then
    // 1024 / 2^24 of the distance, a sixteenth of a pixel in a picture of a thousand rows.
    constexpr double depthRatio = 1024;
    constexpr double roomRadii = 3;
    Camera camera = start_;
    camera.worldFromCamera = glm::mat4(glm::dmat4(worldFromCamera()));
    camera.worldFromCamera[3] = glm::vec4(glm::vec3(position_), 1);
    const double distance = glm::length(position_ - centre_);
    const double farDistance =
        std::clamp(distance + roomRadii * radius_, smallestDistance * depthRatio, largestCoordinate);
    const double nearDistance = std::max(distance - roomRadii * radius_, farDistance / depthRatio);
    camera.nearDistance = static_cast<float>(nearDistance);
    camera.farDistance = static_cast<float>(farDistance);
    return camera;
}

}  // namespace quincunx

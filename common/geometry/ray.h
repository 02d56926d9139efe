#pragma once

#include <glm/glm.hpp>

/// Rays and the plain shapes they are tested against. All in one frame and unit; every number is finite.
/// Axis-aligned boxes are Bounds (geometry/mesh.h); solids of revolution are in geometry/shapes.h.
namespace quincunx {

/// A half line: origin + t · direction, t ≥ 0. The direction has any finite length but zero, and t counts in
/// lengths of it.
struct Ray {
    glm::vec3 origin{0};
    glm::vec3 direction{0, 0, -1};
};

/// The same in double.
struct DRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, -1};
};

/// A sphere with a place. radius ≥ 0; a ball of radius 0 is its centre.
struct Ball {
    glm::vec3 centre{0};
    float radius = 1;
};

/// All p with normal · p + offset = 0. The normal has any finite length but zero and points to the side that
/// counts as in front; `offset` is −normal · p of any point p of the plane, not the plane's distance.
struct Plane {
    glm::vec3 normal{0, 1, 0};
    float offset = 0;
};

/// Where a ray meets a surface. t is a double since quotients of floats reach 2^±278, beyond float.
struct RayHit {
    double t = 0;               ///< in lengths of the ray's direction
    glm::vec3 point{0};         ///< on the surface, rounded once
    glm::vec3 normal{0, 1, 0};  ///< unit length; which side is said by the routine
};

}  // namespace quincunx

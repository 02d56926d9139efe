#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/shapes.h"
#include "scene/scene.h"

namespace quincunx {

/// A scene whose surfaces are known in closed form. World space: right-handed, y up, one unit is a hand's
/// breadth.
struct StillLife {
    struct Object {
        std::string name;
        Shape shape;
        Material material;
        glm::mat4 worldFromModel{1};
        float detail = 1;  ///< times the segments that the others get, for what is large or small
    };
    std::vector<Object> objects;
    std::vector<Light> lights;
    Camera camera;
    glm::vec3 ambientLight{0};      ///< linear RGB, from every direction
    glm::vec3 backgroundTop{0};     ///< linear RGB
    glm::vec3 backgroundBottom{0};  ///< linear RGB
};

/// The house's own scene: on a round dark plinth with a brass band, an ivory pawn, a jade vase, a red egg
/// and an ultramarine ring at the corners of a square, and in the middle a glowing pearl in a golden ring.
StillLife makeStillLife();

/// The same as triangles: for each object a mesh, a material and an instance of its name, in order.
/// `segments` as in quincunx::tessellate for shapes, times each object's detail and kept in its range.
Scene tessellate(const StillLife& stillLife, int segments);

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/mesh.h"

namespace quincunx {

/// Puts a mesh together from flat faces, bars and parts of other meshes. All faces are counter-clockwise seen
/// from outside; normals come with them.
class MeshBuilder {
  public:
    void triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c);
    /// A flat one.
    void quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);
    /// A flat convex polygon, as a fan.
    void polygon(std::span<const glm::vec3> corners);

    /// Which faces of a box are made.
    struct Faces {
        bool bottom = true;
        bool back = true;     ///< towards −z
        bool inward = false;  ///< all of them seen from inside
    };
    void box(glm::vec3 min, glm::vec3 max, Faces faces);
    void box(glm::vec3 min, glm::vec3 max) { box(min, max, Faces{}); }

    /// A round bar through two or more points, no two neighbours equal; its ends, if open, are closed by flat
    /// caps. `sides` ≥ 3.
    void tube(std::span<const glm::vec3> points, float radius, int sides, bool closed = false);
    /// A cylinder or cone about an upright axis, from the point `bottom`, radii ≥ 0, not both 0; with a cap
    /// on top, and below if asked.
    void column(glm::vec3 bottom, float height, float bottomRadius, float topRadius, int sides,
                bool capBelow = false);
    /// A disc facing up.
    void disc(glm::vec3 centre, float radius, int sides);

    /// Another mesh with normals, carried by an affine map.
    void append(const Mesh& mesh, const glm::mat4& place = glm::mat4(1));

    bool empty() const { return mesh_.indices.empty(); }
    /// What was made, and starts anew.
    Mesh take(std::string name);

  private:
    std::uint32_t vertex(glm::vec3 position, glm::vec3 normal);
    Mesh mesh_;
};

/// A smooth skin over rings of equally many points (at least 3, going round counter-clockwise seen from the
/// end of the chain): each ring joined to the next, the ends closed by fans if asked. Smooth normals.
Mesh loft(std::span<const std::vector<glm::vec3>> rings, bool capStart, bool capEnd, std::string name);

/// The triangles of `mesh` for which `keep` is set, vertices and normals as they are.
Mesh subset(const Mesh& mesh, const std::vector<bool>& keep, std::string name);

/// The point at an angle (0 at +a, growing towards +b) on |x/a|ⁿ + |y/b|ⁿ = 1; exponent n > 0: 2 is the
/// ellipse, more is squarer.
glm::vec2 superellipse(float radians, float a, float b, float exponent);

}  // namespace quincunx

#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace quincunx {

/// Axis-aligned box; empty when any `min` exceeds its `max`, as a new one does.
struct Bounds {
    glm::vec3 min{std::numeric_limits<float>::infinity()};
    glm::vec3 max{-std::numeric_limits<float>::infinity()};

    bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
    /// Grown to hold `point`; a point that is not finite is left out.
    void extend(const glm::vec3& point);
    void extend(const Bounds& other);
    /// The middle and half the diagonal, without overflow for any finite box; (0,0,0) and 0 when empty.
    glm::vec3 centre() const;
    float radius() const;
};

/// Indexed triangles, counter-clockwise seen from outside. What is known of vertices besides their positions
/// is empty or has one entry a vertex; `indices` has three entries a triangle.
struct Mesh {
    std::string name = {};
    std::vector<glm::vec3> positions = {};   ///< model space
    std::vector<glm::vec3> normals = {};     ///< model space, unit length
    std::vector<glm::vec2> texcoords = {};   ///< (0,0) is the texture's top left, as in glTF
    std::vector<glm::vec2> texcoords1 = {};  ///< a second set
    /// xyz: along s, model space, unit length; w: the sign of the bitangent cross(normal, tangent)
    std::vector<glm::vec4> tangents = {};
    std::vector<glm::vec4> colors = {};  ///< linear RGB and alpha, multiplied with the base colour
    std::vector<std::uint32_t> indices = {};

    std::size_t triangleCount() const { return indices.size() / 3; }
    Bounds bounds() const;
};

}  // namespace quincunx

#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "gl/executor.h"

namespace quincunx {

/// Line segments of any width with round ends, antialiased: for axes, rays, frames and arrows. OpenGL's own
/// lines are one pixel wide in a core context; these are quads, spread out by the vertex shader.
class Lines {
  public:
    struct Style {
        glm::vec4 color{1};     ///< linear RGB, not multiplied with the opacity in a
        float widthPixels = 2;  ///< of the target; > 0
        float dashPixels = 0;   ///< length of a dash and of a gap; 0: none
    };

    void clear() { segments_.clear(); }
    bool empty() const { return segments_.empty(); }
    std::size_t count() const { return segments_.size(); }

    void segment(glm::vec3 from, glm::vec3 to, const Style& style);
    void polyline(std::span<const glm::vec3> points, const Style& style, bool closed = false);
    /// A shaft with four barbs of `headLength` (in the units of the points).
    void arrow(glm::vec3 from, glm::vec3 to, float headLength, const Style& style);
    /// A circle of `segments` ≥ 3 chords about `center`, in the plane across `normal` (not zero).
    void circle(glm::vec3 center, glm::vec3 normal, float radius, const Style& style, int segments = 64);
    /// The twelve edges of the box −1…1 in each axis, carried by `worldFromBox`, which may be projective: the
    /// clip cube and view frusta among them.
    void box(const glm::mat4& worldFromBox, const Style& style);
    /// The axes of a frame as arrows of length 1 from its origin: x red, y green, z blue.
    void axes(const glm::mat4& worldFromFrame, float widthPixels = 3);

    struct View {
        glm::mat4 clipFromWorld{1};
        glm::vec2 viewportPixels{1};  ///< size of the viewport that is set
        bool depthTest = true;        ///< hidden behind what the depth buffer has
        /// Towards the viewer, in units of normalized depth: what lies in a surface is seen on it.
        float depthBias = 0;
    };
    /// Into the bound target, over what is there, without writing depth. Leaves blending and depth test off.
    void draw(graph::PassContext& context, const View& view);

  private:
    struct Segment {
        glm::vec3 from;
        glm::vec3 to;
        glm::vec4 color;
        glm::vec2 widthAndDash;
    };
    struct Device {
        gl::Buffer segments;
        gl::VertexArray vertexArray;
    };
    std::vector<Segment> segments_;
    std::optional<Device> device_;
};

}  // namespace quincunx

#pragma once

#include <optional>
#include <vector>

#include "gl/executor.h"
#include "passes/scene_buffers.h"

namespace quincunx {

/// Phong shading with Blinn's highlight (`blinnPhong`) or Phong's mirrored light.
gl::ProgramFiles phongProgram(bool blinnPhong = true);

/// The program for instances whose back is lit as well.
gl::ProgramFiles doubleSidedVariant(gl::ProgramFiles program);

/// The frame block's vertical gradient over the whole target, without touching the depth. The frame block is
/// bound.
void drawBackground(graph::PassContext& context);

struct ForwardParams {
    /// Its blocks are SceneBuffers' where it names none. `DOUBLE_SIDED` is defined for instances that are.
    gl::ProgramFiles program = phongProgram();
    std::vector<bool> doubleSided = {};  ///< by instance: the back is lit as well
    std::vector<bool> mirrored = {};     ///< by instance: its placement makes clockwise of counter-clockwise
    bool background = true;              ///< draw the frame block's gradient first
};

/// Draws every instance of `buffers`, whose blocks are up to date, into the bound target, whose depth is
/// clear. Culls the backs of what is not double-sided. Leaves depth test and culling off.
void drawForward(graph::PassContext& context, const SceneBuffers& buffers, const ForwardParams& params);

/// Where a scene is looked at from. `clipFromWorld` need not be a perspective projection.
struct ForwardView {
    glm::mat4 clipFromWorld{1};
    glm::vec3 eyeWorld{0};   ///< what highlights are seen from
    bool background = true;  ///< draw the scene's gradient first
};
ForwardView forwardView(const Camera& camera, float aspect);

/// A scene that is drawn with Phong shading, as often a frame as wanted.
class ForwardScene {
  public:
    explicit ForwardScene(Scene scene) : scene_(std::move(scene)) {}

    const Scene& scene() const { return scene_; }
    /// For placements, materials, lights and backgrounds, at any time; meshes, textures and the number of
    /// instances are those of the first `draw`.
    Scene& scene() { return scene_; }

    /// Into the bound target's viewport, whose depth is clear. The buffers are made at the first call, in the
    /// context that is current then.
    void draw(graph::PassContext& context, const ForwardView& view,
              const gl::ProgramFiles& program = phongProgram());

    /// Lets programs read the camera, lights and background (FrameBlock), for backgrounds of one's own.
    void bindFrame(const ForwardView& view);

    /// Positions alone, into the bound depth target's viewport, as a light sees them. `backFaces`: the far
    /// sides of solids instead of the near ones; what is double-sided or cut out is drawn from both.
    void drawDepth(graph::PassContext& context, const glm::mat4& clipFromWorld, bool backFaces);
    std::size_t triangleCount() const { return scene_.triangleCount(); }

  private:
    /// How the instances are drawn, and what shaders read of them.
    struct Placed {
        ForwardParams params;
        std::vector<ObjectBlock> objects;
    };
    /// Makes the buffers if there are none yet.
    Placed place();

    Scene scene_;
    std::optional<SceneBuffers> buffers_;
};

}  // namespace quincunx

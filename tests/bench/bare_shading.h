#pragma once

#include <cstddef>
#include <vector>

#include <glad/gl.h>

#include "image/image.h"
#include "passes/scene_buffers.h"
#include "scene/scene.h"

namespace quincunx {

/// The picture of lab 10 at its defaults as a program for it alone draws it: plain OpenGL, the same shader
/// files and triangles. What no frame changes is set once, each frame sets what differs between its two
/// passes, and nothing is checked or looked up. The peer that the engine is measured against.
class BareShading {
  public:
    /// Makes everything on the current context, and leaves it set up for `draw`.
    BareShading(int width, int height);
    ~BareShading();
    BareShading(const BareShading&) = delete;
    BareShading& operator=(const BareShading&) = delete;

    const Camera& camera() const { return camera_; }
    void draw(const Camera& camera);
    /// The picture last drawn, top row first, sRGB.
    Image8 picture() const;

  private:
    struct Draw {
        GLsizei indexCount = 0;
        std::size_t firstIndexByte = 0;
        GLint baseVertex = 0;
    };
    enum BufferName { vertexBuffer, indexBuffer, frameBuffer, objectBuffer, bufferCount };
    enum TextureName { white, fineColor, fineDepth, pixels, textureCount };

    void uploadScene(const Scene& scene);
    void makeTargets();

    int width_;
    int height_;
    float aspect_;
    Camera camera_;
    FrameBlock frame_;
    std::vector<Draw> draws_;
    GLuint buffers_[bufferCount] = {};
    GLuint textures_[textureCount] = {};
    GLuint fineFramebuffer_ = 0;
    GLuint framebuffer_ = 0;
    GLuint vertexArray_ = 0;
    GLuint noAttributes_ = 0;
    GLuint background_ = 0;
    GLuint phong_ = 0;
    GLuint downsample_ = 0;
};

}  // namespace quincunx

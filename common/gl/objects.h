#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glad/gl.h>
#include <glm/glm.hpp>

#include "image/block_compression.h"
#include "image/image.h"

/// Owners of GL objects: made whole or not at all, labelled (KHR_debug) so that errors name them, deleted at
/// the end of their life. Each must die while its context is current, or after every context is gone.
namespace quincunx::gl {

/// The name of one GL object of a kind; moves, never copies.
template <typename Deleter>
class Handle {
  public:
    Handle() = default;
    explicit Handle(GLuint name) : name_(name) {}
    Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~Handle() {
        if (name_ != 0)
            Deleter{}(name_);
    }
    GLuint get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

  private:
    GLuint name_ = 0;
};

struct DeleteBuffer {
    void operator()(GLuint name) const;
};
struct DeleteVertexArray {
    void operator()(GLuint name) const;
};
struct DeleteTexture {
    void operator()(GLuint name) const;
};
struct DeleteFramebuffer {
    void operator()(GLuint name) const;
};
struct DeleteProgram {
    void operator()(GLuint name) const;
};
struct DeleteSampler {
    void operator()(GLuint name) const;
};
struct DeleteQuery {
    void operator()(GLuint name) const;
};

/// Attaches `label` to an object for the driver's messages, where KHR_debug exists. `identifier`: GL_BUFFER …
void setLabel(GLenum identifier, GLuint name, std::string_view label);

/// A buffer with contents.
class Buffer {
  public:
    Buffer() = default;
    /// `target` is where it is first bound (GL_ARRAY_BUFFER, GL_ELEMENT_ARRAY_BUFFER, GL_UNIFORM_BUFFER …).
    /// Throws GlError if the device has no room. Contents of element buffers travel by another target, so
    /// that the bound vertex array stays as it is.
    Buffer(std::string_view label, GLenum target, std::span<const std::byte> contents,
           GLenum usage = GL_STATIC_DRAW);
    /// Replaces the contents; the size may change.
    void upload(std::span<const std::byte> contents);
    /// Lets the uniform blocks of `binding` read a part of the contents; the offset is a multiple of 256, the
    /// largest alignment that OpenGL allows a driver to ask for.
    void bindUniform(GLuint binding, std::size_t offsetBytes, std::size_t sizeBytes) const;
    GLuint get() const { return handle_.get(); }
    explicit operator bool() const { return static_cast<bool>(handle_); }
    std::size_t size() const { return size_; }

  private:
    Handle<DeleteBuffer> handle_;
    GLenum target_ = GL_ARRAY_BUFFER;
    GLenum usage_ = GL_STATIC_DRAW;
    std::size_t size_ = 0;
};

/// Where vertex attributes come from.
class VertexArray {
  public:
    struct Attribute {
        GLuint location = 0;
        GLint components = 3;
        GLenum type = GL_FLOAT;
        bool normalized = false;
        GLsizei strideBytes = 0;
        std::size_t offsetBytes = 0;
        GLuint divisor = 0;  ///< 0: one value a vertex; n: one for n instances
    };
    VertexArray() = default;
    explicit VertexArray(std::string_view label);
    /// Reads one attribute from `buffer`, which must outlive this; leaves this vertex array bound.
    void attribute(const Buffer& buffer, const Attribute& attribute);
    /// Takes triangle indices from `buffer`, which must outlive this.
    void indices(const Buffer& buffer);
    void bind() const;
    GLuint get() const { return handle_.get(); }

  private:
    Handle<DeleteVertexArray> handle_;
};

/// Of GL_ARB_texture_compression_bptc, which a core loader does not name: BC7, sRGB with alpha.
inline constexpr GLenum compressedSrgbAlphaBptc = 0x8e8d;

/// A two-dimensional texture; sizes beyond the driver's limit are an InputError. Making, changing and reading
/// one leaves the textures that `bind` bound as they are.
class Texture2D {
  public:
    Texture2D() = default;
    /// Storage only, undefined texels, one level. `internalFormat` is sized (GL_RGBA8, GL_SRGB8_ALPHA8,
    /// GL_RGBA32F, GL_DEPTH_COMPONENT24 …). Sampled with the nearest texel, clamped to the edge.
    Texture2D(std::string_view label, GLenum internalFormat, int width, int height);
    /// From pixels, with all mipmap levels; sRGB images are stored so that sampling gives linear light, and
    /// grey images are sampled as grey. The image's top row is at t = 0. Sampled trilinearly, repeated.
    Texture2D(std::string_view label, const Image8& image);
    /// With these levels and no others, level 0 first, each half of the one before as mipSide has it; all of
    /// the same channels and encoding. Sampled as the one above.
    /// `storage`: a sized or compressed internal format to keep them in, made of the bytes by the driver; 0:
    /// as they are.
    Texture2D(std::string_view label, std::span<const Image8> levels, GLenum storage = 0);
    /// The same as RGBA of 32-bit floats; the images have four channels and are linear.
    Texture2D(std::string_view label, std::span<const Image> levels);
    /// The same, kept in blocks on the device as well. EnvironmentError naming the extension where the driver
    /// cannot read them.
    Texture2D(std::string_view label, std::span<const BlockImage> levels);
    void bind(GLuint unit) const;
    void setFilter(GLenum minification, GLenum magnification);
    void setWrap(GLenum s, GLenum t);
    /// Fills the levels below the first as the driver does, down to 1×1.
    void generateMipmaps();
    GLuint get() const { return handle_.get(); }
    explicit operator bool() const { return static_cast<bool>(handle_); }
    int width() const { return width_; }
    int height() const { return height_; }
    GLenum internalFormat() const { return internalFormat_; }

  private:
    template <typename Level>
    void begin(std::string_view label, std::span<const Level> levels);
    void finish(std::string_view label, std::size_t levels);
    Handle<DeleteTexture> handle_;
    int width_ = 0;
    int height_ = 0;
    GLenum internalFormat_ = 0;
};

class Framebuffer;

/// Six square textures, the faces of a cube looked at from its centre: +x −x +y −y +z −z, each with the same
/// mipmap levels. Directions and texels as OpenGL has them (shaders/lib/environment_math.glsl). Made, changed
/// and bound like Texture2D; sampled trilinearly.
class TextureCube {
  public:
    static constexpr int faceCount = 6;
    /// How many levels there are down to 1×1 texel.
    static int fullLevels(int size);

    TextureCube() = default;
    /// Storage only, undefined texels. `size`: texels along an edge of level 0; beyond the driver's limit, or
    /// not positive, it is an InputError. `levels`: 1 … fullLevels(size); others are a bug of the caller.
    /// Depth formats are a bug of the caller as well.
    TextureCube(std::string_view label, GLenum internalFormat, int size, int levels);
    /// `seamless`: texels of neighbouring faces are blended along the edges, here and for every other cube
    /// until one is bound otherwise.
    void bind(GLuint unit, bool seamless = true) const;
    void setFilter(GLenum minification, GLenum magnification);
    /// Fills the levels below the first, each texel with the mean of four.
    void generateMipmaps();
    /// Replaces the texels of a face by an image of four channels whose row 0 is at t = 0.
    void upload(int face, int level, const Image& image);
    /// Takes over the first colour of a framebuffer of that level's size, bit for bit in the same format;
    /// leaves the framebuffer bound.
    void copyFrom(const Framebuffer& framebuffer, int face, int level);
    GLuint get() const { return handle_.get(); }
    int size() const { return size_; }
    int sizeOf(int level) const { return size_ >> level > 1 ? size_ >> level : 1; }
    int levels() const { return levels_; }
    GLenum internalFormat() const { return internalFormat_; }
    /// Of all faces and levels.
    std::size_t texelCount() const;

  private:
    Handle<DeleteTexture> handle_;
    int size_ = 0;
    int levels_ = 0;
    GLenum internalFormat_ = 0;
};

/// How a unit reads whatever texture is bound to it, instead of as the texture itself says.
class Sampler {
  public:
    struct Params {
        GLenum minification = GL_NEAREST;
        GLenum magnification = GL_NEAREST;
        GLenum wrap = GL_CLAMP_TO_EDGE;
        bool compare = false;   ///< depth textures: the share of texels that a reference is not beyond (≤)
        int maxAnisotropy = 1;  ///< above 1: kept to what the driver can; without the extension to 1
        auto operator<=>(const Params&) const = default;
    };
    Sampler() = default;
    Sampler(std::string_view label, const Params& params);

    /// Applies to a unit until its end.
    class Use {
      public:
        Use(const Sampler& sampler, GLuint unit);
        ~Use();
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;

      private:
        GLuint unit_;
    };

  private:
    Handle<DeleteSampler> handle_;
};

/// Draws into textures. Incomplete: a GlError that lists the attachments.
class Framebuffer {
  public:
    Framebuffer() = default;
    /// `colors` go to attachments 0, 1, …; `depth` may be null (its format decides depth or depth and
    /// stencil). The textures must outlive this.
    Framebuffer(std::string_view label, std::span<const Texture2D* const> colors, const Texture2D* depth);
    /// One level of one face of a cube as the only colour.
    Framebuffer(std::string_view label, const TextureCube& color, int face, int level,
                const Texture2D* depth = nullptr);
    /// Binds it for drawing and sets the viewport to its size.
    void bind() const;
    int width() const { return width_; }
    int height() const { return height_; }
    GLuint get() const { return handle_.get(); }

  private:
    struct Attachment {
        std::string place;
        GLenum format = 0;
        int width = 0;
        int height = 0;
    };
    /// Attaches the depth, chooses the draw buffers, and throws if what there is is not complete.
    void finish(std::string_view label, std::vector<Attachment> attachments, const Texture2D* depth);

    Handle<DeleteFramebuffer> handle_;
    int width_ = 0;
    int height_ = 0;
};

/// Counts what the device does while it draws.
class Query {
  public:
    /// `target`: GL_SAMPLES_PASSED, GL_PRIMITIVES_GENERATED, GL_TIME_ELAPSED …
    Query(std::string_view label, GLenum target);
    /// The count over `work`; waits for the device.
    template <typename Work>
    std::uint64_t count(Work&& work) const {
        glBeginQuery(target_, handle_.get());
        try {
            work();
        } catch (...) {
            glad_glEndQuery(target_);
            throw;
        }
        glEndQuery(target_);
        GLuint64 result = 0;
        glGetQueryObjectui64v(handle_.get(), GL_QUERY_RESULT, &result);
        return result;
    }

  private:
    Handle<DeleteQuery> handle_;
    GLenum target_;
};

/// The pixels of a texture as drawn into: top row (the largest y) first, four channels. sRGB formats keep
/// their encoding; `readPixels8` clamps other formats to [0, 1]. Depth textures are for `readPixels` only,
/// which then gives one channel.
Image8 readPixels8(const Texture2D& texture);
Image readPixels(const Texture2D& texture);
/// One level of a texture: the row of t = 0 first, four channels, as they are stored (compressed ones as they
/// are read).
Image8 readLevel8(const Texture2D& texture, int level);
/// What a level takes on the device, as the driver tells: its texels times the bits of its channels, or its
/// blocks. A level that there is not has size 0.
struct LevelMemory {
    int width = 0;   ///< texels
    int height = 0;  ///< texels
    std::size_t bytes = 0;
};
LevelMemory levelMemory(const Texture2D& texture, int level);
/// One level of a face of a cube: the row of t = 0 first, four channels.
Image readPixels(const TextureCube& cube, int face, int level);

/// Waits until the device has finished, and tells the seconds since `glFinish` before `work` was called.
template <typename Work>
double secondsOf(Work&& work);

}  // namespace quincunx::gl

#include <chrono>

template <typename Work>
double quincunx::gl::secondsOf(Work&& work) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    work();
    glFinish();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

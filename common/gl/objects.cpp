#include "gl/objects.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "gl/backends.h"
#include "gl/bindings.h"
#include "gl/calls.h"
#include "image/mipmaps.h"

namespace quincunx::gl {
namespace {

/// Destructors must not throw: a name that the driver does not want to delete stays its own until the context
/// ends.
template <typename Delete>
void deleteQuietly(Delete&& deletion) noexcept {
    if (!detail::anyCurrent())
        return;
    try {
        deletion();
    } catch (const Error&) {
    }
}

/// How texels of a sized internal format are handed over.
struct Transfer {
    GLenum format = GL_RGBA;
    GLenum type = GL_UNSIGNED_BYTE;
};

Transfer transferOf(GLenum internalFormat) {
    switch (internalFormat) {
        case GL_DEPTH_COMPONENT16:
        case GL_DEPTH_COMPONENT24:
        case GL_DEPTH_COMPONENT32:
        case GL_DEPTH_COMPONENT32F:
            return {GL_DEPTH_COMPONENT, GL_FLOAT};
        case GL_DEPTH24_STENCIL8:
            return {GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8};
        case GL_DEPTH32F_STENCIL8:
            return {GL_DEPTH_STENCIL, GL_FLOAT_32_UNSIGNED_INT_24_8_REV};
        case GL_R8UI:
        case GL_R16UI:
        case GL_R32UI:
            return {GL_RED_INTEGER, GL_UNSIGNED_INT};
        case GL_R32I:
            return {GL_RED_INTEGER, GL_INT};
        case GL_RGBA8UI:
        case GL_RGBA16UI:
        case GL_RGBA32UI:
            return {GL_RGBA_INTEGER, GL_UNSIGNED_INT};
        case GL_R16F:
        case GL_R32F:
        case GL_RG16F:
        case GL_RG32F:
        case GL_RGB16F:
        case GL_RGB32F:
        case GL_RGBA16F:
        case GL_RGBA32F:
        case GL_R11F_G11F_B10F:
            return {GL_RGBA, GL_FLOAT};
        default:
            return {};
    }
}

bool isDepth(GLenum internalFormat) {
    const GLenum format = transferOf(internalFormat).format;
    return format == GL_DEPTH_COMPONENT || format == GL_DEPTH_STENCIL;
}

// Of GL_EXT_texture_compression_s3tc and GL_EXT_texture_sRGB, which a core loader does not name.
constexpr GLenum compressedRgbS3tcDxt1 = 0x83f0;
constexpr GLenum compressedSrgbS3tcDxt1 = 0x8c4c;

bool isSrgb(GLenum internalFormat) {
    return internalFormat == GL_SRGB8 || internalFormat == GL_SRGB8_ALPHA8 ||
           internalFormat == compressedSrgbS3tcDxt1 || internalFormat == compressedSrgbAlphaBptc;
}

std::string formatName(GLenum internalFormat) {
    static constexpr std::pair<GLenum, const char*> names[] = {
        {GL_R8, "R8"},
        {GL_RG8, "RG8"},
        {GL_RGB8, "RGB8"},
        {GL_RGBA8, "RGBA8"},
        {GL_SRGB8, "SRGB8"},
        {GL_SRGB8_ALPHA8, "SRGB8_ALPHA8"},
        {GL_R16F, "R16F"},
        {GL_R32F, "R32F"},
        {GL_RG16F, "RG16F"},
        {GL_RG32F, "RG32F"},
        {GL_RGB16F, "RGB16F"},
        {GL_RGB32F, "RGB32F"},
        {GL_RGBA16F, "RGBA16F"},
        {GL_RGBA32F, "RGBA32F"},
        {GL_RGB9_E5, "RGB9_E5"},
        {GL_DEPTH_COMPONENT16, "DEPTH16"},
        {GL_DEPTH_COMPONENT24, "DEPTH24"},
        {GL_DEPTH_COMPONENT32F, "DEPTH32F"},
        {GL_DEPTH24_STENCIL8, "DEPTH24_STENCIL8"},
        {GL_DEPTH32F_STENCIL8, "DEPTH32F_STENCIL8"},
    };
    for (const auto& [format, name] : names)
        if (format == internalFormat)
            return name;
    return fmt::format("format {:#06x}", internalFormat);
}

std::string statusName(GLenum status) {
    switch (status) {
        case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
            return "an attachment cannot be drawn into";
        case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
            return "it has no attachment";
        case GL_FRAMEBUFFER_INCOMPLETE_DRAW_BUFFER:
            return "a draw buffer has no attachment";
        case GL_FRAMEBUFFER_INCOMPLETE_MULTISAMPLE:
            return "attachments differ in their samples";
        case GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS:
            return "attachments differ in their layers";
        case GL_FRAMEBUFFER_UNSUPPORTED:
            return "the driver does not support this combination";
        default:
            return fmt::format("status {:#06x}", status);
    }
}

void checkSize(std::string_view label, int width, int height) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (width < 1 || height < 1 || width > limit || height > limit)
        throw InputError(
            fmt::format("a texture of {}×{} texels; this driver takes 1 to {} a side", width, height, limit),
            fmt::format("texture \"{}\"", label), "choose another size");
}

GLenum faceTarget(int face) {
    return static_cast<GLenum>(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face);
}

void checkPlace(const TextureCube& cube, int face, int level) {
    QX_CHECK_GE(face, 0);
    QX_CHECK_LT(face, TextureCube::faceCount);
    QX_CHECK_GE(level, 0);
    QX_CHECK_LT(level, cube.levels());
}

bool hasExtension(std::string_view name) {
    GLint count = 0;
    glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i)
        if (name == reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i))))
            return true;
    return false;
}

template <typename Generate>
GLuint newName(Generate&& generate) {
    GLuint name = 0;
    generate(1, &name);
    return name;
}

/// Where contents are uploaded without touching state that draws depend on.
GLenum uploadTarget(GLenum target) {
    return target == GL_ELEMENT_ARRAY_BUFFER ? GL_COPY_WRITE_BUFFER : target;
}

template <typename Channel>
void flipRows(BasicImage<Channel>& image) {
    const auto row = static_cast<std::ptrdiff_t>(image.width) * image.channels;
    for (int top = 0, bottom = image.height - 1; top < bottom; ++top, --bottom)
        std::swap_ranges(image.data.begin() + top * row, image.data.begin() + (top + 1) * row,
                         image.data.begin() + bottom * row);
}

/// The texels of level 0, bottom row first as GL has them, turned top row first.
template <typename Channel>
BasicImage<Channel> download(const Texture2D& texture, int channels, GLenum format, GLenum type) {
    BasicImage<Channel> image(texture.width(), texture.height(), channels,
                              isSrgb(texture.internalFormat()) ? Encoding::srgb : Encoding::linear);
    // llvmpipe with threads may hand out texels that a pass before the last is still writing.
    glFinish();
    detail::bindTextureForEditing(texture.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(GL_TEXTURE_2D, 0, format, type, image.data.data());
    flipRows(image);
    return image;
}

}  // namespace

void DeleteBuffer::operator()(GLuint name) const {
    detail::forgetBuffer(name);
    deleteQuietly([&] { glDeleteBuffers(1, &name); });
}
void DeleteVertexArray::operator()(GLuint name) const {
    detail::forgetVertexArray(name);
    deleteQuietly([&] { glDeleteVertexArrays(1, &name); });
}
void DeleteTexture::operator()(GLuint name) const {
    detail::forgetTexture(name);
    deleteQuietly([&] { glDeleteTextures(1, &name); });
}
void DeleteFramebuffer::operator()(GLuint name) const {
    deleteQuietly([&] { glDeleteFramebuffers(1, &name); });
}
void DeleteProgram::operator()(GLuint name) const {
    detail::forgetProgram(name);
    deleteQuietly([&] { glDeleteProgram(name); });
}
void DeleteSampler::operator()(GLuint name) const {
    deleteQuietly([&] { glDeleteSamplers(1, &name); });
}
void DeleteQuery::operator()(GLuint name) const {
    deleteQuietly([&] { glDeleteQueries(1, &name); });
}

void setLabel(GLenum identifier, GLuint name, std::string_view label) {
    // The least GL_MAX_LABEL_LENGTH that KHR_debug allows, with the end mark.
    constexpr std::size_t maxLength = 255;
    if (GLAD_GL_KHR_debug != 0 && !label.empty())
        glObjectLabel(identifier, name, static_cast<GLsizei>(std::min(label.size(), maxLength)),
                      label.data());
}

Buffer::Buffer(std::string_view label, GLenum target, std::span<const std::byte> contents, GLenum usage)
    : handle_(newName(glGenBuffers)), target_(target), usage_(usage) {
    upload(contents);
    setLabel(GL_BUFFER, get(), label);
}

void Buffer::upload(std::span<const std::byte> contents) {
    QX_CHECK(handle_);
    const GLenum target = uploadTarget(target_);
    glBindBuffer(target, get());
    glBufferData(target, static_cast<GLsizeiptr>(contents.size()), contents.data(), usage_);
    size_ = contents.size();
}

void Buffer::bindUniform(GLuint binding, std::size_t offsetBytes, std::size_t sizeBytes) const {
    QX_CHECK_LE(offsetBytes + sizeBytes, size_);
    detail::bindUniformBuffer(binding, get(), static_cast<GLintptr>(offsetBytes),
                              static_cast<GLsizeiptr>(sizeBytes));
}

VertexArray::VertexArray(std::string_view label) : handle_(newName(glGenVertexArrays)) {
    bind();
    setLabel(GL_VERTEX_ARRAY, get(), label);
}

void VertexArray::attribute(const Buffer& buffer, const Attribute& attribute) {
    bind();
    glBindBuffer(GL_ARRAY_BUFFER, buffer.get());
    glEnableVertexAttribArray(attribute.location);
    glVertexAttribPointer(attribute.location, attribute.components, attribute.type,
                          attribute.normalized ? GL_TRUE : GL_FALSE, attribute.strideBytes,
                          reinterpret_cast<const void*>(attribute.offsetBytes));
    if (attribute.divisor != 0)
        glVertexAttribDivisor(attribute.location, attribute.divisor);
}

void VertexArray::indices(const Buffer& buffer) {
    bind();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer.get());
}

void VertexArray::bind() const {
    QX_CHECK(handle_);
    detail::bindVertexArray(get());
}

Texture2D::Texture2D(std::string_view label, GLenum internalFormat, int width, int height)
    : width_(width), height_(height), internalFormat_(internalFormat) {
    checkSize(label, width, height);
    handle_ = Handle<DeleteTexture>(newName(glGenTextures));
    detail::bindTextureForEditing(get());
    const auto [format, type] = transferOf(internalFormat);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internalFormat), width, height, 0, format, type,
                 nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    setFilter(GL_NEAREST, GL_NEAREST);
    setWrap(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
    setLabel(GL_TEXTURE, get(), label);
}

Texture2D::Texture2D(std::string_view label, const Image8& image)
    : Texture2D(label, std::span<const Image8>(&image, 1)) {
    generateMipmaps();
    setFilter(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
}

template <typename Level>
void Texture2D::begin(std::string_view label, std::span<const Level> levels) {
    QX_CHECK(!levels.empty());
    width_ = levels[0].width;
    height_ = levels[0].height;
    checkSize(label, width_, height_);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        QX_CHECK_EQ(levels[i].width, mipSide(width_, static_cast<int>(i)));
        QX_CHECK_EQ(levels[i].height, mipSide(height_, static_cast<int>(i)));
    }
    handle_ = Handle<DeleteTexture>(newName(glGenTextures));
    detail::bindTextureForEditing(get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

void Texture2D::finish(std::string_view label, std::size_t levels) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(levels) - 1);
    setFilter(levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR, GL_LINEAR);
    setWrap(GL_REPEAT, GL_REPEAT);
    setLabel(GL_TEXTURE, get(), label);
}

Texture2D::Texture2D(std::string_view label, std::span<const Image8> levels, GLenum storage) {
    begin(label, levels);
    const int imageChannels = levels[0].channels;
    QX_CHECK_GE(imageChannels, 1);
    QX_CHECK_LE(imageChannels, 4);
    const bool srgb = levels[0].encoding == Encoding::srgb;
    // No one- or two-channel format decodes sRGB: grey is stored three times there.
    const bool spread = srgb && imageChannels < 3;
    const int channels = spread ? imageChannels + 2 : imageChannels;
    static constexpr GLenum formats[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
    static constexpr GLenum linearFormats[] = {GL_R8, GL_RG8, GL_RGB8, GL_RGBA8};
    internalFormat_ = !srgb ? linearFormats[channels - 1] : channels == 3 ? GL_SRGB8 : GL_SRGB8_ALPHA8;
    if (storage != 0)
        internalFormat_ = storage;
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const Image8& image = levels[level];
        QX_CHECK_EQ(image.channels, imageChannels);
        QX_CHECK((image.encoding == Encoding::srgb) == srgb);
        QX_CHECK_EQ(image.data.size(), image.pixelCount() * static_cast<std::size_t>(image.channels));
        std::vector<std::uint8_t> spreadTexels;
        if (spread) {
            const std::size_t stride = imageChannels == 1 ? 3 : 4;
            spreadTexels.resize(image.pixelCount() * stride);
            for (std::size_t i = 0; i < image.pixelCount(); ++i) {
                const std::uint8_t* texel = &image.data[i * static_cast<std::size_t>(imageChannels)];
                std::fill_n(&spreadTexels[i * stride], 3, texel[0]);
                if (stride == 4)
                    spreadTexels[i * stride + 3] = texel[1];
            }
        }
        glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), static_cast<GLint>(internalFormat_),
                     image.width, image.height, 0, formats[channels - 1], GL_UNSIGNED_BYTE,
                     spread ? spreadTexels.data() : image.data.data());
    }
    if (channels < 3) {
        const GLint alpha = channels == 2 ? GL_GREEN : GL_ONE;
        const GLint swizzle[] = {GL_RED, GL_RED, GL_RED, alpha};
        glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, swizzle);
    }
    finish(label, levels.size());
}

Texture2D::Texture2D(std::string_view label, std::span<const Image> levels) : internalFormat_(GL_RGBA32F) {
    begin(label, levels);
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const Image& image = levels[level];
        QX_CHECK_EQ(image.channels, 4);
        QX_CHECK(image.encoding == Encoding::linear);
        QX_CHECK_EQ(image.data.size(), 4 * image.pixelCount());
        glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA32F, image.width, image.height, 0,
                     GL_RGBA, GL_FLOAT, image.data.data());
    }
    finish(label, levels.size());
}

Texture2D::Texture2D(std::string_view label, std::span<const BlockImage> levels) {
    begin(label, levels);
    const bool srgb = levels[0].encoding == Encoding::srgb;
    const BlockFormat format = levels[0].format;
    if (format == BlockFormat::bc1) {
        internalFormat_ = srgb ? compressedSrgbS3tcDxt1 : compressedRgbS3tcDxt1;
        if (!hasExtension("GL_EXT_texture_compression_s3tc") ||
            (srgb && !hasExtension("GL_EXT_texture_sRGB")))
            throw EnvironmentError("this driver reads no S3TC blocks (GL_EXT_texture_compression_s3tc)",
                                   fmt::format("texture \"{}\"", label), "keep the texture uncompressed");
    } else {
        QX_CHECK(!srgb);
        internalFormat_ = GL_COMPRESSED_RED_RGTC1;
    }
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const BlockImage& image = levels[level];
        QX_CHECK(image.format == format);
        QX_CHECK((image.encoding == Encoding::srgb) == srgb);
        QX_CHECK_EQ(image.blocks.size(), blockBytes(format, image.width, image.height));
        glCompressedTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), internalFormat_, image.width,
                               image.height, 0, static_cast<GLsizei>(image.blocks.size()),
                               image.blocks.data());
    }
    if (format == BlockFormat::bc4) {
        const GLint swizzle[] = {GL_RED, GL_RED, GL_RED, GL_ONE};
        glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, swizzle);
    }
    finish(label, levels.size());
}

void Texture2D::bind(GLuint unit) const {
    QX_CHECK(handle_);
    detail::bindTexture(unit, get());
}

void Texture2D::setFilter(GLenum minification, GLenum magnification) {
    detail::bindTextureForEditing(get());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(minification));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(magnification));
}

void Texture2D::setWrap(GLenum s, GLenum t) {
    detail::bindTextureForEditing(get());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, static_cast<GLint>(s));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, static_cast<GLint>(t));
}

void Texture2D::generateMipmaps() {
    detail::bindTextureForEditing(get());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, mipLevelCount(width_, height_) - 1);
    glGenerateMipmap(GL_TEXTURE_2D);
}

int TextureCube::fullLevels(int size) {
    int levels = 1;
    while (size >> levels > 0)
        ++levels;
    return levels;
}

TextureCube::TextureCube(std::string_view label, GLenum internalFormat, int size, int levels)
    : size_(size), levels_(levels), internalFormat_(internalFormat) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_CUBE_MAP_TEXTURE_SIZE, &limit);
    if (size < 1 || size > limit)
        throw InputError(
            fmt::format("a cube map of {} texels; this driver takes 1 to {} a side", size, limit),
            fmt::format("texture \"{}\"", label), "choose another size");
    QX_CHECK_GE(levels, 1);
    QX_CHECK_LE(levels, fullLevels(size));
    QX_CHECK(!isDepth(internalFormat));
    handle_ = Handle<DeleteTexture>(newName(glGenTextures));
    detail::bindCubeForEditing(get());
    const auto [format, type] = transferOf(internalFormat);
    for (int level = 0; level < levels; ++level)
        for (int face = 0; face < faceCount; ++face)
            glTexImage2D(faceTarget(face), level, static_cast<GLint>(internalFormat), sizeOf(level),
                         sizeOf(level), 0, format, type, nullptr);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, levels - 1);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(GL_TEXTURE_CUBE_MAP, axis, GL_CLAMP_TO_EDGE);
    setFilter(levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR, GL_LINEAR);
    setLabel(GL_TEXTURE, get(), label);
}

void TextureCube::bind(GLuint unit, bool seamless) const {
    QX_CHECK(handle_);
    detail::bindCube(unit, get());
    detail::filterCubesSeamlessly(seamless);
}

void TextureCube::setFilter(GLenum minification, GLenum magnification) {
    detail::bindCubeForEditing(get());
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(minification));
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(magnification));
}

void TextureCube::generateMipmaps() {
    detail::bindCubeForEditing(get());
    glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
}

void TextureCube::upload(int face, int level, const Image& image) {
    checkPlace(*this, face, level);
    QX_CHECK_EQ(image.channels, 4);
    QX_CHECK_EQ(image.width, sizeOf(level));
    QX_CHECK_EQ(image.height, sizeOf(level));
    detail::bindCubeForEditing(get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(faceTarget(face), level, 0, 0, image.width, image.height, GL_RGBA, GL_FLOAT,
                    image.data.data());
}

void TextureCube::copyFrom(const Framebuffer& framebuffer, int face, int level) {
    checkPlace(*this, face, level);
    QX_CHECK_EQ(framebuffer.width(), sizeOf(level));
    QX_CHECK_EQ(framebuffer.height(), sizeOf(level));
    framebuffer.bind();
    detail::bindCubeForEditing(get());
    glCopyTexSubImage2D(faceTarget(face), level, 0, 0, 0, 0, sizeOf(level), sizeOf(level));
}

std::size_t TextureCube::texelCount() const {
    std::size_t count = 0;
    for (int level = 0; level < levels_; ++level)
        count += static_cast<std::size_t>(sizeOf(level)) * static_cast<std::size_t>(sizeOf(level));
    return faceCount * count;
}

Sampler::Sampler(std::string_view label, const Params& params) {
    GLuint name = 0;
    glGenSamplers(1, &name);
    handle_ = Handle<DeleteSampler>(name);
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(params.minification));
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(params.magnification));
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glSamplerParameteri(name, axis, static_cast<GLint>(params.wrap));
    if (params.compare) {
        glSamplerParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glSamplerParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
    if (params.maxAnisotropy > 1 && GLAD_GL_EXT_texture_filter_anisotropic != 0) {
        GLfloat most = 1;
        glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &most);
        glSamplerParameterf(name, GL_TEXTURE_MAX_ANISOTROPY_EXT,
                            std::min(most, static_cast<GLfloat>(params.maxAnisotropy)));
    }
    setLabel(GL_SAMPLER, name, label);
}

Sampler::Use::Use(const Sampler& sampler, GLuint unit) : unit_(unit) {
    QX_CHECK(sampler.handle_);
    glBindSampler(unit, sampler.handle_.get());
}

Sampler::Use::~Use() {
    // Not checked: a destructor must not throw.
    glad_glBindSampler(unit_, 0);
}

Query::Query(std::string_view label, GLenum target) : target_(target) {
    GLuint name = 0;
    glGenQueries(1, &name);
    handle_ = Handle<DeleteQuery>(name);
    // A query has no target, and no label, before its first use.
    glBeginQuery(target, name);
    glEndQuery(target);
    setLabel(GL_QUERY, name, label);
}

Framebuffer::Framebuffer(std::string_view label, std::span<const Texture2D* const> colors,
                         const Texture2D* depth)
    : handle_(newName(glGenFramebuffers)) {
    std::vector<Attachment> attachments;
    glBindFramebuffer(GL_FRAMEBUFFER, get());
    for (const Texture2D* color : colors) {
        const auto attachment = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + attachments.size());
        attachments.push_back({fmt::format("colour {}", attachments.size()), color->internalFormat(),
                               color->width(), color->height()});
        glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, color->get(), 0);
    }
    finish(label, std::move(attachments), depth);
}

Framebuffer::Framebuffer(std::string_view label, const TextureCube& color, int face, int level,
                         const Texture2D* depth)
    : handle_(newName(glGenFramebuffers)) {
    checkPlace(color, face, level);
    glBindFramebuffer(GL_FRAMEBUFFER, get());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, faceTarget(face), color.get(), level);
    const int size = color.sizeOf(level);
    finish(label, {{fmt::format("face {} level {}", face, level), color.internalFormat(), size, size}},
           depth);
}

void Framebuffer::finish(std::string_view label, std::vector<Attachment> attachments,
                         const Texture2D* depth) {
    std::vector<GLenum> drawBuffers;
    for (std::size_t i = 0; i < attachments.size(); ++i)
        drawBuffers.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
    if (depth != nullptr) {
        const bool hasStencil = transferOf(depth->internalFormat()).format == GL_DEPTH_STENCIL;
        attachments.push_back({hasStencil ? "depth and stencil" : "depth", depth->internalFormat(),
                               depth->width(), depth->height()});
        glFramebufferTexture2D(GL_FRAMEBUFFER, hasStencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT,
                               GL_TEXTURE_2D, depth->get(), 0);
    }
    std::string list;
    bool sizesAgree = true;
    for (const Attachment& attachment : attachments) {
        list += fmt::format("{}{} {} {}×{}", list.empty() ? "" : ", ", attachment.place,
                            formatName(attachment.format), attachment.width, attachment.height);
        if (width_ == 0) {
            width_ = attachment.width;
            height_ = attachment.height;
        }
        sizesAgree = sizesAgree && width_ == attachment.width && height_ == attachment.height;
    }
    if (drawBuffers.empty()) {
        glDrawBuffer(GL_NONE);
        glReadBuffer(GL_NONE);
    } else {
        glDrawBuffers(static_cast<GLsizei>(drawBuffers.size()), drawBuffers.data());
    }
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE || !sizesAgree)
        throw GlError(
            fmt::format("incomplete, because {}; attachments: {}",
                        status != GL_FRAMEBUFFER_COMPLETE ? statusName(status) : "attachments differ in size",
                        list.empty() ? "none" : list),
            fmt::format("framebuffer \"{}\"", label));
    setLabel(GL_FRAMEBUFFER, get(), label);
}

void Framebuffer::bind() const {
    QX_CHECK(handle_);
    glBindFramebuffer(GL_FRAMEBUFFER, get());
    glViewport(0, 0, width_, height_);
}

Image8 readPixels8(const Texture2D& texture) {
    QX_CHECK(!isDepth(texture.internalFormat()));
    return download<std::uint8_t>(texture, 4, GL_RGBA, GL_UNSIGNED_BYTE);
}

Image readPixels(const Texture2D& texture) {
    if (isDepth(texture.internalFormat()))
        return download<float>(texture, 1, GL_DEPTH_COMPONENT, GL_FLOAT);
    if (!isSrgb(texture.internalFormat()))
        return download<float>(texture, 4, GL_RGBA, GL_FLOAT);
    // Drivers disagree on whether reading sRGB texels as floats decodes them; as bytes none does.
    const Image8 bytes = readPixels8(texture);
    Image image(bytes.width, bytes.height, bytes.channels, Encoding::srgb);
    std::transform(bytes.data.begin(), bytes.data.end(), image.data.begin(),
                   [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0f; });
    return image;
}

Image8 readLevel8(const Texture2D& texture, int level) {
    const LevelMemory memory = levelMemory(texture, level);
    Image8 image(memory.width, memory.height, 4,
                 isSrgb(texture.internalFormat()) ? Encoding::srgb : Encoding::linear);
    glFinish();
    detail::bindTextureForEditing(texture.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(GL_TEXTURE_2D, level, GL_RGBA, GL_UNSIGNED_BYTE, image.data.data());
    return image;
}

LevelMemory levelMemory(const Texture2D& texture, int level) {
    detail::bindTextureForEditing(texture.get());
    const auto ask = [&](GLenum name) {
        GLint value = 0;
        glGetTexLevelParameteriv(GL_TEXTURE_2D, level, name, &value);
        return value;
    };
    LevelMemory memory{ask(GL_TEXTURE_WIDTH), ask(GL_TEXTURE_HEIGHT), 0};
    if (ask(GL_TEXTURE_COMPRESSED) != 0) {
        memory.bytes = static_cast<std::size_t>(ask(GL_TEXTURE_COMPRESSED_IMAGE_SIZE));
        return memory;
    }
    std::size_t bits = 0;
    for (const GLenum channel : {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE,
                                 GL_TEXTURE_ALPHA_SIZE, GL_TEXTURE_DEPTH_SIZE, GL_TEXTURE_STENCIL_SIZE})
        bits += static_cast<std::size_t>(ask(channel));
    memory.bytes =
        bits * static_cast<std::size_t>(memory.width) * static_cast<std::size_t>(memory.height) / 8;
    return memory;
}

Image readPixels(const TextureCube& cube, int face, int level) {
    checkPlace(cube, face, level);
    Image image(cube.sizeOf(level), cube.sizeOf(level), 4, Encoding::linear);
    detail::bindCubeForEditing(cube.get());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(faceTarget(face), level, GL_RGBA, GL_FLOAT, image.data.data());
    return image;
}

}  // namespace quincunx::gl

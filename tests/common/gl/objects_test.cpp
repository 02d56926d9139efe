#include "gl/objects.h"

#include <cmath>
#include <vector>

#include "base/random.h"
#include "gl/calls.h"
#include "gl/program.h"
#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

class ObjectsTest : public test::OnBackend {
  protected:
    /// Draws the colour that the GLSL expression `color` gives at each pixel into a new float texture.
    Texture2D draw(const std::string& color, int width, int height, GLenum format = GL_RGBA32F) {
        shaders_.write("cover.vert", test::coverVertexShader);
        shaders_.write("probe.frag",
                       "#version 330 core\nuniform sampler2D image;\nout vec4 color;\n"
                       "void main() { ivec2 p = ivec2(gl_FragCoord.xy); color = " +
                           color + "; }\n");
        Texture2D target("target", format, width, height);
        const Texture2D* colors[] = {&target};
        const Framebuffer framebuffer("target", colors, nullptr);
        const Program program({.label = "probe", .vertex = "cover.vert", .fragment = "probe.frag"});
        framebuffer.bind();
        program.use();
        program.set("image", 0);
        test::cover();
        return target;
    }

    test::ShaderFolder shaders_;
};

/// IEC 61966-2-1.
double linearFromSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// Half the distance in light from an 8-bit sRGB code to the one below: an sRGB decoder off by more could be
/// taken for another code. llvmpipe decodes by a polynomial: measured is at most 0.35 steps (0.0012 of
/// light).
double halfStep(int code) {
    const int above = std::max(code, 1);
    return (linearFromSrgb(above / 255.0) - linearFromSrgb((above - 1) / 255.0)) / 2;
}

std::string labelOf(GLenum identifier, GLuint name) {
    GLchar label[300] = {};
    glGetObjectLabel(identifier, name, sizeof label, nullptr, label);
    return label;
}

Image8 noise(int width, int height, int channels, Encoding encoding) {
    Image8 image(width, height, channels, encoding);
    Random random(7);
    for (std::uint8_t& byte : image.data)
        byte = static_cast<std::uint8_t>(random.below(256));
    return image;
}

TEST_P(ObjectsTest, BearTheirLabels) {
    const Buffer buffer("the vertices", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    const VertexArray vertexArray("the layout");
    const Texture2D texture("the picture", GL_RGBA8, 4, 4);
    const Texture2D* colors[] = {&texture};
    const Framebuffer framebuffer("the target", colors, nullptr);
    EXPECT_EQ(labelOf(GL_BUFFER, buffer.get()), "the vertices");
    EXPECT_EQ(labelOf(GL_VERTEX_ARRAY, vertexArray.get()), "the layout");
    EXPECT_EQ(labelOf(GL_TEXTURE, texture.get()), "the picture");
    EXPECT_EQ(labelOf(GL_FRAMEBUFFER, framebuffer.get()), "the target");
    const Texture2D longName(std::string(1000, 'x'), GL_RGBA8, 4, 4);
    EXPECT_EQ(labelOf(GL_TEXTURE, longName.get()), std::string(255, 'x'));
}

TEST_P(ObjectsTest, DieWithTheirOwnersWithoutErrors) {
    GLuint names[4] = {};
    {
        const Buffer buffer("b", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
        const VertexArray vertexArray("v");
        const Texture2D texture("t", GL_RGBA8, 4, 4);
        const Texture2D* colors[] = {&texture};
        const Framebuffer framebuffer("f", colors, nullptr);
        names[0] = buffer.get();
        names[1] = vertexArray.get();
        names[2] = texture.get();
        names[3] = framebuffer.get();
    }
    EXPECT_EQ(glIsBuffer(names[0]), GL_FALSE);
    EXPECT_EQ(glIsVertexArray(names[1]), GL_FALSE);
    EXPECT_EQ(glIsTexture(names[2]), GL_FALSE);
    EXPECT_EQ(glIsFramebuffer(names[3]), GL_FALSE);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_P(ObjectsTest, BindingWhatIsBoundCostsNoCall) {
    const Texture2D first("first", GL_RGBA8, 2, 2);
    const Texture2D second("second", GL_RGBA8, 2, 2);
    const VertexArray vertices("vertices");
    const std::vector<std::byte> zeros(512);
    const Buffer blocks("blocks", GL_UNIFORM_BUFFER, zeros);
    const auto bindAll = [&] {
        first.bind(0);
        second.bind(1);
        first.bind(0);
        vertices.bind();
        blocks.bindUniform(3, 256, 256);
    };
    bindAll();
    const std::uint64_t before = callCount();
    first.bind(0);
    vertices.bind();
    blocks.bindUniform(3, 256, 256);
    EXPECT_EQ(callCount(), before);
    blocks.bindUniform(3, 0, 256);
    blocks.bindUniform(2, 0, 256);
    EXPECT_EQ(callCount(), before + 2) << "another part, another binding";
}

TEST_P(ObjectsTest, ANameThatComesBackIsBoundAgain) {
    const auto boundTo = [](GLenum binding) {
        GLint name = 0;
        glGetIntegerv(binding, &name);
        return static_cast<GLuint>(name);
    };
    const std::vector<std::byte> zeros(256);
    for (int i = 0; i < 3; ++i) {
        const Texture2D texture("texture", GL_RGBA8, 2, 2);
        const VertexArray vertices("vertices");
        const Buffer blocks("blocks", GL_UNIFORM_BUFFER, zeros);
        texture.bind(0);
        vertices.bind();
        blocks.bindUniform(3, 0, 256);
        GLint uniformBuffer = 0;
        glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 3, &uniformBuffer);
        EXPECT_EQ(boundTo(GL_TEXTURE_BINDING_2D), texture.get());
        EXPECT_EQ(boundTo(GL_VERTEX_ARRAY_BINDING), vertices.get());
        EXPECT_EQ(static_cast<GLuint>(uniformBuffer), blocks.get());
    }
}

TEST_P(ObjectsTest, AnotherContextHasItsOwnBindings) {
    const Texture2D texture("texture", GL_RGBA8, 2, 2);
    texture.bind(0);
    {
        const std::unique_ptr<Context> other = createOffscreenContext(GetParam());
        const Texture2D theirs("texture", GL_RGBA8, 2, 2);
        theirs.bind(0);
        GLint name = 0;
        glGetIntegerv(GL_TEXTURE_BINDING_2D, &name);
        EXPECT_EQ(static_cast<GLuint>(name), theirs.get());
    }
    context_->makeCurrent();
    const std::uint64_t before = callCount();
    texture.bind(0);
    EXPECT_GT(callCount(), before) << "what is bound is not known after another context";
}

TEST_P(ObjectsTest, AreMovedNotCopied) {
    Buffer first("b", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    const GLuint name = first.get();
    const Buffer second = std::move(first);
    EXPECT_EQ(second.get(), name);
    EXPECT_EQ(second.size(), 4u);
    EXPECT_EQ(glIsBuffer(name), GL_TRUE);
}

TEST_P(ObjectsTest, ABufferHoldsWhatWasUploaded) {
    Buffer buffer("b", GL_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    buffer.upload(std::as_bytes(std::span("longer")));
    char contents[7] = {};
    glBindBuffer(GL_COPY_READ_BUFFER, buffer.get());
    glGetBufferSubData(GL_COPY_READ_BUFFER, 0, sizeof contents, contents);
    EXPECT_STREQ(contents, "longer");
    EXPECT_EQ(buffer.size(), sizeof contents);
}

TEST_P(ObjectsTest, UploadingIndicesLeavesTheBoundVertexArrayAlone) {
    const Buffer own("own", GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    VertexArray vertexArray("v");
    vertexArray.indices(own);
    Buffer other("other", GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span("abc")));
    other.upload(std::as_bytes(std::span("abcdef")));
    GLint bound = 0;
    glGetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &bound);
    EXPECT_EQ(static_cast<GLuint>(bound), own.get());
}

TEST_P(ObjectsTest, AVertexArrayFeedsAttributes) {
    shaders_.write(
        "points.vert",
        "#version 330 core\nlayout(location = 3) in vec2 place;\nlayout(location = 5) in vec4 tint;\n"
        "out vec4 tinted;\nvoid main() { gl_Position = vec4(place, 0, 1); tinted = tint; }\n");
    shaders_.write("points.frag",
                   "#version 330 core\nin vec4 tinted;\nout vec4 color;\n"
                   "void main() { color = tinted; }\n");
    struct Vertex {
        float x, y;
        std::uint8_t tint[4];
    };
    const Vertex vertices[] = {{9, 9, {1, 2, 3, 4}},
                               {-1, -1, {255, 128, 0, 51}},
                               {3, -1, {255, 128, 0, 51}},
                               {-1, 3, {255, 128, 0, 51}}};
    const std::uint32_t indices[] = {1, 2, 3};
    const Buffer vertexBuffer("vertices", GL_ARRAY_BUFFER, std::as_bytes(std::span(vertices)));
    const Buffer indexBuffer("indices", GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(indices)));
    VertexArray vertexArray("layout");
    vertexArray.attribute(vertexBuffer, {.location = 3, .components = 2, .strideBytes = sizeof(Vertex)});
    vertexArray.attribute(vertexBuffer, {.location = 5,
                                         .components = 4,
                                         .type = GL_UNSIGNED_BYTE,
                                         .normalized = true,
                                         .strideBytes = sizeof(Vertex),
                                         .offsetBytes = offsetof(Vertex, tint)});
    vertexArray.indices(indexBuffer);
    const Texture2D target("target", GL_RGBA8, 2, 2);
    const Texture2D* colors[] = {&target};
    const Framebuffer framebuffer("target", colors, nullptr);
    const Program program({.label = "points", .vertex = "points.vert", .fragment = "points.frag"});
    framebuffer.bind();
    program.use();
    vertexArray.bind();
    glDrawElements(GL_TRIANGLES, 3, GL_UNSIGNED_INT, nullptr);
    const Image8 image = readPixels8(target);
    EXPECT_THAT(std::vector(image.data.begin() + 12, image.data.end()), ElementsAre(255, 128, 0, 51));
}

TEST_P(ObjectsTest, ATextureBeyondTheDriversLimitIsRefusedByName) {
    for (const int side : {0, -5, 1 << 30})
        EXPECT_THAT(messageOf<InputError>([&] { Texture2D("huge", GL_RGBA8, side, 4); }),
                    AllOf(HasSubstr("\"huge\""), HasSubstr(std::to_string(side))));
    EXPECT_THROW(Texture2D("empty", Image8()), InputError);
}

TEST_P(ObjectsTest, MemoryThatTheDeviceLacksIsAGlError) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (!context_->isSoftware() || limit < 16384)
        GTEST_SKIP() << "this device may well have room for the largest texture";
    // 16384² texels of 16 bytes are 4 GiB; llvmpipe 22.3 takes at most 1 GiB (2 GiB from 23.1 on) a texture.
    EXPECT_THAT(messageOf<GlError>([&] { Texture2D("huge", GL_RGBA32F, 16384, 16384); }),
                HasSubstr("GL_OUT_OF_MEMORY"));
}

TEST_P(ObjectsTest, PixelsAreReadTopRowFirst) {
    const Texture2D texture = draw("vec4(p, 7, 1) / 255.0", 5, 3, GL_RGBA8);
    const Image8 image = readPixels8(texture);
    EXPECT_EQ(image.width, 5);
    EXPECT_EQ(image.height, 3);
    EXPECT_EQ(image.channels, 4);
    EXPECT_EQ(image.encoding, Encoding::linear);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x) {
            EXPECT_EQ(image.pixel(x, y)[0], x);
            EXPECT_EQ(image.pixel(x, y)[1], 2 - y);
            EXPECT_EQ(image.pixel(x, y)[2], 7);
        }
}

TEST_P(ObjectsTest, FloatsAreReadWithoutClamping) {
    const Image image = readPixels(draw("vec4(-3.5, 1e30, 1.0 / 3.0, 7)", 3, 2));
    EXPECT_EQ(image.channels, 4);
    EXPECT_EQ(image.encoding, Encoding::linear);
    for (std::size_t i = 0; i < image.data.size(); i += 4)
        EXPECT_THAT(std::vector(image.data.begin() + i, image.data.begin() + i + 4),
                    ElementsAre(-3.5f, 1e30f, 1.0f / 3.0f, 7.0f));
}

TEST_P(ObjectsTest, ReadingFloatsAsBytesClamps) {
    EXPECT_THAT(readPixels8(draw("vec4(-3.5, 1e30, 0.2, 1)", 1, 1)).data, ElementsAre(0, 255, 51, 255));
}

TEST_P(ObjectsTest, OneChannelIsReadAsRed) {
    EXPECT_THAT(readPixels(draw("vec4(0.25, 5, 5, 5)", 1, 1, GL_R32F)).data, ElementsAre(0.25f, 0, 0, 1));
}

TEST_P(ObjectsTest, SrgbTargetsKeepTheirEncoding) {
    Texture2D target("target", GL_SRGB8_ALPHA8, 2, 2);
    const Texture2D* colors[] = {&target};
    const Framebuffer framebuffer("target", colors, nullptr);
    framebuffer.bind();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClearColor(0.5f, 0.25f, 0, 0.2f);
    glClear(GL_COLOR_BUFFER_BIT);
    const Image8 bytes = readPixels8(target);
    EXPECT_EQ(bytes.encoding, Encoding::srgb);
    // 0.5 and 0.25 encoded are 0.7354 and 0.5371: 187.5 and 137.0 of 255. Alpha stays.
    EXPECT_THAT(bytes.data[0], testing::AnyOf(187, 188));
    EXPECT_EQ(bytes.data[1], 137);
    EXPECT_EQ(bytes.data[3], 51);
    const Image floats = readPixels(target);
    EXPECT_EQ(floats.encoding, Encoding::srgb);
    EXPECT_EQ(floats.data[1], 137 / 255.0f);
    EXPECT_EQ(floats.data[3], 51 / 255.0f);
}

TEST_P(ObjectsTest, DepthIsReadAsOneChannel) {
    for (const GLenum format : {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32F, GL_DEPTH24_STENCIL8}) {
        const Texture2D depth("depth", format, 3, 2);
        const Framebuffer framebuffer("target", {}, &depth);
        framebuffer.bind();
        glClearDepth(0.75);
        glClear(GL_DEPTH_BUFFER_BIT);
        const Image image = readPixels(depth);
        EXPECT_EQ(image.channels, 1);
        ASSERT_EQ(image.data.size(), 6u);
        // Half a step of 24 bits.
        EXPECT_THAT(image.data, Each(testing::FloatNear(0.75f, 0x1p-25f)));
    }
}

TEST_P(ObjectsTest, SamplingSrgbGivesLinearLight) {
    Image8 ramp(256, 1, 4, Encoding::srgb);
    for (int i = 0; i < 256; ++i)
        std::fill_n(ramp.pixel(i, 0), 4, static_cast<std::uint8_t>(i));
    const Texture2D texture("ramp", ramp);
    texture.bind(0);
    const Image sampled = readPixels(draw("texelFetch(image, p, 0)", 256, 1));
    double worst = 0;
    double worstInSteps = 0;
    for (int i = 0; i < 256; ++i) {
        const double error = std::abs(sampled.pixel(i, 0)[0] - linearFromSrgb(i / 255.0));
        EXPECT_LE(error, halfStep(i)) << i;
        worst = std::max(worst, error);
        worstInSteps = std::max(worstInSteps, error / (2 * halfStep(i)));
        EXPECT_NEAR(sampled.pixel(i, 0)[3], i / 255.0, 0x1p-23) << "alpha is linear";
    }
    RecordProperty("worstError", std::to_string(worst));
    RecordProperty("worstErrorInSteps", std::to_string(worstInSteps));
}

TEST_P(ObjectsTest, EveryChannelCountIsSampledAsWhatItMeans) {
    for (const Encoding encoding : {Encoding::linear, Encoding::srgb})
        for (int channels = 1; channels <= 4; ++channels) {
            const Image8 image = noise(5, 3, channels, encoding);
            const Texture2D texture("noise", image);
            texture.bind(0);
            const Image sampled = readPixels(draw("texelFetch(image, p, 0)", 5, 3));
            for (int y = 0; y < 3; ++y)
                for (int x = 0; x < 5; ++x) {
                    const std::uint8_t* texel = image.pixel(x, y);
                    // The image's top row is at t = 0, hence at the bottom of what is drawn here.
                    const float* got = sampled.pixel(x, 2 - y);
                    for (int c = 0; c < 3; ++c) {
                        const double value = texel[channels < 3 ? 0 : c] / 255.0;
                        if (encoding == Encoding::srgb)
                            EXPECT_NEAR(got[c], linearFromSrgb(value), halfStep(texel[channels < 3 ? 0 : c]));
                        else
                            EXPECT_NEAR(got[c], value, 0x1p-23) << "one rounding of a value up to 1";
                    }
                    const bool hasAlpha = channels == 2 || channels == 4;
                    EXPECT_NEAR(got[3], hasAlpha ? texel[channels - 1] / 255.0 : 1.0, 0x1p-23);
                }
        }
}

TEST_P(ObjectsTest, MipmapsAverageLinearLight) {
    Image8 checker(8, 8, 4, Encoding::srgb);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            std::fill_n(checker.pixel(x, y), 3, static_cast<std::uint8_t>((x + y) % 2 * 255));
            checker.pixel(x, y)[3] = 255;
        }
    const Texture2D texture("checker", checker);
    texture.bind(0);
    for (int level = 1; level <= 3; ++level) {
        const int side = 8 >> level;
        const Image sampled =
            readPixels(draw("texelFetch(image, p, " + std::to_string(level) + ")", side, side));
        for (int i = 0; i < side * side; ++i)
            // Half the light, kept as sRGB byte 188 (0.5029); an average of encoded values would be 0.2140.
            EXPECT_NEAR(sampled.data[static_cast<std::size_t>(i) * 4], 0.5, 0.005) << "level " << level;
    }
    const Image beyond = readPixels(draw("vec4(textureSize(image, 3), 0, 0)", 1, 1));
    EXPECT_EQ(beyond.data[0], 1.0f) << "four levels down to 1×1";
}

TEST_P(ObjectsTest, AnIncompleteFramebufferListsItsAttachments) {
    const Texture2D color("c", GL_RGBA16F, 4, 4);
    const Texture2D depth("d", GL_DEPTH_COMPONENT24, 4, 4);
    const Texture2D* wrong[] = {&color, &depth};
    EXPECT_THAT(
        messageOf<GlError>([&] { Framebuffer("odd", wrong, nullptr); }),
        AllOf(HasSubstr("\"odd\""), HasSubstr("colour 0 RGBA16F 4×4"), HasSubstr("colour 1 DEPTH24 4×4")));
    EXPECT_THAT(messageOf<GlError>([&] { Framebuffer("bare", {}, nullptr); }),
                AllOf(HasSubstr("\"bare\""), HasSubstr("none")));
}

TEST_P(ObjectsTest, AttachmentsOfDifferentSizesAreRefused) {
    const Texture2D color("c", GL_RGBA8, 4, 4);
    const Texture2D depth("d", GL_DEPTH_COMPONENT24, 4, 5);
    const Texture2D* colors[] = {&color};
    EXPECT_THAT(
        messageOf<GlError>([&] { Framebuffer("odd", colors, &depth); }),
        AllOf(HasSubstr("differ in size"), HasSubstr("colour 0 RGBA8 4×4"), HasSubstr("depth DEPTH24 4×5")));
}

TEST_P(ObjectsTest, BindingAFramebufferSetsTheViewport) {
    const Texture2D color("c", GL_RGBA8, 13, 7);
    const Texture2D* colors[] = {&color};
    const Framebuffer framebuffer("f", colors, nullptr);
    framebuffer.bind();
    GLint viewport[4] = {};
    glGetIntegerv(GL_VIEWPORT, viewport);
    EXPECT_THAT(viewport, ElementsAre(0, 0, 13, 7));
    EXPECT_EQ(framebuffer.width(), 13);
    EXPECT_EQ(framebuffer.height(), 7);
}

TEST_P(ObjectsTest, ANewTargetIsSampledByItsNearestTexelAndClamped) {
    const Texture2D target = draw("vec4(p, 0, 1)", 2, 2);
    target.bind(0);
    EXPECT_THAT(readPixels(draw("texture(image, vec2(0.74, 5))", 1, 1)).data, ElementsAre(1, 1, 0, 1));
}

TEST_P(ObjectsTest, SecondsCoverTheWork) {
    EXPECT_GE(secondsOf([] {}), 0.0);
}

TEST_P(ObjectsTest, CubesHoldWhatIsUploadedToEachFaceAndLevel) {
    TextureCube cube("cube", GL_RGBA32F, 5, TextureCube::fullLevels(5));
    ASSERT_EQ(cube.levels(), 3);
    EXPECT_EQ(cube.texelCount(), 6u * (25 + 4 + 1));
    EXPECT_EQ(labelOf(GL_TEXTURE, cube.get()), "cube");
    const auto value = [&](int face, int level) { return static_cast<float>(10 * face + level); };
    for (int face = 0; face < TextureCube::faceCount; ++face)
        for (int level = 0; level < cube.levels(); ++level) {
            Image image(cube.sizeOf(level), cube.sizeOf(level), 4, Encoding::linear);
            std::fill(image.data.begin(), image.data.end(), value(face, level));
            image.data[0] = -1;
            cube.upload(face, level, image);
        }
    for (int face = 0; face < TextureCube::faceCount; ++face)
        for (int level = 0; level < cube.levels(); ++level) {
            const Image image = readPixels(cube, face, level);
            EXPECT_EQ(image.data[0], -1);
            EXPECT_EQ(image.data[1], value(face, level));
        }
}

TEST_P(ObjectsTest, AFramebufferDrawsIntoOneFaceAndLevelOfACube) {
    TextureCube cube("cube", GL_RGBA32F, 8, 2);
    const Texture2D depth("depth", GL_DEPTH_COMPONENT32F, 4, 4);
    const Framebuffer framebuffer("face", cube, 3, 1, &depth);
    EXPECT_EQ(framebuffer.width(), 4);
    framebuffer.bind();
    glClearColor(1, 2, 3, 4);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    EXPECT_THAT(readPixels(cube, 3, 1).data, testing::Contains(3.0f));
    TextureCube copy("copy", GL_RGBA32F, 4, 1);
    copy.copyFrom(framebuffer, 5, 0);
    EXPECT_EQ(readPixels(copy, 5, 0).data, readPixels(cube, 3, 1).data);
    const Texture2D large("large", GL_DEPTH_COMPONENT32F, 8, 8);
    EXPECT_THAT(messageOf<GlError>([&] { Framebuffer("odd", cube, 3, 1, &large); }),
                AllOf(HasSubstr("odd"), HasSubstr("face 3 level 1"), HasSubstr("8×8")));
}

TEST_P(ObjectsTest, CubesOfImpossibleSizesSayWhatThisDriverTakes) {
    for (const int size : {0, -4, 1 << 20})
        EXPECT_THAT(messageOf<InputError>([&] { TextureCube("cube", GL_RGBA8, size, 1); }),
                    AllOf(HasSubstr("cube"), HasSubstr(std::to_string(size))));
    EXPECT_EQ(TextureCube::fullLevels(1), 1);
    EXPECT_EQ(TextureCube::fullLevels(2), 2);
    EXPECT_EQ(TextureCube::fullLevels(1023), 10);
    EXPECT_EQ(TextureCube::fullLevels(1024), 11);
}

TEST_P(ObjectsTest, ACubeAndAPictureLieSideBySideInAUnit) {
    TextureCube cube("cube", GL_RGBA32F, 1, 1);
    const Texture2D picture("picture", GL_RGBA32F, 1, 1);
    cube.bind(2);
    picture.bind(2);
    GLint bound = 0;
    // The last binding left that unit active.
    glGetIntegerv(GL_TEXTURE_BINDING_CUBE_MAP, &bound);
    EXPECT_EQ(static_cast<GLuint>(bound), cube.get());
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    EXPECT_EQ(static_cast<GLuint>(bound), picture.get());
    EXPECT_EQ(glIsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS), GL_TRUE);
    cube.bind(2, false);
    EXPECT_EQ(glIsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS), GL_FALSE);
}

QX_ON_BOTH_BACKENDS(ObjectsTest);

}  // namespace
}  // namespace quincunx::gl

#include "gl/program.h"

#include "gl/calls.h"
#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const ProgramFiles probeFiles{.label = "probe", .vertex = "cover.vert", .fragment = "probe.frag"};

class ProgramTest : public test::OnBackend {
  protected:
    ProgramTest() { shaders_.write("cover.vert", test::coverVertexShader); }

    void writeFragment(const std::string& body) {
        shaders_.write("probe.frag", "#version 330 core\nout vec4 color;\n" + body);
    }
    /// A fragment shader whose colour is a constant.
    void writeConstant(const std::string& value) {
        writeFragment("void main() { color = vec4(" + value + "); }\n");
    }
    /// The colour that a program draws.
    std::vector<float> drawn(const Program& program) {
        const Texture2D target("target", GL_RGBA32F, 1, 1);
        const Texture2D* colors[] = {&target};
        const Framebuffer framebuffer("target", colors, nullptr);
        framebuffer.bind();
        program.use();
        test::cover();
        return readPixels(target).data;
    }

    test::ShaderFolder shaders_;
};

TEST_P(ProgramTest, AFaultIsNamedByTheAuthorsFileAndLine) {
    shaders_.write("lib/light.glsl", "float f() {\n    return nowhere;\n}\n");
    writeFragment("#include \"lib/light.glsl\"\nvoid main() {\n    color = vec4(f());\n}\n");
    EXPECT_THAT(messageOf<ShaderError>([] { Program{probeFiles}; }),
                AllOf(StartsWith("shaders/lib/light.glsl:2: "), HasSubstr("nowhere")));
    shaders_.write("lib/light.glsl", "float f() {\n    return 1.0;\n}\n");
    writeFragment("#include \"lib/light.glsl\"\nvoid main() {\n    color = nowhere;\n}\n");
    EXPECT_THAT(messageOf<ShaderError>([] { Program{probeFiles}; }),
                AllOf(StartsWith("shaders/probe.frag:5: "), HasSubstr("nowhere")));
    shaders_.write("cover.vert", "#version 330 core\n\n\n\nvoid main() { gl_Position = 7; }\n");
    EXPECT_THAT(messageOf<ShaderError>([] { Program{probeFiles}; }), StartsWith("shaders/cover.vert:5: "));
}

TEST_P(ProgramTest, AFaultAfterDefinesKeepsItsLine) {
    writeFragment("void main() {\n    color = vec4(LIGHTS) + nowhere;\n}\n");
    ProgramFiles files = probeFiles;
    files.defines = {{"LIGHTS", "4"}, {"MORE", "5"}, {"STILL_MORE", "6"}};
    EXPECT_THAT(messageOf<ShaderError>([&] { Program{files}; }), StartsWith("shaders/probe.frag:4: "));
}

TEST_P(ProgramTest, ALinkFaultNamesItsFiles) {
    shaders_.write("cover.vert",
                   "#version 330 core\nout vec2 mixed;\n"
                   "void main() { mixed = vec2(0); gl_Position = vec4(0); }\n");
    writeFragment("in vec3 mixed;\nvoid main() { color = vec4(mixed, 1); }\n");
    EXPECT_THAT(messageOf<ShaderError>([] { Program{probeFiles}; }),
                AllOf(HasSubstr("shaders/cover.vert"), HasSubstr("shaders/probe.frag"), HasSubstr("mixed")));
}

TEST_P(ProgramTest, AFailedBuildLeavesNoErrorBehind) {
    writeFragment("nonsense\n");
    EXPECT_THROW(Program{probeFiles}, ShaderError);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_P(ProgramTest, DefinesReachTheShader) {
    writeConstant("VALUE");
    ProgramFiles files = probeFiles;
    files.defines = {{"VALUE", "0.25, 0.5, 0.75, 1"}};
    EXPECT_THAT(drawn(Program(files)), ElementsAre(0.25f, 0.5f, 0.75f, 1.0f));
}

TEST_P(ProgramTest, GeometryShadersTakePart) {
    writeConstant("0.5");
    shaders_.write("shrink.geom",
                   "#version 330 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\n"
                   "void main() {\n  for (int i = 0; i < 3; ++i) {\n"
                   "    gl_Position = gl_in[i].gl_Position * vec4(1, 1, 1, -1); EmitVertex();\n  }\n}\n");
    ProgramFiles files = probeFiles;
    files.geometry = "shrink.geom";
    const Program program(files);
    const Texture2D target("target", GL_RGBA32F, 1, 1);
    const Texture2D* colors[] = {&target};
    const Framebuffer framebuffer("target", colors, nullptr);
    framebuffer.bind();
    glClearColor(1, 2, 3, 4);
    glClear(GL_COLOR_BUFFER_BIT);
    program.use();
    test::cover();
    EXPECT_THAT(readPixels(target).data, ElementsAre(1, 2, 3, 4)) << "everything is behind the eye";
}

TEST_P(ProgramTest, UniformsOfEveryTypeArrive) {
    writeFragment(
        "uniform int i; uniform bool b; uniform uint u; uniform float f; uniform vec2 v2; uniform vec3 v3;\n"
        "uniform vec4 v4; uniform mat3 m3; uniform mat4 m4; uniform float list[3];\n"
        "struct Light { vec3 color; float power; }; uniform Light lights[2];\n"
        "void main() { color = vec4(float(i) + (b ? 100.0 : 0.0) + float(u) * 1000.0 + f,\n"
        "    dot(v2, vec2(1, 10)) + dot(v3, vec3(100, 1000, 1e4)) + dot(v4, vec4(1e5, 1e6, 0, 0)),\n"
        "    (m3 * vec3(1, 2, 3)).y + (m4 * vec4(1, 2, 3, 4)).z * 1000.0,\n"
        "    list[0] + list[2] * 10.0 + lights[1].power * 100.0 + lights[0].color.y * 1000.0); }\n");
    const Program program(probeFiles);
    program.use();
    program.set("i", 3);
    program.set("b", 1);
    program.set("u", 7);
    program.set("f", 0.5f);
    program.set("v2", glm::vec2(1, 2));
    program.set("v3", glm::vec3(3, 4, 5));
    program.set("v4", glm::vec4(6, 7, 8, 9));
    program.set("m3", glm::mat3(1, 2, 3, 4, 5, 6, 7, 8, 9));
    program.set("m4", glm::mat4(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16));
    program.set("list", 1.0f);
    program.set("list[2]", 2.0f);
    program.set("lights[1].power", 3.0f);
    program.set("lights[0].color", glm::vec3(0, 4, 0));
    // Row 1 of m3 by (1, 2, 3) is 2 + 10 + 24 = 36; row 2 of m4 by (1, 2, 3, 4) is 3 + 14 + 33 + 60 = 110.
    EXPECT_THAT(drawn(program), ElementsAre(7103.5f, 7654321.0f, 110036.0f, 4321.0f));
    EXPECT_TRUE(program.has("list[1]") && program.has("lights[0].color") && program.has("m4"));
    EXPECT_FALSE(program.has("lights") || program.has("lis") || program.has(""));
}

TEST_P(ProgramTest, AValueOfAnotherTypeNamesProgramUniformAndTypes) {
    writeFragment(
        "uniform vec3 tint; uniform int count; uniform uint size; uniform sampler2D image;\n"
        "void main() { color = texture(image, tint.xy) * float(count) * float(size) * tint.z; }\n");
    const Program program(probeFiles);
    EXPECT_THAT(messageOf<GlError>([&] { program.set("tint", 1.0f); }),
                AllOf(HasSubstr("\"probe\""), HasSubstr("\"tint\""), HasSubstr("vec3"), HasSubstr("float")));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("tint", glm::vec4(1)); }), HasSubstr("vec4"));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("count", 1.0f); }), HasSubstr("is int"));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("image", 1.0f); }), HasSubstr("is sampler2D"));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("size", -1); }), HasSubstr("negative"));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("tint", glm::mat4(1)); }), HasSubstr("mat4"));
    EXPECT_NO_THROW(program.set("image", 1));
}

TEST_P(ProgramTest, UnusedUniformsAreIgnoredAndTyposAreErrors) {
    writeFragment("uniform vec3 unused; uniform float used;\nvoid main() { color = vec4(used); }\n");
    const Program program(probeFiles);
    EXPECT_FALSE(program.has("unused"));
    EXPECT_NO_THROW(program.set("unused", glm::vec3(1)));
    EXPECT_THAT(messageOf<GlError>([&] { program.set("usde", 1.0f); }),
                AllOf(HasSubstr("\"probe\""), HasSubstr("\"usde\"")));
}

TEST_P(ProgramTest, SettingAUniformCostsOneCallWhenInUse) {
    writeFragment("uniform vec4 tint;\nvoid main() { color = tint; }\n");
    const Program first(probeFiles);
    const Program second(probeFiles);
    first.use();
    const std::uint64_t before = callCount();
    for (int i = 0; i < 10; ++i)
        first.set("tint", glm::vec4(static_cast<float>(i) - 8));
    EXPECT_EQ(callCount() - before, 10u);
    second.set("tint", glm::vec4(2));
    EXPECT_THAT(drawn(first), ElementsAre(1, 1, 1, 1)) << "the second program's uniform is its own";
    EXPECT_THAT(drawn(second), ElementsAre(2, 2, 2, 2));
}

TEST_P(ProgramTest, SettingAUniformToWhatItHasCostsNoCall) {
    writeFragment("uniform float weights[2];\nvoid main() { color = vec4(weights[0], weights[1], 0, 0); }\n");
    const Program program(probeFiles);
    program.set("weights", 3.0f);
    program.set("weights[1]", 4.0f);
    const std::uint64_t before = callCount();
    program.set("weights[0]", 3.0f);
    program.set("weights[1]", 4.0f);
    EXPECT_EQ(callCount(), before) << "an array and its first element are one uniform";
    program.set("weights[0]", 5.0f);
    program.set("weights", 3.0f);
    EXPECT_EQ(callCount(), before + 2);
    EXPECT_THAT(drawn(program), ElementsAre(3, 4, 0, 0));
}

TEST_P(ProgramTest, ReloadsWhatChanged) {
    shaders_.write("lib/value.glsl", "const float value = 1.0;\n");
    writeFragment("#include \"lib/value.glsl\"\nvoid main() { color = vec4(value); }\n");
    Program program(probeFiles);
    EXPECT_FALSE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(1, 1, 1, 1));
    shaders_.write("lib/value.glsl", "const float value = 2.0;\n");
    EXPECT_TRUE(program.reloadIfChanged());
    EXPECT_FALSE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(2, 2, 2, 2));
    writeConstant("3");
    EXPECT_TRUE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(3, 3, 3, 3));
    shaders_.write("lib/value.glsl", "const float value = 4.0;\n");
    EXPECT_FALSE(program.reloadIfChanged()) << "it is included no more";
}

TEST_P(ProgramTest, ABrokenEditKeepsTheLastGoodProgramAndIsToldOnce) {
    writeConstant("1");
    Program program(probeFiles);
    writeConstant("nowhere");
    EXPECT_THAT(messageOf<ShaderError>([&] { program.reloadIfChanged(); }),
                AllOf(StartsWith("shaders/probe.frag:3: "), HasSubstr("nowhere")));
    EXPECT_THAT(program.brokenEdit(), HasSubstr("nowhere"));
    EXPECT_FALSE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(1, 1, 1, 1));
    writeConstant("2");
    EXPECT_TRUE(program.reloadIfChanged());
    EXPECT_EQ(program.brokenEdit(), "");
    EXPECT_THAT(drawn(program), ElementsAre(2, 2, 2, 2));
}

TEST_P(ProgramTest, ABrokenNewIncludeIsWatched) {
    writeConstant("1");
    Program program(probeFiles);
    writeFragment("#include \"lib/new.glsl\"\nvoid main() { color = vec4(value()); }\n");
    EXPECT_THAT(messageOf<ShaderError>([&] { program.reloadIfChanged(); }),
                AllOf(StartsWith("shaders/probe.frag:3: "), HasSubstr("lib/new.glsl")));
    shaders_.write("lib/new.glsl", "float value() { return nowhere; }\n");
    EXPECT_THAT(messageOf<ShaderError>([&] { program.reloadIfChanged(); }),
                StartsWith("shaders/lib/new.glsl:1: "));
    shaders_.write("lib/new.glsl", "float value() { return 5.0; }\n");
    EXPECT_TRUE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(5, 5, 5, 5));
}

TEST_P(ProgramTest, AFileGoneOrEmptyForAMomentIsWaitedFor) {
    writeConstant("1");
    Program program(probeFiles);
    shaders_.remove("probe.frag");
    EXPECT_FALSE(program.reloadIfChanged());
    shaders_.write("probe.frag", "");
    EXPECT_FALSE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(1, 1, 1, 1));
    writeConstant("2");
    EXPECT_TRUE(program.reloadIfChanged());
    EXPECT_THAT(drawn(program), ElementsAre(2, 2, 2, 2));
}

TEST_P(ProgramTest, UniformsAreFoundAgainAfterReloading) {
    writeFragment("uniform float a;\nvoid main() { color = vec4(a); }\n");
    Program program(probeFiles);
    program.set("a", 1.0f);
    writeFragment("uniform vec2 b; uniform vec3 a;\nvoid main() { color = vec4(a, b.x); }\n");
    ASSERT_TRUE(program.reloadIfChanged());
    EXPECT_THROW(program.set("a", 1.0f), GlError);
    program.set("a", glm::vec3(1, 2, 3));
    program.set("b", glm::vec2(4, 5));
    EXPECT_THAT(drawn(program), ElementsAre(1, 2, 3, 4));
}

TEST_P(ProgramTest, TheCacheBuildsEachVariantOnce) {
    writeConstant("VALUE");
    ProgramFiles one = probeFiles;
    one.defines = {{"VALUE", "1"}};
    ProgramFiles two = one;
    two.defines[0].second = "2";
    ProgramCache cache;
    const Program& first = cache.get(one);
    const Program& second = cache.get(two);
    EXPECT_NE(&first, &second);
    const std::uint64_t before = callCount();
    EXPECT_EQ(&cache.get(one), &first);
    EXPECT_EQ(callCount(), before);
    EXPECT_EQ(cache.size(), 2u);
    EXPECT_THAT(drawn(first), ElementsAre(1, 1, 1, 1));
    EXPECT_THAT(drawn(second), ElementsAre(2, 2, 2, 2));
}

TEST_P(ProgramTest, TheCacheReloadsAllAndTellsWhatIsBroken) {
    writeConstant("VALUE");
    ProgramFiles one = probeFiles;
    one.defines = {{"VALUE", "1"}};
    ProgramCache cache;
    const Program& program = cache.get(one);
    EXPECT_EQ(cache.reloadChanged(), std::nullopt);
    writeConstant("nowhere");
    EXPECT_THAT(cache.reloadChanged().value_or(""), HasSubstr("nowhere"));
    EXPECT_THAT(cache.reloadChanged().value_or(""), HasSubstr("nowhere")) << "until it is mended";
    writeConstant("VALUE + 1");
    EXPECT_EQ(cache.reloadChanged(), std::nullopt);
    EXPECT_THAT(drawn(program), ElementsAre(2, 2, 2, 2));
}

TEST_P(ProgramTest, AFirstBuildThatFailsLeavesTheCacheUnchanged) {
    writeConstant("nowhere");
    ProgramCache cache;
    EXPECT_THROW(cache.get(probeFiles), ShaderError);
    EXPECT_EQ(cache.size(), 0u);
    writeConstant("1");
    EXPECT_THAT(drawn(cache.get(probeFiles)), ElementsAre(1, 1, 1, 1));
}

QX_ON_BOTH_BACKENDS(ProgramTest);

}  // namespace
}  // namespace quincunx::gl

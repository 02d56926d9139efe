#include "gl/shader_source.h"

#include <fmt/format.h>

#include "base/random.h"
#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::string_view head = "#version 330 core\n";

class ShaderSourceTest : public testing::Test {
  protected:
    void write(std::string_view name, const std::string& text) { shaders_.write(name, text); }
    /// Writes a main file after the version line, and tells what loading it throws.
    std::string fault(const std::string& body) {
        write("main.frag", std::string(head) + body);
        return messageOf<ShaderError>([] { loadShader("main.frag"); });
    }

    test::ShaderFolder shaders_;
};

TEST_F(ShaderSourceTest, LinesAreNumberedAsTheAuthorsNumberThem) {
    write("lib/one.glsl", "one 1\none 2\n");
    write("lib/two.glsl", "#include \"one.glsl\"\ntwo 2\n");
    write("main.frag",
          std::string(head) + "main 2\n#include \"lib/two.glsl\"\nmain 4\n#include \"lib/one.glsl\"\nmain 6");
    const ShaderSource source = loadShader("main.frag", {{"LIGHTS", "4"}, {"FAST", ""}});
    EXPECT_EQ(source.text,
              "#version 330 core\n#define LIGHTS 4\n#define FAST \n"
              "main 2\none 1\none 2\ntwo 2\nmain 4\nmain 6\n");
    std::vector<std::pair<std::size_t, std::size_t>> lines;
    for (const auto& [file, line] : source.lines)
        lines.emplace_back(file, line);
    using testing::Pair;
    EXPECT_THAT(lines, testing::ElementsAre(Pair(0, 1), Pair(0, 1), Pair(0, 1), Pair(0, 2), Pair(2, 1),
                                            Pair(2, 2), Pair(1, 2), Pair(0, 4), Pair(0, 6)));
    ASSERT_EQ(source.files.size(), 3u);
    EXPECT_EQ(detail::displayName(source.files[0]), "shaders/main.frag");
    EXPECT_EQ(detail::displayName(source.files[1]), "shaders/lib/two.glsl");
    EXPECT_EQ(detail::displayName(source.files[2]), "shaders/lib/one.glsl");
}

TEST_F(ShaderSourceTest, AFileBesideTheIncludingOneComesFirst) {
    write("a.glsl", "from shaders/\n");
    write("lib/a.glsl", "from lib/\n");
    write("lib/b.glsl", "#include \"a.glsl\"\n");
    write("main.frag", std::string(head) + "#include \"lib/b.glsl\"\n");
    EXPECT_THAT(loadShader("main.frag").text, AllOf(HasSubstr("from lib/"), Not(HasSubstr("from shaders/"))));
}

TEST_F(ShaderSourceTest, TheSameFileByAnotherSpellingIsIncludedOnce) {
    write("lib/a.glsl", "unique\n");
    write("main.frag", std::string(head) + "#include \"lib/a.glsl\"\n#include \"lib/../lib/./a.glsl\"\n");
    const std::string text = loadShader("main.frag").text;
    EXPECT_EQ(text.find("unique"), text.rfind("unique"));
}

TEST_F(ShaderSourceTest, EditorsMarksAndLineEndsAreTaken) {
    write("lib/a.glsl", "\xef\xbb\xbfone\r\ntwo");
    write("main.frag",
          "\xef\xbb\xbf#version 330 core  // with a comment\r\n  #  include  \"lib/a.glsl\" // "
          "here\r\nend\r\n");
    EXPECT_EQ(loadShader("main.frag").text, "#version 330 core\none\ntwo\nend\n");
}

TEST_F(ShaderSourceTest, IncludesInCommentsAreComments) {
    write("main.frag",
          std::string(head) + "// #include \"x\"\n/* #include \"x\"\n#include \"x\"\n*/ int a;\n");
    EXPECT_THAT(loadShader("main.frag").text, HasSubstr("int a;"));
}

TEST_F(ShaderSourceTest, OnlyVersion330CoreOnTheFirstLineIsAccepted) {
    for (const char* text :
         {"", "\n#version 330 core\n", "#version 400\n", "#version 330\n", "#version 330 compatibility\n",
          "// hello\n#version 330 core\n", "void main() {}\n"}) {
        write("main.frag", text);
        EXPECT_THAT(messageOf<ShaderError>([] { loadShader("main.frag"); }),
                    AllOf(StartsWith("shaders/main.frag:1: "), HasSubstr("#version 330 core")))
            << text;
    }
    EXPECT_THAT(fault("#version 400\n"), StartsWith("shaders/main.frag:2: #version"));
    write("lib/a.glsl", "\n\n#version 330 core\n");
    EXPECT_THAT(fault("#include \"lib/a.glsl\"\n"), StartsWith("shaders/lib/a.glsl:3: #version"));
}

TEST_F(ShaderSourceTest, AMissingFileIsBlamedOnTheLineThatAsksForIt) {
    EXPECT_EQ(messageOf<ShaderError>([] { loadShader("none.frag"); }),
              "shaders/none.frag: no such file; check the name");
    EXPECT_THAT(fault("\n#include \"lib/none.glsl\"\n"),
                AllOf(StartsWith("shaders/main.frag:3: "), HasSubstr("\"lib/none.glsl\"")));
    EXPECT_THAT(fault("#include \".\"\n"), StartsWith("shaders/main.frag:2: ")) << "a folder";
}

TEST_F(ShaderSourceTest, ACycleNamesItsFiles) {
    write("a.glsl", "\n#include \"b.glsl\"\n");
    write("b.glsl", "#include \"a.glsl\"\n");
    EXPECT_THAT(fault("#include \"a.glsl\"\n"),
                AllOf(StartsWith("shaders/b.glsl:1: #include cycle: "),
                      HasSubstr("shaders/a.glsl includes shaders/b.glsl includes shaders/a.glsl")));
    EXPECT_THAT(fault("#include \"main.frag\"\n"), HasSubstr("shaders/main.frag includes shaders/main.frag"));
}

TEST_F(ShaderSourceTest, DepthEndsAt32Files) {
    for (int i = 0; i < 33; ++i)
        write(fmt::format("{}.glsl", i), fmt::format("#include \"{}.glsl\"\n", i + 1));
    write("31.glsl", "end\n");
    EXPECT_THAT(fault("#include \"0.glsl\"\n"),
                AllOf(StartsWith("shaders/30.glsl:1: "), HasSubstr("deeper than 32")));
    EXPECT_EQ(fault("#include \"1.glsl\"\n"), "no error");
}

TEST_F(ShaderSourceTest, TotalSizeEndsAt4MiB) {
    write("big.glsl", std::string(std::size_t{3} << 20, ' '));
    write("big2.glsl", std::string(std::size_t{1} << 20, ' '));
    write("huge.glsl", std::string((std::size_t{4} << 20) + 1, ' '));
    EXPECT_EQ(fault("#include \"big.glsl\"\n"), "no error");
    EXPECT_THAT(fault("#include \"big.glsl\"\n#include \"big2.glsl\"\n"),
                AllOf(StartsWith("shaders/main.frag:3: "), HasSubstr("4 MiB")));
    EXPECT_THAT(fault("#include \"huge.glsl\"\n"), StartsWith("shaders/main.frag:2: "));
}

TEST_F(ShaderSourceTest, FilesOutsideShadersAreRefused) {
    shaders_.write("../secret", "secret\n");
    for (const char* name : {"../secret", "lib/../../secret", "/etc/hostname"})
        EXPECT_THAT(fault(fmt::format("#include \"{}\"\n", name)),
                    AllOf(StartsWith("shaders/main.frag:2: "), HasSubstr("outside shaders/")))
            << name;
    write("lib/deep/a.glsl", "#include \"../b.glsl\"\n");
    write("lib/b.glsl", "fine\n");
    EXPECT_EQ(fault("#include \"lib/deep/a.glsl\"\n"), "no error");
}

TEST_F(ShaderSourceTest, MalformedLinesAreRefusedWithTheirPlace) {
    for (const char* line :
         {"#include", "#include <a>", "#include \"\"", "#include \"a", "#include \"a\" \"b\""})
        EXPECT_THAT(fault(std::string(line) + "\n"),
                    AllOf(StartsWith("shaders/main.frag:2: "), HasSubstr("malformed")))
            << line;
    EXPECT_THAT(fault(std::string("ok\na\0b\n", 7)),
                AllOf(StartsWith("shaders/main.frag:3: "), HasSubstr("zero byte")));
    EXPECT_THAT(fault("#line 7\n"), StartsWith("shaders/main.frag:2: #line"));
    EXPECT_THAT(fault("#ifdef A\n#include \"a\"\n#endif\n"),
                AllOf(StartsWith("shaders/main.frag:3: "), HasSubstr("inside #if")));
    write("main.frag", std::string(head));
    EXPECT_THROW(loadShader("main.frag", {{"A B", "1"}}), ShaderError);
    EXPECT_THROW(loadShader("main.frag", {{"A", "1\n#version 400"}}), ShaderError);
}

TEST_F(ShaderSourceTest, AnyBytesGiveTextOrAShaderError) {
    const std::string_view pieces[] = {
        "#include \"a.glsl\"\n", "#include", "\"", "\n",   "/*", "*/", "//", "#if 1\n", "#endif\n",
        "#version 330 core\n",   "\r",       "\\", "\xff", " ",  "..", "<"};
    Random random(5);
    int loaded = 0;
    for (int round = 0; round < 1000; ++round) {
        std::string text = random.below(8) == 0 ? "" : std::string(head);
        std::string included;
        for (std::size_t i = 0, count = random.below(12); i < count; ++i)
            (random.below(2) == 0 ? text : included) += pieces[random.below(std::size(pieces))];
        write("main.frag", text);
        write("a.glsl", included);
        try {
            const ShaderSource source = loadShader("main.frag");
            EXPECT_THAT(source.text, StartsWith(head));
            ++loaded;
        } catch (const ShaderError& error) {
            EXPECT_THAT(error.what(), StartsWith("shaders/"));
            EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
        }
    }
    EXPECT_GT(loaded, 100);
}

TEST_F(ShaderSourceTest, LogsOfAllDriversNameTheAuthorsLines) {
    write("lib/a.glsl", "a 1\na 2\n");
    write("main.frag", std::string(head) + "main 2\n#include \"lib/a.glsl\"\nmain 4\n");
    const ShaderSource source = loadShader("main.frag");
    EXPECT_EQ(authorsLog("0:5(3): error: `x' undeclared\n0:4(14): warning: y\n", source),
              "shaders/main.frag:4: error: `x' undeclared\nshaders/lib/a.glsl:2: warning: y\n")
        << "Mesa";
    EXPECT_EQ(authorsLog("0(5) : error C1008: undefined variable \"x\"\n0(3) : warning C7050: z\n", source),
              "shaders/main.frag:4: error C1008: undefined variable \"x\"\nshaders/lib/a.glsl:1: warning "
              "C7050: z\n")
        << "NVIDIA";
    EXPECT_EQ(authorsLog("ERROR: 0:3: 'x' : undeclared identifier\nWARNING: 0:1: w", source),
              "shaders/lib/a.glsl:1: error: 'x' : undeclared identifier\nshaders/main.frag:1: warning: w")
        << "Apple, Intel";
    for (const char* line : {"error: no place", "1:1(1): error: no such file", "0:6(1): error: no such line",
                             "0:0(0): error: x", "0:x", "0(1: a", "12", "", "99999999999999999999:1: x"})
        EXPECT_EQ(authorsLog(line, source), line);
}

TEST(FirstError, IsOneLineAndCountsTheRest) {
    EXPECT_EQ(detail::firstError("f:1: warning: w\nf:2: error: a\nf:3: error: b\nf:4: error: c\n"),
              "f:2: error: a (and 2 more)");
    EXPECT_EQ(detail::firstError("f:2: error: a\n\n"), "f:2: error: a");
    EXPECT_EQ(detail::firstError("strange\nwords"), "strange");
    EXPECT_EQ(detail::firstError(" \n"), "the driver does not say why");
}

TEST(Identifiers, AreSortedAndUnique) {
    EXPECT_THAT(detail::identifiers("uniform vec4 a_1[2]; 3b 4.e5 a_1 _x"),
                testing::ElementsAre("_x", "a_1", "e5", "uniform", "vec4"));
}

}  // namespace
}  // namespace quincunx::gl

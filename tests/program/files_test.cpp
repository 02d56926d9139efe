// Files that are missing, cut off or hostile, and places that cannot be written.

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/file.h"
#include "tests/program/program.h"

namespace quincunx::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct BadFile {
    std::string name;
    std::string contents;
};

void PrintTo(const BadFile& file, std::ostream* stream) {
    *stream << file.name;
}

class ProgramModels : public Program, public testing::WithParamInterface<BadFile> {};

TEST_P(ProgramModels, ThatAreUnusableAreNamedInOneLine) {
    folder_.file(GetParam().name, GetParam().contents);
    EXPECT_TRUE(
        failedWith(call(drawingSmall({"run", "shading", "--model", GetParam().name})), 2, GetParam().name));
    EXPECT_THAT(leftBehind(), ElementsAre(GetParam().name));
}

using ProgramFolders = Program;

TEST_F(ProgramFolders, ModelsNamedWithoutAFolderKeepTheirMaterials) {
    folder_.file("red.mtl", "newmtl red\nKd 1 0 0\n");
    folder_.file("red.obj", "mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    const ProcessResult bare =
        call(drawingSmall({"run", "shading", "--model", "red.obj", "--out", "bare.png"}));
    EXPECT_TRUE(succeeded(bare));
    EXPECT_THAT(bare.err, testing::IsEmpty());
    EXPECT_TRUE(
        succeeded(call(drawingSmall({"run", "shading", "--model", "./red.obj", "--out", "path.png"}))));
    EXPECT_THAT(call({"compare", "bare.png", "path.png", "--metric", "rmse"}).out,
                HasSubstr("rmse 0.000000"));
}

TEST_F(ProgramFolders, LinearPicturesAreComparedInLinearLight) {
    EXPECT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--out", "a.exr"}))));
    EXPECT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--specular=off", "--out", "b.exr"}))));
    EXPECT_THAT(call({"compare", "a.exr", "b.exr", "--metric", "rmse", "--json"}).out,
                testing::AllOf(HasSubstr("linear"), Not(HasSubstr("\"value\": 0.0,"))));
    EXPECT_THAT(call({"compare", "a.exr", "a.exr", "--metric", "flip"}).out, HasSubstr("flip 0.000000"));
    EXPECT_TRUE(failedWith(call({"compare", "a.exr", "b.exr", "--metric", "ssim"}), 2, "a.exr"));
}

std::string nested(std::size_t depth) {
    return std::string(depth, '[');
}

std::string gltf(const std::string& members) {
    return R"({"asset":{"version":"2.0"},)" + members + "}";
}

/// A scene of one triangle whose positions come from `accessor` and from a buffer of 36 bytes.
std::string gltfTriangle(const std::string& accessor) {
    return gltf(R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                std::string(48, 'A') + R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[)" +
                accessor + "]");
}

INSTANTIATE_TEST_SUITE_P(
    Files, ProgramModels,
    testing::Values(
        BadFile{"model.txt", "v 0 0 0\n"}, BadFile{"noextension", "v 0 0 0\n"}, BadFile{"empty.obj", ""},
        BadFile{"binary.obj", std::string("\x7f"
                                          "ELF\0\0\0\xff\xfe",
                                          9)},
        BadFile{"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"},
        BadFile{"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n"},
        BadFile{"index_huge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n"},
        BadFile{"empty.gltf", ""}, BadFile{"text.gltf", "no JSON\n"}, BadFile{"number.gltf", "5"},
        BadFile{"cut.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"no)"},
        BadFile{"deep.gltf", nested(1'000'000)}, BadFile{"nothing.gltf", gltf(R"("scenes":[])")},
        BadFile{"version.gltf", R"({"asset":{"version":"9.0"}})"},
        BadFile{"extension.gltf", gltf(R"("extensionsUsed":["NO_such"],"extensionsRequired":["NO_such"])")},
        BadFile{"nobuffer.gltf", gltf(R"("buffers":[{"byteLength":4,"uri":"nosuch.bin"}])")},
        BadFile{"count.gltf",
                gltfTriangle(R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})")},
        BadFile{"count_huge.gltf",
                gltfTriangle(
                    R"({"bufferView":0,"componentType":5126,"count":9000000000000000000,"type":"VEC3"})")},
        BadFile{"count_negative.gltf",
                gltfTriangle(R"({"bufferView":0,"componentType":5126,"count":-3,"type":"VEC3"})")},
        BadFile{"view.gltf",
                gltfTriangle(R"({"bufferView":7,"componentType":5126,"count":3,"type":"VEC3"})")},
        BadFile{"cycle.gltf", gltf(R"("scene":0,"scenes":[{"nodes":[0]}],
            "nodes":[{"children":[1]},{"children":[0]}])")},
        BadFile{"empty.glb", ""}, BadFile{"magic.glb", "glTX\2\0\0\0\14\0\0\0"},
        BadFile{"cut.glb", std::string("glTF\2\0\0\0\377\377\377\377\377\377\377\377JSON", 20)}),
    [](const testing::TestParamInfo<BadFile>& tested) {
        std::string name = tested.param.name;
        for (char& c : name)
            c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
        return name;
    });

class ProgramFiles : public Program {
  protected:
    void draw(const std::string& file) const {
        ASSERT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--out", file}))));
    }
};

TEST_F(ProgramFiles, ThatAreNoneAreNamedAndNeverWaitedFor) {
    fs::create_directory(folder_ / "folder.obj");
    ASSERT_EQ(mkfifo((folder_ / "pipe.obj").c_str(), 0600), 0);
    for (const char* file : {"nosuch.obj", "nosuch/model.gltf", "folder.obj", "pipe.obj"})
        EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--model", file})), 2, file));
    fs::create_directory(folder_ / "folder.png");
    ASSERT_EQ(mkfifo((folder_ / "pipe.png").c_str(), 0600), 0);
    for (const char* file : {"nosuch.png", "folder.png", "pipe.png", "/dev/zero"}) {
        EXPECT_TRUE(failedWith(call({"compare", file, file}), 2, file));
        EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--replay", file})), 2, file));
    }
}

TEST_F(ProgramFiles, NamesWithControlCharactersAreEscapedInMessages) {
    EXPECT_TRUE(failedWith(call({"compare", "no\nsuch\x1b[31m.png", "b.png"}), 2, "such"));
    EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--model", "no\nsuch.obj"})), 2, "such.obj"));
}

TEST_F(ProgramFiles, PicturesThatEndEarlyOrAreNoneAreNamed) {
    draw("good.png");
    const std::string whole = readFile(folder_ / "good.png", 1 << 20);
    for (const double part : {0.0, 0.01, 0.1, 0.5, 0.9}) {
        folder_.file("cut.png",
                     whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
        EXPECT_TRUE(failedWith(call({"compare", "good.png", "cut.png"}), 2, "cut.png")) << part;
        EXPECT_TRUE(failedWith(call({"compare", "cut.png", "good.png"}), 2, "cut.png")) << part;
    }
    folder_.file("text.png", "a text\n");
    EXPECT_TRUE(failedWith(call({"compare", "good.png", "text.png"}), 2, "text.png"));
    // The width, in the header of every PNG, at its largest.
    std::string wide = whole;
    wide.replace(16, 4, "\x7f\xff\xff\xff");
    folder_.file("wide.png", wide);
    EXPECT_TRUE(failedWith(call({"compare", "wide.png", "wide.png"}), 2, "wide.png"));
}

TEST_F(ProgramFiles, PicturesOfDifferentSizesCannotBeCompared) {
    draw("a.png");
    ASSERT_TRUE(
        succeeded(call({"run", "shading", "--backend", "osmesa", "--size", "33x24", "--out", "b.png"})));
    EXPECT_TRUE(failedWith(call({"compare", "a.png", "b.png"}), 2, "32"));
}

TEST_F(ProgramFiles, AnErrorMapIsWrittenAndADifferenceBeyondTheLimitIsExitStatusOne) {
    draw("a.png");
    ASSERT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--shading=flat", "--out", "b.png"}))));
    EXPECT_TRUE(succeeded(call({"compare", "a.png", "b.png", "--out", "map.png"})));
    EXPECT_TRUE(fs::exists(folder_ / "map.png"));
    EXPECT_EQ(call({"compare", "a.png", "b.png", "--max-error", "0"}).exitStatus, 1);
    EXPECT_EQ(call({"compare", "a.png", "a.png", "--max-error", "0"}).exitStatus, 0);
}

TEST_F(ProgramFiles, ARecordAndAPictureDrawTheSamePictureAgain) {
    ASSERT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--shading=gouraud", "--light-turn=30.1",
                                             "--out", "a.png", "--record", "a.json"}))));
    for (const char* source : {"a.json", "a.png"}) {
        ASSERT_TRUE(
            succeeded(call({"run", "shading", "--backend", "osmesa", "--replay", source, "--out", "b.png"})));
        EXPECT_EQ(call({"compare", "a.png", "b.png", "--metric", "rmse", "--max-error", "0"}).exitStatus, 0)
            << source;
    }
}

TEST_F(ProgramFiles, AModelThatChangedSinceItsPictureIsNotTakenForTheSame) {
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder_.file("model.obj", triangle);
    ASSERT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--model", "model.obj", "--out", "a.png"}))));
    const std::vector<std::string> again = {"run",      "shading", "--backend", "osmesa",
                                            "--replay", "a.png",   "--out",     "b.png"};
    // A comment changes the file, not what is drawn.
    folder_.file("model.obj", "# the same\n" + triangle);
    ASSERT_TRUE(succeeded(call(again)));
    EXPECT_EQ(call({"compare", "a.png", "b.png", "--metric", "rmse", "--max-error", "0"}).exitStatus, 0);
    folder_.file("model.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    EXPECT_TRUE(failedWith(call(again), 2, "model.obj"));
    std::vector<std::string> named = again;
    named.insert(named.end(), {"--model", "model.obj"});
    EXPECT_TRUE(succeeded(call(named)));
}

TEST_F(ProgramFiles, ADisplayThatDoesNotAnswerGivesAPictureInstead) {
    const ProcessResult result =
        call({"run", "shading", "--size", "32x24"}, {"DISPLAY=:54321", "WAYLAND_DISPLAY="});
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(fs::exists(folder_ / "out/10_shading.png"));
}

TEST_F(ProgramFiles, AKnobWithoutEffectIsToldSo) {
    folder_.file("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const ProcessResult result = call(drawingSmall(
        {"run", "shading", "--model", "model.obj", "--tessellation=9", "--shear=1", "--out", "a.png"}));
    EXPECT_EQ(result.exitStatus, 0);
    EXPECT_THAT(result.err, HasSubstr("warning: --tessellation"));
    EXPECT_THAT(result.err, testing::Not(HasSubstr("--shear")));
}

TEST_F(ProgramFiles, RecordsThatAreHostileAreNamed) {
    for (const char* record : {"", "{", "[]", R"({"lab":5})", R"({"lab":"10_shading"})",
                               R"({"lab":"10_shading","width":1e99,"height":-1})"}) {
        folder_.file("record.json", record);
        EXPECT_TRUE(failedWith(call({"run", "shading", "--replay", "record.json"}), 2, "record.json"))
            << record;
    }
    folder_.file("record.json", nested(1'000'000));
    EXPECT_TRUE(failedWith(call({"run", "shading", "--replay", "record.json"}), 2, "record.json"));
}

TEST_F(ProgramFiles, PlacesThatCannotBeWrittenAreNamedAndNothingIsLeft) {
    folder_.file("file", "");
    for (const char* place : {"file/picture.png", "/proc/picture.png", "/proc/nosuch/picture.exr",
                              "/dev/full", "picture.bmp", "picture", "."})
        EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--out", place})), 2)) << place;
    EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--out", "a.png", "--record", "file/b"})), 2,
                           "file"));
    EXPECT_TRUE(failedWith(call(drawingSmall({"sweep", "shading", "--out", "file"})), 2, "file"));
    EXPECT_THAT(leftBehind(), testing::IsSubsetOf({"a.png", "file"}));
}

TEST_F(ProgramFiles, ADeviceIsNeverReplacedByAFile) {
    const bool wasDevice = fs::is_character_file("/dev/null");
    fs::create_symlink("/dev/null", folder_ / "link.png");
    EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--out", "link.png"})), 2, "link.png"));
    EXPECT_TRUE(failedWith(call(drawingSmall({"run", "shading", "--out", "a.png", "--record", "link.png"})),
                           2, "link.png"));
    EXPECT_EQ(fs::is_character_file("/dev/null"), wasDevice);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.png"));
}

TEST_F(ProgramFiles, OnADiskThatFillsUpNothingIsLeft) {
    // A file that may not grow past 512 bytes fails in the middle of a write, as on a full disk.
    const std::string full = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
    for (const char* place : {"picture.png", "picture.exr"}) {
        EXPECT_TRUE(failedWith(
            callInShell(full, {"run", "shading", "--backend", "osmesa", "--size", "200x200", "--out", place}),
            2, place));
        EXPECT_THAT(leftBehind(), testing::IsEmpty());
    }
}

TEST_F(ProgramFiles, AFailedRunKeepsTheOldPicture) {
    draw("picture.png");
    const std::string before = readFile(folder_ / "picture.png", 1 << 20);
    EXPECT_EQ(
        callInShell("trap '' XFSZ; ulimit -f 1; exec \"$@\"",
                    {"run", "shading", "--backend", "osmesa", "--size", "200x200", "--out", "picture.png"})
            .exitStatus,
        2);
    EXPECT_EQ(readFile(folder_ / "picture.png", 1 << 20), before);
}

}  // namespace
}  // namespace quincunx::test

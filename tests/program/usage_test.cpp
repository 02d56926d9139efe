// Right and wrong use of the command line.

#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/program/program.h"

namespace quincunx::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const std::vector<std::string> verbs = {"list",   "run",     "ask",  "sweep", "plan",
                                        "stress", "compare", "deck", "atlas"};

TEST_F(Program, HelpNamesEveryVerb) {
    const ProcessResult result = call({"--help"});
    EXPECT_TRUE(succeeded(result));
    for (const std::string& verb : verbs)
        EXPECT_THAT(result.out, HasSubstr("\n  " + verb + " "));
}

TEST_F(Program, EveryVerbHasHelpOfItsOwn) {
    for (const std::string& verb : verbs) {
        const ProcessResult result = call({verb, "--help"});
        EXPECT_TRUE(succeeded(result)) << verb;
        EXPECT_THAT(result.out, AllOf(HasSubstr(verb), HasSubstr("--json"))) << verb;
    }
}

TEST_F(Program, HelpOfALabNamesItsKnobsWithWhatTheyAllow) {
    const ProcessResult result = call({"run", "shading", "--help"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_THAT(result.out, AllOf(HasSubstr("--tessellation"), HasSubstr("flat|gouraud|phong")));
}

TEST_F(Program, NamesItsVersion) {
    EXPECT_THAT(call({"--version"}).out, StartsWith("quincunx 0."));
}

TEST_F(Program, FindsALabByNumberNameAndFolder) {
    for (const char* name : {"10", "shading", "10_shading"})
        EXPECT_THAT(call({"run", name, "--help"}).out, HasSubstr("--tessellation")) << name;
}

struct WrongUse {
    std::vector<std::string> words;
    std::string named;  ///< what the message must name
};

void PrintTo(const WrongUse& use, std::ostream* stream) {
    *stream << testing::PrintToString(use.words);
}

class ProgramWrongUse : public Program, public testing::WithParamInterface<WrongUse> {};

TEST_P(ProgramWrongUse, IsOneLineOnStderrAndExitStatusTwo) {
    const ProcessResult result = call(GetParam().words);
    EXPECT_TRUE(failedWith(result, 2, GetParam().named));
    EXPECT_THAT(leftBehind(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Words, ProgramWrongUse,
    testing::Values(
        WrongUse{{}, "--help"}, WrongUse{{"nosuch"}, "nosuch"}, WrongUse{{"--nosuch"}, "--nosuch"},
        WrongUse{{"list", "extra"}, "extra"}, WrongUse{{"run"}, "LAB"},
        WrongUse{{"run", "nosuch"}, "10_shading"},
        WrongUse{{"run", "nosuch", "--tessellation=4"}, "10_shading"},
        WrongUse{{"run", "bad\nname\x1b[31m"}, "10_shading"}, WrongUse{{"run", ""}, "10_shading"},
        WrongUse{{"run", "shading", "--nosuch=1"}, "--nosuch"},
        WrongUse{{"run", "shading", "extra"}, "extra"}, WrongUse{{"run", "shading", "--size"}, "--size"},
        WrongUse{{"run", "shading", "--size", "0x0"}, "--size"},
        WrongUse{{"run", "shading", "--size", "10"}, "--size"},
        WrongUse{{"run", "shading", "--size", "-1x5"}, "--size"},
        WrongUse{{"run", "shading", "--size", "4x4x4"}, "--size"},
        WrongUse{{"run", "shading", "--size", "99999999999x4"}, "--size"},
        WrongUse{{"run", "shading", "--size", "16385x1"}, "--size"},
        WrongUse{{"run", "shading", "--backend", "nosuch"}, "nosuch"},
        WrongUse{{"run", "shading", "--seed", "-1"}, "seed"},
        WrongUse{{"run", "shading", "--seed", "x"}, "seed"},
        WrongUse{{"run", "shading", "--seed", "99999999999999999999"}, "seed"},
        WrongUse{{"run", "shading", "--tessellation=2"}, "tessellation"},
        WrongUse{{"run", "shading", "--tessellation=4.5"}, "tessellation"},
        WrongUse{{"run", "shading", "--tessellation=99999999999999999999"}, "tessellation"},
        WrongUse{{"run", "shading", "--shininess-scale=nan"}, "shininess-scale"},
        WrongUse{{"run", "shading", "--shininess-scale=inf"}, "shininess-scale"},
        WrongUse{{"run", "shading", "--shininess-scale=1e9"}, "shininess-scale"},
        WrongUse{{"run", "shading", "--shininess-scale="}, "shininess-scale"},
        WrongUse{{"run", "shading", "--shininess-scale=1,5"}, "shininess-scale"},
        WrongUse{{"run", "shading", "--shading=nosuch"}, "flat"},
        WrongUse{{"run", "shading", "--mirror=perhaps"}, "mirror"}, WrongUse{{"ask"}, "QUESTION"},
        WrongUse{{"ask", "nosuch"}, "nosuch"}, WrongUse{{"ask", "9999"}, "37"}, WrongUse{{"ask", "-1"}, "-1"},
        WrongUse{{"ask", "99999999999999999999"}, "99999999999999999999"},
        WrongUse{{"sweep", "shading", "--sweep", "nosuch"}, "--sweep"},
        WrongUse{{"sweep", "shading", "--budget-ms", "-1"}, "--budget-ms"},
        WrongUse{{"sweep", "shading", "--budget-ms", "nan"}, "--budget-ms"},
        WrongUse{{"sweep", "shading", "--budget-ms", "inf"}, "--budget-ms"},
        WrongUse{{"sweep", "shading", "--max-error", "-1"}, "--max-error"}, WrongUse{{"plan"}, "TARGET"},
        WrongUse{{"plan", "nosuch"}, "10_shading"}, WrongUse{{"plan", "nosuch.glb"}, "nosuch.glb"},
        WrongUse{{"plan", "shading", "extra"}, "extra"},
        WrongUse{{"plan", "shading", "--graph", "--json"}, "--graph"},
        WrongUse{{"stress", "nosuch"}, "10_shading"}, WrongUse{{"stress", "shading", "--nosuch"}, "--nosuch"},
        WrongUse{{"compare"}, "A"}, WrongUse{{"compare", "a.png"}, "B"},
        WrongUse{{"compare", "a.png", "b.png", "--metric", "nosuch"}, "flip"}),
    [](const testing::TestParamInfo<WrongUse>& tested) {
        std::string name = std::to_string(tested.index);
        for (const std::string& word : tested.param.words)
            for (const char c : word.substr(0, 20))
                name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
        return name;
    });

TEST_F(Program, WithoutADisplayAWindowIsExitStatusThree) {
    EXPECT_TRUE(failedWith(call({"run", "shading", "--backend", "window"}), 3, "display"));
}

TEST_F(Program, WithoutItsShadersIsExitStatusThree) {
    EXPECT_TRUE(
        failedWith(call(drawingSmall({"run", "shading"}), {"QUINCUNX_ROOT=" + folder_.path().string()}), 3,
                   "QUINCUNX_ROOT"));
    EXPECT_THAT(leftBehind(), IsEmpty());
}

TEST_F(Program, WithoutADisplayDrawsIntoOut) {
    const ProcessResult result = call({"run", "shading", "--size", "64x48"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_THAT(result.out, AllOf(HasSubstr("out/10_shading.png"), HasSubstr("64x48"), HasSubstr(" ms"),
                                  HasSubstr("triangles")));
    EXPECT_THAT(leftBehind(), testing::ElementsAre("out", "out/10_shading.png"));
}

TEST_F(Program, AClosedPipeEndsItQuietly) {
    const ProcessResult result =
        callInShell("{ sleep 0.2; \"$@\"; echo $? >status; } | :; sleep 0.5", {"list"});
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_EQ(readFile(folder_ / "status", 10), "0\n");
}

TEST_F(Program, AFullDiskBehindStdoutIsExitStatusTwo) {
    for (const char* verb : {"list", "--help"}) {
        ProcessOptions full = options();
        full.out = "/dev/full";
        EXPECT_TRUE(failedWith(runProcess(command({verb}), full), 2, "standard output")) << verb;
    }
}

/// Libraries that the dynamic linker opens while the program runs.
class ProgramLoading : public Program {
  protected:
    std::string librariesOf(std::vector<std::string> words) const {
        const ProcessResult result = call(std::move(words), {"LD_DEBUG=files"});
        EXPECT_TRUE(result.exitStatus == 0 || result.exitStatus == 1) << result.text();
        return result.err;
    }
};

TEST_F(ProgramLoading, OfOpenImageIoIsLeftToThoseWhoReadOrWritePictures) {
    const std::string library = "libOpenImageIO.so";
    EXPECT_THAT(librariesOf({"list"}), AllOf(HasSubstr("libc.so"), Not(HasSubstr(library))));
    EXPECT_THAT(librariesOf({"run", "shading", "--help"}), Not(HasSubstr(library)));
    EXPECT_THAT(librariesOf({"ask", "37", "--backend", "osmesa"}), Not(HasSubstr(library)));
    EXPECT_THAT(librariesOf(drawingSmall({"run", "shading"})), HasSubstr(library));
}

TEST_F(ProgramLoading, OfDriversIsLeftToThoseWhoDraw) {
    EXPECT_THAT(librariesOf({"list"}), AllOf(Not(HasSubstr("libOSMesa")), Not(HasSubstr("libEGL.so"))));
    EXPECT_THAT(librariesOf(drawingSmall({"run", "shading"})), HasSubstr("libOSMesa"));
}

TEST_F(Program, SwitchesNeedNoValueWhateverFollows) {
    const auto mirrored = [&](std::vector<std::string> words) {
        words.insert(words.end(), {"--json"});
        return call(drawingSmall(words)).out;
    };
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"run", "shading", "--mirror"},
                                               {"run", "--mirror", "shading"},
                                               {"run", "shading", "--mirror", "on"}})
        EXPECT_THAT(mirrored(words), testing::HasSubstr("\"mirror\": \"on\""));
    EXPECT_THAT(mirrored({"run", "shading", "--mirror", "off"}), testing::HasSubstr("\"mirror\": \"off\""));
}

TEST_F(Program, EndsWithItsStatusWhereStderrIsClosedOrFull) {
    for (const char* script : {"\"$@\" 2>&-", "\"$@\" 2>/dev/full"})
        EXPECT_EQ(callInShell(script, {"run", "shading", "--shear=9"}).exitStatus, 2) << script;
}

TEST_F(Program, TellsTwoLabsApart) {
    EXPECT_TRUE(failedWith(call({"run", "foo", "--seed", "10"}), 2, "foo"));
}

}  // namespace
}  // namespace quincunx::test

// ./quincunx, on machines made of stand-ins for the tools it calls; each stand-in notes its words.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using test::Process;
using test::ProcessOptions;
using test::ProcessResult;
using test::runProcess;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class Script : public testing::Test {
  protected:
    Script() {
        for (const char* made : {"bin", "installed", "tree/cmake", "tree/common", "tree/labs"})
            fs::create_directories(folder_ / made);
        for (const char* tool : {"sh", "readlink", "find", "sed", "grep", "env", "mkdir", "flock", "tail",
                                 "mv", "cat", "sleep", "chmod", "touch"})
            fs::create_symlink(systemTool(tool), folder_ / "bin" / tool);
        fs::copy_file(fs::path(QUINCUNX_SOURCE_DIR) / "quincunx", folder_ / "tree/quincunx");
        folder_.file("tree/CMakeLists.txt", "");
        folder_.file("tree/CMakePresets.json", "");
        folder_.file("tree/cmake/module.cmake", "");
        folder_.file("tree/labs/lab.cpp", "");
        folder_.file("tree/common/source.cpp", "");
        standIn("id", "echo 0");
        standIn("nproc", "echo 2");
        standIn("c++", "");
        standIn("dpkg", note);
        standIn("dpkg-query",
                "for word; do [ ! -e \"$MACHINE/installed/$word\" ] || echo \"installed $word\"; done");
        standIn("apt-get", std::string(note) + installPackages);
        standIn("cmake", std::string(note) + ": >\"$MACHINE/tree/build/release/build.ninja\"");
        standIn("ninja", std::string(note) + buildProgram);
        standIn("ctest", std::string(note) + "echo '100% tests passed'");
    }

    static constexpr const char* note = "echo \"${0##*/} $*\" >>\"$MACHINE/calls\"\n";
    static constexpr const char* installPackages =
        "[ \"$1\" = install ] || exit 0\n"
        "for word; do touch \"$MACHINE/installed/$word\"; done\n";
    static constexpr const char* buildProgram =
        "mkdir -p \"$MACHINE/tree/build/release/bin\"\n"
        "program=$MACHINE/tree/build/release/bin/quincunx\n"
        "echo 'echo \"program $*\"; [ \"$1\" != fail ] || exit 7' >\"$program.new\"\n"
        "sed -i '1i#!/bin/sh' \"$program.new\" && chmod +x \"$program.new\" && mv \"$program.new\" "
        "\"$program\"\n";

    static fs::path systemTool(const char* name) {
        for (const char* place : {"/usr/bin", "/bin"})
            if (fs::exists(fs::path(place) / name))
                return fs::path(place) / name;
        ADD_FAILURE() << name << " is not installed";
        return {};
    }

    void standIn(const std::string& name, const std::string& script) {
        const fs::path file = folder_.file("bin/" + name, "#!/bin/sh\n" + script + "\n");
        fs::permissions(file, fs::perms::owner_all);
    }

    ProcessOptions options(const fs::path& from = {}) const {
        return {.folder = from.empty() ? folder_.path() : from,
                .environment = {"PATH=" + (folder_ / "bin").string(), "MACHINE=" + folder_.path().string()},
                .out = {}};
    }
    std::vector<std::string> command(std::vector<std::string> words) const {
        words.insert(words.begin(), (folder_ / "tree/quincunx").string());
        return words;
    }
    ProcessResult call(std::vector<std::string> words) const {
        return runProcess(command(std::move(words)), options());
    }

    /// The tools called since the last question, with their words.
    std::vector<std::string> calls() {
        std::vector<std::string> result;
        if (fs::exists(folder_ / "calls")) {
            std::istringstream lines(readFile(folder_ / "calls", 1 << 20));
            for (std::string line; std::getline(lines, line);)
                result.push_back(line);
            fs::remove(folder_ / "calls");
        }
        return result;
    }

    TemporaryFolder folder_;
};

TEST_F(Script, OnAFreshMachineInstallsConfiguresBuildsAndRuns) {
    const ProcessResult result = call({"run", "shading", "--size", "8x8"});
    EXPECT_EQ(result.exitStatus, 0) << result.text();
    EXPECT_EQ(result.out, "program run shading --size 8x8\n");
    EXPECT_THAT(result.err, StartsWith("quincunx: missing packages: g++ cmake ninja-build"));
    EXPECT_THAT(calls(),
                ElementsAre("dpkg --configure -a",
                            testing::AllOf(StartsWith("apt-get install --yes"),
                                           HasSubstr(" libopenimageio-dev "), Not(HasSubstr("libgmock-dev"))),
                            StartsWith("cmake "), HasSubstr(" programs")));
}

TEST_F(Script, OnASetUpMachineCallsNothingButTheProgram) {
    call({"list"});
    calls();
    const ProcessResult result = call({"list", "--json"});
    EXPECT_EQ(result.out, "program list --json\n");
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_THAT(calls(), IsEmpty());
}

TEST_F(Script, PassesTheProgramsExitStatusOn) {
    EXPECT_EQ(call({"fail"}).exitStatus, 7);
}

TEST_F(Script, BuildsAgainWhenASourceChangesAppearsOrGoes) {
    call({"list"});
    calls();
    folder_.file("tree/common/source.cpp", "changed");
    call({"list"});
    EXPECT_THAT(calls(), ElementsAre(StartsWith("ninja ")));
    folder_.file("tree/labs/99_new/lab.cpp", "");
    call({"list"});
    EXPECT_THAT(calls(), ElementsAre(StartsWith("ninja ")));
    fs::remove_all(folder_ / "tree/labs/99_new");
    call({"list"});
    EXPECT_THAT(calls(), ElementsAre(StartsWith("ninja ")));
    call({"list"});
    EXPECT_THAT(calls(), IsEmpty());
}

TEST_F(Script, InstallsOnlyWhatIsMissing) {
    call({"list"});
    calls();
    fs::remove(folder_ / "installed/libfmt-dev");
    folder_.file("tree/common/source.cpp", "changed");
    EXPECT_THAT(call({"list"}).err, HasSubstr("missing packages: libfmt-dev\n"));
    EXPECT_THAT(calls(), Not(testing::Contains(HasSubstr("g++"))));
}

TEST_F(Script, BringsPackageListsUpToDateOnlyWhenTheyAreTooOld) {
    standIn("apt-get", std::string(note) +
                           "if [ $1 = update ]; then touch \"$MACHINE/fresh\"; exit; fi\n"
                           "[ -e \"$MACHINE/fresh\" ] || exit 100\n" +
                           installPackages);
    EXPECT_EQ(call({"list"}).exitStatus, 0);
    EXPECT_THAT(calls(),
                ElementsAre(StartsWith("dpkg"), StartsWith("apt-get install"), StartsWith("apt-get update"),
                            StartsWith("apt-get install"), StartsWith("cmake"), StartsWith("ninja")));
}

TEST_F(Script, UsesSudoOnlyAsAnOrdinaryUser) {
    standIn("sudo", std::string(note) + "\"$@\"");
    EXPECT_EQ(call({"list"}).exitStatus, 0);
    EXPECT_THAT(calls(), Not(testing::Contains(StartsWith("sudo"))));
    fs::remove_all(folder_ / "tree/build");
    fs::remove(folder_ / "installed/cmake");
    standIn("id", "echo 1000");
    EXPECT_EQ(call({"list"}).exitStatus, 0);
    EXPECT_THAT(calls(), testing::Contains(testing::AllOf(StartsWith("sudo"), HasSubstr(" cmake"))));
}

TEST_F(Script, WithoutRootOrSudoListsThePackagesAndExitsWithThree) {
    standIn("id", "echo 1000");
    const ProcessResult result = call({"list"});
    EXPECT_EQ(result.exitStatus, 3);
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, HasSubstr("apt-get install --no-install-recommends g++ cmake"));
    EXPECT_THAT(calls(), IsEmpty());
}

TEST_F(Script, WhenSudoRefusesListsThePackagesAndExitsWithThree) {
    standIn("id", "echo 1000");
    standIn("sudo", "echo 'a password is required' >&2; exit 1");
    const ProcessResult result = call({"list"});
    EXPECT_EQ(result.exitStatus, 3);
    EXPECT_THAT(result.err, HasSubstr("a password is required"));
    EXPECT_THAT(result.err, HasSubstr("apt-get install --no-install-recommends g++ cmake"));
}

TEST_F(Script, ElsewhereThanOnDebianGoesOnWithTheToolsThereAre) {
    fs::remove(folder_ / "bin/apt-get");
    EXPECT_EQ(call({"list"}).out, "program list\n");
    fs::remove_all(folder_ / "tree/build");
    fs::remove(folder_ / "bin/c++");
    const ProcessResult result = call({"list"});
    EXPECT_EQ(result.exitStatus, 3);
    EXPECT_THAT(result.err, HasSubstr("g++ cmake ninja-build"));
}

TEST_F(Script, ShowsTheLogOfAFailedBuildAndBuildsAgainTheNextTime) {
    standIn("ninja", "echo 'source.cpp:1: error'; exit 1");
    const ProcessResult failed = call({"list"});
    EXPECT_EQ(failed.exitStatus, 2);
    EXPECT_THAT(failed.err, HasSubstr("source.cpp:1: error"));
    EXPECT_THAT(failed.out, IsEmpty());
    standIn("ninja", std::string(note) + buildProgram);
    EXPECT_EQ(call({"list"}).out, "program list\n");
}

TEST_F(Script, StartsAfreshWhereConfiguringFailsOnWhatWasLeft) {
    standIn("cmake", std::string(note) +
                         "case \"$*\" in *--fresh*) touch \"$MACHINE/tree/build/release/build.ninja\" ;;"
                         " *) exit 1 ;; esac");
    EXPECT_EQ(call({"list"}).exitStatus, 0);
    EXPECT_THAT(calls(), testing::Contains(HasSubstr("--fresh")));
}

TEST_F(Script, PicksUpABuildThatWasKilled) {
    standIn("ninja", "echo started >\"$MACHINE/started\"; sleep 60");
    Process killed(command({"list"}), options());
    while (!fs::exists(folder_ / "started"))
        ASSERT_EQ(kill(killed.id(), 0), 0);
    kill(-killed.id(), SIGKILL);
    EXPECT_EQ(killed.wait().signal, SIGKILL);
    standIn("ninja", std::string(note) + buildProgram);
    EXPECT_EQ(call({"list"}).out, "program list\n");
    EXPECT_THAT(calls(), testing::Contains(StartsWith("ninja")));
}

TEST_F(Script, BuildsOnceWhenTwoCallsComeAtTheSameTime) {
    standIn("ninja", std::string(note) + "sleep 0.5\n" + buildProgram);
    Process first(command({"first"}), options());
    Process second(command({"second"}), options());
    EXPECT_EQ(first.wait().out, "program first\n");
    EXPECT_EQ(second.wait().out, "program second\n");
    const std::vector<std::string> all = calls();
    EXPECT_EQ(
        std::count_if(all.begin(), all.end(), [](const std::string& c) { return c.rfind("ninja", 0) == 0; }),
        1);
}

TEST_F(Script, WorksFromOtherFoldersAndThroughLinks) {
    fs::create_symlink("../tree/quincunx", folder_ / "bin/link");
    EXPECT_EQ(runProcess({"../bin/link", "list"}, options(folder_ / "installed")).out, "program list\n");
    EXPECT_EQ(runProcess({"sh", "quincunx", "list"}, options(folder_ / "tree")).out, "program list\n");
}

TEST_F(Script, TestInstallsMoreBuildsAllAndHandsItsWordsToCtest) {
    const ProcessResult result = call({"test", "-R", "flip"});
    EXPECT_EQ(result.exitStatus, 0) << result.text();
    EXPECT_THAT(result.out, HasSubstr("100% tests passed"));
    EXPECT_THAT(calls(), ElementsAre(StartsWith("dpkg"), HasSubstr(" libgmock-dev "),
                                     HasSubstr("QUINCUNX_BUILD_TESTS=ON"), HasSubstr(" all"),
                                     testing::AllOf(StartsWith("ctest"), HasSubstr(" -R flip"))));
    standIn("ctest", "exit 8");
    EXPECT_EQ(call({"test"}).exitStatus, 1);
}

TEST_F(Script, HelpIsTheProgramsAndNamesTest) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{}, {"--help"}}) {
        const ProcessResult result = call(words);
        EXPECT_EQ(result.exitStatus, 0);
        EXPECT_THAT(result.out, testing::AllOf(StartsWith("program --help\n"), HasSubstr("\n  test ")));
    }
}

}  // namespace
}  // namespace quincunx

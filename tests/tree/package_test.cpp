// The installed library: others build on it, and a lab is added to a tree by making a folder.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using test::ProcessResult;
using test::runProcess;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

class Package : public testing::Test {
  protected:
    const fs::path source_ = fs::path(QUINCUNX_SOURCE_DIR);
    const TemporaryFolder folder_;
    const fs::path prefix_ = folder_ / "prefix";
    const fs::path tree_ = folder_ / "tree";
    const fs::path build_ = folder_ / "build";

    ProcessResult call(std::vector<std::string> words) const {
        return runProcess(std::move(words),
                          {.folder = folder_.path(),
                           .environment = {"QUINCUNX_ROOT=" + (prefix_ / "share/quincunx").string()},
                           .out = {},
                           .timeout = std::chrono::seconds(300)});
    }
    void succeed(std::vector<std::string> words) const {
        const ProcessResult result = call(words);
        ASSERT_EQ(result.exitStatus, 0) << fmt::format("{}", fmt::join(words, " ")) << '\n' << result.text();
    }
    void addLab(const std::string& name) const {
        fs::copy(source_ / "tests/tree/consumer/probe", tree_ / "labs" / name);
    }
};

TEST_F(Package, IsBuiltUponAndALabIsAddedByMakingAFolder) {
    succeed({CMAKE_PROGRAM, "--install", QUINCUNX_BINARY_DIR, "--prefix", prefix_.string()});

    // The tree's own labs/CMakeLists.txt and program, with another lab in place of the tree's.
    fs::create_directories(tree_ / "labs");
    for (const char* file : {"CMakeLists.txt", "main.cpp"})
        fs::copy_file(source_ / "tests/tree/consumer" / file, tree_ / file);
    for (const char* file : {"CMakeLists.txt", "all_labs.h"})
        fs::copy_file(source_ / "labs" / file, tree_ / "labs" / file);
    fs::copy(source_ / "labs/quincunx", tree_ / "labs/quincunx");
    addLab("98_other");
    succeed({CMAKE_PROGRAM, "-G", "Ninja", "-S", tree_.string(), "-B", build_.string(),
             "-DCMAKE_PREFIX_PATH=" + prefix_.string(), "-DCMAKE_BUILD_TYPE=Debug",
             "-DCMAKE_CXX_FLAGS=" QUINCUNX_CONSUMER_FLAGS});
    succeed({CMAKE_PROGRAM, "--build", build_.string()});
    EXPECT_EQ(call({build_ / "bin/consumer"}).exitStatus, 2);

    const std::string program = build_ / "bin/quincunx";
    EXPECT_THAT(call({program, "list"}).out, Not(HasSubstr("99_probe")));
    addLab("99_probe");
    succeed({CMAKE_PROGRAM, "--build", build_.string()});
    EXPECT_THAT(call({program, "list"}).out, HasSubstr("99_probe"));

    const auto draw = [&](const std::string& drawer, std::vector<std::string> words) {
        words.insert(words.begin(), drawer);
        words.insert(words.end(), {"--size", "16x8", "--backend", "osmesa"});
        succeed(words);
    };
    draw(program, {"run", "probe", "--out", "black.png"});
    draw(program, {"run", "99", "--grey=1", "--out", "white.png"});
    draw(build_ / "bin/99_probe", {"--grey=1", "--out", "own_program.png"});
    EXPECT_THAT(call({program, "compare", "black.png", "white.png", "--metric", "rmse"}).out,
                HasSubstr("rmse 0.866025"));  // √¾: the alpha of both is 1
    EXPECT_THAT(call({program, "compare", "own_program.png", "white.png", "--metric", "rmse"}).out,
                HasSubstr("rmse 0.000000"));
}

TEST_F(Package, InstalledProgramsDrawWithTheInstalledShadersAndModules) {
    succeed({CMAKE_PROGRAM, "--install", QUINCUNX_BINARY_DIR, "--prefix", prefix_.string()});
    succeed(
        {prefix_ / "bin/quincunx", "run", "10", "--size", "32x24", "--backend", "osmesa", "--out", "a.png"});
    succeed({prefix_ / "bin/10_shading", "--size", "32x24", "--backend", "osmesa", "--out", "b.png"});
    EXPECT_THAT(call({prefix_ / "bin/quincunx", "compare", "a.png", "b.png", "--metric", "rmse"}).out,
                HasSubstr("rmse 0.000000"));
}

}  // namespace
}  // namespace quincunx

// The verbs of instructors, called as people and batch systems call them.

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "tests/program/program.h"

namespace quincunx::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class ProgramGrade : public Program {
  protected:
    void submit(const std::string& name) {
        std::filesystem::create_directories(folder_ / "class");
        ASSERT_TRUE(succeeded(call({"run", "shading", "--size", "96x64", "--backend", "osmesa", "--out",
                                    "class/" + name + ".png"})));
    }
    std::string table(const char* file) { return readFile(folder_ / file, 1 << 20); }
};

TEST_F(ProgramGrade, WrongUseIsToldInOneLine) {
    folder_.file("class/a.txt", "x");
    EXPECT_TRUE(failedWith(call({"grade"}), 2, "no submissions given"));
    EXPECT_TRUE(failedWith(call({"grade", "class"}), 2, "--lab"));
    EXPECT_TRUE(failedWith(call({"grade", "class", "--lab", "nothing"}), 2, "nothing"));
    EXPECT_TRUE(failedWith(call({"grade", "nowhere", "--lab", "shading"}), 2, "nowhere"));
    EXPECT_TRUE(failedWith(call({"grade", "class", "--lab", "shading", "--rubric", "class/a.txt"}), 2,
                           "class/a.txt"));
    EXPECT_TRUE(failedWith(call({"grade", "class", "--lab", "shading"}, {"SLURM_ARRAY_TASK_ID=5"}), 2,
                           "SLURM_ARRAY_TASK_COUNT"));
    EXPECT_TRUE(failedWith(call({"grade", "--merge", "nowhere"}), 2, "nowhere"));
    EXPECT_TRUE(failedWith(call({"handout", "path_tracing"}), 2, "27_path_tracing"));
    EXPECT_THAT(call({"--help"}).out,
                testing::AllOf(HasSubstr("grade"), HasSubstr("handout"), Not(HasSubstr("grade-worker"))));
}

TEST_F(ProgramGrade, ShardsOfABatchSystemAreMergedToTheSameTable) {
    for (const char* name : {"ada", "bob", "eve"})
        submit(name);
    const ProcessResult whole =
        call({"grade", "class", "--lab", "shading", "--backend", "osmesa", "--out", "whole", "--json"});
    ASSERT_TRUE(succeeded(whole));
    const json said = json::parse(whole.out);
    EXPECT_EQ(said.at("submissions"), 3);
    EXPECT_EQ(said.at("mean"), 100);
    for (const char* index : {"1", "2"}) {
        const ProcessResult shard =
            call({"grade", "class", "--lab", "shading", "--backend", "osmesa", "--out", "parts"},
                 {std::string("CI_NODE_INDEX=") + index, "CI_NODE_TOTAL=2"});
        ASSERT_TRUE(succeeded(shard));
        EXPECT_THAT(shard.out, HasSubstr("--merge"));
    }
    ASSERT_TRUE(succeeded(call({"grade", "--merge", "--out", "parts"})));
    for (const char* file : {"grades.csv", "grades.json", "index.html", "lms/canvas.csv"})
        EXPECT_EQ(table((std::string("whole/") + file).c_str()),
                  table((std::string("parts/") + file).c_str()))
            << file;
}

TEST_F(ProgramGrade, HandoutIsAShaderWithItsTask) {
    const ProcessResult made = call({"handout", "shadow_maps", "--out", "starter"});
    ASSERT_TRUE(succeeded(made));
    EXPECT_THAT(table("starter/phong_shadowed.frag"),
                testing::AllOf(HasSubstr("// TASK:"),
                               Not(HasSubstr("litShare(position, triangleNormal(position, n)) : 1.0"))));
    EXPECT_THAT(table("starter/TASK.md"), HasSubstr("The share of a light"));
}

}  // namespace
}  // namespace quincunx::test

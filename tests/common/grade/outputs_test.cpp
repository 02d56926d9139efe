// Tables that spreadsheets and learning platforms read.

#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "grade/grade.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::grade {
namespace {

using quincunx::test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

TEST(CsvFields, AreNeverFormulas) {
    EXPECT_EQ(csvField("plain"), "plain");
    EXPECT_EQ(csvField("a,b \"c\""), "\"a,b \"\"c\"\"\"");
    EXPECT_EQ(csvField("two\nlines\r"), "two lines ");
    for (const char* formula : {"=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "  =1", "|calc", "%0"})
        EXPECT_EQ(csvField(formula).front(), '\'') << formula;
    EXPECT_EQ(csvField("=HYPERLINK(\"x\",\"y\")"), "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\"");
}

Record recordOf(const std::string& student, const std::string& id, Platform platform, double points) {
    Record record;
    record.student = student;
    record.id = id;
    record.platform = platform;
    record.key = digest(student);
    Part part;
    part.kind = "screenshot";
    part.file = "<b>shot</b>.png";
    part.lines.push_back({"the shadows", points, points, 10, points < 10 ? "missing" : ""});
    record.parts.push_back(part);
    return record;
}

class Outputs : public testing::Test {
  protected:
    void write(bool anonymous) {
        Class graded{"16_shadow_maps", "shadow maps", {}, {}};
        graded.rubric.title = "Shadows";
        graded.records = {recordOf("<script>alert(1)</script>", "12", Platform::moodle, 5),
                          recordOf("=1+1", "4711", Platform::canvas, 10)};
        graded.records[1].faults.push_back("../up: refused");
        writeOutputs(graded, folder_.path(), anonymous);
    }
    std::string read(const char* name) { return readFile(folder_ / name, 1 << 20); }

    TemporaryFolder folder_;
};

TEST_F(Outputs, AreTheTablesOfThePlatforms) {
    write(false);
    EXPECT_THAT(read("grades.csv"), HasSubstr("<script>alert(1)</script>,12,,50.00,100.00,50.00,,the "
                                              "shadows: 5.0 of 10.0 points: missing\r\n"));
    EXPECT_THAT(read("lms/canvas.csv"), HasSubstr("Student,ID,SIS User ID,SIS Login ID,Section,Shadows\r\n"));
    EXPECT_THAT(read("lms/canvas.csv"), HasSubstr("'=1+1,4711,,,,100.00\r\n"));
    EXPECT_THAT(read("lms/moodle.csv"), HasSubstr("Participant 12,<script>alert(1)</script>,50.00,100.00,"));
    const Json results = Json::parse(read(("lms/gradescope/" + digest("=1+1") + "/results.json").c_str()));
    EXPECT_EQ(results.at("score"), 100);
    EXPECT_EQ(results.at("tests").at(0).at("max_score"), 100);
}

TEST_F(Outputs, EscapeNamesInTheReport) {
    write(false);
    EXPECT_THAT(read("index.html"), HasSubstr("&lt;script&gt;alert(1)"));
    EXPECT_THAT(read("index.html"), Not(HasSubstr("<script>alert")));
    EXPECT_THAT(read(("students/" + digest("<script>alert(1)</script>") + ".html").c_str()),
                HasSubstr("&lt;b&gt;shot"));
}

TEST_F(Outputs, NeedNothingFromAnywhereElse) {
    write(false);
    for (const char* elsewhere : {"src=\"http", "href=\"http", "src=\"//", "href=\"//"})
        EXPECT_THAT(read("index.html"), Not(HasSubstr(elsewhere)));
}

TEST_F(Outputs, HoldNoNamesWhereTheyAreAnonymous) {
    write(true);
    for (const char* name : {"grades.csv", "grades.json", "index.html"}) {
        EXPECT_THAT(read(name), Not(HasSubstr("alert"))) << name;
        EXPECT_THAT(read(name), Not(HasSubstr("4711"))) << name;
        EXPECT_THAT(read(name), HasSubstr("Student 00")) << name;
    }
    EXPECT_THAT(read("lms/canvas.csv"), HasSubstr("4711"));
}

TEST(Shards, AreWhatBatchSystemsSay) {
    const auto shard = [](std::initializer_list<std::pair<const char*, const char*>> variables) {
        for (const auto& [name, value] : variables)
            setenv(name, value, 1);
        std::optional<Shard> result;
        std::exception_ptr failure;
        try {
            result = shardFromEnvironment();
        } catch (...) {
            failure = std::current_exception();
        }
        for (const auto& [name, value] : variables)
            unsetenv(name);
        if (failure)
            std::rethrow_exception(failure);
        return result ? std::pair(result->index, result->count) : std::pair<std::size_t, std::size_t>(0, 0);
    };
    using testing::Pair;
    EXPECT_THAT(shard({}), Pair(0, 0));
    EXPECT_THAT(shard({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_COUNT", "4"}}), Pair(2, 4));
    EXPECT_THAT(shard({{"SLURM_ARRAY_TASK_ID", "7"},
                       {"SLURM_ARRAY_TASK_MIN", "1"},
                       {"SLURM_ARRAY_TASK_STEP", "3"},
                       {"SLURM_ARRAY_TASK_COUNT", "4"}}),
                Pair(2, 4));
    EXPECT_THAT(shard({{"JOB_COMPLETION_INDEX", "0"}, {"QUINCUNX_SHARDS", "3"}}), Pair(0, 3));
    EXPECT_THAT(shard({{"CI_NODE_INDEX", "2"}, {"CI_NODE_TOTAL", "2"}}), Pair(1, 2));
    EXPECT_THAT(shard({{"CI_NODE_INDEX", "1"}, {"CI_NODE_TOTAL", "1"}}), Pair(0, 0));
    EXPECT_THROW(shard({{"SLURM_ARRAY_TASK_ID", "9"}, {"SLURM_ARRAY_TASK_COUNT", "4"}}), InputError);
    EXPECT_THROW(shard({{"CI_NODE_INDEX", "x"}, {"CI_NODE_TOTAL", "2"}}), InputError);
    EXPECT_THROW(shard({{"JOB_COMPLETION_INDEX", "1"}}), InputError);
}

}  // namespace
}  // namespace quincunx::grade

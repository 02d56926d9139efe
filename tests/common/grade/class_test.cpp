// Classes as they are handed in: right, wrong, broken and hostile.

#include "tests/common/grade/class_test.h"

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace quincunx::grade {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Class = test::ClassTest;

double pointsOf(const Record& record) {
    return record.points(100);
}

TEST_F(Class, IsScoredWithAReasonForEveryLostPoint) {
    submit("right.png", {});
    submit("smoother.png", {{"supersample", "4"}});
    submit("no_record.png", {}, false);
    submit("no_highlight.png", {{"specular", "off"}});
    submit("wrong_light.png", {{"light-turn", "90"}}, false);
    camera_ = studio_.frame(*lab_, 96, 64).camera;
    camera_->worldFromCamera[3] += glm::vec4(0.3F, 0.2F, 0.4F, 0);
    submit("from_the_side.png", {});
    camera_->worldFromCamera[0] *= -1.0F;  // looks the other way
    camera_->worldFromCamera[2] *= -1.0F;
    submit("looks_away.png", {});
    const Summary summary = gradeClass(entry_, options());
    EXPECT_EQ(summary.submissions, 7u);
    EXPECT_EQ(summary.faulty, 0u);
    const auto records = recordsOf(options());
    EXPECT_EQ(pointsOf(records.at("right")), 100);
    EXPECT_TRUE(records.at("right").parts.at(0).exact);
    EXPECT_EQ(pointsOf(records.at("smoother")), 100);
    EXPECT_EQ(pointsOf(records.at("no_record")), 100);
    EXPECT_EQ(pointsOf(records.at("from_the_side")), 100);
    // What a record claims of the task's own knobs gains nothing: the highlights' 20 points are lost.
    const Record& noHighlight = records.at("no_highlight");
    EXPECT_LE(pointsOf(noHighlight), 80);
    EXPECT_THAT(noHighlight.reasons(), Contains(HasSubstr("the highlights: 0.0 of 20.0 points: missing")));
    EXPECT_THAT(noHighlight.parts.at(0).remarks,
                Contains(HasSubstr("--specular=off, where the task has on")));
    EXPECT_LE(pointsOf(records.at("wrong_light")), 60);
    // A camera that hides everything is not followed.
    EXPECT_LE(pointsOf(records.at("looks_away")), 40);
    EXPECT_THAT(records.at("looks_away").parts.at(0).remarks, Contains(HasSubstr("camera hides")));
    for (const auto& [student, record] : records)
        EXPECT_TRUE(pointsOf(record) == 100 || !record.reasons().empty()) << student;
}

/// The header of a PNG that claims a size, and nothing after it but its end.
std::string pngOfSize(const std::string& good, std::uint32_t width, std::uint32_t height) {
    std::string bytes = good;
    for (int i = 0; i < 4; ++i) {
        bytes[16 + static_cast<std::size_t>(i)] = static_cast<char>(width >> (24 - 8 * i));
        bytes[20 + static_cast<std::size_t>(i)] = static_cast<char>(height >> (24 - 8 * i));
    }
    return bytes;
}

TEST_F(Class, LosesOnlyTheSubmissionsThatAreBroken) {
    submit("right.png", {});
    const std::string good = readFile(folder_ / "class/right.png", 1 << 20);
    submitText("truncated.png", good.substr(0, good.size() / 2));
    submitText("wide.png", pngOfSize(good, 60000, 1));
    submitText("huge.png", pngOfSize(good, 60000, 60000));
    submitText("larger.png", pngOfSize(good, 4000, 4000));
    submitText("empty.png", "");
    submitText("text.png", "not a picture");
    submitText("notes.txt", "I could not do it");
    submitText("broken.zip", "PK\x03\x04 and no more");
    submitText("both/a.png", good);
    submitText("both/torn.png", good.substr(0, 100));
    fs::create_directory(folder_ / "class/nothing");
    fs::create_symlink("/etc/passwd", folder_ / "class/link.png");
    submitText("new\nline \"quoted\" <b>&.png", good);
    std::string noise = good;
    for (std::size_t i = 60; i < noise.size(); i += 3)
        noise[i] = static_cast<char>(noise[i] ^ 0x55);
    submitText("noise.png", noise);
    gradeClass(entry_, options());
    const auto records = recordsOf(options());
    EXPECT_EQ(records.size(), 14u);
    for (const char* whole : {"right", "both", "new\nline \"quoted\" <b>&"})
        EXPECT_EQ(pointsOf(records.at(whole)), 100) << whole;
    for (const char* broken : {"truncated", "wide", "huge", "larger", "empty", "text", "notes", "broken",
                               "nothing", "link", "noise"}) {
        EXPECT_EQ(pointsOf(records.at(broken)), 0) << broken;
        EXPECT_THAT(records.at(broken).reasons(), testing::Not(IsEmpty())) << broken;
    }
    EXPECT_THAT(records.at("truncated").faults, ElementsAre(HasSubstr("ends early")));
    EXPECT_THAT(records.at("huge").faults, ElementsAre(HasSubstr("60000×60000 pixels")));
    EXPECT_THAT(records.at("empty").faults, ElementsAre(HasSubstr("empty")));
    EXPECT_THAT(records.at("link").faults, ElementsAre(HasSubstr("a link")));
    EXPECT_THAT(records.at("broken").faults, ElementsAre(HasSubstr("cannot be opened")));
    EXPECT_THAT(records.at("nothing").faults, ElementsAre(HasSubstr("no file")));
    EXPECT_THAT(records.at("both").faults, ElementsAre(HasSubstr("torn.png")));
}

TEST_F(Class, GoesOnWhereItWasKilledAndEndsWithTheSameBytes) {
    for (int i = 0; i < 12; ++i)
        submit("student" + std::to_string(i) + ".png", {{"light-turn", std::to_string(5 * i)}});
    gradeClass(entry_, options("whole"));
    const std::vector<std::string> words = {QUINCUNX_PROGRAM,
                                            "grade",
                                            (folder_ / "class").string(),
                                            "--lab",
                                            "shading",
                                            "--backend",
                                            "osmesa",
                                            "--jobs",
                                            "1",
                                            "--out",
                                            (folder_ / "killed").string()};
    const auto recordsDone = [&] {
        std::error_code error;
        std::size_t count = 0;
        for (const auto& entry : fs::directory_iterator(folder_ / "killed/journal", error))
            count += entry.path().filename().string().front() != '.' ? 1 : 0;
        return count;
    };
    quincunx::test::Process process(words);
    for (int i = 0; i < 2000 && recordsDone() < 4; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    process.signal(SIGKILL);
    EXPECT_EQ(process.wait().signal, SIGKILL);
    const std::size_t before = recordsDone();
    EXPECT_GE(before, 4u);
    EXPECT_LT(before, 13u);
    Options again = options("killed");
    const Summary summary = gradeClass(entry_, again);
    EXPECT_LE(summary.done, 9u);
    EXPECT_EQ(outputsOf(folder_ / "whole"), outputsOf(folder_ / "killed"));
    EXPECT_EQ(gradeClass(entry_, again).done, 0u);
}

TEST_F(Class, InShardsEndsWithTheSameBytes) {
    for (int i = 0; i < 7; ++i)
        submit("student" + std::to_string(i) + ".png", {{"light-turn", std::to_string(9 * i)}});
    gradeClass(entry_, options("whole"));
    std::vector<fs::path> folders;
    for (std::size_t i = 0; i < 3; ++i) {
        Options shard = options(("shard" + std::to_string(i)).c_str());
        shard.shard = Shard{i, 3};
        EXPECT_FALSE(gradeClass(entry_, shard).merged);
        folders.push_back(shard.out);
        if (i == 1) {
            EXPECT_THROW(mergeShards(folders, folder_ / "merged", false), InputError);  // one is missing
        }
    }
    const Summary summary = mergeShards(folders, folder_ / "merged", false);
    EXPECT_EQ(summary.submissions, 7u);
    EXPECT_EQ(outputsOf(folder_ / "whole"), outputsOf(folder_ / "merged"));
}

TEST_F(Class, OfAnotherRubricIsGradedAgain) {
    submit("right.png", {});
    gradeClass(entry_, options());
    Options other = options();
    other.rubric = folder_.file("r.toml", "knobs = { specular = \"off\" }");
    EXPECT_EQ(gradeClass(entry_, other).done, 1u);
    EXPECT_LT(pointsOf(recordsOf(other).at("right")), 100);
}

}  // namespace
}  // namespace quincunx::grade

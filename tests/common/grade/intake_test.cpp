// Whose work a folder holds.

#include "grade/intake.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/error.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::grade {
namespace {

namespace fs = std::filesystem;
using quincunx::test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> studentsOf(const std::vector<Submission>& submissions) {
    std::vector<std::string> students;
    for (const Submission& submission : submissions)
        students.push_back(submission.student);
    return students;
}

TEST(Intake, TakesAFileOrAFolderForAStudent) {
    const TemporaryFolder folder;
    folder.file("ada.png", "x");
    folder.file("Bob/shots/one.png", "x");
    folder.file("Bob/phong.frag", "x");
    folder.file(".DS_Store", "x");
    folder.file("__MACOSX/ada.png", "x");
    const std::vector<Submission> submissions = takeIn(folder.path());
    EXPECT_THAT(studentsOf(submissions), ElementsAre("Bob", "ada"));
    EXPECT_THAT(submissions[0].files, SizeIs(2));
    EXPECT_EQ(submissions[0].files[1].name, "shots/one.png");
    EXPECT_THAT(studentsOf(takeIn(folder / "ada.png")), ElementsAre("ada"));
}

TEST(Intake, KnowsTheNamesThatCanvasGives) {
    const TemporaryFolder folder;
    folder.file("doejane_4711_815_shot_2.png", "x");
    folder.file("doejane_4711_816_phong-1.frag", "x");
    folder.file("mu_eller_LATE_12_34_shot.png", "x");
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(studentsOf(submissions), ElementsAre("doejane", "mu_eller"));
    EXPECT_EQ(submissions[0].platform, Platform::canvas);
    EXPECT_EQ(submissions[0].id, "4711");
    EXPECT_EQ(submissions[0].files.at(0).name, "shot_2.png");
    EXPECT_EQ(submissions[0].files.at(1).name, "phong-1.frag");
    EXPECT_TRUE(submissions[1].late);
    EXPECT_FALSE(submissions[0].late);
}

TEST(Intake, KnowsTheNamesThatMoodleGives) {
    const TemporaryFolder folder;
    folder.file("Jane Doe_4711_assignsubmission_file_/shot.png", "x");
    folder.file("José Ño_12_assignsubmission_file_shot.png", "x");
    folder.file("José Ño_12_assignsubmission_file_phong.frag", "x");
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(studentsOf(submissions), ElementsAre("Jane Doe", "José Ño"));
    EXPECT_EQ(submissions[0].id, "4711");
    EXPECT_EQ(submissions[0].files.at(0).name, "shot.png");
    EXPECT_THAT(submissions[1].files, SizeIs(2));
    EXPECT_EQ(submissions[1].files[0].name, "phong.frag");
}

TEST(Intake, KnowsTheNamesThatGradescopeGives) {
    const TemporaryFolder folder;
    folder.file("submission_77/shot.png", "x");
    folder.file("submission_78/shot.png", "x");
    folder.file(
        "submission_metadata.yml",
        "---\nsubmission_77:\n  :submitters:\n  - :name: Ada Lovelace\n    :sid: '1'\n  - :name: 'Bob'\n");
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(studentsOf(submissions), ElementsAre("Ada Lovelace, Bob", "submission_78"));
    EXPECT_EQ(submissions[0].id, "77");
}

TEST(Intake, RefusesLinksAndDevicesByName) {
    const TemporaryFolder folder;
    const fs::path student = folder.file("eve/real.png", "x").parent_path();
    fs::create_symlink("/etc/passwd", student / "link.png");
    fs::create_directory_symlink("/etc", student / "folder");
    ASSERT_EQ(mkfifo((student / "pipe.png").c_str(), 0600), 0);
    fs::create_symlink("/etc/passwd", folder / "mallory.png");
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(studentsOf(submissions), ElementsAre("eve", "mallory"));
    EXPECT_THAT(submissions[0].files, SizeIs(1));
    EXPECT_THAT(submissions[0].faults,
                ElementsAre(HasSubstr("folder: refused: a link"), HasSubstr("link.png: refused: a link"),
                            HasSubstr("pipe.png: refused: no regular file")));
    EXPECT_THAT(submissions[1].files, IsEmpty());
    EXPECT_THAT(submissions[1].faults, ElementsAre(HasSubstr("a link")));
}

TEST(Intake, KeepsApartWhatHasOneName) {
    const TemporaryFolder folder;
    folder.file("ada.png", "x");
    folder.file("ada.jpg", "x");
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(submissions, SizeIs(2));
    EXPECT_NE(submissions[0].key(), submissions[1].key());
}

TEST(Intake, FilesAnyNameUnderHarmlessDigits) {
    const TemporaryFolder folder;
    for (const char* name :
         {"a\nb.png", "\"quoted\".png", "<script>alert(1)<.png", "'; rm.png", "\xff\xfe.png", "=cmd.png"})
        folder.file(name, "x");
    const std::vector<Submission> submissions = takeIn(folder.path());
    EXPECT_THAT(submissions, SizeIs(6));
    for (const Submission& submission : submissions)
        EXPECT_EQ(submission.key().find_first_not_of("0123456789abcdef"), std::string::npos);
}

TEST(Intake, IsBoundedInFilesAndDepth) {
    const TemporaryFolder folder;
    fs::path deep = folder / "deep";
    for (int i = 0; i < 20; ++i)
        deep /= "d";
    fs::create_directories(deep);
    std::ofstream(deep / "x.png") << 'x';
    fs::create_directory(folder / "many");
    for (int i = 0; i < 2100; ++i)
        std::ofstream(folder / fmt::format("many/{:05}.png", i));
    const std::vector<Submission> submissions = takeIn(folder.path());
    ASSERT_THAT(studentsOf(submissions), ElementsAre("deep", "many"));
    EXPECT_THAT(submissions[0].faults, ElementsAre(HasSubstr("too deep")));
    EXPECT_THAT(submissions[1].files, SizeIs(500));
    EXPECT_THAT(submissions[1].faults, testing::Contains(HasSubstr("more than 2000 files")));
}

TEST(Intake, SaysWhatIsWrongWithThePlace) {
    const TemporaryFolder folder;
    EXPECT_THROW(takeIn(folder / "nowhere"), InputError);
    EXPECT_THROW(takeIn("/dev/null"), InputError);
    EXPECT_THAT(takeIn(folder.path()), IsEmpty());
}

}  // namespace
}  // namespace quincunx::grade

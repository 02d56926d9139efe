// Shaders of students, drawn by processes that they may end.

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grade/handout.h"
#include "grade/views.h"
#include "tests/common/grade/class_test.h"

namespace quincunx::grade {
namespace {

using testing::Contains;
using testing::HasSubstr;

class Shaders : public test::ClassTest {
  protected:
    std::string solution() { return solutionOf(lab_->exercise()); }
    /// The solution with this in the place of its last statement but the end.
    std::string with(const std::string& statement) {
        std::string text = solution();
        return text.insert(text.rfind('}'), statement + "\n");
    }
};

TEST_F(Shaders, CostOnlyThemselves) {
    submitText("solution/phong.frag", solution());
    submitText("handout/phong.frag", handoutOf(solution(), "x").text);
    submitText("renamed/my-phong (1).frag", solution());
    submitText("syntax/phong.frag", with("colour = 1;"));
    submitText("outside/phong.frag",
               "#version 330 core\n#include \"../../../../etc/passwd\"\nvoid main() {}\n");
    submitText("empty/phong.frag", "");
    submitText("binary/phong.frag", std::string("#version 330 core\n\0\xff\xfe", 22));
    // Too long for anyone: each pixel for ever, as far as the driver goes.
    submitText("forever/phong.frag", with("int i = 0; while (i >= 0) { for (int k = 0; k < 1000000000; ++k) "
                                          "{ i = (i * 7 + k) % 1000; if (i == -1) "
                                          "return; color.r += sin(float(i)); } }"));
    submitText("large/phong.frag", with("float many[1000000]; for (int i = 0; i < 1000000; ++i) many[i] = "
                                        "float(i) * color.r; color.g = many[int(gl_FragCoord.x) * 1000];"));
    Options graded = options();
    graded.secondsEach = 2;
    gradeClass(entry_, graded);
    const auto records = recordsOf(graded);
    EXPECT_EQ(records.at("solution").points(100), 100);
    EXPECT_EQ(records.at("renamed").points(100), 100);
    EXPECT_LE(records.at("handout").points(100), 30);
    for (const char* broken : {"syntax", "outside", "empty", "binary", "forever"}) {
        EXPECT_EQ(records.at(broken).points(100), 0) << broken;
        EXPECT_FALSE(records.at(broken).reasons().empty()) << broken;
    }
    EXPECT_THAT(records.at("syntax").reasons(), Contains(HasSubstr("phong.frag:")));
    EXPECT_THAT(records.at("outside").reasons(), Contains(HasSubstr("outside shaders/")));
    EXPECT_THAT(records.at("forever").reasons(),
                Contains(HasSubstr("its process was ended: it took more than 2 s of processor time")));
    EXPECT_LT(records.at("large").points(100), 100);
}

TEST_F(Shaders, AndScreenshotsTogetherCountHalfEach) {
    submit("ada/shot.png", {});
    submitText("ada/phong.frag", handoutOf(solution(), "x").text);
    gradeClass(entry_, options());
    const Record record = recordsOf(options()).at("ada");
    ASSERT_EQ(record.parts.size(), 2u);
    EXPECT_DOUBLE_EQ(record.points(100), 50 * (1 + record.parts[1].share()));
}

std::vector<std::string> labsWithAShader() {
    std::vector<std::string> folders;
    for (const LabEntry& entry : allLabs())
        if (!entry.make()->exercise().shader.empty())
            folders.push_back(entry.folder());
    return folders;
}

class HandoutsOf : public testing::TestWithParam<std::string> {};

TEST_P(HandoutsOf, ScoreLowUntouchedAndFullWhenSolved) {
    const LabEntry& entry = findLab(allLabs(), GetParam());
    const Exercise exercise = entry.make()->exercise();
    const quincunx::test::TemporaryFolder folder;
    const std::string name = std::filesystem::path(exercise.shader).filename().string();
    folder.file("class/solution/" + name, solutionOf(exercise));
    folder.file("class/handout/" + name, handoutOf(solutionOf(exercise), name).text);
    Options options;
    options.submissions = folder / "class";
    options.out = folder / "out";
    options.jobs = 1;
    options.backend = gl::Backend::osmesa;
    options.worker = {QUINCUNX_PROGRAM, "grade-worker"};
    gradeClass(entry, options);
    const auto records = test::ClassTest::recordsOf(options);
    EXPECT_EQ(records.at("solution").points(100), 100);
    // Seventy points are the task's own; what else there is in the pictures gives the rest in part. Measured:
    // 2 (30_full_frame) to 30 (02_car_camera).
    EXPECT_LE(records.at("handout").points(100), 40);
}

INSTANTIATE_TEST_SUITE_P(Labs, HandoutsOf, testing::ValuesIn(labsWithAShader()),
                         [](const auto& lab) { return "L" + lab.param; });

}  // namespace
}  // namespace quincunx::grade

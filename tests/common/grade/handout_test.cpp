// What a handout keeps of the solution.

#include "grade/handout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "labs/all_labs.h"

namespace quincunx::grade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Handouts, HaveTheTaskInPlaceOfTheSolution) {
    const Handout handedOut = handoutOf(
        "a;\n    // task: Do it\n    // well.\n    secret;\n    // instead: b;\n    // end of task\nc;\n",
        "x.frag");
    EXPECT_EQ(handedOut.text, "a;\n    // TASK: Do it\n    // well.\n    b;\nc;\n");
    EXPECT_THAT(handedOut.tasks, ElementsAre("Do it well."));
}

TEST(Handouts, OfTextWithoutMarksAreThatText) {
    EXPECT_EQ(handoutOf("a\nb\n", "x").text, "a\nb\n");
    EXPECT_THAT(handoutOf("a\n", "x").tasks, IsEmpty());
}

TEST(Handouts, NeedMarksThatMatch) {
    for (const char* wrong : {"// task: a\n", "// task: a\n// task: b\n// end of task\n"}) {
        try {
            handoutOf(wrong, "x.frag");
            ADD_FAILURE() << wrong;
        } catch (const InputError& e) {
            EXPECT_THAT(e.what(), HasSubstr("x.frag:"));
        }
    }
}

TEST(Handouts, OfTheLabsNameATaskAndLackTheSolution) {
    int count = 0;
    for (const LabEntry& entry : allLabs()) {
        const Exercise exercise = entry.make()->exercise();
        if (exercise.shader.empty())
            continue;
        ++count;
        const std::string solution = solutionOf(exercise);
        const Handout handedOut = handoutOf(solution, exercise.shader);
        EXPECT_THAT(handedOut.tasks, Not(IsEmpty())) << entry.folder();
        EXPECT_NE(handedOut.text, solution) << entry.folder();
        EXPECT_THAT(handedOut.text, Not(HasSubstr("// instead:"))) << entry.folder();
    }
    EXPECT_GE(count, 10);
}

}  // namespace
}  // namespace quincunx::grade

// Who is pointed out as alike, and who is not.

#include "grade/duplicates.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace quincunx::grade {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

Record screenshotOf(const std::string& student, const std::string& signature, bool exact = false) {
    Record record;
    record.student = student;
    Part part;
    part.kind = "screenshot";
    part.exact = exact;
    part.signature = signature;
    record.parts.push_back(part);
    return record;
}

std::string signature(int at, const char* value) {
    std::string text;
    for (int i = 0; i < 200; ++i)
        text += i >= at && i < at + 40 ? value : "80";
    return text;
}

TEST(Duplicates, AreScreenshotsThatAreWrongInTheSameWay) {
    const std::vector<Record> records = {screenshotOf("a", signature(20, "a0")),
                                         screenshotOf("b", signature(90, "a0")),
                                         screenshotOf("c", signature(20, "a1"))};
    const std::vector<Pair> pairs = findPairs(records);
    ASSERT_THAT(pairs, SizeIs(1));
    EXPECT_EQ(pairs[0].first, 0u);
    EXPECT_EQ(pairs[0].second, 2u);
}

TEST(Duplicates, AreNotScreenshotsThatAreRight) {
    EXPECT_THAT(findPairs({screenshotOf("a", "", true), screenshotOf("b", "", true)}), IsEmpty());
    // Half a code here and there: other drivers.
    EXPECT_THAT(findPairs({screenshotOf("a", signature(20, "81")), screenshotOf("b", signature(20, "81"))}),
                IsEmpty());
}

const char* emptyTask =
    "#version 330 core\nin vec3 n;\nout vec4 color;\nvoid main() { color = vec4(1.0); }\n";
const char* ours =
    "#version 330 core\nin vec3 n;\nout vec4 color;\nvoid main() { color = vec4(max(0.0, dot(n, light))); "
    "}\n";

std::string own(const std::string& name, const std::string& extra = "") {
    return "#version 330 core\nin vec3 n;\nout vec4 color;\nvoid main() { // mine\n float " + name +
           " = 0.0; for (int i = 0; i < 7; ++i) { " + name +
           " += pow(abs(n.x) * 0.3, 2.5) / (1.0 + n.y * n.z); }" + extra + " color = vec4(" + name +
           ", sqrt(" + name + "), 0.25, 1.0); }\n";
}

TEST(Duplicates, AreShadersWithOtherNamesAndComments) {
    const auto recordOf = [](const std::string& text) {
        Record record;
        record.shaderTokens = shaderTokens(text, {emptyTask, ours});
        return record;
    };
    std::string commented = own("brightness");
    commented.insert(commented.find("void"), "/* all my own\nwork */\n");
    EXPECT_THAT(findPairs({recordOf(own("sum")), recordOf(commented)}), SizeIs(1));
    EXPECT_THAT(findPairs({recordOf(emptyTask), recordOf(emptyTask)}), IsEmpty());
    EXPECT_THAT(findPairs({recordOf(ours), recordOf(ours)}), IsEmpty());
    EXPECT_THAT(
        findPairs({recordOf(own("sum")), recordOf("#version 330 core\nin vec3 n;\nout vec4 color;\nvoid "
                                                  "main() { vec3 l = normalize(vec3(1.0, 2.0, "
                                                  "0.5)); float d = clamp(dot(l, n), 0.0, 1.0); color = "
                                                  "vec4(vec3(0.2 + 0.8 * d) * n, 1.0); }\n")}),
        IsEmpty());
}

}  // namespace
}  // namespace quincunx::grade

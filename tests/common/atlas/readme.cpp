// What a lab's README says, on its page.

#include "atlas/readme.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "atlas/exam.h"

namespace quincunx::atlas {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::string html(std::string_view markdown) {
    return inlineHtml(markdown,
                      [](const std::string& target) { return target == "no" ? "" : "x/" + target; });
}

TEST(Markdown, BecomesHtml) {
    EXPECT_EQ(html("`a<b` and **bold *both***"), "<code>a&lt;b</code> and <b>bold *both</b>*");
    EXPECT_EQ(html("[`lab.cpp`](lab.cpp) draws"), "<a href=\"x/lab.cpp\"><code>lab.cpp</code></a> draws");
    EXPECT_EQ(html("[gone](no)"), "gone");
    EXPECT_EQ(html("`a \\| b` \\| c"), "<code>a | b</code> | c");
    EXPECT_EQ(html("2 * 3 * 4 [not a link] `open"), "2 <em> 3 </em> 4 [not a link] `open");
}

TEST(Markdown, CannotSmuggleHtmlIn) {
    EXPECT_EQ(html("<script>&\"'"), "&lt;script&gt;&amp;&quot;&#39;");
    EXPECT_EQ(html("[<b>](\"onclick=\"a)"), "<a href=\"x/&quot;onclick=&quot;a\">&lt;b&gt;</a>");
}

TEST(ReadmeText, IsTakenApart) {
    const Readme readme = parseReadme(
        "# 10 Shading\n\n![alt](a.png)\n\nThe first\nparagraph.\n\nThe second.\n\n```\nrun\n```\n\n"
        "## Questions\n\n| 32 | half |\n\n## Read, in this order\n\n1. [a](a.h): one\n   goes on.\n2. two\n\n"
        "Not an item.\n\n## Try\n\nWords.\n\n| do | see |\n|---|---|\n| `--a \\| b` | it |\n| c | d |\n");
    EXPECT_EQ(readme.intro, "The first paragraph.");
    EXPECT_THAT(readme.reading, ElementsAre("[a](a.h): one goes on.", "two"));
    EXPECT_THAT(readme.tries, ElementsAre(Pair("`--a \\| b`", "it"), Pair("c", "d")));
    EXPECT_THAT(linkTargets("[a](a.h) and [b](../b.cpp)"), ElementsAre("a.h", "../b.cpp"));
    EXPECT_TRUE(parseReadme("").reading.empty());
}

TEST(Exam, HasASubjectForEveryQuestion) {
    for (int number = 1; number <= questionCount; ++number) {
        EXPECT_FALSE(examSubject(number).topic.empty()) << number;
        EXPECT_FALSE(examSubject(number).subject.empty()) << number;
    }
    EXPECT_EQ(examSubject(36).topic, "transforms");
    EXPECT_EQ(examSubject(118).topic, "hardware");
}

}  // namespace
}  // namespace quincunx::atlas

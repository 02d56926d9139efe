// Rubrics as instructors write them, and as they should not.

#include "grade/rubric.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "lab/verbs.h"
#include "labs/all_labs.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::grade {
namespace {

using quincunx::test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

class Rubrics : public testing::Test {
  protected:
    Rubric read(const char* name, const char* text) {
        return readRubric(folder_.file(name, text), entry_, *lab_);
    }

    const LabEntry& entry_ = findLab(allLabs(), "shading");
    std::unique_ptr<Lab> lab_ = entry_.make();
    TemporaryFolder folder_;
};

TEST_F(Rubrics, OfEveryLabHaveAHundredPointsAndWorkingKnobs) {
    for (const LabEntry& entry : allLabs()) {
        const std::unique_ptr<Lab> lab = entry.make();
        const Rubric rubric = defaultRubric(entry, *lab);
        EXPECT_NEAR(rubric.points(), 100, 1e-9) << entry.folder();
        EXPECT_GE(rubric.properties.size(), 4u) << entry.folder();
        for (const std::string& name : rubric.freeKnobs)
            lab->knobs().find(name);
        // Reading it back tries every knob and every value.
        EXPECT_EQ(rubricFromText(rubric.text(), entry, *lab).text(), rubric.text()) << entry.folder();
    }
}

TEST_F(Rubrics, AreReadFromTomlAndFromJson) {
    const char* toml = R"(
title = "Highlights"
size = [320, 240]
camera = "task"
free = ["supersample", "tessellation"]
[knobs]
light-turn = 40
specular = true
[handling]
gamma = 0.5
[[property]]
name = "the highlights"
points = 30
without = { specular = "off" }
[[property]]
name = "all of it"
measure = "flip"
points = 10
full = 0.01
none = 0.1
)";
    const char* json = R"({"title": "Highlights", "size": [320, 240], "camera": "task",
"free": ["supersample", "tessellation"], "knobs": {"light-turn": "40", "specular": "on"}, "handling": {"gamma": 0.5},
"property": [{"name": "the highlights", "points": 30, "without": {"specular": false}},
{"name": "all of it", "measure": "flip", "points": 10, "full": 0.01, "none": 0.1}]})";
    const Rubric rubric = read("a.toml", toml);
    EXPECT_EQ(rubric.text(), read("a.json", json).text());
    EXPECT_EQ(rubric.points(), 40);
    EXPECT_FALSE(rubric.cameraIsFree);
    EXPECT_THAT(rubric.knobs, ElementsAre(std::pair("light-turn", "40"), std::pair("specular", "on")));
    EXPECT_EQ(rubric.most[static_cast<std::size_t>(Handling::gamma)], 0.5);
    EXPECT_EQ(rubric.properties[0].full, 0.85);  // as the default has it
}

TEST_F(Rubrics, ThatMakeNoSenseAreRefusedByName) {
    const std::pair<const char*, const char*> wrong[] = {
        {"knobs = { spectral = 1 }", "spectral"},
        {"knobs = { specular = \"maybe\" }", "maybe"},
        {"colour = 1", "colour"},
        {"lab = \"shadow_maps\"", "shadow_maps"},
        {"size = [1, 99999]", "4096"},
        {"handling = { gamma = 2 }", "gamma"},
        {"property = []", "0 properties"},
        {"[[property]]\nname = \"x\"\npoints = -1\nwithout = { specular = \"off\" }", "-1 points"},
        {"[[property]]\nname = \"x\"\npoints = 1", "does not say which knobs"},
        {"[[property]]\nname = \"x\"\npoints = 1\nmeasure = \"taste\"", "taste"},
        {"[[property]]\nname = \"x\"\npoints = 1\nmeasure = \"flip\"\nfull = 0.5\nnone = 0.1", "no better"},
        {"[[property]]\nname = \"x\"\npoints = nan\nmeasure = \"flip\"", "points"},
        {"a = [", "r.toml:1"}};
    for (const auto& [text, part] : wrong) {
        try {
            read("r.toml", text);
            ADD_FAILURE() << text;
        } catch (const InputError& e) {
            EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("r.toml"), HasSubstr(part))) << text;
        }
    }
    EXPECT_THROW(read("r.json", "{"), InputError);
    EXPECT_THROW(read("r.json", std::string(100000, '[').c_str()), InputError);
}

}  // namespace
}  // namespace quincunx::grade

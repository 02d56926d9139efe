// --json: it parses, with the field names that others build on.

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/program/program.h"

namespace quincunx::test {
namespace {

using nlohmann::json;
using testing::IsSupersetOf;
using testing::UnorderedElementsAre;

class ProgramJson : public Program {
  protected:
    /// What the program printed; exit statuses 0 and 1 both come with an answer.
    json answer(std::vector<std::string> words) const {
        words.emplace_back("--json");
        const ProcessResult result = call(std::move(words));
        EXPECT_TRUE(result.exitStatus == 0 || result.exitStatus == 1) << result.text();
        EXPECT_EQ(result.err, "");
        json parsed = json::parse(result.out, nullptr, false);
        EXPECT_FALSE(parsed.is_discarded()) << result.text();
        if (parsed.is_object() && parsed.contains("pass")) {
            EXPECT_EQ(parsed["pass"], result.exitStatus == 0);
        }
        return parsed;
    }
    static std::set<std::string> names(const json& object) {
        std::set<std::string> result;
        for (const auto& [name, value] : object.items())
            result.insert(name);
        return result;
    }
};

TEST_F(ProgramJson, OfListNamesLabsTopicsAndQuestions) {
    const json labs = answer({"list"});
    ASSERT_FALSE(labs.empty());
    for (const json& lab : labs)
        EXPECT_THAT(names(lab), UnorderedElementsAre("lab", "topic", "questions"));
    const auto shading =
        std::find_if(labs.begin(), labs.end(), [](const json& lab) { return lab["lab"] == "10_shading"; });
    ASSERT_NE(shading, labs.end());
    const json& questions = (*shading)["questions"];
    EXPECT_EQ(std::set<int>(questions.begin(), questions.end()), (std::set<int>{32, 37, 90, 105, 113, 114}));
}

TEST_F(ProgramJson, OfAskHoldsQuestionAnswerAndMeasurements) {
    const json reply = answer({"ask", "37", "--backend", "osmesa"});
    EXPECT_THAT(names(reply), IsSupersetOf({"question", "lab", "asked", "answer", "measurements", "pass"}));
    EXPECT_EQ(reply["question"], 37);
    ASSERT_FALSE(reply["measurements"].empty());
    for (const json& measurement : reply["measurements"]) {
        EXPECT_THAT(names(measurement), IsSupersetOf({"name", "value", "unit", "pass"}));
        EXPECT_TRUE(measurement["value"].is_number()) << measurement;
    }
}

TEST_F(ProgramJson, OfSweepHoldsPointsWithErrorTimeAndFront) {
    const json sweeps = answer(drawingSmall({"sweep", "shading", "--sweep", "tessellation"}));
    ASSERT_TRUE(sweeps.is_array());
    ASSERT_FALSE(sweeps.empty());
    for (const json& sweep : sweeps) {
        EXPECT_THAT(names(sweep), UnorderedElementsAre("lab", "sweep", "title", "reference", "metric",
                                                       "error_unit", "renderer", "points"));
        ASSERT_FALSE(sweep["points"].empty());
        for (const json& point : sweep["points"])
            EXPECT_THAT(names(point), UnorderedElementsAre("knobs", "error", "seconds", "seconds_spread",
                                                           "counters", "pareto"));
    }
}

TEST_F(ProgramJson, OfStressHoldsNaiveAndStableErrorsWithTheirBounds) {
    const json reply = answer({"stress", "shading"});
    EXPECT_THAT(names(reply), UnorderedElementsAre("lab", "cases", "pass"));
    ASSERT_FALSE(reply["cases"].empty());
    for (const json& row : reply["cases"]) {
        EXPECT_THAT(names(row), UnorderedElementsAre("routine", "hard_input", "inputs", "naive_failures",
                                                     "naive_error", "stable_failures", "source",
                                                     "stable_error", "unit", "bound", "pass"));
        EXPECT_EQ(row["pass"], true) << row;
    }
}

TEST_F(ProgramJson, OfPlanHoldsEffectsInAndOutWithTheirReasonsAndCosts) {
    const json reply = answer(drawingSmall(
        {"plan", "full_frame", "--tessellation=6", "--shadow-resolution=128", "--blur=0", "--greyscale=0"}));
    EXPECT_THAT(names(reply),
                IsSupersetOf({"scene", "effects", "passes", "gl_calls", "milliseconds", "memory_bytes"}));
    EXPECT_GT(reply["gl_calls"], 0);
    EXPECT_GT(reply["memory_bytes"], 0);
    std::set<std::string> in;
    for (const json& effect : reply["effects"]) {
        EXPECT_THAT(names(effect),
                    IsSupersetOf({"name", "called_for", "reason", "passes", "gl_calls", "milliseconds",
                                  "milliseconds_even_frames", "milliseconds_odd_frames", "alone_milliseconds",
                                  "memory_bytes"}));
        EXPECT_NE(effect["reason"], "") << effect;
        if (effect["called_for"] == true) {
            in.insert(effect["name"].get<std::string>());
        } else {
            EXPECT_EQ(effect["gl_calls"], 0) << effect;
            EXPECT_EQ(effect["milliseconds"], 0) << effect;
            EXPECT_TRUE(effect["passes"].empty()) << effect;
        }
    }
    EXPECT_THAT(in, IsSupersetOf({"directional shadows", "environment map", "tone map"}));
    EXPECT_THAT(in, testing::Not(testing::Contains("greyscale")));
}

TEST_F(ProgramJson, OfPlanHoldsThePassesOfALabThatPlansNothing) {
    const json reply = answer(drawingSmall({"plan", "shading"}));
    EXPECT_TRUE(reply["effects"].empty());
    ASSERT_FALSE(reply["passes"].empty());
    std::uint64_t calls = 0;
    for (const json& pass : reply["passes"])
        calls += pass["gl_calls"].get<std::uint64_t>();
    // What belongs to no pass is the frame's own: at most that it switches sRGB on.
    EXPECT_LE(calls, reply["gl_calls"].get<std::uint64_t>());
    EXPECT_GE(calls + 8, reply["gl_calls"].get<std::uint64_t>());
}

TEST_F(ProgramJson, OfPlanTakesAFileOfAnyScene) {
    folder_.file("sheet.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nf 1 2 3\n");
    const json reply = answer(drawingSmall({"plan", "sheet.obj"}));
    EXPECT_THAT(reply["scene"], "sheet.obj");
    for (const json& effect : reply["effects"])
        if (effect["name"] == "directional shadows") {
            // One flat sheet has nothing to cast a shadow on it.
            EXPECT_EQ(effect["called_for"], false) << effect;
        }
}

TEST_F(ProgramJson, OfPlanAsAGraphIsForGraphviz) {
    const ProcessResult result = call({"plan", "full_frame", "--graph", "--backend", "osmesa"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_THAT(result.out, testing::AllOf(testing::StartsWith("digraph"), testing::HasSubstr("shade")));
}

TEST_F(ProgramJson, OfRunNamesThePictureAndWhatDrewIt) {
    const json reply = answer(drawingSmall({"run", "shading"}));
    EXPECT_THAT(names(reply), IsSupersetOf({"lab", "file", "backend", "renderer", "width", "height",
                                            "seconds", "counters", "knobs"}));
    EXPECT_EQ(reply["backend"], "osmesa");
    EXPECT_EQ(reply["width"], 32);
}

TEST_F(ProgramJson, OfCompareHoldsMetricAndValue) {
    ASSERT_TRUE(succeeded(call(drawingSmall({"run", "shading", "--out", "a.png"}))));
    const json reply = answer({"compare", "a.png", "a.png"});
    EXPECT_THAT(names(reply), IsSupersetOf({"metric", "value"}));
    EXPECT_EQ(reply["value"], 0);
}

}  // namespace
}  // namespace quincunx::test

#include "lab/sweep.h"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/file.h"
#include "base/random.h"
#include "lab/plot.h"

namespace quincunx {
namespace {

std::vector<SweepPoint> pointsOf(const std::vector<std::pair<double, double>>& secondsAndErrors) {
    std::vector<SweepPoint> points;
    for (const auto& [seconds, error] : secondsAndErrors) {
        SweepPoint point;
        point.knobs = {{"kind", "a"}, {"n", std::to_string(points.size())}};
        point.sample.seconds = seconds;
        point.sample.error = error;
        points.push_back(point);
    }
    return points;
}

/// Draws nothing; its sweep tells what the knobs were.
class TwoKnobs final : public Lab {
  public:
    std::string topic() const override { return "two knobs"; }
    graph::Resource build(graph::FrameGraph&, const Frame&) override { return {}; }
    Camera defaultCamera() const override { return {}; }
    Bounds sceneBounds() const override { return {}; }
    IntKnob a{knobs(), "a", 1, {0, 100}, "", "first"};
    IntKnob b{knobs(), "b", 2, {0, 100}, "", "second"};
};

TEST(RunSweep, APointThatIsSilentAboutAKnobHasItAsItWas) {
    TwoKnobs lab;
    lab.b.set(7);
    Sweep sweep;
    sweep.name = "knobs";
    sweep.points = {{{"a", "10"}}, {{"b", "20"}, {"a", "11"}}, {{"a", "12"}}};
    sweep.measure = [&lab](Studio&, const Frame&) {
        SweepSample sample;
        sample.error = lab.a * 1000 + lab.b;
        sample.seconds = 1;
        return sample;
    };
    Studio studio(gl::Backend::osmesa);
    const SweepResult result = runSweep(lab, {1, "two_knobs", nullptr}, sweep, studio, {});
    ASSERT_EQ(result.points.size(), 3u);
    EXPECT_EQ(result.points[0].sample.error, 10007);
    EXPECT_EQ(result.points[1].sample.error, 11020);
    EXPECT_EQ(result.points[2].sample.error, 12007);
    EXPECT_EQ(result.points[0].knobs, (KnobValues{{"a", "10"}, {"b", "7"}}));
    EXPECT_EQ(result.points[1].knobs, (KnobValues{{"a", "11"}, {"b", "20"}}));
    EXPECT_EQ(lab.a, 1);
    EXPECT_EQ(lab.b, 7);
}

TEST(ParetoFront, HoldsWhatNothingBeats) {
    std::vector<SweepPoint> points = pointsOf({{1, 9}, {2, 4}, {3, 5}, {4, 1}, {4, 2}, {5, 1}, {1, 9}});
    markParetoFront(points);
    std::vector<bool> front;
    for (const SweepPoint& point : points)
        front.push_back(point.pareto);
    EXPECT_EQ(front, (std::vector<bool>{true, true, false, true, false, false, true}));
}

TEST(ParetoFront, OfRandomPointsFallsFromLeftToRightAndLeavesNobodyUnbeaten) {
    Random random(5);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::pair<double, double>> values;
        for (int i = 0; i < 12; ++i)
            values.emplace_back(static_cast<double>(random.below(8)), static_cast<double>(random.below(8)));
        std::vector<SweepPoint> points = pointsOf(values);
        markParetoFront(points);
        for (const SweepPoint& a : points) {
            bool beaten = false;
            for (const SweepPoint& b : points) {
                const bool asGood = b.sample.seconds <= a.sample.seconds && b.sample.error <= a.sample.error;
                const bool better = b.sample.seconds < a.sample.seconds || b.sample.error < a.sample.error;
                beaten = beaten || (asGood && better && b.pareto);
            }
            EXPECT_EQ(a.pareto, !beaten);
        }
    }
}

TEST(Choice, KeepsTheLimitsAndTakesTheBestOfTheRest) {
    const std::vector<SweepPoint> points = pointsOf({{1, 9}, {2, 4}, {4, 1}, {8, 0.5}});
    EXPECT_EQ(choosePoint(points, 4.0, std::nullopt), 2u);
    EXPECT_EQ(choosePoint(points, std::nullopt, 4.0), 1u);
    EXPECT_EQ(choosePoint(points, 5.0, 5.0), 2u);
    EXPECT_EQ(choosePoint(points, 0.5, std::nullopt), std::nullopt);
    EXPECT_EQ(choosePoint(points, 1.5, 1.0), std::nullopt);
}

TEST(Csv, QuotesWhatNeedsIt) {
    SweepResult result;
    result.points = pointsOf({{0.5, 0.25}});
    result.points[0].knobs = {{"file", "a \"b\", c"}};
    result.points[0].sample.counters = {{"rays", 12}};
    markParetoFront(result.points);
    EXPECT_EQ(toCsv(result),
              "file,error,seconds,seconds_spread,pareto,rays\n\"a \"\"b\"\", c\",0.25,0.5,0,1,12\n");
}

TEST(Plot, NamesTheTimeAndTheErrorAndLabelsThePoints) {
    SweepResult result;
    result.lab = "99_lab";
    result.title = "what it trades";
    result.metric = "RMSE";
    result.reference = "the truth";
    result.renderer = "a renderer";
    result.points = pointsOf({{1, 9}, {2, 4}});
    markParetoFront(result.points);
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("quincunx_plot_{}.svg", getpid());
    writePlotSvg(result, file);
    const std::string svg = readFile(file, 1 << 20);
    std::filesystem::remove(file);
    // Of a sweep that draws no frames, too.
    for (const char* words : {"99_lab: what it trades", ">time (ms)<", ">2000<", ">5<", "RMSE<",
                              "against the truth", "a renderer"})
        EXPECT_NE(svg.find(words), std::string::npos) << words;
}

}  // namespace
}  // namespace quincunx

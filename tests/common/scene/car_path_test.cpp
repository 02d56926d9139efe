#include "scene/car_path.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "base/random.h"
#include "scene/town.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

CarPath randomPath(std::uint64_t seed, int spans) {
    Random random(seed);
    CarPath path;
    path.start.position = {random.uniform(-50, 50), 0, random.uniform(-50, 50)};
    path.start.heading = AngleSum(random.uniform(-3, 3));
    for (int i = 0; i < spans; ++i)
        path.spans.push_back({static_cast<std::uint32_t>(1 + random.below(60)),
                              {random.uniform(-1, 1), random.uniform(-1, 1)}});
    return path;
}

TEST(CarPath, RecordsEqualStepsAsOneSpan) {
    CarPath path;
    for (int i = 0; i < 10; ++i)
        path.record({1, 0});
    path.record({1, 0.5});
    ASSERT_EQ(path.spans.size(), 2u);
    EXPECT_EQ(path.spans[0].steps, 10u);
    EXPECT_EQ(path.stepCount(), 11u);
}

TEST(CarPath, PlaysTheSameBitsInAnyOrder) {
    const CarPath path = randomPath(1, 40);
    const PathPlayer player(path);
    CarState car = path.start;
    std::uint64_t step = 0;
    for (const CarPath::Span& span : path.spans)
        for (std::uint32_t i = 0; i < span.steps; ++i, ++step) {
            // By hand, from the start, and from the nearest mark.
            const double seconds = (static_cast<double>(step) + 1e-3) * path.stepSeconds;
            const CarState part = advanced(car, span.controls, 1e-3 * path.stepSeconds);
            if (step % 37 == 0) {
                EXPECT_EQ(stateAt(path, seconds), player.at(seconds)) << step;
                EXPECT_NEAR(player.at(seconds).position.x, part.position.x, 1e-12);
            }
            car = advanced(car, span.controls, path.stepSeconds);
        }
    EXPECT_EQ(player.at(path.seconds() + 5), car);
    EXPECT_EQ(stateAt(path, 1e300), car);
    EXPECT_EQ(player.at(-1), path.start);
    EXPECT_EQ(player.at(std::numeric_limits<double>::quiet_NaN()), path.start);
    EXPECT_EQ(PathPlayer(CarPath{}).at(3), CarState{});
}

TEST(CarPath, ComesBackFromItsTextBitForBit) {
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
        const CarPath path = randomPath(seed, 30);
        const CarPath again = parseCarPath(toJson(path), "text");
        EXPECT_EQ(again, path);
        EXPECT_EQ(stateAt(again, 4.321), stateAt(path, 4.321));
    }
    const test::TemporaryFolder folder;
    writeFile(folder / "drive.json", toJson(randomPath(3, 5)));
    EXPECT_EQ(readCarPath(folder / "drive.json"), randomPath(3, 5));
}

TEST(CarPath, HostileTextsAreOneLineOfError) {
    const std::string good = toJson(randomPath(4, 3));
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    const std::string steps = good.substr(0, good.find("\"steps\": [") + 10);
    const std::string texts[] = {
        "",
        "{",
        "[]",
        "null",
        good.substr(0, good.size() / 2),
        with("quincunx car path", "another path"),
        with("\"step_seconds\": 0.02", "\"step_seconds\": 0"),
        with("\"step_seconds\": 0.02", "\"step_seconds\": -1"),
        with("\"step_seconds\": 0.02", "\"step_seconds\": 1e999"),
        with("\"speed\": 0", "\"speed\": \"fast\""),
        with("\"speed\": 0", "\"speed\": 1e30"),
        with("\"steering_radians\": 0", "\"steering_radians\": 9"),
        with("\"position\": [", "\"position\": [1, "),
        steps + "[4000000000, 0, 0]]}",
        steps + "[-1, 0, 0]]}",
        steps + "[0, 0, 0]]}",
        steps + "[1.5, 0, 0]]}",
        steps + "[8640000, 0, 0], [1, 0, 0]]}",
        steps + "[1, 2, 0]]}",
        steps + "[1, 0]]}",
        steps + "[1, 0, null]]}",
    };
    for (const std::string& text : texts) {
        try {
            parseCarPath(text, "drive.json");
            ADD_FAILURE() << text;
        } catch (const InputError& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            EXPECT_NE(std::string(e.what()).find("drive.json"), std::string::npos) << e.what();
        }
    }
    EXPECT_THROW(readCarPath("/nowhere/drive.json"), InputError);
}

TEST(FollowLine, KeepsToTheStreetsAllTheWayRound) {
    const Town town = makeTown();
    const CarPath path = followLine(town.start, town.tour, 240);
    EXPECT_NEAR(path.seconds(), 240, path.stepSeconds);
    const PathPlayer player(path);
    double worst = 0;
    double travelled = 0;
    for (double t = 0; t < 240; t += 0.1) {
        const CarState car = player.at(t);
        const glm::dvec2 here(car.position.x, car.position.z);
        double nearest = 1e9;
        for (std::size_t i = 0; i < town.tour.size(); ++i) {
            const glm::dvec2 a = town.tour[i];
            const glm::dvec2 b = town.tour[(i + 1) % town.tour.size()];
            const double s = glm::clamp(glm::dot(here - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
            nearest = std::min(nearest, glm::length(here - glm::mix(a, b, s)));
        }
        worst = std::max(worst, nearest);
        travelled = car.distanceTravelled;
    }
    // A lane is four metres wide and the car 1.9; corners are cut a little.
    EXPECT_LE(worst, 1.3);  // measured 0.9
    // More than once round: the tour is 930 m long.
    EXPECT_GE(travelled, 1100);
}

}  // namespace
}  // namespace quincunx

// Figures of pictures whose answer is known in closed form.

#include "grade/scoring.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/common/grade/drawing.h"

namespace quincunx::grade {
namespace {

using test::drawing;
using testing::HasSubstr;

Image8 withSpot(std::uint8_t code) {
    Image8 image = drawing(96, 64);
    for (int y = 10; y < 20; ++y)
        for (int x = 60; x < 80; ++x)
            std::fill_n(image.pixel(x, y), 3, code);
    return image;
}

TEST(EffectShare, IsOneWithAndZeroWithoutTheEffect) {
    const Image8 with = withSpot(200);
    const Image8 without = withSpot(100);
    EXPECT_EQ(effectShare(with, without, with), 1.0);
    EXPECT_EQ(effectShare(with, without, without), 0.0);
    // Half of it leaves half of the distance, a quarter of its square.
    EXPECT_EQ(effectShare(with, without, withSpot(150)), 0.75);
    EXPECT_LT(*effectShare(with, without, withSpot(0)), 0.0);
}

TEST(EffectShare, IsNotSaidOfWhatCannotBeSeen) {
    EXPECT_FALSE(effectShare(drawing(96, 64), drawing(96, 64), drawing(96, 64)));
    EXPECT_FALSE(effectShare(withSpot(100), withSpot(103), withSpot(100)));
}

Rubric rubricWith(std::vector<Property> properties) {
    Rubric rubric;
    rubric.properties = std::move(properties);
    rubric.most.fill(1);
    rubric.most[static_cast<std::size_t>(Handling::cropped)] = 0.5;
    return rubric;
}

const Property flipTen{
    .name = "picture", .measure = Measure::flip, .without = {}, .points = 10, .full = 0.05, .none = 0.3};
const Property spotTwenty{
    .name = "spot", .measure = Measure::effect, .without = {}, .points = 20, .full = 0.85, .none = 0.25};

TEST(Scores, AreFullForTheReferenceItself) {
    const Result result = scoreScreenshot({withSpot(200), {Image8{}, withSpot(100)}}, withSpot(200),
                                          rubricWith({flipTen, spotTwenty}));
    EXPECT_EQ(result.points(), 30);
    EXPECT_EQ(result.of(), 30);
    EXPECT_TRUE(result.scores[0].reason.empty() && result.scores[1].reason.empty());
}

TEST(Scores, TellWhyPointsAreLost) {
    const Result result = scoreScreenshot({withSpot(200), {Image8{}, withSpot(100)}}, withSpot(100),
                                          rubricWith({flipTen, spotTwenty}));
    EXPECT_EQ(result.scores[1].points, 0);
    EXPECT_THAT(result.scores[1].reason, HasSubstr("missing"));
    EXPECT_EQ(result.scores[0].points, 10);  // ten pixels in a hundred do not spoil the whole
}

TEST(Scores, LeaveOutWhatThePictureCannotShow) {
    const Result result =
        scoreScreenshot({drawing(96, 64), {drawing(96, 64)}}, drawing(96, 64), rubricWith({spotTwenty}));
    EXPECT_EQ(result.of(), 0);
    EXPECT_THAT(result.remarks, testing::ElementsAre(HasSubstr("cannot be seen")));
}

TEST(Scores, AreLimitedByHowThePictureWasHandled) {
    const Image8 submitted = cropped(withSpot(200), 1, 0, 95, 64);
    const Result result = scoreScreenshot({withSpot(200), {Image8{}, withSpot(100)}}, submitted,
                                          rubricWith({flipTen, spotTwenty}));
    EXPECT_EQ(result.points(), 15);
    EXPECT_THAT(result.limits.at(0).reason, HasSubstr("cropped"));
}

TEST(Points, GoStraightFromNoneToFull) {
    EXPECT_EQ(flipTen.pointsFor(0), 10);
    EXPECT_EQ(flipTen.pointsFor(0.05), 10);
    EXPECT_NEAR(flipTen.pointsFor(0.175), 5, 1e-12);
    EXPECT_EQ(flipTen.pointsFor(0.3), 0);
    EXPECT_EQ(flipTen.pointsFor(1), 0);
    EXPECT_EQ(flipTen.pointsFor(std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace quincunx::grade

// Which values of a knob are shown.

#include "atlas/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lab/knob.h"

namespace quincunx::atlas {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class KnobValuesShown : public testing::Test {
  protected:
    KnobSet knobs_;
};

TEST_F(KnobValuesShown, AreAllOfAChoice) {
    ChoiceKnob choice(knobs_, "bias", {"none", "constant", "slope"}, 2, "");
    BoolKnob flag(knobs_, "mirror", true, "");
    TextKnob words(knobs_, "model", "", "FILE", "");
    EXPECT_THAT(valuesToShow(choice, 1), ElementsAre("none", "constant", "slope"));
    EXPECT_THAT(valuesToShow(flag, 1), ElementsAre("off", "on"));
    EXPECT_THAT(valuesToShow(words, 1), IsEmpty());
    EXPECT_EQ(choice.text(), "slope");
}

TEST_F(KnobValuesShown, OfANumberAreItsDefaultAndOthersOnBothSides) {
    FloatKnob even(knobs_, "even", 0.5F, {0, 1}, "", "");
    EXPECT_THAT(valuesToShow(even, 1), ElementsAre("0", "0.5", "1"));
    EXPECT_THAT(valuesToShow(even, 2), ElementsAre("0", "0.25", "0.5", "0.75", "1"));
    IntKnob wide(knobs_, "wide", 16, {1, 4096, true}, "", "");
    // Half the way to either end, of the logarithm.
    EXPECT_THAT(valuesToShow(wide, 1), ElementsAre("4", "16", "256"));
    EXPECT_EQ(static_cast<int>(wide), 16);
}

TEST_F(KnobValuesShown, OfANumberAtItsEndLieOnTheOtherSide) {
    IntKnob low(knobs_, "low", 0, {0, 8}, "", "");
    EXPECT_THAT(valuesToShow(low, 1), ElementsAre("0", "4", "8"));
    IntKnob few(knobs_, "few", 1, {1, 2}, "", "");
    EXPECT_THAT(valuesToShow(few, 2), ElementsAre("1", "2"));
    FloatKnob odd(knobs_, "odd", 0.123456F, {0.1F, 0.2F}, "", "");
    EXPECT_THAT(valuesToShow(odd, 1), SizeIs(3));
    EXPECT_THAT(valuesToShow(odd, 1), Contains(odd.defaultText()));
}

}  // namespace
}  // namespace quincunx::atlas

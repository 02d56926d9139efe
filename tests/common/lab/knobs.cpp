#include <bit>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "lab/knob.h"

namespace quincunx {
namespace {

struct Knobs {
    KnobSet set;
    FloatKnob bias{set, "bias", 2, {-1e30f, 1e30f}, "texels", "Pushes away"};
    IntKnob count{set, "count", 3, {1, 100}, "", "How many"};
    BoolKnob fog{set, "fog", false, "Fog"};
    ChoiceKnob filter{set, "filter", {"nearest", "linear"}, 1, "How texels are read"};
};

std::string messageOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(Knobs, SurviveTheWayThroughTextBitForBit) {
    Knobs knobs;
    Random random(1);
    for (int i = 0; i < 20'000; ++i) {
        const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
        if (!(std::abs(value) <= 1e30f))
            continue;
        knobs.bias.set(value);
        const std::string text = knobs.bias.text();
        knobs.bias.set(0);
        knobs.bias.parse(text);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(static_cast<float>(knobs.bias)),
                  std::bit_cast<std::uint32_t>(value))
            << text;
    }
}

TEST(Knobs, RefuseWhatIsOutOfRangeOrNoNumber) {
    Knobs knobs;
    for (const char* text : {"0", "101", "1.5", "", "x", "3 ", "1e1", "99999999999999999999", "nan"})
        EXPECT_THROW(knobs.count.parse(text), InputError) << text;
    for (const char* text : {"nan", "inf", "-inf", "1e31", "2,5", "", "2x", "0x10"})
        EXPECT_THROW(knobs.bias.parse(text), InputError) << text;
    for (const char* text : {"Linear", "", "2", "linear "})
        EXPECT_THROW(knobs.filter.parse(text), InputError) << text;
    EXPECT_THROW(knobs.fog.parse("maybe"), InputError);
    EXPECT_EQ(knobs.count, 3);
    EXPECT_EQ(knobs.bias, 2);
    EXPECT_EQ(knobs.filter.index(), 1);
}

TEST(Knobs, SayInOneLineWhatTheyTake) {
    Knobs knobs;
    EXPECT_EQ(messageOf([&] { knobs.count.parse("many\n"); }),
              "--count: \"many\\n\" is not a value; give 1 … 100");
    EXPECT_EQ(messageOf([&] { knobs.filter.parse("cubic"); }),
              "--filter: \"cubic\" is not a value; give nearest|linear");
    EXPECT_EQ(messageOf([&] { knobs.set.find("glow"); }),
              "there is no knob \"glow\"; choose from bias, count, fog, filter");
}

TEST(Knobs, AreRestoredAtTheEndOfAScope) {
    Knobs knobs;
    knobs.bias.set(0.1f);
    const auto before = knobs.set.values();
    {
        const KnobScope scope(knobs.set);
        knobs.set.set({{"bias", "7"}, {"fog", "on"}, {"filter", "nearest"}, {"count", "9"}});
        EXPECT_EQ(knobs.count, 9);
        EXPECT_TRUE(knobs.fog);
    }
    EXPECT_EQ(knobs.set.values(), before);
    knobs.bias.reset();
    EXPECT_EQ(knobs.bias, 2);
    EXPECT_EQ(knobs.bias.defaultText(), "2");
}

TEST(TextKnob, TakesWordsButNoControlCharacters) {
    KnobSet set;
    TextKnob file(set, "path", "off", "off, or a file", "What is played");
    EXPECT_EQ(file.value(), "off");
    for (const char* text : {"drives/a b.json", "", "größe", "off"}) {
        file.parse(text);
        EXPECT_EQ(file.text(), text);
    }
    file.parse("kept");
    EXPECT_THROW(file.parse("two\nlines"), InputError);
    EXPECT_THROW(file.parse(std::string(5000, 'x')), InputError);
    EXPECT_EQ(file.value(), "kept");
    EXPECT_EQ(messageOf([&] { file.parse("\x01"); }),
              "--path: \"\\x01\" is not a value; give off, or a file");
    file.reset();
    EXPECT_EQ(file.value(), "off");
}

}  // namespace
}  // namespace quincunx

#include "lab/picture_state.h"

#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"

namespace quincunx {
namespace {

PictureState oddState() {
    PictureState state;
    state.lab = "10_shading";
    state.model = "a \"quoted\"\n name \xc3\xa9.obj";
    state.modelFingerprint = 0xfedcba9876543210u;
    state.renderer = "some driver";
    state.knobs = {{"bias", "0.1"}, {"filter", "linear"}};
    state.frame.width = 31;
    state.frame.height = 17;
    state.frame.timeSeconds = 0.1;
    state.frame.seed = std::numeric_limits<std::uint64_t>::max();
    state.frame.camera.farDistance = std::numeric_limits<float>::infinity();
    state.frame.camera.nearDistance = 1e-7f;
    state.frame.camera.apertureRadius = 0.1f;
    state.frame.camera.focusDistance = 1e7f / 3;
    state.frame.camera.worldFromCamera[3] = {0.1f, -1e-38f, 3e30f, 1};
    return state;
}

TEST(PictureState, SurvivesTheWayThroughJsonBitForBit) {
    const PictureState state = oddState();
    const PictureState again = parsePictureState(toJson(state), "test");
    EXPECT_EQ(again.lab, state.lab);
    EXPECT_EQ(again.model, state.model);
    EXPECT_EQ(again.modelFingerprint, state.modelFingerprint);
    EXPECT_EQ(again.knobs, state.knobs);
    EXPECT_EQ(again.frame.width, state.frame.width);
    EXPECT_EQ(again.frame.height, state.frame.height);
    EXPECT_EQ(again.frame.timeSeconds, state.frame.timeSeconds);
    EXPECT_EQ(again.frame.seed, state.frame.seed);
    EXPECT_EQ(again.frame.camera.worldFromCamera, state.frame.camera.worldFromCamera);
    EXPECT_EQ(again.frame.camera.fovYRadians, state.frame.camera.fovYRadians);
    EXPECT_EQ(again.frame.camera.nearDistance, state.frame.camera.nearDistance);
    EXPECT_EQ(again.frame.camera.farDistance, state.frame.camera.farDistance);
    EXPECT_EQ(again.frame.camera.apertureRadius, state.frame.camera.apertureRadius);
    EXPECT_EQ(again.frame.camera.focusDistance, state.frame.camera.focusDistance);
}

TEST(PictureState, KnowsLensesFocusedAtInfinityAndNoLens) {
    PictureState state = oddState();
    state.frame.camera.focusDistance = std::numeric_limits<float>::infinity();
    EXPECT_EQ(parsePictureState(toJson(state), "test").frame.camera.focusDistance,
              state.frame.camera.focusDistance);
    std::string older = toJson(state);
    const std::size_t lens = older.find("\"aperture_radius\"");
    older.replace(lens, older.find_first_of(",}", lens) - lens, "\"unknown\": 0");
    EXPECT_EQ(parsePictureState(older, "test").frame.camera.apertureRadius, 0);
}

TEST(PictureState, RefusesEveryCutOffText) {
    const std::string text = toJson(oddState());
    for (std::size_t length = 0; length < text.size(); ++length)
        EXPECT_THROW(parsePictureState(text.substr(0, length), "cut.json"), InputError) << length;
}

TEST(PictureState, RefusesWhatMakesNoSenseInOneLineThatNamesTheFile) {
    const std::string good = toJson(oddState());
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    for (const std::string& text :
         {with("\"width\": 31", "\"width\": 0"), with("\"width\": 31", "\"width\": 99999999"),
          with("fedcba9876543210", "fedcba987654321x"), with("fedcba9876543210", "fedcba98765432100"),
          with("\"width\": 31", "\"width\": \"31\""), with("\"seed\"", "\"sead\": -1, \"seed\""),
          with("\"fov_y_radians\": ", "\"fov_y_radians\": 4"), with("\"near\"", "\"far\": 1e-9, \"near\""),
          with("\"aperture_radius\": ", "\"aperture_radius\": -"), std::string("[]"), std::string(5000, '[')})
        try {
            const PictureState state = parsePictureState(text, "bad.json");
            EXPECT_TRUE(text.find("sead") != std::string::npos) << text;
        } catch (const InputError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_EQ(message.rfind("bad.json: ", 0), 0u) << message;
        }
}

}  // namespace
}  // namespace quincunx

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include <gtest/gtest.h>

#include "base/file.h"
#include "image/io.h"
#include "lab/ui_panel.h"
#include "lab/verbs.h"
#include "labs/all_labs.h"
#include "tests/common/window/driver.h"

namespace quincunx::test {
namespace {

/// Software rendering gives the same bits in a window and offscreen, so pictures are compared exactly.
constexpr int sameDriver = 0;

Area scaled(float x, float y, float w, float h, float scale) {
    return {static_cast<int>(x * scale), static_cast<int>(y * scale), static_cast<int>(w * scale),
            static_cast<int>(h * scale)};
}

/// The control of the knob that was declared as the i-th.
Area control(const DrivenWindow& window, std::size_t i) {
    Area area =
        scaled(PanelLayout::knobLeft, PanelLayout::knobTop + PanelLayout::knobStep * static_cast<float>(i),
               PanelLayout::knobWidth, PanelLayout::knobHeight, 1);
    area.x += window.panelArea().x;
    return area;
}

/// How many pixels have the red of faults.
int faultPixels(DrivenWindow& window) {
    const Image8 panel = window.screen().look(window.panelArea());
    int count = 0;
    for (std::size_t i = 0; i < panel.pixelCount(); ++i)
        count += panel.data[3 * i] > 200 && panel.data[3 * i + 1] < 140 && panel.data[3 * i + 2] < 140;
    return count;
}

/// A copy of the tree's shaders that a test may edit.
class ShaderCopy {
  public:
    ShaderCopy() {
        std::filesystem::copy(std::filesystem::path(QUINCUNX_SOURCE_DIR) / "shaders", folder_ / "shaders",
                              std::filesystem::copy_options::recursive);
    }
    std::string environment() const { return "QUINCUNX_ROOT=" + folder_.path().string(); }
    std::filesystem::path phong() const { return folder_ / "shaders/passes/phong.frag"; }
    std::string read() const { return readFile(phong(), 1 << 20); }
    void write(const std::string& text) const { writeFile(phong(), text); }

  private:
    TemporaryFolder folder_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.rfind(what);
    EXPECT_NE(at, std::string::npos);
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(Window, ShowsThePictureThatIsDrawnOffscreenByteForByte) {
    DrivenWindow window;
    EXPECT_EQ(window.area().width, DrivenWindow::width + static_cast<int>(PanelLayout::width));
    EXPECT_EQ(window.area().height, DrivenWindow::height);
    const Image8 seen = window.picture();
    EXPECT_EQ(window.close().exitStatus, 0);
    const PictureState state = window.record();
    EXPECT_EQ(state.frame.width, DrivenWindow::width);
    EXPECT_EQ(state.frame.height, DrivenWindow::height);
    EXPECT_LE(largestDifference(seen, window.replay(window.folder() / "record.json")), sameDriver);
}

/// Where along a slider a click changes its value: at the lower end, where triangles and samples are few and
/// the test is quick, unless the default lies there.
float clickShare(const Knob& knob) {
    const auto share = [](double value, const auto& range) {
        return range.logarithmic
                   ? std::log(value / range.min) / std::log(static_cast<double>(range.max) / range.min)
                   : (value - range.min) / (static_cast<double>(range.max) - range.min);
    };
    double usual = 1;
    if (const auto* whole = dynamic_cast<const IntKnob*>(&knob))
        usual = share(*whole, whole->range());
    else if (const auto* real = dynamic_cast<const FloatKnob*>(&knob))
        usual = share(*real, real->range());
    return usual < 0.33 ? 0.6f : 0.2f;
}

class EveryLab : public testing::TestWithParam<LabEntry> {};

TEST_P(EveryLab, HasAWindowWhoseKnobsFollowTheirControlsAndRightClickPutsThemBack) {
    const std::unique_ptr<Lab> lab = GetParam().make();
    const std::vector<Knob*>& knobs = lab->knobs().all();
    ASSERT_FALSE(knobs.empty());
    const float below = PanelLayout::knobTop + PanelLayout::knobStep * static_cast<float>(knobs.size());
    // A narrow picture is soon drawn, often as it is here.
    DrivenWindow window({.lab = GetParam().folder(),
                         .width = 64,
                         .height = std::clamp(static_cast<int>(below), DrivenWindow::height, 1000)});
    const Image8 start = window.picture();
    EXPECT_EQ(faultPixels(window), 0);
    // A hand does not wait until a picture is as good as it gets.
    constexpr auto shown = DrivenWindow::Until::shown;
    const auto operate = [&](std::size_t i) {
        const Area area = control(window, i);
        const int middle = area.y + area.height / 2;
        // What words may say only the lab knows.
        if (dynamic_cast<TextKnob*>(knobs[i]) != nullptr)
            return;
        if (dynamic_cast<BoolKnob*>(knobs[i]) != nullptr) {
            window.click(area.x + area.height / 2, middle, 1, shown);
        } else if (const auto* choice = dynamic_cast<ChoiceKnob*>(knobs[i])) {
            const bool last = choice->index() + 1 == static_cast<int>(choice->options().size());
            window.click(area.x + 20, middle, 1, shown);
            window.press(last ? "Up" : "Down", shown);
            window.press("space", shown);
        } else {
            window.click(area.x + static_cast<int>(clickShare(*knobs[i]) * static_cast<float>(area.width)),
                         middle, 1, shown);
        }
    };
    // Numbers first; then switches and choices, the first declared at the very end: they are what leaves
    // others without effect.
    lab->markIdleKnobs();
    const auto isNumber = [&](std::size_t i) {
        return dynamic_cast<IntKnob*>(knobs[i]) != nullptr || dynamic_cast<FloatKnob*>(knobs[i]) != nullptr;
    };
    std::vector<std::size_t> operated;
    for (std::size_t i = 0; i < knobs.size(); ++i)
        if (knobs[i]->idle().empty() && isNumber(i))
            operated.push_back(i);
    for (std::size_t i = knobs.size(); i-- > 0;)
        if (knobs[i]->idle().empty() && !isNumber(i))
            operated.push_back(i);
    EXPECT_GE(2 * operated.size(), knobs.size());
    for (const std::size_t i : operated)
        operate(i);
    window.settle();
    EXPECT_EQ(faultPixels(window), 0);
    const std::filesystem::path shot = window.screenshot(1);
    const Image8 seen = window.picture();
    EXPECT_NE(seen, start);
    const PictureState turned = readPictureState(shot);
    ASSERT_EQ(turned.knobs.size(), knobs.size());
    for (const std::size_t i : operated)
        if (dynamic_cast<TextKnob*>(knobs[i]) == nullptr) {
            EXPECT_NE(turned.knobs[i].second, knobs[i]->defaultText()) << knobs[i]->name();
        }
    EXPECT_LE(largestDifference(seen, window.replay(shot)), sameDriver);

    // The last first, so that what was turned down to be quick is turned up at the very end.
    for (std::size_t k = operated.size(); k-- > 0;) {
        const Area area = control(window, operated[k]);
        window.click(area.x + area.height / 2, area.y + area.height / 2, 3, shown);
    }
    window.settle();
    EXPECT_EQ(window.picture(), start);
    EXPECT_EQ(window.close().exitStatus, 0);
    for (const auto& [name, value] : window.record().knobs)
        EXPECT_EQ(value, lab->knobs().find(name).defaultText()) << name;
}

INSTANTIATE_TEST_SUITE_P(Window, EveryLab, testing::ValuesIn(allLabs().begin(), allLabs().end()),
                         [](const testing::TestParamInfo<LabEntry>& entry) {
                             return "Lab" + entry.param.folder();
                         });

TEST(Window, TheButtonBesideAKnobPutsItBack) {
    DrivenWindow window({.words = {"--shading=flat", "--tessellation=9"}});
    const std::unique_ptr<Lab> lab = findLab(allLabs(), "shading").make();
    for (std::size_t i = 0; i < lab->knobs().all().size(); ++i) {
        const std::string name = lab->knobs().all()[i]->name();
        if (name == "shading" || name == "tessellation")
            window.click(
                DrivenWindow::width + static_cast<int>(PanelLayout::resetLeft + PanelLayout::resetWidth / 2),
                control(window, i).y + control(window, i).height / 2);
    }
    EXPECT_EQ(window.close().exitStatus, 0);
    for (const auto& [name, value] : window.record().knobs)
        EXPECT_EQ(value, lab->knobs().find(name).defaultText()) << name;
}

TEST(Window, TheMapShowsWhereThePictureIsWrong) {
    DrivenWindow window({.words = {"--shading=flat", "--tessellation=9"}});
    const Image8 start = window.picture();
    window.press("m");
    // The reference takes its time; the map comes up by itself.
    ASSERT_TRUE(window.waitUntil([&] { return window.picture() != start; }));
    // The map's red lies in the lower left, a third as wide as the picture.
    const Image8 inset =
        window.screen().look({14, DrivenWindow::height * 2 / 3, DrivenWindow::width / 3, 100});
    int red = 0;
    for (std::size_t i = 0; i < inset.pixelCount(); ++i)
        red += inset.data[3 * i] > 100 && inset.data[3 * i + 2] < 60;
    EXPECT_GT(red, 50);
    window.press("m");
    EXPECT_EQ(window.picture(), start);
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, AnImportedModelIsShownAsItIsDrawnOffscreenAndComparedWithItsTracedTriangles) {
    const TemporaryFolder folder;
    folder.file("model.obj", "v -1 0 0\nv 1 0 0\nv 0 1.5 0.2\nf 1 2 3\n");
    DrivenWindow window({.words = {"--model", (folder / "model.obj").string()}});
    const Image8 seen = window.picture();
    window.press("m");
    // The map comes up by itself.
    ASSERT_TRUE(window.waitUntil([&] { return window.picture() != seen; }));
    window.press("m");
    EXPECT_EQ(window.picture(), seen);
    EXPECT_EQ(faultPixels(window), 0);
    EXPECT_EQ(window.close().exitStatus, 0);
    EXPECT_NE(window.record().modelFingerprint, 0u);
    EXPECT_LE(largestDifference(seen, window.replay(window.folder() / "record.json")), sameDriver);
}

TEST(Window, ALabWithoutAReferenceHasNoMap) {
    DrivenWindow window({.lab = "03_rotations"});
    const Image8 seen = window.picture();
    window.press("m");
    EXPECT_EQ(window.picture(), seen);
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, OrbitsByDragAndWheelAndComesBackBitForBit) {
    DrivenWindow window;
    const Image8 start = window.picture();
    Image8 last = start;
    const auto moved = [&] {
        const Image8 now = window.picture();
        return std::exchange(last, now) != now;
    };
    window.drag(1, 240, 200, 300, 160);
    EXPECT_TRUE(moved());
    const std::filesystem::path shot = window.screenshot(1);
    EXPECT_EQ(window.picture(), withoutAlpha(readImage8(shot)));
    EXPECT_LE(largestDifference(window.picture(), window.replay(shot)), sameDriver);

    window.drag(3, 240, 200, 200, 230);
    EXPECT_TRUE(moved());
    window.drag(2, 240, 200, 260, 210);
    EXPECT_TRUE(moved());
    window.click(240, 200, 4);
    EXPECT_TRUE(moved());
    window.press("r");
    EXPECT_EQ(window.picture(), start);
    EXPECT_EQ(withoutAlpha(readImage8(window.screenshot(2, "F12"))), start);
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, FliesByKeysAndComesBackBitForBit) {
    DrivenWindow window;
    const Image8 start = window.picture();
    window.press("c");
    Image8 last = start;
    for (const char* key : {"w", "a", "s", "d", "q", "e"}) {
        window.act({"keydown", key, "sleep", "0.05", "keyup", key});
        const Image8 now = window.picture();
        EXPECT_NE(std::exchange(last, now), now) << key;
    }
    window.drag(1, 240, 200, 200, 180);
    EXPECT_NE(window.picture(), last);
    window.press("r");
    EXPECT_EQ(window.picture(), start);
    EXPECT_EQ(window.close().exitStatus, 0);
}

std::string knobOf(const PictureState& state, const std::string& name) {
    for (const auto& [knob, value] : state.knobs)
        if (knob == name)
            return value;
    ADD_FAILURE() << "no knob " << name;
    return "0";
}

TEST(Window, ALabThatTakesTheKeysIsDrivenByThem) {
    DrivenWindow window({.lab = "02_car_camera", .height = 240, .words = {"--supersample=1"}});
    const Image8 start = window.picture();
    // By letters and by arrows; between them the car rolls out, until the window sleeps.
    window.act({"keydown", "w", "sleep", "0.3", "keyup", "w"});
    EXPECT_NE(window.picture(), start);
    const PictureState ahead = readPictureState(window.screenshot(1));
    EXPECT_GT(std::stod(knobOf(ahead, "car-z")), -46);
    EXPECT_EQ(knobOf(ahead, "car-x"), "-2");
    window.act({"keydown", "Up", "keydown", "Left", "sleep", "0.4", "keyup", "Up", "keyup", "Left"});
    const std::filesystem::path shot = window.screenshot(2);
    const PictureState turned = readPictureState(shot);
    EXPECT_GT(std::stod(knobOf(turned, "car-z")), std::stod(knobOf(ahead, "car-z")));
    EXPECT_GT(std::stod(knobOf(turned, "heading")), 0);
    // The knobs are all that the picture was made from.
    EXPECT_LE(largestDifference(window.picture(), window.replay(shot)), sameDriver);

    // A drag does not move a camera that the lab holds; its keys change the view.
    const Image8 chased = window.picture();
    window.drag(1, 200, 120, 260, 140);
    EXPECT_EQ(window.picture(), chased);
    window.press("v");
    EXPECT_NE(window.picture(), chased);

    // The tour goes on without a hand until it is stopped.
    window.act({"key", "t", "sleep", "0.5", "key", "t"});
    EXPECT_EQ(window.close().exitStatus, 0);
    EXPECT_EQ(knobOf(window.record(), "view"), "driver");
    EXPECT_EQ(knobOf(window.record(), "path"), "tour");
    EXPECT_GT(std::stod(knobOf(window.record(), "time")), 8);
}

TEST(Window, KeysOfALabAreInTheHelpAndSayWhatTheyDid) {
    DrivenWindow window({.lab = "02_car_camera", .height = 240, .words = {"--supersample=1"}});
    window.act({"keydown", "w", "sleep", "0.2", "keyup", "w"});
    window.press("k");
    EXPECT_TRUE(exists(window.folder() / "out/drive_001.json"));
    const Image8 start = window.picture();
    window.press("h");
    EXPECT_NE(window.picture(), start);
    window.press("Escape");
    EXPECT_EQ(window.picture(), start);
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, HelpCoversThePictureUntilEscape) {
    DrivenWindow window;
    const Image8 start = window.picture();
    for (const auto& [open, shut] : {std::pair("h", "Escape"), std::pair("F1", "F1")}) {
        window.press(open);
        EXPECT_NE(window.picture(), start);
        window.press(shut);
        EXPECT_EQ(window.picture(), start);
    }
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, WithoutItsPanelThePictureFillsIt) {
    DrivenWindow window;
    const Area all = window.area();
    window.press("Tab");
    const Image8 wide = window.screen().look(all);
    EXPECT_EQ(window.close().exitStatus, 0);
    EXPECT_EQ(window.record().frame.width, all.width);
    EXPECT_LE(largestDifference(wide, window.replay(window.folder() / "record.json")), sameDriver);
}

TEST(Window, ABrokenShaderKeepsThePictureShowsWhyAndRecovers) {
    const ShaderCopy shaders;
    DrivenWindow window({.environment = {shaders.environment()}});
    const Image8 start = window.picture();
    EXPECT_EQ(faultPixels(window), 0);

    const std::string good = shaders.read();
    shaders.write(replaced(good, "}", "this is no GLSL }"));
    // One line of text in red has some hundred pixels of its full colour.
    EXPECT_TRUE(window.waitUntil([&] { return faultPixels(window) > 100; }));
    EXPECT_EQ(window.picture(), start);
    // The camera moves on with the last good program.
    window.drag(1, 240, 200, 300, 200);
    EXPECT_NE(window.picture(), start);
    window.press("r");
    EXPECT_EQ(window.picture(), start);
    EXPECT_GT(faultPixels(window), 100);

    shaders.write(good + "\n");
    EXPECT_TRUE(window.waitUntil([&] { return faultPixels(window) == 0; }));
    EXPECT_EQ(window.picture(), start);
    shaders.write(replaced(good, "}", "\ncolor.rgb = color.brg;\n}"));
    EXPECT_TRUE(window.waitUntil([&] { return window.picture() != start; }));
    EXPECT_EQ(window.close().exitStatus, 0);
}

TEST(Window, AShaderThatIsBrokenAtTheStartIsOneLine) {
    const Xvfb xvfb;
    const ShaderCopy shaders;
    shaders.write(replaced(shaders.read(), "}", "this is no GLSL }"));
    const TemporaryFolder folder;
    ProcessOptions options;
    options.folder = folder.path();
    options.environment = {shaders.environment()};
    const ProcessResult result =
        runProcess({QUINCUNX_PROGRAM, "run", "shading", "--backend", "window", "--size", "64x64"}, options);
    EXPECT_EQ(result.exitStatus, 2) << result.text();
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("phong.frag:"), std::string::npos) << result.err;
}

TEST(Window, EndsCleanlyOnASignal) {
    DrivenWindow window;
    window.signal(SIGINT);
    const ProcessResult result = window.wait();
    EXPECT_EQ(result.exitStatus, 130) << result.text();
    EXPECT_EQ(result.err, "quincunx: interrupted\n");
    EXPECT_TRUE(std::filesystem::is_empty(window.folder().path()));
}

TEST(Window, WithoutADisplayIsOneLineAndStatusThree) {
    const TemporaryFolder folder;
    ProcessOptions options;
    options.folder = folder.path();
    for (const char* display : {"DISPLAY=", "DISPLAY=:4242"}) {
        options.environment = {display, "WAYLAND_DISPLAY="};
        const ProcessResult result =
            runProcess({QUINCUNX_PROGRAM, "run", "shading", "--backend", "window"}, options);
        EXPECT_EQ(result.exitStatus, 3) << result.text();
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
}

TEST(Window, OnADenseDisplayThePanelIsTwiceAsLargeAndThePictureAsAsked) {
    DrivenWindow window({.dotsPerInch = 192});
    const int panel = 2 * static_cast<int>(PanelLayout::width);
    EXPECT_EQ(window.screen().find("10_shading")->width, DrivenWindow::width + panel);
    const Image8 seen = window.picture();

    // Down the middle of the first control, between its neighbours of another colour.
    const Area line =
        scaled(PanelLayout::knobLeft + PanelLayout::knobWidth / 2, PanelLayout::knobTop, 1, 2, 2);
    const Image8 column = window.screen().look(
        {DrivenWindow::width + line.x, line.y - 4, 1, static_cast<int>(2 * PanelLayout::knobStep) + 4});
    const auto isField = [&](int y) {
        // The colour of fields is lighter than the panel's, which is 27, 29, 33.
        return column.pixel(0, y)[2] > 44;
    };
    int height = 0;
    for (int y = 0; y < column.height; ++y)
        height += isField(y);
    EXPECT_NEAR(height, 2 * PanelLayout::knobHeight, 2);

    window.press("Escape");
    EXPECT_EQ(window.wait().exitStatus, 0);
    EXPECT_LE(largestDifference(seen, window.replay(window.folder() / "record.json")), sameDriver);
}

}  // namespace
}  // namespace quincunx::test

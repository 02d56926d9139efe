// The pages of two small labs, made once and opened in Chromium. The labs' words are hostile: whatever of
// them a page takes for HTML shows up as an element, a console message or a request.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <glad/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "atlas/atlas.h"
#include "base/error.h"
#include "base/file.h"
#include "lab/answer.h"
#include "lab/stress.h"
#include "lab/studio.h"
#include "lab/sweep.h"
#include "tests/support/browser.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* hostile = "</script><script>alert('x')</script><b onclick=\"y\">&amp; 'quotes' \"";

int framesDrawn = 0;
bool stopAtTheQuestion = false;

HardCaseFigures runHostile(std::uint64_t inputs, std::uint64_t) {
    return {inputs, 3, 2.5, 0, 0.25, "(0x1p+0)"};
}

/// Two halves: the left of a grey that the knob says, the right black.
class Halves : public Lab {
  public:
    std::string topic() const override { return hostile; }
    Camera defaultCamera() const override { return {}; }
    Bounds sceneBounds() const override { return {}; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override {
        ++framesDrawn;
        const graph::Resource picture =
            graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
        graph.addPass(
            {hostile,
             {},
             {picture},
             [grey = float(grey_), width = frame.width / 2, height = frame.height](graph::PassContext&) {
                 glClearColor(0, 0, 0, 1);
                 glClear(GL_COLOR_BUFFER_BIT);
                 glEnable(GL_SCISSOR_TEST);
                 glScissor(0, 0, width, height);
                 glClearColor(grey, grey, grey, 1);
                 glClear(GL_COLOR_BUFFER_BIT);
                 glDisable(GL_SCISSOR_TEST);
             }});
        return picture;
    }
    std::vector<Question> questions() override {
        return {{36, hostile, std::string("answer ") + hostile, hostile, [](Studio&) {
                     if (stopAtTheQuestion)
                         throw Interrupted();
                     return std::vector<Measurement>{{hostile, 0.123456789, hostile, atMost(1)},
                                                     {"a million", 1e6, "", {}}};
                 }}};
    }
    std::vector<Sweep> sweeps() override {
        Sweep sweep{"grey", hostile, hostile, hostile, hostile, 32, 24, {}, {}};
        for (const char* grey : {"0.1", "0.4", "0.8"})
            sweep.points.push_back({{"grey", grey}});
        sweep.measure = [this](Studio&, const Frame&) {
            const double grey = float(grey_);
            return SweepSample{grey < 0.2 ? 0.0 : 1 / grey, 1e-3 * grey, 1e-5, {{"texels", 12345}}};
        };
        return {sweep};
    }
    std::vector<HardCase> hardCases() override {
        return {{hostile, hostile, hostile, 0.5, hostile, &runHostile}};
    }
    std::vector<EffectReport> effects() const override { return {{hostile, false, hostile, {}}}; }

  protected:
    FloatKnob grey_{knobs(), "grey", 0.25F, {0, 1}, hostile, hostile};
    BoolKnob idle_{knobs(), "nothing", false, "Does nothing"};
};

class Plain final : public Halves {
  public:
    std::string topic() const override { return "Two halves"; }
    std::vector<Question> questions() override { return {}; }
    std::vector<Sweep> sweeps() override { return {}; }
    std::vector<HardCase> hardCases() override { return {}; }
};

std::unique_ptr<Lab> makeHalves() {
    return std::make_unique<Halves>();
}
std::unique_ptr<Lab> makePlain() {
    return std::make_unique<Plain>();
}

const std::vector<LabEntry> labs = {{98, "halves", &makeHalves}, {99, "plain_halves", &makePlain}};

AtlasOptions into(const fs::path& folder) {
    return {gl::Backend::osmesa, {}, folder.string(), false, true};
}

struct Made {
    ExitStatus status;
    json said;
};

Made make(const AtlasOptions& options) {
    testing::internal::CaptureStdout();
    const ExitStatus status = makeAtlas(labs, options);
    return {status, json::parse(testing::internal::GetCapturedStdout())};
}

class Pages : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new test::TemporaryFolder();
        made_ = new Made(make(into(folder_->path() / "site")));
        browser_ = new test::Browser();
    }
    static void TearDownTestSuite() {
        delete browser_;
        delete made_;
        delete folder_;
    }
    static fs::path site() { return folder_->path() / "site"; }
    static fs::path labPage() { return site() / "labs/98_halves.html"; }
    static test::Browser& browser() { return *browser_; }
    static std::vector<fs::path> pages() {
        std::vector<fs::path> found;
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(site()))
            if (entry.path().extension() == ".html")
                found.push_back(entry.path());
        return found;
    }
    /// Opens the comparison of the knob "grey" and waits for its pictures.
    static void openComparison() {
        browser().open(labPage());
        browser().run(
            "const d = document.querySelector('#knob-grey details'); d.open = true; d.scrollIntoView();");
        ASSERT_TRUE(browser().waitFor("return document.querySelector('#knob-grey .compare').dataset.ready"));
    }

    static test::TemporaryFolder* folder_;
    static Made* made_;
    static test::Browser* browser_;
};

test::TemporaryFolder* Pages::folder_ = nullptr;
Made* Pages::made_ = nullptr;
test::Browser* Pages::browser_ = nullptr;

TEST_F(Pages, LoadWithoutAConsoleMessageOrARequest) {
    EXPECT_EQ(made_->status, ExitStatus::ok);
    EXPECT_EQ(pages().size(), 6U);
    for (const fs::path& page : pages()) {
        browser().open(page);
        EXPECT_THAT(browser().consoleMessages(), IsEmpty()) << page;
        EXPECT_THAT(browser().networkRequests(), IsEmpty()) << page;
        EXPECT_NE(browser().run("return document.title"), "") << page;
        EXPECT_EQ(browser().run("return document.querySelectorAll('h1').length"), 1) << page;
    }
    // And the browser does tell.
    browser().run("console.error('seen'); const i = new Image(); i.src = 'https://quincunx.invalid/a.png';");
    browser().run("return new Promise((done) => setTimeout(done, 100))");
    EXPECT_THAT(browser().consoleMessages(), Contains(HasSubstr("seen")));
    EXPECT_THAT(browser().networkRequests(), Contains(HasSubstr("quincunx.invalid")));
}

TEST_F(Pages, TakeNoWordForHtml) {
    for (const fs::path& page : pages()) {
        browser().open(page);
        EXPECT_EQ(browser().run("return document.querySelectorAll('[onclick]').length"), 0) << page;
        EXPECT_EQ(browser().run("return [...document.scripts].filter((s) => !s.src && s.type !== "
                                "'application/json').length"),
                  0)
            << page;
    }
    browser().open(labPage());
    EXPECT_EQ(browser().run("return document.querySelector('.lead').textContent"), hostile);
    EXPECT_EQ(browser().run("return document.querySelector('#q36-asked').textContent"), hostile);
}

TEST_F(Pages, LinkOnlyToWhatIsThere) {
    for (const fs::path& page : pages()) {
        browser().open(page);
        const json targets = browser().run(
            "return [...document.querySelectorAll('[href], [src], [data-pixels]')].flatMap((e) => "
            "['href', 'src', 'data-pixels'].map((n) => e.getAttribute(n)).filter(Boolean))");
        EXPECT_GT(targets.size(), 5U) << page;
        for (const std::string target : targets) {
            if (target.starts_with("data:"))
                continue;
            const std::size_t hash = target.find('#');
            const fs::path file =
                hash == 0 ? page : (page.parent_path() / target.substr(0, hash)).lexically_normal();
            EXPECT_TRUE(fs::is_regular_file(file)) << page << ": " << target;
            if (hash != std::string::npos && fs::is_regular_file(file)) {
                EXPECT_THAT(readFile(file, 1 << 24), HasSubstr("id=\"" + target.substr(hash + 1) + "\""))
                    << page << ": " << target;
            }
        }
    }
}

TEST_F(Pages, DescribeEveryPicture) {
    for (const fs::path& page : pages()) {
        browser().open(page);
        // Without words only where the link around it has some.
        EXPECT_EQ(
            browser().run("return [...document.images].filter((i) => !i.hasAttribute('alt') || (i.alt === '' "
                          "&& !i.closest('a')?.textContent.trim())).map((i) => i.src)"),
            json::array())
            << page;
        EXPECT_EQ(browser().run(
                      "return [...document.querySelectorAll('button, select, input, [role=img], svg[role]')]"
                      ".filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || "
                      "e.labels?.length)).length"),
                  0)
            << page;
    }
    // A page without a description would be found.
    browser().run("document.querySelector('main').append(new Image())");
    EXPECT_EQ(browser().run("return [...document.images].filter((i) => !i.hasAttribute('alt')).length"), 1);
}

TEST_F(Pages, WeighLittleAndFitAPhone) {
    browser().resize(390, 800);
    for (const fs::path& page : pages()) {
        browser().open(page);
        EXPECT_LE(browser().run("return document.documentElement.scrollWidth").get<int>(), 390) << page;
        std::uintmax_t bytes = fs::file_size(page);
        std::set<std::string> loaded;
        for (const std::string source :
             browser().run("return [...document.querySelectorAll('[src], link[href]')].map((e) => "
                           "e.getAttribute('src') ?? e.getAttribute('href'))"))
            if (!source.starts_with("data:") && loaded.insert(source).second)
                bytes += fs::file_size(page.parent_path() / source);
        EXPECT_LT(bytes, 3'000'000U) << page;
    }
    browser().resize(1200, 900);
}

TEST_F(Pages, FindQuestion36) {
    const auto shown = [&] {
        return browser().run(
            "return [...document.querySelectorAll('#list > li')].filter((e) => !e.hidden).map((e) => "
            "Number(e.dataset.number))");
    };
    browser().open(site() / "questions.html");
    EXPECT_EQ(shown().size(), 118U);
    browser().type("#query", "36");
    EXPECT_EQ(shown(), json::array({36}));
    EXPECT_EQ(browser().run("return document.querySelector('#found').textContent"), "1 question");
    EXPECT_EQ(browser().run("return document.querySelector('#q36 a').getAttribute('href')"),
              "labs/98_halves.html#q36");

    browser().open(site() / "questions.html");
    browser().type("#query", "BEZIER curves");
    EXPECT_THAT(shown(), Contains(31)) << "without accents and capitals";
    browser().open(site() / "questions.html");
    browser().run(
        "const t = document.querySelector('#topic'); t.value = 'shadows'; t.dispatchEvent(new "
        "Event('change'))");
    EXPECT_EQ(shown(), json::array({26, 27, 28, 51, 69}));
    browser().open(site() / "questions.html");
    browser().click("#answered");
    EXPECT_EQ(shown(), json::array({36}));
    EXPECT_EQ(browser().run("return document.querySelector('#q27').textContent.includes('not yet answered')"),
              true);
}

TEST_F(Pages, CompareTwoSettingsByASlider) {
    openComparison();
    // The default, 0.25, against what differs most from it.
    EXPECT_EQ(browser().run("return [...document.querySelectorAll('#knob-grey .compare select')].map((s) => "
                            "s.selectedOptions[0].text)"),
              json::array({"0.25", "0"}));
    const auto share = [&] {
        return browser().run(
            "return document.querySelector('#knob-grey .compare').style.getPropertyValue('--share')");
    };
    EXPECT_EQ(share(), "50%");
    browser().type("#knob-grey .compare-slider", "\uE014\uE014\uE014");
    EXPECT_EQ(share(), "53%");
    EXPECT_EQ(browser().run("return document.querySelector('#knob-grey .compare-slider').ariaValueText"),
              "53 % 0.25");
    EXPECT_EQ(browser().run("return getComputedStyle(document.querySelector('.compare-second')).clipPath"),
              "inset(0px 0px 0px 53%)");
}

TEST_F(Pages, FlickerBetweenTwoSettings) {
    openComparison();
    browser().click("#knob-grey .compare-tools button[aria-pressed]");
    EXPECT_TRUE(
        browser().waitFor("return document.querySelector('#knob-grey .compare-badge').textContent === '0'"));
    EXPECT_TRUE(browser().waitFor(
        "return document.querySelector('#knob-grey .compare-badge').textContent === '0.25'"));
    browser().click("#knob-grey .compare-tools button[aria-pressed]");
    EXPECT_EQ(browser().run(
                  "return document.querySelector('#knob-grey .compare').classList.contains('is-flickering')"),
              false);
}

TEST_F(Pages, ReadPixelsAsTheyWereDrawn) {
    openComparison();
    const auto readout = [&] {
        return browser().run("return document.querySelector('#knob-grey .compare-readout').textContent");
    };
    // Linear 0.25 is the code 137; the right half is black in both. 137/255 = 0.537.
    browser().pointAt("#knob-grey .compare-stage", -40);
    EXPECT_THAT(readout(), HasSubstr("left 137 137 137, right 0 0 0, difference 0.537"));
    browser().pointAt("#knob-grey .compare-stage", 40);
    EXPECT_THAT(readout(), HasSubstr("left 0 0 0, right 0 0 0, difference 0.000"));
    EXPECT_EQ(browser().run("return document.querySelector('#knob-grey .compare-summary').textContent"),
              "0.25 against 0: RMSE 0.3799, 50.0 % of the pixels differ, the most by 0.537.");
    EXPECT_THAT(browser().consoleMessages(), IsEmpty());
    EXPECT_THAT(browser().networkRequests(), IsEmpty());
    // The map: its brightest colour on the left, black on the right.
    EXPECT_EQ(
        browser().run(
            "const c = document.querySelectorAll('#knob-grey .compare-stage')[1].querySelector('canvas');"
            "const g = c.getContext('2d'); const p = (x) => [...g.getImageData(x, 10, 1, 1).data];"
            "const e = window.quincunxErrorColours;"
            "return String(p(10)) === String([...e.slice(-3), 255]) && String(p(390)) === "
            "String([...e.slice(0, 3), 255])"),
        true);
    // By keys: plus zooms, arrows go from pixel to pixel.
    browser().type("#knob-grey .compare-stage", "++\uE014");
    EXPECT_EQ(browser().run("return document.querySelector('#knob-grey .compare-zoom').textContent"), "4×");
    EXPECT_THAT(readout(), HasSubstr("left 0 0 0"));
    browser().run(
        "const s = document.querySelector('#knob-grey select'); s.selectedIndex = 2; "
        "s.dispatchEvent(new Event('change'))");
    EXPECT_TRUE(browser().waitFor(
        "return document.querySelector('#knob-grey .compare-summary').textContent.startsWith('1 ')"));
}

TEST_F(Pages, ShowAPointsPictureWhereItsCurveIsPointedAt) {
    browser().open(labPage());
    const auto picture = [&] {
        return browser().run("return document.querySelector('.chart-side img').getAttribute('src')");
    };
    EXPECT_EQ(browser().run("return document.querySelectorAll('.chart .point').length"), 3);
    for (int i = 0; i < 3; ++i) {
        browser().pointAt(".chart .point:nth-of-type(" + std::to_string(i + 2) + ")");
        EXPECT_EQ(picture(), "98_halves/sweep-grey-" + std::to_string(i) + ".jpg");
    }
    EXPECT_THAT(browser().run("return document.querySelector('.chart-words').textContent"),
                testing::AllOf(HasSubstr("0.8"), HasSubstr("1.25"), HasSubstr("12,345")));
    // By keys: back to the faster ones.
    browser().run("document.querySelector('.chart .point.is-chosen').focus()");
    browser().type(".chart .point.is-chosen", "\uE012");
    EXPECT_EQ(picture(), "98_halves/sweep-grey-1.jpg");
    EXPECT_TRUE(
        browser().run("return document.activeElement.getAttribute('aria-label').startsWith('grey 0.4: ')"));
}

TEST_F(Pages, HoldTheFiguresThatTheVerbsPrint) {
    const std::unique_ptr<Lab> lab = makeHalves();
    Studio studio(gl::Backend::osmesa);
    const json stored = json::parse(readFile(site() / "labs/98_halves/lab.json", 1 << 24));
    // As JSON writes and reads it.
    const auto same = [](const auto& printed) { return json::parse(printed.dump()); };
    EXPECT_EQ(stored["questions"][0], same(toJson(answerQuestion(labs[0], lab->questions()[0], studio))));
    EXPECT_EQ(stored["stress"], same(toJson(runStress(*lab, labs[0], quickStressInputs, 1))));
    const Frame frame = studio.frame(*lab, 32, 24);
    EXPECT_EQ(stored["sweeps"][0]["sweep"],
              same(toJson(runSweep(*lab, labs[0], lab->sweeps()[0], studio, frame))));

    browser().open(labPage());
    EXPECT_EQ(browser().run("return [...document.querySelectorAll('#q36 td.number')].map((e) => "
                            "e.firstChild.textContent.trim())"),
              json::array({figureText(0.123456789), figureText(1e6)}));
    EXPECT_EQ(
        browser().run("return JSON.parse(document.querySelector('#data-halves-grey').textContent).points"),
        stored["sweeps"][0]["sweep"]["points"]);
}

TEST_F(Pages, AreReadableInTheDarkAndOnPaper) {
    /// Of text against what it stands on, by WCAG 2, section 1.4.3.
    const char* contrast =
        "const l = (c) => c.match(/[0-9.]+/g).slice(0, 3).map((v) => v / 255).map((v) => v <= .04045 ? v / "
        "12.92 "
        ": ((v + .055) / 1.055) ** 2.4).reduce((s, v, i) => s + v * [.2126, .7152, .0722][i], 0);"
        "const e = document.querySelector(arguments[0]); let b = e; while (b.parentElement && "
        "getComputedStyle(b).backgroundColor.endsWith(', 0)')) b = b.parentElement;"
        "const [x, y] = [l(getComputedStyle(e).color), l(getComputedStyle(b).backgroundColor)];"
        "return (Math.max(x, y) + .05) / (Math.min(x, y) + .05)";
    for (const bool dark : {false, true}) {
        browser().preferDark(dark);
        browser().open(labPage());
        for (const char* what : {"main p", ".soft", "a", ".pass", ".badge", ".fix", "thead th", ".eyebrow"})
            EXPECT_GE(browser().run(contrast, json::array({what})).get<double>(), 4.5) << what << dark;
    }
    browser().click("#theme");
    EXPECT_EQ(browser().run("return document.documentElement.dataset.theme"), "light");
    browser().preferDark(false);
    browser().preferPrint(true);
    openComparison();
    EXPECT_EQ(browser().run("return getComputedStyle(document.querySelector('.compare-face')).display"),
              "none");
    EXPECT_EQ(browser().run("return getComputedStyle(document.querySelector('.bar nav')).display"), "none");
    browser().preferPrint(false);
}

TEST_F(Pages, AreMadeAgainOnlyWhereSomethingChanged) {
    const Made again = make(into(site()));
    EXPECT_EQ(again.said["measured"], 0);
    EXPECT_EQ(again.said["pages_written"], 0);
    fs::remove(site() / "labs/98_halves/grey-1.jpg");
    const Made repaired = make(into(site()));
    EXPECT_EQ(repaired.said["measured"], 1);
    EXPECT_EQ(repaired.said["pages_written"], 0);
}

TEST(Atlas, GoesOnWhereItWasInterrupted) {
    const test::TemporaryFolder folder;
    stopAtTheQuestion = true;
    EXPECT_THROW(makeAtlas(labs, into(folder.path())), Interrupted);
    stopAtTheQuestion = false;
    EXPECT_FALSE(fs::exists(folder / "index.html"));
    framesDrawn = 0;
    const Made made = make(into(folder.path()));
    EXPECT_EQ(made.status, ExitStatus::ok);
    EXPECT_TRUE(fs::is_regular_file(folder / "index.html"));
    // Of the first lab the question alone was missing; the second has a picture, two knobs, no stress to
    // speak of, and a plan.
    EXPECT_EQ(made.said["measured"], 1 + 5);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path()))
        EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path();
}

TEST(Atlas, KeepsTheLabsThatItIsNotAskedFor) {
    const test::TemporaryFolder folder;
    AtlasOptions options = into(folder.path());
    options.labs = {"halves"};
    EXPECT_EQ(make(options).said["labs"], 1);
    EXPECT_THAT(readFile(folder / "index.html", 1 << 20), Not(HasSubstr("99_plain_halves")));
    options.labs = {"99"};
    make(options);
    const std::string index = readFile(folder / "index.html", 1 << 20);
    EXPECT_THAT(index, HasSubstr("labs/98_halves.html"));
    EXPECT_THAT(index, HasSubstr("labs/99_plain_halves.html"));
    options.labs = {"alchemy"};
    EXPECT_THROW(makeAtlas(labs, options), InputError);
}

}  // namespace
}  // namespace quincunx::atlas

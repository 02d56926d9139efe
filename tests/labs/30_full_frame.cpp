#include <algorithm>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "image/compare.h"
#include "lab/sweep.h"
#include "lab/timing_limit.h"
#include "lab/verbs.h"
#include "labs/30_full_frame/lab.h"
#include "math/transform.h"
#include "tests/labs/lab_test.h"

namespace quincunx {
namespace {

using test::Size;

constexpr Size small{96, 72};
constexpr Size large{200, 150};

/// The lab with coarse solids and small shadow maps.
std::unique_ptr<FullFrameLab> quickLab() {
    auto lab = std::make_unique<FullFrameLab>();
    lab->tessellation.set(12);
    lab->shadowResolution.set(256);
    return lab;
}

/// With every knob away from what does nothing.
std::unique_ptr<FullFrameLab> busyLab() {
    auto lab = quickLab();
    lab->exposure.set(0.5f);
    lab->aperture.set(0.1f);
    lab->focus.set(9);
    lab->shutter.set(0.2f);
    lab->blur.set(1);
    lab->greyscale.set(0.3f);
    lab->bloom.set(0.6f);
    return lab;
}

class FullFrame30 : public testing::TestWithParam<gl::Backend> {
  protected:
    FullFrame30() : studio_(GetParam()) {}
    Frame frame(const Lab& lab, Size size) { return studio_.frame(lab, size.width, size.height); }
    Studio studio_;
};
// The other back end draws the same bits: FullFrame30Lab.DrawsTheSameBitsOnBothBackendsInTwoSizes.
INSTANTIATE_TEST_SUITE_P(On, FullFrame30, testing::Values(gl::Backend::egl), test::nameOfBackend);

TEST_P(FullFrame30, ForcingEveryEffectChangesNoBit) {
    for (const auto& make : {quickLab, busyLab}) {
        const auto lab = make();
        const Frame view = frame(*lab, small);
        const Image8 planned = studio_.picture(*lab, view);
        const Image linear = studio_.linearPicture(*lab, view);
        lab->force.set(true);
        EXPECT_EQ(studio_.picture(*lab, view), planned);
        EXPECT_EQ(studio_.linearPicture(*lab, view), linear);
    }
}

TEST_P(FullFrame30, TheSceneCallsForEveryKindOfShadowMirrorAndGlass) {
    const auto lab = quickLab();
    studio_.picture(*lab, frame(*lab, small));
    const std::vector<EffectReport> effects = lab->effects();
    for (const char* name : {"directional shadows", "spot shadows", "point shadows", "environment map",
                             "transparency order", "bloom", "tone map", "fxaa"})
        EXPECT_TRUE(std::any_of(effects.begin(), effects.end(), [&](const EffectReport& effect) {
            return effect.name == name && effect.calledFor;
        })) << name;
    for (const char* name : {"depth of field", "motion blur", "blur", "greyscale"})
        EXPECT_TRUE(std::any_of(effects.begin(), effects.end(), [&](const EffectReport& effect) {
            return effect.name == name && !effect.calledFor && effect.passes.empty();
        })) << name;
}

TEST_P(FullFrame30, LookingAwayCallsForNothing) {
    const auto lab = quickLab();
    lab->bloom.set(0);
    lab->toneCurve.set(0);
    lab->fxaa.set(false);
    Frame view = frame(*lab, small);
    view.camera.worldFromCamera = lookAt({0, 30, 0}, {0, 60, 1}, {0, 1, 0});
    const Image picture = studio_.linearPicture(*lab, view);
    for (const EffectReport& effect : lab->effects())
        EXPECT_FALSE(effect.calledFor) << effect.name << ": " << effect.reason;
    EXPECT_EQ(lab->plan().drawn, 0u);
    // What is left is the background: from its top row to its bottom row.
    EXPECT_NEAR(picture.pixel(0, 0)[2], lab->scene().backgroundTop.b, 0.01);
}

TEST_P(FullFrame30, LeavingAnEffectOutChangesThePicture) {
    const auto lab = busyLab();
    const Frame view = frame(*lab, small);
    const Image full = studio_.linearPicture(*lab, view);
    for (const EffectReport& effect : lab->effects()) {
        EXPECT_TRUE(effect.calledFor) << effect.name;
        lab->leaveOut({effect.name});
        EXPECT_NE(studio_.linearPicture(*lab, view), full) << effect.name;
    }
    lab->leaveOut({});
    EXPECT_EQ(studio_.linearPicture(*lab, view), full);
}

TEST_P(FullFrame30, TimeMovesThePlanetsAndComesBackToTheSamePicture) {
    const auto lab = quickLab();
    const Frame view = frame(*lab, small);
    const Image8 start = studio_.picture(*lab, view);
    lab->time.set(2);
    EXPECT_NE(studio_.picture(*lab, view), start);
    lab->time.set(0);
    EXPECT_EQ(studio_.picture(*lab, view), start);
}

TEST_P(FullFrame30, ThePlanIsWrittenOverThePicture) {
    const auto lab = quickLab();
    const Frame view = frame(*lab, large);
    const Image8 plain = studio_.picture(*lab, view);
    lab->showPlan.set(true);
    const Image8 written = studio_.picture(*lab, view);
    EXPECT_NE(written, plain);
    // Its lowest rows stay as they are.
    for (int y = large.height - 20; y < large.height; ++y)
        for (int x = 0; x < large.width; ++x)
            ASSERT_EQ(written.pixel(x, y)[1], plain.pixel(x, y)[1]);
}

TEST(FullFrame30Lab, DrawsTheSameBitsOnBothBackendsInTwoSizes) {
    const auto forced = [] {
        auto lab = busyLab();
        lab->force.set(true);
        return lab;
    };
    const auto written = [] {
        auto lab = quickLab();
        lab->showPlan.set(true);
        return lab;
    };
    test::expectSameBitsOnBothBackends(std::vector<test::MakeLab>{quickLab, busyLab, forced, written},
                                       {small, large});
}

TEST(FullFrame30Lab, KeepsItsBoundsWhereTheNaiveFormsDoNot) {
    FullFrameLab lab;
    test::expectStressHolds(lab);
}

TEST(FullFrame30Lab, ASweepTellsWhatEachEffectIsWorth) {
    const auto lab = quickLab();
    Studio studio(gl::Backend::automatic);
    const TimingLimit once;
    const std::vector<Sweep> sweeps = lab->sweeps();
    const Sweep& sweep = sweeps.front();
    const SweepResult result =
        runSweep(*lab, LabEntry{30, "full_frame", nullptr}, sweep, studio, studio.frame(*lab, 64, 48));
    ASSERT_EQ(result.points.size(), effects().size() + 1);
    EXPECT_EQ(result.points.front().sample.error, 0);
    const auto errorWithout = [&](const std::string& effect) {
        for (const SweepPoint& point : result.points)
            if (point.knobs.front().second == effect)
                return point.sample.error;
        ADD_FAILURE() << effect;
        return 0.0;
    };
    for (const char* effect : {"directional-shadows", "environment-map", "tone-map", "bloom"})
        EXPECT_GT(errorWithout(effect), 1e-4) << effect;
    for (const char* effect : {"blur", "greyscale"})
        EXPECT_EQ(errorWithout(effect), 0) << effect;  // not called for
}

TEST(FullFrame30Lab, FinerShadowMapsComeNearer) {
    const auto lab = quickLab();
    Studio studio(gl::Backend::automatic);
    const Frame view = studio.frame(*lab, large.width, large.height);
    const auto pictureWith = [&](int resolution) {
        lab->shadowResolution.set(resolution);
        return studio.linearPicture(*lab, view);
    };
    const Image finest = pictureWith(2048);
    double last = 1;
    for (const int resolution : {32, 128, 512}) {
        const double error = rmse(finest, pictureWith(resolution));
        EXPECT_LT(error, last) << resolution;
        last = error;
    }
}

TEST(FullFrame30Lab, BrokenShadersAreSeen) {
    struct Break {
        const char* file;
        const char* from;
        const char* to;
    };
    const Break breaks[] = {
        {"lib/frame_shadows.glsl", "if (views.y == 0)", "if (views.y >= 0)"},
        {"passes/frame_mirror.frag", "environmentRadiance(r, roughness)",
         "environmentRadiance(-r, roughness)"},
        {"passes/tone_map.frag", "exposure * seen.rgb", "seen.rgb * seen.rgb"},
    };
    const auto draw = [] {
        const auto lab = quickLab();
        Studio studio(gl::Backend::automatic);
        return studio.linearPicture(*lab, studio.frame(*lab, small.width, small.height));
    };
    const Image whole = draw();
    for (const Break& broken : breaks) {
        const test::BrokenShaders shaders(broken.file, broken.from, broken.to);
        ASSERT_TRUE(shaders.found()) << broken.file;
        EXPECT_GT(rmse(whole, draw()), 0.004) << broken.file;
    }
}

TEST(FullFrame30Plan, SaysOfEachEffectWhatSwitchingItOnChanges) {
    // Once by the plan, once by the lab's own knob on a device of its own: what can be counted is equal.
    const auto tinyLab = [] {
        auto lab = quickLab();
        lab->tessellation.set(4);
        lab->shadowResolution.set(64);
        return lab;
    };
    const auto lab = tinyLab();
    PlanOptions options;
    options.draw.backend = gl::Backend::osmesa;
    options.draw.width = 64;
    options.draw.height = 48;
    options.draw.json = true;
    options.frames = 2;
    testing::internal::CaptureStdout();
    plan(*lab, LabEntry{30, "full_frame", nullptr}, options);
    const auto reply = nlohmann::json::parse(testing::internal::GetCapturedStdout());
    Studio studio(gl::Backend::osmesa);
    const auto costWithout = [&](const std::string& effect) {
        const auto other = tinyLab();
        other->knobs().set({{"without", effect}});
        const Frame view = studio.frame(*other, 64, 48);
        // Until the targets that only the lab before had a use for are gone.
        studio.time(*other, view, 10, 0);
        return studio.cost(*other, view, 1);
    };
    const Studio::FrameCost full = costWithout("nothing");
    EXPECT_EQ(reply["gl_calls"], full.glCalls);
    EXPECT_EQ(reply["memory_bytes"], full.targetBytes);
    int rows = 0;
    for (const auto& effect : reply["effects"]) {
        if (effect["called_for"] == false)
            continue;
        ++rows;
        std::string word = effect["name"];
        std::replace(word.begin(), word.end(), ' ', '-');
        const Studio::FrameCost less = costWithout(word);
        const auto change = [](std::uint64_t with, std::uint64_t without) {
            return static_cast<std::int64_t>(with) - static_cast<std::int64_t>(without);
        };
        EXPECT_EQ(effect["gl_calls"], change(full.glCalls, less.glCalls)) << word;
        EXPECT_EQ(effect["memory_bytes"], change(full.targetBytes, less.targetBytes)) << word;
        EXPECT_TRUE(effect["gl_calls"] != 0 || effect["memory_bytes"] != 0 || word == "transparency-order")
            << word;
    }
    EXPECT_GE(rows, 8);
}

TEST(FullFrame30Goldens, TheEveningIsAsItWas) {
    FullFrameLab lab;
    lab.tessellation.set(24);
    Studio studio(gl::Backend::automatic);
    test::expectGolden(studio.picture(lab, studio.frame(lab, 240, 180)), "30_full_frame", "evening");
}

}  // namespace
}  // namespace quincunx

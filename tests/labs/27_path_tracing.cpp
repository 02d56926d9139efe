#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "image/compare.h"
#include "lab/sweep.h"
#include "labs/27_path_tracing/lab.h"
#include "labs/27_path_tracing/measure.h"
#include "passes/frame_renderer.h"
#include "tests/labs/lab_test.h"

namespace quincunx {
namespace {

std::unique_ptr<PathTracingLab> smallLab(const char* subject = "chamber") {
    auto lab = std::make_unique<PathTracingLab>();
    lab->subject.parse(subject);
    lab->samples.set(2);
    return lab;
}

TEST(PathTracing27, BothBackendsShowTheSameBits) {
    test::expectSameBitsOnBothBackends([] { return smallLab(); }, {{64, 48}, {33, 57}});
}

TEST(PathTracing27, TheFurnaceIsAsBrightAsItsClosedForm) {
    const auto lab = smallLab("furnace");
    lab->terms.set(false);
    lab->samples.set(64);
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(*lab, 32, 24);
    const Image exact = lab->reference(frame)({});
    const auto verdict = [&] {
        const Image picture = studio.linearPicture(*lab, frame);
        EXPECT_TRUE(test::isFinite(picture));
        double mean = 0;
        for (std::size_t i = 0; i < picture.data.size(); i += 4)
            mean += picture.data[i] / static_cast<double>(picture.pixelCount());
        return std::abs(mean - 2) / 2;
    };
    // 49 152 paths whose standard deviation is about 2: 0.5 % is the limit's fifth. Measured 0.0004.
    constexpr double limit = 0.02;
    EXPECT_LE(verdict(), limit);
    for (const auto& [from, to] :
         {std::pair("exposure * texel", "0.9 * exposure * texel"), std::pair("- 1 - at.y", "- at.y")}) {
        const test::BrokenShaders broken("labs/27_path_tracing/show.frag", from, to);
        ASSERT_TRUE(broken.found()) << from;
        Studio another(gl::Backend::egl);
        const auto again = smallLab("furnace");
        again->terms.set(false);
        const Image picture = another.linearPicture(*again, another.frame(*again, 32, 24));
        const auto whole = smallLab("furnace");
        whole->terms.set(false);
        const Image right = studio.linearPicture(*whole, frame);
        EXPECT_GT(test::largestDifference(picture, right), 0.1) << from;
    }
    EXPECT_EQ(exact.pixel(0, 0)[0], 2);
}

TEST(PathTracing27, EveryKnobChangesThePicture) {
    Studio studio(gl::Backend::egl);
    const auto picture = [&](const char* name, const char* value, const char* subject = "chamber") {
        const auto lab = smallLab(subject);
        if (std::string(name) == "branches")
            lab->method.parse("tree");
        if (std::string(subject) == "furnace")
            lab->exposure.set(0.05f);
        if (name[0] != '\0')
            lab->knobs().find(name).parse(value);
        return studio.picture(*lab, studio.frame(*lab, 40, 30));
    };
    const Image8 plain = picture("", "");
    for (const auto& [name, value] :
         {std::pair("subject", "balls"), std::pair("method", "naive"), std::pair("method", "nee"),
          std::pair("method", "tree"), std::pair("samples", "1"), std::pair("bounces", "1"),
          std::pair("roulette", "0.1"), std::pair("cutoff", "0.5"), std::pair("branches", "2"),
          std::pair("numbers", "independent"), std::pair("clamp", "0.3"), std::pair("exposure", "2"),
          std::pair("terms", "off"), std::pair("pick-x", "0.7"), std::pair("pick-y", "0.2")})
        EXPECT_NE(picture(name, value), plain) << name;
    EXPECT_NE(picture("albedo", "0.9", "furnace"), picture("", "", "furnace"));
}

TEST(PathTracing27, AWindowGoesOnWhereItIs) {
    Studio studio(gl::Backend::egl);
    const auto lab = smallLab();
    Frame frame = studio.frame(*lab, 24, 18);
    frame.live = true;
    lab->samples.set(64);
    const auto settle = [&] {
        while (studio.linearPicture(*lab, frame), lab->isConverging()) {
        }
        return studio.linearPicture(*lab, frame);
    };
    const Image settled = settle();
    Frame at = frame;
    at.live = false;
    const auto whole = smallLab();
    whole->samples.set(64);
    EXPECT_EQ(settled, studio.linearPicture(*whole, at));
    // A whole frame of another size, as the error is measured with, lets it rest as it is.
    at.width = 12;
    at.height = 9;
    studio.linearPicture(*lab, at);
    EXPECT_FALSE(lab->isConverging());
    const auto rays = lab->counters();
    EXPECT_EQ(studio.linearPicture(*lab, frame), settled);
    EXPECT_NE(lab->counters(), rays);
    // A knob begins it anew.
    lab->method.parse("nee");
    EXPECT_NE(settle(), settled);
    lab->method.parse("mis");
    EXPECT_EQ(settle(), settled);
}

TEST(PathTracing27Goldens, LookAsTheyDid) {
    Studio studio(gl::Backend::egl);
    const auto lab = smallLab();
    lab->samples.set(8);
    test::expectGolden(studio.picture(*lab, studio.frame(*lab, 96, 72)), "27_path_tracing", "chamber");
}

TEST(PathTracing27Answers, AllHold) {
    PathTracingLab lab;
    Studio studio(gl::Backend::automatic);
    test::expectAnswersHold(lab, studio, {24, 49, 68, 84});
}

TEST(PathTracing27Stress, StableFormsKeepTheirBoundsWhereNaiveOnesDoNot) {
    PathTracingLab lab;
    test::expectStressHolds(lab, 2000);
}

TEST(PathTracing27Sweeps, EndingsTradeTimeForErrorAgainstTheClosedForm) {
    PathTracingLab lab;
    Studio studio(gl::Backend::egl);
    for (Sweep& sweep : lab.sweeps()) {
        EXPECT_GE(sweep.points.size(), 5u);
        if (sweep.name != "endings")
            continue;
        const KnobScope scope(lab.knobs());
        const Frame frame = studio.frame(lab, 12, 9);
        const auto at = [&](const char* roulette, const char* cutoff, const char* samples) {
            lab.knobs().set({{"roulette", roulette},
                             {"cutoff", cutoff},
                             {"bounces", "1000"},
                             {"samples", samples},
                             {"method", "naive"},
                             {"subject", "furnace"},
                             {"albedo", "0.8"},
                             {"numbers", "independent"}});
            return sweep.measure(studio, frame);
        };
        const SweepSample few = at("1", "0", "4");
        const SweepSample many = at("1", "0", "64");
        // Sixteen times the paths: a quarter of the error, by slope −½; 108 pixels know it to 7 %.
        EXPECT_NEAR(std::log(many.error / few.error) / std::log(16.0), -0.5, 0.06);
        const SweepSample longer = at("0.05", "0", "64");
        EXPECT_LT(longer.error, many.error) << "later roulette, longer paths, less noise";
        EXPECT_GT(longer.counters.at("rays"), many.counters.at("rays"));
        // A cutoff loses light however many paths there are: 0.8^n below 0.1 from the eleventh surface on.
        EXPECT_NEAR(at("0", "0.1", "4").error, std::sqrt(0.75) * 5 * std::pow(0.8, 11), 1e-3);
    }
}

/// The still life as OpenGL draws it with shadow maps.
class RasterFrame final : public Lab {
  public:
    explicit RasterFrame(const Scene& scene) : scene_(scene) {
        settings_.shadowRadius = 0;
        settings_.leftOut.set(findEffect("environment map"));
    }
    std::string topic() const override { return "raster"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override {
        return renderer_.build(graph, {.scene = scene_,
                                       .camera = frame.camera,
                                       .width = frame.width,
                                       .height = frame.height,
                                       .settings = settings_,
                                       .pictureFormat = frame.pictureFormat});
    }
    Camera defaultCamera() const override { return scene_.cameras.front(); }
    Bounds sceneBounds() const override { return scene_.bounds(); }

  private:
    const Scene& scene_;
    FrameSettings settings_;
    FrameRenderer renderer_;
};

TEST(PathTracing27, DirectLightIsWhatOpenGlDraws) {
    const StillLife life = makeStillLife();
    Scene scene = tessellate(life, 48);
    scene.cameras = {life.camera};
    const TraceScene traced(scene);
    RasterFrame raster(scene);
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(raster, 120, 90);
    const Image drawn = studio.linearPicture(raster, frame);
    // Sorted differences of the pixels' largest channel.
    std::vector<double> off;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const Ray ray = cameraRay(frame.camera, frame.width, frame.height, glm::vec2(x, y) + 0.5f);
            const std::optional<glm::vec3> light = traceDirect(traced, ray);
            if (!light)
                continue;
            double largest = 0;
            for (int c = 0; c < 3; ++c)
                largest =
                    std::max(largest, std::abs(static_cast<double>((*light)[c]) - drawn.pixel(x, y)[c]));
            off.push_back(largest);
        }
    std::sort(off.begin(), off.end());
    ASSERT_GT(off.size(), 4000u);
    // Nine of ten pixels are the same but for rounding; the rest lie at the edges of shadows, which the maps
    // sample, and at outlines.
    EXPECT_LT(off[off.size() / 2], 1e-5);
    EXPECT_LT(off[off.size() * 9 / 10], 1e-3);
    EXPECT_LT(std::count_if(off.begin(), off.end(), [](double d) { return d > 0.02; }),
              static_cast<std::ptrdiff_t>(off.size() / 15));
}

}  // namespace
}  // namespace quincunx

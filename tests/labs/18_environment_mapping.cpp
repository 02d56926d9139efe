#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include <gtest/gtest.h>

#include "base/error.h"
#include "gl/calls.h"
#include "image/compare.h"
#include "image/io.h"
#include "lab/studio.h"
#include "lab/timing_limit.h"
#include "labs/18_environment_mapping/lab.h"
#include "labs/18_environment_mapping/mirror_figures.h"
#include "tests/labs/lab_test.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::Size;
using Reflector = EnvironmentMappingLab::Reflector;
using Source = EnvironmentMappingLab::Source;
using View = EnvironmentMappingLab::View;

constexpr Size small{64, 48};
constexpr Size large{160, 120};

/// The lab with one sample a pixel.
std::unique_ptr<EnvironmentMappingLab> plainLab(Reflector reflector = Reflector::both) {
    auto lab = std::make_unique<EnvironmentMappingLab>();
    lab->supersample.set(1);
    lab->reflector.set(static_cast<int>(reflector));
    lab->resolution.set(256);
    lab->tessellation.set(24);
    return lab;
}

/// The mean error over the ball, or over the plane where there is only that.
struct TracedHall {
    Image picture;
    Image vectors;
};

TracedHall traceHall(const EnvironmentMappingLab& lab, const Frame& frame) {
    const MirrorHall hall = lab.currentHall();
    return {traceMirrors(hall, frame.camera, frame.width, frame.height, lab.mirrors()),
            traceReflectionVectors(hall, frame.camera, frame.width, frame.height, lab.mirrors())};
}

double errorOf(EnvironmentMappingLab& lab, Studio& studio, const Frame& frame, const TracedHall& traced) {
    return compareMirrors(studio.linearPicture(lab, frame), traced.picture, traced.vectors,
                          lab.mirrors().ball ? 1 : 2)
        .meanError;
}

double errorOf(EnvironmentMappingLab& lab, Studio& studio, const Frame& frame) {
    return errorOf(lab, studio, frame, traceHall(lab, frame));
}

class EnvironmentMapping18 : public testing::TestWithParam<gl::Backend> {
  protected:
    EnvironmentMapping18() : studio_(GetParam()) {}
    Frame frame(const Lab& lab, Size size) { return studio_.frame(lab, size.width, size.height); }
    Studio studio_;
};
// The other back end draws the same bits: EnvironmentMapping18Backends.
INSTANTIATE_TEST_SUITE_P(On, EnvironmentMapping18, testing::Values(gl::Backend::egl), test::nameOfBackend);

TEST_P(EnvironmentMapping18, ABoxProjectedMapOfTheEmptyHallIsTheTracedReflectionInBothSizes) {
    for (const Reflector reflector : {Reflector::ball, Reflector::plane})
        for (const Size size : {small, large}) {
            const auto lab = plainLab(reflector);
            lab->solids.set(false);
            lab->boxProjection.set(true);
            const double error = errorOf(*lab, studio_, frame(*lab, size));
            EXPECT_LE(error, 0.02) << static_cast<int>(reflector) << " at " << size.width;
        }
}

TEST_P(EnvironmentMapping18, ErrorsFallWithTheDistanceOfWhatIsReflected) {
    for (const Reflector reflector : {Reflector::ball, Reflector::plane}) {
        const auto lab = plainLab(reflector);
        lab->resolution.set(512);
        double last = 1;
        for (const float distance : {1.0f, 4.0f, 16.0f}) {
            lab->distance.set(distance);
            const double error = errorOf(*lab, studio_, frame(*lab, large));
            // Measured 0.31 and 0.25 of the last for the ball, 0.56 and 0.41 for the plane.
            EXPECT_LT(error, 0.7 * last) << static_cast<int>(reflector) << " at " << distance;
            last = error;
        }
    }
}

TEST_P(EnvironmentMapping18, TheSurroundingsOfTheMirrorsAreTheTracedOnes) {
    const auto lab = plainLab();
    const Frame view = frame(*lab, large);
    const Image drawn = studio_.linearPicture(*lab, view);
    const Image traced = traceMirrors(lab->currentHall(), view.camera, large.width, large.height);
    const Image vectors = traceReflectionVectors(lab->currentHall(), view.camera, large.width, large.height);
    const MirrorFigures off = compareMirrors(drawn, traced, vectors, 0);
    EXPECT_GT(off.pixels, 6000u);
    EXPECT_LE(off.meanError, 0.003);
}

TEST_P(EnvironmentMapping18, APanoramaOfTheHallShowsWhatSixViewsShow) {
    for (const Reflector reflector : {Reflector::ball, Reflector::plane}) {
        const auto lab = plainLab(reflector);
        lab->resolution.set(256);
        const Frame view = frame(*lab, large);
        const Image rendered = studio_.linearPicture(*lab, view);
        lab->source.set(static_cast<int>(Source::panorama));
        const Image fromPanorama = studio_.linearPicture(*lab, view);
        const Image vectors = traceReflectionVectors(lab->currentHall(), view.camera, large.width,
                                                     large.height, lab->mirrors());
        EXPECT_LE(compareMirrors(rendered, fromPanorama, vectors, lab->mirrors().ball ? 1 : 2).meanError,
                  0.03);
    }
}

TEST_P(EnvironmentMapping18, AStillMapDoesNotSeeWhatMoves) {
    const auto lab = plainLab(Reflector::ball);
    const Frame view = frame(*lab, large);
    lab->source.set(static_cast<int>(Source::still));
    const Image before = studio_.linearPicture(*lab, view);
    const Image vectors =
        traceReflectionVectors(lab->currentHall(), view.camera, large.width, large.height, lab->mirrors());
    lab->turn.set(40);
    const Image after = studio_.linearPicture(*lab, view);
    lab->source.set(static_cast<int>(Source::rendered));
    const Image rendered = studio_.linearPicture(*lab, view);
    EXPECT_EQ(compareMirrors(before, after, vectors, 1).meanError, 0);
    EXPECT_GT(compareMirrors(rendered, after, vectors, 1).meanError, 0.005);
}

TEST_P(EnvironmentMapping18, RoughnessBlursAndKeepsTheLight) {
    const auto lab = plainLab(Reflector::ball);
    lab->resolution.set(128);
    lab->samples.set(32);
    const Frame view = frame(*lab, small);
    const Image vectors =
        traceReflectionVectors(lab->currentHall(), view.camera, small.width, small.height, lab->mirrors());
    double lastContrast = 1e9;
    for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
        lab->roughness.set(roughness);
        const Image picture = studio_.linearPicture(*lab, view);
        EXPECT_TRUE(test::isFinite(picture));
        double steps = 0;
        for (int y = 1; y < small.height; ++y)
            for (int x = 1; x < small.width; ++x)
                if (vectors.pixel(x, y)[3] == 1 && vectors.pixel(x - 1, y)[3] == 1)
                    steps +=
                        std::abs(static_cast<double>(picture.pixel(x, y)[1]) - picture.pixel(x - 1, y)[1]);
        EXPECT_LT(steps, lastContrast) << roughness;
        lastContrast = steps;
    }
}

TEST_P(EnvironmentMapping18, ReflectionVectorsAreShownAsTheyAre) {
    const auto lab = plainLab();
    lab->view.set(static_cast<int>(View::vectors));
    lab->tessellation.set(128);
    const Frame view = frame(*lab, large);
    const Image shown = studio_.linearPicture(*lab, view);
    const Image vectors = traceReflectionVectors(lab->currentHall(), view.camera, large.width, large.height);
    Image expected = vectors;
    for (std::size_t p = 0; p < expected.pixelCount(); ++p)
        for (std::size_t c = 0; c < 3; ++c)
            expected.data[4 * p + c] = 0.5f + 0.5f * vectors.data[4 * p + c];
    for (const int mirror : {1, 2}) {
        const MirrorFigures off = compareMirrors(shown, expected, vectors, mirror);
        EXPECT_GT(off.pixels, 500u);
        // Directions from interpolated positions and normals in float; the ball is a polyhedron.
        EXPECT_LE(off.meanError, mirror == 1 ? 1e-2 : 1e-4);
    }
}

TEST_P(EnvironmentMapping18, EverySizeFromOnePixelAndOneTexelOnIsDrawn) {
    for (const Size size : {Size{1, 1}, Size{1, 48}, Size{48, 1}})
        EXPECT_TRUE(test::isFinite(studio_.linearPicture(*plainLab(), frame(*plainLab(), size))));
    const auto lab = plainLab();
    for (const int texels : {1, 2, 3}) {
        lab->resolution.set(texels);
        for (const float roughness : {0.0f, 0.7f}) {
            lab->roughness.set(roughness);
            EXPECT_TRUE(test::isFinite(studio_.linearPicture(*lab, frame(*lab, small)))) << texels;
        }
    }
}

TEST_P(EnvironmentMapping18, EveryViewIsDrawn) {
    const auto lab = plainLab();
    for (int view = 0; view < 5; ++view) {
        lab->view.set(view);
        const Image picture = studio_.linearPicture(*lab, frame(*lab, small));
        EXPECT_TRUE(test::isFinite(picture)) << view;
        EXPECT_GT(std::accumulate(picture.data.begin(), picture.data.end(), 0.0), 0.0) << view;
    }
}

TEST(EnvironmentMapping18Panoramas, FilesAreReadAndMissingOnesAreOneLine) {
    const test::TemporaryFolder folder;
    Image sky(64, 32, 3, Encoding::linear);
    std::fill(sky.data.begin(), sky.data.end(), 0.25f);
    sky.data[5] = std::nanf("");
    sky.data[7] = -1;
    const auto file = folder / "sky.exr";
    writeImage(file, sky);
    Studio studio(gl::Backend::egl);
    const auto lab = plainLab(Reflector::ball);
    lab->source.set(static_cast<int>(Source::panorama));
    lab->panorama.set(file.string());
    const Frame view = studio.frame(*lab, small.width, small.height);
    EXPECT_TRUE(test::isFinite(studio.linearPicture(*lab, view)));
    lab->panorama.set((folder / "none.exr").string());
    EXPECT_THROW(studio.linearPicture(*lab, view), InputError);
}

TEST(EnvironmentMapping18Backends, OsmesaAndEglGiveTheSameBits) {
    std::vector<test::MakeLab> makers = {[] { return plainLab(); }};
    test::expectSameBitsOnBothBackends(makers, {small, large});
    makers.clear();
    for (const KnobValues& values : std::vector<KnobValues>{{{"roughness", "0.5"}},
                                                            {{"box-projection", "on"}, {"solids", "off"}},
                                                            {{"map", "panorama"}, {"reflector", "plane"}},
                                                            {{"view", "vectors"}},
                                                            {{"view", "faces"}, {"seamless", "off"}},
                                                            {{"resolution", "3"}, {"roughness", "0.7"}}})
        makers.emplace_back([values] {
            auto lab = plainLab();
            lab->resolution.set(64);
            lab->samples.set(16);
            lab->knobs().set(values);
            return lab;
        });
    test::expectSameBitsOnBothBackends(makers, {small});
}

TEST(EnvironmentMapping18Mutations, EveryBrokenShaderIsNoticed) {
    std::optional<TracedHall> traced;
    const auto error = [&traced] {
        const auto lab = plainLab(Reflector::plane);
        lab->solids.set(false);
        lab->boxProjection.set(true);
        Studio studio(gl::Backend::egl);
        const Frame frame = studio.frame(*lab, large.width, large.height);
        if (!traced)
            traced = traceHall(*lab, frame);
        return errorOf(*lab, studio, frame, *traced);
    };
    constexpr double limit = 0.02;
    EXPECT_LE(error(), limit);
    const std::vector<std::array<const char*, 3>> mutations = {
        {"lib/environment_math.glsl", "d.x > 0.0f ? boxMax.x : boxMin.x", "d.x > 0.0f ? boxMin.x : boxMax.x"},
        {"lib/environment_math.glsl", "clamp(p + t * d, boxMin, boxMax) - mapWorld", "p + t * d"},
        {"lib/environment.glsl", "textureLod(environmentMap, d,", "textureLod(environmentMap, -d,"},
        {"lib/environment.glsl", "environmentBoxMin.w == 0.0", "environmentBoxMin.w == 1.0"},
        {"lib/phong.glsl", "(2.0f * dot(n, towardsSurface))", "(1.0f * dot(n, towardsSurface))"},
        {"labs/18_environment_mapping/mirror.frag", "specular.rgb *", "0.5 * specular.rgb *"},
    };
    for (const auto& [file, from, to] : mutations) {
        const test::BrokenShaders broken(file, from, to);
        ASSERT_TRUE(broken.found()) << file << " no longer holds: " << from;
        EXPECT_GT(error(), limit) << file << ": " << from << " -> " << to;
    }
}

TEST(EnvironmentMapping18Goldens, LookAsTheyDid) {
    Studio studio(gl::Backend::egl);
    const auto golden = [&](EnvironmentMappingLab& lab, const char* name) {
        test::expectGolden(studio.picture(lab, studio.frame(lab, 160, 120)), "18_environment_mapping", name);
    };
    EnvironmentMappingLab picture;
    golden(picture, "picture");
    EnvironmentMappingLab rough;
    rough.resolution.set(128);
    rough.roughness.set(0.4f);
    golden(rough, "rough");
    EnvironmentMappingLab faces;
    faces.resolution.set(128);
    faces.view.parse("faces");
    golden(faces, "faces");
}

TEST(EnvironmentMapping18Answers, AllHold) {
    EnvironmentMappingLab lab;
    Studio studio(gl::Backend::automatic);
    test::expectAnswersHold(lab, studio, {95});
}

TEST(EnvironmentMapping18Stress, StableFormsKeepTheirBoundsWhereNaiveOnesDoNot) {
    EnvironmentMappingLab lab;
    test::expectStressHolds(lab);
}

TEST(EnvironmentMapping18Sweeps, ErrorsFallWithTexelsAndWithSamples) {
    EnvironmentMappingLab lab;
    Studio studio(gl::Backend::egl);
    const TimingLimit once;
    std::vector<Sweep> sweeps = lab.sweeps();
    ASSERT_EQ(sweeps.size(), 2u);
    const auto errors = [&](const Sweep& sweep, const std::vector<std::size_t>& points) {
        std::vector<double> found;
        const KnobScope scope(lab.knobs());
        const Frame frame = studio.frame(lab, 160, 120);
        for (const std::size_t point : points) {
            lab.knobs().set(sweep.points[point]);
            found.push_back(sweep.measure(studio, frame).error);
        }
        return found;
    };
    EXPECT_GE(sweeps[0].points.size(), 5u);
    EXPECT_GE(sweeps[1].points.size(), 5u);
    const std::vector<double> texels = errors(sweeps[0], {7, 9, 11});  // 16, 64, 256, box-projected
    EXPECT_LT(texels[1], 0.7 * texels[0]);
    EXPECT_LT(texels[2], 0.7 * texels[1]);
    const std::vector<double> samples = errors(sweeps[1], {0, 1, 2, 3});
    for (std::size_t i = 1; i < samples.size(); ++i)
        EXPECT_LT(samples[i], samples[i - 1]) << i;
    const std::vector<double> filtered = errors(sweeps[1], {6, 7});
    EXPECT_LT(filtered[0], samples[1]);
    EXPECT_LT(filtered[1], samples[2]);
}

}  // namespace
}  // namespace quincunx

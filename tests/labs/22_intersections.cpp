#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "image/compare.h"
#include "labs/22_intersections/lab.h"
#include "labs/22_intersections/triangle_cases.h"
#include "tests/labs/lab_test.h"

namespace quincunx {
namespace {

using test::Size;

constexpr Size small{64, 40};
constexpr Size large{120, 66};

class Intersections22 : public testing::TestWithParam<gl::Backend> {
  protected:
    Intersections22() : studio_(GetParam()) {
        lab_.supersample.set(1);
        lab_.probe.set(false);
        lab_.view.parse("scene");
    }
    Frame frame(Size size) { return studio_.frame(lab_, size.width, size.height); }

    IntersectionsLab lab_;
    Studio studio_;
};

INSTANTIATE_TEST_SUITE_P(On, Intersections22, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         test::nameOfBackend);

/// What the window shows against what was cast: the two must not differ by a bit.
double shownAgainstCast(IntersectionsLab& lab, Studio& studio, Size size) {
    const Frame frame = studio.frame(lab, size.width, size.height);
    const Lens lens = lab.lens(frame, static_cast<double>(size.width) / size.height);
    Cast cast = castScene(lab.exhibits(), lens, lens.clipFromLocal(glm::dvec3(0)), size.width, size.height,
                          lab.approach(), lab.supersample);
    for (std::size_t i = 3; i < cast.color.data.size(); i += 4)
        cast.color.data[i] = 1;
    return test::largestDifference(cast.color, studio.linearPicture(lab, frame));
}

TEST_P(Intersections22, PictureIsTheRaysThatWereCastInBothSizes) {
    for (const Size size : {small, large})
        for (const char* method : {"naive", "careful", "double", "stable", "exact"}) {
            lab_.method.parse(method);
            EXPECT_EQ(shownAgainstCast(lab_, studio_, size), 0) << method;
        }
}

TEST_P(Intersections22, PictureShowsEveryShapeAndItsColor) {
    lab_.method.parse("stable");
    lab_.distance.set(1);
    const Image empty = [&] {
        lab_.shape.parse("plane");
        return studio_.linearPicture(lab_, frame(small));
    }();
    for (const char* shape : {"sphere", "cylinder", "can", "box", "triangle", "polygon", "all"}) {
        lab_.shape.parse(shape);
        const Image picture = studio_.linearPicture(lab_, frame(small));
        EXPECT_TRUE(test::isFinite(picture)) << shape;
        EXPECT_GT(test::largestDifference(picture, empty), 0.1) << shape;
    }
}

TEST_P(Intersections22, FarAndMovedScenesLookTheSameToTheStableForms) {
    // The same view from afar, with what perspective there is taken out of it: compare two far ones.
    lab_.method.parse("stable");
    lab_.distance.set(128);
    const Image near = studio_.linearPicture(lab_, frame(large));
    lab_.distance.set(256);
    const Image far = studio_.linearPicture(lab_, frame(large));
    // Measured: 0.012; what is left is perspective of 1/128 and rays rounded to float.
    EXPECT_LE(rmse(near, far), 0.03);
    lab_.method.parse("naive");
    lab_.distance.set(2048);
    EXPECT_GT(rmse(near, studio_.linearPicture(lab_, frame(large))), 0.05);
    // Moved by whole numbers, the shapes are the same and the rays' origins rounded.
    lab_.method.parse("stable");
    lab_.distance.set(1);
    const Image here = studio_.linearPicture(lab_, frame(large));
    lab_.offset.set(4096);
    // 2^-24 · 4096 units at most, a fortieth of a pixel: only outlines and tile edges change.
    EXPECT_LE(rmse(here, studio_.linearPicture(lab_, frame(large))), 0.03);
}

TEST_P(Intersections22, ShownRayPointsAtItsHit) {
    lab_.method.parse("stable");
    lab_.distance.set(1);
    const Size size{160, 100};
    const Image without = studio_.linearPicture(lab_, frame(size));
    lab_.probe.set(true);
    const Image with = studio_.linearPicture(lab_, frame(size));
    const Ray ray = lab_.probeRay();
    const Seen seen = look(lab_.exhibits(), ray, lab_.approach());
    ASSERT_EQ(seen.exhibit, 0);
    const Lens lens = lab_.lens(frame(size), 1.6);
    // Along the normal's arrow the picture has become the arrow's blue.
    const glm::vec3 onArrow = seen.hit.point + 0.4f * seen.hit.normal;
    const auto pixel =
        pixelOf(onArrow, glm::mat4(lens.clipFromLocal(glm::dvec3(0))), {size.width, size.height});
    ASSERT_TRUE(pixel);
    const auto x = static_cast<int>(pixel->x);
    const auto y = static_cast<int>(pixel->y);
    double bluer = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const float* a = without.pixel(x + dx, y + dy);
            const float* b = with.pixel(x + dx, y + dy);
            bluer = std::max(bluer, static_cast<double>(b[2] - b[0]) - (a[2] - a[0]));
        }
    EXPECT_GT(bluer, 0.3);
}

std::uint64_t wrongOf(IntersectionsLab& lab) {
    const auto counters = lab.counters();
    return counters.at("false hits") + counters.at("false misses") + counters.at("wrong t");
}

TEST_P(Intersections22, MapIsEmptyForBoundedAndExactFormsAndFillsWithDistanceForNaiveOnes) {
    lab_.view.parse("map");
    for (const float distance : {1.0f, 64.0f, 4096.0f})
        for (const char* method : {"stable", "exact"}) {
            lab_.method.parse(method);
            lab_.distance.set(distance);
            studio_.linearPicture(lab_, frame(small));
            EXPECT_EQ(wrongOf(lab_), 0u) << method << " " << distance;
        }
    lab_.method.parse("naive");
    lab_.shape.parse("sphere");
    std::uint64_t last = 0;
    for (const float distance : {64.0f, 512.0f, 4096.0f}) {
        lab_.distance.set(distance);
        studio_.linearPicture(lab_, frame(small));
        const auto counters = lab_.counters();
        const std::uint64_t wrong = counters.at("false hits") + counters.at("false misses");
        EXPECT_GT(wrong, last) << distance;
        last = wrong;
    }
}

TEST_P(Intersections22, MapColorsWhatItCounts) {
    lab_.view.parse("map");
    lab_.shape.parse("sphere");
    lab_.method.parse("naive");
    lab_.distance.set(512);
    const Image map = studio_.linearPicture(lab_, frame(large));
    std::uint64_t red = 0;
    for (int y = 0; y < map.height * 6 / 10; ++y)  // above the legend
        for (int x = 0; x < map.width; ++x)
            red += map.pixel(x, y)[0] > 0.9f && map.pixel(x, y)[1] < 0.1f;
    EXPECT_GT(red, 10u);
    EXPECT_LE(red, lab_.counters().at("false hits"));
}

TEST_P(Intersections22, BesideIsTheSceneAndTheMap) {
    lab_.distance.set(200);
    lab_.view.parse("beside");
    const Image both = studio_.linearPicture(lab_, frame({128, 66}));
    lab_.view.parse("scene");
    const Image scene = studio_.linearPicture(lab_, frame({64, 66}));
    double worst = 0;
    for (int y = 0; y < 66; ++y)
        for (int x = 0; x < 60; ++x)
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst,
                                 std::abs(static_cast<double>(both.pixel(x, y)[c]) - scene.pixel(x, y)[c]));
    EXPECT_EQ(worst, 0);
}

TEST(Intersections22Backends, OsmesaAndEglGiveTheSameBits) {
    for (const char* view : {"scene", "map", "beside"})
        test::expectSameBitsOnBothBackends(
            [&] {
                auto lab = std::make_unique<IntersectionsLab>();
                lab->view.parse(view);
                lab->supersample.set(1);
                return lab;
            },
            {small, large});
}

struct Mutation {
    const char* from;
    const char* to;
};

TEST(Intersections22Mutations, ABrokenShaderFailsTheTestOfThePicture) {
    for (const Mutation& mutation :
         {Mutation{"textureSize(rays, 0).y - 1 - at.y", "at.y"}, Mutation{"texel.rgb", "texel.rbg"},
          Mutation{"ivec2(gl_FragCoord.xy)", "ivec2(gl_FragCoord.xy) / 2"}}) {
        const test::BrokenShaders broken("labs/22_intersections/show.frag", mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.from;
        IntersectionsLab lab;
        lab.supersample.set(1);
        lab.probe.set(false);
        lab.view.parse("scene");
        Studio studio(gl::Backend::egl);
        EXPECT_GT(shownAgainstCast(lab, studio, small), 0.1) << mutation.from;
    }
}

TEST(Intersections22Mutations, ADepthThatIsNotWrittenShowsTheRayThroughTheShapes) {
    const auto picture = [] {
        IntersectionsLab lab;
        lab.method.parse("stable");
        lab.view.parse("scene");
        lab.supersample.set(1);
        lab.distance.set(1);
        Studio studio(gl::Backend::egl);
        return studio.linearPicture(lab, studio.frame(lab, 160, 100));
    };
    const Image right = picture();
    const test::BrokenShaders broken("labs/22_intersections/show.frag", "gl_FragDepth = texel.a",
                                     "gl_FragDepth = 1.0");
    ASSERT_TRUE(broken.found());
    EXPECT_GT(test::largestDifference(right, picture()), 0.1);
}

TEST(Intersections22Routines, EveryMethodAgreesWithExactArithmeticNearby) {
    // One unit away nothing is hard: all methods see the same shapes, but for a few rays at outlines.
    IntersectionsLab lab;
    lab.distance.set(1);
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(lab, 96, 60);
    const Lens lens = lab.lens(frame, 1.6);
    for (int method = 0; method < 5; ++method) {
        lab.method.set(method);
        int wrong = 0;
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 96; ++x) {
                const Verdict verdict =
                    judge(lab.exhibits(), lens.rayAt((x + 0.5) / 96, (y + 0.5) / 60), lab.approach()).verdict;
                wrong += verdict == Verdict::falseHit || verdict == Verdict::falseMiss;
            }
        EXPECT_LE(wrong, method >= 3 ? 0 : 6) << lab.method.text();
    }
}

TEST(Intersections22Routines, HitsHaveUnitNormalsTowardsTheRay) {
    IntersectionsLab lab;
    lab.distance.set(1);
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(lab, 48, 30);
    const Lens lens = lab.lens(frame, 1.6);
    int hits = 0;
    for (int method = 0; method < 5; ++method) {
        lab.method.set(method);
        for (const Exhibit& exhibit : lab.exhibits())
            for (int y = 0; y < 30; ++y)
                for (int x = 0; x < 48; ++x) {
                    const Ray ray = lens.rayAt((x + 0.5) / 48, (y + 0.5) / 30);
                    const std::optional<RayHit> hit = meet(exhibit, ray, lab.approach());
                    if (!hit)
                        continue;
                    ++hits;
                    EXPECT_NEAR(glm::length(hit->normal), 1, 1e-6) << exhibit.name;
                    EXPECT_LE(glm::dot(hit->normal, ray.direction), 1e-4f) << exhibit.name;
                }
    }
    EXPECT_GT(hits, 1000);
}

TEST(Intersections22Reference, IsThePictureOfTheStableRoutinesWhereNothingIsDrawnOverIt) {
    IntersectionsLab lab;
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(lab, 96, 72);
    EXPECT_FALSE(lab.reference(frame));
    lab.view.parse("scene");
    EXPECT_FALSE(lab.reference(frame));
    lab.probe.set(false);
    lab.distance.set(512);
    const Lab::ReferenceJob job = lab.reference(frame);
    ASSERT_TRUE(job);
    std::atomic<bool> stop = false;
    const Image reference = job(stop);
    lab.method.parse("stable");
    EXPECT_EQ(rmse(reference, studio.linearPicture(lab, frame)), 0);
    lab.method.parse("naive");
    EXPECT_GT(rmse(reference, studio.linearPicture(lab, frame)), 0.05);
    stop = true;
    EXPECT_NE(job(stop), reference);
}

TEST(Intersections22Pictures, AreThoseOfTheRepository) {
    IntersectionsLab lab;
    Studio studio(gl::Backend::osmesa);
    test::expectGolden(studio.picture(lab, studio.frame(lab, 320, 140)), "22_intersections", "beside");
    lab.view.parse("scene");
    lab.method.parse("stable");
    lab.distance.set(1);
    test::expectGolden(studio.picture(lab, studio.frame(lab, 240, 150)), "22_intersections", "scene");
}

TEST(Intersections22Answers, AllHold) {
    IntersectionsLab lab;
    Studio studio(gl::Backend::automatic);
    test::expectAnswersHold(lab, studio, {15, 16, 17, 43, 44, 79, 80, 106, 107});
}

TEST(Intersections22Stress, StableFormsKeepTheirBoundsWhereNaiveOnesDoNot) {
    IntersectionsLab lab;
    test::expectStressHolds(lab, 2000);
}

/// Errors and counters at the points; the times are not looked at.
TEST(Intersections22Sweeps, ErrorsFallFromFloatToExact) {
    IntersectionsLab lab;
    Studio studio(gl::Backend::egl);
    for (Sweep& sweep : lab.sweeps()) {
        ASSERT_GE(sweep.points.size(), 5u);
        std::vector<double> errors;
        for (const KnobValues& point : sweep.points) {
            const KnobScope scope(lab.knobs());
            lab.knobs().set(point);
            const SweepSample sample = sweep.measure(studio, studio.frame(lab, 40, 30));
            errors.push_back(sample.error);
            EXPECT_EQ(sample.counters.at("rays"), 1200u);
        }
        if (sweep.name == "triangles") {
            for (std::size_t i = 0; i + 1 < errors.size(); ++i)
                EXPECT_GT(errors[i], errors.back()) << sweep.points[i].back().second;
            EXPECT_EQ(errors.back(), 0);
            continue;
        }
        // naive > careful > double > stable ≥ exact
        EXPECT_GT(errors[0], errors[1]) << sweep.name;
        EXPECT_GT(errors[1], errors[2]) << sweep.name;
        EXPECT_LE(errors[3], errors[2]) << sweep.name;
        EXPECT_LE(errors[3], 0x1p-31) << sweep.name;
        EXPECT_LE(errors[4], 0x1p-52) << sweep.name;
    }
}

}  // namespace
}  // namespace quincunx

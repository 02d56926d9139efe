#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "base/random.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/02_car_camera/lab.h"
#include "math/projection.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "tests/labs/lab_test.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::isFinite;
using test::Size;

constexpr Size small{96, 64};
constexpr Size large{240, 160};
constexpr auto viewCount = static_cast<int>(CarCameraLab::View::free) + 1;

class CarCamera02 : public testing::TestWithParam<gl::Backend> {
  protected:
    CarCamera02() : studio_(GetParam()) { lab_.supersample.set(1); }

    Frame frame(Size size) { return studio_.frame(lab_, size.width, size.height); }
    void look(CarCameraLab::View view) { lab_.view.set(static_cast<int>(view)); }

    CarCameraLab lab_;
    Studio studio_;
};

INSTANTIATE_TEST_SUITE_P(On, CarCamera02, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         test::nameOfBackend);

TEST_P(CarCamera02, EveryViewIsFiniteInBothSizesAndUnlikeTheOthers) {
    std::vector<Image> seen;
    for (const Size size : {small, large})
        for (int view = 0; view < viewCount; ++view) {
            lab_.view.set(view);
            seen.push_back(studio_.linearPicture(lab_, frame(size)));
            EXPECT_TRUE(isFinite(seen.back())) << view;
        }
    for (std::size_t a = 0; a < viewCount; ++a)
        for (std::size_t b = 0; b < a; ++b)
            EXPECT_GT(rmse(seen[a], seen[b]), 0.05) << a << " " << b;
}

TEST_P(CarCamera02, TheDriversViewIsThatOfACameraWithTheInversePose) {
    // The same picture from the person's own camera, put at (T R) turned half round: V = (T R)⁻¹.
    lab_.carX.set(11);
    lab_.heading.set(77);
    look(CarCameraLab::View::driver);
    const Image inside = studio_.linearPicture(lab_, frame(large));
    look(CarCameraLab::View::free);
    Frame own = frame(large);
    const double h = glm::radians(77.0);
    own.camera.worldFromCamera = glm::mat4(1);
    own.camera.worldFromCamera[0] = glm::vec4(-std::cos(h), 0, std::sin(h), 0);
    own.camera.worldFromCamera[2] = glm::vec4(-std::sin(h), 0, -std::cos(h), 0);
    const glm::dvec3 eye = glm::dvec3(11, 0, static_cast<double>(lab_.carZ)) +
                           glm::dvec3(std::sin(h), 0, std::cos(h)) * driversEye.z +
                           glm::dvec3(std::cos(h), 0, -std::sin(h)) * driversEye.x +
                           glm::dvec3(0, driversEye.y, 0);
    own.camera.worldFromCamera[3] = glm::vec4(glm::vec3(eye), 1);
    own.camera.fovYRadians = driverCamera({}).fovYRadians;
    own.camera.nearDistance = driverCamera({}).nearDistance;
    own.camera.farDistance = driverCamera({}).farDistance;
    // The knob's degrees become radians once here and once there: pixels at edges may differ. Measured 0.
    EXPECT_LE(rmse(inside, studio_.linearPicture(lab_, own)), 2e-3);
    // Without the half turn one looks out at the back.
    own.camera.worldFromCamera[0] *= -1.0f;
    own.camera.worldFromCamera[2] *= -1.0f;
    EXPECT_GE(rmse(inside, studio_.linearPicture(lab_, own)), 0.1);
}

TEST_P(CarCamera02, TurningBySmallStepsIsTurningOnce) {
    look(CarCameraLab::View::bird);
    lab_.turns.set(1'000'000);
    const Image often = studio_.linearPicture(lab_, frame(large));
    lab_.turns.set(0);
    const double radians = std::remainder(1e6 * std::atan(static_cast<double>(0.01f)), 2 * std::numbers::pi);
    lab_.heading.set(static_cast<float>(radians * 180 / std::numbers::pi));
    // The knob's degrees are rounded to 2^-18: some pixels at edges. Measured 1e-3.
    EXPECT_LE(rmse(often, studio_.linearPicture(lab_, frame(large))), 0.01);
    // The card's frame is mirrored and turned elsewhere.
    lab_.heading.set(0);
    lab_.turns.set(157);
    const Image exact = studio_.linearPicture(lab_, frame(large));
    lab_.update.parse("card");
    EXPECT_LE(rmse(exact, studio_.linearPicture(lab_, frame(large))), 0.01);
    lab_.update.parse("card-mirrored");
    EXPECT_GE(rmse(exact, studio_.linearPicture(lab_, frame(large))), 0.015);  // measured 0.020
}

TEST_P(CarCamera02, FarFromTheOriginTheWorldLooksTheSameOnlyCameraRelative) {
    look(CarCameraLab::View::chase);
    const Image near = studio_.linearPicture(lab_, frame(large));
    for (const float metres : {1e4f, 1e6f, 1e8f}) {
        lab_.far.set(metres);
        lab_.cameraRelative.set(true);
        // Measured 4e-3 to 6e-3: matrices are rounded anew, and pixels at edges change.
        EXPECT_LE(rmse(near, studio_.linearPicture(lab_, frame(large))), 0.02) << metres;
        lab_.cameraRelative.set(false);
        const Image naive = studio_.linearPicture(lab_, frame(large));
        EXPECT_TRUE(isFinite(naive));
        if (metres > 1e5f) {
            EXPECT_GE(rmse(near, naive), 0.05) << metres;
        }
    }
}

TEST_P(CarCamera02, ThePathDecidesWhereTheCarIs) {
    look(CarCameraLab::View::chase);
    lab_.path.parse("tour");
    lab_.time.set(31.4f);
    const Image played = studio_.linearPicture(lab_, frame(small));
    const CarState there = lab_.car();
    EXPECT_EQ(there,
              stateAt(followLine(lab_.town().start, lab_.town().tour, 240), static_cast<double>(31.4f)));

    const test::TemporaryFolder folder;
    writeFile(folder / "tour.json", toJson(followLine(lab_.town().start, lab_.town().tour, 60)));
    lab_.path.parse((folder / "tour.json").string());
    EXPECT_EQ(studio_.linearPicture(lab_, frame(small)).data, played.data);

    lab_.path.parse((folder / "missing.json").string());
    EXPECT_THROW(studio_.linearPicture(lab_, frame(small)), InputError);
    // What a window asks for between pictures throws nothing.
    EXPECT_TRUE(lab_.ownCamera());
    EXPECT_FALSE(lab_.advance(0.1, {.forwards = 0.1}));
    writeFile(folder / "broken.json", "{\"format\": 3}");
    lab_.path.parse((folder / "broken.json").string());
    EXPECT_THROW(studio_.linearPicture(lab_, frame(small)), InputError);
    lab_.path.parse("off");
    EXPECT_TRUE(isFinite(studio_.linearPicture(lab_, frame(small))));
}

// ---- shadows on the ground, against rays ----

/// Everything that stands in the town, as triangles of the world, and a ray through all of them.
class Casters {
  public:
    explicit Casters(const CarCameraLab& lab) {
        const Town& town = lab.town();
        Scene scene = town.scene;
        const CarInstances car = addCar(scene);
        placeCar(scene, car, poseOf(lab.car()).matrix(), 0, 0);
        for (std::size_t i = 0; i < scene.instances.size(); ++i) {
            const Instance& instance = scene.instances[i];
            const glm::vec3 place(instance.worldFromModel[3]);
            // As the lab draws them: what is on the hills and in the sky casts none.
            if (std::binary_search(town.ground.begin(), town.ground.end(), i) || std::abs(place.y) >= 1 ||
                std::hypot(place.x, place.z) >= townRadius + 60)
                continue;
            const Mesh& mesh = scene.meshes[instance.mesh];
            for (const std::uint32_t index : mesh.indices)
                corners_.emplace_back(
                    glm::vec3(instance.worldFromModel * glm::vec4(mesh.positions[index], 1)));
        }
    }
    /// Möller and Trumbore's test in double, without an end in either direction: flattened shadows do not ask
    /// which side of the ground a caster is on.
    bool meet(glm::dvec3 origin, glm::dvec3 direction) const {
        for (std::size_t i = 0; i < corners_.size(); i += 3) {
            const glm::dvec3 e1 = corners_[i + 1] - corners_[i];
            const glm::dvec3 e2 = corners_[i + 2] - corners_[i];
            const glm::dvec3 p = glm::cross(direction, e2);
            const double det = glm::dot(e1, p);
            if (det == 0)
                continue;
            const glm::dvec3 s = origin - corners_[i];
            const double a = glm::dot(s, p) / det;
            if (!(a >= 0 && a <= 1))
                continue;
            const double b = glm::dot(direction, glm::cross(s, e1)) / det;
            if (b >= 0 && a + b <= 1)
                return true;
        }
        return false;
    }

  private:
    std::vector<glm::dvec3> corners_;
};

/// Share of pixels whose shadow the rays contradict, of those that look at the plane of the shadows nearby.
double wrongShadows(Studio& studio, CarCameraLab& lab, const Casters& casters, int samples) {
    const Frame frame = studio.frame(lab, large.width, large.height);
    const Image mask = studio.resource(lab, frame, "ground shadow");
    const Camera camera = *lab.ownCamera();
    const glm::dmat4 worldFromCamera(camera.worldFromCamera);
    const double tangent = std::tan(static_cast<double>(camera.fovYRadians) / 2);
    const double aspect = static_cast<double>(large.width) / large.height;
    const glm::dvec3 sun(lab.town().scene.lights[0].direction);
    Random random(9);
    int wrong = 0;
    int looked = 0;
    while (looked < samples) {
        const int x = static_cast<int>(random.below(large.width));
        const int y = static_cast<int>(random.below(large.height));
        const glm::dvec3 inCamera(((x + 0.5) / large.width * 2 - 1) * tangent * aspect,
                                  (1 - (y + 0.5) / large.height * 2) * tangent, -1);
        const glm::dvec3 eye(worldFromCamera[3]);
        const glm::dvec3 way(worldFromCamera * glm::dvec4(inCamera, 0));
        const double t = (0.06 - eye.y) / way.y;
        if (!(t > 0 && t < 120))
            continue;
        ++looked;
        wrong += casters.meet(eye + t * way, -sun) != (mask.pixel(x, y)[0] > 0.5f) ? 1 : 0;
    }
    return static_cast<double>(wrong) / looked;
}

TEST(CarCamera02Shadows, AreWhereRaysToTheSunMeetSomething) {
    CarCameraLab lab;
    lab.supersample.set(1);
    const Casters casters(lab);
    Studio studio(gl::Backend::egl);
    for (const auto view : {CarCameraLab::View::chase, CarCameraLab::View::bird}) {
        lab.view.set(static_cast<int>(view));
        // Edges through a pixel's middle, and slits thinner than a pixel: measured 0 and 0.
        EXPECT_LE(wrongShadows(studio, lab, casters, 400), 0.01) << static_cast<int>(view);
    }
    const test::BrokenShaders broken("labs/02_car_camera/ground_shadow.vert", "p += way *", "p -= way *");
    ASSERT_TRUE(broken.found());
    CarCameraLab other;
    other.supersample.set(1);
    Studio fresh(gl::Backend::egl);
    EXPECT_GT(wrongShadows(fresh, other, casters, 200), 0.05);
}

/// Shadows darken just the ground that the mask marks, and by nothing but the sun: true or a reason.
std::string groundFault() {
    CarCameraLab lab;
    lab.supersample.set(1);
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(lab, large.width, large.height);
    const Image mask = studio.resource(lab, frame, "ground shadow");
    const Image with = studio.linearPicture(lab, frame);
    lab.shadows.set(false);
    const Image without = studio.linearPicture(lab, frame);
    int darker = 0;
    int marked = 0;
    for (std::size_t i = 0; i < with.data.size(); i += 4) {
        const bool shadowed = mask.data[i] > 0.5f;
        marked += shadowed ? 1 : 0;
        for (std::size_t c = i; c < i + 3; ++c) {
            if (!shadowed && with.data[c] != without.data[c])
                return "a pixel changes that no shadow marks";
            if (with.data[c] > without.data[c])
                return "a shadow brightens";
        }
        if (with.data[i] < without.data[i]) {
            ++darker;
            // What is left is the sky's light: the sun's share of a level ground's is 1.15 · 0.66.
            const double left = static_cast<double>(with.data[i]) / static_cast<double>(without.data[i]);
            const double cosine = 0.66 / std::sqrt(0.62 * 0.62 + 0.66 * 0.66 + 0.43 * 0.43);
            const double wanted = 0.30 / (0.30 + 1.15 * cosine);
            if (std::abs(left - wanted) > 0.06)
                return "a shadow leaves " + std::to_string(left) + " of the light, not " +
                       std::to_string(wanted);
        }
    }
    // The rest of the mask lies behind what stands on the ground.
    return darker * 4 > marked && darker > 100 ? "" : "shadows do not darken";
}

TEST(CarCamera02Shadows, TakeTheSunFromTheGroundAndNothingElse) {
    EXPECT_EQ(groundFault(), "");
    struct Mutation {
        const char* from;
        const char* to;
    };
    for (const Mutation& mutation :
         {Mutation{"mix(lit.textured, sky, shadowed)", "lit.textured"},
          Mutation{"mix(lit.textured, sky, shadowed)", "mix(lit.textured, vec3(0.0), shadowed)"},
          Mutation{"ivec2(gl_FragCoord.xy)", "ivec2(gl_FragCoord.yx)"},
          Mutation{"ambient.rgb * ambientLight.rgb", "vec3(1.0)"}}) {
        const test::BrokenShaders broken("labs/02_car_camera/ground.frag", mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.from;
        EXPECT_NE(groundFault(), "") << mutation.to;
    }
}

// ---- hands ----

TEST(CarCamera02Keys, DriveTheCarAndTheKnobsTellWhere) {
    CarCameraLab lab;
    const CarState start = lab.car();
    EXPECT_TRUE(lab.takesControls());
    EXPECT_FALSE(lab.isMoving());
    for (int i = 0; i < 100; ++i)
        lab.advance(0.05, {.forwards = 0.05});
    EXPECT_TRUE(lab.isMoving());
    const CarState ahead = lab.car();
    // 5 s from rest at 4 m/s² to 14 m/s: 45.5 m, all of it forwards.
    EXPECT_NEAR(ahead.position.z - start.position.z, 45.5, 0.3);
    EXPECT_EQ(ahead.position.x, start.position.x);
    for (int i = 0; i < 6; ++i)
        lab.advance(0.05, {.forwards = 0.05, .left = 0.05});
    EXPECT_GT(lab.heading, 10);
    EXPECT_GT(lab.carX, ahead.position.x);
    // No hands: it rolls out, and the wheels straighten.
    for (int i = 0; i < 400 && lab.isMoving(); ++i)
        lab.advance(0.05, {});
    EXPECT_FALSE(lab.isMoving());
    EXPECT_EQ(lab.steering, 0);
}

TEST(CarCamera02Keys, FrameRatesDoNotMatter) {
    CarState ends[2];
    for (const int perSecond : {10, 50}) {
        CarCameraLab lab;
        for (int i = 0; i < 3 * perSecond; ++i)
            lab.advance(1.0 / perSecond, {.forwards = 1.0 / perSecond, .left = 0.3 / perSecond});
        ends[perSecond == 50] = lab.car();
    }
    // At most one step of 20 ms more or less.
    EXPECT_LE(glm::length(ends[0].position - ends[1].position), 0.02 * 12 + 1e-3);
}

TEST(CarCamera02Keys, KnobsPutADrivenCarElsewhere) {
    CarCameraLab lab;
    for (int i = 0; i < 20; ++i)
        lab.advance(0.05, {.forwards = 0.05});
    lab.carX.set(30);
    lab.advance(0.05, {});
    EXPECT_EQ(lab.carX, 30);
    for (int i = 0; i < 20; ++i)
        lab.advance(0.05, {.forwards = 0.05});
    EXPECT_EQ(lab.carX, 30);
    EXPECT_GT(lab.carZ, -45);
}

TEST(CarCamera02Keys, TheEdgeOfTheMapStopsTheCar) {
    CarCameraLab lab;
    lab.carZ.set(299);
    for (int i = 0; i < 400; ++i)
        lab.advance(0.05, {.forwards = 0.05});
    EXPECT_EQ(lab.carZ, 300);
}

TEST(CarCamera02Keys, TheTourPlaysAndAHandEndsIt) {
    CarCameraLab lab;
    const std::vector<LabKey> keys = lab.keys();
    const auto press = [&](char key) {
        for (const LabKey& one : keys)
            if (one.key == key)
                return one.press();
        ADD_FAILURE() << key;
        return std::string();
    };
    lab.time.set(20);
    press('T');
    EXPECT_TRUE(lab.isMoving());
    for (int i = 0; i < 10; ++i)
        lab.advance(0.1, {});
    EXPECT_NEAR(lab.time, 21, 1e-4);
    const CarState played = lab.car();
    lab.advance(0.05, {.left = 0.05});
    EXPECT_EQ(lab.path.value(), "off");
    EXPECT_LE(glm::length(lab.car().position - played.position), 1);
    press('V');
    EXPECT_EQ(lab.view.text(), "driver");
}

TEST(CarCamera02Keys, WhatWasDrivenIsWrittenAndPlaysBack) {
    const test::TemporaryFolder folder;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    CarCameraLab lab;
    LabKey write = lab.keys().back();
    ASSERT_EQ(write.key, 'K');
    EXPECT_NE(write.press().find("nothing"), std::string::npos);
    for (int i = 0; i < 60; ++i)
        lab.advance(0.05, {.forwards = 0.05, .left = i < 30 ? 0.02 : -0.04});
    EXPECT_NE(write.press().find("out/drive_001.json"), std::string::npos);
    const CarState driven = lab.car();
    lab.path.parse("out/drive_001.json");
    lab.time.set(3);
    // The knobs hold floats.
    EXPECT_LE(glm::length(lab.car().position - driven.position), 1e-4);
    std::filesystem::current_path(before);
}

// ---- the rest ----

TEST(CarCamera02Backends, OsmesaAndEglGiveTheSameBits) {
    for (const char* view : {"chase", "driver"})
        test::expectSameBitsOnBothBackends(
            [&] {
                auto lab = std::make_unique<CarCameraLab>();
                lab->view.parse(view);
                lab->axes.set(true);
                return lab;
            },
            {small, large});
}

TEST(CarCamera02Goldens, LookAsTheyDid) {
    Studio studio(gl::Backend::egl);
    for (const char* view : {"chase", "driver", "bird", "free"}) {
        CarCameraLab lab;
        lab.view.parse(view);
        test::expectGolden(studio.picture(lab, studio.frame(lab, 180, 120)), "02_car_camera", view);
    }
}

TEST(CarCamera02Answers, AllHold) {
    CarCameraLab lab;
    Studio studio(gl::Backend::automatic);
    test::expectAnswersHold(lab, studio, {36});
}

TEST(CarCamera02Stress, StableFormsKeepTheirBoundsWhereNaiveOnesDoNot) {
    CarCameraLab lab;
    test::expectStressHolds(lab, 3000);
}

TEST(CarCamera02Sweeps, RarerMendingDriftsFurther) {
    CarCameraLab lab;
    Studio studio(gl::Backend::egl);
    const Frame frame = studio.frame(lab, 16, 16);
    for (const Sweep& sweep : lab.sweeps()) {
        EXPECT_GE(sweep.points.size(), 5u);
        const KnobScope scope(lab.knobs());
        lab.turns.set(19'999);
        std::vector<double> errors;
        for (const char* every : {"16", "256", "0"}) {
            lab.update.parse("product");
            lab.every.parse(every);
            const SweepSample sample = sweep.measure(studio, frame);
            errors.push_back(sample.error);
            EXPECT_EQ(sample.counters.at("turns"), 19'999u);
        }
        lab.update.parse("exact");
        const double exact = sweep.measure(studio, frame).error;
        EXPECT_LE(exact, 1.1e-7) << sweep.name;
        EXPECT_GT(errors[2], 10 * errors[0]) << sweep.name;
        if (sweep.name == "orthonormality") {
            EXPECT_LT(errors[0], errors[1]);
            EXPECT_LT(errors[1], errors[2]);
        }
    }
}

TEST(CarCamera02Knobs, SayWhenTheyAreWithoutEffect) {
    CarCameraLab lab;
    lab.markIdleKnobs();
    EXPECT_FALSE(lab.time.idle().empty());
    EXPECT_TRUE(lab.carX.idle().empty());
    EXPECT_FALSE(lab.cameraRelative.idle().empty());
    lab.path.parse("tour");
    lab.turns.set(10);
    lab.update.parse("product");
    lab.every.set(3);
    lab.far.set(10);
    lab.markIdleKnobs();
    EXPECT_TRUE(lab.time.idle().empty());
    EXPECT_FALSE(lab.carX.idle().empty());
    for (const Knob* knob : {static_cast<Knob*>(&lab.update), static_cast<Knob*>(&lab.every),
                             static_cast<Knob*>(&lab.renormalizer), static_cast<Knob*>(&lab.cameraRelative)})
        EXPECT_TRUE(knob->idle().empty()) << knob->name();
}

}  // namespace
}  // namespace quincunx

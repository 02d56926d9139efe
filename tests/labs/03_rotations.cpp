#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "image/compare.h"
#include "lab/studio.h"
#include "lab/sweep.h"
#include "labs/03_rotations/lab.h"
#include "math/quad_rotation.h"
#include "math/stress_inputs.h"
#include "passes/labels.h"
#include "scene/import.h"
#include "tests/labs/lab_test.h"

namespace quincunx {
namespace {

using test::isFinite;
using test::largestDifference;
using test::Size;

constexpr Size small{96, 72};
constexpr Size large{320, 180};
constexpr double pi = std::numbers::pi;

/// For every backend: one sample a pixel, no words in the picture.
class Rotations03 : public testing::TestWithParam<gl::Backend> {
  protected:
    Rotations03() : studio_(GetParam()) {
        lab_.supersample.set(1);
        lab_.notes.set(false);
    }

    void turn(double head, double pitch, double roll) {
        lab_.head.set(static_cast<float>(head));
        lab_.pitch.set(static_cast<float>(pitch));
        lab_.roll.set(static_cast<float>(roll));
    }
    void use(EulerOrder order) { lab_.order.set(static_cast<int>(order)); }
    Image picture(Size size) {
        return studio_.linearPicture(lab_, studio_.frame(lab_, size.width, size.height));
    }
    /// The aeroplane alone.
    Image aeroplane(Size size) {
        lab_.rings.set(false);
        return picture(size);
    }

    /// How many of the navigation lights that face the eye are where the rotation puts them, in quadruple
    /// precision and by quaternions, and not where the lab's matrices do; and how many there are.
    struct Seen {
        int lights = 0;
        int found = 0;
    };
    Seen lookForLights(EulerOrder assumed) {
        const Image image = aeroplane(large);
        const Camera camera = lab_.defaultCamera();
        const float aspect = static_cast<float>(large.width) / large.height;
        const ForwardView view = forwardView(fittedToAspect(camera, aspect, 1.0f), aspect);
        Seen seen;
        for (const bool port : {true, false}) {
            const QuadVector at = rotateQuad(quaternionFromEulerQuad(lab_.angles(), assumed),
                                             QuadVector(port ? portLightBody : starboardLightBody));
            const glm::vec3 world(static_cast<float>(at.x), static_cast<float>(at.y),
                                  static_cast<float>(at.z));
            // Wing tips on the near side are not hidden: nothing but the other wing is as far from the
            // middle.
            if (glm::dot(world, glm::normalize(view.eyeWorld)) < 0.25f)
                continue;
            const std::optional<glm::vec2> pixel =
                pixelOf(world, view.clipFromWorld, {large.width, large.height});
            if (!pixel)
                continue;
            const float* color = image.pixel(static_cast<int>(pixel->x), static_cast<int>(pixel->y));
            ++seen.lights;
            seen.found += port ? color[0] > 0.8f && color[1] < 0.3f : color[1] > 0.7f && color[0] < 0.3f;
        }
        return seen;
    }

    RotationsLab lab_;
    Studio studio_;
};

INSTANTIATE_TEST_SUITE_P(On, Rotations03, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         test::nameOfBackend);

TEST_P(Rotations03, EveryViewIsFiniteAndShowsSomethingInBothSizes) {
    for (const Size size : {small, large})
        for (const int view : {0, 1, 2, 3}) {
            lab_.view.set(view);
            const Image image = picture(size);
            EXPECT_TRUE(isFinite(image));
            const auto [least, most] = std::minmax_element(image.data.begin(), image.data.end());
            EXPECT_GT(*most - *least, 0.5f);
        }
}

TEST_P(Rotations03, NavigationLightsAreWhereTheRotationPutsThem) {
    StressInputs draw(3);
    Seen all;
    Seen wrongOrder;
    for (int i = 0; i < 4; ++i)
        for (const EulerOrder order : eulerOrders) {
            use(order);
            turn(draw.random().uniform(-180, 180), draw.random().uniform(-180, 180),
                 draw.random().uniform(-180, 180));
            const Seen seen = lookForLights(order);
            all.lights += seen.lights;
            all.found += seen.found;
            const Seen other = lookForLights(order == EulerOrder::xyz ? EulerOrder::zyx : EulerOrder::xyz);
            wrongOrder.lights += other.lights;
            wrongOrder.found += other.found;
        }
    EXPECT_EQ(all.found, all.lights);
    EXPECT_GT(all.lights, 8);
    // The test sees it if the matrices are multiplied in another order.
    EXPECT_LT(wrongOrder.found, wrongOrder.lights / 2);
}

TEST_P(Rotations03, OrderDoesNotShowWhileOneAngleAloneIsTurned) {
    for (int axis = 0; axis < 3; ++axis) {
        turn(axis == 1 ? 50 : 0, axis == 0 ? 50 : 0, axis == 2 ? 50 : 0);
        use(EulerOrder::xyz);
        const Image first = aeroplane(small);
        for (const EulerOrder order : eulerOrders) {
            use(order);
            EXPECT_LE(rmse(first, aeroplane(small)), 1e-4) << eulerOrderName(order);
        }
    }
    turn(50, 40, 30);
    use(EulerOrder::xyz);
    const Image first = aeroplane(small);
    use(EulerOrder::zyx);
    EXPECT_GT(rmse(first, aeroplane(small)), 0.02);
}

TEST_P(Rotations03, LockedGimbalTurnsTheBodyAlikeByItsOuterAndItsInnerRing) {
    use(EulerOrder::zxy);
    turn(20, 90, 10);
    const Image first = aeroplane(small);
    turn(60, 90, -30);
    EXPECT_LE(rmse(first, aeroplane(small)), 1e-3);
    // The rings do not stand alike, and without the lock the body does not either.
    lab_.rings.set(true);
    const Image rings = picture(small);
    turn(20, 90, 10);
    EXPECT_GT(rmse(rings, picture(small)), 0.01);
    turn(20, 0, 10);
    const Image free = aeroplane(small);
    turn(60, 0, -30);
    EXPECT_GT(rmse(free, aeroplane(small)), 0.02);
}

TEST_P(Rotations03, KnobsSayWhenTheyChangeNothing) {
    for (const int view : {0, 1, 2, 3}) {
        lab_.view.set(view);
        lab_.markIdleKnobs();
        const Image before = picture(large);
        for (Knob* knob : lab_.knobs().all()) {
            if (knob->name() == "view" || knob->name() == "supersample" || knob->name() == "notes")
                continue;
            if (auto* number = dynamic_cast<FloatKnob*>(knob))
                number->set(0.6f * number->range().max);
            else if (auto* whole = dynamic_cast<IntKnob*>(knob))
                whole->set(4096);
            else if (auto* choice = dynamic_cast<ChoiceKnob*>(knob))
                choice->set(2);
            else if (auto* flag = dynamic_cast<BoolKnob*>(knob))
                flag->set(!*flag);
            EXPECT_EQ(largestDifference(before, picture(large)) > 0.01, knob->idle().empty())
                << knob->name() << " in " << lab_.view.text();
            knob->reset();
        }
    }
}

TEST_P(Rotations03, WholeTurnsDoNotShow) {
    turn(-180, 180, -180);
    const Image first = picture(small);
    turn(180, -180, 180);
    EXPECT_LE(rmse(first, picture(small)), 1e-3);
}

TEST_P(Rotations03, EveryOrderDrawsItsOwnGimbal) {
    turn(30, 40, 50);
    std::vector<Image> pictures;
    for (const EulerOrder order : eulerOrders) {
        use(order);
        pictures.push_back(picture(small));
        for (std::size_t i = 0; i + 1 < pictures.size(); ++i)
            EXPECT_GT(rmse(pictures[i], pictures.back()), 0.02) << eulerOrderName(order);
    }
}

TEST_P(Rotations03, EveryMethodStartsAndEndsAtTheSamePoses) {
    const Flight flight = lab_.flight();
    for (const float end : {0.0f, 1.0f}) {
        const glm::mat3 right = poseAt(flight, Method::slerp, end);
        for (std::size_t i = 0; i < methodNames.size(); ++i) {
            const glm::mat3 pose = poseAt(flight, static_cast<Method>(i), end);
            for (int column = 0; column < 3; ++column)
                EXPECT_LE(glm::length(pose[column] - right[column]), 1e-6f) << methodNames[i];
        }
    }
    lab_.view.set(static_cast<int>(RotationsLab::View::interpolation));
    lab_.t.set(0.5f);
    std::set<std::string> distinct;
    lab_.method.set(static_cast<int>(Method::slerp));
    const Image half = picture(large);
    lab_.method.set(static_cast<int>(Method::euler));
    EXPECT_GT(largestDifference(half, picture(large)), 0.2);
}

TEST(Rotations03Paths, SpeedIsEvenBySlerpAlone) {
    const RotationsLab lab;
    const Flight flight = lab.flight();
    const auto spread = [&](Method method) {
        double least = 1e9;
        double most = 0;
        for (int i = 0; i <= 32; ++i) {
            const double speed = relativeSpeed(flight, method, static_cast<float>(i) / 32);
            least = std::min(least, speed);
            most = std::max(most, speed);
        }
        return most / least;
    };
    // A step of 2^-8 of 156°, each end off by 2^-23 rad.
    EXPECT_NEAR(spread(Method::slerp), 1, 1e-4);
    EXPECT_GT(spread(Method::nlerp), 1.3);
    EXPECT_GT(spread(Method::matrix), spread(Method::nlerp));
    EXPECT_LT(spread(Method::slerp1), spread(Method::nlerp));
    EXPECT_LT(spread(Method::slerp3), spread(Method::slerp1));
    EXPECT_GT(angleToSlerp(flight, Method::euler, 0.5f), 0.5);
}

TEST(Rotations03Paths, ErrorsShrinkWithEachLevel) {
    const RotationsLab lab;
    const Flight flight = lab.flight();
    double last = pi;
    for (const Method method :
         {Method::matrix, Method::nlerp, Method::slerp1, Method::slerp2, Method::slerp3, Method::slerp5}) {
        double worst = 0;
        for (int i = 0; i <= 64; ++i)
            worst = std::max(worst, angleToSlerp(flight, method, static_cast<float>(i) / 64));
        EXPECT_LT(worst, last) << methodNames[static_cast<std::size_t>(method)];
        last = worst;
    }
    EXPECT_LE(last, 2e-5);
}

TEST(Rotations03Drift, ShrinksWithEveryRenormalisation) {
    const glm::quat turn = smallTurn({1, 2, 3});
    double last = 1;
    for (const int every : {0, 4096, 64, 1}) {
        const Drift drift = measureDrift(turn, every);
        EXPECT_LT(drift.largest, last) << every;
        EXPECT_EQ(drift.byDoubles.size(), 21u);
        EXPECT_EQ(drift.byDoubles.back(), drift.largest);
        EXPECT_TRUE(std::is_sorted(drift.byDoubles.begin(), drift.byDoubles.end()));
        last = drift.largest;
    }
    EXPECT_LE(last, 5e-7);
}

TEST(Rotations03Backends, OsmesaAndEglGiveTheSameBits) {
    for (const int view : {0, 1, 2, 3})
        test::expectSameBitsOnBothBackends(
            [&] {
                auto lab = std::make_unique<RotationsLab>();
                lab->view.set(view);
                return lab;
            },
            {small, large});
}

struct Mutation {
    const char* file;
    const char* from;
    const char* to;
    int view;
};

TEST(Rotations03Mutations, EveryBrokenShaderIsNoticed) {
    const auto draw = [](int view) {
        RotationsLab lab;
        lab.view.set(view);
        Studio studio(gl::Backend::egl);
        return studio.picture(lab, studio.frame(lab, 160, 120));
    };
    const std::vector<Mutation> mutations = {
        {"passes/phong.vert", "worldNormalFromModel * normalModel", "normalModel", 0},
        {"passes/phong.vert", "clipFromWorld * position", "clipFromWorld * vec4(positionModel, 1.0)", 2},
        {"passes/phong.frag", "vec3 normal = safeNormalize(normalWorld);",
         "vec3 normal = vec3(0.0, 0.0, 1.0);", 0},
        {"passes/lines.vert", "vec4 b = clipFromWorld * vec4(toWorld, 1.0);", "vec4 b = a;", 1},
        {"passes/lines.frag", "0.5 * lengthWidthDash.y + 0.5", "0.1 * lengthWidthDash.y", 2},
        {"passes/labels.frag", "texture(typeface, texcoord).r", "0.3", 0},
        {"passes/downsample.frag", "/ float(factor * factor)", "/ float(factor)", 1},
    };
    for (const Mutation& mutation : mutations) {
        const Image8 right = draw(mutation.view);
        const test::BrokenShaders broken(mutation.file, mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.file << " no longer holds: " << mutation.from;
        // What the golden pictures allow.
        EXPECT_GT(compareImages(right, draw(mutation.view), Metric::flip).value, 0.003)
            << mutation.file << ": " << mutation.from << " -> " << mutation.to;
    }
}

TEST(Rotations03Goldens, LookAsTheyDid) {
    Studio studio(gl::Backend::egl);
    for (const char* view : {"gimbal", "lock", "interpolation", "drift"}) {
        RotationsLab lab;
        lab.view.parse(view);
        test::expectGolden(studio.picture(lab, studio.frame(lab, 160, 120)), "03_rotations", view);
    }
}

TEST(Rotations03Answers, AllHold) {
    RotationsLab lab;
    Studio studio(gl::Backend::automatic);
    test::expectAnswersHold(lab, studio, {75, 104});
}

TEST(Rotations03Stress, StableFormsKeepTheirBoundsWhereNaiveOnesDoNot) {
    RotationsLab lab;
    test::expectStressHolds(lab, 2000);
}

TEST(Rotations03Sweeps, ErrorsFallFromMatricesToSlerp) {
    RotationsLab lab;
    Studio studio(gl::Backend::egl);
    std::vector<Sweep> sweeps = lab.sweeps();
    ASSERT_EQ(sweeps.size(), 2u);
    Frame frame;
    frame.seed = 5;
    double last = 1e9;
    for (const KnobValues& point : sweeps[0].points) {
        lab.knobs().set(point);
        const SweepSample sample = sweeps[0].measure(studio, frame);
        EXPECT_LT(sample.error, last) << point[0].second;
        EXPECT_EQ(sample.counters.at("poses"), 4096u);
        last = sample.error;
    }
    // Rounding to float alone: an RMS of 2^-24 or less.
    EXPECT_LE(last, 0x1p-24);
    double drift = 1e9;
    for (const KnobValues& point : sweeps[1].points) {
        lab.knobs().set(point);
        const SweepSample sample = sweeps[1].measure(studio, frame);
        EXPECT_LT(sample.error, drift) << point[0].second;
        drift = sample.error;
        const auto every = static_cast<std::uint64_t>(static_cast<int>(lab.renormalizeEvery));
        EXPECT_EQ(sample.counters.at("renormalisations"), every == 0 ? 0 : (1u << 20) / every);
    }
    EXPECT_LE(drift, 5e-7);
}

}  // namespace
}  // namespace quincunx

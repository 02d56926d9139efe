#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/timing.h"
#include "lab/studio.h"
#include "labs/02_car_camera/lab.h"
#include "math/exact.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr int poses = 2000;
constexpr double millionTurns = 1e6;

/// A model matrix T R with any R, its origin 2^-4 … 2^14 metres away.
glm::mat4 anyPose(StressInputs& draw) {
    glm::mat4 pose{glm::mat3(draw.rotation())};
    pose[3] = glm::vec4(draw.vectorOfMagnitude(-4, 14), 1);
    return pose;
}

double largestOf(glm::vec3 v) {
    return std::max({std::abs(static_cast<double>(v.x)), std::abs(static_cast<double>(v.y)),
                     std::abs(static_cast<double>(v.z))});
}

// (1) tx += 2, whatever R is.
void measureWorldMove(std::vector<Measurement>& figures) {
    StressInputs draw(361);
    double worst = 0;
    double otherPoints = 0;
    double wrongOrder = 0;
    for (int i = 0; i < poses; ++i) {
        const RigidPose before{draw.rotation(), draw.magnitude(-4, 8) * draw.direction()};
        RigidPose after = before;
        after.origin.x += 2;
        const glm::dvec3 point = 4.0 * draw.direction();
        const auto moved = [&](const RigidPose& to, glm::dvec3 p) {
            return (to.rotation * p + to.origin) - (before.rotation * p + before.origin);
        };
        const glm::dvec3 wanted(2, 0, 0);
        worst = std::max(worst, glm::length(moved(after, glm::dvec3(0)) - wanted));
        otherPoints = std::max(otherPoints, glm::length(moved(after, point) - wanted));
        // M translate(2,0,0) moves along the car's own x.
        const RigidPose inside = before * RigidPose{glm::dmat3(1), wanted};
        wrongOrder = std::max(wrongOrder, glm::length(moved(inside, glm::dvec3(0)) - wanted));
    }
    // Two roundings of coordinates below 2^9: 2^-44 each.
    figures.push_back({"(1) the car's origin moves by (2,0,0): off by, any R", worst, "m", atMost(0x1p-43)});
    figures.push_back({"(1) any other point of the car: off by", otherPoints, "m", atMost(0x1p-42)});
    figures.push_back({"(1) the same factor on the right of M instead: off by", wrongOrder, "m", atLeast(3)});
}

// (2) A small turn to the left, by the card and by an exact rotation.
void measureTurn(std::vector<Measurement>& figures) {
    const glm::mat3 once = turnLeftMirroredNaive(glm::mat3(1), 0.01f);
    figures.push_back(
        {"(2) det R after one turn by the card's z × y", determinant(once), "", equals(-1, 1e-4)});
    glm::mat3 card(1);
    glm::mat3 corrected(1);
    for (int i = 0; i < 157; ++i) {
        card = turnLeftMirroredNaive(card, 0.01f);
        corrected = turnLeftNaive(corrected, 0.01f);
    }
    const auto heading = [](const glm::mat3& r) { return static_cast<double>(std::atan2(r[2].x, r[2].z)); };
    const double wanted = 157 * std::atan(0.01);
    figures.push_back(
        {"(2) heading after 157 turns, by the card's z × y", heading(card), "rad to the left", atMost(-1.5)});
    figures.push_back(
        {"(2) the same with x = y × z", heading(corrected), "rad to the left", equals(wanted, 1e-4)});

    const glm::dmat3 start = slopingFrame();
    const auto after = [&](TurnUpdate update) {
        return turnedOften({.update = update, .turns = static_cast<std::int64_t>(millionTurns)}, start);
    };
    const glm::dmat3 exact = turnedExactly({.turns = static_cast<std::int64_t>(millionTurns)}, start);
    const glm::mat3 byCard = after(TurnUpdate::card);
    const glm::mat3 byProduct = after(TurnUpdate::product);
    const glm::mat3 byRounded = after(TurnUpdate::rounded);
    const glm::mat3 byQuaternion = after(TurnUpdate::exact);
    const char* unit = "|RᵀR - I|";
    figures.push_back(
        {"(2) 10⁶ turns, the card's update with y × z", departureFromOrthonormal(byCard), unit, {}});
    figures.push_back({"(2) 10⁶ turns, product of float matrices", departureFromOrthonormal(byProduct), unit,
                       atLeast(1e-4)});
    figures.push_back(
        {"(2) 10⁶ turns, orthonormal after each", departureFromOrthonormal(byRounded), unit, atMost(1.1e-7)});
    figures.push_back({"(2) 10⁶ turns, exact rotation in double", departureFromOrthonormal(byQuaternion),
                       unit, atMost(1.1e-7)});
    figures.push_back({"(2) its largest entry off from one turn by the sum",
                       largestDifference(byQuaternion, exact), "",
                       atMost(0x1p-25 + millionTurns * 16 * 0x1p-53)});
    figures.push_back({"(2) the same of the product of floats", largestDifference(byProduct, exact), "", {}});
}

// (3) Forwards along the car's own z.
void measureForwards(std::vector<Measurement>& figures) {
    StressInputs draw(363);
    double along = 0;
    double aside = 0;
    for (int i = 0; i < poses; ++i) {
        const RigidPose before{draw.rotation(), draw.magnitude(-4, 8) * draw.direction()};
        RigidPose after = before;
        after.origin += 0.1 * before.rotation[2];
        const glm::dvec3 inCar = glm::transpose(before.rotation) * (after.origin - before.origin);
        along = std::max(along, std::abs(inCar.z - 0.1));
        aside = std::max({aside, std::abs(inCar.x), std::abs(inCar.y)});
    }
    figures.push_back({"(3) moves by 0.1 along the car's own z: off by", along, "m", atMost(0x1p-42)});
    figures.push_back({"(3) and along its own x and y by", aside, "m", atMost(0x1p-42)});

    // Half a circle, the wheel held: two radii to the left, at any frame rate.
    const CarBuild build;
    CarState start;
    start.speed = 5;
    start.steering = 0.4;
    const CarControls held{5 / build.topSpeed, 0.4 / build.mostSteering};
    const double radius = build.wheelbase / std::tan(start.steering);
    const double length = std::acos(-1.0) * radius;
    const double seconds = length / start.speed;
    const auto missedBy = [&](auto&& step, int steps) {
        CarState car = start;
        for (int i = 0; i < steps; ++i)
            car = step(car, held, seconds / steps, build);
        return glm::length(car.position - glm::dvec3(2 * radius, 0, 0));
    };
    figures.push_back({"(3) half a circle in 1000 arcs ends off by", missedBy(advanced, 1000), "m",
                       atMost(1000 * 64 * 0x1p-53 * length)});
    figures.push_back(
        {"(3) the same in 1000 straight steps", missedBy(advancedNaive, 1000), "m", atLeast(1e-3)});
    figures.push_back(
        {"(3) the same in 100 straight steps", missedBy(advancedNaive, 100), "m", atLeast(1e-2)});
}

struct InverseErrors {
    double rigid = 0;
    double general = 0;
};

/// ulp of the worst entry of V, for R rounded to float, against exact sums.
InverseErrors inverseErrors() {
    StressInputs draw(364);
    InverseErrors errors;
    for (int i = 0; i < poses; ++i) {
        const glm::mat4 pose = anyPose(draw);
        const QuadVector origin{glm::vec3(pose[3])};
        const auto worst = [&](const glm::mat4& v) {
            double error = 0;
            for (int row = 0; row < 3; ++row)
                error = std::max(
                    error, ulpError(v[3][row], Quad(-dotQuad(QuadVector(glm::vec3(pose[row])), origin))));
            return error;
        };
        errors.rigid = std::max(errors.rigid, worst(cameraFromWorld(pose)));
        errors.general = std::max(errors.general, worst(inverseNaive(pose)));
    }
    return errors;
}

/// Nanoseconds for a matrix, the median over whole arrays.
template <typename Invert>
double nanoseconds(const Invert& invert) {
    StressInputs draw(365);
    std::vector<glm::mat4> in;
    in.reserve(1024);
    for (int i = 0; i < 1024; ++i)
        in.push_back(anyPose(draw));
    std::vector<glm::mat4> out(in.size());
    volatile float sink = 0;
    const Timing timing = timeRuns(15, [&] {
        for (std::size_t i = 0; i < in.size(); ++i)
            out[i] = invert(in[i]);
        sink = sink + out.back()[3][0];
    });
    return 1e9 * timing.medianSeconds / static_cast<double>(in.size());
}

// (4) V = (T R)⁻¹.
void measureCamera(std::vector<Measurement>& figures) {
    StressInputs draw(366);
    // V as a program makes it, the transpose of a matrix of floats, on places in the world.
    constexpr int farthestExponent = 8;
    double eye = 0;
    double ahead = 0;
    double left = 0;
    double behind = std::numeric_limits<double>::infinity();
    double determinants = 0;
    double farAway = 0;
    for (int i = 0; i < poses; ++i) {
        const RigidPose car{draw.rotation(), draw.magnitude(0, farthestExponent) * draw.direction()};
        const auto seen = [&](const RigidPose& camera, glm::dvec3 inCar) {
            const glm::dmat4 v(cameraFromWorld(camera.matrix()));
            return glm::dvec3(v * glm::dvec4(car.rotation * inCar + car.origin, 1));
        };
        const RigidPose camera = cameraFacing(car, glm::dvec3(0));
        eye = std::max(eye, glm::length(seen(camera, glm::dvec3(0))));
        ahead = std::max(ahead, glm::length(seen(camera, {0, 0, 10}) - glm::dvec3(0, 0, -10)));
        left = std::max(left, glm::length(seen(camera, {1, 0, 0}) - glm::dvec3(-1, 0, 0)));
        // Without the half turn, what lies ahead is at positive z: behind OpenGL's eye.
        behind = std::min(behind, seen(car, {0, 0, 10}).z);
        determinants =
            std::max(determinants, std::abs(determinant(glm::mat3(cameraFromWorld(camera.matrix()))) - 1));
        // Far from the origin the difference of the places in double is what keeps the digits.
        const RigidPose away{car.rotation, 0x1p24 * draw.direction()};
        const glm::mat4 relative = cameraFromModel(cameraFacing(away, glm::dvec3(0)), away);
        farAway =
            std::max(farAway, largestOf(glm::vec3(relative * glm::vec4(0, 0, 10, 1)) - glm::vec3(0, 0, -10)));
    }
    // Entries of R are off by 2^-25, and so is each of the three coordinates of place and of V's last column,
    // of up to 2^8 m, by 2^-25 of itself: each component by 2^-25 (3 · 2^8 + 3 · 2^8 + 2^8).
    const double bound = std::sqrt(3.0) * 7 * std::exp2(farthestExponent - 25);
    figures.push_back({"(4) V takes the car's origin to the eye, (0,0,0): off by", eye, "m", atMost(bound)});
    figures.push_back(
        {"(4) 10 m ahead to (0,0,-10), half a turn included: off by", ahead, "m", atMost(bound)});
    figures.push_back({"(4) 1 m to the car's left to (-1,0,0): off by", left, "m", atMost(bound)});
    figures.push_back({"(4) without the half turn, 10 m ahead is at z", behind, "m", atLeast(9.99)});
    figures.push_back({"(4) det of V's rotation is 1: off by", determinants, "", atMost(4e-7)});
    figures.push_back(
        {"(4) 16 777 km out, the eye subtracted first: 10 m ahead is off by", farAway, "m", atMost(1e-6)});

    const InverseErrors errors = inverseErrors();
    figures.push_back(
        {"(4) RᵀT⁻¹, worst entry of the translation", errors.rigid, "ulp", atMost(0.5 + 0x1p-26)});
    figures.push_back({"(4) general inverse in float, the same", errors.general, "ulp", atLeast(2)});
    figures.push_back(
        {"(4) time of RᵀT⁻¹", nanoseconds([](const glm::mat4& m) { return cameraFromWorld(m); }), "ns", {}});
    figures.push_back({"(4) time of the general inverse",
                       nanoseconds([](const glm::mat4& m) { return inverseNaive(m); }),
                       "ns",
                       {}});
    figures.push_back({"(4) time of the general inverse to half an ulp",
                       nanoseconds([](const glm::mat4& m) { return inverse(m).value_or(glm::mat4(0)); }),
                       "ns",
                       {}});
}

std::vector<Measurement> measure(Studio&) {
    std::vector<Measurement> figures;
    measureWorldMove(figures);
    measureTurn(figures);
    measureForwards(figures);
    measureCamera(figures);
    return figures;
}

}  // namespace

std::vector<Question> CarCameraLab::questions() {
    return {
        {36,
         "A car's model matrix is M = T R, a translation after a rotation with the columns x, y, z. How is "
         "it "
         "changed (1) to move 2 units along the world's x, (2) to turn a little to the left, (3) to go the "
         "way "
         "the car faces, and (4) what is the matrix of a camera in the car that looks along z?",
         "(1) Add 2 to the translation's x: T stands left of R, so its entries are in the world's axes, "
         "however "
         "the car is turned. (2) The frame is right-handed, x = y × z, and the car faces z, so x is to its "
         "left: R becomes R Ry(ε), the turn by ε about its own y, which carries z towards x. In small steps: "
         "z + ε x, made unit length, and x = y × z again; that turns by atan ε, and its roundings add up, so "
         "the turn is kept in double or R is made orthonormal now and then. (3) Add z, the third column of "
         "R, "
         "times the way to go, to the translation. (4) V = M⁻¹ = (T R)⁻¹ = R⁻¹ T⁻¹ = Rᵀ T⁻¹, since R is "
         "orthonormal: a transpose and three dot products, no division. OpenGL's eye looks along its -z, so "
         "R "
         "is first turned half round about y: its columns are then -x, y, -z.",
         "x = z × y is the negative of y × z: it mirrors the car, which then turns right; it is x = y × z. "
         "And "
         "(T R)⁻¹ alone looks out of the rear window: OpenGL's camera looks along -z, so facing z takes half "
         "a "
         "turn about y",
         measure},
    };
}

}  // namespace quincunx

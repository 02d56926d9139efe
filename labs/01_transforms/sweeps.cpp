#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/check.h"
#include "base/timing.h"
#include "labs/01_transforms/lab.h"
#include "labs/01_transforms/shader_vertices.h"
#include "math/quad_oracle.h"
#include "math/rigid_motion.h"
#include "math/stress_inputs.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr std::size_t poseCount = 1024;

/// Camera poses up to a thousand units away, and their exact inverses.
struct Poses {
    std::vector<glm::mat4> poses;
    std::vector<QuadAdjugate> inverses;

    Poses() {
        StressInputs draw(1);
        for (std::size_t i = 0; i < poseCount; ++i) {
            glm::mat4 pose{glm::mat3(draw.rotation())};
            pose[3] = glm::vec4(draw.vectorOfMagnitude(0, 10), 1);
            poses.push_back(pose);
            inverses.push_back(adjugateQuad(pose));
        }
    }
};

/// The worst entry's error, over the largest entry of its column.
double worstError(const Poses& poses, const std::vector<glm::mat4>& inverted) {
    double worst = 0;
    for (std::size_t i = 0; i < poseCount; ++i)
        for (int column = 0; column < 4; ++column) {
            double most = 0;
            double error = 0;
            for (int row = 0; row < 4; ++row) {
                const Quad exact = poses.inverses[i].inverseEntry(column, row);
                most = std::max(most, std::abs(static_cast<double>(exact)));
                error =
                    std::max(error, std::abs(static_cast<double>(Quad(inverted[i][column][row]) - exact)));
            }
            worst = std::max(worst, error / most);
        }
    return worst;
}

constexpr std::size_t passes = 977;  // over the poses: a million inverses, nearly

/// Seconds of all passes of `invert`.
template <typename Invert>
Timing timeOf(const Poses& poses, std::vector<glm::mat4>& inverted, const Invert& invert) {
    return timeRuns(9, [&] {
        for (std::size_t pass = 0; pass < passes; ++pass)
            for (std::size_t i = 0; i < poseCount; ++i)
                inverted[i] = invert(poses.poses[i]);
    });
}

template <TransformsLab::Inverse Routine>
SweepSample measureInverse(const Poses& poses) {
    std::vector<glm::mat4> inverted(poseCount);
    const Timing timing =
        timeOf(poses, inverted, [](const glm::mat4& pose) { return TransformsLab::inverted(pose, Routine); });
    SweepSample sample;
    sample.error = worstError(poses, inverted);
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
    sample.counters["inverses"] = passes * poseCount;
    return sample;
}

SweepSample measureInverse(const Poses& poses, TransformsLab::Inverse routine) {
    using Inverse = TransformsLab::Inverse;
    switch (routine) {
        case Inverse::rigid:
            return measureInverse<Inverse::rigid>(poses);
        case Inverse::rigidNaive:
            return measureInverse<Inverse::rigidNaive>(poses);
        case Inverse::affine:
            return measureInverse<Inverse::affine>(poses);
        case Inverse::affineNaive:
            return measureInverse<Inverse::affineNaive>(poses);
        case Inverse::general:
            return measureInverse<Inverse::general>(poses);
        case Inverse::generalNaive:
            return measureInverse<Inverse::generalNaive>(poses);
        case Inverse::inDouble:
            return measureInverse<Inverse::inDouble>(poses);
    }
    QX_CHECK(false);
    return {};
}

Sweep inverseSweep(TransformsLab& lab) {
    Sweep sweep;
    sweep.name = "inverse";
    sweep.title = "the inverse of a camera's pose: what each class of matrix saves, and what exactness costs";
    sweep.reference = "the adjugate over the determinant in quadruple precision";
    sweep.metric = "worst entry";
    sweep.errorUnit = "of its column's largest";
    for (const std::string& routine : lab.inverse.options())
        sweep.points.push_back({{"inverse", routine}});
    const auto poses = std::make_shared<Poses>();
    sweep.measure = [&lab, poses](Studio&, const Frame&) {
        return measureInverse(*poses, lab.inverse.as<TransformsLab::Inverse>());
    };
    return sweep;
}

/// The largest distance, in pixels, between where the shader draws a vertex and where it should be.
double worstPixels(const ShaderVertices& vertices, const Frame& frame) {
    double worst = 0;
    for (std::size_t i = 0; i < vertices.clip.size(); ++i) {
        const glm::dvec4 got(vertices.clip[i]);
        const glm::dvec4 exact = vertices.exactClip[i];
        const glm::dvec2 apart = glm::dvec2(got) / got.w - glm::dvec2(exact) / exact.w;
        const double pixels = std::max(std::abs(apart.x) * frame.width, std::abs(apart.y) * frame.height) / 2;
        // A vertex that fell into the eye's plane has no pixel: as far off as the picture is wide.
        worst = std::max(worst, std::isfinite(pixels) ? pixels : frame.width);
    }
    return worst;
}

/// A flight over many boats that lie still, far from the world's origin.
struct Flight {
    static constexpr std::size_t boats = 1024;
    static constexpr int frames = 4096;
    static constexpr double unitsAFrame = 4;
    static constexpr double startUnits = 1'000'000;

    std::vector<glm::dmat4> worldFromBoat;

    Flight() {
        StressInputs draw(16);
        for (std::size_t i = 0; i < boats; ++i) {
            glm::dmat4 pose(draw.rotation());
            pose[3] = glm::dvec4(glm::dvec3(startUnits) + 1000.0 * draw.direction(), 1);
            worldFromBoat.push_back(pose);
        }
    }

    static glm::dvec3 eyeAt(int frame) {
        const double along = startUnits + unitsAFrame * frame;
        return {along, 2, along};
    }
};

struct Flown {
    std::uint64_t placed = 0;  ///< boats, whenever what is subtracted has changed
    float kept = 0;
};

/// What the CPU must do in all frames: the camera's matrix in each, and the boats' matrices again in those in
/// which another point than before is subtracted.
Flown fly(const TransformsLab& lab, const Flight& flight, std::vector<glm::mat4>& placed) {
    Flown flown;
    glm::dmat4 pose(turnMatrix(glm::dvec3(0.1, 1, 0), 0.7));
    glm::dvec3 subtracted(std::numeric_limits<double>::quiet_NaN());
    for (int frame = 0; frame < Flight::frames; ++frame) {
        const glm::dvec3 eye = Flight::eyeAt(frame);
        const glm::dvec3 origin = lab.subtractedFor(eye);
        if (origin != subtracted) {
            subtracted = origin;
            for (std::size_t i = 0; i < Flight::boats; ++i) {
                placed[i] = glm::mat4(flight.worldFromBoat[i]);
                placed[i][3] = glm::vec4(glm::vec3(glm::dvec3(flight.worldFromBoat[i][3]) - origin), 1);
            }
            flown.placed += Flight::boats;
        }
        pose[3] = glm::dvec4(eye - origin, 1);
        flown.kept += inverseRigid(glm::mat4(pose))[3][0] + placed[Flight::boats / 2][3][0];
    }
    return flown;
}

Sweep largeWorldSweep(TransformsLab& lab) {
    Sweep sweep;
    sweep.name = "large_world";
    sweep.title =
        "4096 frames of a flight past 1024 boats, a million units out: how often to move the origin";
    sweep.reference = "P · V · M in double, in a world without offset";
    sweep.metric = "worst vertex";
    sweep.errorUnit = "pixels";
    sweep.width = 640;
    sweep.height = 480;
    const auto point = [&](const char* precision, const char* every) {
        sweep.points.push_back(
            {{"precision", precision}, {"rebase-every", every}, {"view", "picture"}, {"supersample", "1"}});
    };
    // The first never moves, the last always: as steps without end, and smaller than what is flown in a
    // frame.
    point("absolute", "1e+08");
    for (const char* every : {"1e+08", "262144", "65536", "16384", "4096", "1024", "256", "64", "16"})
        point("rebased", every);
    point("eye-relative", "1");
    const auto flight = std::make_shared<Flight>();
    sweep.measure = [&lab, flight](Studio& studio, const Frame& frame) {
        SweepSample sample;
        // Frames evenly over the flight.
        constexpr int looks = 9;
        for (int look = 0; look < looks; ++look) {
            lab.worldOffset.set(
                static_cast<float>(Flight::eyeAt(look * (Flight::frames - 1) / (looks - 1)).x));
            const ShaderVertices vertices = shaderVertices(studio, lab, frame);
            sample.error = std::max(sample.error, worstPixels(vertices, frame));
            sample.counters["vertices"] += vertices.clip.size();
        }
        std::vector<glm::mat4> placed(Flight::boats);
        Flown flown;
        volatile float kept = 0;
        const Timing timing = timeRuns(9, [&] {
            flown = fly(lab, *flight, placed);
            kept = flown.kept;
        });
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters["boats placed"] = flown.placed;
        sample.counters["bytes uploaded"] = flown.placed * sizeof(glm::mat4);
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> TransformsLab::sweeps() {
    std::vector<Sweep> sweeps;
    sweeps.push_back(inverseSweep(*this));
    sweeps.push_back(largeWorldSweep(*this));
    return sweeps;
}

}  // namespace quincunx

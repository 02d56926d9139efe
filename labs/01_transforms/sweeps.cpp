#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/check.h"
#include "base/timing.h"
#include "labs/01_transforms/lab.h"
#include "labs/01_transforms/shader_vertices.h"
#include "math/quad_oracle.h"
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

Sweep largeWorldSweep(TransformsLab& lab) {
    Sweep sweep;
    sweep.name = "large_world";
    sweep.title = "a boat far from the world's origin: where the eye's position is subtracted";
    sweep.reference = "P · V · M in double, in a world without offset";
    sweep.metric = "worst vertex";
    sweep.errorUnit = "pixels";
    sweep.width = 640;
    sweep.height = 480;
    for (const char* precision : {"absolute", "eye-relative"})
        for (const char* offset : {"0", "1000", "10000", "100000", "1000000", "10000000", "100000000"})
            sweep.points.push_back({{"view", "picture"},
                                    {"supersample", "1"},
                                    {"precision", precision},
                                    {"world-offset", offset}});
    sweep.measure = [&lab](Studio& studio, const Frame& frame) {
        const ShaderVertices vertices = shaderVertices(studio, lab, frame);
        SweepSample sample;
        for (std::size_t i = 0; i < vertices.clip.size(); ++i) {
            const glm::dvec4 got(vertices.clip[i]);
            const glm::dvec4 exact = vertices.exactClip[i];
            const glm::dvec2 apart = glm::dvec2(got) / got.w - glm::dvec2(exact) / exact.w;
            const double pixels =
                std::max(std::abs(apart.x) * frame.width, std::abs(apart.y) * frame.height) / 2;
            // A vertex that fell into the eye's plane has no pixel: as far off as the picture is wide.
            sample.error = std::max(sample.error, std::isfinite(pixels) ? pixels : frame.width);
        }
        const Studio::Timing timing = studio.time(lab, frame);
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters = lab.counters();
        sample.counters["vertices"] = vertices.clip.size();
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

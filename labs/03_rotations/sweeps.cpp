#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/timing.h"
#include "labs/03_rotations/lab.h"
#include "math/quad_rotation.h"
#include "math/rotation_hard_cases.h"
#include "math/rotation_interpolation.h"

namespace quincunx {
namespace {

constexpr std::size_t quaternionPairs = 4096;

/// Whole arrays: pairs of rotations, and what is exactly between them.
struct Pairs {
    std::uint64_t seed = 0;
    std::vector<glm::quat> from;
    std::vector<glm::quat> to;
    std::vector<glm::mat3> fromMatrix;
    std::vector<glm::mat3> toMatrix;
    std::vector<float> t;
    std::vector<QuadQuaternion> exact;
};

Pairs makePairs(std::uint64_t seed) {
    Pairs pairs;
    pairs.seed = seed;
    StressInputs draw(seed);
    for (std::size_t i = 0; i < quaternionPairs; ++i) {
        const glm::quat a(randomRotation(draw));
        const glm::quat b(randomRotation(draw));
        const auto t = static_cast<float>(draw.random().uniformDouble());
        pairs.from.push_back(a);
        pairs.to.push_back(b);
        pairs.fromMatrix.push_back(matrixFromQuaternion(a).value_or(glm::mat3(1)));
        pairs.toMatrix.push_back(matrixFromQuaternion(b).value_or(glm::mat3(1)));
        pairs.t.push_back(t);
        pairs.exact.push_back(slerpQuad(QuadQuaternion(a), QuadQuaternion(b), t));
    }
    return pairs;
}

/// Twice without the clock first.
template <typename Work>
void timeWork(SweepSample& sample, const Work& work, int repeats) {
    const Timing timing = timeRuns(repeats, work, 2);
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
}

/// Fills `out` by `compute(i)`, timed; a number of what was written keeps the work from being dropped.
template <typename Result, typename Compute>
std::vector<Result> timed(SweepSample& sample, const Compute& compute) {
    std::vector<Result> out(quaternionPairs);
    volatile float kept = 0;
    timeWork(
        sample,
        [&] {
            for (std::size_t i = 0; i < quaternionPairs; ++i)
                out[i] = compute(i);
            kept = kept + out[quaternionPairs / 2][0][0];
        },
        31);
    return out;
}

/// A quaternion with the [column][row] of a matrix, for `timed`.
struct Turn {
    glm::quat q{1, 0, 0, 0};
    const float* operator[](int) const { return &q.x; }
};

SweepSample measureQuaternions(const Pairs& pairs, glm::quat (*between)(glm::quat, glm::quat, float)) {
    SweepSample sample;
    const std::vector<Turn> out = timed<Turn>(
        sample, [&](std::size_t i) { return Turn{between(pairs.from[i], pairs.to[i], pairs.t[i])}; });
    double sum = 0;
    for (std::size_t i = 0; i < quaternionPairs; ++i) {
        const double angle = angleBetweenQuad(normalizeQuad(QuadQuaternion(out[i].q)), pairs.exact[i]);
        sum += angle * angle;
    }
    sample.error = std::sqrt(sum / quaternionPairs);
    return sample;
}

SweepSample measureMatrices(const Pairs& pairs,
                            glm::mat3 (*between)(const glm::mat3&, const glm::mat3&, float)) {
    SweepSample sample;
    const std::vector<glm::mat3> out = timed<glm::mat3>(
        sample, [&](std::size_t i) { return between(pairs.fromMatrix[i], pairs.toMatrix[i], pairs.t[i]); });
    double sum = 0;
    for (std::size_t i = 0; i < quaternionPairs; ++i) {
        // How far it is from being the rotation, not only how far it turns.
        const double distance = distanceQuad(toQuad(out[i]), matrixQuad(pairs.exact[i]));
        sum += distance * distance;
    }
    sample.error = std::sqrt(sum / quaternionPairs);
    return sample;
}

SweepSample measureMethod(const Pairs& pairs, Method method) {
    switch (method) {
        case Method::matrix:
            return measureMatrices(pairs, &matrixLerpNaive);
        case Method::matrixGramSchmidt:
            return measureMatrices(pairs, &matrixLerpGramSchmidtNaive);
        case Method::nlerp:
            return measureQuaternions(
                pairs, [](glm::quat a, glm::quat b, float t) { return slerpFast<0>(a, b, t); });
        case Method::slerp1:
            return measureQuaternions(
                pairs, [](glm::quat a, glm::quat b, float t) { return slerpFast<1>(a, b, t); });
        case Method::slerp2:
            return measureQuaternions(
                pairs, [](glm::quat a, glm::quat b, float t) { return slerpFast<2>(a, b, t); });
        case Method::slerp3:
            return measureQuaternions(
                pairs, [](glm::quat a, glm::quat b, float t) { return slerpFast<3>(a, b, t); });
        case Method::slerp5:
            return measureQuaternions(
                pairs, [](glm::quat a, glm::quat b, float t) { return slerpFast<5>(a, b, t); });
        case Method::slerpNaive:
            return measureQuaternions(pairs, &slerpNearerNaive);
        case Method::slerp:
        case Method::euler:
            break;
    }
    return measureQuaternions(pairs,
                              [](glm::quat a, glm::quat b, float t) { return slerp(a, b, t).value_or(a); });
}

Sweep interpolationSweep(RotationsLab& lab) {
    Sweep sweep;
    sweep.name = "interpolation";
    sweep.title = "4096 poses somewhere between two others: what constant speed costs";
    sweep.reference = "slerp in quadruple precision";
    sweep.metric = "RMS angle";
    sweep.errorUnit = "rad";
    for (std::size_t i = 1; i < methodNames.size(); ++i)
        sweep.points.push_back({{"method", std::string(methodNames[i])}});
    const auto pairs = std::make_shared<Pairs>();
    sweep.measure = [&lab, pairs](Studio&, const Frame& frame) {
        if (pairs->from.empty() || pairs->seed != frame.seed)
            *pairs = makePairs(frame.seed);
        SweepSample sample = measureMethod(*pairs, lab.method.as<Method>());
        sample.counters["poses"] = quaternionPairs;
        return sample;
    };
    return sweep;
}

Sweep driftSweep(RotationsLab& lab) {
    Sweep sweep;
    sweep.name = "drift";
    sweep.title = "a million small turns after one another: how often to renormalise";
    sweep.reference = "a rotation has |q| = 1";
    sweep.metric = "largest | |q| − 1 |";
    sweep.errorUnit = "";
    for (const int every : {0, 16384, 4096, 1024, 256, 64, 16, 4, 1})
        sweep.points.push_back({{"renormalize-every", std::to_string(every)}});
    sweep.measure = [&lab](Studio&, const Frame& frame) {
        StressInputs draw(frame.seed);
        const glm::quat turn = smallTurn(draw.unitVector());
        const auto every = static_cast<std::uint64_t>(static_cast<int>(lab.renormalizeEvery));
        const std::uint64_t stretch = every == 0 ? driftProducts : every;
        SweepSample sample;
        volatile float kept = 0;
        timeWork(
            sample,
            [&] {
                glm::quat q(1, 0, 0, 0);
                for (std::uint64_t done = 0; done < driftProducts; done += stretch) {
                    for (std::uint64_t i = 0; i < stretch; ++i)
                        q = productNaive(turn, q);
                    if (every > 0)
                        q = normalizeNaive(q);
                }
                kept = q.w;
            },
            5);
        sample.error = measureDrift(turn, lab.renormalizeEvery).largest;
        sample.counters["products"] = driftProducts;
        sample.counters["renormalisations"] = every > 0 ? driftProducts / every : 0;
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> RotationsLab::sweeps() {
    return {interpolationSweep(*this), driftSweep(*this)};
}

}  // namespace quincunx

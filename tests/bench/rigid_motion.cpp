// What orthonormality that does not drift costs: the stable turns, frames and inverses on whole arrays, each
// beside the textbook's form, with the ratio of their times.

#include "math/rigid_motion.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "math/stress_inputs.h"
#include "math/transform.h"
#include "ratio_reporter.h"

namespace {

using namespace quincunx;

struct Inputs {
    std::vector<glm::mat3> frames;
    std::vector<glm::mat4> poses;
    std::vector<RigidPose> bodies;
    std::vector<glm::vec3> axes;
    std::vector<float> angles;
};

const Inputs& inputs() {
    static const Inputs filled = [] {
        Inputs made;
        StressInputs draw(1);
        for (int i = 0; i < 1024; ++i) {
            const glm::dmat3 rotation = draw.rotation();
            made.frames.emplace_back(rotation);
            made.bodies.push_back({rotation, draw.magnitude(0, 10) * draw.direction()});
            made.poses.push_back(made.bodies.back().matrix());
            made.axes.push_back(draw.unitVector());
            made.angles.push_back(static_cast<float>(draw.random().uniform(-0.1, 0.1)));
        }
        return made;
    }();
    return filled;
}

template <typename Result, typename Compute>
void overArray(benchmark::State& state, Compute compute) {
    std::vector<Result> out(inputs().frames.size());
    for (auto _ : state) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = compute(inputs(), i);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * out.size()));
}

/// Registers "routine/naive" and "routine/stable".
template <typename Result, typename Naive, typename Stable>
void compare(const std::string& routine, const Naive& naive, const Stable& stable) {
    benchmark::RegisterBenchmark((routine + "/naive").c_str(),
                                 [naive](benchmark::State& state) { overArray<Result>(state, naive); });
    benchmark::RegisterBenchmark((routine + "/stable").c_str(),
                                 [stable](benchmark::State& state) { overArray<Result>(state, stable); });
}

}  // namespace

int main(int argc, char** argv) {
    using I = const Inputs&;
    using N = std::size_t;
    compare<glm::mat3>(
        "turnMatrix", [](I in, N i) { return turnMatrixNaive(in.axes[i], in.angles[i]); },
        [](I in, N i) { return turnMatrix(in.axes[i], in.angles[i]); });
    compare<glm::mat3>(
        "turned", [](I in, N i) { return turnedNaive(in.frames[i], in.axes[i], in.angles[i]); },
        [](I in, N i) { return turned(in.frames[i], in.axes[i], in.angles[i]).value_or(glm::mat3(1)); });
    compare<glm::mat3>(
        "Orientation (a turn)", [](I in, N i) { return turnedNaive(in.frames[i], in.axes[i], in.angles[i]); },
        [body = Orientation()](I in, N i) mutable {
            body.turnAboutBody(glm::dvec3(in.axes[i]), static_cast<double>(in.angles[i]));
            return body.worldFromBodyFloat();
        });
    compare<glm::mat3>(
        "gramSchmidt", [](I in, N i) { return gramSchmidtNaive(in.frames[i]); },
        [](I in, N i) { return gramSchmidt(in.frames[i]).value_or(glm::mat3(1)); });
    compare<glm::mat3>(
        "newtonSchulzStep", [](I in, N i) { return gramSchmidtNaive(in.frames[i]); },
        [](I in, N i) { return newtonSchulzStep(in.frames[i]); });
    compare<glm::mat3>(
        "nearestRotation", [](I in, N i) { return gramSchmidtNaive(in.frames[i]); },
        [](I in, N i) { return nearestRotation(in.frames[i]).value_or(glm::mat3(1)); });
    compare<glm::mat4>(
        "cameraFromWorld", [](I in, N i) { return inverseNaive(in.poses[i]); },
        [](I in, N i) { return cameraFromWorld(in.poses[i]); });
    compare<glm::mat4>(
        "cameraFromModel", [](I in, N i) { return cameraFromModelNaive(in.poses[i], in.poses[0]); },
        [](I in, N i) { return cameraFromModel(in.bodies[i], in.bodies[0]); });
    compare<glm::dvec2>(
        "arcOffset", [](I in, N i) { return glm::dvec2(arcOffsetNaive(1 + in.angles[i], in.axes[i].x)); },
        [](I in, N i) {
            return arcOffset(1 + static_cast<double>(in.angles[i]), static_cast<double>(in.axes[i].x));
        });

    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}

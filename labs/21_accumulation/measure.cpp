#include "labs/21_accumulation/measure.h"

#include <cmath>

#include "base/interrupt.h"
#include "image/compare.h"

namespace quincunx {

double edgeError(AccumulationLab& lab, Studio& studio, int width, int height, std::uint64_t seed) {
    Frame frame = studio.frame(lab, width, height);
    frame.seed = seed;
    return rmse(lab.reference(frame)(interruptFlag()), studio.linearPicture(lab, frame));
}

double fittedSlope(const std::vector<int>& passes, const std::vector<double>& errors) {
    double sumX = 0;
    double sumY = 0;
    double sumXX = 0;
    double sumXY = 0;
    const auto count = static_cast<double>(passes.size());
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const double x = std::log2(static_cast<double>(passes[i]));
        const double y = std::log2(errors[i]);
        sumX += x;
        sumY += y;
        sumXX += x * x;
        sumXY += x * y;
    }
    return (count * sumXY - sumX * sumY) / (count * sumXX - sumX * sumX);
}

Convergence convergenceOf(AccumulationLab& lab, Studio& studio, SamplePattern pattern,
                          const std::vector<int>& passes, int seeds) {
    // All pixels of a row see the same samples: a few rows, and more seeds, say more.
    constexpr int width = 96;
    constexpr int height = 24;
    const KnobScope scope(lab.knobs());
    lab.samples.set(static_cast<int>(pattern));
    Convergence convergence;
    for (const int count : passes) {
        lab.passes.set(count);
        double squares = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
            const double error = edgeError(lab, studio, width, height, static_cast<std::uint64_t>(seed));
            squares += error * error;
        }
        convergence.errors.push_back(std::sqrt(squares / seeds));
    }
    convergence.slope = fittedSlope(passes, convergence.errors);
    return convergence;
}

double meanOfSameFrames(Studio& studio, const Accumulator::Params& wanted, float value) {
    studio.context();
    Accumulator accumulator;
    AccumulationParams params;
    params.accumulator = wanted;
    params.accumulator.width = 1;
    params.accumulator.height = 1;
    params.format = graph::Format::rgba32f;
    params.samples.resize(wanted.passes);
    params.draw = [value](graph::PassContext&, const PassSample&) {
        const GLfloat color[4] = {value, value, value, 1};
        glClearBufferfv(GL_COLOR, 0, color);
    };
    graph::FrameGraph graph;
    const graph::Resource picture = addAccumulationPasses(graph, accumulator, params);
    graph.addOutput(picture);
    studio.executor().run(graph);
    return static_cast<double>(gl::readPixels(studio.executor().output(picture)).data[0]);
}

Image convergedPicture(AccumulationLab& lab, Studio& studio, const Frame& frame, int passes) {
    const KnobScope scope(lab.knobs());
    lab.method.set(static_cast<int>(AccumulationLab::Method::accumulated));
    lab.samples.set(static_cast<int>(SamplePattern::sobol));
    lab.summation.set(static_cast<int>(Summation::compensated));
    lab.passes.set(passes);
    Frame other = frame;
    other.seed = frame.seed + 1000;
    return studio.linearPicture(lab, other);
}

}  // namespace quincunx

// What accumulating adds to a pass: CPU time of the process for the still life drawn through 32 points of a
// lens, each picture added up, beside the same 32 pictures drawn one over the other.
#include "passes/accumulation.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "gl/context.h"
#include "gl/executor.h"
#include "passes/forward.h"
#include "scene/still_life.h"

namespace {

using namespace quincunx;

constexpr int passes = 32;

double cpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

class Bench {
  public:
    Bench(int width, int height)
        : width_(width),
          height_(height),
          context_(gl::createOffscreenContext(gl::Backend::automatic)),
          scene_(tessellate(makeStillLife(), 48)),
          camera_(makeStillLife().camera),
          samples_(passSamples(SamplePattern::sobol, passes, {.depthOfField = true}, 1)) {
        camera_.apertureRadius = 0.1f;
        camera_.focusDistance = 9;
    }

    double seconds(bool accumulated, Summation summation, AccumulationBuffer buffer) {
        graph::FrameGraph graph;
        graph.addOutput(accumulated ? addAccumulated(graph, summation, buffer) : addPlain(graph));
        const double start = cpuSeconds();
        executor_.run(graph);
        glFinish();
        return (cpuSeconds() - start) / passes;
    }

  private:
    void draw(graph::PassContext& context, const PassSample& sample) {
        glClear(GL_DEPTH_BUFFER_BIT);
        scene_.draw(context, passView(camera_, width_, height_, sample));
    }
    graph::Resource addPlain(graph::FrameGraph& graph) {
        const graph::Resource picture =
            graph.addResource({"picture", graph::Format::rgba32f, width_, height_});
        const graph::Resource depth = graph.addResource({"depth", graph::Format::depth32f, width_, height_});
        graph.addPass({.name = "draw",
                       .reads = {},
                       .writes = {picture, depth},
                       .execute = [this](graph::PassContext& context) {
                           for (const PassSample& sample : samples_) {
                               draw(context, sample);
                               glFlush();  // or a driver may drop what the next picture covers
                           }
                       }});
        return picture;
    }
    graph::Resource addAccumulated(graph::FrameGraph& graph, Summation summation, AccumulationBuffer buffer) {
        AccumulationParams params;
        params.accumulator = {.width = width_,
                              .height = height_,
                              .summation = summation,
                              .buffer = buffer,
                              .passes = samples_.size()};
        params.samples = samples_;
        params.draw = [this](graph::PassContext& context, const PassSample& sample) {
            draw(context, sample);
        };
        return addAccumulationPasses(graph, accumulator_, params);
    }

    int width_;
    int height_;
    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    ForwardScene scene_;
    Camera camera_;
    std::vector<PassSample> samples_;
    Accumulator accumulator_;
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    Bench bench(640, 480);
    struct Row {
        const char* name;
        Summation summation;
        AccumulationBuffer buffer;
    };
    for (const Row& row : {Row{"compensated", Summation::compensated, AccumulationBuffer::rgba32f},
                           Row{"weighted, 32F", Summation::weighted, AccumulationBuffer::rgba32f}}) {
        std::vector<double> ours;
        std::vector<double> plain;
        std::vector<double> ratios;
        for (int round = 0; round < 8; ++round) {
            const double first = bench.seconds(true, row.summation, row.buffer);
            const double second = bench.seconds(false, row.summation, row.buffer);
            if (round == 0)
                continue;  // programs are finished at their first use
            ours.push_back(first);
            plain.push_back(second);
            ratios.push_back(first / second);
        }
        std::printf("ratio accumulated / drawn a pass, %s: %.3f (%.3f ms / %.3f ms; round by round %.3f)\n",
                    row.name, median(ours) / median(plain), median(ours) * 1e3, median(plain) * 1e3,
                    median(ratios));
    }
    return 0;
}

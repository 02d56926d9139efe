#include "lab/studio.h"

#include <numeric>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/interrupt.h"
#include "gl/calls.h"
#include "lab/timing_limit.h"
#include "scene/import.h"

namespace quincunx {
namespace {

int timingLimits = 0;

/// Of the targets that a frame shares among its resources; what other frames left is not its own.
std::size_t targetBytesOf(const graph::FrameGraph& graph) {
    const graph::Plan plan = graph.compile();
    std::vector<std::size_t> bySlot(plan.slotCount, 0);
    for (std::size_t r = 0; r < graph.resourceCount(); ++r) {
        const graph::ResourceDescription& resource = graph.resource({r});
        if (plan.lifetimes[r].used)
            bySlot[plan.lifetimes[r].slot] = static_cast<std::size_t>(resource.width) *
                                             static_cast<std::size_t>(resource.height) *
                                             graph::bytesPerTexel(resource.format);
    }
    return std::accumulate(bySlot.begin(), bySlot.end(), std::size_t{0});
}

}  // namespace

TimingLimit::TimingLimit() {
    ++timingLimits;
}

TimingLimit::~TimingLimit() {
    --timingLimits;
}

Studio::~Studio() {
    if (context_)
        context_->makeCurrent();
    executor_.reset();
}

gl::Context& Studio::context() {
    if (context_) {
        context_->makeCurrent();
        return *context_;
    }
    context_ = gl::createOffscreenContext(backend_);
    executor_ = std::make_unique<gl::Executor>();
    return *context_;
}

gl::Executor& Studio::executor() {
    context();
    return *executor_;
}

graph::Resource Studio::draw(Lab& lab, const Frame& frame) {
    graph::FrameGraph graph;
    const graph::Resource picture = lab.build(graph, frame);
    graph.addOutput(picture);
    executor().run(graph);
    return picture;
}

graph::Resource Studio::drawTimed(Lab& lab, const Frame& frame) {
    context();
    graph::Resource picture;
    pictureSeconds_ = gl::secondsOf([&] { picture = draw(lab, frame); });
    return picture;
}

Image8 Studio::picture(Lab& lab, const Frame& frame) {
    QX_CHECK(frame.pictureFormat == graph::Format::rgba8Srgb);
    const graph::Resource picture = drawTimed(lab, frame);
    return gl::readPixels8(executor_->output(picture));
}

Image Studio::linearPicture(Lab& lab, const Frame& frame) {
    Frame exact = frame;
    exact.pictureFormat = graph::Format::rgba32f;
    const graph::Resource picture = drawTimed(lab, exact);
    return gl::readPixels(executor_->output(picture));
}

Image Studio::resource(Lab& lab, const Frame& frame, std::string_view name) {
    graph::FrameGraph graph;
    graph.addOutput(lab.build(graph, frame));
    const graph::Resource wanted = graph.find(name);
    graph.addOutput(wanted);
    executor().run(graph);
    return gl::readPixels(executor_->output(wanted));
}

Studio::Timing Studio::time(Lab& lab, const Frame& frame, int repeats, int warmUps) {
    QX_CHECK_GE(repeats, 1);
    context();
    const bool once = timingLimits > 0;
    for (int i = 0; i < warmUps && !once; ++i)
        draw(lab, frame);
    std::vector<double> seconds;
    for (int i = 0; i < (once ? 1 : repeats); ++i) {
        throwIfInterrupted();
        seconds.push_back(gl::secondsOf([&] { draw(lab, frame); }));
    }
    return timingOf(std::move(seconds));
}

graph::FrameGraph Studio::graph(Lab& lab, const Frame& frame) {
    context();
    graph::FrameGraph graph;
    graph.addOutput(lab.build(graph, frame));
    return graph;
}

Studio::FrameCost Studio::cost(Lab& lab, const Frame& frame, int repeats) {
    QX_CHECK_GE(repeats, 1);
    context();
    constexpr int warmUps = 2;
    for (int i = 0; i < warmUps; ++i)
        draw(lab, frame);
    FrameCost result;
    const std::uint64_t before = gl::callCount();
    draw(lab, frame);
    result.glCalls = gl::callCount() - before;
    result.targetBytes = targetBytesOf(graph(lab, frame));
    std::vector<std::vector<double>> seconds;
    for (int i = 0; i < repeats; ++i) {
        throwIfInterrupted();
        result.passes = executor_->runMeasured(graph(lab, frame));
        seconds.resize(result.passes.size());
        for (std::size_t p = 0; p < result.passes.size(); ++p)
            seconds[p].push_back(result.passes[p].seconds);
    }
    for (std::size_t p = 0; p < result.passes.size(); ++p)
        result.passes[p].seconds = timingOf(seconds[p]).medianSeconds;
    return result;
}

std::uint64_t Studio::samplesPassed(Lab& lab, const Frame& frame) {
    context();
    const gl::Query query("samples passed", GL_SAMPLES_PASSED);
    return query.count([&] { draw(lab, frame); });
}

Frame Studio::frame(const Lab& lab, int width, int height) const {
    Frame frame;
    frame.width = width;
    frame.height = height;
    frame.camera =
        fittedToAspect(lab.defaultCamera(), static_cast<float>(width) / static_cast<float>(height));
    return frame;
}

}  // namespace quincunx

#include "passes/accumulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/check.h"
#include "math/projection.h"
#include "math/transform.h"
#include "math/vector.h"
#include "passes/fullscreen.h"

namespace quincunx {
namespace {

// Not the unit of the materials, so that both stay bound from pass to pass.
constexpr int pictureUnit = 1;
constexpr int totalUnit = 2;
constexpr int carryUnit = 3;
constexpr std::array<GLuint, 4> pictureUnits = {pictureUnit, 8, 9, 10};
constexpr GLuint beforeUnit = 11;
constexpr double greatestEntry = 0x1p100;

GLenum formatOf(const Accumulator::Params& params) {
    if (params.summation == Summation::compensated || params.buffer == AccumulationBuffer::rgba32f)
        return GL_RGBA32F;
    return params.buffer == AccumulationBuffer::rgba16f ? GL_RGBA16F : GL_RGBA8;
}

std::size_t bytesPerTexelOf(GLenum format) {
    return format == GL_RGBA32F ? 16 : format == GL_RGBA16F ? 8 : 4;
}

bool isMiddle(glm::dvec2 sample) {
    return sample == glm::dvec2(0.5);
}

/// lens/focus, where 0/0 is 0: the middle of the lens sees what it sees wherever the focus is.
glm::dvec2 slopeOf(glm::dvec2 lensPoint, double focusDistance) {
    const auto slope = [&](double x) {
        return x == 0 ? 0.0 : std::clamp(x / focusDistance, -greatestEntry, greatestEntry);
    };
    return {slope(lensPoint.x), slope(lensPoint.y)};
}

const gl::ProgramFiles& addProgram() {
    static const gl::ProgramFiles files = [] {
        gl::ProgramFiles made = fullscreenProgram("accumulate_add");
        made.samplers = {{"before", beforeUnit}};
        for (std::size_t i = 0; i < pictureUnits.size(); ++i)
            made.samplers.push_back({fmt::format("picture{}", i), static_cast<GLint>(pictureUnits[i])});
        return made;
    }();
    return files;
}

void drawOnTop(graph::PassContext& context) {
    glEnable(GL_BLEND);
    context.drawFullscreen();
    glDisable(GL_BLEND);
}

}  // namespace

std::vector<PassSample> passSamples(SamplePattern pattern, int passes, const AccumulatedEffects& effects,
                                    std::uint64_t seed) {
    QX_CHECK_GE(passes, 1);
    if (!effects.any())
        return {PassSample{}};
    static constexpr std::array groups = {2, 2, 2, 1};
    constexpr std::size_t dimensions = 7;
    const std::vector<double> points = samplePoints(pattern, static_cast<std::size_t>(passes), groups, seed);
    std::vector<PassSample> samples(static_cast<std::size_t>(passes));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double* const x = points.data() + i * dimensions;
        if (effects.antialiasing)
            samples[i].pixel = {x[0], x[1]};
        if (effects.depthOfField)
            samples[i].lens = {x[2], x[3]};
        if (effects.softShadows)
            samples[i].light = {x[4], x[5]};
        if (effects.motionBlur)
            samples[i].time = x[6];
    }
    return samples;
}

glm::dmat4 lensClipFromCamera(const Camera& camera, float aspect, glm::dvec2 lensPoint,
                              glm::dvec2 offsetNdc) {
    QX_CHECK(camera.focusDistance >= 0);
    const double n = camera.nearDistance;
    const double f = camera.farDistance;
    const double scale = 1 / std::tan(static_cast<double>(camera.fovYRadians) / 2);
    const glm::dvec2 scales(scale / static_cast<double>(aspect), scale);
    const bool farAway = std::isinf(f);
    glm::dmat4 m(0);
    m[0][0] = scales.x;
    m[1][1] = scales.y;
    m[2][2] = farAway ? -1 : -(f + n) / (f - n);
    m[2][3] = -1;
    m[3][2] = farAway ? -2 * n : -2 * n * (f / (f - n));
    const glm::dvec2 slope = slopeOf(lensPoint, camera.focusDistance);
    for (int axis = 0; axis < 2; ++axis) {
        // x + lens (z/focus − 1), z = −z_eye = w; and the whole picture moved against the sample.
        m[2][axis] = std::clamp(offsetNdc[axis] - scales[axis] * slope[axis], -greatestEntry, greatestEntry);
        m[3][axis] = std::clamp(-scales[axis] * lensPoint[axis], -greatestEntry, greatestEntry);
    }
    return m;
}

glm::mat4 lensClipFromCameraNaive(const Camera& camera, float aspect, glm::vec2 lensPoint) {
    const float n = camera.nearDistance;
    const float f = camera.farDistance;
    const float top = n * std::tan(camera.fovYRadians / 2);
    const float right = top * aspect;
    const glm::vec2 moved = -lensPoint * n / camera.focusDistance;
    const float l = -right + moved.x;
    const float r = right + moved.x;
    const float b = -top + moved.y;
    const float t = top + moved.y;
    glm::mat4 frustum(0);
    frustum[0][0] = 2 * n / (r - l);
    frustum[1][1] = 2 * n / (t - b);
    frustum[2] = {(r + l) / (r - l), (t + b) / (t - b), -(f + n) / (f - n), -1};
    frustum[3][2] = -2 * f * n / (f - n);
    glm::mat4 translation(1);
    translation[3] = {-lensPoint, 0, 1};
    return frustum * translation;
}

ForwardView passView(const Camera& camera, int widthPixels, int heightPixels, const PassSample& sample) {
    QX_CHECK(camera.apertureRadius >= 0);
    const float aspect = static_cast<float>(widthPixels) / static_cast<float>(heightPixels);
    const bool pinhole = camera.apertureRadius == 0 || isMiddle(sample.lens);
    if (pinhole && isMiddle(sample.pixel))
        return forwardView(camera, aspect);
    const glm::dvec2 lensPoint =
        pinhole ? glm::dvec2(0) : static_cast<double>(camera.apertureRadius) * pointOnDisc(sample.lens);
    // Divided by −w = z_eye in the matrix: a sample to the right moves the picture to the left.
    const glm::dvec2 offsetNdc = 2.0 * (sample.pixel - 0.5) / glm::dvec2(widthPixels, heightPixels);
    const glm::dmat4 worldFromCamera(camera.worldFromCamera);
    ForwardView view;
    view.clipFromWorld =
        glm::mat4(lensClipFromCamera(camera, aspect, lensPoint, offsetNdc) * glm::inverse(worldFromCamera));
    view.eyeWorld = glm::vec3(worldFromCamera * glm::dvec4(lensPoint, 0, 1));
    return view;
}

Light passLight(const AreaLight& area, const PassSample& sample) {
    QX_CHECK(area.radius >= 0);
    Light light = area.light;
    if (area.radius == 0 || isMiddle(sample.light))
        return light;
    const std::optional<glm::mat3> basis = basisAround(light.direction);
    if (!basis)
        return light;
    const glm::dvec2 across =
        static_cast<double>(area.radius) *
        (area.shape == AreaLight::Shape::disc ? pointOnDisc(sample.light) : 2.0 * sample.light - 1.0);
    const glm::dvec3 offset = across.x * glm::dvec3((*basis)[0]) + across.y * glm::dvec3((*basis)[1]);
    if (light.kind == Light::Kind::directional)
        light.direction = glm::vec3(glm::normalize(glm::dvec3(light.direction) - offset));
    else
        light.position = glm::vec3(glm::dvec3(light.position) + offset);
    return light;
}

double passSeconds(double seconds, double shutterSeconds, const PassSample& sample) {
    return seconds + shutterSeconds * (sample.time - 0.5);
}

float passSecondsNaive(float seconds, float shutterSeconds, float sample) {
    return seconds + shutterSeconds * (sample - 0.5f);
}

void Accumulator::restart(const Params& params, std::uint64_t rebuilds) {
    QX_CHECK(params.width >= 1 && params.height >= 1);
    QX_CHECK(params.passes >= 1 && params.blockPasses >= 1);
    const bool sameBuffers = params.width == params_.width && params.height == params_.height &&
                             formatOf(params) == formatOf(params_) && params.summation == params_.summation &&
                             params.passes == params_.passes && params.blockPasses == params_.blockPasses;
    if (!sameBuffers) {
        pictures_ = {};
        sums_ = {};
        totals_ = {};
        depth_ = {};
    }
    params_ = params;
    rebuilds_ = rebuilds;
    added_ = 0;
    waiting_ = 0;
    inBlock_ = 0;
    folds_ = 0;
    current_ = 0;
}

Accumulator::Target Accumulator::makeTarget(const char* name, GLenum format, std::size_t colors,
                                            const gl::Texture2D* depth) const {
    Target target;
    std::vector<const gl::Texture2D*> attached;
    for (std::size_t i = 0; i < colors; ++i)
        target.colors.emplace_back(name, format, params_.width, params_.height);
    for (const gl::Texture2D& color : target.colors)
        attached.push_back(&color);
    target.framebuffer = gl::Framebuffer(name, attached, depth);
    return target;
}

std::size_t Accumulator::bytes() const {
    const std::size_t texels =
        static_cast<std::size_t>(params_.width) * static_cast<std::size_t>(params_.height);
    std::size_t bytesPerTexel = depth_ ? 4 : 0;
    const auto add = [&](const auto& targets) {
        for (const std::optional<Target>& target : targets)
            bytesPerTexel += target ? target->colors.size() * bytesPerTexelOf(formatOf(params_)) : 0;
    };
    add(pictures_);
    add(sums_);
    add(totals_);
    return texels * bytesPerTexel;
}

bool Accumulator::blends() const {
    return formatOf(params_) != GL_RGBA32F || params_.summation == Summation::runningMean;
}

std::size_t Accumulator::atATime() const {
    if (blends())
        return 1;
    return params_.summation == Summation::compensated ? std::min(mostAtATime, params_.blockPasses)
                                                       : mostAtATime;
}

void Accumulator::add(graph::PassContext& context, const Draw& prepare, const Draw& draw) {
    QX_CHECK_LT(added_, params_.passes);
    if (!depth_)
        depth_ = gl::Texture2D("accumulated pass", GL_DEPTH_COMPONENT32F, params_.width, params_.height);
    std::optional<Target>& picture = pictures_[waiting_];
    if (!picture)
        picture = makeTarget("accumulated pass", formatOf(params_), 1, &depth_);
    if (prepare)
        prepare(context);
    picture->framebuffer.bind();
    draw(context);
    ++added_;
    ++waiting_;
    const bool endsBlock =
        params_.summation == Summation::compensated && inBlock_ + waiting_ == params_.blockPasses;
    if (endsBlock || waiting_ == atATime())
        settle(context);
}

void Accumulator::settle(graph::PassContext& context) {
    if (waiting_ == 0)
        return;
    const std::size_t pictures = std::exchange(waiting_, 0);
    const bool compensated = params_.summation == Summation::compensated;
    if (compensated && params_.blockPasses == 1 && params_.passes > 1)
        return foldBlock(context, pictures_[0]->colors[0]);
    const bool first = inBlock_ == 0;
    const std::size_t last = current_;
    if (!blends() && !first)
        current_ = 1 - current_;
    std::optional<Target>& sum = sums_[current_];
    if (!sum)
        sum = makeTarget("accumulation", formatOf(params_), 1);
    sum->framebuffer.bind();
    const gl::Program& program = context.programs().get(addProgram());
    program.use();
    program.set("count", static_cast<int>(pictures));
    program.set("hasBefore", blends() || first ? 0 : 1);
    program.set("weight",
                params_.summation == Summation::weighted ? 1.0f / static_cast<float>(params_.passes) : 1.0f);
    for (std::size_t i = 0; i < pictures; ++i)
        pictures_[i]->colors[0].bind(pictureUnits[i]);
    if (!blends() && !first)
        sums_[last]->colors[0].bind(beforeUnit);
    if (first || !blends()) {
        context.drawFullscreen();
    } else {
        if (params_.summation == Summation::runningMean) {
            const float share = 1.0f / static_cast<float>(inBlock_ + 1);
            glBlendColor(share, share, share, share);
            glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
        } else {
            glBlendFunc(GL_ONE, GL_ONE);
        }
        drawOnTop(context);
    }
    inBlock_ += pictures;
    // What fits into one block needs no total.
    if (compensated && params_.passes > params_.blockPasses && inBlock_ == params_.blockPasses) {
        foldBlock(context, sums_[current_]->colors[0]);
        inBlock_ = 0;
    }
}

void Accumulator::foldBlock(graph::PassContext& context, const gl::Texture2D& block) {
    std::optional<Target>& next = totals_[(folds_ + 1) % 2];
    std::optional<Target>& last = totals_[folds_ % 2];
    for (std::optional<Target>* total : {&last, &next})
        if (!*total)
            *total = makeTarget("accumulated total", GL_RGBA32F, 2);
    if (folds_ == 0) {
        last->framebuffer.bind();
        const std::array<GLfloat, 4> nothing{};
        glClearBufferfv(GL_COLOR, 0, nothing.data());
        glClearBufferfv(GL_COLOR, 1, nothing.data());
    }
    next->framebuffer.bind();
    const gl::Program& program = context.programs().get(fullscreenProgram("accumulate_fold"));
    program.use();
    program.set("block", pictureUnit);
    program.set("totalMap", totalUnit);
    program.set("carryMap", carryUnit);
    program.set("zero", 0);
    block.bind(pictureUnit);
    last->colors[0].bind(totalUnit);
    last->colors[1].bind(carryUnit);
    context.drawFullscreen();
    ++folds_;
}

void Accumulator::show(graph::PassContext& context) const {
    QX_CHECK_GT(added_, 0u);
    QX_CHECK_EQ(waiting_, 0u);
    const bool compensated = params_.summation == Summation::compensated;
    const bool hasBlock = !compensated || inBlock_ > 0;
    const float divisor = compensated ? static_cast<float>(added_)
                          : params_.summation == Summation::runningMean
                              ? 1.0f
                              : static_cast<float>(added_) / static_cast<float>(params_.passes);
    const gl::Program& program = context.programs().get(fullscreenProgram("accumulate_show"));
    program.use();
    program.set("block", pictureUnit);
    program.set("totalMap", totalUnit);
    program.set("carryMap", carryUnit);
    program.set("hasBlock", hasBlock ? 1 : 0);
    program.set("hasTotal", folds_ > 0 ? 1 : 0);
    program.set("divisor", divisor);
    if (hasBlock)
        sums_[current_]->colors[0].bind(pictureUnit);
    if (folds_ > 0) {
        totals_[folds_ % 2]->colors[0].bind(totalUnit);
        totals_[folds_ % 2]->colors[1].bind(carryUnit);
    }
    context.drawFullscreen();
}

graph::Resource addAccumulationPasses(graph::FrameGraph& graph, Accumulator& accumulator,
                                      const AccumulationParams& params, bool resume) {
    const Accumulator::Params& wanted = params.accumulator;
    QX_CHECK_EQ(params.samples.size(), wanted.passes);
    const graph::Resource picture =
        graph.addResource({"picture", params.format, wanted.width, wanted.height});
    if (params.samples.size() == 1) {
        const graph::Resource depth =
            graph.addResource({"depth", graph::Format::depth32f, wanted.width, wanted.height});
        graph::PassDescription draw{.name = "draw",
                                    .reads = {},
                                    .writes = {picture, depth},
                                    .execute = [params](graph::PassContext& context) {
                                        params.draw(context, params.samples.front());
                                    }};
        if (params.prepare) {
            const graph::Resource ready = graph.addResource({"prepared", graph::Format::rgba8, 1, 1});
            graph.addPass({.name = "prepare",
                           .reads = {},
                           .writes = {ready},
                           .execute = [params](graph::PassContext& context) {
                               // What the resource holds is not read, yet it is defined.
                               glClear(GL_COLOR_BUFFER_BIT);
                               params.prepare(context, params.samples.front());
                           }});
            draw.reads.push_back(ready);
        }
        graph.addPass(std::move(draw));
        return picture;
    }
    const graph::Resource done = graph.addResource({"accumulation done", graph::Format::rgba8, 1, 1});
    graph.addPass(
        {.name = "accumulate",
         .reads = {},
         .writes = {done},
         .execute = [params, resume, &accumulator](graph::PassContext& context) {
             glClear(GL_COLOR_BUFFER_BIT);
             const std::uint64_t rebuilds = context.programs().rebuilds();
             if (!resume || accumulator.params() != params.accumulator || accumulator.rebuilds() != rebuilds)
                 accumulator.restart(params.accumulator, rebuilds);
             const std::size_t left = params.samples.size() - accumulator.added();
             const std::size_t now = params.passesAFrame == 0 ? left : std::min(left, params.passesAFrame);
             for (std::size_t i = 0; i < now; ++i) {
                 const PassSample& sample = params.samples[accumulator.added()];
                 accumulator.add(
                     context,
                     [&](graph::PassContext& pass) {
                         if (params.prepare)
                             params.prepare(pass, sample);
                     },
                     [&](graph::PassContext& pass) { params.draw(pass, sample); });
             }
             accumulator.settle(context);
         }});
    graph.addPass({.name = "show the mean",
                   .reads = {done},
                   .writes = {picture},
                   .execute = [&accumulator](graph::PassContext& context) { accumulator.show(context); }});
    return picture;
}

}  // namespace quincunx

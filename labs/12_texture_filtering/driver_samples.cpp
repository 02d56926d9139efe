#include "labs/12_texture_filtering/driver_samples.h"

#include <algorithm>

#include "base/check.h"
#include "gl/upload.h"

namespace quincunx {
namespace {

constexpr GLuint sampledUnit = 1;
constexpr GLuint placesUnit = 2;
constexpr GLuint derivativesUnit = 3;

std::vector<glm::vec4> sample(gl::Executor& executor, const gl::Texture2D& texture,
                              const gl::Sampler::Params& sampler, std::span<const TexturePoint> points,
                              std::span<const float> levels) {
    const auto count = static_cast<int>(points.size());
    const int width = std::clamp(count, 1, 256);
    const int height = std::max((count + width - 1) / width, 1);
    Image places(width, height, 4, Encoding::linear);
    Image derivatives = places;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const TexturePoint& point = points[i];
        const float level = levels.empty() ? 0 : levels[i];
        const float place[] = {point.st.x, point.st.y, level, 0};
        const float along[] = {point.alongX.x, point.alongX.y, point.alongY.x, point.alongY.y};
        std::copy_n(place, 4, &places.data[4 * i]);
        std::copy_n(along, 4, &derivatives.data[4 * i]);
    }
    const gl::Texture2D placesTexture("places", GL_RGBA32F, width, height);
    const gl::Texture2D derivativesTexture("derivatives", GL_RGBA32F, width, height);
    gl::upload(placesTexture, 0, 0, places);
    gl::upload(derivativesTexture, 0, 0, derivatives);
    graph::FrameGraph graph;
    const graph::Resource samples = graph.addResource({"samples", graph::Format::rgba32f, width, height});
    graph.addPass(
        {.name = "sample", .reads = {}, .writes = {samples}, .execute = [&](graph::PassContext& context) {
             const gl::Program& program =
                 context.programs().get({.label = "samples",
                                         .vertex = "passes/fullscreen.vert",
                                         .fragment = "labs/12_texture_filtering/samples.frag"});
             program.use();
             program.set("image", static_cast<int>(sampledUnit));
             program.set("places", static_cast<int>(placesUnit));
             program.set("derivatives", static_cast<int>(derivativesUnit));
             program.set("byLevel", levels.empty() ? 0 : 1);
             texture.bind(sampledUnit);
             placesTexture.bind(placesUnit);
             derivativesTexture.bind(derivativesUnit);
             const gl::Sampler::Use use(context.sampler(sampler), sampledUnit);
             context.drawFullscreen();
         }});
    graph.addOutput(samples);
    executor.run(graph);
    const Image read = gl::readPixels(executor.output(samples));
    std::vector<glm::vec4> result;
    for (int i = 0; i < count; ++i) {
        const float* const pixel = read.pixel(i % width, height - 1 - i / width);
        result.emplace_back(pixel[0], pixel[1], pixel[2], pixel[3]);
    }
    return result;
}

}  // namespace

std::vector<glm::vec4> driverSamples(gl::Executor& executor, const gl::Texture2D& texture,
                                     const gl::Sampler::Params& sampler,
                                     std::span<const TexturePoint> points) {
    return sample(executor, texture, sampler, points, {});
}

std::vector<glm::vec4> driverSamplesLod(gl::Executor& executor, const gl::Texture2D& texture,
                                        const gl::Sampler::Params& sampler,
                                        std::span<const TexturePoint> points, std::span<const float> levels) {
    QX_CHECK_EQ(points.size(), levels.size());
    return sample(executor, texture, sampler, points, levels);
}

}  // namespace quincunx

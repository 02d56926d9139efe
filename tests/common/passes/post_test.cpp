#include "passes/post.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>

#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "gl/upload.h"

namespace quincunx {
namespace {

using AddPasses = std::function<graph::Resource(graph::FrameGraph&, graph::Resource)>;

struct Effect {
    const char* name;
    AddPasses add;
    std::uint64_t draws;  ///< of one frame
};

graph::Resource targetLike(graph::FrameGraph& graph, graph::Resource picture) {
    graph::ResourceDescription description = graph.resource(picture);
    description.name = "target";
    return graph.addResource(description);
}

/// Every pass of post.h at strength zero.
std::vector<Effect> effectsOfNoStrength() {
    std::vector<Effect> effects = {
        {"film",
         [](auto& graph, auto picture) {
             return addFilmPass(graph, picture, {0, 0});
         },
         1},
        {"bloom", [](auto& graph, auto picture) { return addBloomPasses(graph, picture, {.strength = 0}); },
         4},
        {"tone map",
         [](auto& graph, auto picture) {
             const graph::Resource target = targetLike(graph, picture);
             addToneMapPass(graph, picture, target, {.curve = ToneCurve::none, .cutOff = false});
             return target;
         },
         1},
        {"fxaa",
         [](auto& graph, auto picture) {
             const graph::Resource target = targetLike(graph, picture);
             addFxaaPass(graph, picture, target, {.strength = 0});
             return target;
         },
         1}};
    const std::pair<const char*, BlurMethod> methods[] = {{"direct blur", BlurMethod::direct},
                                                          {"separable blur", BlurMethod::separable},
                                                          {"blur by pairs", BlurMethod::pairs},
                                                          {"blur of a half", BlurMethod::half},
                                                          {"blur of a quarter", BlurMethod::quarter}};
    for (const auto& [name, method] : methods)
        effects.push_back({name,
                           [method = method](auto& graph, auto picture) {
                               return addBlurPasses(graph, picture, {.method = method, .sigmaPixels = 0});
                           },
                           method == BlurMethod::direct ? 1u : 2u});
    return effects;
}

/// Any bits but those of NaN.
Image randomPicture(graph::Format format, std::mt19937_64& random) {
    Image picture(37, 23, 4, Encoding::linear);
    for (float& value : picture.data) {
        do {
            const std::uint64_t bits = random();
            value = format == graph::Format::rgba16f ? glm::unpackHalf1x16(static_cast<std::uint16_t>(bits))
                                                     : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
            // As many from the scene's range, and of those that passes stumble over.
            if (bits >> 62 == 1)
                value = static_cast<float>(bits >> 32 & 0x3ff) / 256;
            else if (bits >> 60 == 0) {
                const float hard[] = {
                    0.0f,
                    -0.0f,
                    std::numeric_limits<float>::infinity(),
                    -std::numeric_limits<float>::infinity(),
                    format == graph::Format::rgba16f ? 65504.0f : std::numeric_limits<float>::max(),
                    format == graph::Format::rgba16f ? 0x1p-24f : std::numeric_limits<float>::denorm_min(),
                    1.0f,
                    65504.0f};
                value = hard[bits >> 32 & 7];
            }
        } while (std::isnan(value));
    }
    return picture;
}

std::size_t differentBits(const Image& a, const Image& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        count += std::bit_cast<std::uint32_t>(a.data[i]) != std::bit_cast<std::uint32_t>(b.data[i]) ? 1 : 0;
    return count;
}

class PostIdentity : public testing::TestWithParam<gl::Backend> {
  protected:
    PostIdentity() : context_(gl::createOffscreenContext(GetParam())) {}

    /// How many values an effect changes, and the draws it makes.
    std::pair<std::size_t, std::uint64_t> run(const Effect& effect, graph::Format format,
                                              const Image& picture) {
        graph::FrameGraph graph;
        const graph::Resource input = graph.addResource({"input", format, picture.width, picture.height});
        graph.addPass({"fill", {}, {input}, [&](graph::PassContext& context) {
                           gl::upload(context.texture(input), 0, 0, picture);
                       }});
        const graph::Resource output = effect.add(graph, input);
        graph.addOutput(input);
        graph.addOutput(output);
        const gl::CallRecorder recorder;
        executor_.run(graph);
        const auto draws = recorder.calls().find("glDrawArrays");
        return {
            differentBits(gl::readPixels(executor_.output(input)), gl::readPixels(executor_.output(output))),
            draws == recorder.calls().end() ? 0 : draws->second};
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
};

TEST_P(PostIdentity, PassesOfNoStrengthRunAndCopyEveryBit) {
    std::mt19937_64 random(4);
    for (const graph::Format format : {graph::Format::rgba16f, graph::Format::rgba32f})
        for (int repeat = 0; repeat < 4; ++repeat) {
            const Image picture = randomPicture(format, random);
            for (const Effect& effect : effectsOfNoStrength()) {
                const auto [changed, draws] = run(effect, format, picture);
                EXPECT_EQ(changed, 0u) << effect.name << " of format " << static_cast<int>(format);
                EXPECT_EQ(draws, effect.draws) << effect.name;
            }
        }
}

TEST_P(PostIdentity, ANoneThatCutsOffCopiesWhatIsWithinItsRange) {
    Image picture(32, 32, 4, Encoding::linear);
    std::mt19937 random(7);
    for (float& value : picture.data)
        value = std::uniform_real_distribution<float>(0, 1)(random);
    const Effect none{"none",
                      [](auto& graph, auto input) {
                          const graph::Resource target = targetLike(graph, input);
                          addToneMapPass(graph, input, target, {.curve = ToneCurve::none});
                          return target;
                      },
                      1};
    EXPECT_EQ(run(none, graph::Format::rgba32f, picture).first, 0u);
    picture.pixel(3, 4)[1] = 1.5f;
    picture.pixel(5, 6)[2] = -0.5f;
    EXPECT_EQ(run(none, graph::Format::rgba32f, picture).first, 2u);
}

TEST_P(PostIdentity, PassesOfSomeStrengthDoNotCopy) {
    std::mt19937_64 random(5);
    Image picture = randomPicture(graph::Format::rgba32f, random);
    for (float& value : picture.data)
        value = std::isfinite(value) ? std::fmod(std::abs(value), 2.0f) : 1;
    const Effect effects[] = {
        {"film",
         [](auto& graph, auto input) {
             return addFilmPass(graph, input, {0.01f, 0});
         },
         1},
        {"grain",
         [](auto& graph, auto input) {
             return addFilmPass(graph, input, {0, 1});
         },
         1},
        {"blur", [](auto& graph, auto input) { return addBlurPasses(graph, input, {.sigmaPixels = 0.3f}); },
         2},
        {"bloom", [](auto& graph, auto input) { return addBloomPasses(graph, input, {.strength = 0.01f}); },
         4},
        {"fxaa",
         [](auto& graph, auto input) {
             const graph::Resource target = targetLike(graph, input);
             addFxaaPass(graph, input, target, {.strength = 0.1f});
             return target;
         },
         1}};
    for (const Effect& effect : effects)
        EXPECT_GT(run(effect, graph::Format::rgba32f, picture).first, 100u) << effect.name;
}

INSTANTIATE_TEST_SUITE_P(OnBoth, PostIdentity, testing::Values(gl::Backend::osmesa, gl::Backend::egl),
                         [](const testing::TestParamInfo<gl::Backend>& backend) {
                             return std::string(gl::backendName(backend.param));
                         });

}  // namespace
}  // namespace quincunx

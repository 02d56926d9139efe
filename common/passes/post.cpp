#include "passes/post.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "base/check.h"
#include "gl/executor.h"
#include "passes/fresh_name.h"
#include "passes/fullscreen.h"

namespace quincunx {
namespace {

constexpr int pictureUnit = 1;
constexpr int baseUnit = 2;
constexpr int maxRadius = 128;
constexpr const char* directVariant = "BLUR_DIRECT";
constexpr const char* pairsVariant = "BLUR_PAIRS";

graph::Resource addLike(graph::FrameGraph& graph, graph::Resource picture, const std::string& name) {
    graph::ResourceDescription description = graph.resource(picture);
    description.name = name;
    return graph.addResource(description);
}

/// Lets a pass read between the texels of its picture.
class Bilinear {
  public:
    explicit Bilinear(graph::PassContext& context)
        : use_(context.sampler({.minification = GL_LINEAR, .magnification = GL_LINEAR}), pictureUnit) {}

  private:
    gl::Sampler::Use use_;
};

int radiusOf(float sigma, float reach) {
    return sigma == 0 ? 0 : std::clamp(static_cast<int>(std::ceil(reach * sigma)), 1, maxRadius);
}

/// Weights of distances 0 … radius that sum to 1 over both sides.
std::vector<float> weightsOf(double sigma, int radius) {
    std::vector<double> weights = {1};
    weights.reserve(static_cast<std::size_t>(radius) + 1);
    for (int i = 1; i <= radius; ++i)
        weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    const double sum = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
    std::vector<float> result;
    result.reserve(weights.size());
    for (const double weight : weights)
        result.push_back(static_cast<float>(weight / sum));
    return result;
}

struct BlurPass {
    const char* variant = nullptr;  ///< BLUR_DIRECT, BLUR_PAIRS, or none
    glm::vec2 axis{1, 0};
    double sigma = 1;
    int radius = 3;
};

graph::Resource addBlurPass(graph::FrameGraph& graph, graph::Resource picture, const std::string& name,
                            const BlurPass& pass) {
    const graph::Resource blurred = addLike(graph, picture, name);
    graph.addPass({.name = name,
                   .reads = {picture},
                   .writes = {blurred},
                   .execute = [picture, pass](graph::PassContext& context) {
                       gl::ProgramFiles files = fullscreenProgram("blur");
                       if (pass.variant != nullptr)
                           files.defines.emplace_back(pass.variant, "");
                       const gl::Program& program = context.programs().get(files);
                       program.use();
                       program.set("picture", pictureUnit);
                       if (program.has("axis"))
                           program.set("axis", pass.axis);
                       program.set("radius", pass.radius);
                       const std::vector<float> weights = weightsOf(pass.sigma, pass.radius);
                       for (std::size_t i = 0; i < weights.size(); ++i)
                           program.set(fmt::format("weights[{}]", i), weights[i]);
                       context.texture(picture).bind(pictureUnit);
                       std::optional<Bilinear> between;
                       if (pass.variant == pairsVariant)
                           between.emplace(context);
                       context.drawFullscreen();
                   }});
    return blurred;
}

graph::Resource addSeparableBlur(graph::FrameGraph& graph, graph::Resource picture, const std::string& name,
                                 const char* variant, double sigma, int radius) {
    const graph::Resource rows =
        addBlurPass(graph, picture, name + ", rows", {variant, {1, 0}, sigma, radius});
    return addBlurPass(graph, rows, name, {variant, {0, 1}, sigma, radius});
}

/// Averages factor × factor texels (the last ones again where the sides do not divide) of what is brighter
/// than `threshold`; all of it for 0.
graph::Resource addReducePass(graph::FrameGraph& graph, graph::Resource picture, const std::string& name,
                              int factor, float threshold) {
    graph::ResourceDescription description = graph.resource(picture);
    description.name = name;
    description.width = (description.width + factor - 1) / factor;
    description.height = (description.height + factor - 1) / factor;
    const graph::Resource reduced = graph.addResource(description);
    graph.addPass({.name = name,
                   .reads = {picture},
                   .writes = {reduced},
                   .execute = [picture, factor, threshold](graph::PassContext& context) {
                       const gl::Program& program = context.programs().get(fullscreenProgram("bright"));
                       program.use();
                       program.set("picture", pictureUnit);
                       program.set("factor", factor);
                       program.set("threshold", threshold);
                       context.texture(picture).bind(pictureUnit);
                       context.drawFullscreen();
                   }});
    return reduced;
}

/// `small` over the whole of `like`'s size, times `strength`, on top of `base` if there is one.
graph::Resource addEnlargePass(graph::FrameGraph& graph, graph::Resource small, graph::Resource like,
                               const std::string& name, int factor, float strength, bool addToLike) {
    const graph::Resource large = addLike(graph, like, name);
    std::vector<graph::Resource> reads = {small};
    if (addToLike)
        reads.push_back(like);
    graph.addPass({.name = name,
                   .reads = reads,
                   .writes = {large},
                   .execute = [small, like, factor, strength, addToLike](graph::PassContext& context) {
                       gl::ProgramFiles files = fullscreenProgram("enlarge");
                       if (addToLike)
                           files.defines.emplace_back("ADD_TO_BASE", "");
                       const gl::Program& program = context.programs().get(files);
                       program.use();
                       program.set("small", pictureUnit);
                       program.set("strength", strength);
                       program.set("factor", factor);
                       context.texture(small).bind(pictureUnit);
                       if (addToLike) {
                           program.set("base", baseUnit);
                           context.texture(like).bind(baseUnit);
                       }
                       const Bilinear between(context);
                       context.drawFullscreen();
                   }});
    return large;
}

/// How many texels wide a texel of the picture that is blurred is.
int factorOf(const BlurParams& params) {
    const BlurMethod method = params.method;
    if (params.sigmaPixels == 0)
        return 1;
    return method == BlurMethod::half ? 2 : method == BlurMethod::quarter ? 4 : 1;
}

/// The deviation that the Gaussian between averaging and enlarging must have, in texels of the small picture.
double sigmaOfReduced(double sigma, int factor) {
    const double f2 = static_cast<double>(factor) * factor;
    constexpr double minVariance = 1e-4;  // of a blur that leaves every texel as it is
    return std::sqrt(std::max(sigma * sigma - f2 / 4, minVariance)) / factor;
}

}  // namespace

graph::Resource addFilmPass(graph::FrameGraph& graph, graph::Resource picture, const FilmParams& params) {
    const graph::Resource film = addLike(graph, picture, freshName(graph, "film"));
    graph.addPass({.name = graph.resource(film).name,
                   .reads = {picture},
                   .writes = {film},
                   .execute = [picture, params](graph::PassContext& context) {
                       const gl::Program& program = context.programs().get(fullscreenProgram("film"));
                       program.use();
                       program.set("picture", pictureUnit);
                       program.set("greyscale", params.greyscale);
                       program.set("octaves", params.grainOctaves);
                       context.texture(picture).bind(pictureUnit);
                       context.drawFullscreen();
                   }});
    return film;
}

graph::Resource addBlurPasses(graph::FrameGraph& graph, graph::Resource picture, const BlurParams& params,
                              const std::string& name) {
    QX_CHECK_GE(params.sigmaPixels, 0.0f);
    const double sigma = params.sigmaPixels;
    const int radius = radiusOf(params.sigmaPixels, params.reach);
    const int factor = factorOf(params);
    if (factor > 1) {
        const double reducedSigma = sigmaOfReduced(sigma, factor);
        const graph::Resource reduced = addReducePass(graph, picture, name + ", reduced", factor, 0);
        const graph::Resource blurred =
            addSeparableBlur(graph, reduced, name + ", small", nullptr, reducedSigma,
                             radiusOf(static_cast<float>(reducedSigma), params.reach));
        return addEnlargePass(graph, blurred, picture, name, factor, 1, false);
    }
    if (params.method == BlurMethod::direct)
        return addBlurPass(graph, picture, name, {directVariant, {1, 0}, sigma, radius});
    return addSeparableBlur(graph, picture, name, params.method == BlurMethod::pairs ? pairsVariant : nullptr,
                            sigma, radius);
}

std::vector<float> blurWeights(double sigmaPixels, double reach) {
    QX_CHECK_GT(sigmaPixels, 0.0);
    return weightsOf(sigmaPixels, radiusOf(static_cast<float>(sigmaPixels), static_cast<float>(reach)));
}

std::size_t fetchesAPixel(const BlurParams& params) {
    const auto radius = static_cast<std::size_t>(radiusOf(params.sigmaPixels, params.reach));
    const int factor = factorOf(params);
    if (params.method == BlurMethod::direct)
        return (2 * radius + 1) * (2 * radius + 1);
    if (params.method == BlurMethod::pairs)
        return 2 * (1 + 2 * ((radius + 1) / 2));
    if (factor == 1)
        return 2 * (2 * radius + 1);
    // Each texel of the picture is read once to be averaged; the small ones are blurred; one bilinear fetch.
    const auto small = static_cast<std::size_t>(
        radiusOf(static_cast<float>(sigmaOfReduced(params.sigmaPixels, factor)), params.reach));
    const auto area = static_cast<std::size_t>(factor * factor);
    return 2 + (2 * (2 * small + 1) + area - 1) / area;
}

graph::Resource addBloomPasses(graph::FrameGraph& graph, graph::Resource picture, const BloomParams& params) {
    constexpr int factor = 4;
    const double sigma = sigmaOfReduced(params.sigmaPixels, factor);
    const std::string name = freshName(graph, "bloom");
    const graph::Resource bright = addReducePass(graph, picture, name + ", bright", factor, params.threshold);
    const graph::Resource spread = addSeparableBlur(graph, bright, name + ", spread", nullptr, sigma,
                                                    radiusOf(static_cast<float>(sigma), 3));
    return addEnlargePass(graph, spread, picture, name, factor, params.strength, true);
}

void addToneMapPass(graph::FrameGraph& graph, graph::Resource picture, graph::Resource target,
                    const ToneMapParams& params) {
    graph.addPass({.name = "tone map",
                   .reads = {picture},
                   .writes = {target},
                   .execute = [picture, params](graph::PassContext& context) {
                       const gl::Program& program = context.programs().get(fullscreenProgram("tone_map"));
                       program.use();
                       program.set("picture", pictureUnit);
                       program.set("exposure", std::exp2(params.exposureStops));
                       program.set("curve", static_cast<int>(params.curve));
                       program.set("cutOff", params.cutOff ? 1 : 0);
                       context.texture(picture).bind(pictureUnit);
                       context.drawFullscreen();
                   }});
}

void addFxaaPass(graph::FrameGraph& graph, graph::Resource picture, graph::Resource target,
                 const FxaaParams& params) {
    graph.addPass({.name = "fxaa",
                   .reads = {picture},
                   .writes = {target},
                   .execute = [picture, params](graph::PassContext& context) {
                       const gl::Program& program = context.programs().get(fullscreenProgram("fxaa"));
                       program.use();
                       program.set("picture", pictureUnit);
                       program.set("strength", params.strength);
                       context.texture(picture).bind(pictureUnit);
                       const Bilinear between(context);
                       context.drawFullscreen();
                   }});
}

}  // namespace quincunx

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gl/objects.h"
#include "graph/graph.h"

/// Effects over a finished picture. Each adds its passes and returns what it made, of the size and format of
/// its input and in linear light; nothing is added that is not asked for. Passes of strength zero are run all
/// the same, and copy the bits of every texel: of float formats all numbers, with denormal ones, both zeros
/// and infinities. Held by PostIdentity.*.
namespace quincunx {

/// Greyscale and grain (shaders/lib/film.glsl). Copies for 0 and 0.
struct FilmParams {
    float greyscale = 1;   ///< 0 colour … 1 grey
    int grainOctaves = 0;  ///< each costs the same again
};
graph::Resource addFilmPass(graph::FrameGraph& graph, graph::Resource picture, const FilmParams& params);

enum class BlurMethod {
    direct,     ///< every texel of a square: (2r + 1)² fetches
    separable,  ///< rows, then columns: 2 (2r + 1)
    pairs,      ///< the same by bilinear fetches between two texels: 2 (r + 1)
    half,       ///< separable on a picture half as wide and high …
    quarter,    ///< … or a quarter, and enlarged
};

/// The Gaussian of standard deviation `sigmaPixels`, cut off at `reach` deviations.
struct BlurParams {
    BlurMethod method = BlurMethod::separable;
    float sigmaPixels = 4;  ///< ≥ 0; 0 copies, by as many passes
    float reach = 3;        ///< the radius r is ⌈reach σ⌉, 128 texels at most
};
/// Smaller pictures lend the blur their own: averaging f × f texels and enlarging bilinearly
/// together add the variance f²/4 (of pixels at their centres), and the Gaussian between makes up the rest; a
/// σ below 0.5 f becomes 0.5 f, but for 0, which leaves the picture at its size.
graph::Resource addBlurPasses(graph::FrameGraph& graph, graph::Resource picture, const BlurParams& params,
                              const std::string& name = "blurred");
/// The weights of texels 0 … r away, `sigmaPixels` > 0, r = ⌈reach σ⌉ within 1 … 128; over both sides they
/// sum to 1 within 2^-24.
std::vector<float> blurWeights(double sigmaPixels, double reach);
/// Texels that a pixel's value is made of, as the shaders fetch them.
std::size_t fetchesAPixel(const BlurParams& params);

/// What is brighter than `threshold` spreads a glow over its surroundings.
struct BloomParams {
    float threshold = 1;
    float strength = 0.6f;  ///< 0 copies
    float sigmaPixels = 8;
};
graph::Resource addBloomPasses(graph::FrameGraph& graph, graph::Resource picture, const BloomParams& params);

enum class ToneCurve { none, reinhard, filmic };
struct ToneMapParams {
    ToneCurve curve = ToneCurve::filmic;
    float exposureStops = 0;
    /// Keep to [0, 1]. Without it the curve `none` at exposure 0 copies; targets of eight bits cut off
    /// anyway.
    bool cutOff = true;
};
/// Into `target`.
void addToneMapPass(graph::FrameGraph& graph, graph::Resource picture, graph::Resource target,
                    const ToneMapParams& params);

struct FxaaParams {
    float strength = 1;  ///< 0 copies … 1 reaches as far across an edge as its run asks for
};
/// Smooths the steps of edges in a picture within [0, 1], into `target`.
void addFxaaPass(graph::FrameGraph& graph, graph::Resource picture, graph::Resource target,
                 const FxaaParams& params = {});

}  // namespace quincunx

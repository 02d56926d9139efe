#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"
#include "trace/path.h"

namespace quincunx {

/// A picture by path tracing: what is asked for.
struct RenderSettings {
    int width = 320;   ///< pixels
    int height = 240;  ///< pixels
    Camera camera = {};
    PathMethod method = PathMethod::mis;
    PathLimits limits = {};
    PathSampler::Kind numbers = PathSampler::Kind::sobol;
    std::uint64_t seed = 1;
    /// 0: paths; else `traceTree` with so many branches, one tree a sample.
    int branches = 0;
    /// Samples brighter than this, in any channel, count as this: less noise, and a bias. 0: none do.
    float clamp = 0;

    /// A number that is another one for other settings.
    std::uint64_t identity() const;
};

/// A picture that gets better pass by pass. The same bits for the same settings, whatever the number of
/// threads, of samples a pass, and of stops between: every sample of a pixel has numbers of its own, and a
/// pixel's samples are summed in order.
class ProgressiveRender {
  public:
    /// `scene` outlives it. A picture without pixels is a bug of the caller.
    ProgressiveRender(const PathScene& scene, const RenderSettings& settings);

    /// Adds samples to every pixel, in tiles, on all cores. When `stop` becomes true the pass is given up, as
    /// if it had not begun; false then.
    bool addSamples(int count, const std::atomic<bool>* stop = nullptr);
    /// Goes on with a pass of one sample a pixel, on all cores, until it is whole or `until` has come; a few
    /// pixels more each time, however late it is. True when the pass is whole. Pixels are taken from coarse
    /// to fine. `addSamples` and `load` drop a pass that is not whole.
    bool addSlice(std::chrono::steady_clock::time_point until);
    int samples() const { return samples_; }  ///< of every pixel so far, in whole passes

    /// Means so far, RGBA (A = 1), linear. Where a camera's ray meets nothing and there is no environment,
    /// the scene's background. In a first pass that is not whole yet, pixels without a sample are as the
    /// coarser ones beside them, or black.
    Image picture() const;
    /// The root of the mean of the pixels' squared standard errors, of RGB: what `picture` is off by, from
    /// the scatter of the samples. Infinite below two samples. Too large where the numbers are stratified,
    /// and blind to light that no sample has met yet.
    double errorEstimate() const;
    const PathCounts& counts() const { return counts_; }  ///< of whole passes

    /// What all is about, as a number: scene, settings. Renders of different ones have different ones.
    std::uint64_t identity() const;
    /// Writes all that it takes to go on, so that the file is the old one or the new one whatever happens.
    void save(const std::filesystem::path& file) const;
    /// Goes on where `save` left off. InputError for files that are damaged or of another scene or settings.
    void load(const std::filesystem::path& file);

  private:
    /// Sums of a pixel's samples, by Welford.
    struct Pixel {
        glm::dvec3 mean{0};
        double squares = 0;  ///< of all three channels
    };
    Pixel sampled(int x, int y, int count, PathCounts& counts) const;
    glm::ivec2 placeOf(std::uint32_t index) const;
    void dropSlices();

    const PathScene& scene_;
    RenderSettings settings_;
    int samples_ = 0;
    std::vector<Pixel> pixels_;
    std::vector<Pixel> next_;
    PathCounts counts_;
    std::vector<std::uint32_t> order_;  ///< of the pixels in slices, from coarse to fine; made when asked for
    std::size_t sliced_ = 0;            ///< so many of `order_` have their next sample
    PathCounts slicedCounts_;
};

/// How a long render goes.
struct RenderJob {
    int samples = 64;  ///< of every pixel, in the end
    int samplesAPass = 4;
    /// Continued if it is there, rewritten as often as said, at the end, and when interrupted; empty: none.
    std::filesystem::path checkpoint = {};
    double checkpointShare = 0.05;  ///< of the time, at most, goes into writing it
    std::string title = "path tracing";
    const std::atomic<bool>* stop = nullptr;
};

/// Renders with a bar on the terminal: time left, error so far. Returns early, with what there is, when
/// `stop` becomes true; throws Interrupted after a signal, the checkpoint written.
Image renderPaths(ProgressiveRender& render, const RenderJob& job);

}  // namespace quincunx

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "gl/executor.h"
#include "graph/graph.h"
#include "math/sample_patterns.h"
#include "passes/forward.h"
#include "scene/scene.h"

/// The accumulation buffer (Haeberli, Akeley, "The accumulation buffer: hardware support for high-quality
/// rendering", SIGGRAPH 1990): a picture as the mean of many, each drawn from another point of the lens, by
/// another point of the light, at another moment, a fraction of a pixel aside. One set of passes serves all
/// of these effects at once.
namespace quincunx {

/// Which of the effects passes are spread over.
struct AccumulatedEffects {
    bool antialiasing = false;
    bool depthOfField = false;
    bool softShadows = false;
    bool motionBlur = false;

    bool any() const { return antialiasing || depthOfField || softShadows || motionBlur; }
    bool operator==(const AccumulatedEffects&) const = default;
};

/// Where one pass looks, each number in [0, 1). The middle of everything is what a picture without any of the
/// effects shows.
struct PassSample {
    glm::dvec2 pixel{0.5};  ///< (0, 0): the pixel's lower left corner
    glm::dvec2 lens{0.5};   ///< of the square that pointOnDisc carries to the lens
    glm::dvec2 light{0.5};  ///< the same, or of the light's own square
    double time = 0.5;      ///< of the time that the shutter is open

    bool operator==(const PassSample&) const = default;
};

/// A sample a pass. What no effect spreads stays in the middle; without any effect there is one pass, however
/// many are asked for. passes ≥ 1. Held by PassSamples.*.
std::vector<PassSample> passSamples(SamplePattern pattern, int passes, const AccumulatedEffects& effects,
                                    std::uint64_t seed);

/// The view through a point of a thin lens, moved by a fraction of a pixel, in a picture of that size: points
/// in the plane of focus stay where a pinhole shows them, and a point at distance z along the view moves by
/// (1/focus − 1/z) of the lens's own size in the picture. Highlights are seen from the point on the lens.
///
/// A pinhole sees the middle, and the middle of lens and pixel gives forwardView(camera, aspect), bit for
/// bit. The matrix is computed in double and rounded once; entries beyond 2^100 are 2^100. A focus of
/// infinity moves the view in parallel; a focus of 0, at the eye, turns all but the middle of the lens away
/// from whatever is there. Negative or NaN apertures and distances of focus are a bug of the caller. Held by
/// LensViews.*.
ForwardView passView(const Camera& camera, int widthPixels, int heightPixels, const PassSample& sample);

/// `clipFromCamera` of passView for a point of the lens, in the world's unit, and an offset of the sample
/// from the pixel's middle, in normalized device coordinates.
glm::dmat4 lensClipFromCamera(const Camera& camera, float aspect, glm::dvec2 lensPoint, glm::dvec2 offsetNdc);

/// By glTranslate and glFrustum in float, as textbooks have it.
glm::mat4 lensClipFromCameraNaive(const Camera& camera, float aspect, glm::vec2 lensPoint);

/// A light with an extent, across the way it shines.
struct AreaLight {
    enum class Shape { disc, square };
    Light light;  ///< its middle
    Shape shape = Shape::disc;
    /// Of the disc, or half the square's side: in the world's unit, ≥ 0; for a directional light the tangent
    /// of the angle that it is seen under.
    float radius = 0;
};

/// One point of the light as a light; the middle, and every point of a light without extent, is the light as
/// it is. Held by AreaLights.*.
Light passLight(const AreaLight& area, const PassSample& sample);

/// The moment of a pass: `shutterSeconds` ≥ 0 are centred on `seconds`. In double, so that a thousandth of a
/// second is still many moments after a day.
double passSeconds(double seconds, double shutterSeconds, const PassSample& sample);
float passSecondsNaive(float seconds, float shutterSeconds, float sample);

/// How passes are added up.
enum class Summation {
    weighted,     ///< each divided by the number of passes, and added: what glAccum did
    runningMean,  ///< mean ← mean + (pass − mean) / n, by blending
    compensated,  ///< in 32-bit float: blocks of a few passes, whose sums are added with what rounding loses
};
enum class AccumulationBuffer { rgba8, rgba16f, rgba32f };

/// Adds up pictures, over as many frames as wanted. Nothing is allocated before the first pass, and only what
/// the summation needs. Sums in 32-bit float take up to four pictures at a time, in their order, since what a
/// sum costs is its memory's traffic; the others blend each as it comes, as what they are kept in rounds it.
///
/// `compensated` adds up blocks of `blockPasses` pictures, and adds each block to the total by Kahan's sum
/// ("Pracniques: further remarks on reducing truncation errors", CACM 8(1), 1965) with Knuth's exact TwoSum:
/// of light that is nowhere negative, the mean is within (blockPasses + 3) · 2^-24 of itself after any number
/// of passes up to 2^20 (with a division good to 1 ulp). The other two drift in 32 bits, and stand still in
/// 16 and
/// 8. Held by Accumulation.* and the lab's hard cases.
class Accumulator {
  public:
    struct Params {
        int width = 0;   ///< pixels
        int height = 0;  ///< pixels
        Summation summation = Summation::compensated;
        AccumulationBuffer buffer = AccumulationBuffer::rgba32f;  ///< `compensated` is always in rgba32f
        std::size_t passes = 1;                                   ///< in all
        std::size_t blockPasses = 16;                             ///< ≥ 1
        bool operator==(const Params&) const = default;
    };
    using Draw = std::function<void(graph::PassContext&)>;

    /// Forgets what was added. Buffers of the right size and format are kept.
    void restart(const Params& params, std::uint64_t rebuilds = 0);
    /// Calls `prepare`, if any, then `draw`, which finds a target bound whose colour and depth are undefined.
    /// Both leave blending off.
    void add(graph::PassContext& context, const Draw& prepare, const Draw& draw);
    /// Adds up the pictures that still wait for others: after the last `add`, before `show`.
    void settle(graph::PassContext& context);
    /// Writes the mean of what was added into the bound target.
    void show(graph::PassContext& context) const;
    std::size_t added() const { return added_; }
    /// Of ProgramCache::rebuilds when this was last started: pictures of different shaders do not mix.
    std::uint64_t rebuilds() const { return rebuilds_; }
    const Params& params() const { return params_; }
    /// Of all buffers on the device.
    std::size_t bytes() const;

  private:
    static constexpr std::size_t mostAtATime = 4;
    struct Target {
        std::vector<gl::Texture2D> colors;
        gl::Framebuffer framebuffer;
    };
    Target makeTarget(const char* name, GLenum format, std::size_t colors,
                      const gl::Texture2D* depth = nullptr) const;
    /// Pictures that wait until they are added.
    std::size_t atATime() const;
    bool blends() const;
    void foldBlock(graph::PassContext& context, const gl::Texture2D& block);

    Params params_;
    std::size_t added_ = 0;    ///< drawn, those that wait included
    std::size_t waiting_ = 0;  ///< pictures that the sum does not have yet
    std::uint64_t rebuilds_ = 0;
    std::size_t inBlock_ = 0;  ///< pictures that the sum has
    std::size_t folds_ = 0;
    std::size_t current_ = 0;  ///< of sums_
    gl::Texture2D depth_;      ///< of all pictures
    std::array<std::optional<Target>, mostAtATime> pictures_;
    /// weighted, runningMean: the sum; compensated: the block. Where nothing blends one is read, one written.
    std::array<std::optional<Target>, 2> sums_;
    std::array<std::optional<Target>, 2> totals_;  ///< compensated: total and carry, the same
};

struct AccumulationParams {
    Accumulator::Params accumulator = {};
    graph::Format format = graph::Format::rgba8Srgb;  ///< of the picture
    std::vector<PassSample> samples = {};             ///< as many as accumulator.passes
    /// What a pass needs before its target is bound, such as shadow maps; may be empty.
    std::function<void(graph::PassContext&, const PassSample&)> prepare = {};
    /// Draws one pass into the bound target, whose colour and depth are undefined. Called with the samples in
    /// their order, each once.
    std::function<void(graph::PassContext&, const PassSample&)> draw = {};
    /// Passes of this frame, 0: all that are left. The picture is the mean of those that there are by then.
    std::size_t passesAFrame = 0;
};

/// Adds "accumulate" and "show the mean"; returns the picture, of the accumulator's size. With `resume` what
/// was added in earlier frames counts, unless `accumulator` was for other parameters or a shader has been
/// edited since; without it everything starts anew. A single sample is drawn straight into the picture: the
/// accumulator is not touched.
graph::Resource addAccumulationPasses(graph::FrameGraph& graph, Accumulator& accumulator,
                                      const AccumulationParams& params, bool resume = false);

}  // namespace quincunx

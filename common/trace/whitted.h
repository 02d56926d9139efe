#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "image/image.h"
#include "scene/scene.h"
#include "trace/sample_patterns.h"
#include "trace/whitted_scene.h"

/// The ray tracer that looks into mirrors and through glass (Whitted, "An improved illumination model for
/// shaded display", CACM 23(6), 1980), in the four functions of the textbook; see whitted.cpp.
namespace quincunx {

/// How the tree of rays comes to an end.
enum class RecursionEnd {
    depth,    ///< at a greatest depth
    weight,   ///< where a ray's share of its pixel falls below a threshold
    roulette  ///< below the threshold by chance, what goes on weighing as much more: the mean is kept
};

struct WhittedSettings {
    RecursionEnd end = RecursionEnd::weight;
    int maxDepth = 6;              ///< for `depth`: 0 has the first rays alone
    float minWeight = 1 / 128.0f;  ///< for `weight` and `roulette`: > 0
    /// Shadow rays a light, and where on it they end: one of 64 sets of the pattern, by pixel and depth.
    int shadowRays = 16;
    SamplePattern pattern = SamplePattern::sobol;
    bool shadowCache = true;
    int pixelSamples = 1;  ///< along a side of a pixel, in a regular grid
    std::uint64_t seed = 1;
};

/// However a tree ends, no ray is traced deeper.
inline constexpr int whittedDeepest = 48;

/// What a picture took: the same on every machine, for any number of threads.
struct WhittedCounts {
    std::uint64_t traceCalls = 0;
    std::uint64_t shadeCalls = 0;
    std::uint64_t findCalls = 0;
    std::uint64_t childRays = 0;      ///< mirrored and refracted ones
    std::uint64_t endedRays = 0;      ///< children that were not traced, by whichever rule
    std::uint64_t shadowRays = 0;     ///< towards lights that the surface faces
    std::uint64_t cacheTries = 0;     ///< shadow rays that had a last blocker to try
    std::uint64_t cacheHits = 0;      ///< of these, settled by it
    std::uint64_t blockedRays = 0;    ///< shadow rays that something opaque stopped
    std::uint64_t shadowWalks = 0;    ///< walks through the structure for shadow rays
    std::uint64_t deepest = 0;        ///< the greatest depth of a call of trace
    TraversalCounts viewTraversal;    ///< for findClosestIntersection
    TraversalCounts shadowTraversal;  ///< for shadow rays

    WhittedCounts& operator+=(const WhittedCounts& other);
};

/// A picture in the making, in tiles over all cores: RGBA (A = 1), linear, the same on any number of threads
/// and in however many steps.
class WhittedRender {
  public:
    /// The scene outlives it. Where nothing is traced yet, `under`, stretched, is seen; without it, zeros.
    WhittedRender(const WhittedScene& scene, const Camera& camera, int width, int height,
                  const WhittedSettings& settings, const Image& under = {});
    ~WhittedRender();
    WhittedRender(WhittedRender&&) noexcept;
    WhittedRender& operator=(WhittedRender&&) noexcept;

    /// Starts no tile when the seconds are over, but the first. True when all are done. When `stop` becomes
    /// true, what is in the making is left as it is, and the picture is never finished.
    bool traceTiles(double seconds = std::numeric_limits<double>::infinity(),
                    const std::atomic<bool>* stop = nullptr);
    const Image& picture() const;
    WhittedCounts counts() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The textbook's main(): calls trace() for each pixel. What `stop` forestalls is left at zero.
Image renderWhitted(const WhittedScene& scene, const Camera& camera, int width, int height,
                    const WhittedSettings& settings, WhittedCounts* counts = nullptr,
                    const std::atomic<bool>* stop = nullptr);

/// The 64 sets of places on a light that pixels choose from.
std::vector<std::vector<glm::vec2>> lightSets(SamplePattern pattern, int shadowRays, std::uint64_t seed);

/// The share of a light that a point sees, by a shadow ray to each of the places; the point lies on nothing.
double visibleShare(const WhittedScene& scene, std::size_t light, glm::vec3 point,
                    std::span<const glm::vec2> places);

}  // namespace quincunx

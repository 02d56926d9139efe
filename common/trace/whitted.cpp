#include "trace/whitted.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "math/vector.h"
#include "trace/fresnel.h"
#include "trace/trace_scene.h"

namespace quincunx {
namespace {

constexpr int tileSize = 16;
constexpr std::size_t patternSets = 64;
constexpr float invPi = 0.31830989f;

/// What a ray of the tree brings along.
struct Path {
    int depth = 0;
    float weight = 1;  ///< the largest share of a channel that it has in its pixel
    /// The glass that it is in, outermost first.
    std::array<std::uint32_t, 8> media{};
    int mediaCount = 0;

    bool enter(std::uint32_t material) {
        if (mediaCount == static_cast<int>(media.size()))
            return false;
        media[static_cast<std::size_t>(mediaCount++)] = material;
        return true;
    }
    void leave(std::uint32_t material) {
        for (int i = mediaCount - 1; i >= 0; --i)
            if (media[static_cast<std::size_t>(i)] == material) {
                std::copy(media.begin() + i + 1, media.begin() + mediaCount, media.begin() + i);
                --mediaCount;
                return;
            }
    }
};

/// What a thread writes to.
struct Worker {
    Worker(std::size_t lights, std::uint64_t seed) : cache(lights, whittedDeepest + 1), sampler(0, 0, seed) {}
    CsgScratch scratch;
    ShadowCache cache;
    WhittedCounts counts;
    PathSampler sampler;
    std::uint32_t set = 0;  ///< which pattern set the pixel takes
};

class Tracer {
  public:
    Tracer(const WhittedScene& scene, const WhittedSettings& settings)
        : scene_(scene),
          settings_(settings),
          patterns_(lightSets(settings.pattern, settings.shadowRays, settings.seed)) {}

    /// The colour that comes along a ray: that of the nearest surface, or the sky's.
    glm::vec3 trace(const Ray& ray, const Path& path, Worker& worker) const {
        ++worker.counts.traceCalls;
        worker.counts.deepest = std::max(worker.counts.deepest, static_cast<std::uint64_t>(path.depth));
        const std::optional<WhittedHit> hit = findClosestIntersection(ray, worker);
        const glm::vec3 seen = hit ? shade(*hit, ray, path, worker) : scene_.sky(ray.direction);
        return hit ? absorbed(seen, path, hit->t * glm::length(glm::dvec3(ray.direction))) : seen;
    }

  private:
    std::optional<WhittedHit> findClosestIntersection(const Ray& ray, Worker& worker) const {
        ++worker.counts.findCalls;
        return scene_.nearest(ray, worker.scratch, &worker.counts.viewTraversal);
    }

    /// The colour of a surface: what the lights give it, and what `trace` says of the mirrored and of the
    /// refracted ray.
    glm::vec3 shade(const WhittedHit& hit, const Ray& ray, const Path& path, Worker& worker) const {
        ++worker.counts.shadeCalls;
        if (hit.light >= 0)
            return hit.front ? scene_.contents().lights[static_cast<std::size_t>(hit.light)].radiance
                             : glm::vec3(0);
        const WhittedMaterial& material = scene_.material(hit.material);
        const glm::dvec3 normal = hit.front ? hit.shading : -hit.shading;
        const float cosine =
            static_cast<float>(std::clamp(-glm::dot(normal, glm::dvec3(ray.direction)), 0.0, 1.0));

        glm::vec3 mirrored(0);
        glm::vec3 color(0);
        if (material.glass) {
            Path inside = path;
            ++inside.depth;
            if (!hit.front)
                inside.leave(hit.material);
            else if (!inside.enter(hit.material))
                return glm::vec3(0);
            const float eta = indexOf(inside) / indexOf(path);
            const float share = fresnelDielectric(cosine, eta);
            mirrored = glm::vec3(share);
            if (share < 1)
                if (const auto onwards = refract(ray.direction, glm::vec3(normal), eta))
                    color += follow(hit, *onwards, inside, glm::vec3(1 - share), worker);
        } else {
            if (material.mirror != glm::vec3(0))
                mirrored = material.mirror + (1.0f - material.mirror) * std::pow(1 - cosine, 5.0f);
            else if (material.ior > 1)
                mirrored = glm::vec3(fresnelDielectric(cosine, material.ior));
            if (material.diffuse != glm::vec3(0) && material.mirror == glm::vec3(0))
                color += (1.0f - mirrored) * albedo(material, hit.point) * light(hit, normal, path, worker);
        }
        if (mirrored != glm::vec3(0)) {
            Path outside = path;
            ++outside.depth;
            const glm::vec3 onwards = reflect(ray.direction, glm::vec3(normal)).value_or(-ray.direction);
            color += follow(hit, onwards, outside, mirrored, worker);
        }
        return color;
    }

    /// `share` of what comes along a child of the ray, unless the recursion ends here.
    glm::vec3 follow(const WhittedHit& hit, glm::vec3 direction, Path path, glm::vec3 share,
                     Worker& worker) const {
        path.weight *= std::max({share.x, share.y, share.z});
        const float goesOn = path.depth > whittedDeepest ? 0 : survival(path, worker);
        if (goesOn == 0) {
            ++worker.counts.endedRays;
            return glm::vec3(0);
        }
        ++worker.counts.childRays;
        path.weight *= goesOn;
        const Ray child{leaveSurface(hit.point, hit.pointError, hit.normal, direction), direction};
        return goesOn * share * trace(child, path, worker);
    }

    /// By what the colour of a child is multiplied: 0 where it is not traced, 1 where it is, and by roulette
    /// the reciprocal of the probability that it is, so that the mean stays.
    float survival(const Path& path, Worker& worker) const {
        switch (settings_.end) {
            case RecursionEnd::depth:
                return path.depth <= settings_.maxDepth ? 1.0f : 0.0f;
            case RecursionEnd::weight:
                return path.weight >= settings_.minWeight ? 1.0f : 0.0f;
            case RecursionEnd::roulette:
                break;
        }
        const float probability = std::min(1.0f, path.weight / settings_.minWeight);
        return worker.sampler.next() < probability ? 1 / probability : 0.0f;
    }

    /// Irradiance over π, from all lights and from all around.
    glm::vec3 light(const WhittedHit& hit, glm::dvec3 normal, const Path& path, Worker& worker) const {
        glm::vec3 sum = scene_.contents().ambient * static_cast<float>(0.75 + 0.25 * normal.y);
        const glm::dvec3 surface = hit.front ? hit.normal : -hit.normal;
        const std::vector<glm::vec2>& places = patterns_[(worker.set + 7u * path.depth) % patternSets];
        for (std::size_t i = 0; i < scene_.contents().lights.size(); ++i) {
            const AreaLight& from = scene_.contents().lights[i];
            const glm::vec3 facing = glm::cross(from.edgeU, from.edgeV);
            glm::vec3 arriving(0);
            for (const glm::vec2& place : places) {
                const glm::vec3 target = from.at(place);
                const glm::dvec3 way = glm::dvec3(target) - glm::dvec3(hit.point);
                const double toLight = glm::dot(normal, way);
                const double fromLight = -glm::dot(glm::dvec3(facing), way);
                // The surface itself decides what is above it, the interpolated normal how much it gets.
                if (!(glm::dot(surface, way) > 0 && toLight > 0 && fromLight > 0))
                    continue;
                const glm::vec3 origin = leaveSurface(hit.point, hit.pointError, surface, way);
                const glm::vec3 share = unshadowed({origin, target - origin}, i, path, worker);
                const double squared = glm::dot(way, way);
                arriving += share * static_cast<float>(toLight * fromLight / (squared * squared));
            }
            sum += invPi / static_cast<float>(places.size()) * arriving * from.radiance;
        }
        return sum;
    }

    /// What arrives along a ray that ends on a light at t = 1: nothing behind what is opaque.
    glm::vec3 unshadowed(const Ray& ray, std::size_t light, const Path& path, Worker& worker) const {
        constexpr RayInterval toLight{0, 1};
        ++worker.counts.shadowRays;
        Blocker& last = worker.cache.last(light, static_cast<std::size_t>(path.depth));
        if (settings_.shadowCache && last.kind != Blocker::Kind::none) {
            ++worker.counts.cacheTries;
            if (scene_.blocks(last, ray, toLight, worker.scratch)) {
                ++worker.counts.cacheHits;
                ++worker.counts.blockedRays;
                return glm::vec3(0);
            }
        }
        ++worker.counts.shadowWalks;
        last = scene_.findBlocker(ray, toLight, worker.scratch, &worker.counts.shadowTraversal);
        if (last.kind != Blocker::Kind::none) {
            ++worker.counts.blockedRays;
            return glm::vec3(0);
        }
        return scene_.throughGlass(ray, worker.scratch);
    }

    glm::vec3 absorbed(glm::vec3 color, const Path& path, double length) const {
        if (path.mediaCount == 0)
            return color;
        const std::uint32_t innermost = path.media[static_cast<std::size_t>(path.mediaCount - 1)];
        return color * glm::exp(-scene_.material(innermost).absorption * static_cast<float>(length));
    }

    float indexOf(const Path& path) const {
        return path.mediaCount == 0
                   ? 1.0f
                   : scene_.material(path.media[static_cast<std::size_t>(path.mediaCount - 1)]).ior;
    }

    static glm::vec3 albedo(const WhittedMaterial& material, glm::vec3 point) {
        if (!material.otherTile)
            return material.diffuse;
        const float x = std::floor(point.x / material.tileSize);
        const float z = std::floor(point.z / material.tileSize);
        return std::fmod(std::abs(x + z), 2.0f) == 0 ? material.diffuse : *material.otherTile;
    }

    const WhittedScene& scene_;
    const WhittedSettings& settings_;
    std::vector<std::vector<glm::vec2>> patterns_;
};

}  // namespace

WhittedCounts& WhittedCounts::operator+=(const WhittedCounts& other) {
    traceCalls += other.traceCalls;
    shadeCalls += other.shadeCalls;
    findCalls += other.findCalls;
    childRays += other.childRays;
    endedRays += other.endedRays;
    shadowRays += other.shadowRays;
    cacheTries += other.cacheTries;
    cacheHits += other.cacheHits;
    blockedRays += other.blockedRays;
    shadowWalks += other.shadowWalks;
    deepest = std::max(deepest, other.deepest);
    viewTraversal += other.viewTraversal;
    shadowTraversal += other.shadowTraversal;
    return *this;
}

struct WhittedRender::State {
    State(const WhittedScene& scene, const Camera& view, int width, int height, const WhittedSettings& with)
        : settings(with),
          camera(view),
          tracer(scene, settings),
          image(width, height, 4, Encoding::linear),
          tilesAcross((width + tileSize - 1) / tileSize),
          tileCount(tilesAcross * ((height + tileSize - 1) / tileSize)),
          workers(
              [lights = scene.contents().lights.size(), seed = with.seed] { return Worker(lights, seed); }) {}

    glm::vec3 tracePixel(int x, int y, Worker& worker) const {
        const auto side = static_cast<std::uint32_t>(settings.pixelSamples);
        const auto pixel = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(image.width) +
                           static_cast<std::uint32_t>(x);
        glm::vec3 sum(0);
        for (std::uint32_t sample = 0; sample < side * side; ++sample) {
            worker.sampler = PathSampler(pixel, sample, settings.seed);
            worker.set = static_cast<std::uint32_t>(worker.sampler.next() * static_cast<float>(patternSets));
            const glm::vec2 within(static_cast<float>(sample % side) + 0.5f,
                                   static_cast<float>(sample / side) + 0.5f);
            const Ray ray = cameraRay(camera, image.width, image.height,
                                      glm::vec2(x, y) + within / static_cast<float>(side));
            sum += tracer.trace(ray, {}, worker);
        }
        return sum / static_cast<float>(side * side);
    }

    /// False if stopped before its end.
    bool traceTile(int tile, Worker& worker, const std::atomic<bool>* stop) {
        worker.cache.clear();
        const int left = tile % tilesAcross * tileSize;
        const int top = tile / tilesAcross * tileSize;
        for (int y = top; y < std::min(top + tileSize, image.height); ++y)
            for (int x = left; x < std::min(left + tileSize, image.width); ++x) {
                if (stop != nullptr && stop->load(std::memory_order_relaxed))
                    return false;
                const glm::vec3 color = tracePixel(x, y, worker);
                float* const out = image.pixel(x, y);
                for (int c = 0; c < 3; ++c)
                    out[c] = color[c];
                out[3] = 1;
            }
        return true;
    }

    WhittedSettings settings;
    Camera camera;
    Tracer tracer;
    Image image;
    int tilesAcross;
    int tileCount;
    std::atomic<int> nextTile = 0;
    std::atomic<bool> stopped = false;
    tbb::enumerable_thread_specific<Worker> workers;
};

WhittedRender::WhittedRender(const WhittedScene& scene, const Camera& camera, int width, int height,
                             const WhittedSettings& settings, const Image& under)
    : state_(std::make_unique<State>(scene, camera, width, height, settings)) {
    if (under.data.empty())
        return;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto at = [](int i, int size, int underSize) {
                return static_cast<int>(static_cast<std::int64_t>(i) * underSize / size);
            };
            std::copy_n(under.pixel(at(x, width, under.width), at(y, height, under.height)), 4,
                        state_->image.pixel(x, y));
        }
}

WhittedRender::~WhittedRender() = default;
WhittedRender::WhittedRender(WhittedRender&&) noexcept = default;
WhittedRender& WhittedRender::operator=(WhittedRender&&) noexcept = default;

bool WhittedRender::traceTiles(double seconds, const std::atomic<bool>* stop) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    State& state = *state_;
    std::atomic<bool> over = false;
    const auto work = [&] {
        while (!over && !state.stopped && state.nextTile < state.tileCount) {
            const int tile = state.nextTile++;
            if (tile >= state.tileCount)
                break;
            if (!state.traceTile(tile, state.workers.local(), stop))
                state.stopped = true;
            if (std::chrono::duration<double>(Clock::now() - start).count() >= seconds)
                over = true;
        }
    };
    tbb::parallel_for(
        0, tbb::this_task_arena::max_concurrency(), [&](int) { work(); }, tbb::simple_partitioner());
    return !state.stopped && state.nextTile >= state.tileCount;
}

const Image& WhittedRender::picture() const {
    return state_->image;
}

WhittedCounts WhittedRender::counts() const {
    WhittedCounts counts;
    for (const Worker& worker : state_->workers)
        counts += worker.counts;
    return counts;
}

Image renderWhitted(const WhittedScene& scene, const Camera& camera, int width, int height,
                    const WhittedSettings& settings, WhittedCounts* counts, const std::atomic<bool>* stop) {
    WhittedRender render(scene, camera, width, height, settings);
    render.traceTiles(std::numeric_limits<double>::infinity(), stop);
    if (counts != nullptr)
        *counts = render.counts();
    return render.picture();
}

std::vector<std::vector<glm::vec2>> lightSets(SamplePattern pattern, int shadowRays, std::uint64_t seed) {
    std::vector<std::vector<glm::vec2>> sets;
    for (std::size_t i = 0; i < patternSets; ++i)
        sets.push_back(samplePattern(pattern, static_cast<std::size_t>(shadowRays), seed * patternSets + i));
    return sets;
}

double visibleShare(const WhittedScene& scene, std::size_t light, glm::vec3 point,
                    std::span<const glm::vec2> places) {
    CsgScratch scratch;
    const AreaLight& from = scene.contents().lights[light];
    std::size_t reached = 0;
    for (const glm::vec2& place : places)
        reached += scene.findBlocker({point, from.at(place) - point}, {0, 1}, scratch, nullptr).kind ==
                   Blocker::Kind::none;
    return static_cast<double>(reached) / static_cast<double>(places.size());
}

}  // namespace quincunx

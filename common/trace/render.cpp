#include "trace/render.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "scene/fingerprint.h"

namespace quincunx {
namespace {

constexpr int tileSide = 16;

/// A checkpoint's head; the pixels follow, then a sum over all of it.
struct Head {
    char magic[8] = {'Q', 'X', 'P', 'A', 'T', 'H', '0', '1'};
    std::uint64_t identity = 0;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::int32_t samples = 0;
    std::int32_t padding = 0;
};
static_assert(sizeof(Head) == 32);

/// Fowler, Noll and Vo's hash over words of eight bytes: tells damage, not intent.
class Hash {
  public:
    void add(const void* data, std::size_t bytes) {
        const auto* const from = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < bytes; i += 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, from + i, std::min<std::size_t>(8, bytes - i));
            value_ = (value_ ^ word) * 0x100000001b3u;
            value_ ^= value_ >> 29;
        }
    }
    template <typename T>
    void addValue(const T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        add(&value, sizeof value);
    }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

void addScene(Hash& hash, const PathScene& paths) {
    const TraceScene& scene = paths.scene();
    hash.addValue(paths.model());
    hash.addValue(fingerprint(scene.scene()));
    for (const TracedSolid& solid : scene.solids()) {
        hash.addValue(solid.shape.index());
        hash.addValue(solid.material);
        hash.add(&solid.worldFromModel, sizeof solid.worldFromModel);
        const Solid exact(solid.shape);
        for (const Solid::Part& part : exact.parts()) {
            hash.addValue(part.piece.radius);
            hash.add(&part.min, sizeof part.min);
            hash.add(&part.max, sizeof part.max);
        }
    }
    const Scene& background = scene.scene();
    hash.add(&background.backgroundTop, sizeof background.backgroundTop);
    hash.add(&background.backgroundBottom, sizeof background.backgroundBottom);
}

/// Pixels that lie apart by this are the first that slices take; then those halfway between, and so on.
constexpr int coarsestStep = 16;
/// So many pixels are taken between two looks at the clock.
constexpr std::size_t pixelsALook = 16;

/// The coarsest lattice that a pixel belongs to.
int stepOf(int x, int y) {
    int step = coarsestStep;
    while (((x | y) & (step - 1)) != 0)
        step /= 2;
    return step;
}

}  // namespace

std::uint64_t RenderSettings::identity() const {
    Hash hash;
    hash.add(&camera.worldFromCamera, sizeof camera.worldFromCamera);
    for (const float value : {camera.fovYRadians, camera.apertureRadius, camera.focusDistance,
                              limits.rouletteThreshold, limits.cutoff, clamp})
        hash.addValue(value);
    for (const int value : {width, height, limits.maxBounces, branches})
        hash.addValue(value);
    hash.addValue(method);
    hash.addValue(numbers);
    hash.addValue(seed);
    return hash.value();
}

ProgressiveRender::ProgressiveRender(const PathScene& scene, const RenderSettings& settings)
    : scene_(scene), settings_(settings) {
    QX_CHECK_GT(settings.width, 0);
    QX_CHECK_GT(settings.height, 0);
    QX_CHECK_GE(settings.limits.maxBounces, 0);
    pixels_.resize(static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height));
    next_ = pixels_;
}

std::uint64_t ProgressiveRender::identity() const {
    Hash hash;
    addScene(hash, scene_);
    hash.addValue(settings_.identity());
    return hash.value();
}

ProgressiveRender::Pixel ProgressiveRender::sampled(int x, int y, int count, PathCounts& counts) const {
    const auto index =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(settings_.width) + static_cast<std::size_t>(x);
    const Scene& scene = scene_.scene().scene();
    Pixel pixel = pixels_[index];
    for (int i = samples_; i < samples_ + count; ++i) {
        PathSampler sampler(static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(i), settings_.seed,
                            settings_.numbers);
        const glm::vec2 place = glm::vec2(x, y) + sampler.next2();
        const glm::vec2 lens = sampler.next2();
        const Ray ray = cameraRay(settings_.camera, settings_.width, settings_.height, place,
                                  settings_.camera.apertureRadius > 0 ? sampleDisk(lens) : glm::vec2(0));
        glm::vec3 light = settings_.branches > 0
                              ? traceTree(scene_, ray, sampler, settings_.branches, settings_.limits, &counts)
                              : tracePath(settings_.method, scene_, ray, sampler, settings_.limits, &counts);
        if (!scene.environment && light == glm::vec3(0) && !scene_.scene().occluded(ray))
            light = glm::mix(scene.backgroundTop, scene.backgroundBottom,
                             place.y / static_cast<float>(settings_.height));
        if (settings_.clamp > 0)
            light = glm::min(light, glm::vec3(settings_.clamp));
        const glm::dvec3 off = glm::dvec3(light) - pixel.mean;
        pixel.mean += off / static_cast<double>(i + 1);
        pixel.squares += glm::dot(off, glm::dvec3(light) - pixel.mean);
    }
    return pixel;
}

bool ProgressiveRender::addSamples(int count, const std::atomic<bool>* stop) {
    QX_CHECK_GE(count, 0);
    QX_CHECK_LE(count, std::numeric_limits<int>::max() - samples_);
    dropSlices();
    const auto stopped = [stop] { return stop != nullptr && stop->load(std::memory_order_relaxed); };
    std::mutex mutex;
    PathCounts total = counts_;
    tbb::parallel_for(
        tbb::blocked_range2d<int>(0, settings_.height, tileSide, 0, settings_.width, tileSide),
        [&](const tbb::blocked_range2d<int>& tile) {
            PathCounts counts;
            for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
                if (stopped())
                    return;
                for (int x = tile.cols().begin(); x < tile.cols().end(); ++x)
                    next_[static_cast<std::size_t>(y) * static_cast<std::size_t>(settings_.width) +
                          static_cast<std::size_t>(x)] = sampled(x, y, count, counts);
            }
            const std::lock_guard lock(mutex);
            total += counts;
        });
    if (stopped())
        return false;
    pixels_.swap(next_);
    counts_ = total;
    samples_ += count;
    return true;
}

glm::ivec2 ProgressiveRender::placeOf(std::uint32_t index) const {
    const auto width = static_cast<std::uint32_t>(settings_.width);
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
}

void ProgressiveRender::dropSlices() {
    sliced_ = 0;
    slicedCounts_ = {};
}

bool ProgressiveRender::addSlice(std::chrono::steady_clock::time_point until) {
    QX_CHECK_LT(samples_, std::numeric_limits<int>::max());
    if (order_.empty())
        for (int step = coarsestStep; step > 0; step /= 2)
            for (int y = 0; y < settings_.height; y += step)
                for (int x = 0; x < settings_.width; x += step)
                    if (stepOf(x, y) == step)
                        order_.push_back(static_cast<std::uint32_t>(y * settings_.width + x));
    std::atomic<std::size_t> next = sliced_;
    std::mutex mutex;
    const int workers = tbb::this_task_arena::max_concurrency();
    tbb::parallel_for(
        0, workers,
        [&](int) {
            PathCounts counts;
            do {
                const std::size_t begin = next.fetch_add(pixelsALook);
                const std::size_t end = std::min(begin + pixelsALook, order_.size());
                for (std::size_t i = begin; i < end; ++i) {
                    const glm::ivec2 place = placeOf(order_[i]);
                    next_[order_[i]] = sampled(place.x, place.y, 1, counts);
                }
            } while (next < order_.size() && std::chrono::steady_clock::now() < until);
            const std::lock_guard lock(mutex);
            slicedCounts_ += counts;
        },
        tbb::simple_partitioner());
    sliced_ = std::min(next.load(), order_.size());
    if (sliced_ < order_.size())
        return false;
    pixels_.swap(next_);
    counts_ += slicedCounts_;
    ++samples_;
    dropSlices();
    return true;
}

Image ProgressiveRender::picture() const {
    Image image(settings_.width, settings_.height, 4, Encoding::linear);
    const auto show = [&](std::size_t i, const Pixel& pixel) {
        for (int c = 0; c < 3; ++c)
            image.data[4 * i + static_cast<std::size_t>(c)] = static_cast<float>(pixel.mean[c]);
        image.data[4 * i + 3] = 1;
    };
    for (std::size_t i = 0; i < pixels_.size(); ++i)
        show(i, pixels_[i]);
    for (std::size_t k = 0; k < sliced_; ++k)
        show(order_[k], next_[order_[k]]);
    if (samples_ > 0 || sliced_ == 0)
        return image;
    for (std::size_t k = sliced_; k < order_.size(); ++k) {
        const glm::ivec2 place = placeOf(order_[k]);
        // The next coarser lattice's, which comes earlier in the order.
        const int step = 2 * stepOf(place.x, place.y);
        if (step <= coarsestStep) {
            const float* const coarse = image.pixel(place.x & -step, place.y & -step);
            std::copy(coarse, coarse + 4, image.pixel(place.x, place.y));
        }
    }
    return image;
}

double ProgressiveRender::errorEstimate() const {
    if (samples_ < 2)
        return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (const Pixel& pixel : pixels_)
        sum += pixel.squares;
    return std::sqrt(sum / (3.0 * samples_ * (samples_ - 1.0) * static_cast<double>(pixels_.size())));
}

void ProgressiveRender::save(const std::filesystem::path& file) const {
    Head head;
    head.identity = identity();
    head.width = settings_.width;
    head.height = settings_.height;
    head.samples = samples_;
    std::string contents(sizeof head + pixels_.size() * sizeof(Pixel) + sizeof(std::uint64_t), '\0');
    std::memcpy(contents.data(), &head, sizeof head);
    std::memcpy(contents.data() + sizeof head, pixels_.data(), pixels_.size() * sizeof(Pixel));
    Hash hash;
    hash.add(contents.data(), contents.size() - sizeof(std::uint64_t));
    const std::uint64_t sum = hash.value();
    std::memcpy(contents.data() + contents.size() - sizeof sum, &sum, sizeof sum);
    writeFile(file, contents);
}

void ProgressiveRender::load(const std::filesystem::path& file) {
    const std::size_t size = sizeof(Head) + pixels_.size() * sizeof(Pixel) + sizeof(std::uint64_t);
    const std::string where = printable(file.string());
    const std::string remedy = "remove it, or name another file";
    const std::string contents = readFile(file, std::max<std::uintmax_t>(size, 1 << 20));
    Head head;
    const Head ours;
    if (contents.size() < sizeof head)
        throw InputError("not a checkpoint", where, remedy);
    std::memcpy(&head, contents.data(), sizeof head);
    if (std::memcmp(head.magic, ours.magic, sizeof ours.magic) != 0)
        throw InputError("not a checkpoint", where, remedy);
    if (head.identity != identity() || head.width != settings_.width || head.height != settings_.height)
        throw InputError("the checkpoint of another picture", where, remedy);
    Hash hash;
    std::uint64_t sum = 0;
    if (contents.size() == size) {
        hash.add(contents.data(), size - sizeof sum);
        std::memcpy(&sum, contents.data() + size - sizeof sum, sizeof sum);
    }
    if (contents.size() != size || sum != hash.value() || head.samples < 0)
        throw InputError("a damaged checkpoint", where, remedy);
    std::memcpy(static_cast<void*>(pixels_.data()), contents.data() + sizeof head,
                pixels_.size() * sizeof(Pixel));
    samples_ = head.samples;
    counts_ = {};
    dropSlices();
}

Image renderPaths(ProgressiveRender& render, const RenderJob& job) {
    QX_CHECK_GT(job.samplesAPass, 0);
    const bool kept = !job.checkpoint.empty();
    if (kept && std::filesystem::exists(job.checkpoint))
        render.load(job.checkpoint);
    if (render.samples() >= job.samples)
        return render.picture();
    using Clock = std::chrono::steady_clock;
    const int first = render.samples();
    Progress progress(job.title, static_cast<std::size_t>(job.samples - first));
    Clock::time_point nextSave = Clock::now();
    try {
        while (render.samples() < job.samples) {
            if (!render.addSamples(std::min(job.samplesAPass, job.samples - render.samples()), job.stop))
                throwIfInterrupted();
            if (job.stop != nullptr && *job.stop)
                break;
            progress.note(fmt::format("error {:.2g}", render.errorEstimate()));
            progress.update(static_cast<std::size_t>(render.samples() - first));
            if (kept && Clock::now() >= nextSave) {
                const Clock::time_point start = Clock::now();
                render.save(job.checkpoint);
                const std::chrono::duration<double> pause = (Clock::now() - start) / job.checkpointShare;
                nextSave = Clock::now() + std::chrono::duration_cast<Clock::duration>(pause);
            }
        }
    } catch (const Interrupted&) {
        if (kept)
            render.save(job.checkpoint);
        throw;
    }
    if (kept)
        render.save(job.checkpoint);
    return render.picture();
}

}  // namespace quincunx

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

std::uint64_t identityOf(const TraceScene& scene, const RenderSettings& settings) {
    Hash hash;
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
    if (scene.scene().environment) {
        const Environment& environment = *scene.scene().environment;
        hash.add(environment.panorama.data.data(), environment.panorama.data.size() * sizeof(float));
        hash.add(&environment.tint, sizeof environment.tint);
    }
    const Scene& background = scene.scene();
    hash.add(&background.backgroundTop, sizeof background.backgroundTop);
    hash.add(&background.backgroundBottom, sizeof background.backgroundBottom);
    const Camera& camera = settings.camera;
    hash.add(&camera.worldFromCamera, sizeof camera.worldFromCamera);
    for (const float value : {camera.fovYRadians, camera.apertureRadius, camera.focusDistance,
                              settings.limits.rouletteThreshold, settings.limits.cutoff, settings.clamp})
        hash.addValue(value);
    for (const int value : {settings.width, settings.height, settings.limits.maxBounces, settings.branches})
        hash.addValue(value);
    hash.addValue(settings.method);
    hash.addValue(settings.numbers);
    hash.addValue(settings.seed);
    return hash.value();
}

}  // namespace

ProgressiveRender::ProgressiveRender(const PathScene& scene, const RenderSettings& settings)
    : scene_(scene), settings_(settings), identity_(identityOf(scene.scene(), settings)) {
    QX_CHECK_GT(settings.width, 0);
    QX_CHECK_GT(settings.height, 0);
    QX_CHECK_GE(settings.limits.maxBounces, 0);
    pixels_.resize(static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height));
    next_ = pixels_;
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

Image ProgressiveRender::picture() const {
    Image image(settings_.width, settings_.height, 4, Encoding::linear);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            image.data[4 * i + static_cast<std::size_t>(c)] = static_cast<float>(pixels_[i].mean[c]);
        image.data[4 * i + 3] = 1;
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
    head.identity = identity_;
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
    if (head.identity != identity_ || head.width != settings_.width || head.height != settings_.height)
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
}

Image renderPaths(ProgressiveRender& render, const RenderJob& job) {
    QX_CHECK_GT(job.samplesAPass, 0);
    const bool kept = !job.checkpoint.empty();
    if (kept && std::filesystem::exists(job.checkpoint))
        render.load(job.checkpoint);
    if (render.samples() >= job.samples)
        return render.picture();
    const int first = render.samples();
    Progress progress(job.title, static_cast<std::size_t>(job.samples - first));
    auto saved = std::chrono::steady_clock::now();
    try {
        while (render.samples() < job.samples) {
            if (!render.addSamples(std::min(job.samplesAPass, job.samples - render.samples()), job.stop))
                return render.picture();
            progress.note(fmt::format("error {:.2g}", render.errorEstimate()));
            progress.update(static_cast<std::size_t>(render.samples() - first));
            const auto now = std::chrono::steady_clock::now();
            if (kept && std::chrono::duration<double>(now - saved).count() >= job.secondsBetweenCheckpoints) {
                render.save(job.checkpoint);
                saved = now;
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

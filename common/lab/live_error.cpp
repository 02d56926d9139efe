#include "lab/live_error.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "image/compare.h"

namespace quincunx {
namespace {

/// Black over red and yellow to white, each a third of the way.
Image8 mapOf(const Image& reference, const Image& picture) {
    constexpr float whiteAt = 0.25f;
    Image8 map(picture.width, picture.height, 4, Encoding::linear);
    for (std::size_t i = 0; i < picture.pixelCount(); ++i) {
        float squares = 0;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float difference = reference.data[4 * i + channel] - picture.data[4 * i + channel];
            squares += difference * difference;
        }
        const float heat = 3 * std::sqrt(squares / 3) / whiteAt;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float part = std::clamp(heat - static_cast<float>(channel), 0.0f, 1.0f);
            map.data[4 * i + channel] = static_cast<std::uint8_t>(std::lround(255 * part));
        }
        map.data[4 * i + 3] = 255;
    }
    return map;
}

LiveError::Result compare(const Lab::ReferenceJob& job, const Image& picture, const std::atomic<bool>& stop) {
    LiveError::Result result;
    try {
        const Image reference = job(stop);
        if (stop)
            return result;
        if (reference.width != picture.width || reference.height != picture.height ||
            reference.channels != 4 || picture.channels != 4) {
            result.failure = "the reference has another size than the picture";
            return result;
        }
        result.rmse = rmse(reference, picture);
        result.map = mapOf(reference, picture);
    } catch (const std::exception& e) {
        result.failure = e.what();
    }
    return result;
}

}  // namespace

LiveError::LiveError(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { work(); }) {}

LiveError::~LiveError() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        waiting_.reset();
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void LiveError::start(Lab::ReferenceJob job, Image picture) {
    {
        const std::lock_guard lock(mutex_);
        waiting_ = Work{std::move(job), std::move(picture)};
        result_.reset();
        stop_ = true;
    }
    changed_.notify_all();
}

void LiveError::cancel() {
    const std::lock_guard lock(mutex_);
    waiting_.reset();
    result_.reset();
    stop_ = true;
}

std::optional<LiveError::Result> LiveError::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

void LiveError::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || waiting_.has_value(); });
        if (ending_)
            return;
        const Work work = *std::exchange(waiting_, std::nullopt);
        running_ = true;
        stop_ = false;
        lock.unlock();
        Result result = compare(work.job, work.picture, stop_);
        lock.lock();
        running_ = false;
        if (stop_)
            continue;
        result_ = std::move(result);
        lock.unlock();
        wake_();
        lock.lock();
    }
}

}  // namespace quincunx

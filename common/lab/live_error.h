#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "image/image.h"
#include "lab/lab.h"

namespace quincunx {

/// Compares pictures with their references on a thread of its own. One comparison at a time: a new one
/// cancels the one before.
class LiveError {
  public:
    struct Result {
        double rmse = 0;      ///< of linear light
        Image8 map;           ///< root of the mean squared difference of a pixel's channels, white ≥ 0.25
        std::string failure;  ///< why there is none; empty: there is one
    };

    /// `wake` is called from the thread when a result is there.
    explicit LiveError(std::function<void()> wake);
    /// Cancels what is under way and waits until it has given up.
    ~LiveError();
    LiveError(const LiveError&) = delete;
    LiveError& operator=(const LiveError&) = delete;

    /// Compares `picture` (linear light, RGBA) with what `job` makes.
    void start(Lab::ReferenceJob job, Image picture);
    void cancel();
    /// The result of the last `start`, once.
    std::optional<Result> take();

  private:
    struct Work {
        Lab::ReferenceJob job;
        Image picture;
    };
    void work();

    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Work> waiting_;
    std::optional<Result> result_;
    bool running_ = false;
    bool ending_ = false;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace quincunx

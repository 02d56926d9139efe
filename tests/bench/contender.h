#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gl/context.h"
#include "scene/still_life.h"
#include "tests/bench/engine_shading.h"

namespace quincunx {

inline double cpuSeconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

inline double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

/// A renderer of the still life in a context of its own, with the checks of its calls or without.
template <typename Renderer>
class Contender {
  public:
    Contender(int width, int height, bool watched)
        : watched_(watched), context_(gl::createOffscreenContext(gl::Backend::automatic)) {
        enter();
        renderer_ = std::make_unique<Renderer>(width, height);
    }
    ~Contender() {
        context_->makeCurrent();
        renderer_.reset();
    }
    /// Must precede frames when another contender has drawn.
    void enter() {
        context_->makeCurrent();
        if (watched_)
            return;
        if (GLAD_GL_KHR_debug != 0)
            glDisable(GL_DEBUG_OUTPUT);
        gladUninstallGLDebug();
    }
    void frame() {
        renderer_->draw(walking(camera_, frameNumber_++ % 1000));
        glFinish();
    }
    std::map<std::string, std::uint64_t> calls() {
        enter();
        frame();
        gladInstallGLDebug();
        const auto calls = callsOf([&] { renderer_->draw(walking(camera_, frameNumber_)); });
        enter();
        return calls;
    }
    /// Seconds of CPU a frame: of the whole process, and of the thread that calls.
    std::pair<double, double> batch(int frames) {
        enter();
        frame();
        const double process = cpuSeconds(CLOCK_PROCESS_CPUTIME_ID);
        const double thread = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
        for (int i = 0; i < frames; ++i)
            frame();
        return {(cpuSeconds(CLOCK_PROCESS_CPUTIME_ID) - process) / frames,
                (cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - thread) / frames};
    }

  private:
    bool watched_;
    int frameNumber_ = 0;
    Camera camera_ = makeStillLife().camera;
    std::unique_ptr<gl::Context> context_;
    std::unique_ptr<Renderer> renderer_;
};

}  // namespace quincunx

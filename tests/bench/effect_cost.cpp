// What `plan` says that each effect of a frame takes, beside what switching the effect on takes: the same
// frame with it and without it by the lab's own knob, on a device of its own, in turn.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/check.h"
#include "base/timing.h"
#include "lab/studio.h"
#include "lab/verbs.h"
#include "labs/30_full_frame/lab.h"

namespace {

using namespace quincunx;

constexpr int width = 160;
constexpr int height = 120;
constexpr int frames = 15;

/// What a call prints.
template <typename Call>
std::string printed(const Call& call) {
    std::fflush(stdout);
    std::FILE* const file = std::tmpfile();
    QX_CHECK(file != nullptr);
    const int before = dup(STDOUT_FILENO);
    dup2(fileno(file), STDOUT_FILENO);
    call();
    std::fflush(stdout);
    dup2(before, STDOUT_FILENO);
    close(before);
    std::rewind(file);
    std::string text;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file))
        text += static_cast<char>(c);
    std::fclose(file);
    return text;
}

/// Seconds that a frame takes more with the effect than without.
double switchedSeconds(std::string effect) {
    std::replace(effect.begin(), effect.end(), ' ', '-');
    Studio studio(gl::Backend::automatic);
    FullFrameLab with;
    FullFrameLab without;
    without.without.parse(effect);
    const Frame frame = studio.frame(with, width, height);
    std::vector<double> added;
    for (int i = 0; i < frames; ++i) {
        const double more = studio.time(with, frame, 1, 1).medianSeconds;
        added.push_back(more - studio.time(without, frame, 1, 1).medianSeconds);
    }
    return timingOf(std::move(added)).medianSeconds;
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    FullFrameLab lab;
    PlanOptions options;
    options.draw.width = width;
    options.draw.height = height;
    options.draw.json = true;
    options.frames = frames;
    const auto reply = nlohmann::json::parse(printed([&] {
        plan(lab, LabEntry{30, "full_frame", nullptr}, options);
    }));
    for (const auto& effect : reply["effects"]) {
        if (effect["called_for"] == false)
            continue;
        const double planned = effect["milliseconds"];
        const double switched = 1e3 * switchedSeconds(effect["name"]);
        std::printf("ratio planned / switched on, %s: %.3f (%.3f ms / %.3f ms of %.1f ms)\n",
                    effect["name"].get<std::string>().c_str(), planned / switched, planned, switched,
                    reply["milliseconds"].get<double>());
        std::fflush(stdout);
    }
    return 0;
}

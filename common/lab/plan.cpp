#include "lab/plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "lab/json.h"
#include "lab/studio.h"
#include "lab/verbs.h"
#include "scene/import.h"

namespace quincunx {
namespace {

/// What a frame costs without some effects.
struct Measured {
    std::vector<std::string> leftOut = {};
    std::vector<double> seconds = {};  ///< frame by frame, in turn with those of the other variants
    std::uint64_t glCalls = 0;
    std::size_t targetBytes = 0;

    double median() const { return timingOf(seconds).medianSeconds; }
};

/// Which of the frames are compared: what the odd ones say is independent of what the even ones say.
enum class Frames { all, even, odd };

/// The median of what `with` took more than `without`, each pair of frames measured right after one another.
double addedSeconds(const Measured& with, const Measured& without, Frames frames = Frames::all) {
    std::vector<double> added;
    for (std::size_t i = frames == Frames::odd ? 1 : 0; i < with.seconds.size();
         i += frames == Frames::all ? 1 : 2)
        added.push_back(with.seconds[i] - without.seconds[i]);
    return added.empty() ? 0 : timingOf(std::move(added)).medianSeconds;
}

/// Leaves nothing out again at its end.
class LeavingOut {
  public:
    explicit LeavingOut(Lab& lab) : lab_(lab) {}
    ~LeavingOut() { lab_.leaveOut({}); }
    LeavingOut(const LeavingOut&) = delete;
    LeavingOut& operator=(const LeavingOut&) = delete;

  private:
    Lab& lab_;
};

/// Variants in turn, frame by frame, so that what slows the machine down for a while slows all of them. Each
/// is drawn once before it is timed, since it finds the device as the variant before it left it.
void measure(Lab& lab, Studio& studio, const Frame& frame, std::vector<Measured>& variants, int frames) {
    constexpr double patienceSeconds = 8;
    constexpr int mostFrames = 60;
    const LeavingOut restored(lab);
    double once = 0;
    for (Measured& variant : variants) {
        lab.leaveOut(variant.leftOut);
        const Studio::FrameCost cost = studio.cost(lab, frame, 1);
        variant.glCalls = cost.glCalls;
        variant.targetBytes = cost.targetBytes;
        once += studio.time(lab, frame, 1, 0).medianSeconds;
    }
    if (frames == 0)
        frames = std::clamp(static_cast<int>(patienceSeconds / (2 * once)), 2, mostFrames);
    Progress progress("plan", static_cast<std::size_t>(frames));
    for (int i = 0; i < frames; ++i) {
        for (Measured& variant : variants) {
            lab.leaveOut(variant.leftOut);
            variant.seconds.push_back(studio.time(lab, frame, 1, 1).medianSeconds);
        }
        progress.update(static_cast<std::size_t>(i) + 1);
    }
}

std::vector<std::string> without(std::vector<std::string> names, const std::string& name) {
    std::erase(names, name);
    return names;
}

std::string bytesText(double bytes) {
    return bytes < 1e4   ? fmt::format("{:.0f} B", bytes)
           : bytes < 1e7 ? fmt::format("{:.0f} kB", bytes / 1e3)
                         : fmt::format("{:.1f} MB", bytes / 1e6);
}

}  // namespace

FramePlan planFrame(Lab& lab, const LabEntry& entry, const std::string& scene, Studio& studio,
                    const Frame& frame, int frames) {
    constexpr int repeats = 7;
    const Studio::FrameCost cost = studio.cost(lab, frame, repeats);
    const std::vector<EffectReport> effects = lab.effects();
    std::vector<std::string> calledFor;
    for (const EffectReport& effect : effects)
        if (effect.calledFor)
            calledFor.push_back(effect.name);

    // The frame; without each of its effects; without any; and with each alone.
    std::vector<Measured> variants(1);
    for (const std::string& effect : calledFor)
        variants.push_back({.leftOut = {effect}});
    if (!calledFor.empty())
        variants.push_back({.leftOut = calledFor});
    for (const std::string& effect : calledFor)
        variants.push_back({.leftOut = without(calledFor, effect)});
    measure(lab, studio, frame, variants, frames);
    const std::size_t count = calledFor.size();
    const auto costOf = [&](std::size_t i) {
        const Measured& full = variants[0];
        const Measured& less = variants[1 + i];
        return EffectCost{
            static_cast<std::int64_t>(full.glCalls) - static_cast<std::int64_t>(less.glCalls),
            static_cast<std::int64_t>(full.targetBytes) - static_cast<std::int64_t>(less.targetBytes),
            addedSeconds(full, less),
            addedSeconds(full, less, Frames::even),
            addedSeconds(full, less, Frames::odd),
            addedSeconds(variants[2 + count + i], variants[1 + count])};
    };

    FramePlan plan{
        scene,       entry.folder(), studio.context().renderer(), frame.width,     frame.height, {},
        cost.passes, cost.glCalls,   variants[0].median(),        cost.targetBytes};
    std::size_t next = 0;
    for (const EffectReport& effect : effects)
        plan.effects.push_back({effect, effect.calledFor ? costOf(next++) : EffectCost{}});
    return plan;
}

std::string toText(const FramePlan& plan) {
    std::string text = fmt::format("{} at {}x{}: {:.2f} ms, {} GL calls, {} of targets\n\n", plan.scene,
                                   plan.width, plan.height, plan.seconds * 1e3, plan.glCalls,
                                   bytesText(static_cast<double>(plan.memoryBytes)));
    std::string in;
    std::string out;
    for (const auto& [effect, own] : plan.effects)
        if (effect.calledFor)
            in += fmt::format("  {:<22} {:>8.2f} ms ± {:<5.2f} {:>8.2f} ms alone {:>5} calls {:>9}  {}\n",
                              effect.name, own.seconds * 1e3,
                              0.5e3 * std::abs(own.firstSeconds - own.secondSeconds), own.aloneSeconds * 1e3,
                              own.glCalls, bytesText(static_cast<double>(own.bytes)), effect.reason);
        else
            out += fmt::format("  {:<22} {}\n", effect.name, effect.reason);
    if (!in.empty())
        text += "effects in, and what switching each on adds\n" + in + "\n";
    if (!out.empty())
        text += "effects out\n" + out + "\n";
    text += "passes, each waited for\n";
    for (const gl::Executor::PassCost& pass : plan.passes)
        text +=
            fmt::format("  {:<34} {:>8.2f} ms {:>6} calls\n", pass.pass, pass.seconds * 1e3, pass.glCalls);
    return text;
}

Json toJson(const FramePlan& plan) {
    Json effects = Json::array();
    for (const auto& [effect, own] : plan.effects)
        effects.push_back({{"name", effect.name},
                           {"called_for", effect.calledFor},
                           {"reason", effect.reason},
                           {"passes", effect.passes},
                           {"gl_calls", own.glCalls},
                           {"milliseconds", own.seconds * 1e3},
                           {"milliseconds_even_frames", own.firstSeconds * 1e3},
                           {"milliseconds_odd_frames", own.secondSeconds * 1e3},
                           {"alone_milliseconds", own.aloneSeconds * 1e3},
                           {"memory_bytes", own.bytes}});
    Json passes = Json::array();
    for (const gl::Executor::PassCost& pass : plan.passes)
        passes.push_back(
            {{"name", pass.pass}, {"gl_calls", pass.glCalls}, {"milliseconds", pass.seconds * 1e3}});
    return {{"scene", plan.scene},
            {"lab", plan.lab},
            {"renderer", plan.renderer},
            {"width", plan.width},
            {"height", plan.height},
            {"effects", effects},
            {"passes", passes},
            {"gl_calls", plan.glCalls},
            {"milliseconds", plan.seconds * 1e3},
            {"memory_bytes", plan.memoryBytes}};
}

void plan(Lab& lab, const LabEntry& entry, const PlanOptions& options) {
    const DrawOptions& draw = options.draw;
    std::string scene = entry.folder();
    if (!draw.model.empty()) {
        ImportedScene imported = importScene(draw.model);
        for (const std::string& warning : imported.warnings)
            say(fmt::format("warning: {}: {}", printable(draw.model), printable(warning)));
        lab.useScene(std::move(imported.scene));
        scene = printable(draw.model);
    }
    lab.markIdleKnobs();
    Studio studio(draw.backend);
    constexpr int defaultWidth = 640;
    constexpr int defaultHeight = 480;
    Frame frame = studio.frame(lab, draw.width.value_or(defaultWidth), draw.height.value_or(defaultHeight));
    frame.seed = draw.seed.value_or(frame.seed);
    if (options.graph) {
        print(studio.graph(lab, frame).graphviz());
        return;
    }
    const FramePlan result = planFrame(lab, entry, scene, studio, frame, options.frames);
    print(draw.json ? dump(toJson(result)) : toText(result));
}

}  // namespace quincunx

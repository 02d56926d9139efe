#include "lab/verbs.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <future>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "gl/window.h"
#include "image/color.h"
#include "image/io.h"
#include "lab/answer.h"
#include "lab/json.h"
#include "lab/picture_state.h"
#include "lab/plot.h"
#include "lab/stress.h"
#include "lab/studio.h"
#include "lab/sweep.h"
#include "lab/window.h"
#include "scene/fingerprint.h"
#include "scene/import.h"

namespace quincunx {
namespace {

constexpr int defaultWidth = 640;
constexpr int defaultHeight = 480;
constexpr int defaultWindowWidth = 960;
constexpr int defaultWindowHeight = 720;

float aspectOf(const Frame& frame) {
    return static_cast<float>(frame.width) / static_cast<float>(frame.height);
}

Frame makeFrame(const Lab& lab, const DrawOptions& options, bool window) {
    Frame frame;
    frame.width = options.width.value_or(window ? defaultWindowWidth : defaultWidth);
    frame.height = options.height.value_or(window ? defaultWindowHeight : defaultHeight);
    frame.camera = fittedToAspect(lab.defaultCamera(),
                                  static_cast<float>(frame.width) / static_cast<float>(frame.height));
    frame.seed = options.seed.value_or(frame.seed);
    return frame;
}

/// A model that is read by a thread of its own, while this one makes a context and the lab's programs.
class ComingModel {
  public:
    /// An empty name: none.
    explicit ComingModel(std::string file) : file_(std::move(file)) {
        if (!file_.empty())
            scene_ = std::async(std::launch::async, [this] { return importScene(file_); });
    }
    bool awaited() const { return scene_.valid(); }
    /// Waits for it, gives it to the lab and tells its fingerprint, 0 where there is none to come. Rethrows
    /// what reading threw; InputError if another fingerprint is `expected`, unless that is 0.
    std::uint64_t deliver(Lab& lab, std::uint64_t expected) {
        if (!awaited())
            return 0;
        ImportedScene imported = scene_.get();
        const std::uint64_t found = fingerprint(imported.scene);
        if (expected != 0 && expected != found)
            throw InputError("is not what it was when the picture was made", printable(file_),
                             "name it with --model to draw it as it is now");
        for (const std::string& warning : imported.warnings)
            say(fmt::format("warning: {}: {}", printable(file_), printable(warning)));
        lab.useScene(std::move(imported.scene));
        return found;
    }

  private:
    std::string file_;
    std::future<ImportedScene> scene_;
};

/// Draws the frame very small, so that its programs are ready (drivers finish them at their first use) when
/// the picture is drawn and timed.
void warmUp(Studio& studio, Lab& lab, Frame frame) {
    constexpr int reduction = 32;
    frame.width = std::max(frame.width / reduction, 1);
    frame.height = std::max(frame.height / reduction, 1);
    frame.unseen = true;
    studio.time(lab, frame, 1, 0);
}

/// The time of the picture's own frame if that is slow, since nobody should wait for another (its targets are
/// new to it: a tenth more on llvmpipe); else the median of five more.
double quickFrameSeconds(Studio& studio, Lab& lab, const Frame& frame) {
    constexpr double patienceSeconds = 0.1;
    const double seconds = studio.pictureSeconds();
    return seconds * 5 > patienceSeconds ? seconds : studio.time(lab, frame, 5, 0).medianSeconds;
}

}  // namespace

void print(std::string_view text) {
    errno = 0;
    const bool written = (text.empty() || std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) &&
                         std::fflush(stdout) == 0;
    if (written)
        return;
    if (errno == EPIPE)
        std::_Exit(static_cast<int>(ExitStatus::ok));
    throw InputError(std::strerror(errno), "standard output", "make room");
}

const LabEntry& findLab(std::span<const LabEntry> labs, std::string_view name) {
    std::vector<std::string> names;
    for (const LabEntry& entry : labs) {
        if (entry.isCalled(name))
            return entry;
        names.push_back(entry.folder());
    }
    throw InputError(fmt::format("there is no lab \"{}\"", printable(name, 40)), {},
                     fmt::format("choose from {}", fmt::join(names, ", ")));
}

void list(std::span<const LabEntry> labs, bool json) {
    Json array = Json::array();
    std::string text;
    for (const LabEntry& entry : labs) {
        const std::unique_ptr<Lab> lab = entry.make();
        std::vector<int> questions;
        for (const Question& question : lab->questions())
            questions.push_back(question.number);
        array.push_back({{"lab", entry.folder()}, {"topic", lab->topic()}, {"questions", questions}});
        text += fmt::format("{:<22} {}\n{:<22} questions {}\n", entry.folder(), lab->topic(), "",
                            fmt::join(questions, ", "));
    }
    print(json ? dump(array) : text);
}

void run(Lab& lab, const LabEntry& entry, RunOptions options) {
    DrawOptions& draw = options.draw;
    const bool offscreenWanted = !draw.out.empty() || draw.json;
    if (draw.backend == gl::Backend::window && offscreenWanted)
        throw InputError("a window writes no file and prints no figures", draw.json ? "--json" : "--out",
                         "leave it out, or choose another --backend");
    const bool window = draw.backend == gl::Backend::window || (draw.backend == gl::Backend::automatic &&
                                                                !offscreenWanted && gl::displayAvailable());
    const std::filesystem::path file = draw.out.empty() ? "out/" + entry.folder() + ".png" : draw.out;
    const bool floatingPoint = imageKindOf(file) == ImageKind::exr;
    if (!options.record.empty() &&
        std::filesystem::weakly_canonical(options.record) == std::filesystem::weakly_canonical(file))
        throw InputError("is the picture's own name", options.record, "give --record another file");
    PictureState state;
    if (!options.replay.empty()) {
        state = readPictureState(options.replay);
        if (state.lab != entry.folder())
            throw InputError(fmt::format("is a picture of {}", printable(state.lab, 40)), options.replay,
                             fmt::format("run {} instead", printable(state.lab, 40)));
        if (draw.model.empty())
            draw.model = state.model;
        else
            state.modelFingerprint = 0;
        try {
            lab.knobs().set(state.knobs);
        } catch (const InputError& e) {
            throw InputError(e.what(), options.replay);
        }
        lab.knobs().set(options.knobs);
        if (draw.width) {
            state.frame.width = *draw.width;
            state.frame.height = draw.height.value();
            state.frame.camera = fittedToAspect(state.frame.camera, aspectOf(state.frame));
        }
        state.frame.seed = draw.seed.value_or(state.frame.seed);
    } else {
        state.frame = makeFrame(lab, draw, window);
    }
    state.lab = entry.folder();
    state.model = draw.model;
    state.knobs = lab.knobs().values();

    ComingModel model(draw.model);
    const auto withModel = [&] {
        state.modelFingerprint = model.deliver(lab, state.modelFingerprint);
        lab.markIdleKnobs();
        for (const auto& [name, value] : options.knobs)
            if (const std::string& idle = lab.knobs().find(name).idle(); !idle.empty())
                say(fmt::format("warning: --{}: without effect; {}", name, idle));
        if (options.replay.empty())
            state.frame.camera = makeFrame(lab, draw, window).camera;
        return state;
    };
    if (window) {
        runWindow(lab, entry, withModel,
                  {.pictureFolder = "out",
                   .record = options.record,
                   .width = state.frame.width,
                   .height = state.frame.height,
                   .sceneIsComing = model.awaited()});
        return;
    }

    preloadImageIo();
    Studio studio(draw.backend);
    if (floatingPoint)
        state.frame.pictureFormat = graph::Format::rgba32f;
    warmUp(studio, lab, state.frame);
    withModel();
    const Image8 picture = floatingPoint ? Image8{} : studio.picture(lab, state.frame);
    const Image linear = floatingPoint ? studio.linearPicture(lab, state.frame) : Image{};
    throwIfInterrupted();
    const double frameSeconds = quickFrameSeconds(studio, lab, state.frame);
    state.renderer = studio.context().renderer();
    const std::string record = toJson(state);
    const ImageMetadata metadata = {{std::string(pictureStateKey), record}};
    if (floatingPoint)
        writeImage(file, linear, metadata);
    else
        writeImage(file, picture, metadata);
    if (!options.record.empty())
        writeFile(options.record, record + "\n");

    std::vector<std::string> drawn;
    for (const auto& [name, count] : lab.counters())
        drawn.push_back(fmt::format("{} {}", count, name));
    const std::string_view backend = gl::backendName(studio.context().backend());
    if (draw.json)
        print(dump({{"lab", entry.folder()},
                    {"file", file.string()},
                    {"backend", backend},
                    {"renderer", state.renderer},
                    {"width", state.frame.width},
                    {"height", state.frame.height},
                    {"seconds", frameSeconds},
                    {"counters", lab.counters()},
                    {"knobs", toJson(state.knobs)}}));
    else
        print(fmt::format("{}: {} at {}x{}, {:.2f} ms a frame\non {}: {}\n{}\n", entry.folder(),
                          fmt::join(drawn, ", "), state.frame.width, state.frame.height, frameSeconds * 1e3,
                          backend, state.renderer, file.string()));
}

ExitStatus ask(std::span<const LabEntry> labs, int number, const DrawOptions& options) {
    std::vector<int> answered;
    for (const LabEntry& entry : labs) {
        const std::unique_ptr<Lab> lab = entry.make();
        for (const Question& question : lab->questions()) {
            answered.push_back(question.number);
            if (question.number != number)
                continue;
            Studio studio(options.backend);
            const Answer answer = answerQuestion(entry, question, studio);
            print(options.json ? dump(toJson(answer)) : toText(answer));
            return answer.pass() ? ExitStatus::ok : ExitStatus::checkFellShort;
        }
    }
    std::sort(answered.begin(), answered.end());
    throw InputError(number > questionCount
                         ? fmt::format("there is no question {} among the {}", number, questionCount)
                         : fmt::format("question {} is not answered yet", number),
                     {}, fmt::format("ask one of {}", fmt::join(answered, ", ")));
}

ExitStatus sweep(Lab& lab, const LabEntry& entry, const SweepOptions& options) {
    const std::filesystem::path folder = options.draw.out.empty() ? "out" : options.draw.out;
    const std::vector<Sweep> sweeps = lab.sweeps();
    std::vector<std::string> names;
    names.reserve(sweeps.size());
    for (const Sweep& sweep : sweeps)
        names.push_back(sweep.name);
    if (!options.only.empty() && std::find(names.begin(), names.end(), options.only) == names.end())
        throw InputError(fmt::format("there is no sweep \"{}\"", printable(options.only, 40)), "--sweep",
                         fmt::format("choose from {}", fmt::join(names, ", ")));
    requireFolder(folder);

    Studio studio(options.draw.backend);
    Json array = Json::array();
    std::string text;
    bool chosen = true;
    for (const Sweep& sweep : sweeps) {
        if (!options.only.empty() && sweep.name != options.only)
            continue;
        Frame frame = studio.frame(lab, options.draw.width.value_or(sweep.width),
                                   options.draw.height.value_or(sweep.height));
        frame.seed = options.draw.seed.value_or(frame.seed);
        const SweepResult result = runSweep(lab, entry, sweep, studio, frame);
        const std::string stem = fmt::format("{}_{}", entry.folder(), sweep.name);
        writeFile(folder / (stem + ".csv"), toCsv(result));
        writePlotSvg(result, folder / (stem + ".svg"));

        const bool choose = options.budgetSeconds || options.maxError;
        const std::optional<std::size_t> choice =
            choosePoint(result.points, options.budgetSeconds, options.maxError);
        array.push_back(toJson(result));
        for (std::size_t i = 0; choose && i < result.points.size(); ++i)
            array.back()["points"][i]["chosen"] = i == choice.value_or(result.points.size());
        text += toTable(result) + "\n";
        if (choose && choice) {
            std::vector<std::string> knobs;
            for (const auto& [name, value] : result.points[choice.value()].knobs)
                knobs.push_back(fmt::format("--{}={}", name, value));
            text += fmt::format("picked: {}\n", fmt::join(knobs, " "));
        } else if (choose) {
            chosen = false;
            text += "no setting keeps the limits\n";
        }
        text += fmt::format("{0}/{1}.csv\n{0}/{1}.svg\n\n", folder.string(), stem);
    }
    print(options.draw.json ? dump(array) : text);
    return chosen ? ExitStatus::ok : ExitStatus::checkFellShort;
}

ExitStatus stress(Lab& lab, const LabEntry& entry, const StressOptions& options) {
    const StressResult result =
        runStress(lab, entry, options.full ? fullStressInputs : quickStressInputs, options.seed);
    print(options.json ? dump(toJson(result)) : toTable(result));
    return result.pass() ? ExitStatus::ok : ExitStatus::checkFellShort;
}

namespace {

/// Files that hold linear light, which 8-bit codes would cut off at 1.
bool isLinearFile(const std::filesystem::path& file) {
    const std::string extension = lowerCaseExtension(file);
    return extension == ".exr" || extension == ".hdr";
}

Comparison compareEncoded(const CompareOptions& options) {
    return compareImages(readImage8(options.first), readImage8(options.second), options.metric);
}

Comparison compareLinear(const CompareOptions& options) {
    const Image first = toLinear(readImage(options.first));
    const Image second = toLinear(readImage(options.second));
    switch (options.metric) {
        case Metric::rmse:
            return {rmse(first, second), differenceMap(first, second)};
        case Metric::flip:
            return {flip(first, second), flipMap(first, second)};
        case Metric::psnr:
        case Metric::ssim:
            break;
    }
    throw InputError(fmt::format("{} is defined for encoded pictures", metricName(options.metric)),
                     options.first, "compare EXR and HDR by rmse or flip");
}

}  // namespace

ExitStatus compare(const CompareOptions& options) {
    if (options.maxError && higherIsBetter(options.metric))
        throw InputError(fmt::format("{} grows with likeness", metricName(options.metric)), "--max-error",
                         "use it with rmse or flip");
    const std::filesystem::path map(
        !options.out.empty()
            ? options.out
            : fmt::format("out/{}_{}_{}.png", std::filesystem::path(options.first).stem().string(),
                          std::filesystem::path(options.second).stem().string(), metricName(options.metric)));
    imageKindOf(map);
    for (const std::string& input : {options.first, options.second})
        if (std::filesystem::weakly_canonical(input) == std::filesystem::weakly_canonical(map))
            throw InputError("is one of the pictures to compare", map.string(), "give --out another file");
    const bool linear = isLinearFile(options.first) || isLinearFile(options.second);
    const Comparison comparison = linear ? compareLinear(options) : compareEncoded(options);
    writeImage(map, errorMap(comparison.perPixel));
    if (options.json)
        print(dump({{"reference", options.first},
                    {"test", options.second},
                    {"metric", metricName(options.metric)},
                    {"value", comparison.value},
                    {"light", linear ? "linear" : "srgb"},
                    {"map", map.string()}}));
    else
        print(fmt::format("{} {:.6f}\n{}\n", metricName(options.metric), comparison.value, map.string()));
    return options.maxError && !(comparison.value <= *options.maxError) ? ExitStatus::checkFellShort
                                                                        : ExitStatus::ok;
}

}  // namespace quincunx

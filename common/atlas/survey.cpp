#include "atlas/survey.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "image/compare.h"
#include "image/io.h"
#include "lab/answer.h"
#include "lab/plan.h"
#include "lab/stress.h"
#include "lab/studio.h"
#include "lab/sweep.h"
#include "web/page.h"

namespace quincunx::atlas {
namespace {

constexpr int heroWidth = 640;
constexpr int heroHeight = 480;
constexpr int thumbWidth = 200;
constexpr int thumbHeight = 150;
constexpr int pointWidth = 320;
constexpr int pointHeight = 240;
constexpr int thumbQuality = 82;
constexpr int heroQuality = 90;
constexpr int planWidth = 640;
constexpr int planHeight = 480;

/// A lab with what draws it, made at the first use.
class Drawer {
  public:
    Drawer(const LabEntry& entry, gl::Backend backend) : entry_(entry), studio_(backend) {}
    Lab& lab() {
        if (!lab_)
            lab_ = entry_.make();
        return *lab_;
    }
    Studio& studio() { return studio_; }
    /// Without alpha, as it is seen and compared on a page.
    Image8 draw(int width, int height) {
        return web::withoutAlpha(studio_.picture(lab(), studio_.frame(lab(), width, height)));
    }

    /// Whether a picture of this size would take much longer than `patienceSeconds`, as far as smaller ones
    /// tell: their time is taken for a part that is fixed and one that grows with the pixels.
    bool isSlow(int width, int height, double patienceSeconds) {
        constexpr double muchLonger = 8;
        const auto seconds = [&](int part) {
            draw(std::max(width / part, 1), std::max(height / part, 1));
            return studio_.pictureSeconds();
        };
        if (seconds(16) < patienceSeconds / 16)
            return false;
        const double small = seconds(16);  // again: the first may have made programs ready
        if (small < patienceSeconds / 16)
            return false;
        const double larger = seconds(8);
        // In pixels of the small one, the larger has 4 and the whole 256.
        const double whole = larger + std::max(0.0, larger - small) / 3 * (256 - 4);
        return whole > muchLonger * patienceSeconds;
    }

    /// By how much pictures of this size are made smaller so that the lab, as it is at first, is not slow.
    int reduction(int width, int height, double patienceSeconds) {
        if (reduction_ == 0) {
            draw(width / 2, height / 2);
            reduction_ = studio_.pictureSeconds() > patienceSeconds / 4 ? 2 : 1;
        }
        return reduction_;
    }

  private:
    LabEntry entry_;
    int reduction_ = 0;  ///< 0: not known yet
    Studio studio_;
    std::unique_ptr<Lab> lab_;  // goes before its context
};

std::string bytesText(const std::vector<unsigned char>& bytes) {
    return {bytes.begin(), bytes.end()};
}

/// Writes the pictures of one piece.
class PictureWriter {
  public:
    explicit PictureWriter(const Store& store) : store_(store) {}

    void jpeg(const std::string& name, const Image8& picture, int quality) {
        write(name, bytesText(encodedJpeg(picture, quality, name)));
    }
    /// The picture for people, and all its pixels for compare.js.
    Json comparable(const std::string& stem, const Image8& picture) {
        jpeg(stem + ".jpg", web::thumbnail(picture, thumbWidth, thumbHeight), thumbQuality);
        // As the lab's page, which is beside the folder, names it.
        const std::string key = store_.folder().filename().string() + "/" + stem + ".js";
        write(stem + ".js", web::pixelScript(key, picture));
        return {{"file", stem + ".jpg"}, {"pixels", stem + ".js"}};
    }
    Piece piece(Json result) { return {std::move(result), std::move(files_)}; }

  private:
    void write(const std::string& name, const std::string& contents) {
        writeFile(store_.folder() / name, contents);
        files_.push_back(name);
    }
    const Store& store_;
    std::vector<std::string> files_;
};

/// A number of people's kind, of few digits.
std::string rounded(double value) {
    return fmt::format("{:.3g}", value);
}

/// The `k`-th of `count` values from the default towards `end`.
double between(double from, double end, int k, int count, bool logarithmic) {
    const double share = static_cast<double>(k) / count;
    return logarithmic && from > 0 && end > 0 ? from * std::pow(end / from, share)
                                              : from + (end - from) * share;
}

template <typename Number>
std::vector<std::string> numberValues(NumberKnob<Number>& knob, int steps) {
    const double start = static_cast<double>(static_cast<Number>(knob));
    const auto [min, max, logarithmic] = knob.range();
    // An end that is the default has no values on its side: the other side gets them.
    const int below = start == min ? 0 : start == max ? 2 * steps : steps;
    const int above = 2 * steps - below;
    std::vector<std::pair<double, std::string>> values;
    const auto add = [&](double value) {
        if constexpr (std::is_integral_v<Number>)
            value = std::round(value);
        const double near = std::stod(rounded(value));
        knob.parse(fmt::format("{}", std::clamp<double>(near, min, max)));
        const double set = static_cast<double>(static_cast<Number>(knob));
        if (std::none_of(values.begin(), values.end(), [&](const auto& known) { return known.first == set; }))
            values.emplace_back(set, knob.text());
    };
    values.emplace_back(start, knob.text());
    // Logarithmic ranges reach far beyond what is of use: their ends are left out.
    for (int k = 1; k <= below; ++k)
        add(between(start, min, k, logarithmic ? below + 1 : below, logarithmic));
    for (int k = 1; k <= above; ++k)
        add(between(start, max, k, logarithmic ? above + 1 : above, logarithmic));
    std::sort(values.begin(), values.end());
    std::vector<std::string> texts;
    for (const auto& [value, text] : values)
        texts.push_back(text);
    return texts;
}

/// In the order in which they are drawn: the default, then away from it, first to lower ones.
std::vector<std::size_t> drawingOrder(std::size_t count, std::size_t start) {
    std::vector<std::size_t> order = {start};
    for (std::size_t i = start; i-- > 0;)
        order.push_back(i);
    for (std::size_t i = start + 1; i < count; ++i)
        order.push_back(i);
    return order;
}

/// How much longer the picture of `value` would take than that of `from`, if its time grew with the value.
double growth(const std::string& from, const std::string& value) {
    const double start = std::abs(std::stod(from));
    return start > 0 ? std::max(1.0, std::abs(std::stod(value)) / start) : 1;
}

Piece knobPiece(const std::string& name, Drawer& drawer, const SurveyOptions& options, const Store& store) {
    Lab& lab = drawer.lab();
    const KnobScope scope(lab.knobs());
    lab.markIdleKnobs();
    Knob& knob = lab.knobs().find(name);
    Json result{{"name", knob.name()},           {"unit", knob.unit()},
                {"help", knob.help()},           {"allowed", knob.allowed()},
                {"default", knob.defaultText()}, {"idle", knob.idle().empty() ? Json() : Json(knob.idle())},
                {"values", Json::array()},       {"slow", false},
                {"refused", Json::array()},      {"same", false}};
    PictureWriter writer(store);
    const std::vector<std::string> values = valuesToShow(knob, options.steps);
    if (!knob.idle().empty() || values.size() < 2)
        return writer.piece(result);

    const bool isNumber =
        dynamic_cast<FloatKnob*>(&knob) != nullptr || dynamic_cast<IntKnob*>(&knob) != nullptr;
    const auto start = static_cast<std::size_t>(std::find(values.begin(), values.end(), knob.defaultText()) -
                                                values.begin());
    std::vector<std::optional<Image8>> pictures(values.size());
    const int reduction =
        drawer.reduction(options.pictureWidth, options.pictureHeight, options.patienceSeconds);
    const int width = options.pictureWidth / reduction;
    const int height = options.pictureHeight / reduction;
    double startSeconds = 0;
    double lastSeconds = 0;
    for (const std::size_t i : drawingOrder(values.size(), start)) {
        throwIfInterrupted();
        if (i == start + 1)
            lastSeconds = startSeconds;  // the other way from here
        if (isNumber && i != start &&
            lastSeconds * growth(values[i > start ? i - 1 : i + 1], values[i]) > options.patienceSeconds) {
            result["slow"] = true;
            lastSeconds = HUGE_VAL;
            continue;
        }
        knob.parse(values[i]);
        try {
            if (i != start && drawer.isSlow(width, height, options.patienceSeconds)) {
                result["slow"] = true;
                lastSeconds = HUGE_VAL;
                continue;
            }
            pictures[i] = drawer.draw(width, height);
        } catch (const Interrupted&) {
            throw;
        } catch (const InputError& e) {  // a setting that needs others beside it
            if (i == start)
                throw;
            result["refused"].push_back({{"value", values[i]}, {"why", e.what()}});
            continue;
        }
        lastSeconds = drawer.studio().pictureSeconds();
        if (i == start)
            startSeconds = lastSeconds;
    }
    const Image8& before = *pictures[start];
    const auto drawn = std::count_if(pictures.begin(), pictures.end(),
                                     [](const auto& picture) { return picture.has_value(); });
    if (drawn < 2)
        return writer.piece(result);
    result["same"] = std::all_of(pictures.begin(), pictures.end(),
                                 [&](const auto& picture) { return !picture || *picture == before; });
    if (result["same"])
        return writer.piece(result);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!pictures[i])
            continue;
        Json value{{"value", values[i]}, {"is_default", i == start}, {"rmse", rmse(before, *pictures[i])}};
        value.update(writer.comparable(fmt::format("{}-{}", name, i), *pictures[i]));
        result["values"].push_back(value);
    }
    return writer.piece(result);
}

Piece sweepPiece(std::size_t index, const LabEntry& entry, const SurveyOptions& options, const Store& store) {
    Drawer drawer(entry, options.backend);
    Lab& lab = drawer.lab();
    const Sweep sweep = lab.sweeps()[index];
    // What is small already is small for a reason.
    constexpr double leastWidth = 120;
    const double scale = std::max(options.sweepScale, std::min(1.0, leastWidth / sweep.width));
    const auto side = [&](int pixels) { return static_cast<int>(std::lround(pixels * scale)); };
    const Frame frame = drawer.studio().frame(lab, side(sweep.width), side(sweep.height));
    const SweepResult measured = runSweep(lab, entry, sweep, drawer.studio(), frame);
    PictureWriter writer(store);
    Json result{{"sweep", toJson(measured)},
                {"width", frame.width},
                {"height", frame.height},
                {"pictures", Json::array()}};
    const KnobScope scope(lab.knobs());
    std::vector<Image8> pictures;
    for (const SweepPoint& point : measured.points) {
        throwIfInterrupted();
        lab.knobs().set(point.knobs);
        const bool slow = drawer.isSlow(pointWidth, pointHeight, options.patienceSeconds);
        pictures.push_back(slow ? drawer.draw(frame.width, frame.height)
                                : drawer.draw(pointWidth, pointHeight));
    }
    if (std::all_of(pictures.begin(), pictures.end(),
                    [&](const Image8& picture) { return picture == pictures.front(); }))
        pictures.resize(1);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const std::string name = fmt::format("sweep-{}-{}.jpg", sweep.name, i);
        writer.jpeg(name, pictures[i], thumbQuality);
        result["pictures"].push_back(name);
    }
    return writer.piece(result);
}

Piece heroPiece(Drawer& drawer, const Store& store) {
    PictureWriter writer(store);
    const Image8 picture = drawer.draw(heroWidth, heroHeight);
    writer.jpeg("picture.jpg", picture, heroQuality);
    writer.jpeg("card.jpg", web::thumbnail(picture, pointWidth, pointHeight), thumbQuality);
    return writer.piece({{"file", "picture.jpg"},
                         {"card", "card.jpg"},
                         {"width", heroWidth},
                         {"height", heroHeight},
                         {"renderer", drawer.studio().context().renderer()}});
}

}  // namespace

SurveyOptions quickSurvey(gl::Backend backend) {
    return {.backend = backend, .stressInputs = quickStressInputs};
}

SurveyOptions fullSurvey(gl::Backend backend) {
    return {.backend = backend,
            .steps = 2,
            .patienceSeconds = 4,
            .sweepScale = 1,
            .planFrames = 12,
            .stressInputs = 10 * quickStressInputs};
}

std::vector<std::string> valuesToShow(Knob& knob, int steps) {
    const std::string before = knob.text();
    std::vector<std::string> values;
    if (auto* const real = dynamic_cast<FloatKnob*>(&knob))
        values = numberValues(*real, steps);
    else if (auto* const whole = dynamic_cast<IntKnob*>(&knob))
        values = numberValues(*whole, steps);
    else if (const auto* const choice = dynamic_cast<const ChoiceKnob*>(&knob))
        values = choice->options();
    else if (dynamic_cast<const BoolKnob*>(&knob) != nullptr)
        values = {"off", "on"};
    knob.parse(before);
    return values;
}

std::vector<Task> surveyOf(const LabEntry& entry, const SurveyOptions& options, const Store& store) {
    const auto pictures = std::make_shared<Drawer>(entry, options.backend);
    const auto answers = std::make_shared<Drawer>(entry, options.backend);
    const std::string backend(gl::backendName(options.backend));
    std::vector<Task> tasks;
    tasks.push_back({"picture", backend, 1, [pictures, &store] { return heroPiece(*pictures, store); }});
    Lab& lab = pictures->lab();
    for (const Knob* knob : lab.knobs().all())
        tasks.push_back({"knob_" + knob->name(),
                         fmt::format("{} {}x{} {} {}", backend, options.pictureWidth, options.pictureHeight,
                                     options.steps, options.patienceSeconds),
                         1, [name = knob->name(), pictures, options, &store] {
                             return knobPiece(name, *pictures, options, store);
                         }});
    const std::vector<Sweep> sweeps = lab.sweeps();
    for (std::size_t i = 0; i < sweeps.size(); ++i)
        tasks.push_back({"sweep_" + sweeps[i].name,
                         fmt::format("{} {} {}", backend, options.sweepScale, options.patienceSeconds),
                         sweeps[i].points.size(),
                         [i, entry, options, &store] { return sweepPiece(i, entry, options, store); }});
    tasks.push_back({"stress", fmt::format("{}", options.stressInputs), 1, [entry, options] {
                         const std::unique_ptr<Lab> own = entry.make();
                         constexpr std::uint64_t seed = 1;
                         return Piece{toJson(runStress(*own, entry, options.stressInputs, seed)), {}};
                     }});
    tasks.push_back({"plan", fmt::format("{} {}", backend, options.planFrames), 2, [entry, options] {
                         Drawer drawer(entry, options.backend);
                         const Frame frame = drawer.studio().frame(drawer.lab(), planWidth, planHeight);
                         return Piece{toJson(planFrame(drawer.lab(), entry, entry.folder(), drawer.studio(),
                                                       frame, options.planFrames)),
                                      {}};
                     }});
    const std::vector<Question> questions = answers->lab().questions();
    for (std::size_t i = 0; i < questions.size(); ++i)
        tasks.push_back({fmt::format("question_{}", questions[i].number), backend, 1, [i, entry, answers] {
                             const std::vector<Question> all = answers->lab().questions();
                             return Piece{toJson(answerQuestion(entry, all[i], answers->studio())), {}};
                         }});
    return tasks;
}

}  // namespace quincunx::atlas

#include "grade/references.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "grade/handout.h"
#include "grade/intake.h"
#include "lab/picture_state.h"

namespace quincunx::grade {
namespace {

constexpr int leastSide = 16;
constexpr int mostSide = 4096;
constexpr std::size_t keptBytes = std::size_t{1} << 30;

bool isSize(int width, int height) {
    return width >= leastSide && height >= leastSide && width <= mostSide && height <= mostSide;
}

/// A size with the picture's shape within what is rendered.
std::pair<int, int> boundedSize(int width, int height) {
    const double scale = std::min(1.0, static_cast<double>(mostSide) / std::max(width, height));
    return {std::clamp(static_cast<int>(width * scale), leastSide, mostSide),
            std::clamp(static_cast<int>(height * scale), leastSide, mostSide)};
}

/// Whether a picture of one side may have been made with the other: cropped, in a border, or on a screen with
/// two pixels for one. A record that is further off is no help: its picture would be all blur.
bool plausible(int recorded, int found) {
    return 2.2 * recorded >= found && 2.2 * found >= recorded;
}

std::size_t bytesOf(const Reference& reference) {
    std::size_t bytes = reference.picture.data.size();
    for (const Image8& picture : reference.without)
        bytes += picture.data.size();
    return bytes;
}

void set(KnobSet& knobs, const KnobValues& values) {
    for (const auto& [name, value] : values)
        knobs.find(name).parse(value);
}

}  // namespace

ReferenceStore::ReferenceStore(const LabEntry& entry, Rubric rubric, gl::Backend backend)
    : entry_(entry), rubric_(std::move(rubric)), backend_(backend), thread_([this] { work(); }) {}

ReferenceStore::~ReferenceStore() {
    {
        const std::scoped_lock lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

References ReferenceStore::get(const Claim& claim) {
    std::future<References> result;
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back({claim, {}});
        result = tasks_.back().result.get_future();
    }
    changed_.notify_all();
    return result.get();
}

void ReferenceStore::work() {
    while (true) {
        Task task;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
            if (tasks_.empty())
                break;
            task = std::move(tasks_.front());
            tasks_.pop_front();
        }
        try {
            task.result.set_value(render(task.claim));
        } catch (...) {
            task.result.set_exception(std::current_exception());
        }
    }
    // Objects of the device go where they were made.
    if (studio_)
        studio_->context();
    lab_.reset();
    studio_.reset();
}

ReferenceStore::Wanted ReferenceStore::wantedFor(const Claim& claim, std::vector<std::string>& remarks) {
    Wanted wanted;
    set(lab_->knobs(), rubric_.knobs);
    std::optional<PictureState> state;
    if (!claim.state.empty()) {
        try {
            state = parsePictureState(claim.state, "the picture's record");
        } catch (const Error& e) {
            remarks.push_back(printable(e.what()));
        }
    }
    if (state && state->lab != entry_.folder()) {
        remarks.push_back(fmt::format("the picture's record is of the lab {}", printable(state->lab, 40)));
        state.reset();
    }
    if (state) {
        if (!state->model.empty())
            remarks.push_back(
                "the picture was drawn from a model of the student's own; the task's scene is the lab's");
        const std::set<std::string> free(rubric_.freeKnobs.begin(), rubric_.freeKnobs.end());
        constexpr std::size_t mostTold = 8;
        for (const auto& [name, value] : state->knobs) {
            const auto& all = lab_->knobs().all();
            const auto knob = std::find_if(all.begin(), all.end(), [&, &wantedName = name](const Knob* one) {
                return one->name() == wantedName;
            });
            if (knob == all.end() || (*knob)->text() == value)
                continue;
            if (!free.contains(name)) {
                if (remarks.size() < mostTold)
                    remarks.push_back(fmt::format("drawn with --{}={}, where the task has {}", name,
                                                  printable(value, 40), (*knob)->text()));
                continue;
            }
            try {
                (*knob)->parse(value);
            } catch (const InputError& e) {
                remarks.push_back(printable(e.what()));
            }
        }
    }
    auto [width, height] = boundedSize(claim.width, claim.height);
    if (state && isSize(state->frame.width, state->frame.height) &&
        plausible(state->frame.width, claim.width) && plausible(state->frame.height, claim.height))
        std::tie(width, height) = std::pair(state->frame.width, state->frame.height);
    else if (rubric_.size)
        std::tie(width, height) = *rubric_.size;
    wanted.knobs = lab_->knobs().values();
    wanted.frame = studio_->frame(*lab_, width, height);
    if (state && rubric_.cameraIsFree &&
        !(state->frame.camera.worldFromCamera == wanted.frame.camera.worldFromCamera &&
          state->frame.camera.fovYRadians == wanted.frame.camera.fovYRadians)) {
        wanted.frame.camera = state->frame.camera;
        wanted.cameraClaimed = true;
    }
    return wanted;
}

Reference ReferenceStore::drawn(const Wanted& wanted) {
    Reference reference;
    set(lab_->knobs(), wanted.knobs);
    reference.picture = rgbOf(studio_->picture(*lab_, wanted.frame));
    for (const Property& property : rubric_.properties) {
        Image8 without;
        if (property.measure == Measure::effect) {
            set(lab_->knobs(), wanted.knobs);
            set(lab_->knobs(), property.without);
            without = rgbOf(studio_->picture(*lab_, wanted.frame));
        }
        if (property.measure == Measure::task && !untouched_.empty()) {
            set(lab_->knobs(), wanted.knobs);
            useShader(untouched_);
            without = rgbOf(studio_->picture(*lab_, wanted.frame));
            useShader(solution_);
        }
        reference.without.push_back(std::move(without));
    }
    set(lab_->knobs(), wanted.knobs);
    return reference;
}

void ReferenceStore::useShader(const std::string& text) {
    gl::replaceKeptShader(shader_, text);
    if (const std::optional<std::string> fault = studio_->executor().programs().reloadChanged())
        throw EnvironmentError(*fault, "shaders/" + shader_);
}

std::vector<double> ReferenceStore::areasOf(const Wanted& wanted) {
    Wanted small = wanted;
    constexpr int side = 160;
    const double scale =
        std::min(1.0, static_cast<double>(side) / std::max(small.frame.width, small.frame.height));
    small.frame.width = std::max(leastSide, static_cast<int>(small.frame.width * scale));
    small.frame.height = std::max(leastSide, static_cast<int>(small.frame.height * scale));
    const Reference reference = drawn(small);
    std::vector<double> areas;
    for (const Image8& without : reference.without)
        areas.push_back(without.data.empty() ? 0 : effectArea(reference.picture, without));
    return areas;
}

bool ReferenceStore::hidesAnEffect(const Wanted& wanted) {
    constexpr double mostHidden = 0.75;
    Wanted task = wanted;
    task.frame = studio_->frame(*lab_, wanted.frame.width, wanted.frame.height);
    const std::vector<double> asked = areasOf(task);
    const std::vector<double> claimed = areasOf(wanted);
    for (std::size_t i = 0; i < asked.size(); ++i)
        if (claimed[i] < (1 - mostHidden) * asked[i])
            return true;
    return false;
}

References ReferenceStore::render(const Claim& claim) {
    if (!studio_) {
        studio_ = std::make_unique<Studio>(backend_);
        lab_ = entry_.make();
        const Exercise exercise = lab_->exercise();
        shader_ = exercise.shader;
        solution_ = solutionOf(exercise);
        untouched_ = handoutOf(solution_, shader_).text;
        gl::keepShadersInMemory();
    }
    const KnobScope scope(lab_->knobs());
    References result;
    Wanted wanted = wantedFor(claim, result.remarks);
    const auto textOf = [&] {
        PictureState state;
        state.lab = entry_.folder();
        state.knobs = wanted.knobs;
        state.frame = wanted.frame;
        return toJson(state);
    };
    if (wanted.cameraClaimed) {
        const std::string text = textOf();
        if (!hiding_.contains(text)) {
            if (hiding_.size() > 10000)
                hiding_.clear();
            hiding_[text] = hidesAnEffect(wanted);
        }
        if (hiding_[text]) {
            result.remarks.emplace_back(
                "the picture's camera hides what is to be seen; the task's camera is the reference's");
            wanted.frame = studio_->frame(*lab_, wanted.frame.width, wanted.frame.height);
        }
    }
    result.key = digest(textOf());
    if (const auto found = kept_.find(result.key); found != kept_.end()) {
        result.pictures = found->second;
        return result;
    }
    auto reference = std::make_shared<Reference>(drawn(wanted));
    keptBytes_ += bytesOf(*reference);
    while (keptBytes_ > keptBytes && !order_.empty()) {
        keptBytes_ -= bytesOf(*kept_.at(order_.front()));
        kept_.erase(order_.front());
        order_.pop_front();
    }
    kept_[result.key] = reference;
    order_.push_back(result.key);
    result.pictures = std::move(reference);
    return result;
}

}  // namespace quincunx::grade

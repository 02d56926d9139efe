#include "grade/worker.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "grade/archive.h"
#include "grade/channel.h"
#include "grade/handout.h"
#include "grade/intake.h"
#include "grade/rubric.h"
#include "grade/sandbox.h"
#include "grade/scoring.h"
#include "grade/views.h"
#include "image/compare.h"
#include "image/header.h"
#include "image/io.h"
#include "lab/picture_state.h"

namespace quincunx::grade {
namespace {

constexpr std::uint64_t maxFileBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t maxAllBytes = std::uint64_t{512} << 20;
constexpr std::size_t maxShaderBytes = 256 << 10;
constexpr std::int64_t maxPixels = std::int64_t{64} << 20;
constexpr std::size_t maxPicturesTried = 8;

struct Given {
    std::string name;
    std::string bytes;
};

/// What a submission's processes know before they know the submission.
struct Setting {
    const LabEntry* entry = nullptr;
    Exercise exercise;
    Rubric rubric;
    ProcessLimits limits;
};

void answer(const Message& message) {
    if (!send(STDOUT_FILENO, message))
        _exit(1);
}

/// The file's bytes, or why not: opened without following links and without waiting for a reader of a pipe.
std::optional<std::string> contentsOf(const std::string& path, std::string& fault) {
    const int file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status {};
    if (file < 0 || fstat(file, &status) != 0) {
        fault = fmt::format("cannot be read: {}", std::strerror(errno));
        if (file >= 0)
            close(file);
        return {};
    }
    const auto size = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
    std::string bytes;
    if (!S_ISREG(status.st_mode))
        fault = "refused: no regular file";
    else if (size > maxFileBytes)
        fault = fmt::format("refused: {} bytes", size);
    else
        bytes.resize(size);
    std::size_t filled = 0;
    while (fault.empty() && filled < bytes.size()) {
        const ssize_t got = read(file, bytes.data() + filled, bytes.size() - filled);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            fault = fmt::format("cannot be read: {}", std::strerror(errno));
        if (got <= 0)
            break;
        filled += static_cast<std::size_t>(got);
    }
    close(file);
    bytes.resize(filled);
    return fault.empty() ? std::optional(std::move(bytes)) : std::nullopt;
}

bool looksLikePicture(std::string_view bytes) {
    return bytes.starts_with("\x89PNG") || bytes.starts_with("\xFF\xD8\xFF") ||
           (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP"));
}

std::string extensionOf(const std::string& name) {
    return lowerCaseExtension(std::filesystem::path(name));
}

bool isPictureName(const std::string& name) {
    const std::string extension = extensionOf(name);
    return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".webp";
}

bool isShaderName(const std::string& name) {
    const std::string extension = extensionOf(name);
    return extension == ".frag" || extension == ".vert" || extension == ".glsl";
}

std::span<const std::byte> asBytes(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

/// As reports show it.
std::string encodedSmall(const Image8& picture) {
    const int longest = std::max(picture.width, picture.height);
    const int width =
        longest <= reportSide ? picture.width : std::max(1, picture.width * reportSide / longest);
    const int height =
        longest <= reportSide ? picture.height : std::max(1, picture.height * reportSide / longest);
    const std::vector<unsigned char> bytes = encodedPng(resized(picture, width, height), "picture");
    return {bytes.begin(), bytes.end()};
}

Json jsonOf(const Result& result) {
    Json scores = Json::array();
    for (const Score& score : result.scores)
        scores.push_back({{"name", score.name},
                          {"figure", score.figure},
                          {"points", score.points},
                          {"of", score.of},
                          {"reason", score.reason}});
    Json limits = Json::array();
    for (const Limit& limit : result.limits)
        limits.push_back({{"share", limit.share}, {"reason", limit.reason}});
    return {{"scores", scores}, {"limits", limits}, {"remarks", result.remarks}};
}

/// How the pictures differ, coarsely: to find submissions that are wrong in the same way.
std::string signatureOf(const Image8& reference, const Image8& submitted) {
    constexpr int width = 24;
    constexpr int height = 18;
    const Image8 a = resized(reference, width, height);
    const Image8 b = resized(submitted, width, height);
    std::string signature;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        signature += fmt::format("{:02x}", std::clamp((b.data[i] - a.data[i]) / 2 + 128, 0, 255));
    return signature;
}

void answerScored(Json header, const Result& result) {
    const std::string submitted = encodedSmall(result.submitted);
    const std::string errors = encodedSmall(errorMap(result.errors));
    header["pictures"] = {submitted.size(), errors.size()};
    answer({"scored", std::move(header), submitted + errors});
}

/// The first bytes of a picture hold sizes to be refused before anything is decoded.
Image8 decodedPicture(const Given& given) {
    const imageio::Header header = imageio::readHeader(asBytes(given.bytes), "the picture");
    if (header.width > 0 && header.height > 0 && header.width * header.height > maxPixels)
        throw InputError(
            fmt::format("{}×{} pixels, more than {} million", header.width, header.height, maxPixels >> 20));
    return readImage8FromMemory(asBytes(given.bytes), "the picture");
}

class Look {
  public:
    Look(const Setting& setting, const Json& job) : setting_(setting) {
        std::uint64_t total = 0;
        for (const Json& file : job.at("files")) {
            std::string name = file.at("name").get<std::string>();
            std::string wrong;
            std::optional<std::string> bytes = contentsOf(file.at("path").get<std::string>(), wrong);
            if (bytes && (total += bytes->size()) > maxAllBytes) {
                wrong = "passed over: too much in all";
                bytes.reset();
            }
            if (bytes)
                given_.push_back({std::move(name), std::move(*bytes)});
            else
                fault(name, wrong);
        }
    }

    void run() {
        unpackArchives();
        choosePicture();
        chooseShader();
        Json seen{{"faults", faults_}, {"remarks", remarks_}, {"picture", Json()}, {"shader", Json()}};
        if (picture_)
            seen["picture"] = {{"name", pictureName_},
                               {"width", picture_->width},
                               {"height", picture_->height},
                               {"state", state_ ? Json(*state_) : Json()}};
        if (shader_ != nullptr)
            seen["shader"] = {{"name", shader_->name}};
        answer({"seen", std::move(seen), shader_ != nullptr ? shader_->bytes : std::string()});
        if (!picture_)
            return;
        const std::optional<Message> next = receive(STDIN_FILENO);
        if (!next || next->kind != "reference")
            return;
        score(*next);
    }

  private:
    void fault(const std::string& name, const std::string& what) {
        constexpr std::size_t most = 60;
        if (faults_.size() < most)
            faults_.push_back(fmt::format("{}: {}", printable(name, 120), what));
    }

    void unpackArchives() {
        std::vector<Given> all;
        for (Given& given : given_) {
            if (!isArchive(given.bytes)) {
                all.push_back(std::move(given));
                continue;
            }
            Unpacked unpacked = unpack(given.bytes);
            for (const std::string& wrong : unpacked.faults)
                fault(given.name, wrong);
            for (UnpackedFile& file : unpacked.files)
                if (file.name.find("__MACOSX/") == std::string::npos &&
                    file.name.find("/._") == std::string::npos)
                    all.push_back({given.name + "/" + file.name, std::move(file.bytes)});
        }
        given_ = std::move(all);
    }

    /// The picture's own record, if this lab wrote one.
    std::optional<std::string> stateOf(const Given& given) const {
        for (const auto& [key, value] : readMetadataFromMemory(asBytes(given.bytes), "the picture"))
            if (key == pictureStateKey)
                return value;
        return {};
    }

    /// One with a record of this lab before others, then the last by name: platforms number what is handed in
    /// again.
    void choosePicture() {
        std::vector<const Given*> candidates;
        for (const Given& given : given_) {
            if (looksLikePicture(given.bytes))
                candidates.push_back(&given);
            else if (isPictureName(given.name))
                fault(given.name, given.bytes.empty() ? "empty" : "no picture, whatever its name says");
        }
        std::sort(candidates.begin(), candidates.end(),
                  [](const Given* a, const Given* b) { return a->name > b->name; });
        if (candidates.size() > maxPicturesTried) {
            remarks_.push_back(
                fmt::format("{} pictures, of which {} were looked at", candidates.size(), maxPicturesTried));
            candidates.resize(maxPicturesTried);
        }
        std::size_t usable = 0;
        for (const Given* given : candidates) {
            try {
                Image8 picture = decodedPicture(*given);
                std::optional<std::string> state = stateOf(*given);
                ++usable;
                const bool better = !picture_ || (!state_ && state);
                if (!better)
                    continue;
                picture_ = std::move(picture);
                state_ = std::move(state);
                pictureName_ = given->name;
            } catch (const Error& e) {
                fault(given->name, e.what());
            } catch (const std::bad_alloc&) {
                fault(given->name, "does not fit into memory");
            }
        }
        if (usable > 1)
            remarks_.push_back(
                fmt::format("{} pictures; {} was graded", usable, printable(pictureName_, 80)));
    }

    void chooseShader() {
        const std::string wanted = std::filesystem::path(setting_.exercise.shader).filename().string();
        const std::string stem = std::filesystem::path(wanted).stem().string();
        std::size_t count = 0;
        const auto fit = [&](const Given& given) {
            const std::string name = std::filesystem::path(given.name).filename().string();
            return (extensionOf(name) == extensionOf(wanted) ? 1 : 0) +
                   (name.find(stem) != std::string::npos ? 2 : 0) + (name == wanted ? 4 : 0);
        };
        for (const Given& given : given_) {
            if (!isShaderName(given.name))
                continue;
            if (given.bytes.size() > maxShaderBytes) {
                fault(given.name, fmt::format("refused: a shader of {} bytes", given.bytes.size()));
                continue;
            }
            ++count;
            if (shader_ == nullptr || fit(given) >= fit(*shader_))
                shader_ = &given;
        }
        if (count > 1)
            remarks_.push_back(fmt::format("{} shaders; {} was graded", count, printable(shader_->name, 80)));
        if (shader_ != nullptr && wanted.empty()) {
            fault(shader_->name, "this lab has no task for a shader");
            shader_ = nullptr;
        }
    }

    void score(const Message& message) {
        const int width = message.header.at("width").get<int>();
        const int height = message.header.at("height").get<int>();
        std::size_t at = 0;
        const auto picture = [&] {
            Image8 image(width, height, 3, Encoding::srgb);
            QX_CHECK_LE(at + image.data.size(), message.blob.size());
            std::memcpy(image.data.data(), message.blob.data() + at, image.data.size());
            at += image.data.size();
            return image;
        };
        Reference reference;
        reference.picture = picture();
        for (const Json& present : message.header.at("without"))
            reference.without.push_back(present.get<bool>() ? picture() : Image8{});
        picture_->encoding = Encoding::srgb;
        const Result result = scoreScreenshot(reference, *picture_, setting_.rubric);
        Json header = jsonOf(result);
        const bool same = result.reference.data == result.submitted.data;
        header["exact"] = same;
        header["signature"] = same ? std::string() : signatureOf(result.reference, result.submitted);
        answerScored(std::move(header), result);
    }

    const Setting& setting_;
    std::vector<Given> given_;
    std::vector<std::string> faults_;
    std::vector<std::string> remarks_;
    std::optional<Image8> picture_;
    std::optional<std::string> state_;
    std::string pictureName_;
    const Given* shader_ = nullptr;
};

/// Draws the views with the solution and the handout, closes the process in, and draws them with the
/// student's shader. In software: a device would need more of the system than a closed-in process has.
void draw(const Setting& setting, const Message& job) {
    const std::unique_ptr<Lab> lab = setting.entry->make();
    Studio studio(gl::Backend::osmesa);
    gl::keepShadersInMemory();
    const std::string solution = solutionOf(setting.exercise);
    const std::vector<View> views = unseenViews(*lab, setting.exercise, setting.rubric);
    const auto pictures = [&] {
        std::vector<Image8> drawn;
        for (const View& view : views)
            drawn.push_back(drawView(studio, *lab, view));
        return drawn;
    };
    const auto use = [&](std::string text) {
        gl::ProgramCache& programs = studio.executor().programs();
        const std::uint64_t before = programs.rebuilds();
        gl::replaceKeptShader(setting.exercise.shader, std::move(text));
        if (const std::optional<std::string> fault = programs.reloadChanged())
            throw InputError(*fault);
        // Programs keep what they have while a file is empty, as editors leave it for a moment.
        if (programs.rebuilds() == before)
            throw InputError("makes no program: it is empty", setting.exercise.shader);
    };
    const std::vector<Image8> right = pictures();
    use(handoutOf(solution, setting.exercise.shader).text);
    const std::vector<Image8> untouched = pictures();
    use(solution);
    limitProcess(setting.limits);
    closeSandbox();

    const std::vector<Property>& properties = setting.rubric.shaderProperties;
    Json header{{"scores", Json::array()}, {"limits", Json::array()}, {"remarks", Json::array()}};
    std::vector<Result> results;
    try {
        use(job.blob);
        const std::vector<Image8> drawn = pictures();
        for (std::size_t i = 0; i < views.size(); ++i) {
            Reference reference{right[i], {}};
            for (const Property& property : properties)
                reference.without.push_back(property.measure == Measure::task ? untouched[i] : Image8{});
            results.push_back(scoreDrawn(reference, drawn[i], properties));
        }
    } catch (const Error& e) {
        for (const Property& property : properties)
            header["scores"].push_back({{"name", property.name},
                                        {"figure", 0},
                                        {"points", 0},
                                        {"of", property.points},
                                        {"reason", "the shader cannot be used"}});
        header["fault"] = e.what();
        answer({"scored", std::move(header), {}});
        return;
    }
    // A property's points are the mean over the views that show it; its reason is that of the worst.
    std::size_t worst = 0;
    for (std::size_t i = 0; i < results.size(); ++i)
        if (results[i].of() > 0 && results[i].points() / results[i].of() <
                                       results[worst].points() / std::max(results[worst].of(), 1e-9))
            worst = i;
    for (std::size_t p = 0; p < properties.size(); ++p) {
        double points = 0;
        double figure = 0;
        int seen = 0;
        for (const Result& result : results)
            if (result.scores[p].of > 0) {
                points += result.scores[p].points;
                figure += result.scores[p].figure;
                ++seen;
            }
        const double of = seen == 0 ? 0 : properties[p].points;
        points = seen == 0 ? 0 : points / seen;
        std::string reason;
        for (std::size_t i = 0; i < results.size() && points < of && reason.empty(); ++i)
            if (results[i].scores[p].points < results[i].scores[p].of)
                reason = fmt::format("view {}: {}", i + 1, results[i].scores[p].reason);
        header["scores"].push_back({{"name", properties[p].name},
                                    {"figure", seen == 0 ? 0 : figure / seen},
                                    {"points", points},
                                    {"of", of},
                                    {"reason", reason}});
    }
    header["remarks"].push_back(
        fmt::format("drawn in {} views that were not shown before; the pictures are of view {}", views.size(),
                    worst + 1));
    const std::string reference = encodedSmall(results[worst].reference);
    const std::string submitted = encodedSmall(results[worst].submitted);
    const std::string errors = encodedSmall(errorMap(results[worst].errors));
    header["pictures"] = {submitted.size(), errors.size(), reference.size()};
    answer({"scored", std::move(header), submitted + errors + reference});
}

[[noreturn]] void doJob(const Setting& setting) {
    // The parent's end is this process' end too, whatever it is at.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // One process a core is kept busy by others like this one.
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    try {
        const std::optional<Message> job = receive(STDIN_FILENO);
        if (!job)
            _exit(2);
        if (job->kind == "look") {
            Look look(setting, job->header);
            limitProcess(setting.limits);
            closeSandbox();
            look.run();
        } else if (job->kind == "draw") {
            draw(setting, *job);
        }
        _exit(0);
    } catch (const std::bad_alloc&) {
        answer({"failed", {{"reason", "not enough memory"}}, {}});
    } catch (const EnvironmentError& e) {
        answer({"impossible", {{"reason", e.what()}}, {}});
    } catch (const std::exception& e) {
        answer({"failed", {{"reason", e.what()}}, {}});
    }
    _exit(0);
}

/// Loads what decodes pictures, so that the processes forked from this one have it.
void warmUp() {
    const Image8 dot(1, 1, 3, Encoding::srgb);
    const std::vector<unsigned char> bytes = encodedPng(dot, "dot");
    readImage8FromMemory(std::as_bytes(std::span(bytes)), "dot");
}

}  // namespace

int runWorker(std::span<const LabEntry> labs) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_DFL);
    // Nothing of the machine's or the user's is read or written by drivers.
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    const std::optional<Message> begin = receive(STDIN_FILENO);
    if (!begin || begin->kind != "begin")
        return static_cast<int>(ExitStatus::badInput);
    Setting setting;
    for (const LabEntry& entry : labs)
        if (entry.folder() == begin->header.at("lab").get<std::string>())
            setting.entry = &entry;
    if (setting.entry == nullptr)
        return static_cast<int>(ExitStatus::badInput);
    const std::unique_ptr<Lab> lab = setting.entry->make();
    setting.exercise = lab->exercise();
    setting.rubric = rubricFromText(begin->header.at("rubric").get<std::string>(), *setting.entry, *lab);
    setting.limits.cpuSeconds = begin->header.at("cpu_seconds").get<int>();
    setting.limits.memoryBytes = begin->header.at("memory_bytes").get<std::uint64_t>();
    warmUp();
    if (!send(STDOUT_FILENO, {"ready", Json::object(), {}}))
        return 0;
    while (true) {
        pollfd input{STDIN_FILENO, POLLIN, 0};
        if (poll(&input, 1, -1) < 0)
            continue;
        if ((input.revents & POLLIN) == 0)
            return 0;
        const pid_t child = fork();
        if (child == 0)
            doJob(setting);
        if (child < 0)
            return static_cast<int>(ExitStatus::notPossibleHere);
        int status = 0;
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
        if (WIFSIGNALED(status))
            return diedBySignal + WTERMSIG(status);
        if (WEXITSTATUS(status) != 0)
            return WEXITSTATUS(status);
        if (!send(STDOUT_FILENO, {"end", Json::object(), {}}))
            return 0;
    }
}

}  // namespace quincunx::grade

#include "grade/grade.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/paths.h"
#include "base/progress.h"
#include "grade/archive.h"
#include "grade/crew.h"
#include "grade/duplicates.h"
#include "grade/handout.h"
#include "grade/references.h"
#include "grade/worker.h"
#include "image/io.h"
#include "lab/json.h"

namespace quincunx::grade {
namespace {
namespace fs = std::filesystem;

constexpr std::uintmax_t maxJournalBytes = 64 << 20;

std::optional<std::size_t> numberIn(const char* variable) {
    const char* const text = std::getenv(variable);
    if (text == nullptr || *text == '\0')
        return {};
    std::size_t number = 0;
    const std::string_view digits(text);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size())
        throw InputError(fmt::format("\"{}\" is no number", printable(digits, 40)), variable,
                         "unset it, or let the batch system set it");
    return number;
}

std::optional<Shard> shardOf(std::size_t index, std::optional<std::size_t> count, const char* where) {
    if (!count || *count == 0 || index >= *count)
        throw InputError(fmt::format("shard {} of {}", index, count.value_or(0)), where,
                         "say how many shards there are");
    if (*count == 1)
        return {};
    return Shard{index, *count};
}

/// What was handed in, as the journal knows it again: names, sizes and times of files.
std::string fingerprintOf(const Submission& submission, const std::string& rubric) {
    std::string text = rubric;
    std::error_code error;
    for (const SubmittedFile& file : submission.files)
        text += fmt::format("{}\n{}\n{}\n", file.name, fs::file_size(file.file, error),
                            fs::last_write_time(file.file, error).time_since_epoch().count());
    for (const std::string& fault : submission.faults)
        text += fault + "\n";
    return digest(text);
}

Json classJson(const std::string& lab, const std::string& topic, const Rubric& rubric,
               const std::vector<Submission>& submissions) {
    Json list = Json::array();
    for (const Submission& submission : submissions)
        list.push_back({{"key", submission.key()}, {"student", submission.student}});
    return {{"lab", lab}, {"topic", topic}, {"rubric", Json::parse(rubric.text())}, {"submissions", list}};
}

/// A class in one ZIP, as Canvas exports it: its files are put beside the report.
fs::path unpackedClass(const fs::path& file, const fs::path& out) {
    constexpr std::uintmax_t most = std::uintmax_t{2} << 30;
    ArchiveLimits limits;
    limits.entries = 50000;
    limits.totalBytes = std::uint64_t{8} << 30;
    limits.depth = 0;
    const Unpacked unpacked = unpack(readFile(file, most), limits);
    const fs::path folder = out / "unpacked";
    std::error_code error;
    fs::remove_all(folder, error);
    for (const UnpackedFile& entry : unpacked.files)
        writeFile(folder / entry.name, entry.bytes);
    for (const std::string& fault : unpacked.faults)
        say(fmt::format("warning: {}: {}", printable(file.string()), printable(fault)));
    if (unpacked.files.empty())
        throw InputError("no submission in it", printable(file.string()),
                         "name a folder or a ZIP of submissions");
    return folder;
}

bool isClassArchive(const fs::path& place) {
    std::error_code error;
    return fs::is_regular_file(place, error) && lowerCaseExtension(place) == ".zip";
}

/// Grades one submission after the other with a worker of its own.
class Grader {
  public:
    Grader(const Options& options, const Rubric& rubric, const Exercise& exercise, ReferenceStore& references)
        : options_(options), rubric_(rubric), exercise_(exercise), references_(references) {
        solution_ = solutionOf(exercise);
        untouched_ = handoutOf(solution_, exercise.shader).text;
    }

    Record grade(const Submission& submission, Worker& worker) {
        Record record;
        record.key = submission.key();
        record.student = submission.student;
        record.id = submission.id;
        record.platform = submission.platform;
        record.late = submission.late;
        record.faults = submission.faults;
        if (submission.files.empty() && submission.faults.empty())
            record.faults.emplace_back("empty: no file in it");
        if (!submission.files.empty())
            look(submission, record, worker);
        return record;
    }

  private:
    static std::vector<std::string> texts(const Json& list) {
        std::vector<std::string> result;
        for (const Json& text : list)
            result.push_back(printable(text.get<std::string>(), 500));
        return result;
    }

    void look(const Submission& submission, Record& record, Worker& worker) {
        Json files = Json::array();
        for (const SubmittedFile& file : submission.files)
            files.push_back({{"path", file.file.string()}, {"name", file.name}});
        worker.begin({"look", {{"files", files}}, {}}, std::chrono::seconds(options_.secondsEach));
        const Message seen = next(worker);
        if (seen.kind != "seen") {
            record.faults.push_back(fmt::format("could not be looked at: {}", reasonOf(seen)));
            worker.finish();
            return;
        }
        for (std::string& fault : texts(seen.header.at("faults")))
            record.faults.push_back(std::move(fault));
        const std::vector<std::string> remarks = texts(seen.header.at("remarks"));
        if (const Json& picture = seen.header.at("picture"); picture.is_object())
            screenshot(picture, remarks, record, worker);
        worker.finish();
        if (const Json& shader = seen.header.at("shader"); shader.is_object())
            drawShader(shader.at("name").get<std::string>(), seen.blob, record, worker);
    }

    static Message next(Worker& worker) {
        Message message = worker.next();
        if (message.kind == "impossible")
            throw EnvironmentError(reasonOf(message));
        return message;
    }

    static std::string reasonOf(const Message& message) {
        return message.header.contains("reason") ? printable(message.header["reason"].get<std::string>(), 300)
                                                 : "nonsense";
    }

    void screenshot(const Json& picture, const std::vector<std::string>& remarks, Record& record,
                    Worker& worker) {
        Part part;
        part.kind = "screenshot";
        part.file = picture.at("name").get<std::string>();
        part.remarks = remarks;
        Claim claim{picture.at("width").get<int>(), picture.at("height").get<int>(), {}};
        if (picture.at("state").is_string())
            claim.state = picture.at("state").get<std::string>();
        const References references = references_.get(claim);
        for (const std::string& remark : references.remarks)
            part.remarks.push_back(remark);
        const Reference& reference = *references.pictures;
        Message message{"reference",
                        {{"width", reference.picture.width},
                         {"height", reference.picture.height},
                         {"without", Json::array()}},
                        {}};
        const auto append = [&](const Image8& image) {
            message.blob.append(reinterpret_cast<const char*>(image.data.data()), image.data.size());
        };
        append(reference.picture);
        for (const Image8& without : reference.without) {
            message.header["without"].push_back(!without.data.empty());
            append(without);
        }
        worker.send(message);
        const Message scored = next(worker);
        if (scored.kind != "scored") {
            record.faults.push_back(
                fmt::format("{}: could not be graded: {}", printable(part.file, 120), reasonOf(scored)));
            return;
        }
        fill(part, scored.header);
        part.exact = scored.header.at("exact").get<bool>();
        part.signature = scored.header.at("signature").get<std::string>();
        part.reference = fmt::format("reference-{}.png", references.key);
        writeReference(part.reference, reference.picture);
        writePictures(part, record.key, scored);
        record.parts.push_back(std::move(part));
    }

    void drawShader(const std::string& name, const std::string& text, Record& record, Worker& worker) {
        Part part;
        part.kind = "shader";
        part.file = name;
        record.shaderTokens = shaderTokens(text, {solution_, untouched_});
        worker.begin({"draw", {{"name", name}}, text}, std::chrono::seconds(options_.secondsEach));
        const Message scored = next(worker);
        if (scored.kind == "scored") {
            fill(part, scored.header);
            if (scored.header.contains("fault"))
                part.limits.emplace_back(0.0, printable(scored.header["fault"].get<std::string>(), 600));
            else
                writePictures(part, record.key, scored);
        } else {
            for (const Property& property : rubric_.shaderProperties)
                part.lines.push_back(
                    {property.name, 0, 0, property.points, "the shader did not come to an end"});
            part.limits.emplace_back(0.0, fmt::format("{}: {}", printable(name, 120), reasonOf(scored)));
        }
        worker.finish();
        record.parts.push_back(std::move(part));
    }

    static void fill(Part& part, const Json& scored) {
        for (const Json& score : scored.at("scores"))
            part.lines.push_back({score.at("name").get<std::string>(), score.at("figure").get<double>(),
                                  score.at("points").get<double>(), score.at("of").get<double>(),
                                  score.at("reason").get<std::string>()});
        for (const Json& limit : scored.at("limits"))
            part.limits.emplace_back(limit.at("share").get<double>(), limit.at("reason").get<std::string>());
        for (std::string& remark : texts(scored.at("remarks")))
            part.remarks.push_back(std::move(remark));
    }

    void writePictures(Part& part, const std::string& key, const Message& scored) {
        const auto sizes = scored.header.at("pictures").get<std::vector<std::size_t>>();
        std::string_view rest = scored.blob;
        const auto take = [&](std::size_t i, const char* what) {
            const std::string name = fmt::format("{}-{}-{}.png", key, part.kind, what);
            writeFile(options_.out / "pictures" / name, rest.substr(0, sizes.at(i)));
            rest.remove_prefix(std::min(sizes.at(i), rest.size()));
            return name;
        };
        part.submitted = take(0, "submitted");
        part.errors = take(1, "errors");
        if (sizes.size() > 2)
            part.reference = take(2, "reference");
    }

    void writeReference(const std::string& name, const Image8& picture) {
        const std::scoped_lock lock(mutex_);
        if (!written_.insert(name).second)
            return;
        const int longest = std::max(picture.width, picture.height);
        const bool large = longest > reportSide;
        writeImage(options_.out / "pictures" / name,
                   large ? resized(picture, std::max(1, picture.width * reportSide / longest),
                                   std::max(1, picture.height * reportSide / longest))
                         : picture);
    }

    const Options& options_;
    const Rubric& rubric_;
    const Exercise& exercise_;
    ReferenceStore& references_;
    std::string solution_;
    std::string untouched_;
    std::mutex mutex_;
    std::set<std::string> written_;
};

/// The records of a class, as far as they are there.
std::optional<Record> journalled(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error))
        return {};
    try {
        return parseRecord(readFile(file, maxJournalBytes), file.string());
    } catch (const InputError&) {
        return {};  // graded again
    }
}

std::size_t faultyAmong(const std::vector<Record>& records) {
    return static_cast<std::size_t>(std::count_if(records.begin(), records.end(), [](const Record& record) {
        return !record.faults.empty() || record.parts.empty();
    }));
}

Summary summaryOf(const std::vector<Record>& records, const fs::path& out) {
    Summary summary{
        .out = out, .submissions = records.size(), .faulty = faultyAmong(records), .points = pointsOfAll};
    for (const Record& record : records)
        summary.mean +=
            record.points(pointsOfAll) / static_cast<double>(std::max<std::size_t>(records.size(), 1));
    return summary;
}

}  // namespace

std::optional<Shard> shardFromEnvironment() {
    if (const auto task = numberIn("SLURM_ARRAY_TASK_ID")) {
        const std::size_t first = numberIn("SLURM_ARRAY_TASK_MIN").value_or(0);
        const std::size_t step = std::max<std::size_t>(numberIn("SLURM_ARRAY_TASK_STEP").value_or(1), 1);
        return shardOf(*task < first ? *task : (*task - first) / step, numberIn("SLURM_ARRAY_TASK_COUNT"),
                       "SLURM_ARRAY_TASK_COUNT");
    }
    if (const auto index = numberIn("JOB_COMPLETION_INDEX"))
        return shardOf(*index, numberIn("QUINCUNX_SHARDS"), "QUINCUNX_SHARDS");
    if (const auto index = numberIn("CI_NODE_INDEX"))
        return shardOf(*index == 0 ? std::size_t{1} << 40 : *index - 1, numberIn("CI_NODE_TOTAL"),
                       "CI_NODE_TOTAL");
    return {};
}

Summary gradeClass(const LabEntry& entry, const Options& given) {
    Options options = given;
    const std::unique_ptr<Lab> lab = entry.make();
    const Exercise exercise = lab->exercise();
    const Rubric rubric =
        options.rubric.empty() ? defaultRubric(entry, *lab) : readRubric(options.rubric, entry, *lab);
    const std::string rubricText = rubric.text();
    requireFolder(options.out / "journal");
    requireFolder(options.out / "pictures");
    const std::vector<Submission> all =
        takeIn(isClassArchive(options.submissions) ? unpackedClass(options.submissions, options.out)
                                                   : options.submissions);
    if (all.empty())
        throw InputError("no submission in it", printable(options.submissions.string()),
                         "name a folder of submissions");
    writeFile(options.out / "journal" / "class.json",
              dump(classJson(entry.folder(), lab->topic(), rubric, all)));

    const Shard shard = options.shard.value_or(Shard{});
    std::vector<const Submission*> mine;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % shard.count == shard.index)
            mine.push_back(&all[i]);
    std::vector<Record> records(mine.size());
    std::vector<std::size_t> todo;
    for (std::size_t i = 0; i < mine.size(); ++i) {
        const std::optional<Record> known = journalled(options.out / "journal" / (mine[i]->key() + ".json"));
        if (known && known->digest == fingerprintOf(*mine[i], rubricText))
            records[i] = *known;
        else
            todo.push_back(i);
    }

    if (options.worker.empty())
        options.worker = {executablePath().string(), "grade-worker"};
    ReferenceStore references(entry, rubric, options.backend);
    Grader grader(options, rubric, exercise, references);
    std::atomic<std::size_t> next = 0;
    std::size_t done = 0;
    std::mutex mutex;
    std::condition_variable changed;
    std::exception_ptr failure;
    std::atomic<bool> stopping = false;
    const auto work = [&] {
        try {
            Worker worker(options.worker, entry.folder(), rubricText, {.cpuSeconds = options.secondsEach});
            while (!stopping && !interrupted()) {
                const std::size_t i = next++;
                if (i >= todo.size())
                    break;
                const Submission& submission = *mine[todo[i]];
                Record record = grader.grade(submission, worker);
                record.digest = fingerprintOf(submission, rubricText);
                writeFile(options.out / "journal" / (record.key + ".json"), dump(toJson(record)));
                const std::scoped_lock lock(mutex);
                records[todo[i]] = std::move(record);
                ++done;
                changed.notify_all();
            }
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!failure)
                failure = std::current_exception();
            stopping = true;
            changed.notify_all();
        }
    };
    const std::size_t jobs = std::min<std::size_t>(
        todo.size(), options.jobs > 0 ? static_cast<std::size_t>(options.jobs)
                                      : std::max(1u, std::thread::hardware_concurrency()));
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < jobs; ++i)
            threads.emplace_back(work);
        Progress progress("grade", std::max<std::size_t>(todo.size(), 1));
        std::unique_lock lock(mutex);
        try {
            while (done < todo.size() && !stopping) {
                progress.update(done);
                changed.wait_for(lock, std::chrono::milliseconds(100));
            }
        } catch (...) {
            stopping = true;
            throw;
        }
    }
    if (failure)
        std::rethrow_exception(failure);
    throwIfInterrupted();

    Summary summary = summaryOf(records, options.out);
    summary.done = todo.size();
    summary.merged = shard.count == 1;
    if (summary.merged)
        writeOutputs({entry.folder(), lab->topic(), rubric, records}, options.out, options.anonymous);
    return summary;
}

Summary mergeShards(std::span<const fs::path> folders, const fs::path& out, bool anonymous) {
    QX_CHECK(!folders.empty());
    const auto classOf = [](const fs::path& folder) {
        return readFile(folder / "journal" / "class.json", maxJournalBytes);
    };
    const std::string text = classOf(folders.front());
    for (const fs::path& folder : folders)
        if (classOf(folder) != text)
            throw InputError("is of another class or rubric", printable(folder.string()),
                             "merge shards of one call");
    requireFolder(out / "journal");
    requireFolder(out / "pictures");
    const Json json = Json::parse(text, nullptr, false);
    Class graded;
    std::vector<std::string> missing;
    try {
        graded.lab = json.at("lab").get<std::string>();
        graded.topic = json.at("topic").get<std::string>();
        graded.rubric.title = json.at("rubric").at("title").get<std::string>();
        graded.rubric.lab = graded.lab;
        for (const Json& submission : json.at("submissions")) {
            const std::string key = submission.at("key").get<std::string>();
            const auto found = std::find_if(folders.begin(), folders.end(), [&](const fs::path& folder) {
                return journalled(folder / "journal" / (key + ".json")).has_value();
            });
            if (found == folders.end()) {
                missing.push_back(submission.at("student").get<std::string>());
                continue;
            }
            Record record = *journalled(*found / "journal" / (key + ".json"));
            if (!fs::equivalent(*found, out)) {
                writeFile(out / "journal" / (key + ".json"), dump(toJson(record)));
                for (const Part& part : record.parts)
                    for (const std::string& picture : {part.reference, part.submitted, part.errors})
                        if (!picture.empty())
                            writeFile(out / "pictures" / picture,
                                      readFile(*found / "pictures" / picture, maxJournalBytes));
            }
            graded.records.push_back(std::move(record));
        }
    } catch (const Json::exception& e) {
        throw InputError(printable(e.what(), 100), (folders.front() / "journal" / "class.json").string(),
                         "grade again");
    }
    if (!missing.empty())
        throw InputError(fmt::format("{} of {} submissions are not graded, {} the first", missing.size(),
                                     missing.size() + graded.records.size(), printable(missing.front(), 60)),
                         printable(folders.front().string()), "let the other shards finish, then merge");
    writeFile(out / "journal" / "class.json", text);
    Summary summary = summaryOf(graded.records, out);
    writeOutputs(graded, out, anonymous);
    return summary;
}

}  // namespace quincunx::grade

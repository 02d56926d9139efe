#include "grade/intake.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <regex>
#include <system_error>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"

namespace quincunx::grade {
namespace {
namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> platformNames = {"", "canvas", "moodle", "gradescope"};

/// Files that systems and editors leave everywhere.
bool isLitter(const std::string& name) {
    return name.empty() || name.front() == '.' || name == "__MACOSX" || name == "Thumbs.db" ||
           name == "desktop.ini";
}

/// Whose file or folder this is, by its name.
struct Owner {
    Submission submission;
    std::string fileName;  ///< what is left of a file's name
};

bool isNumber(std::string_view text) {
    return !text.empty() && text.size() <= 20 &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "doejane_LATE_4711_815_shadow.png": parts between '_', read with no regular expression, since names are
/// any bytes of any length.
std::optional<Owner> canvasOwner(const std::string& name) {
    std::vector<std::size_t> bars;
    for (std::size_t i = 0; i < name.size() && bars.size() < 8; ++i)
        if (name[i] == '_')
            bars.push_back(i);
    for (std::size_t first = 0; first + 2 < bars.size(); ++first) {
        const std::string user = name.substr(bars[first] + 1, bars[first + 1] - bars[first] - 1);
        const std::string attempt = name.substr(bars[first + 1] + 1, bars[first + 2] - bars[first + 1] - 1);
        if (!isNumber(user) || !isNumber(attempt) || bars[first] == 0)
            continue;
        Owner owner;
        std::string student = name.substr(0, bars[first]);
        constexpr std::string_view late = "_LATE";
        owner.submission.late = student.size() > late.size() && student.ends_with(late);
        if (owner.submission.late)
            student.resize(student.size() - late.size());
        owner.submission.student = student;
        owner.submission.id = user;
        owner.submission.platform = Platform::canvas;
        owner.fileName = name.substr(bars[first + 2] + 1);
        return owner;
    }
    return {};
}

std::optional<Owner> moodleOwner(const std::string& name) {
    const std::size_t mark = name.find("_assignsubmission_");
    if (mark == std::string::npos || mark == 0)
        return {};
    const std::size_t bar = name.rfind('_', mark - 1);
    if (bar == std::string::npos || bar == 0 ||
        !isNumber(std::string_view(name).substr(bar + 1, mark - bar - 1)))
        return {};
    Owner owner;
    owner.submission.student = name.substr(0, bar);
    owner.submission.id = name.substr(bar + 1, mark - bar - 1);
    owner.submission.platform = Platform::moodle;
    const std::size_t rest = name.find('_', mark + 18);
    owner.fileName = rest == std::string::npos ? std::string() : name.substr(rest + 1);
    return owner;
}

std::optional<Owner> gradescopeOwner(const std::string& name) {
    constexpr std::string_view prefix = "submission_";
    if (!name.starts_with(prefix) || !isNumber(std::string_view(name).substr(prefix.size())))
        return {};
    Owner owner;
    owner.submission.student = name;
    owner.submission.id = name.substr(prefix.size());
    owner.submission.platform = Platform::gradescope;
    return owner;
}

Owner ownerOf(const fs::path& path, bool isFolder) {
    const std::string name = path.filename().string();
    std::optional<Owner> owner = moodleOwner(name);
    if (!owner && isFolder)
        owner = gradescopeOwner(name);
    if (!owner && !isFolder)
        owner = canvasOwner(name);
    if (owner) {
        if (owner->fileName.empty())
            owner->fileName = name;
        return *owner;
    }
    Owner plain;
    plain.submission.student = isFolder ? name : path.stem().string();
    plain.fileName = name;
    return plain;
}

/// Students' names of a Gradescope export, by "submission_4711": lines of YAML as Gradescope writes them.
std::map<std::string, std::string> gradescopeNames(const fs::path& folder) {
    constexpr std::uintmax_t most = 16 << 20;
    const fs::path file = folder / "submission_metadata.yml";
    std::map<std::string, std::string> names;
    std::error_code error;
    if (!fs::is_regular_file(fs::symlink_status(file, error)))
        return names;
    const std::string text = readFile(file, most);
    std::string current;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string_view line(text.data() + begin, end - begin);
        begin = end + 1;
        if (line.ends_with('\r'))
            line.remove_suffix(1);
        if (line.starts_with("submission_") && line.ends_with(':')) {
            current = line.substr(0, line.size() - 1);
        } else if (const std::size_t mark = line.find(":name: ");
                   mark != std::string_view::npos && !current.empty()) {
            std::string_view name = line.substr(mark + 7);
            if (name.size() >= 2 && (name.front() == '\'' || name.front() == '"') &&
                name.back() == name.front())
                name = name.substr(1, name.size() - 2);
            std::string& known = names[current];
            known += (known.empty() ? "" : ", ") + std::string(name);
        }
    }
    return names;
}

std::vector<fs::path> sortedEntries(const fs::path& folder, std::size_t most, bool& tooMany) {
    std::vector<fs::path> entries;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entries.size() > most) {
            tooMany = true;
            break;
        }
        entries.push_back(entry.path());
    }
    std::sort(entries.begin(), entries.end(),
              [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
    return entries;
}

class FolderReader {
  public:
    FolderReader(Submission& submission, const IntakeLimits& limits)
        : submission_(submission), limits_(limits) {}

    void addFile(const fs::path& file, const std::string& name) {
        std::error_code error;
        const fs::file_status status = fs::symlink_status(file, error);
        if (fs::is_symlink(status))
            return fault(name, "refused: a link");
        if (fs::is_directory(status))
            return;
        if (!fs::is_regular_file(status))
            return fault(name, "refused: no regular file");
        if (submission_.files.size() >= limits_.files) {
            if (!full_)
                fault(name, fmt::format("and what follows: passed over, {} files are enough", limits_.files));
            full_ = true;
            return;
        }
        submission_.files.push_back({file, name});
    }

    void addFolder(const fs::path& folder, const std::string& prefix, int depth) {
        std::error_code error;
        if (fs::is_symlink(fs::symlink_status(folder, error)))
            return fault(prefix, "refused: a link");
        if (depth > limits_.depth)
            return fault(prefix, "passed over: folders too deep in each other");
        std::vector<fs::path> entries;
        bool tooMany = false;
        try {
            entries = sortedEntries(folder, 4 * limits_.files, tooMany);
        } catch (const fs::filesystem_error& e) {
            return fault(prefix, fmt::format("cannot be read: {}", e.code().message()));
        }
        if (tooMany)
            fault(prefix, fmt::format("holds more than {} files", 4 * limits_.files));
        for (const fs::path& entry : entries) {
            const std::string name = entry.filename().string();
            if (isLitter(name) || full_)
                continue;
            const std::string whole = prefix.empty() ? name : prefix + "/" + name;
            if (fs::is_directory(fs::symlink_status(entry, error)))
                addFolder(entry, whole, depth + 1);
            else
                addFile(entry, whole);
        }
    }

  private:
    void fault(const std::string& name, const std::string& what) {
        constexpr std::size_t most = 50;
        if (submission_.faults.size() < most)
            submission_.faults.push_back(
                fmt::format("{}: {}", name.empty() ? "folder" : printable(name, 120), what));
    }

    Submission& submission_;
    const IntakeLimits& limits_;
    bool full_ = false;
};

}  // namespace

std::string_view platformName(Platform platform) {
    return platformNames[static_cast<std::size_t>(platform)];
}

std::string digest(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash);
}

std::string Submission::key() const {
    return digest(fmt::format("{}\n{}\n{}", platformName(platform), id, student));
}

std::vector<Submission> takeIn(const fs::path& place, const IntakeLimits& limits) {
    std::error_code error;
    const fs::file_status status = fs::status(place, error);
    if (!fs::exists(status))
        throw InputError("no such file or folder", printable(place.string()), "check the name");
    const auto ordered = [](const Submission& a, const Submission& b) {
        return std::tie(a.student, a.id) < std::tie(b.student, b.id);
    };
    std::vector<Submission> result;
    if (fs::is_regular_file(status)) {
        Owner owner = ownerOf(place, false);
        FolderReader(owner.submission, limits).addFile(fs::canonical(place), owner.fileName);
        result.push_back(std::move(owner.submission));
        return result;
    }
    if (!fs::is_directory(status))
        throw InputError("is neither file nor folder", printable(place.string()),
                         "name a folder of submissions");
    bool tooMany = false;
    std::vector<fs::path> entries;
    std::map<std::string, std::string> names;
    try {
        entries = sortedEntries(place, 4 * limits.submissions, tooMany);
        names = gradescopeNames(place);
    } catch (const fs::filesystem_error& e) {
        throw InputError(e.code().message(), printable(place.string()), "check its permissions");
    }
    std::map<std::string, Submission> byKey;
    for (const fs::path& entry : entries) {
        const std::string name = entry.filename().string();
        if (isLitter(name) || name == "submission_metadata.yml")
            continue;
        const bool isFolder = fs::is_directory(fs::symlink_status(entry, error));
        Owner owner = ownerOf(entry, isFolder);
        std::string key = owner.submission.key();
        // Only platforms spread a student's work over several entries; others of one name are two students.
        if (owner.submission.platform == Platform::none && byKey.contains(key)) {
            owner.submission.student = name;
            key = owner.submission.key();
        }
        Submission& submission = byKey.try_emplace(key, owner.submission).first->second;
        submission.late = submission.late || owner.submission.late;
        if (isFolder)
            FolderReader(submission, limits).addFolder(entry, {}, 1);
        else
            FolderReader(submission, limits).addFile(entry, owner.fileName);
    }
    for (auto& [key, submission] : byKey)
        result.push_back(std::move(submission));
    // The names that Gradescope has apart are put in last: what is filed stays under its number.
    std::sort(result.begin(), result.end(), ordered);
    if (tooMany || result.size() > limits.submissions)
        throw InputError(fmt::format("more than {} submissions", limits.submissions),
                         printable(place.string()), "grade parts of the folder");
    for (Submission& submission : result)
        if (const auto found = names.find(submission.student); found != names.end())
            submission.student = found->second;
    std::sort(result.begin(), result.end(), ordered);
    return result;
}

}  // namespace quincunx::grade

#include "atlas/fingerprint.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "base/file.h"
#include "base/paths.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t mostSourceBytes = 16 << 20;
constexpr std::uintmax_t mostProgramBytes = std::uintmax_t{1} << 30;

/// Rooms of common/ that only show what others measure.
constexpr std::array<std::string_view, 3> showingRooms = {"web", "atlas", "cli"};

std::vector<fs::path> filesBelow(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, error), end; at != end && !error; at.increment(error))
        if (at->is_regular_file(error))
            files.push_back(at->path());
    std::sort(files.begin(), files.end());
    return files;
}

bool isSource(const fs::path& file) {
    const fs::path extension = file.extension();
    return extension == ".cpp" || extension == ".h" || extension == ".inc";
}

std::vector<fs::path> sourcesOf(const std::string& folder, const fs::path& root) {
    std::vector<fs::path> files = filesBelow(root / "labs" / folder);
    if (files.empty())
        return files;
    for (const fs::path& file : filesBelow(root / "common")) {
        const std::string room = file.lexically_relative(root / "common").begin()->string();
        if (std::find(showingRooms.begin(), showingRooms.end(), room) == showingRooms.end())
            files.push_back(file);
    }
    std::erase_if(files, [](const fs::path& file) { return !isSource(file); });
    return files;
}

void addFile(Digest& digest, const fs::path& file, const fs::path& root, std::uintmax_t mostBytes) {
    digest.add(file.lexically_relative(root).generic_string()).add(readFile(file, mostBytes));
}

}  // namespace

Digest& Digest::add(std::string_view text) {
    const auto byte = [&](unsigned char b) {
        value_ ^= b;
        value_ *= 0x100000001b3u;
    };
    for (std::size_t length = text.size(), i = 0; i < sizeof length; ++i)
        byte(static_cast<unsigned char>(length >> 8 * i));
    for (const char c : text)
        byte(static_cast<unsigned char>(c));
    return *this;
}

std::string Digest::text() const {
    return fmt::format("{:016x}", value_);
}

std::string labFingerprint(const std::string& folder, const KnobSet& knobs, const fs::path& root,
                           const fs::path& program) {
    Digest digest;
    const std::vector<fs::path> sources = sourcesOf(folder, root);
    std::error_code error;
    const fs::file_time_type made = fs::last_write_time(program, error);
    const bool current =
        !error && !sources.empty() && std::all_of(sources.begin(), sources.end(), [&](const fs::path& file) {
            std::error_code unread;
            return fs::last_write_time(file, unread) <= made && !unread;
        });
    if (current)
        for (const fs::path& file : sources)
            addFile(digest, file, root, mostSourceBytes);
    else
        digest.add(readFile(program, mostProgramBytes));
    for (const char* shaders : {"lib", "passes"})
        for (const fs::path& file : filesBelow(root / "shaders" / shaders))
            addFile(digest, file, root, mostSourceBytes);
    for (const fs::path& file : filesBelow(root / "shaders/labs" / folder))
        addFile(digest, file, root, mostSourceBytes);
    for (const Knob* knob : knobs.all())
        digest.add(knob->name()).add(knob->unit()).add(knob->allowed()).add(knob->defaultText());
    return digest.text();
}

std::string labFingerprint(const LabEntry& entry, Lab& lab) {
    return labFingerprint(entry.folder(), lab.knobs(), assetRoot(), executablePath());
}

}  // namespace quincunx::atlas

#include "grade/archive.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include "base/error.h"

namespace quincunx::grade {
namespace {

using Archive = std::unique_ptr<zip_t, decltype(&zip_discard)>;
using Entry = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

/// What is wrong with an entry's name; empty: nothing.
std::string nameFault(std::string_view name) {
    if (name.empty() || name.size() > 1000)
        return "a name that is empty or too long";
    if (std::any_of(name.begin(), name.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7F'; }))
        return "control characters in its name";
    if (name.front() == '/' || name.find('\\') != std::string_view::npos ||
        name.find(':') != std::string_view::npos)
        return "an absolute name";
    while (!name.empty()) {
        const std::size_t slash = std::min(name.find('/'), name.size());
        if (name.substr(0, slash) == "..")
            return "\"..\" in its name";
        name.remove_prefix(std::min(slash + 1, name.size()));
    }
    return {};
}

class Unpacker {
  public:
    explicit Unpacker(const ArchiveLimits& limits) : limits_(limits) {}

    void unpack(std::string_view bytes, const std::string& prefix, int depth) {
        zip_error_t error;
        zip_error_init(&error);
        zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
        zip_t* const opened =
            source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
        if (opened == nullptr) {
            fault(prefix,
                  fmt::format("the archive cannot be opened: {}", printable(zip_error_strerror(&error), 80)));
            if (source != nullptr)
                zip_source_free(source);
            zip_error_fini(&error);
            return;
        }
        zip_error_fini(&error);
        const Archive archive(opened, &zip_discard);
        const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
        for (zip_int64_t i = 0; i < count; ++i) {
            if (++entries_ > limits_.entries) {
                fault(prefix, fmt::format("{} entries, of which {} are looked at", count, i));
                return;
            }
            take(archive.get(), static_cast<zip_uint64_t>(i), prefix, depth);
        }
    }

    Unpacked result;

  private:
    void fault(const std::string& name, const std::string& what) {
        constexpr std::size_t most = 50;
        if (result.faults.size() < most)
            result.faults.push_back(
                fmt::format("{}: {}", name.empty() ? "archive" : printable(name, 120), what));
    }

    void take(zip_t* archive, zip_uint64_t index, const std::string& prefix, int depth) {
        zip_stat_t stat;
        zip_stat_init(&stat);
        constexpr zip_uint64_t needed = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE;
        if (zip_stat_index(archive, index, ZIP_FL_ENC_GUESS, &stat) != 0 || (stat.valid & needed) != needed) {
            fault(prefix, "a damaged entry");
            return;
        }
        const std::string name = stat.name;
        const std::string whole = prefix.empty() ? name : prefix + "/" + name;
        if (const std::string wrong = nameFault(name); !wrong.empty())
            return fault(whole, "refused: " + wrong);
        if (name.back() == '/')
            return;
        zip_uint8_t system = 0;
        zip_uint32_t attributes = 0;
        const bool known = zip_file_get_external_attributes(archive, index, 0, &system, &attributes) == 0;
        const mode_t kind = (attributes >> 16) & S_IFMT;
        if (known && system == ZIP_OPSYS_UNIX && kind != 0 && kind != S_IFREG)
            return fault(whole, kind == S_IFLNK ? "refused: a link" : "refused: no regular file");
        if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
            return fault(whole, "refused: encrypted");
        constexpr std::uint64_t harmless = 1 << 20;
        if (stat.size > limits_.entryBytes || totalBytes_ + stat.size > limits_.totalBytes)
            return fault(whole, fmt::format("refused: {} bytes unpacked", stat.size));
        if (stat.size > harmless &&
            static_cast<double>(stat.size) > limits_.ratio * static_cast<double>(stat.comp_size))
            return fault(whole, fmt::format("refused: {} bytes out of {}", stat.size, stat.comp_size));
        const Entry entry(zip_fopen_index(archive, index, 0), &zip_fclose);
        std::string bytes(entry ? stat.size : 0, '\0');
        const zip_int64_t got = entry ? zip_fread(entry.get(), bytes.data(), bytes.size()) : -1;
        char beyond = 0;
        const bool whole_ =
            got == static_cast<zip_int64_t>(bytes.size()) && zip_fread(entry.get(), &beyond, 1) == 0;
        if (!whole_)
            return fault(whole, "refused: damaged");
        totalBytes_ += bytes.size();
        if (isArchive(bytes)) {
            if (depth >= limits_.depth)
                return fault(whole, "refused: archives too deep in each other");
            return unpack(bytes, whole, depth + 1);
        }
        result.files.push_back({whole, std::move(bytes)});
    }

    ArchiveLimits limits_;
    std::size_t entries_ = 0;
    std::uint64_t totalBytes_ = 0;
};

}  // namespace

bool isArchive(std::string_view bytes) {
    return bytes.starts_with("PK\x03\x04") || bytes.starts_with(std::string_view("PK\x05\x06", 4));
}

Unpacked unpack(std::string_view bytes, const ArchiveLimits& limits) {
    Unpacker unpacker(limits);
    unpacker.unpack(bytes, {}, 1);
    return std::move(unpacker.result);
}

}  // namespace quincunx::grade

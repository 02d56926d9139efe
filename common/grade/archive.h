#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace quincunx::grade {

/// What is believed of an archive at most.
struct ArchiveLimits {
    std::size_t entries = 2000;
    std::uint64_t entryBytes = std::uint64_t{128} << 20;  ///< of one entry, unpacked
    std::uint64_t totalBytes = std::uint64_t{512} << 20;  ///< of all of them, unpacked
    double ratio = 200;                                   ///< unpacked to packed, of entries above 1 MiB
    int depth = 2;                                        ///< archives in archives; 1: none
};

struct UnpackedFile {
    std::string name;  ///< a relative path without "..", as in the archive
    std::string bytes;
};

struct Unpacked {
    std::vector<UnpackedFile> files;
    std::vector<std::string> faults;  ///< a line for each entry that was refused, and why
};

/// True for the first bytes of a ZIP.
bool isArchive(std::string_view bytes);

/// The regular files of a ZIP in memory. Refused, each with a fault: names with "..", absolute ones, ones
/// with control characters; links and devices; encrypted and damaged entries; what exceeds a limit. A file
/// that is no ZIP is one fault. Throws nothing but std::bad_alloc.
Unpacked unpack(std::string_view bytes, const ArchiveLimits& limits = {});

}  // namespace quincunx::grade

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace quincunx {

/// The whole file as bytes. Throws InputError naming the file if it is missing, not a regular file,
/// unreadable, or larger than `maxBytes`.
std::string readFile(const std::filesystem::path& file, std::uintmax_t maxBytes);

/// Makes the folder, and those it is in, if need be. Throws InputError if that fails or it cannot be written;
/// called before long work whose results go there.
void requireFolder(const std::filesystem::path& folder);

/// The extension with its dot, in lower case: ".png" for "a.PNG".
std::string lowerCaseExtension(const std::filesystem::path& file);

/// Calls `write` with the name of a new file in the same folder, then renames that to `file`: readers see
/// the old contents or the new, never a part. On any exception, or when interrupted, the new file is removed.
/// The temporary name keeps the extension of `file`. Throws InputError if the folder cannot be written, or if
/// `file` exists and is not a regular file: a device is never replaced.
void writeAtomically(const std::filesystem::path& file,
                     const std::function<void(const std::filesystem::path& temporary)>& write);

/// Writes `contents` to `file` by `writeAtomically`; a full disk is an InputError.
void writeFile(const std::filesystem::path& file, std::string_view contents);

}  // namespace quincunx

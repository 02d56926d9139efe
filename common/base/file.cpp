#include "base/file.h"

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/interrupt.h"

namespace quincunx {
namespace fs = std::filesystem;

namespace {

using FilePointer = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

}  // namespace

std::string lowerCaseExtension(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

std::string readFile(const fs::path& file, std::uintmax_t maxBytes) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status))
        throw InputError("no such file", file.string(), "check the name");
    if (!fs::is_regular_file(status))
        throw InputError("not a regular file", file.string(), "name a file");
    const std::uintmax_t size = fs::file_size(file, error);
    if (error)
        throw InputError(error.message(), file.string());
    if (size > maxBytes)
        throw InputError(fmt::format("{} bytes, more than the {} allowed", size, maxBytes), file.string(),
                         "use a smaller file");
    const FilePointer stream(std::fopen(file.c_str(), "rb"), &std::fclose);
    if (!stream)
        throw InputError(std::strerror(errno), file.string(), "check its permissions");
    std::string contents(size, '\0');
    contents.resize(std::fread(contents.data(), 1, contents.size(), stream.get()));
    if (std::ferror(stream.get()))
        throw InputError("cannot be read", file.string());
    return contents;
}

void requireFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw InputError(fmt::format("cannot make the folder: {}", error.message()), folder.string(),
                         "choose another place with --out");
    if (!fs::is_directory(folder, error))
        throw InputError("is no folder", folder.string(), "choose another place with --out");
    if (access(folder.c_str(), W_OK) != 0)
        throw InputError(fmt::format("the folder cannot be written: {}", std::strerror(errno)),
                         folder.string(), "choose another place with --out");
}

void writeAtomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
    std::error_code error;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    requireFolder(folder);
    if (const fs::file_status status = fs::status(file, error);
        fs::exists(status) && !fs::is_regular_file(status))
        throw InputError(fs::is_directory(status) ? "is a folder" : "is no regular file", file.string(),
                         "name another file");
    const fs::path temporary =
        folder / fmt::format(".{}.{}{}", file.stem().string(), getpid(), file.extension().string());
    try {
        write(temporary);
        throwIfInterrupted();
        fs::rename(temporary, file);
    } catch (const fs::filesystem_error& e) {
        fs::remove(temporary, error);
        throw InputError(e.code().message(), file.string(), "choose another place with --out");
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
}

void writeFile(const fs::path& file, std::string_view contents) {
    writeAtomically(file, [&](const fs::path& temporary) {
        FilePointer stream(std::fopen(temporary.c_str(), "wb"), &std::fclose);
        const bool written =
            stream && std::fwrite(contents.data(), 1, contents.size(), stream.get()) == contents.size() &&
            std::fflush(stream.get()) == 0;
        if (!written)
            throw InputError(std::strerror(errno), file.string(), "choose another place with --out");
    });
}

}  // namespace quincunx

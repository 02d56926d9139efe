#include "atlas/store.h"

#include <system_error>

#include "base/error.h"
#include "base/file.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t mostBytes = 64 << 20;

/// A name that stays inside the folder, whatever the file says.
bool isInside(const std::string& name) {
    const fs::path path = fs::path(name).lexically_normal();
    return !name.empty() && path.is_relative() && *path.begin() != "..";
}

}  // namespace

fs::path Store::fileOf(const std::string& name) const {
    return folder_ / "data" / (name + ".json");
}

bool Store::read(const std::string& name, const std::string& madeOf, Json& result) const {
    std::error_code error;
    if (!fs::is_regular_file(fileOf(name), error))
        return false;
    Json piece = Json::parse(readFile(fileOf(name), mostBytes), nullptr, false);
    if (!piece.is_object() || !piece.contains("result") || !piece.contains("files") ||
        !piece["files"].is_array() || piece.value("made_of", Json()) != madeOf)
        return false;
    for (const Json& file : piece["files"])
        if (!file.is_string() || !isInside(file.get<std::string>()) ||
            !fs::is_regular_file(folder_ / file.get<std::string>(), error))
            return false;
    result = std::move(piece["result"]);
    return true;
}

bool Store::has(const std::string& name, const std::string& madeOf) const {
    Json unused;
    return read(name, madeOf, unused);
}

Json Store::get(const std::string& name, const std::string& madeOf, const std::function<Piece()>& make) {
    Json result;
    if (read(name, madeOf, result))
        return result;
    Piece piece = make();
    writeFile(fileOf(name),
              dump({{"made_of", madeOf}, {"files", piece.files}, {"result", std::move(piece.result)}}));
    ++made_;
    // As the next call will read it: figures that are not finite are null.
    if (!read(name, madeOf, result))
        throw InputError("was changed while the atlas was made", fileOf(name).string(), "call it again");
    return result;
}

}  // namespace quincunx::atlas

#include "gl/shader_source.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "base/paths.h"

namespace quincunx::gl {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t maxTotalBytes = std::size_t{4} << 20;
constexpr std::size_t maxDepth = 32;
constexpr std::string_view versionLine = "#version 330 core";

/// All shaders, where they are kept in memory.
struct KeptShaders {
    fs::path assets;                            ///< assetRoot() as it was
    std::map<fs::path, std::string> texts;      ///< by whole name
    std::map<fs::path, std::uint64_t> changes;  ///< how often each was replaced
};

std::optional<KeptShaders>& keptShaders() {
    static std::optional<KeptShaders> kept;
    return kept;
}

fs::path assets() {
    return keptShaders() ? keptShaders()->assets : assetRoot();
}

fs::path shaderRoot() {
    return assets() / "shaders";
}

bool shaderExists(const fs::path& file) {
    std::error_code error;
    return keptShaders() ? keptShaders()->texts.contains(file.lexically_normal()) : fs::exists(file, error);
}

std::string_view trim(std::string_view text) {
    const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && isSpace(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && isSpace(text.back()))
        text.remove_suffix(1);
    return text;
}

bool isWordStart(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool isWordPart(char c) {
    return isWordStart(c) || (c >= '0' && c <= '9');
}

/// The line with comments replaced by a space each; `inBlock` carries a block comment to the next line.
std::string withoutComments(std::string_view line, bool& inBlock) {
    std::string code;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const std::string_view rest = line.substr(i);
        if (inBlock) {
            if (rest.starts_with("*/")) {
                inBlock = false;
                ++i;
            }
        } else if (rest.starts_with("//")) {
            break;
        } else if (rest.starts_with("/*")) {
            inBlock = true;
            code += ' ';
            ++i;
        } else {
            code += line[i];
        }
    }
    return code;
}

struct Directive {
    std::string_view name;  ///< empty when the line is none
    std::string_view argument;
};

Directive directiveOf(std::string_view code) {
    code = trim(code);
    if (!code.starts_with('#'))
        return {};
    code = trim(code.substr(1));
    const auto end = std::find_if_not(code.begin(), code.end(), isWordPart);
    const auto length = static_cast<std::size_t>(end - code.begin());
    return {code.substr(0, length), trim(code.substr(length))};
}

bool escapes(const fs::path& relative) {
    const fs::path normal = relative.lexically_normal();
    return normal.is_absolute() || (!normal.empty() && *normal.begin() == "..");
}

/// Joins a file and what it includes.
class Loader {
  public:
    Loader(fs::path root, std::vector<FileStamp>& visited) : root_(std::move(root)), visited_(visited) {}

    ShaderSource load(const fs::path& file, const std::vector<std::pair<std::string, std::string>>& defines) {
        addFile(file, detail::displayName(file), &defines);
        return std::move(source_);
    }

  private:
    /// `includedAt`: where to put the blame if the file cannot be read. `defines`: not null for the main
    /// file.
    void addFile(const fs::path& file, const std::string& includedAt,
                 const std::vector<std::pair<std::string, std::string>>* defines) {
        visited_.push_back(detail::stampOf(file));
        const std::string contents = read(file, includedAt);
        if (totalBytes_ += contents.size(); totalBytes_ > maxTotalBytes)
            throw ShaderError(
                fmt::format("with what it includes larger than {} MiB in all", maxTotalBytes >> 20),
                includedAt);
        const std::size_t number = source_.files.size();
        source_.files.push_back(file);
        identities_.insert(identity(file));
        open_.push_back(file);

        std::string_view rest = contents;
        if (rest.starts_with("\xef\xbb\xbf"))
            rest.remove_prefix(3);
        bool inBlock = false;
        std::size_t conditions = 0;
        std::size_t line = 0;
        while (!rest.empty()) {
            ++line;
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            std::string_view text = rest.substr(0, end);
            rest.remove_prefix(std::min(end + 1, rest.size()));
            if (text.ends_with('\r'))
                text.remove_suffix(1);
            const std::string where = place(file, line);
            if (text.find('\0') != std::string_view::npos)
                throw ShaderError("has a zero byte", where, "save it as text");
            const std::string code = withoutComments(text, inBlock);
            const Directive directive = directiveOf(code);
            if (line == 1 && defines != nullptr) {
                beginMain(code, where, *defines);
                continue;
            }
            if (directive.name == "version")
                throw ShaderError("#version is for the first line of the main file", where, "delete it");
            if (directive.name == "line")
                throw ShaderError("#line would hide where a fault is", where, "delete it");
            if (directive.name == "if" || directive.name == "ifdef" || directive.name == "ifndef")
                ++conditions;
            if (directive.name == "endif" && conditions > 0)
                --conditions;
            if (directive.name == "include") {
                if (conditions > 0)
                    throw ShaderError("#include inside #if", where,
                                      "move it out: a file is included once anyway");
                include(file, directive.argument, where);
            } else {
                addLine(text, number, line);
            }
        }
        if (line == 0 && defines != nullptr)
            beginMain("", place(file, 1), *defines);
        open_.pop_back();
    }

    void beginMain(std::string_view code, const std::string& where,
                   const std::vector<std::pair<std::string, std::string>>& defines) {
        if (trim(code) != versionLine)
            throw ShaderError(fmt::format("the first line is not {}", versionLine), where,
                              "make it so: the labs use OpenGL 3.3 core");
        addLine(versionLine, 0, 1);
        for (const auto& [name, value] : defines) {
            if (name.empty() || !isWordStart(name[0]) || !std::all_of(name.begin(), name.end(), isWordPart) ||
                value.find_first_of("\n\r\\") != std::string::npos)
                throw ShaderError(fmt::format("\"{}\" cannot be defined as \"{}\"", printable(name, 60),
                                              printable(value, 60)),
                                  where);
            addLine(fmt::format("#define {} {}", name, value), 0, 1);
        }
    }

    void addLine(std::string_view text, std::size_t file, std::size_t line) {
        source_.text += text;
        source_.text += '\n';
        source_.lines.push_back({file, line});
    }

    void include(const fs::path& from, std::string_view argument, const std::string& where) {
        const bool isQuoted = argument.size() > 2 && argument.front() == '"' && argument.back() == '"' &&
                              std::count(argument.begin(), argument.end(), '"') == 2;
        if (!isQuoted)
            throw ShaderError("malformed #include", where, "write #include \"path/from/shaders.glsl\"");
        const fs::path name(argument.substr(1, argument.size() - 2));
        const fs::path beside = from.parent_path() / name;
        if (name.is_absolute() || (escapes(name) && escapes(beside.lexically_relative(root_))))
            throw ShaderError(
                fmt::format("#include \"{}\" is outside shaders/", printable(name.string(), 100)), where,
                "move the file into shaders/");
        const fs::path file = find(beside, root_ / name);
        if (file.empty())
            throw ShaderError(fmt::format("#include \"{}\": no such file", printable(name.string(), 100)),
                              where, "name it relative to this file or to shaders/");
        const fs::path id = identity(file);
        const auto again = std::find_if(open_.begin(), open_.end(),
                                        [&](const fs::path& other) { return identity(other) == id; });
        if (again != open_.end()) {
            std::string chain;
            for (auto link = again; link != open_.end(); ++link)
                chain += detail::displayName(*link) + " includes ";
            throw ShaderError(fmt::format("#include cycle: {}{}", chain, detail::displayName(file)), where,
                              "move what both need into a third file");
        }
        if (identities_.contains(id))
            return;
        if (open_.size() >= maxDepth)
            throw ShaderError(fmt::format("#include deeper than {} files", maxDepth), where);
        addFile(file, where, nullptr);
    }

    /// The first of the two that exists; both are watched, as either may appear.
    fs::path find(const fs::path& beside, const fs::path& fromRoot) {
        for (const fs::path& candidate : {beside.lexically_normal(), fromRoot.lexically_normal()}) {
            if (shaderExists(candidate))
                return candidate;
            visited_.push_back(detail::stampOf(candidate));
        }
        return {};
    }

    static std::string read(const fs::path& file, const std::string& includedAt) {
        if (keptShaders()) {
            const auto found = keptShaders()->texts.find(file.lexically_normal());
            if (found == keptShaders()->texts.end())
                throw ShaderError("no such shader", includedAt, "check the name");
            return found->second;
        }
        try {
            return readFile(file, maxTotalBytes);
        } catch (const InputError& error) {
            const std::string what = error.what();
            const std::string name = detail::displayName(file);
            throw ShaderError(
                includedAt == name ? what.substr(std::min(what.size(), file.string().size() + 2)) : what,
                includedAt);
        }
    }

    static fs::path identity(const fs::path& file) {
        if (keptShaders())
            return file.lexically_normal();
        std::error_code error;
        fs::path canonical = fs::canonical(file, error);
        return error ? file.lexically_normal() : canonical;
    }

    static std::string place(const fs::path& file, std::size_t line) {
        return fmt::format("{}:{}", detail::displayName(file), line);
    }

    fs::path root_;
    std::vector<FileStamp>& visited_;
    ShaderSource source_;
    std::set<fs::path> identities_;
    std::vector<fs::path> open_;
    std::size_t totalBytes_ = 0;
};

std::optional<std::size_t> takeNumber(std::string_view& text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc())
        return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix))
        return false;
    text.remove_prefix(prefix.size());
    return true;
}

struct Place {
    std::size_t file = 0;
    std::size_t line = 0;
    std::string severity;   ///< empty when the message itself says it
    std::string_view rest;  ///< the message
};

std::optional<Place> placeOf(std::string_view line) {
    Place place;
    if (take(line, "ERROR: "))
        place.severity = "error: ";
    else if (take(line, "WARNING: "))
        place.severity = "warning: ";
    const auto file = takeNumber(line);
    if (!file)
        return std::nullopt;
    std::optional<std::size_t> row;
    if (take(line, ":")) {
        row = takeNumber(line);
        if (row && take(line, "(") && !(takeNumber(line) && take(line, ")")))
            return std::nullopt;
    } else if (take(line, "(")) {
        row = takeNumber(line);
        if (!row || !take(line, ")"))
            return std::nullopt;
    }
    line = trim(line);
    if (!row || !take(line, ":"))
        return std::nullopt;
    place.file = *file;
    place.line = *row;
    place.rest = trim(line);
    return place;
}

}  // namespace

void keepShadersInMemory() {
    KeptShaders kept;
    kept.assets = assetRoot();
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kept.assets / "shaders"))
        if (entry.is_regular_file())
            kept.texts[entry.path().lexically_normal()] = readFile(entry.path(), maxTotalBytes);
    for (const auto& [file, text] : kept.texts)
        kept.changes[file] = 0;
    keptShaders() = std::move(kept);
}

void replaceKeptShader(const std::string& name, std::string text) {
    QX_CHECK(keptShaders().has_value());
    const fs::path file = (shaderRoot() / name).lexically_normal();
    keptShaders()->texts[file] = std::move(text);
    ++keptShaders()->changes[file];
}

FileStamp detail::stampOf(const fs::path& file) {
    if (keptShaders()) {
        const fs::path name = file.lexically_normal();
        const auto found = keptShaders()->texts.find(name);
        if (found == keptShaders()->texts.end())
            return {.file = file};
        return {.file = file,
                .time = fs::file_time_type(fs::file_time_type::duration(keptShaders()->changes[name])),
                .size = found->second.size()};
    }
    std::error_code error;
    FileStamp stamp{.file = file};
    const auto size = fs::file_size(file, error);
    if (!error)
        stamp.size = size;
    const auto time = fs::last_write_time(file, error);
    if (!error)
        stamp.time = time;
    return stamp;
}

std::string detail::displayName(const fs::path& file) {
    const fs::path relative = file.lexically_relative(assets());
    return relative.empty() || *relative.begin() == ".." ? file.string() : relative.string();
}

std::vector<std::string> detail::identifiers(std::string_view text) {
    std::set<std::string, std::less<>> words;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!isWordPart(text[i]))
            continue;
        const std::size_t start = i;
        while (i < text.size() && isWordPart(text[i]))
            ++i;
        const std::string_view word = text.substr(start, i - start);
        if (isWordStart(word[0]) && !words.contains(word))
            words.emplace(word);
    }
    return {words.begin(), words.end()};
}

std::string detail::firstError(std::string_view log) {
    std::vector<std::string_view> lines;
    while (!log.empty()) {
        const std::size_t end = std::min(log.find('\n'), log.size());
        if (const std::string_view line = trim(log.substr(0, end)); !line.empty())
            lines.push_back(line);
        log.remove_prefix(std::min(end + 1, log.size()));
    }
    const auto isError = [](std::string_view line) { return line.find("error") != std::string_view::npos; };
    const auto first = std::find_if(lines.begin(), lines.end(), isError);
    if (first == lines.end())
        return lines.empty() ? "the driver does not say why" : printable(lines[0], 500);
    const auto more = std::count_if(first + 1, lines.end(), isError);
    return printable(*first, 500) + (more == 0 ? "" : fmt::format(" (and {} more)", more));
}

ShaderSource detail::loadShader(const fs::path& file,
                                const std::vector<std::pair<std::string, std::string>>& defines,
                                std::vector<FileStamp>& visited) {
    const fs::path root = shaderRoot();
    return Loader(root, visited).load((root / file).lexically_normal(), defines);
}

ShaderSource loadShader(const fs::path& file,
                        const std::vector<std::pair<std::string, std::string>>& defines) {
    std::vector<FileStamp> visited;
    return detail::loadShader(file, defines, visited);
}

std::string authorsLog(std::string_view driverLog, const ShaderSource& source) {
    std::string log;
    while (!driverLog.empty()) {
        const std::size_t end =
            std::min(driverLog.find_first_of(std::string_view("\n\0", 2)), driverLog.size());
        const std::string_view line = driverLog.substr(0, end);
        const std::optional<Place> place = placeOf(line);
        if (place && place->file == 0 && place->line >= 1 && place->line <= source.lines.size()) {
            const ShaderSource::Origin& origin = source.lines[place->line - 1];
            log += fmt::format("{}:{}: {}{}", detail::displayName(source.files[origin.file]), origin.line,
                               place->severity, place->rest);
        } else {
            log += line;
        }
        if (end < driverLog.size())
            log += '\n';
        driverLog.remove_prefix(std::min(end + 1, driverLog.size()));
    }
    return log;
}

}  // namespace quincunx::gl

#include "base/error.h"

#include <cstdio>

#include <fmt/format.h>

namespace quincunx {
namespace {

std::string oneLine(std::string_view what, std::string_view where, std::string_view remedy) {
    std::string line;
    if (!where.empty())
        line += fmt::format("{}: ", printable(where));
    line += what;
    if (!remedy.empty())
        line += fmt::format("; {}", remedy);
    return line;
}

}  // namespace

Error::Error(std::string_view what, std::string_view where, std::string_view remedy)
    : std::runtime_error(oneLine(what, where, remedy)) {}

void say(const std::string& line) noexcept {
    std::fputs(line.c_str(), stderr);
    std::fputc('\n', stderr);
}

std::string printable(std::string_view text, std::size_t maxLength) {
    std::string result;
    for (const char c : text) {
        if (result.size() >= maxLength)
            return result + "...";
        if (c == '\n')
            result += "\\n";
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else
            result += c;
    }
    return result;
}

}  // namespace quincunx

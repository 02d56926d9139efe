#include "atlas/readme.h"

#include <cctype>

#include <fmt/format.h>

#include "web/page.h"

namespace quincunx::atlas {
namespace {

/// What stands between `open` at `at` and the next `close`; nothing if there is none. Moves `at` behind it.
bool between(std::string_view text, std::size_t& at, std::string_view open, std::string_view close,
             std::string_view& inside) {
    if (!text.substr(at).starts_with(open))
        return false;
    const std::size_t start = at + open.size();
    const std::size_t end = text.find(close, start);
    if (end == std::string_view::npos || end == start)
        return false;
    inside = text.substr(start, end - start);
    at = end + close.size();
    return true;
}

bool linkAt(std::string_view text, std::size_t& at, std::string_view& label, std::string_view& target) {
    std::size_t end = at;
    if (!between(text, end, "[", "](", label))
        return false;
    const std::size_t close = text.find(')', end);
    if (close == std::string_view::npos)
        return false;
    target = text.substr(end, close - end);
    at = close + 1;
    return true;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0)
        text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0)
        text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> linesOf(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

/// The cells of a table's row; "\|" does not end one.
std::vector<std::string> cellsOf(std::string_view row) {
    std::vector<std::string> cells(1);
    for (std::size_t i = 1; i < row.size(); ++i)
        if (row[i] == '|' && row[i - 1] != '\\')
            cells.emplace_back();
        else
            cells.back() += row[i];
    for (std::string& cell : cells)
        cell = std::string(trimmed(cell));
    if (cells.back().empty())
        cells.pop_back();
    return cells;
}

bool isNumbered(std::string_view line) {
    std::size_t digits = 0;
    while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])) != 0)
        ++digits;
    return digits > 0 && line.substr(digits).starts_with(". ");
}

}  // namespace

std::string inlineHtml(std::string_view markdown,
                       const std::function<std::string(const std::string&)>& link) {
    std::string html;
    std::string plain;
    const auto flush = [&] {
        html += web::escaped(plain);
        plain.clear();
    };
    for (std::size_t at = 0; at < markdown.size();) {
        std::string_view inside;
        std::string_view target;
        if (markdown.substr(at).starts_with("\\|")) {
            plain += '|';
            at += 2;
        } else if (between(markdown, at, "`", "`", inside)) {
            flush();
            std::string code(inside);
            for (std::size_t bar; (bar = code.find("\\|")) != std::string::npos;)
                code.erase(bar, 1);
            html += "<code>" + web::escaped(code) + "</code>";
        } else if (between(markdown, at, "**", "**", inside)) {
            flush();
            html += "<b>" + inlineHtml(inside, link) + "</b>";
        } else if (between(markdown, at, "*", "*", inside)) {
            flush();
            html += "<em>" + inlineHtml(inside, link) + "</em>";
        } else if (linkAt(markdown, at, inside, target)) {
            flush();
            const std::string href = link(std::string(target));
            const std::string text = inlineHtml(inside, link);
            html += href.empty() ? text : fmt::format("<a href=\"{}\">{}</a>", web::escaped(href), text);
        } else {
            plain += markdown[at++];
        }
    }
    flush();
    return html;
}

std::vector<std::string> linkTargets(std::string_view markdown) {
    std::vector<std::string> targets;
    inlineHtml(markdown, [&](const std::string& target) {
        targets.push_back(target);
        return std::string();
    });
    return targets;
}

Readme parseReadme(std::string_view text) {
    Readme readme;
    std::string heading;
    bool introEnded = false;
    std::string* open = nullptr;  // an item or a paragraph that the next line may go on with
    for (const std::string_view line : linesOf(text)) {
        const std::string_view words = trimmed(line);
        if (words.starts_with('#')) {
            introEnded = introEnded || words.starts_with("##");
            heading = words;
            open = nullptr;
        } else if (heading.starts_with("## Read") && isNumbered(words)) {
            readme.reading.emplace_back(trimmed(words.substr(words.find(' '))));
            open = &readme.reading.back();
        } else if (heading.starts_with("## Try") && words.starts_with('|')) {
            const std::vector<std::string> cells = cellsOf(words);
            if (cells.size() == 2 && cells[0] != "do" &&
                cells[0].find_first_not_of("-: ") != std::string::npos)
                readme.tries.emplace_back(cells[0], cells[1]);
        } else if (words.empty() || words.starts_with("![") || words.starts_with("```")) {
            introEnded = introEnded || !readme.intro.empty();
            open = nullptr;
        } else if (open != nullptr) {
            *open += ' ';
            *open += words;
        } else if (!introEnded) {
            readme.intro = words;
            open = &readme.intro;
        }
    }
    return readme;
}

}  // namespace quincunx::atlas

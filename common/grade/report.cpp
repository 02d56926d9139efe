#include "grade/report.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/file.h"

namespace quincunx::grade {
namespace {
namespace fs = std::filesystem;

constexpr double pointsOfAll = 100;

/// Text in HTML and in quoted attributes. Control characters and bytes that are no UTF-8 become U+FFFD.
std::string escaped(std::string_view text) {
    std::string html;
    const auto isContinuation = [&](std::size_t i) {
        return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '&') {
            html += "&amp;";
        } else if (c == '<') {
            html += "&lt;";
        } else if (c == '>') {
            html += "&gt;";
        } else if (c == '"') {
            html += "&quot;";
        } else if (c == '\'') {
            html += "&#39;";
        } else if (c < 0x80) {
            html += c < 0x20 || c == 0x7F ? "\uFFFD" : std::string(1, text[i]);
        } else {
            const std::size_t length = c >= 0xC2 && c < 0xE0 ? 2 : c >= 0xE0 && c < 0xF0 ? 3 : c >= 0xF0 && c < 0xF5 ? 4 : 0;
            bool whole = length > 0;
            for (std::size_t k = 1; k < length; ++k)
                whole = whole && isContinuation(i + k);
            html += whole ? std::string(text.substr(i, length)) : "\uFFFD";
            i += whole ? length - 1 : 0;
        }
    }
    return html;
}

constexpr std::string_view style = R"(
:root { color-scheme: light dark; --ground: #fbfaf7; --ink: #22211f; --soft: #6d6a64; --line: #dedad2; --good: #2c7a57; --middle: #b07d1a; --bad: #b3402f; --accent: #3d5a8a; }
@media (prefers-color-scheme: dark) { :root { --ground: #1b1b1d; --ink: #e8e6e1; --soft: #a09c94; --line: #38373a; --good: #6cc39b; --middle: #dcae55; --bad: #e5806f; --accent: #9ab5e2; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--ground); margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 70rem; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 0 0 .3rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .6rem; }
p, ul { max-width: 46rem; } a { color: var(--accent); } .soft { color: var(--soft); }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .35rem .7rem .35rem 0; border-bottom: 1px solid var(--line); vertical-align: top; overflow-wrap: anywhere; }
th button { font: inherit; font-weight: 600; color: inherit; background: none; border: 0; padding: 0; cursor: pointer; }
th[aria-sort=ascending] button::after { content: " ↑"; } th[aria-sort=descending] button::after { content: " ↓"; }
td.number, th.number { text-align: right; white-space: nowrap; }
.good { color: var(--good); } .middle { color: var(--middle); } .bad { color: var(--bad); }
.bars { display: flex; align-items: flex-end; gap: 4px; height: 9rem; max-width: 40rem; margin: 1rem 0 .2rem; }
.bars div { flex: 1; background: var(--accent); min-height: 1px; position: relative; } .bars span { position: absolute; top: -1.4em; width: 100%; text-align: center; font-size: .8rem; }
.scale { display: flex; max-width: 40rem; font-size: .8rem; color: var(--soft); } .scale span { flex: 1; text-align: center; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(18rem, 1fr)); gap: 1.2rem; margin: 1rem 0; }
figure { margin: 0; } img { width: 100%; height: auto; display: block; image-rendering: auto; } figcaption { font-size: .85rem; color: var(--soft); margin-top: .3rem; }
.slider { position: relative; } .slider .over { position: absolute; inset: 0; overflow: hidden; border-right: 2px solid #fff; width: 50%; }
.slider .over img { width: auto; height: 100%; max-width: none; } input[type=range] { width: 100%; }
)";

std::string page(const std::string& title, const std::string& body) {
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
                       "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src 'self' file: data:; "
                       "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
                       "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
                       escaped(title), style, body);
}

const char* classOf(double points) {
    return points >= 0.85 * pointsOfAll ? "good" : points >= 0.5 * pointsOfAll ? "middle" : "bad";
}

std::string distribution(const std::vector<Record>& records) {
    std::array<std::size_t, 10> bins{};
    for (const Record& record : records)
        ++bins[std::min<std::size_t>(9, static_cast<std::size_t>(record.points(pointsOfAll) / 10))];
    const std::size_t most = std::max<std::size_t>(1, *std::max_element(bins.begin(), bins.end()));
    std::string bars;
    std::string scale;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        bars += fmt::format("<div style=\"height:{:.1f}%\"><span>{}</span></div>", 100.0 * static_cast<double>(bins[i]) / static_cast<double>(most),
                            bins[i] > 0 ? std::to_string(bins[i]) : "");
        scale += fmt::format("<span>{}–{}</span>", 10 * i, 10 * (i + 1));
    }
    return fmt::format("<h2>Distribution</h2>\n<div class=\"bars\" role=\"img\" aria-label=\"Submissions by points\">{}</div>\n<div class=\"scale\">{}</div>\n", bars, scale);
}

constexpr std::string_view sorting = R"(<script>
for (const header of document.querySelectorAll("th")) header.querySelector("button").onclick = () => {
  const up = header.getAttribute("aria-sort") !== "ascending", column = header.cellIndex, body = document.querySelector("tbody");
  for (const other of document.querySelectorAll("th")) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", up ? "ascending" : "descending");
  const value = row => { const cell = row.cells[column]; return cell.classList.contains("number") ? Number(cell.textContent) : cell.textContent; };
  [...body.rows].sort((a, b) => (value(a) > value(b) ? 1 : value(a) < value(b) ? -1 : 0) * (up ? 1 : -1)).forEach(row => body.append(row));
};
</script>
)";

constexpr std::string_view sliding = R"(<script>
for (const slider of document.querySelectorAll(".slider")) {
  const over = slider.querySelector(".over"), picture = over.querySelector("img"), range = slider.parentElement.querySelector("input");
  const place = () => { picture.style.width = slider.clientWidth + "px"; over.style.width = range.value + "%"; };
  range.oninput = place; addEventListener("resize", place); addEventListener("load", place); place();
}
</script>
)";

std::string list(const std::vector<std::string>& lines) {
    std::string items;
    for (const std::string& line : lines)
        items += fmt::format("<li>{}</li>\n", escaped(line));
    return items.empty() ? items : "<ul>\n" + items + "</ul>\n";
}

std::string partHtml(const Part& part) {
    std::string html = fmt::format("<h2>{}: {:.1f} of {:.0f} points</h2>\n<p class=\"soft\">{}</p>\n",
                                   part.kind == "shader" ? "Shader" : "Screenshot", pointsOfAll * part.share(), pointsOfAll, escaped(part.file));
    for (const auto& [share, reason] : part.limits)
        html += fmt::format("<p class=\"bad\">{}</p>\n", escaped(reason));
    html += "<table>\n<thead><tr><th>property</th><th class=\"number\">points</th><th class=\"number\">of</th><th class=\"number\">measured</th><th>why points were lost</th></tr></thead>\n<tbody>\n";
    for (const Line& line : part.lines)
        html += fmt::format("<tr><td>{}</td><td class=\"number\">{:.1f}</td><td class=\"number\">{:.1f}</td><td class=\"number\">{:.3f}</td><td>{}</td></tr>\n",
                            escaped(line.name), line.points, line.of, line.figure, escaped(line.reason));
    html += "</tbody>\n</table>\n";
    if (!part.submitted.empty())
        html += fmt::format(
            "<div class=\"pictures\">\n<figure><div class=\"slider\"><img src=\"../pictures/{0}\" alt=\"submitted\"><div class=\"over\"><img src=\"../pictures/{1}\" alt=\"reference\"></div></div>"
            "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"share of the reference that is shown\"><figcaption>left: reference, right: submitted</figcaption></figure>\n"
            "<figure><img src=\"../pictures/{1}\" alt=\"\"><figcaption>reference</figcaption></figure>\n"
            "<figure><img src=\"../pictures/{0}\" alt=\"\"><figcaption>submitted, as it was compared</figcaption></figure>\n"
            "<figure><img src=\"../pictures/{2}\" alt=\"\"><figcaption>FLIP error: black none, yellow most</figcaption></figure>\n</div>\n",
            escaped(part.submitted), escaped(part.reference), escaped(part.errors));
    return html + list(part.remarks);
}

}  // namespace

void writeReport(const Class& graded, const std::vector<std::string>& names, const std::vector<Pair>& pairs, const fs::path& out) {
    const std::vector<Record>& records = graded.records;
    double mean = 0;
    for (const Record& record : records)
        mean += record.points(pointsOfAll) / static_cast<double>(records.size());
    std::string body = fmt::format("<h1>{}</h1>\n<p class=\"soft\">{}: {}. {} submissions, mean {:.1f} of {:.0f} points.</p>\n", escaped(graded.rubric.title),
                                   escaped(graded.lab), escaped(graded.topic), records.size(), mean, pointsOfAll);
    body += distribution(records);
    if (!pairs.empty()) {
        body += "<h2>Alike</h2>\n<p class=\"soft\">Pointed out, not punished: who copied, if anybody did, pictures cannot tell.</p>\n<ul>\n";
        for (const Pair& pair : pairs)
            body += fmt::format("<li><a href=\"students/{}.html\">{}</a> and <a href=\"students/{}.html\">{}</a>: {}</li>\n", records[pair.first].key,
                                escaped(names[pair.first]), records[pair.second].key, escaped(names[pair.second]), escaped(pair.text));
        body += "</ul>\n";
    }
    body += "<h2>Submissions</h2>\n<table>\n<thead><tr><th><button>student</button></th><th class=\"number\"><button>points</button></th><th><button>handed in</button></th><th><button>why points were lost</button></th></tr></thead>\n<tbody>\n";
    for (std::size_t i = 0; i < records.size(); ++i) {
        const Record& record = records[i];
        const double points = record.points(pointsOfAll);
        std::string kinds;
        for (const Part& part : record.parts)
            kinds += (kinds.empty() ? "" : ", ") + part.kind;
        const std::vector<std::string> reasons = record.reasons();
        std::string why = reasons.empty() ? "" : escaped(reasons.front());
        if (reasons.size() > 1)
            why += fmt::format(" <span class=\"soft\">and {} more</span>", reasons.size() - 1);
        body += fmt::format("<tr><td><a href=\"students/{}.html\">{}</a></td><td class=\"number {}\">{:.1f}</td><td>{}</td><td>{}</td></tr>\n", record.key,
                            names[i].empty() ? "(no name)" : escaped(names[i]), classOf(points), points, kinds.empty() ? "nothing usable" : kinds + (record.late ? ", late" : ""), why);
        std::string own = fmt::format("<p><a href=\"../index.html\">{}</a></p>\n<h1>{}</h1>\n<p class=\"{}\">{:.1f} of {:.0f} points{}</p>\n", escaped(graded.rubric.title),
                                      names[i].empty() ? "(no name)" : escaped(names[i]), classOf(points), points, pointsOfAll, record.late ? ", late" : "");
        for (const Part& part : record.parts)
            own += partHtml(part);
        if (record.parts.empty())
            own += "<p>Nothing that can be graded: no screenshot and no shader.</p>\n";
        if (!record.faults.empty())
            own += "<h2>Refused or broken</h2>\n" + list(record.faults);
        for (const Pair& pair : pairs)
            if (pair.first == i || pair.second == i) {
                const std::size_t other = pair.first == i ? pair.second : pair.first;
                own += fmt::format("<p>Like <a href=\"{}.html\">{}</a>: {}</p>\n", records[other].key, escaped(names[other]), escaped(pair.text));
            }
        writeFile(out / "students" / (record.key + ".html"), page(names[i], own + std::string(sliding)));
    }
    body += "</tbody>\n</table>\n";
    writeFile(out / "index.html", page(graded.rubric.title, body + std::string(sorting)));
}

}  // namespace quincunx::grade

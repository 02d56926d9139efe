#include "grade/report.h"

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include <fmt/format.h>

#include "base/file.h"
#include "lab/json.h"
#include "web/page.h"

namespace quincunx::grade {
namespace {
namespace fs = std::filesystem;

constexpr std::uintmax_t maxPictureBytes = 64 << 20;

Json pageView(const std::string& title, const std::string& root, std::vector<std::string> scripts) {
    return {{"title", title},
            {"root", root},
            {"assets", root + "assets/"},
            {"home", "index.html"},
            {"nav", Json::array({{{"href", "index.html"}, {"name", "Class"}, {"current", root.empty()}}})},
            {"scripts", std::move(scripts)},
            {"footer", "Made by quincunx grade. The points, the figures and their limits are the rubric's."}};
}

Json bars(const std::vector<Record>& records, std::string& words) {
    constexpr std::size_t count = 10;
    constexpr double floor = 145;
    constexpr double tallest = 115;
    std::array<std::size_t, count> bins{};
    for (const Record& record : records)
        ++bins[std::min(count - 1, static_cast<std::size_t>(record.points(pointsOfAll) / 10))];
    const std::size_t most = std::max<std::size_t>(1, *std::max_element(bins.begin(), bins.end()));
    Json json = Json::array();
    words = "Submissions by points:";
    for (std::size_t i = 0; i < count; ++i) {
        const double height = tallest * static_cast<double>(bins[i]) / static_cast<double>(most);
        const std::string range = fmt::format("{}–{}", 10 * i, 10 * (i + 1));
        json.push_back({{"x", fmt::format("{}", 60 * i + 4)},
                        {"y", fmt::format("{:.1f}", floor - height)},
                        {"height", fmt::format("{:.1f}", height)},
                        {"middle", fmt::format("{}", 60 * i + 30)},
                        {"top", fmt::format("{:.1f}", floor - height - 6)},
                        {"number", bins[i] > 0 ? std::to_string(bins[i]) : ""},
                        {"range", range}});
        words += fmt::format(" {}: {};", range, bins[i]);
    }
    return json;
}

Json partView(const Part& part) {
    Json lines = Json::array();
    for (const Line& line : part.lines)
        lines.push_back({{"name", line.name},
                         {"points", pointsText(line.points)},
                         {"of", pointsText(line.of)},
                         {"figure", fmt::format("{:.3f}", line.figure)},
                         {"reason", line.reason}});
    Json limits = Json::array();
    for (const auto& [share, reason] : part.limits)
        limits.push_back(reason);
    Json view{{"heading", part.kind == "shader" ? "Shader" : "Screenshot"},
              {"points", pointsText(pointsOfAll * part.share())},
              {"most", pointsText(pointsOfAll)},
              {"file", part.file},
              {"limits", limits},
              {"lines", lines},
              {"remarks", part.remarks},
              {"has_remarks", !part.remarks.empty()},
              {"pictures", Json::array()}};
    if (!part.submitted.empty())
        view["pictures"].push_back(
            {{"reference", part.reference}, {"submitted", part.submitted}, {"errors", part.errors}});
    return view;
}

/// The script that gives the page's widget the pixels of a picture (web::pixelScript, from a PNG that is
/// there).
void writePixels(const fs::path& pictures, const std::string& name) {
    const std::string bytes = readFile(pictures / name, maxPictureBytes);
    const std::string uri = web::dataUri(
        "image/png", std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
    web::writeIfChanged(pictures / (name + ".js"),
                        fmt::format("quincunxPixels({}, {});\n", Json("../pictures/" + name + ".js").dump(),
                                    Json(uri).dump()));
}

}  // namespace

void writeReport(const Class& graded, const std::vector<std::string>& names, const std::vector<Pair>& pairs,
                 const fs::path& out) {
    constexpr std::array<std::string_view, 2> scripts = {"compare.js", "grade.js"};
    web::copyAssets(out / "assets", scripts);
    const std::vector<Record>& records = graded.records;
    const auto shown = [&](std::size_t i) { return names[i].empty() ? std::string("(no name)") : names[i]; };

    Json index = pageView(graded.rubric.title, "", {"grade.js"});
    std::string words;
    double mean = 0;
    std::size_t faulty = 0;
    for (const Record& record : records) {
        mean += record.points(pointsOfAll) / static_cast<double>(std::max<std::size_t>(records.size(), 1));
        faulty += !record.faults.empty() || record.parts.empty() ? 1 : 0;
    }
    index["bars"] = bars(records, words);
    index.update(Json{{"lab", graded.lab},
                      {"topic", graded.topic},
                      {"count", std::to_string(records.size())},
                      {"mean", pointsText(mean)},
                      {"most", pointsText(pointsOfAll)},
                      {"faulty", std::to_string(faulty)},
                      {"distribution_words", words},
                      {"has_pairs", !pairs.empty()},
                      {"pairs", Json::array()},
                      {"students", Json::array()}});
    for (const Pair& pair : pairs)
        index["pairs"].push_back({{"first", shown(pair.first)},
                                  {"first_key", records[pair.first].key},
                                  {"second", shown(pair.second)},
                                  {"second_key", records[pair.second].key},
                                  {"how", pair.text}});
    std::set<std::string> pictures;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const Record& record = records[i];
        const std::string points = pointsText(record.points(pointsOfAll));
        std::string kinds;
        for (const Part& part : record.parts)
            kinds += (kinds.empty() ? "" : ", ") + part.kind;
        kinds = kinds.empty() ? "nothing usable" : kinds;
        const std::vector<std::string> reasons = record.reasons();
        Json row{{"key", record.key},
                 {"name", shown(i)},
                 {"points", points},
                 {"kinds", kinds + (record.late ? ", late" : "")},
                 {"why", reasons.empty() ? "" : reasons.front()},
                 {"more", Json::array()}};
        if (reasons.size() > 1)
            row["more"].push_back({{"more", std::to_string(reasons.size() - 1)}});
        index["students"].push_back(std::move(row));

        Json page = pageView(shown(i), "../", {"error_colours.js", "compare.js"});
        Json parts = Json::array();
        for (const Part& part : record.parts) {
            parts.push_back(partView(part));
            if (!part.submitted.empty())
                pictures.insert({part.reference, part.submitted});
        }
        Json alike = Json::array();
        for (const Pair& pair : pairs)
            if (pair.first == i || pair.second == i) {
                const std::size_t other = pair.first == i ? pair.second : pair.first;
                alike.push_back({{"key", records[other].key}, {"name", shown(other)}, {"how", pair.text}});
            }
        page.update(Json{{"class", graded.rubric.title},
                         {"name", shown(i)},
                         {"points", points},
                         {"most", pointsText(pointsOfAll)},
                         {"late", record.late},
                         {"parts", parts},
                         {"has_faults", !record.faults.empty()},
                         {"faults", record.faults},
                         {"alike", alike}});
        web::writeIfChanged(out / "students" / (record.key + ".html"),
                            web::filledTemplate("grade_student", page));
    }
    for (const std::string& picture : pictures)
        writePixels(out / "pictures", picture);
    web::writeIfChanged(out / "index.html", web::filledTemplate("grade", index));
}

}  // namespace quincunx::grade

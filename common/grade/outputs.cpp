// What a class' records become: tables for people, spreadsheets and learning platforms.

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.h"
#include "grade/duplicates.h"
#include "grade/grade.h"
#include "grade/report.h"

namespace quincunx::grade {
namespace {
namespace fs = std::filesystem;

std::string row(const std::vector<std::string>& fields) {
    std::vector<std::string> quoted;
    quoted.reserve(fields.size());
    for (const std::string& field : fields)
        quoted.push_back(csvField(field));
    return fmt::format("{}\r\n", fmt::join(quoted, ","));
}

std::string joined(const std::vector<std::string>& reasons) {
    return fmt::format("{}", fmt::join(reasons, "; "));
}

std::string gradesCsv(const Class& graded, const std::vector<std::string>& names, bool anonymous) {
    std::string text = row({"student", "id", "late", "score", "of", "screenshot", "shader", "reasons"});
    for (std::size_t i = 0; i < graded.records.size(); ++i) {
        const Record& record = graded.records[i];
        const auto partText = [&](const char* kind) {
            for (const Part& part : record.parts)
                if (part.kind == kind)
                    return pointsText(pointsOfAll * part.share());
            return std::string();
        };
        text += row({names[i], anonymous ? "" : record.id, record.late ? "late" : "",
                     pointsText(record.points(pointsOfAll)), pointsText(pointsOfAll), partText("screenshot"),
                     partText("shader"), joined(record.reasons())});
    }
    return text;
}

std::string canvasCsv(const Class& graded) {
    std::string text = row({"Student", "ID", "SIS User ID", "SIS Login ID", "Section", graded.rubric.title});
    text += row({"    Points Possible", "", "", "", "", pointsText(pointsOfAll)});
    for (const Record& record : graded.records)
        text += row({record.student, record.platform == Platform::canvas ? record.id : "", "", "", "",
                     pointsText(record.points(pointsOfAll))});
    return text;
}

std::string moodleCsv(const Class& graded) {
    std::string text = row({"Identifier", "Full name", "Grade", "Maximum Grade", "Feedback comments"});
    for (const Record& record : graded.records)
        text +=
            row({record.platform == Platform::moodle ? "Participant " + record.id : "", record.student,
                 pointsText(record.points(pointsOfAll)), pointsText(pointsOfAll), joined(record.reasons())});
    return text;
}

/// As Gradescope's autograder reads it.
Json gradescopeJson(const Record& record) {
    Json tests = Json::array();
    for (const Part& part : record.parts) {
        const double scale =
            part.of() > 0 ? pointsOfAll / part.of() / static_cast<double>(record.parts.size()) : 0;
        for (const Line& line : part.lines)
            tests.push_back({{"name", part.kind + ": " + line.name},
                             {"score", scale * line.points},
                             {"max_score", scale * line.of},
                             {"output", line.reason}});
    }
    return {{"score", record.points(pointsOfAll)},
            {"output", fmt::format("{}", fmt::join(record.reasons(), "\n"))},
            {"visibility", "after_published"},
            {"stdout_visibility", "hidden"},
            {"tests", tests}};
}

/// Names for people who are not to know them: numbered in the order of their keys, which tells nothing.
std::vector<std::string> shownNames(const std::vector<Record>& records, bool anonymous) {
    std::vector<std::string> names;
    std::vector<std::string> keys;
    for (const Record& record : records)
        keys.push_back(record.key);
    std::sort(keys.begin(), keys.end());
    for (const Record& record : records) {
        const auto place = std::lower_bound(keys.begin(), keys.end(), record.key) - keys.begin();
        names.push_back(anonymous ? fmt::format("Student {:03}", place + 1) : record.student);
    }
    return names;
}

}  // namespace

std::string csvField(std::string_view text) {
    std::string field;
    for (const char c : text)
        field += static_cast<unsigned char>(c) < 0x20 || c == '\x7F' ? ' ' : c;
    // Spreadsheets take these for the beginning of a formula, also after spaces.
    const std::size_t first = field.find_first_not_of(' ');
    const bool isFormula =
        first != std::string::npos && std::string_view("=+-@|%").find(field[first]) != std::string_view::npos;
    if (isFormula)
        field = "'" + field;
    std::string quoted = "\"";
    for (const char c : field)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    return field.find_first_of("\",;") == std::string::npos ? field : quoted + '"';
}

void writeOutputs(const Class& graded, const fs::path& out, bool anonymous) {
    const std::vector<std::string> names = shownNames(graded.records, anonymous);
    const std::vector<Pair> pairs = findPairs(graded.records);
    writeFile(out / "grades.csv", gradesCsv(graded, names, anonymous));
    writeFile(out / "lms" / "canvas.csv", canvasCsv(graded));
    writeFile(out / "lms" / "moodle.csv", moodleCsv(graded));
    Json all = Json::array();
    for (std::size_t i = 0; i < graded.records.size(); ++i) {
        const Record& record = graded.records[i];
        // Numbers of the platform name its folders; names of students, which may be anything, do not.
        const std::string folder = record.platform == Platform::gradescope ? record.id : record.key;
        writeFile(out / "lms" / "gradescope" / folder / "results.json", dump(gradescopeJson(record)));
        Json json = toJson(record);
        json["student"] = names[i];
        if (anonymous)
            json["id"] = "";
        json["score"] = record.points(pointsOfAll);
        json["max_score"] = pointsOfAll;
        json["reasons"] = record.reasons();
        for (const char* internal : {"digest", "shader_tokens"})
            json.erase(internal);
        for (Json& part : json["parts"])
            part.erase("signature");
        all.push_back(std::move(json));
    }
    Json alike = Json::array();
    for (const Pair& pair : pairs)
        alike.push_back({{"students", {names[pair.first], names[pair.second]}}, {"how", pair.text}});
    writeFile(
        out / "grades.json",
        dump({{"lab", graded.lab}, {"title", graded.rubric.title}, {"submissions", all}, {"alike", alike}}));
    writeReport(graded, names, pairs, out);
}

}  // namespace quincunx::grade

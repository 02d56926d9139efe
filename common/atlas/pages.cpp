#include "atlas/pages.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "atlas/exam.h"
#include "atlas/readme.h"
#include "base/error.h"
#include "base/file.h"
#include "lab/answer.h"
#include "web/page.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t mostReadmeBytes = 1 << 20;
constexpr std::uintmax_t mostShownBytes = 1 << 19;

constexpr std::string_view footer =
    "Made by quincunx atlas. Nothing on these pages is fetched; times hold for the machine they were "
    "measured "
    "on. The charts are drawn by D3; its licence is in assets/licences.txt.";

struct NavigationEntry {
    const char* href;
    const char* name;
};
constexpr std::array navigation = {
    NavigationEntry{"index.html", "Labs"}, NavigationEntry{"questions.html", "Questions"},
    NavigationEntry{"stability.html", "Stability"}, NavigationEntry{"cost.html", "Cost"}};

/// "shadow_maps" → "Shadow maps"
std::string headingOf(const std::string& name) {
    std::string heading = name;
    std::replace(heading.begin(), heading.end(), '_', ' ');
    if (!heading.empty())
        heading[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(heading[0])));
    return heading;
}

/// What every page needs. `root`: the way to the site's folder.
Json pageView(const std::string& title, const std::string& root, std::string_view current,
              std::vector<std::string> scripts) {
    Json nav = Json::array();
    for (const NavigationEntry& entry : navigation)
        nav.push_back({{"href", entry.href}, {"name", entry.name}, {"current", entry.href == current}});
    return {{"title", title},       {"root", root}, {"assets", root + "assets/"},
            {"home", "index.html"}, {"nav", nav},   {"scripts", std::move(scripts)},
            {"footer", footer}};
}

std::string textOf(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// A figure as people read it. JSON has null where a figure is not finite.
std::string figure(const Json& value) {
    return value.is_number() ? figureText(value.get<double>()) : "not finite";
}

std::string rounded(double value, int digits) {
    return value != 0 && std::abs(value) < std::pow(10, -digits) ? fmt::format("{:.2g}", value)
                                                                 : fmt::format("{:.{}f}", value, digits);
}

std::string milliseconds(const Json& value, double factor = 1) {
    return value.is_number() ? rounded(value.get<double>() * factor, 2) : "not finite";
}

std::string bytesText(const Json& value) {
    const double bytes = value.is_number() ? value.get<double>() : 0;
    return std::abs(bytes) < 1e4   ? fmt::format("{:.0f} B", bytes)
           : std::abs(bytes) < 1e7 ? fmt::format("{:.0f} kB", bytes / 1e3)
                                   : fmt::format("{:.1f} MB", bytes / 1e6);
}

/// Text, or nothing in Mustache's sense.
Json orNothing(const std::string& text) {
    return text.empty() ? Json() : Json(text);
}

Json questionView(const Json& answer) {
    Json figures = Json::array();
    for (const Json& m : answer["measurements"])
        figures.push_back({{"name", m["name"]},
                           {"value", figure(m["value"])},
                           {"unit", textOf(m, "unit")},
                           {"bound", orNothing(textOf(m, "bound"))},
                           {"pass", m["pass"]}});
    return {{"number", answer["question"]},    {"asked", answer["asked"]},
            {"answer", answer["answer"]},      {"card_fix", orNothing(textOf(answer, "card_fix"))},
            {"has_figures", !figures.empty()}, {"figures", figures}};
}

Json knobView(const LabResults& lab, const Json& knob) {
    Json values = Json::array();
    int first = 0;
    int second = 0;
    double largest = -1;
    for (const Json& value : knob["values"]) {
        const auto index = static_cast<int>(values.size());
        const double difference = value["rmse"].is_number() ? value["rmse"].get<double>() : 0;
        if (value["is_default"].get<bool>())
            first = index;
        else if (difference > largest) {
            largest = difference;
            second = index;
        }
        Json view = value;
        view["rmse"] = fmt::format("{:.3f}", difference);
        view["alt"] =
            fmt::format("{} with {} = {}", headingOf(lab.name), textOf(knob, "name"), textOf(value, "value"));
        values.push_back(view);
    }
    const std::string idle = textOf(knob, "idle");
    Json refused = Json::array();
    for (const Json& one : knob["refused"])
        refused.push_back(one);
    const std::string why = !refused.empty()           ? textOf(refused[0], "why")
                            : !idle.empty()            ? idle
                            : knob["same"].get<bool>() ? "alone it leaves this picture as it is, bit for bit"
                                                       : "it takes words";
    return {{"name", knob["name"]},
            {"allowed", knob["allowed"]},
            {"unit", orNothing(textOf(knob, "unit"))},
            {"help", knob["help"]},
            {"slow", knob["slow"]},
            {"why", why},
            {"folder", lab.folder},
            {"first", first},
            {"second", second},
            {"refused", refused},
            {"values", values}};
}

/// `prefix`: the way from the page to the lab's folder.
Json sweepView(const LabResults& lab, const Json& measured, const std::string& prefix) {
    const Json& sweep = measured["sweep"];
    const Json& points = sweep["points"];
    Json names = Json::array();
    if (!points.empty())
        for (const auto& [name, value] : points[0]["knobs"].items())
            names.push_back(name);
    Json rows = Json::array();
    for (const Json& point : points) {
        Json values = Json::array();
        for (const auto& [name, value] : point["knobs"].items())
            values.push_back(value);
        std::vector<std::string> counters;
        for (const auto& [name, count] : point["counters"].items())
            counters.push_back(fmt::format("{} {}", count.dump(), name));
        rows.push_back({{"knob_values", values},
                        {"error", figure(point["error"])},
                        {"ms", milliseconds(point["seconds"], 1e3)},
                        {"spread", milliseconds(point["seconds_spread"], 1e3)},
                        {"pareto", point["pareto"]},
                        {"counters", fmt::format("{}", fmt::join(counters, ", "))}});
    }
    Json data = sweep;
    data["heading"] = headingOf(lab.name);
    data["pictures"] = Json::array();
    for (const Json& picture : measured["pictures"])
        data["pictures"].push_back(prefix + picture.get<std::string>());
    return {{"id", fmt::format("{}-{}", lab.name, textOf(sweep, "sweep"))},
            {"lab_name", lab.name},
            {"sweep_name", sweep["sweep"]},
            {"title", sweep["title"]},
            {"metric", sweep["metric"]},
            {"error_unit", orNothing(textOf(sweep, "error_unit"))},
            {"reference", sweep["reference"]},
            {"renderer", sweep["renderer"]},
            {"width", measured["width"]},
            {"height", measured["height"]},
            {"knob_names", names},
            {"points", rows},
            {"point_count", rows.size()},
            {"data", web::inScript(data)}};
}

/// Where an error lies between 0 (10^-18 and less) and 1 (10^6 and more).
double onGauge(const Json& value) {
    const double error = value.is_number() ? value.get<double>() : HUGE_VAL;
    constexpr double least = -18;
    constexpr double most = 6;
    return error > 0 ? (std::clamp(std::log10(error), least, most) - least) / (most - least) : 0;
}

Json caseView(const Json& one) {
    const auto inputs = one["inputs"].get<double>();
    const auto failures = one["naive_failures"].get<double>();
    const std::string failed = failures == 0        ? "never"
                               : failures == inputs ? "always"
                                                    : fmt::format("{:.2g} %", 100 * failures / inputs);
    const bool anyNaive = failures < inputs;
    return {{"routine", one["routine"]},
            {"hard_input", one["hard_input"]},
            {"source", one["source"]},
            {"unit", one["unit"]},
            {"failed", failed},
            {"naive_error", anyNaive ? figure(one["naive_error"]) : "–"},
            {"stable_error", figure(one["stable_error"])},
            {"bound", figure(one["bound"])},
            {"naive_at", fmt::format("{:.4f}", anyNaive ? onGauge(one["naive_error"]) : 1)},
            {"stable_at", fmt::format("{:.4f}", onGauge(one["stable_error"]))},
            {"bound_at", fmt::format("{:.4f}", onGauge(one["bound"]))},
            {"gauge", fmt::format("stable {}, textbook {}, bound {}", figure(one["stable_error"]),
                                  anyNaive ? figure(one["naive_error"]) : "fails", figure(one["bound"]))},
            {"pass", one["pass"]}};
}

Json caseViews(const LabResults& lab) {
    Json cases = Json::array();
    for (const Json& one : lab.stress["cases"])
        cases.push_back(caseView(one));
    return cases;
}

std::string share(double part, double whole) {
    return fmt::format("{:.4f}", whole > 0 ? std::clamp(part / whole, 0.0, 1.0) : 0);
}

/// Adds what _plan.mustache shows.
void addPlan(Json& view, const Json& plan) {
    view["plan_width"] = plan["width"];
    view["plan_height"] = plan["height"];
    view["plan_ms"] = milliseconds(plan["milliseconds"]);
    view["plan_calls"] = figure(plan["gl_calls"]);
    view["plan_memory"] = bytesText(plan["memory_bytes"]);
    view["effects"] = Json::array();
    for (const bool in : {true, false})
        for (const Json& effect : plan["effects"])
            if (effect["called_for"] == in)
                view["effects"].push_back({{"name", effect["name"]},
                                           {"called_for", in},
                                           {"reason", effect["reason"]},
                                           {"ms", in ? milliseconds(effect["milliseconds"]) : "–"},
                                           {"calls", in ? figure(effect["gl_calls"]) : "0"},
                                           {"memory", in ? bytesText(effect["memory_bytes"]) : "0 B"}});
    view["has_effects"] = !view["effects"].empty();
    double longest = 0;
    for (const Json& pass : plan["passes"])
        longest = std::max(longest, pass["milliseconds"].get<double>());
    view["passes"] = Json::array();
    for (const Json& pass : plan["passes"])
        view["passes"].push_back({{"name", pass["name"]},
                                  {"calls", figure(pass["gl_calls"])},
                                  {"ms", milliseconds(pass["milliseconds"])},
                                  {"share", share(pass["milliseconds"].get<double>(), longest)}});
    view["has_passes"] = !view["passes"].empty();
}

std::string sourcePage(const std::string& path) {
    return fmt::format("sources/{}.html", path);
}

/// The file of the tree that a README's link means, "shaders/passes/phong.frag"; empty if it is none that can
/// be shown.
std::string treeFile(const Site& site, const std::string& folder, const std::string& target) {
    const fs::path path = (fs::path("labs") / folder / target).lexically_normal();
    std::error_code error;
    return *path.begin() != ".." && fs::is_regular_file(site.sources / path, error) ? path.generic_string()
                                                                                    : std::string();
}

int writeSourcePage(const Site& site, const LabResults& lab, const std::string& path) {
    std::string root = "../";  // of the folder sources/
    for (const char c : path)
        if (c == '/')
            root += "../";
    Json view = pageView(path, root, "", {});
    view["folder"] = lab.folder;
    view["heading"] = headingOf(lab.name);
    view["path"] = path;
    view["text"] = readFile(site.sources / path, mostShownBytes);
    return web::writeIfChanged(site.folder / sourcePage(path), web::filledTemplate("source", view)) ? 1 : 0;
}

/// What the README says goes into `view`; the sources it names become pages. Returns how many were written.
int addReadme(Json& view, const Site& site, const LabResults& lab) {
    int written = 0;
    std::error_code error;
    const fs::path file = site.sources / "labs" / lab.folder / "README.md";
    Readme readme;
    if (fs::is_regular_file(file, error))
        readme = parseReadme(readFile(file, mostReadmeBytes));
    std::set<std::string> shown;
    for (const std::string& item : readme.reading)
        for (const std::string& target : linkTargets(item))
            if (const std::string path = treeFile(site, lab.folder, target); !path.empty())
                shown.insert(path);
    for (const std::string& path : shown)
        written += writeSourcePage(site, lab, path);
    const auto html = [&](const std::string& markdown) {
        return inlineHtml(markdown, [&](const std::string& target) {
            const std::string path = treeFile(site, lab.folder, target);
            return shown.contains(path) ? "../" + sourcePage(path) : std::string();
        });
    };
    view["intro"] = readme.intro.empty() ? Json() : Json(html(readme.intro));
    view["reading"] = Json::array();
    for (const std::string& item : readme.reading)
        view["reading"].push_back({{"item", html(item)}});
    view["has_reading"] = !readme.reading.empty();
    view["tries"] = Json::array();
    for (const auto& [what, seen] : readme.tries)
        view["tries"].push_back({{"do", html(what)}, {"see", html(seen)}});
    view["has_tries"] = !readme.tries.empty();
    return written;
}

struct Count {
    int figures = 0;
    int fellShort = 0;
};

Count countOf(const LabResults& lab) {
    Count count;
    for (const Json& answer : lab.questions)
        for (const Json& m : answer["measurements"]) {
            ++count.figures;
            count.fellShort += m["pass"].get<bool>() ? 0 : 1;
        }
    return count;
}

int writeIndex(const Site& site, std::span<const LabResults> labs) {
    Json view = pageView("Quincunx", "", "index.html", {});
    std::set<int> answered;
    Count count;
    int cases = 0;
    int points = 0;
    view["labs"] = Json::array();
    for (const LabResults& lab : labs) {
        std::vector<int> numbers;
        for (const Json& answer : lab.questions)
            numbers.push_back(answer["question"]);
        std::sort(numbers.begin(), numbers.end());
        answered.insert(numbers.begin(), numbers.end());
        count.figures += countOf(lab).figures;
        cases += static_cast<int>(lab.stress["cases"].size());
        for (const Json& sweep : lab.sweeps)
            points += static_cast<int>(sweep["sweep"]["points"].size());
        view["labs"].push_back(
            {{"folder", lab.folder},
             {"number", lab.number},
             {"heading", headingOf(lab.name)},
             {"topic", lab.topic},
             {"card", textOf(lab.picture, "card")},
             {"questions", numbers.empty()       ? "any scene"
                           : numbers.size() == 1 ? fmt::format("question {}", numbers.front())
                                                 : fmt::format("questions {}", fmt::join(numbers, ", "))}});
    }
    view["lab_count"] = labs.size();
    view["stats"] = {{{"name", fmt::format("of {} questions answered", questionCount)},
                      {"value", fmt::format("{}", answered.size())}},
                     {{"name", "figures measured for them"}, {"value", fmt::format("{}", count.figures)}},
                     {{"name", "settings timed against a reference"}, {"value", fmt::format("{}", points)}},
                     {{"name", "hard cases held"}, {"value", fmt::format("{}", cases)}}};
    return web::writeIfChanged(site.folder / "index.html", web::filledTemplate("index", view)) ? 1 : 0;
}

int writeQuestions(const Site& site, std::span<const LabResults> labs) {
    Json view = pageView("Questions", "", "questions.html", {"questions.js"});
    std::map<int, std::vector<std::pair<const LabResults*, const Json*>>> answers;
    for (const LabResults& lab : labs)
        for (const Json& answer : lab.questions)
            answers[answer["question"].get<int>()].emplace_back(&lab, &answer);
    std::set<std::string> topics;
    view["questions"] = Json::array();
    for (int number = 1; number <= questionCount; ++number) {
        const ExamSubject& subject = examSubject(number);
        topics.emplace(subject.topic);
        Json row{{"number", number},
                 {"topic", subject.topic},
                 {"has_answers", false},
                 {"asked", subject.subject},
                 {"search", fmt::format("{} {} {}", number, subject.topic, subject.subject)}};
        if (const auto found = answers.find(number); found != answers.end()) {
            const auto& [lab, answer] = found->second.front();
            row["has_answers"] = true;
            row["asked"] = (*answer)["asked"];
            row["href"] = fmt::format("labs/{}.html#q{}", lab->folder, number);
            row["lab"] = headingOf(lab->name);
            row["figure_count"] = (*answer)["measurements"].size();
            row["pass"] = (*answer)["pass"];
            row["fix"] = !textOf(*answer, "card_fix").empty();
            row["search"] = fmt::format("{} {} {} {} {}", number, subject.topic, subject.subject,
                                        textOf(*answer, "asked"), textOf(*answer, "answer"));
        }
        row["answers"] = row["has_answers"];
        view["questions"].push_back(row);
    }
    view["topics"] = topics;
    view["total"] = questionCount;
    view["answered"] = answers.size();
    view["unanswered"] = questionCount - static_cast<int>(answers.size());
    return web::writeIfChanged(site.folder / "questions.html", web::filledTemplate("questions", view)) ? 1
                                                                                                       : 0;
}

int writeStability(const Site& site, std::span<const LabResults> labs) {
    Json view = pageView("Stability", "", "stability.html", {});
    int cases = 0;
    int holding = 0;
    int failing = 0;
    view["labs"] = Json::array();
    for (const LabResults& lab : labs) {
        for (const Json& one : lab.stress["cases"]) {
            ++cases;
            holding += one["pass"].get<bool>() ? 1 : 0;
            failing += one["naive_failures"].get<double>() > 0 ? 1 : 0;
        }
        if (!lab.stress["cases"].empty())
            view["labs"].push_back(
                {{"folder", lab.folder}, {"heading", headingOf(lab.name)}, {"cases", caseViews(lab)}});
    }
    view["case_count"] = cases;
    view["holding"] = holding;
    view["failing"] = failing;
    return web::writeIfChanged(site.folder / "stability.html", web::filledTemplate("stability", view)) ? 1
                                                                                                       : 0;
}

int writeCost(const Site& site, std::span<const LabResults> labs) {
    Json view = pageView("Cost", "", "cost.html", {"d3.min.js", "charts.js"});
    double longest = 0;
    for (const LabResults& lab : labs)
        longest = std::max(longest, lab.plan["milliseconds"].get<double>());
    view["labs"] = Json::array();
    for (const LabResults& lab : labs) {
        const auto in = std::count_if(lab.plan["effects"].begin(), lab.plan["effects"].end(),
                                      [](const Json& effect) { return effect["called_for"] == true; });
        Json row{{"folder", lab.folder}, {"heading", headingOf(lab.name)}};
        addPlan(row, lab.plan);
        row["share"] = share(lab.plan["milliseconds"].get<double>(), longest);
        row["pass_count"] = lab.plan["passes"].size();
        row["effects_in"] = lab.plan["effects"].empty() ? Json("–") : Json(in);
        row["effects_out"] = lab.plan["effects"].empty()
                                 ? Json("–")
                                 : Json(static_cast<std::ptrdiff_t>(lab.plan["effects"].size()) - in);
        row["sweeps"] = Json::array();
        for (const Json& sweep : lab.sweeps)
            row["sweeps"].push_back(sweepView(lab, sweep, fmt::format("labs/{}/", lab.folder)));
        row["has_sweeps"] = !lab.sweeps.empty();
        view["labs"].push_back(row);
    }
    return web::writeIfChanged(site.folder / "cost.html", web::filledTemplate("cost", view)) ? 1 : 0;
}

}  // namespace

Json toJson(const LabResults& results) {
    return {{"folder", results.folder},      {"name", results.name},       {"topic", results.topic},
            {"number", results.number},      {"picture", results.picture}, {"knobs", results.knobs},
            {"sweeps", results.sweeps},      {"stress", results.stress},   {"plan", results.plan},
            {"questions", results.questions}};
}

LabResults labResultsFrom(const Json& json, const std::string& where) {
    try {
        return {json.at("folder"),
                json.at("name"),
                json.at("topic"),
                json.at("number"),
                json.at("picture"),
                json.at("knobs").get<std::vector<Json>>(),
                json.at("sweeps").get<std::vector<Json>>(),
                json.at("stress"),
                json.at("plan"),
                json.at("questions").get<std::vector<Json>>()};
    } catch (const nlohmann::json::exception& e) {
        throw InputError(printable(e.what()), where, "delete it, and make its lab again");
    }
}

int writeLabPage(const Site& site, const LabResults& lab) {
    Json view = pageView(headingOf(lab.name) + " – Quincunx", "../", "",
                         {"d3.min.js", "charts.js", "error_colours.js", "compare.js"});
    int written = addReadme(view, site, lab);
    const Count count = countOf(lab);
    view["number"] = lab.number;
    view["name"] = lab.name;
    view["heading"] = headingOf(lab.name);
    view["topic"] = lab.topic;
    view["folder"] = lab.folder;
    view["question_count"] = lab.questions.size();
    view["figure_count"] = count.figures;
    view["all_hold"] = count.figures > 0 && count.fellShort == 0;
    view["falls_short"] = count.fellShort > 0 ? Json(count.fellShort) : Json();
    view["picture"] = lab.picture["file"];
    view["picture_width"] = lab.picture["width"];
    view["picture_height"] = lab.picture["height"];
    view["picture_alt"] = fmt::format("{}: {}", headingOf(lab.name), lab.topic);
    view["renderer"] = lab.picture["renderer"];

    view["questions"] = Json::array();
    for (const Json& answer : lab.questions)
        view["questions"].push_back(questionView(answer));
    view["has_questions"] = !lab.questions.empty();

    view["knobs"] = Json::array();
    view["plain_knobs"] = Json::array();
    for (const Json& knob : lab.knobs)
        view[knob["values"].empty() ? "plain_knobs" : "knobs"].push_back(knobView(lab, knob));
    view["plain_count"] = view["plain_knobs"].size();
    view["one_plain_knob"] = view["plain_knobs"].size() == 1;
    view["has_plain_knobs"] = !view["plain_knobs"].empty();
    view["has_knobs"] = !lab.knobs.empty();

    view["sweeps"] = Json::array();
    for (const Json& sweep : lab.sweeps)
        view["sweeps"].push_back(sweepView(lab, sweep, lab.folder + "/"));
    view["has_sweeps"] = !lab.sweeps.empty();
    view["cases"] = caseViews(lab);
    view["has_cases"] = !view["cases"].empty();
    addPlan(view, lab.plan);

    view["sections"] = Json::array();
    const auto section = [&](const char* id, const char* name, const Json& there) {
        if (there.get<bool>())
            view["sections"].push_back({{"id", id}, {"name", name}});
    };
    section("questions", "Questions", view["has_questions"]);
    section("knobs", "Knobs", view["has_knobs"]);
    section("cost", "What accuracy costs", view["has_sweeps"]);
    section("stability", "Hard cases", view["has_cases"]);
    section("plan", "Plan", true);
    section("sources", "Sources", view["has_reading"]);
    section("try", "Try", view["has_tries"]);
    written +=
        web::writeIfChanged(site.folder / "labs" / (lab.folder + ".html"), web::filledTemplate("lab", view))
            ? 1
            : 0;
    return written;
}

int writeCommonPages(const Site& site, std::span<const LabResults> labs) {
    return writeIndex(site, labs) + writeQuestions(site, labs) + writeStability(site, labs) +
           writeCost(site, labs);
}

}  // namespace quincunx::atlas

#include "lab/sweep.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/check.h"
#include "base/progress.h"
#include "lab/json.h"

namespace quincunx {
namespace {

std::string knobsText(const KnobValues& knobs, std::string_view separator) {
    std::vector<std::string> parts;
    for (const auto& [name, value] : knobs)
        parts.push_back(fmt::format("{}={}", name, value));
    return fmt::format("{}", fmt::join(parts, separator));
}

/// `text` as one field of a CSV file (RFC 4180).
std::string csvField(std::string_view text) {
    if (text.find_first_of(",\"\n\r") == std::string_view::npos)
        return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"')
            quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

/// The points with every knob that any of them names, in the order of first mention; a point that is silent
/// about a knob has it as it is now.
std::vector<KnobValues> completePoints(const std::vector<KnobValues>& points, const KnobSet& knobs) {
    KnobValues named;
    for (const KnobValues& point : points)
        for (const auto& [name, value] : point)
            if (std::none_of(named.begin(), named.end(),
                             [&, &name = name](const auto& known) { return known.first == name; }))
                named.emplace_back(name, knobs.find(name).text());
    std::vector<KnobValues> complete(points.size(), named);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (const auto& [name, value] : points[i])
            std::find_if(complete[i].begin(), complete[i].end(), [&, &name = name](const auto& knob) {
                return knob.first == name;
            })->second = value;
    return complete;
}

}  // namespace

SweepResult runSweep(Lab& lab, const LabEntry& entry, const Sweep& sweep, Studio& studio,
                     const Frame& frame) {
    QX_CHECK(!sweep.points.empty());
    const KnobScope scope(lab.knobs());
    SweepResult result{entry.folder(), sweep.name,      sweep.title, sweep.reference,
                       sweep.metric,   sweep.errorUnit, {},          {}};
    Progress progress(fmt::format("{} {}", entry.folder(), sweep.name), sweep.points.size());
    for (const KnobValues& point : completePoints(sweep.points, lab.knobs())) {
        lab.knobs().set(point);
        result.points.push_back({point, sweep.measure(studio, frame), false});
        progress.update(result.points.size());
    }
    markParetoFront(result.points);
    result.renderer = studio.context().renderer();
    return result;
}

void markParetoFront(std::vector<SweepPoint>& points) {
    for (SweepPoint& point : points) {
        const SweepSample& mine = point.sample;
        point.pareto = std::none_of(points.begin(), points.end(), [&](const SweepPoint& other) {
            const SweepSample& theirs = other.sample;
            return theirs.seconds <= mine.seconds && theirs.error <= mine.error &&
                   (theirs.seconds < mine.seconds || theirs.error < mine.error);
        });
    }
}

std::optional<std::size_t> choosePoint(const std::vector<SweepPoint>& points,
                                       std::optional<double> budgetSeconds, std::optional<double> maxError) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SweepSample& sample = points[i].sample;
        if ((budgetSeconds && sample.seconds > *budgetSeconds) || (maxError && sample.error > *maxError))
            continue;
        if (!best) {
            best = i;
            continue;
        }
        const SweepSample& champion = points[*best].sample;
        const bool better = budgetSeconds ? sample.error < champion.error : sample.seconds < champion.seconds;
        if (better)
            best = i;
    }
    return best;
}

std::string toTable(const SweepResult& result) {
    std::size_t width = 8;
    for (const SweepPoint& point : result.points)
        width = std::max(width, knobsText(point.knobs, " ").size());
    std::string table = fmt::format("{}: {}\n{} against {}, on {}\n\n", result.lab, result.title,
                                    result.metric, result.reference, result.renderer);
    table += fmt::format("  {:<{}}  {:>11}  {:>9}  {:>8}  {}\n", "settings", width,
                         result.metric + (result.errorUnit.empty() ? "" : " " + result.errorUnit), "ms",
                         "± ms", "counters");
    for (const SweepPoint& point : result.points) {
        std::vector<std::string> counters;
        for (const auto& [name, value] : point.sample.counters)
            counters.push_back(fmt::format("{} {}", value, name));
        table +=
            fmt::format("{} {:<{}}  {:>11.4g}  {:>9.3f}  {:>8.3f}  {}\n", point.pareto ? "*" : " ",
                        knobsText(point.knobs, " "), width, point.sample.error, point.sample.seconds * 1e3,
                        point.sample.secondsSpread * 1e3, fmt::join(counters, ", "));
    }
    return table + "* on the Pareto front: nothing measured is both faster and more accurate\n";
}

std::string toCsv(const SweepResult& result) {
    std::vector<std::string> header;
    for (const auto& [name, value] : result.points.front().knobs)
        header.push_back(csvField(name));
    for (const char* name : {"error", "seconds", "seconds_spread", "pareto"})
        header.emplace_back(name);
    for (const auto& [name, value] : result.points.front().sample.counters)
        header.push_back(csvField(name));
    std::string csv = fmt::format("{}\n", fmt::join(header, ","));
    for (const SweepPoint& point : result.points) {
        std::vector<std::string> row;
        for (const auto& [name, value] : point.knobs)
            row.push_back(csvField(value));
        row.push_back(fmt::format("{}", point.sample.error));
        row.push_back(fmt::format("{}", point.sample.seconds));
        row.push_back(fmt::format("{}", point.sample.secondsSpread));
        row.emplace_back(point.pareto ? "1" : "0");
        for (const auto& [name, value] : point.sample.counters)
            row.push_back(fmt::format("{}", value));
        csv += fmt::format("{}\n", fmt::join(row, ","));
    }
    return csv;
}

Json toJson(const KnobValues& knobs) {
    Json json = Json::object();
    for (const auto& [name, value] : knobs)
        json[name] = value;
    return json;
}

Json toJson(const SweepResult& result) {
    Json points = Json::array();
    for (const SweepPoint& point : result.points)
        points.push_back({{"knobs", toJson(point.knobs)},
                          {"error", point.sample.error},
                          {"seconds", point.sample.seconds},
                          {"seconds_spread", point.sample.secondsSpread},
                          {"counters", point.sample.counters},
                          {"pareto", point.pareto}});
    return {{"lab", result.lab},           {"sweep", result.name},
            {"title", result.title},       {"reference", result.reference},
            {"metric", result.metric},     {"error_unit", result.errorUnit},
            {"renderer", result.renderer}, {"points", points}};
}

}  // namespace quincunx

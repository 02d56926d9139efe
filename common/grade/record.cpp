#include "grade/record.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"

namespace quincunx::grade {

double Part::of() const {
    double sum = 0;
    for (const Line& line : lines)
        sum += line.of;
    return sum;
}

std::string pointsText(double points) {
    return fmt::format("{:.2f}", points);
}

double Part::points() const {
    double sum = 0;
    for (const Line& line : lines)
        sum += line.points;
    double share = 1;
    for (const auto& [most, reason] : limits)
        share = std::min(share, most);
    return std::min(sum, share * of());
}

double Part::share() const {
    return of() > 0 ? points() / of() : 0;
}

double Record::points(double most) const {
    double sum = 0;
    for (const Part& part : parts)
        sum += part.share();
    return parts.empty() ? 0 : most * sum / static_cast<double>(parts.size());
}

std::vector<std::string> Record::reasons() const {
    std::vector<std::string> result;
    for (const Part& part : parts) {
        for (const auto& [share, reason] : part.limits)
            result.push_back(reason);
        for (const Line& line : part.lines)
            if (!line.reason.empty())
                result.push_back(fmt::format("{}: {:.1f} of {:.1f} points: {}", line.name, line.points,
                                             line.of, line.reason));
    }
    result.insert(result.end(), faults.begin(), faults.end());
    if (parts.empty())
        result.emplace_back("nothing that can be graded: no screenshot and no shader");
    return result;
}

Json toJson(const Record& record) {
    Json parts = Json::array();
    for (const Part& part : record.parts) {
        Json lines = Json::array();
        for (const Line& line : part.lines)
            lines.push_back({{"name", line.name},
                             {"figure", line.figure},
                             {"points", line.points},
                             {"of", line.of},
                             {"reason", line.reason}});
        Json limits = Json::array();
        for (const auto& [share, reason] : part.limits)
            limits.push_back({{"share", share}, {"reason", reason}});
        parts.push_back({{"kind", part.kind},
                         {"file", part.file},
                         {"points", part.points()},
                         {"of", part.of()},
                         {"scores", lines},
                         {"limits", limits},
                         {"remarks", part.remarks},
                         {"reference", part.reference},
                         {"submitted", part.submitted},
                         {"errors", part.errors},
                         {"exact", part.exact},
                         {"signature", part.signature}});
    }
    return {{"key", record.key},
            {"student", record.student},
            {"id", record.id},
            {"platform", platformName(record.platform)},
            {"late", record.late},
            {"digest", record.digest},
            {"parts", parts},
            {"faults", record.faults},
            {"shader_tokens", record.shaderTokens}};
}

Record parseRecord(const std::string& text, const std::string& where) {
    try {
        const Json json = Json::parse(text);
        Record record;
        record.key = json.at("key").get<std::string>();
        record.student = json.at("student").get<std::string>();
        record.id = json.at("id").get<std::string>();
        for (const Platform platform : {Platform::canvas, Platform::moodle, Platform::gradescope})
            if (json.at("platform").get<std::string>() == platformName(platform))
                record.platform = platform;
        record.late = json.at("late").get<bool>();
        record.digest = json.at("digest").get<std::string>();
        record.faults = json.at("faults").get<std::vector<std::string>>();
        record.shaderTokens = json.at("shader_tokens").get<std::string>();
        for (const Json& from : json.at("parts")) {
            Part part;
            part.kind = from.at("kind").get<std::string>();
            part.file = from.at("file").get<std::string>();
            for (const Json& line : from.at("scores"))
                part.lines.push_back({line.at("name").get<std::string>(), line.at("figure").get<double>(),
                                      line.at("points").get<double>(), line.at("of").get<double>(),
                                      line.at("reason").get<std::string>()});
            for (const Json& limit : from.at("limits"))
                part.limits.emplace_back(limit.at("share").get<double>(),
                                         limit.at("reason").get<std::string>());
            part.remarks = from.at("remarks").get<std::vector<std::string>>();
            part.reference = from.at("reference").get<std::string>();
            part.submitted = from.at("submitted").get<std::string>();
            part.errors = from.at("errors").get<std::string>();
            part.exact = from.at("exact").get<bool>();
            part.signature = from.at("signature").get<std::string>();
            record.parts.push_back(std::move(part));
        }
        return record;
    } catch (const Json::exception& e) {
        throw InputError(fmt::format("is no record of a submission ({})", printable(e.what(), 100)), where,
                         "delete it, and grade again");
    }
}

}  // namespace quincunx::grade

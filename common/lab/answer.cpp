#include "lab/answer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "lab/json.h"
#include "lab/studio.h"

namespace quincunx {

bool Answer::pass() const {
    return std::all_of(measurements.begin(), measurements.end(),
                       [](const Measurement& measurement) { return measurement.pass(); });
}

Answer answerQuestion(const LabEntry& entry, const Question& question, Studio& studio) {
    return {entry.folder(), question, question.measure(studio)};
}

std::string toText(const Answer& answer) {
    constexpr std::size_t columns = 100;
    const Question& question = answer.question;
    std::string text = fmt::format("Question {} ({})\n\n{}\n{}\n", question.number, answer.lab,
                                   wrapped(question.asked, columns), wrapped(question.answer, columns));
    if (!question.cardFix.empty())
        text += wrapped("The card's mistake: " + question.cardFix, columns) + "\n";
    std::size_t width = 0;
    for (const Measurement& measurement : answer.measurements)
        width = std::max(width, measurement.name.size());
    for (const Measurement& measurement : answer.measurements)
        text += fmt::format("  {:<{}}  {:>12} {:<10} {}\n", measurement.name, width,
                            figureText(measurement.value), measurement.unit,
                            !measurement.bound ? ""
                                               : fmt::format("{:<18} {}", measurement.bound->text(),
                                                             measurement.pass() ? "holds" : "FELL SHORT"));
    return text;
}

Json toJson(const Answer& answer) {
    const Question& question = answer.question;
    Json json{{"question", question.number},
              {"lab", answer.lab},
              {"asked", question.asked},
              {"answer", question.answer}};
    if (!question.cardFix.empty())
        json["card_fix"] = question.cardFix;
    json["measurements"] = Json::array();
    for (const Measurement& measurement : answer.measurements) {
        Json row{{"name", measurement.name}, {"value", measurement.value}, {"unit", measurement.unit}};
        if (measurement.bound)
            row["bound"] = measurement.bound->text();
        row["pass"] = measurement.pass();
        json["measurements"].push_back(row);
    }
    json["pass"] = answer.pass();
    return json;
}

std::string figureText(double value) {
    if (std::abs(value) >= 1e5 && value == std::floor(value) && std::abs(value) < 1e15)
        return fmt::format("{:.0f}", value);
    return fmt::format("{:.6g}", value);
}

std::string wrapped(std::string_view text, std::size_t width) {
    std::string lines;
    std::size_t column = 0;
    std::size_t start = 0;
    while (start < text.size()) {
        const std::size_t end = std::min(text.find(' ', start), text.size());
        const std::string_view word = text.substr(start, end - start);
        if (column > 0 && column + 1 + word.size() > width) {
            lines += '\n';
            column = 0;
        } else if (column > 0) {
            lines += ' ';
            ++column;
        }
        lines += word;
        column += word.size();
        start = end + 1;
    }
    return lines + '\n';
}

}  // namespace quincunx

// The verb `deck`: the questions as cards for Anki, with the pictures and the figures of the labs.

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "image/io.h"
#include "lab/answer.h"
#include "lab/json.h"
#include "lab/studio.h"
#include "lab/verbs.h"

namespace quincunx {
namespace {

constexpr int pictureWidth = 640;
constexpr int pictureHeight = 480;

std::string escaped(std::string_view text) {
    std::string html;
    for (const char c : text)
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\n':
                html += "<br>";
                break;
            case '\t':
                html += ' ';
                break;
            case '\r':
                break;
            default:
                html += c;
        }
    return html;
}

/// Anki reads fields as CSV files have them: quotes around, and quotes inside doubled.
std::string field(std::string_view html) {
    std::string quoted = "\"";
    for (const char c : html)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string figuresHtml(const std::vector<Measurement>& measurements) {
    std::string rows;
    for (const Measurement& m : measurements)
        rows += fmt::format("<tr><td>{}</td><td>{} {}</td><td>{}</td></tr>", escaped(m.name),
                            figureText(m.value), escaped(m.unit),
                            m.bound ? escaped(m.bound->text() + (m.pass() ? " ✓" : " ✗ fell short")) : "");
    return rows.empty() ? rows : "<table>" + rows + "</table>";
}

std::string pictureName(const LabEntry& entry) {
    return "quincunx_" + entry.folder() + ".png";
}

/// One line of the file: identity, front, back, tags. Anki knows by the identity which card an import brings
/// up to date.
std::string card(const LabEntry& entry, const std::string& topic, const Answer& answer) {
    const Question& question = answer.question;
    std::string back = fmt::format("<p>{}</p>", escaped(question.answer));
    if (!question.cardFix.empty())
        back += fmt::format("<p><b>The card's mistake:</b> {}</p>", escaped(question.cardFix));
    back += figuresHtml(answer.measurements);
    back += fmt::format("<p><img src=\"{}\" alt=\"{}\"></p>", pictureName(entry),
                        escaped(entry.folder() + ": " + topic));
    return fmt::format("{}\t{}\t{}\t{}\n",
                       field(fmt::format("quincunx-{:03}-{:02}", question.number, entry.number)),
                       field(fmt::format("<p>{}</p>", escaped(question.asked))), field(back),
                       field("quincunx::" + entry.folder()));
}

std::vector<const LabEntry*> chosenLabs(std::span<const LabEntry> labs,
                                        const std::vector<std::string>& names) {
    std::vector<const LabEntry*> chosen;
    for (const LabEntry& entry : labs)
        if (names.empty())
            chosen.push_back(&entry);
    for (const std::string& name : names)
        if (const LabEntry* const entry = &findLab(labs, name);
            std::find(chosen.begin(), chosen.end(), entry) == chosen.end())
            chosen.push_back(entry);
    return chosen;
}

}  // namespace

ExitStatus deck(std::span<const LabEntry> labs, const DeckOptions& options) {
    const std::vector<const LabEntry*> chosen = chosenLabs(labs, options.labs);
    const std::filesystem::path folder = options.out.empty() ? "out/deck" : options.out;
    requireFolder(folder);
    preloadImageIo();

    std::size_t total = 0;
    for (const LabEntry* entry : chosen)
        total += entry->make()->questions().size() + 1;
    Progress progress("deck", std::max<std::size_t>(total, 1));
    std::size_t done = 0;

    std::string cards =
        "#separator:tab\n#html:true\n#notetype:Basic\n#deck:Quincunx\n#guid column:1\n#tags column:4\n";
    std::size_t count = 0;
    std::set<int> answered;
    std::vector<std::string> fellShort;
    for (const LabEntry* entry : chosen) {
        const std::unique_ptr<Lab> lab = entry->make();
        const std::vector<Question> questions = lab->questions();
        Studio studio(options.backend);
        if (!questions.empty())
            writeImage(folder / pictureName(*entry),
                       studio.picture(*lab, studio.frame(*lab, pictureWidth, pictureHeight)));
        progress.update(++done);
        for (const Question& question : questions) {
            const Answer answer = answerQuestion(*entry, question, studio);
            cards += card(*entry, lab->topic(), answer);
            ++count;
            answered.insert(question.number);
            if (!answer.pass())
                fellShort.push_back(fmt::format("question {} ({})", question.number, answer.lab));
            progress.update(++done);
        }
    }
    const std::filesystem::path file = folder / "quincunx.txt";
    writeFile(file, cards);

    for (const std::string& name : fellShort)
        say("warning: " + name + ": a figure fell short of its bound");
    if (options.json)
        print(dump({{"file", file.string()},
                    {"cards", count},
                    {"questions_answered", answered.size()},
                    {"questions", questionCount},
                    {"pass", fellShort.empty()}}));
    else
        print(
            fmt::format("{}: {} cards for {} of {} questions; File > Import in Anki\n"
                        "pictures beside it: copy them into Anki's folder collection.media\n",
                        file.string(), count, answered.size(), questionCount));
    return fellShort.empty() ? ExitStatus::ok : ExitStatus::checkFellShort;
}

}  // namespace quincunx

#include "grade/verbs.h"

#include <fmt/format.h>

#include "base/file.h"
#include "grade/handout.h"
#include "lab/json.h"
#include "lab/verbs.h"

namespace quincunx {
namespace fs = std::filesystem;

void gradeSubmissions(std::span<const LabEntry> labs, const GradeOptions& options) {
    grade::Summary summary;
    if (options.merge) {
        const std::vector<fs::path> folders =
            options.places.empty() ? std::vector<fs::path>{options.grade.out} : options.places;
        summary = grade::mergeShards(folders, options.grade.out, options.grade.anonymous);
    } else {
        if (options.places.size() != 1)
            throw InputError(
                options.places.empty() ? "no submissions given" : "more than one folder of submissions",
                "grade", "name one folder, or several of shards with --merge");
        if (options.lab.empty())
            throw InputError("no lab given", "--lab", "name the lab that the class worked on");
        grade::Options given = options.grade;
        given.submissions = options.places.front();
        given.shard = grade::shardFromEnvironment();
        summary = grade::gradeClass(findLab(labs, options.lab), given);
    }
    if (options.json) {
        print(dump({{"out", summary.out.string()},
                    {"submissions", summary.submissions},
                    {"graded_now", summary.done},
                    {"faulty", summary.faulty},
                    {"mean", summary.mean},
                    {"max_score", summary.points},
                    {"merged", summary.merged}}));
        return;
    }
    std::string text =
        fmt::format("{} submissions, mean {:.1f} of {:.0f} points; {} with faults that are named\n",
                    summary.submissions, summary.mean, summary.points, summary.faulty);
    text += summary.merged
                ? fmt::format("{0}/index.html\n{0}/grades.csv\n", summary.out.string())
                : fmt::format("a shard: when all are done, grade --merge --out {}\n", summary.out.string());
    print(text);
}

void handout(const LabEntry& entry, const HandoutOptions& options) {
    const std::unique_ptr<Lab> lab = entry.make();
    const Exercise exercise = lab->exercise();
    if (exercise.shader.empty())
        throw InputError("sets no task for a shader", entry.folder(),
                         "choose another lab, or grade screenshots");
    const grade::Handout made = grade::handoutOf(grade::solutionOf(exercise), "shaders/" + exercise.shader);
    const fs::path folder =
        options.out.empty() ? fs::path("out") / "handout" / entry.folder() : fs::path(options.out);
    const std::string name = fs::path(exercise.shader).filename().string();
    std::string words = fmt::format(
        "# {}: {}\n\n`{}` lacks a part of the lab {}. It compiles, and the picture lacks what the part "
        "does.\n\n",
        entry.folder(), lab->topic(), name, entry.folder());
    for (const std::string& task : made.tasks)
        words += "- " + task + "\n";
    words += fmt::format(
        "\nTo try it: put the file in the place of `shaders/{}` while the lab's window is open\n"
        "(`./quincunx run {}`): the picture follows every save. Hand in `{}`, a screenshot (key P in the "
        "window), or both.\n",
        exercise.shader, entry.name, name);
    if (!exercise.shaderKnobs.empty()) {
        std::string flags;
        for (const auto& [knob, value] : exercise.shaderKnobs)
            flags += fmt::format(" --{}={}", knob, value);
        words += fmt::format("The task shows with `./quincunx run {}{}`.\n", entry.name, flags);
    }
    writeFile(folder / name, made.text);
    writeFile(folder / "TASK.md", words);
    if (options.json)
        print(dump(
            {{"lab", entry.folder()}, {"folder", folder.string()}, {"shader", name}, {"tasks", made.tasks}}));
    else
        print(fmt::format("{0}/{1}\n{0}/TASK.md\n", folder.string(), name));
}

}  // namespace quincunx

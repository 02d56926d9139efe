#include "atlas/atlas.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "atlas/fingerprint.h"
#include "atlas/pages.h"
#include "atlas/store.h"
#include "atlas/survey.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/paths.h"
#include "base/progress.h"
#include "image/io.h"
#include "lab/json.h"
#include "lab/verbs.h"
#include "web/page.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using namespace atlas;

constexpr std::uintmax_t mostResultBytes = 256 << 20;
constexpr std::array<std::string_view, 4> scripts = {"d3.min.js", "charts.js", "questions.js", "compare.js"};

/// A lab with what is to be found out about it.
struct Work {
    const LabEntry* entry = nullptr;
    std::unique_ptr<Store> store;
    std::string fingerprint;  ///< of the lab
    std::vector<Task> tasks;

    std::string madeOf(const Task& task) const { return Digest().add(fingerprint).add(task.settings).text(); }
};

bool isChosen(const LabEntry& entry, const std::vector<std::string>& names) {
    return names.empty() || std::any_of(names.begin(), names.end(),
                                        [&](const std::string& name) { return entry.isCalled(name); });
}

Work workOn(const LabEntry& entry, const SurveyOptions& options, const fs::path& folder) {
    const std::unique_ptr<Lab> lab = entry.make();
    Work work{&entry, std::make_unique<Store>(folder / "labs" / entry.folder()), {}, {}};
    work.fingerprint = labFingerprint(entry, *lab);
    work.tasks = surveyOf(entry, options, *work.store);
    return work;
}

/// Puts a result where the pages look for it.
void place(LabResults& results, const std::string& task, Json result) {
    if (task == "picture")
        results.picture = std::move(result);
    else if (task == "stress")
        results.stress = std::move(result);
    else if (task == "plan")
        results.plan = std::move(result);
    else if (task.starts_with("knob_"))
        results.knobs.push_back(std::move(result));
    else if (task.starts_with("sweep_"))
        results.sweeps.push_back(std::move(result));
    else
        results.questions.push_back(std::move(result));
}

bool passes(const LabResults& lab) {
    return lab.stress["pass"] == true &&
           std::all_of(lab.questions.begin(), lab.questions.end(),
                       [](const Json& answer) { return answer["pass"] == true; });
}

fs::path resultFile(const fs::path& folder, const LabEntry& entry) {
    return folder / "labs" / entry.folder() / "lab.json";
}

}  // namespace

ExitStatus makeAtlas(std::span<const LabEntry> labs, const AtlasOptions& options) {
    for (const std::string& name : options.labs)
        findLab(labs, name);
    const Site site{options.out.empty() ? "out/atlas" : options.out, assetRoot()};
    requireFolder(site.folder);
    preloadImageIo();
    web::copyAssets(site.folder / "assets", scripts);

    const SurveyOptions survey = options.full ? fullSurvey(options.backend) : quickSurvey(options.backend);
    std::vector<Work> works;
    std::size_t total = 0;
    for (const LabEntry& entry : labs)
        if (isChosen(entry, options.labs)) {
            works.push_back(workOn(entry, survey, site.folder));
            for (const Task& task : works.back().tasks)
                total += works.back().store->has(task.name, works.back().madeOf(task)) ? 0 : task.effort;
        }

    Progress progress("atlas", std::max<std::size_t>(total, 1));
    std::size_t done = 0;
    int measured = 0;
    int written = 0;
    bool pass = true;
    for (Work& work : works) {
        LabResults results{work.entry->folder(),
                           std::string(work.entry->name),
                           work.entry->make()->topic(),
                           work.entry->number,
                           {},
                           {},
                           {},
                           {},
                           {},
                           {}};
        for (const Task& task : work.tasks) {
            progress.note(fmt::format("{} {}", results.folder, task.name));
            const bool there = work.store->has(task.name, work.madeOf(task));
            place(results, task.name, work.store->get(task.name, work.madeOf(task), task.make));
            done += there ? 0 : task.effort;
            progress.update(done);
        }
        measured += work.store->made();
        pass = pass && passes(results);
        web::writeIfChanged(resultFile(site.folder, *work.entry), dump(toJson(results)));
        written += writeLabPage(site, results);
        work.tasks.clear();  // and with them the lab and its context
    }

    // Labs that this call was not asked for stay as an earlier one has left them.
    std::vector<LabResults> all;
    for (const LabEntry& entry : labs)
        if (const fs::path file = resultFile(site.folder, entry); fs::exists(file))
            all.push_back(
                labResultsFrom(Json::parse(readFile(file, mostResultBytes), nullptr, false), file.string()));
    written += writeCommonPages(site, all);

    const fs::path index = site.folder / "index.html";
    if (options.json)
        print(dump({{"index", index.string()},
                    {"labs", works.size()},
                    {"measured", measured},
                    {"pages_written", written},
                    {"pass", pass}}));
    else
        print(fmt::format("{}: {} labs, {} results measured, {} pages written\nopen it in a browser\n",
                          index.string(), works.size(), measured, written));
    if (!pass)
        say("warning: a figure fell short of its bound; the pages show which");
    return pass ? ExitStatus::ok : ExitStatus::checkFellShort;
}

}  // namespace quincunx

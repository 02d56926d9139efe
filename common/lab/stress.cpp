#include "lab/stress.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/progress.h"
#include "lab/json.h"

namespace quincunx {

bool StressResult::pass() const {
    return std::all_of(cases.begin(), cases.end(), [](const Case& one) { return one.pass(); });
}

StressResult runStress(Lab& lab, const LabEntry& entry, std::uint64_t inputs, std::uint64_t seed) {
    StressResult result{entry.folder(), {}};
    const std::vector<HardCase> cases = lab.hardCases();
    Progress progress(entry.folder() + " stress", std::max<std::size_t>(cases.size(), 1));
    for (const HardCase& hardCase : cases) {
        result.cases.push_back({hardCase, hardCase.run(inputs, seed)});
        progress.update(result.cases.size());
    }
    return result;
}

std::string toTable(const StressResult& result) {
    std::string text = fmt::format("{}\n\n  {:<22} {:<54} {:>9} {:>9} {:>11} {:>11} {:>9}\n", result.lab,
                                   "routine", "hard input", "inputs", "naive", "naive", "stable", "bound");
    text +=
        fmt::format("  {:<22} {:<54} {:>9} {:>9} {:>11} {:>11}\n", "", "", "", "failures", "error", "error");
    for (const StressResult::Case& one : result.cases) {
        const HardCaseFigures& figures = one.figures;
        text +=
            fmt::format("  {:<22} {:<54} {:>9} {:>9} {:>11.4g} {:>11.4g} {:>9.3g}  {}{}\n",
                        one.hardCase.routine, one.hardCase.hardInput, figures.inputs, figures.naiveFailures,
                        figures.naiveError, figures.stableError, one.hardCase.bound, one.hardCase.unit,
                        one.pass() ? ""
                                   : fmt::format("  FELL SHORT ({} failures) at {}", figures.stableFailures,
                                                 figures.worstInput));
    }
    return text;
}

Json toJson(const StressResult& result) {
    Json cases = Json::array();
    for (const StressResult::Case& one : result.cases)
        cases.push_back({{"routine", one.hardCase.routine},
                         {"hard_input", one.hardCase.hardInput},
                         {"inputs", one.figures.inputs},
                         {"naive_failures", one.figures.naiveFailures},
                         {"naive_error", one.figures.naiveError},
                         {"stable_failures", one.figures.stableFailures},
                         {"stable_error", one.figures.stableError},
                         {"unit", one.hardCase.unit},
                         {"bound", one.hardCase.bound},
                         {"source", one.hardCase.source},
                         {"pass", one.pass()}});
    return {{"lab", result.lab}, {"cases", cases}, {"pass", result.pass()}};
}

}  // namespace quincunx

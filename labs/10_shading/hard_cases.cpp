#include "math/hard_cases.h"

#include "labs/10_shading/lab.h"

namespace quincunx {

std::vector<HardCase> ShadingLab::hardCases() {
    std::vector<HardCase> cases;
    for (const NumericHardCase& hard : shadingHardCases())
        cases.push_back({hard.routine, hard.hardInput, hard.unit, hard.bound, hard.source,
                         [run = hard.run](std::uint64_t inputs, std::uint64_t seed) {
                             const HardCaseFigures figures = run(inputs, seed);
                             return HardCase::Result{figures.inputs, figures.naiveError, figures.stableError,
                                                     figures.worstInput};
                         }});
    return cases;
}

}  // namespace quincunx

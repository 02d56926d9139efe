#include "labs/27_path_tracing/lab.h"
#include "trace/path_hard_cases.h"
#include "trace/scattering_hard_cases.h"

namespace quincunx {

std::vector<HardCase> PathTracingLab::hardCases() {
    std::vector<HardCase> cases;
    for (const std::span<const HardCase> part :
         {pathHardCases(), boundaryHardCases(), microfacetHardCases(), samplingHardCases()})
        cases.insert(cases.end(), part.begin(), part.end());
    return cases;
}

}  // namespace quincunx

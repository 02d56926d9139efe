#include "math/hard_cases.h"

#include "labs/10_shading/lab.h"

namespace quincunx {

std::vector<HardCase> ShadingLab::hardCases() {
    const std::span<const HardCase> cases = shadingHardCases();
    return {cases.begin(), cases.end()};
}

}  // namespace quincunx

#include "math/hard_cases.h"

#include "labs/01_transforms/lab.h"
#include "math/transform_hard_cases.h"

namespace quincunx {

std::vector<HardCase> TransformsLab::hardCases() {
    const std::span<const HardCase> transforms = transformHardCases();
    std::vector<HardCase> cases(transforms.begin(), transforms.end());
    const std::span<const HardCase> frames = frameHardCases();
    cases.insert(cases.end(), frames.begin(), frames.end());
    return cases;
}

}  // namespace quincunx

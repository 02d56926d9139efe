#include <span>

#include "labs/03_rotations/lab.h"
#include "math/rotation_hard_cases.h"

namespace quincunx {

std::vector<HardCase> RotationsLab::hardCases() {
    std::vector<HardCase> all;
    for (const std::span<const HardCase> cases : {quaternionHardCases(), orientationHardCases()})
        all.insert(all.end(), cases.begin(), cases.end());
    return all;
}

}  // namespace quincunx

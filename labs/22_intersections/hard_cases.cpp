#include "geometry/intersection_hard_cases.h"
#include "geometry/triangle_hard_cases.h"
#include "labs/22_intersections/lab.h"

namespace quincunx {

std::vector<HardCase> IntersectionsLab::hardCases() {
    std::vector<HardCase> cases;
    for (const std::span<const HardCase> part : {intersectionHardCases(), triangleHardCases()})
        cases.insert(cases.end(), part.begin(), part.end());
    return cases;
}

}  // namespace quincunx

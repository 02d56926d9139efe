#include "math/hard_cases.h"

#include "labs/02_car_camera/lab.h"
#include "math/rigid_motion_hard_cases.h"

namespace quincunx {

std::vector<HardCase> CarCameraLab::hardCases() {
    const std::span<const HardCase> motions = rigidMotionHardCases();
    std::vector<HardCase> cases(motions.begin(), motions.end());
    // Cameras from above look straight down, along what elsewhere is up.
    for (const HardCase& one : frameHardCases())
        if (std::string_view(one.routine) == "lookAt")
            cases.push_back(one);
    return cases;
}

}  // namespace quincunx

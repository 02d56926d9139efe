#include "labs/16_shadow_maps/lab.h"

namespace quincunx {

std::vector<Question> ShadowMapLab::questions() {
    return {};
}

std::vector<Sweep> ShadowMapLab::sweeps() {
    return {};
}

std::vector<HardCase> ShadowMapLab::hardCases() {
    return {};
}

}  // namespace quincunx

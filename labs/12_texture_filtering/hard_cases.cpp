#include "image/texture_hard_cases.h"
#include "labs/12_texture_filtering/lab.h"

namespace quincunx {

std::vector<HardCase> TextureFilteringLab::hardCases() {
    const std::span<const HardCase> cases = textureHardCases();
    return {cases.begin(), cases.end()};
}

}  // namespace quincunx

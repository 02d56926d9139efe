#include "labs/12_texture_filtering/lab.h"

namespace quincunx {
std::vector<HardCase> TextureFilteringLab::hardCases() {
    return {};
}
}  // namespace quincunx

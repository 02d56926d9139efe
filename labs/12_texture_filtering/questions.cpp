#include "labs/12_texture_filtering/lab.h"

namespace quincunx {
std::vector<Question> TextureFilteringLab::questions() {
    return {};
}
std::vector<Sweep> TextureFilteringLab::sweeps() {
    return {};
}
std::vector<HardCase> TextureFilteringLab::hardCases() {
    return {};
}
}  // namespace quincunx

#include "labs/21_accumulation/lab.h"

namespace quincunx {
std::vector<HardCase> AccumulationLab::hardCases() {
    return {};
}
}  // namespace quincunx

#include "labs/21_accumulation/lab.h"

namespace quincunx {
std::vector<Question> AccumulationLab::questions() {
    return {};
}
std::vector<Sweep> AccumulationLab::sweeps() {
    return {};
}
std::vector<HardCase> AccumulationLab::hardCases() {
    return {};
}
}  // namespace quincunx

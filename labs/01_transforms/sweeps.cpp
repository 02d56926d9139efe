#include "labs/01_transforms/lab.h"
namespace quincunx {
std::vector<Sweep> TransformsLab::sweeps() {
    return {};
}
}  // namespace quincunx

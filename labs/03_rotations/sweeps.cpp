#include "labs/03_rotations/lab.h"
namespace quincunx {
std::vector<Sweep> RotationsLab::sweeps() {
    return {};
}
std::vector<Question> RotationsLab::questions() {
    return {};
}
}  // namespace quincunx

#include "labs/22_intersections/lab.h"
namespace quincunx {
std::vector<Question> IntersectionsLab::questions() {
    return {};
}
std::vector<Sweep> IntersectionsLab::sweeps() {
    return {};
}
}  // namespace quincunx

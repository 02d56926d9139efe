#include "lab/lab.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace quincunx {

bool Bound::holds(double measured) const {
    switch (kind) {
        case Kind::atMost:
            return measured <= value;
        case Kind::atLeast:
            return measured >= value;
        case Kind::equals:
            return std::abs(measured - value) <= tolerance;
    }
    return false;
}

std::string Bound::text() const {
    switch (kind) {
        case Kind::atMost:
            return fmt::format("≤ {:.4g}", value);
        case Kind::atLeast:
            return fmt::format("≥ {:.4g}", value);
        case Kind::equals:
            return tolerance == 0 ? fmt::format("= {:.6g}", value)
                                  : fmt::format("= {:.6g} ± {:.2g}", value, tolerance);
    }
    return {};
}

// Those who take a scene keep it.
// NOLINTNEXTLINE(performance-unnecessary-value-param)
void Lab::useScene(Scene) {
    throw InputError("this lab draws its own scene only", "--model", "leave --model out");
}

Lab::ReferenceJob Lab::reference(const Frame&) const {
    return {};
}

bool LabEntry::isCalled(std::string_view word) const {
    return word == name || word == folder() || word == std::to_string(number);
}

std::string LabEntry::folder() const {
    return fmt::format("{:02}_{}", number, name);
}

}  // namespace quincunx

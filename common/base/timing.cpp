#include "base/timing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/check.h"

namespace quincunx {

Timing timingOf(std::vector<double> seconds) {
    QX_CHECK(!seconds.empty());
    std::sort(seconds.begin(), seconds.end());
    const auto quantile = [&](double q) {
        return seconds[static_cast<std::size_t>(std::lround(q * static_cast<double>(seconds.size() - 1)))];
    };
    return {quantile(0.5), quantile(0.75) - quantile(0.25)};
}

}  // namespace quincunx

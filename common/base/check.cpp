#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace quincunx::detail {

void checkFailed(std::string_view expression, std::string_view values, std::string_view file, int line) {
    fmt::print(stderr, "{}:{}: check failed: {} ({})\n", file, line, expression, values);
    std::fflush(stderr);
    std::abort();
}

}  // namespace quincunx::detail

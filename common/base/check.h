#pragma once

#include <string>
#include <string_view>

#include <fmt/format.h>

/// Checks for bugs in the program itself: they print what was compared and stop. What the world may get
/// wrong (files, shaders, drivers, memory) is reported by the exceptions of base/error.h instead.
namespace quincunx::detail {

[[noreturn]] void checkFailed(std::string_view expression, std::string_view values, std::string_view file,
                              int line);

template <typename A, typename B>
std::string bothValues(const A& a, const B& b) {
    if constexpr (fmt::is_formattable<A>::value && fmt::is_formattable<B>::value)
        return fmt::format("{} against {}", a, b);
    else
        return "values that cannot be printed";
}

}  // namespace quincunx::detail

/// Stops the program unless `condition` holds.
#define QX_CHECK(condition)                                                           \
    do {                                                                              \
        if (!(condition)) [[unlikely]]                                                \
            ::quincunx::detail::checkFailed(#condition, "false", __FILE__, __LINE__); \
    } while (false)

#define QX_CHECK_OP(a, op, b)                                                                            \
    do {                                                                                                 \
        const auto& qxLeft = (a);                                                                        \
        const auto& qxRight = (b);                                                                       \
        if (!(qxLeft op qxRight)) [[unlikely]]                                                           \
            ::quincunx::detail::checkFailed(                                                             \
                #a " " #op " " #b, ::quincunx::detail::bothValues(qxLeft, qxRight), __FILE__, __LINE__); \
    } while (false)

/// Comparisons that print both sides when they fail.
#define QX_CHECK_EQ(a, b) QX_CHECK_OP(a, ==, b)
#define QX_CHECK_NE(a, b) QX_CHECK_OP(a, !=, b)
#define QX_CHECK_LT(a, b) QX_CHECK_OP(a, <, b)
#define QX_CHECK_LE(a, b) QX_CHECK_OP(a, <=, b)
#define QX_CHECK_GT(a, b) QX_CHECK_OP(a, >, b)
#define QX_CHECK_GE(a, b) QX_CHECK_OP(a, >=, b)

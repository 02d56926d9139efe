#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <fmt/format.h>

namespace quincunx {

/// The naive and the stable form of a routine on the same hard inputs, each against the exact value. An input
/// is a failure of a form if what the form gives cannot be measured: not finite where the exact value is, an
/// answer where there is none, none where there is one, the wrong one of two. Failures are counted apart and
/// never enter the errors.
struct HardCaseFigures {
    std::uint64_t inputs = 0;
    std::uint64_t naiveFailures = 0;
    double naiveError = 0;  ///< the worst of the rest
    std::uint64_t stableFailures = 0;
    double stableError = 0;  ///< the worst of the rest
    std::string worstInput;  ///< of the stable form, in hexadecimal floating point
};

/// A numeric routine with inputs that break its textbook form.
struct HardCase {
    const char* routine;
    const char* hardInput;
    const char* unit;    ///< of the errors
    double bound;        ///< what `stableError` must not exceed: the bound of the routine's header
    const char* source;  ///< of the stable form
    /// The same seed gives the same figures. 10⁶ inputs take seconds of a core.
    HardCaseFigures (*run)(std::uint64_t inputs, std::uint64_t seed);

    bool holds(const HardCaseFigures& figures) const {
        return figures.stableFailures == 0 && figures.stableError <= bound;
    }
};

/// The larger of two errors; one that is not a number counts as infinite.
inline double worse(double a, double b) {
    return std::isnan(a) || std::isnan(b) ? std::numeric_limits<double>::infinity() : std::max(a, b);
}

/// A vector of three as hexadecimal floating point, for `worstInput`.
template <typename V>
std::string hexVector(const V& v) {
    return fmt::format("({:a},{:a},{:a})", v.x, v.y, v.z);
}

/// Collects the figures of a run.
class Tally {
  public:
    /// Errors that are infinite or not numbers are failures. `describe` writes the input down as a string,
    /// called only for a new worst one.
    template <typename Describe>
    void add(double naiveError, double stableError, const Describe& describe) {
        if (std::isfinite(naiveError))
            figures_.naiveError = std::max(figures_.naiveError, naiveError);
        else
            ++figures_.naiveFailures;
        const bool fails = !std::isfinite(stableError);
        const bool worst = fails ? figures_.stableFailures == 0
                                 : figures_.stableFailures == 0 &&
                                       (figures_.inputs == 0 || stableError > figures_.stableError);
        if (fails)
            ++figures_.stableFailures;
        else
            figures_.stableError = std::max(figures_.stableError, stableError);
        if (worst)
            figures_.worstInput = describe();
        ++figures_.inputs;
    }

    const HardCaseFigures& figures() const { return figures_; }

  private:
    HardCaseFigures figures_;
};

}  // namespace quincunx

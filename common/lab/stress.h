#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lab/lab.h"

namespace quincunx {

/// How many inputs a routine gets: as a rule, and where patience allows.
inline constexpr std::uint64_t quickStressInputs = 20'000;
inline constexpr std::uint64_t fullStressInputs = 1'000'000;

/// The hard cases of a lab with what its routines made of them.
struct StressResult {
    struct Case {
        HardCase hardCase;
        HardCaseFigures figures;
        bool pass() const { return hardCase.holds(figures); }
    };
    std::string lab;  ///< folder name
    std::vector<Case> cases;

    bool pass() const;
};

/// Runs all hard cases of the lab, with progress. The same seed gives the same figures.
StressResult runStress(Lab& lab, const LabEntry& entry, std::uint64_t inputs, std::uint64_t seed);

std::string toTable(const StressResult& result);
nlohmann::ordered_json toJson(const StressResult& result);

}  // namespace quincunx

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lab/studio.h"

namespace quincunx {

struct SweepPoint {
    KnobValues knobs;
    SweepSample sample;
    bool pareto = false;  ///< no other point is both faster and more accurate
};

struct SweepResult {
    std::string lab;
    std::string name;
    std::string title;
    std::string reference;
    std::string metric;
    std::string errorUnit;
    std::string renderer;
    std::vector<SweepPoint> points;
};

/// Measures every point of a sweep in `frame`, with progress; the lab's knobs are put back afterwards.
SweepResult runSweep(Lab& lab, const LabEntry& entry, const Sweep& sweep, Studio& studio, const Frame& frame);

/// Marks the points that no other point beats: at most as slow and at most as wrong, and better in one of
/// them.
void markParetoFront(std::vector<SweepPoint>& points);

/// The fastest point within `maxError`, or the most accurate within `budgetSeconds`, or, with both given, the
/// most accurate that keeps both. Nothing if no point does.
std::optional<std::size_t> choosePoint(const std::vector<SweepPoint>& points,
                                       std::optional<double> budgetSeconds, std::optional<double> maxError);

std::string toTable(const SweepResult& result);
std::string toCsv(const SweepResult& result);
nlohmann::ordered_json toJson(const SweepResult& result);
/// An object of names and values.
nlohmann::ordered_json toJson(const KnobValues& knobs);

}  // namespace quincunx

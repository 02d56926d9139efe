#pragma once

#include <filesystem>

#include "lab/sweep.h"

namespace quincunx {

/// Draws error against time as SVG, log–log: one colour for each value of the first knob, every point
/// labelled with its other knobs, the Pareto front, the lab, the units and the machine's renderer. Uses
/// gnuplot; EnvironmentError where that is missing.
void writePlotSvg(const SweepResult& result, const std::filesystem::path& file);

}  // namespace quincunx

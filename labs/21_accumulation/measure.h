#pragma once

#include <cstddef>
#include <vector>

#include "lab/studio.h"
#include "labs/21_accumulation/lab.h"

/// What the lab's answers, sweeps and tests measure alike.
namespace quincunx {

/// RMSE of the lab's edge, as the knobs are, against its closed form.
double edgeError(AccumulationLab& lab, Studio& studio, int width, int height, std::uint64_t seed = 1);

/// The same as a root mean square over seeds, for each number of passes; the slope of its logarithm over
/// theirs is fitted by least squares.
struct Convergence {
    std::vector<double> errors;
    double slope = 0;
};
Convergence convergenceOf(AccumulationLab& lab, Studio& studio, SamplePattern pattern,
                          const std::vector<int>& passes, int seeds);
double fittedSlope(const std::vector<int>& passes, const std::vector<double>& errors);

/// The mean that the accumulator shows of so many frames of one grey, each of the same value; one pixel.
double meanOfSameFrames(Studio& studio, const Accumulator::Params& params, float value);

/// The lab as it is with so many Sobol' passes of another seed than pictures have.
Image convergedPicture(AccumulationLab& lab, Studio& studio, const Frame& frame, int passes);

}  // namespace quincunx

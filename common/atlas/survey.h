#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "atlas/store.h"
#include "gl/context.h"
#include "lab/lab.h"

namespace quincunx::atlas {

/// How thorough a survey is.
struct SurveyOptions {
    gl::Backend backend = gl::Backend::automatic;
    int pictureWidth = 400;   ///< pixels, of the pictures of settings
    int pictureHeight = 300;  ///< pixels
    int steps = 1;            ///< values of a number on either side of its default
    /// Values of a number are left out whose picture would take longer, were its time to grow with the value.
    double patienceSeconds = 1;
    double sweepScale = 0.3;  ///< of the sizes that sweeps ask for, down to 120 pixels
    int planFrames = 2;       ///< that each variant of the plan is timed over
    std::uint64_t stressInputs = 0;
};

SurveyOptions quickSurvey(gl::Backend backend);
SurveyOptions fullSurvey(gl::Backend backend);

/// One result of a lab: a picture, a knob, a sweep …
struct Task {
    std::string name;        ///< of the piece in the store
    std::string settings;    ///< all of the options that its result depends on
    std::size_t effort = 1;  ///< against that of other tasks, a guess
    std::function<Piece()> make;
};

/// All that is to be found out about a lab. Tasks keep what they share; they are to be called one after
/// another, and may be left out. `store` must outlive them; pictures go into its folder.
std::vector<Task> surveyOf(const LabEntry& entry, const SurveyOptions& options, const Store& store);

/// Values of a knob to show beside one another, its default among them, in rising order or as declared:
/// all of a choice; of a number the default and up to 2 · `steps` others, nearer ones first where it is
/// logarithmic; nothing of texts.
std::vector<std::string> valuesToShow(Knob& knob, int steps);

}  // namespace quincunx::atlas

#pragma once

#include <filesystem>

#include "lab/lab.h"
#include "lab/picture_state.h"

namespace quincunx {

struct WindowOptions {
    std::filesystem::path pictureFolder = "out";  ///< where the screenshot key writes
    std::filesystem::path record;                 ///< where the state is written at the end; empty: nowhere
};

/// Opens a window on the lab: the picture, the panel with a control for each knob, the time of a frame, the
/// error against the lab's reference, orbit and fly cameras, screenshots, reload of edited shaders. Starts
/// from `state` and returns when the window is closed. EnvironmentError where there is no display.
void runWindow(Lab& lab, const LabEntry& entry, PictureState state, const WindowOptions& options);

}  // namespace quincunx

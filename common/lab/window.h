#pragma once

#include <filesystem>
#include <functional>

#include "lab/lab.h"
#include "lab/picture_state.h"

namespace quincunx {

struct WindowOptions {
    std::filesystem::path pictureFolder = "out";  ///< where the screenshot key writes
    std::filesystem::path record;                 ///< where the state is written at the end; empty: nowhere
    int width = 960;                              ///< of the picture at first, pixels
    int height = 720;                             ///< of the picture at first, pixels
    /// The scene is still being read when the window opens: meanwhile the lab's programs are made ready by
    /// drawing its own scene.
    bool sceneIsComing = false;
};

/// Opens a window on the lab: the picture, the panel with a control for each knob, the time of a frame, the
/// error against the lab's reference, orbit and fly cameras, screenshots, reload of edited shaders. Starts
/// from what `begin` returns, which is called once, when the window is there, and returns when the window is
/// closed. EnvironmentError where there is no display.
void runWindow(Lab& lab, const LabEntry& entry, const std::function<PictureState()>& begin,
               const WindowOptions& options);

}  // namespace quincunx

#pragma once

#include <span>
#include <string>
#include <vector>

#include "lab/knob.h"

namespace quincunx {

/// Where things are in the panel, in points: screen coordinates of a display of scale 1. The panel is at the
/// right edge of the window and as high as it; the first knob's control is at a fixed place and the others
/// follow at equal steps, so that a hand, or a test, finds them.
struct PanelLayout {
    static constexpr float width = 348;
    static constexpr float knobTop = 70;     ///< upper edge of the first control
    static constexpr float knobStep = 27;    ///< from one control to the next
    static constexpr float knobHeight = 23;  ///< of a control
    static constexpr float knobLeft = 138;   ///< left edge of the controls, from that of the panel
    static constexpr float knobWidth = 170;
    static constexpr float resetLeft = 313;  ///< of the buttons that put a knob back
    static constexpr float resetWidth = 23;
};

/// What the panel tells.
struct PanelText {
    std::string title;
    std::string topic;
    std::vector<std::pair<std::string, std::string>> facts;  ///< frame time, error and the like
    std::string camera;
};

/// One line of the help.
struct KeyHelp {
    std::string keys;
    std::string what;
};

/// A small picture over the large one, by its GL name.
struct InsetPicture {
    unsigned int texture = 0;
    int width = 0;   ///< pixels
    int height = 0;  ///< pixels
    std::string caption;
};

/// What the person did.
struct PanelActions {
    bool knobsChanged = false;
    bool helpWanted = false;
};

/// Colours, roundings and the font for a display: `pointsToScreen` screen coordinates are a point,
/// `screenToPixels` pixels a screen coordinate. Replaces an earlier style; the font's texture must be made
/// anew after.
void applyStyle(float pointsToScreen, float screenToPixels);

/// Draws the panel with a control for every knob, and changes the knobs as the person does.
PanelActions drawPanel(KnobSet& knobs, const PanelText& text, float pointsToScreen);

/// A picture with its caption in the lower left, a third as wide as the lab's picture, which is
/// `pictureWidth` screen coordinates wide.
void drawInset(const InsetPicture& picture, float pictureWidth, float pointsToScreen);

/// What was done last ("wrote out/x.png") and, red, what went wrong; either may be empty. At the foot of the
/// panel or, where that is hidden, of the picture: always in sight.
void drawMessages(const std::string& notice, const std::string& fault, bool onPanel, float pointsToScreen);

/// The list of keys over the picture, `pictureWidth` screen coordinates wide.
void drawHelp(std::span<const KeyHelp> keys, float pictureWidth, float pointsToScreen);

}  // namespace quincunx

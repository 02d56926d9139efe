#pragma once

#include <vector>

#include "grade/rubric.h"
#include "lab/studio.h"

namespace quincunx::grade {

/// A picture that shaders are looked at in.
struct View {
    KnobValues knobs;
    Frame frame;
};

/// Settings and cameras that a student has not seen: the lab's own camera and two others round the middle of
/// the scene, with the knobs of the exercise, and the exercise's further scenes.
std::vector<View> unseenViews(const Lab& lab, const Exercise& exercise, const Rubric& rubric);

/// Draws a view; the lab's knobs are as before afterwards.
Image8 drawView(Studio& studio, Lab& lab, const View& view);

/// The camera carried about the upright axis through `centre` and lifted, both by angles in radians, still
/// looking the same way relative to that centre.
Camera turnedAbout(const Camera& camera, const glm::vec3& centre, float aboutUp, float upwards);

}  // namespace quincunx::grade

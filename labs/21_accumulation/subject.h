#pragma once

#include <functional>

#include "image/image.h"
#include "passes/accumulation.h"
#include "scene/scene.h"

namespace quincunx {

/// What is accumulated: the toys, or a straight edge that one effect blurs, in closed form.
enum class Subject { toys, edge, movingEdge, turningEdge, defocusedEdge, penumbra };

/// The sheet with the edge and the camera before it; not for the toys. Sheets shine with radiance 1 before
/// nothing; the penumbra falls on a floor below a lamp, seen from between floor and sheet. Where something
/// moves, the edge passes the middle 2 seconds after the start.
Scene makeSubject(Subject subject);

/// The only effect that an edge shows; all for the toys.
AccumulatedEffects effectsOf(Subject subject);

/// What of an edge's picture depends on.
struct EdgeSettings {
    Subject subject = Subject::edge;
    Camera camera;  ///< that of the scene, with its lens
    AreaLight lamp;
    double seconds = 2;
    double shutterSeconds = 0;
};

/// The converged picture of an edge: one channel, what share of pixel, shutter, lens or lamp sees the sheet,
/// or the lamp, at the pixel's centre. Computed in double.
Image exactEdge(const EdgeSettings& settings, int width, int height);

/// The share of a disc of radius 1 about 0 where x ≥ cut, and of the square of half side 1.
double shareOfDisc(double cut);
double shareOfSquare(double cut);

/// The share of the unit square's points with n·p ≤ d: how much of a pixel a half-plane covers.
double coverage(glm::dvec2 n, double d);

}  // namespace quincunx

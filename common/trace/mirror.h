#pragma once

#include <atomic>

#include <glm/glm.hpp>

#include "image/image.h"
#include "scene/mirror_hall.h"

namespace quincunx {

/// Which mirrors are there.
struct MirrorsSeen {
    bool ball = true;
    bool panel = true;
};

/// The picture with true reflections: one ray through each pixel's centre against the surfaces themselves;
/// where it meets a mirror first it goes on once, along its mirror image, and what that ray meets is seen
/// times the mirror's tint. Mirrors do not see one another or themselves. All other surfaces are matt:
///   L = emission + ambient ⊙ ambientLight + Σ over lights of E ⊙ diffuse max(0, n·l),
/// E as in trace/reference.h, without shadows. Black where nothing is met. RGBA (A = 1), linear, the same on
/// any number of threads. When `stop` becomes true, the remaining rows are left at zero.
Image traceMirrors(const MirrorHall& hall, const Camera& camera, int width, int height,
                   MirrorsSeen mirrors = {}, const std::atomic<bool>* stop = nullptr);

/// What a mirror does at each pixel: the unit direction in which its ray goes on, world space, and which
/// mirror it is (0 none, 1 the ball, 2 the panel). Four channels.
Image traceReflectionVectors(const MirrorHall& hall, const Camera& camera, int width, int height,
                             MirrorsSeen mirrors = {});

/// How far a lookup by the reflection vector alone is off: the angle, in radians, between that vector and the
/// direction in which what the mirror shows lies from `mapPosition`. Four channels: the angle, 0, 0, and
/// which mirror.
Image traceLookupAngles(const MirrorHall& hall, const Camera& camera, int width, int height,
                        glm::vec3 mapPosition, MirrorsSeen mirrors = {});

/// All that is seen from a point, the mirrors left out, as a panorama: laid out as panoramaDirection in
/// shaders/lib/environment_math.glsl. `samples` along a side of a pixel, averaged. RGBA, linear.
Image tracePanorama(const MirrorHall& hall, glm::vec3 position, int width, int height, int samples = 2,
                    const std::atomic<bool>* stop = nullptr);

}  // namespace quincunx

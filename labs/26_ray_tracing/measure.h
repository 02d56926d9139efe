#pragma once

#include <cstdint>
#include <vector>

#include "labs/26_ray_tracing/lab.h"

namespace quincunx {

/// Settings under which only the end of the recursion is left to vary: the lamp's sample does not depend on
/// the seed.
WhittedSettings recursionSettings(RecursionEnd end, int maxDepth, float minWeight, std::uint64_t seed = 1);
/// Nothing of the tree is cut but what weighs less than 2^-16 of its pixel.
Image recursionReference(const WhittedScene& scene, const Camera& camera, int width, int height);
/// Of all pixels' luminance.
double meanLuminance(const Image& image);

/// Rays through the pixels of a picture and, from what they meet, towards the lamp: what a grid is asked.
std::vector<Ray> raysOfPicture(const WhittedScene& scene, const Camera& camera, int width, int height);

}  // namespace quincunx

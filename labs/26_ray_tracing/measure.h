#pragma once

#include <cstdint>
#include <vector>

#include "labs/26_ray_tracing/lab.h"
#include "labs/26_ray_tracing/mailbox_grid.h"

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

/// How mailboxes are kept while a grid is walked.
enum class Mailing { none, perThread, shared };
struct MailingFigures {
    std::uint64_t tests = 0;      ///< rays against triangles
    std::uint64_t wrongHits = 0;  ///< against those without mailboxes
};
/// As `threads` threads would walk, a cell each in turn, so that the figures repeat; `shared`: all write to
/// the same boxes.
MailingFigures walkGrid(const MailboxGrid& grid, const std::vector<Ray>& rays, Mailing mailing, int threads);

}  // namespace quincunx

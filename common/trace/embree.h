#pragma once

#include <memory>

#include "trace/accelerator.h"

namespace quincunx {

/// Whether Embree 3 was there when this was built, and its library can be loaded now.
bool isEmbreeAvailable();

/// Embree's tree and traversal (Wald, Woop, Benthin, Johnson, Ernst, "Embree: a kernel framework for
/// efficient CPU ray tracing", SIGGRAPH 2014) around our test of triangles: Embree is given boxes, a little
/// larger than the triangles', in its robust mode, and asks back for each that a ray meets. So the hits are
/// the same as of the others; its own test of triangles misses some at edges and corners.
/// It takes components of the direction below 10^-18 for 10^-18. The boxes are larger by 2^-24 of the longest
/// side of all, so that this loses none for directions of 2^-10 … 2^30 along their longest axis, from up to
/// 2^12 such sides away. Other rays are tested against every triangle.
/// Throws EnvironmentError where it is not available.
std::unique_ptr<Accelerator> makeEmbree(TriangleView triangles);

}  // namespace quincunx

#pragma once

#include "base/random.h"
#include "scene/scene.h"

namespace quincunx::test {

/// A scene with something of everything that a glTF file can hold, different for every seed: nothing in it
/// is left over, and all of it is as `exportScene` keeps it.
Scene randomScene(std::uint64_t seed);

}  // namespace quincunx::test

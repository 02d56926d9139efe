#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "gl/context.h"
#include "lab/lab.h"

namespace quincunx {

struct AtlasOptions {
    gl::Backend backend = gl::Backend::automatic;
    std::vector<std::string> labs;  ///< only these; empty: all
    std::string out;                ///< folder; empty: out/atlas
    bool full = false;  ///< more values of each knob, more inputs of the hard cases, larger pictures
    bool json = false;
};

/// The verb `atlas`: everything that the labs show and measure as a static site, which opens from disk and
/// fetches nothing. What is there already and still true is kept (atlas/store.h), so that a call that was
/// interrupted is gone on with by the same call.
ExitStatus makeAtlas(std::span<const LabEntry> labs, const AtlasOptions& options);

}  // namespace quincunx

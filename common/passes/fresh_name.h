#pragma once

#include <string>

#include "graph/graph.h"

namespace quincunx {

/// The stem, or with a number after it if resources of that stem are there: an effect can be added twice.
std::string freshName(const graph::FrameGraph& graph, const std::string& stem);

}  // namespace quincunx

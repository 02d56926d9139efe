#include "passes/fresh_name.h"

#include <fmt/format.h>

namespace quincunx {

std::string freshName(const graph::FrameGraph& graph, const std::string& stem) {
    int count = 1;
    for (std::size_t i = 0; i < graph.resourceCount(); ++i)
        if (graph.resource({i}).name.starts_with(stem))
            ++count;
    return count == 1 ? stem : fmt::format("{} {}", stem, count);
}

}  // namespace quincunx

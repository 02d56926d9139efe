#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "graph/graph.h"

namespace quincunx::graph {

/// What a running pass sees: its targets are bound, its inputs can be sampled.
class PassContext {
  public:
    virtual ~PassContext() = default;
    /// The texture of a resource that the pass declared as read or written; a check fails otherwise.
    virtual const gl::Texture2D& texture(Resource resource) const = 0;
    /// Programs shared by all passes and frames.
    virtual gl::ProgramCache& programs() = 0;
};

}  // namespace quincunx::graph

namespace quincunx::gl {

/// Runs frame graphs on the current context, and keeps targets from one frame to the next.
class Executor {
  public:
    /// Runs what the graph's outputs need. The outputs stay readable until the next call.
    void run(const graph::FrameGraph& graph);
    /// The texture that holds an output of the last run.
    const Texture2D& output(graph::Resource resource) const;
    ProgramCache& programs() { return programs_; }
    /// Bytes of all targets kept.
    std::size_t targetBytes() const;

  private:
    struct Target {
        std::unique_ptr<Texture2D> texture;
        bool inUse = false;
    };
    std::vector<Target> pool_;
    std::map<std::vector<GLuint>, Framebuffer> framebuffers_;
    std::vector<const Texture2D*> byResource_;
    ProgramCache programs_;
};

}  // namespace quincunx::gl

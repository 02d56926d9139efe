#pragma once

#include <cstdint>
#include <list>
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
    /// Samplers, the same.
    virtual const gl::Sampler& sampler(const gl::Sampler::Params& params) = 0;
    /// One triangle over the whole target, for programs with passes/fullscreen.vert. Leaves an empty vertex
    /// array bound.
    virtual void drawFullscreen() = 0;
};

}  // namespace quincunx::graph

namespace quincunx::gl {

/// The GL format of a resource's texels.
GLenum internalFormat(graph::Format format);

/// Runs frame graphs on the current context, and keeps targets from one frame to the next; those that some
/// frames had no use for are freed.
class Executor {
  public:
    /// Runs what the graph's outputs need. The outputs stay readable until the next call. Each pass finds its
    /// targets bound with undefined contents (it clears them itself), the viewport set to their size, and
    /// GL_FRAMEBUFFER_SRGB enabled, which encodes what is drawn into sRGB formats and leaves others alone;
    /// all other state is what the pass before left. An error in a pass is thrown with the pass' name, as the
    /// same type.
    void run(const graph::FrameGraph& graph);

    /// What a pass of the last run took, from glFinish to glFinish.
    struct PassCost {
        std::string pass;
        std::uint64_t glCalls = 0;
        double seconds = 0;
    };
    /// Runs as `run` does, but waits for the device after each pass.
    std::vector<PassCost> runMeasured(const graph::FrameGraph& graph);
    /// The texture that holds an output of the last run; a check fails for other resources.
    const Texture2D& output(graph::Resource resource) const;
    ProgramCache& programs() { return programs_; }
    /// Bytes of all targets kept.
    std::size_t targetBytes() const;

  private:
    struct Target {
        Texture2D texture;
        std::size_t bytes = 0;
        std::uint64_t lastFrame = 0;
    };

    void run(const graph::FrameGraph& graph, std::vector<PassCost>* costs);
    const Texture2D& takeTarget(const graph::ResourceDescription& resource);
    const Framebuffer& framebufferFor(const graph::FrameGraph& graph, const graph::PassDescription& pass);
    void dropUnusedTargets();

    std::uint64_t frame_ = 0;
    std::list<Target> pool_;
    std::map<std::vector<GLuint>, Framebuffer> framebuffers_;  ///< by the textures' names, depth last
    std::vector<const Texture2D*> byResource_;                 ///< null where the last run had no use for one
    std::vector<bool> isOutput_;
    ProgramCache programs_;
    std::map<Sampler::Params, Sampler> samplers_;
    VertexArray noAttributes_{"no attributes"};
};

}  // namespace quincunx::gl

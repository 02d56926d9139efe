#pragma once

#include <memory>
#include <string_view>

#include "base/timing.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "lab/lab.h"

namespace quincunx {

/// Draws labs without a window: for pictures, sweeps, answers and tests. The context is made when something
/// is first drawn, so that answers that need no picture need no OpenGL.
class Studio {
  public:
    explicit Studio(gl::Backend backend) : backend_(backend) {}
    ~Studio();

    /// The picture as people see it: 8-bit RGBA, sRGB.
    Image8 picture(Lab& lab, const Frame& frame);
    /// The same in linear light, RGBA float.
    Image linearPicture(Lab& lab, const Frame& frame);
    /// A named intermediate resource of the frame, RGBA float. A name there is not is an InputError listing
    /// them.
    Image resource(Lab& lab, const Frame& frame, std::string_view name);

    /// How long the frame of the last `picture` or `linearPicture` took, around glFinish, read-back apart.
    double pictureSeconds() const { return pictureSeconds_; }

    /// Time of a frame, around glFinish: `warmUps` frames first, then the median and the interquartile range
    /// of `repeats`.
    using Timing = quincunx::Timing;
    Timing time(Lab& lab, const Frame& frame, int repeats = 9, int warmUps = 2);

    /// What a frame asks of the device once it is warm.
    struct FrameCost {
        std::vector<gl::Executor::PassCost> passes;  ///< as a median over `repeats` frames, each
        std::uint64_t glCalls = 0;                   ///< of the whole frame
        std::size_t targetBytes = 0;                 ///< of all its targets
    };
    FrameCost cost(Lab& lab, const Frame& frame, int repeats);
    /// The frame's passes and resources.
    graph::FrameGraph graph(Lab& lab, const Frame& frame);

    /// Frame with the lab's default camera.
    Frame frame(const Lab& lab, int width, int height) const;

    /// Fragments that passed the depth test while the frame was drawn (GL_SAMPLES_PASSED), over all passes.
    std::uint64_t samplesPassed(Lab& lab, const Frame& frame);

    gl::Context& context();
    gl::Executor& executor();

  private:
    graph::Resource draw(Lab& lab, const Frame& frame);
    graph::Resource drawTimed(Lab& lab, const Frame& frame);
    gl::Backend backend_;
    std::unique_ptr<gl::Context> context_;
    std::unique_ptr<gl::Executor> executor_;
    double pictureSeconds_ = 0;
};

}  // namespace quincunx

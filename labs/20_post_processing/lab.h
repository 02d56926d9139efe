#pragma once

#include <memory>
#include <optional>

#include "gl/context.h"
#include "lab/lab.h"
#include "passes/forward.h"
#include "passes/post.h"

namespace quincunx {

/// Effects over a finished picture: greyscale and grain, blurs, bloom, tone curves, antialiasing; each in a
/// pass, and none that is not asked for.
class PostProcessingLab final : public Lab {
  public:
    enum class Place { pass, shader };

    PostProcessingLab();

    std::string topic() const override { return "post-processing: greyscale, blur, bloom, tone curves"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    void useScene(Scene scene) override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    FloatKnob greyscale{knobs(), "greyscale", 0, {0, 1}, "share", "From colour to light and dark"};
    IntKnob grain{knobs(), "grain",   0,
                  {0, 24}, "octaves", "Grain as of old film; each octave costs as much again"};
    ChoiceKnob place{knobs(),
                     "place",
                     {"pass", "shader"},
                     0,
                     "Greyscale and grain in a pass over the picture, or in the shader that draws the scene"};
    IntKnob layers{knobs(), "layers", 1, {1, 16}, "times", "How often the scene is drawn over itself"};
    FloatKnob blurSize{knobs(), "blur", 0, {0, 32}, "pixels", "Standard deviation of a Gaussian; 0: none"};
    ChoiceKnob blurMethod{
        knobs(),
        "blur-method",
        {"direct", "separable", "pairs", "half", "quarter"},
        1,
        "All texels of a square, rows then columns, two by one fetch, or on a smaller picture"};
    FloatKnob blurReach{knobs(), "blur-reach", 3, {1, 6}, "deviations", "Where the Gaussian is cut off"};
    FloatKnob bloom{knobs(), "bloom", 0.8f,
                    {0, 4},  "times", "Glow around what is too bright to show; 0: none"};
    FloatKnob bloomSize{knobs(), "bloom-size", 10, {4, 32}, "pixels", "Standard deviation of the glow"};
    ChoiceKnob curve{knobs(),
                     "tone-map",
                     {"none", "reinhard", "filmic"},
                     2,
                     "How light of any strength comes into what a screen shows"};
    FloatKnob exposure{knobs(), "exposure", 0, {-6, 6}, "stops", "Twice the light for each"};
    BoolKnob fxaa{knobs(), "fxaa", false, "Smooth edges from the picture alone"};
    IntKnob tessellation{knobs(),        "tessellation", 48,
                         {3, 512, true}, "segments",     "Triangles around each solid of the built-in scene"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

  private:
    void prepareScene();
    void drawScene(graph::PassContext& context, const Frame& frame, int factor);

    bool builtIn_ = true;
    int builtTessellation_ = 0;
    std::unique_ptr<ForwardScene> scene_;
    std::map<std::string, std::uint64_t> counters_;
};

/// In how many of the 40 320 orders of the eight steps of "draw the spaceship, then make it grey" the window
/// shows the grey spaceship, all of them run on OpenGL.
struct StepOrders {
    int tried = 0;
    int right = 0;
    int rightOfCards = 0;        ///< of the orders that the card's partial order allows
    int cards = 0;               ///< how many orders that are
    int rightWithEarlyBind = 0;  ///< right ones in which the texture is bound before the spaceship is drawn
};
StepOrders runAllOrders(gl::Context& context);

}  // namespace quincunx

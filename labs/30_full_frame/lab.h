#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "lab/lab.h"
#include "passes/frame_renderer.h"
#include "passes/labels.h"

namespace quincunx {

/// Any scene with the effects that it calls for, and the plan that says why.
class FullFrameLab final : public Lab {
  public:
    FullFrameLab();

    std::string topic() const override { return "any glTF, with only the effects that it calls for"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    void useScene(Scene scene) override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    bool isMoving() const override { return playing_; }
    bool advance(double seconds, const HeldSeconds& held) override;
    std::vector<LabKey> keys() override;
    std::vector<EffectReport> effects() const override;
    void leaveOut(const std::vector<std::string>& effects) override;
    bool plansFiles() const override { return true; }
    std::vector<Sweep> sweeps() override;
    Exercise exercise() const override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    FloatKnob time{knobs(), "time", 0, {0, 3600}, "s", "What moves is placed as it is then"};
    BoolKnob showPlan{knobs(), "show-plan", false, "Write the plan over the picture"};
    BoolKnob force{knobs(), "force", false, "Run every effect, called for or not: nothing changes"};
    ChoiceKnob without;
    FloatKnob exposure{knobs(), "exposure", 0, {-10, 10}, "stops", "Before the tone curve"};
    ChoiceKnob toneCurve{knobs(),
                         "tone-map",
                         {"none", "reinhard", "filmic"},
                         2,
                         "How light of any strength is brought onto the screen"};
    FloatKnob bloom{knobs(), "bloom", 0.35f,
                    {0, 4},  "",      "Glow around what is brighter than the screen shows"};
    FloatKnob aperture{knobs(), "aperture", 0, {0, 1}, "", "Radius of the lens; 0: the camera's own"};
    FloatKnob focus{knobs(), "focus", 0, {0, 1e6f, false}, "", "Distance that is sharp; 0: the camera's own"};
    FloatKnob shutter{knobs(), "shutter", 0, {0, 1}, "s", "How long the shutter is open"};
    FloatKnob blur{knobs(), "blur", 0, {0, 40}, "pixels", "Deviation of a Gaussian over the picture"};
    FloatKnob greyscale{knobs(), "greyscale", 0, {0, 1}, "", "0 colour, 1 grey"};
    BoolKnob fxaa{knobs(), "fxaa", true, "Smooth the steps of edges"};
    IntKnob shadowResolution{knobs(),          "shadow-resolution", 2048,
                             {16, 8192, true}, "texels a side",     "Of a sun's map; other lights get half"};
    IntKnob tessellation{knobs(),        "tessellation", 32,
                         {3, 256, true}, "segments",     "Triangles around each solid of the built-in scene"};

    const Scene& scene() const { return scene_; }
    const FramePlan& plan() const { return renderer_.plan(); }

  private:
    bool moves() const;
    void prepareScene();
    void placeAt(double seconds);
    std::vector<glm::mat4> placementsAt(double seconds);
    /// As many of the words as there is room for.
    std::string fitted(std::string words, float sizePixels, float widthPixels);
    graph::Resource addPlanPass(graph::FrameGraph& graph, const Frame& frame, graph::Resource picture);

    Scene scene_;
    bool builtIn_ = true;
    bool playing_ = false;  ///< the time runs
    int builtTessellation_ = 0;
    FrameRenderer renderer_;
    EffectSet leftOut_;
    std::vector<glm::mat4> atOpen_;   ///< placements when the shutter opens
    std::vector<glm::mat4> atClose_;  ///< … and when it closes
    Labels labels_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx

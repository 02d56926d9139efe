#pragma once

#include <functional>
#include <memory>

#include "lab/lab.h"
#include "passes/shadow_map.h"
#include "passes/targets.h"
#include "scene/still_life.h"
#include "trace/reference.h"

namespace quincunx {

/// Shadow maps: the map, the lookup, and what bias, resolution, filtering and cascades do to the picture.
class ShadowMapLab final : public Lab {
  public:
    enum class View { picture, mask, map };
    enum class Source { sun, spot, lamp };
    enum class Filter { nearest, bilinear, pcf };

    ShadowMapLab();

    std::string topic() const override { return "shadow maps: bias, resolution, filtering, cascades"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    void useScene(Scene scene) override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override {
        return builtIn_ ? "rays traced to the exact surfaces and on to the light"
                        : "rays traced to the triangles and on to the light";
    }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"picture", "mask", "map"},
                    0,
                    "The picture, what the light reaches (white), or the map itself"};
    ChoiceKnob source{knobs(),
                      "light",
                      {"sun", "spot", "lamp"},
                      0,
                      "A directional light, a spot, or a point that needs six views"};
    FloatKnob sunTurn{knobs(), "light-turn", 0, {-180, 180}, "degrees", "Carries the light round the scene"};
    FloatKnob sunHeight{knobs(), "light-height", 38, {2, 88}, "degrees", "The light above the horizon"};
    IntKnob resolution{knobs(),          "resolution",    1024,
                       {16, 8192, true}, "texels a side", "Of the map, or of each of its views"};
    ChoiceKnob bias{knobs(),
                    "bias",
                    {"none", "constant", "slope", "receiver-plane"},
                    3,
                    "What is left between a surface and its own image in the map"};
    FloatKnob biasScale{knobs(), "bias-scale", 1, {0, 64}, "times", "1 is what theory asks for"};
    ChoiceKnob filter{knobs(),
                      "filter",
                      {"nearest", "bilinear", "pcf"},
                      2,
                      "One texel, four blended, or many taps of four"};
    IntKnob pcfRadius{knobs(), "pcf-radius", 1, {1, 8}, "taps", "On each side of the middle one"};
    IntKnob cascades{knobs(), "cascades", 1, {1, 4}, "maps", "Of the sun, each for a slice of the view"};
    BoolKnob backFaces{knobs(), "back-faces", false, "Draw the casters' backs into the map"};
    IntKnob tessellation{knobs(),        "tessellation", 48,
                         {3, 512, true}, "segments",     "Triangles around each solid of the built-in scene"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

    const StillLife& colonnade() const { return colonnade_; }
    /// The light as the knobs have it; the scene's only one.
    Light currentLight() const;
    /// Makes what is drawn, to be traced: solids, or the triangles of an imported model.
    std::function<TraceScene()> exactScene() const;
    ShadowMapParams shadowParams() const;

  private:
    void prepareScene();

    StillLife colonnade_;
    bool builtIn_ = true;
    int builtTessellation_ = 0;
    Bounds bounds_;  ///< of the casters
    std::unique_ptr<ForwardScene> scene_;
    std::shared_ptr<const Scene> imported_;  ///< the same, to be traced
    ShadowMap shadowMap_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx

#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lab/lab.h"
#include "labs/21_accumulation/subject.h"
#include "passes/accumulation.h"
#include "passes/forward.h"
#include "passes/shadow_map.h"

namespace quincunx {

/// The accumulation buffer: motion blur, depth of field, soft shadows and antialiasing as the mean of many
/// passes, which serve all four at once; and the same effects made from one picture, to compare.
class AccumulationLab final : public Lab {
  public:
    enum class Method { accumulated, postProcessed };

    AccumulationLab();

    std::string topic() const override {
        return "the accumulation buffer: motion blur, depth of field, soft shadows, antialiasing";
    }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    void useScene(Scene scene) override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    /// The edges are looked at from where their closed forms hold.
    std::optional<Camera> ownCamera() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override { return "the edge's closed form, in double"; }
    bool isConverging() const override { return converging_; }
    std::vector<EffectReport> effects() const override;
    void leaveOut(const std::vector<std::string>& effects) override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob subject{knobs(),
                       "subject",
                       {"toys", "edge", "moving-edge", "turning-edge", "defocused-edge", "penumbra"},
                       0,
                       "Toys on a table, or an edge that one effect blurs, in closed form"};
    ChoiceKnob method{knobs(),
                      "method",
                      {"accumulated", "post-processed"},
                      0,
                      "Many pictures added up, or one picture blurred by its depths and velocities"};
    IntKnob passes{knobs(), "passes", 64, {1, 65536, true}, "", "Pictures that are added up"};
    ChoiceKnob samples{knobs(),
                       "samples",
                       {samplePatternNames.begin(), samplePatternNames.begin() + patternsOfAnyDimension},
                       static_cast<int>(SamplePattern::sobol),
                       "How the passes are spread over pixel, lens, light and time"};
    BoolKnob antialias{knobs(), "antialias", true, "Each pass a fraction of a pixel aside"};
    FloatKnob aperture{knobs(), "aperture", 0.14f, {0, 1000}, "units", "Radius of the lens; 0: a pinhole"};
    FloatKnob focus{knobs(), "focus", 9.9f, {0, 1e30f}, "units", "Distance that is sharp; 0 is at the eye"};
    FloatKnob lightSize{knobs(),   "light-size", 0.75f,
                        {0, 1000}, "units",      "Radius of the lamp; 0: a point with hard shadows"};
    ChoiceKnob lightShape{knobs(), "light-shape", {"disc", "square"}, 0, "What the lamp looks like"};
    FloatKnob shutter{knobs(), "shutter", 0.12f, {0, 4}, "s", "How long the shutter is open; 0: a moment"};
    FloatKnob time{knobs(), "time", 2, {0, 3600}, "s", "The middle of the exposure"};
    ChoiceKnob summation{knobs(),
                         "sum",
                         {"weighted", "running-mean", "compensated"},
                         static_cast<int>(Summation::compensated),
                         "Each pass divided by their number; blended by 1/n; or with what rounding loses"};
    ChoiceKnob buffer{knobs(), "buffer", {"rgba8", "rgba16f", "rgba32f"}, 2, "What the sum is kept in"};
    IntKnob block{knobs(),         "block",  16,
                  {1, 1024, true}, "passes", "Added by blending before a compensated sum"};
    IntKnob taps{knobs(),         "taps", 48,
                 {1, 1024, true}, "",     "Of each layer, where a picture is post-processed"};
    IntKnob perFrame{knobs(), "per-frame", 4, {1, 1024, true}, "passes", "Drawn at a time in a window"};
    IntKnob shadowResolution{knobs(),          "shadow-resolution", 1024,
                             {16, 4096, true}, "texels a side",     "Of the shadow map of each pass"};
    IntKnob tessellation{knobs(),        "tessellation", 32,
                         {3, 256, true}, "segments",     "Triangles around each solid of the built-in scene"};

    const Scene& scene();
    /// Which effects the frame calls for as the knobs are; `effects` then says why.
    AccumulatedEffects calledFor();
    /// Of what the last frame added up.
    const Accumulator& accumulator() const { return whole_; }

  private:
    /// What passes draw, for as long as a graph runs.
    struct Shot {
        Camera camera;
        AreaLight lamp;
        ShadowMapParams shadows;
        AccumulatedEffects effects;
        double seconds = 0;
        double shutterSeconds = 0;
        float aspect = 1;
        int width = 1;
        int height = 1;
        bool shadowed = false;
    };

    void prepareScene();
    bool moves();
    bool casts() const;
    Camera cameraOf(const Frame& frame) const;
    AreaLight lamp() const;
    std::vector<glm::mat4> placementsAt(double seconds);
    /// All that the accumulated picture depends on.
    std::string settings(const Frame& frame) const;
    Shot shotOf(const Frame& frame);
    /// Before a pass: what moves, the light, and its shadow map where it is not that of the pass before.
    void prepare(graph::PassContext& context, const Shot& shot, const PassSample& sample);
    /// Into the bound target.
    void draw(graph::PassContext& context, const Shot& shot, const PassSample& sample);
    graph::Resource buildPostProcessed(graph::FrameGraph& graph, const Frame& frame, const Shot& shot);

    bool builtIn_ = true;
    int builtTessellation_ = 0;
    int builtSubject_ = 0;
    float unit_ = 1;  ///< of the knobs' lengths, in the world's
    Bounds bounds_;
    std::unique_ptr<ForwardScene> scene_;
    std::vector<Light> lights_;  ///< as the scene has them
    std::optional<SceneBuffers> movingMeshes_;
    struct LampMap {
        gl::Texture2D depth;
        gl::Framebuffer framebuffer;
        ShadowViews views;
        bool drawn = false;  ///< for the frame that is being drawn
    };
    std::optional<LampMap> map_;
    ShadowMap shadowMap_;
    Accumulator whole_;  ///< of frames that are drawn in one go
    Accumulator live_;   ///< of the window's
    std::string liveSettings_;
    bool converging_ = false;
    std::set<std::string, std::less<>> leftOut_;
    std::vector<EffectReport> reports_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx

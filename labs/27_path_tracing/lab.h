#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "gl/objects.h"
#include "lab/lab.h"
#include "passes/labels.h"
#include "trace/path_scenes.h"
#include "trace/render.h"

namespace quincunx {

/// A set of surfaces and lights, ready for paths.
struct PathStage {
    explicit PathStage(PathSet set);
    PathStage(const PathStage&) = delete;
    PathStage& operator=(const PathStage&) = delete;

    Camera camera;
    TraceScene traced;
    PathScene paths;
};

/// Path tracing: the rendering equation estimated by chance, pass by pass, and its terms at a point.
class PathTracingLab final : public Lab {
  public:
    enum class Subject { chamber, balls, furnace, shell };
    enum class Method { naive, nee, mis, tree };

    std::string topic() const override { return "path tracing: the rendering equation, estimated by chance"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void useScene(Scene scene) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    bool isConverging() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override { return "the furnace's light in closed form"; }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob subject{knobs(),
                       "subject",
                       {"chamber", "balls", "furnace", "shell"},
                       0,
                       "A room to look at, a field of balls, or two scenes whose light is known"};
    ChoiceKnob method{knobs(),
                      "method",
                      {"naive", "nee", "mis", "tree"},
                      2,
                      "Light found by chance, by shadow rays, by both; or a tree of rays"};
    IntKnob samples{knobs(), "samples", 16, {1, 4096, true}, "a pixel", "Paths, or trees, averaged"};
    IntKnob bounces{knobs(), "bounces",
                    64,      {0, 1000},
                    "",      "Surfaces that light is scattered at, most; a tree ends where it has 64 leaves"};
    FloatKnob roulette{knobs(), "roulette", 1,
                       {0, 1},  "",         "Paths of less weight end by Russian roulette; 0: none do"};
    FloatKnob cutoff{knobs(), "cutoff", 0, {0, 1}, "", "Paths of less weight are dropped: dark, and wrong"};
    IntKnob branches{knobs(), "branches", 4, {1, 16}, "", "Rays that go on at each surface of a tree"};
    ChoiceKnob numbers{knobs(),
                       "numbers",
                       {"independent", "sobol"},
                       1,
                       "Random numbers, or points that fill the space of paths evenly"};
    FloatKnob clamp{knobs(), "clamp", 0, {0, 100}, "", "Samples brighter than this count as this; 0: none"};
    FloatKnob albedo{knobs(), "albedo", 0.5f, {0, 0.99f}, "", "What the furnace's walls send back"};
    FloatKnob exposure{knobs(), "exposure", 1, {0.01f, 100, true}, "times", "Brightness of the picture"};
    BoolKnob terms{knobs(), "terms", true, "Shows the equation's terms at a point"};
    FloatKnob pickX{knobs(), "pick-x", 0.32f, {0, 1}, "of the width", "The point, from the left"};
    FloatKnob pickY{knobs(), "pick-y", 0.83f, {0, 1}, "of the height", "The point, from the top"};
    TextKnob checkpoint{knobs(), "checkpoint", "", "FILE",
                        "Where a picture is kept while it is made, and gone on with"};

    PathLimits limits() const;
    RenderSettings settings(const Frame& frame) const;
    /// The scene that the knobs name; made again when they change.
    const PathStage& stage();

  private:
    /// A picture with the settings that it is made by.
    struct Rendered {
        std::unique_ptr<ProgressiveRender> render;
        std::uint64_t settings = 0;
    };
    ProgressiveRender& renderOf(const Frame& frame);
    void traceFrame(ProgressiveRender& render, const Frame& frame,
                    std::chrono::steady_clock::time_point until);
    void draw(graph::PassContext& context, const Frame& frame);
    void addTerms(const Frame& frame, std::chrono::steady_clock::time_point until);
    void drawTerms(glm::vec2 at, float height, const EquationTerms& found);

    std::optional<Scene> imported_;
    std::unique_ptr<PathStage> stage_;
    std::pair<int, float> staged_{-1, 0};
    Rendered live_;   ///< a window's, which goes on from frame to frame
    Rendered whole_;  ///< of frames that are whole at once
    std::chrono::steady_clock::time_point begun_;
    std::optional<TermEstimate> terms_;
    std::uint64_t termsOf_ = 0;
    std::pair<float, float> picked_{-1, -1};
    std::optional<gl::Texture2D> texture_;
    Labels labels_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/objects.h"
#include "lab/lab.h"
#include "labs/26_ray_tracing/terrace.h"
#include "trace/whitted.h"

namespace quincunx {

/// Whitted's ray tracer: mirrors, glass, soft shadows, constructed solids, and what each of its savings
/// saves.
class RayTracingLab final : public Lab {
  public:
    std::string topic() const override {
        return "Whitted's ray tracer: recursion, shadow caches, mailboxes, soft shadows, constructed solids";
    }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override { return terraceCamera(); }
    Bounds sceneBounds() const override { return {{-4, 0, -3}, {4.5f, 3.2f, 3}}; }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    /// What the last picture took: rays by kind, tests, cache hits.
    std::map<std::string, std::uint64_t> counters() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override {
        return "256 shadow rays a lamp, and all rays that weigh 1/4096 of their pixel";
    }

    /// In the window a picture that changes is coarse at first, and refined while nothing is touched.
    bool isConverging() const override { return step_ > 0; }
    /// Of a live frame, for tracing; at least one tile is traced in each.
    double liveSeconds = 0.03;

    ChoiceKnob end{knobs(),
                   "end",
                   {"depth", "weight", "roulette"},
                   1,
                   "What ends the tree of rays: a greatest depth, a least weight, chance below that weight"};
    IntKnob maxDepth{knobs(), "max-depth", 6, {0, 16}, "", "Mirrored and refracted rays in a chain"};
    FloatKnob minWeight{knobs(),   "min-weight",
                        0.0078125, {0.000244140625f, 1, true},
                        "",        "Share of its pixel below which a ray is not traced, or by chance"};
    IntKnob shadowRays{knobs(), "shadow-rays", 4, {1, 256, true}, "", "Towards the lamp, from each point"};
    ChoiceKnob pattern{knobs(),
                       "pattern",
                       {"regular", "random", "jittered", "n-rooks", "halton", "sobol", "quincunx"},
                       5,
                       "Where on the lamp they end"};
    FloatKnob lampSize{knobs(),          "lamp-size", 1,
                       {0.05f, 2, true}, "times",     "Sides of the lamp; its light stays the same"};
    BoolKnob shadowCache{knobs(), "shadow-cache", true,
                         "Tries the last thing that stood before the lamp first"};
    ChoiceKnob structure{knobs(), "structure", structureNames(), defaultStructure(),
                         "Where rays look for triangles: same picture, other times"};
    ChoiceKnob mailboxes{knobs(),
                         "mailboxes",
                         {"none", "of-ray", "of-thread"},
                         1,
                         "How a ray in the grid is kept from testing a triangle again"};
    ChoiceKnob sculpture{knobs(),
                         "sculpture",
                         {"difference", "union", "intersection"},
                         0,
                         "How the rounded cube and the three rods are put together"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Rays along a side of a pixel, averaged"};

    WhittedSettings settings() const;
    std::shared_ptr<const WhittedScene> scene() const;
    static std::vector<Structure> structures();

  private:
    static std::vector<std::string> structureNames();
    static int defaultStructure();
    std::vector<double> stateOf(const Frame& frame) const;
    void traceFrame(const Frame& frame);
    void draw(graph::PassContext& context, const Frame& frame);

    void begin(const Frame& frame, int step);

    std::vector<double> state_;
    int step_ = 0;  ///< pixels a side that share a ray in what is being traced; 0: the picture is whole
    std::optional<WhittedRender> render_;
    bool uploaded_ = false;
    std::optional<gl::Texture2D> texture_;
    mutable std::shared_ptr<const WhittedScene> scene_;
    mutable std::vector<double> sceneState_;
    std::shared_ptr<const WhittedScene> rendered_;  ///< what render_ looks at
};

}  // namespace quincunx

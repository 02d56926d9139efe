#pragma once

#include <optional>

#include "gl/objects.h"
#include "lab/lab.h"
#include "labs/22_intersections/exhibit.h"
#include "labs/22_intersections/picture.h"
#include "passes/labels.h"
#include "passes/lines.h"

namespace quincunx {

/// Rays and shapes: where they meet, the normal there, and where float arithmetic and exact arithmetic
/// disagree, as a map over the picture.
class IntersectionsLab final : public Lab {
  public:
    enum class View { scene, map, beside };

    std::string topic() const override { return "rays and shapes: hits, normals, and where float is wrong"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    /// Rays, and on a map the pixels where the method is wrong, by kind.
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override { return "the same rays, met by the stable routines"; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"scene", "map", "beside"},
                    2,
                    "The picture, the map of wrong answers over it, or one beside the other"};
    ChoiceKnob shape{knobs(),
                     "shape",
                     {"all", "sphere", "cylinder", "can", "box", "triangle", "polygon", "plane"},
                     0,
                     "Which shapes there are"};
    ChoiceKnob method{knobs(),
                      "method",
                      {"naive", "careful", "double", "stable", "exact"},
                      0,
                      "The textbook in float, float with less cancelling, the textbook in double, routines "
                      "with an error bound, exact arithmetic"};
    ChoiceKnob triangleWay{knobs(),
                           "triangle-way",
                           {"crossings", "angle-sum", "areas", "fan", "pluecker-2d", "cross-products",
                            "pluecker", "moller-trumbore", "woop"},
                           7,
                           "How the naive method meets triangles"};
    FloatKnob distance{knobs(), "distance",
                       128,     {1, 4096, true},
                       "times", "Moves the camera back, and narrows it as much: the same picture from afar"};
    IntKnob offset{knobs(),     "offset", 0,
                   {0, 131072}, "units",  "Moves shapes and camera away from the world's origin"};
    BoolKnob probe{knobs(), "probe", true,
                   "Shows one ray: its hit, the normal there, and what float makes of it"};
    FloatKnob probeTurn{knobs(),     "probe-turn", 0,
                        {-180, 180}, "degrees",    "Turns the shown ray about the upright axis"};
    FloatKnob probeTilt{knobs(), "probe-tilt", 0, {-90, 90}, "degrees", "Lifts or lowers the shown ray"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Rays along a side of a pixel, averaged; the map has one"};

    Approach approach() const { return {method.as<Method>(), triangleWay.as<TriangleWay>()}; }
    /// The shapes that the knobs leave, in their place.
    std::vector<Exhibit> exhibits() const;
    /// What the camera of the frame sees of them, in a picture of this aspect.
    Lens lens(const Frame& frame, double aspect) const;
    /// The shown ray, in the world.
    Ray probeRay() const;

  private:
    struct Panel {
        int left = 0;  ///< pixels
        int width = 1;
        bool map = false;
    };
    std::vector<Panel> panels(const Frame& frame) const;
    glm::vec3 place() const;
    glm::dmat4 clipFromWorld(const Lens& seenBy) const;
    /// All that the pixels depend on.
    std::vector<double> stateOf(const Frame& frame) const;
    void castPanels(const Frame& frame);
    void draw(graph::PassContext& context, const Frame& frame);
    void addProbe(const Panel& panel, const Frame& frame);
    void addLegend(const Panel& panel, const Frame& frame);

    std::vector<double> castState_;
    std::vector<Cast> casts_;  ///< by panel
    std::optional<gl::Texture2D> texture_;
    bool uploaded_ = false;
    Lines lines_;
    Labels labels_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx

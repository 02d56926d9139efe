#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lab/lab.h"
#include "labs/01_transforms/boat.h"
#include "math/spaces.h"
#include "passes/forward.h"
#include "passes/labels.h"
#include "passes/lines.h"
#include "passes/targets.h"

namespace quincunx {

/// The way of a vertex through all spaces, the order of translation, rotation and scale, and which arithmetic
/// holds in a large world.
class TransformsLab final : public Lab {
  public:
    enum class View { spaces, orders, picture };
    enum class Precision { absolute, eyeRelative, rebased };
    /// How the camera's pose is inverted; the naive ones are in float.
    enum class Inverse { rigid, rigidNaive, affine, affineNaive, general, generalNaive, inDouble };
    static constexpr int orderCount = 6;
    static constexpr int intendedOrder = 0;

    TransformsLab();

    std::string topic() const override {
        return "spaces and matrices: object, world, eye, clip, NDC, window; orders; inverses";
    }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"spaces", "orders", "picture"},
                    0,
                    "All six spaces, all six orders of T, R and S, or the picture alone"};
    ChoiceKnob vertex{knobs(),
                      "vertex",
                      {"masthead", "bow", "stern", "clew"},
                      0,
                      "The vertex that is followed through the spaces"};
    ChoiceKnob order{knobs(),
                     "order",
                     {"TRS", "TSR", "RTS", "RST", "STR", "SRT"},
                     intendedOrder,
                     "The product that places the boat, the leftmost acting last"};
    FloatKnob translateX{knobs(), "translate-x", 0.7f, {-4, 4}, "units", "Carries the boat along x"};
    FloatKnob translateY{knobs(), "translate-y", 0, {-4, 4}, "units", "Lifts the boat"};
    FloatKnob translateZ{knobs(), "translate-z", -0.6f, {-4, 4}, "units", "Carries the boat along z"};
    FloatKnob heading{knobs(), "heading", -38, {-180, 180}, "degrees", "Turns the boat about its mast"};
    FloatKnob heel{knobs(), "heel", 9, {-180, 180}, "degrees", "Leans the boat to starboard"};
    FloatKnob scaleX{knobs(), "scale-x", 1.45f, {-3, 3}, "times", "Stretches the boat along its keel"};
    FloatKnob scaleY{knobs(), "scale-y", 0.9f, {-3, 3}, "times", "Stretches the boat along its mast"};
    FloatKnob scaleZ{knobs(), "scale-z", 1, {-3, 3}, "times", "Stretches the boat sideways"};
    FloatKnob shear{knobs(), "shear", 0, {-2, 2}, "times the height", "Rakes the boat's mast fore and aft"};
    BoolKnob mirror{knobs(), "mirror", false, "Exchanges port and starboard"};
    FloatKnob fov{knobs(), "fov", 32, {5, 150}, "degrees", "Full vertical angle of the view"};
    FloatKnob nearPlane{knobs(), "near", 4, {0.001f, 20, true}, "units", "Distance of the near plane"};
    FloatKnob farPlane{knobs(), "far", 11, {1, 100000, true}, "units", "Distance of the far plane"};
    FloatKnob worldOffset{knobs(), "world-offset",
                          0,       {0, 1e8f},
                          "units", "Carries boat, sea and eye away from the world's origin"};
    ChoiceKnob precision{knobs(),
                         "precision",
                         {"absolute", "eye-relative", "rebased"},
                         1,
                         "What reaches the shader: world coordinates, what is left after the eye's, or after "
                         "those of an origin that follows the eye in steps"};
    FloatKnob rebaseEvery{knobs(),         "rebase-every", 4096,
                          {1, 1e8f, true}, "units",        "The steps of the origin that follows the eye"};
    ChoiceKnob inverse{
        knobs(),
        "inverse",
        {"rigid", "rigid-naive", "affine", "affine-naive", "general", "general-naive", "double"},
        0,
        "The routine that turns the camera's pose into the view matrix"};
    IntKnob supersample{knobs(), "supersample", 2, {1, 4}, "per side", "Samples along a side of a pixel"};

    /// The boat's matrix by an order of `order`, without the world's offset.
    glm::mat4 worldFromBoat(int orderIndex) const;
    glm::mat4 worldFromBoat() const { return worldFromBoat(order.index()); }
    /// All that stands between the boat and the pixels of a frame, without the world's offset.
    SpaceChain chain(const Frame& frame) const;
    const Scene& boat() const { return boat_.scene(); }
    /// The parts' placements in the boat.
    const std::vector<glm::mat4>& boatFromPart() const { return boatFromPart_; }
    BoatVertex chosenVertex() const { return vertices_[static_cast<std::size_t>(vertex.index())]; }
    /// What the picture's shader gets: the knobs `precision`, `rebase-every` and `world-offset` at work.
    struct PlacedView {
        glm::mat4 worldFromBoat{1};
        glm::mat4 worldFromSea{1};
        glm::mat4 clipFromWorld{1};
        glm::vec3 eyeWorld{0};
    };
    PlacedView placedView(const Frame& frame) const;
    /// What is subtracted, in double, before places of a world become floats, for an eye there.
    glm::dvec3 subtractedFor(glm::dvec3 eyeWorld) const;
    /// The pose's inverse by the routine of a knob's choice; what has no inverse gives the identity.
    static glm::mat4 inverted(const glm::mat4& pose, Inverse routine);

  private:
    struct Panel;
    void drawSpaces(graph::PassContext& context, const Frame& frame, int factor);
    void drawOrders(graph::PassContext& context, const Frame& frame, int factor);
    void drawPicture(graph::PassContext& context, const Frame& frame);
    void drawMarks(graph::PassContext& context, const Frame& frame, bool chosenOnly);
    void addBackdrop(graph::PassContext& context, const Panel& panel, const std::string& title,
                     bool intended);
    /// Boat and sea, placed in a world of the caller's.
    void drawScene(graph::PassContext& context, const glm::mat4& worldFromBoat, const glm::mat4& worldFromSea,
                   const ForwardView& view, bool withSea);
    glm::mat4 clipFromEye(float aspect) const;

    ForwardScene boat_;
    ForwardScene sea_;
    glm::mat4 worldFromSea_;
    std::vector<glm::mat4> boatFromPart_;
    std::array<BoatVertex, 4> vertices_;
    Lines lines_;
    Lines dots_;
    Labels labels_;
    struct MarkBuffers {
        gl::Buffer positions;
        gl::VertexArray vertexArray;
        GLsizei count = 0;
    };
    std::optional<MarkBuffers> marks_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx
